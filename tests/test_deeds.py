"""Does what an episode says agree with what it does? And copies of which only a half is the same."""

import re
from dataclasses import replace

import numpy as np
import pytest
from arms import ACTION, POS, STATE, TASK, Operator, Recording, make, so101, write
from healthy import LEFT_BOX, RIGHT_BOX, write_healthy
from test_scales import found

import z2r
from z2r.audits.motion import parted
from z2r.data import find_dataset
from z2r.reading.verdict import read_verdict

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


def run_on(recording: Recording, episode: int, *, and_rest: bool = False) -> None:
    """Go back the way that an episode came, or stay where it ended for as long."""
    own = recording.episodes[episode]
    for name in own:
        more = np.repeat(own[name][-1:], len(own[name]), axis=0) if and_rest else own[name][::-1]
        own[name] = np.concatenate([own[name], more])


@pytest.mark.parametrize(("and_rest", "named"), [(False, {(4,)}), (True, set())])
def test_an_episode_that_undoes_what_it_did_is_named_and_one_that_only_waits_is_not(and_rest, named, tmp_path):
    recording = make("so101", 0)
    assert not found(recording, tmp_path / "right", "long-episode")
    run_on(recording, 4, and_rest=and_rest)
    said = found(recording, tmp_path / "dataset", "long-episode")
    assert {finding.episodes for finding in said} == named
    assert all("2.0 times as much motion" in finding.found for finding in said)


def two_arms() -> Recording:
    """The left arm takes a thing, and the right one waits and then turns."""
    recording, rng = so101(0), np.random.default_rng(0)
    for own in recording.episodes:
        for name in (STATE, ACTION):
            turns = 30 * np.linspace(0, 1, len(own[name]))[:, None] ** 4 + rng.uniform(-2, 2, 6)
            own[name] = np.concatenate([own[name], turns.astype(np.float32)], axis=1)
    names = tuple(f"{side}_{name}" for side in ("left", "right") for name in POS)
    recording.names.update({STATE: names, ACTION: names})
    return recording


def test_an_episode_with_left_and_right_exchanged_is_named(tmp_path):
    recording = two_arms()
    assert not found(recording, tmp_path / "right", "left-right")
    for name in (STATE, ACTION):
        recording.episodes[3][name] = np.roll(recording.episodes[3][name], 6, axis=1)
    [finding] = found(recording, tmp_path / "dataset", "left-right")
    assert (finding.severity, finding.episodes) == ("note", (3,))
    assert "once left and right are exchanged" in finding.found


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


