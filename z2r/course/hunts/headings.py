"""The hunt of `03_atan2_decoding`: a column has no name. Is it a heading, and how is it stored?"""

from collections.abc import Callable, Iterator
from typing import Any, NamedTuple

import numpy as np

from z2r.arrays import Floats
from z2r.course.hunts._core import SEED, Trial, judge, one_of, rng_of, shuffled
from z2r.reading.angles import wrap_angle, yaw_quaternions

ENCODINGS = ("degrees", "radians", "sin cos", "cos sin", "x y z w", "w x y z", "no heading")
"""What the learner's function may answer."""

_NUMBER = 3
_FPS = 10


class _Drive(NamedTuple):
    """What a cart did: where it was [m], (n_frames,), and where it pointed [rad], counted on over whole turns."""

    x: Floats
    y: Floats
    yaw: Floats


def score(encoding: Callable[..., Any], seed: int = SEED) -> None:
    """Score a function that says how a heading is stored.

    Parameters
    ----------
    encoding : callable
        The learner's: takes where a cart was, x and y [m], float64[n_frames], and columns without names,
        float64[n_frames, 1, 2 or 4]; returns one of `ENCODINGS`.
    seed : int, optional
        Of the carts.
    """
    hint = "A cart drives where it points. Decode the columns in every way there is, and ask the wheels."
    expected = "one of " + ", ".join(map(repr, ENCODINGS))
    judge(encoding, _trials(rng_of(_NUMBER, seed)), one_of(ENCODINGS, "no heading"), expected, hint)


def examples() -> list[Trial]:
    """Return some carts to look at: ``x, y, columns = examples()[0].args``; ``truth`` is how the heading is stored."""
    return _trials(rng_of(_NUMBER))


def _trials(rng: np.random.Generator) -> list[Trial]:
    return shuffled(rng, (Trial(what, (x, y, columns), truth) for what, (x, y, columns), truth in _carts(rng)))


def _carts(rng: np.random.Generator) -> Iterator[tuple[str, tuple[Floats, Floats, Floats], str]]:
    """Three of every encoding; some of them look like another one at first."""
    slow, round_and_round, once_round = (0.0, 0.02), (0.15, 0.1), (0.0, 0.25)

    def cart(what: str, turning: tuple[float, float], encode: Callable[[Floats], Floats], truth: str) -> Any:
        drive = _drive(rng, *turning)
        columns = encode(drive.yaw)
        return what, (drive.x, drive.y, columns if columns.ndim == 2 else columns[:, np.newaxis]), truth

    yield cart("degrees", once_round, lambda yaw: np.rad2deg(wrap_angle(yaw)), "degrees")
    yield cart("degrees of a cart that hardly turns", slow, lambda yaw: np.rad2deg(wrap_angle(yaw)), "degrees")
    yield cart("degrees from 0 to 360", once_round, lambda yaw: np.rad2deg(yaw) % 360, "degrees")
    yield cart("radians", once_round, wrap_angle, "radians")
    yield cart("radians that count on over many turns", round_and_round, lambda yaw: yaw + 40 * np.pi, "radians")
    yield cart("radians from 0 to 2 pi", once_round, lambda yaw: yaw % (2 * np.pi), "radians")
    for turning in (slow, once_round, round_and_round):
        yield cart("sine and cosine", turning, lambda yaw: np.stack([np.sin(yaw), np.cos(yaw)], 1), "sin cos")
        yield cart("cosine and sine", turning, lambda yaw: np.stack([np.cos(yaw), np.sin(yaw)], 1), "cos sin")
        yield cart("a quaternion, x y z w", turning, _quaternion, "x y z w")
        yield cart("a quaternion, w x y z", turning, lambda yaw: np.roll(_quaternion(yaw), 1, axis=1), "w x y z")
    other = _drive(rng, *once_round).yaw
    yield cart("the angle of a mast that turns by itself", once_round, lambda _: np.rad2deg(other) % 360, "no heading")
    other_yaw = _drive(rng, *round_and_round).yaw
    pair = np.stack([np.sin(other_yaw), np.cos(other_yaw)], axis=1)
    yield cart("sine and cosine of a mast that turns by itself", once_round, lambda _: pair, "no heading")
    yield cart(
        "how much charge the battery has",
        once_round,
        lambda yaw: 98 - 0.06 * np.arange(len(yaw), dtype=np.float64),
        "no heading",
    )


def _quaternion(yaw: Floats) -> Floats:
    quaternions: Floats = yaw_quaternions(yaw)
    return quaternions


def _drive(rng: np.random.Generator, turn: float, spread: float) -> _Drive:
    """Drive for 12 s at changing speeds, turning by so much in a frame [rad] and by chance; measure it, not quite."""
    n = 12 * _FPS
    turns = turn * rng.choice([-1, 1]) + spread * np.convolve(rng.normal(size=n + 20), np.ones(21) / 21, "valid")
    yaw = rng.uniform(-np.pi, np.pi) + np.cumsum(turns)
    step = rng.uniform(0.02, 0.06) * (1.2 + np.sin(np.linspace(0, rng.uniform(3, 9), n)))
    x, y = (np.cumsum(step * part) + rng.uniform(-5, 5) for part in (np.cos(yaw), np.sin(yaw)))
    return _Drive(x + rng.normal(0, 2e-4, n), y + rng.normal(0, 2e-4, n), yaw + rng.normal(0, 0.01, n))
