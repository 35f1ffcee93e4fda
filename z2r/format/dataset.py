"""The frames as numpy arrays, sliced by the episode index: how does one read a dataset that is whole?

It is read whole or not at all: the first fault is an error. What can be read of a damaged one is the business of
`z2r.format.tables`, and what must hold is written down in `z2r.format.rules`.
"""

import os
from collections import deque
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import BrokenExecutor, Executor, Future, ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from itertools import chain
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from z2r.arrays import Array, Columns, Progress, no_progress
from z2r.data.urls import place_of
from z2r.errors import DatasetError, one_error, printable
from z2r.format import parquet, rules
from z2r.format.episodes import DataFile, EpisodeIndex, EpisodeTable, shard_paths
from z2r.format.misread import Misread
from z2r.format.parquet import count_values, open_parquet, read_alike, read_columns, vectors
from z2r.format.schema import ACTION, STATE, Schema, read_schema
from z2r.format.store import all_inside, folder_name, is_far
from z2r.format.tables import DataColumns, join_shards, read_shard

# Each thread holds one data file in memory: more threads than this would trade memory for little time.
_MAX_THREADS = 4
_MAX_WAITING = 64  # data files, or batches of them, that an executor is given at once: enough for as many workers
_SMALL, _MAX_TOGETHER = 2**15, 64  # numbers in a data file that is read together with others, and how many of these


@dataclass(frozen=True, eq=False)
class Dataset:
    """A LeRobot v3 dataset on disk: what a frame is, where episodes end, and which files hold the frames.

    Attributes
    ----------
    root : Path
        The folder.
    schema : Schema
        Fact one.
    episodes : EpisodeIndex
        Fact two.
    files : tuple of DataFile
        The data files, in the order of their frames.
    misread : Misread, optional
        What somebody takes the frames for who is wrong about some columns: they are read so.
    """

    root: Path
    schema: Schema
    episodes: EpisodeIndex
    files: tuple[DataFile, ...]
    misread: Misread | None = None

    def __repr__(self) -> str:
        counts = f"{len(self.episodes):,} episodes, {self.episodes.n_frames:,} frames"
        return f"Dataset({printable(folder_name(self.root))}: {counts})"

    def first(self, n_episodes: int) -> "Dataset":
        """Return the dataset that holds the first `n_episodes` episodes only, and reads no file that it does not need.

        Raises
        ------
        ValueError
            If the dataset has fewer episodes, or `n_episodes` is less than 1.
        """
        if not 1 <= n_episodes <= len(self.episodes):
            raise ValueError(f"found {n_episodes} episodes asked for, expected 1 to {len(self.episodes)}")
        episodes = self.episodes.only(slice(n_episodes))
        end = int(episodes.to_index[-1])
        return replace(self, episodes=episodes, files=tuple(file for file in self.files if file.from_index < end))

    @one_error()
    def read(self, feature: str) -> Array:
        """Read one feature of every frame.

        Parameters
        ----------
        feature : str
            Such as ``observation.state`` or ``action``.

        Returns
        -------
        ndarray, (n_frames, size of the feature), of the dtype in the file
            Cut one episode out of it with the index: ``dataset.read("action")[dataset.episodes[2]]``.

        Raises
        ------
        DatasetError
            If a data file is missing, damaged, or not what the schema and the index say.
        """
        return np.concatenate([frames[feature] for frames in map_files(self, [feature], _keep)])


def load(root: str | os.PathLike[str]) -> Dataset:
    """Read the two structural facts of the dataset in a folder; its frames are read when asked for.

    Raises
    ------
    DatasetError
        If it is no whole LeRobot v3 dataset.
    """
    root = place_of(root)
    schema = read_schema(root)
    episodes, files = _read_episodes(root, schema)
    return Dataset(root, schema, episodes, files)


