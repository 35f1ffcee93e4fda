"""Datasets to test with: recorded by LeRobotDataset itself, or laid out by hand where thousands of episodes are needed.

Those laid out by hand follow what lerobot 0.6.1 writes (`lerobot/datasets/dataset_writer.py`, `dataset_metadata.py`):
one row group for each episode, a metadata row for each. `test_dataset.py` shows that LeRobotDataset reads them alike.
"""

import json
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

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
            dataset.add_frame({"observation.state": observation, "action": act, "task": "test"})
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
    """Write a dataset by hand: `files` and `shards` say how many episodes each data file and metadata shard holds."""
    lengths = np.asarray(lengths)
    stops = np.cumsum(lengths)
    starts = stops - lengths
    file_of_episode = np.repeat(np.arange(len(files)), files)
    _write_info(root, n_episodes=len(lengths), n_frames=int(stops[-1]))
    _write_tasks(root)
    _write_metadata(root, lengths, starts, file_of_episode, shards, chunk_size)
    for number in range(len(files)):
        episodes = np.flatnonzero(file_of_episode == number)
        _write_data(root, number, episodes, lengths, int(starts[episodes[0]]), seed + number, chunk_size)


def _write_info(root: Path, n_episodes: int, n_frames: int) -> None:
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
        "data_path": "data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet",
        "video_path": None,
        "robot_type": None,
        "splits": {"train": f"0:{n_episodes}"},
    }
    (root / "meta").mkdir(parents=True)
    (root / "meta/info.json").write_text(json.dumps(info, indent=4))


def _write_tasks(root: Path) -> None:
    import pandas as pd

    pd.DataFrame({"task_index": [0]}, index=pd.Index(["test"], name="task")).to_parquet(root / "meta/tasks.parquet")


def _write_metadata(
    root: Path,
    lengths: np.ndarray,
    starts: np.ndarray,
    file_of_episode: np.ndarray,
    shards: Sequence[int],
    chunk_size: int,
) -> None:
    table = pa.table(
        {
            "episode_index": np.arange(len(lengths)),
            "tasks": pa.array([["test"]] * len(lengths)),
            "length": lengths,
            "data/chunk_index": file_of_episode // chunk_size,
            "data/file_index": file_of_episode % chunk_size,
            "dataset_from_index": starts,
            "dataset_to_index": starts + lengths,
        }
    )
    first = 0
    for number, n_episodes in enumerate(shards):
        path = root / f"meta/episodes/chunk-{number // chunk_size:03d}/file-{number % chunk_size:03d}.parquet"
        path.parent.mkdir(parents=True, exist_ok=True)
        pq.write_table(table.slice(first, n_episodes), path)
        first += n_episodes


def _write_data(
    root: Path, number: int, episodes: np.ndarray, lengths: np.ndarray, first_frame: int, seed: int, chunk_size: int
) -> None:
    own = lengths[episodes]
    state, action = random_frames(int(own.sum()), seed)
    frame_index = np.concatenate([np.arange(length) for length in own])
    table = pa.table(
        {
            "observation.state": pa.FixedSizeListArray.from_arrays(state.ravel(), state.shape[1]),
            "action": pa.FixedSizeListArray.from_arrays(action.ravel(), action.shape[1]),
            "timestamp": (frame_index / CONTROL_HZ).astype(np.float32),
            "frame_index": frame_index,
            "episode_index": np.repeat(episodes, own),
            "index": first_frame + np.arange(len(state)),
            "task_index": np.zeros(len(state), dtype=np.int64),
        }
    )
    path = root / f"data/chunk-{number // chunk_size:03d}/file-{number % chunk_size:03d}.parquet"
    path.parent.mkdir(parents=True, exist_ok=True)
    with pq.ParquetWriter(path, table.schema) as writer:
        for start, length in zip(np.cumsum(own) - own, own, strict=True):
            writer.write_table(table.slice(start, length))
