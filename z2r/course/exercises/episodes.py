"""Exercises of `02_episode_index`."""

from collections.abc import Callable
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from z2r.api import inspect_dataset, load
from z2r.arrays import Ints
from z2r.course import figures
from z2r.course.exercises._core import NOT_YET, Case, Question, judge_function, judge_prediction
from z2r.data import MESSY, STANDIN
from z2r.format.dataset import Dataset
from z2r.format.episodes import EpisodeIndex
from z2r.pusht.world import PUSHT
from z2r.reading.breaks import break_mode
from z2r.reading.decode import decode


def check_episode_length(function: Callable[..., Any]) -> None:
    """Judge a function that says how many frames an episode has.

    Parameters
    ----------
    function : callable
        Takes the two numbers of a range, `from_index` and `to_index`, or arrays of them.
    """
    index = load(MESSY).episodes
    judge_function(
        function,
        lambda from_index, to_index: to_index - from_index,
        [
            Case("the range from 67 to 141", (67, 141)),
            Case("the range from 5 to 6", (5, 6)),
            Case("all ranges of messy", (index.from_index, index.to_index)),
        ],
        hint="The first number is the first frame of the episode; the second is not a frame of it any more.",
    )


def check_cut(function: Callable[..., Any]) -> Figure | None:
    """Judge a function that cuts one episode out of all frames.

    Parameters
    ----------
    function : callable
        Takes an array with a row for every frame of the dataset, the episode index, and the number of an episode;
        returns the rows of that episode.

    Returns
    -------
    Figure or None
        The block in the last frame that belongs to the episode, and in the last frame of an answer that goes beyond it.
    """
    dataset = load(STANDIN)
    frames, index = np.arange(dataset.episodes.n_frames), dataset.episodes
    episodes = (1, 0, 2, len(index) - 1)
    cases = [Case(f"the frames of episode {episode}", (frames, index, episode)) for episode in episodes]
    hint = "Compare your first and your last frame with the range of the episode."
    case = judge_function(
        function,
        _cut,
        cases,
        hint,
        untouched=lambda frames, index, episode: frames[index.from_index[episode] : index.to_index[episode] + 1],
        special_hint=lambda got, expected: (
            "One frame too few: the last frame of the episode is missing."
            if np.array_equal(got, expected[:-1])
            else None
        ),
    )
    return None if case is None else _last_frames(dataset, case.args[-1], function(*case.args))


def check_without_index(
    prediction: tuple[int, float] | None, dataset: Dataset, again: tuple[int, float] | None = None
) -> None:
    """Judge what somebody sees who ignores the episode index.

    Parameters
    ----------
    prediction : tuple of int and float, or None
        How many episodes, and which share of them reached the target, in [0, 1].
    dataset : Dataset
        What is read.
    again : tuple of int and float, optional
        The answer to the second question, which is asked of whoever was wrong.
    """
    if any(each is not None and np.shape(each) != (2,) for each in (prediction, again)):
        print(f"{NOT_YET}: two numbers are needed, how many episodes and which share of them, as in (14, 0.79).")
        return
    right = inspect_dataset(dataset).outcome
    wrong = inspect_dataset(dataset, break_mode("drop-boundaries"))
    if right is None or wrong.outcome is None:
        raise ValueError("found a dataset that is not of the PushT task, expected one with its columns")
    why = (
        "All frames have become one episode, and only the last frame of the dataset is asked. "
        f"Read with the index, {right.n_reached} of {len(right.reached)} reached the target: "
        f"{right.share_reached:.2f}."
    )
    second = Question(
        (1, 0.0),
        "The one episode that they see ends as the last one does, and 19 good ones do not count.",
        "In a dataset of 20 episodes, 19 reached the target, and the last did not. What does somebody see who ignores"
        " its index?",
    )
    judge_prediction(prediction, (len(wrong.episodes), wrong.outcome.share_reached), why, second, again)


def _cut(frames: Ints, index: EpisodeIndex, episode: int) -> Ints:
    return frames[index[episode]]


def _last_frames(dataset: Dataset, episode: int, answer: object) -> Figure | None:
    """Draw the block in the last frame of an episode, and in that of an answer that ends in another episode."""
    try:
        last = int(np.asarray(answer)[-1])
    except (IndexError, TypeError, ValueError):
        return None
    own = dataset.episodes[episode]
    if own.start <= last < own.stop or not 0 <= last < dataset.episodes.n_frames:
        return None
    state = dataset.read(PUSHT.feature)[[own.stop - 1, last]]
    ends = decode(state, PUSHT, dataset.schema)
    tee = ends.pose("tee")
    right, wrong = zip(tee.x.tolist(), tee.y.tolist(), ends.yaw("tee").tolist(), strict=True)
    return figures.two_poses(right, wrong)
