"""Which datasets ship with the package, and which one does a name mean?

A name may also be that of a folder, of anything in a dataset's folder, or of a dataset in a cache (`z2r.data.caches`);
or a URL (`z2r.data.urls`). Those that ship:

- ``standin``: six demonstrations, all of which reached the target.
- ``messy``: what people really record. Noise is twice as large, episodes end after 120 frames, and the seeds were
  chosen among the first thousand: some time out, some are very short, and one times out in tolerance without having
  held there, so that a reading calls it reached and the simulator does not call it a success. With the usual limit of
  300 frames, none of the first thousand seeds ends like that.
- ``arm``: an SO-101, which is what many people have, with two cameras and two tasks. It places a cube, and lifts it;
  three of thirteen episodes fail. Its success is stored nowhere, and no reading that ships says what counts as reached.

The first two, of PushT, were written by `z2r record`, and the third by ``record_arm.py`` beside it. Next to each is a
verdict: what the simulator said of every episode, the command that recorded it, and the stack that it ran on
(`z2r.reading.verdict`).
"""

import difflib
import os
from collections.abc import Iterator
from pathlib import Path

from z2r.data.caches import cached, cached_names, looks_like_a_name
from z2r.data.urls import Url, place_of
from z2r.errors import DatasetError, Fault

STANDIN = Path(__file__).parent / "standin"
MESSY = Path(__file__).parent / "messy"
ARM = Path(__file__).parent / "arm"
SHIPPED = {"standin": STANDIN, "messy": MESSY, "arm": ARM}
READINGS_DIR = Path(__file__).parent / "readings"  # of robots that people have: what their columns mean
REPLAY_STILL = Path(__file__).parent / "replay_still.png"
ARM_STILL = Path(__file__).parent / "arm_still.png"


def find_dataset(dataset: str | os.PathLike[str] | None) -> Path:
    """Return the folder that is meant: one that is there, or else a dataset that ships or is in a cache; or a URL.

    Parameters
    ----------
    dataset : str, path or None
        A folder, or something in it, such as its ``meta/info.json``; the name of a dataset that ships; or one on the
        hub, such as ``lerobot/pusht``, that was downloaded before; or a URL. None means ``standin``.

    Raises
    ------
    DatasetError
        If there is none; it offers names that are nearly the same. Nothing is fetched: what is at a URL is not looked
        at here.

    Examples
    --------
    >>> find_dataset("messy") == MESSY
    True
    """
    if dataset is None:
        return STANDIN
    path = place_of(dataset)
    if isinstance(path, Url):
        return path
    if path.exists():
        return _whole(path)
    name = os.fspath(dataset)
    found = SHIPPED.get(name) or cached(name)
    if found is not None:
        return found
    expected = f"the folder of a LeRobot dataset, or one that ships: {' or '.join(SHIPPED)}"
    if looks_like_a_name(name):
        where, mend = "no such folder, and no such dataset in a cache", f"To get it: {_download(name)}"
        raise DatasetError(Fault(path, "", where, expected, _did_you_mean(path) or mend))
    raise DatasetError(Fault(path, "", "no such folder", expected, _did_you_mean(path)))


def _download(name: str) -> str:
    return f"hf download {name} --repo-type dataset"


def _whole(path: Path) -> Path:
    """Return the dataset that a path leads into; the path itself where it leads into none."""
    whole = path if path.name else path.absolute()  # "." is below nothing
    for folder in () if _has_info(path) else whole.parents:
        if whole.relative_to(folder).parts[0] in ("meta", "data", "videos") and _has_info(folder):
            return folder
    return path


def _has_info(folder: Path) -> bool:
    try:
        return (folder / "meta/info.json").is_file()
    except OSError:  # nobody may look: whoever reads it says so
        return False


def _did_you_mean(path: Path) -> str:
    # Only a bare name can be meant for one that ships.
    shipped = {name: name for name in SHIPPED if path.name == str(path)}
    in_caches = {name: name for name in cached_names() if len(path.parts) == 2}
    choices = {folder.name: str(folder) for folder in _siblings(path)} | shipped
    near = difflib.get_close_matches(path.name, choices) or difflib.get_close_matches(str(path), in_caches)
    choices |= in_caches
    return f"Did you mean {' or '.join(choices[name] for name in near)}?" if near else ""


def _siblings(path: Path) -> Iterator[Path]:
    try:
        yield from filter(Path.is_dir, path.parent.iterdir())
    except OSError:  # there is no such parent, or it may not be read
        return
