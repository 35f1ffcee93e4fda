"""Every break mode against a plain loop that makes the same mistake, on a dataset of many files and shards."""

import math
import re
from collections.abc import Callable
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from hypothesis import given
from hypothesis import strategies as st
from layouts import BOOKKEEPING, Layout, restate, write_dataset
from msgspec.structs import replace
from robots import JOINTS, write_arm, write_hand
from test_replay import read_rows, values

import z2r
from z2r import BREAK_MODES, PUSHT, EpisodeIndex, Reading
from z2r.arrays import reduce_parts
from z2r.audits import audit as audits
from z2r.audits.frames import FileFrames
from z2r.check import Check, Part
from z2r.course.damage import split
from z2r.reading.poses import QuaternionColumns
from z2r.reading.reading import ColumnMeaning


@pytest.fixture(scope="module")
def dataset(tmp_path_factory: pytest.TempPathFactory) -> z2r.Dataset:
    """`messy` in three shards, with a data file for each of its 14 episodes, named without zeros before the number."""
    root = tmp_path_factory.mktemp("split") / "dataset"
    split(z2r.MESSY, root)
    return z2r.load(root)


@pytest.fixture(scope="module")
def right(dataset: z2r.Dataset) -> z2r.Inspection:
    return z2r.inspect_dataset(dataset)


def wrong(dataset: z2r.Dataset, mode: str) -> z2r.Inspection:
    return z2r.inspect_dataset(dataset, z2r.break_mode(mode))


def errors_of(state: np.ndarray, reading: z2r.Reading, dataset: z2r.Dataset) -> z2r.FrameErrors:
    return z2r.frame_errors(z2r.decode(state, reading, dataset.schema))


def reached_in(dataset: z2r.Dataset, frames: list[int], reading: z2r.Reading = PUSHT) -> list[bool]:
    return z2r.in_tolerance(errors_of(dataset.read("observation.state")[frames], reading, dataset), reading).tolist()


def test_inclusive_end_decides_in_the_first_frame_of_the_next_episode(dataset, right):
    found = wrong(dataset, "inclusive-end")
    assert found.episodes.lengths.tolist() == [*(right.episodes.lengths[:-1] + 1), right.episodes.lengths[-1]]
    ends = right.episodes.to_index.tolist()
    assert found.outcome.reached.tolist() == reached_in(dataset, [*ends[:-1], ends[-1] - 1])


def test_first_shard_only_loses_the_episodes_of_the_others(dataset, right):
    found = wrong(dataset, "first-shard-only")
    [first, *_] = sorted(dataset.root.glob("meta/episodes/*/*.parquet"))
    n_episodes = pq.read_metadata(first).num_rows
    assert len(found.episodes) == n_episodes < len(right.episodes)
    assert found.outcome.reached.tolist() == right.outcome.reached[:n_episodes].tolist()


def test_a_stale_pointer_loses_the_first_episode_of_every_file_but_the_first(recorded):
    dataset = z2r.load(recorded)
    right, found = z2r.inspect_dataset(dataset), wrong(dataset, "stale-file-pointer")
    begins = {file.from_index for file in dataset.files[1:]}
    kept = [i for i, start in enumerate(right.episodes.from_index.tolist()) if start not in begins]
    assert 1 < len(kept) < len(right.episodes)
    assert [found.episodes.number(i) for i in range(len(found.episodes))] == kept
    assert found.outcome.reached.tolist() == right.outcome.reached[kept].tolist()


def test_files_sorted_by_name_give_frames_to_the_wrong_episodes(dataset, right):
    found = wrong(dataset, "name-sorted-files")
    assert found.episodes.lengths.tolist() == right.episodes.lengths.tolist()
    files = sorted(dataset.root.glob("data/*/*.parquet"), key=str)
    numbers = [int(re.findall(r"\d+", file.name)[0]) for file in files]
    order = np.concatenate([np.arange(dataset.episodes[i].start, dataset.episodes[i].stop) for i in numbers])
    assert not np.array_equal(order, np.arange(len(order)))
    last_frames = order[right.episodes.to_index - 1]
    assert found.outcome.reached.tolist() == reached_in(dataset, last_frames.tolist())


