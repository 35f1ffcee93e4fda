"""Is there anything of the colour that a task names? Plain words only: red, yellow, green and blue.

Nobody can say which thing a word means. But where a task speaks of yellow, and no picture of its episodes has any while
they have plenty of another colour, or where two tasks end each with the colour of the other, words and pictures differ.
"""

import re
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from z2r.arrays import Floats, Ints

NAMES = ("red", "yellow", "green", "blue")
_FROM, _TO = np.array([-25, 38, 75, 180]), np.array([20, 75, 180, 270])  # degrees of hue, as in HSV
_FAINT, _CLEAR = 0.25, 0.5  # of saturation: something of it, and no doubt
_BRIGHT = 50  # of 255: what is darker has no colour that one would name
_EACH = 4  # of the pictures, of which one is looked at
_PLENTY, _NONE = 0.002, 0.0005  # of a picture: six cells of 3,072; and one, as the edge of a thing may be
_ENDS, _RATIO = 0.01, 8  # of the last picture; and times as much as of the colour that is named


class Misnamed(NamedTuple):
    """Episodes of a task, by their rows, whose pictures have not the colour that it names, and what they have."""

    task: int
    rows: Ints
    found: str
    expected: str


def hues_of(colours: NDArray[np.floating[Any]]) -> Floats:
    """Return which shares of pictures (n, height, width, 3) are of each named colour: float64[3, 4].

    Of whatever has something of it, and of what has it clearly, the most in any picture; and the latter in the last.
    """
    some = np.concatenate([colours[:-1:_EACH], colours[-1:]]).reshape(-1, colours.shape[1] * colours.shape[2], 3)
    red, green, blue = np.moveaxis(some, -1, 0)
    high = some.max(axis=-1)
    span = high - some.min(axis=-1)
    spans = np.maximum(span, 1)
    sixth = np.where(high == red, (green - blue) / spans, np.where(high == green, 2 + (blue - red) / spans, 0))
    sixth = np.where((high == blue) & (high > red) & (high > green), 4 + (red - green) / spans, sixth)
    hue = 60 * sixth[..., None]
    inside = (hue >= _FROM) & (hue < _TO) & (high >= _BRIGHT)[..., None]
    faint, clear = (
        (inside & (span >= least * high)[..., None]).mean(axis=1, dtype=np.float64) for least in (_FAINT, _CLEAR)
    )
    hues: Floats = np.stack([faint.max(axis=0), clear.max(axis=0), clear[-1]])
    return hues


def named_in(text: str) -> list[int]:
    """Return which of `NAMES` stand in a text.

    >>> named_in("Put the red cube into the Blue bowl"), named_in("reduce")
    ([0, 3], [])
    """
    words = set(re.findall(r"[a-z]+", text.casefold()))
    return [place for place, name in enumerate(NAMES) if name in words]


def misnamed(
    cameras: Sequence[Mapping[int, Floats]], tasks: Mapping[int, int], texts: Mapping[int, str]
) -> list[Misnamed]:
    """Find the tasks that name a colour of which nothing is seen, or that of another task.

    Parameters
    ----------
    cameras : sequence of dict of int to ndarray
        Of each camera the hues of each episode, by its row; only what all of them show counts.
    tasks : dict of int to int
        The task of each episode.
    texts : dict of int to str
        What they say.
    """
    seen = {row: np.max([each[row] for each in cameras], axis=0) for row in tasks if all(row in c for c in cameras)}
    found, ends = list[Misnamed](), dict[int, tuple[int, Floats, Ints]]()
    for task, text in texts.items() if cameras else ():
        rows, named = np.array([row for row in seen if tasks[row] == task], dtype=np.int64), named_in(text)
        if not len(rows) or not named:
            continue
        most = np.max([seen[row] for row in rows.tolist()], axis=0)
        others = [place for place in range(len(NAMES)) if place not in named and most[1, place] >= _PLENTY]
        missing = [place for place in named if most[0, place] <= _NONE]
        if missing and others:
            has = " and ".join(f"{most[1, place]:.1%} {NAMES[place]}" for place in others)
            found.append(Misnamed(task, rows, f"pictures with up to {has}", f"something {NAMES[missing[0]]}"))
        elif len(named) == 1:
            ends[task] = named[0], np.median([seen[row][2] for row in rows.tolist()], axis=0), rows
    for task, (own, last, rows) in ends.items():
        shown = int(last.argmax())
        is_of_another = last[shown] >= max(_ENDS, _RATIO * last[own])
        if is_of_another and any(name == shown and int(other.argmax()) != shown for name, other, _ in ends.values()):
            what = f"last pictures with {last[shown]:.1%} {NAMES[shown]} and {last[own]:.1%} {NAMES[own]}"
            found.append(Misnamed(task, rows, what, f"more {NAMES[own]} than that"))
    return found
