"""Are the values what a sensor gives? Summed up for each run of frames, so that no file stays in memory."""

import re
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa

from z2r.arrays import Array, Columns, Floats, Ints
from z2r.audits.findings import Finding, error, from_fault, warning
from z2r.audits.index import and_more
from z2r.audits.structure import STATS_PATH
from z2r.errors import DatasetError
from z2r.format.parquet import integers, open_parquet, read_columns, vectors
from z2r.format.schema import ACTION, STATE, Feature, Schema

UNIT_TOLERANCE = 0.01  # of sin² + cos²: rounding to three digits stays within
JUMP = 10  # times the step that is usual: no sensor of a moving robot was seen to do that by itself

_KINDS = ("count", "min", "max", "mean", "std")  # of statistics
_FEW = 5  # episodes: from so few nothing can be said about what is usual
_LONG = 20  # frames: a sensor may well stand still for less
_MOST = 0.9  # of the episodes
_ROUGH = 5e-6  # of a variance, as a share of the largest square


class RunStats(NamedTuple):
    """One feature in each run of frames: float64[n_runs] and float64[n_runs, size].

    `n` is the number of frames, `squares` the sum of the squared distances from the mean, `step` the largest step from
    one frame to the next, `spike` the largest step that the next one takes back.
    """

    n: Floats
    low: Floats
    high: Floats
    mean: Floats
    squares: Floats
    step: Floats
    spike: Floats


def sum_up(values: Array, starts: Ints) -> RunStats:
    """Sum one feature up for each run; a run begins at each of `starts` and ends where the next begins."""
    count = np.diff(np.append(starts, len(values)))
    # One column after another: numpy reduces adjacent numbers many times faster, and copies stay small.
    columns = [_sum_up_column(column.astype(np.float64), starts, count) for column in values.T]
    sums = np.array(columns).reshape(values.shape[1], 6, len(starts))
    return RunStats(count.astype(np.float64), *(sums[:, place].T for place in range(6)))


def _sum_up_column(values: Floats, starts: Ints, count: Ints) -> tuple[Floats, ...]:
    mean = np.add.reduceat(values, starts) / count
    squares = np.add.reduceat(np.square(values - np.repeat(mean, count)), starts)
    steps = np.diff(values, prepend=values[:1])
    steps[starts] = 0
    back = np.append(-steps[1:], 0.0)
    spikes = np.maximum(np.minimum(steps, back), np.minimum(-steps, -back))  # both the same way, or below 0
    low, high = np.minimum.reduceat(values, starts), np.maximum.reduceat(values, starts)
    return low, high, mean, squares, np.maximum.reduceat(np.abs(steps), starts), np.maximum.reduceat(spikes, starts)


def joined(parts: list[RunStats]) -> RunStats:
    """Put the runs of all files after each other."""
    return RunStats(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))


def unit_pairs(feature: Feature) -> list[tuple[int, int]]:
    """Find the dimensions that hold a sine and a cosine of one angle, by their names.

    >>> unit_pairs(Feature("float32", (3,), ["sin_yaw", "x", "cos_yaw"]))
    [(0, 2)]
    """
    names = feature.dim_names
    partners = [re.sub(r"(?<![^\W_])sin(?![^\W_])", "cos", name) for name in names]
    return [(i, names.index(other)) for i, other in enumerate(partners) if other != names[i] and other in names]


def check_unit_circle(frames: Columns, schema: Schema, path: Path) -> Iterator[Finding]:
    """Is sin² + cos² = 1 for every angle that is stored as (sin, cos)?"""
    for name, values in frames.items():
        feature = schema.features[name]
        for sine, cosine in unit_pairs(feature):
            squares = np.square(values[:, [sine, cosine]].astype(np.float64)).sum(axis=1)
            wrong = np.abs(squares - 1) > UNIT_TOLERANCE
            if wrong.any():
                row = int(wrong.argmax())
                pair = f"{feature.dim_names[sine]}² + {feature.dim_names[cosine]}²"
                found = f"{squares[row]:.3f}{and_more(wrong)}"
                yield error("unit-circle", path, f"{name}: {pair} in row {row}", found, "1: a sine and its cosine")


def check_stats(
    stored: Mapping[str, Mapping[str, Any]], runs: Mapping[str, RunStats], schema: Schema
) -> Iterator[Finding]:
    """Are the stored statistics those of the data?"""
    for name, stats in runs.items():
        if not stored.get(name):
            yield warning("stats", STATS_PATH, name, "no statistics", "some for each numeric feature")
            continue
        for what, told, computed in _differences(stored[name], _pooled(stats), schema.features[name]):
            mend = "A policy scales its input with them: recompute the statistics"
            yield warning("stats", STATS_PATH, f"{name}.{what}", told, f"{computed}, recomputed", mend)


