"""Fact two: the episode index. Where does one demonstration end and the next begin?

The frames of all episodes lie one after another in the data files. `meta/episodes/` holds one row for each episode,
which says which frames are its own and which data file they are in.
"""

import re
from dataclasses import dataclass, field
from pathlib import Path

import numpy as np

from z2r.arrays import Bools, Ints
from z2r.errors import DatasetError, Fault
from z2r.format.parquet import integers, open_parquet, read_columns
from z2r.format.schema import INFO_PATH, Schema, data_file_path, inside

EPISODES_DIR = Path("meta/episodes")
COLUMNS = (
    "episode_index",
    "length",
    "dataset_from_index",
    "dataset_to_index",
    "data/chunk_index",
    "data/file_index",
)


@dataclass(frozen=True, eq=False)
class EpisodeIndex:
    """Which frames belong to which episode.

    Attributes
    ----------
    from_index : ndarray, int64[n_episodes]
        The first frame of each episode, counted over the whole dataset.
    to_index : ndarray, int64[n_episodes]
        One past the last frame of each episode.
    numbers : ndarray, int64[n_episodes], optional
        What the dataset calls each episode, where some are left out; 0, 1, 2 ... unless given.

    Examples
    --------
    >>> index = EpisodeIndex(from_index=np.array([0, 3]), to_index=np.array([3, 8]))
    >>> len(index), index.lengths.tolist(), index[1]
    (2, [3, 5], slice(3, 8, None))
    """

    from_index: Ints
    to_index: Ints
    numbers: Ints = field(default_factory=lambda: np.empty(0, np.int64))

    def __post_init__(self) -> None:
        if not len(self.numbers):
            object.__setattr__(self, "numbers", np.arange(len(self.from_index)))

    def __len__(self) -> int:
        return len(self.from_index)

    def __getitem__(self, episode: int) -> slice:
        """Return the slice that cuts one episode out of an array with a row for every frame."""
        return slice(int(self.from_index[episode]), int(self.to_index[episode]))

    @property
    def lengths(self) -> Ints:
        """Number of frames in each episode, int64[n_episodes]."""
        return self.to_index - self.from_index

    @property
    def n_frames(self) -> int:
        """Number of frames in all episodes together."""
        return int(self.lengths.sum())

    @property
    def frame_numbers(self) -> Ints:
        """The frames of all episodes one after another, int64[n_frames]: 0, 1, 2 ... unless a reading is wrong."""
        shift = self.from_index - (np.cumsum(self.lengths) - self.lengths)
        frames: Ints = np.arange(self.n_frames) + np.repeat(shift, self.lengths)
        return frames

    def number(self, episode: int) -> int:
        """Return what the dataset calls the episode that comes at this place, counted from 0."""
        return int(self.numbers[episode])

    def only(self, kept: slice | Bools) -> "EpisodeIndex":
        """Return the index of some of the episodes; each keeps its number."""
        return EpisodeIndex(self.from_index[kept], self.to_index[kept], self.numbers[kept])

    def merged(self) -> "EpisodeIndex":
        """Return the index that a reader would have who does not know of episodes: all frames are one."""
        return EpisodeIndex(self.from_index[:1], self.to_index[-1:])


def parts_within(episodes: EpisodeIndex, from_index: int, to_index: int) -> tuple[Ints, Ints, Ints]:
    """Find the parts of episodes that lie in a range of frames, such as that of a data file.

    Returns
    -------
    place, start, stop : ndarray, int64[n_parts]
        Which episodes have a part there, by their place in the index; and where it starts and stops, counted from the
        first frame of the range.

    Examples
    --------
    >>> index = EpisodeIndex(from_index=np.array([0, 3]), to_index=np.array([3, 8]))
    >>> [part.tolist() for part in parts_within(index, 2, 6)]
    [[0, 1], [0, 1], [1, 4]]
    """
    place = np.flatnonzero((episodes.from_index < to_index) & (episodes.to_index > from_index))
    start = np.maximum(episodes.from_index[place], from_index) - from_index
    stop = np.minimum(episodes.to_index[place], to_index) - from_index
    return place, start, stop


@dataclass(frozen=True)
class DataFile:
    """One parquet file of frames, and which frames of the dataset it holds: `from_index` up to `to_index`."""

    path: Path
    from_index: int
    to_index: int


