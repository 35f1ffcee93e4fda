"""Pictures that teach: one episode, the whole dataset, and what a wrong reading does to both.

Every picture is an opaque light card, so that it reads on a light page and on a dark one. Colours are Okabe and Ito's,
which colour-blind people tell apart, and nothing is told by colour alone. A figure is returned closed, so a notebook
shows it once: where it is the last expression of a cell.
"""

from collections.abc import Callable, Sequence
from functools import wraps
from typing import Any, NamedTuple

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgba_array
from matplotlib.figure import Figure
from matplotlib.patches import Circle
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray

from z2r.angles import decode_yaw, wrap_angle
from z2r.dataset import Dataset
from z2r.episodes import EpisodeIndex
from z2r.overlap import pusher_in_block
from z2r.pusht import task
from z2r.reading import Pose, PoseColumns, Reading, named_columns, read_pose
from z2r.schema import Schema
from z2r.success import FrameErrors, frame_errors, in_tolerance

_CARD, _INK, _GREY = "#faf9f6", "#333333", "#6f6f6f"
_BLUE, _GREEN, _VERMILLION = "#0072b2", "#009e73", "#d55e00"
_TEE, _TARGET, _PUSHER = _BLUE, _GREEN, _VERMILLION  # as in the replay: bluish, greenish, reddish
_RIGHT, _WRONG = _BLUE, _VERMILLION
_RIBBON_POINTS = 7.2 * 72  # about how wide the ribbon is on the page
_NEAR = 0.1  # m: what is farther from the block than this says nothing about overlap
_MAX_NUMBERS = 12  # more would hide what they number
_STYLE = {
    "figure.dpi": 80,
    "figure.facecolor": _CARD,
    "figure.constrained_layout.use": True,
    "axes.facecolor": _CARD,
    "axes.edgecolor": _GREY,
    "axes.labelcolor": _INK,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlelocation": "left",
    "axes.titlesize": 12,
    "font.size": 11,
    "hatch.linewidth": 0.6,
    "text.color": _INK,
    "xtick.color": _INK,
    "ytick.color": _INK,
}

type _Array = NDArray[np.float64]


def _in_style[**P](draw: Callable[P, Figure]) -> Callable[P, Figure]:
    """Draw in this module's style, whatever the notebook has set."""

    @wraps(draw)
    def styled(*args: P.args, **kwargs: P.kwargs) -> Figure:
        with plt.style.context(["default", _STYLE]):
            return draw(*args, **kwargs)

    return styled


def _figure(width: float, height: float) -> Figure:
    """Open a figure in pyplot, without which Jupyter could not show it, and close it, so as not to show it twice."""
    figure = plt.figure(figsize=(width, height))
    plt.close(figure)
    return figure


@_in_style
def episode_path(state: NDArray[np.generic], reading: Reading, schema: Schema) -> Figure:
    """Draw one episode seen from above: some moments of the block, and the paths of block and pusher.

    Parameters
    ----------
    state : ndarray, (n_frames, size of the feature)
        Values of the feature that `reading` reads, at least one frame. Positions in m.
    reading : Reading
        What the columns mean.
    schema : Schema
        Where the columns stand.

    Raises
    ------
    ValueError
        If there is no frame, or the schema lacks a column of the reading.
    """
    scene = _read_scene(state, reading, schema)
    figure = _figure(7, 7.2)
    axes = figure.subplots()
    n_drawn = len(_draw_scene(axes, scene, n_moments=7))
    _draw_path(axes, scene.pusher, _PUSHER, "pusher")
    # Neither on the way to the block, nor through the wall.
    _write(axes, "pusher starts", scene.pusher[0], np.sign(scene.pusher[0]) * (-1, 1), _PUSHER)
    _frame(axes, _WALLS, margin=0.02)
    _write(axes, "walls", _WALLS[2], (-1, 1), _GREY)
    moments = f"the block at {_count(n_drawn, 'moment')}, from light to strong"
    axes.set_title(f"{_count(len(state), 'frame')} from above; {moments}\ndot: start, cross: end")
    return figure


