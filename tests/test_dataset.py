"""The reader against LeRobotDataset, value by value."""

import multiprocessing
import os
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from layouts import last_action, lay_out, random_frames, to_arrow

import z2r
from z2r.arrays import Columns
from z2r.format.dataset import in_order, map_files
from z2r.format.episodes import DataFile


def oracle(root: Path):
    from lerobot.datasets.lerobot_dataset import LeRobotDataset

    return LeRobotDataset("test/test", root=root, video_backend="pyav")


def assert_same_as_lerobot(root: Path) -> None:
    theirs, ours = oracle(root), z2r.load(root)
    assert ours.schema.fps == theirs.fps
    assert list(ours.schema.features) == list(theirs.features)
    assert ours.episodes.from_index.tolist() == list(theirs.meta.episodes["dataset_from_index"])
    assert ours.episodes.to_index.tolist() == list(theirs.meta.episodes["dataset_to_index"])
    for feature in theirs.features:
        expected = np.stack(theirs.hf_dataset.with_format("numpy")[:][feature]).reshape(len(theirs), -1)
        np.testing.assert_array_equal(ours.read(feature), expected)
    for episode, (start, stop) in enumerate(zip(ours.episodes.from_index, ours.episodes.to_index, strict=True)):
        belongs = theirs.hf_dataset.with_format("numpy")[int(start) : int(stop)]["episode_index"]
        assert set(belongs.tolist()) == {episode}


def test_every_value_is_what_lerobot_reads(recorded):
    dataset = z2r.load(recorded)
    assert len(dataset.files) > 3
    assert len(list((recorded / "meta/episodes").rglob("*.parquet"))) > 3
    assert_same_as_lerobot(recorded)


@pytest.mark.parametrize("shipped", [z2r.STANDIN, z2r.MESSY], ids=["standin", "messy"])
def test_every_value_of_the_shipped_data_is_what_lerobot_reads(shipped):
    assert_same_as_lerobot(shipped)


def test_a_dataset_laid_out_by_hand_is_one_that_lerobot_reads(tmp_path):
    lay_out(tmp_path / "dataset", lengths=[3, 1, 5, 2], files=[1, 3], shards=[2, 2])
    assert_same_as_lerobot(tmp_path / "dataset")


@st.composite
def layouts(draw):
    lengths = draw(st.lists(st.integers(1, 12), min_size=1, max_size=12))

    def split():
        cuts = draw(st.lists(st.integers(1, len(lengths)), unique=True))
        ends = sorted({*cuts, len(lengths)})
        return [end - start for start, end in zip([0, *ends], ends, strict=False)]

    return lengths, split(), split()


@settings(max_examples=40, suppress_health_check=[HealthCheck.too_slow])
@given(layout=layouts(), n_episodes=st.integers(1, 12))
def test_any_layout_of_files_and_shards_reads_back_what_was_written(layout, n_episodes, tmp_path_factory):
    lengths, files, shards = layout
    root = tmp_path_factory.mktemp("layout") / "dataset"
    lay_out(root, lengths, files, shards)
    file_lengths = [sum(chunk) for chunk in np.split(lengths, np.cumsum(files)[:-1])]
    written = [random_frames(length, seed) for seed, length in enumerate(file_lengths)]
    states = np.concatenate([state for state, _ in written])

    dataset = z2r.load(root)
    assert dataset.episodes.lengths.tolist() == lengths
    np.testing.assert_array_equal(dataset.read("observation.state"), states)
    np.testing.assert_array_equal(dataset.read("action"), np.concatenate([action for _, action in written]))

    few = dataset.first(min(n_episodes, len(lengths)))
    np.testing.assert_array_equal(few.read("observation.state"), states[: few.episodes.n_frames])


def test_file_1000_comes_after_file_999(tmp_path):
    n = 1002
    lay_out(tmp_path / "dataset", lengths=[1] * n, files=[1] * n, shards=[1] * n, chunk_size=2000)
    dataset = z2r.load(tmp_path / "dataset")
    assert dataset.read("index")[:, 0].tolist() == list(range(n))