def test_the_first_frame_for_the_last_asks_the_first(dataset, right):
    found = wrong(dataset, "first-frame-for-last").outcome
    assert found.reached.tolist() == reached_in(dataset, right.episodes.from_index.tolist())
    first = dataset.read("observation.state")[right.episodes.from_index].astype(float)
    np.testing.assert_allclose(found.final_errors["pos_err"], np.hypot(first[:, 2], first[:, 3]), atol=1e-6)


def test_the_wrong_reference_point_measures_from_the_pusher(dataset, right):
    last = dataset.read("observation.state")[right.episodes.to_index - 1].astype(float)
    found = wrong(dataset, "wrong-reference-point").outcome
    np.testing.assert_allclose(found.final_errors["pos_err"], np.hypot(last[:, 0], last[:, 1]), atol=1e-6)
    np.testing.assert_array_equal(found.final_errors["ang_err"], right.outcome.final_errors["ang_err"])


def test_degrees_for_radians_leave_a_tolerance_that_is_57_times_smaller(dataset, right):
    found = wrong(dataset, "degrees-for-radians").outcome
    fine = (right.outcome.final_errors["pos_err"] < 0.03) & (np.rad2deg(right.outcome.final_errors["ang_err"]) < 0.2)
    assert found.reached.tolist() == fine.tolist()
    np.testing.assert_array_equal(found.final_errors["ang_err"], right.outcome.final_errors["ang_err"])


@pytest.mark.parametrize("mode", ["no-wrap", "wrong-fps", "action-lag"])
def test_some_modes_leave_the_outcome_as_it_is(dataset, right, mode):
    found = wrong(dataset, mode)
    assert found.outcome.reached.tolist() == right.outcome.reached.tolist()
    np.testing.assert_allclose(found.outcome.final_errors["ang_err"], right.outcome.final_errors["ang_err"], atol=1e-12)


def test_the_wrong_fps_shortens_the_time(dataset):
    assert wrong(dataset, "wrong-fps").schema.fps == 3 * dataset.schema.fps


def test_an_error_that_is_not_wrapped_shows_from_the_other_side_of_the_table(dataset):
    """Turning the table by half a turn changes the sign of all ten numbers, and no error that is wrapped."""
    state = dataset.read("observation.state")
    unwrapped = z2r.break_mode("no-wrap").reading(PUSHT)
    for table, reading, turned in ((state, unwrapped, False), (-state, PUSHT, False), (-state, unwrapped, True)):
        difference = errors_of(table, reading, dataset)["ang_err"] - errors_of(state, PUSHT, dataset)["ang_err"]
        assert (np.abs(difference).max() > 3) == turned


@pytest.mark.parametrize("mode", BREAK_MODES)
def test_the_picture_is_that_of_the_frames_in_the_order_of_the_wrong_reading(dataset, mode, tmp_path):
    """Which frames, in which order: the pusher's x is stored as it is drawn."""
    believed, _ = z2r.break_mode(mode).believe(dataset, PUSHT)
    z2r.write_replay(believed, tmp_path / "x.rrd", PUSHT)
    drawn = values(read_rows(tmp_path / "x.rrd", "frame"), "world/robot/pusher", "Transform3D:translation").reshape(
        -1, 3
    )
    index = believed.episodes
    frames = np.concatenate(
        [np.arange(start, stop) for start, stop in zip(index.from_index, index.to_index, strict=True)]
    )
    np.testing.assert_allclose(drawn[:, 0], believed.read("observation.state")[frames, 0], atol=1e-6)


@pytest.mark.parametrize("mode", BREAK_MODES)
def test_no_mode_changes_the_dataset(dataset, mode):
    before = {path: path.read_bytes() for path in dataset.root.rglob("*") if path.is_file()}
    right_index, right_files = dataset.episodes, dataset.files
    believed, _ = z2r.break_mode(mode).believe(dataset, PUSHT)
    believed.read("observation.state")
    assert (dataset.episodes, dataset.files, dataset.misread) == (right_index, right_files, None)
    assert before == {path: path.read_bytes() for path in dataset.root.rglob("*") if path.is_file()}


ranges = st.lists(st.tuples(st.integers(0, 30), st.integers(1, 12)), min_size=1, max_size=8)


