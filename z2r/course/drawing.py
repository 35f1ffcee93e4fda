"""What every figure of the course is drawn with: one style, and the world of PushT seen from above."""

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

from z2r.arrays import Array, Bools, Floats
from z2r.format.schema import Schema
from z2r.pusht import task
from z2r.reading.angles import wrap_angle
from z2r.reading.reading import Pose, Reading, named_columns, read_pose

CARD, INK, GREY = "#faf9f6", "#333333", "#6f6f6f"
BLUE, GREEN, VERMILLION = "#0072b2", "#009e73", "#d55e00"
TEE, TARGET, PUSHER = BLUE, GREEN, VERMILLION  # as in the replay: bluish, greenish, reddish
RIGHT, WRONG = BLUE, VERMILLION

_STYLE = {
    "figure.dpi": 80,
    "figure.facecolor": CARD,
    "figure.constrained_layout.use": True,
    "axes.facecolor": CARD,
    "axes.edgecolor": GREY,
    "axes.labelcolor": INK,
    "axes.spines.right": False,
    "axes.spines.top": False,
    "axes.titlelocation": "left",
    "axes.titlesize": 12,
    "font.size": 11,
    "hatch.linewidth": 0.6,
    "text.color": INK,
    "xtick.color": INK,
    "ytick.color": INK,
}


def in_style[**P](draw: Callable[P, Figure]) -> Callable[P, Figure]:
    """Draw in this module's style, whatever the notebook has set."""

    @wraps(draw)
    def styled(*args: P.args, **kwargs: P.kwargs) -> Figure:
        with plt.style.context(["default", _STYLE]):
            return draw(*args, **kwargs)

    return styled


def new_figure(width: float, height: float) -> Figure:
    """Open a figure in pyplot, without which Jupyter could not show it, and close it, so as not to show it twice."""
    figure = plt.figure(figsize=(width, height))
    plt.close(figure)
    return figure


def box(center: tuple[float, float], half_size: Sequence[float]) -> Floats:
    """Corners of a box seen from above, (4, 2) [m]: top left, top right, bottom right, bottom left."""
    corners = np.array([(-1, 1), (1, 1), (1, -1), (-1, -1)])
    return np.asarray(center) + corners * half_size[:2]


WALLS = box((0, 0), (task.WALL, task.WALL))


def _tee() -> Floats:
    """Outline of the T in its own frame, (8, 2) [m]: the stem hangs from the lower edge of the bar."""
    bar, stem = box(task.BAR_CENTER, task.BAR_HALF_SIZE), box(task.STEM_CENTER, task.STEM_HALF_SIZE)
    return np.concatenate([bar[:3], stem[1:3], stem[3:], stem[:1], bar[3:]])


def tee_outlines(pose: Pose, size: float = 1.0) -> Floats:
    """Outline of the T at each pose, (n, 8, 2) [m]: turned counter-clockwise by the yaw, then moved."""
    x, y = size * _tee().T
    points = (pose.x + 1j * pose.y)[:, None] + np.exp(1j * pose.yaw)[:, None] * (x + 1j * y)
    return np.stack([points.real, points.imag], axis=2)


def single_pose(x: float, y: float, yaw: float) -> Pose:
    """Return one pose, x and y [m] and yaw [rad], as if it were that of a single frame."""
    return Pose(np.array([float(x)]), np.array([float(y)]), np.array([float(yaw)]))


def select_frames(pose: Pose, chosen: Bools | list[int]) -> Pose:
    """Return the poses of some frames, chosen by a mask or by their numbers."""
    return Pose(pose.x[chosen], pose.y[chosen], pose.yaw[chosen])


def on_circle(angle: float, radius: float = 1.0) -> tuple[float, float]:
    """Return the point of a circle around the origin that lies in the direction of an angle [rad]."""
    return float(radius * np.cos(angle)), float(radius * np.sin(angle))


def draw_tees(
    axes: Axes, pose: Pose, color: str, gid: str, strength: Sequence[float] = (1,), fill: float = 0.12, **style: Any
) -> Floats:
    """Draw the T at each pose, each as opaque as its strength, and return the outlines, (n, 8, 2) [m]."""
    alpha = np.broadcast_to(strength, len(pose.yaw))
    outlines = tee_outlines(pose, style.pop("size", 1.0))
    colors = [to_rgba_array([color] * len(alpha), alpha * share) for share in (1, fill)]
    axes.add_collection(PolyCollection(list(outlines), edgecolors=colors[0], facecolors=colors[1], gid=gid, **style))
    return outlines


def draw_target(axes: Axes, pose: Pose) -> Floats:
    """Draw the target once for each pose that it has, which is one in a PushT task; return its first outline."""
    poses = Pose(*np.unique(np.stack(pose, axis=1).round(3), axis=0).T)
    style: dict[str, Any] = {"linestyle": (0, (1.5, 1)), "linewidth": 1.8, "zorder": 2}
    first: Floats = draw_tees(axes, poses, TARGET, "target", **style)[0]
    return first


