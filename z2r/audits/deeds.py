"""Does an episode do what it says? Held against the others that say the same, and against those that do not.

The text of a task, a success and a reward are only said; what the robot does is measured. Where the two part in a few
episodes, nobody knows which of them is right: so all of this is a note.
"""

import re
from collections.abc import Iterator
from itertools import permutations
from typing import NamedTuple

import numpy as np

from z2r.arrays import Bools, Floats, Ints
from z2r.audits.following import MIN_FRAMES
from z2r.audits.frames import FileFrames
from z2r.audits.labels import LABEL_MOMENT
from z2r.audits.motion import parted, share_a_task
from z2r.audits.runs import Runs
from z2r.audits.steps import run_of
from z2r.check import Answer, Check
from z2r.errors import Fault, short
from z2r.format.episodes import DATA_DIR
from z2r.format.schema import ACTION, STATE, Schema, column_label
from z2r.reading.joints import is_gripper
from z2r.reading.stored import REWARD, episodes_named, is_one_number, is_true, label_in, levels_of

_MIN_OF_A_TASK = 3  # episodes
_APART = 2.5  # times how far the episodes of two tasks stray, between the middles of both: there, they differ
_TELLING = 4  # places in which they do
_OTHERS_WAY = 0.75  # of these: nearer to the other task
_NEARER = 0.75  # times as far as from the nearest of its own task
_FEW = 0.25  # of the episodes of a task: of more, nobody knows whether the text is wrong
_MAX_TEXT, _FINE = 60, 0.01  # characters of a text that are shown; and of a range, what is always nearly the same
_SAMPLE = 64  # episodes of a task, by which it is known how near they come to each other

MIN_EPISODES = 8  # of which one comes elsewhere
_BEYOND, _SURELY = 1.5, 5  # times as far as the others are from each other, of one alone, and of several
_SHARE = 0.15  # of a column's range
_MANY = 0.3  # of the episodes: the others need not be the right ones

ENOUGH, _TWO = 5, 1.5  # episodes; and times as much as usual: those that tried twice came to 1.3
_CLEAR = 1.15  # times as much as the most of the others

_SIDES = {"left": "right", "right": "left"}

_CLEARLY = 2.5  # times as far as those that hold nothing
_STANDS = 0.02  # of a gripper's range, in two frames
_HELD_BACK, _NOT_HELD = 0.08, 0.2  # of it; and of how far it is held back in the others
_HALF, _MOST = 0.5, 0.75  # of the episodes: at least so many hold something, and what is usual in them
_WIDE = 0.3  # of a gripper's range: by so much it is told to open
_LATER = 3  # moments of an episode in which it stands: a hand or two may be in between


@Check("task-motion", "an episode goes as the others of its task do, and not as those of another", "note").of(Runs)
def episodes_do_their_own_task(runs: Runs) -> Iterator[Answer]:
    """Does an episode go as those of another task, where the two go different ways? It may have the other's text."""
    tasks, states, task = runs.claims.stored.tasks.value, runs.moments_of(STATE)[:, :, 0], _only_tasks(runs)
    if tasks is None or len(tasks.number) < 2 or not states.size:
        return
    task[~np.isfinite(states).all(axis=(1, 2))] = -1
    text = dict(zip(tasks.number.tolist(), tasks.text, strict=True))
    numbers, n = np.unique(task[np.isin(task, tasks.number)], return_counts=True)
    for own, other in permutations(numbers[n >= _MIN_OF_A_TASK].tolist(), 2):
        rows = _as_of_another(states.astype(np.float64), *(np.flatnonzero(task == each) for each in (own, other)))
        if len(rows):
            number = runs.number[rows].tolist()
            said, done = (repr(short(text[each], _MAX_TEXT)) for each in (own, other))
            expected = f"motion as in the other episodes of {said}"
            mend = "Was it recorded with the text of another task? Look at its pictures"
            place = f"task_index in {episodes_named(number)}"
            yield Fault(DATA_DIR, place, f"{said}, and motion as of {done}", expected, mend, tuple(number))


