"""The frames as numpy arrays, sliced by the episode index."""

import os
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from z2r.arrays import Array, Columns, Progress, no_progress
from z2r.errors import DatasetError, Fault
from z2r.format.episodes import DataFile, EpisodeIndex, read_episodes
from z2r.format.parquet import open_parquet, read_columns, vectors
from z2r.format.schema import ACTION, STATE, Schema, read_schema

# Each thread holds one data file in memory: more threads than this would trade memory for little time.
_MAX_THREADS = 4


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
    """

    root: Path
    schema: Schema
    episodes: EpisodeIndex
    files: tuple[DataFile, ...]

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
        return np.concatenate([frames[feature] for frames in map_files(self, [feature], lambda _, frames: frames)])


def load(root: str | os.PathLike[str]) -> Dataset:
    """Read the two structural facts of a LeRobot v3 dataset; its frames are read when asked for.

    Parameters
    ----------
    root : str or path
        The folder that holds ``meta/`` and ``data/``.

    Raises
    ------
    DatasetError
        If it is no whole LeRobot v3 dataset.

    Examples
    --------
    >>> import z2r
    >>> dataset = z2r.load(z2r.STANDIN)
    >>> len(dataset.episodes), dataset.schema.fps
    (6, 10)
    """
    root = Path(root)
    schema = read_schema(root)
    episodes, files = read_episodes(root, schema)
    return Dataset(root, schema, episodes, files)


def map_files[T](
    dataset: Dataset,
    features: Sequence[str],
    fold: Callable[[DataFile, Columns], T],
    progress: Progress = no_progress,
) -> list[T]:
    """Read the data files, some at a time, and keep only what `fold` makes of each.

    Memory is bounded by the files in flight, at most one for each of four threads, and not by their number.

    Parameters
    ----------
    dataset : Dataset
        What to read.
    features : sequence of str
        Numeric features.
    fold : callable
        Takes a file and its frames: a dict of feature to array, (n_rows, size).
    progress : callable, optional
        Called with the number of frames done and the number of all, after each file.

    Returns
    -------
    list
        What `fold` returned, in the order of the files.

    Raises
    ------
    DatasetError
        If a data file is missing, damaged, or not what the schema and the index say.
    """
    end = int(dataset.episodes.to_index[-1])

    def read_and_fold(file: DataFile) -> T:
        return fold(file, read_frames(dataset.schema, file, features, min(file.to_index, end) - file.from_index))

    files = [file for file in dataset.files if file.from_index < end]
    results: list[T] = []
    for file, result in zip(files, in_threads(read_and_fold, files), strict=True):
        results.append(result)
        progress(min(file.to_index, end), end)
    return results


def read_frames(schema: Schema, file: DataFile, features: Sequence[str], n_rows: int) -> Columns:
    """Read the first `n_rows` frames of one data file.

    Returns
    -------
    dict of str to ndarray, (n_rows, size of the feature)

    Raises
    ------
    DatasetError
        If the file is missing or damaged, has another number of rows than the episode index gives it, lacks a feature,
        or has NaN or infinity in the state or the action.
    """
    parquet = open_parquet(file.path)
    expected_rows = file.to_index - file.from_index
    if parquet.metadata.num_rows != expected_rows:
        raise DatasetError(
            Fault(
                file.path,
                "rows",
                f"{parquet.metadata.num_rows}",
                f"{expected_rows}, frames {file.from_index} to {file.to_index} of the episode index",
            )
        )
    table = read_columns(parquet, file.path, features, n_rows)
    frames = {name: vectors(table, name, schema.features[name].shape, file.path)[:n_rows] for name in features}
    for name in {STATE, ACTION}.intersection(features):
        _check_finite(frames[name], schema.features[name].dim_names, file, name)
    return frames


def in_threads[A, T](function: Callable[[A], T], items: Sequence[A]) -> Iterator[T]:
    """Call a function for each item, some at a time, and yield what it returns in the order of the items."""
    with ThreadPoolExecutor(min(_MAX_THREADS, os.cpu_count() or 1, len(items))) as pool:
        yield from pool.map(function, items)


def _check_finite(values: Array, names: tuple[str, ...], file: DataFile, feature: str) -> None:
    finite = np.isfinite(values)
    if finite.all():
        return
    row, column = np.argwhere(~finite)[0].tolist()
    raise DatasetError(
        Fault(
            file.path,
            f"{feature}[{names[column] if names else column}] in row {row}",
            f"{values[row, column]} (frame {file.from_index + row} of the dataset)",
            "a finite number",
        )
    )
