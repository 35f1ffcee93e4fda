"""Which way is the block pointing? Decode a yaw that is stored as (sin, cos)."""

import numpy as np
from numpy.typing import ArrayLike

from z2r.arrays import Floats


def wrap_angle(angle: ArrayLike) -> Floats:
    """Bring angles into one turn.

    Parameters
    ----------
    angle : array_like of float
        Angles [rad], any finite value, any shape.

    Returns
    -------
    ndarray of float64, the shape of `angle`
        The same directions in [-pi, pi).

    Examples
    --------
    A heading of +179 degrees and one of -179 degrees are 2 degrees apart, not 358:

    >>> float(np.rad2deg(wrap_angle(np.deg2rad(179 - -179))).round(6))
    -2.0
    """
    angle = np.asarray(angle, dtype=np.float64)
    wrapped = np.mod(angle + np.pi, 2 * np.pi) - np.pi
    # Rounding can carry a tiny negative angle + pi to a whole turn, which is the excluded end of the interval.
    return np.where(wrapped >= np.pi, -np.pi, wrapped)


def decode_yaw(sin_yaw: ArrayLike, cos_yaw: ArrayLike) -> Floats:
    """Decode a yaw from its sine and cosine: ``atan2(sin, cos)``, in that order.

    Swapping the two arguments gives ``pi/2 - yaw``: the direction mirrored about 45 degrees.

    Parameters
    ----------
    sin_yaw, cos_yaw : array_like of float
        Sine and cosine of the yaw, in [-1, 1], of one shape.

    Returns
    -------
    ndarray of float64, the shape of the arguments
        Yaw [rad] in [-pi, pi], counter-clockwise from the x axis.

    Examples
    --------
    >>> float(np.rad2deg(decode_yaw(sin_yaw=0.5, cos_yaw=np.sqrt(3) / 2)).round(6))
    30.0
    """
    return np.arctan2(np.asarray(sin_yaw, dtype=np.float64), np.asarray(cos_yaw, dtype=np.float64))
