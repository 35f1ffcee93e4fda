"""What did each misreading cost? The rows that were measured, and how far chance alone may have moved them.

`results.csv` holds one line for each policy and way to play it: how each of its starts ended. It is read without torch.
"""

import csv
from collections.abc import Callable, Sequence
from inspect import get_annotations
from math import sqrt
from pathlib import Path
from typing import NamedTuple

import numpy as np

from z2r.arrays import Floats
from z2r.pusht.played import Rollout

RESULTS, AUDITED, ROLLOUTS = (Path(__file__).with_name(name) for name in ("results.csv", "audited.csv", "rollouts.npz"))
SHOWN = ("right", "drop-boundaries", "late-2", "late-5", "exchanged", "step-for-velocity", "yaw-swap-in-training")
_Z = 1.959964  # of the normal distribution: 95 % lie within as many standard deviations


class Result(NamedTuple):
    """How one policy did, played one way.

    Attributes
    ----------
    row : str
        What was read wrong.
    demonstrations : int
        How many episodes it learned from, as they were read.
    seed : int
        What drew its first weights and its batches.
    outcomes : str
        A ``1`` for each start that succeeded and a ``0`` for each that did not, in the order of the starts: those of
        all rows are the same.
    seconds : float
        Mean length of its rollouts [s], those that ran out of time included.
    frames, batches : int
        How many frames it learned from, and in how many batches.
    minutes : float
        Of one core, to train and to play it.
    stack : str
        The machine, and the versions that matter.
    command : str
        What measures it again.
    against : str
        The row that it is held against.
    """

    row: str
    demonstrations: int
    seed: int
    outcomes: str
    seconds: float
    frames: int
    batches: int
    minutes: float
    stack: str
    command: str
    against: str

    @property
    def succeeded(self) -> Floats:
        """1 or 0 for each start, float64[n_starts]."""
        return np.array([float(each) for each in self.outcomes])


class Audited(NamedTuple):
    """What `z2r audit` says of a set of demonstrations of which some were damaged.

    Attributes
    ----------
    source : str
        The set, called as what was done to it.
    episodes, damaged : int
        How many there are, and how many of them were damaged.
    kept, kept_damaged : int
        How many `--keep` leaves, those that no error is about, and how many of these are damaged.
    unnamed, unnamed_damaged : int
        How many no error and no warning names, and how many of these are damaged.
    checks : str
        Which checks name damaged episodes, and how many of them; how many whole ones behind a ``+``.
    """

    source: str
    episodes: int
    damaged: int
    kept: int
    kept_damaged: int
    unnamed: int
    unnamed_damaged: int
    checks: str


def read_results(path: Path = RESULTS) -> list[Result]:
    """Return all lines of a table, those that ship unless another is named; none where there is no file."""
    return _read(path, Result)


def read_audited(path: Path = AUDITED) -> list[Audited]:
    """Return what the audit said of each set that was damaged, as it ships unless another file is named."""
    return _read(path, Audited)


def _read[T](path: Path, kind: Callable[..., T]) -> list[T]:
    if not path.exists():
        return []
    kinds = get_annotations(kind)
    with path.open(newline="") as file:
        return [kind(**{key: kinds[key](value) for key, value in line.items()}) for line in csv.DictReader(file)]


def write_table(path: Path, rows: Sequence[Result] | Sequence[Audited]) -> None:
    """Write a table of at least one row, whole or not at all."""
    part = path.with_suffix(".part")
    with part.open("w", newline="") as file:
        lines = csv.writer(file, lineterminator="\n")
        lines.writerow(rows[0]._fields)
        lines.writerows(rows)
    part.replace(path)


def read_rollout(row: str, number: int = 0, path: Path = ROLLOUTS) -> Rollout:
    """Return how a policy of a row that is shown went from a start, with the same number in all rows.

    Parameters
    ----------
    row : str
        One of `SHOWN`; or ``replay/`` and a mode of `z2r.pusht.simulator.replayed`, for the actions of `standin`.
    number : int, optional
        Which start, 0 to 2, or which episode of `standin`.
    path : Path, optional
        The file, that which ships unless named.
    """
    with np.load(path) as arrays:
        success, states, actions = (arrays[f"{row}/{number}/{part}"] for part in Rollout._fields)
    return Rollout(bool(success), states, actions)


