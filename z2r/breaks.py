"""How do I know that I read it right? Read it wrong on purpose, and learn what that looks like.

A break mode is a reading, or an episode index, with one assumption wrong. The data never changes; what is believed
about it does, and each wrong belief leaves a signature.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # the command line lists the modes in its help, which must not wait for numpy and pyarrow
    from z2r.episodes import EpisodeIndex
    from z2r.reading import PoseColumns, Reading


@dataclass(frozen=True)
class BreakMode:
    """One way to read a dataset wrong.

    Attributes
    ----------
    name : str
        What `--break` takes.
    assumption : str
        What it gets wrong, in a few words.
    signature : str
        What that looks like.
    reading : callable
        Turns the right reading into the wrong one.
    episodes : callable
        Turns the right episode index into the wrong one.
    """

    name: str
    assumption: str
    signature: str
    reading: Callable[[Reading], Reading] = lambda reading: reading
    episodes: Callable[[EpisodeIndex], EpisodeIndex] = lambda episodes: episodes


def _swap(pose: PoseColumns) -> PoseColumns:
    return replace(pose, sin_yaw=pose.cos_yaw, cos_yaw=pose.sin_yaw)


BREAK_MODES: dict[str, BreakMode] = {
    mode.name: mode
    for mode in (
        BreakMode(
            name="yaw-swap",
            assumption="the block's yaw is atan2(cos, sin)",
            signature="same frames and lengths; the success rate collapses; the block is drawn turned the wrong way",
            reading=lambda reading: replace(reading, tee=_swap(reading.tee)),
        ),
        BreakMode(
            name="drop-boundaries",
            assumption="there are no episodes",
            signature="all episodes become one, a success rate of 0/1 or 1/1; the block teleports",
            episodes=lambda episodes: episodes.merged(),
        ),
        BreakMode(
            name="yaw-swap-everywhere",
            assumption="every yaw is atan2(cos, sin), the target's too",
            signature="the two mistakes cancel: the success rate stays; every direction is mirrored, no position is",
            reading=lambda reading: replace(reading, tee=_swap(reading.tee), target=_swap(reading.target)),
        ),
    )
}


def break_mode(name: str) -> BreakMode:
    """Look a break mode up.

    Raises
    ------
    ValueError
        If there is none of that name; the message lists those that there are.
    """
    if name not in BREAK_MODES:
        raise ValueError(f"found break mode {name!r}, expected one of {', '.join(BREAK_MODES)}")
    return BREAK_MODES[name]
