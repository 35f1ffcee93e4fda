"""What can be read of the tables of a dataset? Everything that can, with a fault for everything that cannot.

The reader of a whole dataset (`z2r.format.dataset`) wants all or nothing and stops at the first fault; the audit and
the salvage go on. All of them read with what stands here.
"""

from collections.abc import Collection, Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from z2r.arrays import Array, Bools, Columns, Ints
from z2r.errors import DatasetError, Fault, some
from z2r.format import rules
from z2r.format.episodes import EpisodeTable, file_numbers, shard_paths
from z2r.format.parquet import (
    NUMERIC,
    check_readable,
    count_values,
    dtype_of,
    gap_rows,
    integers,
    open_parquet,
    read_blocks,
    read_columns,
    texts,
    vectors,
    width,
)
from z2r.format.schema import BOOKKEEPING, INFO_PATH, MAX_SIGNAL_SIZE, Feature, Schema, data_file_path, read_info
from z2r.format.store import inside, read_bytes

TASKS_PATH = Path("meta/tasks.parquet")
STATS_PATH = Path("meta/stats.json")
EPISODE_COLUMNS = (
    "episode_index",
    "length",
    "dataset_from_index",
    "dataset_to_index",
    "data/chunk_index",
    "data/file_index",
)
STATISTICS = ("count", "min", "max", "mean", "std")
QUANTILES = ("q01", "q10", "q50", "q90", "q99")
"""Of each feature, as LeRobot names them; the quantiles it estimates."""

_MAX_STATS_BYTES = 2**24  # as Python's own numbers they take ten times as much


class Read[T](NamedTuple):
    """What was read, and what could not be; the faults name files relative to the dataset."""

    value: T
    faults: tuple[Fault, ...] = ()


# --- meta/info.json


class Stated(msgspec.Struct, frozen=True):
    """What `meta/info.json` states beside the schema."""

    total_tasks: int | None = None
    splits: dict[str, str] | None = None
    video_path: str | None = None


def read_stated(root: Path) -> Read[Stated]:
    """Read what `meta/info.json` states beside the schema, which was read before."""
    try:
        return Read(msgspec.json.decode(read_info(root), type=Stated))
    except msgspec.ValidationError as error:
        what, _, where = str(error).partition(" - at `$.")
        fault = Fault(INFO_PATH, where.rstrip("`"), "another type", what.removeprefix("Expected "))
        return Read(Stated(), (fault,))


# --- the episode metadata


class Episodes(NamedTuple):
    """The episode metadata, as far as it can be read.

    Attributes
    ----------
    table : EpisodeTable
        A row for each episode; there may be none.
    files : tuple of Path
        The data files that are named, in the order of their numbers, relative to the dataset.
    shards : tuple of Path
        The shards that can be read, relative to the dataset.
    skipped : tuple of Fault
        Where a shard seems to be missing: their numbers do not count on.
    """

    table: EpisodeTable
    files: tuple[Path, ...]
    shards: tuple[Path, ...]
    skipped: tuple[Fault, ...]


def read_shard(path: Path) -> dict[str, Ints]:
    """Read the columns of one metadata shard that say where its episodes are, a row for each.

    Raises
    ------
    DatasetError
        If the shard is unreadable, or a column is missing or does not hold whole numbers.
    """
    return _place_columns(open_parquet(path), path)


def join_shards(schema: Schema, shards: Sequence[Mapping[str, Ints]]) -> tuple[EpisodeTable, tuple[Path, ...]]:
    """Put the rows of all shards into one table, and list the data files that they name."""
    nothing = np.array([], dtype=np.int64)
    columns = {name: np.concatenate([nothing, *(shard[name] for shard in shards)]) for name in EPISODE_COLUMNS}
    file_number, pointers = count_files(columns["data/chunk_index"], columns["data/file_index"])
    table = EpisodeTable(
        number=columns["episode_index"],
        start=columns["dataset_from_index"],
        stop=columns["dataset_to_index"],
        length=columns["length"],
        file_number=file_number,
    )
    return table, tuple(data_file_path(schema, *pointer) for pointer in pointers)


