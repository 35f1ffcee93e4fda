"""What did it look like? Write the frames of a dataset into a rerun recording (.rrd).

The recording shows the dataset as the reading has it: a wrong reading draws a wrong picture. Frames of all episodes lie
one after another on two timelines, `sim_time` [s] and `frame`. Every column is sent whole, never row by row, and the
layout of the viewer is part of the file.
"""

from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from z2r.arrays import Array, Floats, Ints
from z2r.format.dataset import Dataset
from z2r.format.episodes import EpisodeIndex
from z2r.format.schema import ACTION, STATE, Schema
from z2r.pusht import task
from z2r.reading.reading import Pose, Reading, named_columns, read_pose
from z2r.reading.success import frame_errors

APPLICATION_ID = "seeing-like-a-robot"
MAX_FRAMES = 20_000  # half an hour at 10 Hz: more than anybody scrubs through

_TEE_COLOR = (115, 128, 242)
_TARGET_COLOR = (90, 205, 100, 120)
_PUSHER_COLOR = (230, 102, 90)
_TOLERANCE_COLOR = (90, 205, 100)
_GREY = (128, 128, 128)
_LINE_RADIUS = 0.0012  # m
_MARKING = 0.0005  # m: half the height of the target, which is a marking on the table
_PATH_Z = 0.002  # m: just above it


@dataclass(frozen=True)
class Replay:
    """What a recording shows: the first `n_frames` frames, which begin `n_episodes` episodes."""

    path: Path
    n_frames: int
    n_episodes: int


class _Recorder:
    """Sends columns that have a row for every frame."""

    def __init__(self, path: Path, blueprint: rrb.Blueprint, fps: float, n_frames: int) -> None:
        self.stream = rr.RecordingStream(APPLICATION_ID, recording_id=path.stem)
        self.stream.save(path, default_blueprint=blueprint)
        self.fps, self.n_frames = fps, n_frames

    def static(self, entity: str, *components: rr.AsComponents) -> None:
        self.stream.log(entity, *components, static=True)

    def columns(self, entity: str, columns: rr.ComponentColumnList, frames: Ints | None = None) -> None:
        frames = np.arange(self.n_frames) if frames is None else frames
        time = [rr.TimeColumn("sim_time", duration=frames / self.fps), rr.TimeColumn("frame", sequence=frames)]
        self.stream.send_columns(entity, indexes=time, columns=columns)

    def close(self) -> None:
        self.stream.flush()
        self.stream.disconnect()


def write_replay(dataset: Dataset, path: Path, reading: Reading | None, max_frames: int = MAX_FRAMES) -> Replay:
    """Write the first episodes of a dataset into a rerun recording.

    Parameters
    ----------
    dataset : Dataset
        From `z2r.load`, or what a break mode makes of it.
    path : Path
        The .rrd file to write. One that is there is replaced.
    reading : Reading or None
        What the columns mean; with None, only the numbers are shown and no world.
    max_frames : int, optional
        Show whole episodes up to this many frames; of a longer first episode, its beginning.

    Raises
    ------
    DatasetError
        If a data file is missing, damaged, or not what the schema and the index say.
    """
    schema = dataset.schema
    ends = np.cumsum(dataset.episodes.lengths)
    n_frames = _frames_to_show(ends, max_frames)
    frames = dataset.episodes.frame_numbers[:n_frames]
    starts = (ends - dataset.episodes.lengths)[: np.searchsorted(ends, n_frames) + 1]
    features = [feature for feature in (STATE, ACTION) if feature in schema.signals()]
    values = {feature: _up_to(dataset, int(frames.max()) + 1).read(feature)[frames] for feature in features}

    recorder = _Recorder(path, _blueprint(schema, features, reading), schema.fps, n_frames)
    episode_of_frame = np.repeat(np.arange(len(starts)), np.diff(np.append(starts, n_frames)))
    recorder.columns("eval/episode_index", rr.Scalars.columns(scalars=episode_of_frame))
    if ACTION in features:
        _send_feature(recorder, "policy/action", values[ACTION], schema.features[ACTION].dim_names)
    if reading is not None:
        _send_world(recorder, values[reading.feature], reading, schema, starts)
        _send_errors(recorder, values[reading.feature], reading, schema)
    elif STATE in features:
        _send_feature(recorder, "observation/state", values[STATE], schema.features[STATE].dim_names)
    recorder.close()
    return Replay(path, n_frames, len(starts))


def _frames_to_show(ends: Ints, max_frames: int) -> int:
    whole = ends[ends <= max_frames]
    return int(whole[-1]) if len(whole) else max_frames


def _up_to(dataset: Dataset, n_frames: int) -> Dataset:
    """Return the first frames of a dataset as one episode: no file that they do not need is read."""
    episodes = EpisodeIndex(np.array([0]), np.array([n_frames]))
    return replace(dataset, episodes=episodes, files=tuple(f for f in dataset.files if f.from_index < n_frames))


def _send_feature(recorder: _Recorder, entity: str, values: Array, names: tuple[str, ...]) -> None:
    recorder.static(entity, rr.SeriesLines(names=names or [f"[{i}]" for i in range(values.shape[1])]))
    recorder.columns(entity, rr.Scalars.columns(scalars=values))


