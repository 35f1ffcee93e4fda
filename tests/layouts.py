"""Datasets to test with: recorded by LeRobotDataset itself, or laid out by hand where another layout is needed.

Those laid out by hand follow what lerobot 0.6.1 writes (`lerobot/datasets/dataset_writer.py`, `dataset_metadata.py`):
one row group for each episode, a metadata row for each. `test_dataset.py` shows that LeRobotDataset reads them alike.
"""

import json
import shutil
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from z2r.arrays import Columns
from z2r.format.episodes import DataFile
from z2r.pusht.task import ACTION_NAMES, CONTROL_HZ, STATE_NAMES

FEATURES = {
    "observation.state": {"dtype": "float32", "shape": [len(STATE_NAMES)], "names": list(STATE_NAMES)},
    "action": {"dtype": "float32", "shape": [len(ACTION_NAMES)], "names": list(ACTION_NAMES)},
}
BOOKKEEPING = {
    "timestamp": {"dtype": "float32", "shape": [1], "names": None},
    **{
        name: {"dtype": "int64", "shape": [1], "names": None}
        for name in ("frame_index", "episode_index", "index", "task_index")
    },
}
DATA_PATH = "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
SHARD_PATH = "meta/episodes/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
STATS_PATH = "meta/stats.json"

type Frames = dict[str, np.ndarray]


def random_frames(n_frames: int, seed: int) -> tuple[np.ndarray, np.ndarray]:
    """States whose (sin, cos) pairs are on the unit circle, about half of them in tolerance, and actions."""
    rng = np.random.default_rng(seed)
    state = rng.uniform(-0.4, 0.4, size=(n_frames, len(STATE_NAMES)))
    near = rng.random(n_frames) < 0.6
    yaw = np.where(near, rng.uniform(-0.2, 0.2, n_frames), rng.uniform(-np.pi, np.pi, n_frames))
    state[near, 2:4] = rng.uniform(-0.02, 0.02, (near.sum(), 2))
    state[:, 4], state[:, 5] = np.sin(yaw), np.cos(yaw)
    state[:, 6:10] = 0, 0, 0, 1
    action = rng.uniform(-1, 1, size=(n_frames, len(ACTION_NAMES)))
    return state.astype(np.float32), action.astype(np.float32)


def record_with_lerobot(root: Path, lengths: Sequence[int], file_size_in_mb: float, seed: int = 0) -> None:
    """Record random frames with LeRobotDataset; a small file size makes it write several data files and shards."""
    from lerobot.datasets.lerobot_dataset import LeRobotDataset

    dataset = LeRobotDataset.create(
        repo_id="test/test",
        root=root,
        fps=CONTROL_HZ,
        features=FEATURES,
        use_videos=False,
        video_backend="pyav",
        metadata_buffer_size=1,
        data_files_size_in_mb=file_size_in_mb,
    )
    state, action = random_frames(sum(lengths), seed)
    frames = zip(state, action, strict=True)
    for length in lengths:
        for _ in range(length):
            observation, act = next(frames)
            dataset.add_frame({"observation.state": observation, "action": act, "task": "push it"})
        dataset.save_episode()
    dataset.finalize()


def lay_out(
    root: Path,
    lengths: Sequence[int],
    files: Sequence[int],
    shards: Sequence[int],
    seed: int = 0,
    chunk_size: int = 1000,
) -> None:
    """Write random frames by hand: `files` and `shards` say how many episodes each data file and shard holds."""
    firsts = np.cumsum(files) - np.asarray(files)
    rows = np.add.reduceat(np.asarray(lengths), firsts)
    states, actions = zip(*(random_frames(int(n), seed + number) for number, n in enumerate(rows)), strict=True)
    frames = {"observation.state": np.concatenate(states), "action": np.concatenate(actions)}
    write_dataset(root, frames, lengths, Layout(files, shards, chunk_size))


@dataclass(frozen=True)
class Layout:
    """Where the episodes go: how many each data file and each metadata shard holds, and what the files are called."""

    files: Sequence[int]
    shards: Sequence[int]
    chunk_size: int = 1000
    data_path: str = DATA_PATH
    shard_path: str = SHARD_PATH
    episode_stats: bool = False


