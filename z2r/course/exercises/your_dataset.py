"""Exercises of `08_your_dataset`: is my data any good?"""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from z2r.api import inspect_dataset, load
from z2r.arrays import Array, Floats
from z2r.course.exercises._core import NOT_ATTEMPTED, NOT_YET, RIGHT, Case, Question, judge_function, judge_prediction
from z2r.data import ARM, MESSY
from z2r.errors import count
from z2r.format.schema import ACTION, STATE

_N = 10  # frames: how far the function of the bug hunt looks
_PLACE_HINT = "Is that a number of frames, or its place in the list of those that were tried?"


class _Recording(NamedTuple):
    """An episode of the arm, good or with something wrong."""

    what: str
    action: Floats
    state: Floats


def predict_reached(prediction: str | None, again: str | None = None) -> None:
    """Judge how many episodes the learner expects `z2r` to call reached, where no reading says what that is.

    Parameters
    ----------
    prediction, again : str or None
        ``13 of 13``, ``0 of 13`` or ``nothing``; None where there is no prediction yet.
    """
    outcome = inspect_dataset(ARM).outcome
    truth = "nothing" if outcome is None else outcome.tally
    why = "Nobody has said yet what counts as reached. A guess that looks like a number is worse than no number."
    second = Question(
        "nothing",
        "A reading finds its columns by their names, never by their places. Without the names it does not guess.",
        "The columns of standin, of which 6 of 6 reached, get other names. What does z2r say of it?",
    )
    judge_prediction(_plain(prediction), truth, why, second, _plain(again))


def _plain(answer: object) -> object:
    return answer.strip().lower() if isinstance(answer, str) else answer


def check_never_moves(function: Callable[[Array], object]) -> None:
    """Try a function that tells which dimensions of a feature have one and the same value in every frame.

    Parameters
    ----------
    function : callable
        The learner's: takes an array (n_frames, size of the feature), returns a bool for each dimension.
    """
    there_and_back = np.array([[0.0, 1.0, 5.0], [2.0, 1.0, 5.0], [0.0, 1.0, 4.999]])
    cases = [
        Case("the state of messy, in which the target rests", (load(MESSY).read(STATE),)),
        Case("the state of arm", (load(ARM).read(STATE),)),
        Case("three frames in which the first dimension goes and comes back", (there_and_back,)),
        Case("a single frame", (np.array([[1.0, 2.0]]),)),
        Case("1108 frames of a constant 0.1 in float32", (np.full((1108, 1), 0.1, np.float32),)),
    ]
    hint = "One answer for each column. A column rests if its smallest value is also its largest."
    judge_function(function, lambda values: values.min(axis=0) == values.max(axis=0), cases, hint)


def check_frames_ahead(function: Callable[[Floats, Floats], object]) -> None:
    """Try a function that says how many frames later a joint does what it was told.

    Parameters
    ----------
    function : callable
        The learner's: takes the command and the place of one joint, float64[n_frames] each; returns a number of frames,
        negative where the joint seems to be ahead of its command.
    """
    action, state = _episode(5)
    late, early = _held(action, 5), action[3:]
    cases = [
        Case("the elbow of arm", (action[:, 2], state[:, 2])),
        Case("the same, its commands stored five frames late", (late[:, 2], state[:, 2])),
        Case("its shoulder, the commands late", (late[:, 0], state[:, 0])),
        Case("its wrist, the commands three frames early", (early[:, 3], state[:-3, 3])),
    ]
    hint = "Which numbers of frames does it try? A command that is stored late comes after the motion."
    judge_function(
        function,
        _frames_ahead,
        cases,
        hint,
        untouched=_frames_ahead_as_handed_out,
        special_hint=lambda got, expected: _PLACE_HINT if got.shape == () and got - expected >= _N - 1 else None,
    )


