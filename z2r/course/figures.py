"""Pictures that teach: one episode, the whole dataset, and what a wrong reading does to both.

Every picture is an opaque light card, so that it reads on a light page and on a dark one. Colours are Okabe and Ito's,
which colour-blind people tell apart, and nothing is told by colour alone. A figure is returned closed, so a notebook
shows it once: where it is the last expression of a cell.
"""

from collections.abc import Sequence
from textwrap import wrap
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator

from z2r.api import inspect_dataset
from z2r.arrays import Bools, Floats
from z2r.course import drawing
from z2r.course.cameras import picture
from z2r.course.field_guide import Change, by_kind
from z2r.errors import count
from z2r.format.about import short_names
from z2r.format.dataset import Dataset
from z2r.format.episodes import EpisodeIndex
from z2r.format.videos import video_features
from z2r.pusht.overlap import pusher_in_block
from z2r.pusht.world import BODIES, PUSHT
from z2r.reading.action import explained_by_frames, sample_of, sample_windows, sampled_features
from z2r.reading.angles import decode_yaw, wrap_angle
from z2r.reading.bodies import Body
from z2r.reading.decode import Decoded, decode
from z2r.reading.goal import Goal
from z2r.reading.poses import Pose
from z2r.reading.reading import Reading
from z2r.reading.success import FrameErrors, decisive_frame, in_tolerance

_RIBBON_POINTS = 7.2 * 72  # about how wide the ribbon is on the page
_UPRIGHT_POINTS = 6.5  # a narrower segment has no room for a number that stands on end either
_NEAR = 0.1  # m: what is farther from the block than this says nothing about overlap
_MAX_NUMBERS = 12  # more would hide what they number
_MAX_CHECKS = 2  # names that fit in one cell


@drawing.in_style
def episode_path(decoded: Decoded) -> Figure:
    """Draw one episode seen from above: some moments of what is moved, and its path and that of what moves it.

    Parameters
    ----------
    decoded : Decoded
        The frames of the episode, at least one, from `z2r.decode`.

    Raises
    ------
    ValueError
        If there is no frame, or the reading has no pose.
    """
    figure = drawing.new_figure(7, 7.2)
    bodies = drawing.bodies_to_draw(decoded)
    axes = figure.subplots()
    outlines = drawing.draw_world(axes, decoded, n_moments=7)
    everywhere = [*outlines.reshape(-1, 2)]
    robot, walls = drawing.robot_of(bodies), drawing.walls(decoded.reading)
    if robot is not None:
        path = drawing.place(decoded.pose(robot))
        label = bodies[robot].label
        drawing.draw_path(axes, path, drawing.PUSHER, label)
        # Neither on the way to the body, nor through the wall.
        drawing.write_label(axes, f"{label} starts", path[0], np.sign(path[0]) * (-1, 1), drawing.PUSHER)
        everywhere += [*path]
    for name, body in bodies.items():
        everywhere += [*drawing.place(decoded.pose(name))[:1]] if body.role == "goal" else []
    points = np.array(everywhere) if walls is None else walls
    drawing.set_frame(axes, decoded.reading, points, margin=0.05 * float(np.ptp(points, axis=0).max()) or 1.0)
    if walls is not None:
        drawing.write_label(axes, "walls", walls[2], (-1, 1), drawing.GREY)
    moved = bodies[drawing.moved_of(bodies)].label
    moments = f"the {moved} at {count(len(outlines), 'moment')}, from light to strong"
    axes.set_title(f"{count(len(decoded), 'frame')} from above; {moments}\ndot: start, cross: end")
    return figure