@_in_style
def right_and_wrong(state: NDArray[np.generic], right: Reading, wrong: Reading, schema: Schema) -> Figure:
    """Draw the same frames twice, as two readings have them: where the block was, and the pusher at those moments.

    Parameters
    ----------
    state : ndarray, (n_frames, size of the feature)
        Values of the feature that both readings read, at least one frame. Positions in m.
    right, wrong : Reading
        What the columns mean, and what somebody takes them to mean. Where they differ is in the titles.
    schema : Schema
        Where the columns stand.

    Raises
    ------
    ValueError
        If there is no frame, or the schema lacks a column of a reading.
    """
    figure = _figure(7.6, 4.2)
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    corners: list[_Array] = []
    for axes, what, color, one, other in zip(
        panels, ("read right", "read wrong"), (_RIGHT, _WRONG), (right, wrong), (wrong, right), strict=True
    ):
        scene = _read_scene(state, one, schema)
        corners += [*_draw_scene(axes, scene, n_moments=3), *_outlines(scene.target)]
        _write(axes, "pusher", scene.pusher[-1], (1, -1), _PUSHER, gap=12)
        axes.set_title("\n".join([what, *_yaws_that_differ(one, other)]), color=color, size=10)
    for axes in panels:
        _frame(axes, np.concatenate(corners), margin=0.05, ratio=1)
    panels[1].set_ylabel("")
    return figure


@_in_style
def seen_from_block(state: NDArray[np.generic], right: Reading, wrong: Reading, schema: Schema) -> Figure:
    """Draw where the pusher was in every frame as seen from the block, as two readings have it.

    Solid bodies stay apart, so the right reading leaves the block empty, and a gap around it as wide as the pusher.

    Parameters
    ----------
    state : ndarray, (n_frames, size of the feature)
        Values of the feature that both readings read. Positions in m.
    right, wrong : Reading
        What the columns mean, and what somebody takes them to mean.
    schema : Schema
        Where the columns stand.

    Raises
    ------
    ValueError
        If the schema lacks a column of a reading.
    """
    figure = _figure(7.6, 4.2)
    panels = figure.subplots(1, 2, sharex=True, sharey=True)
    for axes, what, color, reading in zip(
        panels, ("read right", "read wrong"), (_RIGHT, _WRONG), (right, wrong), strict=True
    ):
        across, along = pusher_in_block(state, reading, schema)
        outline = _draw_tees(axes, _pose(0, 0, 0), _TEE, "block", fill=0.25).reshape(-1, 2)
        axes.plot(across, along, ".", color=_PUSHER, markersize=4, gid="pusher")
        axes.set_title(what, color=color)
        (left, bottom), (right_end, top) = outline.min(axis=0) - _NEAR, outline.max(axis=0) + _NEAR
        axes.set(aspect="equal", xlabel="across the block [m]", xlim=(left, right_end), ylim=(bottom, top))
    panels[0].set_ylabel("along the block [m]")
    return figure


@_in_style
def episode_ribbon(episodes: EpisodeIndex, reached: NDArray[np.bool_] | None = None) -> Figure:
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
    figure = _figure(8.5, 1.3 if reached is None else 1.7)
    axes = figure.subplots()
    axes.set(xlim=(episodes.from_index[0], episodes.to_index[-1]), xlabel="frame of the dataset", yticks=[])
    axes.xaxis.set_major_formatter("{x:,.0f}")
    axes.spines[["left", "bottom"]].set_visible(False)
    counted = f"{_count(len(episodes), 'episode')}, {_count(episodes.n_frames, 'frame')}"
    if reached is None:
        _draw_segments(axes, episodes, np.ones(len(episodes), np.bool_), 0.0, _BLUE, "")
        axes.set_title(counted)
        return figure
    reached = np.asarray(reached, np.bool_)
    _draw_segments(axes, episodes, reached, 0.4, _RIGHT, "")
    _draw_segments(axes, episodes, ~reached, 0.0, _WRONG, "////")
    axes.set(ylim=(0, 1), yticks=[0.7, 0.3], yticklabels=["reached", "not reached"])
    axes.tick_params(axis="y", length=0)
    for label, color in zip(axes.get_yticklabels(), (_RIGHT, _WRONG), strict=True):
        label.set_color(color)
    axes.set_title(f"{counted}: {_tally(reached)}")
    return figure


