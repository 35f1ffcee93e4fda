"""Does a column stay at an end of its range, or go beyond one that is declared?

What rests at an end may be meant to: a joint at its stop, a gripper that is closed, a base that stands still. What
stands there, bit for bit, while its command goes on, or comes there at full speed while all else moves, was cut off.
"""

from collections.abc import Iterator

import numpy as np
from numpy.typing import NDArray

from z2r.arrays import Bools, Floats
from z2r.audits.motion import often_moves
from z2r.audits.runs import Runs
from z2r.check import Answer, Check
from z2r.errors import Fault
from z2r.format.episodes import DATA_DIR
from z2r.format.schema import ACTION, STATE, column_label
from z2r.reading.joints import is_gripper
from z2r.reading.stored import episodes_named

_FEW = 0.2  # of the episodes
_LIMIT = 0.05  # of the way between two limits: calibration is off by as much
_SHARE = 0.05  # of a column's range
_CLIPPED = 0.02  # of the frames
_MIN_EPISODES = 3
_STANDS = 0.05  # of the moments of the episodes that come to it
_NEAR, _FARTHER = 0.03, 0.09  # of a column's range, from its end
_SLOWER = 4  # times as often near an end as farther from it: it comes to rest there
_LEVELS = 20  # in which a column that moves stands, at least
_OTHERS_MOVE = 0.4  # of how fast they usually go


@Check("limits", "a column stays within the limits that a reading declares", "warning").of(Runs)
def columns_keep_their_limits(runs: Runs) -> Iterator[Answer]:
    """Does a column go beyond what a reading says that it keeps?"""
    reading, features = runs.claims.reading, runs.claims.schema.features
    if reading is None:
        return
    for name, stats in runs.stats.items():
        for column, label in enumerate(features[name].dim_names):
            meaning = reading.meaning(name, label)
            for limit, sign, values in ((meaning.low, -1, stats.low), (meaning.high, 1, stats.high)):
                if limit is None:
                    continue
                beyond = sign * (values[:, column] - limit)
                wrong = beyond > _LIMIT * np.ptp([meaning.low or 0.0, meaning.high or 0.0])
                if wrong.any():
                    run = int(beyond.argmax())
                    found = f"{values[run, column]:.4g}{f' {meaning.unit}' if meaning.unit else ''}"
                    expected = f"at {'least' if sign < 0 else 'most'} {limit:.4g}, as the reading {reading.name} says"
                    mend = "Is the reading right? Then a unit, a calibration or a sensor is not"
                    fault = _fault(runs, name, column, wrong, found, expected, mend)
                    yield fault if wrong.mean() <= _FEW else ("note", fault)  # beyond it everywhere, it is no limit


CLIPPED = Check("clipped", "what a robot does is not cut off where the recording ends, and it does not", "note")


@CLIPPED.of(Runs)
def nothing_is_clipped(runs: Runs) -> Iterator[Answer]:
    """Does a column stay at its end, bit for bit, while the one of its name goes on beyond it?"""
    if STATE not in runs.steps or ACTION not in runs.steps:
        return
    names = {name: runs.claims.schema.features[name].labels for name in (STATE, ACTION)}
    for one, other in ((STATE, ACTION), (ACTION, STATE)):
        moves = often_moves(runs, one)
        for column, name in enumerate(names[one]):
            if names[other].count(name) != 1 or not moves[column]:
                continue
            beyond = names[other].index(name)
            for end, sign, at in (("low", -1, runs.steps[one].at_low), ("high", 1, runs.steps[one].at_high)):
                mine, its = (
                    getattr(runs.stats[one], end)[:, column] * sign,
                    getattr(runs.stats[other], end)[:, beyond] * sign,
                )
                there = mine == mine.max()
                share = at[there, column].sum() / runs.n_frames.sum()
                by = its.max() - mine.max()
                if share > _CLIPPED and there.sum() >= _MIN_EPISODES and by > _SHARE * runs.spans(one)[column]:
                    found = f"{mine.max() * sign:.4g} in {share:.0%} of all frames, the {end}est value"
                    partner = column_label(other, runs.claims.schema.features[other], beyond)
                    expected = f"as far as {partner} goes: {its.max() * sign:.4g}"
                    mend = "A limit of the joint is no fault; a limit of the recording hides where it was"
                    yield _fault(runs, one, column, there, found, expected, mend)


