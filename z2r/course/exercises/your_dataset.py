"""Exercises of `08_your_dataset`: is my data any good?"""

import shutil
import tempfile
from collections.abc import Callable
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

from z2r.api import inspect_dataset, load
from z2r.arrays import Array, Floats
from z2r.course import figures
from z2r.course.exercises._core import Case, judge_function, judge_prediction
from z2r.data import MESSY, STANDIN
from z2r.format.episodes import EpisodeIndex
from z2r.format.schema import ACTION, INFO_PATH, STATE

_OTHER_NAMES = {"pusher": "hand", "tee": "part", "target": "slot"}


def predict_other_robot(prediction: str | None) -> None:
    """Judge how many episodes the learner expects `z2r` to call reached where the columns have other names.

    Parameters
    ----------
    prediction : str or None
        ``0 of 6``, ``6 of 6`` or ``nothing``; None where there is no prediction yet.
    """
    with tempfile.TemporaryDirectory() as folder:
        root = Path(shutil.copytree(STANDIN, Path(folder) / "other"))
        info = (root / INFO_PATH).read_text(encoding="utf-8")
        for name, other_name in _OTHER_NAMES.items():
            info = info.replace(name, other_name)
        (root / INFO_PATH).write_text(info, encoding="utf-8")
        outcome = inspect_dataset(load(root)).outcome
    truth = "nothing" if outcome is None else f"{outcome.n_reached} of {len(outcome.reached)}"
    said = prediction.strip().lower() if isinstance(prediction, str) else prediction
    why = "A reading finds its columns by their names, never by their places. Without the names it does not guess."
    judge_prediction(said, truth, why)


def check_never_moves(function: Callable[[Array], object]) -> None:
    """Try a function that tells which dimensions of a feature have one and the same value in every frame.

    Parameters
    ----------
    function : callable
        The learner's: takes an array (n_frames, size of the feature), returns a bool for each dimension.
    """
    there_and_back = np.array([[0.0, 1.0, 5.0], [2.0, 1.0, 5.0], [0.0, 1.0, 4.999]])
    cases = [
        Case("the state of the messy dataset", (load(MESSY).read(STATE),)),
        Case("its action", (load(MESSY).read(ACTION),)),
        Case("three frames in which the first dimension goes and comes back", (there_and_back,)),
        Case("a single frame", (np.array([[1.0, 2.0]]),)),
        Case("1108 frames of a constant 0.1 in float32", (np.full((1108, 1), 0.1, np.float32),)),
    ]
    hint = "One answer for each column. A column rests if its smallest value is also its largest."
    judge_function(function, lambda values: values.min(axis=0) == values.max(axis=0), cases, hint)


def check_column_mean(function: Callable[[Floats, EpisodeIndex], object]) -> Figure | None:
    """Try a function that takes the mean of a column over all frames of a dataset.

    Parameters
    ----------
    function : callable
        The learner's: takes float64[n_frames] and the episode index, returns the mean over the frames.

    Returns
    -------
    Figure or None
        The episodes of the first case that went wrong.
    """
    messy = load(MESSY)
    tee_x = messy.read(STATE)[:, messy.schema.columns(STATE, ["tee_x"])[0]].astype(np.float64)
    cases = [
        Case("x of the block in the messy dataset", (tee_x, messy.episodes)),
        Case("four frames, an episode of three and one of one", (np.array([1.0, 1.0, 1.0, 5.0]), _index(3, 1))),
        Case("two episodes of two frames", (np.array([1.0, 3.0, 5.0, 7.0]), _index(2, 2))),
    ]
    hint = "Every frame counts once. How much does a frame of a short episode count here?"
    wrong = judge_function(
        function, lambda values, _: float(values.mean()), cases, hint, untouched=_column_mean_as_handed_out
    )
    return None if wrong is None else figures.episode_ribbon(wrong.args[1])


def _column_mean_as_handed_out(values: Floats, episodes: EpisodeIndex) -> float:
    return float(np.mean([values[episodes[i]].mean() for i in range(len(episodes))]))


def _index(*lengths: int) -> EpisodeIndex:
    to_index = np.cumsum(lengths, dtype=np.int64)
    return EpisodeIndex(to_index - np.array(lengths), to_index)
