"""How does a hunt score a function that the learner wrote? On datasets that the page does not show, drawn from a seed.

The three openings are those of the exercises: *not attempted yet*, *not yet*, *right*. What was missed is named, and so
is what was taken for something that is not there. Nothing is ever raised.
"""

import copy
from collections import Counter
from collections.abc import Callable, Iterable, Sequence
from typing import Any, NamedTuple

import numpy as np

from z2r.course.exercises._core import NOT_ATTEMPTED, NOT_YET, RIGHT

SEED = 0  # of the datasets that count, unless the learner gives another
_NAMED = 4  # kinds of mistakes that are told at once


class Trial(NamedTuple):
    """One dataset of a hunt.

    Attributes
    ----------
    what : str
        What is special about it, such as ``the camera stood still``: told to who was wrong about it.
    args : tuple
        What the learner's function is called with.
    truth : object
        What a right answer is.
    """

    what: str
    args: tuple[Any, ...]
    truth: Any


class Marks(NamedTuple):
    """How many things an answer got right, and how many it missed, or saw where there are none."""

    right: int = 0
    missed: int = 0
    false: int = 0


type Mark = Callable[[Any, Any], Marks | None]
"""Holds an answer against the truth; None where the answer is none that could be right."""


def rng_of(number: int, seed: int | None = None) -> np.random.Generator:
    """Return the source of the datasets that count, by seed, or of those that the learner may look at.

    Parameters
    ----------
    number : int
        Of the notebook: two hunts draw differently from the same seed.
    seed : int or None
        None for the examples, which are drawn like the others, and are none of them.
    """
    return np.random.default_rng([number] if seed is None else [number, 1, seed])


def one_of(choices: Sequence[object], nothing: object = ...) -> Mark:
    """Return how an answer is marked that is one of some.

    Parameters
    ----------
    choices : sequence
        All answers that there are.
    nothing : object, optional
        The one that says that there is nothing to find: who says so by mistake missed something, and who says
        something else where it is right saw something that is not there.
    """

    def mark(answer: Any, truth: Any) -> Marks | None:
        plain = answer.item() if isinstance(answer, np.generic) else answer
        # 1 == True: a number is no answer to a question of yes or no
        if not any(type(plain) is type(choice) and plain == choice for choice in choices):
            return None
        if plain == truth:
            return Marks(right=1)
        return Marks(false=1) if truth == nothing else Marks(missed=1)

    return mark


def judge(function: Callable[..., Any], trials: Sequence[Trial], mark: Mark, expected: str, hint: str) -> None:
    """Call the learner's function with every dataset, and tell the score.

    Parameters
    ----------
    function : callable
        The learner's. One that returns three dots for every dataset has not been touched yet.
    trials : sequence of Trial
        They are not changed.
    mark : callable
        How an answer is held against the truth.
    expected : str
        What an answer is, in words.
    hint : str
        Which way to look, where something was missed.
    """
    answers, gone_wrong = _ask(function, trials)
    if gone_wrong:
        print(f"{NOT_YET}: {gone_wrong}")
        return
    if all(answer is ... for answer in answers):
        print(f"{NOT_ATTEMPTED}: write the function in this cell, then run the cell again.")
        return
    marks = [_marked(mark, answer, trial.truth) for answer, trial in zip(answers, trials, strict=True)]
    for number, (answer, marked) in enumerate(zip(answers, marks, strict=True), 1):
        if marked is None:
            print(f"{NOT_YET}: for {_place(number, trials)} your function returned {_short(answer)}.", end=" ")
            print(f"Expected: {expected}.")
            return
    _tell([each for each in marks if each], answers, trials, hint)


def _ask(function: Callable[..., Any], trials: Sequence[Trial]) -> tuple[list[Any], str]:
    """Return the answers, and what went wrong while they were asked for."""
    answers = []
    for number, trial in enumerate(trials, 1):
        given = copy.deepcopy(trial.args)
        try:
            answers.append(copy.deepcopy(function(*given)))
        except Exception as error:  # whatever the learner's code raises is an answer, not a crash
            said = f"{type(error).__name__}: {error}"
            return answers, f"for {_place(number, trials)} your function raised {said}."
        if not _is_same(given, trial.args):
            return answers, (
                f"your function changes the numbers that it is given, in {_place(number, trials)}. "
                "A check must leave what it checks as it was: work on a copy."
            )
    return answers, ""


def _marked(mark: Mark, answer: Any, truth: Any) -> Marks | None:
    try:
        return mark(answer, truth)
    except (TypeError, ValueError, OverflowError):  # no answer of the kind that is asked for
        return None


def _tell(marks: Sequence[Marks], answers: Sequence[Any], trials: Sequence[Trial], hint: str) -> None:
    right, missed, false = (sum(each) for each in zip(*marks, strict=True))
    whole = right + missed + false
    if right == whole:
        print(f"{RIGHT}: {right} of {whole}, nothing missed, no false alarm. For another hunt, add seed=1 to the call.")
        return
    share = int(100 * right / whole)  # 99.9 % is not full
    print(f"{NOT_YET}: {share} of 100 points. Right: {right}, missed: {missed}, false alarms: {false}.")
    wrong: dict[str, list[str]] = {}
    for each, answer, trial in zip(marks, answers, trials, strict=True):
        if each.missed or each.false:
            wrong.setdefault(trial.what, []).append(_verdict(each, answer, trial.truth))
    of_its_kind = Counter(trial.what for trial in trials)
    for what, verdicts in sorted(wrong.items(), key=lambda item: -len(item[1]))[:_NAMED]:
        several = f" ({len(verdicts)} of {of_its_kind[what]})" if of_its_kind[what] > 1 else ""
        print(f"    {what}{several}: {verdicts[0]}")
    if len(wrong) > _NAMED:
        print(f"    and {len(wrong) - _NAMED} kinds more")
    print(f"    {hint}")


def _verdict(marks: Marks, answer: Any, truth: Any) -> str:
    if isinstance(truth, bool):
        return "missed" if marks.missed else "a false alarm"
    if isinstance(truth, list):
        return ", ".join([f"{marks.missed} missed"] * bool(marks.missed) + [f"{marks.false} false"] * bool(marks.false))
    return f"you said {_short(answer)}, it is {_short(truth)}"


def _place(number: int, trials: Sequence[Trial]) -> str:
    return f"dataset {number} of {len(trials)}"


def _short(value: Any) -> str:
    text = " ".join(str(value).split()) if isinstance(value, np.ndarray) else repr(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


def _is_same(one: Any, other: Any) -> bool:
    """Whether two nests of tuples, dicts and arrays hold the same."""
    if isinstance(one, dict):
        return isinstance(other, dict) and one.keys() == other.keys() and _is_same([*one.values()], [*other.values()])
    if isinstance(one, list | tuple):
        return len(one) == len(other) and all(map(_is_same, one, other))
    return bool(np.array_equal(one, other))


def shuffled(rng: np.random.Generator, trials: Iterable[Trial]) -> list[Trial]:
    """Put trials in an order that says nothing."""
    listed = list(trials)
    return [listed[place] for place in rng.permutation(len(listed)).tolist()]