def read_episodes(root: Path, schema: Schema) -> Read[Episodes]:
    """Read the shards of the episode metadata that can be read, with all of their columns, as LeRobot does."""
    try:
        paths = shard_paths(root)
    except DatasetError as error:
        return Read(Episodes(*join_shards(schema, []), (), ()), (error.fault.relative_to(root),))
    skipped = tuple(_skipped_numbers([path.relative_to(root) for path in paths]))
    faults: list[Fault] = []
    shards: dict[Path, dict[str, Ints]] = {}
    for path in paths:
        relative = path.relative_to(root)
        try:
            parquet = open_parquet(path)
            stored = parquet.schema_arrow.names
            check_readable(parquet, path)
            if "tasks" not in stored:
                faults.append(Fault(relative, "tasks", "no such column", "the tasks of each episode"))
            shards[relative] = _place_columns(parquet, path)
        except DatasetError as error:
            faults.append(error.fault.relative_to(root))
    table, files = join_shards(schema, list(shards.values()))
    if not (skipped or faults):
        faults += rules.some_episode(table)
    return Read(Episodes(table, files, tuple(shards), skipped), tuple(faults))


class ShardStatistics(NamedTuple):
    """The statistics of each episode of a shard: what is stored for a feature, by their kind, (n_rows, size)."""

    numbers: Ints
    stored: dict[str, Columns]


def read_shard_statistics(
    root: Path, shard: Path, features: Mapping[str, Feature], kinds: Sequence[str] = STATISTICS
) -> Read[ShardStatistics]:
    """Read the statistics that stand in a shard, which `read_episodes` found to be readable, beside its episodes."""
    path, faults = root / shard, []
    parquet = open_parquet(path)
    numbers = integers(read_columns(parquet, path, ["episode_index"]), "episode_index", path)
    stored: dict[str, Columns] = {}
    for name, feature in features.items():
        try:
            stored[name] = _statistics_of(parquet, path, name, feature, kinds)
        except DatasetError as error:
            faults.append(error.fault.relative_to(root))
    return Read(ShardStatistics(numbers, stored), tuple(faults))


def _statistics_of(parquet: pq.ParquetFile, path: Path, name: str, feature: Feature, kinds: Sequence[str]) -> Columns:
    present = parquet.schema_arrow.names
    columns = {kind: f"stats/{name}/{kind}" for kind in kinds if f"stats/{name}/{kind}" in present}
    table = read_columns(parquet, path, list(columns.values()))
    return {
        kind: vectors(table, column, (1,) if kind == "count" else feature.shape, path)
        for kind, column in columns.items()
    }


def _place_columns(parquet: pq.ParquetFile, path: Path) -> dict[str, Ints]:
    table = read_columns(parquet, path, EPISODE_COLUMNS)
    return {name: integers(table, name, path) for name in EPISODE_COLUMNS}


def count_files(chunk: Ints, file: Ints) -> tuple[Ints, list[tuple[int, int]]]:
    """Count the data files in the order of their numbers: which one each row names, and what each is called."""
    order = np.lexsort((file, chunk))
    pointers = np.stack([chunk, file])[:, order]  # (2, n_rows)
    begins = np.any(pointers[:, 1:] != pointers[:, :-1], axis=0)
    number = np.empty(len(order), dtype=np.int64)
    number[order] = np.concatenate([[0], np.cumsum(begins)])[: len(order)]
    first = np.concatenate([[True], begins])[: len(order)]
    return number, list(zip(*pointers[:, first].tolist(), strict=True))


def _skipped_numbers(shards: Sequence[Path]) -> Iterator[Fault]:
    """Shards count on within a chunk, or begin the next one."""
    before = [0, -1]
    for shard in shards:
        numbers = file_numbers(shard)
        if numbers not in ([before[0], before[1] + 1], [before[0] + 1, 0]):
            found = f"this shard after file {before[1]} of chunk {before[0]}" if before[1] >= 0 else "this shard first"
            expected = f"file {before[1] + 1} of chunk {before[0]}"
            yield Fault(shard, "", found, expected, "A shard is missing: copy or download it again")
        before = [*numbers, 0, 0][:2]


# --- tasks and statistics


class Tasks(NamedTuple):
    """The tasks, in the order of their numbers: what frames call them, int64[n_tasks], and what they say."""

    number: Ints
    text: list[str]


def read_tasks(root: Path) -> Read[Tasks | None]:
    """Read the tasks; None where they cannot be read."""
    try:
        number, text = _task_table(inside(root, TASKS_PATH))
    except DatasetError as error:
        return Read(None, (error.fault.relative_to(root),))
    order = np.argsort(number, kind="stable")
    tasks = Tasks(number[order], [text[row] for row in order.tolist()])
    if np.array_equal(number, np.arange(len(number))) and len(number):
        return Read(tasks)
    found = some(number.tolist()) or "no task"
    mend = "LeRobot takes the first row for task 0, the second for task 1"
    return Read(tasks, (Fault(TASKS_PATH, "task_index", found, "0, 1, 2 ... in order", mend),))


