"""What could a reading of this dataset be? A draft to fill in: what is inferred, and from what, beside each line.

Whatever is written without a ``#`` before it is there or was inferred; what nobody can know from the data is left to
fill in. The text is a reading file as it stands.
"""

import re
from collections.abc import Iterator, Sequence

import msgspec
import numpy as np

from z2r.errors import printable
from z2r.format.schema import ACTION, STATE, Schema
from z2r.reading.action import DrivenColumn
from z2r.reading.inspection import Inspection
from z2r.reading.reading import column_names, locate
from z2r.reading.stored import label_in

_MAX_COLUMNS = 200
_AXES = ("x", "y", "z")
_DRIVES = {"target": "position", "velocity": "velocity", "step": "delta"}


def draft_reading(inspection: Inspection, name: str) -> str:
    """Write a draft of a reading file for a dataset.

    Parameters
    ----------
    inspection : Inspection
        What was found in it.
    name : str
        What to call the reading.

    Returns
    -------
    str
        TOML that `z2r.read_reading` reads.
    """
    n_frames, n_episodes = inspection.episodes.n_frames, len(inspection.episodes)
    poses = find_poses(_observed(inspection.schema))
    lines = [
        f"# A draft, from {n_episodes:,} episodes with {n_frames:,} frames. Each line says where it comes from:",
        "# seen or stored in the data, inferred from it, or unknown. What is unknown is for you to fill in.",
        f"name = {_text(name)}",
        "",
        *_column_lines(inspection),
        *_pose_lines(poses),
        *_action_lines(inspection.action, inspection.schema),
        *_goal_lines(inspection, poses),
    ]
    return "\n".join(lines) + "\n"


def _observed(schema: Schema) -> list[str]:
    """Name every column that was observed, as a reading does."""
    features = [name for name in schema.signals() if name.startswith("observation")]
    return [column for name in features for column in column_names(name, schema)]


def _column_lines(inspection: Inspection) -> Iterator[str]:
    """A line for each column of the state: its range, and a unit to fill in."""
    columns = [c for name in inspection.ranges if name.startswith("observation") for c in _ranges(inspection, name)]
    yield "# Columns, with the range that was seen. Their units are unknown: fill in such as deg, rad, percent, m."
    yield "[columns]"
    known = inspection.reading.columns if inspection.reading else {}
    for column, low, high in columns[:_MAX_COLUMNS]:
        unit = known[column].unit if column in known else ""
        declared = f"; declared by {inspection.reading.name}" if unit and inspection.reading else ""
        remark = declared or _remark(low, high)
        yield f"{_text(column)} = {{ unit = {_text(unit)} }} # seen: {low:.4g} to {high:.4g}{remark}"
    if len(columns) > _MAX_COLUMNS:
        yield f"# and {len(columns) - _MAX_COLUMNS:,} more"
    yield ""


def _ranges(inspection: Inspection, feature: str) -> Iterator[tuple[str, float, float]]:
    ranges = inspection.ranges[feature]
    low, high = ranges.low.min(axis=0).tolist(), ranges.high.max(axis=0).tolist()
    yield from zip(column_names(feature, inspection.schema), low, high, strict=True)


def _remark(low: float, high: float) -> str:
    """Say what a range hints at, which is no more than a hint."""
    if low == high:
        return "; it never changes"
    if low >= -1.001 and high <= 1.001 and low < -0.5:
        return "; a sine, a cosine or a number that was scaled would stay in it"
    if low >= -np.pi - 0.01 and high <= np.pi + 0.01 and (low < -1.6 or high > 1.6):
        return "; an angle in rad would stay in it"
    return ""


def find_poses(columns: Sequence[str]) -> dict[str, dict[str, str]]:
    """Find columns whose names say that they are the position of one body, and its yaw where sine and cosine are there.

    Parameters
    ----------
    columns : sequence of str
        As a reading names them.

    Returns
    -------
    dict of str to dict of str to str
        For each body, the column of ``x``, ``y``, ``z``, ``sin`` and ``cos``, as far as they are there.

    Examples
    --------
    >>> find_poses(["block_x", "block_y", "gripper.pos", "sin_block_yaw", "cos_block_yaw"])
    {'block': {'x': 'block_x', 'y': 'block_y', 'sin': 'sin_block_yaw', 'cos': 'cos_block_yaw'}}
    """
    found: dict[str, dict[str, str]] = {}
    for column in columns:
        name = column.rpartition("/")[2]
        if place := re.fullmatch(r"(.+)[_.]([xyz])", name):
            found.setdefault(place[1], {})[place[2]] = column
        if turn := re.fullmatch(r"(sin|cos)_(.+?)(?:_yaw)?|(.+?)(?:_yaw)?_(sin|cos)", name):
            found.setdefault(turn[2] or turn[3], {})[turn[1] or turn[4]] = column
    return {body: parts for body, parts in found.items() if {"x", "y"} <= parts.keys()}


