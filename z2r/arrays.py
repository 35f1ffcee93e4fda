"""What passes from hand to hand: the types of arrays, and the reductions that all parts of the package use.

Shapes stand beside the algebra: ``float64[n_frames, 2]`` in a docstring, ``# (n, 2)`` at the end of a line.
"""

from collections.abc import Callable, Sequence

import numpy as np
from numpy.typing import NDArray

_ROWS_AT_ONCE = 256  # so many of some numbers each fit into the nearest cache

type Ints = NDArray[np.int64]
type Floats = NDArray[np.float64]
type Bools = NDArray[np.bool_]
type Array = NDArray[np.generic]

type Columns = dict[str, Array]
"""Features by name, each (n_frames, size of the feature), of the dtype in the file."""

type Progress = Callable[[int, int], None]
"""Called with how much is done and how much there is."""


def no_progress(done: int, total: int) -> None:
    """Show no progress."""


def join[T: np.generic](parts: Sequence[NDArray[T] | None]) -> NDArray[T] | None:
    """Put the rows of all parts after each other; None where some part has none."""
    known = [part for part in parts if part is not None]
    return np.concatenate(known) if len(known) == len(parts) else None


def reduce_parts[T: np.generic](function: np.ufunc, values: NDArray[T], starts: Ints, stops: Ints) -> NDArray[T]:
    """Reduce parts of an array, which may overlap or leave gaps.

    Parameters
    ----------
    function : ufunc
        Such as ``np.minimum``: what comes of a value that it is given twice must be the same.
    values : ndarray, (n_rows, size)
        The whole.
    starts, stops : ndarray, int64[n_parts]
        First row, and one past the last row, of each part; none is empty.

    Returns
    -------
    ndarray, (n_parts, size)

    Examples
    --------
    >>> values = np.array([[5], [3], [8], [1]])
    >>> reduce_parts(np.minimum, values, starts=np.array([0, 1]), stops=np.array([3, 4])).ravel()
    array([3, 1])
    """
    # reduceat wants the parts as pairs of rows that are in the array: the last row of each comes in by itself.
    pairs = np.stack([starts, np.minimum(stops, len(values) - 1)], axis=1).ravel()
    parts: NDArray[T] = function(function.reduceat(values, pairs, axis=0)[::2], values[stops - 1])
    return parts


def sum_parts(values: Array, starts: Ints, stops: Ints) -> Floats:
    """Add up the rows of all parts of an array, which may overlap or leave gaps: float64[size].

    Examples
    --------
    >>> sum_parts(np.array([[5], [3], [8], [1]]), starts=np.array([0, 1]), stops=np.array([3, 4]))
    array([28.])
    """
    if np.array_equal(stops[:-1], starts[1:]):  # one after another: far quicker, and the common case
        starts, stops = starts[:1], stops[-1:]
    sums = [values[start:stop].sum(axis=0, dtype=np.float64) for start, stop in zip(starts, stops, strict=True)]
    total: Floats = np.sum(sums, axis=0)
    return total


def by_column(values: Array) -> Array:
    """Return the same numbers, (n_rows, size), each column in one piece of memory; numpy copies so at half the speed.

    >>> by_column(np.eye(3, 2)).T.flags.c_contiguous
    True
    """
    turned = np.empty(values.shape[::-1], values.dtype)
    for first in range(0, len(values), _ROWS_AT_ONCE):
        rows = slice(first, first + _ROWS_AT_ONCE)
        turned[:, rows] = values[rows].T
    return turned.T