def _task_table(path: Path) -> tuple[Ints, list[str]]:
    parquet = open_parquet(path)
    stored = parquet.schema_arrow  # the text is in the index of a pandas table, whose name may be any
    names = [field.name for field in stored if pa.types.is_string(field.type) or pa.types.is_large_string(field.type)]
    tasks = integers(read_columns(parquet, path, ["task_index"]), "task_index", path)
    for name in names:
        said = texts(parquet, name, path)
        whole = [text for text in said if text is not None]
        if len(whole) == len(said):
            return tasks, whole
    raise DatasetError(Fault(path, "task", "no such column, or gaps in it", "the text of each task"))


def read_stats(root: Path) -> Read[dict[str, dict[str, Any]] | None]:
    """Read the stored statistics of each feature, None where they cannot be read; a policy scales its input by them."""
    expected = "the statistics of each feature"
    try:
        raw = read_bytes(inside(root, STATS_PATH), _MAX_STATS_BYTES, expected)
        return Read(msgspec.json.decode(raw, type=dict[str, dict[str, Any]]))
    except DatasetError as error:
        return Read(None, (error.fault.relative_to(root),))
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
        return Read(None, (Fault(STATS_PATH, "", f"broken JSON ({error})", expected),))


# --- the frames of one data file


class DataColumns(NamedTuple):
    """What can be read of one data file, or of a block of its rows.

    Attributes
    ----------
    first : int
        Which row of the file the block begins with.
    n_rows : int or None
        None where the file cannot be read.
    frames : dict of str to ndarray
        The numeric features that are whole, each (n_rows, size); empty where there is no row.
    present : tuple of str
        The names of the columns.
    dtypes : dict of str to str
        The dtype of each numeric feature that has the shape which the schema says.
    widths : dict of str to int
        How many numbers each row holds, where that is the same in all rows: of what is too wide to be read, or of all
        where nothing else is.
    unreadable : tuple of Fault
        The file.
    misshapen, missing, unfinite : dict of str to Fault
        Columns that are not what the schema says; those with nothing in a row; those with NaN or infinity.
    """

    first: int
    n_rows: int | None
    frames: Columns
    present: tuple[str, ...]
    dtypes: dict[str, str]
    widths: dict[str, int]
    unreadable: tuple[Fault, ...]
    misshapen: dict[str, Fault]
    missing: dict[str, Fault]
    unfinite: dict[str, Fault]

    @property
    def broken(self) -> set[str]:
        """The columns that are not whole."""
        return {*self.misshapen, *self.missing, *self.unfinite}

    @property
    def faults(self) -> tuple[Fault, ...]:
        """All of them, the worst first."""
        columns = self.misshapen, self.missing, self.unfinite
        return (*self.unreadable, *(fault for faults in columns for fault in faults.values()))

    def part(self, start: int, stop: int) -> "DataColumns":
        """Return some of its rows."""
        frames = {name: values[start:stop] for name, values in self.frames.items()}
        return self._replace(first=self.first + start, n_rows=stop - start, frames=frames)


def read_data_file(root: Path, schema: Schema, path: Path) -> DataColumns:
    """Read the numeric columns of a data file; `path` is relative to `root`."""
    try:
        opened = open_parquet(inside(root, path))
        wanted = _wanted(schema, opened.schema_arrow)
        large = _too_large(schema, path, opened)
        wanted = [name for name in wanted if name not in large]
        table = read_columns(opened, path, wanted)
        return _also_misshapen(_data_columns(schema, path, opened.schema_arrow, wanted, table, 0), large)
    except DatasetError as error:
        return _unreadable(root, error)


def read_data_footer(root: Path, schema: Schema, path: Path) -> DataColumns:
    """Read what the footer of a data file says of its columns, and no frame; `path` is relative to `root`."""
    try:
        opened = open_parquet(inside(root, path))
    except DatasetError as error:
        return _unreadable(root, error)
    stored = opened.schema_arrow
    kinds = {
        name: stored.field(name).type for name, feature in schema.features.items() if _is_once(name, feature, stored)
    }
    dtypes = {name: leaf for name, kind in kinds.items() if (leaf := dtype_of(kind))}
    widths = {name: size for name, kind in kinds.items() if (size := width(kind)) is not None}
    return DataColumns(0, opened.metadata.num_rows, {}, tuple(stored.names), dtypes, widths, (), {}, {}, {})


def _is_once(name: str, feature: Feature, stored: pa.Schema) -> bool:
    return feature.is_numeric and stored.names.count(name) == 1


