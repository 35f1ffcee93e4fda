"""How does each column go from frame to frame? Summed up for each run of frames, so that no file stays in memory."""

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from z2r.arrays import Array, Bools, Floats, Ints, stack_columns
from z2r.audits.frames import RunStats
from z2r.format.schema import ACTION

_STILL = 6  # frames: a shorter rest tells nothing (`_stalls` looks for as many)
_AFTER = 5  # frames after a leap, with which it is compared
_MARKS = 12  # frames of a run, evenly from its start, which tell one demonstration from another
_TURNS, _A_TURN = (2 * np.pi, 360.0), 0.05  # rad and deg; of it: so much may come to it in one frame
_MARK_EVERY = 0.27  # s
_ALTERNATES = -0.4  # of the squares
_FEW = 8  # runs, at which to look one by one
_MIXERS = 2 * np.random.default_rng(0).integers(2**63, size=8, dtype=np.uint64) + 1  # odd
NO_SKETCH = np.iinfo(np.uint64).max


type Counts = NDArray[np.int32]


class RunSteps(NamedTuple):
    """The steps of one feature from one frame to the next: [n_runs, size] unless it says otherwise.

    Sizes are float64. Frames, and how many of them there are, are int32: a dataset may have a million episodes.

    Attributes
    ----------
    at, around : ndarray
        The frame of its run to which the largest step leads, and the larger one of the steps before and after it.
    path : ndarray
        The sum of the sizes of all steps.
    moves : ndarray
        How many frames differ from the one before.
    at_low, at_high : ndarray
        In how many frames it is at the lowest, and at the highest value of this file, bit for bit.
    noise : ndarray
        The sum of the sizes of the third differences: white noise of a standard deviation s gives 3.6 s a frame, smooth
        motion far less, and one leap counts as one.
    alternates : ndarray of bool
        Whether they go up and down as those of noise do: the products of each with the next sum up to less than -0.4 of
        their squares. Those of white noise come to -0.75, and those of motion to more than 0.
    stall, stall_leap, stall_at, stall_length : ndarray
        How many times as far as in the frames thereafter a column leaps after a rest, while it goes on moving; how far;
        the frame to which it leaps; and how many frames it rested.
    repeated : ndarray, [n_runs, 1]
        How many frames repeat the one before, in all columns, between two that do not.
    marks : ndarray, float32 or float64[n_runs, 12 * size], or None
        Some frames, a quarter of a second apart: what tells a demonstration from another. NaN beyond its end. Of the
        state, and of nothing else.
    sketch : ndarray, uint64[n_runs, 8], or None
        The least of eight hashes of its frames, each with the one before, in which at least half as many columns move
        as do at most: two runs have as many of them in common as frames, wherever these begin (Broder, "On the
        resemblance and containment of documents", 1997). `NO_SKETCH` where there is no such frame. Of the state only.
    """

    at: Counts
    around: Floats
    path: Floats
    moves: Counts
    at_low: Counts
    at_high: Counts
    noise: Floats
    alternates: Bools
    stall: Floats
    stall_leap: Floats
    stall_at: Counts
    stall_length: Counts
    repeated: Counts
    marks: Floats | None
    sketch: NDArray[np.uint64] | None


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


def run_sums(values: Array, starts: Ints, fps: float | None = None) -> tuple[RunStats, RunSteps]:
    """Sum up one feature for each run; a run begins at each of `starts` and ends where the next begins.

    Parameters
    ----------
    values : ndarray, (n_rows, size)
        All finite; there is at least one row.
    starts : ndarray, int64[n_runs]
        The first of them is 0.
    fps : float, optional
        Frames per second, by which `RunSteps.marks` are chosen; neither they nor a sketch are kept unless it is given.
    """
    count = np.diff(starts, append=len(values))
    n_moving, prints = np.zeros(len(values), dtype=np.int16), np.zeros(len(values), dtype=np.uint64)
    stats, steps = [], []
    room = np.empty((5, len(values)))  # once for all columns: to get memory anew for each takes longer than to use it
    numbers, change, size, spare = *room[:3], room[3:]
    # Of a run, where a third difference would reach into the run before.
    begins = np.minimum(starts[:, None] + np.arange(3), len(values) - 1).ravel()
    # One column after another: numpy reduces adjacent numbers many times faster, and what is at hand stays in a cache.
    for column in values.T:
        numbers[:] = column
        if fps is not None:
            prints *= _MIXERS[0]
            prints += np.add(numbers, 0.0, out=spare[0]).view(np.uint64)  # of 0 there are two, which differ in a bit
        if (numbers == numbers[0]).all():  # a target that rests, a gripper that nobody used
            of_stats, of_steps = _still_column(numbers[starts], count)
        else:
            change_in_runs(numbers, starts, change)
            moving = np.abs(change, out=size) > 0
            n_moving += moving
            of_stats = _column_stats(numbers, change, size, starts, count, spare)
            of_steps = _column_steps(numbers, change, size, moving, of_stats, starts, count, begins, spare)
        stats.append(of_stats)
        steps.append(of_steps)
    return (
        RunStats(n=count.astype(np.float64), **_stacked(stats)),
        RunSteps(
            **_stacked(steps),
            repeated=_repeated(n_moving > 0, starts)[:, None],
            marks=None if fps is None else _marks(values, starts, fps),
            sketch=None if fps is None else _sketch(prints, n_moving, starts),
        ),
    )


