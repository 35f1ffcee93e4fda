"""How does each column go from frame to frame? Summed up for each run of frames, so that no file stays in memory."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from z2r.arrays import Array, Bools, Floats, Ints
from z2r.format.schema import ACTION

_STILL = 6  # frames: a shorter rest tells nothing
_AFTER = 5  # frames after a leap, with which it is compared
_MARKS = 12  # frames of a run, evenly from its start, which tell one demonstration from another
_TURNS, _A_TURN = (2 * np.pi, 360.0), 0.05  # rad and deg; of it: so much may come to it in one frame
_MARK_EVERY = 0.27  # s


class RunSteps(NamedTuple):
    """The steps of one feature from one frame to the next: float64[n_runs, size] unless it says otherwise.

    Attributes
    ----------
    largest, at, around : ndarray
        The largest step, the frame of its run to which it leads, and the larger one of the steps before and after it.
    path : ndarray
        The sum of the sizes of all steps.
    moves : ndarray
        How many frames differ from the one before.
    at_low, at_high : ndarray
        In how many frames it is at the lowest, and at the highest value of this file, bit for bit.
    noise : ndarray
        The sum of the sizes of the third differences: white noise of a standard deviation s gives 3.6 s a frame, smooth
        motion far less, and one leap counts as one.
    jerks, alternates : ndarray
        The sum of their squares, and of the products of each with the next: of white noise, -3/4 of the former.
    stall, stall_leap, stall_at, stall_length : ndarray
        How many times as far as in the frames thereafter a column leaps after a rest, while it goes on moving; how far;
        the frame to which it leaps; and how many frames it rested.
    repeated : ndarray, float64[n_runs, 1]
        How many frames repeat the one before, in all columns, between two that do not.
    marks : ndarray, float64[n_runs, 12 * size]
        Some frames, a quarter of a second apart: what tells a demonstration from another. NaN beyond its end.
    """

    largest: Floats
    at: Floats
    around: Floats
    path: Floats
    moves: Floats
    at_low: Floats
    at_high: Floats
    noise: Floats
    jerks: Floats
    alternates: Floats
    stall: Floats
    stall_leap: Floats
    stall_at: Floats
    stall_length: Floats
    repeated: Floats
    marks: Floats


def moves(name: str) -> bool:
    """Tell whether a feature is what a robot was seen to do, or was told to do, by its name."""
    return name.startswith(("observation", ACTION))


def is_a_turn(steps: Floats | float, spans: Floats | float) -> Bools:
    """Say where an angle goes on at the other end of its range: a step of a whole turn, through a range as wide.

    Parameters
    ----------
    steps : ndarray, float64[..., size], or float
        From one frame to the next.
    spans : ndarray, float64[size], or float
        From the smallest to the largest value of each column.

    Examples
    --------
    >>> is_a_turn(np.array([359.0, 359.0, 6.2]), spans=np.array([360.0, 2000.0, 100.0])).tolist()
    [True, False, False]
    """
    turns = [(np.abs(steps - turn) < _A_TURN * turn) & (np.abs(spans - turn) < _A_TURN * turn) for turn in _TURNS]
    a_turn: Bools = np.logical_or(*turns)
    return a_turn


def run_of_each(starts: Ints, n_rows: int) -> Ints:
    """Return the run that each row is in, int64[n_rows]."""
    begins = np.zeros(n_rows, dtype=np.int64)
    begins[starts[(starts > 0) & (starts < n_rows)]] = 1
    return np.cumsum(begins)


def run_steps(values: Array, starts: Ints, fps: float) -> RunSteps:
    """Sum up one feature for each run; a run begins at each of `starts` and ends where the next begins."""
    run = run_of_each(starts, len(values))
    moving = np.zeros(len(values), dtype=bool)
    columns = []
    for column in values.T:
        columns.append(_column_steps(column.astype(np.float64), run, starts))
        moving[1:] |= column[1:] != column[:-1]
    stacked = {name: np.stack([column[name] for column in columns], axis=1) for name in columns[0]}
    return RunSteps(**stacked, repeated=_repeated(moving, starts)[:, None], marks=_marks(values, starts, fps))


def join_steps(parts: Sequence[RunSteps]) -> RunSteps:
    """Put the runs of all files after each other."""
    return RunSteps(*(np.concatenate(each) for each in zip(*parts, strict=True)))


def _column_steps(values: Floats, run: Ints, starts: Ints) -> dict[str, Any]:
    steps = np.diff(values, prepend=0.0)
    steps[starts] = 0
    size = np.abs(steps)
    largest = np.maximum.reduceat(size, starts)
    at, around = np.zeros(len(starts)), np.zeros(len(starts))
    hits = np.flatnonzero(size == largest[run])[::-1]  # the first of each run is written last
    at[run[hits]] = hits - starts[run[hits]]
    after = np.where(run[np.minimum(hits + 1, len(run) - 1)] == run[hits], size[np.minimum(hits + 1, len(run) - 1)], 0)
    around[run[hits]] = np.maximum(size[np.maximum(hits - 1, 0)], after)  # of the first frame of a run it is 0
    third = np.zeros(len(steps))
    third[3:] = steps[3:] - 2 * steps[2:-1] + steps[1:-2]
    for place in range(3):
        third[np.minimum(starts + place, len(steps) - 1)] = 0  # which would reach into the run before
    return {
        "largest": largest,
        "at": at,
        "around": around,
        "path": np.add.reduceat(size, starts),
        "moves": np.add.reduceat((steps != 0).astype(np.float64), starts),
        "at_low": np.add.reduceat((values == values.min()).astype(np.float64), starts),
        "at_high": np.add.reduceat((values == values.max()).astype(np.float64), starts),
        "noise": np.add.reduceat(np.abs(third), starts),
        "jerks": np.add.reduceat(np.square(third), starts),
        "alternates": np.add.reduceat(third * np.append(third[1:], 0.0), starts),
        **_stalls(size, run, starts),
    }


def _stalls(size: Floats, run: Ints, starts: Ints) -> dict[str, Any]:
    """Find the worst leap after a rest in each run, by how far it goes compared with the largest step soon after it."""
    found = {name: np.zeros(len(starts)) for name in ("stall", "stall_leap", "stall_at", "stall_length")}
    moves = np.flatnonzero(size)
    before = np.maximum(np.concatenate([[-1], moves[:-1]])[: len(moves)], starts[run[moves]])
    rest = moves - before - 1
    leaps = np.flatnonzero((rest >= _STILL) & (moves + _AFTER < len(size)))
    frames = moves[leaps]
    frames_after = frames[:, None] + 1 + np.arange(_AFTER)  # (n_leaps, 5)
    inside = run[frames_after[:, -1]] == run[frames] if len(frames) else np.zeros(0, dtype=bool)
    frames, rest, after = frames[inside], rest[leaps][inside], size[frames_after[inside]]
    ratio = size[frames] / np.maximum(after.max(axis=1, initial=0), 1e-300)
    ratio[(after > 0).sum(axis=1) < _AFTER - 1] = 0  # it does not go on: a switch
    order = np.argsort(ratio, kind="stable")  # the worst of each run is written last
    frames, where = frames[order], run[frames[order]]
    worst = ratio[order], size[frames], frames - starts[where], rest[order]
    for name, values in zip(found, worst, strict=True):
        found[name][where] = values
    return found


def _repeated(moving: Bools, starts: Ints) -> Floats:
    moving[starts] = False
    between = np.zeros(len(moving))
    between[1:-1] = ~moving[1:-1] & moving[:-2] & moving[2:]
    between[starts] = 0
    repeated: Floats = np.add.reduceat(between, starts)
    return repeated


def _marks(values: Array, starts: Ints, fps: float) -> Floats:
    stops = np.append(starts[1:], len(values))
    rows = starts[:, None] + max(1, round(_MARK_EVERY * fps)) * np.arange(_MARKS)  # (n_runs, 12)
    marks = values[np.minimum(rows, len(values) - 1)].astype(np.float64)  # (n_runs, 12, size)
    marks[rows >= stops[:, None]] = np.nan
    flat: Floats = marks.reshape(len(starts), -1)
    return flat
