"""Does every column move as it does in the other episodes? No command is needed, and nothing is declared."""

import warnings
from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from z2r.arrays import Array, Bools, Floats, Ints
from z2r.audits.following import MIN_FRAMES
from z2r.audits.runs import Runs
from z2r.audits.steps import NO_SKETCH, is_a_turn
from z2r.audits.values import JUMP, quaternions
from z2r.check import Answer, Check
from z2r.errors import Fault, count
from z2r.format.episodes import DATA_DIR
from z2r.format.rules import and_more, episodes_of
from z2r.format.schema import ACTION, STATE, column_label
from z2r.reading.joints import is_gripper
from z2r.reading.stored import episodes_named

_LEAP = 20  # times the mean step of its own episode: a joint that starts or stops suddenly comes to half of it
_ALONE = 3  # times the steps before and after it
_SMOOTH = 12  # times the mean step: a command that goes from setpoint to setpoint leaps further
_USUAL = 5  # times what is usual in the calmer quarter of the episodes
_SHARE = 0.05  # of a column's range
_SELDOM = 0.1  # of the frames
_MOST = 0.8  # of the episodes
_END = 3  # frames
_LETS_GO = 1.5  # times the step in which a gripper opens or closes: as far it springs back from what it lets go
_STALL = 6  # times the steps thereafter
_NOISE = 3  # times the usual standard deviation
NOISE_A_FRAME = 3.57  # what third differences of white noise come to, on average: sqrt(20 * 2 / pi)
_MOVES = 0.3  # of the usual way
_ROUGH = 3  # times as rough as usual for its speed
_REPEATED = 0.25  # of the frames: half of them, where a sensor is read at half the rate
_SOME_REPEATED, _FEW_REPEATED = 0.04, 0.01  # of the frames, where the other episodes have few
_SELDOMER, _A_STEP = 0.4, (0.1, 0.45)  # times as often; of its range: less is a tick, and more a switch or keys
_ALIKE_REPEATED = 0.08  # of the frames, of the state and of the action
_STEPS, _TICKS = 3, 1000  # through which a column goes
_LEVELS = 8, 100  # in which a column stands
_SAME_LEVEL, _OFF_LEVEL = 1e-5, 0.01  # of its range, and of a step
_IDLE = 0.05  # of the usual motion
_HOMES = 8  # episodes, from which one can be told to begin elsewhere
_HOMES_APART = 6  # times as far as the episodes of one place are from each other
_ONE_APART = 1.2  # times as far, of one episode: of twelve that begin anywhere, one does so once in some hundred times
_SHIFTED = 0.5  # of how far the episodes of one place are from each other
_FAR_HOME = 0.08  # of a column's range
_ALIKE_BY = 0.7  # of the one, by which two values are shifted
_AWAY = 4  # steps: what gets there in fewer is a velocity, and may begin anywhere
_FEW = 0.2  # of the episodes
_TICK = 0.0005  # of a column's range: less is the tick of an encoder
_NEAR = 0.1  # of the distance that is usual between two demonstrations
_COMMON = 6  # marks that two demonstrations must have to be compared
_MOVED, _TELLING = 0.05, 10  # of its spread, a column; so often, or two copies are by chance
_NEIGHBOURS = 32  # demonstrations, with which each is compared
_COUNTS_TWICE = "It counts twice in training, and may stand on both sides of a split"
_SHARED = 0.5  # of the frames of two demonstrations
MAX_COMPARED = 20_000  # demonstrations


LEAP = Check("discontinuity", "no robot leaps inside an episode, as where two are joined or it is put back", "warning")


@LEAP.of(Runs)
def nothing_leaps(runs: Runs) -> Iterator[Answer]:
    """Does a column leap, and stay there, while it goes smoothly elsewhere?"""
    for name, steps in runs.steps.items():
        ratio, continuous, largest = _leap_ratio(runs, name), often_moves(runs, name), runs.stats[name].step
        calm = _quarter(largest)
        wrong: Bools = (ratio > _LEAP) & (largest > _USUAL * calm) & continuous & (calm > 0)
        wrong &= (_quarter(ratio) < _SMOOTH) & (largest > _ALONE * steps.around)
        wrong &= steps.repeated < _SOME_REPEATED * runs.n_frames[:, None]
        wrong &= ~is_a_turn(largest, runs.spans(name))
        if wrong.any():
            run, column = _worst(wrong, ratio)
            together = wrong[run] & (steps.at[run] == steps.at[run, column])
            where = _where(runs, wrong, run, steps.at[run, column])
            place = f"{_dim(runs, name, column)} in {where}"
            found = f"a leap of {largest[run, column]:.3g}{_so_in(together)}"
            expected = f"steps of about {calm[column]:.3g} at most, as in the other episodes"
            mend = "Are these two episodes, or were frames dropped? Cut it there, or leave it out"
            frame = int(runs.start[run] + steps.at[run, column])
            yield _fault(runs, place, wrong, found, expected, mend, frame)


