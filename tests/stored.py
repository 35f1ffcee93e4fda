"""Datasets that say themselves what was a success, in the shapes that people store it in, written by LeRobotDataset.

Which episodes are a success is drawn here, and kept, so that a test knows it without reading the dataset.
"""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

SUCCESS = (True, False, True, True, False, True)
LENGTHS = (24, 30, 9, 41, 30, 12)

BOOL = {"dtype": "bool", "shape": (1,), "names": None}
NUMBER = {"dtype": "float32", "shape": (1,), "names": None}
PIXELS = {  # those of lerobot/pusht, but for its pictures
    "observation.state": {"dtype": "float32", "shape": (2,), "names": {"motors": ["motor_0", "motor_1"]}},
    "action": {"dtype": "float32", "shape": (2,), "names": {"motors": ["motor_0", "motor_1"]}},
    "next.reward": NUMBER,
    "next.done": BOOL,
    "next.success": BOOL,
}

type Labels = dict[str, np.ndarray]


def latched(n: int, success: bool, from_end: int = 3) -> np.ndarray:
    """True in the last few frames of a success."""
    return (np.arange(n) >= n - from_end) & success


def last_only(n: int) -> np.ndarray:
    return np.arange(n) == n - 1


def sparse(n: int, success: bool) -> Labels:
    return {"next.reward": (last_only(n) & success).astype(np.float32), "next.done": last_only(n)}


def dense(n: int, success: bool) -> Labels:
    how_well = np.linspace(0, 1 if success else 0.6, n, dtype=np.float32)
    return {"next.reward": how_well, "next.done": last_only(n)}


def pixel_pusht(n: int, success: bool) -> Labels:
    return dense(n, success) | {"next.success": latched(n, success)}


_PLAIN = {name: feature for name, feature in PIXELS.items() if not name.startswith("next.")}
SHAPES: dict[str, tuple[dict[str, Any], Callable[[int, bool], Labels]]] = {
    "next.success": (_PLAIN | {"next.success": BOOL}, lambda n, success: {"next.success": latched(n, success)}),
    "success": (
        _PLAIN | {"success": {"dtype": "int64", "shape": (1,), "names": None}},
        lambda n, success: {"success": latched(n, success).astype(np.int64)},
    ),
    "sparse": (_PLAIN | {"next.reward": NUMBER, "next.done": BOOL}, sparse),
    "dense": (_PLAIN | {"next.reward": NUMBER, "next.done": BOOL}, dense),
    "lerobot/pusht": (PIXELS, pixel_pusht),
}


def record(root: Path, shape: str) -> None:
    """Record a hand that wanders over a board, in several data files, with the labels of one shape."""
    from lerobot.datasets.lerobot_dataset import LeRobotDataset

    features, labels = SHAPES[shape]
    where = {"repo_id": "test/test", "root": root, "video_backend": "pyav"}
    small = {"metadata_buffer_size": 1, "data_files_size_in_mb": 0.008}
    dataset = LeRobotDataset.create(**where, **small, fps=10, features=features, use_videos=False)
    rng = np.random.default_rng(0)
    for n, success in zip(LENGTHS, SUCCESS, strict=True):
        way = np.cumsum(rng.normal(0, 5, (n + 1, 2)), axis=0).astype(np.float32) + 256
        columns = {"observation.state": way[:-1], "action": way[1:]}
        columns |= {name: values[:, None] for name, values in labels(n, success).items()}
        for frame in range(n):
            dataset.add_frame({name: values[frame] for name, values in columns.items()} | {"task": "push it"})
        dataset.save_episode()
    dataset.finalize()