def _send_world(recorder: _Recorder, state: Array, reading: Reading, schema: Schema, starts: Ints) -> None:
    columns = named_columns(state, reading, schema)
    tee, target = read_pose(columns, reading.tee), read_pose(columns, reading.target)
    pusher_x, pusher_y = (columns[name] for name in reading.pusher)

    recorder.static("world/walls", _walls())
    recorder.static("world/objects/target", _tee_boxes(_TARGET_COLOR, _MARKING), _first_transform(target))
    recorder.static("world/objects/tee", _tee_boxes(_TEE_COLOR, task.BAR_HALF_SIZE[2]))
    recorder.static(
        "world/robot/pusher",
        rr.Cylinders3D(
            lengths=[task.PUSHER_LENGTH], radii=[task.PUSHER_RADIUS], colors=[_PUSHER_COLOR], fill_mode="solid"
        ),
    )
    recorder.columns(
        "world/objects/tee",
        rr.Transform3D.columns(translation=_points(tee.x, tee.y, task.TEE_Z), quaternion=yaw_quaternions(tee.yaw)),
    )
    recorder.columns(
        "world/robot/pusher", rr.Transform3D.columns(translation=_points(pusher_x, pusher_y, task.PUSHER_Z))
    )
    _send_path(recorder, "world/paths/tee", _points(tee.x, tee.y, _PATH_Z), _TEE_COLOR, starts)
    _send_path(recorder, "world/paths/pusher", _points(pusher_x, pusher_y, _PATH_Z), _PUSHER_COLOR, starts)


def _send_path(
    recorder: _Recorder,
    entity: str,
    points: Floats,
    color: tuple[int, int, int],
    starts: Ints,
) -> None:
    """Show the whole path of an episode from its first frame on; without boundaries, one path leaps between them."""
    strips = np.split(points, starts[1:])
    recorder.static(entity, rr.LineStrips3D.from_fields(colors=[color], radii=[_LINE_RADIUS]))
    recorder.columns(entity, rr.LineStrips3D.columns(strips=strips), frames=starts)


def _send_errors(recorder: _Recorder, state: Array, reading: Reading, schema: Schema) -> None:
    errors = frame_errors(state, reading, schema)
    for name, values, tolerance, unit in (
        ("pos_err", errors.pos_err, reading.pos_tol, "m"),
        ("ang_err", errors.ang_err, reading.ang_tol, "rad"),
    ):
        recorder.static(f"eval/{name}", rr.SeriesLines(names=f"{name} [{unit}]", colors=_TEE_COLOR, widths=2))
        recorder.columns(f"eval/{name}", rr.Scalars.columns(scalars=values))
        recorder.static(
            f"eval/{name}/tolerance", rr.SeriesLines(names=f"tolerance {tolerance} {unit}", colors=_TOLERANCE_COLOR)
        )
        ends = np.array([0, recorder.n_frames - 1])
        recorder.columns(f"eval/{name}/tolerance", rr.Scalars.columns(scalars=[tolerance] * 2), frames=ends)


def _tee_boxes(color: tuple[int, ...], half_height: float) -> rr.Boxes3D:
    return rr.Boxes3D(
        centers=[(*task.BAR_CENTER, 0), (*task.STEM_CENTER, 0)],
        half_sizes=[(*task.BAR_HALF_SIZE[:2], half_height), (*task.STEM_HALF_SIZE[:2], half_height)],
        colors=[color] * 2,
        fill_mode="solid",
    )


def _walls() -> rr.LineStrips3D:
    corners = [(-1, -1, 0), (1, -1, 0), (1, 1, 0), (-1, 1, 0), (-1, -1, 0)]
    return rr.LineStrips3D([np.multiply(corners, task.WALL)], colors=[_GREY], radii=[_LINE_RADIUS])


def _first_transform(pose: Pose) -> rr.Transform3D:
    return rr.Transform3D(
        translation=_points(pose.x, pose.y, _MARKING)[0], quaternion=rr.Quaternion(xyzw=yaw_quaternions(pose.yaw)[0])
    )


def _points(x: Floats, y: Floats, z: float) -> Floats:
    return np.stack([x, y, np.full_like(x, z)], axis=1)


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


def _blueprint(schema: Schema, features: list[str], reading: Reading | None) -> rrb.Blueprint:
    plots = [_plot("action", "policy/action")] if ACTION in features else []
    if reading is None:
        state = [_plot("state", "observation/state")] if STATE in features else []
        layout: rrb.Container = rrb.Vertical(*state, *plots, _plot("episode", "eval/episode_index", legend=False))
    else:
        world = rrb.Spatial3DView(
            name="world",
            origin="world",
            background=(28, 30, 36),
            line_grid=False,
            eye_controls=rrb.EyeControls3D(position=(0, -0.5, 0.78), look_target=(0, -0.03, 0), eye_up=(0, 0, 1)),
        )
        errors = [
            _plot(f"distance to the target [m], tolerance {reading.pos_tol}", "eval/pos_err", legend=False),
            _plot(f"yaw away from the target [rad], tolerance {reading.ang_tol}", "eval/ang_err", legend=False),
        ]
        layout = rrb.Horizontal(
            world,
            rrb.Vertical(*errors, *plots, _plot("episode", "eval/episode_index", legend=False)),
            column_shares=[3, 2],
        )
    time_panel = rrb.TimePanel(timeline="sim_time", play_state="paused", state="collapsed")
    return rrb.Blueprint(layout, time_panel, collapse_panels=True)


def _plot(name: str, origin: str, legend: bool = True) -> rrb.TimeSeriesView:
    whole_recording = rr.TimeRange(start=rr.TimeRangeBoundary.infinite(), end=rr.TimeRangeBoundary.infinite())
    return rrb.TimeSeriesView(
        name=name,
        origin=origin,
        axis_x=rrb.TimeAxis(view_range=whole_recording),
        plot_legend=rrb.PlotLegend(rrb.Corner2D.RightTop, visible=legend),
    )