def read_episodes(root: Path, schema: Schema) -> tuple[EpisodeIndex, tuple[DataFile, ...]]:
    """Read the episode index, and find the data files that it points at.

    Parameters
    ----------
    root : Path
        The folder of a LeRobot v3 dataset.
    schema : Schema
        From `z2r.format.schema.read_schema`.

    Returns
    -------
    EpisodeIndex
        All episodes, in order.
    tuple of DataFile
        In the order of their frames.

    Raises
    ------
    DatasetError
        If there is no episode, or a metadata shard is unreadable, or the rows do not tell one story: episodes numbered
        0, 1, 2 ..., each beginning where the one before ends, as long as their ranges, and as many as the schema says.
    """
    rows = [read_shard(shard) for shard in shard_paths(root)]
    columns = {name: np.concatenate([row[name] for row in rows]) for name in COLUMNS}
    _check_one_story(columns, root / EPISODES_DIR)
    index = EpisodeIndex(columns["dataset_from_index"], columns["dataset_to_index"])
    _check_totals(index, schema, root / INFO_PATH)
    return index, _data_files(root, schema, columns)


def shard_paths(root: Path) -> list[Path]:
    """Find the metadata shards, in the order of their numbers.

    Raises
    ------
    DatasetError
        If there is none, or one leads out of the dataset.
    """
    shards = [inside(root, shard.relative_to(root)) for shard in (root / EPISODES_DIR).glob("chunk-*/file-*.parquet")]
    if not shards:
        raise DatasetError(
            Fault(
                root / EPISODES_DIR,
                "",
                "no file-*.parquet in a chunk-* folder",
                "at least one",
                mend="Without it nobody knows where an episode ends; a recording that crashed never wrote it",
            )
        )
    return sorted(shards, key=file_numbers)


def file_numbers(path: Path) -> list[int]:
    """Sort key: file-1000 comes after file-999, which sorting by name gets wrong."""
    return [int(number) for number in re.findall(r"\d+", f"{path.parent.name}/{path.name}")]


def read_shard(path: Path) -> dict[str, Ints]:
    """Read the columns of one metadata shard, a row for each episode.

    Raises
    ------
    DatasetError
        If the shard is unreadable, or a column is missing or does not hold whole numbers.
    """
    table = read_columns(open_parquet(path), path, COLUMNS)
    return {name: integers(table, name, path) for name in COLUMNS}


def _check_one_story(columns: dict[str, Ints], path: Path) -> None:
    number, start, stop = columns["episode_index"], columns["dataset_from_index"], columns["dataset_to_index"]
    if not len(number):
        raise DatasetError(Fault(path, "", "no episodes", "at least one"))
    _check_equal(number, np.arange(len(number)), path, "episode_index")
    _check_equal(start, np.concatenate([[0], stop[:-1]]), path, "dataset_from_index")
    _check_equal(columns["length"], stop - start, path, "length")
    if np.any(stop <= start):
        episode = int(np.argmax(stop <= start))
        raise DatasetError(
            Fault(
                path,
                f"dataset_to_index of episode {episode}",
                f"{stop[episode]}",
                f"more than its dataset_from_index, {start[episode]}",
            )
        )


def _check_equal(found: Ints, expected: Ints, path: Path, field: str) -> None:
    if not np.array_equal(found, expected):
        episode = int(np.argmax(found != expected))
        raise DatasetError(Fault(path, f"{field} of episode {episode}", f"{found[episode]}", f"{expected[episode]}"))


def _check_totals(index: EpisodeIndex, schema: Schema, path: Path) -> None:
    for key, stated, counted in (
        ("total_episodes", schema.total_episodes, len(index)),
        ("total_frames", schema.total_frames, index.n_frames),
    ):
        if stated != counted:
            raise DatasetError(Fault(path, key, f"{stated}", f"{counted}, as meta/episodes says"))


def _data_files(root: Path, schema: Schema, columns: dict[str, Ints]) -> tuple[DataFile, ...]:
    pointer = np.stack([columns["data/chunk_index"], columns["data/file_index"]], axis=1)
    begins = np.concatenate([[True], np.any(pointer[1:] != pointer[:-1], axis=1)])
    first = np.flatnonzero(begins)
    last = np.append(first[1:], len(pointer)) - 1
    files = tuple(
        DataFile(
            path=data_file_path(root, schema, *pointer[episode].tolist()),
            from_index=int(columns["dataset_from_index"][episode]),
            to_index=int(columns["dataset_to_index"][last_episode]),
        )
        for episode, last_episode in zip(first, last, strict=True)
    )
    _check_each_file_once(files, first, root / EPISODES_DIR)
    return files


def _check_each_file_once(files: tuple[DataFile, ...], first_episode: Ints, path: Path) -> None:
    seen: set[Path] = set()
    for file, episode in zip(files, first_episode, strict=True):
        if file.path in seen:
            raise DatasetError(
                Fault(
                    path,
                    f"data/file_index of episode {episode}",
                    f"{file.path.name} again, after another file",
                    "episodes of one file side by side",
                )
            )
        seen.add(file.path)