@_in_style
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
    figure = _figure(8, 4.7)
    axes, notes = figure.subplots(1, 2, width_ratios=[5, 3])
    axes.set(aspect="equal", xlim=(-1.75, 1.75), ylim=(-1.75, 1.75), xlabel="cos(yaw)", ylabel="sin(yaw)")
    axes.set(xticks=[-1, 0, 1], yticks=[-1, 0, 1], title="Swapped arguments mirror the yaw about 45°")
    axes.add_patch(Circle((0, 0), 1, fill=False, color=_GREY, linewidth=1))
    axes.plot((-1.2, 1.2), (-1.2, 1.2), color=_GREY, linestyle=(0, (6, 3)), linewidth=1.2, gid="mirror")
    axes.plot(*np.transpose([_on_circle(right), _on_circle(wrong)]), color=_GREY, linestyle=":", linewidth=1.2)
    axes.plot(*_on_circle(right + np.pi / 2), "o", markersize=11, color=_GREY, fillstyle="none", gid="quarter turn")
    # Each number stands on the side of its ray that is away from the mirror, so the two never collide.
    side = 1.0 if wrap_angle(right - wrong) > 0 else -1.0
    _draw_yaw(axes, right, side, _RIGHT, "-", "right")
    _draw_yaw(axes, wrong, -side, _WRONG, "--", "wrong")
    _write_notes(notes, right, wrong)
    return figure


@_in_style
def error_traces(errors: FrameErrors, reading: Reading, fps: float) -> Figure:
    """Draw how far the block is from the target in each frame of one episode, and the tolerances.

    Parameters
    ----------
    errors : FrameErrors
        From `z2r.frame_errors`: distance [m] and yaw [rad], each float64[n_frames], at least one frame.
    reading : Reading
        Has the tolerances.
    fps : float
        Frames a second, from the schema.

    Raises
    ------
    ValueError
        If there is no frame, or `fps` is not positive.
    """
    if not len(errors.pos_err) or not fps > 0:
        raise ValueError(f"found {len(errors.pos_err)} frames at {fps} fps, expected at least one at more than 0 fps")
    figure = _figure(8, 4.4)
    panels = figure.subplots(2, 1, sharex=True)
    _draw_trace(panels[0], errors.pos_err, fps, reading.pos_tol, "pos_err", "m")
    _draw_trace(panels[1], errors.ang_err, fps, reading.ang_tol, "ang_err", "rad")
    panels[1].set_xlabel("time [s]")
    outcome = "in tolerance: reached" if in_tolerance(errors, reading)[-1] else "out of tolerance: not reached"
    panels[0].set_title(f"The last stored frame is {outcome}")
    return figure


@_in_style
def final_poses(dataset: Dataset, reading: Reading) -> Figure:
    """Draw where the block stands in the last stored frame of every episode.

    Parameters
    ----------
    dataset : Dataset
        From `z2r.load`.
    reading : Reading
        What the columns mean.

    Raises
    ------
    DatasetError
        If a data file is missing, damaged, or not what the schema and the index say.
    ValueError
        If the schema lacks a column of the reading.
    """
    last = dataset.read(reading.feature)[dataset.episodes.to_index - 1]
    reached = in_tolerance(frame_errors(last, reading, dataset.schema), reading)
    columns = named_columns(last, reading, dataset.schema)
    tee = read_pose(columns, reading.tee)
    figure = _figure(7.6, 4.3)
    axes = figure.subplots()
    target = _draw_target(axes, read_pose(columns, reading.target))
    strength = float(np.clip(12 / len(reached), 0.02, 0.9))  # of thousands, each is faint: where they agree adds up
    for chosen, color, line, what in (
        (reached, _RIGHT, "solid", "reached"),
        (~reached, _WRONG, "dashed", "not reached"),
    ):
        _draw_tees(axes, _select(tee, chosen), color, what, [strength], fill=0, linestyle=line, linewidth=1.3)
    outlines = _outlines(tee)
    _frame(axes, np.concatenate([*outlines, target]), margin=0.02, ratio=1.3)
    _write_key(axes, "solid: reached", "dashed: not reached", "dotted: target")
    if (~reached).sum() <= _MAX_NUMBERS:
        for episode in np.flatnonzero(~reached).tolist():
            _write_beside(axes, f"{episode}", outlines[episode], target.mean(axis=0), _WRONG)
    axes.set_title(f"{_count(len(reached), 'episode')}: {_tally(reached)}")
    return figure


