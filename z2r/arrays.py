"""What passes from hand to hand: the types of arrays, and the reductions that all parts of the package use.

Shapes stand beside the algebra: ``float64[n_frames, 2]`` in a docstring, ``# (n, 2)`` at the end of a line.
"""

from collections.abc import Callable, Sequence
from functools import cache
from types import NoneType
from typing import Any

import numpy as np
from numpy.typing import NDArray

_BLAS_ALONE = 200_000  # multiplications: OpenBLAS takes one thread for so few
_ROWS_AT_ONCE = 256  # so many of some numbers each fit into the nearest cache
_LARGE = 2**25 - 2**13  # bytes: the most that glibc takes for the bound of what is large, less what it adds to a block

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


@cache
def keep_freed_memory() -> None:
    """Let memory that is freed stay with the process, so that the next array does not have to wait for the system.

    What is large, glibc takes from the system and gives back at once; and large is what is larger than any such block
    before, up to 32 MB (`man 3 mallopt`, M_MMAP_THRESHOLD). So it is enough to ask once for the largest, untouched.
    Another C library is not changed by that.
    """
    np.empty(_LARGE, np.uint8)


class Pile:
    """Rows that are put after each other as they come: of arrays, of lists, or of named tuples and dicts of them.

    What is None, or not there, in some part, is so in the whole. Each array is written once into memory that has room
    for more, which costs nothing before it is used: many small parts that wait to be joined would be held twice.

    Parameters
    ----------
    room : int
        For about how many rows.
    """

    def __init__(self, room: int = 0) -> None:
        self._room = room
        self._n_parts = 0
        self._first: Any = None
        self._kind: Any = None
        self._piles: dict[Any, Pile] = {}
        self._rows: Any = None
        self._n = 0

    def add(self, part: Any) -> None:
        """Put the rows of a part after the others."""
        if not self._n_parts:
            self._first = part  # which may stay the only one
        else:
            if self._n_parts == 1:
                self._put(self._first)
            self._first = None
            self._put(part)
        self._n_parts += 1

    def _put(self, part: Any) -> None:
        first, self._kind = self._kind is None, NoneType if NoneType in (self._kind, type(part)) else type(part)
        if self._kind is NoneType:
            self._rows, self._piles = None, {}
        elif isinstance(part, np.ndarray):
            self._add_array(part)
        elif isinstance(part, list):
            self._rows = [*part] if first else self._rows + part
        else:
            parts = part if isinstance(part, dict) else dict(enumerate(part))
            piles = {name: Pile(self._room) for name in parts} if first else self._piles
            self._piles = {name: pile for name, pile in piles.items() if name in parts}
            for name, pile in self._piles.items():
                pile.add(parts[name])

    def _add_array(self, part: Array) -> None:
        n, dtype = self._n + len(part), part.dtype if self._rows is None else np.result_type(self._rows, part)
        if self._rows is None or n > len(self._rows) or dtype != self._rows.dtype:
            rows = np.empty((max(self._room, n + n // 2), *part.shape[1:]), dtype, "F")  # each column in one piece
            if self._n:
                rows[: self._n] = self._rows[: self._n]
            self._rows = rows
        self._rows[self._n : n] = part
        self._n = n

    @property
    def whole(self) -> Any:
        """All of them, as one part."""
        if self._n_parts == 1:
            return self._first
        if isinstance(self._rows, np.ndarray):
            return self._rows[: self._n]
        if self._kind in (None, NoneType, list):
            return self._rows
        parts = {name: pile.whole for name, pile in self._piles.items()}
        return parts if self._kind is dict else self._kind(*parts.values())


def join_all(parts: Sequence[Any]) -> Any:
    """Put the rows of all parts after each other, as a `Pile` does.

    >>> join_all([{"x": np.array([1.0]), "y": None}, {"x": np.array([2.0, 3.0]), "y": np.array([4.0])}])
    {'x': array([1., 2., 3.]), 'y': None}
    """
    pile = Pile()
    for part in parts:
        pile.add(part)
    return pile.whole


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


def products[T: np.floating](one: NDArray[T], other: NDArray[T]) -> NDArray[T]:
    """Return ``one.T @ other``, of (n, k) and (n, l): (k, l).

    In blocks that BLAS multiplies in one thread: its threads cost more than they save.

    >>> products(np.array([[1.0, 2.0], [3.0, 4.0]]), np.array([[1.0], [10.0]])).tolist()
    [[31.0], [42.0]]
    """
    size = max(_BLAS_ALONE // max(one.shape[1] * other.shape[1], 1), 1)
    whole = len(one) // size * size
    first, second = (each[:whole].reshape(-1, size, each.shape[1]) for each in (one, other))
    summed: NDArray[T] = (first.transpose(0, 2, 1) @ second).sum(axis=0) + one[whole:].T @ other[whole:]
    return summed


def times[T: np.floating](weights: NDArray[T], values: NDArray[T]) -> NDArray[T]:
    """Return ``weights @ values``, of (k, l) and (l, n): (k, n), in such blocks.

    >>> times(np.array([[1.0, 10.0]]), np.array([[1.0, 2.0], [3.0, 4.0]])).tolist()
    [[31.0, 42.0]]
    """
    size = max(_BLAS_ALONE // max(weights.size, 1), 1)
    parts = [weights @ values[:, first : first + size] for first in range(0, values.shape[1], size)]
    return np.concatenate(parts, axis=1) if parts else weights @ values


def lengths(x: Floats, y: Floats) -> Floats:
    """Return how long vectors in a plane are, as `np.hypot` does in eight times the time.

    >>> lengths(np.array([3.0, 0.0]), np.array([-4.0, 0.0])).tolist()
    [5.0, 0.0]
    """
    found: Floats = np.abs(x + 1j * y)
    return found


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


def stack_columns[T: np.generic](columns: Sequence[NDArray[T]]) -> NDArray[T]:
    """Put columns of one dtype beside each other, (n_rows, n_columns), each in one piece of memory.

    >>> stack_columns([np.array([1, 2]), np.array([3, 4])]).tolist()
    [[1, 3], [2, 4]]
    """
    return np.array(columns).T
