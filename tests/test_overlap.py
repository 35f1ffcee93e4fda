"""How far the pusher sinks into the block, against boxes made of dense points, and on the shipped data."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import z2r
from z2r.pusht import task
from z2r.pusht.overlap import LIMIT, overlap, pusher_in_block
from z2r.pusht.world import PUSHT

SCHEMA = z2r.load(z2r.STANDIN).schema
BOXES = ((task.BAR_CENTER, task.BAR_HALF_SIZE[:2]), (task.STEM_CENTER, task.STEM_HALF_SIZE[:2]))
SPACING = 1e-4  # m: between two points of a side


def frame_of(pusher: tuple[float, float], block: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> z2r.Decoded:
    x, y, yaw = block
    state = np.array([[*pusher, x, y, np.sin(yaw), np.cos(yaw), 0.0, 0.0, 0.0, 1.0]])
    return z2r.decode(state, PUSHT, SCHEMA)


def sides(center: tuple[float, float], half_size: tuple[float, float]) -> np.ndarray:
    """Points all along the four sides of a box."""
    (half_x, half_y), along = half_size, np.linspace(-1, 1, round(2 * max(half_size) / SPACING) + 1)
    ends = np.ones_like(along)
    points = [np.stack([along * half_x, sign * ends * half_y], axis=1) for sign in (-1, 1)]
    points += [np.stack([sign * ends * half_x, along * half_y], axis=1) for sign in (-1, 1)]
    return np.concatenate(points) + center


SIDES = [sides(*box) for box in BOXES]


def sampled_overlap(pusher: tuple[float, float]) -> float:
    """The same, from the nearest of many points: the block is at the origin, unturned."""
    depths = [0.0]
    for (center, half_size), points in zip(BOXES, SIDES, strict=True):
        nearest = np.hypot(*(points - pusher).T).min()
        is_inside = np.all(np.abs(np.subtract(pusher, center)) < half_size)
        depths.append(task.PUSHER_RADIUS + (nearest if is_inside else -nearest))
    return max(depths)


near = st.floats(-0.15, 0.15)


@given(x=near, y=near)
def test_it_agrees_with_the_nearest_of_many_points(x, y):
    assert overlap(frame_of((x, y))) == pytest.approx(sampled_overlap((x, y)), abs=SPACING)


@pytest.mark.parametrize(
    ("pusher", "expected"),
    [
        ((0.0, 0.0), 0.030),  # the centre of the bar: 15 mm to its side, and the radius
        ((0.0, -0.06), 0.030),  # the centre of the stem
        ((0.055, 0.0), 0.020),  # 5 mm inside the end of the bar
        ((0.0, 0.030), 0.0),  # touches the bar
        ((0.0, 0.025), 0.005),
        ((0.0, -0.110), 0.010),  # below the foot of the stem
        ((0.063, 0.019), 0.010),  # off a corner: 3, 4 and 5 mm
        ((0.06 + 0.011, 0.015 + 0.011), 0.0),  # off a corner, further than the radius
        ((0.030, -0.030), 0.0),  # in the armpit of the T, touching both
    ],
)
def test_places_around_the_block(pusher, expected):
    assert overlap(frame_of(pusher)) == pytest.approx(expected, abs=1e-9)


@given(pusher=st.tuples(near, near), at=st.tuples(near, near), yaw=st.floats(-np.pi, np.pi))
def test_nothing_changes_when_pusher_and_block_move_together(pusher, at, yaw):
    turned = complex(*pusher) * np.exp(1j * yaw) + complex(*at)
    moved = frame_of((turned.real, turned.imag), (*at, yaw))
    np.testing.assert_allclose(np.concatenate(pusher_in_block(moved)), pusher, atol=1e-9)
    np.testing.assert_allclose(overlap(moved), overlap(frame_of(pusher)), atol=1e-9)


@pytest.mark.parametrize("root", [z2r.STANDIN, z2r.MESSY], ids=["standin", "messy"])
@pytest.mark.parametrize("mode", [None, *z2r.BREAK_MODES])
def test_only_a_reading_with_the_right_pose_of_the_block_keeps_solid_bodies_apart(root, mode):
    dataset = z2r.load(root)
    reading = z2r.break_mode(mode).reading(PUSHT) if mode else PUSHT
    deepest = overlap(z2r.decode(dataset.read("observation.state"), reading, dataset.schema)).max()
    if mode in ("yaw-swap", "yaw-swap-everywhere", "wrong-reference-point"):
        assert deepest > 2 * LIMIT
    else:
        assert deepest < LIMIT / 2


def test_a_missing_column_is_named():
    schema = z2r.Schema("v3.0", 10, 1, 1, {"observation.state": z2r.Feature("float32", (2,), ["a", "b"])}, "")
    with pytest.raises(ValueError, match=r"pusher_x.*a, b"):
        overlap(z2r.decode(np.zeros((1, 2)), PUSHT, schema))
