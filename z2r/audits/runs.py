"""What do all frames say together? Where their episodes run, and how each feature moves in each of them."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from z2r.arrays import Floats, Ints
from z2r.audits.claims import Claims
from z2r.audits.findings import Finding
from z2r.audits.footage import ImageSums
from z2r.audits.frames import FileClaims, RunStats, joined
from z2r.audits.labels import FileLabels


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
    labels : FileLabels or None
        What success, reward and done say.
    scene : object
        What the scene made of it; None where there is none, or its columns are not there.
    images : dict of str to ImageSums
        Of each feature whose pictures stand in it.
    way : ndarray, (n_runs, 65), or None
        How far the robot has come, from `sum_way`.
    """

    n_rows: int | None
    findings: list[Finding]
    starts: Ints
    numbers: Ints | None
    stats: dict[str, RunStats]
    labels: FileLabels | None
    scene: Any
    images: dict[str, ImageSums]
    way: Floats | None


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
    """

    claims: Claims
    number: Ints
    start: Ints
    stop: Ints
    file_number: Ints
    read: list[int]
    stats: dict[str, RunStats]


def join_runs(claims: Claims, files: Sequence[FileClaims], sums: Sequence[FileSums]) -> Runs | None:
    """Put the runs of all files that can be read after each other; None where some do not say what episode it is."""
    read = [number for number, part in enumerate(sums) if part.n_rows]
    numbers = [sums[number].numbers for number in read]
    known = [each for each in numbers if each is not None]
    if not read or len(known) < len(read):
        return None
    parts = [(files[number].base, sums[number]) for number in read]
    shared = [name for name in claims.schema.signals() if all(name in part.stats for _, part in parts)]
    return Runs(
        claims=claims,
        number=np.concatenate(known),
        start=np.concatenate([base + part.starts for base, part in parts]),
        stop=np.concatenate([base + np.append(part.starts[1:], part.n_rows or 0) for base, part in parts]),
        file_number=np.repeat(read, [len(part.starts) for _, part in parts]),
        read=read,
        stats={name: joined([part.stats[name] for _, part in parts]) for name in shared},
    )