@drawing.in_style
def moments(decoded: Decoded, n_moments: int = 5) -> Figure:
    """Draw one episode as a strip of moments: the bodies at each, and the way that they came.

    Parameters
    ----------
    decoded : Decoded
        The frames of the episode, at least one, from `z2r.decode`.
    n_moments : int, optional
        How many moments there are, where the body moves enough; at least two.

    Raises
    ------
    ValueError
        If there is no frame, or the reading has no pose.
    """
    bodies = drawing.bodies_to_draw(decoded)
    moved = drawing.moved_of(bodies)
    picked = drawing.pick_moments(decoded.pose(moved), bodies[moved], n_moments)
    figure = drawing.new_figure(2.2 * len(picked), 2.6)
    panels = figure.subplots(1, len(picked), sharex=True, sharey=True, squeeze=False)[0]
    corners = []
    for axes, frame in zip(panels, picked, strict=True):
        corners += [*drawing.draw_moment(axes, decoded.take(slice(frame + 1)))]
        axes.set_title(f"frame {frame}")
    corners += [*drawing.place(decoded.pose(drawing.robot_of(bodies) or moved))]
    for axes in panels:
        drawing.set_frame(axes, decoded.reading, np.array(corners), margin=0.02, ratio=1)
        axes.set(xlabel="", ylabel="", xticks=[], yticks=[])
        axes.spines[:].set_visible(False)
    return figure


@drawing.in_style
def seams(decoded: Decoded, episodes: EpisodeIndex) -> Figure:
    """Draw the path of what is moved through all episodes, as if they were one, and where it leaps to the next.

    Parameters
    ----------
    decoded : Decoded
        The frames of all episodes.
    episodes : EpisodeIndex
        Where each of them ends; two or more.

    Raises
    ------
    ValueError
        If there are fewer than two episodes.
    """
    if len(episodes) < 2:
        raise ValueError(f"found {count(len(episodes), 'episode')}, expected two or more")
    figure = drawing.new_figure(6, 4.4)
    axes = figure.subplots()
    bodies = drawing.bodies_to_draw(decoded)
    moved = drawing.moved_of(bodies)
    path = drawing.place(decoded.pose(moved))
    for episode in range(len(episodes)):
        axes.plot(*path[episodes[episode]].T, color=drawing.TEE, linewidth=1.5, gid=f"{bodies[moved].label} path")
    for before, after in zip(episodes.to_index[:-1] - 1, episodes.from_index[1:], strict=True):
        ends = path[[before, after]]
        axes.plot(*ends.T, color=drawing.WRONG, linestyle="--", linewidth=1.8, gid="seam")
        drawing.write_label(axes, f"{after}", ends[1], ends[1] - ends[0], drawing.WRONG)
    drawing.set_frame(axes, decoded.reading, path, margin=0.2 * float(np.ptp(path, axis=0).max()) or 1.0, ratio=1.4)
    axes.set_title(f"solid: the {bodies[moved].label} moves, dashed: to the first frame of the next episode")
    return figure


@drawing.in_style
def camera_pictures(dataset: Dataset, frames: Sequence[int]) -> Figure:
    """Show what the cameras of a dataset saw in some frames, all side by side.

    Parameters
    ----------
    dataset : Dataset
        From `z2r.load`, with at least one camera that is stored as video.
    frames : sequence of int
        Which frames of the dataset, at least one.

    Raises
    ------
    DatasetError
        If a video is missing or cannot be decoded.
    MissingExtraError
        If PyAV is not installed.
    ValueError
        If there is no frame, or no camera.
    """
    names = video_features(dataset.schema)
    if not names or not len(frames):
        raise ValueError(f"found {len(names)} cameras and {len(frames)} frames, expected one of each at least")
    across = [(frame, name) for frame in frames for name in names]
    figure = drawing.new_figure(2.6 * len(across), 2.3)
    panels = figure.subplots(1, len(across), squeeze=False)[0]
    labels = dict(zip(names, short_names(names), strict=True))
    for axes, (frame, name) in zip(panels, across, strict=True):
        axes.imshow(picture(dataset, name, frame), gid=name)
        axes.set(title=f"{labels[name]}, frame {frame:,}", xticks=[], yticks=[])
        axes.spines[:].set_visible(False)
    return figure


