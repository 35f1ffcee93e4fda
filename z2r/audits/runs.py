"""What do all frames say together? Where their episodes run, and how each feature moves in each of them."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from z2r.arrays import Floats, Ints
from z2r.audits.claims import Claims
from z2r.audits.findings import Finding
from z2r.audits.following import Following
from z2r.audits.frames import FileClaims, RunStats, joined
from z2r.audits.labels import FileLabels
from z2r.audits.steps import RunSteps, join_steps


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
    tasks : ndarray, int64[n_runs]
        Their first `task_index`; -1 where it cannot be used.
    stats : dict of str to RunStats
        Of each numeric feature.
    labels : FileLabels or None
        What success, reward and done say.
    scene : object
        What the scene made of it; None where there is none, or its columns are not there.
    following : Following or None
        How joints follow their commands; None where no command has the name of a joint.
    steps : dict of str to RunSteps
        Of what was observed and done.
    """

    n_rows: int | None
    findings: list[Finding]
    starts: Ints
    numbers: Ints | None
    tasks: Ints
    stats: dict[str, RunStats]
    labels: FileLabels | None
    scene: Any
    following: Following | None
    steps: dict[str, RunSteps]


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
    task : ndarray, int64[n_runs]
        Their first `task_index`; -1 where it cannot be used.
    read : list of int
        The data files that could be read.
    stats : dict of str to RunStats
        Of each feature that could be read in all of these files.
    steps : dict of str to RunSteps
        Of those of them that were observed or done.
    """

    claims: Claims
    number: Ints
    start: Ints
    stop: Ints
    file_number: Ints
    task: Ints
    read: list[int]
    stats: dict[str, RunStats]
    steps: dict[str, RunSteps]

    @property
    def n_frames(self) -> Floats:
        """Of each run."""
        return (self.stop - self.start).astype(np.float64)

    def spans(self, name: str) -> Floats:
        """Return the range of each column of a feature over all runs, float64[size]."""
        stats = self.stats[name]
        span: Floats = stats.high.max(axis=0) - stats.low.min(axis=0)
        return span


def join_runs(claims: Claims, files: Sequence[FileClaims], sums: Sequence[FileSums]) -> Runs | None:
    """Put the runs of all files that can be read after each other; None where some do not say what episode it is."""
    read = [number for number, part in enumerate(sums) if part.n_rows]
    numbers = [sums[number].numbers for number in read]
    known = [each for each in numbers if each is not None]
    if not read or len(known) < len(read):
        return None
    parts = [(files[number].base, sums[number]) for number in read]
    moved = {name for _, part in parts for name in part.steps}
    shared = [name for name in claims.schema.signals() if all(name in part.stats for _, part in parts)]
    return Runs(
        claims=claims,
        number=np.concatenate(known),
        start=np.concatenate([base + part.starts for base, part in parts]),
        stop=np.concatenate([base + np.append(part.starts[1:], part.n_rows or 0) for base, part in parts]),
        file_number=np.repeat(read, [len(part.starts) for _, part in parts]),
        task=np.concatenate([part.tasks for _, part in parts]),
        read=read,
        stats={name: joined([part.stats[name] for _, part in parts]) for name in shared},
        steps={name: join_steps([part.steps[name] for _, part in parts]) for name in shared if name in moved},
    )