def _only_tasks(runs: Runs) -> Ints:
    """Return the task of each run that has one and no other, else -1: int64[n_runs]."""
    task = np.full(len(runs.number), -1)
    if runs.tasks is not None:
        run, number = runs.tasks.T
        task[run] = number
        task[np.bincount(run, minlength=len(task)) != 1] = -1
    return task


def _as_of_another(states: Floats, own: Ints, other: Ints) -> Ints:
    """Return the few of a task's runs that go as those of another one, where the middles of both are far apart.

    `states` are (n_runs, n_moments, size). Only one of them near the other's is no reason: it may have gone astray.
    """
    span, strays = np.ptp(states, axis=(0, 1)), np.zeros(states.shape[1:])
    middle = {}
    for name, rows in (("own", own), ("other", other)):
        middle[name] = np.median(states[rows], axis=0)
        away = 1.4826 * np.median(np.abs(states[rows] - middle[name]), axis=0)  # as a standard deviation
        strays += np.maximum(away, _FINE * span)
    telling = (np.abs(middle["own"] - middle["other"]) >= _APART * strays) & (span > 0)  # (n_moments, size)
    if telling.sum() < _TELLING:
        return own[:0]
    nearer = np.abs(states[own] - middle["other"]) < np.abs(states[own] - middle["own"])
    as_other = nearer[:, telling].mean(axis=1) >= _OTHERS_WAY
    if as_other.sum() > max(1, _FEW * len(own)):
        return own[:0]
    scaled = states / np.where(span > 0, states.std(axis=(0, 1)), 1)
    usual = max(_to_the_nearest(scaled, row, other) for row in other[:_SAMPLE].tolist())
    return np.array(
        [
            row
            for row in own[as_other].tolist()
            if (far := _to_the_nearest(scaled, row, other)) <= usual
            and far <= _NEARER * _to_the_nearest(scaled, row, own)
        ],
        dtype=np.int64,
    )


def _to_the_nearest(states: Floats, row: int, others: Ints) -> float:
    """Return how far a run is from the nearest of some others, as a root mean square."""
    return float(np.sqrt(np.square(states[others[others != row]] - states[row]).mean(axis=(1, 2)).min()))


@Check("long-episode", "an episode is one demonstration, and no more", "note").of(Runs)
def episodes_are_one_demonstration(runs: Runs) -> Iterator[Answer]:
    """Does an episode go on for much longer, and much farther, than the others? Who is only slow goes no farther."""
    if STATE not in runs.steps or len(runs.number) < ENOUGH:
        return
    path = runs.steps[STATE].path
    usual = np.median(path, axis=0)
    farther = np.median(path[:, usual > 0] / usual[usual > 0], axis=1) if usual.any() else np.zeros(len(path))
    usual_length = np.median(runs.n_frames)
    longer = runs.n_frames / usual_length
    both = np.minimum(farther, longer)
    wrong: Bools = (both >= _TWO) & (usual_length >= MIN_FRAMES)
    if not wrong.any() or wrong.mean() > _FEW or both[wrong].min() < _CLEAR * both[~wrong].max():
        return
    if share_a_task(runs, wrong):
        worst = int(np.where(wrong, farther, 0).argmax())
        number = runs.number[wrong].tolist()
        found = f"{longer[worst]:.1f} times as many frames as usual, and {farther[worst]:.1f} times as much motion"
        mend = "Was the reset recorded too, a second try, or the next demonstration? Cut it there, or leave it out"
        named = episodes_named(number)
        yield Fault(DATA_DIR, named, found, "about as long a way as in the other episodes", mend, tuple(number))


