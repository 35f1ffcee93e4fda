"""Are the values what a sensor gives? Summed up for each run of frames, so that no file stays in memory."""

import re
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from z2r.arrays import Bools, Columns, Floats, Ints
from z2r.audits.frames import FileFrames, RunStats
from z2r.audits.runs import Runs
from z2r.check import Answer, Check
from z2r.errors import Fault
from z2r.format.episodes import DATA_DIR
from z2r.format.rules import and_more
from z2r.format.schema import ACTION, STATE, Feature
from z2r.format.tables import STATS_PATH, read_shard_statistics
from z2r.reading.scene import FROZEN

UNIT_TOLERANCE = 0.01  # of sin² + cos²: rounding to three digits stays within
JUMP = 10  # times the step that is usual: no sensor of a moving robot was seen to do that by itself

_MIN_EPISODES = 5  # from fewer nothing can be said about what is usual
_LONG = 20  # frames: a sensor may well stand still for less
_NEARLY_ALL = 0.9  # of the episodes
_ROUGH = 5e-6  # of a variance, as a share of the largest square
_FLOAT32_ROUNDING = 2.0**-24  # of a number, at most


FINITE = Check("finite", "there is no NaN, no infinity, and no gap", "error")


@FINITE.of(FileFrames)
def finite(frames: FileFrames) -> Iterator[Answer]:
    """Is every value a number?"""
    yield from frames.read.gaps


@Check("unit-circle", "sin² + cos² is 1 for every angle that is stored as (sin, cos)", "error").of(FileFrames)
def unit_circle(frames: FileFrames) -> Iterator[Answer]:
    """Is sin² + cos² = 1 for every angle that is stored as (sin, cos)?"""
    for name, values in frames.read.frames.items():
        feature = frames.schema.features[name]
        for sine, cosine in unit_pairs(feature):
            squares = np.square(values[:, [sine, cosine]].astype(np.float64)).sum(axis=1)
            wrong = np.abs(squares - 1) > UNIT_TOLERANCE
            if wrong.any():
                row = int(wrong.argmax())
                place = f"{name}: {feature.dim_names[sine]}² + {feature.dim_names[cosine]}² in row {row}"
                yield Fault(frames.path, place, f"{squares[row]:.3f}{and_more(wrong)}", "1: a sine and its cosine")


@Check("jump", "no value leaps away and back, many times further than it moves elsewhere", "warning").of(Runs)
def jump(runs: Runs) -> Iterator[Answer]:
    """Does a value leap away and back?"""
    for name, stats in runs.stats.items():
        yield from jumps(name, runs.claims.schema.features[name], stats, runs.number)


@FROZEN.of(Runs)
def no_sensor_is_frozen(runs: Runs) -> Iterator[Answer]:
    """Does a sensor stand still for a long episode while it moves in nearly all others?

    Not where the action of the same name stands still too: then nobody asked it to move.
    """
    if STATE not in runs.stats:
        return
    feature, stats = runs.claims.schema.features[STATE], runs.stats[STATE]
    long = stats.n >= _LONG
    if long.sum() < _MIN_EPISODES:
        return
    wrong = _still(stats, long)
    asked = runs.claims.schema.features[ACTION].dim_names if ACTION in runs.stats else ()
    for column, name in enumerate(feature.dim_names):
        if name in asked:
            action = runs.stats[ACTION]
            wrong[:, column] &= (action.high > action.low)[:, asked.index(name)]
    for column in np.flatnonzero(wrong.any(axis=0)).tolist():
        run = int(wrong[:, column].argmax())
        found = f"{stats.low[run, column]:.4g} in all {stats.n[run]:.0f} frames{and_more(wrong[:, column])}"
        place = f"{STATE}{_dim(feature, column)} in episode {runs.number[run]}"
        yield Fault(DATA_DIR, place, found, "a value that moves, as in the other episodes")


@FROZEN.of(Runs)
def no_sensor_is_dead(runs: Runs) -> Iterator[Answer]:
    """Does an observation stand still in all frames although the action of the same name moves it?"""
    if STATE not in runs.stats or ACTION not in runs.stats:
        return
    features = runs.claims.schema.features
    state, action = features[STATE].dim_names, features[ACTION].dim_names
    for name in (name for name in action if name in state):
        asked = _span(runs.stats[ACTION], action.index(name))
        seen = _span(runs.stats[STATE], state.index(name))
        if asked[0] < asked[1] and seen[0] == seen[1]:
            expected = f"one that moves: the action {name} goes from {asked[0]:.3g} to {asked[1]:.3g}"
            yield Fault(DATA_DIR, f"{STATE}[{name}]", f"{seen[0]:.4g} in all frames", expected)


