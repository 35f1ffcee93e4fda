"""Fact two: the episode index. Where does one demonstration end and the next begin?

The frames of all episodes lie one after another in the data files. `meta/episodes/` holds one row for each episode,
which says which frames are its own and which data file they are in.
"""

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np

from z2r.arrays import Bools, Ints
from z2r.errors import DatasetError, Fault, some
from z2r.format.store import find, inside

EPISODES_DIR = Path("meta/episodes")
DATA_DIR = Path("data")  # what is wrong with an episode, or with all of them, is wrong in some data file


class EpisodeTable(NamedTuple):
    """What the episode metadata says, a row for each episode: all int64[n_episodes].

    Attributes
    ----------
    number : ndarray
        What the dataset calls the episode: its `episode_index`.
    start, stop : ndarray
        Its first frame and one past its last, counted over the whole dataset.
    length : ndarray
        How many frames it has.
    file_number : ndarray
        Which data file it is in: files are counted in the order of their numbers, over those that are named.
    """

    number: Ints
    start: Ints
    stop: Ints
    length: Ints
    file_number: Ints


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
    >>> index
    EpisodeIndex(2 episodes, 8 frames)
    >>> index.lengths.tolist(), index[1]
    ([3, 5], slice(3, 8, None))
    """

    from_index: Ints
    to_index: Ints
    numbers: Ints = field(default_factory=lambda: np.empty(0, np.int64))

    def __post_init__(self) -> None:
        if not len(self.numbers):
            object.__setattr__(self, "numbers", np.arange(len(self.from_index)))

    def __repr__(self) -> str:
        return f"EpisodeIndex({len(self):,} episodes, {self.n_frames:,} frames)"

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

    def one(self, number: int) -> "EpisodeIndex":
        """Return the index of the one episode that the dataset calls so.

        Raises
        ------
        ValueError
            If there is none: the message lists those that there are.

        Examples
        --------
        >>> EpisodeIndex(np.array([0, 3]), np.array([3, 8])).one(1).from_index
        array([3])
        """
        if number in self.numbers:
            return self.only(self.numbers == number)
        low, high = int(self.numbers.min()), int(self.numbers.max())
        all_there = high - low + 1 == len(self) > 1
        choices = f"one of {low} to {high}" if all_there else f"one of {some(self.numbers.tolist())}"
        raise ValueError(f"found no episode {number}, expected {choices}")

    def moved(self, n_frames: int) -> "EpisodeIndex":
        """Return the index of the same episodes where so many more frames come before them."""
        return EpisodeIndex(self.from_index + n_frames, self.to_index + n_frames, self.numbers)

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


def shard_paths(root: Path) -> list[Path]:
    """Find the metadata shards, in the order of their numbers.

    Raises
    ------
    DatasetError
        If there is none, or one leads out of the dataset.
    """
    shards = [inside(root, shard) for shard in find(root, EPISODES_DIR, "chunk-*/file-*.parquet")]
    if not shards:
        mend = "Without it nobody knows where an episode ends; a recording that crashed never wrote it"
        found = "no file-*.parquet in a chunk-* folder"
        raise DatasetError(Fault(root / EPISODES_DIR, "", found, "at least one", mend))
    return sorted(shards, key=file_numbers)


def file_numbers(path: Path) -> list[int]:
    """Sort key: file-1000 comes after file-999, which sorting by name gets wrong."""
    return [int(number) for number in re.findall(r"\d+", f"{path.parent.name}/{path.name}")]
