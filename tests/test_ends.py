"""Is a joint that was cut off at an end of its range told from one that rests there?"""

import numpy as np
import pytest
from arms import ACTION, STATE, Recording, make
from test_scales import found


def cut(recording: Recording, column: int, episodes: range, quantile: float, low: bool) -> float:
    """Cut state and action alike at one value."""
    limit = np.float32(np.quantile(np.concatenate([own[STATE][:, column] for own in recording.episodes]), quantile))
    for number in episodes:
        for name in (STATE, ACTION):
            values = recording.episodes[number][name]
            values[:, column] = (np.maximum if low else np.minimum)(values[:, column], limit)
    return float(limit)


@pytest.mark.parametrize(
    ("robot", "column", "quantile", "low", "half"),
    [("so101", 1, 0.7, False, False), ("aloha", 2, 0.25, True, False), ("koch", 1, 0.7, False, True)],
)
def test_a_joint_that_is_cut_with_its_command_is_named(robot, column, quantile, low, half, tmp_path):
    recording = make(robot, 0)
    label = recording.names[STATE][column]
    assert not [each for each in found(recording, tmp_path / "right", "clipped") if "others move" in each.found]
    n = len(recording.episodes)
    limit = cut(recording, column, range(n // 2 * half, n), quantile, low)
    [finding] = [each for each in found(recording, tmp_path / "dataset", "clipped") if "others move" in each.found]
    assert (finding.severity, f"{STATE}[{label}] in" in finding.field) == ("note", True)
    assert finding.found.startswith(f"{limit:.4g} at")
    assert set(finding.episodes) <= set(range(n // 2 * half, n))


def test_a_gripper_that_closes_and_a_joint_that_waits_are_not_cut(tmp_path):
    recording = make("so101", 0)
    cut(recording, 5, range(len(recording.episodes)), 0.3, low=True)
    for own in recording.episodes:
        for name in (STATE, ACTION):
            own[name] = np.concatenate([own[name], np.repeat(own[name][-1:], 60, axis=0)])  # all rest at its end
            own[name][-60:, 1] = 200
        for name in own.keys() - {STATE, ACTION}:
            own[name] = np.concatenate([own[name], np.repeat(own[name][-1:], 60, axis=0)])
    assert not [each for each in found(recording, tmp_path / "dataset", "clipped") if "others move" in each.found]


def test_a_joint_that_is_not_used_but_for_a_tick_is_not_cut(tmp_path):
    recording, rng = make("so101", 0), np.random.default_rng(0)
    for own in recording.episodes:
        for name in (STATE, ACTION):
            own[name][:, 4] = rng.integers(0, 3, len(own[name])) * np.float32(0.088)
    assert not found(recording, tmp_path / "dataset", "clipped")
