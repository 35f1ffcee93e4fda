"""What can somebody believe of an action that drives a pusher, and be wrong? Break modes of this task.

Those that any dataset may be read under are in `z2r.reading.breaks`.
"""

from collections.abc import Callable
from functools import partial

import numpy as np

from z2r.arrays import Floats
from z2r.errors import count
from z2r.format.episodes import EpisodeIndex
from z2r.format.misread import Misread
from z2r.format.schema import ACTION, STATE, Schema
from z2r.pusht.task import CONTROL_HZ
from z2r.reading.breaks import BreakMode
from z2r.reading.reading import Reading

type _Change = Callable[[Floats, Floats, EpisodeIndex], Floats]
"""Takes the action and the place of the pusher, both (n, 2), and the episodes; returns what the action is taken for."""


def _stored_late(by: int, action: Floats, _: Floats, episodes: EpisodeIndex) -> Floats:
    frames, first = episodes.frame_numbers, np.repeat(episodes.from_index, episodes.lengths)
    late = np.zeros_like(action)  # an episode begins at rest, and its last actions are stored nowhere
    late[frames] = np.where((frames - by >= first)[:, None], action[frames - by], 0.0)
    return late


def _exchanged(action: Floats, _: Floats, __: EpisodeIndex) -> Floats:
    return action[:, ::-1]


def _in_centimetres(action: Floats, _: Floats, __: EpisodeIndex) -> Floats:
    return action / 100


def _steps(times: int, _: Floats, pusher: Floats, episodes: EpisodeIndex) -> Floats:
    steps = times * np.diff(pusher, axis=0, append=pusher[-1:])
    steps[episodes.to_index - 1] = 0.0  # what comes after the last frame of an episode is another one
    return steps


def _belief(name: str, assumption: str, signature: str, change: _Change) -> BreakMode:
    return BreakMode(name, assumption, signature, misread=partial(_misread, change))


def _misread(change: _Change, _: Schema, __: Reading | None) -> Misread:
    return Misread(((ACTION, 0), (ACTION, 1)), partial(_split, change), beside=((STATE, 0), (STATE, 1)))


def _split(change: _Change, values: Floats, episodes: EpisodeIndex) -> Floats:
    return change(values[:, :2], values[:, 2:], episodes)


BELIEFS: dict[str, BreakMode] = {
    belief.name: belief
    for belief in (
        *(
            _belief(
                f"late-{by}",
                f"actions that are stored {count(by, 'frame')} late belong to the frames that they are stored in",
                "the action explains a step that was made before it",
                partial(_stored_late, by),
            )
            for by in (1, 2, 5)
        ),
        _belief(
            "exchanged",
            "the action is vy, vx",
            "the pusher does along one axis what it is asked to do along the other",
            _exchanged,
        ),
        _belief(
            "centimetres",
            "the action is in cm/s",
            "the pusher moves a hundred times as far as it is asked to",
            _in_centimetres,
        ),
        _belief(
            "step-for-velocity",
            "how far the pusher moved until the next frame [m] is the action [m/s]",
            "the pusher moves ten times as far as it is asked to",
            partial(_steps, 1),
        ),
        *(
            _belief(
                f"velocity-by-{fps}-fps",
                f"the action is how far the pusher moved until the next frame, times {fps}",
                says,
                partial(_steps, fps),
            )
            for fps, says in (
                (CONTROL_HZ, "what is asked for is what is done, without the noise of a command"),
                (3 * CONTROL_HZ, "the pusher moves a third as far as it is asked to"),
            )
        ),
    )
}
