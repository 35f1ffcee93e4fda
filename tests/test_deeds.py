"""Does what an episode says agree with what it does? And copies of which only a half is the same."""

from dataclasses import replace

import numpy as np
import pytest
from arms import ACTION, POS, STATE, TASK, Operator, Recording, make, so101, write
from healthy import LEFT_BOX, RIGHT_BOX
from test_scales import found

import z2r
from z2r.audits.motion import parted

GRIPPER = 5
IMU = "observation.imu"


def boxes(n: int = 12) -> Recording:
    """Two tasks that mirror each other, in turn."""
    return so101(0, n=n, tasks=(LEFT_BOX, RIGHT_BOX))


@pytest.mark.parametrize("episode", [0, 5])
def test_an_episode_with_the_text_of_another_task_is_named(episode, tmp_path):
    recording = boxes()
    assert not found(recording, tmp_path / "right", "task-motion")
    own = recording.episodes[episode]
    own[TASK] = 1 - own[TASK]
    [finding] = found(recording, tmp_path / "dataset", "task-motion")
    assert (finding.severity, finding.episodes) == ("note", (episode,))
    said, done = (recording.tasks[task] for task in (own[TASK][0], 1 - own[TASK][0]))
    assert (repr(said) in finding.found, repr(done) in finding.found) == (True, True)
    assert finding.found.index(said) < finding.found.index(done)


@pytest.mark.parametrize("seed", range(3))
def test_where_texts_say_nothing_of_the_motion_none_is_named(seed, tmp_path):
    """As where two texts say the same: then each is there by chance."""
    recording, rng = boxes(), np.random.default_rng(seed)
    for own, task in zip(recording.episodes, rng.permutation([0, 1] * 6), strict=True):
        own[TASK] = np.full(len(own[TASK]), task)
    assert not found(recording, tmp_path / "dataset", "task-motion")


def close_on_nothing(recording: Recording, episode: int) -> None:
    own = recording.episodes[episode]
    own[STATE][:, GRIPPER] = np.roll(own[ACTION][:, GRIPPER], 3) + 0.1


def test_a_gripper_that_closes_on_nothing_is_named(tmp_path):
    recording = make("so101", 0)
    assert not found(recording, tmp_path / "right", "grasp")
    close_on_nothing(recording, 4)
    [finding] = found(recording, tmp_path / "dataset", "grasp")
    assert f"{STATE}[{POS[GRIPPER]}] in episode 4" in finding.field
    assert (finding.severity, finding.episodes) == ("note", (4,))


def test_a_grip_that_was_tried_again_is_none_on_nothing(tmp_path):
    recording = so101(0, operator=Operator(retry=1))
    assert not found(recording, tmp_path / "dataset", "grasp")


def test_a_gripper_that_is_not_used_closes_on_nothing_and_is_not_named(tmp_path):
    recording = make("so101", 0)
    for name in (STATE, ACTION):
        recording.episodes[4][name][:, GRIPPER] = 3 + 0.1 * (name == STATE)
    assert not found(recording, tmp_path / "dataset", "grasp")


def early(recording: Recording, *episodes: int, by: int = 60) -> Recording:
    for episode in episodes:
        own = recording.episodes[episode]
        for name in ("next.reward", "next.success"):
            own[name] = own[name] | np.roll(own[name], -by) if own[name].dtype == bool else own[name]
        own["next.reward"] = own["next.success"].astype(np.float32)
    return recording


@pytest.mark.parametrize("episodes", [(5,), (0, 1, 5, 6)])
@pytest.mark.parametrize("without", ["", "next.success"])
def test_a_label_that_comes_too_soon_is_named(episodes, without, tmp_path):
    recording = make("scored", 0)
    assert not found(recording, tmp_path / "right", "label-moment")
    early(recording, *episodes)
    for own in recording.episodes:
        own.pop(without, None)
    [finding] = found(recording, tmp_path / "dataset", "label-moment")
    assert (finding.severity, finding.episodes) == ("note", episodes)
    assert ("next.success" if not without else "next.reward") in finding.field
    assert (finding.found, finding.expected[:8]) == ("what comes first 65 frames before the end", "it about")
    assert "5 frames before the end" in finding.expected
    assert ("nobody knows which of them are right" in finding.mend) == (len(episodes) > 1)


