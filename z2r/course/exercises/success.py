"""Exercises of `04_hidden_success`: how many reached the target?"""

from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from z2r.api import inspect_dataset, load
from z2r.arrays import Array, Floats
from z2r.course import figures
from z2r.course.exercises._core import NOT_ATTEMPTED, NOT_YET, RIGHT, Case, Question, judge_function, judge_prediction
from z2r.data import ARM, MESSY, STANDIN
from z2r.format.dataset import Dataset
from z2r.pusht.world import PUSHT
from z2r.reading.angles import decode_yaw, wrap_angle
from z2r.reading.decode import decode, named_columns
from z2r.reading.goal import Goal
from z2r.reading.poses import PoseColumns
from z2r.reading.reading import Reading
from z2r.reading.stored import episodes_named
from z2r.reading.success import FrameErrors, frame_errors, in_tolerance
from z2r.reading.verdict import read_verdict

_LOOSER_POS_TOL, _STRICTER_POS_TOL = 0.04, 0.01  # m
_GOAL_HINT = "What should be near what, and how near?"
_OTHER_TARGET = {"target_x": 0.1, "target_y": -0.05, "sin_target_yaw": 0.28, "cos_target_yaw": -0.96}

type _Frame = dict[str, float]


def check_looser(prediction: int | None, again: int | None = None) -> Figure | None:
    """Compare a prediction with how many episodes of `messy` are read as reached within 0.04 m instead of 0.03 m.

    Parameters
    ----------
    prediction : int or None
        Number of episodes.
    again : int, optional
        The answer to the second question, which is asked of whoever was wrong.

    Returns
    -------
    Figure or None
        Where the block ended in every episode, read with the looser tolerance; None as long as there is no prediction.
    """
    dataset, state = _read(MESSY)
    last = state[dataset.episodes.to_index - 1]
    looser, stricter = (PUSHT.with_goal("pos_err", within=limit) for limit in (_LOOSER_POS_TOL, _STRICTER_POS_TOL))
    before, after, with_stricter = (
        int(in_tolerance(frame_errors(decode(last, reading, dataset.schema)), reading).sum())
        for reading in (PUSHT, looser, stricter)
    )
    why = (
        f"Within {PUSHT.goal[0].within} m it is {before}. Not one frame has changed: a count belongs to its tolerances."
    )
    second = Question(
        with_stricter,
        "Of those that are near enough, all are turned by less than 0.2 rad.",
        f"And within {_STRICTER_POS_TOL} m?",
    )
    judge_prediction(prediction, after, why, second, again)
    return figures.final_poses(dataset, looser) if isinstance(prediction, int) else None


def check_frame_errors(function: Callable[..., Any]) -> None:
    """Try a function that measures how far the block is from the target.

    Parameters
    ----------
    function : callable
        The learner's: takes the columns of one frame by name, returns `pos_err` [m] and `ang_err` [rad].
    """

    def measure(frame: _Frame) -> Floats:
        pos_err, ang_err = function(frame)
        return np.array([float(pos_err), float(ang_err)])

    first = _frame(STANDIN, 0, 0)
    cases = [
        Case("the first frame of episode 0 of standin", (first,)),
        Case("the last frame of episode 0 of standin", (_frame(STANDIN, 0, -1),)),
        Case("the first frame of episode 4 of standin", (_frame(STANDIN, 4, 0),)),
        Case("the last frame of episode 4 of messy", (_frame(MESSY, 4, -1),)),
        Case("the first frame of episode 0 with another target", (first | _OTHER_TARGET,)),
    ]
    hint = "Both errors go from the block to the target. From where to where does each line measure?"
    judge_function(
        measure, _both_errors, cases, hint, untouched=_errors_as_handed_out, special_hint=_hint_about_the_angle
    )


def _hint_about_the_angle(got: Floats, expected: Floats) -> str | None:
    if got.shape != expected.shape or not np.isclose(got[0], expected[0]):
        return None
    if not np.isclose(abs(wrap_angle(got[1])), expected[1]):
        return None
    if abs(got[1]) <= np.pi:
        return "An error is never negative."
    return "Two directions are never more than pi apart: what has to be done to a difference of two angles?"


