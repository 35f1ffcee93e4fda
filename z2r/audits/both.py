"""What is in a dataset, and what is wrong with it? Both in one pass over its files, each of which is read once."""

from collections.abc import Callable, Mapping
from concurrent.futures import Executor
from dataclasses import dataclass
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
    parts = dict(each for each in made if each is not None)
    if len(parts) < len(files):
        return inspect_dataset(dataset, None, reading, no_progress, keep, executor), audited
    return sum_up(dataset, [parts[start] for start in sorted(parts)], None, reading, keep), audited


@dataclass(frozen=True, eq=False)
class _Fold:
    """Sums up, for the inspection, what the audit read of a data file; an object, so that it can be sent elsewhere."""

    root: Path
    schema: Schema
    files: Mapping[Path, DataFile]
    end: int
    fold: Callable[[DataFile, Columns], FileSums]

    def __call__(self, path: Path, read: DataColumns) -> tuple[int, FileSums] | None:
        """Return the sums and the first frame of a file; None where the inspection does not want it."""
        if path not in self.files:
            return None
        file, signals = self.files[path], tuple(self.schema.signals())
        n_rows = min(file.to_index, self.end) - file.from_index
        frames = frames_of(read, self.root, self.schema, file, signals, n_rows)
        return file.from_index, self.fold(file, frames)
