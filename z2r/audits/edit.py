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
_MAX_LENGTH = 300  # of what a dataset may say in a line: nobody reads or types more


def recompute_stats(root: Path) -> str:
    """Return the line that copies a dataset, with statistics in `meta/stats.json` that are those of its data."""
    return _line(root, "recompute_stats")


def delete_episodes(root: Path, episodes: Sequence[int]) -> str:
    """Return the line that copies a dataset without some of its episodes."""
    return _line(root, "delete_episodes", episode_indices=[*episodes])


def remove_feature(root: Path, name: str) -> str:
    """Return the line that copies a dataset without one of its features."""
    return _line(root, "remove_feature", feature_names=[name])


def replace_tasks(root: Path, texts: dict[str, str]) -> str:
    """Return the line that gives tasks another text, in the folder itself; those with the same text become one.

    >>> print(replace_tasks(Path("/data"), {"Push": "push it"}).removeprefix(PROGRAM))
     --repo_id=my/own --root=/data --operation.type=modify_tasks '--operation.task_replacements={"Push": "push it"}'
    """
    return _line(root, "modify_tasks", in_place=True, task_replacements=texts)


def _line(root: Path, operation: str, *, in_place: bool = False, **options: object) -> str:
    said = [f"--operation.{name}={json.dumps(value)}" for name, value in options.items()]
    if sum(map(len, said)) > _MAX_LENGTH:
        return f"{PROGRAM}, operation {operation}"
    folder = in_full(root)
    edited = [] if in_place else [f"--new_root={folder.with_name(f'{folder.name}-edited')}"]
    return shlex.join(
        [PROGRAM, "--repo_id=my/own", f"--root={folder}", *edited, f"--operation.type={operation}", *said]
    )