@LEAP.of(Runs)
def no_angle_goes_on_at_the_other_end(runs: Runs) -> Iterator[Answer]:
    """Does an angle leap by a whole turn? To a robot that is no motion, and to a policy the farthest that there is."""
    for name in runs.steps:
        wrong = is_a_turn(runs.stats[name].step, runs.spans(name)) & often_moves(runs, name)
        if wrong.any():
            run, column = _worst(wrong, runs.stats[name].step)
            place = f"{_dim(runs, name, column)} in {_named(runs, wrong.any(axis=1))}"
            found = f"a leap of {runs.stats[name].step[run, column]:.3g}, a whole turn{_so_in(wrong[run])}"
            mend = "It is no motion, but a policy learns it as one: unwind the angle, or store its sine and cosine"
            yield "note", _fault(runs, place, wrong, found, "an angle that goes on smoothly", mend)


@JUMP.of(Runs)
def nothing_leaps_and_comes_back(runs: Runs) -> Iterator[Answer]:
    """Does a value leap away and back in one frame, much further than it moves in its own episode?"""
    for name, steps in runs.steps.items():
        spike, largest, continuous = runs.stats[name].spike, runs.stats[name].step, often_moves(runs, name)
        ratio = _leap_ratio(runs, name) * np.divide(spike, largest, out=np.zeros_like(spike), where=spike > 0)
        wrong = (ratio > _LEAP) & (spike > _SHARE * runs.spans(name)) & continuous & ~is_a_turn(spike, runs.spans(name))
        wrong &= ~_is_grip(runs, name) | (spike > _LETS_GO * _quarter(largest))
        if name == ACTION:  # a policy may well say what no robot can do
            wrong &= (_quarter(ratio) < _SMOOTH) & (ratio > 1.5 * _LEAP)
        if wrong.any():
            run, column = _worst(wrong, ratio)
            where = _where(runs, wrong, run, steps.at[run, column])
            found = f"a leap of {spike[run, column]:.3g} away and back, {ratio[run, column]:.0f} times its usual step"
            mend = "Was a sample lost or read wrong? Smooth it, or leave the episode out"
            expected = "motion that a robot can do"
            place, frame = f"{_dim(runs, name, column)} in {where}", int(runs.start[run] + steps.at[run, column])
            yield _fault(runs, place, wrong, found + _so_in(wrong[run]), expected, mend, frame)


@LEAP.of(Runs)
def no_robot_is_put_back(runs: Runs) -> Iterator[Answer]:
    """Do nearly all episodes begin or end with a leap? Then the robot was put back while it was recorded."""
    for name, steps in runs.steps.items():
        largest = runs.stats[name].step
        leaps = (_leap_ratio(runs, name) > _LEAP) & often_moves(runs, name) & ~is_a_turn(largest, runs.spans(name))
        for where, is_there in (("first", steps.at <= 1), ("last", steps.at >= runs.n_frames[:, None] - _END)):
            wrong = (leaps & is_there).mean(axis=0) > _MOST
            if wrong.any() and len(runs.number) > 2:
                column = int(wrong.argmax())
                size = np.median(largest[(leaps & is_there)[:, column], column])
                found = f"a leap of {size:.3g} in the {where} frames of nearly all episodes"
                mend = "Was the robot put back, or a number not yet there? A policy learns to leap: cut these frames"
                place = _dim(runs, name, column) + (f" and {int(wrong.sum()) - 1} more" if wrong.sum() > 1 else "")
                yield Fault(DATA_DIR, place, found, "episodes that begin and end with the motion", mend)


