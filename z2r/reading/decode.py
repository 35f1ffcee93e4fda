"""What do these numbers mean? The columns of some frames as a reading sees them."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from z2r.arrays import Array, Columns, Floats, stack_columns
from z2r.format.schema import ACTION, Schema
from z2r.reading.poses import Pose, read_pose
from z2r.reading.reading import Reading, locate


@dataclass(frozen=True, eq=False)
class Decoded:
    """Some frames as a reading sees them.

    Attributes
    ----------
    reading : Reading
        What the columns mean.
    columns : dict of str to ndarray, float64[n_frames]
        The columns that its poses and goals read, by the names that it uses.
    action : ndarray, float64[n_frames, n], or None
        The columns of its action; None where the frames have none.
    """

    reading: Reading
    columns: dict[str, Floats]
    action: Floats | None

    def __len__(self) -> int:
        return len(next(iter(self.columns.values()), ()))

    def __repr__(self) -> str:
        return f"Decoded({len(self):,} frames read as {self.reading.name}: {', '.join(self.columns)})"

    def pose(self, name: str) -> Pose:
        """Decode the pose of a body, such as ``tee``: once, for its angles are what costs."""
        if name not in self._poses:
            self._poses[name] = read_pose(self.columns, self.reading.poses[name])
        return self._poses[name]

    @cached_property
    def _poses(self) -> dict[str, Pose]:
        return {}

    def yaw(self, name: str) -> Floats:
        """Decode the yaw of a body [rad], float64[n_frames].

        Raises
        ------
        ValueError
            If its pose has none.
        """
        yaw = self.pose(name).yaw
        if yaw is None:
            raise ValueError(f"found no yaw of {name}, expected one in the reading {self.reading.name}")
        return yaw

    def direction(self, name: str) -> tuple[Floats, Floats]:
        """Return cosine and sine of the yaw of a body, which its reading has: each float64[n_frames]."""
        yaw = self.reading.poses[name].yaw
        assert yaw is not None
        return yaw.direction(self.columns)

    def take(self, frames: slice | Array) -> "Decoded":
        """Return some of the frames."""
        action = None if self.action is None else self.action[frames]
        return Decoded(self.reading, {name: values[frames] for name, values in self.columns.items()}, action)


def decode(frames: Columns | Array, reading: Reading, schema: Schema) -> Decoded:
    """Say what some frames mean.

    Parameters
    ----------
    frames : dict of str to ndarray, or ndarray, (n_frames, size of the feature)
        Values by feature; or those of the one feature that `reading` reads.
    reading : Reading
        What the columns mean.
    schema : Schema
        Where the columns stand.

    Raises
    ------
    ValueError
        If the schema or the frames lack a column of the reading.

    Examples
    --------
    >>> import z2r
    >>> dataset = z2r.load(z2r.STANDIN)
    >>> last = z2r.decode(dataset.read("observation.state")[-1:], z2r.PUSHT, dataset.schema)
    >>> last.pose("tee").yaw.round(3)
    array([0.163])
    """
    features = frames if isinstance(frames, dict) else {reading.feature: frames}
    return Decoded(reading, named_columns(features, reading, schema), _action(features, reading, schema))


def named_columns(frames: Columns | Array, reading: Reading, schema: Schema) -> dict[str, Floats]:
    """Pick the columns that a reading names out of some frames; the arguments are those of `decode`.

    Returns
    -------
    dict of str to ndarray, float64[n_frames]

    Raises
    ------
    ValueError
        If the schema or the frames lack one of them.
    """
    features = frames if isinstance(frames, dict) else {reading.feature: frames}
    places = {name: locate(name, reading.feature, schema) for name in reading.names}
    return {name: _column(features, *place) for name, place in places.items()}


def features_of(reading: Reading, schema: Schema) -> tuple[str, ...]:
    """Return the features that a reading reads, those of its action included where they are there."""
    names = {locate(name, reading.feature, schema)[0] for name in reading.names}
    if reading.action and not reading.missing_action(schema):
        names |= {locate(name, ACTION, schema)[0] for name in reading.action.columns}
    return tuple(name for name in schema.features if name in names)


def can_decode(frames: Columns, reading: Reading, schema: Schema) -> bool:
    """Tell whether some frames have all columns that a reading reads, those of its action included if it has one."""
    try:
        return set(features_of(reading, schema)) <= set(frames)
    except ValueError:
        return False


def _column(features: Mapping[str, Array], feature: str, dim: int) -> Floats:
    if feature not in features:
        raise ValueError(f"no feature {feature!r} among the frames: {', '.join(features)}")
    return features[feature][:, dim].astype(np.float64)


def _action(features: Mapping[str, Array], reading: Reading, schema: Schema) -> Floats | None:
    if reading.action is None or reading.missing_action(schema):
        return None
    places = [locate(name, ACTION, schema) for name in reading.action.columns]
    if not {feature for feature, _ in places} <= set(features):
        return None
    return stack_columns([_column(features, *place) for place in places])
