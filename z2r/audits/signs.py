"""Are the pictures of all episodes made in the same way? A few numbers of each tell where lens or driver changed.

Nothing says what is right. What is told is that one of these numbers parts the episodes of a camera in two groups that
lie far apart, or that the camera sinks bit by bit: nobody sees that in one episode.
"""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from z2r.arrays import Array, Bools, Floats, Ints
from z2r.format.decoding import Small

_MIN_EPISODES = 5  # from fewer nothing can be said about what is usual
_WITHIN = 1.5  # times as far apart as those of one side are
_OF_ONE = 1.5  # times as far as else, where there is one alone
_SHIFTS = 6  # cells of 64, by which colours may lie beside
_EACH = 4  # of the pictures, of which one is enough for what is slow to tell
_FITS = 1.3  # times as well as where they belong
_TINY = 1e-3
_BALANCED = 0.01  # what a ratio of red to blue swings by in any case
_AT_LEAST, _STEPS, _STANDS = 2, 0.7, 2.0  # episodes; cells; and times as far as those of one side lie apart
_DRIFTS, _STEADILY, _SEEN = 2.0, 0.95, 0.15  # cells of 48 or 64; a correlation with the order; and of both pictures

type _Pictures = NDArray[np.floating[Any]]


class Signs(NamedTuple):
    """What is kept of the pictures of one episode.

    Attributes
    ----------
    sharpness : float
        How far a pixel is from the next one, in a part of the picture as most are: a logarithm.
    rows : float
        How far a row is from the two around it, beside how far these are from each other: a logarithm.
    contrast : float
        Of the brightest and the darkest that is seen: their difference over their sum, from 0 to 1.
    halves : float
        The correlation of the left half of a picture with the right one.
    balance : float
        How much the ratio of red to blue goes up and down: a logarithm.
    beside : float
        How far edges of colour lie to the right of those of brightness, in 64ths of the picture.
    """

    sharpness: float
    rows: float
    contrast: float
    halves: float
    balance: float
    beside: float


class _Kind(NamedTuple):
    """What a sign says.

    Attributes
    ----------
    least : float
        By how much it must differ.
    says, mend : str
        What it is, and what may be behind it.
    odd : int
        Which of two groups that are as large is the odd one: 1 where it is that with more, else -1.
    is_log : bool
        Whether it is a logarithm.
    """

    least: float
    says: str
    mend: str
    odd: int
    is_log: bool = True


_KINDS = {
    "halves": _Kind(0.15, "two halves with a correlation of", "Are two views side by side?", 1, is_log=False),
    "beside": _Kind(1.5, "colours beside their edges, by 64ths of the width:", "Were planes shifted?", 1, is_log=False),
    "balance": _Kind(1.0, "a ratio of red to blue that swings by", "Does the white balance hunt? Fix it", 1),
    "contrast": _Kind(0.08, "a contrast of", "Is black grey, as where 16 to 235 is taken for all?", -1, is_log=False),
    "sharpness": _Kind(0.3, "a sharpness of", "Is the lens out of focus or dirty, or the background blurred?", -1),
    "rows": _Kind(0.3, "rows that differ from those around them by", "Are they interlaced, turned or scaled?", 1),
}


class Parted(NamedTuple):
    """Two groups of episodes of a camera, by their rows in the metadata.

    Attributes
    ----------
    some, others : ndarray of int
        Those that are fewer, or the odd ones, and the others.
    says, mend : str
        What it is by which they differ, and what may be behind it.
    own, its : float
        The median of both.
    """

    some: Ints
    others: Ints
    says: str
    mend: str
    own: float
    its: float


