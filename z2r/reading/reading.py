"""A reading: which named columns mean what, in which unit, and what counts as reached.

It is data, so it can be printed, compared, kept in a file, and got wrong on purpose (`z2r.reading.breaks`). It names
columns and never counts them: where they stand is the schema's business.
"""

import os
import re
from difflib import get_close_matches
from pathlib import Path
from typing import Any, Literal, get_args, get_type_hints

import msgspec

from z2r.errors import DatasetError, Fault
from z2r.format.schema import ACTION, STATE, Schema
from z2r.format.store import read_bytes
from z2r.reading.goal import Goal
from z2r.reading.poses import PoseColumns, QuaternionColumns, YawColumns

_MAX_BYTES = 2**20  # of a reading file
_DRAFT = "z2r reading DATASET --out FILE.toml drafts one"


class ColumnMeaning(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True, kw_only=True):
    """What is known of one column.

    Attributes
    ----------
    unit : str
        Such as ``deg``, ``m/s`` or ``percent``; empty where nobody says.
    low, high : float, optional
        The limits that the robot keeps.
    """

    unit: str = ""
    low: float | None = None
    high: float | None = None


class ActionMeaning(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True, kw_only=True):
    """What the action does.

    Attributes
    ----------
    drives : str
        ``velocity``: what is driven should move so fast. ``position``: it should be there. ``delta``: it should move by
        so much until the next frame.
    columns : tuple of str
        Columns of the action.
    of : tuple of str
        What each of them drives: columns of the state.
    lag : int
        By how many frames an action is stored late: the one in a frame was taken this many frames earlier.

    Raises
    ------
    ValueError
        If there are not as many columns as there is to drive.
    """

    drives: Literal["velocity", "position", "delta"]
    columns: tuple[str, ...]
    of: tuple[str, ...]
    lag: int = 0

    def __post_init__(self) -> None:
        if len(self.columns) != len(self.of):
            raise ValueError(f"found {len(self.columns)} columns that drive {len(self.of)}, expected as many of both")