@Check("stall", "no sensor rests and then leaps to where it should have been", "warning").of(Runs)
def nothing_stalls(runs: Runs) -> Iterator[Answer]:
    """Does a joint rest, bit for bit, and then leap to where motion would have brought it?

    What is pushed may do so. A joint that has a command may not, nor may all columns together.
    """
    commanded = runs.claims.schema.features[ACTION].dim_names if ACTION in runs.steps else ()
    for name, steps in runs.steps.items():
        moves = often_moves(runs, name)
        leaps = (steps.stall > _STALL) & (steps.stall_leap > _SHARE * runs.spans(name)) & moves
        leaps &= _quarter(steps.stall) < _STALL / 2
        together = (leaps | ~moves).all(axis=1, keepdims=True)
        wrong: Bools = leaps & together
        if name == STATE:
            wrong |= leaps & np.isin(runs.claims.schema.features[name].labels, commanded)
        if wrong.any():
            run, column = _worst(wrong, steps.stall)
            length, times = steps.stall_length[run, column], steps.stall[run, column]
            found = f"a rest of {length:.0f} frames, and a leap {times:.0f} times as large as the steps thereafter"
            where = _where(runs, wrong, run, steps.stall_at[run, column])
            mend = "Did the sensor or the recording hang there? Leave the episode out, or record it again"
            expected = "motion that goes on, as in the other episodes"
            place, frame = f"{_dim(runs, name, column)} in {where}", int(runs.start[run] + steps.stall_at[run, column])
            yield _fault(runs, place, wrong, found + _so_in(wrong[run]), expected, mend, frame)


@Check("noise", "no sensor is many times noisier in one episode than in the others", "warning").of(Runs)
def no_episode_is_noisier(runs: Runs) -> Iterator[Answer]:
    """Is a column much noisier in some episodes?"""
    long = (runs.n_frames >= MIN_FRAMES)[:, None]
    for name, steps in runs.steps.items() if long.any() else ():
        size = steps.noise / (NOISE_A_FRAME * runs.n_frames[:, None])
        for turn in quaternions(runs.claims.schema.features[name]):  # how it lies says which of the four shakes
            size[:, turn] = np.sqrt(np.square(size[:, turn]).sum(axis=1, keepdims=True))
        moves = long & (steps.path > _MOVES * _median(steps.path))  # at rest, a sensor is quieter than in motion
        usual = _quarter_of(size, moves)
        with np.errstate(divide="ignore", invalid="ignore"):
            rough = np.nan_to_num(size * runs.n_frames[:, None] / steps.path, posinf=0)
        wrong = long & (size > _NOISE * usual) & (usual > 0) & (size > _TICK * runs.spans(name))
        wrong &= _quarter(_leap_ratio(runs, name)) < _SMOOTH
        wrong &= steps.repeated < _SOME_REPEATED * runs.n_frames[:, None]
        trembles = (rough > _ROUGH * _median(rough)) & (name in (STATE, ACTION))  # what is pushed or dropped may do so
        wrong &= often_moves(runs, name) & (steps.alternates | trembles)
        if wrong.any():
            run, column = _worst(wrong, size / np.maximum(usual, 1e-300))
            found = f"noise of about {size[run, column]:.3g}{_so_in(wrong[run])}"
            expected = f"about {usual[column]:.3g}, as in the other episodes"
            mend = "Is a cable loose, or was something touched? Look at it before you train on it"
            place = f"{_dim(runs, name, column)} in {_named(runs, wrong.any(axis=1))}"
            fault = _fault(runs, place, wrong, found, expected, mend)
            yield ("note", fault) if name == ACTION else fault  # another hand may well tremble more


REPEAT = Check("repeat", "every frame is a new measurement", "warning")


@REPEAT.of(Runs)
def frames_are_no_repeats(runs: Runs) -> Iterator[Answer]:
    """Does every other frame repeat the one before, although the robot moves?"""
    for name, steps in runs.steps.items():
        share = steps.repeated[:, 0] / runs.n_frames
        many = share > (_SOME_REPEATED if _median(share) < _FEW_REPEATED else _REPEATED)
        wrong = many & (runs.n_frames >= MIN_FRAMES)
        if wrong.any() and runs.claims.schema.features[name].size > 1:
            run = int(np.where(wrong, share, 0).argmax())
            everywhere = bool(wrong.mean() > _MOST)
            if everywhere and name == ACTION:
                continue  # a policy may well give its commands more seldom
            where = "" if everywhere else f" in {_named(runs, wrong)}"
            found = f"{share[run]:.0%} of all frames the same as the one before, between others that move"
            mend = "Was it read more seldom than it was recorded? Then changes from frame to frame mean nothing"
            fault = _fault(runs, f"{name}{where}", wrong, found, "a new value in every frame while it moves", mend)
            yield ("note", fault) if everywhere else fault


