"""What is read of one data file, and what is kept of it? All that the checks need, and nothing else stays in memory."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import NamedTuple

import numpy as np

from z2r.arrays import Bools, Columns, Floats, Ints, by_column
from z2r.audits.claims import Claims
from z2r.errors import Fault
from z2r.format import rules
from z2r.format.episodes import EpisodeIndex
from z2r.format.misread import Misread
from z2r.format.rules import Rows
from z2r.format.schema import BOOKKEEPING, Schema
from z2r.format.tables import DataColumns, count_rows, episodes_in

HEAD_FRAMES = 2**14
"""The runs that begin in so many frames of a data file tell what is usual in it: later ones do not wait for its end."""


class FileClaims(NamedTuple):
    """What the metadata says of one data file.

    Attributes
    ----------
    path : Path
        Relative to the dataset.
    base : int
        Which frame of the dataset it begins with.
    n_claimed : int
        How many frames its episodes have.
    numbers : tuple of int
        What they are called.
    episodes : EpisodeIndex or None
        Those that it may hold a part of, as the metadata says; None where that does not hang together.
    misread : Misread or None
        What somebody takes its columns for; as the files have them, unless given.
    """

    path: Path
    base: int
    n_claimed: int
    numbers: tuple[int, ...]
    episodes: EpisodeIndex | None
    misread: Misread | None = None

    def taken(self, read: DataColumns) -> DataColumns:
        """Return what was read of the file, which is all of it, as it is taken."""
        if self.misread is None or self.episodes is None:
            return read
        return read._replace(frames=self.misread(read.frames, self.base, self.episodes))


class FileColumns(NamedTuple):
    """What could be read of one data file, but for its frames: what is asked of a file as a whole is asked of this.

    Attributes
    ----------
    claims : FileClaims
        What the metadata says of it.
    schema : Schema
        What a frame should be.
    read : DataColumns
        Without the frames.
    """

    claims: FileClaims
    schema: Schema
    read: DataColumns

    def in_order(self, faults: Mapping[str, Fault]) -> list[Fault]:
        """List faults of columns in the order of the features, whichever was seen first."""
        return [faults[name] for name in self.schema.features if name in faults]


class Before(NamedTuple):
    """What is known of a file before a block of it.

    Attributes
    ----------
    frame_index : int or None
        Of the row before; None where it cannot be read.
    frame_index_is_wrong : bool or None
        Whether `frame_index` or `episode_index` is wrong, if they were seen to disagree.
    """

    frame_index: int | None
    frame_index_is_wrong: bool | None


@dataclass(frozen=True, eq=False)
class FileFrames:
    """Frames of one data file, and what the metadata says of it: what is asked of its rows is asked of this.

    They are all of them, or a block; each run of frames with one `episode_index` is whole.

    Attributes
    ----------
    claims : FileClaims
        What the metadata says of the file.
    schema : Schema
        What a frame should be.
    tasks : ndarray or None
        The numbers of all tasks, where they could be read.
    read : DataColumns
        What could be read.
    before : Before or None
        What is known of the rows before; None where there are none.
    """

    claims: FileClaims
    schema: Schema
    tasks: Ints | None
    read: DataColumns
    before: Before | None = None

    @property
    def path(self) -> Path:
        """The file, relative to the dataset."""
        return self.claims.path

    @property
    def base(self) -> int:
        """Which frame of the dataset the first of these is."""
        return self.claims.base + self.read.first

    @cached_property
    def counts(self) -> dict[str, Ints]:
        """The columns of the bookkeeping that hold whole numbers, and can be read."""
        names = [name for name in BOOKKEEPING if name != "timestamp" and name in self.read.frames]
        return {name: self.read.frames[name][:, 0].astype(np.int64) for name in names}

    @property
    def timestamp(self) -> Floats | None:
        """Of each frame [s], where it can be read."""
        values = self.read.frames.get("timestamp")
        return None if values is None else values[:, 0].astype(np.float64)

    @cached_property
    def signals(self) -> Columns:
        """What the robot saw and did, each column in one piece, as it will be read again and again.

        LeRobot does not renew the statistics of the rest when it edits a dataset.
        """
        return {name: by_column(values) for name, values in self.read.frames.items() if name not in BOOKKEEPING}

    @cached_property
    def run_starts(self) -> Ints:
        """The first row of each run of frames with one `episode_index`; of all frames, where there is none."""
        number = self.counts.get("episode_index")
        if number is None:
            return np.zeros(1, dtype=np.int64)
        return np.flatnonzero(np.concatenate([[True], np.diff(number) != 0]))

    @property
    def head(self) -> int:
        """How many of its first runs tell what is usual in the file."""
        return int(np.searchsorted(self.run_starts, HEAD_FRAMES))

    @property
    def episodes(self) -> EpisodeIndex:
        """Where episodes end: by the metadata, or by the frames' own `episode_index` where that is nothing to go by."""
        if self.claims.episodes is not None:
            return self.claims.episodes
        starts, number = self.run_starts, self.counts.get("episode_index")
        stops = np.append(starts[1:], self.read.n_rows or 0)
        numbers = np.arange(len(starts)) if number is None else number[starts]
        return EpisodeIndex(self.base + starts, self.base + stops, numbers)

    def fault(
        self, what: str, wrong: Bools, found: object, expected: object, mend: str = "", *, framed: bool = False
    ) -> Fault:
        """Name the first row in which something is wrong, with whose number its place ends, and its frame if wanted."""
        row = int(wrong.argmax())
        place, rows = f"{what} in row {self.read.first + row}", Rows(found, int(wrong.sum()))
        return Fault(
            self.path, place, rows, expected, mend, self.episodes_in(wrong), self.base + row if framed else None
        )

    def episodes_at(self, rows: Ints) -> Ints:
        """Return the episode of each of these rows: as the frames say, or by its place in the file."""
        number = self.counts.get("episode_index")
        return np.arange(len(rows)) if number is None else number[rows]

    def episodes_in(self, rows: Bools) -> tuple[int, ...]:
        """List the episodes of some of the rows; none where the frames do not say which one they are of."""
        return episodes_in(self.read.frames, rows)