@given(ranges=ranges)
def test_frames_are_those_of_each_range_one_after_another(ranges):
    index = EpisodeIndex(np.array([start for start, _ in ranges]), np.array([start + n for start, n in ranges]))
    assert index.frame_numbers.tolist() == [frame for start, n in ranges for frame in range(start, start + n)]


@given(ranges=ranges, data=st.data())
def test_parts_may_overlap_and_leave_gaps(ranges, data):
    table = np.array(data.draw(st.lists(st.integers(-9, 9), min_size=30, max_size=30)))[:, None]
    spans = [(min(start, 29), min(start + n, 30)) for start, n in ranges]
    starts, stops = np.array(spans).T
    expected = [table[start:stop].min() for start, stop in spans]
    assert reduce_parts(np.minimum, table, starts, stops).ravel().tolist() == expected


@given(ranges=ranges)
def test_an_episode_that_is_kept_keeps_its_number(ranges):
    index = EpisodeIndex(np.array([start for start, _ in ranges]), np.array([start + n for start, n in ranges]))
    odd = np.arange(len(index)) % 2 == 1
    kept = index.only(odd)
    assert [kept.number(i) for i in range(len(kept))] == np.flatnonzero(odd).tolist()
    assert [kept.only(slice(1)).number(i) for i in range(min(1, len(kept)))] == [1][: len(kept)]


# --- what columns are taken for, on any robot

type Robot = tuple[z2r.Dataset, Reading]

STATE, ACTION = "observation.state", "action"
FLYER = ("x", "y", "z", "a", "b", "c", "d", "goal.x", "goal.y", "goal.z", "goal.a", "goal.b", "goal.c", "goal.d")
COLUMN_MODES = (
    "action-lag",
    "wrong-angle-unit",
    "joints-exchanged",
    "quaternion-order",
    "delta-for-absolute",
    "gripper-inverted",
)


@pytest.fixture(scope="module")
def arm(tmp_path_factory: pytest.TempPathFactory) -> Robot:
    return write_arm(tmp_path_factory.mktemp("arm"))


@pytest.fixture(scope="module")
def hand(tmp_path_factory: pytest.TempPathFactory) -> Robot:
    return write_hand(tmp_path_factory.mktemp("hand"))


@pytest.fixture(scope="module", params=["xyzw", "wxyz"])
def flyer(request, tmp_path_factory: pytest.TempPathFactory) -> Robot:
    """Something that flies, in two files: a pose in space and where it should be, no action."""
    rng = np.random.default_rng(5)
    state = rng.normal(size=(40, len(FLYER))).astype(np.float32)
    feature = {"dtype": "float32", "shape": [len(FLYER)], "names": list(FLYER)}
    root = tmp_path_factory.mktemp("flyer") / "data"
    write_dataset(root, {STATE: state}, [15, 25], Layout([1, 1], [2]), features={STATE: feature} | BOOKKEEPING)
    poses = {
        name: z2r.PoseColumns(
            *(f"{prefix}{axis}" for axis in "xyz"),
            quaternion=QuaternionColumns(**{request.param: tuple(f"{prefix}{part}" for part in "abcd")}),
        )
        for name, prefix in (("drone", ""), ("gate", "goal."))
    }
    goal = (z2r.Goal(name="slant", turn=("drone", "gate"), within=0.3),)
    return z2r.load(root), Reading(name="fly", poses=poses, goal=goal)


def taken(robot: Robot, mode: str, feature: str = STATE) -> tuple[np.ndarray, np.ndarray]:
    """A feature as it is stored, and as it is taken under a break mode."""
    dataset, reading = robot
    return dataset.read(feature), z2r.break_mode(mode).believe(dataset, reading)[0].read(feature)


def test_joints_that_are_exchanged_have_each_others_values(arm):
    stored, exchanged = taken(arm, "joints-exchanged")
    np.testing.assert_array_equal(exchanged, stored[:, [1, 0, 2, 3, 4, 5]])


@pytest.mark.parametrize(("unit", "factor"), [("", math.pi / 180), ("rad", math.pi / 180), ("deg", 180 / math.pi)])
def test_angles_in_the_other_unit_are_those_of_the_joints_and_not_of_the_gripper(arm, unit, factor):
    dataset, reading = arm
    meanings = reading.columns | {name: ColumnMeaning(unit=unit) for name in JOINTS[:5]}
    declared = Reading(name="d", columns=meanings, action=reading.action)
    stored, other = taken((dataset, declared), "wrong-angle-unit")
    np.testing.assert_allclose(other, stored * ([factor] * 5 + [1]), rtol=1e-6)


