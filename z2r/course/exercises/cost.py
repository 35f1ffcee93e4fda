"""Exercises of `10_cost_of_a_misreading`: what does a misreading cost?"""

from collections.abc import Callable, Sequence
from itertools import combinations
from typing import Any

import numpy as np

from z2r.arrays import Floats
from z2r.course.exercises._core import (
    NOT_ATTEMPTED,
    NOT_YET,
    RIGHT,
    Case,
    Question,
    judge_function,
    judge_prediction,
)
from z2r.pusht.cloning.results import paired_difference, read_results, read_rollout

_N_EPISODES = 6  # of `standin`
_DRAWS = 1000
_CLOSE = 0.02  # what another draw of the starts may change

# Why a row costs what it costs, whatever that is.
_WHY = {
    "drop-boundaries": "Only the frames beside an episode's end are spoiled, and most frames are not beside one",
    "late-2": "Everything is done 0.2 s after its time, and a policy that looks again can correct itself",
    "late-5": "Everything is done half a second after its time, and by then the pusher is somewhere else",
    "yaw-swap-throughout": "It learns from what it will see, but all is turned by a wrong angle first",
    "fps-30-at-rollout": "Each action lasts a third as long, so between two looks all moves a third as far",
    "exchanged": "Every push goes along the wrong axis, and no second look mends that",
    "scale-eightfold-throughout": "The network learns with the same wrong number that it is played with",
    "scale-eightfold-at-rollout": "The network has never seen its input so small",
    "velocity-by-10-fps": "What was done, in metres a second, is nearly what was asked for",
    "velocity-by-30-fps": "Every action is three times too fast, and the next one is late for it",
}


def predict_replay(exchanged: int | None, late: int | None, again: int | None = None) -> None:
    """Judge how many episodes of `standin` the learner expects to succeed when their actions are played again.

    Parameters
    ----------
    exchanged, late : int or None
        With vx and vy exchanged, and with actions two frames late; None where nobody has predicted yet.
    again : int, optional
        With a clock three times as fast, which is asked of whoever was wrong.
    """
    truth = " and ".join(f"{_replayed(name)} of {_N_EPISODES}" for name in ("exchanged", "late-2"))
    said = None if None in (exchanged, late) else f"{exchanged} of 6 and {late} of 6"
    why = (
        "Exchanged, the pusher goes another way. Late, it goes the same way later, and nothing moves meanwhile: "
        "a block that nobody touches waits."
    )
    second = Question(
        _replayed("wrong-fps"),
        "Each action lasts a third as long, so the pusher goes a third as far, and hardly meets the block.",
        f"Played at 30 frames a second instead of 10, how many of the {_N_EPISODES} succeed?",
    )
    judge_prediction(said, truth, why, second, again)


def _replayed(name: str) -> int:
    return sum(read_rollout(f"replay/{name}", number).success for number in range(_N_EPISODES))


def check_order(order: Sequence[str] | None, rows: Sequence[str]) -> None:
    """Judge an order of misreadings, from cheap to costly, by what was measured.

    Two that the paired interval cannot tell apart may stand either way.

    Parameters
    ----------
    order : sequence of str or None
        The learner's; None where there is none yet.
    rows : sequence of str
        What is to be put in order, rows of the table.
    """
    if order is None:
        print(f"{NOT_ATTEMPTED}: put your list in place of None, then run the cell again.")
        return
    given = [order] if isinstance(order, str) else list(order)
    if strange := [each for each in given if each not in rows]:
        print(f"{NOT_YET}: {strange[0]!r} is none of the {len(rows)} names: {', '.join(rows)}.")
    elif missing := [row for row in rows if row not in given]:
        print(f"{NOT_YET}: {missing[0]!r} is missing from your list.")
    elif len(given) > len(rows):
        print(f"{NOT_YET}: a name stands twice in your list. Each of the {len(rows)} should stand in it once.")
    else:
        _judge_order(given)


def _judge_order(order: Sequence[str]) -> None:
    seen = {row: _outcomes(row) for row in order}
    wrong = [(paired_difference(seen[one], seen[other]), one, other) for one, other in combinations(order, 2)]
    wrong = [each for each in wrong if each[0][2] < 0]  # what stands first succeeded less often, beyond chance
    if not wrong:
        print(f"{RIGHT}: {', '.join(f'{row} {_tally(seen[row])}' for row in order)}.")
        return
    _, one, other = min(wrong)
    print(f"{NOT_YET}: you have {one} as cheaper than {other}, and it is costlier.")
    for row in (other, one):
        print(f"    {row}: {_tally(seen[row])}. {_WHY[row]}.")


def _outcomes(row: str) -> Floats:
    return np.stack([each.succeeded for each in read_results() if each.row == row])


def _tally(seen: Floats) -> str:
    return f"{seen.sum():.0f} of {seen.size}"


def check_interval(function: Callable[..., Any]) -> None:
    """Try a function that says how far chance alone moves the difference of two policies on the same starts.

    Parameters
    ----------
    function : callable
        Takes the outcomes of one policy and of another on the same starts, 1 or 0 each, and a numpy generator; returns
        the ends of the interval in which the difference of their rates lies, 95 times in 100.
    """
    cases = [
        Case("a policy and itself", _pair("early-1", "early-1")),
        Case("early-1 and right", _pair("early-1", "right")),
        Case("late-2 and early-1", _pair("late-2", "early-1")),
        Case("a policy that always fails and one that always succeeds", (np.zeros(100), np.ones(100))),
    ]

    hint = "The starts are the same for both policies. Are they still, once they are drawn again?"
    answer, reference, untouched = map(_drawn, (function, _interval, _interval_as_handed_out))
    judge_function(answer, reference, cases, hint, untouched=untouched, special_hint=_hint_about_the_sign)


def _drawn(function: Callable[..., Any]) -> Callable[[Floats, Floats], object]:
    """Let a function draw; where its answer is as near to what was expected as another draw would be, take that."""

    def near(one: Floats, other: Floats) -> object:
        got, expected = (each(one, other, np.random.default_rng(0)) for each in (function, _interval))
        close = np.shape(got) == (2,) and np.abs(np.subtract(got, expected)).max() < _CLOSE
        return expected if close else got

    return near


def _hint_about_the_sign(got: Floats, expected: Floats) -> str | None:
    turned = got.shape == expected.shape and np.abs(got + expected[::-1]).max() < _CLOSE
    return "Which of the two rates is taken from which? The first less the second." if turned else None


def _pair(one: str, other: str) -> tuple[Floats, Floats]:
    return _outcomes(one)[0], _outcomes(other)[0]


def _interval(one: Floats, other: Floats, rng: np.random.Generator) -> tuple[float, float]:
    drawn = rng.integers(len(one), size=(_DRAWS, len(one)))
    low, high = np.quantile((one - other)[drawn].mean(axis=1), (0.025, 0.975)).tolist()
    return low, high


def _interval_as_handed_out(one: Floats, other: Floats, rng: np.random.Generator) -> tuple[float, float]:
    differences = []
    for _ in range(_DRAWS):
        drawn = rng.integers(len(one), size=len(one))
        again = rng.integers(len(one), size=len(one))
        differences.append(one[drawn].mean() - other[again].mean())
    low, high = np.quantile(differences, (0.025, 0.975)).tolist()
    return low, high
