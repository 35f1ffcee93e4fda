"""What do all frames say together? Where their episodes run, and how each feature moves in each of them."""

from collections.abc import Sequence
from itertools import takewhile
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from z2r.arrays import Floats, Ints, join_all
from z2r.audits.claims import Claims
from z2r.audits.findings import Finding
from z2r.audits.following import Following
from z2r.audits.footage import ImageSums
from z2r.audits.frames import FileClaims, RunStats
from z2r.audits.labels import FileLabels
from z2r.audits.steps import RunSteps


class FileSums(NamedTuple):
    """What is kept of one data file.

    Attributes
    ----------
    n_rows : int or None
        None where it cannot be read.
    findings : list of Finding
        What is wrong with it by itself.
    starts : ndarray, int64[n_runs]
        The first row of each run of frames with one `episode_index`.
    numbers : ndarray, int64[n_runs], or None
        Their `episode_index`.
    stats : dict of str to RunStats
        Of each numeric feature.
    steps : dict of str to RunSteps
        Of what was observed and done.
    following : Following or None
        How joints follow their commands; None where no command has the name of a joint.
    labels : FileLabels or None
        What success, reward and done say.
    scene : list or None
        What the scene made of each block of it; None where there is none, or its columns are not there.
    idle : ndarray, int64[n_runs, 2], or None
        In how many frames nothing moves, in the beginning and in the end of each run.
    tasks : ndarray, int64[n, 2], or None
        Which runs have a frame of which task: pairs of a run and a `task_index`.
    images : dict of str to ImageSums
        Of each feature whose pictures stand in it.
    places : ndarray, float32[n_runs, 129, size], or None
        Where the robot is, from `sum_places`; only where pictures are decoded.
    moments : ndarray, float32[n_runs, n_moments, 2, n_columns], or None
        What all columns are at some moments, from `keep_moments`; None where that would be too much, or one is missing.
    comes : ndarray, float64[n_runs, 1 + size], or None
        When a label first comes, and the state then, from `fold_comes`; None where there is none of both.
    """

    n_rows: int | None
    findings: list[Finding]
    starts: Ints = np.empty(0, dtype=np.int64)
    numbers: Ints | None = None
    stats: dict[str, RunStats] = {}  # noqa: RUF012 -- nobody writes into it
    steps: dict[str, RunSteps] = {}  # noqa: RUF012
    following: Following | None = None
    labels: FileLabels | None = None
    scene: list[Any] | None = None
    idle: Ints | None = None
    tasks: Ints | None = None
    images: dict[str, ImageSums] = {}  # noqa: RUF012
    places: Floats | None = None
    moments: NDArray[np.float32] | None = None
    comes: Floats | None = None


class Runs(NamedTuple):
    """Frames of one data file that follow each other and have one `episode_index`: a row for each such run.

    Attributes
    ----------
    claims : Claims
        What the metadata says.
    number, start, stop : ndarray, int64[n_runs]
        Their `episode_index`, their first frame, and one past their last, counted over the whole dataset.
    file_number : ndarray, int64[n_runs]
        Which data file they are in.
    read : list of int
        The data files that could be read.
    stats : dict of str to RunStats
        Of each feature that could be read in all of these files.
    steps : dict of str to RunSteps
        Of those of them that were observed or done.
    idle, tasks, moments, comes : as in `FileSums`
        None where they are of some of these files.
    """

    claims: Claims
    number: Ints
    start: Ints
    stop: Ints
    file_number: Ints
    read: list[int]
    stats: dict[str, RunStats]
    steps: dict[str, RunSteps]
    idle: Ints | None
    tasks: Ints | None
    moments: NDArray[np.float32] | None
    comes: Floats | None

    @property
    def n_frames(self) -> Floats:
        """Of each run."""
        return (self.stop - self.start).astype(np.float64)

    def spans(self, name: str) -> Floats:
        """Return the range of each column of a feature over all runs, float64[size]."""
        stats = self.stats[name]
        span: Floats = stats.high.max(axis=0) - stats.low.min(axis=0)
        return span

    def moments_of(self, name: str) -> NDArray[np.float32]:
        """What a feature is at some moments, and how it changes: (n_runs, n_moments, 2, size); no moment if unknown."""
        features = self.claims.schema.signals()
        size = features[name].size if name in features else 0
        first = sum(features[each].size for each in takewhile(name.__ne__, features))
        if self.moments is None:
            return np.empty((len(self.number), 0, 2, size), dtype=np.float32)
        return self.moments[..., first : first + size]


class Motion(NamedTuple):
    """Of all files that could be read, in their order: statistics, steps and moments of each feature that all have.

    They are most of what is kept of a dataset. So they are put together as they come: no file's own are held beside.
    """

    stats: dict[str, RunStats]
    steps: dict[str, RunSteps]
    moments: NDArray[np.float32] | None


def join_runs(
    claims: Claims, files: Sequence[FileClaims], sums: Sequence[FileSums], motion: Motion | None
) -> Runs | None:
    """Put the runs of all files that can be read after each other; None where some do not say what episode it is."""
    read = [number for number, part in enumerate(sums) if part.n_rows]
    numbers = [sums[number].numbers for number in read]
    known = [each for each in numbers if each is not None]
    if motion is None or len(known) < len(read):
        return None
    parts = [(files[number].base, sums[number]) for number in read]
    n_runs = np.array([len(part.starts) for _, part in parts])
    firsts = np.cumsum(n_runs) - n_runs
    return Runs(
        claims=claims,
        number=np.concatenate(known),
        start=np.concatenate([base + part.starts for base, part in parts]),
        stop=np.concatenate([base + np.append(part.starts[1:], part.n_rows or 0) for base, part in parts]),
        file_number=np.repeat(read, n_runs),
        read=read,
        stats=motion.stats,
        steps=motion.steps,
        idle=join_all([part.idle for _, part in parts]),
        tasks=join_all([_shifted(part.tasks, int(first)) for first, (_, part) in zip(firsts, parts, strict=True)]),
        moments=motion.moments,
        comes=join_all([part.comes for _, part in parts]),
    )


def _shifted(tasks: Ints | None, first_run: int) -> Ints | None:
    """Count the runs of pairs of a run and a task on from those of the files before."""
    return None if tasks is None else tasks + np.array([first_run, 0])