def test_a_success_elsewhere_is_named_by_where(tmp_path):
    recording = make("scored", 0)
    for name in (STATE, ACTION):
        own = recording.episodes[5][name]
        own[-5:, 1] = own[:-5, 1].max()  # as if it had ended half way
    [finding] = found(recording, tmp_path / "dataset", "label-moment")
    assert finding.episodes == (5,)
    assert f"where {STATE}[{POS[1]}] is" in finding.found


def test_a_reward_of_many_levels_comes_at_no_moment(tmp_path):
    recording = early(make("scored", 0), 5)
    for own in recording.episodes:
        del own["next.success"]
        own["next.reward"] = own["next.reward"] * np.linspace(0, 1, len(own["next.reward"]), dtype=np.float32)
    assert not found(recording, tmp_path / "dataset", "label-moment")


def test_the_largest_gap_parts_values():
    few, gap, spread = parted(np.array([5.0, 1, 1.5, 0.5, 5.25]))
    assert (sorted(few.tolist()), gap, spread) == ([0, 4], 3.5, 1.0)


# --- copies


def copy_of(recording: Recording, source: int, *features: str) -> Recording:
    """Give the last episode these features of another one; the rest of it is cut or held to the same length."""
    own, other = recording.episodes[-1], recording.episodes[source]
    rows = np.minimum(np.arange(len(other[TASK])), len(own[TASK]) - 1)
    recording.episodes[-1] = {
        name: (other if name in features else own)[name][rows if name not in features else slice(None)] for name in own
    }
    return recording


@pytest.mark.parametrize(("name", "other", "severity"), [(STATE, ACTION, "warning"), (ACTION, STATE, "note")])
def test_a_copy_of_one_half_of_an_episode_says_which(name, other, severity, tmp_path):
    recording = copy_of(make("so101", 0), 2, name)
    last = len(recording.episodes) - 1
    [finding] = found(recording, tmp_path / "dataset", "twin")
    assert (finding.severity, finding.episodes) == (severity, (last,))
    assert finding.found == f"{name} of episode 2 again, frame for frame, with another {other}"


def test_of_a_whole_copy_no_half_is_named(tmp_path):
    recording = copy_of(make("so101", 0), 2, STATE, ACTION, TASK)
    [finding] = found(recording, tmp_path / "dataset", "twin")
    assert "episode 2 again, frame for frame" in finding.found


@pytest.mark.parametrize("times", [0.8, 1.25])
def test_a_copy_at_another_speed_is_named(times, tmp_path):
    recording = make("so101", 0)
    assert not found(recording, tmp_path / "right", "near-twin")
    own = recording.episodes[3]
    frames = np.arange(int(len(own[TASK]) * times)) / times
    when = np.arange(len(own[TASK]))
    stretched = {
        name: np.stack([np.interp(frames, when, column) for column in own[name].T], axis=1) for name in (STATE, ACTION)
    }
    recording.episodes.append(stretched | {TASK: np.full(len(frames), own[TASK][0])})
    [finding] = found(recording, tmp_path / "dataset", "near-twin")
    assert f"nearly episode 3 again: {times:.2f} times as long" in finding.found


# --- what a joint does and its command does not


