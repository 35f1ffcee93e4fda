"""Which line mends it? What `lerobot-edit-dataset` can do to a folder, written so that it runs as it stands.

LeRobot 0.6.1 (`lerobot/scripts/lerobot_edit_dataset.py`) wants a name for a dataset, and never uses it for one that is
read from a folder and not pushed. It writes what it edits into another folder; only tasks are edited where they are.
"""

import json
import shlex
from collections.abc import Sequence
from pathlib import Path

from z2r.format.store import in_full

PROGRAM = "lerobot-edit-dataset"
_MAX_LISTED = 50  # episodes in one line
_MAX_TEXT = 200  # characters of a task in one line


def recompute_stats(root: Path) -> str:
    """Return the line that copies a dataset, with statistics in `meta/stats.json` that are those of its data.

    >>> recompute_stats(Path("/my data")).partition(" --root")[0]
    'lerobot-edit-dataset --repo_id=my/own'
    """
    return _line(root, "recompute_stats")


def delete_episodes(root: Path, episodes: Sequence[int]) -> str:
    """Return the line that copies a dataset without some of its episodes, or what to do where they are too many."""
    if len(episodes) > _MAX_LISTED:
        return (
            f"{PROGRAM} with --operation.type=delete_episodes, which takes the `episodes` that `z2r audit --json` lists"
        )
    return _line(root, "delete_episodes", episode_indices=[*episodes])


def remove_feature(root: Path, name: str) -> str:
    """Return the line that copies a dataset without one of its features."""
    return _line(root, "remove_feature", feature_names=[name])


def replace_tasks(root: Path, texts: dict[str, str]) -> str:
    """Return the line that gives tasks another text, in the folder itself; those with the same text become one."""
    if sum(map(len, texts)) > _MAX_TEXT:
        return f"{PROGRAM} with --operation.type=modify_tasks"
    options = ["--operation.type=modify_tasks", f"--operation.task_replacements={json.dumps(texts)}"]
    return shlex.join([PROGRAM, "--repo_id=my/own", f"--root={in_full(root)}", *options])


def _line(root: Path, operation: str, **options: object) -> str:
    folder = in_full(root)
    edited = folder.with_name(f"{folder.name}-edited")
    said = [f"--operation.{name}={json.dumps(value)}" for name, value in options.items()]
    where = [f"--root={folder}", f"--new_root={edited}"]
    return shlex.join([PROGRAM, "--repo_id=my/own", *where, f"--operation.type={operation}", *said])
