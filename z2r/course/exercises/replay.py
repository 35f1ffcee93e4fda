"""Exercises of `05_rerun_replay`: what did it look like?"""

from collections.abc import Callable

import numpy as np
from matplotlib.figure import Figure

from z2r.api import load
from z2r.arrays import Floats
from z2r.course import figures
from z2r.course.exercises._core import NOT_YET, Case, Question, judge_function, judge_prediction
from z2r.data import ARM, STANDIN
from z2r.format.videos import read_films
from z2r.pusht.world import PUSHT
from z2r.reading.breaks import break_mode
from z2r.reading.decode import decode
from z2r.reading.reading import Reading

_SHOWN = ((0, 0, 30), (0, 1, 30), (100, 1, 30), (60, 12, 30), (60, 12, 15))  # frame, episode, frames a second
_ALIKE = ("neither", "yaw", "position", "both")
_MOMENTS = ((67, 10), (0, 10), (426, 10), (90, 30), (7, 2.5))  # frame number, frames a second


def predict_same_rows(prediction: str | None, again: str | None = None) -> Figure | None:
    """Judge which rows of the block the learner expects to be alike in a right replay and in one with `yaw-swap`.

    Parameters
    ----------
    prediction : str or None
        ``position``, ``yaw``, ``both`` or ``neither``; None where there is no prediction yet.
    again : str, optional
        The answer to the second question, which is asked of whoever was wrong.

    Returns
    -------
    Figure or None
        The second episode in both readings, for a wrong prediction.
    """
    said, said_again = _plain(prediction), _plain(again)
    for answer, plain in ((prediction, said), (again, said_again)):
        if plain not in (None, ..., *_ALIKE):
            print(f"{NOT_YET}: you said {answer!r}, but there are four answers: {', '.join(_ALIKE)}.")
            return None
    dataset = load(STANDIN)
    wrong = break_mode("yaw-swap").reading(PUSHT)
    state = dataset.read(PUSHT.feature)[dataset.episodes[1]]

    def block(reading: Reading) -> tuple[Floats, Floats]:
        decoded = decode(state, reading, dataset.schema)
        return np.stack(decoded.pose("tee")[:2]), decoded.yaw("tee")

    alike = [np.allclose(one, other) for one, other in zip(block(PUSHT), block(wrong), strict=True)]
    truth = _ALIKE[2 * alike[0] + alike[1]]
    second = Question(
        "both",
        "Every frame is where it was. What is lost is where one episode ends and the next begins.",
        "Somebody ignores where episodes end, which is drop-boundaries, and writes the replay. What of the block is the"
        " same, frame by frame?",
    )
    why = "The swap exchanges the sine and the cosine of the yaw. It does not touch x and y."
    judge_prediction(said, truth, why, second, said_again)
    return (
        None
        if said in (None, ..., truth)
        else figures.right_and_wrong(*(decode(state, reading, dataset.schema) for reading in (PUSHT, wrong)))
    )


def _plain(answer: object) -> object:
    return answer.strip().lower().removesuffix("s") if isinstance(answer, str) else answer


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


def check_video_time(function: Callable[[int, float, float], object]) -> None:
    """Try a function that says at which second of a camera's film a frame is shown.

    Parameters
    ----------
    function : callable
        The learner's: takes the number of a frame in its episode, when the episode begins in the film [s], and the
        frames a second; returns the time [s].
    """
    arm = load(ARM)
    film = next(iter(read_films(arm.root, arm.schema, arm.episodes).value.values()))
    starts = film.time[arm.episodes.from_index].round(6).tolist()
    cases = [
        Case(f"frame {frame} of episode {episode} at {fps:g} frames a second", (frame, starts[episode], fps))
        for frame, episode, fps in _SHOWN
    ]
    hint = "Count from where the episode begins in the film."
    judge_function(
        function,
        lambda frame_index, from_timestamp, fps: from_timestamp + frame_index / fps,
        cases,
        hint,
        untouched=lambda frame_index, from_timestamp, fps: frame_index / fps,
    )
