"""The shipped data is what the course says it is, and the simulator's verdict beside it agrees with what is stored.

What only the arm has is asked in `test_arm`.
"""

import numpy as np
import pytest

import z2r
from z2r.data import SHIPPED
from z2r.reading.verdict import read_verdict

PUSHT = ("standin", "messy")


@pytest.mark.parametrize("name", SHIPPED)
def test_lengths_are_those_of_the_verdict(name):
    told = [verdict.n_frames for verdict in read_verdict(SHIPPED[name]).episodes]
    assert z2r.load(SHIPPED[name]).episodes.lengths.tolist() == told


@pytest.mark.parametrize("name", PUSHT)
def test_an_episode_with_success_is_read_as_reached(name):
    """Success means five steps in tolerance, of which the last stored frame is the fourth."""
    reached = z2r.inspect_dataset(z2r.load(SHIPPED[name])).outcome.reached
    for verdict, read in zip(read_verdict(SHIPPED[name]).episodes, reached, strict=True):
        assert read or not verdict.success


@pytest.mark.parametrize("name", PUSHT)
def test_every_sin_and_cos_is_on_the_unit_circle(name):
    state = z2r.load(SHIPPED[name]).read("observation.state").astype(float)
    for sin_yaw, cos_yaw in ((4, 5), (8, 9)):
        np.testing.assert_allclose(np.hypot(state[:, sin_yaw], state[:, cos_yaw]), 1, atol=1e-6)


def test_standin_is_six_demonstrations_that_all_succeed():
    verdicts = read_verdict(z2r.STANDIN)
    assert [verdict.seed for verdict in verdicts.episodes] == list(range(6))
    assert all(verdict.success for verdict in verdicts.episodes)
    assert verdicts.command == "z2r record standin --episodes 6 --seed 0 --noise 0.08 --max-steps 300"


def test_messy_has_time_outs_short_episodes_and_one_reached_without_success():
    verdicts = read_verdict(z2r.MESSY).episodes
    lengths = np.array([verdict.n_frames for verdict in verdicts])
    success = np.array([verdict.success for verdict in verdicts])
    reached = z2r.inspect_dataset(z2r.load(z2r.MESSY)).outcome.reached
    assert len(verdicts) >= 12
    assert np.all(lengths[~success] == lengths.max())
    assert (~success).sum() >= 2
    assert (lengths < 20).sum() >= 2
    assert (reached & ~success).sum() == 1


@pytest.mark.parametrize("name", SHIPPED)
def test_the_stack_it_was_recorded_on_is_told(name):
    assert {"python", "platform", "mujoco", "lerobot", "numpy"} <= set(read_verdict(SHIPPED[name]).stack)