def map_files[T](
    dataset: Dataset,
    features: Sequence[str],
    fold: Callable[[DataFile, Columns], T],
    progress: Progress = no_progress,
    executor: Executor | None = None,
) -> list[T]:
    """Read the data files, some at a time, and keep only what `fold` makes of each block.

    A block is a data file, a part of a large one, or small ones that follow each other. Which, depends on the dataset
    alone and not on who reads it.
    Memory is bounded by what is in flight, a block for each worker, and not by the number of files or their size.

    Parameters
    ----------
    dataset : Dataset
        What to read.
    features : sequence of str
        Numeric features.
    fold : callable
        Takes a file, whose numbers say which frames a block has, and these: a dict of feature to array, (n_rows, size).
        Where the executor runs in other processes, it and what it returns must survive pickling.
    progress : callable, optional
        Called with the number of frames done and the number of all, after each file.
    executor : Executor, optional
        Who runs it, such as a ``ProcessPoolExecutor``; at most four threads unless given. It is not shut down.

    Returns
    -------
    list
        What `fold` returned, in the order of the frames.

    Raises
    ------
    DatasetError
        If a data file is missing, damaged, or not what the schema and the index say.
    """
    end = int(dataset.episodes.to_index[-1])
    files = [file for file in dataset.files if file.from_index < end]
    if dataset.misread:
        fold = partial(_fold_misread, dataset.misread, dataset.episodes, tuple(features), fold)
        features = tuple(dict.fromkeys((*features, *dataset.misread.needed)))
    read = _whole if dataset.misread else read_blocks  # what is made of an episode may depend on all of its frames
    work = partial(_read_and_fold, read, dataset.root, dataset.schema, tuple(features), fold, end)
    known = set(features) <= set(dataset.schema.features)
    alone = dataset.misread or is_far(dataset.root) or not known  # what is far away is fetched a file for each worker
    batches = [[file] for file in files] if alone else _batches(dataset.schema, files, features)
    results: list[T] = []
    for batch, parts in zip(batches, in_order(work, batches, executor), strict=True):
        results += parts
        for file in batch:
            progress(min(file.to_index, end), end)
    return results


def _batches(schema: Schema, files: Sequence[DataFile], features: Sequence[str]) -> list[list[DataFile]]:
    """Put small files together that follow each other: to handle each by itself costs more than to read it."""
    a_row = sum(schema.features[name].size for name in features)
    batches: list[list[DataFile]] = []
    room = 0
    for file in files:
        small = (file.to_index - file.from_index) * a_row <= _SMALL
        if small and room and batches[-1][-1].to_index == file.from_index:
            batches[-1].append(file)
            room -= 1
        else:
            batches.append([file])
            room = _MAX_TOGETHER - 1 if small else 0
    return batches


def read_frames(root: Path, schema: Schema, file: DataFile, features: Sequence[str], n_rows: int) -> Columns:
    """Read the first `n_rows` frames of one data file of the dataset at `root`.

    Returns
    -------
    dict of str to ndarray, (n_rows, size of the feature)

    Raises
    ------
    DatasetError
        If the file is missing or damaged, has another number of rows than the episode index gives it, lacks a feature,
        or has NaN or infinity in the state or the action.
    """
    table = read_columns(_checked(root, schema, file, features), file.path, features, n_rows)
    return _columns(root, schema, file, features, table, n_rows)


def read_blocks(
    root: Path, schema: Schema, file: DataFile, features: Sequence[str], n_rows: int
) -> Iterator[tuple[DataFile, Columns]]:
    """Read what `read_frames` does, some frames at a time, each with which frames of the file they are.

    Raises
    ------
    DatasetError
        As `read_frames`; rows are counted from the first of those frames on.
    """
    first = file.from_index
    for table in parquet.read_blocks(_checked(root, schema, file, features), file.path, features, n_rows):
        last = min(first + len(table), file.from_index + n_rows)
        try:
            frames = _columns(root, schema, file, features, table, last - first)
        except DatasetError as error:
            if first == file.from_index:
                raise
            place = f"{error.fault.field}, counted from row {first - file.from_index} on"
            raise DatasetError(error.fault._replace(field=place)) from None
        yield replace(file, from_index=first, to_index=last), frames
        first = last


def _checked(root: Path, schema: Schema, file: DataFile, features: Sequence[str]) -> pq.ParquetFile:
    """Open a data file that has the rows and the columns that it should have."""
    path, opened = file.path.relative_to(root), open_parquet(file.path)
    rules.raise_first(root, rules.file_rows(path, opened.metadata.num_rows, file.to_index - file.from_index))
    rules.raise_first(root, rules.missing_columns(path, features, opened.schema_arrow.names))
    for name, n in count_values(opened, features).items():
        rules.raise_first(root, rules.too_many(path, name, schema.features[name], n, opened.metadata.num_rows))
    return opened


def _columns(
    root: Path, schema: Schema, file: DataFile, features: Sequence[str], table: pa.Table, n_rows: int
) -> Columns:
    frames = {name: vectors(table, name, schema.features[name].shape, file.path)[:n_rows] for name in features}
    for name in {STATE, ACTION}.intersection(features):
        path = file.path.relative_to(root)
        rules.raise_first(root, rules.finite(path, name, schema.features[name], frames[name]))
    return frames


def frames_of(
    read: DataColumns, root: Path, schema: Schema, file: DataFile, features: Sequence[str], n_rows: int
) -> Columns:
    """Return what `read_frames` does, of a file that `read_data_file` read.

    Raises
    ------
    DatasetError
        As `read_frames`, which reads the file again where something is wrong with it.
    """
    if read.n_rows == file.to_index - file.from_index and set(features) <= set(read.frames):
        return {name: read.frames[name][:n_rows] for name in features}
    return read_frames(root, schema, file, features, n_rows)


