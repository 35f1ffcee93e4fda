"""How many reached the target? The dataset does not say; its last frames do.

*Reached* is a reading: the last stored frame is in tolerance. *Success* is the environment's verdict: in tolerance for
five control steps in a row. The recorder stops when success latches, so the observation after the last action is never
stored, and the two can differ.
"""

from typing import NamedTuple

import numpy as np

from z2r.arrays import Array, Bools, Floats
from z2r.format.schema import Schema
from z2r.reading.angles import wrap_angle
from z2r.reading.reading import Reading, named_columns, read_pose


class FrameErrors(NamedTuple):
    """How far the block is from the target: distance [m] and yaw [rad] in [0, pi], each float64[n_frames]."""

    pos_err: Floats
    ang_err: Floats


def frame_errors(state: Array, reading: Reading, schema: Schema) -> FrameErrors:
    """Measure how far the block is from the target in every frame.

    Parameters
    ----------
    state : ndarray, (n_frames, size of the feature)
        Values of the feature that `reading` reads.
    reading : Reading
        What the columns mean.
    schema : Schema
        Where the columns stand.
    """
    columns = named_columns(state, reading, schema)
    tee, target = read_pose(columns, reading.tee), read_pose(columns, reading.target)
    pos_err = np.hypot(tee.x - target.x, tee.y - target.y)
    turn = tee.yaw - target.yaw
    ang_err = np.abs(wrap_angle(turn) if reading.wraps else turn)
    return FrameErrors(pos_err, ang_err)


def in_tolerance(errors: FrameErrors, reading: Reading) -> Bools:
    """Tell for every frame whether both errors are within the reading's tolerances, bool[n_frames]."""
    return (errors.pos_err <= reading.pos_tol) & (errors.ang_err <= reading.ang_tol)


def episode_reached(state: Array, reading: Reading, schema: Schema) -> bool:
    """Tell whether an episode reached the target: its decisive frame, the last stored one, is in tolerance.

    Parameters
    ----------
    state : ndarray, (n_frames, size of the feature)
        The frames of one episode, at least one.
    reading : Reading
        What the columns mean.
    schema : Schema
        Where the columns stand.
    """
    decisive_frame = state[-1:] if reading.decisive == "last" else state[:1]
    return bool(in_tolerance(frame_errors(decisive_frame, reading, schema), reading)[0])