@Check("left-right", "left and right are the same two in all episodes", "note").of(Runs)
def left_stays_left(runs: Runs) -> Iterator[Answer]:
    """Does an episode go as the others do once the columns that are called left and right are exchanged?"""
    states, other = runs.moments_of(STATE)[:, :, 0], _other_side(runs)
    mine = np.flatnonzero(other >= 0)
    if not len(mine) or not np.isfinite(states).any():
        return
    states = states.astype(np.float64)
    spans = np.maximum(runs.spans(STATE)[mine], runs.spans(STATE)[other[mine]])
    middle = np.nanmedian(states[:, :, mine], axis=0)  # (n_moments, n)
    far, exchanged = (
        np.sqrt(np.square((states[:, :, each] - middle) / np.where(spans > 0, spans, 1)).mean(axis=(1, 2)))
        for each in (mine, other[mine])
    )
    wrong: Bools = (exchanged <= far / 2) & (far >= 2 * np.nanmedian(far))
    if wrong.any() and wrong.mean() <= _FEW and share_a_task(runs, wrong):
        number = runs.number[wrong].tolist()
        found = f"motion that is {far[wrong].max():.2f} of its range from that of the others"
        found += f", and {exchanged[wrong].max():.2f} once left and right are exchanged"
        mend = (
            "Are the columns of the two arms exchanged there, or was it done with the other hand? Look at the pictures"
        )
        place = f"{STATE} in {episodes_named(number)}"
        yield Fault(DATA_DIR, place, found, "about that of the other episodes", mend, tuple(number))


def _other_side(runs: Runs) -> Ints:
    """Return for each column of the state the one of the other side, by their names; -1 where there is none."""
    labels = list(runs.claims.schema.features[STATE].labels) if STATE in runs.stats else []
    swapped = [re.sub("left|right", lambda side: _SIDES[side[0]], label) for label in labels]
    sides = [
        labels.index(there) if there != label and there in labels else -1
        for label, there in zip(labels, swapped, strict=True)
    ]
    return np.array(sides, dtype=np.int64)


GRASP = Check("grasp", "a gripper holds what it holds in the other episodes, until it is told to open", "note")


class _Grip(NamedTuple):
    """How a gripper holds something, at some moments of each run: all (n_runs, n_moments), and usual a number.

    Attributes
    ----------
    column : int
        Of the state.
    span : float
        What it goes through.
    command, place : ndarray, float64
        Where it is told to be, and where it is.
    beside : ndarray, float64
        How far from there it stands: 0 where it moves.
    stands : ndarray of bool
        Whether it does.
    held : ndarray, float64[n_runs]
        How far beside its command it stands in most of its moments that are so, but for a few.
    usual : float
        That of most runs.
    """

    column: int
    span: float
    command: Floats
    place: Floats
    beside: Floats
    stands: Bools
    held: Floats
    usual: float


def _grips(runs: Runs) -> Iterator[_Grip]:
    """Yield the grippers that have a command of their own, and hold something in at least half of the episodes."""
    labels = {name: runs.claims.schema.features[name].labels for name in (STATE, ACTION) if name in runs.stats}
    seen, asked = (runs.moments_of(name) for name in (STATE, ACTION))
    if len(labels) < 2 or not seen.size or len(runs.number) < MIN_EPISODES:
        return
    for column, name in enumerate(labels[STATE]):
        if not is_gripper(name) or labels[ACTION].count(name) != 1:
            continue
        span = float(runs.spans(STATE)[column])
        stands = np.abs(seen[:, :, 1, column].astype(np.float64)) <= _STANDS * span
        command = asked[:, :, 0, labels[ACTION].index(name)].astype(np.float64)
        place = seen[:, :, 0, column].astype(np.float64)
        beside = np.where(stands, np.abs(command - place), 0)
        held = np.sort(beside, axis=1)[:, -_LATER]
        usual = float(np.quantile(held, _MOST))
        if (held >= max(_HELD_BACK * span, usual / 2)).mean() >= _HALF:
            yield _Grip(column, span, command, place, beside, stands, held, usual)