def test_a_joint_that_is_no_angle_has_no_unit_to_mistake(arm, hand):
    dataset, reading = arm
    lengths = reading.columns | {name: ColumnMeaning(unit="mm") for name in JOINTS[:5]}
    assert not z2r.break_mode("wrong-angle-unit").columns(dataset.schema, Reading(columns=lengths))
    stored, other = taken(hand, "wrong-angle-unit")
    np.testing.assert_allclose(other[:, 2], np.rad2deg(stored[:, 2].astype(float)), rtol=1e-6)  # a yaw in degrees
    np.testing.assert_array_equal(np.delete(other, 2, axis=1), np.delete(stored, 2, axis=1))  # m


def test_an_inverted_gripper_is_open_where_it_is_closed(arm):
    stored, inverted = taken(arm, "gripper-inverted")
    np.testing.assert_allclose(inverted[:, 5], 100 - stored[:, 5].astype(float), atol=1e-5)
    np.testing.assert_array_equal(inverted[:, :5], stored[:, :5])
    right, wrong = (z2r.inspect_dataset(arm[0], mode, arm[1]) for mode in (None, z2r.break_mode("gripper-inverted")))
    assert wrong.outcome.reached.tolist() == (~right.outcome.reached).tolist()


def test_a_quaternion_in_the_other_order_is_what_a_reading_of_that_order_decodes(flyer):
    dataset, reading = flyer
    stored = reading.poses["drone"].quaternion
    other = QuaternionColumns(wxyz=stored.xyzw) if stored.xyzw else QuaternionColumns(xyzw=stored.wxyz)
    believed, same = z2r.break_mode("quaternion-order").believe(dataset, reading)
    assert same == reading
    found = z2r.decode(believed.read(STATE), reading, dataset.schema)
    expected = z2r.decode(dataset.read(STATE), reading.with_pose("drone", quaternion=other), dataset.schema)
    for name in reading.poses:
        np.testing.assert_allclose(found.pose(name).quaternion, expected.pose(name).quaternion, rtol=1e-6)


def test_an_action_that_lags_is_that_of_the_next_frame_of_its_episode(dataset):
    stored, late = taken((dataset, PUSHT), "action-lag", ACTION)
    for episode in range(len(dataset.episodes)):
        own = stored[dataset.episodes[episode]]
        np.testing.assert_array_equal(late[dataset.episodes[episode]], np.concatenate([own[1:], own[-1:]]))


def test_a_reading_may_say_that_actions_are_stored_late_and_is_refuted_alike(dataset):
    late = replace(PUSHT, action=replace(PUSHT.action, lag=1))
    lags = z2r.break_mode("action-lag")
    assert z2r.audit(dataset, None, late).findings == z2r.audit(dataset, lags).findings != z2r.audit(dataset).findings


def test_changes_add_up_from_where_an_episode_begins(arm):
    dataset, _ = arm
    stored, targets = taken(arm, "delta-for-absolute", ACTION)
    for episode in range(len(dataset.episodes)):
        where = dataset.read(STATE)[dataset.episodes[episode]][0].astype(float)
        for change, target in zip(stored[dataset.episodes[episode]], targets[dataset.episodes[episode]], strict=True):
            where = where + change
            np.testing.assert_allclose(target, where, rtol=1e-5, atol=1e-3)


finite = st.floats(-1000, 1000, width=32)


@given(lengths=st.lists(st.integers(1, 6), min_size=1, max_size=5), data=st.data())
def test_of_real_changes_the_targets_are_right(arm, lengths, data):
    """Had an arm stored changes, who adds them up would be right."""
    n, index = sum(lengths), EpisodeIndex(np.cumsum(lengths) - lengths, np.cumsum(lengths))
    drawn = st.lists(st.lists(finite, min_size=6, max_size=6), min_size=n, max_size=n)
    state, targets = (np.array(data.draw(drawn)) for _ in range(2))
    before = np.roll(targets, 1, axis=0)
    before[index.from_index] = state[index.from_index]
    misread = z2r.break_mode("delta-for-absolute").misread(arm[0].schema, arm[1])
    found = misread({STATE: state, ACTION: targets - before}, 0, index)
    np.testing.assert_allclose(found[ACTION], targets, atol=1e-8)
    assert found[STATE] is state


