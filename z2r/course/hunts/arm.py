"""What do the hunts know of `arm`? Its episodes, column by column, which of them did their task, and what can go wrong.

What goes wrong makes new frames of some frames; arrays are never written to.
"""

import numpy as np

from z2r.arrays import Floats
from z2r.course.hunts._frames import COMMAND, Frames, episodes_of, side_by_side
from z2r.data import ARM

PLACED, LIFTED = (0, 1, 2, 3, 5, 6, 7), (8, 9, 10)
"""The episodes that did it, by task: the verdict beside the dataset says so."""
NOT_PLACED, NOT_LIFTED = (4,), (11, 12)
"""Those that did not: dropped on the way; lifted beside the goal, and missed."""

JOINTS = tuple(f"{joint}.pos" for joint in ("shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll"))
"""The joints that are angles [deg]."""
JAWS = "gripper.pos"
"""How far open the jaws are [percent]."""
_AXES = ("x", "y", "z")


def episode(number: int) -> Frames:
    """Return the columns of one episode, which are the caller's own."""
    return episodes_of(ARM)[number]


def commands(frames: Frames) -> Floats:
    """Return what the joints were told, the jaws last, float64[n_frames, 6]."""
    return side_by_side(frames, [COMMAND + joint for joint in (*JOINTS, JAWS)])


def joints(frames: Frames) -> Floats:
    """Return where the joints were, the jaws last, float64[n_frames, 6]."""
    return side_by_side(frames, (*JOINTS, JAWS))


def elsewhere(rng: np.random.Generator, frames: Frames) -> Frames:
    """Move cube and goal together: another place, and a table of another height."""
    for axis, reach in zip(_AXES, (0.3, 0.3, 0.4), strict=True):
        moved = rng.uniform(-reach, reach)
        frames = frames | {f"{body}_{axis}": frames[f"{body}_{axis}"] + moved for body in ("block", "goal")}
    return frames


def later(frames: Frames, prefix: str, n: int) -> Frames:
    """Store what columns of this prefix were `n` frames before, or will be if it is negative; the rest is cut off."""
    own, other = (slice(None, -n), slice(n, None)) if n > 0 else (slice(-n, None), slice(None, n))
    return {name: values[own if name.startswith(prefix) else other] for name, values in frames.items()}


def in_radians(frames: Frames, joint: str) -> Frames:
    """Store one joint in radians, and its command in degrees."""
    return frames | {joint: np.deg2rad(frames[joint])}


def exchanged(frames: Frames, one: str, other: str) -> Frames:
    """Exchange two columns."""
    return frames | {one: frames[other], other: frames[one]}


def stuck(frames: Frames, first: int, n: int) -> Frames:
    """Let all encoders tell the same for some frames, while everything goes on."""
    rows = np.arange(len(frames[JAWS]))
    rows[first : first + n] = first
    return frames | {joint: frames[joint][rows] for joint in (*JOINTS, JAWS)}


def with_jaws_turned_round(frames: Frames) -> Frames:
    """Take open for closed: where the jaws are, and where they are told to be."""
    return frames | {name: 100 - frames[name] for name in (JAWS, COMMAND + JAWS)}


def with_cube_for_goal(frames: Frames) -> Frames:
    """Take cube and goal for each other."""
    for axis in _AXES:
        frames = exchanged(frames, f"block_{axis}", f"goal_{axis}")
    return frames


def upside_down(frames: Frames) -> Frames:
    """Take up for down."""
    return frames | {name: -frames[name] for name in ("block_z", "goal_z")}


def in_millimetres(frames: Frames) -> Frames:
    """Take millimetres for metres, of cube and goal."""
    names = [f"{body}_{axis}" for body in ("block", "goal") for axis in _AXES]
    return frames | {name: 1000 * frames[name] for name in names}
