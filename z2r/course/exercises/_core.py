"""How an exercise answers. Three openings, nothing else: *not attempted yet*, *not yet*, *right*.

An exercise is never an error: an untouched one says so, and *Run All* goes on.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from z2r.arrays import Floats

NOT_ATTEMPTED = "not attempted yet"
NOT_YET = "not yet"
RIGHT = "right"


@dataclass(frozen=True)
class Case:
    """One trial of a learner's function.

    Attributes
    ----------
    what : str
        The trial in words, such as ``a yaw of 30 degrees``.
    args : tuple
        What the function is called with.
    """

    what: str
    args: tuple[Any, ...]


@dataclass(frozen=True)
class Question:
    """Something to predict.

    Attributes
    ----------
    truth : object
        What happens; floats are compared to within a percent.
    why : str
        The explanation, in a sentence or two: said with the answer, and only then.
    asks : str
        The question in words, where the page has not asked it.
    """

    truth: object
    why: str
    asks: str = ""


def judge_prediction(
    prediction: object, truth: object, why: str, second: Question | None = None, again: object = None
) -> None:
    """Compare a prediction with what happens, and only then say why; where it was wrong, ask another question.

    Parameters
    ----------
    prediction : object
        What the learner put in place of None.
    truth, why : object, str
        As for `Question`.
    second : Question, optional
        What is asked of whoever was wrong: with what they know now, they can be right.
    again : object, optional
        The learner's answer to that.
    """
    first = Question(truth, why)
    if again is None or second is None or _is_right(prediction, first):
        _judge(prediction, first)
        if second is not None and _was_judged(prediction, first) and not _is_right(prediction, first):
            print(f"Another one: {second.asks} Add your answer to the call, as again=..., and run the cell again.")
    else:
        _judge(again, second)


def _judge(prediction: object, question: Question) -> None:
    if prediction is None or prediction is ...:
        print(f"{NOT_ATTEMPTED}: put your prediction in place of {prediction}, then run the cell again.")
    elif _is_right(prediction, question):
        print(f"{RIGHT}: it is {question.truth}. {question.why}")
    elif _was_judged(prediction, question):
        print(f"{NOT_YET}: you said {prediction!r}, it is {question.truth}. {question.why}")
    else:
        print(f"{NOT_YET}: {prediction!r} is text. Write the number without the quotes.")


def _is_right(prediction: object, question: Question) -> bool:
    return _same(prediction, question.truth, rtol=0.01)


def _was_judged(prediction: object, question: Question) -> bool:
    """Whether there is a prediction, and it is not a number in quotes, which may be tried again."""
    if isinstance(prediction, str) and not isinstance(question.truth, str):
        try:
            float(prediction)
        except ValueError:
            return True
        return False
    return prediction is not None and prediction is not ...


def judge_function(
    function: Callable[..., Any],
    reference: Callable[..., Any],
    cases: Sequence[Case],
    hint: str,
    untouched: Callable[..., Any] | None = None,
    special_hint: Callable[[Floats, Floats], str | None] | None = None,
) -> Case | None:
    """Try a learner's function on every case, and say what was expected and what it gave.

    Parameters
    ----------
    function : callable
        The learner's.
    reference : callable
        The package's own.
    cases : sequence of Case
        More than the example on the page.
    hint : str
        Said where an answer is wrong: which way to look, not the solution.
    untouched : callable, optional
        The function as the page hands it out, where it runs but is wrong.
    special_hint : callable, optional
        Takes the first wrong answer and what was expected, and returns a hint about just that answer, or None.

    Returns
    -------
    Case or None
        The first case that went wrong, for a drawing; None where there is nothing to draw.
    """
    answers = _answers(function, cases)
    if answers and _is_untouched(answers, untouched, cases):
        print(f"{NOT_ATTEMPTED}: change the function in this cell, then run the cell again.")
        return None
    for case in cases:
        expected = reference(*case.args)
        try:
            got = function(*case.args)
        except Exception as error:  # whatever the learner's code raises is an answer, not a crash
            print(f"{NOT_YET}: for {case.what} your function raised {type(error).__name__}: {error}. {hint}")
            return None
        if not _same(got, expected):
            print(f"{NOT_YET}: for {case.what}, expected {_shown(expected)} and got {_shown(got)}.", end=" ")
            print(_hint_about(got, expected, hint, special_hint))
            if answers and all(_same(answer, got) for answer in answers):
                print(f"It answers the same in all {len(cases)} trials. Does it use what it is given?")
            return case
    print(f"{RIGHT}: all {len(cases)} trials agree with z2r.")
    return None


def _hint_about(
    got: object,
    expected: object,
    hint: str,
    special_hint: Callable[[Floats, Floats], str | None] | None,
) -> str:
    try:
        found, wanted = np.asarray(got, dtype=float), np.asarray(expected, dtype=float)
    except (TypeError, ValueError):
        return hint
    return (special_hint(found, wanted) if special_hint else None) or hint


def _answers(function: Callable[..., Any], cases: Sequence[Case]) -> list[Any]:
    """Return what a function answers in each trial, nothing where it raises."""
    try:
        return [function(*case.args) for case in cases]
    except Exception:  # it was changed, if not for the better
        return []


def _is_untouched(answers: Sequence[Any], untouched: Callable[..., Any] | None, cases: Sequence[Case]) -> bool:
    if untouched is None:
        return all(answer is ... or answer is None for answer in answers)
    return all(_same(answer, untouched(*case.args)) for answer, case in zip(answers, cases, strict=True))


def _same(got: object, expected: object, rtol: float = 1e-6) -> bool:
    if isinstance(expected, str | None) or isinstance(got, str):
        return isinstance(got, str | None) and got == expected
    try:
        found, wanted = np.asarray(got, dtype=float), np.asarray(expected, dtype=float)
    except (TypeError, ValueError):
        return False
    return found.shape == wanted.shape and bool(np.allclose(found, wanted, rtol=rtol, atol=1e-9))


def _shown(value: object) -> str:
    if isinstance(value, float | np.floating):
        return f"{round(float(value), 6) + 0.0:.4g}"  # + 0.0 makes 0 of -0
    if isinstance(value, tuple | list):
        return f"({', '.join(_shown(each) for each in value)})"
    if isinstance(value, np.ndarray) and value.ndim == 1 and len(value) <= 6:
        return _shown(value.tolist())
    if isinstance(value, np.ndarray):
        return np.array2string(value, precision=4, threshold=6)
    return f"{value}"
