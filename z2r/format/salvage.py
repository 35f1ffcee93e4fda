"""What can still be read of a dataset that was cut off? The episodes of which everything is there.

A recording that crashes leaves a last file that cannot be read, or episode metadata that is short of the data. What the
metadata and the frames still agree on is whole; the rest is left out, and named. The dataset is not written to.
"""

import os
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

import numpy as np

from z2r.arrays import Bools, Ints
from z2r.audits.frames import read_file
from z2r.audits.structure import Rows, name_files, read_rows
from z2r.errors import DatasetError, Fault
from z2r.format.dataset import Dataset, in_threads
from z2r.format.episodes import EPISODES_DIR, DataFile, EpisodeIndex
from z2r.format.schema import Schema, read_schema

_SOME = 8  # numbers in one line


@dataclass(frozen=True, eq=False)
class Salvage:
    """What can still be read of a dataset.

    Attributes
    ----------
    dataset : Dataset
        The whole episodes, which keep their numbers. Frames are counted over the files that can be read.
    left_out : tuple of str
        What is not in it, and why: a line for each reason and file; empty where nothing is left out.
    """

    dataset: Dataset
    left_out: tuple[str, ...]


def salvage(root: str | os.PathLike[str]) -> Salvage:
    """Find the episodes of a damaged dataset that are whole.

    An episode is whole where its row of metadata can be read, and the data file that it names can be read and has as
    many frames with its `episode_index`, side by side, as the row says.

    Parameters
    ----------
    root : str or path
        The folder of a LeRobot v3 dataset.

    Raises
    ------
    DatasetError
        If `meta/info.json` cannot be read, or no episode is whole.

    Examples
    --------
    >>> import z2r
    >>> z2r.salvage(z2r.STANDIN).left_out
    ()
    """
    root = Path(root)
    schema = read_schema(root)
    columns, _, findings = read_rows(root)
    if not len(columns["length"]):
        raise _no_episode(root, "no episode metadata that can be read")
    rows, paths = name_files(schema, columns)
    read = list(in_threads(lambda path: _read(root, schema, path), paths))
    kept = [_whole(rows, file, part) for file, part in enumerate(read)]
    if not any(len(whole.row) for whole in kept):
        faults = [f" ({path.as_posix()}: {part.fault})" for path, part in zip(paths, read, strict=True) if part.fault]
        raise _no_episode(root, f"no episode of which everything is there{faults[0] if faults else ''}")
    lost = [f"{finding.file}: {finding.found}" for finding in findings]
    lost += [line for file, whole in enumerate(kept) for line in _left_out(rows, file, paths[file], read[file], whole)]
    return Salvage(_join(root, schema, rows, paths, read, kept), tuple(lost))


class _Part(NamedTuple):
    """The runs of frames with one `episode_index` in a data file; no rows where it cannot be read."""

    n_rows: int
    number: Ints
    start: Ints
    stop: Ints
    fault: str


class _Whole(NamedTuple):
    """The episodes of a file that are whole: their rows of metadata, and where they start and stop in the file."""

    row: Ints
    start: Ints
    stop: Ints


def _read(root: Path, schema: Schema, path: Path) -> _Part:
    nothing = np.array([], dtype=np.int64)
    read = read_file(root, schema, path)
    unread = {*schema.signals(), "episode_index"} - set(read.frames)
    if not read.n_rows or unread:
        fault = next((finding.found for finding in read.findings), f"no {', '.join(sorted(unread))}")
        return _Part(0, nothing, nothing, nothing, fault)
    number = read.frames["episode_index"][:, 0].astype(np.int64)
    start = np.flatnonzero(np.concatenate([[True], np.diff(number) != 0]))
    return _Part(read.n_rows, number[start], start, np.append(start[1:], read.n_rows), "")


def _whole(rows: Rows, file: int, part: _Part) -> _Whole:
    """An episode that comes twice, in the metadata or in the file, is not whole: nobody knows which one is right."""
    runs = np.flatnonzero(_once(part.number))
    run_of_number = dict(zip(part.number[runs].tolist(), runs.tolist(), strict=True))
    own = np.flatnonzero((rows.file == file) & _once(rows.number))
    run = np.array([run_of_number.get(number, -1) for number in rows.number[own].tolist()], dtype=np.int64)
    own, run = own[run >= 0], run[run >= 0]
    fits = part.stop[run] - part.start[run] == rows.length[own]
    return _Whole(own[fits], part.start[run[fits]], part.stop[run[fits]])


def _once(numbers: Ints) -> Bools:
    """Tell of each number whether it comes only once."""
    values, counts = np.unique(numbers, return_counts=True)
    return np.isin(numbers, values[counts == 1])


def _left_out(rows: Rows, file: int, path: Path, part: _Part, whole: _Whole) -> list[str]:
    lost = np.setdiff1d(np.flatnonzero(rows.file == file), whole.row)
    why = f"found {part.fault}" if part.fault else "its frames are not all there"
    lines = [f"{_episodes(rows.number[lost])}: {path.as_posix()}: {why}"] if len(lost) else []
    unclaimed = np.setdiff1d(part.number, rows.number)
    if len(unclaimed):
        lines.append(f"{_episodes(unclaimed)}: {path.as_posix()} has frames of it, and meta/episodes no row")
    return lines


def _episodes(numbers: Ints) -> str:
    some = ", ".join(map(str, numbers[:_SOME].tolist())) + (" ..." if len(numbers) > _SOME else "")
    return f"episode {some}" if len(numbers) == 1 else f"{len(numbers)} episodes ({some})"


def _join(
    root: Path, schema: Schema, rows: Rows, paths: Sequence[Path], read: Sequence[_Part], kept: Sequence[_Whole]
) -> Dataset:
    bases = np.cumsum([0, *(part.n_rows for part in read)])
    row = np.concatenate([whole.row for whole in kept])
    start = np.concatenate([whole.start + base for whole, base in zip(kept, bases[:-1], strict=True)])
    stop = np.concatenate([whole.stop + base for whole, base in zip(kept, bases[:-1], strict=True)])
    order = np.argsort(start)
    files = tuple(
        DataFile(root / path, int(base), int(base) + part.n_rows)
        for path, part, base in zip(paths, read, bases[:-1], strict=True)
        if part.n_rows
    )
    return Dataset(root, schema, EpisodeIndex(start[order], stop[order], rows.number[row[order]]), files)


def _no_episode(root: Path, found: str) -> DatasetError:
    mend = "Copy or record the dataset again; a data file is left out as a whole where one of its values is no number"
    return DatasetError(Fault(root / EPISODES_DIR, "", found, "at least one whole episode", mend=mend))