@GRASP.of(Runs)
def grippers_hold_something(runs: Runs) -> Iterator[Answer]:
    """Does a gripper come to where it is told to be, where something between its fingers holds it back elsewhere?"""
    for grip in _grips(runs):
        held, closes = grip.held, np.ptp(grip.command, axis=1)
        wrong: Bools = (held <= _NOT_HELD * grip.usual) & (held > 0)  # a command may be a copy of the state
        wrong &= closes >= np.median(closes) / 2
        if wrong.any() and held[~wrong].min() >= _CLEARLY * held[wrong].max() and share_a_task(runs, wrong):
            found = f"{held[wrong].max():.2g} beside its command at most, where it stands"
            expected = f"about {grip.usual:.3g}, as in the other episodes, where something holds it back"
            mend = "Did it close on nothing, or on something thinner? Look at the pictures, and at what the label says"
            yield _fault_of(runs, grip, wrong, found, expected, mend)


@GRASP.of(Runs)
def grippers_lose_nothing(runs: Runs) -> Iterator[Answer]:
    """Does what held a gripper back go, while the command stays as it is? In the other episodes it opens before."""
    for grip in _grips(runs):
        wrong: Bools = _moments_after_a_loss(grip) >= _LATER
        if wrong.any() and wrong.mean() <= _FEW:
            found = "nothing any more that holds it back, although it stays closed"
            if runs.comes is not None and np.isfinite(runs.comes[wrong, 0]).all():
                found += f", and {label_of(runs.claims.schema)} comes all the same"
            expected = "something until it is told to open, as in the other episodes"
            mend = "Was something lost on the way? Look at the pictures, and at what the label says"
            yield _fault_of(runs, grip, wrong, found, expected, mend)


@GRASP.of(Runs)
def grippers_let_go(runs: Runs) -> Iterator[Answer]:
    """Does a gripper that holds something stay where it is, although it is told to open wide?"""
    for grip in _grips(runs):
        middle = _amid_a_hold(grip)
        closed, at = (np.take_along_axis(each, middle, axis=1) for each in (grip.command, grip.place))
        stays = grip.stands & (np.abs(grip.place - at) <= 2 * _STANDS * grip.span)
        stays &= (np.abs(grip.command - closed) >= _WIDE * grip.span) & (np.arange(stays.shape[1]) > middle)
        wrong: Bools = stays.sum(axis=1) >= _LATER
        if wrong.any() and wrong.mean() <= _FEW:
            there = np.median(np.broadcast_to(at, stays.shape)[stays])
            found = f"{there:.3g} ever since it closed, although it is told to open"
            mend = "Did its servo switch off, as in overload, or does it stick? Look at the pictures"
            yield _fault_of(runs, grip, wrong, found, "a gripper that opens, as in the other episodes", mend)


def _amid_a_hold(grip: _Grip) -> Ints:
    """Return the moment of each run that is in the middle of those in which something holds it back: (n_runs, 1)."""
    holds = grip.beside >= _holds_at_least(grip) / 2
    middle: Ints = (2 * holds.cumsum(axis=1) >= holds.sum(axis=1, keepdims=True)).argmax(axis=1, keepdims=True)
    return middle


def _holds_at_least(grip: _Grip) -> Floats:
    """Say how far each run is held back, (n_runs, 1): one may hold what is thinner."""
    return np.maximum(grip.held, _NOT_HELD * grip.usual)[:, None]


def _moments_after_a_loss(grip: _Grip) -> Ints:
    """Count the moments of each run in which nothing holds the gripper back, since it last held something and closed.

    What opens in between lets go.
    """
    usual = _holds_at_least(grip)
    holds = grip.beside >= usual / 2
    closed = np.take_along_axis(grip.command, _amid_a_hold(grip), axis=1)
    opens = np.abs(grip.command - closed) > _HELD_BACK * grip.span
    empty = ~opens & grip.stands & (grip.beside <= _NOT_HELD * usual)
    last_open, last_held = (
        np.maximum.accumulate(np.where(so, np.arange(so.shape[1]), -1), axis=1) for so in (opens, holds & ~opens)
    )
    lost: Ints = (empty & (last_held > last_open)).sum(axis=1)
    return lost


