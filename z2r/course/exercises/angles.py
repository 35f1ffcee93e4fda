"""Exercises of `03_atan2_decoding`: which way is the block pointing?"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from z2r.arrays import Floats
from z2r.course import figures
from z2r.course.exercises._core import NOT_YET, Case, Question, judge_function, judge_prediction
from z2r.reading.angles import decode_yaw, wrap_angle, yaw_quaternions

_PREDICTED_YAW = 120  # degrees: a quarter turn and a reflection make different angles of it
_DECODED = (30, 150, -60, -165, 100)  # degrees: each quarter of the circle, and the first one where arcsin is right
_TURNED = (60, -90, 150, -165, 0)  # degrees
_TURNS = ((10, 40), (60, -50), (179, -179), (-170, 170), (100, -150), (200, -150))  # degrees

# Ways from a sine and a cosine to an angle that give two yaws the same answer.
_HALVES: tuple[Callable[[float, float], Any], ...] = (
    lambda sine, _: np.arcsin(sine),
    lambda _, cosine: np.arccos(cosine),
    lambda sine, cosine: np.arctan(sine / cosine),
)


def check_swap(prediction: float | None, again: float | None = None) -> Figure | None:
    """Compare a prediction with what the swapped arguments make of a yaw of 120 degrees.

    Parameters
    ----------
    prediction : float or None
        The angle that comes out [degrees], in (-180, 180].
    again : float, optional
        The answer to the second question, which is asked of whoever was wrong.

    Returns
    -------
    Figure or None
        The two directions on the circle; None as long as there is no prediction in that range.
    """
    sine, cosine = _stored(_PREDICTED_YAW)
    truth = round(float(np.rad2deg(decode_yaw(sin_yaw=cosine, cos_yaw=sine))), 6)
    if isinstance(prediction, int | float) and abs(prediction) > 180 and not (prediction - truth) % 360:
        print(f"{NOT_YET}: right direction, but write it between -180 and 180.")
        return None
    why = f"The swap makes 90 - yaw of every yaw, and 90 - {_PREDICTED_YAW} = {truth:.0f}."
    second = Question(
        -135.0,
        "90 + 135 = 225, which is -135: the mirror has two ends, and this is the other one.",
        "And a block at -135 degrees?",
    )
    judge_prediction(prediction, truth, why, second, again)
    return figures.yaw_circle(sine, cosine) if isinstance(prediction, int | float) else None


def check_decode(function: Callable[..., Any]) -> Figure | None:
    """Try a function that decodes a yaw.

    Parameters
    ----------
    function : callable
        The learner's: takes the sine and the cosine of a yaw, returns the yaw [rad] in [-pi, pi].

    Returns
    -------
    Figure or None
        The block as it is turned and as the answer has it, for the first yaw that was decoded wrong.
    """
    cases = [Case(f"a yaw of {degrees} degrees", _stored(degrees)) for degrees in _DECODED]
    in_degrees = _agree(function, lambda sine, cosine: np.rad2deg(decode_yaw(sine, cosine)), cases)
    hint = (
        "The answer is in radians. The sine is how far up the point is, the cosine how far to the right: "
        "which of the two does atan2 want first?"
    )
    if in_degrees:
        hint = "That looks like degrees. The answer is in radians."
    elif any(_agree(function, half, cases) for half in _HALVES):
        hint = "That loses half of the circle: two yaws get the same answer."
    wrong = judge_function(function, decode_yaw, cases, hint)
    if wrong is None or in_degrees:
        return None
    return _draw(float(decode_yaw(*wrong.args)), function(*wrong.args))


def check_turn(function: Callable[..., Any]) -> None:
    """Try a function that says how far apart two yaws are.

    Parameters
    ----------
    function : callable
        The learner's: takes two yaws [rad], returns the angle between them [rad] in [0, pi].
    """
    cases = [
        Case(f"the yaws {before} and {after} degrees", (float(np.deg2rad(before)), float(np.deg2rad(after))))
        for before, after in _TURNS
    ]
    hint = "Two directions are never more than pi apart. Which of the numbers has to be wrapped?"
    judge_function(
        function,
        _turn,
        cases,
        hint,
        untouched=_turn_as_handed_out,
        special_hint=lambda got, _: (
            "How far apart is never negative: wrap first, then abs." if got.ndim == 0 and got < 0 else None
        ),
    )


def check_quaternion(function: Callable[[float], object]) -> Figure | None:
    """Try a function that turns a yaw into a quaternion.

    Parameters
    ----------
    function : callable
        The learner's: takes a yaw [rad], returns the four numbers x, y, z, w.

    Returns
    -------
    Figure or None
        The block as it should be turned and as the viewer would draw it, for the first yaw that went wrong.
    """
    cases = [Case(f"a yaw of {degrees} degrees", (float(np.deg2rad(degrees)),)) for degrees in _TURNED]
    hint = "A quaternion does not hold the sine and the cosine of the yaw itself. Of which angle, then?"
    if _begins_with_w(function):
        hint = "The order is x, y, z, w. Which of these are 0, and at which end do they stand?"
    wrong = judge_function(function, _quaternion, cases, hint, untouched=_quaternion_as_handed_out)
    if wrong is None:
        return None
    (yaw,) = wrong.args
    try:
        _, _, z, w = np.asarray(function(yaw), dtype=float)
        return figures.two_poses((0.0, 0.0, yaw), (0.0, 0.0, float(2 * np.arctan2(z, w))))
    except (TypeError, ValueError):  # not four numbers: nothing to draw
        return None


def _agree(function: Callable[..., Any], other: Callable[..., Any], cases: Sequence[Case]) -> bool:
    """Whether two functions give the same number in every case."""
    try:
        return all(bool(np.isclose(function(*case.args), other(*case.args))) for case in cases)
    except Exception:  # judge_function says what was raised
        return False


def _stored(degrees: float) -> tuple[float, float]:
    """Return the sine and the cosine that a dataset stores for a yaw."""
    yaw = np.deg2rad(degrees)
    return float(np.sin(yaw)), float(np.cos(yaw))


def _turn(before: float, after: float) -> Floats:
    turn: Floats = np.abs(wrap_angle(after - before))
    return turn


def _turn_as_handed_out(before: float, after: float) -> Floats:
    turn: Floats = np.abs(wrap_angle(after) - wrap_angle(before))
    return turn


def _draw(expected: float, got: object) -> Figure | None:
    """Draw two yaws of a block at the origin; nothing where the answer is no angle."""
    try:
        return figures.two_poses((0.0, 0.0, expected), (0.0, 0.0, float(np.asarray(got, dtype=float))))
    except (TypeError, ValueError):
        return None


def _quaternion(yaw: float) -> Floats:
    quaternion: Floats = yaw_quaternions(np.array([yaw]))[0]
    return quaternion


def _begins_with_w(function: Callable[[float], object]) -> bool:
    try:
        numbers = np.asarray(function(1.0), dtype=float)
    except Exception:  # whatever the learner's code raises, the trials tell
        return False
    return numbers.shape == (4,) and bool(numbers[0]) and not numbers[1:3].any()


def _quaternion_as_handed_out(yaw: float) -> Floats:
    return np.array([0.0, 0.0, np.sin(yaw), np.cos(yaw)])
