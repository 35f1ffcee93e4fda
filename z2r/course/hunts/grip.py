"""The hunt of `05_rerun_replay`: when did the jaws close on something? The gripper knows, and nobody else is asked."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from z2r.arrays import Floats
from z2r.course.hunts._core import SEED, Marks, Trial, judge, rng_of, shuffled

_NUMBER = 5
_FPS = 30
_CLOSE = 4  # frames: so near to the moment is right
_LAG = 4  # frames from a command to the motion
_WIDE = 65.0  # percent
_TICK = 0.25  # percent: what an encoder can tell


def score(gripped: Callable[..., Any], seed: int = SEED) -> None:
    """Score a function that says when a gripper took hold of something.

    Parameters
    ----------
    gripped : callable
        The learner's: takes how far open the jaws were told to be and how far open they were, float64[n_frames] each,
        in percent, 30 frames a second; returns the number of the frame in which they first had something between them
        that they kept, or None where they never had.
    seed : int, optional
        Of the episodes.
    """
    hint = "Jaws that stop before the place where they are sent are held open. A command also takes time to arrive."
    judge(gripped, _trials(rng_of(_NUMBER, seed)), _mark, "the number of a frame, or None", hint)


def examples() -> list[Trial]:
    """Return some episodes to look at: ``told, seen = examples()[0].args``; ``truth`` is the frame, or None."""
    return _trials(rng_of(_NUMBER))


def _mark(answer: Any, truth: int | None) -> Marks | None:
    if answer is None:
        return Marks(right=1) if truth is None else Marks(missed=1)
    if isinstance(answer, bool) or not isinstance(answer, int | np.integer):
        return None
    if truth is None:
        return Marks(false=1)
    return Marks(right=1) if abs(answer - truth) <= _CLOSE else Marks(missed=1)


def _trials(rng: np.random.Generator) -> list[Trial]:
    return shuffled(rng, _episodes(rng))


def _episodes(rng: np.random.Generator) -> Iterator[Trial]:
    for _ in range(3):
        yield _episode(rng, "a cube", [rng.uniform(25, 40)])
        yield _episode(rng, "nothing between the jaws", [None])
    for _ in range(2):
        yield _episode(rng, "a thin thing", [rng.uniform(10, 14)])
        yield _episode(rng, "nothing in the first grasp, a cube in the second", [None, rng.uniform(25, 40)])
        yield _episode(rng, "a cube, with jaws that always stop a little too wide", [rng.uniform(25, 40)], bias=2.0)
        yield _episode(rng, "nothing, with jaws that always stop a little too wide", [None], bias=2.0)
        yield _episode(rng, "nothing, told to close half only", [None], low=45.0)
        yield _episode(rng, "something that slipped out at once", [rng.uniform(25, 40)], kept=6)


def _episode(
    rng: np.random.Generator,
    what: str,
    widths: list[float | None],
    low: float = 2.0,
    bias: float = 0.0,
    kept: int | None = None,
) -> Trial:
    """Open and close the jaws once for each width; where that is not None, something of that width is in between.

    Parameters
    ----------
    low : float
        How far they are told to close [percent].
    bias : float
        How much wider they always are than told [percent].
    kept : int or None
        For how many frames something stays between the jaws; None for as long as they are closed.
    """
    grasps = [_opened_and_closed(rng, low) for _ in widths]
    told = np.concatenate([np.full(int(rng.integers(10, 25)), low), *grasps])
    seen, truth, stop = _followed(told) + bias, None, len(told)
    for width, grasp in zip(reversed(widths), reversed(grasps), strict=True):
        start = stop - len(grasp)
        if width is not None:
            open_wide = start + int(np.argmax(seen[start:stop]))
            held = open_wide + int(np.argmax(seen[open_wide:stop] < width))
            seen[held : stop if kept is None else held + kept] = width
            truth = held if kept is None else None
        stop = start
    noisy = np.round((seen + rng.normal(0, 0.15, len(seen))) / _TICK) * _TICK
    return Trial(what, (told, noisy), truth)


def _opened_and_closed(rng: np.random.Generator, low: float) -> Floats:
    """Return how far open the jaws are told to be in one grasp."""
    opens, closes = rng.integers(10, 22, 2)
    waits, holds = rng.integers(15, 40, 2)
    ways = np.linspace(low, _WIDE, opens), np.full(waits, _WIDE), np.linspace(_WIDE, low, closes)
    return np.concatenate([*ways, np.full(holds + 15, low)])


def _followed(command: Floats) -> Floats:
    """Follow a command late, and then as a spring would: half of the rest in a frame."""
    late = np.concatenate([np.full(_LAG, command[0]), command[:-_LAG]])
    place: Floats = np.empty_like(late)
    now = late[0]
    for frame, wanted in enumerate(late):
        now += 0.5 * (wanted - now)
        place[frame] = now
    return place
