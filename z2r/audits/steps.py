"""How does each column go from frame to frame? Summed up for each run of frames, so that no file stays in memory."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from z2r.arrays import Array, Bools, Floats, Ints
from z2r.format.schema import ACTION

_STILL = 6  # frames: a shorter rest tells nothing
_AFTER = 5  # frames after a leap, with which it is compared
_MARKS = 12  # frames of a run, evenly from its start, which tell one demonstration from another
_MARK_EVERY = 8  # frames


class RunSteps(NamedTuple):
    """The steps of one feature from one frame to the next: float64[n_runs, size] unless it says otherwise.

    Attributes
    ----------
    largest, at : ndarray
        The largest step, and the frame of its run to which it leads.
    squares : ndarray
        The sum of the squares of all steps.
    noise, alternates : ndarray
        The sum of the squares of the third differences, and of the products of each with the next: white noise of a
        standard deviation s gives 20 s² a frame and -15 s² a frame, and smooth motion far less.
    stall, stall_at, stall_length : ndarray
        How many times as far as in the frames thereafter a column leaps after a rest, while it goes on moving; the
        frame to which it leaps; and how many frames it rested.
    repeated : ndarray, float64[n_runs, 1]
        How many frames repeat the one before, in all columns, between two that do not.
    marks : ndarray, float64[n_runs, 12 * size]
        Some frames, one in eight: what tells a demonstration from another. NaN beyond its end.
    """

    largest: Floats
    at: Floats
    squares: Floats
    noise: Floats
    alternates: Floats
    stall: Floats
    stall_at: Floats
    stall_length: Floats
    repeated: Floats
    marks: Floats


def moves(name: str) -> bool:
    """Tell whether a feature is what a robot was seen to do, or was told to do, by its name."""
    return name.startswith(("observation", ACTION))


def run_steps(values: Array, starts: Ints) -> RunSteps:
    """Sum up one feature for each run; a run begins at each of `starts` and ends where the next begins."""
    run = np.repeat(np.arange(len(starts)), np.diff(np.append(starts, len(values))))
    moving = np.zeros(len(values), dtype=bool)
    columns = []
    for column in values.T:
        steps = np.diff(column.astype(np.float64), prepend=0.0)
        steps[starts] = 0
        moving |= steps != 0
        columns.append(_column_steps(steps, run, starts))
    stacked = {name: np.stack([column[name] for column in columns], axis=1) for name in columns[0]}
    return RunSteps(**stacked, repeated=_repeated(moving, starts)[:, None], marks=_marks(values, starts))


def join_steps(parts: Sequence[RunSteps]) -> RunSteps:
    """Put the runs of all files after each other."""
    return RunSteps(*(np.concatenate(each) for each in zip(*parts, strict=True)))


def _column_steps(steps: Floats, run: Ints, starts: Ints) -> dict[str, Floats]:
    size = np.abs(steps)
    largest = np.maximum.reduceat(size, starts)
    at = np.zeros(len(starts))
    hits = np.flatnonzero(size == largest[run])[::-1]  # the first of each run is written last
    at[run[hits]] = hits - starts[run[hits]]
    third = np.zeros(len(steps))
    third[3:] = steps[3:] - 2 * steps[2:-1] + steps[1:-2]
    for place in range(3):
        third[np.minimum(starts + place, len(steps) - 1)] = 0  # which would reach into the run before
    stall, stall_at, stall_length = _stalls(size, run, starts)
    return {
        "largest": largest,
        "at": at,
        "squares": np.add.reduceat(np.square(steps), starts),
        "noise": np.add.reduceat(np.square(third), starts),
        "alternates": np.add.reduceat(third * np.append(third[1:], 0.0), starts),
        "stall": stall,
        "stall_at": stall_at,
        "stall_length": stall_length,
    }


def _stalls(size: Floats, run: Ints, starts: Ints) -> tuple[Floats, Floats, Floats]:
    """Find the worst leap after a rest in each run, by how far it goes compared with the largest step soon after it."""
    worst, at, length = np.zeros(len(starts)), np.zeros(len(starts)), np.zeros(len(starts))
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
    worst[where], at[where], length[where] = ratio[order], frames - starts[where], rest[order]
    return worst, at, length


def _repeated(moving: Bools, starts: Ints) -> Floats:
    between = np.zeros(len(moving))
    between[1:-1] = ~moving[1:-1] & moving[:-2] & moving[2:]
    between[starts] = 0
    repeated: Floats = np.add.reduceat(between, starts)
    return repeated


def _marks(values: Array, starts: Ints) -> Floats:
    stops = np.append(starts[1:], len(values))
    rows = starts[:, None] + _MARK_EVERY * np.arange(_MARKS)  # (n_runs, 12)
    marks = values[np.minimum(rows, len(values) - 1)].astype(np.float64)  # (n_runs, 12, size)
    marks[rows >= stops[:, None]] = np.nan
    return marks.reshape(len(starts), -1)