def read_data_blocks(
    root: Path, schema: Schema, path: Path, least: int, *, alone: bool = True
) -> Iterator[DataColumns]:
    """Read what `read_data_file` does, some episodes at a time, so that memory does not grow with the file.

    Only an episode is held at once, however long it is, and so is a file that does not say which episodes it holds.

    Parameters
    ----------
    root, schema, path
        As for `read_data_file`.
    least : int
        So many rows has the first block, where the file has as many.
    alone : bool, optional
        Whether no other file is read beside this one.

    Yields
    ------
    DataColumns
        With the columns that are whole in all of the file. That one is not may be seen late: a block that begins with
        row 0 begins the file again, and what came before is void. What the last one says is wrong is so in the file.
    """
    try:
        whole = inside(root, path)
        opened = open_parquet(whole)
        large = _too_large(schema, path, opened)
        seen: list[DataColumns] = []
        n_rows = opened.metadata.num_rows
        blocks = _of_whole_episodes(
            _until_broken(_blocks(opened, whole, schema, path, large, alone), seen), least, n_rows
        )
        yield from (_also_misshapen(block, large) for block in blocks)
        found = _join_blocks(seen)
        if len(seen) > 1 and found.broken:
            again = _blocks(opened, whole, schema, path, found.broken | large.keys(), alone)
            blocks = _of_whole_episodes(again, least, n_rows)
            yield from (_also_misshapen(_saying_of(found, each), large) for each in blocks)
    except DatasetError as error:
        yield _unreadable(root, error)


def _blocks(
    opened: pq.ParquetFile, whole: Path, schema: Schema, path: Path, left_out: Collection[str], alone: bool
) -> Iterator[DataColumns]:
    stored, first = opened.schema_arrow, 0
    wanted = [name for name in _wanted(schema, stored) if name not in left_out]
    for table in read_blocks(opened, whole, wanted, alone=alone):
        yield _data_columns(schema, path, stored, wanted, table, first)
        first += len(table)


def _too_large(schema: Schema, path: Path, opened: pq.ParquetFile) -> dict[str, Fault]:
    """Name the columns that hold more numbers than their shape says, which are not decoded: few bytes may be many."""
    n_rows, counts = opened.metadata.num_rows, count_values(opened, _wanted(schema, opened.schema_arrow))
    faults = ((name, rules.too_many(path, name, schema.features[name], n, n_rows)) for name, n in counts.items())
    return {name: fault for name, found in faults for fault in found}


def _also_misshapen(read: DataColumns, faults: dict[str, Fault]) -> DataColumns:
    return read._replace(misshapen=read.misshapen | faults)


def _saying_of(file: DataColumns, block: DataColumns) -> DataColumns:
    """Return the frames of a block, with what is said of the whole file."""
    return file._replace(first=block.first, n_rows=block.n_rows, frames=block.frames)


def _until_broken(blocks: Iterator[DataColumns], seen: list[DataColumns]) -> Iterator[DataColumns]:
    """Hand blocks on until a column is broken that was whole before; see what is said of the file in all of them."""
    broken: set[str] = set()
    for block in blocks:
        seen.append(block._replace(frames={}))
        broken |= block.broken
        if len(seen) == 1 or not broken:
            yield block


def _of_whole_episodes(blocks: Iterator[DataColumns], least: int, n_rows: int) -> Iterator[DataColumns]:
    """Cut blocks of a file of so many rows anew, where an episode begins; what comes after waits for the rest of it."""
    waiting: list[DataColumns] = []
    for block in blocks:
        is_last = block.first + (block.n_rows or 0) == n_rows
        rest, cut = block, None if is_last else _last_beginning(waiting, block)
        if cut is not None and block.first + cut >= least:
            yield _join_blocks([*waiting, block.part(0, cut)])
            waiting, rest = [], block.part(cut, block.n_rows or 0)
        waiting.append(rest)
    yield _join_blocks(waiting)


def _last_beginning(before: Sequence[DataColumns], block: DataColumns) -> int | None:
    """Return the last row of a block in which an episode begins; None where none does, or where nobody knows."""
    if any("episode_index" not in each.frames for each in (*before[-1:], block)):
        return None
    number = block.frames["episode_index"][:, 0]
    last = before[-1].frames["episode_index"][-1:, 0] if before else number[:1]
    begins = np.flatnonzero(np.concatenate([last, number[:-1]]) != number)
    return int(begins[-1]) if len(begins) else None


