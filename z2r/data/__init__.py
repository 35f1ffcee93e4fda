"""Which datasets ship with the package, and which one does a name mean?

They were written by `z2r record`:

- ``standin``: six demonstrations, all of which reached the target.
- ``messy``: what people really record. Noise is twice as large, episodes end after 120 frames, and the seeds were
  chosen among the first thousand: some time out, some are very short, and one times out in tolerance without having
  held there, so that a reading calls it reached and the simulator does not call it a success. With the usual limit of
  300 frames, none of the first thousand seeds ends like that.

Next to each is a verdict: what the simulator said of every episode, the command that recorded it, and the stack that
it ran on (`z2r.pusht.verdict`).
"""

import difflib
import os
from collections.abc import Iterator
from pathlib import Path

from z2r.errors import DatasetError, Fault

STANDIN = Path(__file__).parent / "standin"
MESSY = Path(__file__).parent / "messy"
SHIPPED = {"standin": STANDIN, "messy": MESSY}
READINGS_DIR = Path(__file__).parent / "readings"  # of robots that people have: what their columns mean
REPLAY_STILL = Path(__file__).parent / "replay_still.png"


def find_dataset(dataset: str | os.PathLike[str] | None) -> Path:
    """Return the folder that is meant: one that is there, or else a dataset that ships and has this name.

    Parameters
    ----------
    dataset : str, path or None
        A folder, or the name of a dataset that ships; None means ``standin``.

    Raises
    ------
    DatasetError
        If there is neither; it offers names that are nearly the same.

    Examples
    --------
    >>> find_dataset("messy") == MESSY
    True
    """
    if dataset is None:
        return STANDIN
    path = Path(dataset)
    if path.exists():
        return path
    if os.fspath(dataset) in SHIPPED:
        return SHIPPED[os.fspath(dataset)]
    expected = f"the folder of a LeRobot dataset, or one that ships: {' or '.join(SHIPPED)}"
    raise DatasetError(Fault(path, "", "no such folder", expected, _did_you_mean(path)))


def _did_you_mean(path: Path) -> str:
    # Only a bare name can be meant for one that ships.
    shipped = {name: name for name in SHIPPED if path.name == str(path)}
    choices = {folder.name: str(folder) for folder in _siblings(path)} | shipped
    near = difflib.get_close_matches(path.name, choices)
    return f"Did you mean {' or '.join(choices[name] for name in near)}?" if near else ""


def _siblings(path: Path) -> Iterator[Path]:
    try:
        yield from filter(Path.is_dir, path.parent.iterdir())
    except OSError:  # there is no such parent, or it may not be read
        return