@pytest.mark.parametrize("mode", ["joints-exchanged", "gripper-inverted"])
@given(rows=st.lists(st.lists(finite, min_size=6, max_size=6), min_size=1, max_size=9))
def test_a_belief_that_is_its_own_inverse_is_none_twice(arm, mode, rows):
    frames, index = (
        {STATE: np.array(rows), "other": np.ones((len(rows), 1))},
        EpisodeIndex(np.array([0]), np.array([9])),
    )
    misread = z2r.break_mode(mode).misread(arm[0].schema, arm[1])
    before = frames[STATE].copy()
    once = misread(frames, 0, index)
    np.testing.assert_allclose(misread(once, 0, index)[STATE], before, atol=1e-9)
    np.testing.assert_array_equal(frames[STATE], before)  # a copy is changed
    assert once["other"] is frames["other"]


def test_whole_numbers_need_not_be_taken_for_whole_numbers(arm):
    frames = {STATE: np.full((3, 6), 57)}
    misread = z2r.break_mode("wrong-angle-unit").misread(arm[0].schema, arm[1])
    found = misread(frames, 0, EpisodeIndex(np.array([0]), np.array([3])))[STATE]
    np.testing.assert_allclose(found[:, :5], np.deg2rad(57))
    assert misread({ACTION: frames[STATE]}, 0, EpisodeIndex(np.array([0]), np.array([3]))) == {ACTION: frames[STATE]}


APPLIES = {  # of the modes about columns
    "pusht": "action-lag joints-exchanged",
    "arm": "action-lag wrong-angle-unit joints-exchanged delta-for-absolute gripper-inverted",
    "arm without a reading": "action-lag wrong-angle-unit joints-exchanged",
    "arm with the reading of another robot": "action-lag wrong-angle-unit joints-exchanged",
    "hand": "action-lag wrong-angle-unit joints-exchanged delta-for-absolute",
    "flyer": "quaternion-order",
}


@pytest.mark.parametrize("name", APPLIES)
def test_a_mode_applies_where_a_dataset_has_what_it_is_about(name, dataset, arm, hand, flyer):
    robots = {"pusht": (dataset, PUSHT), "arm": arm, "hand": hand, "flyer": flyer}
    robots |= {"arm without a reading": (arm[0], None), "arm with the reading of another robot": (arm[0], PUSHT)}
    found, reading = robots[name]
    assert [mode for mode in COLUMN_MODES if BREAK_MODES[mode].applies_to(found, reading)] == APPLIES[name].split()
    for mode in COLUMN_MODES:
        believed, same = BREAK_MODES[mode].believe(found, reading)
        assert same == reading
        assert bool(BREAK_MODES[mode].columns(found.schema, reading)) == (mode in APPLIES[name].split())
        assert (believed is found) == (mode not in APPLIES[name].split())


def test_what_is_believed_of_files_applies_where_there_are_several(dataset, arm):
    files = ["drop-boundaries", "inclusive-end", "first-shard-only", "stale-file-pointer", "name-sorted-files"]
    assert all(BREAK_MODES[mode].applies_to(dataset, PUSHT) for mode in files)
    one = z2r.load("standin").first(1)
    assert not any(BREAK_MODES[mode].applies_to(one, PUSHT) for mode in files)
    assert all(mode.about for mode in BREAK_MODES.values() if mode.name != "wrong-fps")  # why it may not apply
    assert BREAK_MODES["wrong-fps"].applies_to(one, None)


def test_the_columns_of_a_mode_are_named_as_a_reading_names_them(arm, hand):
    assert z2r.break_mode("joints-exchanged").columns(arm[0].schema, arm[1]) == JOINTS[:2]
    assert z2r.break_mode("delta-for-absolute").columns(hand[0].schema, hand[1]) == ("action/go.x", "action/go.y")
    assert z2r.break_mode("yaw-swap").columns(hand[0].schema, hand[1]) == ()