@drawing.in_style
def right_and_wrong(right: Decoded, wrong: Decoded) -> Figure:
    """Draw the same frames twice, as two readings have them: what is moved, and what moves it, at some moments.

    Parameters
    ----------
    right, wrong : Decoded
        What the frames mean, at least one, and what somebody takes them to mean. Where they differ is in the titles.

    Raises
    ------
    ValueError
        If there is no frame, or a reading has no pose.
    """
    figure = drawing.new_figure(7.6, 4.2)
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    corners: list[Floats] = []
    for axes, what, color, one, other in zip(
        panels,
        ("read right", "read wrong"),
        (drawing.RIGHT, drawing.WRONG),
        (right, wrong),
        (wrong, right),
        strict=True,
    ):
        bodies = drawing.bodies_to_draw(one)
        robot, goal = drawing.robot_of(bodies), drawing.body_of_role(bodies, "goal")
        corners += [*drawing.draw_world(axes, one, n_moments=3)]
        corners += [*drawing.outlines_of(bodies[goal], one.pose(goal))] if goal is not None else []
        if robot is not None:
            last = drawing.place(one.pose(robot))[-1]
            drawing.write_label(axes, bodies[robot].label, last, (1, -1), drawing.PUSHER, gap=12)
        axes.set_title("\n".join([what, *_yaws_that_differ(one.reading, other.reading, bodies)]), color=color, size=10)
    points = np.concatenate(corners)
    for axes in panels:
        drawing.set_frame(axes, right.reading, points, margin=0.08 * float(np.ptp(points, axis=0).max()), ratio=1)
    panels[1].set_ylabel("")
    return figure


@drawing.in_style
def seen_from_block(right: Decoded, wrong: Decoded) -> Figure:
    """Draw where the pusher was in every frame as seen from the block, as two readings have it.

    Solid bodies stay apart, so the right reading leaves the block empty, and a gap around it as wide as the pusher.

    Parameters
    ----------
    right, wrong : Decoded
        What the frames mean, and what somebody takes them to mean; of readings with the scene of PushT.
    """
    figure = drawing.new_figure(7.6, 4.2)
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    for axes, what, color, decoded in zip(
        panels, ("read right", "read wrong"), (drawing.RIGHT, drawing.WRONG), (right, wrong), strict=True
    ):
        across, along = pusher_in_block(decoded)
        outline = _draw_block(axes, drawing.single_pose(0, 0, 0), drawing.TEE, "block", fill=0.25).reshape(-1, 2)
        axes.plot(across, along, ".", color=drawing.PUSHER, markersize=4, gid="pusher")
        axes.set_title(what, color=color)
        (left, bottom), (right_end, top) = outline.min(axis=0) - _NEAR, outline.max(axis=0) + _NEAR
        axes.set(aspect="equal", xlabel="across the block [m]", xlim=(left, right_end), ylim=(bottom, top))
    panels[0].set_ylabel("along the block [m]")
    return figure


