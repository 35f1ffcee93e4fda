"""What does the script of a page need? The frames, column after column, and what each reading makes of them.

The script decodes nothing: positions, yaws and errors of every frame are worked out here, by the functions that all of
the package uses, so that a page cannot say anything else than they do.
"""

import base64
from typing import Any

import numpy as np

from z2r.arrays import Array, Bools, Floats
from z2r.errors import printable
from z2r.format.schema import ACTION
from z2r.reading.decode import Decoded
from z2r.reading.reading import Reading, locate
from z2r.reading.success import frame_errors
from z2r.show.page.content import Chart, Content, View, dtype_of
from z2r.show.page.films import Film

LONGEST_PATH = 2000  # frames: of a longer one, this many are drawn, which any browser does between two frames


class _Table:
    """Columns, each (n_frames,), that are asked for by their place; the same numbers stand in it once."""

    def __init__(self, dtype: np.dtype[np.generic], columns: list[Array]) -> None:
        self.dtype = dtype
        self.columns = [np.ascontiguousarray(column, dtype=dtype) for column in columns]
        self.places = {column.tobytes(): place for place, column in enumerate(self.columns)}

    def add(self, values: Floats) -> int:
        column = np.ascontiguousarray(values, dtype=self.dtype)
        place = self.places.setdefault(column.tobytes(), len(self.columns))
        if place == len(self.columns):
            self.columns.append(column)
        return place

    def encode(self) -> str:
        return base64.b64encode(b"".join(column.tobytes() for column in self.columns)).decode()


def script_data(content: Content) -> dict[str, Any]:
    """Return what the script needs, as plain Python values."""
    table = _Table(dtype_of(content.inspection), [c for frames in content.frames.values() for c in frames.T])
    readings = [_reading_data(view, content, table) for view in content.views]
    return {
        "fps": content.schema.fps,
        "longestPath": LONGEST_PATH,
        "shown": content.shown.n_frames,
        "total": content.inspection.episodes.n_frames,
        "names": [[feature, printable(name)] for feature, name in content.columns],
        "bytes": table.dtype.itemsize,
        "frames": table.encode(),
        "readings": readings,
        "charts": [_chart_data(chart) for chart in content.charts],
        "cameras": [_film_data(film) for film in content.films],
        "findings": _findings_data(content),
    }


def _chart_data(chart: Chart) -> dict[str, Any]:
    names = {"group": printable(chart.group), "name": printable(chart.name), "unit": printable(chart.unit)}
    series = {"measured": chart.measured, "command": chart.command}
    ends = [end if np.isfinite(end) else None for end in (chart.low, chart.high)]  # JSON has no NaN
    return {**names, "series": {kind: place for kind, place in series.items() if place is not None}, "ends": ends}


def _film_data(film: Film) -> dict[str, Any]:
    clips = [[base64.b64encode(clip.data).decode(), clip.offset, clip.n_frames] for clip in film.clips]
    pictures = [[each.at, base64.b64encode(each.data).decode(), each.media_type] for each in film.pictures]
    return {"missing": film.missing, "clips": clips, "pictures": pictures}


def _findings_data(content: Content) -> list[dict[str, Any]]:
    """Where to put the marks: of each finding its episodes, its columns, and its frame, counted over the page."""
    findings = content.audit.findings if content.audit else ()
    return [
        {
            "severity": each.severity,
            "episodes": each.episodes,
            "columns": content.columns_of(each),
            "at": content.shown_frame(each.frame),
        }
        for each in findings
    ]


def _reading_data(view: View, content: Content, table: _Table) -> dict[str, Any]:
    spans = np.stack([view.episodes.from_index, view.episodes.to_index], axis=1)
    episodes = spans[view.episodes.from_index < content.shown.n_frames].tolist()
    data: dict[str, Any] = {"name": view.name, "episodes": episodes, "goals": [], "poses": {}, "formulas": {}}
    data["numbers"] = [view.episodes.number(place) for place in range(len(episodes))]
    if view.stored is not None:
        data["stored"] = view.stored.any_frame[: len(episodes)].tolist()
    if view.reading is None:
        return data
    decoded = content.decoded(view.reading)
    data["poses"] = {name: _pose_data(decoded, name, table) for name in view.reading.poses}
    data["formulas"] = formulas(view.reading)
    data["goals"] = _goals_data(decoded, content, table)
    data["action"] = _action_data(view.reading, content)
    if view.outcome is not None:
        data["reached"] = view.outcome.reached[: len(episodes)].tolist()
        share = f"{view.outcome.share_reached:.0%}"
        data["said"] = f"{view.name}: {view.outcome.tally} reached {content.destination}, {share}"
    return data


def formulas(reading: Reading) -> dict[str, str]:
    """Return how the reading decodes the yaw of each pose that has one."""
    return {name: pose.yaw.formula for name, pose in reading.poses.items() if pose.yaw}


def _pose_data(decoded: Decoded, name: str, table: _Table) -> list[int | None]:
    pose = decoded.pose(name)
    return [table.add(pose.x), table.add(pose.y), None if pose.yaw is None else table.add(pose.yaw)]


def _goals_data(decoded: Decoded, content: Content, table: _Table) -> list[dict[str, Any]]:
    errors = frame_errors(decoded)
    return [
        {
            "name": goal.name,
            "label": content.goal_title(goal),
            "unit": decoded.reading.unit(goal),
            "column": table.add(errors[goal.name]),
            "held": _bits(goal.holds(errors[goal.name])),
            "limit": limit_text(decoded.reading, goal.name),
            "band": goal.band if goal.limits else None,
            "isAngle": goal.turn is not None,
        }
        for goal in decoded.reading.goal
    ]


def limit_text(reading: Reading, name: str) -> str:
    """Say which limits a goal has, such as ``within 0.03 m``."""
    goal = next(goal for goal in reading.goal if goal.name == name)
    unit = reading.unit(goal)
    limits = [f"{limit.replace('_', ' ')} {value:g} {unit}".strip() for limit, value in goal.limits.items()]
    return " and ".join(limits) or "above 0"


def _bits(held: Bools) -> str:
    return base64.b64encode(np.packbits(held).tobytes()).decode()


def _action_data(reading: Reading, content: Content) -> dict[str, Any] | None:
    """Say which body the action drives along x and y, if it does, and how far it would bring it in one frame."""
    action = reading.action
    if action is None or reading.missing_action(content.schema) or ACTION not in content.frames:
        return None
    driven = next((name for name, pose in reading.poses.items() if action.of[:2] == (pose.x, pose.y)), None)
    if driven is None:
        return None
    places = [content.place(*locate(name, ACTION, content.schema)) for name in action.columns[:2]]
    scale = {"velocity": 1 / content.schema.fps, "delta": 1, "position": 1}[action.drives]
    return {"pose": driven, "columns": places, "scale": scale, "isPlace": action.drives == "position"}
