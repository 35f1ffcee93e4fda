"""Which columns of the state are joints, angles, grippers? By what the reading says, or else by their names."""

from collections.abc import Iterator, Mapping
from typing import NamedTuple

from z2r.format.schema import ACTION, STATE, Schema
from z2r.reading.reading import ColumnMeaning, Reading, is_there, locate

type Place = tuple[str, int]
"""A feature, and a dimension of it."""


class Joint(NamedTuple):
    """A column of the state that a column of the action drives.

    Attributes
    ----------
    name : str
        What to call it: the column of the state.
    action, state : Place
        Where the two stand.
    unit : str
        Of the state, or else of the action; empty where nobody says.
    """

    name: str
    action: Place
    state: Place
    unit: str

    @property
    def is_gripper(self) -> bool:
        """Whether it is one, by its name."""
        return is_gripper(self.name)


def is_gripper(name: str) -> bool:
    """Tell whether a column is called a gripper.

    >>> is_gripper("left_gripper"), is_gripper("wrist_roll.pos")
    (True, False)
    """
    return "gripper" in name.lower()


def joints_of(schema: Schema, reading: Reading | None) -> list[Joint]:
    """Pair the columns of the action with those that they drive, in the order of the action.

    Parameters
    ----------
    schema : Schema
        Where columns stand.
    reading : Reading or None
        Says which is which; without its word, columns of one name are a pair, as LeRobot names the joints of an arm.
    """
    if reading is not None and reading.action is not None and not reading.missing_action(schema):
        feature, pairs = reading.feature, zip(reading.action.columns, reading.action.of, strict=True)
    else:
        names = schema.features[ACTION].dim_names if ACTION in schema.signals() else ()
        feature, pairs = STATE, zip(names, names, strict=True)
    return [
        _joint(driven, locate(name, ACTION, schema), locate(driven, feature, schema), schema, reading)
        for name, driven in pairs
        if is_there(name, ACTION, schema) and is_there(driven, feature, schema)
    ]


def angles_of(schema: Schema, reading: Reading | None) -> dict[Place, str]:
    """Return the angles of the state with their units: ``rad``, ``deg``, or empty where nobody says.

    They are the joints that the action drives, but for grippers and those that are declared to be something else; the
    columns that a reading has in one of the two units; and its yaws that stand in one column.
    """
    joints = {joint.state: joint.unit for joint in joints_of(schema, reading) if not joint.is_gripper}
    declared = {} if reading is None else {name: meaning.unit for name, meaning in reading.columns.items()}
    for pose in reading.poses.values() if reading else ():
        if pose.yaw and pose.yaw.sin is None:
            declared[pose.yaw.names[0]] = "deg" if pose.yaw.deg else "rad"
    angles = joints | {place: unit for _, place, unit in _in_the_state(declared, schema, reading) if unit}
    return {place: unit for place, unit in angles.items() if unit in ("", "rad", "deg")}


def gripper_limits(schema: Schema, reading: Reading | None) -> dict[Place, tuple[float, float]]:
    """Return the limits of each gripper of the state of which a reading says both."""
    columns = reading.columns if reading else {}
    return {
        place: (meaning.low, meaning.high)
        for name, place, meaning in _in_the_state(columns, schema, reading)
        if is_gripper(name) and meaning.low is not None and meaning.high is not None
    }


def _in_the_state[T](
    columns: Mapping[str, T], schema: Schema, reading: Reading | None
) -> Iterator[tuple[str, Place, T]]:
    """Say where columns that a reading names stand, but for those that are not there, and those of the action."""
    feature = reading.feature if reading else STATE
    for name, value in columns.items():
        if is_there(name, feature, schema) and (place := locate(name, feature, schema))[0] != ACTION:
            yield name, place, value


def _joint(name: str, action: Place, state: Place, schema: Schema, reading: Reading | None) -> Joint:
    unit = _meaning(state, schema, reading).unit or _meaning(action, schema, reading).unit
    return Joint(name, action, state, unit)


def _meaning(place: Place, schema: Schema, reading: Reading | None) -> ColumnMeaning:
    feature, dim = place
    names = schema.features[feature].dim_names
    return reading.meaning(feature, names[dim] if names else str(dim)) if reading else ColumnMeaning()