def signs_of(smalls: Sequence[Small], colours: _Pictures, seen: _Pictures) -> Signs:
    """Return the signs of an episode.

    Parameters
    ----------
    smalls : sequence of Small
        Its pictures.
    colours, seen : ndarray, float32[n, 48, 64, 3], float32[n, 48, 64]
        Of each the colours, and the brightness.
    """
    few = seen[::_EACH]
    tint = colours[::_EACH, ..., 0] - colours[::_EACH, ..., 2]
    darkest, brightest = np.median(colours.min(axis=(1, 2, 3))), np.median(colours.max(axis=(1, 2, 3)))
    red, blue = np.log(np.maximum(colours[::_EACH, ..., ::2].mean(axis=(1, 2)), 1)).T
    comb = np.sum([small.comb for small in smalls], axis=0)
    return Signs(
        sharpness=float(np.log(_TINY + np.median([small.sharpness for small in smalls]))),
        rows=float(np.log(np.sqrt((comb[0] + _TINY) / (comb[1] + _TINY)))),
        contrast=float((brightest - darkest) / max(brightest + darkest, 1)),
        halves=float(np.median(_correlations(*np.split(few, 2, axis=2)))),
        balance=float(np.log(_BALANCED + (red - blue).std())),
        beside=float(_beside(np.abs(np.diff(few, axis=2)), np.abs(np.diff(tint, axis=2)))),
    )


def _correlations(some: _Pictures, others: _Pictures) -> Floats:
    """Return the correlation of each picture of some (n, height, width) with that of others."""
    one, other = (each - each.mean(axis=(1, 2), keepdims=True) for each in (some, others))
    sizes = np.sqrt(np.square(one).sum(axis=(1, 2)) * np.square(other).sum(axis=(1, 2)))
    correlations: Floats = (one * other).sum(axis=(1, 2)) / np.maximum(sizes, 1)
    return correlations


def _beside(edges: _Pictures, of_colour: _Pictures) -> int:
    """Return by how many columns edges must be shifted, to fit those of colour far better: (n, height, width)."""
    shifts, width = range(-_SHIFTS, _SHIFTS + 1), edges.shape[2]
    inside = of_colour[..., _SHIFTS:-_SHIFTS]
    fits = [np.vdot(edges[..., _SHIFTS - shift : width - _SHIFTS - shift], inside) for shift in shifts]
    best = int(np.argmax(fits))
    return shifts[best] if fits[best] >= _FITS * fits[_SHIFTS] else 0


def parted(signs: Mapping[int, Signs], tasks: Mapping[int, int]) -> list[Parted]:
    """Find what parts the episodes of a camera, by their rows, in two; not where each side has tasks of its own.

    Of several signs that part them in the same way, the one by which they differ most has the cause.
    """
    rows, found = np.array([*signs]), dict[frozenset[bytes], list[tuple[float, Parted]]]()
    for name, kind in _KINDS.items() if len(rows) >= _MIN_EPISODES else ():
        values = np.array([getattr(each, name) for each in signs.values()])
        few = _apart(kind.odd * values, kind.least)
        if few.any() and not _told_by_tasks(rows[few], rows[~few], tasks):
            both = [float(np.median(values[each])) for each in (few, ~few)]
            own, its = np.exp(both) if kind.is_log else both
            each = Parted(rows[few], rows[~few], kind.says, kind.mend, own, its)
            same = found.setdefault(frozenset({few.tobytes(), (~few).tobytes()}), [])
            same.append((abs(both[0] - both[1]) / kind.least, each))
    return [max(same, key=lambda pair: pair[0])[1] for same in found.values()]


def _apart(values: Floats, least: float) -> Bools:
    """Tell which of the values (n,) lie far from the others, as these do not from each other; of as many, the higher.

    >>> _apart(np.array([1.0, 5, 1.2, 5.1, 1.1]), 1).nonzero()[0].tolist()
    [1, 3]
    >>> _apart(np.array([1.0, 2, 3, 4, 5]), 0.5).any()
    np.False_
    """
    ordered = np.sort(values)
    gaps = np.diff(ordered)
    below = int(gaps.argmax()) + 1
    within = max(ordered[below - 1] - ordered[0], ordered[-1] - ordered[below])
    least = least * _OF_ONE if min(below, len(values) - below) == 1 else least
    if gaps[below - 1] < max(least, _WITHIN * within):
        return np.zeros(len(values), dtype=bool)
    higher: Bools = values >= ordered[below]
    return higher if higher.sum() <= len(values) / 2 else ~higher


