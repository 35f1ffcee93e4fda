"""What is measured in two units, and velocities that are not those of their columns."""

from pathlib import Path

import numpy as np
import pytest
from arms import ACTION, POS, STATE, Recording, make, write

import z2r
from z2r.audits.findings import Finding

VELOCITY = "observation.velocity"


def arm(seed: int = 0) -> Recording:
    """An SO-101 that says how fast its joints move, as they come to be in the middle between two frames."""
    own = make("so101", seed)
    own.names[VELOCITY] = POS
    for episode in own.episodes:
        episode[VELOCITY] = np.gradient(episode[STATE], axis=0) * own.fps
    return own


def found(recording: Recording, root: Path, check: str) -> list[Finding]:
    write(recording, root)
    return [each for each in z2r.audit(root).findings if each.check == check]


def test_nothing_is_said_of_what_is_right(tmp_path):
    write(arm(), tmp_path / "dataset")
    assert not [each for each in z2r.audit(tmp_path / "dataset").findings if each.severity != "note"]


def test_a_velocity_in_another_unit_is_named_with_the_factor(tmp_path):
    recording = arm()
    for episode in recording.episodes:
        episode[VELOCITY][:, 2] = np.radians(episode[VELOCITY][:, 2])
    for finding in (said := found(recording, tmp_path / "dataset", "velocity")):
        assert f"{VELOCITY}[elbow_flex.pos] in episode" in finding.field
        assert "0.0175 where observation.state[elbow_flex.pos] moves by 1 a second" in finding.found
    assert {number for finding in said for number in finding.episodes} == set(range(len(recording.episodes)))


def test_velocities_that_are_exchanged_are_named_by_the_column_that_moves_so(tmp_path):
    recording = arm()
    recording.episodes[3][VELOCITY][:, [1, 4]] = recording.episodes[3][VELOCITY][:, [4, 1]]
    said = found(recording, tmp_path / "dataset", "velocity")
    assert [finding.episodes for finding in said] == [(3,), (3,)]
    assert "observation.state[wrist_roll.pos]" in said[0].found
    assert "observation.state[shoulder_lift.pos]" in said[1].found


@pytest.mark.parametrize(("factor", "says"), [(100, "percent"), (180 / np.pi, "degrees"), (1000, "mm")])
@pytest.mark.parametrize("episodes", [[2], [1, 3, 4]])
@pytest.mark.parametrize("times", ["as much", "less"])
def test_another_unit_in_some_episodes_is_named_though_the_command_has_it_too(factor, says, episodes, times, tmp_path):
    recording = make("so101", 0)
    for number, own in enumerate(recording.episodes):
        for name in (STATE, ACTION):
            own[name][:, 1] /= factor if (number in episodes) == (times == "as much") else 1
    [finding] = [each for each in found(recording, tmp_path / "dataset", "unit") if "in the others" in each.expected]
    assert f"{factor:.4g} times {times}" in finding.expected
    assert finding.field.startswith(f"{STATE}[{POS[1]}], {ACTION}[{POS[1]}] in episode")
    assert finding.episodes == tuple(episodes)
    assert says in finding.mend


def test_one_short_episode_hides_no_unit(tmp_path):
    recording = make("so101", 0)
    recording.episodes[0] = {name: values[:5] for name, values in recording.episodes[0].items()}
    for name in (STATE, ACTION):
        recording.episodes[2][name][:, 1] /= 100
    assert {each.episodes for each in found(recording, tmp_path / "dataset", "unit")} == {(2,)}


def test_a_joint_that_is_not_used_in_an_episode_has_no_other_unit(tmp_path):
    recording, rng = make("so101", 0), np.random.default_rng(5)
    for name in (STATE, ACTION):
        own = recording.episodes[2][name]
        own[:, 5] = own[0, 5] + rng.normal(0, 0.2, len(own))
    assert not found(recording, tmp_path / "dataset", "unit")