def lose_on_the_way(recording: Recording, episode: int) -> None:
    """Let the gripper close on nothing after a third of the time in which something holds it back."""
    own = recording.episodes[episode]
    held = np.flatnonzero(own[STATE][:, GRIPPER] - own[ACTION][:, GRIPPER] > 5)
    closed = slice(held[len(held) // 3], held[-1])
    own[STATE][closed, GRIPPER] = own[ACTION][closed, GRIPPER] + 0.1


@pytest.mark.parametrize("says_so", [False, True])
def test_what_a_gripper_loses_on_the_way_is_named_and_a_label_that_denies_it(says_so, tmp_path):
    recording = make("scored" if says_so else "so101", 0)
    assert not found(recording, tmp_path / "right", "grasp")
    lose_on_the_way(recording, 2)
    [finding] = found(recording, tmp_path / "dataset", "grasp")
    assert f"{STATE}[{POS[GRIPPER]}] in episode 2" in finding.field
    assert "nothing any more that holds it back" in finding.found
    assert ("next.success comes all the same" in finding.found) == says_so
    assert (finding.severity, finding.episodes) == ("note", (2,))


def test_a_gripper_that_stays_shut_when_it_is_told_to_open_is_named(tmp_path):
    recording = make("so101", 0)
    own = recording.episodes[2]
    held = np.flatnonzero(own[STATE][:, GRIPPER] - own[ACTION][:, GRIPPER] > 5)
    shut = own[STATE][held[len(held) // 3], GRIPPER]
    own[STATE][held[len(held) // 3] :, GRIPPER] = shut
    [finding] = found(recording, tmp_path / "dataset", "grasp")
    assert f"{STATE}[{POS[GRIPPER]}] in episode 2" in finding.field
    assert finding.found == f"{shut:.3g} ever since it closed, although it is told to open"
    assert (finding.severity, finding.episodes) == ("note", (2,))


def test_an_episode_in_which_the_arm_lost_the_cube_is_a_failure_by_the_simulator():
    root = find_dataset("arm")
    lost = [number for each in z2r.audit(root).findings if each.check == "grasp" for number in each.episodes]
    verdict = read_verdict(root)
    assert lost == [4, 12]  # as the README says
    assert not any(verdict.episodes[number].success for number in lost)


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


@pytest.mark.parametrize("episodes", [(5,), range(12)])
@pytest.mark.parametrize(
    ("reward", "said"),
    [
        (lambda n: np.arange(n) < n // 5, "1 in the first frame and 0 in the end"),
        (lambda n: np.ones(n), "1 in every frame"),
        (lambda n: np.arange(n) < n - 1, ""),  # a penalty in the end
        (lambda n: np.where(np.arange(n) < n // 5, 0, -1), ""),
    ],
)
def test_a_reward_before_anything_was_done_is_named(reward, said, episodes, tmp_path):
    recording = make("scored", 0)
    for number, own in enumerate(recording.episodes):
        n = len(own[TASK])
        lowest = min(reward(n).min(), 0)
        own["next.reward"] = (reward(n) if number in episodes else np.full(n, lowest)).astype(np.float32)
        if said:
            own["next.reward"][-1] += number not in episodes
        del own["next.success"]
    findings = [each for each in found(recording, tmp_path / "dataset", "label-moment") if "next.reward" in each.field]
    everywhere = "every frame" in said and len(episodes) > 1  # which `label-constant` says
    assert [(each.found, each.episodes) for each in findings] == [(said, tuple(episodes))] * bool(
        said and not everywhere
    )


@pytest.mark.parametrize(
    ("change", "named"), [(lambda asked: asked[:, ::-1], True), (np.negative, False)], ids=["exchanged", "inverted"]
)
def test_two_joints_that_go_against_each_other_are_exchanged_where_each_follows_the_other(change, named, tmp_path):
    recording, rng = make("so101", 0), np.random.default_rng(0)
    for own in recording.episodes:
        lift, elbow = 1, 2
        for name in (STATE, ACTION):
            own[name][:, elbow] = -own[name][:, lift] + 0.2 * own[name][:, 0]
        own[STATE][:, [lift, elbow]] += rng.normal(0, 0.1, (len(own[STATE]), 2))
        own[ACTION][:, [lift, elbow]] = change(own[ACTION][:, [lift, elbow]])
    said = [each for each in found(recording, tmp_path / "dataset", "joint-order") if "and the reverse" in each.found]
    assert [POS[1] in each.field and POS[2] in each.found for each in said] == [True] * named


def end_half_way(recording: Recording, *episodes: int) -> Recording:
    for episode in episodes:
        for name in (STATE, ACTION):
            own = recording.episodes[episode][name]
            own[-5:, 1] = 80  # beyond where any ends
    return recording


def test_of_two_places_in_which_many_succeed_none_is_odd(tmp_path):
    recording = end_half_way(make("scored", 0), 1, 4, 6, 9)
    assert not found(recording, tmp_path / "dataset", "label-moment")


def test_a_success_elsewhere_is_named_by_where(tmp_path):
    recording = end_half_way(make("scored", 0), 5)
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


@pytest.mark.parametrize(("n", "n_said"), [(4, 4), (5, 3), (6, 2), (8, 0)])
def test_it_is_said_where_there_are_too_few_episodes_for_demonstrations_grips_kinds_and_labels(n, n_said, tmp_path):
    recording, rng = make("scored", 0), np.random.default_rng(0)
    recording = replace(recording, names=recording.names | {IMU: ("ax",)})
    del recording.episodes[n:]
    for own in recording.episodes:
        own[IMU] = rng.normal(size=(len(own[TASK]), 1))
    write(recording, tmp_path / "dataset")
    few = [each for each in z2r.audit(tmp_path / "dataset").not_checked if ": there are fewer than" in each]
    told = ("is one demonstration", "what a gripper holds", "means the same in all", "comes where it does")
    assert sum(what in each for each in few for what in told) == n_said


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


@pytest.mark.parametrize("name", [STATE, ACTION])
@pytest.mark.parametrize("episodes", [(2, 3), range(12)])
def test_what_goes_by_steps_while_the_other_moves_is_named(episodes, name, tmp_path):
    recording = make("so101", 0)
    assert not found(recording, tmp_path / "right", "repeat")
    for episode in episodes:
        own = recording.episodes[episode][name]
        own[:] = np.repeat(own[::8], 8, axis=0)[: len(own)]
    [finding] = found(recording, tmp_path / "dataset", "repeat")
    assert re.match(r"a new value in \d+% of the frames, while", finding.found)
    assert (finding.severity, finding.episodes, finding.field[: len(name)]) == ("note", tuple(episodes), name)


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


@pytest.mark.parametrize("episodes", [(2,), (1, 2, 5, 6, 7, 9)])
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
    """What turns about one axis shakes in other columns than what turns about another."""
    recording, rng = make("so101", 0), np.random.default_rng(0)
    names = recording.names | {STATE: [*POS, "qx", "qy", "qz", "qw"]}
    for number, own in enumerate(recording.episodes):
        n = len(own[TASK])
        lies = np.linspace(0.1, 0.4, n) + rng.normal(0, 0.004, n)
        x = 0.05 * np.sin(np.arange(n) / 20) + rng.normal(0, 0.003 if number in (2, 7) else 0.0004, n)
        turn = np.stack([x, np.sin(lies), 0 * lies, np.cos(lies)], axis=1)
        own[STATE] = np.concatenate([own[STATE], turn / np.linalg.norm(turn, axis=1, keepdims=True)], axis=1)
    assert not found(replace(recording, names=names), tmp_path / "dataset", "noise")


@pytest.mark.parametrize(
    ("episodes", "said"), [((1, 3, 4), (1, 3, 4)), ((0, 2, 5, 6, 7, 9), ()), ((4,), None), ((), None)]
)
def test_a_column_of_two_kinds_is_a_note(episodes, said, tmp_path):
    recording, rng = make("so101", 0), np.random.default_rng(0)
    recording = replace(recording, names=recording.names | {IMU: ("ax", "ay", "az")})
    for number, own in enumerate(recording.episodes):
        own[IMU] = rng.normal((0.1, 0, 9.81), 0.3, (len(own[TASK]), 3))
        own[IMU][:, 1:] -= (5, 9.81) if number in episodes else (0, 0)
    findings = found(recording, tmp_path / "dataset", "two-kinds")
    assert [(each.severity, each.episodes) for each in findings] == ([] if said is None else [("note", said)])
    if said:
        assert f"{IMU}[az], {IMU}[ay] in episodes 1, 3, 4" in findings[0].field
        assert "9.8" in findings[0].expected


@pytest.mark.parametrize("feature", [IMU, STATE])
@pytest.mark.parametrize(
    ("lost", "moves", "named"), [((0, 1, 2, 3), 1.0, True), (range(5, 12), 1.0, True), ((0, 1, 2, 3), 0.3, False)]
)
def test_a_sensor_that_is_lost_in_many_episodes_is_named(feature, lost, moves, named, tmp_path):
    """Not one that often rests where it is not lost, as what is pushed or gripped does."""
    recording, rng = make("so101", 0), np.random.default_rng(0)
    names = [*recording.names.get(feature, ()), "range"]
    recording = replace(recording, names=recording.names | {feature: names})
    for number, own in enumerate(recording.episodes):
        n = len(own[TASK])
        seen = np.cumsum(rng.normal(0, 0.1, n) * (rng.random(n) < moves)) if number not in lost else np.full(n, 4.0)
        own[feature] = np.column_stack([*own.get(feature, np.empty((n, 0))).T, seen])
    findings = [each for each in found(recording, tmp_path / "dataset", "frozen") if "range" in each.field]
    assert [(each.severity, each.episodes) for each in findings] == [("note", tuple(lost))] * named
    assert all("4 in all frames" in each.found for each in findings)


@pytest.mark.parametrize(("told", "named"), [(True, False), (False, True)])
def test_a_joint_that_is_told_to_rest_in_many_episodes_is_not_lost(told, named, tmp_path):
    recording, rng = make("so101", 0), np.random.default_rng(0)
    for number, own in enumerate(recording.episodes):
        own[STATE][:, 4] = (own[STATE][:, 4] + rng.normal(0, 0.2, len(own[STATE]))) * (number > 5)
        own[ACTION][:, 4] *= number > 5 or not told
    findings = [each for each in found(recording, tmp_path / "dataset", "frozen") if POS[4] in each.field]
    assert [each.episodes for each in findings] == [tuple(range(6))] * named


def test_two_kinds_that_the_tasks_explain_are_none(tmp_path):
    recording, rng = boxes(), np.random.default_rng(0)
    recording = replace(recording, names=recording.names | {IMU: ("weight",)})
    for own in recording.episodes:
        own[IMU] = rng.normal(9 * own[TASK][0], 0.3, (len(own[TASK]), 1))
    assert not found(recording, tmp_path / "dataset", "two-kinds")


def test_a_state_that_echoes_its_command_is_a_note(tmp_path):
    recording = make("so101", 0)
    for own in recording.episodes:
        own[STATE][1:] = own[ACTION][:-1]
    [finding] = found(recording, tmp_path / "dataset", "echo")
    assert (finding.severity, finding.field) == ("note", STATE)
    assert "the action of the frame before, bit for bit, in 100%" in finding.found


@pytest.mark.parametrize("episodes", [(3,), range(12)])
def test_commands_on_a_coarse_grid_are_named(episodes, tmp_path):
    recording = make("so101", 0)
    for episode in episodes:
        own = recording.episodes[episode]
        own[ACTION][:, :3] = np.round(own[ACTION][:, :3] / 3.5) * 3.5
    [finding] = found(recording, tmp_path / "dataset", "resolution")
    assert (finding.severity, finding.episodes) == ("note", tuple(episodes))
    assert "multiples of 3.5" in finding.found


@pytest.mark.parametrize(("by", "named"), [(12, True), (0, False)])
def test_a_gripper_that_goes_before_it_is_told_is_named(by, named, tmp_path):
    recording = make("so101", 0)
    for own in recording.episodes:
        asked, seen = own[ACTION][:, GRIPPER], own[STATE][:, GRIPPER]
        seen[:] = np.maximum(seen, np.quantile(seen, 0.6))  # held back by what it grips
        asked[by:] = asked[: len(asked) - by].copy()
    said = found(recording, tmp_path / "dataset", "late")
    told = [each for each in said if "as of the other joints" in each.expected]
    assert [f"action[{POS[GRIPPER]}]" in each.field and len(each.episodes) > 4 for each in told] == [True] * named


@pytest.mark.parametrize(("play", "named"), [(12.0, True), (0.5, False)])
def test_a_joint_with_play_in_some_episodes_is_named(play, named, tmp_path):
    recording = make("so101", 0)
    for episode in (2, 5, 6):
        state = recording.episodes[episode][STATE][:, 1]
        held = state[0]
        for frame, free in enumerate(state.tolist()):
            held = state[frame] = min(max(held, free - play / 2), free + play / 2)
    said = found(recording, tmp_path / "dataset", "play")
    assert [(each.severity, each.episodes) for each in said] == [("note", (2, 5, 6))] * named


def test_an_angle_that_goes_on_at_the_other_end_has_no_play(tmp_path):
    write_healthy("turning", tmp_path / "dataset")
    assert "play" not in {each.check for each in z2r.audit(tmp_path / "dataset").findings}


@pytest.mark.parametrize(("stands", "named"), [(12.0, True), (0.0, False)])
def test_a_joint_that_sticks_and_slips_is_named(stands, named, tmp_path):
    recording = make("so101", 0)
    for episode in (2, 5):
        state = recording.episodes[episode][STATE][:, 1]
        for frame in range(1, len(state)):
            if abs(state[frame] - state[frame - 1]) < stands:
                state[frame] = state[frame - 1]
    said = found(recording, tmp_path / "dataset", "stick")
    assert [(each.severity, each.episodes) for each in said] == [("note", (2, 5))] * named


@pytest.mark.parametrize(
    ("kind", "named"), [("so101_follower", True), ("bi_so101_follower", False), ("aloha", False), ("other", False)]
)
def test_a_robot_with_too_few_arms_is_a_note(kind, named, tmp_path):
    recording = make("so101", 0)
    names = [f"{side}_{joint}" for side in ("left", "right") for joint in ("waist", "elbow", "gripper")]
    both = replace(recording, names=recording.names | {STATE: names, ACTION: names}, info={"robot_type": kind})
    assert [each.severity for each in found(both, tmp_path / "dataset", "robot-type")] == ["note"] * named


@pytest.mark.parametrize(("kind", "named"), [("so101_follower", False), ("aloha", True), ("bi_koch", True)])
def test_a_robot_with_too_many_arms_is_a_note(kind, named, tmp_path):
    recording = replace(make("so101", 0), info={"robot_type": kind})
    assert [each.severity for each in found(recording, tmp_path / "dataset", "robot-type")] == ["note"] * named


@pytest.mark.parametrize(("turned", "named"), [((), False), ((1, 2, 6), True)])
def test_a_speed_is_held_against_the_speed_of_its_name(turned, named, tmp_path):
    recording = make("so101", 0)
    names = ["x", "y", "vx", "vy"]
    for number, own in enumerate(recording.episodes):
        speeds = 0.01 * own[STATE][:, :2]
        own[ACTION] = 0.01 * own[ACTION][:, :2] * (-1 if number in turned else 1)
        own[STATE] = np.concatenate([np.cumsum(speeds, axis=0) / 30, speeds], axis=1)
    base = replace(recording, names=recording.names | {STATE: names, ACTION: ["vx_cmd", "vy_cmd"]})
    said = [each for each in found(base, tmp_path / "dataset", "unit") if each.severity == "warning"]
    assert any("vx" in each.found and each.episodes == turned for each in said) == named
