"""Does every column move as it does in the other episodes? No command is needed, and nothing is declared."""

from collections.abc import Iterator

import numpy as np

from z2r.arrays import Bools, Floats, Ints
from z2r.audits.following import MIN_FRAMES
from z2r.audits.runs import Runs
from z2r.audits.steps import RunSteps
from z2r.check import Answer, Check
from z2r.errors import Fault, count
from z2r.format.episodes import DATA_DIR
from z2r.format.rules import and_more
from z2r.format.schema import ACTION, STATE
from z2r.reading.stored import episodes_named

_LEAP = 12  # times the usual step of its own episode: a joint that starts or stops suddenly comes to half of it
_USUAL = 5  # times what is usual in the calmer quarter of the episodes
_SHARE = 0.05  # of a column's range
_SWITCH = 0.5  # of a column's range in one step: a switch, and no joint
_MOST = 0.8  # of the episodes
_END = 3  # frames
_STALL = 6  # times the steps thereafter
_NOISE = 4  # times the usual standard deviation
_ALTERNATES = -0.4  # of the squares: white noise comes to -0.75, and motion to more than 0
_REPEATED = 0.25  # of the frames: half of them, where a sensor is read at half the rate
_IDLE = 0.05  # of the usual motion
_TICK = 0.002  # of a column's range: less is the tick of an encoder
_NEAR = 0.12  # of the distance that is usual between two demonstrations
_NEIGHBOURS = 64  # demonstrations, with which each is compared
_MAX_COMPARED = 20_000  # demonstrations


LEAP = Check("leap", "no robot leaps inside an episode, as where two are joined or it is put back", "warning")


@LEAP.of(Runs)
def nothing_leaps(runs: Runs) -> Iterator[Answer]:
    """Does a column leap, and stay there, while it goes smoothly elsewhere?"""
    for name, steps in runs.steps.items():
        ratio, continuous = _leap_ratio(runs, name), _continuous(runs, name)
        calm = _quarter(steps.largest)
        wrong: Bools = (ratio > _LEAP) & (steps.largest > _USUAL * calm) & continuous & (calm > 0)
        wrong &= ~_is_a_turn(steps.largest)
        if wrong.any():
            run, column = _worst(wrong, ratio)
            together = wrong[run] & (steps.at[run] == steps.at[run, column])
            where = _where(runs, wrong, run, steps.at[run, column])
            place = f"{_dim(runs, name, column)} in {where}"
            found = f"a leap of {steps.largest[run, column]:.3g}{_so_in(together)}"
            expected = f"steps of about {calm[column]:.3g} at most, as in the other episodes"
            mend = "Are these two episodes, or were frames dropped? Cut it there, or leave it out"
            yield Fault(DATA_DIR, place, found, expected, mend)


@LEAP.of(Runs)
def no_robot_is_put_back_at_the_end(runs: Runs) -> Iterator[Answer]:
    """Do nearly all episodes end with a leap? Then the robot was put back before the recording stopped."""
    for name, steps in runs.steps.items():
        at_end = steps.at >= runs.n_frames[:, None] - _END
        leaps = (_leap_ratio(runs, name) > _LEAP) & _continuous(runs, name) & ~_is_a_turn(steps.largest)
        wrong = (leaps & at_end).mean(axis=0) > _MOST
        if wrong.any() and len(runs.number) > 2:
            column = int(wrong.argmax())
            found = f"a leap of {steps.largest[0, column]:.3g} in the last {_END} frames of nearly all episodes"
            mend = "Was the robot put back before the recording stopped? A policy learns to leap: cut these frames"
            place = _dim(runs, name, column) + (f" and {int(wrong.sum()) - 1} more" if wrong.sum() > 1 else "")
            yield Fault(DATA_DIR, place, found, "episodes that end with the motion", mend)


