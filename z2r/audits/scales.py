"""Is a column in one unit throughout? Held against the other episodes, and a velocity against what moves."""

from collections.abc import Iterator

import numpy as np

from z2r.arrays import Bools, Floats, Ints
from z2r.audits.frames import FileFrames
from z2r.audits.joints import UNIT
from z2r.audits.runs import Runs
from z2r.check import Answer, Check
from z2r.errors import Fault, count, some
from z2r.format.episodes import DATA_DIR
from z2r.format.rules import Rows, episodes_of
from z2r.format.schema import ACTION, STATE, column_label
from z2r.reading.stored import episodes_named

_FACTORS = {100.0: "percent and parts of 1", 180 / np.pi: "degrees and radians", 1000.0: "mm and m"}
_G = 9.80665  # m/s2, which is g
_OFF = 0.35  # of such a factor: episodes differ in how far a column goes
_MIN_EPISODES = 4

_VELOCITY = "observation.velocity"
_MIN_FRAMES = 20
_SMOOTHED = 5  # frames
_FOLLOWS, _BETTER = 0.8, 0.1  # correlation of a velocity with how fast a column moves, and more than with its own
_LATE, _LOOK = 3, 10  # frames: how late it may be, and how far one looks
_SAME_RATE = 1.5  # times too fast or too slow: a filter or a delay may be behind less


@UNIT.of(Runs)
def episodes_have_one_unit(runs: Runs) -> Iterator[Answer]:
    """Does a column go, in some episodes, through a known part of the range that it goes through in all the others?"""
    long = runs.n_frames >= _MIN_FRAMES
    if long.sum() < _MIN_EPISODES:
        return
    alike: dict[tuple[bytes, float], list[tuple[str, float, float]]] = {}
    for name in (each for each in (STATE, ACTION) if each in runs.steps and each in runs.stats):
        feature, path = runs.claims.schema.features[name], runs.steps[name].path
        span = runs.stats[name].high - runs.stats[name].low
        for column in range(feature.size):
            small, factor = np.zeros(len(long), dtype=bool), 0.0
            small[long], factor = _in_a_smaller_unit(span[long, column], path[long, column])
            if small.any():
                odd = _fewer(small, long & ~small)
                here, there = (float(np.median(span[each, column])) for each in (odd, long & ~odd))
                alike.setdefault((odd.tobytes(), factor), []).append((column_label(name, feature, column), here, there))
    for (some_runs, factor), columns in alike.items():
        number = runs.number[np.frombuffer(some_runs, dtype=bool)].tolist()
        labels, (_, here, there) = [label for label, *_ in columns], columns[0]
        found = f"a range of {here:.3g}{' of the first' if len(labels) > 1 else ''}"
        expected = f"about {there:.3g}, {factor:.4g} times {'as much' if here < there else 'less'}, as in the others"
        mend = f"Are these {_FACTORS[factor]}? Multiply or divide one of the two"
        place = f"{some(labels)} in {episodes_named(number)}"
        yield Fault(DATA_DIR, place, found, expected, mend, tuple(dict.fromkeys(number)))


def _fewer(some_runs: Bools, others: Bools) -> Bools:
    """Return those runs of two kinds that are fewer; of two that are as many, those that the first is not among."""
    return min(some_runs, others, key=lambda each: (each.sum(), each[np.argmax(some_runs | others)]))


def _in_a_smaller_unit(span: Floats, path: Floats) -> tuple[Bools, float]:
    """Find the episodes in which both are smaller by one of the factors, if all others are alike.

    Examples
    --------
    >>> small, factor = _in_a_smaller_unit(np.array([90.0, 0.95, 80, 99, 85]), np.array([300.0, 3, 280, 350, 310]))
    >>> small.nonzero()[0].tolist(), factor
    ([1], 100.0)
    """
    for factor in _FACTORS if path.all() else ():
        large = span > span.max() / np.sqrt(factor)
        usual_span, usual_path = np.median(span[large]), np.median(path[large])
        off = np.stack([span * factor / usual_span, path * factor / usual_path])
        fits = (np.abs(off - 1) <= _OFF).all(axis=0)
        if not large.all() and fits.any() and (large | fits).all():
            return ~large, factor
    return np.zeros(len(span), dtype=bool), 0.0


@UNIT.of(Runs)
def accelerations_have_one_unit(runs: Runs) -> Iterator[Answer]:
    """Is a column beside state and action, in some episodes, all in all a g-th of what it is in the others?"""
    long = runs.n_frames >= _MIN_FRAMES
    for name in (each for each in runs.steps if each not in (STATE, ACTION) and long.sum() >= _MIN_EPISODES):
        stats = runs.stats[name]
        for column in np.flatnonzero((np.abs(stats.mean) > stats.std).all(axis=0)).tolist():  # gravity is always there
            mean = np.abs(stats.mean[:, column])
            small = long & (mean * np.sqrt(_G) < mean.max())
            off = mean * np.where(small, _G, 1) / np.median(mean[long & ~small])
            if small.any() and (np.abs(off[long] - 1) <= _OFF).all():
                odd = _fewer(small, long & ~small)
                here, there = (float(np.median(stats.mean[each, column])) for each in (odd, long & ~odd))
                number = runs.number[odd].tolist()
                place = f"{column_label(name, runs.claims.schema.features[name], column)} in {episodes_named(number)}"
                found = f"{here:.3g} on average"
                times = "as much" if abs(here) < abs(there) else "less"
                expected = f"about {there:.3g}, {_G:.3g} times {times}, as in the others"
                mend = "Are these g and m/s2? Multiply or divide one of the two, and the other axes as well"
                yield Fault(DATA_DIR, place, found, expected, mend, tuple(dict.fromkeys(number)))


