"""How did each episode really end? What the environment said, kept beside the dataset and not in it.

A dataset holds no verdict, and to grade a reading one needs it: `z2r record OUT` writes `OUT.verdict.json`. Of any
robot, an episode of it has its length and whether it was a success; what else an environment says differs.
"""

import os
from pathlib import Path
from typing import Annotated, Any

import msgspec
import numpy as np

from z2r.arrays import Bools
from z2r.data.urls import Url, place_of
from z2r.errors import DatasetError, Fault
from z2r.format.episodes import EpisodeIndex
from z2r.format.store import is_file, read_bytes, write

_MAX_BYTES = 2**26
_MEND = "Record it again, or move it away: the dataset can be read without it"


class Verdict(msgspec.Struct, frozen=True):
    """How one episode ended in the environment.

    Attributes
    ----------
    n_frames : int
        Number of frames stored: one for each action.
    success : bool
        Whether the environment called it a success.
    seed : int, optional
        Seed of the episode, where a simulator had one.
    details : dict
        What else the environment said of it, by name, as the file has it. For PushT, after the last action, of which
        the observation is not stored: ``pos_err``, the distance from the block to the target [m], and ``ang_err``, how
        far the block was turned away from it [rad], in [0, pi].
    """

    n_frames: int
    success: bool
    seed: int | None = None
    details: dict[str, Any] = {}


class Recording(msgspec.Struct, frozen=True):
    """How a dataset was recorded, and what came of it.

    Attributes
    ----------
    command : str
        The command that records it again.
    stack : dict of str to str
        Version of everything that decides what the simulator does. Another stack gives other lengths.
    episodes : list of Verdict
        One for each episode, in the order of their numbers; at least one.
    """

    command: str
    stack: dict[str, str]
    episodes: list[Verdict]

    def success_of(self, episodes: EpisodeIndex) -> Bools | None:
        """Tell which of these episodes were a success, bool[n]; None where they are not the ones that were recorded."""
        numbers = episodes.numbers
        if numbers.max() >= len(self.episodes):
            return None
        told = [self.episodes[number] for number in numbers.tolist()]
        if [each.n_frames for each in told] != episodes.lengths.tolist():
            return None
        return np.array([each.success for each in told])


def verdict_path(root: str | os.PathLike[str]) -> Path:
    """Return where the verdict on the dataset at `root` is kept, whether it is there or not."""
    root = place_of(root)
    root = root if isinstance(root, Url) else root.resolve()  # the name of `.` is that of the folder
    return root.parent / f"{root.name}.verdict.json"


def write_verdict(root: Path, recording: Recording) -> None:
    """Write the verdict beside the dataset at `root`."""
    episodes = [
        {"seed": each.seed, "n_frames": each.n_frames, "success": each.success} | each.details
        for each in recording.episodes
    ]
    said = {"command": recording.command, "stack": recording.stack, "episodes": episodes}
    write(verdict_path(root), msgspec.json.format(msgspec.json.encode(said), indent=2) + b"\n")


def read_verdict(root: str | os.PathLike[str]) -> Recording | None:
    """Read the verdict beside the dataset at `root`; None where there is none.

    Raises
    ------
    DatasetError
        If the file is there, and cannot be read or is no verdict.

    Examples
    --------
    >>> import z2r
    >>> all(verdict.success for verdict in z2r.read_verdict(z2r.STANDIN).episodes)
    True
    """
    path, expected = verdict_path(root), "a verdict: a command, a stack, and n_frames and success of each episode"
    if not is_file(path):
        return None
    try:
        said = msgspec.json.decode(read_bytes(path, _MAX_BYTES, expected, _MEND), type=_File)
        return msgspec.convert({**msgspec.structs.asdict(said), "episodes": [*map(_sorted, said.episodes)]}, Recording)
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
        raise DatasetError(Fault(path, "", f"{error}", expected, _MEND)) from error


class _File(msgspec.Struct):
    """What stands in the file: all that is said of an episode is in one object there."""

    command: str
    stack: dict[str, str]
    episodes: Annotated[list[dict[str, Any]], msgspec.Meta(min_length=1)]


def _sorted(said: dict[str, Any]) -> dict[str, Any]:
    """Take what any environment says of an episode out of what this one does."""
    common = {name: said.pop(name) for name in ("n_frames", "success", "seed") if name in said}
    return common | {"details": said}