@drawing.in_style
def episode_ribbon(episodes: EpisodeIndex, reached: Bools | None = None) -> Figure:
    """Draw a whole dataset at a glance: all frames in one bar, and a segment of it for each episode.

    Parameters
    ----------
    episodes : EpisodeIndex
        At least one episode.
    reached : ndarray, bool[n_episodes], optional
        Which of them reached the target. Those that did not hang lower, in another colour, and hatched.

    Raises
    ------
    ValueError
        If there is no episode, or `reached` has another length than the index.
    """
    if not len(episodes) or (reached is not None and len(reached) != len(episodes)):
        found = "" if reached is None else f" and {len(reached)} values of reached"
        raise ValueError(f"found {len(episodes)} episodes{found}, expected at least one and a value for each")
    figure = drawing.new_figure(8.5, 1.3 if reached is None else 1.7)
    axes = figure.subplots()
    axes.set(xlim=(episodes.from_index[0], episodes.to_index[-1]), xlabel="frame of the dataset", yticks=[])
    axes.xaxis.set_major_formatter("{x:,.0f}")
    axes.spines[["left", "bottom"]].set_visible(False)
    counted = f"{count(len(episodes), 'episode')}, {count(episodes.n_frames, 'frame')}"
    if reached is None:
        _draw_segments(axes, episodes, np.ones(len(episodes), np.bool_), 0.0, drawing.BLUE, "")
        axes.set_title(counted)
        return figure
    reached = np.asarray(reached, np.bool_)
    _draw_segments(axes, episodes, reached, 0.4, drawing.RIGHT, "")
    _draw_segments(axes, episodes, ~reached, 0.0, drawing.WRONG, "////")
    axes.set(ylim=(0, 1), yticks=[0.7, 0.3], yticklabels=["reached", "not reached"])
    axes.tick_params(axis="y", length=0)
    for label, color in zip(axes.get_yticklabels(), (drawing.RIGHT, drawing.WRONG), strict=True):
        label.set_color(color)
    axes.set_title(f"{counted}: {_tally(reached)}")
    return figure


@drawing.in_style
def yaw_circle(sin_yaw: float, cos_yaw: float) -> Figure:
    """Draw one yaw on the unit circle, decoded right and decoded with the two arguments swapped.

    Parameters
    ----------
    sin_yaw, cos_yaw : float
        Sine and cosine of the yaw, as they are stored.

    Raises
    ------
    ValueError
        If both are zero, or one is not finite: that is no direction.
    """
    if not np.isfinite([sin_yaw, cos_yaw]).all() or sin_yaw == cos_yaw == 0:
        raise ValueError(f"found sin {sin_yaw} and cos {cos_yaw}, expected finite numbers that are not both zero")
    right, wrong = float(decode_yaw(sin_yaw, cos_yaw)), float(decode_yaw(cos_yaw, sin_yaw))
    figure = drawing.new_figure(8, 4.7)
    axes, notes = figure.subplots(1, 2, width_ratios=[5, 3])
    axes.set(aspect="equal", xlim=(-1.75, 1.75), ylim=(-1.75, 1.75), xlabel="cos(yaw)", ylabel="sin(yaw)")
    axes.set(xticks=[-1, 0, 1], yticks=[-1, 0, 1], title="Swapped arguments mirror the yaw about 45°")
    axes.add_patch(Circle((0, 0), 1, fill=False, color=drawing.GREY, linewidth=1))
    axes.plot((-1.2, 1.2), (-1.2, 1.2), color=drawing.GREY, linestyle=(0, (6, 3)), linewidth=1.2, gid="mirror")
    axes.plot(
        *np.transpose([drawing.on_circle(right), drawing.on_circle(wrong)]),
        color=drawing.GREY,
        linestyle=":",
        linewidth=1.2,
    )
    axes.plot(
        *drawing.on_circle(right + np.pi / 2),
        "o",
        markersize=11,
        color=drawing.GREY,
        fillstyle="none",
        gid="quarter turn",
    )
    # Each number stands on the side of its ray that is away from the mirror, so the two never collide.
    side = 1.0 if wrap_angle(right - wrong) > 0 else -1.0
    _draw_yaw(axes, right, side, drawing.RIGHT, "-", "right")
    _draw_yaw(axes, wrong, -side, drawing.WRONG, "--", "wrong")
    _write_notes(notes, right, wrong)
    return figure