def write_dataset(
    root: Path,
    frames: Frames,
    lengths: Sequence[int],
    layout: Layout,
    tasks: Sequence[str] = ("push it",),
    **info: Any,
) -> None:
    """Write the features of all frames as episodes of these lengths, with everything else as it has to be.

    All frames are of the first task, unless `frames` has a `task_index`.
    """
    lengths = np.asarray(lengths)
    frames = frames | _bookkeeping(lengths, info.get("fps", CONTROL_HZ)) | frames
    _write_info(root, layout, len(lengths), len(frames["index"]), {"total_tasks": len(tasks)} | info)
    _write_tasks(root, tasks)
    _write_metadata(root, frames, lengths, layout, tasks)
    _write_data(root, frames, lengths, layout)
    (root / STATS_PATH).write_text(json.dumps(_statistics_of(frames)))


def read_dataset(root: Path) -> tuple[Frames, list[int]]:
    """Return all frames of a dataset, bookkeeping too, and the length of each episode."""
    frames = {name: to_numpy(column) for name, column in read_data(root).items()}
    return frames, np.bincount(frames["episode_index"]).tolist()


def lay_out_again(source: Path, root: Path, layout: Layout) -> None:
    """Write the episodes of another dataset into other files."""
    frames, lengths = read_dataset(source)
    write_dataset(root, {name: frames[name] for name in FEATURES}, lengths, layout)


def rewrite(root: Path, episodes: Sequence[Frames]) -> None:
    """Replace all episodes of a dataset, in one file, with everything else as it has to be."""
    frames = {name: np.concatenate([episode[name] for episode in episodes]) for name in FEATURES}
    lengths = [len(episode["action"]) for episode in episodes]
    info = json.loads((root / "meta/info.json").read_text())
    shutil.rmtree(root)
    layout = Layout(files=[len(lengths)], shards=[len(lengths)], data_path=info["data_path"], episode_stats=True)
    write_dataset(root, frames, lengths, layout, features=info["features"], fps=info["fps"])


def restate(root: Path) -> None:
    """Make all stored statistics right again, those of the dataset and those of each episode."""
    frames, lengths = read_dataset(root)
    (root / STATS_PATH).write_text(json.dumps(_statistics_of(frames)))
    first = 0
    for path in shard_files(root):
        table = pq.read_table(path)
        table = table.drop_columns([name for name in table.column_names if name.startswith("stats/")])
        stops = np.cumsum(lengths)[first : first + len(table)]
        first += len(table)
        columns = _statistics_columns(frames, stops - table.column("length").to_numpy(), stops)
        for name, column in columns.items():
            table = table.append_column(name, column)
        pq.write_table(table, path)


def statistics(values: np.ndarray) -> dict[str, list[float]]:
    """Return what `meta/stats.json` says of one feature."""
    values = values.reshape(len(values), -1).astype(float)
    return {
        "min": values.min(axis=0).tolist(),
        "max": values.max(axis=0).tolist(),
        "mean": values.mean(axis=0).tolist(),
        "std": values.std(axis=0).tolist(),
        "count": [len(values)],
        **{f"q{100 * each:02.0f}": np.quantile(values, each, axis=0).tolist() for each in (0.01, 0.1, 0.5, 0.9, 0.99)},
    }


def last_action(file: DataFile, frames: Columns) -> tuple[int, list[float]]:
    """Take the last action of a file: a fold that other processes can be handed, for they find it here."""
    return file.from_index, frames["action"][-1].tolist()


def data_files(root: Path) -> list[Path]:
    """Return the data files in the order of their numbers."""
    return sorted((root / "data").rglob("*.parquet"), key=_numbers)


def shard_files(root: Path) -> list[Path]:
    """Return the metadata shards in the order of their numbers."""
    return sorted((root / "meta/episodes").rglob("*.parquet"), key=_numbers)


def read_data(root: Path) -> dict[str, pa.ChunkedArray]:
    """Return the columns of all data files one after another."""
    table = pa.concat_tables([pq.read_table(path) for path in data_files(root)])
    return dict(zip(table.column_names, table.columns, strict=True))


def to_numpy(column: pa.ChunkedArray) -> np.ndarray:
    """Return numbers as (n,) and lists of them as (n, size)."""
    array = column.combine_chunks()
    if pa.types.is_nested(array.type):
        return array.flatten().to_numpy().reshape(len(array), -1)
    return array.to_numpy(zero_copy_only=False)


def to_arrow(values: np.ndarray) -> pa.Array:
    """Return (n,) as numbers, (n, size) as lists of fixed size and more as lists of lists, as LeRobot stores them."""
    if values.ndim > 2:
        return pa.array(values.tolist(), pa.list_(pa.list_(pa.from_numpy_dtype(values.dtype))))
    return pa.array(values) if values.ndim == 1 else pa.FixedSizeListArray.from_arrays(values.ravel(), values.shape[1])


