"""The hunt of `02_episode_index`: the index is lost. Where did the episodes begin?"""

from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from z2r.arrays import Floats
from z2r.course.hunts._core import SEED, Marks, Trial, judge, rng_of
from z2r.course.hunts._frames import episodes_of, names_of, side_by_side
from z2r.data import ARM, MESSY, STANDIN
from z2r.format.schema import STATE

_NUMBER = 2
_LONG = 50  # frames: of a shorter episode nobody knows what is usual in it
_CLEAR = 4.0  # times as far as a column ever goes in a step: a seam that leaps less is not asked for
_DROP_OUT = 1.5  # of a column's range: how far off a single broken value is


def score(find_starts: Callable[..., Any], seed: int = SEED) -> None:
    """Score a function that finds where episodes begin.

    Parameters
    ----------
    find_starts : callable
        The learner's: takes the state of all frames of a recording, float64[n_frames, n], and returns the numbers of
        the frames with which an episode begins, but for the first episode.
    seed : int, optional
        Of the recordings.
    """
    hint = "A robot comes from somewhere. What is a long way for one column of one robot, and does it stay there?"
    expected = "a list of frame numbers"
    judge(find_starts, list(_trials(rng_of(_NUMBER, seed))), _mark, expected, hint)


def examples() -> list[Trial]:
    """Return some recordings to look at; ``args[0]`` is the state, and ``truth`` where episodes begin."""
    return list(_trials(rng_of(_NUMBER)))


def _mark(answer: Any, truth: list[int]) -> Marks | None:
    found = np.asarray(answer)
    if found.ndim != 1 or (found.size and found.dtype.kind not in "iu"):
        return None
    starts = {*found.tolist()} - {0}
    right = len(starts & {*truth})
    # An episode that nobody cut is one thing to get right, too: to say nothing about it.
    alone = int(not truth and not starts)
    return Marks(right + alone, len(truth) - right, len(starts) - right)


def _trials(rng: np.random.Generator) -> Iterator[Trial]:
    yield _recording("six demonstrations of pushing", _joined(rng, STANDIN, 6))
    yield _recording("pushing, in millimetres", _joined(rng, STANDIN, 5), np.repeat([1000.0, 1.0] * 2, [4, 2, 2, 2]))
    yield _recording("an unsteady pusher", _joined(rng, MESSY, 6))
    yield _recording("an arm, in degrees", _joined(rng, ARM, 6))
    yield _recording("an arm, in radians", _joined(rng, ARM, 5), np.deg2rad(1))
    parts = _joined(rng, ARM, 4)
    yield _recording("an arm whose encoder drops out twice, for a frame", parts, dropped=rng)
    yield _recording("one episode, in which an encoder drops out twice", _joined(rng, ARM, 1), dropped=rng)
    yield _recording("one episode, and nothing else", _joined(rng, MESSY, 1))


def _recording(
    what: str, parts: Sequence[Floats], factor: Any = 1.0, dropped: np.random.Generator | None = None
) -> Trial:
    """Lay episodes one after another, in another unit, and with broken values where there is chance to draw them."""
    starts = np.cumsum([len(part) for part in parts])[:-1]
    state = np.concatenate(parts) * factor
    if dropped is not None:
        inside = np.concatenate(
            [np.arange(6, len(part) - 6) + first for part, first in zip(parts, [0, *starts], strict=True)]
        )
        column = int(np.argmax(np.ptp(state, axis=0)))
        broken = [dropped.choice(third) for third in np.array_split(inside, 3)[::2]]
        state[broken, column] += _DROP_OUT * np.ptp(state[:, column])
    return Trial(what, (state,), starts.tolist())


def _joined(rng: np.random.Generator, root: Path, n: int) -> list[Floats]:
    """Draw episodes in an order in which every one begins clearly elsewhere than the one before it ended."""
    names = names_of(root)[STATE]
    seen = [side_by_side(frames, names) for frames in episodes_of(root)]
    episodes = [state for state in seen if len(state) >= _LONG]
    longest = np.max([np.abs(np.diff(each, axis=0)).max(axis=0) for each in episodes], axis=0)
    longest[longest == 0] = np.inf  # never moves
    while True:
        parts = [episodes[number] for number in rng.choice(len(episodes), n, replace=False)]
        leaps = [np.abs(after[0] - before[-1]) / longest for before, after in pairwise(parts)]
        if all(leap.max() > _CLEAR for leap in leaps):
            return parts