def test_a_gripper_is_no_angle_and_the_one_of_the_action_is_not_of_the_state(arm):
    dataset, reading = arm
    assert z2r.break_mode("wrong-angle-unit").columns(dataset.schema, None) == JOINTS[:5]
    limits = {f"action/{JOINTS[5]}": ColumnMeaning(low=0, high=100), JOINTS[4]: ColumnMeaning(low=-180, high=180)}
    both = Reading(columns=reading.columns | limits)
    assert z2r.break_mode("gripper-inverted").columns(dataset.schema, both) == JOINTS[5:]
    half = Reading(columns={JOINTS[5]: ColumnMeaning(low=0)})
    assert z2r.break_mode("gripper-inverted").columns(dataset.schema, half) == ()


@pytest.mark.parametrize("mode", COLUMN_MODES)
@pytest.mark.parametrize("feature", [STATE, ACTION])
def test_a_check_of_the_audit_sees_the_frames_as_they_are_taken(arm, mode, feature, monkeypatch):
    dataset, reading = arm
    seen: dict[Path, np.ndarray] = {}

    def look(frames: FileFrames) -> list[z2r.Fault]:
        seen[frames.path] = frames.signals[feature]
        return []

    monkeypatch.setattr(audits, "PARTS", (*audits.PARTS, Part(Check("look", "", "note"), FileFrames, look)))
    z2r.audit(dataset, z2r.break_mode(mode), reading)
    found = np.concatenate([seen[path] for path in sorted(seen)])
    np.testing.assert_array_equal(found, taken(arm, mode, feature)[1])
    assert len(seen) == 2


def test_an_inspection_and_a_replay_see_them_too(arm, tmp_path):
    dataset, reading = arm
    found = z2r.inspect_dataset(dataset, z2r.break_mode("joints-exchanged"), reading, keep=1000)
    _, exchanged = taken(arm, "joints-exchanged")
    np.testing.assert_array_equal(found.kept[STATE], exchanged)
    np.testing.assert_array_equal(found.last_frames[STATE], exchanged[dataset.episodes.to_index - 1])
    z2r.write_replay(found.dataset, tmp_path / "x.rrd", reading)
    drawn = values(read_rows(tmp_path / "x.rrd", "frame"), "observation/state", "Scalars:scalars").reshape(-1, 6)
    np.testing.assert_allclose(drawn, exchanged, rtol=1e-6)


@pytest.mark.parametrize("work", [z2r.inspect_dataset, z2r.audit], ids=["inspect", "audit"])
@pytest.mark.parametrize("mode", ["wrong-angle-unit", "gripper-inverted", "delta-for-absolute"])
def test_a_belief_goes_to_other_processes(arm, mode, work: Callable[..., object]):
    dataset, reading = arm
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as processes:
        elsewhere = work(dataset, z2r.break_mode(mode), reading, executor=processes)
    here = work(dataset, z2r.break_mode(mode), reading)
    if isinstance(here, z2r.Audit):
        assert elsewhere == here
    else:
        assert elsewhere.metrics("x", None) == here.metrics("x", None)


def test_stored_statistics_refute_no_belief_about_their_own_columns(arm, tmp_path):
    """They are numbers of the same file, in the same unit: but those of other columns are held against the data."""
    dataset, reading = arm
    restate(dataset.root)  # of each episode, too
    for mode in COLUMN_MODES:
        assert "stats" not in {finding.check for finding in z2r.audit(dataset, z2r.break_mode(mode), reading).findings}
    told = z2r.audit(dataset, z2r.break_mode("wrong-angle-unit"), reading).not_checked
    assert [line for line in told if line.startswith("stored statistics of observation.state:")]
    assert not [line for line in z2r.audit(dataset, None, reading).not_checked if line.startswith("stored statistics")]
    path = dataset.root / "meta/stats.json"
    text = path.read_text()
    path.write_text(text.replace(f"[{len(dataset.read(ACTION))}]", "[1]"))
    wrong = z2r.audit(dataset, z2r.break_mode("wrong-angle-unit"), reading).findings
    path.write_text(text)
    assert {finding.field.split(".")[0] for finding in wrong if finding.check == "stats"} >= {"action"}
    assert not [finding for finding in wrong if finding.field.startswith(STATE)]
