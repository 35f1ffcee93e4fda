"""Every break mode against a plain loop that makes the same mistake, on a dataset of many files and shards."""

import re

import numpy as np
import pyarrow.parquet as pq
import pytest
from hypothesis import given
from hypothesis import strategies as st
from test_replay import read_rows, values

import z2r
from z2r import BREAK_MODES, PUSHT, EpisodeIndex
from z2r.arrays import reduce_parts
from z2r.course.damage import split


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