class Scene(NamedTuple):
    """What a reading sees: two poses, and the pusher's position, float64[n_frames, 2] [m]."""

    tee: Pose
    target: Pose
    pusher: Floats


def read_scene(state: Array, reading: Reading, schema: Schema) -> Scene:
    """Return what a reading sees in some frames, of which there must be one at least."""
    if not len(state):
        raise ValueError("found 0 frames, expected at least one")
    columns = named_columns(state, reading, schema)
    pusher = np.stack([columns[name] for name in reading.pusher], axis=1)
    return Scene(read_pose(columns, reading.tee), read_pose(columns, reading.target), pusher)


def draw_scene(axes: Axes, scene: Scene, n_moments: int) -> Floats:
    """Draw target, block and pusher at some moments, and the block's path; return the block's outlines, (n, 8, 2)."""
    moments = pick_moments(scene.tee, n_moments)
    strength = np.linspace(0.3, 1, len(moments) + 1)[1:].tolist()
    target = draw_target(axes, scene.target)
    outlines = draw_tees(axes, select_frames(scene.tee, moments), TEE, "block", strength, linewidth=1.5)
    for center, alpha in zip(scene.pusher[moments], strength, strict=True):
        # As large as it is: under a wrong reading it stands inside of the block.
        axes.add_patch(Circle(center, task.PUSHER_RADIUS, fill=False, color=PUSHER, alpha=alpha, gid="pusher"))
    draw_path(axes, np.stack([scene.tee.x, scene.tee.y], axis=1), TEE, "block")
    write_beside(axes, "block starts", outlines[0], target.mean(axis=0), TEE)
    write_beside(axes, "target", target, outlines[0].mean(axis=0), TARGET)
    return outlines


def draw_path(axes: Axes, path: Floats, color: str, what: str) -> None:
    """Draw a path, (n, 2) [m], with a dot where it starts and a cross where it ends."""
    axes.plot(*path.T, color=color, linewidth=1, gid=f"{what} path")
    axes.plot(*path[0], "o", color=color, markersize=5, gid=f"{what} start")
    axes.plot(*path[-1], "X", color=color, markersize=8, markeredgecolor=CARD, gid=f"{what} end")


def pick_moments(tee: Pose, n_moments: int) -> list[int]:
    """Pick frames between which the block moves about equally far, so that drawings of it do not pile up."""
    moved = np.hypot(np.diff(tee.x), np.diff(tee.y)) + task.BAR_HALF_SIZE[0] * np.abs(wrap_angle(np.diff(tee.yaw)))
    travelled = np.concatenate([[0.0], np.cumsum(moved)])
    picked = np.searchsorted(travelled, np.linspace(0, travelled[-1], n_moments)[1:-1]).tolist()
    return sorted({0, *picked, len(travelled) - 1})


def set_frame(axes: Axes, points: Floats, margin: float, ratio: float = 0) -> None:
    """Set equal axes in m around the points, `ratio` times as wide as high if given, and draw the walls."""
    low, high = points.min(axis=0) - margin, points.max(axis=0) + margin
    width, height = high - low
    half = np.array([max(width, ratio * height), max(height, width / ratio if ratio else 0)]) / 2
    (left, bottom), (right, top) = (low + high) / 2 - half, (low + high) / 2 + half
    walls = np.append(WALLS, WALLS[:1], axis=0)
    axes.plot(*walls.T, color=GREY, linewidth=2, gid="walls")
    axes.set(aspect="equal", xlabel="x [m]", ylabel="y [m]", xlim=(left, right), ylim=(bottom, top))
    for axis in (axes.xaxis, axes.yaxis):
        axis.set_major_locator(MaxNLocator(5, steps=[1, 2, 5, 10]))


def write_label(axes: Axes, text: str, at: Floats, away: Sequence[float] | Floats, color: str, gap: float = 7) -> None:
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
        path_effects=[withStroke(linewidth=3, foreground=CARD)],
        annotation_clip=True,
    )


def write_beside(axes: Axes, text: str, outline: Floats, other: Floats, color: str) -> None:
    """Write at the corner of an outline that is farthest from something else, where there is most room."""
    corner = outline[np.argmax(np.hypot(*(outline - other).T))]
    write_label(axes, text, corner, corner - outline.mean(axis=0), color, gap=4)


def write_key(axes: Axes, *lines: str) -> None:
    """Say beside the axes, where nothing can be in the way, what the lines are: right, wrong, and the target."""
    for place, (line, color) in enumerate(zip(lines, (RIGHT, WRONG, TARGET), strict=False)):
        axes.text(1.03, 1 - 0.08 * place, line, color=color, va="top", transform=axes.transAxes)
