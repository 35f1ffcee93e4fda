"""The hunt of `07_break_modes`: somebody believes something wrong about an arm, and there is no label to ask."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from z2r.course.hunts import arm
from z2r.course.hunts._core import SEED, Trial, judge, one_of, rng_of, shuffled
from z2r.course.hunts._frames import Frames

_NUMBER = 7
_AHEAD = 25  # frames: how far the clock of the cube is ahead of that of the jaws


def score(is_refuted: Callable[..., Any], seed: int = SEED) -> None:
    """Score a check that refutes wrong beliefs about an arm that moves a cube.

    Parameters
    ----------
    is_refuted : callable
        The learner's: takes the columns of an episode by the names that somebody believes they have, float64[n_frames]
        each; returns True where that cannot be, and False where it can.
    seed : int, optional
        Of the episodes.
    """
    hint = "What can a cube not do that nobody holds? What can a table not let through, and what never moves?"
    trials = _trials(rng_of(_NUMBER, seed))
    judge(is_refuted, trials, one_of((True, False), nothing=False), "True or False", hint)


def examples() -> list[Trial]:
    """Return some episodes to look at: ``(frames,) = examples()[0].args``; ``truth`` is True where they are misread."""
    return _trials(rng_of(_NUMBER))


def _trials(rng: np.random.Generator) -> list[Trial]:
    return shuffled(rng, _episodes(rng))


def _episodes(rng: np.random.Generator) -> Iterator[Trial]:
    for number in arm.NOT_PLACED + arm.NOT_LIFTED:
        yield _trial(rng, "right, and the task failed", number)
    for number in rng.choice(arm.PLACED, 5, replace=False).tolist():
        yield _trial(rng, "right, and the cube was placed", number)
    for number in rng.choice(arm.LIFTED, 2, replace=False).tolist():
        yield _trial(rng, "right, and the cube was lifted", number)
    for what, wrong in _BELIEFS.items():
        for numbers in (arm.PLACED, arm.LIFTED):
            yield _trial(rng, what, int(rng.choice(numbers)), wrong)


def _trial(rng: np.random.Generator, what: str, number: int, wrong: Callable[[Frames], Frames] | None = None) -> Trial:
    frames = arm.elsewhere(rng, arm.episode(number))
    return Trial(what, (wrong(frames) if wrong else frames,), wrong is not None)


_BELIEFS: dict[str, Callable[[Frames], Frames]] = {
    "the jaws taken for closed where they are open": arm.with_jaws_turned_round,
    "cube and goal taken for each other": arm.with_cube_for_goal,
    "up taken for down": arm.upside_down,
    "the cube's clock ahead of that of the jaws": lambda frames: arm.later(frames, "block", -_AHEAD),
    "millimetres taken for metres": arm.in_millimetres,
}
