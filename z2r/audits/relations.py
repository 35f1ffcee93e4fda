"""Does each column go with the others as it does in the other episodes? Nothing is declared, and no name is read.

What a column is at a moment, and how it changes there, mostly follows from all others: the state from the command, an
effort from the posture, a foot's contact from its leg. How it does, only the dataset itself can say: it is learned from
the other episodes. Where a column of one episode is far from what it should be by that, something else is recorded.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from z2r.arrays import Bools, Columns, Floats, Ints, products, times
from z2r.audits.runs import Runs
from z2r.check import Answer, Check
from z2r.errors import Fault, count
from z2r.format.episodes import DATA_DIR
from z2r.format.schema import Schema, column_label
from z2r.reading.stored import episodes_named

_MOST, _LEAST = 32, 8  # moments of an episode
_NUMBERS = 2**22  # that are kept of a dataset, at most: about a tenth of a second, and 16 MiB
_MIN_FRAMES = 20
_MIN_EPISODES = 6  # from fewer nothing can be said about what is usual
_FOLDS = 8  # of the episodes: each is foretold from the others
_ROUNDS = 3  # until those that differ teach the others nothing
_DOUBT = 1e-3  # of a variance
_CLIP = 10  # spreads: so much an episode may teach at most
_TELLS = 0.3  # spreads: what is usually farther off cannot be foretold
_FAR, _FARTHER, _FARTHEST = 0.4, 3.5, 2  # spreads; times what is usual; times what four in five episodes stay below
_FEW = 0.3  # of the episodes: of more, nobody knows which ones are right


def moments_to_keep(schema: Schema, n_episodes: int) -> int:
    """Return how many moments of each episode are kept, so that all of them are few enough; 0 where none are."""
    n = min(_MOST, _NUMBERS // max(2 * _n_columns(schema) * n_episodes, 1))
    return n if n >= _LEAST and n_episodes >= _MIN_EPISODES else 0


def keep_moments(schema: Schema, signals: Columns, starts: Ints, n_moments: int) -> NDArray[np.float32] | None:
    """Return what all columns are at some moments of each run, and how they change there.

    Parameters
    ----------
    schema : Schema
        The features, whose order is that of the columns.
    signals : dict of str to ndarray, (n_rows, size)
        The numeric features that can be read.
    starts : ndarray, int64[n_runs]
        The first row of each run.
    n_moments : int
        Evenly through it.

    Returns
    -------
    ndarray, float32[n_runs, n_moments, 2, n_columns], or None
        NaN in runs of fewer than 20 frames. In memory, runs lie beside each other: what is asked is asked by column.
        None where a feature cannot be read, or no moments are asked for.
    """
    if not n_moments or not signals or signals.keys() != schema.signals().keys():
        return None
    columns = [column for name in schema.signals() for column in signals[name].T]
    n = np.diff(starts, append=len(columns[0]))
    rows = starts[:, None] + (1 + np.linspace(0, 1, n_moments) * (n[:, None] - 3)).round().astype(np.int64)
    long = n >= _MIN_FRAMES
    rows = rows[long].T  # (n_moments, n_long)
    moments = np.full((len(columns), 2, n_moments, len(starts)), np.nan, dtype=np.float32)
    for place, column in enumerate(columns):
        moments[place, 0][:, long] = column[rows]
        moments[place, 1][:, long] = column[rows + 1] - column[rows - 1]
    return moments.T


def not_related(schema: Schema, n_episodes: int, moments: NDArray[np.float32] | None) -> str:
    """Say why no column is held against the others, of the moments that are kept of all files; empty where they are."""
    few = f"there are fewer than {_MIN_EPISODES} episodes of {_MIN_FRAMES} frames or more"
    if n_episodes < _MIN_EPISODES:
        return few
    if not moments_to_keep(schema, n_episodes):
        return f"{n_episodes:,} episodes of so many columns are too many"
    if moments is None:
        return "not all of them can be read"
    return few if _is_told(moments).sum() < _MIN_EPISODES else ""


def _n_columns(schema: Schema) -> int:
    return sum(feature.size for feature in schema.signals().values())


def _is_told(moments: NDArray[np.float32]) -> Bools:
    """Tell of which runs moments are kept, bool[n_runs]."""
    told: Bools = np.asarray(np.isfinite(moments).all(axis=(1, 2, 3)))
    return told


RELATION = Check("relation", "each column goes with the others as it does in the other episodes", "note")


@RELATION.of(Runs)
def columns_go_with_the_others(runs: Runs) -> Iterator[Answer]:
    """Is a column of an episode far from what all others say that it should be?"""
    if runs.moments is None:
        return
    labels = [
        column_label(name, runs.claims.schema.features[name], column)
        for name in runs.stats
        for column in range(runs.claims.schema.features[name].size)
    ]
    told = np.flatnonzero(_is_told(runs.moments))
    if len(told) < _MIN_EPISODES:
        return
    off = _off(runs.moments.T, told)
    worst = np.where(off.wrong, off.far / np.maximum(off.usual, _DOUBT), 0).argmax(axis=1)
    odd = off.wrong.any(axis=1)
    for column in np.unique(worst[odd]).tolist():
        rows = np.flatnonzero(odd & (worst == column))
        row = int(rows[off.far[rows, column].argmax()])
        others = int(off.wrong[row].sum()) - 1
        more = f", as {count(others, 'more column')}" if others else ""
        number = runs.number[told[rows]].tolist()
        found = f"values {off.far[row, column]:.2f} spreads from what the other columns foretell{more}"
        expected = f"about {off.usual[column]:.2f}, as in the other episodes"
        mend = "Is one of them of another time, unit, sign or place, or did something else happen there? Look at it"
        yield Fault(DATA_DIR, f"{labels[column]} in {episodes_named(number)}", found, expected, mend, tuple(number))


class _Off(NamedTuple):
    """How far off each column is in each episode, (n, n_columns), what is usual, (n_columns,), and where it is too far.

    Distances are root mean squares, in spreads.
    """

    far: Floats
    usual: Floats
    wrong: Bools


def _off(moments: NDArray[np.float32], told: Ints) -> _Off:
    """Foretell each column, (n_columns, 2, n_moments, n_runs), from all else of its moment, in some of the runs.

    It is learned from other episodes. The inverse of a covariance holds the regressions of each variable on all the
    others (Lauritzen, "Graphical Models", 1996, section 5.1.3), so one inverse foretells all columns at once.
    """
    n_columns, _, n_moments, _ = moments.shape
    series = moments.reshape(2 * n_columns, n_moments, -1)  # each column, and after it how it changes
    scales = [_middle_and_spread(column.take(told, axis=1)) for column in series]
    scale = np.array(scales, np.float32).T[..., None, None]
    fold, good = np.arange(len(told)) % _FOLDS, np.ones(len(told), dtype=bool)
    for _ in range(_ROUNDS):
        learned = (_scaled(series, scale, told[good & (fold == one)]).T for one in range(_FOLDS))
        sums = [products(each, each).astype(np.float64) for each in learned]
        far = np.empty((len(told), n_columns))
        for one in range(_FOLDS):
            others = sum(sums) - sums[one]
            covariance = others / max((good & (fold != one)).sum() * n_moments, 1)
            inverse = np.linalg.inv(covariance + _DOUBT * np.eye(len(series)))
            weights = (inverse / np.diag(inverse))[:, ::2].T.astype(np.float32)  # (n_columns, 2 n_columns)
            left = times(weights, _scaled(series, scale, told[fold == one])).reshape(n_columns, n_moments, -1)
            far[fold == one] = np.sqrt(np.square(left, out=left).mean(axis=1)).T
        usual = np.median(far, axis=0)
        limit = np.maximum(np.maximum(_FAR, _FARTHER * usual), _FARTHEST * np.quantile(far, 0.8, axis=0))
        wrong = (far >= limit) & (usual <= _TELLS)
        now = ~wrong.any(axis=1)
        if (now == good).all() or now.mean() < 1 - _FEW:
            break
        good = now
    return _Off(far, usual, wrong & (wrong.mean(axis=0) <= _FEW))


def _middle_and_spread(column: NDArray[np.float32]) -> tuple[float, float]:
    """Return where a column, (n_moments, n), is, and how far its moments are from there; 1 if nothing moves."""
    middle = np.median(column.mean(axis=0))
    spread = np.sqrt(np.square(column - middle).mean(dtype=np.float64))
    return float(middle), float(spread) or 1.0


def _scaled(series: NDArray[np.float32], scale: NDArray[np.float32], runs: Ints) -> NDArray[np.float32]:
    """Count the moments of some runs, (k, n_moments, n_runs), from the middle, in spreads: float32[k, n].

    Of a part of the runs at a time, for all of them at once are much.
    """
    scaled = series.take(runs, axis=2)
    middle, spread = scale
    np.clip((scaled - middle) / spread, -_CLIP, _CLIP, out=scaled)
    return scaled.reshape(len(series), -1)
