"""Does the picture move when the robot does? How far it changes from one picture to the next, against how far it comes.

Only the dataset itself says what to expect: in a camera that sees little of the robot, little fits, and then nothing is
said. An episode that fits far less than the others shows something else: another episode, or another time.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from z2r.arrays import Floats

_MIN_EPISODES = 5  # from fewer nothing can be said about what is usual
_MIN_STEPS = 12  # from picture to picture: fewer say little about how two things move together
_SHIFTS = [shift for shift in range(-16, 17) if shift]  # steps; of an episode, a third at most
_LATE = 0.5  # s: cameras are late by some tenths of a second, all of them
_FITS, _FITS_NOT = 0.5, 0.25  # correlation: what is usual must be more; what is less fits nothing
_LESS, _SPREADS = 0.35, 6  # below what is usual, in correlation and in spreads of it: then there must be a reason
_AS_WELL = 0.15  # below what is usual: with something else it fits


class Steps(NamedTuple):
    """From each picture of an episode to the next: how far it changes, and how far the robot comes; (n_steps,).

    Attributes
    ----------
    change, way : ndarray, float64[n_steps]
        Of the picture, and of the robot.
    seconds : float
        How long a step is.
    """

    change: Floats
    way: Floats
    seconds: float


class Fit(NamedTuple):
    """How well the pictures of a camera fit.

    Attributes
    ----------
    usual : float
        The correlation that is usual; nan where too little moves to say anything.
    astray : dict of int to str
        The episodes that do not fit, and what was found of each.
    """

    usual: float
    astray: dict[int, str]


def fit(episodes: Mapping[int, Steps]) -> Fit:
    """Find the episodes, by their numbers, whose pictures do not move with the robot as those of the others do.

    Examples
    --------
    >>> way = np.random.default_rng(0).random((6, 30))
    >>> right = {number: Steps(change=way[number], way=way[number], seconds=0.5) for number in range(6)}
    >>> fit(right)
    Fit(usual=1.0, astray={})
    >>> fit(right | {4: Steps(change=way[2], way=way[4], seconds=0.5)}).astray
    {4: 'a correlation of 0.06 with the motion of the robot, and of 1.00 with that in episode 2'}
    """
    episodes = {number: steps for number, steps in episodes.items() if len(steps.way) >= _MIN_STEPS}
    own = {number: _correlation(steps.change, steps.way) for number, steps in episodes.items()}
    usual = _median(list(own.values()))
    shifted = {shift: _median([_shifted(steps, shift) for steps in episodes.values()]) for shift in _SHIFTS}
    shift = max(shifted, key=lambda shift: np.nan_to_num(shifted[shift], nan=-1))
    if shifted[shift] >= _FITS and shifted[shift] - usual >= _LESS:
        every = episodes.items()
        found = {number: _said(own[number], _shifted(steps, shift), _when(steps, shift)) for number, steps in every}
        return Fit(shifted[shift], found)
    if not usual >= _FITS:
        return Fit(np.nan, {})
    spread = 1.4826 * _median([abs(each - usual) for each in own.values()])
    astray = {}
    for number, fits in own.items():
        if fits < usual - max(_LESS, _SPREADS * spread):
            better, where = max(_others(number, episodes))
            if better >= usual - _AS_WELL:
                astray[number] = _said(fits, better, where)
            elif fits < _FITS_NOT:
                astray[number] = _said(fits)
    return Fit(usual, astray)


def _said(fits: float, better: float = 0, where: str = "") -> str:
    said = f"a correlation of {fits:.2f} with the motion of the robot"
    return f"{said}, and of {better:.2f} with that {where}" if where else said


def _others(number: int, episodes: Mapping[int, Steps]) -> Iterator[tuple[float, str]]:
    """Yield how well the pictures of an episode fit at other times, and in other episodes that are as long."""
    own = episodes[number]
    yield -1.0, ""
    for shift in _SHIFTS:
        yield np.nan_to_num(_shifted(own, shift), nan=-1), _when(own, shift)
    for other, steps in episodes.items():
        if other != number and len(steps.way) == len(own.way):
            yield np.nan_to_num(_correlation(own.change, steps.way), nan=-1), f"in episode {other}"


def _when(steps: Steps, shift: int) -> str:
    return f"{abs(shift) * steps.seconds:.2g} s {'before' if shift > 0 else 'after'}"


def _shifted(steps: Steps, shift: int) -> float:
    """Correlate pictures with the motion of so many steps before; nan where that is no shift, or too few are left."""
    n, before, after = len(steps.way), max(shift, 0), max(-shift, 0)
    if abs(shift) > n / 3 or n - abs(shift) < _MIN_STEPS or abs(shift) * steps.seconds < _LATE:
        return np.nan
    return _correlation(steps.change[before : n - after], steps.way[after : n - before])


def _correlation(change: Floats, way: Floats) -> float:
    """Correlate their roots, in which a large step does not outweigh all small ones; nan where one stands still."""
    both = np.sqrt(np.stack([change, way]))
    both -= both.mean(axis=1, keepdims=True)
    sizes = np.sqrt(np.square(both).sum(axis=1))
    return float(both.prod(axis=0).sum() / sizes.prod()) if sizes.min() > 1e-9 else np.nan


def _median(values: Sequence[float]) -> float:
    """Return what is usual; nan where too few are known."""
    known = [value for value in values if not np.isnan(value)]
    return float(np.median(known)) if len(known) >= _MIN_EPISODES else np.nan