@_in_style
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
    figure = _figure(7.5, 4.2)
    axes = figure.subplots()
    one = _draw_tees(axes, _pose(*expected), _RIGHT, "expected", linewidth=2)
    other = _draw_tees(axes, _pose(*got), _WRONG, "got", linewidth=2, linestyle="dashed")
    _frame(axes, np.concatenate([*one, *other]), margin=0.03, ratio=1.4)
    _write_key(axes, "solid: expected", f"dashed: {label}")
    distance = np.hypot(got[0] - expected[0], got[1] - expected[1])
    turn = np.rad2deg(wrap_angle(got[2] - expected[2]))
    axes.set_title(f"{label}: {distance:.3f} m away and turned by {turn:+.1f}°")
    return figure


def _box(center: tuple[float, float], half_size: Sequence[float]) -> _Array:
    """Corners of a box seen from above, (4, 2) [m]: top left, top right, bottom right, bottom left."""
    corners = np.array([(-1, 1), (1, 1), (1, -1), (-1, -1)])
    return np.asarray(center) + corners * half_size[:2]


_WALLS = _box((0, 0), (task.WALL, task.WALL))


def _tee() -> _Array:
    """Outline of the T in its own frame, (8, 2) [m]: the stem hangs from the lower edge of the bar."""
    bar, stem = _box(task.BAR_CENTER, task.BAR_HALF_SIZE), _box(task.STEM_CENTER, task.STEM_HALF_SIZE)
    return np.concatenate([bar[:3], stem[1:3], stem[3:], stem[:1], bar[3:]])


def _outlines(pose: Pose, size: float = 1.0) -> _Array:
    """Outline of the T at each pose, (n, 8, 2) [m]: turned counter-clockwise by the yaw, then moved."""
    x, y = size * _tee().T
    points = (pose.x + 1j * pose.y)[:, None] + np.exp(1j * pose.yaw)[:, None] * (x + 1j * y)
    return np.stack([points.real, points.imag], axis=2)


def _pose(x: float, y: float, yaw: float) -> Pose:
    return Pose(np.array([float(x)]), np.array([float(y)]), np.array([float(yaw)]))


def _select(pose: Pose, chosen: NDArray[np.bool_] | list[int]) -> Pose:
    return Pose(pose.x[chosen], pose.y[chosen], pose.yaw[chosen])


def _on_circle(angle: float, radius: float = 1.0) -> tuple[float, float]:
    return float(radius * np.cos(angle)), float(radius * np.sin(angle))


def _draw_tees(
    axes: Axes, pose: Pose, color: str, gid: str, strength: Sequence[float] = (1,), fill: float = 0.12, **style: Any
) -> _Array:
    """Draw the T at each pose, each as opaque as its strength, and return the outlines, (n, 8, 2) [m]."""
    alpha = np.broadcast_to(strength, len(pose.yaw))
    outlines = _outlines(pose, style.pop("size", 1.0))
    colors = [to_rgba_array([color] * len(alpha), alpha * share) for share in (1, fill)]
    axes.add_collection(PolyCollection(list(outlines), edgecolors=colors[0], facecolors=colors[1], gid=gid, **style))
    return outlines


def _draw_target(axes: Axes, pose: Pose) -> _Array:
    """Draw the target once for each pose that it has, which is one in a PushT task; return its first outline."""
    poses = Pose(*np.unique(np.stack(pose, axis=1).round(3), axis=0).T)
    style: dict[str, Any] = {"linestyle": (0, (1.5, 1)), "linewidth": 1.8, "zorder": 2}
    first: _Array = _draw_tees(axes, poses, _TARGET, "target", **style)[0]
    return first


class _Scene(NamedTuple):
    """What a reading sees: two poses, and the pusher's position, float64[n_frames, 2] [m]."""

    tee: Pose
    target: Pose
    pusher: _Array


def _read_scene(state: NDArray[np.generic], reading: Reading, schema: Schema) -> _Scene:
    if not len(state):
        raise ValueError("found 0 frames, expected at least one")
    columns = named_columns(state, reading, schema)
    pusher = np.stack([columns[name] for name in reading.pusher], axis=1)
    return _Scene(read_pose(columns, reading.tee), read_pose(columns, reading.target), pusher)


