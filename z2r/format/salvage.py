"""What can still be read of a dataset that was cut off? The episodes of which everything is there.

A recording that crashes leaves a last file that cannot be read, or episode metadata that is short of the data. What the
metadata and the frames still agree on is whole; the rest is left out, and named. The dataset is not written to.
"""

import os
from collections.abc import Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from z2r.arrays import Bools, Ints
from z2r.data.urls import place_of
from z2r.errors import DatasetError, Fault, some
from z2r.format.dataset import Dataset, in_order
from z2r.format.episodes import EPISODES_DIR, DataFile, EpisodeIndex, EpisodeTable
from z2r.format.schema import Schema, read_schema
from z2r.format.tables import read_data_file, read_episodes


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


def salvage(root: str | os.PathLike[str], executor: Executor | None = None) -> Salvage:
    """Find the episodes of a damaged dataset that are whole.

    An episode is whole where its row of metadata can be read, and the data file that it names can be read and has as
    many frames with its `episode_index`, side by side, as the row says.

    Parameters
    ----------
    root : str or path
        The folder of a LeRobot v3 dataset.
    executor : Executor, optional
        Who reads the data files; at most four threads unless given. It is not shut down.

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
    root = place_of(root)
    schema = read_schema(root)
    (table, paths, _, skipped), faults = read_episodes(root, schema)
    if not len(table.number):
        raise _no_episode(root, "no episode metadata that can be read")
    read = list(in_order(partial(_read_runs, root, schema), paths, executor))
    kept = [_whole(table, file_number, runs) for file_number, runs in enumerate(read)]
    if not any(len(whole.row) for whole in kept):
        lost = [f" ({path.as_posix()}: {runs.fault})" for path, runs in zip(paths, read, strict=True) if runs.fault]
        raise _no_episode(root, f"no episode of which everything is there{lost[0] if lost else ''}")
    left_out = [f"{fault.path.as_posix()}: {fault.found}" for fault in (*skipped, *faults)]
    for file_number, whole in enumerate(kept):
        left_out += _left_out(table, file_number, paths[file_number], read[file_number], whole)
    return Salvage(_join(root, schema, table, paths, read, kept), tuple(left_out))


class _FileRuns(NamedTuple):
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


def _read_runs(root: Path, schema: Schema, path: Path) -> _FileRuns:
    nothing = np.array([], dtype=np.int64)
    read = read_data_file(root, schema, path)
    unread = {*schema.signals(), "episode_index"} - set(read.frames)
    if not read.n_rows or unread:
        found = str(read.faults[0].found) if read.faults else f"no {', '.join(sorted(unread))}"
        return _FileRuns(0, nothing, nothing, nothing, "no rows" if read.n_rows == 0 else found)
    number = read.frames["episode_index"][:, 0].astype(np.int64)
    start = np.flatnonzero(np.concatenate([[True], np.diff(number) != 0]))
    return _FileRuns(read.n_rows, number[start], start, np.append(start[1:], read.n_rows), "")


def _whole(table: EpisodeTable, file_number: int, runs: _FileRuns) -> _Whole:
    """An episode that comes twice, in the metadata or in the file, is not whole: nobody knows which one is right."""
    once = np.flatnonzero(_once(runs.number))
    run_of_number = dict(zip(runs.number[once].tolist(), once.tolist(), strict=True))
    own = np.flatnonzero((table.file_number == file_number) & _once(table.number))
    run = np.array([run_of_number.get(number, -1) for number in table.number[own].tolist()], dtype=np.int64)
    own, run = own[run >= 0], run[run >= 0]
    fits = runs.stop[run] - runs.start[run] == table.length[own]
    return _Whole(own[fits], runs.start[run[fits]], runs.stop[run[fits]])


def _once(numbers: Ints) -> Bools:
    """Tell of each number whether it comes only once."""
    values, counts = np.unique(numbers, return_counts=True)
    return np.isin(numbers, values[counts == 1])


def _left_out(table: EpisodeTable, file_number: int, path: Path, runs: _FileRuns, whole: _Whole) -> list[str]:
    lost = np.setdiff1d(np.flatnonzero(table.file_number == file_number), whole.row)
    why = f"found {runs.fault}" if runs.fault else "its frames are not all there"
    lines = [f"{_episodes(table.number[lost])}: {path.as_posix()}: {why}"] if len(lost) else []
    unclaimed = np.setdiff1d(runs.number, table.number)
    if len(unclaimed):
        lines.append(f"{_episodes(unclaimed)}: {path.as_posix()} has frames of it, and meta/episodes no row")
    return lines


def _episodes(numbers: Ints) -> str:
    named = some(numbers.tolist())
    return f"episode {named}" if len(numbers) == 1 else f"{len(numbers)} episodes ({named})"


def _join(
    root: Path,
    schema: Schema,
    table: EpisodeTable,
    paths: Sequence[Path],
    read: Sequence[_FileRuns],
    kept: Sequence[_Whole],
) -> Dataset:
    bases = np.cumsum([0, *(runs.n_rows for runs in read)])
    row = np.concatenate([whole.row for whole in kept])
    start = np.concatenate([whole.start + base for whole, base in zip(kept, bases[:-1], strict=True)])
    stop = np.concatenate([whole.stop + base for whole, base in zip(kept, bases[:-1], strict=True)])
    order = np.argsort(start)
    files = tuple(
        DataFile(root / path, int(base), int(base) + runs.n_rows)
        for path, runs, base in zip(paths, read, bases[:-1], strict=True)
        if runs.n_rows
    )
    return Dataset(root, schema, EpisodeIndex(start[order], stop[order], table.number[row[order]]), files)


def _no_episode(root: Path, found: str) -> DatasetError:
    mend = "Copy or record the dataset again; a data file is left out as a whole where one of its values is no number"
    return DatasetError(Fault(root / EPISODES_DIR, "", found, "at least one whole episode", mend=mend))
