"""Exercises of `05_rerun_replay`: what did it look like?"""

from collections.abc import Callable

import numpy as np
from matplotlib.figure import Figure

from z2r.api import load
from z2r.arrays import Floats
from z2r.course import figures
from z2r.course.exercises._core import NOT_YET, Case, judge_function, judge_prediction
from z2r.data import STANDIN
from z2r.pusht.world import PUSHT
from z2r.reading.breaks import break_mode
from z2r.reading.decode import decode
from z2r.reading.reading import Reading

_ALIKE = ("neither", "yaw", "position", "both")
_MOMENTS = ((67, 10), (0, 10), (426, 10), (90, 30), (7, 2.5))  # frame number, frames a second


def predict_same_rows(prediction: str | None) -> Figure | None:
    """Judge which rows of the block the learner expects to be alike in a right replay and in one with `yaw-swap`.

    Parameters
    ----------
    prediction : str or None
        ``position``, ``yaw``, ``both`` or ``neither``; None where there is no prediction yet.

    Returns
    -------
    Figure or None
        The second episode in both readings, for a wrong prediction.
    """
    said = prediction.strip().lower().removesuffix("s") if isinstance(prediction, str) else prediction
    if said not in (None, ..., *_ALIKE):
        print(f"{NOT_YET}: you said {prediction!r}, but there are four answers: {', '.join(_ALIKE)}.")
        return None
    dataset = load(STANDIN)
    wrong = break_mode("yaw-swap").reading(PUSHT)
    state = dataset.read(PUSHT.feature)[dataset.episodes[1]]

    def block(reading: Reading) -> tuple[Floats, Floats]:
        decoded = decode(state, reading, dataset.schema)
        return np.stack(decoded.pose("tee")[:2]), decoded.yaw("tee")

    alike = [np.allclose(one, other) for one, other in zip(block(PUSHT), block(wrong), strict=True)]
    truth = _ALIKE[2 * alike[0] + alike[1]]
    judge_prediction(said, truth, "The swap exchanges the sine and the cosine of the yaw. It does not touch x and y.")
    return (
        None
        if said in (None, ..., truth)
        else figures.right_and_wrong(*(decode(state, reading, dataset.schema) for reading in (PUSHT, wrong)))
    )


def check_sim_time(function: Callable[[int, float], object]) -> None:
    """Try a function that says when a frame is shown.

    Parameters
    ----------
    function : callable
        The learner's: takes the number of a frame and the frames a second, returns the time [s].
    """
    cases = [Case(f"frame {frame} at {fps} frames a second", (frame, fps)) for frame, fps in _MOMENTS]
    hint = "Frame 0 is shown at 0 s. At 10 frames a second, how many seconds is one frame?"
    judge_function(function, lambda frame, fps: frame / fps, cases, hint)