def in_order[A, T](function: Callable[[A], T], items: Sequence[A], executor: Executor | None = None) -> Iterator[T]:
    """Call a function for each item, some at a time, and yield what it returns in the order of the items.

    Parameters
    ----------
    function : callable
        Survives pickling, as do its items and results, where the executor runs in other processes.
    items : sequence
        They are handed out as results are taken: what waits is bounded.
    executor : Executor, optional
        At most four threads unless given. It is not shut down. Where one of its workers is killed, the rest runs here.
    """
    if executor is None:
        with ThreadPoolExecutor(min(_MAX_THREADS, os.cpu_count() or 1)) as threads:
            yield from in_order(function, items, threads)
        return
    waiting: deque[tuple[A, Future[T]]] = deque()
    try:
        for item in items:
            waiting.append((item, _submit(executor, function, item)))
            if len(waiting) == _MAX_WAITING:
                yield _result(function, *waiting.popleft())
        while waiting:
            yield _result(function, *waiting.popleft())
    finally:
        for _, future in waiting:
            future.cancel()


def _submit[A, T](executor: Executor, function: Callable[[A], T], item: A) -> Future[T]:
    try:
        return executor.submit(function, item)
    except BrokenExecutor as error:
        lost: Future[T] = Future()
        lost.set_exception(error)
        return lost


def _result[A, T](function: Callable[[A], T], item: A, future: Future[T]) -> T:
    """Wait for a result; where a worker was killed, and all that waited is lost with it, it is made here."""
    try:
        return future.result()
    except BrokenExecutor:
        return function(item)


def _read_and_fold[T](
    read: Callable[[Path, Schema, DataFile, Sequence[str], int], Iterator[tuple[DataFile, Columns]]],
    root: Path,
    schema: Schema,
    features: Sequence[str],
    fold: Callable[[DataFile, Columns], T],
    end: int,
    batch: Sequence[DataFile],
) -> list[T]:
    block = replace(batch[0], to_index=batch[-1].to_index)
    if len(batch) > 1 and block.to_index <= end and (frames := _read_batch(root, schema, batch, features)):
        return [fold(block, frames)]
    blocks = (read(root, schema, file, features, min(file.to_index, end) - file.from_index) for file in batch)
    return [fold(block, frames) for block, frames in chain.from_iterable(blocks)]


def _read_batch(root: Path, schema: Schema, batch: Sequence[DataFile], features: Sequence[str]) -> Columns | None:
    """Read small files as if they were one; None where something is wrong with one of them, or they are not alike."""
    rows = [(file.path, file.to_index - file.from_index) for file in batch]
    table = read_alike(rows, {name: schema.features[name].size for name in features})
    try:
        return None if table is None else _columns(root, schema, batch[0], features, table, len(table))
    except DatasetError:
        return None


def _whole(
    root: Path, schema: Schema, file: DataFile, features: Sequence[str], n_rows: int
) -> Iterator[tuple[DataFile, Columns]]:
    yield file, read_frames(root, schema, file, features, n_rows)


def _fold_misread[T](
    misread: Misread,
    episodes: EpisodeIndex,
    features: Sequence[str],
    fold: Callable[[DataFile, Columns], T],
    file: DataFile,
    frames: Columns,
) -> T:
    taken = misread(frames, file.from_index, episodes)
    return fold(file, {name: taken[name] for name in features})


def _keep(_: DataFile, frames: Columns) -> Columns:
    return frames


def _read_episodes(root: Path, schema: Schema) -> tuple[EpisodeIndex, tuple[DataFile, ...]]:
    """Read the episode index, and the data files that it points at, in the order of their frames."""
    table, paths = join_shards(schema, [read_shard(path) for path in shard_paths(root)])
    wanted = (rules.some_episode, rules.episode_order, rules.range_overlap, rules.range_gap, rules.range_length)
    rules.raise_first(root, chain.from_iterable(rule(table) for rule in wanted))
    rules.raise_first(root, chain(rules.totals(schema, table), rules.side_by_side(table, paths)))
    return EpisodeIndex(table.start, table.stop), _data_files(root, table, paths)


def _data_files(root: Path, table: EpisodeTable, paths: Sequence[Path]) -> tuple[DataFile, ...]:
    first = np.flatnonzero(np.diff(table.file_number, prepend=-1))
    last = np.append(first[1:], len(table.number)) - 1
    places = all_inside(root, [paths[number] for number in table.file_number[first].tolist()])
    return tuple(map(DataFile, places, table.start[first].tolist(), table.stop[last].tolist()))
