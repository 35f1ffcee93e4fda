"""Are the values what a sensor gives? Summed up for each run of frames, so that no file stays in memory."""

import re
from collections.abc import Collection, Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from z2r.arrays import Array, Bools, Floats, Ints
from z2r.audits.frames import FileColumns, FileFrames, RunStats
from z2r.audits.runs import Runs
from z2r.check import Answer, Check
from z2r.errors import Fault
from z2r.format.episodes import DATA_DIR
from z2r.format.rules import and_more, episodes_of
from z2r.format.schema import ACTION, STATE, Feature
from z2r.reading.scene import FROZEN

_SAME_TURN = 0.5  # cosine of half of what it turns in a frame
UNIT_TOLERANCE = 0.01  # of sin² + cos²: rounding to three digits stays within
_FURTHER = 10  # times the step that is usual: no sensor of a moving robot was seen to do that by itself

_MIN_EPISODES = 5  # from fewer nothing can be said about what is usual
_LONG = 40  # frames: a sensor may well stand still for less
_NEARLY_ALL = 0.9  # of the episodes
_ALWAYS, _SOMETIMES = 0.95, 0.75  # of the frames: what noise moves in all of them, and how much less is too little
_OFTEN, _SELDOM = 0.1, 0.15  # the same of what moves in some of them
_FEW = 0.3  # of the episodes
_MIXER = np.uint64(0x9E3779B97F4A7C15)  # odd: 2**64 over the golden ratio (Knuth, "Sorting and searching", 6.4)


FINITE = Check("finite", "there is no NaN, no infinity, and no gap", "error")


@FINITE.of(FileColumns)
def finite(file: FileColumns) -> Iterator[Answer]:
    """Is every value a number?"""
    yield from file.in_order(file.read.missing)
    yield from file.in_order(file.read.unfinite)


@Check("unit-circle", "sin² + cos² is 1 for every angle that is stored as (sin, cos)", "error").of(FileFrames)
def unit_circle(frames: FileFrames) -> Iterator[Answer]:
    """Is sin² + cos² = 1 for every angle that is stored as (sin, cos)?"""
    for name, values in frames.read.frames.items():
        feature = frames.schema.features[name]
        for sine, cosine in unit_pairs(feature):
            squares = _squares(values, (sine, cosine))
            wrong = np.abs(squares - 1) > UNIT_TOLERANCE
            if wrong.any():
                row = int(wrong.argmax())
                what, found = f"{feature.dim_names[sine]}² + {feature.dim_names[cosine]}²", f"{squares[row]:.3f}"
                yield frames.fault(f"{name}: {what}", wrong, found, "1: a sine and its cosine", framed=True)


def _squares(values: Array, columns: Sequence[int]) -> Floats:
    """Sum up the squares of some columns in each row, float64[n_rows]."""
    return sum((np.square(values[:, column].astype(np.float64)) for column in columns), start=np.zeros(len(values)))


JUMP = Check("jump", "no value leaps away and back, many times further than it moves elsewhere", "warning")


@Check("unit-quaternion", "the squares of a quaternion sum up to 1", "error").of(FileFrames)
def unit_quaternion(frames: FileFrames) -> Iterator[Answer]:
    """Are the squares of every quaternion 1 together? Else it is none, or its columns are not what they are called."""
    for name, values in frames.read.frames.items():
        feature = frames.schema.features[name]
        for columns in quaternions(feature):
            squares = _squares(values, columns)
            wrong = np.abs(squares - 1) > UNIT_TOLERANCE
            if wrong.any():
                what = f"{name}: the squares of {', '.join(feature.dim_names[each] for each in columns)}"
                found = f"{squares[int(wrong.argmax())]:.3f}"
                yield frames.fault(what, wrong, found, "1: a quaternion", "Divide each by its length", framed=True)


