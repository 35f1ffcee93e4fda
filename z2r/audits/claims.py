"""What does a dataset say of itself, before a frame is read? Its schema, its index, its totals, and its statistics."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from z2r.arrays import Ints
from z2r.audits import index, structure
from z2r.audits.findings import Finding
from z2r.audits.structure import Rows
from z2r.format.dataset import Dataset, load
from z2r.format.episodes import EpisodeIndex
from z2r.format.schema import Schema, read_schema
from z2r.reading.breaks import BreakMode


class Story(NamedTuple):
    """What a dataset says of itself, and what is wrong with that."""

    schema: Schema
    rows: Rows
    files: Sequence[Path]  # relative to the root, in the order of their frames
    shards: Sequence[Path]  # of the episode metadata: those that can be read
    tasks: Ints | None
    stats: dict[str, dict[str, Any]] | None
    findings: list[Finding]
    trusted: bool  # whether the metadata is taken at its word

    @property
    def episodes(self) -> EpisodeIndex:
        """Where episodes end, as the metadata says."""
        return EpisodeIndex(self.rows.start, self.rows.stop, self.rows.number)


def read_story(root: Path) -> Story:
    """Read all that a dataset says of itself beside its frames; what cannot be read is a finding.

    Raises
    ------
    DatasetError
        If `meta/info.json` cannot be read.
    """
    schema = read_schema(root)
    totals, findings = structure.read_totals(root)
    findings += structure.check_features(schema)
    columns, shards, faults = structure.read_rows(root)
    tasks, task_faults = structure.read_tasks(root)
    stats, stats_faults = structure.read_stats(root)
    findings += faults + task_faults + stats_faults
    rows, files = structure.name_files(schema, columns)
    if not len(rows.number):
        return Story(schema, rows, files, shards, tasks, stats, findings, trusted=False)
    findings += structure.check_order(files)
    findings += structure.check_orphans(root, files)
    findings += structure.check_totals(root, schema, totals, rows, None if tasks is None else len(tasks))
    findings += structure.check_splits(totals, len(rows.number))
    findings += structure.check_videos(root, schema, totals)
    faults = list(index.check_rows(rows))
    return Story(schema, rows, files, shards, tasks, stats, findings + faults, trusted=not faults)


def believe(root: Path, mode: BreakMode) -> Story:
    """Return what somebody believes of a dataset who gets one assumption wrong.

    Raises
    ------
    DatasetError
        If the dataset is not whole.
    """
    right = load(root)
    told = read_story(root)
    believed = mode.dataset(right)
    rows, files = _rows_of(believed)
    findings = list(structure.check_totals(root, believed.schema, structure.Totals(), rows, None))
    findings += index.check_rows(rows)
    findings += told.findings
    return told._replace(schema=believed.schema, rows=rows, files=files, findings=findings, trusted=True)


def _rows_of(dataset: Dataset) -> tuple[Rows, list[Path]]:
    episodes = dataset.episodes
    file = np.searchsorted([file.to_index for file in dataset.files], episodes.from_index, side="right")
    rows = Rows(episodes.numbers, episodes.from_index, episodes.to_index, episodes.lengths, file)
    return rows, [file.path.relative_to(dataset.root) for file in dataset.files]
