"""What the simulator said of a recording, kept beside the dataset and not in it.

A dataset holds no verdict. To grade a reading one needs it, so `z2r record OUT` writes `OUT.verdict.json`.
"""

import os
from pathlib import Path
from typing import Annotated

import msgspec

from z2r.errors import DatasetError, Fault
from z2r.format.store import is_file, read_bytes

_MAX_BYTES = 2**28
_MEND = "Record it again, or move it away: the dataset can be read without it"


class Verdict(msgspec.Struct, frozen=True):
    """How one episode ended in the simulator.

    Attributes
    ----------
    seed : int
        Seed of the episode.
    n_frames : int
        Number of frames stored: one for each action.
    success : bool
        Whether the environment latched success.
    pos_err : float
        Distance from the block to the target after the last action [m]. This observation is not stored.
    ang_err : float
        How far the block was turned away from the target then [rad], in [0, pi].
    """

    seed: int
    n_frames: int
    success: bool
    pos_err: float
    ang_err: float


class Recording(msgspec.Struct, frozen=True):
    """How a dataset was recorded, and what came of it.

    Attributes
    ----------
    command : str
        The command that records it again.
    stack : dict of str to str
        Version of everything that decides what the simulator does. Another stack gives other lengths.
    episodes : list of Verdict
        One for each episode, in order; at least one.
    """

    command: str
    stack: dict[str, str]
    episodes: Annotated[list[Verdict], msgspec.Meta(min_length=1)]


def verdict_path(root: str | os.PathLike[str]) -> Path:
    """Return where the verdict on the dataset at `root` is kept, whether it is there or not."""
    root = Path(root).resolve()  # the name of `.` is that of the folder
    return root.parent / f"{root.name}.verdict.json"


def write_verdict(root: Path, recording: Recording) -> None:
    """Write the verdict beside the dataset at `root`."""
    verdict_path(root).write_bytes(msgspec.json.format(msgspec.json.encode(recording), indent=2) + b"\n")


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
    path, expected = verdict_path(root), "a verdict as z2r record writes it"
    if not is_file(path):
        return None
    try:
        return msgspec.json.decode(read_bytes(path, _MAX_BYTES, expected, _MEND), type=Recording)
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
        raise DatasetError(Fault(path, "", f"{error}", expected, _MEND)) from error