@drawing.in_style
def error_traces(errors: FrameErrors, reading: Reading, fps: float) -> Figure:
    """Draw how far each frame of one episode is from each goal of the reading, and the limits.

    Parameters
    ----------
    errors : dict of str to ndarray, float64[n_frames]
        From `z2r.frame_errors`, at least one frame.
    reading : Reading
        Has the goals, at least one, and their limits.
    fps : float
        Frames a second, from the schema.

    Raises
    ------
    ValueError
        If there is no frame, or `fps` is not positive.
    """
    n_frames = len(next(iter(errors.values()), ()))
    if not n_frames or not fps > 0:
        raise ValueError(f"found {n_frames} frames at {fps} fps, expected at least one at more than 0 fps")
    figure = drawing.new_figure(8, 2.2 * len(reading.goal))
    panels = figure.subplots(len(reading.goal), 1, sharex=True, squeeze=False)[:, 0]
    for axes, goal in zip(panels, reading.goal, strict=True):
        _draw_trace(axes, errors[goal.name], fps, goal, reading)
    panels[-1].set_xlabel("time [s]")
    reached = in_tolerance(errors, reading)[decisive_frame(n_frames, reading)]
    outcome = "in tolerance: reached" if reached else "out of tolerance: not reached"
    panels[0].set_title(f"The {'last stored' if reading.decisive == 'last' else 'first'} frame is {outcome}")
    return figure


@drawing.in_style
def final_poses(dataset: Dataset, reading: Reading) -> Figure:
    """Draw where the body that a goal moves stands in the decisive frame of every episode.

    Parameters
    ----------
    dataset : Dataset
        From `z2r.load`.
    reading : Reading
        What the columns mean: its goals are about poses.

    Raises
    ------
    DatasetError
        If a data file is missing, damaged, or not what the schema and the index say.
    ValueError
        If the schema lacks a column of the reading, or no goal is about a pose.
    """
    inspection = inspect_dataset(dataset, reading=reading)
    if inspection.outcome is None or reading.moved is None:
        raise ValueError(f"found {reading}, expected one that fits and has a goal between two poses")
    reached = inspection.outcome.reached
    ends = decode(inspection.ends[reading.decisive], reading, dataset.schema)
    bodies = drawing.bodies_to_draw(ends)
    body, pose = bodies[reading.moved], ends.pose(reading.moved)
    figure = drawing.new_figure(7.6, 4.3)
    axes = figure.subplots()
    target = drawing.draw_goal(axes, bodies[reading.destination], ends.pose(reading.destination))
    strength = float(np.clip(12 / len(reached), 0.02, 0.9))  # of thousands, each is faint: where they agree adds up
    for chosen, color, line, what in (
        (reached, drawing.RIGHT, "solid", "reached"),
        (~reached, drawing.WRONG, "dashed", "not reached"),
    ):
        some = drawing.select_frames(pose, chosen)
        drawing.draw_bodies(axes, body, some, color, what, [strength], fill=0, linestyle=line, linewidth=1.3)
    outlines = drawing.outlines_of(body, pose)
    points = np.concatenate([*outlines, target])
    drawing.set_frame(axes, reading, points, margin=0.1 * float(np.ptp(points, axis=0).max()), ratio=1.3)
    drawing.write_key(axes, "solid: reached", "dashed: not reached", f"dotted: {bodies[reading.destination].label}")
    if (~reached).sum() <= _MAX_NUMBERS:
        for episode in np.flatnonzero(~reached).tolist():
            drawing.write_beside(axes, f"{episode}", outlines[episode], target.mean(axis=0), drawing.WRONG)
    axes.set_title(f"{count(len(reached), 'episode')}: {_tally(reached)}")
    return figure