def change_in_runs(values: Floats, starts: Ints, out: Floats | None = None) -> Floats:
    """Return the change from the frame before, 0 in the first of each run: float64[n_rows]."""
    change = np.empty(len(values)) if out is None else out
    np.subtract(values[1:], values[:-1], out=change[1:])
    change[starts] = 0
    return change


def count_in_runs(those: Bools, starts: Ints) -> Counts:
    """Count in each run the rows that are so: int32[n_runs]."""
    n: Counts = np.add.reduceat(those.view(np.uint8), starts, dtype=np.int32)
    return n


def run_of(rows: Ints, starts: Ints) -> Ints:
    """Return the run that each of some rows is in, int64[n]."""
    return np.searchsorted(starts, rows, side="right") - 1


def _stacked(columns: Sequence[dict[str, Any]]) -> dict[str, Any]:
    return {name: stack_columns([column[name] for column in columns]) for name in columns[0]}


def _still_column(value: Floats, count: Ints) -> tuple[dict[str, Floats], dict[str, Any]]:
    """Sum up a column that never changes: in each run it has this value, and nothing happens."""
    nothing, never = np.zeros(len(count)), np.zeros(len(count), np.int32)
    stats = dict.fromkeys(("low", "high", "mean"), value) | dict.fromkeys(("squares", "step", "spike"), nothing)
    steps: dict[str, Any] = dict.fromkeys(("around", "path", "noise", "stall", "stall_leap"), nothing)
    steps |= dict.fromkeys(("at", "moves", "stall_at", "stall_length"), never)
    steps |= dict.fromkeys(("at_low", "at_high"), count.astype(np.int32))
    return stats, steps | {"alternates": never > 0}


def _column_stats(
    values: Floats, change: Floats, size: Floats, starts: Ints, count: Ints, spare: Floats
) -> dict[str, Floats]:
    """Sum up a column for `RunStats`; `spare`, (2, n_rows), is memory that is written over."""
    low, high = np.minimum.reduceat(values, starts), np.maximum.reduceat(values, starts)
    mean = np.add.reduceat(values, starts) / count
    mean = np.minimum(np.maximum(mean, low), high)  # of one and the same value, that value
    back, falls = spare[0], np.signbit(change)  # how far it goes back at once from where it went
    np.minimum(size[:-1], size[1:], out=back[:-1])
    back[:-1] *= falls[:-1] != falls[1:]
    back[-1] = 0
    off = np.subtract(values, np.repeat(mean, count), out=spare[1])
    return {
        "low": low,
        "high": high,
        "mean": mean,
        "squares": np.add.reduceat(np.square(off, out=off), starts),
        "step": np.maximum.reduceat(size, starts),
        "spike": np.maximum.reduceat(back, starts),
    }


def _column_steps(
    values: Floats,
    change: Floats,
    size: Floats,
    moving: Bools,
    stats: dict[str, Floats],
    starts: Ints,
    count: Ints,
    begins: Ints,
    spare: Floats,
) -> dict[str, Any]:
    """Sum up a column for `RunSteps`; `spare`, (2, n_rows), is memory that is written over."""
    at, around = np.zeros(len(starts), np.int32), np.zeros(len(starts))
    largest = moving & (size == np.repeat(stats["step"], count))
    hits = np.flatnonzero(largest)[::-1]  # the first of each run is written last
    run = run_of(hits, starts)
    at[run] = hits - starts[run]
    next_one = np.minimum(hits + 1, len(size) - 1)
    after = np.where(next_one > hits, size[next_one], 0)
    around[run] = np.maximum(size[np.maximum(hits - 1, 0)], after)  # 0 where a run begins
    second, third = spare
    np.subtract(change[1:], change[:-1], out=second[1:])
    np.subtract(second[3:], second[2:-1], out=third[3:])
    third[begins] = 0
    made = second  # which is written over
    squares = np.add.reduceat(np.square(third, out=made), starts)
    return {
        "at": at,
        "around": around,
        "path": np.add.reduceat(size, starts),
        "moves": count_in_runs(moving, starts),
        "at_low": _count_at(values, stats["low"], stats["low"].min(), starts, count),
        "at_high": _count_at(values, stats["high"], stats["high"].max(), starts, count),
        "noise": np.add.reduceat(np.abs(third, out=made), starts),
        "alternates": np.add.reduceat(_times_the_next(third, made), starts) < _ALTERNATES * squares,
        **_stalls(size, moving, starts, count),
    }