@REPEAT.of(Runs)
def frames_come_evenly(runs: Runs) -> Iterator[Answer]:
    """Are many frames of state and action alike the same as the one before, in nearly all episodes?"""
    if STATE not in runs.steps or ACTION not in runs.steps:
        return
    both = np.minimum(runs.steps[STATE].repeated[:, 0], runs.steps[ACTION].repeated[:, 0]) / runs.n_frames
    wrong = (both > _ALIKE_REPEATED) & (runs.n_frames >= MIN_FRAMES)
    if wrong.mean() > _MOST and _median(both) <= _REPEATED:
        found = (
            f"both the same as in the frame before in about {_median(both):.0%} of the frames, between others that move"
        )
        mend = "Did frames come in bursts, and were they stored as if evenly spaced? Then the time of each is wrong"
        yield "note", _fault(runs, f"{STATE} and {ACTION}", wrong, found, "new values in every frame", mend)


@REPEAT.of(Runs)
def state_and_action_come_as_often(runs: Runs) -> Iterator[Answer]:
    """Does one of the two go by steps, each of some frames, while the other moves from frame to frame?"""
    if STATE not in runs.steps or ACTION not in runs.steps:
        return
    moves = {name: (runs.steps[name].moves / runs.n_frames[:, None]).max(axis=1) for name in (STATE, ACTION)}
    for name, other in ((STATE, ACTION), (ACTION, STATE)):
        span = runs.spans(name)
        steps = np.median(runs.stats[name].step[:, span > 0] / span[span > 0], axis=1) if span.any() else np.zeros(1)
        wrong = (moves[name] < _SELDOMER * moves[other]) & (runs.n_frames >= MIN_FRAMES)
        wrong &= (steps > _A_STEP[0]) & (steps < _A_STEP[1])
        if wrong.any():
            run = int(np.where(wrong, moves[other] / np.maximum(moves[name], _SELDOM), 0).argmax())
            where = "" if wrong.mean() > _MOST else f" in {_named(runs, wrong)}"
            found = (
                f"a new value in {moves[name][run]:.0%} of the frames, while {other} moves in {moves[other][run]:.0%}"
            )
            mend = "Was it read more seldom than it was recorded? A policy learns to hold still, and then to leap"
            yield "note", _fault(runs, f"{name}{where}", wrong, found, f"one about as often as {other} has", mend)


@Check("resolution", "what moves is stored more finely than in whole numbers, or in steps as coarse", "note").of(Runs)
def nothing_is_rounded(runs: Runs) -> Iterator[Answer]:
    """Is all of a state or an action whole numbers, or multiples of a coarse step? In some episodes, or in all."""
    for name in (each for each in (STATE, ACTION) if each in runs.steps):
        span, feature = runs.spans(name), runs.claims.schema.features[name]
        moments = runs.moments_of(name)[:, :, 0]
        if not moments.size or not feature.dtype.startswith("float"):
            continue
        moves = (span > _STEPS) & (span < _TICKS)  # fewer are switches, and more are what an encoder counts
        whole, steps = np.full(len(moments), moves.sum() > 1), np.zeros((len(moments), len(span)))
        for column in np.flatnonzero(span).tolist():
            values = moments[:, :, column].astype(np.float64)
            steps[:, column] = _coarse_steps(values, span[column])
            if moves[column]:
                whole &= (values == np.round(values)).all(axis=1)
        coarse: Bools = (steps > 0).sum(axis=1) > 1
        if whole.any() and not (whole.all() and name == ACTION):  # keys, or a policy, may well give such commands
            found = f"whole numbers only in {count(int(moves.sum()), 'column')}, at all moments that were looked at"
            mend = "Was it cast to integers on the way? Small motion is lost"
            yield _rounded(runs, name, whole, found, mend)
        elif coarse.any() and not whole.any():
            run, column = _worst(steps > 0, steps / np.where(span > 0, span, 1))
            found = (
                f"nothing but multiples of {steps[run, column]:.3g} in {feature.labels[column]}, which goes through "
            )
            found += f"{span[column]:.3g}, and so in {count(int((steps[run] > 0).sum()) - 1, 'more column')}"
            mend = "Was it rounded or truncated, perhaps in another unit? Small motion is lost"
            yield _rounded(runs, name, coarse, found, mend)


def _rounded(runs: Runs, name: str, wrong: Bools, found: str, mend: str) -> Fault:
    where = "" if wrong.all() else f" in {_named(runs, wrong)}"
    expected = "numbers as fine as the sensors are" if wrong.all() else "finer ones, as in the other episodes"
    return _fault(runs, f"{name}{where}", wrong, found, expected, mend)


