"""How many reached the goal? The dataset does not say; its last frames do.

*Reached* is a reading: every goal holds in the last stored frame. *Success* is the environment's verdict, and may ask
for more. A recorder that stops when success latches never stores the observation after the last action, and the two can
differ.
"""

import numpy as np

from z2r.arrays import Bools, Floats
from z2r.reading.angles import turn_between, wrap_angle
from z2r.reading.decode import Decoded
from z2r.reading.goal import Goal
from z2r.reading.poses import Pose
from z2r.reading.reading import Reading

type FrameErrors = dict[str, Floats]
"""What each goal measures, by its name: ``pos_err`` [m], ``ang_err`` [rad] ..., each float64[n_frames]."""


def frame_errors(decoded: Decoded) -> FrameErrors:
    """Measure how far every frame is from each goal of the reading.

    Parameters
    ----------
    decoded : Decoded
        From `z2r.decode`.

    Returns
    -------
    dict of str to ndarray, float64[n_frames]
        By the names of the goals: a distance in the unit of the positions, a turn [rad] in [0, pi], or the value of a
        column.
    """
    return {goal.name: _error(decoded, goal) for goal in decoded.reading.goal}


def in_tolerance(errors: FrameErrors, reading: Reading) -> Bools:
    """Tell for every frame whether all goals of the reading, at least one, hold, bool[n_frames]."""
    fine: Bools = np.all([goal.holds(errors[goal.name]) for goal in reading.goal], axis=0)  # (n_goals, n_frames)
    return fine


def decisive_frame(n_frames: int, reading: Reading) -> int:
    """Say which of an episode's frames decides whether it reached the goal."""
    return n_frames - 1 if reading.decisive == "last" else 0


def episode_reached(decoded: Decoded) -> bool:
    """Tell whether an episode reached the goal: all goals hold in its decisive frame, which is the last stored one.

    Parameters
    ----------
    decoded : Decoded
        The frames of one episode, at least one, from `z2r.decode`.
    """
    frame = decisive_frame(len(decoded), decoded.reading)
    return bool(in_tolerance(frame_errors(decoded), decoded.reading)[frame])


def _error(decoded: Decoded, goal: Goal) -> Floats:
    if goal.column is not None:
        return decoded.columns[goal.column]
    one, other = (decoded.pose(name) for name in goal.poses)
    return _distance(one, other) if goal.distance else _turn(one, other, goal.wraps)


def _distance(one: Pose, other: Pose) -> Floats:
    flat: Floats = np.hypot(one.x - other.x, one.y - other.y)
    return flat if one.z is None or other.z is None else np.hypot(flat, one.z - other.z)


def _turn(one: Pose, other: Pose, wraps: bool) -> Floats:
    if one.quaternion is not None and other.quaternion is not None:
        return turn_between(one.quaternion, other.quaternion)
    assert one.yaw is not None
    assert other.yaw is not None  # a reading lets two orientations of one kind alone be compared
    turn = one.yaw - other.yaw
    difference: Floats = np.abs(wrap_angle(turn) if wraps else turn)
    return difference
