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
    turned = np.asarray(np.asarray(angle, dtype=np.float64) + np.pi)
    beyond = (turned < 0) | (turned >= 2 * np.pi)  # few: a remainder takes ten times as long as to look
    turned[beyond] = np.mod(turned[beyond], 2 * np.pi)
    wrapped = np.asarray(turned - np.pi)
    # Rounding can carry a tiny negative angle + pi to a whole turn, which is the excluded end of the interval.
    wrapped[wrapped >= np.pi] = -np.pi
    return wrapped


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


def turn_between(one: Floats, other: Floats) -> Floats:
    """Measure by how much two orientations in space differ: the angle of the one turn that leads from one to the other.

    Parameters
    ----------
    one, other : ndarray, float64[n, 4]
        Quaternions of length 1, both in the same order. A quaternion and its negative are the same orientation.

    Returns
    -------
    ndarray, float64[n]
        The angle [rad], in [0, pi].

    Examples
    --------
    >>> half = np.sqrt(0.5)
    >>> np.rad2deg(turn_between(np.array([[0, 0, 0, 1.0]]), np.array([[0, 0, half, half]]))).round(6)
    array([90.])
    """
    same_side = np.where((one * other).sum(axis=1, keepdims=True) < 0, -1.0, 1.0)  # (n, 1)
    apart, together = one - same_side * other, one + same_side * other  # (n, 4)
    # Twice the angle between the two as vectors; by halves, which is exact where an arc cosine is not: near 0.
    angle: Floats = 4 * np.arctan2(np.linalg.norm(apart, axis=1), np.linalg.norm(together, axis=1))
    return angle


def yaw_quaternions(yaw: Floats) -> Floats:
    """Turn yaws about the vertical axis into quaternions.

    Parameters
    ----------
    yaw : ndarray, float64[n_frames]
        Yaw [rad].

    Returns
    -------
    ndarray, float64[n_frames, 4]
        In the order x, y, z, w, as rerun has them.
    """
    zero = np.zeros_like(yaw)
    return np.stack([zero, zero, np.sin(yaw / 2), np.cos(yaw / 2)], axis=1)