@Check(
    "quaternion-sign", "a quaternion goes on smoothly: q and -q are one turn, and far apart to a policy", "warning"
).of(FileFrames)
def quaternions_keep_their_sign(frames: FileFrames) -> Iterator[Answer]:
    """Does a quaternion turn into its negative from one frame to the next?"""
    for name, values in frames.read.frames.items():
        feature = frames.schema.features[name]
        for columns in quaternions(feature):
            turns = values[:, columns].astype(np.float64)  # (n_rows, 4)
            wrong = np.zeros(len(turns), dtype=bool)
            wrong[1:] = (turns[1:] * turns[:-1]).sum(axis=1) < -_SAME_TURN * np.square(turns[1:]).sum(axis=1)
            wrong[frames.run_starts] = False
            if wrong.any():
                what = f"{name}: {', '.join(feature.dim_names[each] for each in columns)}"
                mend = "Both are one turn, but a policy that learns it sees a leap: turn the sign of those rows round"
                yield frames.fault(what, wrong, "the negative of the row before", "the same sign", mend, framed=True)


@JUMP.of(Runs)
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
        place = f"{STATE}{feature.at(column)} in episode {runs.number[run]}"
        named = episodes_of(runs.number, wrong[:, column])
        yield Fault(DATA_DIR, place, found, "a value that moves, as in the other episodes", episodes=named)


@FROZEN.of(Runs)
def no_other_sensor_stands(runs: Runs) -> Iterator[Answer]:
    """Does a column beside the state stand in an episode for far more frames than in nearly all others?

    What it measures may have rested: a note.
    """
    long = runs.n_frames >= _LONG
    for name in (each for each in runs.steps if each not in (STATE, ACTION) and long.sum() >= _MIN_EPISODES):
        share = runs.steps[name].moves / runs.n_frames[:, None]  # (n_runs, size)
        usual, low = (np.quantile(share[long], each, axis=0) for each in (0.5, 0.25))
        limit = np.where(usual >= _ALWAYS, _SOMETIMES * low, _SELDOM * low) * (usual > _OFTEN)
        wrong = (share < limit) & long[:, None]
        for column in np.flatnonzero(wrong.any(axis=0) & (wrong.mean(axis=0) <= _FEW)).tolist():
            run = int(np.where(wrong[:, column], share[:, column], np.inf).argmin())
            place = f"{name}{runs.claims.schema.features[name].at(column)} in episode {runs.number[run]}"
            found = f"a value that moves in {share[run, column]:.0%} of the frames{and_more(wrong[:, column])}"
            expected, named = f"in about {usual[column]:.0%}", episodes_of(runs.number, wrong[:, column])
            yield "note", Fault(DATA_DIR, place, found, expected, "Was the sensor lost, or at rest?", named)


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


TWIN = Check("twin", "no demonstration is there twice", "warning")
_COUNTS_TWICE = "It counts twice in training, and may stand on both sides of a split"


@TWIN.of(Runs)
def twin(runs: Runs) -> Iterator[Answer]:
    """Is the same demonstration there twice? Every sum of every feature is the same then, to the last bit."""
    if twins := _again(runs, runs.stats):
        run, same = twins[0]
        found = f"episode {runs.number[same]} again, frame for frame{and_more(len(twins))}"
        yield Fault(
            DATA_DIR,
            f"episode {runs.number[run]}",
            found,
            "every demonstration once",
            _COUNTS_TWICE,
            _numbers(runs, twins),
        )


@TWIN.of(Runs)
def half_a_twin(runs: Runs) -> Iterator[Answer]:
    """Is the state of another episode there again, with other actions? Or these with another state: a replay may be."""
    if not {STATE, ACTION} <= runs.stats.keys():
        return
    whole = {run for run, _ in _again(runs, (STATE, ACTION))}
    for name, other in ((STATE, ACTION), (ACTION, STATE)):
        twins = [each for each in _again(runs, (name,)) if each[0] not in whole]
        if twins:
            run, same = twins[0]
            found = f"{name} of episode {runs.number[same]} again, frame for frame, with another {other}"
            expected = f"{name} and {other} of one recording"
            mend = "Was one of the two taken from elsewhere? Look at both episodes"
            place = f"{name} in episode {runs.number[run]}"
            fault = Fault(DATA_DIR, place, found + and_more(len(twins)), expected, mend, _numbers(runs, twins))
            yield fault if name == STATE else ("note", fault)


