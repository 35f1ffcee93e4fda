"""What must hold in a dataset? Each rule once, for who stops at the first fault and for who collects them all.

A rule is a generator of faults, and names files relative to the dataset. The reader raises the first
(`raise_first`), the audit gives each a check and a severity, and goes on.
"""

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from z2r.arrays import Array, Bools, Ints
from z2r.errors import DatasetError, Fault
from z2r.format.episodes import EPISODES_DIR, EpisodeTable
from z2r.format.schema import INFO_PATH, Feature, Schema

_SPARE = 2**21  # numbers
_REBUILD = "The episode metadata was written or edited wrong: rebuild it from the columns of the frames"


def raise_first(root: Path, faults: Iterable[Fault]) -> None:
    """Stop at the first fault.

    Raises
    ------
    DatasetError
        If there is one.
    """
    for fault in faults:
        raise DatasetError(fault.below(root))


class Rows(NamedTuple):
    """What was found in the first of some rows of a file, and how many there are like it: it reads as what was found.

    >>> print(Rows(7, 3))
    7 (and 2 more like it)
    """

    found: object
    n: int

    def __str__(self) -> str:
        return f"{self.found}{and_more(self.n)}"


def together(faults: Sequence[Fault]) -> Fault:
    """Put what is wrong in several blocks of rows, in their order, into the one fault that all rows would have had."""
    first = faults[0]
    rows = [fault.found for fault in faults if isinstance(fault.found, Rows)]
    episodes = tuple(sorted({number for fault in faults for number in fault.episodes}))
    found = rows[0]._replace(n=sum(each.n for each in rows)) if rows else first.found
    return first._replace(found=found, episodes=episodes)


def and_more(wrong: Bools | int) -> str:
    """Say how many more there are beside the first, if any: of those that are wrong, or of so many."""
    more = int(np.sum(wrong)) - 1
    return f" (and {more:,} more like it)" if more else ""


def episodes_of(number: Ints, wrong: Bools | Ints) -> tuple[int, ...]:
    """List the episodes of which something is wrong: their numbers, and which of them, or in which rows."""
    return tuple(np.unique(number[wrong]).tolist())


# --- the episode metadata


def some_episode(table: EpisodeTable) -> Iterator[Fault]:
    """A dataset has at least one episode."""
    if not len(table.number):
        yield Fault(EPISODES_DIR, "", "no episodes", "at least one")


def episode_order(table: EpisodeTable) -> Iterator[Fault]:
    """Episodes are numbered 0, 1, 2 ... in order."""
    expected = np.arange(len(table.number))
    wrong = table.number != expected
    if wrong.any():
        row = int(wrong.argmax())
        yield _row_fault(f"episode_index in row {row}", table, table.number, wrong, f"{expected[row]}")


def range_length(table: EpisodeTable) -> Iterator[Fault]:
    """Every episode has frames, and as many as its range."""
    span = table.stop - table.start
    wrong, empty = table.length != span, table.stop <= table.start
    if wrong.any():
        yield _row_fault(_place("length", table, wrong), table, table.length, wrong, f"{span[int(wrong.argmax())]}")
    if empty.any():
        expected = f"more than {table.start[int(empty.argmax())]}"
        yield _row_fault(_place("dataset_to_index", table, empty), table, table.stop, empty, expected)


def range_overlap(table: EpisodeTable) -> Iterator[Fault]:
    """No frame belongs to two episodes."""
    yield from _not_where_the_one_before_ends(table, table.start < _ends_before(table))


def range_gap(table: EpisodeTable) -> Iterator[Fault]:
    """Every frame belongs to an episode."""
    yield from _not_where_the_one_before_ends(table, table.start > _ends_before(table))


def totals(schema: Schema, table: EpisodeTable) -> Iterator[Fault]:
    """The totals of episodes and frames in `meta/info.json` are those of the episode metadata."""
    counted = (
        ("total_episodes", schema.total_episodes, len(table.number), "rows of meta/episodes"),
        ("total_frames", schema.total_frames, int(table.length.sum()), "frames by meta/episodes"),
    )
    for field, stated, found, what in counted:
        if stated != found:
            yield Fault(INFO_PATH, field, stated, f"{found}, the number of {what}")


def side_by_side(table: EpisodeTable, paths: Sequence[Path]) -> Iterator[Fault]:
    """The episodes of one data file come one after another."""
    first = np.flatnonzero(np.diff(table.file_number, prepend=-1))
    again = np.ones(len(first), dtype=bool)
    again[np.unique(table.file_number[first], return_index=True)[1]] = False
    if again.any():
        row = int(first[again.argmax()])
        found = f"{paths[table.file_number[row]].name} again, after another file"
        field = f"data/file_index of episode {table.number[row]}"
        wrong = np.isin(table.file_number, table.file_number[first[again]])
        named = episodes_of(table.number, wrong)
        yield Fault(EPISODES_DIR, field, found, "episodes of one file side by side", episodes=named)


def _ends_before(table: EpisodeTable) -> Ints:
    """Where the episode before each ends, int64[n_episodes]."""
    return np.concatenate([[0], table.stop])[:-1]


def _not_where_the_one_before_ends(table: EpisodeTable, wrong: Bools) -> Iterator[Fault]:
    wrong = wrong & (table.stop > table.start)  # of an empty range, `range_length` says so
    if wrong.any():
        expected = f"{_ends_before(table)[int(wrong.argmax())]}, where the episode before ends"
        yield _row_fault(_place("dataset_from_index", table, wrong), table, table.start, wrong, expected)


def _place(field: str, table: EpisodeTable, wrong: Bools) -> str:
    return f"{field} of episode {table.number[int(wrong.argmax())]}"


def _row_fault(place: str, table: EpisodeTable, values: Ints, wrong: Bools, expected: str) -> Fault:
    """Name the first wrong row of the metadata."""
    found = f"{values[int(wrong.argmax())]}{and_more(wrong)}"
    return Fault(EPISODES_DIR, place, found, expected, _REBUILD, episodes=episodes_of(table.number, wrong))


# --- one data file


def file_rows(path: Path, n_rows: int, n_claimed: int) -> Iterator[Fault]:
    """A data file has as many rows as the episodes that are in it have frames."""
    if n_rows != n_claimed:
        yield Fault(path, "rows", n_rows, f"{n_claimed}, the frames of its episodes")


def missing_columns(path: Path, features: Iterable[str], present: Sequence[str]) -> Iterator[Fault]:
    """Every feature has a column."""
    for name in features:
        if name not in present:
            yield Fault(path, name, "no such column", "one for each feature in meta/info.json")


def too_many(path: Path, name: str, feature: Feature, n_values: int, n_rows: int) -> Iterator[Fault]:
    """A column does not hold very many more numbers than rows of its shape have; of a few more, a row is named."""
    if n_values > n_rows * feature.size + _SPARE:
        found = f"{n_values:,} numbers in {n_rows:,} rows"
        expected = f"{feature.size:,} numbers in each row, as its shape {feature.shape} in meta/info.json says"
        yield Fault(path, name, found, expected)


def finite(path: Path, name: str, feature: Feature, values: Array, first: int = 0) -> Iterator[Fault]:
    """There is no NaN and no infinity; `values` are those of one feature in a data file from row `first` on."""
    fine = np.isfinite(values)
    if fine.all():
        return
    row, column = np.argwhere(~fine)[0].tolist()
    place = f"{name}[{feature.dim_names[column] if feature.dim_names else column}] in row {first + row}"
    yield Fault(path, place, Rows(values[row, column], int(np.sum(~fine))), "a finite number")
