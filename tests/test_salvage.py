"""What can still be read of a dataset that was cut off, held against the same episodes of the whole one."""

import json
import multiprocessing
import shutil
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from hypothesis import given
from hypothesis import strategies as st
from layouts import lay_out
from test_cli import run

import z2r

LENGTHS = [3, 1, 4, 2, 6, 5, 2]
FILES, SHARDS = [2, 2, 3], [1, 4, 2]  # episodes 0 and 1 are in the first data file, 0 alone in the first shard


def data(root: Path, number: int) -> Path:
    return root / f"data/chunk-000/file-{number:03d}.parquet"


def shard(root: Path, number: int) -> Path:
    return root / f"meta/episodes/chunk-000/file-{number:03d}.parquet"


def cut(path: Path, share: float = 0.5) -> None:
    path.write_bytes(path.read_bytes()[: int(path.stat().st_size * share)])


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("whole") / "dataset"
    lay_out(root, LENGTHS, FILES, SHARDS)
    return root


@pytest.fixture
def copy(whole: Path, tmp_path: Path) -> Path:
    return Path(shutil.copytree(whole, tmp_path / "copy"))


def numbers(found: z2r.Salvage) -> list[int]:
    return [found.dataset.episodes.number(i) for i in range(len(found.dataset.episodes))]


def assert_same_frames(found: z2r.Salvage, whole: Path) -> None:
    """Each episode that is left has the frames that it had."""
    right = z2r.load(whole)
    for feature in ("observation.state", "action"):
        before, after = right.read(feature), found.dataset.read(feature)
        for place, number in enumerate(numbers(found)):
            np.testing.assert_array_equal(after[found.dataset.episodes[place]], before[right.episodes[number]])


@pytest.mark.parametrize(
    ("damaged", "left"),
    [
        ((data, 2), [0, 1, 2, 3]),
        ((data, 1), [0, 1, 4, 5, 6]),
        ((shard, 2), [0, 1, 2, 3, 4]),
        ((shard, 0), list(range(1, 7))),
    ],
    ids=["last data file", "data file in the middle", "last shard", "first shard"],
)
@pytest.mark.parametrize("damage", [cut, Path.unlink, lambda path: path.write_bytes(b"")], ids=["cut", "gone", "empty"])
def test_the_episodes_that_a_lost_file_does_not_touch_are_left(copy, whole, damaged, left, damage):
    path_of, number = damaged
    damage(path_of(copy, number))
    found = z2r.salvage(copy)
    assert numbers(found) == left
    assert_same_frames(found, whole)
    assert found.left_out


@given(share=st.floats(0, 0.99), number=st.integers(0, 2))
def test_wherever_a_data_file_is_cut_the_other_episodes_are_left(tmp_path_factory, whole, share, number):
    root = Path(shutil.copytree(whole, tmp_path_factory.mktemp("cut") / "copy"))
    cut(data(root, number), share)
    first = sum(FILES[:number])
    assert numbers(z2r.salvage(root)) == [i for i in range(7) if not first <= i < first + FILES[number]]


def test_other_processes_salvage_what_threads_salvage(copy):
    cut(data(copy, 1))
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as processes:
        found, threads = z2r.salvage(copy, processes), z2r.salvage(copy)
    assert (found.left_out, found.dataset.files) == (threads.left_out, threads.dataset.files)
    assert numbers(found) == numbers(threads)


def test_metadata_that_is_short_of_the_data_names_the_frames_that_nobody_claims(copy, whole):
    table = pq.read_table(shard(copy, 2))
    pq.write_table(table.slice(0, 1), shard(copy, 2))
    found = z2r.salvage(copy)
    assert numbers(found) == [0, 1, 2, 3, 4, 5]
    assert_same_frames(found, whole)
    [line] = found.left_out
    assert "episode 6" in line


def test_an_episode_that_lacks_frames_is_left_out(copy, whole):
    table = pq.read_table(data(copy, 1))
    pq.write_table(table.slice(0, len(table) - 1), data(copy, 1))
    found = z2r.salvage(copy)
    assert numbers(found) == [0, 1, 2, 4, 5, 6]
    assert_same_frames(found, whole)
    [line] = found.left_out
    assert line.startswith("episode 3:")


def test_an_episode_that_is_told_twice_is_left_out(copy):
    table = pq.read_table(shard(copy, 1))
    pq.write_table(pa.concat_tables([table, table.slice(1, 1)]), shard(copy, 1))
    assert numbers(z2r.salvage(copy)) == [0, 1, 3, 4, 5, 6]


def test_a_whole_dataset_loses_nothing(whole):
    found = z2r.salvage(whole)
    assert numbers(found) == list(range(7))
    assert found.left_out == ()
    assert_same_frames(found, whole)


@pytest.mark.parametrize("folder", ["data", "meta/episodes"])
def test_where_nothing_is_whole_an_error_says_so(copy, folder):
    shutil.rmtree(copy / folder)
    with pytest.raises(z2r.DatasetError, match="whole episode"):
        z2r.salvage(copy)


def test_the_summary_is_that_of_the_episodes_that_are_left(copy, whole):
    data(copy, 1).unlink()
    right, left = z2r.inspect_dataset(z2r.load(whole)), z2r.inspect_dataset(z2r.salvage(copy).dataset)
    kept = [0, 1, 4, 5, 6]
    assert left.episodes.lengths.tolist() == right.episodes.lengths[kept].tolist()
    assert left.outcome.reached.tolist() == right.outcome.reached[kept].tolist()
    np.testing.assert_array_equal(left.ranges["action"].high, right.ranges["action"].high[kept])


def test_the_error_of_inspect_says_what_can_still_be_read(copy, tmp_path):
    cut(data(copy, 2))
    refused = run("inspect", copy, cwd=tmp_path)
    assert refused.returncode == 2
    assert "--salvage reads the 4 episodes" in refused.stderr
    salvaged = run("inspect", copy, "--salvage", "--json", "--out", "out", cwd=tmp_path)
    assert salvaged.returncode == 0
    metrics = json.loads(salvaged.stdout)
    assert metrics["episode_numbers"] == [0, 1, 2, 3]
    assert len(metrics["left_out"]) == 1
    assert not (tmp_path / "out/inspect.rrd").is_file()  # --json writes none unless it is asked for
    assert run("inspect", copy, "--salvage", "--out", "out", cwd=tmp_path).returncode == 0
    assert (tmp_path / "out/inspect.rrd").is_file()
