"""Which episodes does the dataset itself call a success? A column may say so, or a reward that comes or does not.

*Stored* is what the recorder wrote down; *reached* is what a reading makes of the numbers (`z2r.reading.success`). The
two need not agree, and where they do not, one of them is wrong.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from z2r.arrays import Array, Bools, Columns, Floats
from z2r.errors import some
from z2r.format.episodes import EpisodeIndex
from z2r.format.schema import Schema
from z2r.reading.goal import Goal

SUCCESS = ("next.success", "success")  # columns that say it outright: the first that is there
REWARD, DONE = "next.reward", "next.done"


@dataclass(frozen=True, eq=False)
class StoredSuccess:
    """Which episodes the dataset calls a success.

    Attributes
    ----------
    source : str
        The column that says so, or ``next.reward with next.done``.
    any_frame, last_frame : ndarray, bool[n_episodes]
        Whether it does in some frame of the episode, and in its last one. An episode is counted as a success where it
        does in some frame: recorders differ in whether they say it once or from then on.
    """

    source: str
    any_frame: Bools
    last_frame: Bools

    @property
    def n_success(self) -> int:
        """Number of episodes that are called a success."""
        return int(self.any_frame.sum())

    @property
    def share(self) -> float:
        """Share of the episodes that are called a success, in [0, 1]."""
        return float(self.any_frame.mean())

    @property
    def tally(self) -> str:
        """How many are called a success, of how many."""
        return _tally(self.any_frame)

    @property
    def says(self) -> str:
        """All that is said, in short; some frame and the last one apart where they differ.

        >>> StoredSuccess("success", np.array([True, True]), np.array([True, False])).says
        '2 of 2 in some frame, 1 of 2 in the last (success)'
        """
        if np.array_equal(self.any_frame, self.last_frame):
            return f"{self.tally} ({self.source})"
        return f"{self.tally} in some frame, {_tally(self.last_frame)} in the last ({self.source})"

    def contradicts(self, reached: Bools) -> Bools:
        """Tell of each episode whether neither of its frames agrees with a reading, bool[n_episodes]."""
        wrong: Bools = (self.any_frame != reached) & (self.last_frame != reached)
        return wrong

    def agreement(self, reached: Bools, episodes: EpisodeIndex) -> str:
        """Say in how many episodes a reading agrees, and name those in which it does not."""
        wrong = self.contradicts(reached)
        agree = f"the two agree in {_tally(~wrong)}"
        return f"{agree}; they differ in {episodes_named(episodes.numbers[wrong].tolist())}" if wrong.any() else agree


def stored_success(schema: Schema, high: Columns, last: Columns, levels: Floats) -> tuple[StoredSuccess | None, str]:
    """Say which episodes a dataset calls a success.

    Parameters
    ----------
    schema : Schema
        What there is.
    high, last : dict of str to ndarray, (n_episodes, size of the feature)
        The largest value and the last one of each feature in each episode.
    levels : ndarray, float64[n]
        Which values the reward takes, from `levels_of`; none where there is no reward.

    Returns
    -------
    stored : StoredSuccess or None
        None where no column says it.
    note : str
        What else there is to say of such a column, such as why a reward says nothing; mostly empty.
    """
    if label := label_in(schema):
        return _by_label(label, high[label][:, 0], last[label][:, 0])
    if not (is_one_number(REWARD, schema) and is_one_number(DONE, schema)):
        return None, ""
    if why := why_no_success(levels):
        return None, f"{REWARD} {why}"
    top = levels[-1]
    return StoredSuccess(f"{REWARD} with {DONE}", high[REWARD][:, 0] == top, last[REWARD][:, 0] == top), ""


def label_in(schema: Schema) -> str | None:
    """Return the column that says success outright, if there is one."""
    return next((name for name in SUCCESS if is_one_number(name, schema)), None)


def is_one_number(name: str, schema: Schema) -> bool:
    """Tell whether a feature is one number a frame."""
    return name in schema.features and schema.features[name].is_numeric and schema.features[name].size == 1


def is_true(label: Array) -> Bools:
    """Tell of each value of a column whether it says yes, bool[n]: as a goal on a stored column holds."""
    return Goal(name="label", stored="label").holds(label.astype(np.float64))


def levels_of(values: Array) -> Floats:
    """Return the smallest and the largest value of a column, and one between them if there is one: two for a switch.

    >>> levels_of(np.array([0, 1, 1, 0])), levels_of(np.array([0.1, 0.4, 0.2, 0.3]))
    (array([0., 1.]), array([0.1, 0.2, 0.4]))
    """
    flat = values.ravel().astype(np.float64)
    ends = np.unique([flat.min(), flat.max()]) if len(flat) else flat
    levels: Floats = np.unique(np.concatenate([ends, flat[~np.isin(flat, ends)][:1]]))
    return levels


def why_no_success(levels: Floats) -> str:
    """Say why a reward of these levels does not tell a success; empty where it does: one value above 0, one below it.

    >>> why_no_success(np.array([0.0, 1.0])), why_no_success(np.array([0.0]))
    ('', 'is 0 in every frame: it tells no episode from another')
    """
    if not np.isfinite(levels).all():
        return "is no number in some frame: no success is read off it"
    if len(levels) == 1:
        return f"is {levels[0]:g} in every frame: it tells no episode from another"
    if len(levels) > 2:
        return "is dense: it says how well, not whether"
    return "" if levels[-1] > 0 else "is never above 0: it does not say which of its values is a success"


def episodes_named(numbers: Sequence[int]) -> str:
    """Name episodes, at most eight of them.

    >>> episodes_named([3]), episodes_named(range(10))
    ('episode 3', 'episodes 0, 1, 2, 3, 4, 5, 6, 7 and 2 more')
    """
    more = f" and {len(numbers) - 8:,} more" if len(numbers) > 8 else ""
    return f"episode{'s' if len(numbers) > 1 else ''} {some(numbers[:8])}{more}"


def _by_label(label: str, high: Array, last: Array) -> tuple[StoredSuccess, str]:
    gaps = np.flatnonzero(~np.isfinite(high.astype(np.float64)))
    some_of = f"{len(gaps):,} of {len(high):,} episodes"
    note = f"{label} is no number in some frame of {some_of}: they are not counted as a success" if len(gaps) else ""
    return StoredSuccess(label, is_true(high), is_true(last) & is_true(high)), note


def _tally(labels: Bools) -> str:
    return f"{labels.sum():,} of {len(labels):,}"