def _told_by_tasks(some: Ints, others: Ints, tasks: Mapping[int, int]) -> bool:
    """Tell whether no task is on both sides: then it may be the task that one sees."""
    one, other = ({tasks[row] for row in rows.tolist() if row in tasks} for rows in (some, others))
    return bool(one) and not one & other


def drift(stills: Mapping[int, NDArray[np.uint8]], numbers: Ints) -> str:
    """Say by how much what stands still (48, 64) moves, bit by bit or once; empty where it does not.

    Parameters
    ----------
    stills : dict of int to ndarray of uint8
        Of each episode, by its row in the metadata.
    numbers : ndarray, int64[n_episodes]
        What the dataset calls the episodes.
    """
    rows = sorted(stills)
    if len(rows) < _MIN_EPISODES:
        return ""
    first = _spectrum(stills[rows[0]])
    found = [_shift(first, _spectrum(stills[row])) for row in rows]
    shifts = np.array([shift for shift, _ in found])  # (n, 2)
    if np.quantile([seen for _, seen in found], 0.1) < _SEEN:
        return ""
    for axis, (said, size) in enumerate((("height", 48), ("width", 64))):
        moved = shifts[:, axis]
        if abs(moved[-1]) >= _DRIFTS and abs(np.corrcoef(moved, np.arange(len(moved)))[0, 1]) >= _STEADILY:
            return f"what stands still moved by {abs(moved[-1]) / size:.0%} of the {said}, bit by bit"
    after, down, right = _step(shifts)
    if not after:
        return ""
    how = f"{abs(down) / 48:.1%} of the height and {abs(right) / 64:.1%} of the width"
    return f"what stands still moved by {how} from episode {numbers[rows[after]]} on"


def _step(shifts: Floats) -> tuple[int, float, float]:
    """Find from which place on shifts (n, 2) are others, by how much in both: 0 where they stay, or come back.

    Within a group they stay nearly where they are. In the episode between them it may have happened.

    >>> _step(np.repeat([[0.0, 0], [0.9, -0.5]], [4, 3], axis=0))
    (4, 0.9, -0.5)
    >>> _step(np.array([[0.0, 0], [0.9, 0], [0, 0], [0.9, 0], [0, 0]]))[0]
    0
    """
    n, between = len(shifts), int(np.hypot(*(np.diff(shifts, axis=0).T)).argmax()) + 1
    for before, after in ((between, between), (between, between + 1), (between - 1, between)):
        groups = shifts[:before], shifts[after:]
        if min(before, n - after) < _AT_LEAST:
            continue
        one, other = (np.median(group, axis=0) for group in groups)
        steady = max(float(np.abs(group - middle).max()) for group, middle in zip(groups, (one, other), strict=True))
        if np.hypot(*(other - one)) >= max(_STEPS, _STANDS * steady):
            down, right = (other - one).tolist()
            return after, down, right
    return 0, 0.0, 0.0


def _spectrum(picture: Array) -> NDArray[np.complex128]:
    height, width = picture.shape
    window = np.outer(np.hanning(height + 2)[1:-1], np.hanning(width + 2)[1:-1])
    spectrum: NDArray[np.complex128] = np.fft.rfft2((picture - picture.mean()) * window)
    return spectrum


def _shift(one: NDArray[np.complex128], other: NDArray[np.complex128]) -> tuple[tuple[float, float], float]:
    """Return by how many rows and columns a picture is shifted against another, and how surely, from 0 to 1.

    By phase correlation (Kuglin and Hines, 1975), which no exposure changes; the top of a parabola is between cells.
    """
    both = one.conj() * other
    fits = np.fft.irfft2(both / np.maximum(np.abs(both), _TINY))
    height, width = fits.shape
    row, column = divmod(int(fits.argmax()), width)
    down = row + _top(fits[[row - 1, row, (row + 1) % height], column])
    right = column + _top(fits[row, [column - 1, column, (column + 1) % width]])
    return ((down + height / 2) % height - height / 2, (right + width / 2) % width - width / 2), float(fits.max())


def _top(fits: Floats) -> float:
    """Return where a parabola through three values, the middle one the largest, is highest: from -0.5 to 0.5."""
    before, here, after = fits.tolist()
    return float(0.5 * (before - after) / min(before - 2 * here + after, -_TINY))