def test_the_first_episodes_are_read_without_touching_the_files_of_the_others(recorded, tmp_path):
    dataset = z2r.load(recorded)
    few = dataset.first(2)
    assert len(few.files) < len(dataset.files)
    assert few.episodes.lengths.tolist() == dataset.episodes.lengths[:2].tolist()


def test_the_first_episodes_of_a_file_that_is_one_row_group_are_cut_where_they_end(tmp_path):
    lay_out(tmp_path / "dataset", lengths=[3, 4, 5], files=[3], shards=[3])
    [file] = z2r.load(tmp_path / "dataset").files
    pq.write_table(pq.read_table(file.path), file.path)
    assert pq.ParquetFile(file.path).num_row_groups == 1
    assert z2r.load(tmp_path / "dataset").first(2).read("index")[:, 0].tolist() == list(range(7))


@pytest.mark.parametrize("n_episodes", [0, -1, 13])
def test_asking_for_episodes_that_are_not_there_says_how_many_there_are(recorded, n_episodes):
    with pytest.raises(ValueError, match="1 to 12"):
        z2r.load(recorded).first(n_episodes)


def test_arrays_are_read_only(recorded):
    frames = map_files(z2r.load(recorded), ["action"], lambda _, frames: frames)[0]
    with pytest.raises(ValueError, match="read-only"):
        frames["action"][0, 0] = 1


def test_progress_counts_frames_up_to_the_last_one(recorded):
    dataset, seen = z2r.load(recorded), []
    map_files(dataset, ["action"], lambda *_: None, lambda done, total: seen.append((done, total)))
    n = dataset.episodes.n_frames
    assert seen == [(file.to_index, n) for file in dataset.files]
    assert seen[-1] == (n, n)


# --- small files that are read together


def change(file: Path, do: Callable[[pa.Table], pa.Table]) -> None:
    pq.write_table(do(pq.read_table(file)), file)


def with_column(table: pa.Table, name: str, values: pa.Array) -> pa.Table:
    return table.set_column(table.column_names.index(name), name, values)


def with_nan(table: pa.Table) -> pa.Table:
    values = np.array(table["action"].to_pylist(), np.float32)
    values[1, 0] = np.nan
    return with_column(table, "action", to_arrow(values))


SMALL_DAMAGES = {
    "none": lambda _: None,
    "missing": Path.unlink,
    "cut": lambda file: os.truncate(file, 100),
    "a row less": lambda file: change(file, lambda table: table[:-1]),
    "no action": lambda file: change(file, lambda table: table.drop_columns("action")),
    "two actions": lambda file: change(file, lambda table: table.append_column("action", table["action"])),
    "wider action": lambda file: change(file, lambda t: with_column(t, "action", to_arrow(np.zeros((len(t), 3))))),
    "text": lambda file: change(file, lambda t: with_column(t, "action", pa.array(["1"] * len(t)))),
    "no value": lambda file: change(file, lambda t: with_column(t, "action", pa.array([None] * len(t), pa.float32()))),
    "NaN": lambda file: change(file, with_nan),
    "as float64": lambda file: change(file, lambda t: with_column(t, "action", to_arrow(np.ones((len(t), 2))))),
    "lists": lambda file: change(file, lambda t: with_column(t, "action", pa.array(t["action"].to_pylist()))),
}


@pytest.mark.parametrize("which", [[1], [0, 1, 2]], ids=["one", "all"])
@pytest.mark.parametrize("damage", SMALL_DAMAGES)
def test_small_files_that_are_read_together_say_what_each_says(damage, which, tmp_path, monkeypatch):
    lay_out(tmp_path / "dataset", lengths=[3, 4, 5, 6], files=[1, 1, 2], shards=[4])
    dataset, n_blocks = z2r.load(tmp_path / "dataset"), 0
    for number in which:
        SMALL_DAMAGES[damage](dataset.files[number].path)

    def keep(file: DataFile, frames: Columns) -> tuple[int, Columns]:
        nonlocal n_blocks
        n_blocks += 1
        return file.from_index, frames

    def read(together: int) -> object:
        monkeypatch.setattr("z2r.format.dataset._MAX_TOGETHER", together)
        try:
            parts = map_files(dataset, ["action", "index"], keep)
        except z2r.DatasetError as error:
            return str(error)
        assert [first for first, _ in parts] == [int(frames["index"][0, 0]) for _, frames in parts]
        return {name: np.concatenate([frames[name] for _, frames in parts]).tolist() for name in ("action", "index")}

    alone = read(1)
    n_alone, n_blocks = n_blocks, 0
    assert read(64) == alone
    assert isinstance(alone, str) == (damage not in ("none", "as float64", "lists"))
    if damage == "none":
        assert (n_alone, n_blocks) == (3, 1)


