"""What does a dataset claim, before a frame is read? Its schema, its index, its totals, and its statistics."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from z2r.arrays import Ints
from z2r.errors import DatasetError, Fault
from z2r.format import rules
from z2r.format.dataset import Dataset, load
from z2r.format.episodes import EpisodeIndex, EpisodeTable
from z2r.format.misread import Misread
from z2r.format.schema import Schema, read_schema
from z2r.format.store import find
from z2r.format.tables import Episodes, Read, Stated, Tasks, read_episodes, read_stated, read_stats, read_tasks
from z2r.format.videos import Spans, read_videos
from z2r.reading.breaks import BreakMode
from z2r.reading.reading import Reading


class NoSchema(NamedTuple):
    """A dataset of which nothing can be read, and why."""

    fault: Fault


class Stored(NamedTuple):
    """The tables that are stored beside the frames, as far as they can be read."""

    schema: Schema
    stated: Read[Stated]
    episodes: Read[Episodes]
    tasks: Read[Tasks | None]
    stats: Read[dict[str, dict[str, Any]] | None]

    @property
    def task_numbers(self) -> Ints | None:
        """What frames call the tasks; None where they cannot be read."""
        return self.tasks.value.number if self.tasks.value else None


class Claims(NamedTuple):
    """What a dataset says of itself, or what somebody believes of it who gets an assumption wrong.

    Attributes
    ----------
    root : Path
        The folder.
    stored : Stored
        All that stands in its tables.
    schema, table, paths : Schema, EpisodeTable, sequence of Path
        What a frame is, where episodes end, and the data files, relative to `root`, in the order of their frames.
    videos : Read of dict of str to Spans
        Where the episodes are in the videos of each camera.
    found : Read of tuple of Path
        The parquet files and videos that are there, named or not, relative to `root`.
    reading : Reading or None
        What the columns are taken to mean.
    trusted : bool
        Whether the table is taken at its word.
    misread : Misread or None
        What some columns are taken for.
    """

    root: Path
    stored: Stored
    schema: Schema
    table: EpisodeTable
    paths: Sequence[Path]
    videos: Read[dict[str, Spans]]
    found: Read[tuple[Path, ...]]
    reading: Reading | None
    trusted: bool
    misread: Misread | None = None

    @property
    def episodes(self) -> EpisodeIndex:
        """Where episodes end, as the metadata says."""
        return EpisodeIndex(self.table.start, self.table.stop, self.table.number)


def read_claims(root: Path, reading: Reading | None) -> Claims:
    """Read all that a dataset says of itself beside its frames, as far as it can be read.

    Raises
    ------
    DatasetError
        If `meta/info.json` cannot be read.
    """
    schema = read_schema(root)
    stated, episodes = read_stated(root), read_episodes(root, schema)
    stored = Stored(schema, stated, episodes, read_tasks(root), read_stats(root))
    table, paths, shards, _ = episodes.value
    videos = read_videos(root, schema, stated.value.video_path, shards)
    return Claims(root, stored, schema, table, paths, videos, _found(root), reading, trusted=_hangs_together(table))


def claims_under(mode: BreakMode, root: Path, reading: Reading | None) -> Claims:
    """Return what somebody believes of a dataset who gets one assumption wrong.

    Raises
    ------
    DatasetError
        If the dataset is not whole.
    """
    believed, wrong = mode.believe(load(root), reading)
    table, paths = _table_of(believed)
    claims = read_claims(root, wrong)
    return claims._replace(schema=believed.schema, table=table, paths=paths, trusted=True, misread=believed.misread)


def _found(root: Path) -> Read[tuple[Path, ...]]:
    try:
        return Read((*find(root, "", "**/*.parquet"), *find(root, "videos", "**/*.mp4")))
    except DatasetError as error:
        return Read((), (error.fault.relative_to(root),))


def _hangs_together(table: EpisodeTable) -> bool:
    must_hold = (rules.episode_order, rules.range_length, rules.range_overlap, rules.range_gap)
    return not any(True for rule in must_hold for _ in rule(table))


def _table_of(dataset: Dataset) -> tuple[EpisodeTable, list[Path]]:
    episodes = dataset.episodes
    file_number = np.searchsorted([file.to_index for file in dataset.files], episodes.from_index, side="right")
    table = EpisodeTable(episodes.numbers, episodes.from_index, episodes.to_index, episodes.lengths, file_number)
    return table, [file.path.relative_to(dataset.root) for file in dataset.files]
