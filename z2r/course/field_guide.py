"""What does each wrong reading change, and who would notice? Every break mode, run on one dataset."""

import os
from collections.abc import Iterable
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from z2r.api import audit, choose_reading, inspect_dataset, load
from z2r.arrays import Floats, Ints
from z2r.format.dataset import Dataset
from z2r.format.schema import STATE
from z2r.reading.breaks import BREAK_MODES, BreakMode
from z2r.reading.decode import decode, features_of
from z2r.reading.inspection import Outcome
from z2r.reading.poses import Pose
from z2r.reading.reading import Reading

_DIGITS = 6  # of an error: what float32 leaves behind is no change

KINDS: dict[str, tuple[str, ...]] = {
    "what the numbers mean": (
        "yaw-swap",
        "yaw-swap-everywhere",
        "no-wrap",
        "wrong-reference-point",
        "degrees-for-radians",
        "first-frame-for-last",
        "wrong-angle-unit",
        "joints-exchanged",
        "quaternion-order",
        "delta-for-absolute",
        "gripper-inverted",
    ),
    "the index": ("drop-boundaries", "inclusive-end", "first-shard-only", "stale-file-pointer"),
    "the files": ("name-sorted-files",),
    "time": ("wrong-fps", "action-lag"),
}
"""What a break mode is about, and which are about it."""


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
    errors : dict of str to float
        The largest change of each final error among those that are left, in the unit of its goal.
    picture, action : float
        The share of the frames in which a body is drawn elsewhere, or the state where there is no body, or which are
        given another action, in [0, 1]. A frame that is missing, or that has no place in its episode, counts.
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
    errors: dict[str, float]
    picture: float
    action: float
    speed: float
    checks: tuple[str, ...]

    @property
    def is_dormant(self) -> bool:
        """Whether the mistake changes nothing in this dataset: it waits for one in which it does."""
        counts = self.missing, self.lengths, self.reached, self.picture, self.action, *self.errors.values()
        return not any(counts) and self.speed == 1

    @property
    def marks(self) -> dict[str, str]:
        """By how much each thing changes; empty where it does not."""
        counts = {"episodes gone": self.missing, "other length": self.lengths, "reached is wrong": self.reached}
        shares = {"picture": self.picture, "action": self.action}
        return {
            **{name: f"{number or ''}" for name, number in counts.items()},
            **{f"final {name}": f"{error:.2f}" if error else "" for name, error in self.errors.items()},
            **{name: f"{100 * share:.0f} %" if share else "" for name, share in shares.items()},
            "speed": "" if self.speed == 1 else f"{self.speed:.0f} x",
        }


class _Drawn(NamedTuple):
    """Of every frame: its place in its episode, what is drawn, and its action; a row for each."""

    places: Ints
    bodies: Floats
    action: Floats


def by_kind(changes: Iterable[Change]) -> dict[str, list[Change]]:
    """Sort changes by what their break modes are about; a kind of which there is none is left out."""
    changes = list(changes)
    kinds = {kind: [change for change in changes if change.name in names] for kind, names in KINDS.items()}
    return {kind: found for kind, found in kinds.items() if found}


def what_changes(
    dataset: str | os.PathLike[str],
    modes: Iterable[BreakMode] | None = None,
    reading: Reading | None = None,
) -> list[Change]:
    """Read a dataset in every wrong way, and say of each what it changes.

    Parameters
    ----------
    dataset : str or path
        The folder, or the name of a dataset that ships. Its frames are in memory at once.
    modes : iterable of BreakMode, optional
        Those that apply unless given; one that is about something that is not there changes nothing.
    reading : Reading, optional
        What the columns mean; the one that ships and fits, unless given.

    Returns
    -------
    list of Change
        In the order of the modes.

    Raises
    ------
    ValueError
        If no reading fits, or the one that does has no goal.

    Examples
    --------
    >>> import z2r
    >>> [change] = what_changes(z2r.STANDIN, [z2r.break_mode("yaw-swap-everywhere")])
    >>> change.reached, change.picture, change.checks
    (0, 1.0, ('overlap',))
    """
    whole = load(dataset)
    reading = reading or choose_reading(whole.schema)
    right = inspect_dataset(whole, reading=reading)
    if reading is None or right.outcome is None:
        lacking = ", ".join(right.missing) or "a goal"
        raise ValueError(f"found no {lacking}, expected a reading that fits the dataset and has a goal")
    known = {finding.check for finding in audit(whole, reading=reading).findings}
    drawn = _drawn(whole, reading)
    if modes is None:
        modes = (mode for mode in BREAK_MODES.values() if mode.applies_to(whole, reading))
    return [_compare(whole, mode, reading, right.outcome, drawn, known) for mode in modes]


