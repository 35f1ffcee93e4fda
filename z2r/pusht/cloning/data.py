"""What does a policy see, and what is it to do? Demonstrations, as somebody reads them, cut into examples.

One frame does not say enough. The expert keeps in mind which contact it chose and how fast it told the pusher to go,
and a frame holds neither; so an example has two frames and the action before, and asks for the next few actions at
once. All of it is seen from the block: what matters is where the pusher is on the block and which way the block has to
go, and a push is then the same push wherever the block lies. From the table, the raw numbers, it works less well.
"""

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from z2r.arrays import Array, Bools, Floats
from z2r.format.dataset import Dataset
from z2r.format.episodes import EpisodeIndex
from z2r.format.schema import ACTION, Schema
from z2r.pusht.task import TARGET_POSE
from z2r.reading.decode import decode
from z2r.reading.reading import Reading

CHUNK = 8  # actions that an example asks for: 0.8 s of them
# Left and right on the T are alike: mirrored about its stem, a demonstration is another demonstration.
MIRROR = np.array((-1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1, 1, -1.0))  # the sign of each input
MIRROR_ACTION = np.array((-1, 1.0))

type Vantage = Literal["block", "table"]
"""From where a policy sees the scene."""


class Examples(NamedTuple):
    """What to learn from: one example for each frame.

    Attributes
    ----------
    inputs : ndarray, float64[n, 13]
        From `inputs`.
    actions : ndarray, float64[n, CHUNK, 2]
        The action of the frame and of those after it [m/s], along the axes that `axes` says.
    there : ndarray, bool[n, CHUNK]
        Whether the episode, as it was read, has so many frames left.
    """

    inputs: Floats
    actions: Floats
    there: Bools


@dataclass(frozen=True)
class Scale:
    """What numbers are divided by before a network sees them, and what its answers are multiplied with.

    Nothing is subtracted: what is mirrored has a mean of 0.

    Attributes
    ----------
    inputs : ndarray, float64[13]
        Root mean square of each input.
    action : float
        Root mean square of all actions [m/s].
    """

    inputs: Floats
    action: float


def scale_of(examples: Examples) -> Scale:
    """Measure the scale of some examples; 1 for what is always 0."""
    size = np.sqrt(np.mean(examples.inputs**2, axis=0))
    return Scale(np.where(size > 0, size, 1.0), float(np.sqrt(np.mean(examples.actions[examples.there] ** 2))) or 1.0)


def read_examples(dataset: Dataset, reading: Reading, vantage: Vantage = "block") -> Examples:
    """Read demonstrations as a reading sees them, and cut them into examples.

    Parameters
    ----------
    dataset : Dataset
        From `z2r.load`, or what a break mode makes of it.
    reading : Reading
        One of PushT, right or wrong.
    vantage : str, optional
        From where the scene is seen.

    Raises
    ------
    DatasetError
        If a data file is missing, damaged, or not what the schema and the index say.
    """
    state, action = dataset.read(reading.feature), dataset.read(ACTION).astype(np.float64)
    return cut(see(state, reading, dataset.schema), action, dataset.episodes, vantage)


def see(state: Array, reading: Reading, schema: Schema) -> Floats:
    """Say where pusher and block are: x, y of the pusher, x, y [m] and yaw [rad] of the block, float64[n, 5]."""
    decoded = decode(state, reading, schema)
    pusher, tee = decoded.pose("pusher"), decoded.pose("tee")
    return np.stack([pusher.x, pusher.y, tee.x, tee.y, decoded.yaw("tee")], axis=1)


def cut(seen: Floats, action: Floats, episodes: EpisodeIndex, vantage: Vantage) -> Examples:
    """Cut frames, (n, 5), and actions, (n, 2), into an example for each frame of each episode."""
    now = episodes.frame_numbers  # (n,)
    first, last = (np.repeat(ends, episodes.lengths) for ends in (episodes.from_index, episodes.to_index - 1))
    before = np.maximum(now - 1, first)
    ahead = now[:, None] + np.arange(CHUNK)  # (n, CHUNK)
    before_it = np.where((now > first)[:, None], action[before], 0.0)  # an episode begins at rest
    chunk = turn(action[np.minimum(ahead, last[:, None])], -axes(seen[now], vantage)[:, None])  # (n, CHUNK, 2)
    return Examples(inputs(seen[now], seen[before], before_it, vantage), chunk, ahead <= last[:, None])


def inputs(now: Floats, before: Floats, action: Floats, vantage: Vantage) -> Floats:
    """Put two frames and the action between them into the numbers that a network sees.

    Parameters
    ----------
    now, before : ndarray, float64[n, 5]
        A frame and the one before it, from `see`.
    action : ndarray, float64[n, 2]
        The action taken in the frame before [m/s].
    vantage : str
        From where it is seen.

    Returns
    -------
    ndarray, float64[n, 13]
        Where the pusher is; where the target is, seen from the block, or the block, seen from the table; how that is
        turned (sine, cosine); the last action; by how much pusher and block have moved, and the block has turned.
    """
    pusher, tee, yaw = now[:, :2], now[:, 2:4], now[:, 4]
    way = -axes(now, vantage)  # turns what is along the axes of the table
    if vantage == "block":
        pusher, other, turned = pusher - tee, TARGET_POSE[:2] - tee, TARGET_POSE[2] - yaw
    else:
        other, turned = tee, yaw
    vectors = [pusher, other, action, now[:, :2] - before[:, :2], tee - before[:, 2:4]]
    seen = [turn(each, way) for each in vectors]
    seen.insert(2, np.stack([np.sin(turned), np.cos(turned)], axis=1))
    return np.concatenate([*seen, np.sin(yaw - before[:, 4])[:, None]], axis=1)


def axes(now: Floats, vantage: Vantage) -> Floats:
    """Say how the axes are turned along which actions are seen [rad], float64[n]: as the block is, or not at all."""
    return now[:, 4] if vantage == "block" else np.zeros(len(now))


def turn(vectors: Floats, angle: Floats) -> Floats:
    """Turn vectors (..., 2) counter-clockwise by an angle [rad], (...)."""
    x, y = vectors[..., 0], vectors[..., 1]
    return np.stack([np.cos(angle) * x - np.sin(angle) * y, np.sin(angle) * x + np.cos(angle) * y], axis=-1)