@drawing.in_style
def two_poses(
    expected: tuple[float, float, float], got: tuple[float, float, float], label: str = "your answer"
) -> Figure:
    """Draw the T where it should be and where somebody has it.

    Parameters
    ----------
    expected, got : tuple of three float
        x [m], y [m], yaw [rad].
    label : str, optional
        What to call `got`.

    Raises
    ------
    ValueError
        If a number is not finite.
    """
    if not np.isfinite([*expected, *got]).all():
        raise ValueError(f"found {expected} and {got}, expected finite numbers")
    figure = drawing.new_figure(7.5, 4.2)
    axes = figure.subplots()
    one = _draw_block(axes, drawing.single_pose(*expected), drawing.RIGHT, "expected", linewidth=2)
    other = _draw_block(axes, drawing.single_pose(*got), drawing.WRONG, "got", linewidth=2, linestyle="dashed")
    drawing.set_frame(axes, PUSHT, np.concatenate([*one, *other]), margin=0.03, ratio=1.4)
    drawing.write_key(axes, "solid: expected", f"dashed: {label}")
    distance = np.hypot(got[0] - expected[0], got[1] - expected[1])
    turn = np.rad2deg(wrap_angle(got[2] - expected[2]))
    axes.set_title(f"{label}: {distance:.3f} m away and turned by {turn:+.1f}°")
    return figure


@drawing.in_style
def action_and_motion(action: Floats, velocity: Floats, fps: float) -> Figure:
    """Draw what was asked of the pusher and what it did, along one axis.

    Parameters
    ----------
    action : ndarray, float64[n_frames]
        The velocity that the action of each frame asks for [m/s], at least two frames.
    velocity : ndarray, float64[n_frames - 1]
        How fast the pusher went from each frame to the next [m/s].
    fps : float
        Frames a second.

    Raises
    ------
    ValueError
        If there are fewer than two frames, or not one velocity less than actions.
    """
    if len(action) < 2 or len(velocity) != len(action) - 1:
        raise ValueError(f"found {len(action)} actions and {len(velocity)} velocities, expected 2 or more and one less")
    figure = drawing.new_figure(8, 2.9)
    axes = figure.subplots()
    time = np.arange(len(action)) / fps
    axes.plot(time, action, "o", color=drawing.BLUE, markersize=7, fillstyle="none", gid="action")
    axes.plot(time[:-1], velocity, "x-", color=drawing.VERMILLION, markersize=6, linewidth=1, gid="motion")
    axes.set(xlabel="time of the frame [s]", ylabel="velocity [m/s]")
    axes.set_title("ring: what the action of a frame asks, cross: what the pusher then does")
    return figure


@drawing.in_style
def what_changes(changes: Sequence[Change]) -> Figure:
    """Draw what each break mode changes, and which checks of the audit notice it; those of a kind come together.

    Parameters
    ----------
    changes : sequence of Change
        From `z2r.course.field_guide.what_changes`, at least one.

    Raises
    ------
    ValueError
        If there is none.
    """
    if not changes:
        raise ValueError("found no change, expected at least one")
    kinds = by_kind(changes)
    n_rows = len(changes) + len(kinds)
    figure = drawing.new_figure(11.5, 1 + 0.34 * n_rows)
    axes = figure.subplots()
    columns = [name.replace(" ", "\n", 1) for name in changes[0].marks]
    axes.set(xlim=(-0.5, len(columns) + 2.7), ylim=(n_rows - 0.4, -0.6))
    axes.set(xticks=range(len(columns)), xticklabels=columns)
    after = len(columns) - 0.4
    axes.text(after, -0.7, "checks of the audit\nthat find it", va="bottom")
    axes.tick_params(length=0, labeltop=True, labelbottom=False)
    axes.spines[["left", "bottom"]].set_visible(False)
    rows: dict[int, Change] = {}
    for kind, own in kinds.items():
        heading = len(rows) + list(kinds).index(kind)
        axes.text(-0.4, heading, kind, va="center", weight="bold", color=drawing.BLUE)
        rows |= enumerate(own, heading + 1)
    axes.set(yticks=list(rows), yticklabels=[change.name for change in rows.values()])
    for row, change in rows.items():
        axes.axhline(row + 0.5, color=drawing.GREY, linewidth=0.3)
        for column, text in enumerate(change.marks.values()):
            style: dict[str, Any] = {"boxstyle": "round,pad=0.25", "edgecolor": drawing.WRONG, "facecolor": "none"}
            axes.text(column, row, text or "·", ha="center", va="center", bbox=style if text else None)
        axes.text(after, row, _noticed(change), va="center", weight="normal" if change.checks else "bold")
    return figure


