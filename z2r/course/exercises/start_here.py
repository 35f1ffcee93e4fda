"""Exercises of `00_start_here`."""

from collections.abc import Callable

import numpy as np

from z2r.api import inspect_dataset, load
from z2r.course.exercises._core import Case, Question, judge_function, judge_prediction
from z2r.data import STANDIN
from z2r.reading.breaks import break_mode


def check_yaw_swap(prediction: int | None, again: int | None = None) -> None:
    """Judge a prediction of how many of the first three episodes seem to reach the target under `yaw-swap`.

    Parameters
    ----------
    prediction : int or None
        0 to 3; None where nobody has predicted yet.
    again : int, optional
        The answer to the second question, which is asked of whoever was wrong.
    """
    outcome = inspect_dataset(load(STANDIN).first(3), break_mode("yaw-swap")).outcome
    assert outcome is not None
    judge_prediction(
        prediction,
        outcome.n_reached,
        "The swap turns a yaw into 90 degrees minus that yaw. The blocks end with one near 0, and so they seem to lie"
        " at 90, far out of tolerance.",
        Question(
            3,
            "45 degrees is the one direction that the swap leaves alone: 90 - 45 = 45.",
            "Suppose that the target had a yaw of 45 degrees, and each block ended on it, at 45 degrees too. How many"
            " of the three would seem to reach it?",
        ),
        again,
    )


def check_share_reached(function: Callable[..., object]) -> None:
    """Try a function that returns the share of episodes that reached the target, in [0, 1].

    Parameters
    ----------
    function : callable
        Takes bool[n_episodes].
    """
    cases = [
        Case("six episodes that all reached it", (np.ones(6, dtype=bool),)),
        Case("four episodes of which one reached it", (np.array([False, True, False, False]),)),
        Case("eight episodes of which none reached it", (np.zeros(8, dtype=bool),)),
    ]
    judge_function(
        function,
        lambda reached: float(np.mean(reached)),
        cases,
        hint="Count the True, and divide by how many there are in all.",
    )