def _coarse_steps(values: Floats, span: float) -> Floats:
    """Find the step of which all values of a run are multiples, (n_runs, n_moments): (n_runs,); 0 where none is.

    Values of fewer than eight levels are a switch or keys; more than a hundred are fine enough.

    Examples
    --------
    >>> values = np.arange(0, 40, 2.0)[None]
    >>> _coarse_steps(values, 40.0).tolist(), _coarse_steps(values**1.1, 40.0).tolist()
    ([2.0], [0.0])
    """
    found = np.zeros(len(values))
    # Two values nearer than a step, and not at one level, rule a step out: in most runs, neighbours do.
    between = np.abs(values[:, 1:] - values[:, :-1])
    fine = (between > values.shape[1] * _SAME_LEVEL * span) & (between * _LEVELS[1] < span)
    run = np.flatnonzero(~fine.any(axis=1))
    gaps = np.diff(np.sort(np.ascontiguousarray(values[run])))  # (n, n_moments - 1)
    apart = gaps > _SAME_LEVEL * span
    steps = gaps.min(axis=1, initial=np.inf, where=apart)
    perhaps = (apart.sum(axis=1) >= _LEVELS[0] - 1) & (steps * _LEVELS[1] >= span)
    run, steps = run[perhaps], steps[perhaps]
    times = values[run] / steps[:, None]
    found[run] = np.where(np.abs(times - np.round(times)).max(axis=1) > _OFF_LEVEL, 0, steps)
    return found


@Check("idle-episode", "something happens in every episode", "warning").of(Runs)
def something_happens(runs: Runs) -> Iterator[Answer]:
    """Does a robot hardly move in an episode, while it moves in the others?"""
    if STATE not in runs.steps or len(runs.number) < 3:
        return
    spans = runs.stats[STATE].high - runs.stats[STATE].low  # (n_runs, size)
    usual = np.median(spans, axis=0)
    long = runs.n_frames >= MIN_FRAMES
    wrong = long & (spans[:, usual > 0] < _IDLE * usual[usual > 0]).all(axis=1) & bool((usual > 0).any())
    if wrong.any() and wrong.mean() < 0.6:
        mend = "Nothing is shown there: leave it out"
        found = f"motion of less than {_IDLE:.0%} of what is usual, in every column"
        yield _fault(runs, f"{STATE} in {_named(runs, wrong)}", wrong, found, "motion, as in the other episodes", mend)


ELSEWHERE = Check("elsewhere", "every episode begins where the others do, if they all begin at one place", "warning")


@ELSEWHERE.of(Runs)
def episodes_begin_at_one_place(runs: Runs) -> Iterator[Answer]:
    """Do some episodes begin far from where all the others begin? Then a calibration, a sign or an order may differ."""
    if STATE not in runs.steps or len(runs.number) < _HOMES:
        return
    size = runs.claims.schema.features[STATE].size
    first = _marks(runs, size)[:, 0].astype(np.float64)  # (n_runs, size)
    turns = [column for turn in quaternions(runs.claims.schema.features[STATE]) for column in turn]
    first[:, turns] = np.abs(first[:, turns])  # q and -q are one turn
    moments = runs.moments_of(STATE)
    last = moments[:, -1, 0].astype(np.float64) if moments.size else np.full_like(first, np.nan)
    ranges, step = runs.spans(STATE), np.quantile(runs.stats[STATE].step, 0.9, axis=0)
    for column in np.flatnonzero(often_moves(runs, STATE)).tolist():
        few, gap, spread = parted(first[:, column])
        least = max(_FAR_HOME * ranges[column], _AWAY * step[column])
        surely = gap >= max(_HOMES_APART * spread, least)
        settled = _ends_there_too(first[:, column], last[:, column], ranges[column])
        if not (surely or settled) and (len(few) > 1 or gap < max(_ONE_APART * spread, least)):
            continue
        wrong = np.zeros(len(runs.number), dtype=bool)
        wrong[few] = True
        if not share_a_task(runs, wrong):
            continue  # one task may begin where another does not
        here, there = float(np.median(first[wrong, column])), float(np.median(first[~wrong, column]))
        mend = "Was it calibrated anew, is a sign, a unit or an order another one, or does an episode begin too late?"
        place = f"{_dim(runs, STATE, column)} in {_named(runs, wrong)}"
        fault = _fault(
            runs, place, wrong, f"a first frame at {here:.3g}", f"one at about {there:.3g}, as in the others", mend
        )
        yield fault if surely and len(few) <= _FEW * len(runs.number) else ("note", fault)