def _draw_scene(axes: Axes, scene: _Scene, n_moments: int) -> _Array:
    """Draw target, block and pusher at some moments, and the block's path; return the block's outlines, (n, 8, 2)."""
    moments = _moments(scene.tee, n_moments)
    strength = np.linspace(0.3, 1, len(moments) + 1)[1:].tolist()
    target = _draw_target(axes, scene.target)
    outlines = _draw_tees(axes, _select(scene.tee, moments), _TEE, "block", strength, linewidth=1.5)
    for center, alpha in zip(scene.pusher[moments], strength, strict=True):
        # As large as it is: under a wrong reading it stands inside of the block.
        axes.add_patch(Circle(center, task.PUSHER_RADIUS, fill=False, color=_PUSHER, alpha=alpha, gid="pusher"))
    _draw_path(axes, np.stack([scene.tee.x, scene.tee.y], axis=1), _TEE, "block")
    _write_beside(axes, "block starts", outlines[0], target.mean(axis=0), _TEE)
    _write_beside(axes, "target", target, outlines[0].mean(axis=0), _TARGET)
    return outlines


def _draw_path(axes: Axes, path: _Array, color: str, what: str) -> None:
    axes.plot(*path.T, color=color, linewidth=1, gid=f"{what} path")
    axes.plot(*path[0], "o", color=color, markersize=5, gid=f"{what} start")
    axes.plot(*path[-1], "X", color=color, markersize=8, markeredgecolor=_CARD, gid=f"{what} end")


def _moments(tee: Pose, n_moments: int) -> list[int]:
    """Pick frames between which the block moves about equally far, so that drawings of it do not pile up."""
    moved = np.hypot(np.diff(tee.x), np.diff(tee.y)) + task.BAR_HALF_SIZE[0] * np.abs(wrap_angle(np.diff(tee.yaw)))
    travelled = np.concatenate([[0.0], np.cumsum(moved)])
    picked = np.searchsorted(travelled, np.linspace(0, travelled[-1], n_moments)[1:-1]).tolist()
    return sorted({0, *picked, len(travelled) - 1})


def _frame(axes: Axes, points: _Array, margin: float, ratio: float = 0) -> None:
    """Set equal axes in m around the points, `ratio` times as wide as high if given, and draw the walls."""
    low, high = points.min(axis=0) - margin, points.max(axis=0) + margin
    width, height = high - low
    half = np.array([max(width, ratio * height), max(height, width / ratio if ratio else 0)]) / 2
    (left, bottom), (right, top) = (low + high) / 2 - half, (low + high) / 2 + half
    walls = np.append(_WALLS, _WALLS[:1], axis=0)
    axes.plot(*walls.T, color=_GREY, linewidth=2, gid="walls")
    axes.set(aspect="equal", xlabel="x [m]", ylabel="y [m]", xlim=(left, right), ylim=(bottom, top))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))


def _write(axes: Axes, text: str, at: _Array, away: Sequence[float] | _Array, color: str, gap: float = 7) -> None:
    """Write beside a point, on the side that `away` points to, with a halo that keeps it readable on lines."""
    x, y = np.asarray(away) / (np.hypot(away[0], away[1]) or 1.0)
    axes.annotate(
        text,
        (float(at[0]), float(at[1])),
        (gap * x, gap * y),
        textcoords="offset points",
        color=color,
        ha="left" if x > 0.3 else "right" if x < -0.3 else "center",
        va="bottom" if y > 0.3 else "top" if y < -0.3 else "center",
        path_effects=[withStroke(linewidth=3, foreground=_CARD)],
        annotation_clip=True,
    )


def _write_beside(axes: Axes, text: str, outline: _Array, other: _Array, color: str) -> None:
    """Write at the corner of an outline that is farthest from something else, where there is most room."""
    corner = outline[np.argmax(np.hypot(*(outline - other).T))]
    _write(axes, text, corner, corner - outline.mean(axis=0), color, gap=4)


def _write_key(axes: Axes, *lines: str) -> None:
    """Say beside the axes, where nothing can be in the way, what the lines are: right, wrong, and the target."""
    for place, (line, color) in enumerate(zip(lines, (_RIGHT, _WRONG, _TARGET), strict=False)):
        axes.text(1.03, 1 - 0.08 * place, line, color=color, va="top", transform=axes.transAxes)


