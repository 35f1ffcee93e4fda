"""Does the picture move when the robot does? How far it changes from one picture to the next, against how far it comes.

Only the dataset itself says what to expect: in a camera that sees little of the robot, little fits, and then nothing is
said. An episode that fits far less than the others shows something else: another episode, or another time.
"""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

import numpy as np

from z2r.arrays import Floats

_MIN_EPISODES = 5  # from fewer nothing can be said about what is usual
_MIN_STEPS = 12  # from picture to picture: fewer say little about how two things move together
_DELAYS = [tenths / 10 for tenths in range(-4, 5)]  # s: a camera may well be late by so much, always alike
_SHIFTS = [sign * quarters / 4 for quarters in range(2, 21) for sign in (-1, 1)]  # s: that is no delay
_RESTS = 1e-9  # of what moves
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
    episodes = {number: steps for number, steps in episodes.items() if steps.seconds > 0}
    usual, delay = max((_usual(episodes, delay), delay) for delay in _DELAYS)
    own = {number: fits for number, steps in episodes.items() if (fits := _shifted(steps, delay)) > -1}
    better, shift = max((_usual(episodes, shift), shift) for shift in _SHIFTS)
    if better >= _FITS and better - usual >= _LESS:
        found = {number: (fits, _shifted(episodes[number], shift), _when(shift)) for number, fits in own.items()}
        return Fit(better, {number: _said(*said) for number, said in found.items()})
    if not usual >= _FITS:
        return Fit(np.nan, {})
    spread = 1.4826 * float(np.median([abs(each - usual) for each in own.values()]))
    astray = {}
    for number, fits in own.items():
        if fits < usual - max(_LESS, _SPREADS * spread):
            better, where = max(_others(number, episodes, delay))
            if better >= usual - _AS_WELL:
                astray[number] = _said(fits, better, where)
            elif fits < _FITS_NOT:
                astray[number] = _said(fits)
    return Fit(usual, astray)


def _said(fits: float, better: float = 0, where: str = "") -> str:
    said = f"a correlation of {fits:.2f} with the motion of the robot"
    return f"{said}, and of {better:.2f} with that {where}" if where else said


def _others(number: int, episodes: Mapping[int, Steps], delay: float) -> Iterator[tuple[float, str]]:
    """Yield how well the pictures of an episode fit at other times, and in other episodes that are as long."""
    own = episodes[number]
    for shift in _SHIFTS:
        yield _shifted(own, shift), _when(shift)
    for other, steps in episodes.items():
        if other != number and len(steps.way) == len(own.way):
            yield _shifted(own._replace(way=steps.way), delay), f"in episode {other}"


def _when(shift: float) -> str:
    return f"{abs(shift):g} s {'before' if shift > 0 else 'after'}"


def _usual(episodes: Mapping[int, Steps], shift: float) -> float:
    """Return the correlation that is usual with the motion of so many seconds before; -1 where too few say anything."""
    known = [fits for steps in episodes.values() if (fits := _shifted(steps, shift)) > -1]
    return float(np.median(known)) if len(known) >= _MIN_EPISODES else -1.0


def _shifted(steps: Steps, shift: float) -> float:
    """Correlate pictures with the motion of so many seconds before; -1 where that says nothing.

    So it is where too little of the episode is left, where a step takes longer, and where one of the two rests. It is
    their roots that are correlated, in which a large step does not outweigh all small ones.
    """
    n, by = len(steps.way), round(shift / steps.seconds)
    before, after = max(by, 0), max(-by, 0)
    if abs(by) > n / 3 or n - abs(by) < _MIN_STEPS or (not by and shift in _SHIFTS):
        return -1.0
    both = np.sqrt(np.stack([steps.change[before : n - after], steps.way[after : n - before]]))
    both -= both.mean(axis=1, keepdims=True)
    sizes = np.sqrt(np.square(both).sum(axis=1))
    return float(both.prod(axis=0).sum() / sizes.prod()) if sizes.min() > _RESTS else -1.0