@CLIPPED.of(Runs)
def no_joint_is_cut_with_its_command(runs: Runs) -> Iterator[Answer]:
    """Does a joint come to one value at full speed and stand there, bit for bit, as far as its command goes?

    Not a gripper, which closes; nor where all else rests too, or most episodes begin.
    """
    moments = runs.moments_of(STATE)
    if not moments.size or ACTION not in runs.stats:
        return
    labels, asked = (runs.claims.schema.features[name].labels for name in (STATE, ACTION))
    spans, moves = runs.spans(STATE), often_moves(runs, STATE)
    for column in np.flatnonzero(moves).tolist():
        name = labels[column]
        if asked.count(name) != 1 or is_gripper(name):
            continue
        values, others = moments[:, :, 0, column], moves & (np.arange(len(moves)) != column)
        for end, sign in (("low", -1), ("high", 1)):
            limit, there = _shared(sign * getattr(runs.stats[STATE], end)[:, column])
            its = sign * getattr(runs.stats[ACTION], end)[there, asked.index(name)]
            goes_on = its.max() - limit > _SHARE * spans[column]
            if goes_on or there.sum() < _MIN_EPISODES or not others.any():
                continue
            if not _arrives_at_speed(sign * values[there], limit, spans[column]):
                continue
            stands = there[:, None] & (values == np.float32(sign * limit))
            speed = np.abs(moments[:, :, 1][:, :, others])
            if np.nanmean(speed[stands] / np.nanmean(speed, axis=(0, 1))) >= _OTHERS_MOVE:
                share = stands.sum() / int(np.isfinite(values).sum())
                found = f"{sign * limit:.4g} at {share:.0%} of all moments, the {end}est value, while the others move"
                mend = "Is it a stop of the joint, or a limit of a calibration or a program that hides where it was?"
                expected = "a joint that slows down where it turns back, and readings that differ a little"
                yield _fault(runs, STATE, column, there, found, expected, mend)


def _shared(ends: Floats) -> tuple[float, Bools]:
    """Return at which value, bit for bit, most runs have their end, of as many the highest, and which these are."""
    values, n = np.unique(ends, return_counts=True)
    limit = float(values[len(n) - 1 - n[::-1].argmax()])
    return limit, ends == limit


def _arrives_at_speed(values: NDArray[np.float32], limit: float, span: float) -> bool:
    """Tell whether runs stand at a limit, and are near it no more than farther off: what slows down is near for long.

    `values` are (n_runs, n_moments), below the limit.
    """
    below = (limit - values) / span
    stands, near = (values == np.float32(limit)).sum(), ((below > 0) & (below < _NEAR)).sum()
    farther = ((below >= _NEAR) & (below < _FARTHER)).sum() / (_FARTHER / _NEAR - 1)
    begins_there = (values[:, 0] == np.float32(limit)).mean() >= 1 / 2
    enough = stands >= max(_STANDS * values.size, 1.5 * near) and len(np.unique(values)) >= _LEVELS
    return bool(enough and near <= _SLOWER * (farther + 1) and not begins_there)


def _fault(runs: Runs, name: str, column: int, wrong: Bools, found: str, expected: str, mend: str) -> Fault:
    number = runs.number[wrong].tolist()
    label = column_label(name, runs.claims.schema.features[name], column)
    return Fault(DATA_DIR, f"{label} in {episodes_named(number)}", found, expected, mend, tuple(dict.fromkeys(number)))
