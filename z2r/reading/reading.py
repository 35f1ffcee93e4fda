"""A reading: which named columns mean what, and within which tolerances.

It is data, so it can be printed, compared, and got wrong on purpose (`z2r.reading.breaks`). It names columns and never
counts them: where they stand is the schema's business.
"""

from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np

from z2r.arrays import Array, Floats
from z2r.format.schema import STATE, Schema
from z2r.pusht.task import ANG_TOL, POS_TOL
from z2r.reading.angles import decode_yaw


@dataclass(frozen=True)
class PoseColumns:
    """The names of the four columns that hold a planar pose."""

    x: str
    y: str
    sin_yaw: str
    cos_yaw: str

    @property
    def names(self) -> tuple[str, ...]:
        """All four, in the order x, y, sin, cos."""
        return self.x, self.y, self.sin_yaw, self.cos_yaw


@dataclass(frozen=True)
class Reading:
    """What the columns mean, and what follows from them.

    Attributes
    ----------
    feature : str
        The feature that holds the poses.
    pusher : tuple of two str
        Columns of the pusher's x and y [m].
    tee, target : PoseColumns
        Columns of the block's pose and of the pose where it should be.
    pos_tol : float
        How far the block may be from the target [m].
    ang_tol : float
        How far it may be turned away from it [rad].
    velocity : tuple of two str
        Columns of `action` that say how fast the pusher is to move along x and y [m/s].
    action_lag : int
        An action that is stored in a frame moves the pusher this many frames earlier.
    decisive : str
        Which frame of an episode says whether it reached the target: ``last`` or ``first``.
    wraps : bool
        Whether a difference of two yaws is wrapped into one turn.
    """

    feature: str
    pusher: tuple[str, str]
    tee: PoseColumns
    target: PoseColumns
    pos_tol: float
    ang_tol: float
    velocity: tuple[str, str]
    action_lag: int = 0
    decisive: Literal["first", "last"] = "last"
    wraps: bool = True

    @property
    def names(self) -> tuple[str, ...]:
        """Every column of `feature` that it reads."""
        return *self.pusher, *self.tee.names, *self.target.names

    def missing(self, schema: Schema) -> tuple[str, ...]:
        """Return the columns of this reading that are no numbers in the schema: where there are none, it fits."""
        feature = schema.signals().get(self.feature)
        dims = feature.dim_names if feature else ()
        return tuple(name for name in self.names if name not in dims)


class Pose(NamedTuple):
    """A planar pose for every frame: x and y [m], yaw [rad] in [-pi, pi], each float64[n_frames]."""

    x: Floats
    y: Floats
    yaw: Floats


PUSHT = Reading(
    feature=STATE,
    pusher=("pusher_x", "pusher_y"),
    tee=PoseColumns("tee_x", "tee_y", "sin_tee_yaw", "cos_tee_yaw"),
    target=PoseColumns("target_x", "target_y", "sin_target_yaw", "cos_target_yaw"),
    pos_tol=POS_TOL,
    ang_tol=ANG_TOL,
    velocity=("pusher_vx", "pusher_vy"),
)


def named_columns(state: Array, reading: Reading, schema: Schema) -> dict[str, Floats]:
    """Pick the columns that a reading names out of the state.

    Parameters
    ----------
    state : ndarray, (n_frames, size of the feature)
        Values of the feature that `reading` reads.
    reading : Reading
        Which columns.
    schema : Schema
        Where they stand.

    Returns
    -------
    dict of str to ndarray, float64[n_frames]

    Raises
    ------
    ValueError
        If the schema lacks one of them.
    """
    places = schema.columns(reading.feature, reading.names)
    return {name: state[:, place].astype(np.float64) for name, place in zip(reading.names, places, strict=True)}


def read_pose(columns: dict[str, Floats], pose: PoseColumns) -> Pose:
    """Decode a pose in every frame.

    Parameters
    ----------
    columns : dict of str to ndarray, float64[n_frames]
        From `named_columns`.
    pose : PoseColumns
        Which pose: ``reading.tee`` or ``reading.target``.
    """
    return Pose(columns[pose.x], columns[pose.y], decode_yaw(columns[pose.sin_yaw], columns[pose.cos_yaw]))
