"""Do the labels hold together? Success, reward and done: against each other, against time, and against the reading.

Each data file is folded into what its labels say of every run of frames (`FileLabels`); those of all files are joined
into episodes (`Labels`), of which the checks are asked.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from z2r.arrays import Array, Bools, Columns, Floats, Ints, reduce_parts
from z2r.audits.frames import FileFrames
from z2r.check import Answer, Check
from z2r.errors import Fault
from z2r.format.episodes import DATA_DIR
from z2r.format.rules import episodes_of
from z2r.format.schema import Schema
from z2r.reading.decode import can_decode, decode
from z2r.reading.reading import Reading
from z2r.reading.stored import (
    DONE,
    REWARD,
    StoredSuccess,
    episodes_named,
    is_one_number,
    is_true,
    label_in,
    levels_of,
    stored_success,
    why_no_success,
)
from z2r.reading.success import frame_errors, in_tolerance

_MIN_EPISODES = 2  # of one alone, nothing can tell it from another


class Flag(NamedTuple):
    """What a column that says yes or no says in each run of frames, or in each episode: all bool[n].

    Attributes
    ----------
    ever, always, last : ndarray
        Yes in some frame, in every one, in the last one.
    early : ndarray
        Yes in some frame before the last one.
    lost : ndarray
        Yes in some frame, and no in the one after it.
    """

    ever: Bools
    always: Bools
    last: Bools
    early: Bools
    lost: Bools


class FileLabels(NamedTuple):
    """What the labels of one data file say of each run of frames; None where they are not there, or cannot be read.

    Attributes
    ----------
    success, done : Flag or None
        Columns that say yes or no.
    reward : ndarray, float64[n_runs, 5], or None
        The largest one, the last one, the first one, the one in the middle, and the smallest one.
    levels : ndarray, float64[n]
        Which values the reward takes.
    reached : ndarray, bool[n_runs, 2], or None
        Whether all goals of the reading hold in the first frame, and in the last one.
    """

    success: Flag | None
    done: Flag | None
    reward: Floats | None
    levels: Floats
    reached: Bools | None


class Labels(NamedTuple):
    """What the labels of all files say of each episode.

    Attributes
    ----------
    label : str
        The column that `success` is.
    number : ndarray, int64[n_episodes]
        Their `episode_index`.
    success, done, reward, levels : as in `FileLabels`
        With a row for each episode.
    stored : StoredSuccess or None
        Which of them the dataset calls a success.
    reached : ndarray, bool[n_episodes], or None
        Whether all goals of the reading hold in the frame that decides.
    """

    label: str
    number: Ints
    success: Flag | None
    done: Flag | None
    reward: Floats | None
    levels: Floats
    stored: StoredSuccess | None
    reached: Bools | None

    def named(self, wrong: Bools) -> str:
        """Name some of the episodes."""
        return episodes_named(self.number[wrong].tolist())

    def episodes(self, wrong: Bools) -> tuple[int, ...]:
        """List all of them."""
        return episodes_of(self.number, wrong)


def fold_labels(frames: FileFrames, reading: Reading | None) -> FileLabels:
    """Sum the labels of one data file, which has a frame, up for each run of frames."""
    schema, columns, starts = frames.schema, frames.read.frames, frames.run_starts
    stops = np.append(starts[1:], frames.read.n_rows or 0)
    reward = columns.get(REWARD) if is_one_number(REWARD, schema) else None
    return FileLabels(
        success=_flag(label_in(schema), columns, starts, stops),
        done=_flag(DONE if is_one_number(DONE, schema) else None, columns, starts, stops),
        reward=None if reward is None else _rewards(reward, starts, stops),
        levels=levels_of(np.empty(0) if reward is None else reward),
        reached=_reached(schema, reading, columns, np.stack([starts, stops - 1], axis=1)),
    )


def labels_of_episodes(schema: Schema, reading: Reading | None, number: Ints, runs: FileLabels) -> Labels:
    """Join the runs of all files, whose `episode_index` is `number`; an episode in several files becomes one row."""
    starts = np.flatnonzero(np.diff(number, prepend=number[0] - 1))
    ends = np.append(starts[1:], len(number)) - 1
    success, reward, reached = _of_episodes(runs.success, starts, ends), runs.reward, runs.reached
    levels = levels_of(runs.levels)
    if reward is not None:
        highest, lowest = np.maximum.reduceat(reward[:, 0], starts), np.minimum.reduceat(reward[:, 4], starts)
        reward = np.stack([highest, reward[ends, 1], reward[starts, 2], reward[ends, 3], lowest], axis=1)
    if reached is not None and reading is not None:
        reached = reached[starts, 0] if reading.decisive == "first" else reached[ends, 1]
    return Labels(
        label=label_in(schema) or "",
        number=number[starts],
        success=success,
        done=_of_episodes(runs.done, starts, ends),
        reward=reward,
        levels=levels,
        stored=_stored(schema, success, reward, levels),
        reached=reached,
    )


@Check("success-reward", "a stored success and the reward tell the same story", "warning").of(Labels)
def success_and_reward_agree(labels: Labels) -> Iterator[Answer]:
    """Does the reward rise where there is a success, and is there one where it says so?"""
    if labels.success is None or labels.reward is None or len(labels.levels) < 2:
        return
    highest, ever = labels.reward[:, 0], labels.success.ever
    unpaid = ever & (highest == labels.levels[0])
    if unpaid.any():
        found = f"true in {labels.named(unpaid)}, where {REWARD} is never more than {labels.levels[0]:g}"
        yield Fault(
            DATA_DIR,
            labels.label,
            found,
            "a reward that rises where there is a success",
            episodes=labels.episodes(unpaid),
        )
    unsaid = ~ever & (highest == labels.levels[-1])
    if unsaid.any() and not why_no_success(labels.levels):
        found = f"never true in {labels.named(unsaid)}, where {REWARD} comes to {labels.levels[-1]:g}"
        yield Fault(DATA_DIR, labels.label, found, "a success where the reward comes", episodes=labels.episodes(unsaid))


@Check("success-lost", "a stored success is one to the end of its episode", "note").of(Labels)
def success_is_not_lost(labels: Labels) -> Iterator[Answer]:
    """Does an episode that is called a success end as one?"""
    if labels.success is None:
        return
    wrong = labels.success.lost & ~labels.success.last
    if wrong.any():
        found = f"true and then false to the end in {labels.named(wrong)}"
        mend = "It was lost again, or is said once only: an episode counts as a success where it is true in some frame"
        yield Fault(DATA_DIR, labels.label, found, "true from then on", mend, labels.episodes(wrong))


LABEL_MOMENT = Check("label-moment", "a success or a reward comes where it does in the other episodes", "note")


@LABEL_MOMENT.of(Labels)
def rewards_come_after_something(labels: Labels) -> Iterator[Answer]:
    """Is a reward of two values high before anything was done, and low later, or high all the time in some episodes?

    One that is low in the end alone, or at times, is a penalty.
    """
    if labels.reward is None or why_no_success(labels.levels):
        return
    low, high = labels.levels
    _, last, first, middle, lowest = labels.reward.T
    expected, mend = (
        "a reward that comes when something is reached",
        "Is it turned round in time, or filled in by hand?",
    )
    always = lowest == high
    for wrong, found in (
        ((first == high) & (middle == low) & (last == low), f"{high:g} in the first frame and {low:g} in the end"),
        (always & (always | (first == low)).all(), f"{high:g} in every frame"),
    ):
        if wrong.any():
            yield Fault(DATA_DIR, f"{REWARD} in {labels.named(wrong)}", found, expected, mend, labels.episodes(wrong))


@Check("done", "`next.done` is true where an episode ends, and nowhere else", "warning").of(Labels)
def done_where_an_episode_ends(labels: Labels) -> Iterator[Answer]:
    """Is an episode done in its last frame alone? One that was cut off need not be done at all."""
    if (done := labels.done) is None:
        return
    expected = "true in the last frame alone"
    goes_on = done.lost | (done.always & done.early)
    if goes_on.any():
        mend = "Do these episodes go on after their end, or does the index lack a boundary there?"
        found = f"true before the end of {labels.named(goes_on)}"
        yield Fault(DATA_DIR, DONE, found, expected, mend, labels.episodes(goes_on))
    stays = done.early & ~goes_on
    if stays.any():
        found = f"true in several frames up to the end of {labels.named(stays)}"
        mend = "Who stops at the first one leaves the others out"
        yield "note", Fault(DATA_DIR, DONE, found, expected, mend, labels.episodes(stays))
    if not done.ever.any():
        yield "note", Fault(DATA_DIR, DONE, "false in every frame", "true where an episode ends, unless it was cut off")


@Check("label-constant", "a label tells one episode, or one frame, from another", "note").of(Labels)
def label_tells_something(labels: Labels) -> Iterator[Answer]:
    """Is success, or the reward, the same in all frames of all episodes?"""
    if len(labels.number) < _MIN_EPISODES:
        return
    expected, mend = "a label that tells one from another", "Was it ever filled in?"
    if labels.success and (labels.success.always.all() or not labels.success.ever.any()):
        found = f"{'true' if labels.success.always[0] else 'false'} in every frame of every episode"
        yield Fault(DATA_DIR, labels.label, found, expected, mend)
    elif labels.success and labels.success.always.any():
        found = f"true in every frame of {labels.named(labels.success.always)}"
        mend = "Was it set before the episode began?"
        episodes = labels.episodes(labels.success.always)
        yield Fault(DATA_DIR, labels.label, found, "false before it is a success", mend, episodes)
    if labels.reward is not None and len(labels.levels) == 1:
        yield Fault(DATA_DIR, REWARD, f"{labels.levels[0]:g} in every frame of every episode", expected, mend)


@Check("stored-success", "the reading agrees with the success that is stored, where there is one", "warning").of(Labels)
def reading_agrees_with_what_is_stored(labels: Labels) -> Iterator[Answer]:
    """Is every stored success read as reached? The reverse need not be: success may ask for more."""
    if labels.stored is None or labels.reached is None:
        return
    wrong, source = labels.stored.contradicts(labels.reached), labels.stored.source
    missed, unsaid = wrong & ~labels.reached, wrong & labels.reached
    if missed.any():
        found = f"a success in {labels.named(missed)}, read as not reached"
        mend = "The reading or its tolerances are wrong, or the label is"
        yield Fault(DATA_DIR, source, found, "every stored success read as reached", mend, labels.episodes(missed))
    if unsaid.any():
        found = f"no success in {labels.named(unsaid)}, read as reached"
        mend = "A success may ask for more than the last frame, such as to stay there: does it?"
        yield "note", Fault(DATA_DIR, source, found, "the same of both", mend, labels.episodes(unsaid))


def _flag(name: str | None, columns: Columns, starts: Ints, stops: Ints) -> Flag | None:
    if name is None or name not in columns:
        return None
    yes = is_true(columns[name][:, 0])
    early, lost = yes.copy(), yes & ~np.append(yes[1:], True)
    early[stops - 1] = lost[stops - 1] = False
    ever, early, lost = (reduce_parts(np.logical_or, each, starts, stops) for each in (yes, early, lost))
    return Flag(ever, reduce_parts(np.logical_and, yes, starts, stops), yes[stops - 1], early, lost)


def _rewards(reward: Array, starts: Ints, stops: Ints) -> Floats:
    values = reward[:, 0].astype(np.float64)
    highest, lowest = (reduce_parts(each, values, starts, stops) for each in (np.maximum, np.minimum))
    last, middle = stops - 1, starts + (stops - starts) // 2
    return np.stack([highest, values[last], values[starts], values[middle], lowest], axis=1)


def _reached(schema: Schema, reading: Reading | None, columns: Columns, rows: Ints) -> Bools | None:
    if reading is None or not reading.goal or not can_decode(columns, reading, schema):
        return None
    ends = {name: values[rows.ravel()] for name, values in columns.items()}
    return in_tolerance(frame_errors(decode(ends, reading, schema)), reading).reshape(rows.shape)


def _of_episodes(runs: Flag | None, starts: Ints, ends: Ints) -> Flag | None:
    if runs is None:
        return None
    ever, always, last, early, lost = runs
    ever, early, lost = (np.logical_or.reduceat(each, starts) for each in (ever, early, lost))
    return Flag(ever, np.logical_and.reduceat(always, starts), last[ends], early, lost)


def _stored(schema: Schema, success: Flag | None, reward: Floats | None, levels: Floats) -> StoredSuccess | None:
    """Say which episodes are called a success, as `z2r inspect` does."""
    label = label_in(schema)
    high: Columns = {}
    last: Columns = {}
    if label and success:
        high[label], last[label] = success.ever[:, None], success.last[:, None]
    elif not label and reward is not None:
        high[REWARD], last[REWARD] = reward[:, :1], reward[:, 1:2]
    return stored_success(schema, high, last, levels)[0] if high else None
