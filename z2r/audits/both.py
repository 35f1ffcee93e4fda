"""What is in a dataset, and what is wrong with it? Both in one pass over its files, each of which is read once."""

from collections.abc import Callable, Mapping
from concurrent.futures import Executor
from dataclasses import dataclass, replace
from pathlib import Path

from z2r.arrays import Columns, Progress, no_progress
from z2r.audits.audit import Audit, audit, audit_beside
from z2r.format.dataset import Dataset, frames_of
from z2r.format.episodes import DataFile
from z2r.format.schema import Schema
from z2r.format.tables import DataColumns
from z2r.reading.inspection import FileSums, Inspection, fold_for, inspect_dataset, sum_up
from z2r.reading.reading import Reading
from z2r.reading.scene import Scene


def inspect_and_audit(
    dataset: Dataset,
    reading: Reading | None = None,
    scene: Scene | None = None,
    progress: Progress = no_progress,
    keep: int = 0,
    executor: Executor | None = None,
) -> tuple[Inspection, Audit]:
    """Inspect a dataset, as `inspect_dataset` does, and audit the folder that it is in.

    Parameters
    ----------
    dataset : Dataset
        What to inspect.
    reading, keep, executor
        As for `inspect_dataset`.
    scene : Scene, optional
        What the audit asks beside.
    progress : callable, optional
        Called with about how many frames are done and the number of all, after each data file.

    Raises
    ------
    DatasetError
        If a data file is missing, damaged, or not what the schema and the index say.
    """
    n_frames = dataset.episodes.n_frames

    def move(done: int, n_files: int) -> None:
        progress(n_frames * done // n_files, n_frames)

    if dataset.misread:  # the inspection takes the files for something else than the audit
        inspection = inspect_dataset(dataset, None, reading, progress, keep, executor)
        return inspection, audit(dataset.root, None, reading, scene, executor=executor)
    end = int(dataset.episodes.to_index[-1])
    files = {file.path.relative_to(dataset.root): file for file in dataset.files if file.from_index < end}
    fold = _Fold(dataset.root, dataset.schema, files, end, fold_for(dataset, keep))
    audited, made = audit_beside(dataset.root, fold, None, reading, scene, move, executor)
    parts = sorted(filter(None, made), key=lambda each: each[0].from_index)
    if sum(block.to_index - block.from_index for block, _ in parts) < end:
        return inspect_dataset(dataset, None, reading, no_progress, keep, executor), audited
    return sum_up(dataset, [part for _, part in parts], None, reading, keep), audited


@dataclass(frozen=True, eq=False)
class _Fold:
    """Sums up, for the inspection, what the audit read of a data file; an object, so that it can be sent elsewhere."""

    root: Path
    schema: Schema
    files: Mapping[Path, DataFile]
    end: int
    fold: Callable[[DataFile, Columns], FileSums]

    def __call__(self, path: Path, read: DataColumns) -> tuple[DataFile, FileSums] | None:
        """Return the sums of a file, or of a block of it, and which; None where the inspection does not want it."""
        if path not in self.files:
            return None
        file, signals = self.files[path], tuple(self.schema.signals())
        first = file.from_index + read.first
        block = replace(file, from_index=first, to_index=first + (read.n_rows or 0))
        n_rows = min(block.to_index, self.end) - first
        broken = block != file and not set(signals) <= set(read.frames)
        if n_rows <= 0 or block.to_index > file.to_index or broken:
            return None
        frames = frames_of(read, self.root, self.schema, block, signals, n_rows)
        return replace(block, to_index=first + n_rows), self.fold(block, frames)