@drawing.in_style
def action_fits(dataset: Dataset, dim: int = 0) -> Figure:
    """Draw how well each explanation explains one dimension of the action, frames ahead by frames ahead.

    Parameters
    ----------
    dataset : Dataset
        From `z2r.load`. Its frames are in memory at once.
    dim : int, optional
        Which dimension of the action.

    Raises
    ------
    ValueError
        If the dataset has no such dimension.
    """
    inspection = inspect_dataset(dataset)
    if not 0 <= dim < len(inspection.action):
        raise ValueError(f"found dimension {dim}, expected one of {len(inspection.action)}")
    driven, windows = inspection.action[dim], sample_windows(dataset.episodes)
    frames = {name: dataset.read(name)[windows.frame_numbers] for name in sampled_features(dataset.schema)}
    curves = explained_by_frames(sample_of(frames, windows, dataset.schema), dim)
    figure = drawing.new_figure(8, 3.2)
    axes = figure.subplots()
    for (what, values), color, style in zip(curves.items(), (drawing.BLUE, drawing.VERMILLION), "os", strict=False):
        axes.plot(100 * values, f"{style}-", color=color, markersize=4, linewidth=1, gid=what)
        best = int(np.argmax(values))
        drawing.write_label(axes, what, np.array([best, 100 * values[best]]), (0, 1), color)
    axes.set(xlabel="frames ahead", ylabel="of the action explained [%]", xlim=(-1, 23), ylim=(0, 118))
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
    axes.set_title("\n".join(wrap(f"{driven}".replace("$", r"\$"), 90)), size=10)
    return figure


def _noticed(change: Change) -> str:
    if change.is_dormant:
        return "nothing to find here"
    more = len(change.checks) - _MAX_CHECKS
    names = ", ".join(change.checks[:_MAX_CHECKS]) or "NONE"
    return f"{names}, {more} more" if more > 0 else names


def _yaws_that_differ(reading: Reading, other: Reading, bodies: dict[str, Body]) -> list[str]:
    """Say how a reading decodes each yaw that another one decodes in another way; what is moved comes first."""
    yaws = {name: pose.yaw.formula for name, pose in reading.poses.items() if pose.yaw}
    others = {name: pose.yaw.formula for name, pose in other.poses.items() if pose.yaw}
    moved_first = [name for name in reversed(bodies) if name in yaws]
    return [f"{bodies[name].label}: {yaws[name]}" for name in moved_first if yaws[name] != others.get(name)]


def _draw_block(axes: Axes, pose: Pose, color: str, gid: str, **style: Any) -> Floats:
    """Draw the T of the course, which gives a yaw a shape."""
    return drawing.draw_bodies(axes, BODIES["tee"], pose, color, gid, **style)


def _draw_segments(axes: Axes, episodes: EpisodeIndex, chosen: Bools, bottom: float, color: str, hatch: str) -> None:
    """Draw the chosen episodes as segments of the bar; boundaries and numbers where there are pixels for them."""
    lengths = episodes.lengths[chosen]
    spans = list(zip(episodes.from_index[chosen].tolist(), lengths.tolist(), strict=True))
    points = _RIBBON_POINTS * lengths / episodes.n_frames  # how wide each segment is, in points
    typical = float(np.median(points)) if len(points) else 0.0
    style: dict[str, Any] = {"facecolor": color, "edgecolor": drawing.CARD if typical > 1 else "none"}
    style |= {"linewidth": min(1.2, 0.2 * typical), "hatch": hatch if typical > 8 else ""}
    axes.broken_barh(spans, (bottom, 0.6), snap=False, gid="episodes", **style)
    halo = [withStroke(linewidth=4, foreground=color)]
    for number, (start, length), width in zip(np.flatnonzero(chosen).tolist(), spans, points, strict=True):
        middle, fits = (start + length / 2, bottom + 0.3), width > 7 * len(f"{number}") + 4
        if fits or width > _UPRIGHT_POINTS:
            how: dict[str, Any] = {} if fits else {"rotation": 90, "size": 8}
            axes.text(*middle, f"{number}", color="white", ha="center", va="center", path_effects=halo, **how)


