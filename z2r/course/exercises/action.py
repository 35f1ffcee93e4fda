"""Exercises of `06_what_is_an_action`: what is an action?"""

from collections.abc import Callable
from pathlib import Path

import numpy as np

from z2r.api import load
from z2r.arrays import Floats
from z2r.course.exercises._core import Case, Question, judge_function, judge_prediction
from z2r.data import ARM, STANDIN
from z2r.format.schema import ACTION, STATE

_AHEAD = 2  # frames, of `arm`


def predict_a_second(share: float | None, slope: float | None, again: float | None = None) -> None:
    """Judge what the learner expects of the pusher's fit, once its change is counted in a second.

    Parameters
    ----------
    share, slope : float or None
        How much of the action is explained, and the slope; None where nobody has predicted yet.
    again : float, optional
        The slope that is asked for of whoever was wrong.
    """
    action, state = _episode(STANDIN, 0)
    asked, change = action[:-1, 0], load(STANDIN).schema.fps * np.diff(state[:, 0])
    in_a_second = float(np.polyfit(change, asked, 1)[0])
    truth = round(float(np.corrcoef(asked, change)[0, 1] ** 2), 3), round(in_a_second, 2)
    why = (
        "Another unit stretches the whole picture and moves no dot off the line, so as much is explained as before. "
        "The same action over a change ten times as large is a slope ten times as small."
    )
    second = Question(
        round(in_a_second / 60, 4),
        "A minute has 60 times as much change as a second.",
        "And if the change is counted in a minute: what is the slope?",
    )
    judge_prediction(None if share is None or slope is None else (share, slope), truth, why, second, again)


def check_within(function: Callable[[Floats, Floats], object]) -> None:
    """Try a function that says how far the action is from the line, in 99 of 100 frames.

    Parameters
    ----------
    function : callable
        The learner's: takes the action and what was seen, float64[n_frames] each; returns the distance in the unit of
        the action.
    """
    pushed, turned = _episode(STANDIN, 0), _episode(ARM, 5)
    cases = [
        Case("the elbow of arm, two frames ahead, in episode 5", _ahead(turned, 2)),
        Case("the wrist's flex of arm, in episode 5", _ahead(turned, 3)),
        Case("vx of standin and the change of x in a frame", (pushed[0][:-1, 0], np.diff(pushed[1][:, 0]))),
    ]
    hint = "What does the line say the action is, where `seen` was seen? The distance to that counts without its sign."
    judge_function(function, _within, cases, hint)


def check_driven_column(function: Callable[[Floats, Floats], object]) -> None:
    """Try a function that says which column of the state one dimension of the action drives.

    Parameters
    ----------
    function : callable
        The learner's: takes a dimension of the action, float64[n_frames], and the state some frames later,
        float64[n_frames, n_columns]; returns the number of the column.
    """
    action, state = _episode(ARM, 5)
    asked, seen = action[:-_AHEAD], state[_AHEAD:]
    turned = seen * [-1, 1, -1, 1, -1, 1]
    cases = [
        Case("the elbow of arm", (asked[:, 2], seen)),
        Case("its gripper, with the columns in the opposite order", (asked[:, 5], seen[:, ::-1])),
        Case("its elbow, in a state that counts it the other way round", (asked[:, 2], turned)),
        Case("its shoulder, in that state", (asked[:, 0], turned)),
    ]
    hint = "A joint that goes down whenever the action goes up follows it perfectly. What is its correlation?"
    judge_function(function, _driven_column, cases, hint, untouched=_driven_column_as_handed_out)


def _episode(root: Path, number: int) -> tuple[Floats, Floats]:
    dataset = load(root)
    part = dataset.episodes[number]
    return dataset.read(ACTION)[part].astype(np.float64), dataset.read(STATE)[part].astype(np.float64)


def _ahead(episode: tuple[Floats, Floats], joint: int) -> tuple[Floats, Floats]:
    action, state = episode
    return action[:-_AHEAD, joint], state[_AHEAD:, joint]


def _within(asked: Floats, seen: Floats) -> float:
    slope, offset = np.polyfit(seen, asked, 1)
    return float(np.quantile(np.abs(asked - slope * seen - offset), 0.99))


def _driven_column(action: Floats, state: Floats) -> int:
    return int(np.argmax(np.square(_likeness(action, state))))


def _driven_column_as_handed_out(action: Floats, state: Floats) -> int:
    return int(np.argmax(_likeness(action, state)))


def _likeness(action: Floats, state: Floats) -> list[float]:
    return [float(np.corrcoef(action, column)[0, 1]) for column in state.T]