def check_is_sane(function: Callable[[Floats, Floats], object]) -> None:
    """Try a fact about the arm on episodes that are good, and on others in which something is wrong.

    Parameters
    ----------
    function : callable
        The learner's: takes the action and the state of an episode, float64[n_frames, 6] each, in degrees and percent;
        returns whether the two go together.
    """
    good, bad = _recordings()
    try:
        said = [function(each.action.copy(), each.state.copy()) for each in (*good, *bad)]
    except Exception as error:  # whatever the learner's code raises is an answer, not a crash
        print(f"{NOT_YET}: your function raised {type(error).__name__}: {error}.")
        return
    if all(answer is ... or answer is None for answer in said):
        print(f"{NOT_ATTEMPTED}: put a fact in place of the three dots, then run the cell again.")
        return
    if not all(isinstance(answer, bool | np.bool_) for answer in said):
        print(f"{NOT_YET}: your function returned {said[0]!r}, expected True or False for the whole episode.")
        return
    alarms = [each for each, sane in zip(good, said, strict=False) if not sane]
    missed = [each.what for each, sane in zip(bad, said[len(good) :], strict=True) if sane]
    if alarms:
        found = f"{count(len(alarms), 'false alarm')} in {len(good)} good episodes, the first in {alarms[0].what}"
        print(f"{NOT_YET}: {found}. Its joints, but for the gripper, are up to")
        print(f"{_off(alarms[0]):.1f} degrees from where they were told to be, two frames before.")
    if missed:
        print(f"{NOT_YET}: {len(missed)} of {len(bad)} damaged ones pass for good: {', '.join(missed)}.")
    if not alarms and not missed:
        print(f"{RIGHT}: no false alarm in {len(good)} good episodes, and all {len(bad)} damaged ones found.")


def _off(recording: _Recording) -> float:
    """Return how far its joints are at most from their commands of two frames before, in degrees."""
    return float(np.abs(recording.action[:-2, :5] - recording.state[2:, :5]).max())


def _recordings() -> tuple[list[_Recording], list[_Recording]]:
    """Episodes of the arm that the page does not show: the good ones, and one for each mistake."""
    good = [_Recording(f"episode {number}", *_episode(number)) for number in (1, 3, 6, 8, 11, 12)]
    episodes = [_episode(number) for number in (2, 7, 5, 10, 9, 4)]
    stories: dict[str, Callable[[Floats, Floats], tuple[Floats, Floats]]] = {
        "commands five frames late": lambda action, state: (_held(action, 5), state),
        "an elbow in radians": lambda action, state: (action, _with(state, 2, np.deg2rad(state[:, 2]))),
        "two joints exchanged": lambda action, state: (action, state[:, [1, 0, 2, 3, 4, 5]]),
        "a follower 17 degrees beside its leader": lambda action, state: (action, _with(state, 0, state[:, 0] + 17)),
        "a motor mounted the other way round": lambda action, state: (action, _with(state, 0, -state[:, 0])),
        "a joint that hangs for two seconds": lambda action, state: (action, _with(state, 1, _hanging(state[:, 1]))),
    }
    return good, [_Recording(what, *harm(*own)) for (what, harm), own in zip(stories.items(), episodes, strict=True)]


def _with(state: Floats, joint: int, values: Floats) -> Floats:
    state = state.copy()
    state[:, joint] = values
    return state


def _hanging(values: Floats) -> Floats:
    values, start = values.copy(), int(np.argmax(np.abs(np.diff(values))))
    values[start : start + 60] = values[start]
    return values


def _held(action: Floats, by: int) -> Floats:
    held: Floats = action[np.maximum(np.arange(len(action)) - by, 0)]
    return held


def _episode(number: int) -> tuple[Floats, Floats]:
    arm = load(ARM)
    part = arm.episodes[number]
    return arm.read(ACTION)[part].astype(np.float64), arm.read(STATE)[part].astype(np.float64)


def _frames_ahead(action: Floats, state: Floats) -> int:
    return _best(action, state, range(1 - _N, _N))


def _frames_ahead_as_handed_out(action: Floats, state: Floats) -> int:
    return _best(action, state, range(_N))


def _best(action: Floats, state: Floats, tried: range) -> int:
    def share(ahead: int) -> Any:
        first, then = (state, action) if ahead < 0 else (action, state)
        return np.corrcoef(first[: len(first) - abs(ahead)], then[abs(ahead) :])[0, 1] ** 2

    return max(tried, key=share)