def _yaws_that_differ(reading: Reading, other: Reading) -> list[str]:
    def formula(pose: PoseColumns) -> str:
        return f"atan2({pose.sin_yaw}, {pose.cos_yaw})"

    pairs = (("block", reading.tee, other.tee), ("target", reading.target, other.target))
    return [f"{what}: {formula(one)}" for what, one, two in pairs if formula(one) != formula(two)]


def _draw_segments(
    axes: Axes, episodes: EpisodeIndex, chosen: NDArray[np.bool_], bottom: float, color: str, hatch: str
) -> None:
    """Draw the chosen episodes as segments of the bar; boundaries and numbers where there are pixels for them."""
    lengths = episodes.lengths[chosen]
    spans = list(zip(episodes.from_index[chosen].tolist(), lengths.tolist(), strict=True))
    points = _RIBBON_POINTS * lengths / episodes.n_frames  # how wide each segment is, in points
    typical = float(np.median(points)) if len(points) else 0.0
    style: dict[str, Any] = {"facecolor": color, "edgecolor": _CARD if typical > 1 else "none"}
    style |= {"linewidth": min(1.2, 0.2 * typical), "hatch": hatch if typical > 8 else ""}
    axes.broken_barh(spans, (bottom, 0.6), snap=False, gid="episodes", **style)
    halo = [withStroke(linewidth=4, foreground=color)]
    for number, (start, length), width in zip(np.flatnonzero(chosen).tolist(), spans, points, strict=True):
        if width > 7 * len(f"{number}") + 4:
            middle = (start + length / 2, bottom + 0.3)
            axes.text(*middle, f"{number}", color="white", ha="center", va="center", path_effects=halo)


def _draw_yaw(axes: Axes, yaw: float, side: float, color: str, linestyle: str, what: str) -> None:
    """Draw a yaw as a ray, with a T that points along it, and its number on the given side of the ray."""
    tip = _on_circle(yaw)
    axes.plot(*np.transpose([(0, 0), tip]), color=color, linestyle=linestyle, linewidth=2, gid=what)
    _draw_tees(axes, _pose(*_on_circle(yaw, 1.35), yaw), color, f"{what} block", size=4, linestyle=linestyle)
    axes.plot(*tip, "o", color=color, markersize=6)
    _write(axes, f"{np.rad2deg(yaw):.1f}°", np.multiply(0.6, tip), _on_circle(yaw + np.pi / 2, side), color)


def _write_notes(axes: Axes, right: float, wrong: float) -> None:
    axes.axis("off")
    quarter = np.rad2deg(wrap_angle(right + np.pi / 2))
    for height, color, text in (
        (0.9, _RIGHT, f"read right\natan2(sin, cos) = {np.rad2deg(right):.1f}°"),
        (0.7, _WRONG, f"read wrong\natan2(cos, sin) = {np.rad2deg(wrong):.1f}°"),
        (0.5, _GREY, "dashed: the mirror at 45°, halfway\nbetween the two"),
        (0.3, _GREY, f"ring: {quarter:.1f}°, where turning\nby 90° would have put it"),
    ):
        axes.text(0, height, text, color=color, va="top")


def _draw_trace(axes: Axes, values: _Array, fps: float, tolerance: float, name: str, unit: str) -> None:
    time = np.arange(len(values)) / fps
    end = max(time[-1], 1 / fps)
    axes.axhspan(0, tolerance, color=_GREEN, alpha=0.2, linewidth=0, gid="tolerance")
    axes.plot(time, values, color=_BLUE, linewidth=1.8, gid=name)
    axes.plot(time[-1], values[-1], "o", color=_INK, markersize=6, gid="last stored frame")
    axes.set(ylabel=f"{name} [{unit}]", xlim=(0, 1.22 * end), ylim=(0, 1.1 * max(tolerance, values.max())))
    last = f"last stored frame\n{values[-1]:.3f} {unit}"
    _write(axes, last, np.array([time[-1], values[-1]]), (1, 0.5), _INK)
    _write(axes, f"tolerance {tolerance:g} {unit}", np.array([0, tolerance]), (1, 1), _GREEN, gap=4)


def _count(number: int, noun: str) -> str:
    return f"{number:,} {noun}{'' if number == 1 else 's'}"


def _tally(reached: NDArray[np.bool_]) -> str:
    return f"{reached.sum():,} reached, {(~reached).sum():,} not reached"
