"""What did it look like? Write the frames of a dataset into a rerun recording (.rrd).

The recording shows the dataset as the reading has it: a wrong reading draws a wrong picture. Frames of all episodes lie
one after another on two timelines, `sim_time` [s] and `frame`. Every column is sent whole, never row by row, and the
layout of the viewer is part of the file.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from z2r.arrays import Array, Columns, Floats, Ints
from z2r.errors import printable
from z2r.format.about import About
from z2r.format.schema import ACTION, STATE, Schema
from z2r.reading.angles import yaw_quaternions
from z2r.reading.bodies import Body, Role, bodies_of
from z2r.reading.decode import Decoded, decode
from z2r.reading.goal import Goal
from z2r.reading.inspection import Inspection
from z2r.reading.poses import Pose
from z2r.reading.reading import Reading
from z2r.reading.scene import Scene
from z2r.reading.success import frame_errors

APPLICATION_ID = "seeing-like-a-robot"

_COLORS: dict[Role, tuple[int, ...]] = {"object": (115, 128, 242), "goal": (90, 205, 100), "robot": (230, 102, 90)}
_SEE_THROUGH = 120  # of 255: a marking lets what stands on it be seen
_GREY = (128, 128, 128)
_LINE_WIDTH = 0.003  # of what is looked at: radius of a path
_POINT_SIZE = 0.02  # of what is looked at: radius of a body of which nothing but the place is known
_PATH_Z = 0.002  # m: just above the table


@dataclass(frozen=True)
class Replay:
    """What a recording shows: the first `n_frames` frames, which begin `n_episodes` episodes."""

    path: Path
    n_frames: int
    n_episodes: int


@dataclass(frozen=True)
class _View:
    """What the camera looks at: the middle of it, and how far it goes from there, in the unit of the positions."""

    middle: tuple[float, float, float]
    reach: float


class _Recorder:
    """Sends columns that have a row for every frame."""

    def __init__(self, path: Path, blueprint: rrb.Blueprint, fps: float, starts: Ints, n_frames: int) -> None:
        self.stream = rr.RecordingStream(APPLICATION_ID, recording_id=path.stem)
        self.stream.save(path, default_blueprint=blueprint)
        self.fps, self.starts, self.n_frames = fps, starts, n_frames

    def static(self, entity: str, *components: rr.AsComponents) -> None:
        self.stream.log(entity, *components, static=True)

    def columns(self, entity: str, columns: rr.ComponentColumnList, frames: Ints | None = None) -> None:
        frames = np.arange(self.n_frames) if frames is None else frames
        time = [rr.TimeColumn("sim_time", duration=frames / self.fps), rr.TimeColumn("frame", sequence=frames)]
        self.stream.send_columns(entity, indexes=time, columns=columns)

    def close(self) -> None:
        self.stream.flush()
        self.stream.disconnect()


def write_replay(inspection: Inspection, path: Path, scene: Scene | None = None) -> Replay:
    """Write the frames that an inspection has kept into a rerun recording.

    Parameters
    ----------
    inspection : Inspection
        From `z2r.reading.inspection.inspect_dataset`, which was asked to keep some frames. Without a reading, only the
        numbers are shown; without poses in it, no world.
    path : Path
        The .rrd file to write. One that is there is replaced.
    scene : Scene, optional
        What the bodies look like; without it, each is a point.
    """
    schema, reading, shown = inspection.schema, inspection.reading, inspection.shown
    rows = shown.frame_numbers
    frames: Columns = {name: values[rows] for name, values in inspection.kept.items()}
    decoded = decode(frames, reading, schema) if reading else None
    starts = np.cumsum(shown.lengths) - shown.lengths
    view = _view(decoded, scene) if decoded and decoded.reading.poses else None
    recorder = _Recorder(path, _blueprint(frames, reading, view), schema.fps, starts, len(rows))
    recorder.static("about", rr.TextDocument(_about(inspection.about)))
    recorder.columns("eval/episode_index", rr.Scalars.columns(scalars=np.repeat(shown.numbers, shown.lengths)))
    if ACTION in frames:
        _send_feature(recorder, "policy/action", frames[ACTION], schema, ACTION)
    if decoded and view:
        _send_world(recorder, decoded, scene, view)
    elif STATE in frames:
        _send_feature(recorder, "observation/state", frames[STATE], schema, STATE)
    if decoded:
        _send_errors(recorder, decoded)
    recorder.close()
    return Replay(path, len(rows), len(shown))


def _about(about: About) -> str:
    """Return what the dataset says of itself, a line for each; as plain text, so that no name in it is markup."""
    return "\n".join(f"{kind}: {printable(line)}" for kind, lines in about.lines.items() for line in lines)


def _send_feature(recorder: _Recorder, entity: str, values: Array, schema: Schema, name: str) -> None:
    recorder.static(entity, rr.SeriesLines(names=schema.features[name].labels))
    recorder.columns(entity, rr.Scalars.columns(scalars=values))


def _send_world(recorder: _Recorder, decoded: Decoded, scene: Scene | None, view: _View) -> None:
    if scene:
        recorder.static("world/walls", _walls(scene.half_width, view))
    for name, body in bodies_of(decoded.reading, scene.bodies if scene else {}).items():
        pose, color = decoded.pose(name), _COLORS[body.role]
        part = rr.escape_entity_path_part(name)  # a "/" would make one body move with another
        entity = f"world/{'robot' if body.role == 'robot' else 'objects'}/{part}"
        recorder.static(entity, *_shapes(body, color, view, turns=bool(decoded.reading.poses[name].orientation)))
        if body.flat and _stays(pose):
            recorder.static(entity, _first_transform(pose, body))
            continue
        recorder.columns(entity, rr.Transform3D.columns(translation=_points(pose, body.z), quaternion=_turns(pose)))
        if body.role != "goal":
            _send_path(recorder, f"world/paths/{part}", _points(pose, _PATH_Z), color, view)


def _shapes(body: Body, color: tuple[int, ...], view: _View, turns: bool) -> list[rr.AsComponents]:
    """Return what a body looks like: its shapes, or else a point, with a pointer ahead where its pose can turn."""
    if body.disc:
        radius, height = body.disc
        return [rr.Cylinders3D(lengths=[height], radii=[radius], colors=[color], fill_mode="solid")]
    if body.boxes:
        paint = (*color, _SEE_THROUGH) if body.flat else color
        boxes = rr.Boxes3D(
            centers=[(*box.center, 0) for box in body.boxes],
            half_sizes=[box.half_size for box in body.boxes],
            colors=[paint] * len(body.boxes),
            fill_mode="solid",
        )
        return [boxes]
    size = _POINT_SIZE * view.reach
    point = rr.Points3D([(0, 0, 0)], radii=[size], colors=[color], labels=[body.label])
    ahead = rr.Arrows3D(vectors=[(4 * size, 0, 0)], radii=[size / 4], colors=[color])
    return [point, ahead] if turns else [point]


def _send_path(recorder: _Recorder, entity: str, points: Floats, color: tuple[int, ...], view: _View) -> None:
    """Show the whole path of an episode from its first frame on; without boundaries, one path leaps between them."""
    strips = np.split(points, recorder.starts[1:])
    recorder.static(entity, rr.LineStrips3D.from_fields(colors=[color], radii=[_LINE_WIDTH * view.reach]))
    recorder.columns(entity, rr.LineStrips3D.columns(strips=strips), frames=recorder.starts)


def _send_errors(recorder: _Recorder, decoded: Decoded) -> None:
    errors, ends = frame_errors(decoded), np.array([0, recorder.n_frames - 1])
    for goal in decoded.reading.goal:
        entity, title = _entity(goal), _title(goal, decoded.reading)
        recorder.static(entity, rr.SeriesLines(names=title, colors=_COLORS["object"], widths=2))
        recorder.columns(entity, rr.Scalars.columns(scalars=errors[goal.name]))
        for limit, value in goal.limits.items():
            line = f"{entity}/{'tolerance' if limit == 'within' else limit}"
            said = f"{limit.replace('_', ' ')} {value:g} {decoded.reading.unit(goal)}".strip()
            recorder.static(line, rr.SeriesLines(names=said, colors=_COLORS["goal"]))
            recorder.columns(line, rr.Scalars.columns(scalars=[value] * 2), frames=ends)


def _entity(goal: Goal) -> str:
    return f"eval/{rr.escape_entity_path_part(goal.name)}"


def _title(goal: Goal, reading: Reading) -> str:
    unit = reading.unit(goal)
    return f"{goal.name} [{unit}]" if unit else goal.name


def _walls(half_width: float, view: _View) -> rr.LineStrips3D:
    corners = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0), (-1, -1, 0)]
    return rr.LineStrips3D([np.multiply(corners, half_width)], colors=[_GREY], radii=[_LINE_WIDTH * view.reach])


def _view(decoded: Decoded, scene: Scene | None) -> _View:
    """Look at the walls of a scene, or else at all places where a body was."""
    if scene:
        return _View((0, 0, 0), scene.half_width)
    places = np.concatenate([_points(decoded.pose(name), 0.0) for name in decoded.reading.poses])  # (n, 3)
    low, high = places.min(axis=0), places.max(axis=0)
    return _View(tuple(((low + high) / 2).tolist()), float((high - low).max()) / 2 or 1.0)


def _stays(pose: Pose) -> bool:
    return all(np.ptp(each) == 0 for each in (pose.x, pose.y, pose.yaw) if each is not None)


def _first_transform(pose: Pose, body: Body) -> rr.Transform3D:
    quaternion = rr.Quaternion(xyzw=_turns(pose)[0])
    return rr.Transform3D(translation=_points(pose, body.z)[0], quaternion=quaternion)


def _points(pose: Pose, z: float) -> Floats:
    """Return the position in every frame, float64[n_frames, 3]; at height `z` in a plane."""
    return np.stack([pose.x, pose.y, np.full_like(pose.x, z) if pose.z is None else pose.z], axis=1)


def _turns(pose: Pose) -> Floats:
    """Return the orientation in every frame as a quaternion x, y, z, w, float64[n_frames, 4]."""
    if pose.quaternion is not None:
        return pose.quaternion
    return yaw_quaternions(np.zeros_like(pose.x) if pose.yaw is None else pose.yaw)


def _blueprint(frames: Mapping[str, Array], reading: Reading | None, view: _View | None) -> rrb.Blueprint:
    plots = [_plot(_plot_title(goal, reading), _entity(goal), legend=False) for goal in _goals(reading)]
    if view is None and STATE in frames:
        plots.insert(0, _plot("state", "observation/state"))
    if ACTION in frames:
        plots.append(_plot("action", "policy/action"))
    plots.append(_plot("episode", "eval/episode_index", legend=False))
    about = rrb.TextDocumentView(name="about", origin="about")
    layout: rrb.Container = rrb.Vertical(*plots, about)
    if view:
        layout = rrb.Horizontal(_world_view(view), layout, column_shares=[3, 2])
    time_panel = rrb.TimePanel(timeline="sim_time", play_state="paused", state="collapsed")
    return rrb.Blueprint(layout, time_panel, collapse_panels=True)


def _goals(reading: Reading | None) -> Sequence[Goal]:
    return reading.goal if reading else ()


def _plot_title(goal: Goal, reading: Reading | None) -> str:
    said = goal.says(reading.unit(goal) if reading else "")
    return f"reached where {said}"


def _world_view(view: _View) -> rrb.Spatial3DView:
    x, y, z = view.middle
    return rrb.Spatial3DView(
        name="world",
        origin="world",
        background=(28, 30, 36),
        line_grid=False,
        eye_controls=rrb.EyeControls3D(
            position=(x, y - 1.25 * view.reach, z + 1.95 * view.reach),
            look_target=(x, y - 0.075 * view.reach, z),
            eye_up=(0, 0, 1),
        ),
    )


def _plot(name: str, origin: str, legend: bool = True) -> rrb.TimeSeriesView:
    whole_recording = rr.TimeRange(start=rr.TimeRangeBoundary.infinite(), end=rr.TimeRangeBoundary.infinite())
    return rrb.TimeSeriesView(
        name=name,
        origin=origin,
        axis_x=rrb.TimeAxis(view_range=whole_recording),
        plot_legend=rrb.PlotLegend(rrb.Corner2D.RightTop, visible=legend),
    )