def test_a_horn_that_slips_is_named_and_a_gripper_that_is_let_go_is_not(tmp_path):
    recording = make("so101", 0)
    assert not found(recording, tmp_path / "right", "discontinuity")
    for column in (2, GRIPPER):
        own = recording.episodes[3][STATE]
        own[len(own) // 2 :, column] -= 0.3 * np.ptp(own[:, column])
    said = found(recording, tmp_path / "dataset", "discontinuity")
    told = [each for each in said if "than" in each.expected or "of its command" in each.expected]
    assert [(each.severity, each.episodes) for each in told] == [("note", (3,))]
    assert POS[2] in told[0].field


@pytest.mark.parametrize(("name", "severity"), [(STATE, "warning"), (ACTION, "note")])
def test_samples_that_are_off_in_all_episodes_are_named(name, severity, tmp_path):
    recording = make("so101", 0)
    for own in recording.episodes:
        own[name][7::20, 1] += 60
    said = [each for each in found(recording, tmp_path / "dataset", "jump") if "steps like those of" in each.expected]
    assert [(each.severity, len(each.episodes)) for each in said] == [(severity, len(recording.episodes))]
    assert f"{name}[{POS[1]}]" in said[0].field


def test_noise_of_a_joint_that_hardly_moves_is_no_sample_that_is_off(tmp_path):
    recording, rng = make("so101", 0), np.random.default_rng(0)
    for own in recording.episodes:
        for name in (STATE, ACTION):
            own[name][:, 1] = 0.01 * own[name][:, 1]
        own[STATE][:, 1] += rng.normal(0, 0.05, len(own[TASK]))
    said = found(recording, tmp_path / "dataset", "jump")
    assert not [each for each in said if "steps like those of" in each.expected]


@pytest.mark.parametrize("episodes", [(3,), range(12)])
def test_whole_numbers_are_named(episodes, tmp_path):
    recording = make("so101", 0)
    assert not found(recording, tmp_path / "right", "resolution")
    for episode in episodes:
        recording.episodes[episode][STATE] = recording.episodes[episode][STATE].round()
    [finding] = found(recording, tmp_path / "dataset", "resolution")
    assert (finding.severity, finding.episodes) == ("note", tuple(episodes))


def test_commands_that_are_always_whole_numbers_may_be_keys(tmp_path):
    recording = make("so101", 0)
    for own in recording.episodes:
        own[ACTION] = own[ACTION].round()
    assert not found(recording, tmp_path / "dataset", "resolution")


def test_frames_that_came_in_bursts_are_named(tmp_path):
    recording, rng = make("so101", 0), np.random.default_rng(1)
    for episode, own in enumerate(recording.episodes):
        n = len(own[TASK])
        rows = np.clip(np.arange(n) + rng.integers(-2, 3, n), 0, n - 1)
        recording.episodes[episode] = {name: own[name][rows] for name in own}
    said = found(recording, tmp_path / "dataset", "repeat")
    assert [each.severity for each in said] == ["note"]
    assert "both the same as in the frame before" in said[0].found


@pytest.mark.parametrize("episodes", [(2,), (0, 2, 5, 6, 7, 9)])
def test_an_acceleration_in_g_is_named(episodes, tmp_path):
    recording, rng = make("so101", 0), np.random.default_rng(0)
    recording = replace(recording, names=recording.names | {IMU: ("ax", "ay", "az")})
    for own in recording.episodes:
        own[IMU] = rng.normal((0.1, 0, 9.81), 0.3, (len(own[TASK]), 3))
    assert not found(recording, tmp_path / "right", "unit")
    for episode in episodes:
        recording.episodes[episode][IMU] /= 9.81
    [finding] = found(recording, tmp_path / "dataset", "unit")
    assert (f"{IMU}[az]" in finding.field, finding.severity, finding.episodes) == (True, "warning", episodes)


def test_a_split_without_an_episode_is_a_note(tmp_path):
    write(replace(make("so101", 0), info={"splits": {"train": "0:12", "test": "12:12"}}), tmp_path / "dataset")
    [finding] = [each for each in z2r.audit(tmp_path / "dataset").findings if each.check == "splits"]
    assert (finding.severity, finding.field) == ("note", "splits.test")


@pytest.mark.parametrize(("by", "named"), [(30, False), (150, True)])
def test_a_gripper_that_springs_back_as_far_as_it_steps_lost_no_sample(by, named, tmp_path):
    recording, rng = make("so101", 0), np.random.default_rng(0)
    for number, own in enumerate(recording.episodes):
        n = len(own[TASK])
        own[STATE][:, GRIPPER] = np.where(np.arange(n) // 60 % 2, 80, 50) + rng.normal(0, 0.1, n)
        own[STATE][30, GRIPPER] -= by * (number in (1, 4, 6))
    said = [each for each in found(recording, tmp_path / "dataset", "jump") if "its usual step" in each.found]
    assert bool(said) == named


def test_noise_of_one_column_of_a_quaternion_is_how_it_lies(tmp_path):
    """Where it is nearly unturned, the columns that are near 0 have all the noise, and the one near 1 has none."""
    recording, rng = make("so101", 0), np.random.default_rng(0)
    names = recording.names | {STATE: [*POS, "qx", "qy", "qz", "qw"]}
    for number, own in enumerate(recording.episodes):
        n = len(own[TASK])
        lies = np.linspace(0, 0.4, n) * (1 + number) / len(recording.episodes) + rng.normal(0, 0.004, n)
        shakes = np.sin(0.02 + 0.4 * number) * rng.normal(0, 0.004, n)
        turn = np.stack([shakes, np.sin(lies), 0 * lies, np.cos(lies)], axis=1)
        own[STATE] = np.concatenate([own[STATE], turn / np.linalg.norm(turn, axis=1, keepdims=True)], axis=1)
    assert not found(replace(recording, names=names), tmp_path / "dataset", "noise")