@Check("stall", "no sensor rests and then leaps to where it should have been", "warning").of(Runs)
def nothing_stalls(runs: Runs) -> Iterator[Answer]:
    """Does a joint rest, bit for bit, and then leap to where motion would have brought it?

    What is pushed may do so. A joint that has a command may not, nor may all columns together.
    """
    commanded = runs.claims.schema.features[ACTION].labels if ACTION in runs.steps else ()
    for name, steps in runs.steps.items():
        moves = _continuous(runs, name)
        leaps = (steps.stall > _STALL) & (_quarter(steps.stall) < _STALL / 2) & moves
        together = (leaps | ~moves).all(axis=1, keepdims=True)
        wrong: Bools = leaps & (together | np.isin(runs.claims.schema.features[name].labels, commanded))
        if wrong.any():
            run, column = _worst(wrong, steps.stall)
            length, times = steps.stall_length[run, column], steps.stall[run, column]
            found = f"a rest of {length:.0f} frames, and a leap {times:.0f} times as large as the steps thereafter"
            where = _where(runs, wrong, run, steps.stall_at[run, column])
            mend = "Did the sensor or the recording hang there? Leave the episode out, or record it again"
            expected = "motion that goes on, as in the other episodes"
            yield Fault(DATA_DIR, f"{_dim(runs, name, column)} in {where}", found + _so_in(wrong[run]), expected, mend)


@Check("noise", "no sensor is many times noisier in one episode than in the others", "warning").of(Runs)
def no_episode_is_noisier(runs: Runs) -> Iterator[Answer]:
    """Is a column much noisier in some episodes?"""
    long = (runs.n_frames >= MIN_FRAMES)[:, None]
    for name, steps in runs.steps.items() if long.any() else ():
        # One leap adds 6 times its square to the third differences, and is no noise.
        noise = np.maximum(steps.noise - 6 * np.square(steps.largest), 0)
        size = np.sqrt(noise / (20 * runs.n_frames[:, None]))
        usual = _quarter(size[long[:, 0]])
        wrong = (size > _NOISE * usual) & (usual > 0) & (size > _TICK * runs.spans(name)) & _continuous(runs, name)
        wrong &= long & (steps.alternates < _ALTERNATES * steps.noise)
        if wrong.any():
            run, column = _worst(wrong, size / np.maximum(usual, 1e-300))
            found = f"noise of about {size[run, column]:.3g}{_so_in(wrong[run])}"
            expected = f"about {usual[column]:.3g}, as in the other episodes"
            mend = "Is a cable loose, or was something touched? Look at it before you train on it"
            place = f"{_dim(runs, name, column)} in {_named(runs, wrong.any(axis=1))}"
            yield Fault(DATA_DIR, place, found, expected, mend)


@Check("repeat", "every frame is a new measurement", "warning").of(Runs)
def frames_are_no_repeats(runs: Runs) -> Iterator[Answer]:
    """Does every other frame repeat the one before, although the robot moves?"""
    for name, steps in runs.steps.items():
        share = steps.repeated[:, 0] / runs.n_frames
        wrong = (share > _REPEATED) & (runs.n_frames >= MIN_FRAMES)
        if wrong.any() and runs.claims.schema.features[name].size > 1:
            run = int(np.where(wrong, share, 0).argmax())
            everywhere = bool(wrong.mean() > _MOST)
            where = "" if everywhere else f" in {_named(runs, wrong)}"
            found = f"{share[run]:.0%} of all frames the same as the one before, between others that move"
            mend = "Was it read more seldom than it was recorded? Then changes from frame to frame mean nothing"
            fault = Fault(DATA_DIR, f"{name}{where}", found, "a new value in every frame while it moves", mend)
            yield ("note", fault) if everywhere else fault


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
        yield Fault(DATA_DIR, f"{STATE} in {_named(runs, wrong)}", found, "motion, as in the other episodes", mend)


@Check("near-twin", "no demonstration is nearly that of another episode", "warning").of(Runs)
def no_near_twins(runs: Runs) -> Iterator[Answer]:
    """Is a demonstration a copy of another one, cut, shifted by a frame, or with noise added?"""
    if STATE not in runs.steps or not 3 <= len(runs.number) <= _MAX_COMPARED:
        return
    distance, neighbour = _nearest(runs.steps[STATE], runs.claims.schema.features[STATE].size)
    known = np.isfinite(distance)
    if known.sum() < 3:
        return
    usual = float(np.quantile(distance[known], 0.75))
    near = known & (distance < _NEAR * usual) & (distance > 0)
    pairs = sorted({tuple(sorted((run, int(neighbour[run])))) for run in np.flatnonzero(near).tolist()})
    if pairs:
        one, other = pairs[0]
        more = and_more(np.ones(len(pairs), dtype=bool))
        found = f"nearly episode {runs.number[one]} again: {distance[other]:.2g} apart{more}"
        expected = f"demonstrations that differ by about {usual:.2g} of their spread"
        mend = "It counts twice in training, and may stand on both sides of a split"
        yield Fault(DATA_DIR, f"episode {runs.number[other]}", found, expected, mend)