def _again(runs: Runs, names: Collection[str]) -> list[tuple[int, int]]:
    """Find the long runs that are an earlier one again in all of these features, which move: both, the later first."""
    if not names:
        return []
    stats = [runs.stats[name] for name in names]
    moves = np.any([(each.high > each.low).any(axis=1) for each in stats], axis=0)
    long = np.flatnonzero(moves & (stats[0].n >= _LONG))
    columns = [column[long] for each in stats for sums in each for column in sums.reshape(len(runs.number), -1).T]
    _, first, where = np.unique(_prints(columns), return_index=True, return_inverse=True)
    same = first[where]  # the first one with the same print
    again = np.flatnonzero(same != np.arange(len(long)))
    again = again[np.all([column[again] == column[same[again]] for column in columns], axis=0)]
    return [*zip(long[again].tolist(), long[same[again]].tolist(), strict=True)]


def _numbers(runs: Runs, twins: Sequence[tuple[int, int]]) -> tuple[int, ...]:
    return tuple(runs.number[[run for run, _ in twins]].tolist())


def _prints(columns: Sequence[Floats]) -> NDArray[np.uint64]:
    """Return a number for each row, the same for the same numbers; of 0 there are two, which differ in a bit."""
    prints = np.zeros(len(columns[0]), dtype=np.uint64)
    for column in columns:
        prints ^= (column + 0.0).view(np.uint64)
        prints *= _MIXER
        prints ^= prints >> np.uint64(32)
    return prints


def unit_pairs(feature: Feature) -> list[tuple[int, int]]:
    """Find the dimensions that hold a sine and a cosine of one angle, by their names.

    >>> unit_pairs(Feature("float32", (3,), ["sin_yaw", "x", "cos_yaw"]))
    [(0, 2)]
    """
    names = feature.dim_names
    partners = [re.sub(r"(?<![^\W_])sin(?![^\W_])", "cos", name) for name in names]
    return [(i, names.index(other)) for i, other in enumerate(partners) if other != names[i] and other in names]


def quaternions(feature: Feature) -> list[list[int]]:
    """Find the dimensions that hold a quaternion, by their names.

    >>> quaternions(Feature("float32", (5,), ["x", "ee.qx", "ee.qy", "ee.qz", "ee.qw"]))
    [[1, 2, 3, 4]]
    """
    found: dict[str, dict[str, int]] = {}
    for place, name in enumerate(feature.dim_names):
        if match := re.fullmatch(r"(.*?)(?:q|quat|quaternion)[._]?([xyzw])", name, re.IGNORECASE):
            found.setdefault(match[1], {})[match[2].lower()] = place
    return [[places[axis] for axis in "xyzw"] for places in found.values() if len(places) == 4]


def jumps(name: str, feature: Feature, stats: RunStats, numbers: Ints) -> Iterator[Fault]:
    """Find where a value of one feature leaps away and back, many times further than it moves elsewhere.

    A leap that stays may be a switch; one by a whole turn, there and back, is an angle at the end of its range.
    """
    moving = stats.n >= _MIN_EPISODES
    if moving.sum() < _MIN_EPISODES:
        return
    usual = np.median(stats.step[moving], axis=0)
    a_turn = np.isclose(stats.spike, 2 * np.pi, rtol=0.01) | np.isclose(stats.spike, 360, rtol=0.01)
    wrong = (stats.spike > _FURTHER * usual) & (usual > 0) & ~a_turn
    for column in np.flatnonzero(wrong.any(axis=0)).tolist():
        run = int(np.where(wrong, stats.spike, 0)[:, column].argmax())
        found = f"a leap of {stats.spike[run, column]:.3g} away and back{and_more(wrong[:, column])}"
        expected = f"steps of about {usual[column]:.3g} at most, as in the other episodes"
        place, named = (
            f"{name}{feature.at(column)} in episode {numbers[run]}",
            episodes_of(numbers, wrong[:, column]),
        )
        yield Fault(DATA_DIR, place, found, expected, episodes=named)


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
