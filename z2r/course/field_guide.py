"""What does each wrong reading change, and who would notice? Every break mode, run on one dataset."""

import os
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from z2r.api import audit
from z2r.arrays import Floats, Ints
from z2r.format.dataset import Dataset, load
from z2r.format.schema import ACTION
from z2r.reading.breaks import BREAK_MODES, BreakMode
from z2r.reading.inspection import Outcome, inspect_dataset
from z2r.reading.reading import PUSHT, Reading, named_columns, read_pose

_DIGITS = 6  # of an error: what float32 leaves behind is no change

type _Drawn = tuple[Ints, Floats, Floats]


@dataclass(frozen=True)
class Change:
    """What one break mode changes.

    Attributes
    ----------
    name : str
        Of the break mode.
    missing, lengths, reached : int
        How many episodes are gone; of how many that are left the length is another, or what is said of the target.
    n_episodes, n_reached : int
        How many episodes there are, and how many are read as reached.
    pos_err, ang_err : float
        The largest change of a final error among those that are left [m], [rad].
    picture, action : float
        The share of the frames in which a body is drawn elsewhere, or which are given another action, in [0, 1]. A
        frame that is missing, or that has no place in its episode, counts.
    speed : float
        How many times as fast everything seems to go.
    checks : tuple of str
        The audit's checks that find something, and find nothing where the dataset is read right.
    """

    name: str
    missing: int
    lengths: int
    reached: int
    n_episodes: int
    n_reached: int
    pos_err: float
    ang_err: float
    picture: float
    action: float
    speed: float
    checks: tuple[str, ...]

    @property
    def is_dormant(self) -> bool:
        """Whether the mistake changes nothing in this dataset: it waits for one in which it does."""
        counts = self.missing, self.lengths, self.reached, self.pos_err, self.ang_err, self.picture, self.action
        return not any(counts) and self.speed == 1


def what_changes(root: str | os.PathLike[str], modes: Iterable[BreakMode] = BREAK_MODES.values()) -> list[Change]:
    """Read a dataset of the PushT task in every wrong way, and say of each what it changes.

    Parameters
    ----------
    root : str or path
        The folder. Its frames are in memory at once.
    modes : iterable of BreakMode, optional
        All unless given.

    Returns
    -------
    list of Change
        In the order of the modes.

    Raises
    ------
    ValueError
        If it has not the columns of the PushT task.

    Examples
    --------
    >>> import z2r
    >>> [change] = what_changes(z2r.STANDIN, [z2r.break_mode("yaw-swap-everywhere")])
    >>> change.reached, change.picture, change.checks
    (0, 1.0, ('overlap',))
    """
    dataset = load(root)
    right = inspect_dataset(dataset)
    if right.outcome is None:
        raise ValueError(f"found a dataset without {', '.join(right.missing)}, expected one of the PushT task")
    known = {finding.check for finding in audit(root).findings}
    frames = _frames(dataset, PUSHT)
    return [_compare(dataset, mode, right.outcome, frames, known) for mode in modes]


def _compare(dataset: Dataset, mode: BreakMode, right: Outcome, frames: _Drawn, known: set[str]) -> Change:
    believed, wrong = mode.dataset(dataset), inspect_dataset(dataset, mode)
    assert wrong.outcome is not None  # every mode reads columns that the right reading reads
    index, left = wrong.episodes, wrong.episodes.numbers
    places, bodies, action = _frames(believed, mode.reading(PUSHT))
    checks = [finding.check for finding in audit(dataset.root, mode).findings]
    return Change(
        name=mode.name,
        missing=len(dataset.episodes) - len(left),
        lengths=int((dataset.episodes.lengths[left] != index.lengths).sum()),
        reached=int((right.reached[left] != wrong.outcome.reached).sum()),
        n_episodes=len(index),
        n_reached=wrong.outcome.n_reached,
        pos_err=_largest(right.final_pos_err[left] - wrong.outcome.final_pos_err),
        ang_err=_largest(right.final_ang_err[left] - wrong.outcome.final_ang_err),
        picture=_share_that_differs(frames[0], frames[1], places, bodies),
        action=_share_that_differs(frames[0], frames[2], places, action),
        speed=believed.schema.fps / dataset.schema.fps,
        checks=tuple(check for check in dict.fromkeys(checks) if check not in known),
    )


def _frames(dataset: Dataset, reading: Reading) -> _Drawn:
    """Of every frame: its place in its episode, where the bodies are drawn, and its action; a row for each."""
    index, frames = dataset.episodes, dataset.episodes.frame_numbers
    places = np.repeat((index.numbers << 32) - index.from_index, index.lengths) + frames
    columns = named_columns(dataset.read(reading.feature)[frames], reading, dataset.schema)
    poses = [read_pose(columns, pose) for pose in (reading.tee, reading.target)]
    drawn = [part for pose in poses for part in (pose.x, pose.y, np.cos(pose.yaw), np.sin(pose.yaw))]
    bodies = np.stack([*(columns[name] for name in reading.pusher), *drawn], axis=1)
    last = np.repeat(index.to_index - 1, index.lengths)
    action = dataset.read(ACTION)[np.minimum(frames + reading.action_lag, last)]
    return places, bodies, action.astype(np.float64)


def _share_that_differs(places: Ints, values: Floats, other_places: Ints, other_values: Floats) -> float:
    both, here, there = np.intersect1d(places, other_places, return_indices=True)
    same = np.isclose(values[here], other_values[there], atol=10.0**-_DIGITS).all(axis=1).sum()
    return 1 - float(same) / (len(places) + len(other_places) - len(both))


def _largest(change: Floats) -> float:
    return round(float(np.abs(change).max()), _DIGITS)