def _compare(
    dataset: Dataset, mode: BreakMode, reading: Reading, right: Outcome, drawn: _Drawn, known: set[str]
) -> Change:
    (believed, wrong_reading), wrong = mode.believe(dataset, reading), inspect_dataset(dataset, mode, reading)
    assert wrong_reading is not None  # there was a right one
    assert wrong.outcome is not None  # every mode reads columns that the right reading reads
    index, left = wrong.episodes, wrong.episodes.numbers
    as_believed = _drawn(believed, wrong_reading)
    checks = [finding.check for finding in audit(dataset, mode, reading).findings]
    finals = wrong.outcome.final_errors
    return Change(
        name=mode.name,
        missing=len(dataset.episodes) - len(left),
        lengths=int((dataset.episodes.lengths[left] != index.lengths).sum()),
        reached=int((right.reached[left] != wrong.outcome.reached).sum()),
        n_episodes=len(index),
        n_reached=wrong.outcome.n_reached,
        errors={name: _largest(errors[left] - finals[name]) for name, errors in right.final_errors.items()},
        picture=_share_that_differs(drawn.places, drawn.bodies, as_believed.places, as_believed.bodies),
        action=_share_that_differs(drawn.places, drawn.action, as_believed.places, as_believed.action),
        speed=believed.schema.fps / dataset.schema.fps,
        checks=tuple(check for check in dict.fromkeys(checks) if check not in known),
    )


def _drawn(dataset: Dataset, reading: Reading) -> _Drawn:
    index, frames = dataset.episodes, dataset.episodes.frame_numbers
    places = np.repeat((index.numbers << 32) - index.from_index, index.lengths) + frames
    features = {name: dataset.read(name) for name in features_of(reading, dataset.schema)}
    decoded = decode(features, reading, dataset.schema)
    bodies = [part for name in reading.poses for part in _parts_drawn(decoded.take(frames).pose(name))]
    action = np.empty((len(frames), 0)) if decoded.action is None else decoded.action[frames]
    if not bodies and STATE in dataset.schema.signals():  # as in a replay: without a body, it draws the numbers
        bodies = [*dataset.read(STATE)[frames].astype(np.float64).T]
    return _Drawn(places, np.stack(bodies, axis=1) if bodies else np.empty((len(frames), 0)), action)


def _parts_drawn(pose: Pose) -> list[Floats]:
    """What decides where a body is drawn: two yaws that are a whole turn apart look the same."""
    turned = [] if pose.yaw is None else [np.cos(pose.yaw), np.sin(pose.yaw)]
    spatial = [] if pose.quaternion is None else [*pose.quaternion.T]
    return [pose.x, pose.y, *([] if pose.z is None else [pose.z]), *turned, *spatial]


def _share_that_differs(places: Ints, values: Floats, other_places: Ints, other_values: Floats) -> float:
    both, here, there = np.intersect1d(places, other_places, return_indices=True)
    same = np.isclose(values[here], other_values[there], atol=10.0**-_DIGITS).all(axis=1).sum()
    return 1 - float(same) / (len(places) + len(other_places) - len(both))


def _largest(change: Floats) -> float:
    return round(float(np.abs(change).max()), _DIGITS)


class Guide(str):
    """A table in Markdown, which a notebook renders."""

    def __repr__(self) -> str:
        return str(self)

    def _repr_markdown_(self) -> str:
        return str(self)


def guide(kind: str) -> Guide:
    """Return the page of the field guide about one kind of mistake: what is believed, what it leaves, who met it.

    Parameters
    ----------
    kind : str
        One of `KINDS`.

    Examples
    --------
    >>> print(guide("the files").splitlines()[0])
    | break mode | what is believed | what it leaves behind | |
    """
    lines = ["| break mode | what is believed | what it leaves behind | |", "| --- | --- | --- | --- |"]
    for mode in (BREAK_MODES[name] for name in KINDS[kind]):
        met = f"[met]({mode.seen_in})" if mode.seen_in else ""
        lines.append(f"| `{mode.name}` | {mode.assumption} | {mode.signature} | {met} |")
    return Guide("\n".join(lines))
