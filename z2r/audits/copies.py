"""Are the pictures of an episode those of another one? Nothing needs to be foretold of them: they are held together.

A cell of a picture that is encoded once more hardly changes. Two demonstrations never look the same in every cell of
every frame, unless the robot does the same in both, which is then no fault of the pictures. Where only its first or its
last pictures are another's, they are those of its neighbour, and leap to its own.
"""

from collections.abc import Mapping
from itertools import islice

import numpy as np

from z2r.arrays import Floats, Ints
from z2r.audits.glances import Glance

_OTHERS = 32  # episodes after each, with which it is compared
_COMMON = 6  # pictures of the same frames, at least
_CHANGES = 15  # of 255, by which some cell changes in pictures in which something happens
_SAME = 0.1  # of that: by less, cells change when they are encoded again; measured, 0.05 to 0.09, and else 0.13 or more
_ELSEWHERE = 0.15  # spreads of where the robot is
_LEAPS = 1  # of 255 on average
_ALONE, _WITH_OTHERS, _MANY = 4, 2, 0.4  # times as far as from the neighbour's; the same in so many of the episodes
_MIN_MANY = 3


def pictures_again(seen: Mapping[int, Glance], paths: Mapping[int, tuple[Ints, Floats]]) -> dict[int, int]:
    """Find the episodes whose pictures are those of another one although the robot is elsewhere.

    Parameters
    ----------
    seen : dict of int to Glance
        Of one camera: the episodes, by their rows in the metadata.
    paths : dict of int to (ndarray, ndarray)
        At which frames of an episode it is known where the robot is, (n,), and where it is, (n, size).

    Returns
    -------
    dict of int to int
        Of each such episode the other one, by their rows: who is right, the pictures alone do not say.
    """
    changes = {row: float(np.ptp(seen[row].cells, axis=0).max()) for row in sorted(seen.keys() & paths.keys())}
    rows = [row for row in changes if changes[row] >= _CHANGES]
    if not rows:
        return {}
    spread = np.concatenate([paths[row][1] for row in rows]).std(axis=0, dtype=np.float64)  # (size,)
    found: dict[int, int] = {}
    for place, row in enumerate(rows):
        for other in islice(rows, place + 1, place + 1 + _OTHERS):
            frames = _frames_of_both(seen[row], seen[other], _SAME * min(changes[row], changes[other]))
            if len(frames) >= _COMMON and _apart(paths[row], paths[other], frames, spread) >= _ELSEWHERE:
                found.setdefault(row, other)
                found.setdefault(other, row)
    return found


def pictures_of_neighbours(seen: Mapping[int, Glance]) -> dict[int, str]:
    """Find the episodes of one camera, by their rows, whose first one or two pictures, or last ones, are a neighbour's.

    Then all of its pictures may be late, or early: what is said is by how much.
    """
    ends = {row: glance.ends.astype(np.float64) for row, glance in seen.items() if glance.ends is not None}
    found: dict[int, str] = {}
    before, after = (
        (-1, 0, "first {} like the last of the episode before"),
        (1, 1, "last {} like the first of the next"),
    )
    for by, side, said in (before, after):
        rows = sorted(row for row in ends if row + by in ends)
        both = {row: _leap_to_own(ends[row][side], ends[row + by][1 - side][0]) for row in rows}
        many = [row for row in rows if both[row][0] >= _WITH_OTHERS]
        enough = len(many) >= max(_MIN_MANY, _MANY * len(rows))
        for row in many if enough else (row for row in many if both[row][0] >= _ALONE):
            found.setdefault(row, said.format(("picture", "two pictures")[both[row][1] - 1]))
    return found


def _leap_to_own(own: Floats, its: Floats) -> tuple[float, int]:
    """Say how far three pictures at an end leap, beside how far they are from a neighbour's before, and where."""
    steps = np.abs(np.diff(own, axis=0)).mean(axis=(1, 2))
    n = int(steps.argmax()) + 1  # so many come before the leap
    near = float(np.abs(own[:n] - its).mean(axis=(1, 2)).max())
    return (float(steps.max() / max(near, steps.min(), _LEAPS / _ALONE)) if steps.max() >= _LEAPS else 0.0), n


def _frames_of_both(one: Glance, other: Glance, limit: float) -> Floats:
    """Return the frames of which both have a picture, if all of these show the same; else none."""
    frames, mine, its = np.intersect1d(one.frame.round(), other.frame.round(), return_indices=True)
    same = np.abs(one.cells[mine] - other.cells[its]).max(initial=0) <= limit
    return frames if same else frames[:0]


def _apart(one: tuple[Ints, Floats], other: tuple[Ints, Floats], frames: Floats, spread: Floats) -> float:
    """Return how far robots are from each other at some frames, as a root mean square over the columns that move."""
    own, its = (
        np.stack([np.interp(frames, when, column) for column in places[:, spread > 0].T.astype(np.float64)], axis=1)
        for when, places in (one, other)
    )
    return float(np.sqrt(np.square((own - its) / spread[spread > 0]).mean())) if (spread > 0).any() else 0.0
