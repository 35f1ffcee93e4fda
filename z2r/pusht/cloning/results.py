"""What did each misreading cost? The rows that were measured, and how far chance alone may have moved them.

`results.csv` holds one line for each policy and way to play it: how each of its starts ended. It is read without torch.
"""

import csv
from collections.abc import Sequence
from math import sqrt
from pathlib import Path
from typing import NamedTuple

import numpy as np

from z2r.arrays import Floats

RESULTS = Path(__file__).with_name("results.csv")
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

    @property
    def succeeded(self) -> Floats:
        """1 or 0 for each start, float64[n_starts]."""
        return np.array([float(each) for each in self.outcomes])


def read_results(path: Path = RESULTS) -> list[Result]:
    """Return all lines of a table, those that ship unless another is named; none where there is no file."""
    if not path.exists():
        return []
    with path.open(newline="") as file:
        return [Result(**{key: _KINDS[key](value) for key, value in line.items()}) for line in csv.DictReader(file)]


_KINDS = Result.__annotations__


def write_results(path: Path, results: Sequence[Result]) -> None:
    """Write a table, whole or not at all."""
    part = path.with_suffix(".part")
    with part.open("w", newline="") as file:
        lines = csv.writer(file, lineterminator="\n")
        lines.writerow(Result._fields)
        lines.writerows(results)
    part.replace(path)


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
        From `paired_difference`: the rate less that of the right reading, and between which that lies.
    """

    row: str
    demonstrations: int
    n_successes: int
    n_rollouts: int
    low: float
    high: float
    seeds: tuple[float, ...]
    cost: tuple[float, float, float]

    @property
    def rate(self) -> float:
        """Share of the rollouts that succeeded."""
        return self.n_successes / self.n_rollouts


def costs_of(results: Sequence[Result]) -> list[Cost]:
    """Sum up each row over its seeds, and hold it against the right reading of as many demonstrations."""
    by_row: dict[str, list[Result]] = {}
    for each in results:
        by_row.setdefault(each.row, []).append(each)
    return [_cost(rows, by_row["right-2000" if row.endswith("-2000") else "right"]) for row, rows in by_row.items()]


def _cost(rows: list[Result], right: list[Result]) -> Cost:
    seen = np.stack([each.succeeded for each in rows])  # (n_seeds, n_starts)
    n_starts = min(seen.shape[1], *(len(each.outcomes) for each in right))
    against = np.stack([each.succeeded[:n_starts] for each in right])
    return Cost(
        rows[0].row,
        rows[0].demonstrations,
        int(seen.sum()),
        seen.size,
        *wilson(int(seen.sum()), seen.size),
        tuple(seen.mean(axis=1).tolist()),
        paired_difference(seen[:, :n_starts], against),
    )


def table_of(results: Sequence[Result]) -> str:
    """Write the table in Markdown."""
    lines = ["| row | demonstrations | success | 95 % | each seed | against the right reading |", "| --- " * 6 + "|"]
    for each in costs_of(results):
        seeds = ", ".join(f"{rate:.0%}" for rate in each.seeds)
        difference, low, high = (100 * value for value in each.cost)
        lines.append(
            f"| {each.row} | {each.demonstrations:,} | {each.n_successes} of {each.n_rollouts}, {each.rate:.0%} |"
            f" {each.low:.0%} to {each.high:.0%} | {seeds} | {difference:+.0f} ({low:+.0f} to {high:+.0f}) points |"
        )
    return "\n".join(lines)