def _numbers_of(frames: Frames) -> Frames:
    """Leave out the text: LeRobot has no statistics of it."""
    return {name: values for name, values in frames.items() if values.dtype.kind in "biuf"}


def _statistics_of(frames: Frames) -> dict[str, Any]:
    return {name: statistics(values) for name, values in _numbers_of(frames).items()}


def _numbers(path: Path) -> list[int]:
    return [int("".join(char for char in part if char.isdigit()) or 0) for part in path.parts[-2:]]


def _bookkeeping(lengths: np.ndarray, fps: float) -> Frames:
    frame_index = np.concatenate([np.arange(length) for length in lengths])
    return {
        "timestamp": (frame_index / fps).astype(np.float32),
        "frame_index": frame_index,
        "episode_index": np.repeat(np.arange(len(lengths)), lengths),
        "index": np.arange(len(frame_index)),
        "task_index": np.zeros(len(frame_index), dtype=np.int64),
    }


def _write_info(root: Path, layout: Layout, n_episodes: int, n_frames: int, changes: dict[str, Any]) -> None:
    info = {
        "codebase_version": "v3.0",
        "fps": CONTROL_HZ,
        "features": FEATURES | BOOKKEEPING,
        "total_episodes": n_episodes,
        "total_frames": n_frames,
        "total_tasks": 1,
        "chunks_size": 1000,
        "data_files_size_in_mb": 100,
        "video_files_size_in_mb": 200,
        "data_path": layout.data_path,
        "video_path": None,
        "robot_type": None,
        "splits": {"train": f"0:{n_episodes}"},
    }
    (root / "meta").mkdir(parents=True)
    (root / "meta/info.json").write_text(json.dumps(info | changes, indent=4))


def _write_tasks(root: Path, tasks: Sequence[str]) -> None:
    import pandas as pd

    table = pd.DataFrame({"task_index": range(len(tasks))}, index=pd.Index(tasks, name="task"))
    table.to_parquet(root / "meta/tasks.parquet")


def _write_metadata(root: Path, frames: Frames, lengths: np.ndarray, layout: Layout, tasks: Sequence[str]) -> None:
    stops = np.cumsum(lengths)
    number = np.repeat(np.arange(len(layout.files)), layout.files)
    shard = np.repeat(np.arange(len(layout.shards)), layout.shards)
    of_episodes = np.split(frames["task_index"], stops[:-1])
    table = pa.table(
        {
            "episode_index": np.arange(len(lengths)),
            "tasks": pa.array([[tasks[task] for task in dict.fromkeys(own.tolist())] for own in of_episodes]),
            "length": lengths,
            "data/chunk_index": number // layout.chunk_size,
            "data/file_index": number % layout.chunk_size,
            "dataset_from_index": stops - lengths,
            "dataset_to_index": stops,
            "meta/episodes/chunk_index": shard // layout.chunk_size,
            "meta/episodes/file_index": shard % layout.chunk_size,
        }
        | (_statistics_columns(frames, stops - lengths, stops) if layout.episode_stats else {})
    )
    first = 0
    for number, n_episodes in enumerate(layout.shards):
        pq.write_table(table.slice(first, n_episodes), _place(root, layout.shard_path, number, layout.chunk_size))
        first += n_episodes


def _statistics_columns(frames: Frames, starts: np.ndarray, stops: np.ndarray) -> dict[str, pa.Array]:
    columns = {}
    for name, values in _numbers_of(frames).items():
        rows = [statistics(values[start:stop]) for start, stop in zip(starts, stops, strict=True)]
        columns |= {f"stats/{name}/{what}": pa.array([row[what] for row in rows]) for what in rows[0]}
    return columns


def _write_data(root: Path, frames: Frames, lengths: np.ndarray, layout: Layout) -> None:
    table = pa.table({name: to_arrow(values) for name, values in frames.items()})
    episode, row = 0, 0
    for number, n_episodes in enumerate(layout.files):
        with pq.ParquetWriter(_place(root, layout.data_path, number, layout.chunk_size), table.schema) as writer:
            for length in lengths[episode : episode + n_episodes]:
                writer.write_table(table.slice(row, length))
                row += length
        episode += n_episodes


def _place(root: Path, template: str, number: int, chunk_size: int) -> Path:
    path = root / template.format(chunk_index=number // chunk_size, file_index=number % chunk_size)
    path.parent.mkdir(parents=True, exist_ok=True)
    return path