def check_episode_stats(
    root: Path, shards: Sequence[Path], schema: Schema, runs: Mapping[str, RunStats], run_of_episode: Mapping[int, int]
) -> Iterator[Finding]:
    """Are the statistics of each episode, which are stored with the metadata, those of its frames?"""
    for path in shards:
        parquet = open_parquet(path)
        stored = parquet.schema_arrow.names
        numbers = integers(read_columns(parquet, path, ["episode_index"]), "episode_index", path).tolist()
        run = np.array([run_of_episode.get(number, -1) for number in numbers], dtype=np.int64)
        for name, stats in runs.items():
            columns = [column for kind in _KINDS if (column := f"stats/{name}/{kind}") in stored]
            try:
                table = read_columns(parquet, path, columns)
                yield from _check_shard_stats(table, path, root, name, schema.features[name], stats, run)
            except DatasetError as fault:
                yield from_fault("stats", fault, root)


def _check_shard_stats(
    table: pa.Table, path: Path, root: Path, name: str, feature: Feature, stats: RunStats, run: Ints
) -> Iterator[Finding]:
    there = run >= 0
    for kind, computed, tolerance in _statistics(RunStats(*(column[run[there]] for column in stats))):
        column_name = f"stats/{name}/{kind}"
        if column_name not in table.column_names:
            continue
        told = vectors(table, column_name, (1,) if kind == "count" else feature.shape, path)[there].astype(np.float64)
        wrong = ~(np.abs(told - computed) <= tolerance)
        if wrong.any():
            row, column = np.argwhere(wrong)[0].tolist()
            dim = "" if kind == "count" else _dim(feature, column)
            place = f"{column_name}{dim} in row {np.flatnonzero(there)[row]}"
            said = f"{told[row, column]:.6g}{and_more(wrong)}"
            yield warning("stats", path.relative_to(root), place, said, f"{computed[row, column]:.6g}, recomputed")


def check_jumps(name: str, feature: Feature, stats: RunStats, numbers: Ints) -> Iterator[Finding]:
    """Does a value leap away and back, many times further than it moves elsewhere?

    A leap that stays may be a switch; one by a whole turn, there and back, is an angle at the end of its range.
    """
    moving = stats.n >= _FEW
    if moving.sum() < _FEW:
        return
    usual = np.median(stats.step[moving], axis=0)
    a_turn = np.isclose(stats.spike, 2 * np.pi, rtol=0.01) | np.isclose(stats.spike, 360, rtol=0.01)
    wrong = (stats.spike > JUMP * usual) & (usual > 0) & ~a_turn
    for column in np.flatnonzero(wrong.any(axis=0)).tolist():
        run = int(np.where(wrong, stats.spike, 0)[:, column].argmax())
        found = f"a leap of {stats.spike[run, column]:.3g} away and back{and_more(wrong[:, column])}"
        expected = f"steps of about {usual[column]:.3g} at most, as in the other episodes"
        yield warning("jump", "data", f"{name}{_dim(feature, column)} in episode {numbers[run]}", found, expected)


def check_frozen(schema: Schema, runs: Mapping[str, RunStats], numbers: Ints) -> Iterator[Finding]:
    """Does a sensor stand still for a long episode while it moves in nearly all others?

    Not where the action of the same name stands still too: then nobody asked it to move.
    """
    if STATE not in runs:
        return
    feature, stats = schema.features[STATE], runs[STATE]
    long = stats.n >= _LONG
    if long.sum() < _FEW:
        return
    span = stats.high - stats.low
    moves = span > 0
    # What goes from one end of its span to the other in one step is a switch, and may well not be used.
    is_switch = (~moves | (stats.step > _MOST * span))[long].mean(axis=0) > 0.5
    still = ~moves & long[:, None]
    wrong = still & (still.sum(axis=0) <= max(1, (1 - _MOST) * long.sum())) & ~is_switch
    asked = schema.features[ACTION].dim_names if ACTION in runs else ()
    for column, name in enumerate(feature.dim_names):
        if name in asked:
            wrong[:, column] &= (runs[ACTION].high > runs[ACTION].low)[:, asked.index(name)]
    for column in np.flatnonzero(wrong.any(axis=0)).tolist():
        run = int(wrong[:, column].argmax())
        found = f"{stats.low[run, column]:.4g} in all {stats.n[run]:.0f} frames{and_more(wrong[:, column])}"
        place = f"{STATE}{_dim(feature, column)} in episode {numbers[run]}"
        yield warning("frozen", "data", place, found, "a value that moves, as in the other episodes")