@Check("twin", "no demonstration is there twice", "warning").of(Runs)
def twin(runs: Runs) -> Iterator[Answer]:
    """Is the same demonstration there twice? Every sum of every feature is the same then, to the last bit."""
    if not runs.stats:
        return
    columns = [column.reshape(len(runs.number), -1) for stats in runs.stats.values() for column in stats]
    rows = np.concatenate(columns, axis=1)
    first: dict[bytes, int] = {}
    long = np.flatnonzero(next(iter(runs.stats.values())).n >= _LONG)
    twins = [(run, same) for run in long.tolist() if (same := first.setdefault(rows[run].tobytes(), run)) != run]
    if twins:
        run, same = twins[0]
        found = f"episode {runs.number[same]} again, frame for frame{and_more(np.ones(len(twins), dtype=bool))}"
        mend = "It counts twice in training, and may stand on both sides of a split"
        yield Fault(DATA_DIR, f"episode {runs.number[run]}", found, "every demonstration once", mend)


STATS = Check("stats", "the stored statistics are those of the data", "warning")


@STATS.of(Runs)
def stats_of_the_dataset(runs: Runs) -> Iterator[Answer]:
    """Are the statistics in meta/stats.json those of the data?"""
    stored = runs.claims.stored.stats.value
    if stored is None or len(runs.read) < len(runs.claims.paths):
        return
    for name, stats in _flat(runs).items():
        if not stored.get(name):
            yield Fault(STATS_PATH, name, "no statistics", "some for each numeric feature")
            continue
        mend = "A policy scales its input with them: recompute the statistics"
        feature, longest = runs.claims.schema.features[name], float(stats.n.max())
        for what, said, computed in _differences(stored[name], _pooled(stats), longest, feature):
            yield Fault(STATS_PATH, f"{name}.{what}", said, f"{computed}, recomputed", mend)


@STATS.of(Runs)
def stats_of_each_episode(runs: Runs) -> Iterator[Answer]:
    """Are the statistics of each episode, which are stored with the metadata, those of its frames?"""
    run_of_episode = {number: run for run, number in enumerate(runs.number.tolist())}
    flat, features = _flat(runs), runs.claims.schema.features
    for shard in runs.claims.stored.episodes.value.shards:
        wanted = {name: features[name] for name in flat}
        (numbers, stored), faults = read_shard_statistics(runs.claims.root, shard, wanted)
        run = np.array([run_of_episode.get(number, -1) for number in numbers.tolist()], dtype=np.int64)
        for name, columns in stored.items():
            yield from _episode_differences(shard, name, features[name], columns, flat[name], run)
        for fault in faults:
            yield "error", fault


def unit_pairs(feature: Feature) -> list[tuple[int, int]]:
    """Find the dimensions that hold a sine and a cosine of one angle, by their names.

    >>> unit_pairs(Feature("float32", (3,), ["sin_yaw", "x", "cos_yaw"]))
    [(0, 2)]
    """
    names = feature.dim_names
    partners = [re.sub(r"(?<![^\W_])sin(?![^\W_])", "cos", name) for name in names]
    return [(i, names.index(other)) for i, other in enumerate(partners) if other != names[i] and other in names]


def jumps(name: str, feature: Feature, stats: RunStats, numbers: Ints) -> Iterator[Fault]:
    """Find where a value of one feature leaps away and back, many times further than it moves elsewhere.

    A leap that stays may be a switch; one by a whole turn, there and back, is an angle at the end of its range.
    """
    moving = stats.n >= _MIN_EPISODES
    if moving.sum() < _MIN_EPISODES:
        return
    usual = np.median(stats.step[moving], axis=0)
    a_turn = np.isclose(stats.spike, 2 * np.pi, rtol=0.01) | np.isclose(stats.spike, 360, rtol=0.01)
    wrong = (stats.spike > JUMP * usual) & (usual > 0) & ~a_turn
    for column in np.flatnonzero(wrong.any(axis=0)).tolist():
        run = int(np.where(wrong, stats.spike, 0)[:, column].argmax())
        found = f"a leap of {stats.spike[run, column]:.3g} away and back{and_more(wrong[:, column])}"
        expected = f"steps of about {usual[column]:.3g} at most, as in the other episodes"
        yield Fault(DATA_DIR, f"{name}{_dim(feature, column)} in episode {numbers[run]}", found, expected)


def _still(stats: RunStats, long: Bools) -> Bools:
    """Tell of each run and column whether it stands still, and nearly all others move."""
    span = stats.high - stats.low
    moves = span > 0
    # What goes from one end of its span to the other in one step is a switch, and may well not be used.
    is_switch = (~moves | (stats.step > _NEARLY_ALL * span))[long].mean(axis=0) > 0.5
    still = ~moves & long[:, None]
    seldom = still.sum(axis=0) <= max(1, (1 - _NEARLY_ALL) * long.sum())
    wrong: Bools = still & seldom & ~is_switch
    return wrong


