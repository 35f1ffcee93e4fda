"""The hunt of `04_hidden_success`: what its owner wants of an arm is a sentence. Which episodes did it?"""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from z2r.course.hunts import arm
from z2r.course.hunts._core import SEED, Trial, judge, one_of, rng_of, shuffled
from z2r.course.hunts._frames import Frames

WITHIN = 0.03  # m, from the middle of the cube to the middle of its goal
LET_GO = 40.0  # percent: jaws that are wider hold no cube
CARRIED = 0.03  # m above its start: a cube that was pushed never is

_NUMBER = 4


def score(reached: Callable[..., Any], seed: int = SEED) -> None:
    """Score a function that says whether an episode of an arm did what its owner wants.

    Parameters
    ----------
    reached : callable
        The learner's: takes the columns of an episode by name, float64[n_frames] each, and its task, ``place`` or
        ``lift``; returns True or False.
    seed : int, optional
        Of the episodes.
    """
    hint = "Go through the owner's words one by one: which columns, which frame, seen from where?"
    judge(reached, _trials(rng_of(_NUMBER, seed)), one_of((True, False), nothing=False), "True or False", hint)


def examples() -> list[Trial]:
    """Return some episodes to look at: ``frames, task = examples()[0].args``; ``truth`` says whether it was reached."""
    return _trials(rng_of(_NUMBER))


def _trials(rng: np.random.Generator) -> list[Trial]:
    return shuffled(rng, [*_placing(rng), *_lifting(rng)])


def _placing(rng: np.random.Generator) -> Iterator[Trial]:
    def trial(what: str, frames: Frames, truth: bool) -> Trial:
        return Trial(f"place, {what}", (arm.elsewhere(rng, frames), "place"), truth)

    recorded = (arm.episode(number) for number in rng.permutation(arm.PLACED).tolist() * 2)
    for _ in range(3):
        yield trial("on the disc", next(recorded), True)
    for _ in range(2):
        yield trial("on the disc, and the arm is gone long since", _afterwards(next(recorded), 30), True)
        yield trial("near the rim of the disc", _beside(rng, next(recorded), 0.024), True)
        yield trial("beside the disc", _beside(rng, next(recorded), 0.042), False)
        yield trial("pushed there, never carried", _never_carried(next(recorded)), False)
        yield trial("on the disc, and still held", _still_held(next(recorded)), False)
    yield trial("on the disc, and knocked off again", _knocked_off(rng, next(recorded)), False)
    yield trial("dropped on the way", arm.episode(arm.NOT_PLACED[0]), False)


def _lifting(rng: np.random.Generator) -> Iterator[Trial]:
    def trial(what: str, frames: Frames, truth: bool) -> Trial:
        return Trial(f"lift, {what}", (arm.elsewhere(rng, frames), "lift"), truth)

    recorded = (arm.episode(number) for number in rng.permutation(arm.LIFTED).tolist() * 2)
    for _ in range(2):
        yield trial("in the ball", next(recorded), True)
    yield trial("near the rim of the ball", _beside(rng, next(recorded), 0.024), True)
    yield trial("beside the ball", _beside(rng, next(recorded), 0.042), False)
    yield trial("under the ball", _under(next(recorded)), False)
    for number in arm.NOT_LIFTED:
        yield trial(("beside the ball", "missed by the jaws")[number == arm.NOT_LIFTED[1]], arm.episode(number), False)


def _beside(rng: np.random.Generator, frames: Frames, distance: float) -> Frames:
    """Move the goal so that the cube ends at this distance from its middle [m], along x or along y."""
    along, across = rng.permutation(["x", "y"]).tolist()
    frames = _goal_where_it_ends(frames, across, 0.0)
    return _goal_where_it_ends(frames, along, distance * rng.choice([-1, 1]))


def _under(frames: Frames) -> Frames:
    for axis, above in (("x", 0.0), ("y", 0.0), ("z", 0.042)):
        frames = _goal_where_it_ends(frames, axis, above)
    return frames


def _goal_where_it_ends(frames: Frames, axis: str, beside: float) -> Frames:
    return frames | {f"goal_{axis}": np.full_like(frames[f"goal_{axis}"], frames[f"block_{axis}"][-1] + beside)}


def _never_carried(frames: Frames) -> Frames:
    return frames | {"block_z": np.minimum(frames["block_z"], frames["block_z"][0] + 0.004)}


def _still_held(frames: Frames) -> Frames:
    """End where the cube is above the disc, and the jaws are as wide as the cube."""
    gap = np.hypot(frames["block_x"] - frames["goal_x"], frames["block_y"] - frames["goal_y"])
    last = int(np.flatnonzero((gap < 0.9 * WITHIN) & (frames[arm.JAWS] < LET_GO - 5))[-1])
    return {name: values[: last + 1] for name, values in frames.items()}


def _afterwards(frames: Frames, n: int) -> Frames:
    """Go on for some frames, in which nothing moves and the jaws are wide open."""
    longer = {name: np.append(values, np.repeat(values[-1], n)) for name, values in frames.items()}
    return longer | {arm.JAWS: np.append(frames[arm.JAWS], np.full(n, 65.0))}


def _knocked_off(rng: np.random.Generator, frames: Frames) -> Frames:
    n, name = 20, f"block_{rng.choice(['x', 'y'])}"
    longer = _afterwards(frames, n)
    way = np.linspace(0, 0.08, n) * rng.choice([-1, 1])
    return longer | {name: longer[name] + np.append(np.zeros(len(frames[name])), way)}