def _join_blocks(blocks: Sequence[DataColumns]) -> DataColumns:
    """Put blocks that follow each other together, with the frames of columns that all of them have."""
    if len(blocks) == 1:
        return blocks[0]
    names = [name for name in blocks[0].frames if all(name in block.frames for block in blocks)]
    whole = {name: dtype for name, dtype in blocks[0].dtypes.items() if all(name in block.dtypes for block in blocks)}
    missing = _join_faults([block.missing for block in blocks])
    misshapen = _join_faults([block.misshapen for block in blocks], missing)
    unfinite = _join_faults([block.unfinite for block in blocks], missing | misshapen)
    if "episode_index" not in whole:
        missing, unfinite = (
            {name: fault._replace(episodes=()) for name, fault in each.items()} for each in (missing, unfinite)
        )
    return blocks[0]._replace(
        n_rows=sum(block.n_rows or 0 for block in blocks),
        frames={name: np.concatenate([block.frames[name] for block in blocks]) for name in names},
        dtypes=whole,
        misshapen=misshapen,
        missing=missing,
        unfinite=unfinite,
    )


def _join_faults(blocks: Sequence[Mapping[str, Fault]], without: Collection[str] = ()) -> dict[str, Fault]:
    names = dict.fromkeys(name for block in blocks for name in block if name not in without)
    return {name: rules.together([block[name] for block in blocks if name in block]) for name in names}


def _wanted(schema: Schema, stored: pa.Schema) -> list[str]:
    known = set(stored.names) & set(schema.features)
    return [name for name in (*schema.signals(), *BOOKKEEPING) if name in known]


def _unreadable(root: Path, error: DatasetError) -> DataColumns:
    return DataColumns(0, None, {}, (), {}, {}, (error.fault.relative_to(root),), {}, {}, {})


def _data_columns(
    schema: Schema, path: Path, stored: pa.Schema, wanted: Sequence[str], table: pa.Table, first: int
) -> DataColumns:
    """Take the columns apart of which all rows, from row `first` of the file on, are as they should be."""
    frames: Columns = {}
    dtypes: dict[str, str] = {}
    misshapen: dict[str, Fault] = {}
    broken: tuple[dict[str, tuple[Fault, Bools]], ...] = ({}, {})
    for name in wanted:
        try:
            values = vectors(table, name, schema.features[name].shape, path, first)
            _check_kind(path, name, values)
        except DatasetError as error:
            rows = gap_rows(table, name)
            if rows.any():
                place = f"{name} in row {first + int(rows.argmax())}"
                found = rules.Rows("no value", int(rows.sum()))
                broken[0][name] = Fault(path, place, found, NUMERIC), rows
            else:
                misshapen[name] = error.fault
            continue
        dtypes[name] = values.dtype.name
        for fault in rules.finite(path, name, schema.features[name], values, first):
            broken[1][name] = fault, _unfinite_rows(values)
        if len(table) and name not in broken[1]:
            frames[name] = values
    missing, unfinite = (
        {name: fault._replace(episodes=episodes_in(frames, rows)) for name, (fault, rows) in each.items()}
        for each in broken
    )
    widths = dict(_wide(schema, stored))
    return DataColumns(first, len(table), frames, tuple(stored.names), dtypes, widths, (), misshapen, missing, unfinite)


def episodes_in(frames: Columns, rows: Bools) -> tuple[int, ...]:
    """List the episodes of some rows of a data file; none where the frames do not say which one they are of."""
    number = frames.get("episode_index")
    return () if number is None else rules.episodes_of(number[:, 0].astype(np.int64), rows)


def count_rows(root: Path, path: Path) -> int | None:
    """Return how many rows a data file has; None where it cannot be opened."""
    try:
        n_rows: int = open_parquet(inside(root, path)).metadata.num_rows
    except DatasetError:
        return None
    return n_rows


def _unfinite_rows(values: Array) -> Bools:
    return np.logical_not(np.isfinite(values).all(axis=1))


def _check_kind(path: Path, name: str, values: Array) -> None:
    kinds = "iu" if name in BOOKKEEPING and name != "timestamp" else "biuf"
    if values.dtype.kind not in kinds:
        raise DatasetError(Fault(path, name, f"values of type {values.dtype}", "whole numbers"))


def _wide(schema: Schema, stored: pa.Schema) -> Iterator[tuple[str, int]]:
    for name, feature in schema.features.items():
        if feature.size > MAX_SIGNAL_SIZE and feature.is_numeric and name in stored.names:
            found = width(stored.field(name).type)
            if found is not None:
                yield name, found
