"""The reading against the simulator's own errors, frame by frame."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

import z2r
from z2r.pusht.simulator.env import PushTEnv
from z2r.pusht.simulator.expert import ScriptedExpert
from z2r.pusht.world import PUSHT

SCHEMA = z2r.load(z2r.STANDIN).schema


def errors_of(state: np.ndarray, schema: z2r.Schema = SCHEMA) -> z2r.FrameErrors:
    return z2r.frame_errors(z2r.decode(state, PUSHT, schema))


@pytest.fixture(scope="module")
def rollouts() -> list[tuple[np.ndarray, np.ndarray, np.ndarray]]:
    """Observations, and the simulator's own errors at each of them, for three episodes."""
    result = []
    for seed in range(3):
        env, expert = PushTEnv(), ScriptedExpert()
        observation, done = env.reset(seed), False
        frames, pos_err, ang_err = [], [], []
        while not done:
            frames.append(observation)
            pos_err.append(env.pos_err)
            ang_err.append(env.ang_err)
            step = env.step(expert(observation))
            observation, done = step.observation, step.done
        result.append((np.stack(frames), np.array(pos_err), np.array(ang_err)))
    return result


def test_errors_are_the_simulators_own(rollouts):
    for state, pos_err, ang_err in rollouts:
        read = errors_of(state)
        np.testing.assert_allclose(read["pos_err"], pos_err, atol=1e-6)
        np.testing.assert_allclose(read["ang_err"], ang_err, atol=1e-6)


@given(yaw=st.floats(-np.pi, np.pi), target_yaw=st.floats(-np.pi, np.pi), x=st.floats(-0.4, 0.4))
def test_errors_are_measured_to_the_target_and_the_short_way_round(yaw, target_yaw, x):
    state = np.array([[9, 9, x, 0.1, np.sin(yaw), np.cos(yaw), 0.2, -0.1, np.sin(target_yaw), np.cos(target_yaw)]])
    errors = errors_of(state)
    assert errors["pos_err"] == pytest.approx(np.hypot(x - 0.2, 0.2))
    turn = abs(yaw - target_yaw)
    assert errors["ang_err"] == pytest.approx(min(turn, 2 * np.pi - turn), abs=1e-9)


def pose(x: float, yaw: float) -> list[float]:
    return [0.3, 0.3, x, 0.0, np.sin(yaw), np.cos(yaw), 0.0, 0.0, 0.0, 1.0]


@pytest.mark.parametrize(
    ("last", "reached"),
    [
        (pose(0.0, 0.0), True),
        (pose(0.0299, 0.199), True),
        (pose(0.0301, 0.0), False),
        (pose(0.0, 0.201), False),
        (pose(0.0, -0.201), False),
        (pose(0.0, np.pi), False),
    ],
)
def test_the_last_frame_alone_decides_whether_an_episode_reached_the_target(last, reached):
    far, near = pose(0.3, 2.0), pose(0.0, 0.0)
    assert z2r.episode_reached(z2r.decode(np.array([far, near, last]), PUSHT, SCHEMA)) is reached


def test_columns_are_found_by_name_wherever_they_stand():
    state = np.array([pose(0.1, 0.5)])
    names = SCHEMA.features["observation.state"].dim_names
    order = np.random.default_rng(0).permutation(len(names))
    feature = z2r.Feature("float32", (len(names),), [names[i] for i in order])
    shuffled = z2r.Schema("v3.0", 10, 1, 1, {"observation.state": feature}, "")
    assert errors_of(state[:, order], shuffled) == errors_of(state)


def test_a_missing_column_is_named():
    schema = z2r.Schema("v3.0", 10, 1, 1, {"observation.state": z2r.Feature("float32", (2,), ["a", "b"])}, "")
    with pytest.raises(ValueError, match=r"pusher_x.*a, b"):
        errors_of(np.zeros((1, 2)), schema)