class RunStats(NamedTuple):
    """One feature in each run of frames: float64[n_runs] and float64[n_runs, size].

    `n` is the number of frames, `squares` the sum of the squared distances from the mean, `step` the largest step from
    one frame to the next, `spike` the largest step that the next one takes back.
    """

    n: Floats
    low: Floats
    high: Floats
    mean: Floats
    squares: Floats
    step: Floats
    spike: Floats

    @property
    def std(self) -> Floats:
        """The standard deviation in each run, float64[n_runs, size]."""
        std: Floats = np.sqrt(self.squares / self.n[:, None])
        return std

    def column(self, column: int) -> "RunStats":
        """Return those of one column: all float64[n_runs]."""
        return RunStats(self.n, *(each[:, column] for each in self[1:]))

    def first(self, n_runs: int) -> "RunStats":
        """Return the first runs."""
        return RunStats(*(each[:n_runs] for each in self))

    def together(self) -> "RunStats":
        """Return all runs as if they were one."""
        n, weight = self.n.sum(keepdims=True), self.n[:, None]
        mean = (self.mean * weight).sum(axis=0, keepdims=True) / n
        squares = (self.squares + weight * np.square(self.mean - mean)).sum(axis=0, keepdims=True)
        high, step, spike = (each.max(axis=0, keepdims=True) for each in (self.high, self.step, self.spike))
        return RunStats(n, self.low.min(axis=0, keepdims=True), high, mean, squares, step, spike)


def file_claims(claims: Claims, *, under_mode: bool) -> list[FileClaims]:
    """Say of each data file what the metadata says of it."""
    bases = _first_frames(claims, under_mode=under_mode)
    ends = [*bases[1:], np.iinfo(np.int64).max]
    return [_claims_of(claims, number, base, end) for number, (base, end) in enumerate(zip(bases, ends, strict=True))]


def _claims_of(claims: Claims, file_number: int, base: int, next_base: int) -> FileClaims:
    """Keep the episodes that the file is said to hold, and those whose frames it would hold: no more go with it."""
    table, own = claims.table, claims.table.file_number == file_number
    n_claimed = int(table.length[own].sum())
    there = (table.start < max(next_base, base + n_claimed)) & (table.stop > base)
    episodes = claims.episodes.only(own | there) if claims.trusted else None
    return FileClaims(
        claims.paths[file_number], base, n_claimed, rules.episodes_of(table.number, own), episodes, claims.misread
    )


def _first_frames(claims: Claims, *, under_mode: bool) -> list[int]:
    """Say which frame each file begins with: by the metadata, or by the rows where that does not hang together."""
    table = claims.table
    if claims.trusted and not under_mode:
        return [int(table.start[table.file_number == number].min()) for number in range(len(claims.paths))]
    bases = [0]
    for number, path in enumerate(claims.paths):
        n_rows = count_rows(claims.root, path)
        bases.append(bases[-1] + (int(table.length[table.file_number == number].sum()) if n_rows is None else n_rows))
    return bases[:-1]
