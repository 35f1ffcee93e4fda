"""The hunt of `08_your_dataset`: keep it, mend it, or throw it away?"""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np
from numpy.typing import NDArray

from z2r.arrays import Floats
from z2r.course.hunts import arm
from z2r.course.hunts._core import SEED, Trial, judge, one_of, rng_of, shuffled
from z2r.course.hunts._frames import COMMAND, Frames

KEEP, MEND, THROW_AWAY = DECISIONS = ("keep", "mend", "throw away")
"""What the learner's function may answer: mend is for what can be undone without loss."""

_NUMBER = 8
_HEIGHT, _WIDTH = 12, 16  # pixels
_LATE = (6, 10)  # frames: a command that is stored so much later than it was given
_STUCK = 25  # frames for which encoders tell the same
_JITTER = 0.02  # degrees and percent
_UNLIKE = arm.JOINTS[1:4]  # pan and roll do nearly the same

type _Pictures = NDArray[np.uint8]


_PICTURES = "pictures"

type _Change = Callable[[np.random.Generator, Frames], Frames]


def score(decide: Callable[..., Any], seed: int = SEED) -> None:
    """Score a function that decides what to do with a recording.

    Parameters
    ----------
    decide : callable
        The learner's: takes the action and the state of an arm, float64[n_frames, 6], joints of the same names in
        degrees, and what its camera saw, uint8[n_frames, 12, 16], 30 frames a second; returns one of `DECISIONS`.
    seed : int, optional
        Of the recordings.
    """
    hint = "A joint follows its command, and a camera sees the arm move. Can you compute what it should have been?"
    expected = "one of " + ", ".join(map(repr, DECISIONS))
    judge(decide, _trials(rng_of(_NUMBER, seed)), one_of(DECISIONS, KEEP), expected, hint)


def examples() -> list[Trial]:
    """Return some recordings: ``action, state, pictures = examples()[0].args``; ``truth`` is what to decide."""
    return _trials(rng_of(_NUMBER))


def _trials(rng: np.random.Generator) -> list[Trial]:
    return shuffled(rng, _recordings(rng))


def _recordings(rng: np.random.Generator) -> Iterator[Trial]:
    kinds: list[tuple[str, str, int, _Change]] = [
        (KEEP, "nothing is wrong", 2, lambda rng, it: it),
        (KEEP, "the arm waits for a second, and so does the picture", 2, _wait),
        (KEEP, "a dark room", 1, lambda rng, it: it | {_PICTURES: it[_PICTURES] // 3}),
        (KEEP, "an arm that follows a little later than others", 1, lambda rng, it: arm.later(it, COMMAND, -2)),
        (MEND, "a joint is in radians", 2, lambda rng, it: arm.in_radians(it, rng.choice(arm.JOINTS))),
        (MEND, "the command is stored late", 2, lambda rng, it: arm.later(it, COMMAND, _between(rng, *_LATE))),
        (MEND, "two joints are exchanged", 1, lambda rng, it: arm.exchanged(it, *rng.choice(_UNLIKE, 2, False))),
        (MEND, "a joint has the other sign", 1, _negative),
        (THROW_AWAY, "the camera is black", 2, _black),
        (THROW_AWAY, "the camera shows one picture", 1, lambda rng, it: _frozen(it, 0)),
        (THROW_AWAY, "the camera stops on the way", 2, lambda rng, it: _frozen(it, _between(rng, 40, 60))),
        (THROW_AWAY, "all encoders stop for a while", 2, lambda rng, it: arm.stuck(it, _between(rng, 20, 40), _STUCK)),
        (THROW_AWAY, "the commands are out of order", 2, _out_of_order),
    ]
    for truth, what, n, change in kinds:
        for number in rng.choice(arm.PLACED, n, replace=False).tolist():
            frames = change(rng, _recorded(rng, number))
            yield Trial(what, (arm.commands(frames), arm.joints(frames), frames[_PICTURES]), truth)


def _recorded(rng: np.random.Generator, number: int) -> Frames:
    """Record an episode again: encoders are never twice the same."""
    frames = arm.episode(number)
    for joint in (*arm.JOINTS, arm.JAWS):
        frames[joint] += rng.normal(0, _JITTER, len(frames[joint]))
    return frames | {_PICTURES: _seen_by_camera(arm.joints(frames))}


def _between(rng: np.random.Generator, low: int, high: int) -> int:
    return int(rng.integers(low, high))


def _seen_by_camera(state: Floats) -> _Pictures:
    """Draw a bright arm on a table with a pattern: a spot whose place and width are those of the joints."""
    rows, columns = np.mgrid[:_HEIGHT, :_WIDTH]
    table = 60 + 30 * ((rows // 3 + columns // 4) % 2)
    pan, lift, elbow, wrist, _, jaws = state.T[:, :, None, None]
    across, up = _WIDTH / 2 + pan / 6, _HEIGHT / 2 + (lift - elbow) / 16 + (wrist - 80) / 8
    spot = 160 * np.exp(-(np.square(columns - across) + np.square(rows - up)) / (3 + jaws / 10))
    pictures: _Pictures = np.clip(table + spot, 0, 255).astype(np.uint8)
    return pictures


def _wait(rng: np.random.Generator, it: Frames) -> Frames:
    """Stay for a second, at the beginning or at the end, and be told to."""
    here = 0 if rng.random() < 0.5 else len(it[arm.JAWS]) - 1
    rows = np.insert(np.arange(len(it[arm.JAWS])), here, np.full(29, here))
    longer, still = {name: values[rows] for name, values in it.items()}, slice(here, here + 30)
    for joint in (*arm.JOINTS, arm.JAWS):
        longer[COMMAND + joint][still] = longer[joint][still]
    return longer


def _negative(rng: np.random.Generator, it: Frames) -> Frames:
    joint = rng.choice(arm.JOINTS)
    return it | {joint: -it[joint]}


def _black(rng: np.random.Generator, it: Frames) -> Frames:
    return it | {_PICTURES: rng.integers(0, 4, it[_PICTURES].shape, dtype=np.uint8)}


def _frozen(it: Frames, first: int) -> Frames:
    rows = np.minimum(np.arange(len(it[_PICTURES])), first)
    return it | {_PICTURES: it[_PICTURES][rows]}


def _out_of_order(rng: np.random.Generator, it: Frames) -> Frames:
    """Store the commands of every half a second where those of another half a second belong."""
    rows = np.arange(len(it[arm.JAWS]))
    parts = np.array_split(rows, len(rows) // 15)
    order = np.concatenate([parts[place] for place in rng.permutation(len(parts))])
    return it | {COMMAND + joint: it[COMMAND + joint][order] for joint in (*arm.JOINTS, arm.JAWS)}
