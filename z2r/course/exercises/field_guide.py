"""Exercises of `09_field_guide`: what is wrong with this dataset?"""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from z2r.api import audit, load
from z2r.arrays import Floats
from z2r.course import figures
from z2r.course.exercises._core import Case, Question, judge_function, judge_prediction
from z2r.data import ARM, MESSY, STANDIN
from z2r.format.dataset import Dataset
from z2r.format.episodes import EpisodeIndex
from z2r.format.schema import STATE
from z2r.pusht.world import PUSHT
from z2r.reading.breaks import break_mode
from z2r.reading.decode import decode

CHOICES = ("wrong-reference-point", "degrees-for-radians", "first-frame-for-last", "joints-exchanged")
_OF_AN_ARM = ("wrong-angle-unit", "delta-for-absolute", "action-lag", "wrong-fps")


def predict_unnoticed(root: Path, prediction: str | None, again: str | None = None) -> None:
    """Judge under which break mode the learner expects the audit to find nothing new.

    Parameters
    ----------
    root : Path
        A PushT dataset without a verdict beside it.
    prediction : str or None
        One of `CHOICES`; None where there is no prediction yet.
    again : str, optional
        The same of an arm, which is asked of whoever was wrong.
    """
    second = Question(
        _unnoticed(ARM, _OF_AN_ARM),
        "An arm is some frames behind its commands anyway: one more is within what arms do.",
        f"Of the arm, which is not noticed: {', '.join(_OF_AN_ARM)}?",
    )
    why = "No data can say how good is good enough. Somebody has to know the task, or there is a second witness."
    judge_prediction(prediction, _unnoticed(root, CHOICES), why, second, again)


def _unnoticed(root: Path, names: tuple[str, ...]) -> str:
    """Return the mode under which no check finds something that it does not find anyway."""
    known = _checks(root)
    [name] = (name for name in names if not _checks(root, name) - known)
    return name


def _checks(root: Path, mode: str = "") -> set[str]:
    return {finding.check for finding in audit(root, break_mode(mode) if mode else None).findings}


def check_longest_steps(function: Callable[..., Any]) -> Figure | None:
    """Try a function that looks for leaps inside episodes.

    Parameters
    ----------
    function : callable
        Takes x and y of the block in every frame [m], and the episode index; returns for each episode the longest step
        that the block makes inside it, from one frame to the next [m].

    Returns
    -------
    Figure or None
        The episodes of the first case that went wrong.
    """
    cases = [
        Case("the episodes of messy", _block(load(MESSY))),
        Case("the episodes of standin", _block(load(STANDIN))),
        Case("two episodes of two frames", (np.array([0.0, 0.01, 0.5, 0.52]), np.zeros(4), _index(2, 2))),
    ]
    hint = "Step number k goes from frame k to frame k + 1. Which steps of the slice lead out of the episode?"
    wrong = judge_function(function, _longest_steps, cases, hint, untouched=_longest_steps_as_handed_out)
    return None if wrong is None else figures.episode_ribbon(wrong.args[2])


def _block(dataset: Dataset) -> tuple[Floats, Floats, EpisodeIndex]:
    tee = decode(dataset.read(STATE), PUSHT, dataset.schema).pose("tee")
    return tee.x, tee.y, dataset.episodes


def _longest_steps(x: Floats, y: Floats, episodes: EpisodeIndex) -> list[float]:
    parts = [episodes[i] for i in range(len(episodes))]
    return [float(np.hypot(np.diff(x[part]), np.diff(y[part])).max()) for part in parts]


def _longest_steps_as_handed_out(x: Floats, y: Floats, episodes: EpisodeIndex) -> list[float]:
    steps = np.hypot(np.diff(x), np.diff(y))
    return [float(steps[start:stop].max()) for start, stop in zip(episodes.from_index, episodes.to_index, strict=True)]


def _index(*lengths: int) -> EpisodeIndex:
    to_index = np.cumsum(lengths, dtype=np.int64)
    return EpisodeIndex(to_index - np.array(lengths), to_index)