def _count_at(values: Floats, ends: Floats, end: float, starts: Ints, count: Ints) -> Counts:
    """Count the frames at an end of the range, in the runs that come to it: few, but for a limit or a gripper."""
    runs = np.flatnonzero(ends == end)
    if len(runs) > _FEW:
        return count_in_runs(values == end, starts)
    n = np.zeros(len(starts), dtype=np.int32)
    for run in runs:
        n[run] = np.count_nonzero(values[starts[run] : starts[run] + count[run]] == end)
    return n


def _times_the_next(values: Floats, out: Floats) -> Floats:
    np.multiply(values[:-1], values[1:], out=out[:-1])
    out[-1] = 0
    return out


def _stalls(size: Floats, moving: Bools, starts: Ints, count: Ints) -> dict[str, Any]:
    """Find the worst leap after a rest in each run, by how far it goes compared with the largest step soon after it."""
    sizes, frames_of = ("stall", "stall_leap"), ("stall_at", "stall_length")
    found: dict[str, Any] = {name: np.zeros(len(starts)) for name in sizes}
    found |= {name: np.zeros(len(starts), np.int32) for name in frames_of}
    ends = moving.copy()
    ends[starts] = True  # a rest ends where something moves, or the run does
    still = ~ends
    two = still[:-1] & still[1:]
    six = two[:-4] & two[2:-2] & two[4:]  # _STILL in a row, from each on
    frames = np.flatnonzero(six[:-1] & moving[_STILL:]) + _STILL
    if not len(frames):  # as in most
        return found
    run = run_of(frames, starts)
    whole = frames + _AFTER < (starts + count)[run]
    frames, run = frames[whole], run[whole]
    after = size[frames + 1 + np.arange(_AFTER)[:, None]]  # (5, n_leaps)
    ratio = size[frames] / np.maximum(after.max(axis=0), 1e-300)
    goes_on = (after > 0).sum(axis=0) >= _AFTER - 1  # else it is a switch
    frames, run, ratio = frames[goes_on], run[goes_on], ratio[goes_on]
    worst = np.full(len(starts), -1)
    order = np.argsort(ratio, kind="stable")  # the worst of each run is written last
    worst[run[order]] = order
    at = worst[worst >= 0]
    frames, run, marks = frames[at], run[at], np.flatnonzero(ends)
    rest = frames - 1 - marks[np.searchsorted(marks, frames) - 1]
    for name, values in zip(found, (ratio[at], size[frames], frames - starts[run], rest), strict=True):
        found[name][run] = values
    return found


def _repeated(moving: Bools, starts: Ints) -> Counts:
    between = np.zeros(len(moving), dtype=bool)
    between[1:-1] = ~moving[1:-1] & moving[:-2] & moving[2:]
    between[starts] = False
    return count_in_runs(between, starts)


def _sketch(prints: NDArray[np.uint64], n_moving: NDArray[np.int16], starts: Ints) -> NDArray[np.uint64]:
    half = np.maximum(1, (np.maximum.reduceat(n_moving, starts) + 1) // 2)
    told = n_moving >= np.repeat(half, np.diff(starts, append=len(n_moving)))
    told[starts] = False
    n, frames = count_in_runs(told, starts), np.flatnonzero(told)
    has = n > 0
    sketch = np.full((len(starts), len(_MIXERS)), NO_SKETCH)
    if not has.any():
        return sketch
    begins = (np.cumsum(n) - n)[has]
    both = prints[frames] * _MIXERS[1] + prints[frames - 1]
    both ^= both >> np.uint64(31)
    sketch[has] = np.stack([np.minimum.reduceat(both * mixer, begins) for mixer in _MIXERS], axis=1)
    return sketch


def _marks(values: Array, starts: Ints, fps: float) -> Floats:
    stops = np.append(starts[1:], len(values))
    rows = starts[:, None] + max(1, round(_MARK_EVERY * fps)) * np.arange(_MARKS)  # (n_runs, 12)
    marks = np.empty((*rows.shape, values.shape[1]), np.result_type(values, np.float32))  # (n_runs, 12, size)
    there = np.minimum(rows, len(values) - 1)
    for place, column in enumerate(values.T):
        marks[..., place] = column[there]
    marks[rows >= stops[:, None]] = np.nan
    flat: Floats = marks.reshape(len(starts), -1)
    return flat