def _nearest(steps: RunSteps, size: int) -> tuple[Floats, Ints]:
    """Return how far each demonstration is from the nearest other one, in spreads of its columns, and which that is."""
    marks = steps.marks.reshape(len(steps.marks), -1, size)  # (n_runs, n_marks, size)
    spread = np.nanstd(marks.reshape(-1, size), axis=0)
    marks = ((marks - np.nanmean(marks.reshape(-1, size), axis=0)) / np.where(spread > 0, spread, 1))[:, :, spread > 0]
    order = np.argsort(np.nansum(marks[:, : marks.shape[1] // 2], axis=(1, 2)), kind="stable")
    distance, neighbour = np.full(len(marks), np.nan), np.zeros(len(marks), dtype=np.int64)
    for ahead in range(1, min(_NEIGHBOURS, len(order) - 1) + 1):
        one, other = order[:-ahead], order[ahead:]
        apart = np.square(marks[one] - marks[other]).mean(axis=2)  # (n, n_marks)
        common = np.isfinite(apart).sum(axis=1)
        far = np.sqrt(np.nansum(apart, axis=1) / np.maximum(common, 1))
        far[common < 4] = np.nan
        for mine, its in ((one, other), (other, one)):
            closer = far < np.where(np.isnan(distance[mine]), np.inf, distance[mine])
            distance[mine[closer]], neighbour[mine[closer]] = far[closer], its[closer]
    return distance, neighbour


def _leap_ratio(runs: Runs, name: str) -> Floats:
    """Say how many times larger than the others of its run the largest step is, (n_runs, size)."""
    steps = runs.steps[name]
    rest = (steps.squares - np.square(steps.largest)) / np.maximum(runs.n_frames[:, None] - 2, 1)
    with np.errstate(divide="ignore", invalid="ignore"):
        ratio = steps.largest / np.sqrt(np.maximum(rest, 1e-300))
    return np.where((rest > 0) & (runs.n_frames[:, None] >= MIN_FRAMES), ratio, 0.0)


def _continuous(runs: Runs, name: str) -> Bools:
    """Say of each column whether it moves in many steps: what goes through half of its range in one is a switch."""
    spans = runs.spans(name)
    steps = runs.steps[name].largest
    continuous: Bools = (spans > 0) & (np.median(steps, axis=0) < _SWITCH * spans)
    return continuous


def _is_a_turn(step: Floats) -> Bools:
    """Say where an angle goes on at the other end of its range."""
    a_turn: Bools = np.isclose(step, 2 * np.pi, rtol=0.05) | np.isclose(step, 360, rtol=0.05)
    return a_turn


def _quarter(values: Floats) -> Floats:
    """Return what a quarter of the episodes stay below, for each column: a fault in half of them does not shift it."""
    quarter: Floats = np.quantile(values, 0.25, axis=0, method="lower")
    return quarter


def _worst(wrong: Bools, values: Floats) -> tuple[int, int]:
    """Return the run and the column of the largest value that is wrong."""
    run, column = np.unravel_index(int(np.where(wrong, values, -np.inf).argmax()), wrong.shape)
    return int(run), int(column)


def _so_in(wrong: Bools) -> str:
    """Say in how many columns else of the run that is so."""
    n = int(wrong.sum())
    return f", and so in {count(n - 1, 'more column')}" if n > 1 else ""


def _where(runs: Runs, wrong: Bools, run: int, frame: float) -> str:
    episodes: Bools = wrong.any(axis=1)
    return f"episode {runs.number[run]}, frame {frame:.0f}{and_more(episodes)}"


def _named(runs: Runs, wrong: Bools) -> str:
    return episodes_named(runs.number[wrong].tolist())


def _dim(runs: Runs, name: str, column: int) -> str:
    feature = runs.claims.schema.features[name]
    label = feature.labels[column]
    return name if feature.size == 1 else f"{name}{label}" if label.startswith("[") else f"{name}[{label}]"