class Reading(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True, kw_only=True):
    """What the columns mean, and what follows from that.

    A column is named as the schema names it: ``tee_x`` stands in `feature`, ``observation.environment_state/block_x``
    in another one, and ``observation.state/3`` is the fourth dimension of one whose dimensions have no names.

    Attributes
    ----------
    name : str
        What to call it.
    feature : str
        Where columns stand unless they say otherwise.
    scene : str, optional
        What only this task knows of it: bodies, limits, checks.
    poses : dict of str to PoseColumns
        The bodies, by the names that goals use.
    columns : dict of str to ColumnMeaning
        Units and limits of single columns; those of the action as ``action/pusher_vx``.
    goal : tuple of Goal
        What must hold, all of it, in the decisive frame; empty where nothing says what counts as reached.
    decisive : str
        Which frame of an episode says whether it reached the goal: ``last`` or ``first``.
    action : ActionMeaning, optional
        What the action does.

    Raises
    ------
    ValueError
        If a goal names a pose that is not there or has no orientation to turn, or two goals have one name.
    """

    name: str = ""
    feature: str = STATE
    scene: str | None = None
    poses: dict[str, PoseColumns] = {}
    columns: dict[str, ColumnMeaning] = {}
    goal: tuple[Goal, ...] = ()
    decisive: Literal["first", "last"] = "last"
    action: ActionMeaning | None = None

    def __post_init__(self) -> None:
        names = [goal.name for goal in self.goal]
        if len(set(names)) < len(names):
            raise ValueError(f"found two goals of one name among {', '.join(names)}, expected a name for each")
        for goal in self.goal:
            turns = [name for name, pose in self.poses.items() if pose.orientation]
            choices = turns if goal.turn else list(self.poses)
            for pose in goal.poses:
                if pose not in choices:
                    what = "pose that can turn" if goal.turn else "pose"
                    raise ValueError(
                        f"found {pose} in goal {goal.name}, expected a {what}: {', '.join(choices) or 'there is none'}"
                    )
            if goal.turn and len({type(self.poses[pose].orientation) for pose in goal.turn}) > 1:
                raise ValueError(f"found a yaw and a quaternion in goal {goal.name}, expected two of one kind")

    def __repr__(self) -> str:
        goal = " and ".join(goal.says(self.unit(goal)) for goal in self.goal)
        return f"Reading({self.name}: {', '.join(self.poses) or 'no poses'}; reached where {goal or 'nobody says'})"

    @property
    def names(self) -> tuple[str, ...]:
        """Every column that it needs: those of its poses and goals, and those of which it says something."""
        of_columns = [name for name in self.columns if "/" not in name]
        of_poses = [name for pose in self.poses.values() for name in pose.names]
        of_goals = [goal.column for goal in self.goal if goal.column is not None]
        return tuple(dict.fromkeys([*of_poses, *of_goals, *of_columns]))

    @property
    def moved(self) -> str | None:
        """The pose that a goal brings somewhere, and which `yaw-swap` is about: the first of the first pair."""
        return next((goal.poses[0] for goal in self.goal if goal.poses), None)

    @property
    def destination(self) -> str:
        """What to call what is to be reached: the second pose of the first pair, or just the goal."""
        return next((goal.poses[1] for goal in self.goal if goal.poses), "the goal")

    def with_pose(self, name: str, **changes: object) -> "Reading":
        """Return the reading with some fields of one pose replaced."""
        pose = msgspec.structs.replace(self.poses[name], **changes)
        return msgspec.structs.replace(self, poses=self.poses | {name: pose})

    def with_goal(self, name: str, **changes: object) -> "Reading":
        """Return the reading with some fields of one goal replaced: ``PUSHT.with_goal("pos_err", within=0.01)``."""
        goals = (msgspec.structs.replace(goal, **changes) if goal.name == name else goal for goal in self.goal)
        return msgspec.structs.replace(self, goal=tuple(goals))

    def unit(self, goal: Goal) -> str:
        """Return the unit of a goal's number; empty where nobody says."""
        if goal.turn:
            return "rad"
        if goal.distance:
            return self.poses[goal.distance[0]].unit
        return self.columns.get(str(goal.column), ColumnMeaning()).unit

    def meaning(self, feature: str, dim: str) -> ColumnMeaning:
        """Return what is known of a dimension of a feature; without unit and limits where nothing is."""
        found = self.columns.get(f"{feature}/{dim}")
        if found is None and feature == self.feature:
            positions = {name: pose.unit for pose in self.poses.values() for name in pose.position}
            found = self.columns.get(dim, ColumnMeaning(unit=positions.get(dim, "")))
        return found or ColumnMeaning()

    def missing(self, schema: Schema) -> tuple[str, ...]:
        """Return the columns that it needs and that are no numbers in the schema; none where it fits."""
        return tuple(name for name in self.names if not is_there(name, self.feature, schema))

    def missing_action(self, schema: Schema) -> tuple[str, ...]:
        """Return the columns of its action, and of what that drives, that are no numbers in the schema."""
        if self.action is None:
            return ()
        driven = tuple(name for name in self.action.of if not is_there(name, self.feature, schema))
        return *(name for name in self.action.columns if not is_there(name, ACTION, schema)), *driven


def locate(name: str, feature: str, schema: Schema) -> tuple[str, int]:
    """Find where a column stands.

    Parameters
    ----------
    name : str
        A dimension of `feature`; or a feature and one of its dimensions, by name or by number, as in ``action/3``; or a
        feature that is one number.
    feature : str
        Where it stands unless it says otherwise.
    schema : Schema
        What there is.

    Returns
    -------
    feature : str
    dimension : int

    Raises
    ------
    ValueError
        If it is not there, where the message lists what is; or two dimensions have this name.
    """
    signals = schema.signals()
    if feature in signals and name in signals[feature].dim_names:
        return feature, signals[feature].place(name)
    if name in signals and signals[name].size == 1:
        return name, 0
    owners = [other for other in signals if name.startswith(f"{other}/")]  # a feature, or a dimension, may have a "/"
    for other in owners:
        dim, dims = name.removeprefix(f"{other}/"), signals[other].dim_names
        if dim in dims:
            return other, signals[other].place(dim)
        if dim.isdecimal() and dim.isascii() and len(dim) < 9 and int(dim) < signals[other].size:
            return other, int(dim)
        feature = other
    if feature not in signals:
        raise ValueError(f"no feature {feature!r} of numbers among {', '.join(schema.features)}")
    dims = signals[feature].dim_names
    raise ValueError(f"no dimension {name!r} in {feature}: {', '.join(dims) or 'its dimensions have no names'}")