def _ends_there_too(first: Floats, last: Floats, span: float) -> bool:
    """Tell whether the same episodes begin and end apart from all others, (n,), on the same side: as a zero that moved.

    That is rarer than to begin elsewhere, so that less of it says something.
    """
    (few, gap, spread), (others, its_gap, its_spread) = parted(first), parted(last)
    apart = gap >= max(_ONE_APART * spread, _FAR_HOME * span) and its_gap >= max(its_spread, _FAR_HOME / 2 * span)
    if not apart or not np.array_equal(np.sort(few), np.sort(others)):
        return False
    rest = np.setdiff1d(np.arange(len(first)), few)
    by, its = (float(np.median(values[few]) - np.median(values[rest])) for values in (first, last))
    return _ALIKE_BY < its / by < 1 / _ALIKE_BY


@ELSEWHERE.of(Runs)
def episodes_are_not_shifted(runs: Runs) -> Iterator[Answer]:
    """Do a column's first, lowest and highest value all lie beyond those of the other episodes, on the same side?"""
    if STATE not in runs.steps or len(runs.number) < _HOMES:
        return
    stats, size = runs.stats[STATE], runs.claims.schema.features[STATE].size
    ranges, first = runs.spans(STATE), _marks(runs, size)[:, 0].astype(np.float64)
    for column in np.flatnonzero(often_moves(runs, STATE)).tolist():
        seen = np.stack([first[:, column], stats.low[:, column], stats.high[:, column]])  # (3, n_runs)
        wrong = np.isin(np.arange(len(runs.number)), parted(seen[1])[0])
        by = float(np.median(seen[1, wrong]) - np.median(seen[1, ~wrong]))
        below, above = (seen[:, wrong], seen[:, ~wrong]) if by < 0 else (seen[:, ~wrong], seen[:, wrong])
        gap, spread = above.min(axis=1) - below.max(axis=1), np.maximum(np.ptp(below, axis=1), np.ptp(above, axis=1))
        goes = np.median(stats.high[:, column] - stats.low[:, column])  # where it hardly does, each rests at its own
        apart = (gap >= np.maximum(_SHIFTED * spread, _SHARE * ranges[column])).all()
        if apart and goes >= abs(by) and share_a_task(runs, wrong):
            found = f"a first, a lowest and a highest value that are all {'higher' if by > 0 else 'lower'}, by {by:.3g}"
            mend = "Was it calibrated anew, or is another tool or another zero set there?"
            place = f"{_dim(runs, STATE, column)} in {_named(runs, wrong)}"
            yield "note", _fault(runs, place, wrong, found, "some among those of the others", mend)


NEAR_TWIN = Check("near-twin", "no demonstration is nearly that of another episode", "warning")


@NEAR_TWIN.of(Runs)
def no_near_twins(runs: Runs) -> Iterator[Answer]:
    """Is a demonstration a copy of another one: cut, wherever it begins and ends, or with noise added?"""
    shared, first, copied = _shared(runs)
    if copied.any():
        run = int(copied.argmax())
        found = f"about {shared[run]:.0%} of the frames of episode {runs.number[first[run]]} as well{and_more(copied)}"
        named = episodes_of(runs.number, copied)
        yield Fault(DATA_DIR, f"episode {runs.number[run]}", found, "frames of its own", _COUNTS_TWICE, named)
    if STATE in runs.steps and 3 <= len(runs.number) <= MAX_COMPARED:
        marks = _marks(runs, runs.claims.schema.features[STATE].size)
        for at_their_own_speed, each in ((False, marks), (True, runs.moments_of(STATE)[:, ::3, 0])):
            for fault in _nearly_again(runs, each, copied, at_their_own_speed):
                copied = copied | np.isin(runs.number, fault.episodes)
                yield fault


def _nearly_again(runs: Runs, marks: Array, said: Bools, at_their_own_speed: bool) -> Iterator[Fault]:
    """Find runs that go nearly as an earlier one does: frame for frame, or however long each is; some were said."""
    distance, neighbour = _nearest(marks)
    known = np.isfinite(distance)
    if known.sum() < 3:
        return
    usual, n = float(np.quantile(distance[known], 0.75)), runs.n_frames
    near = np.flatnonzero(
        known & (n >= MIN_FRAMES) & (distance < _NEAR * usual) & ((distance > 0) | (n != n[neighbour]))
    )
    near = near[distance[near] < _NEAR * _motion(marks, near)] if len(near) else near
    both = {tuple(sorted((run, int(neighbour[run])))) for run in near.tolist()}
    if pairs := sorted(pair for pair in both if not said[pair[1]]):
        one, other = pairs[0]
        speed = f" {n[other] / n[one]:.2f} times as long," if at_their_own_speed else ""
        found = f"nearly episode {runs.number[one]} again:{speed} {distance[other]:.2g} apart{and_more(len(pairs))}"
        expected = f"demonstrations that differ by about {usual:.2g} of their spread"
        again = tuple(sorted({int(runs.number[each]) for _, each in pairs}))
        yield Fault(DATA_DIR, f"episode {runs.number[other]}", found, expected, _COUNTS_TWICE, again)