def check_episode_reached(function: Callable[..., Any]) -> Figure | None:
    """Try a function that says whether an episode reached the target.

    Parameters
    ----------
    function : callable
        The learner's: takes `pos_err` [m] and `ang_err` [rad] of all frames of an episode, returns a bool.

    Returns
    -------
    Figure or None
        The errors of the first episode that was judged wrong, and the tolerances.
    """

    def judge(pos_err: Floats, ang_err: Floats) -> object:
        answer = function(pos_err, ang_err)
        return answer if np.ndim(answer) == 0 else f"{np.size(answer)} values"

    solved = _errors(STANDIN, 0)
    trials = {
        "episode 0 of standin": solved,
        "episode 2 of messy": _errors(MESSY, 2),
        "episode 10 of messy": _errors(MESSY, 10),
        "episode 0 of standin played backwards": {name: values[::-1] for name, values in solved.items()},
        "episode 0 of standin with ang_err larger by 0.4 rad": solved | {"ang_err": solved["ang_err"] + 0.4},
    }
    cases = [Case(what, tuple(errors.values())) for what, errors in trials.items()]
    hint = "One frame decides, and both of its errors count"
    wrong = judge_function(judge, _reached, cases, f"{hint}: which frame, and how many tolerances are there?")
    if wrong is None:
        return None
    return figures.error_traces(dict(zip(solved, wrong.args, strict=True)), PUSHT, _read(STANDIN)[0].schema.fps)


def check_arm_goal(function: Callable[[], Any], poses: dict[str, PoseColumns]) -> None:
    """Compare what a learner's goal says of the arm with its verdict, episode by episode.

    Parameters
    ----------
    function : callable
        The learner's: returns a `z2r.Goal`.
    poses : dict of str to PoseColumns
        What the goal can name; columns are those of ``observation.environment_state``.
    """
    try:
        goal = function()
        if goal is None or goal is ...:
            print(f"{NOT_ATTEMPTED}: return a z2r.Goal from the function in this cell, then run the cell again.")
        else:
            print(_said_of_goal(goal, poses))
    except Exception as error:  # whatever the learner's code raises is an answer, not a crash
        print(f"{NOT_YET}: your function raised {type(error).__name__}: {error}. {_GOAL_HINT}")


def _said_of_goal(goal: object, poses: dict[str, PoseColumns]) -> str:
    if not isinstance(goal, Goal):
        return f"{NOT_YET}: your function returned {goal!r}, expected a z2r.Goal."
    if not all(isinstance(name, str) for name in goal.poses):
        return f"{NOT_YET}: found a pose itself in your goal, expected its name in quotes: {' or '.join(poses)}."
    arm, recording = load(ARM), read_verdict(ARM)
    reading = Reading(feature="observation.environment_state", poses=poses, goal=(goal,))
    if missing := reading.missing(arm.schema):
        return f"{NOT_YET}: found no column {', '.join(missing)}. One of another feature is observation.state/NAME."
    outcome = inspect_dataset(arm, reading=reading).outcome
    assert outcome is not None
    assert recording is not None
    success = np.array([episode.success for episode in recording.episodes])
    apart = {
        "reached it without success": outcome.reached & ~success,
        "did not reach it, and were a success": ~outcome.reached & success,
    }
    said = [f"{episodes_named(np.flatnonzero(each).tolist())} {what}" for what, each in apart.items() if each.any()]
    if said:
        return f"{NOT_YET}: by your goal, {' and '.join(said)}. {_GOAL_HINT}"
    return f"{RIGHT}: reached and success agree in all {len(success)} episodes."


@cache
def _read(root: Path) -> tuple[Dataset, Array]:
    dataset = load(root)
    return dataset, dataset.read(PUSHT.feature)


def _errors(root: Path, episode: int) -> FrameErrors:
    dataset, state = _read(root)
    return frame_errors(decode(state[dataset.episodes[episode]], PUSHT, dataset.schema))


def _frame(root: Path, episode: int, number: int) -> _Frame:
    """Return one frame of an episode, its columns by name."""
    dataset, state = _read(root)
    columns = named_columns(state[dataset.episodes[episode]], PUSHT, dataset.schema)
    return {name: float(values[number]) for name, values in columns.items()}


def _both_errors(frame: _Frame) -> Floats:
    dataset, _ = _read(STANDIN)
    state = np.array([[frame[name] for name in dataset.schema.features[PUSHT.feature].dim_names]])
    return np.concatenate([*frame_errors(decode(state, PUSHT, dataset.schema)).values()])


def _errors_as_handed_out(frame: _Frame) -> Floats:
    distance = np.hypot(frame["tee_x"] - frame["pusher_x"], frame["tee_y"] - frame["pusher_y"])
    tee_yaw = decode_yaw(frame["sin_tee_yaw"], frame["cos_tee_yaw"])
    target_yaw = decode_yaw(frame["sin_target_yaw"], frame["cos_target_yaw"])
    return np.array([distance, np.abs(wrap_angle(tee_yaw - target_yaw))])


def _reached(pos_err: Floats, ang_err: Floats) -> bool:
    return bool(in_tolerance({"pos_err": pos_err, "ang_err": ang_err}, PUSHT)[-1])