@Check("velocity", "a velocity says how fast the column of its name moves, in its unit", "warning").of(FileFrames)
def velocities_are_those_of_their_columns(frames: FileFrames) -> Iterator[Answer]:
    """Is `observation.velocity` how fast the columns of the state move that have the same names?"""
    columns, features = frames.read.frames, frames.schema.features
    if STATE not in columns or _VELOCITY not in columns:
        return
    states = features[STATE].dim_names
    starts = frames.run_starts
    stops = np.append(starts[1:], len(columns[STATE]))
    long = stops - starts >= _MIN_FRAMES
    runs = list(zip(starts[long].tolist(), stops[long].tolist(), strict=True))
    motion = [
        _smoothed(np.gradient(columns[STATE][a:b].astype(np.float64), axis=0)) * frames.schema.fps for a, b in runs
    ]
    for dim, name in enumerate(features[_VELOCITY].dim_names):
        if name in states and runs:
            said = [_smoothed(columns[_VELOCITY][a:b, dim : dim + 1].astype(np.float64)) for a, b in runs]
            rates = [_rate(velocity, moves) for velocity, moves in zip(said, motion, strict=True)]
            fits, factor = (np.array(each) for each in zip(*rates, strict=True))  # (n_runs, size)
            column = states.index(name)
            yield from _of_rates(frames, dim, column, fits, factor, starts[long])
            late = [_late(velocity[:, 0], moves[:, column]) for velocity, moves in zip(said, motion, strict=True)]
            yield from _of_delays(frames, dim, column, np.array(late), starts[long])


def _of_rates(frames: FileFrames, dim: int, column: int, fits: Floats, factor: Floats, starts: Ints) -> Iterator[Fault]:
    own, other = fits[:, column], np.delete(fits, column, axis=1).max(axis=1, initial=-1)
    exchanged = (other >= _FOLLOWS) & (other - own >= _BETTER)
    scaled = (
        ~exchanged
        & (own >= _FOLLOWS)
        & (np.abs(np.log(np.maximum(np.abs(factor[:, column]), 1e-9))) > np.log(_SAME_RATE))
    )
    features, numbers = frames.schema.features, frames.episodes_at(starts)
    label = column_label(_VELOCITY, features[_VELOCITY], dim)
    for what, wrong in ((label, exchanged), (f"the scale of {label}", scaled)):
        if wrong.any():
            run = int(wrong.argmax())
            as_fast = column_label(STATE, features[STATE], int(fits[run].argmax()))
            found = f"{factor[run, int(fits[run].argmax())]:.3g} where {as_fast} moves by 1 a second"
            expected = f"1 where {column_label(STATE, features[STATE], column)} does"
            mend = "Are columns exchanged, or is it in degrees where the state is in radians?"
            place, rows = f"{what} in episode {numbers[run]}", Rows(found, int(wrong.sum()))
            yield Fault(frames.path, place, rows, expected, mend, episodes_of(numbers, wrong))


def _of_delays(frames: FileFrames, dim: int, column: int, late: Ints, starts: Ints) -> Iterator[Fault]:
    wrong = np.abs(late) >= _LATE
    if wrong.any():
        run, numbers, features = int(wrong.argmax()), frames.episodes_at(starts), frames.schema.features
        label, moved = column_label(_VELOCITY, features[_VELOCITY], dim), column_label(STATE, features[STATE], column)
        when = "after" if late[run] > 0 else "before"
        rows = Rows(f"{count(abs(int(late[run])), 'frame')} {when} {moved} moves", int(wrong.sum()))
        mend = "Is it filtered, or of another time? A policy takes both for now"
        place = f"the time of {label} in episode {numbers[run]}"
        yield Fault(frames.path, place, rows, "when it does", mend, episodes_of(numbers, wrong))


def _late(velocity: Floats, moves: Floats) -> int:
    """Return how many frames a velocity is behind the motion that it fits best, if then far better; else 0.

    Examples
    --------
    >>> motion = np.sin(np.arange(60) / 5)
    >>> _late(np.roll(motion, 4)[8:], motion[8:])
    4
    """
    ahead = np.arange(-_LOOK, _LOOK + 1)
    inner = slice(_LOOK, len(moves) - _LOOK)
    if len(moves) < 4 * _LOOK:
        return 0
    fits = [float(_rate(np.roll(velocity, -by)[inner, None], moves[inner, None])[0][0]) for by in ahead.tolist()]
    best = int(np.argmax(fits))
    surely = fits[best] >= _FOLLOWS and fits[best] - fits[_LOOK] >= _BETTER
    return int(ahead[best]) if surely else 0


def _smoothed(values: Floats) -> Floats:
    """Average each row (n, size) with those around it: a difference is mostly noise."""
    whole = np.cumsum(np.concatenate([np.zeros((1, values.shape[1])), values]), axis=0)
    smoothed: Floats = (whole[_SMOOTHED:] - whole[:-_SMOOTHED]) / _SMOOTHED
    return smoothed


def _rate(velocity: Floats, moves: Floats) -> tuple[Floats, Floats]:
    """Return how a velocity (n, 1) goes with the motion of each column (n, size): correlations, and factors."""
    velocity, moves = velocity - velocity.mean(), moves - moves.mean(axis=0)
    both, of_moves = (velocity * moves).sum(axis=0), np.square(moves).sum(axis=0)
    sizes = np.sqrt(of_moves * np.square(velocity).sum())
    fits = np.divide(both, sizes, out=np.zeros_like(both), where=sizes > 0)
    factor = np.divide(both, of_moves, out=np.zeros_like(both), where=of_moves > 0)
    return fits, factor