def is_there(name: str, feature: str, schema: Schema) -> bool:
    """Tell whether a column is there and holds numbers."""
    try:
        locate(name, feature, schema)
    except ValueError:
        return False
    return True


def column_names(feature: str, schema: Schema) -> list[str]:
    """Name the dimensions of a feature as a reading does, which looks for a bare name in `observation.state`."""
    found = schema.features[feature]
    if found.dim_names:
        return list(found.dim_names) if feature == STATE else [f"{feature}/{dim}" for dim in found.dim_names]
    return [feature] if found.size == 1 else [f"{feature}/{place}" for place in range(found.size)]


def read_reading(path: str | os.PathLike[str]) -> Reading:
    """Read a reading file.

    Parameters
    ----------
    path : str or path
        A TOML file. Its keys are the attributes of `Reading`; it is called as the file, unless it has a `name`.

    Raises
    ------
    DatasetError
        If the file cannot be read, is no TOML, or holds anything but a reading: in one line, with the key and the
        choices.
    """
    path = Path(path)
    try:
        content = msgspec.toml.decode(read_bytes(path, _MAX_BYTES, "a reading file", _DRAFT), type=dict[str, Any])
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
        raise DatasetError(Fault(path, "", f"no TOML ({error})", "a reading file")) from None
    return reading_of({"name": path.stem} | content, path)


def reading_of(content: dict[str, Any], path: Path) -> Reading:
    """Make a reading of what stands in its file; part by part, so that an error says which.

    Raises
    ------
    DatasetError
        If a key is misspelt or a value is not what it should be.
    """
    for key, kind in (("poses", PoseColumns), ("columns", ColumnMeaning)):
        parts = content.get(key, {})
        for name, part in parts.items() if isinstance(parts, dict) else ():
            if kind is PoseColumns and isinstance(part, dict):
                for inner, inner_kind in (("yaw", YawColumns), ("quaternion", QuaternionColumns)):
                    if inner in part:
                        _convert(part[inner], inner_kind, path, f"{key}.{name}.{inner}")
            _convert(part, kind, path, f"{key}.{name}")
    goals = content.get("goal", [])
    for number, goal in enumerate(goals if isinstance(goals, list) else ()):
        _convert(goal, Goal, path, f"goal[{number}]")
    if "action" in content:
        _convert(content["action"], ActionMeaning, path, "action")
    return _convert(content, Reading, path, "")


def _convert[T: msgspec.Struct](content: Any, kind: type[T], path: Path, field: str) -> T:
    choices = kind.__struct_fields__
    if isinstance(content, dict):
        for key in content:
            if key not in choices:
                near = get_close_matches(key, choices, n=1)
                mend = f"Did you mean {near[0]}?" if near else ""
                where = f"{field}.{key}".lstrip(".")
                raise DatasetError(Fault(path, where, "a key that means nothing", f"one of {', '.join(choices)}", mend))
    try:
        return msgspec.convert(content, kind)
    except msgspec.ValidationError as error:
        said, _, where = str(error).partition(" - at `$")
        place = (field + where.rstrip("`")).lstrip(".")
        raise DatasetError(Fault(path, place, *_found_and_expected(said, kind, place))) from None


def _found_and_expected(said: str, kind: type[msgspec.Struct], place: str) -> tuple[str, str]:
    """Take apart what msgspec says, or what a class here says through it."""
    if missing := re.fullmatch("Object missing required field `(.*)`", said):
        return f"no {missing[1]}", f"one, for {', '.join(kind.__struct_fields__)} are what there is"
    if wrong := re.fullmatch("Invalid enum value (.*)", said):
        choices = get_args(get_type_hints(kind).get(place.rpartition(".")[2]))
        return wrong[1], f"one of {', '.join(map(str, choices))}"
    found, _, expected = said.removeprefix("found ").partition(", expected ")
    if not expected:
        expected, _, found = said.removeprefix("Expected ").partition(", got ")
    return found or "something else", expected
