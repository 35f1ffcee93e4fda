"""Where is a body, and how is it turned? A pose, and the columns that hold it.

The classes here are parts of a reading file: what stands in one is what may stand in the file.
"""

from collections.abc import Mapping
from typing import NamedTuple

import msgspec
import numpy as np

from z2r.arrays import Floats, lengths
from z2r.reading.angles import decode_yaw


class YawColumns(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True, kw_only=True):
    """The columns that hold a yaw: ``sin`` and ``cos``, or ``rad``, or ``deg``.

    Attributes
    ----------
    sin, cos : str, optional
        Columns of its sine and its cosine.
    rad, deg : str, optional
        The column that holds it in radians, or in degrees.

    Raises
    ------
    ValueError
        If it is none of the three, or more than one.
    """

    sin: str | None = None
    cos: str | None = None
    rad: str | None = None
    deg: str | None = None

    def __post_init__(self) -> None:
        given = tuple(name for name in self.__struct_fields__ if getattr(self, name) is not None)
        if given not in (("sin", "cos"), ("rad",), ("deg",)):
            raise ValueError(f"found {' and '.join(given) or 'nothing'}, expected sin and cos, or rad, or deg")

    @property
    def names(self) -> tuple[str, ...]:
        """Every column that it reads."""
        return tuple(name for name in (self.sin, self.cos, self.rad, self.deg) if name is not None)

    @property
    def formula(self) -> str:
        """How it is decoded, such as ``atan2(sin_tee_yaw, cos_tee_yaw)``."""
        if self.sin is not None:
            return f"atan2({self.sin}, {self.cos})"
        return self.rad if self.rad is not None else f"radians({self.deg})"

    def decode(self, columns: Mapping[str, Floats]) -> Floats:
        """Decode the yaw [rad] of every frame, float64[n_frames]; in [-pi, pi] where it is stored as (sin, cos)."""
        if self.sin is not None and self.cos is not None:
            return decode_yaw(columns[self.sin], columns[self.cos])
        return columns[self.rad] if self.rad is not None else np.deg2rad(columns[str(self.deg)])

    def direction(self, columns: Mapping[str, Floats]) -> tuple[Floats, Floats]:
        """Return cosine and sine of the yaw in every frame, each float64[n_frames]; as they are stored, where they are.

        They are brought to length 1. Of a sine and a cosine that are both 0 the yaw is 0, as for `decode`.
        """
        if self.sin is None or self.cos is None:
            yaw = self.decode(columns)
            return np.cos(yaw), np.sin(yaw)
        cosine, sine = columns[self.cos], columns[self.sin]
        length = lengths(cosine, sine)
        one, other = np.ones(len(length)), np.zeros(len(length))
        np.divide(cosine, length, out=one, where=length > 0)
        np.divide(sine, length, out=other, where=length > 0)
        return one, other


class QuaternionColumns(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True, kw_only=True):
    """The four columns that hold an orientation in space, in the order that the key says: ``xyzw`` or ``wxyz``.

    Raises
    ------
    ValueError
        If none of the two is given, or both: a quaternion without its order is a guess.
    """

    xyzw: tuple[str, str, str, str] | None = None
    wxyz: tuple[str, str, str, str] | None = None

    def __post_init__(self) -> None:
        if (self.xyzw is None) == (self.wxyz is None):
            raise ValueError("found no order of the quaternion, or two, expected xyzw = [...] or wxyz = [...]")

    @property
    def names(self) -> tuple[str, ...]:
        """Its columns, in the order x, y, z, w."""
        if self.wxyz is not None:
            return *self.wxyz[1:], self.wxyz[0]
        return self.xyzw or ()

    @property
    def formula(self) -> str:
        """How it is decoded, such as ``quaternion xyzw(qx, qy, qz, qw)``."""
        return f"quaternion xyzw({', '.join(self.names)})"

    def decode(self, columns: Mapping[str, Floats]) -> Floats:
        """Return the quaternion of every frame in the order x, y, z, w, of length 1, float64[n_frames, 4]."""
        four = np.stack([columns[name] for name in self.names], axis=1)  # (n, 4)
        unit: Floats = four / np.linalg.norm(four, axis=1, keepdims=True)
        return unit


class PoseColumns(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True):
    """The columns that hold the pose of one body.

    Attributes
    ----------
    x, y : str
        Columns of its position.
    z : str, optional
        Column of its height; none in a plane.
    yaw : YawColumns, optional
        How it is turned in the plane.
    quaternion : QuaternionColumns, optional
        How it is turned in space. One of the two at most.
    unit : str
        Of the position.
    """

    x: str
    y: str
    z: str | None = None
    yaw: YawColumns | None = None
    quaternion: QuaternionColumns | None = None
    unit: str = "m"

    def __post_init__(self) -> None:
        if self.yaw is not None and self.quaternion is not None:
            raise ValueError("found yaw and quaternion, expected one of them at most")

    @property
    def position(self) -> tuple[str, ...]:
        """Columns of the position, two in a plane and three in space."""
        return (self.x, self.y) if self.z is None else (self.x, self.y, self.z)

    @property
    def orientation(self) -> YawColumns | QuaternionColumns | None:
        """Columns of the orientation, where there is one."""
        return self.yaw or self.quaternion

    @property
    def names(self) -> tuple[str, ...]:
        """Every column that it reads."""
        return *self.position, *(self.orientation.names if self.orientation else ())


class Pose(NamedTuple):
    """The pose of one body in every frame.

    Attributes
    ----------
    x, y : ndarray, float64[n_frames]
        Its position, in the unit of its columns.
    yaw : ndarray, float64[n_frames], or None
        How it is turned in the plane [rad], counter-clockwise from the x axis.
    z : ndarray, float64[n_frames], or None
        Its height; None in a plane.
    quaternion : ndarray, float64[n_frames, 4], or None
        How it is turned in space: x, y, z, w, of length 1.
    """

    x: Floats
    y: Floats
    yaw: Floats | None = None
    z: Floats | None = None
    quaternion: Floats | None = None


def read_pose(columns: Mapping[str, Floats], pose: PoseColumns) -> Pose:
    """Decode a pose in every frame.

    Parameters
    ----------
    columns : mapping of str to ndarray, float64[n_frames]
        From `z2r.named_columns`.
    pose : PoseColumns
        Which pose, such as ``reading.poses["tee"]``.
    """
    return Pose(
        x=columns[pose.x],
        y=columns[pose.y],
        yaw=pose.yaw.decode(columns) if pose.yaw else None,
        z=columns[pose.z] if pose.z is not None else None,
        quaternion=pose.quaternion.decode(columns) if pose.quaternion else None,
    )