def _span(stats: RunStats, column: int) -> tuple[float, float]:
    """From where to where a column goes in all runs together."""
    return float(stats.low[:, column].min()), float(stats.high[:, column].max())


def _flat(runs: Runs) -> dict[str, RunStats]:
    """Of a matrix, LeRobot stores the statistics of the last axis only: leave it out.

    What is taken for something else is left out too. Its statistics are numbers of the same file, in the same unit and
    order, whatever that is: who is wrong about the one is wrong about the other, and the two cannot refute each other.
    """
    features, misread = runs.claims.schema.features, runs.claims.misread
    left_out = misread.features if misread else ()
    return {
        name: stats for name, stats in runs.stats.items() if len(features[name].shape) == 1 and name not in left_out
    }


def _episode_differences(
    shard: Path, name: str, feature: Feature, columns: Columns, stats: RunStats, run: Ints
) -> Iterator[Answer]:
    there = run >= 0
    of_each = _rows_of(stats, run[there])
    for kind, computed, tolerance in _statistics(of_each, of_each.n[:, None]):
        if kind not in columns:
            continue
        stored = columns[kind][there].astype(np.float64)
        wrong = ~(np.abs(stored - computed) <= tolerance)
        if wrong.any():
            row, column = np.argwhere(wrong)[0].tolist()
            dim = "" if kind == "count" else _dim(feature, column)
            place = f"stats/{name}/{kind}{dim} in row {np.flatnonzero(there)[row]}"
            said = f"{stored[row, column]:.6g}{and_more(wrong)}"
            yield Fault(shard, place, said, f"{computed[row, column]:.6g}, recomputed")


def _rows_of(stats: RunStats, rows: Ints) -> RunStats:
    return RunStats(**{name: column[rows] for name, column in stats._asdict().items()})


def _pooled(stats: RunStats) -> RunStats:
    """Take all runs together: one row."""
    count, weight = stats.n.sum(), stats.n[:, None]
    mean = (stats.mean * weight).sum(axis=0) / count
    return RunStats(
        n=np.array([count]),
        low=stats.low.min(axis=0)[None],
        high=stats.high.max(axis=0)[None],
        mean=mean[None],
        squares=(stats.squares + weight * np.square(stats.mean - mean)).sum(axis=0)[None],
        step=stats.step.max(axis=0)[None],
        spike=stats.spike.max(axis=0)[None],
    )


def _statistics(stats: RunStats, longest: Floats | float) -> Iterator[tuple[str, Floats, Floats]]:
    """Yield each statistic as LeRobot names it, with how far a stored one may be off.

    LeRobot 0.6.1 sums the frames of one episode, `longest` at most, up in float32 (`lerobot/datasets/compute_stats.py`:
    `RunningQuantileStats`), and takes the variance as a difference of two such means. Each addition is rounded, and
    where a column stands still, always the same way.
    """
    n = stats.n[:, None]
    std = np.sqrt(stats.squares / n)
    size = np.maximum(np.abs(stats.low), np.abs(stats.high))
    close, rounded = 1e-5 * size + 1e-6, longest * _FLOAT32_ROUNDING
    yield "count", n, np.zeros_like(n)
    yield "min", stats.low, close
    yield "max", stats.high, close
    yield "mean", stats.mean, close + rounded * size + 1e-3 * std
    rough = np.maximum(_ROUGH * np.maximum(1, n / 5_000), rounded) * np.square(size)
    yield "std", std, close + 1e-3 * std + np.sqrt(np.square(std) + rough) - std


def _differences(
    stored: Mapping[str, Any], stats: RunStats, longest: float, feature: Feature
) -> Iterator[tuple[str, str, str]]:
    """Yield the statistics that differ: which one, what is stored, what is right."""
    for kind, computed, tolerance in _statistics(stats, longest):
        if kind not in stored:
            yield kind, "nothing", f"{computed.size} numbers"
            continue
        try:
            claimed = np.asarray(stored[kind], dtype=np.float64).ravel()
        except (TypeError, ValueError, OverflowError):
            yield kind, "something else", f"{computed.size} numbers"
            continue
        if claimed.size != computed.size:
            yield kind, f"{claimed.size} numbers", f"{computed.size} numbers"
            continue
        wrong = ~(np.abs(claimed - computed[0]) <= tolerance[0])
        if wrong.any():
            column = int(wrong.argmax())
            place = kind if kind == "count" else f"{kind}{_dim(feature, column)}"
            yield place, f"{claimed[column]:.6g}{and_more(wrong)}", f"{computed[0, column]:.6g}"


def _dim(feature: Feature, column: int) -> str:
    return f"[{feature.dim_names[column]}]" if feature.dim_names else f"[{column}]" if feature.size > 1 else ""