def _shared(runs: Runs) -> tuple[Floats, Ints, Bools]:
    """Return of each run which share of its frames an earlier one has too, which one, and whether that is a copy."""
    each = np.arange(len(runs.number))
    sketch = runs.steps[STATE].sketch if STATE in runs.steps else None
    if sketch is None:
        return np.zeros(len(each)), each, np.zeros(len(each), dtype=bool)
    firsts = np.empty(sketch.shape, dtype=np.int64)  # (n_runs, 8): the first run with the same hash
    for column, hashes in enumerate(sketch.T):
        _, first, where = np.unique(hashes, return_index=True, return_inverse=True)
        firsts[:, column] = np.where(hashes == NO_SKETCH, each, first[where])
    alike = ((firsts[:, :, None] == firsts[:, None]) & (firsts < each[:, None])[:, None]).mean(axis=2)  # (n_runs, 8)
    best = alike.argmax(axis=1)
    shared, first, n = alike[each, best], firsts[each, best], runs.n_frames
    return shared, first, (n >= MIN_FRAMES) & (shared >= _SHARED) & ((shared < 1) | (n != n[first]))


def _marks(runs: Runs, size: int) -> Array:
    """Return some frames of the state of each run, (n_runs, n_marks, size); the first of them is its first."""
    marks = runs.steps[STATE].marks
    return np.empty((0, 0, size)) if marks is None else marks.reshape(len(marks), -1, size)