@pytest.mark.parametrize("n_episodes", [1, 2, 3, 4])
def test_small_files_are_cut_where_the_first_episodes_end(n_episodes, tmp_path):
    lay_out(tmp_path / "dataset", lengths=[3, 4, 5, 6], files=[1, 1, 2], shards=[4])
    first = z2r.load(tmp_path / "dataset").first(n_episodes)
    assert first.read("index")[:, 0].tolist() == list(range(sum([3, 4, 5, 6][:n_episodes])))


# --- who runs it


@pytest.fixture(scope="module")
def processes() -> Iterator[ProcessPoolExecutor]:
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as executor:
        yield executor


def test_other_processes_read_what_threads_read(recorded, processes):
    dataset = z2r.load(recorded)
    done: list[int] = []
    found = map_files(dataset, ["action"], last_action, lambda done_, _: done.append(done_), processes)
    assert found == map_files(dataset, ["action"], last_action)
    assert done == [file.to_index for file in dataset.files]


@pytest.mark.parametrize(("damage", "says"), [(Path.unlink, "no such file"), (os.truncate, "cut off")])
def test_the_error_of_another_process_arrives_whole(damage, says, tmp_path, processes):
    lay_out(tmp_path / "dataset", lengths=[3, 4, 5], files=[1, 1, 1], shards=[3])
    dataset = z2r.load(tmp_path / "dataset")
    damage(dataset.files[1].path, *[20] * (damage is os.truncate))
    with pytest.raises(z2r.DatasetError, match=says) as caught:
        map_files(dataset, ["action"], last_action, executor=processes)
    assert caught.value.fault.path == dataset.files[1].path


def test_a_missing_folder_is_an_error_that_crosses_processes(tmp_path, processes):
    with pytest.raises(z2r.DatasetError, match="no such folder"):
        processes.submit(z2r.load, tmp_path / "nothing").result()
    with pytest.raises(z2r.DatasetError, match="no such folder"):
        processes.submit(z2r.salvage, tmp_path / "nothing").result()


def test_files_are_handed_out_as_results_are_taken():
    """However many there are, what waits is bounded."""

    class Counting(ThreadPoolExecutor):
        submitted = 0

        def submit(self, *args, **kwargs):
            self.submitted += 1
            return super().submit(*args, **kwargs)

    with Counting(2) as executor:
        results = in_order(abs, range(10_000), executor)
        assert [next(results) for _ in range(3)] == [0, 1, 2]
        assert executor.submitted < 100
        assert list(results) == list(range(3, 10_000))


def test_a_dataset_and_its_facts_are_short_at_the_prompt():
    dataset = z2r.load(z2r.STANDIN)
    assert repr(dataset) == "Dataset(standin: 6 episodes, 427 frames)"
    assert repr(dataset.episodes) == "EpisodeIndex(6 episodes, 427 frames)"
    assert repr(dataset.schema) == "Schema(7 features at 10 fps)"


def test_a_file_that_nobody_may_read_is_not_called_damaged(tmp_path, monkeypatch):
    def closed(path, *_, **__):
        raise PermissionError(13, "Permission denied", str(path))

    dataset = z2r.load(z2r.STANDIN)
    monkeypatch.setattr(pa, "memory_map", closed)
    with pytest.raises(z2r.DatasetError, match=r"permission denied.*chmod"):
        dataset.read("action")