def _fault_of(runs: Runs, grip: _Grip, wrong: Bools, found: str, expected: str, mend: str) -> Fault:
    number = runs.number[wrong].tolist()
    label = column_label(STATE, runs.claims.schema.features[STATE], grip.column)
    return Fault(DATA_DIR, f"{label} in {episodes_named(number)}", found, expected, mend, tuple(number))


@LABEL_MOMENT.of(Runs)
def labels_come_where_they_do_elsewhere(runs: Runs) -> Iterator[Answer]:
    """Does a label come in a state, or so many frames before the end, as in no other episode?"""
    come = (
        np.flatnonzero(np.isfinite(runs.comes).all(axis=1)) if runs.comes is not None else np.empty(0, dtype=np.int64)
    )
    if runs.comes is None or len(come) < MIN_EPISODES:
        return
    column, few = _elsewhere(runs.comes[come], np.append(np.median(runs.n_frames[come]), runs.spans(STATE)))
    wrong: Bools = np.isin(np.arange(len(runs.number)), come[few])
    if len(few) and share_a_task(runs, wrong):
        here, there = (
            float(np.median(runs.comes[some, column])) for some in (come[few], np.setdiff1d(come, come[few]))
        )
        name = column_label(STATE, runs.claims.schema.features[STATE], column - 1) if column else ""
        where = [
            f"where {name} is {each:.3g}" if name else f"{each:.0f} frames before the end" for each in (here, there)
        ]
        number = runs.number[wrong].tolist()
        place = f"{label_of(runs.claims.schema)} in {episodes_named(number)}"
        expected = f"it about {where[1]}, as in the other episodes"
        mend = "Does the label come too early or too late there, or was something else done? Look at it"
        if len(few) > _MANY * len(come):
            mend += f". It is {len(few)} episodes against {len(come) - len(few)}: nobody knows which of them are right"
        yield Fault(DATA_DIR, place, f"what comes first {where[0]}", expected, mend, tuple(number))


def _elsewhere(comes: Floats, whole: Floats) -> tuple[int, Ints]:
    """Return in which column few rows, and which, are far from all others: in the first, or where they are farthest.

    `comes` are (n, size), of which each column goes through the `whole` (size,), and the first counts frames.
    """
    odd: list[tuple[float, int, Ints]] = []
    for column in np.flatnonzero(whole > 0).tolist():
        few, gap, spread = parted(comes[:, column])
        if column and len(few) > _MANY * len(comes):
            continue  # of goals, there may well be two
        times = _BEYOND if len(few) == 1 else _SURELY
        if gap >= max(_SHARE * whole[column], times * spread, 0 if column else times):
            odd.append((gap / max(spread, _FINE * whole[column]), column, few))
    if not odd:
        return 0, np.empty(0, dtype=np.int64)
    _, column, few = odd[0] if odd[0][1] == 0 else max(odd, key=lambda each: each[0])
    return column, few


def label_of(schema: Schema) -> str | None:
    """Return the column that says that something was reached: a success, else a reward of one number."""
    return label_in(schema) or (REWARD if is_one_number(REWARD, schema) else None)


def fold_comes(frames: FileFrames) -> Floats | None:
    """Say of each run how many frames before its end its label first comes, and what the state is then.

    Returns
    -------
    ndarray, float64[n_runs, 1 + size], or None
        NaN where it never comes, is there from the start, or is a reward of more than two levels. None where there is
        no label, or no state.
    """
    label, starts = label_of(frames.schema), frames.run_starts
    if label not in frames.read.frames or STATE not in frames.signals:
        return None
    values, state = frames.read.frames[label][:, 0], frames.signals[STATE]
    comes = np.full((len(starts), 1 + state.shape[1]), np.nan)
    if label == REWARD and len(levels_of(values)) > 2:
        return comes
    there = is_true(values) if label != REWARD else values == values.max()
    hits = np.flatnonzero(there & (values != values.min()))[::-1]
    first = np.full(len(starts), -1)
    first[run_of(hits, starts)] = hits  # the first of each run is written last
    late = first > starts
    comes[late, 0] = np.append(starts[1:], len(values))[late] - first[late]
    comes[late, 1:] = state[first[late]]
    return comes