def wilson(n_successes: int, n: int) -> tuple[float, float]:
    """Say between which rates the true one lies, 95 times in 100, if `n_successes` of `n` were seen (Wilson, 1927).

    >>> [round(each, 3) for each in wilson(0, 100)]
    [0.0, 0.037]
    """
    rate, spread = n_successes / n, _Z**2 / n
    middle, width = rate + spread / 2, _Z * sqrt(rate * (1 - rate) / n + spread / n / 4)
    return max(0.0, (middle - width) / (1 + spread)), min(1.0, (middle + width) / (1 + spread))


def paired_difference(one: Floats, other: Floats, n_draws: int = 10_000) -> tuple[float, float, float]:
    """Say by how much two rows differ on the same starts: the difference of their rates, and where it lies 95 in 100.

    Starts are drawn again, the same for both, and training seeds too, for each by itself: a bootstrap over both. With
    three seeds it knows little of the seeds.

    Parameters
    ----------
    one, other : ndarray, float64[n_seeds, n_starts]
        1 where a policy succeeded, 0 where not.
    n_draws : int, optional
        How often.
    """
    rng, n_starts = np.random.default_rng(0), one.shape[1]
    starts = rng.integers(n_starts, size=(n_draws, n_starts))
    drawn = []
    for row in (one, other):
        seeds = rng.integers(len(row), size=(n_draws, len(row)))
        weights = np.stack([(seeds == seed).sum(axis=1) for seed in range(len(row))], axis=1) / len(row)
        drawn.append(np.take_along_axis(weights @ row, starts, axis=1).mean(axis=1))
    low, high = np.quantile(drawn[0] - drawn[1], (0.025, 0.975)).tolist()
    return float(one.mean() - other.mean()), low, high


class Cost(NamedTuple):
    """What one row of the table says.

    Attributes
    ----------
    row : str
    demonstrations : int
    n_successes, n_rollouts : int
        Over all seeds.
    low, high : float
        Between which the true rate lies, 95 times in 100 (Wilson), as if every rollout were independent of the others.
    seeds : tuple of float
        The rate of each training seed.
    cost : tuple of float
        From `paired_difference`: the rate less that of the row that it is held against, and between which that lies.
    against : str
        That row.
    """

    row: str
    demonstrations: int
    n_successes: int
    n_rollouts: int
    low: float
    high: float
    seeds: tuple[float, ...]
    cost: tuple[float, float, float]
    against: str

    @property
    def rate(self) -> float:
        """Share of the rollouts that succeeded."""
        return self.n_successes / self.n_rollouts


def costs_of(results: Sequence[Result]) -> list[Cost]:
    """Sum up each row over its seeds, and hold it against another; where that is not among them, the one that ships."""
    by_row = _by_row(results)
    others = _by_row(read_results()) | by_row
    return [_cost(rows, others[rows[0].against]) for rows in by_row.values()]


def _by_row(results: Sequence[Result]) -> dict[str, list[Result]]:
    rows: dict[str, list[Result]] = {}
    for each in results:
        rows.setdefault(each.row, []).append(each)
    return rows


def _cost(rows: list[Result], others: list[Result]) -> Cost:
    seen = np.stack([each.succeeded for each in rows])  # (n_seeds, n_starts)
    n_starts = min(seen.shape[1], *(len(each.outcomes) for each in others))
    against = np.stack([each.succeeded[:n_starts] for each in others])
    return Cost(
        rows[0].row,
        rows[0].demonstrations,
        int(seen.sum()),
        seen.size,
        *wilson(int(seen.sum()), seen.size),
        tuple(seen.mean(axis=1).tolist()),
        paired_difference(seen[:, :n_starts], against),
        rows[0].against,
    )


def table_of(results: Sequence[Result]) -> str:
    """Write the table in Markdown."""
    lines = ["| row | demonstrations | success | 95 % | each seed | difference | from |", "| --- " * 7 + "|"]
    for each in costs_of(results):
        seeds = ", ".join(f"{rate:.0%}" for rate in each.seeds)
        difference, low, high = (100 * value for value in each.cost)
        lines.append(
            f"| {each.row} | {each.demonstrations:,} | {each.n_successes} of {each.n_rollouts}, {each.rate:.0%} |"
            f" {each.low:.0%} to {each.high:.0%} | {seeds} |"
            f" {difference:+.0f} ({low:+.0f} to {high:+.0f}) points | {each.against} |"
        )
    return "\n".join(lines)