def check_twins(runs: Mapping[str, RunStats], numbers: Ints) -> Iterator[Finding]:
    """Is the same demonstration there twice? Every sum of every feature is the same then, to the last bit."""
    if not runs:
        return
    rows = np.concatenate([column.reshape(len(numbers), -1) for each in runs.values() for column in each], axis=1)
    first: dict[bytes, int] = {}
    long = np.flatnonzero(next(iter(runs.values())).n >= _LONG)
    twins = [(run, twin) for run in long.tolist() if (twin := first.setdefault(rows[run].tobytes(), run)) != run]
    if twins:
        run, twin = twins[0]
        more = f" (and {len(twins) - 1:,} more like it)" if len(twins) > 1 else ""
        found = f"episode {numbers[twin]} again, frame for frame{more}"
        mend = "It counts twice in training, and may stand on both sides of a split"
        yield warning("twin", "data", f"episode {numbers[run]}", found, "every demonstration once", mend)


def check_dead(schema: Schema, runs: Mapping[str, RunStats]) -> Iterator[Finding]:
    """Does an observation stand still although the action of the same name moves it?"""
    if STATE not in runs or ACTION not in runs:
        return
    state, action = schema.features[STATE].dim_names, schema.features[ACTION].dim_names
    for name in (name for name in action if name in state):
        asked, seen = (
            (stats.high[:, column].max(), stats.low[:, column].min())
            for stats, column in ((runs[ACTION], action.index(name)), (runs[STATE], state.index(name)))
        )
        if asked[0] > asked[1] and seen[0] == seen[1]:
            expected = f"one that moves: the action {name} goes from {asked[1]:.3g} to {asked[0]:.3g}"
            yield warning("frozen", "data", f"{STATE}[{name}]", f"{seen[0]:.4g} in all frames", expected)


def _pooled(stats: RunStats) -> RunStats:
    """Take all runs together: one row."""
    count, weight = stats.n.sum(), stats.n[:, None]
    mean = (stats.mean * weight).sum(axis=0) / count
    squares = (stats.squares + weight * np.square(stats.mean - mean)).sum(axis=0)
    low, high = stats.low.min(axis=0), stats.high.max(axis=0)
    columns = (count, low, high, mean, squares, stats.step.max(axis=0), stats.spike.max(axis=0))
    return RunStats(*(np.array([column]) for column in columns))


def _statistics(stats: RunStats) -> Iterator[tuple[str, Floats, Floats]]:
    """Yield each statistic as LeRobot names it, with how far a stored one may be off."""
    std = np.sqrt(stats.squares / stats.n[:, None])
    size = np.maximum(np.abs(stats.low), np.abs(stats.high))
    close = 1e-5 * size + 1e-6
    yield "count", stats.n[:, None], np.zeros_like(stats.n[:, None])
    yield "min", stats.low, close
    yield "max", stats.high, close
    yield "mean", stats.mean, close + 1e-3 * std
    # LeRobot takes the variance as a difference of two means of squares, in float32: near 1, a small one is rough,
    # and more so the longer an episode is.
    rough = _ROUGH * np.maximum(1, stats.n[:, None] / 5_000) * np.square(size)
    yield "std", std, close + 1e-3 * std + np.sqrt(np.square(std) + rough) - std


def _differences(stored: Mapping[str, Any], stats: RunStats, feature: Feature) -> Iterator[tuple[str, str, str]]:
    """Yield the statistics that differ: which one, what is stored, what is right."""
    for kind, computed, tolerance in _statistics(stats):
        if kind not in stored:
            yield kind, "nothing", f"{computed.size} numbers"
            continue
        try:
            told = np.asarray(stored[kind], dtype=np.float64).ravel()
        except (TypeError, ValueError, OverflowError):
            yield kind, "something else", f"{computed.size} numbers"
            continue
        if told.size != computed.size:
            yield kind, f"{told.size} numbers", f"{computed.size} numbers"
            continue
        wrong = ~(np.abs(told - computed[0]) <= tolerance[0])
        if wrong.any():
            column = int(wrong.argmax())
            place = kind if kind == "count" else f"{kind}{_dim(feature, column)}"
            yield place, f"{told[column]:.6g}{and_more(wrong)}", f"{computed[0, column]:.6g}"


def _dim(feature: Feature, column: int) -> str:
    return f"[{feature.dim_names[column]}]" if feature.dim_names else f"[{column}]" if feature.size > 1 else ""