def _draw_yaw(axes: Axes, yaw: float, side: float, color: str, linestyle: str, what: str) -> None:
    """Draw a yaw as a ray, with a T that points along it, and its number on the given side of the ray."""
    tip = drawing.on_circle(yaw)
    axes.plot(*np.transpose([(0, 0), tip]), color=color, linestyle=linestyle, linewidth=2, gid=what)
    beside = drawing.single_pose(*drawing.on_circle(yaw, 1.35), yaw)
    _draw_block(axes, beside, color, f"{what} block", size=4, linestyle=linestyle)
    axes.plot(*tip, "o", color=color, markersize=6)
    drawing.write_label(
        axes, f"{np.rad2deg(yaw):.1f}°", np.multiply(0.6, tip), drawing.on_circle(yaw + np.pi / 2, side), color
    )


def _write_notes(axes: Axes, right: float, wrong: float) -> None:
    axes.axis("off")
    quarter = np.rad2deg(wrap_angle(right + np.pi / 2))
    for height, color, text in (
        (0.9, drawing.RIGHT, f"read right\natan2(sin, cos) = {np.rad2deg(right):.1f}°"),
        (0.7, drawing.WRONG, f"read wrong\natan2(cos, sin) = {np.rad2deg(wrong):.1f}°"),
        (0.5, drawing.GREY, "dashed: the mirror at 45°, halfway\nbetween the two"),
        (0.3, drawing.GREY, f"ring: {quarter:.1f}°, where turning\nby 90° would have put it"),
    ):
        axes.text(0, height, text, color=color, va="top")


def _draw_trace(axes: Axes, values: Floats, fps: float, goal: Goal, reading: Reading) -> None:
    unit, decisive = reading.unit(goal), decisive_frame(len(values), reading)
    time = np.arange(len(values)) / fps
    end = max(time[-1], 1 / fps)
    low, high = goal.band
    shown = [0.0, *goal.limits.values(), *values[np.isfinite(values)]]
    bottom, top = min(shown), max(shown) + 0.1 * float(np.ptp(shown) or 1.0)
    if goal.limits:
        ends = bottom if low is None else max(low, bottom), top if high is None else high
        axes.axhspan(*ends, color=drawing.GREEN, alpha=0.2, linewidth=0, gid="tolerance")
    axes.plot(time, values, color=drawing.BLUE, linewidth=1.8, gid=goal.name)
    what = "last stored frame" if reading.decisive == "last" else "first frame"
    axes.plot(time[decisive], values[decisive], "o", color=drawing.INK, markersize=6, gid=what)
    label = f"{goal.name} [{unit}]" if unit else goal.name
    axes.set(ylabel=label, xlim=(0, 1.22 * end), ylim=(bottom, top))
    said = f"{what}\n{values[decisive]:.3f} {unit}"
    drawing.write_label(axes, said, np.array([time[decisive], values[decisive]]), (1, 0.5), drawing.INK)
    for limit, value in goal.limits.items():
        said = f"{'tolerance' if limit == 'within' else limit.replace('_', ' ')} {value:g} {unit}"
        drawing.write_label(axes, said, np.array([0, value]), (1, 1), drawing.GREEN, gap=4)


def _tally(reached: Bools) -> str:
    return f"{reached.sum():,} reached, {(~reached).sum():,} not reached"
