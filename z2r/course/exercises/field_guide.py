"""Exercises of `09_field_guide`: what is wrong with this dataset?"""

import shutil
import textwrap
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from z2r.api import audit, load
from z2r.arrays import Floats
from z2r.course import figures
from z2r.course.damage import delay_actions, shift_ranges, swap_sine_and_cosine
from z2r.course.exercises._core import NOT_ATTEMPTED, NOT_YET, RIGHT, Case, judge_function
from z2r.data import MESSY, STANDIN
from z2r.format.dataset import Dataset
from z2r.format.episodes import EpisodeIndex
from z2r.format.schema import ACTION, STATE
from z2r.pusht.world import PUSHT
from z2r.reading.decode import decode

# Every suspect, and what one would see of it.
SUSPECTS = {
    "two-episodes-merged": "one episode is about twice as long as before, and the block leaps in its middle",
    "ranges-one-frame-late": "every episode but the last ends with the first frame of the next one: a leap at its end",
    "files-in-wrong-order": "the lengths are right, but the block leaps anywhere inside the episodes",
    "sine-and-cosine-swapped": "no leap; every position is right and every direction mirrored, the target's too",
    "positions-in-millimetres": "distances of hundreds of metres; nothing reaches the target",
    "fps-three-times-too-high": "the pusher seems to move three times as fast as the action asks",
    "actions-one-frame-late": "the motion after a frame fits the action that is stored one frame later",
    "actions-one-frame-early": "the motion after a frame fits the action that is stored one frame earlier",
}


class _Damaged(NamedTuple):
    source: Path
    damage: Callable[[Path], None]
    answer: str


_DAMAGED = {
    "a": _Damaged(STANDIN, shift_ranges, "ranges-one-frame-late"),
    "b": _Damaged(MESSY, swap_sine_and_cosine, "sine-and-cosine-swapped"),
    "c": _Damaged(MESSY, delay_actions, "actions-one-frame-late"),
}


def make_dataset(name: str) -> Path:
    """Write a dataset with something wrong in it, and do not say what.

    Parameters
    ----------
    name : str
        ``a``, ``b`` or ``c``.

    Returns
    -------
    Path
        Its folder, below ``z2r-out``; what was there before is gone.
    """
    root = Path("z2r-out") / f"dataset-{name}"
    shutil.rmtree(root, ignore_errors=True)
    shutil.copytree(_DAMAGED[name].source, root)
    _DAMAGED[name].damage(root)
    return root


def check_diagnosis(name: str, answer: str | None) -> None:
    """Judge what the learner says is wrong with a dataset; if it is right, the audit has its say.

    Parameters
    ----------
    name : str
        Which dataset: ``a``, ``b`` or ``c``.
    answer : str or None
        One of `SUSPECTS`; None where there is no answer yet.
    """
    if answer is None:
        print(f"{NOT_ATTEMPTED}: put the name of a suspect, in quotes, in place of None, then run the cell again.")
    elif answer not in SUSPECTS:
        print(f"{NOT_YET}: {answer!r} is none of the suspects: {', '.join(SUSPECTS)}.")
    elif answer != _DAMAGED[name].answer:
        print(f"{NOT_YET}: of {answer} you would see this: {SUSPECTS[answer]}. Do the cells above show it?")
    else:
        print(f"{RIGHT}: {answer}. What z2r.audit says of it:")
        for finding in (each for each in audit(make_dataset(name)).findings if each.severity != "note"):
            print(textwrap.fill(f"[{finding.check}] {finding}", 100, subsequent_indent="    "))


def check_longest_steps(function: Callable[..., Any]) -> Figure | None:
    """Try a function that looks for leaps inside episodes.

    Parameters
    ----------
    function : callable
        Takes x and y of the block in every frame [m], and the episode index; returns for each episode the longest step
        that the block makes inside it, from one frame to the next [m].

    Returns
    -------
    Figure or None
        The episodes of the first case that went wrong.
    """
    cases = [
        Case("the episodes of messy", _block(load(MESSY))),
        Case("the episodes of standin", _block(load(STANDIN))),
        Case("two episodes of two frames", (np.array([0.0, 0.01, 0.5, 0.52]), np.zeros(4), _index(2, 2))),
    ]
    hint = "Step number k goes from frame k to frame k + 1. Which steps of the slice lead out of the episode?"
    wrong = judge_function(function, _longest_steps, cases, hint, untouched=_longest_steps_as_handed_out)
    return None if wrong is None else figures.episode_ribbon(wrong.args[2])


def check_match(function: Callable[..., Any]) -> Figure | None:
    """Try a function that says how well the motion fits the actions that are stored some frames later.

    Parameters
    ----------
    function : callable
        Takes the actions of an episode, float64[n_frames], the velocity from each frame to the next,
        float64[n_frames - 1], and by how many frames to look later; returns the correlation.

    Returns
    -------
    Figure or None
        The action and the motion of the first case that went wrong.
    """
    dataset = load(MESSY)
    first, second = _motion(dataset, 0), _motion(dataset, 5)
    cases = [
        Case("episode 0 of messy, no frame later", (*first, 0)),
        Case("episode 0 of messy, one frame later", (*first, 1)),
        Case("episode 5 of messy, three frames later", (*second, 3)),
    ]
    hint = "Velocity number k belongs to action number k + shift, and there are as many actions as velocities left."
    wrong = judge_function(function, _match, cases, hint)
    return None if wrong is None else figures.action_and_motion(wrong.args[0], wrong.args[1], dataset.schema.fps)


def _block(dataset: Dataset) -> tuple[Floats, Floats, EpisodeIndex]:
    tee = decode(dataset.read(STATE), PUSHT, dataset.schema).pose("tee")
    return tee.x, tee.y, dataset.episodes


def _longest_steps(x: Floats, y: Floats, episodes: EpisodeIndex) -> list[float]:
    parts = [episodes[i] for i in range(len(episodes))]
    return [float(np.hypot(np.diff(x[part]), np.diff(y[part])).max()) for part in parts]


def _longest_steps_as_handed_out(x: Floats, y: Floats, episodes: EpisodeIndex) -> list[float]:
    steps = np.hypot(np.diff(x), np.diff(y))
    return [float(steps[start:stop].max()) for start, stop in zip(episodes.from_index, episodes.to_index, strict=True)]


def _motion(dataset: Dataset, episode: int) -> tuple[Floats, Floats]:
    """Return the action along x in each frame of an episode, and the velocity from each frame to the next."""
    part = dataset.episodes[episode]
    x = decode(dataset.read(STATE)[part], PUSHT, dataset.schema).pose("pusher").x
    [place] = dataset.schema.columns(ACTION, ["pusher_vx"])
    return dataset.read(ACTION)[part][:, place].astype(np.float64), np.diff(x) * dataset.schema.fps


def _match(action: Floats, velocity: Floats, shift: int) -> float:
    later = action[shift:][: len(velocity)]
    return float(np.corrcoef(later, velocity[: len(later)])[0, 1])


def _index(*lengths: int) -> EpisodeIndex:
    to_index = np.cumsum(lengths, dtype=np.int64)
    return EpisodeIndex(to_index - np.array(lengths), to_index)