def _pose_lines(poses: dict[str, dict[str, str]]) -> Iterator[str]:
    for body, parts in poses.items():
        yield f"[poses.{_text(body)}] # inferred from the names of the columns"
        yield from (f"{axis} = {_text(parts[axis])}" for axis in _AXES if axis in parts)
        if {"sin", "cos"} <= parts.keys():
            yield f"yaw = {{ sin = {_text(parts['sin'])}, cos = {_text(parts['cos'])} }}"
        yield 'unit = "m" # unknown: is it?'
        yield ""


def _action_lines(action: Sequence[DrivenColumn], schema: Schema) -> Iterator[str]:
    """What the action drives, where the data tells; the dimensions of which it does not are named with the reason."""
    kinds = [driven.kind for driven in action if driven.kind in _DRIVES]
    if not action:
        yield "# The dataset has no action."
        return
    yield "# What the action drives, inferred from how the state follows it:"
    yield from (f"#   {printable(str(driven))}" for driven in action)
    if kinds:
        kind = max(set(kinds), key=kinds.count)
        named = zip(action, schema.features[ACTION].dim_names or column_names(ACTION, schema), strict=True)
        chosen = [(name, driven.column) for driven, name in named if driven.kind == kind]
        yield "[action]"
        yield f"drives = {_text(_DRIVES[kind])} # inferred: {len(chosen)} of {len(action)} dimensions"
        yield f"columns = [{', '.join(_text(name) for name, _ in chosen)}]"
        yield f"of = [{', '.join(_text(str(column)) for _, column in chosen)}]"
    yield ""


def _goal_lines(inspection: Inspection, poses: dict[str, dict[str, str]]) -> Iterator[str]:
    yield "# What counts as reached? Unknown: nothing in the data says it. All goals that stand here must hold in the"
    yield "# last stored frame of an episode. Take the # away from one, and fill in its limit."
    if stored := label_in(inspection.schema):
        yield f'[[goal]]\nname = "success"\nstored = {_text(stored)} # stored in the dataset'
    if pair := _pair_to_bring_together(inspection, poses):
        yield f'# [[goal]]\n# name = "distance"\n# distance = [{_text(pair[0])}, {_text(pair[1])}]\n# within = 0.03'
    for column, low, high in _last_ranges(inspection):
        yield f"# [[goal]]\n# name = {_text(column)}"
        yield f"# value = {_text(column)} # in the last frames: {low:.4g} to {high:.4g}"
        yield f"# at_most = {low + (high - low) / 2:.4g}"
        return  # one example will do


def _pair_to_bring_together(inspection: Inspection, poses: dict[str, dict[str, str]]) -> tuple[str, str] | None:
    """Suggest what is brought where: what moves, and is not driven by the action, to what stays in an episode."""
    driven = {each.column for each in inspection.action}
    stays = [body for body, parts in poses.items() if _stays(inspection, parts["x"]) and _stays(inspection, parts["y"])]
    moved = sorted((body for body in poses if body not in stays), key=lambda body: poses[body]["x"] in driven)
    return (moved[0], stays[0]) if moved and stays else None


def _stays(inspection: Inspection, column: str) -> bool:
    """Tell whether a column keeps its value within every episode."""
    feature, dim = locate(column, STATE, inspection.schema)
    ranges = inspection.ranges[feature]
    return bool(np.array_equal(ranges.low[:, dim], ranges.high[:, dim]))


def _last_ranges(inspection: Inspection) -> Iterator[tuple[str, float, float]]:
    """The range of each column over the last frames, from the last column back: there the gripper is."""
    for feature, last in inspection.last_frames.items():
        if feature.startswith("observation") and len(last):
            names = column_names(feature, inspection.schema)
            yield from reversed(list(zip(names, last.min(axis=0).tolist(), last.max(axis=0).tolist(), strict=True)))


def _text(text: str) -> str:
    """Write a TOML string: the basic ones are those of JSON."""
    return msgspec.json.encode(text).decode()
