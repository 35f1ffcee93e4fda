import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from z2r.reading.angles import decode_yaw, wrap_angle
from z2r.reading.poses import YawColumns

angles = st.floats(-1e4, 1e4)
yaws = st.floats(-np.pi, np.pi)


@given(angles)
def test_a_wrapped_angle_is_within_one_turn(angle):
    assert -np.pi <= wrap_angle(angle) < np.pi


@given(angles)
def test_wrapping_keeps_the_direction(angle):
    assert np.exp(1j * wrap_angle(angle)) == pytest.approx(np.exp(1j * angle), abs=1e-9)


@pytest.mark.parametrize("angle", [np.pi, -np.pi, 3 * np.pi, np.nextafter(-np.pi, -4)])
def test_half_a_turn_wraps_to_the_closed_end(angle):
    assert wrap_angle(angle) == pytest.approx(-np.pi)


@given(yaws)
def test_a_yaw_survives_being_stored_as_sin_and_cos(yaw):
    assert wrap_angle(decode_yaw(np.sin(yaw), np.cos(yaw)) - yaw) == pytest.approx(0, abs=1e-9)


@given(yaws)
def test_swapped_arguments_mirror_the_yaw_about_45_degrees(yaw):
    assert wrap_angle(decode_yaw(np.cos(yaw), np.sin(yaw)) - (np.pi / 2 - yaw)) == pytest.approx(0, abs=1e-9)


def test_arrays_keep_their_shape_and_float32_is_decoded_in_float64():
    sin_yaw = np.zeros((4, 3), dtype=np.float32)
    decoded = decode_yaw(sin_yaw, sin_yaw + 1)
    assert decoded.shape == (4, 3)
    assert decoded.dtype == wrap_angle(sin_yaw).dtype == np.float64


@pytest.mark.parametrize("how", [YawColumns(sin="s", cos="c"), YawColumns(rad="r"), YawColumns(deg="d")])
@given(yaw=yaws, length=st.sampled_from([1e-3, 1.0, 7.0]))
def test_a_direction_is_cosine_and_sine_of_the_yaw(how, yaw, length):
    stored = {"s": length * np.sin(yaw), "c": length * np.cos(yaw), "r": yaw, "d": np.rad2deg(yaw)}
    columns = {name: np.array([value]) for name, value in stored.items()}
    [cosine], [sine] = how.direction(columns)
    [decoded] = how.decode(columns)
    assert (cosine, sine) == pytest.approx((np.cos(decoded), np.sin(decoded)), abs=1e-12)


def test_where_neither_sine_nor_cosine_is_stored_the_direction_is_that_of_yaw_0():
    nothing = {"s": np.zeros(1), "c": np.zeros(1)}
    how = YawColumns(sin="s", cos="c")
    assert [each.tolist() for each in how.direction(nothing)] == [[1.0], [0.0]]
    assert how.decode(nothing).tolist() == [0.0]