def _nearest(marks: Array) -> tuple[Floats, Ints]:
    """Return how far each demonstration is from the nearest other one, in spreads of its columns, and which that is.

    `marks` are some frames of each, (n_runs, n_marks, size).
    """
    n, columns = len(marks), [*_in_spreads(marks)]
    if not columns:
        return np.full(n, np.nan), np.zeros(n, dtype=np.int64)
    order = np.argsort(sum(np.nansum(column[: len(column) // 2], axis=0) for column in columns), kind="stable")
    scaled = np.empty((marks.shape[1], len(columns), n), np.float32)  # numpy adds long rows up faster
    moves, room = np.zeros(n, dtype=np.int64), np.empty_like(scaled)
    for place, column in enumerate(columns):
        scaled[:, place] = column[:, order]
        moves += np.count_nonzero(np.abs(np.diff(scaled[:, place], axis=0)) > _MOVED, axis=0)
    known: Bools = np.all(np.isfinite(scaled), axis=1)  # (n_marks, n)
    scaled[~np.isfinite(scaled)] = 0
    distance, neighbour = np.full(n, np.inf), np.zeros(n, dtype=np.int64)
    for ahead in range(1, min(_NEIGHBOURS, n - 1) + 1):
        one, other = slice(-ahead), slice(ahead, None)
        between = np.subtract(scaled[..., one], scaled[..., other], out=room[..., one])
        apart, both = np.einsum("mcn,mcn->mn", between, between), known[:, one] & known[:, other]  # (n_marks, n)
        common = np.count_nonzero(both, axis=0)
        far = np.sqrt((apart * both).sum(axis=0) / (len(columns) * np.maximum(common, 1)))
        far[(common < _COMMON) | (moves[one] < _TELLING)] = np.inf
        for mine, its in ((one, other), (other, one)):
            np.copyto(neighbour[mine], order[its], where=far < distance[mine])
            np.minimum(far, distance[mine], out=distance[mine])
    back = np.argsort(order)
    return np.where(np.isfinite(distance), distance, np.nan)[back], neighbour[back]


def _in_spreads(marks: Array) -> Iterator[NDArray[np.float32]]:
    """Count each column that moves from its mean, in spreads: float32[n_marks, n_runs]."""
    for column in marks.T:
        values = column.astype(np.float64)
        n = max(int(np.isfinite(values).sum()), 1)
        values -= np.nansum(values) / n
        spread = np.sqrt(np.nansum(np.square(values)) / n)
        if spread > 0:
            yield (values / spread).astype(np.float32)


def _motion(marks: Array, rows: Ints) -> Floats:
    """Return how far some demonstrations go, in spreads of their columns, as a root mean square."""
    values = marks.astype(np.float64)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # a mark beyond the end of all of them
        spread, own = np.nanstd(values, axis=(0, 1)), np.nanstd(values[rows], axis=1)
    motion: Floats = np.sqrt(np.square(own[:, spread > 0] / spread[spread > 0]).mean(axis=1))
    return motion


def _leap_ratio(runs: Runs, name: str) -> Floats:
    """Say how many times larger than the others of its run, on average, the largest step is, (n_runs, size)."""
    largest = runs.stats[name].step
    rest = (runs.steps[name].path - largest) / np.maximum(runs.n_frames[:, None] - 2, 1)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = largest / np.maximum(rest, 1e-300)
    return np.where((rest > 0) & (runs.n_frames[:, None] >= MIN_FRAMES), ratio, 0.0)


def often_moves(runs: Runs, name: str) -> Bools:
    """Say of each column whether it moves in many frames: what seldom changes is a switch, and may leap."""
    continuous: Bools = (runs.spans(name) > 0) & (_median(runs.steps[name].moves / runs.n_frames[:, None]) > _SELDOM)
    return continuous


def _is_grip(runs: Runs, name: str) -> Bools:
    """Say of each column whether it is called a gripper, bool[size]."""
    return np.array([is_gripper(label) for label in runs.claims.schema.features[name].labels], dtype=bool)


def _quarter(values: Floats) -> Floats:
    """Return what a quarter of the episodes stay below, for each column: a fault in half of them does not shift it."""
    quarter: Floats = np.quantile(values, 0.25, axis=0, method="lower")
    return quarter


def _quarter_of(values: Floats, where: Bools) -> Floats:
    """Return the same of those episodes that count; 0 where none does."""
    counting = np.where(where, values, np.inf)
    quarter: Floats = np.sort(counting, axis=0)[(where.sum(axis=0) - 1).clip(0) // 4, np.arange(values.shape[1])]
    return np.where(np.isfinite(quarter), quarter, 0.0)


def _median(values: Floats) -> Floats:
    middle: Floats = np.quantile(values, 0.5, axis=0, method="lower")
    return middle


def parted(values: Floats) -> tuple[Ints, float, float]:
    """Part values at the largest gap: which are the fewer, how wide it is, and how far the wider of the two spreads.

    Of two that are as many, it is those that the first value is not among.

    Examples
    --------
    >>> few, gap, spread = parted(np.array([3.0, 9.0, 2.0, 2.5]))
    >>> few.tolist(), gap, spread
    ([1], 6.0, 1.0)
    >>> parted(np.array([9.0, 3.0, 2.0, 9.0]))[0].tolist()
    [2, 1]
    """
    order = np.argsort(values, kind="stable")
    gaps = np.diff(values[order])
    cut = int(gaps.argmax()) + 1
    groups = (order[:cut], order[cut:])
    few = min(groups, key=lambda group: (len(group), 0 in group))
    return few, float(gaps[cut - 1]), max(float(np.ptp(values[group])) for group in groups)


def share_a_task(runs: Runs, wrong: Bools) -> bool:
    """Tell whether some of these episodes have a task that some of the others have as well."""
    if runs.tasks is None:
        return True
    run, task = runs.tasks.T
    return bool(np.isin(task[wrong[run]], task[~wrong[run]]).any())


def _worst(wrong: Bools, values: Floats) -> tuple[int, int]:
    """Return the run and the column of the largest value that is wrong."""
    run, column = np.unravel_index(int(np.where(wrong, values, -np.inf).argmax()), wrong.shape)
    return int(run), int(column)


def _so_in(wrong: Bools) -> str:
    """Say in how many columns else of the run that is so."""
    n = int(wrong.sum())
    return f", and so in {count(n - 1, 'more column')}" if n > 1 else ""


def _where(runs: Runs, wrong: Bools, run: int, frame: float) -> str:
    return f"episode {runs.number[run]}, frame {frame:.0f}{and_more(np.atleast_1d(wrong.any(axis=1)))}"


def _fault(
    runs: Runs, place: str, wrong: Bools, found: str, expected: str, mend: str, frame: int | None = None
) -> Fault:
    """Return a fault of the runs in which something is wrong, bool[n_runs] or bool[n_runs, size]."""
    episodes = runs.number[wrong.any(axis=1) if wrong.ndim > 1 else wrong].tolist()
    return Fault(DATA_DIR, place, found, expected, mend, tuple(dict.fromkeys(episodes)), frame)


def _named(runs: Runs, wrong: Any) -> str:
    return episodes_named(runs.number[wrong].tolist())


def _dim(runs: Runs, name: str, column: int) -> str:
    return column_label(name, runs.claims.schema.features[name], column)
