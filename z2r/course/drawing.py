"""What is every figure of the course drawn with? One style, and the bodies of a reading seen from above."""

from collections.abc import Callable, Sequence
from functools import wraps
from typing import Any

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.collections import PolyCollection
from matplotlib.colors import to_rgba_array
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Polygon
from matplotlib.patheffects import withStroke
from matplotlib.ticker import MaxNLocator

from z2r.api import scene_of
from z2r.arrays import Bools, Floats
from z2r.reading.angles import wrap_angle
from z2r.reading.bodies import Body, Box, Role, bodies_of
from z2r.reading.decode import Decoded
from z2r.reading.poses import Pose
from z2r.reading.reading import Reading

CARD, INK, GREY = "#faf9f6", "#333333", "#6f6f6f"
BLUE, GREEN, VERMILLION = "#0072b2", "#009e73", "#d55e00"
TEE, TARGET, PUSHER = BLUE, GREEN, VERMILLION  # as in the replay: bluish, greenish, reddish
RIGHT, WRONG = BLUE, VERMILLION

_ARROW = 0.03  # of all that is drawn: half the length of a body of which only the place is known
_ARROWHEAD = np.array([(1.0, 0.0), (-0.7, 0.6), (-0.35, 0.0), (-0.7, -0.6)])  # points along its yaw

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
    "text.parse_math": False,  # a name may have a dollar sign
    "xtick.color": INK,
    "ytick.color": INK,
}


def in_style[**P, T](draw: Callable[P, T]) -> Callable[P, T]:
    """Draw in this module's style, whatever the notebook has set."""

    @wraps(draw)
    def styled(*args: P.args, **kwargs: P.kwargs) -> T:
        with plt.style.context(["default", _STYLE]):
            return draw(*args, **kwargs)

    return styled


def new_figure(width: float, height: float) -> Figure:
    """Open a figure in pyplot, without which Jupyter could not show it, and close it, so as not to show it twice."""
    figure = plt.figure(figsize=(width, height))
    plt.close(figure)
    return figure


def outlines_of(body: Body, pose: Pose, size: float = 1.0) -> Floats:
    """Outline of a body at each pose, (n, corners, 2): turned counter-clockwise by the yaw, then moved."""
    x, y = size * body.outline.T
    yaw = np.zeros_like(pose.x) if pose.yaw is None else pose.yaw
    points = (pose.x + 1j * pose.y)[:, None] + np.exp(1j * yaw)[:, None] * (x + 1j * y)  # (n, corners)
    return np.stack([points.real, points.imag], axis=2)


def bodies_to_draw(decoded: Decoded) -> dict[str, Body]:
    """Return the bodies of a reading; one of which nothing but the place is known is drawn as an arrowhead.

    Raises
    ------
    ValueError
        If there is no frame, or the reading has no pose.
    """
    if not len(decoded) or not decoded.reading.poses:
        raise ValueError(f"found {len(decoded)} frames with {len(decoded.reading.poses)} poses, expected one at least")
    scene = scene_of(decoded.reading)
    places = np.concatenate([place(decoded.pose(name)) for name in decoded.reading.poses])
    size = _ARROW * (float(np.ptp(places, axis=0).max()) or 1.0)

    def drawn(body: Body) -> Body:
        return body if body.shapes else body._replace(outline=size * _ARROWHEAD)

    return {name: drawn(body) for name, body in bodies_of(decoded.reading, scene.bodies if scene else {}).items()}


def body_of_role(bodies: dict[str, Body], role: Role) -> str | None:
    """Return the name of the last body with a role; None where there is none."""
    return next((name for name in reversed(bodies) if bodies[name].role == role), None)


def moved_of(bodies: dict[str, Body]) -> str:
    """Return the name of the body that is brought somewhere: the last object, or else the robot itself."""
    return body_of_role(bodies, "object") or next(reversed(bodies))


def robot_of(bodies: dict[str, Body]) -> str | None:
    """Return the name of the robot; None where there is none, or it is what is brought somewhere."""
    robot = body_of_role(bodies, "robot")
    return None if robot == moved_of(bodies) else robot


def place(pose: Pose) -> Floats:
    """Return the position in every frame, seen from above, (n_frames, 2)."""
    return np.stack([pose.x, pose.y], axis=1)


def single_pose(x: float, y: float, yaw: float) -> Pose:
    """Return one pose, x and y [m] and yaw [rad], as if it were that of a single frame."""
    return Pose(np.array([float(x)]), np.array([float(y)]), np.array([float(yaw)]))


def select_frames(pose: Pose, chosen: Bools | list[int]) -> Pose:
    """Return the poses of some frames, chosen by a mask or by their numbers."""
    return Pose(pose.x[chosen], pose.y[chosen], None if pose.yaw is None else pose.yaw[chosen])


def on_circle(angle: float, radius: float = 1.0) -> tuple[float, float]:
    """Return the point of a circle around the origin that lies in the direction of an angle [rad]."""
    return float(radius * np.cos(angle)), float(radius * np.sin(angle))


def draw_bodies(
    axes: Axes,
    body: Body,
    pose: Pose,
    color: str,
    gid: str,
    strength: Sequence[float] = (1,),
    fill: float = 0.12,
    size: float = 1.0,
    **style: Any,
) -> Floats:
    """Draw a body at each pose, each as opaque as its strength, and return the outlines, (n, corners, 2)."""
    alpha = np.broadcast_to(strength, len(pose.x))
    outlines = outlines_of(body, pose, size)
    colors = [to_rgba_array([color] * len(alpha), alpha * share) for share in (1, fill)]
    axes.add_collection(PolyCollection(list(outlines), edgecolors=colors[0], facecolors=colors[1], gid=gid, **style))
    return outlines


def draw_goal(axes: Axes, body: Body, pose: Pose) -> Floats:
    """Draw where a body is to be, once for each pose that this has; return the first outline."""
    yaw = np.zeros_like(pose.x) if pose.yaw is None else pose.yaw
    poses = Pose(*np.unique(np.stack([pose.x, pose.y, yaw], axis=1).round(3), axis=0).T)
    style: dict[str, Any] = {"linestyle": (0, (1.5, 1)), "linewidth": 1.8, "zorder": 2}
    first: Floats = draw_bodies(axes, body, poses, TARGET, body.label, **style)[0]
    return first


def draw_world(axes: Axes, decoded: Decoded, n_moments: int) -> Floats:
    """Draw the bodies at some moments, and the path of what is moved; return its outlines, (n, corners, 2).

    Of each role, the last body in the reading is drawn: what is moved, where it is to be, and what moves it.
    """
    bodies = bodies_to_draw(decoded)
    goal, robot, moved = body_of_role(bodies, "goal"), robot_of(bodies), moved_of(bodies)
    pose = decoded.pose(moved)
    moments = pick_moments(pose, bodies[moved], n_moments)
    strength = np.linspace(0.3, 1, len(moments) + 1)[1:].tolist()
    target = None if goal is None else draw_goal(axes, bodies[goal], decoded.pose(goal))
    at_moments = select_frames(pose, moments)
    outlines = draw_bodies(axes, bodies[moved], at_moments, TEE, bodies[moved].label, strength, linewidth=1.5)
    if robot is not None:
        _draw_robot(axes, bodies[robot], select_frames(decoded.pose(robot), moments), strength)
    draw_path(axes, place(pose), TEE, bodies[moved].label)
    middle = outlines[0].mean(axis=0) if target is None else target.mean(axis=0)
    write_beside(axes, f"{bodies[moved].label} starts", outlines[0], middle, TEE)
    if target is not None and goal is not None:
        write_beside(axes, bodies[goal].label, target, outlines[0].mean(axis=0), TARGET)
    return outlines


def draw_moment(axes: Axes, decoded: Decoded) -> Floats:
    """Draw the bodies in the last of some frames, and the way that they came; return what was drawn, (n, 2)."""
    bodies = bodies_to_draw(decoded)
    goal, robot, moved = body_of_role(bodies, "goal"), robot_of(bodies), moved_of(bodies)
    drawn = [] if goal is None else [draw_goal(axes, bodies[goal], decoded.pose(goal))]
    last = select_frames(decoded.pose(moved), [len(decoded) - 1])
    drawn += [*draw_bodies(axes, bodies[moved], last, TEE, bodies[moved].label, fill=0.25, linewidth=1.5)]
    if robot is not None:
        path = place(decoded.pose(robot))
        axes.plot(*path.T, color=PUSHER, linewidth=1, gid=f"{bodies[robot].label} path")
        _draw_robot(axes, bodies[robot], select_frames(decoded.pose(robot), [len(decoded) - 1]), [1])
    corners: Floats = np.concatenate(drawn)
    return corners


def _draw_robot(axes: Axes, body: Body, pose: Pose, strength: Sequence[float]) -> None:
    if not body.disc:
        draw_bodies(axes, body, pose, PUSHER, body.label, strength)
        return
    for center, alpha in zip(place(pose), strength, strict=True):
        # As large as it is: under a wrong reading it stands inside of another body.
        axes.add_patch(Circle(center, body.disc.radius, fill=False, color=PUSHER, alpha=alpha, gid=body.label))


def put_bodies(axes: Axes, decoded: Decoded) -> Callable[[int], list[Artist]]:
    """Draw the bodies of a reading but for goals; return what moves them to a frame, and says which they are."""
    moved: list[tuple[Polygon, Floats]] = []
    for name, body in bodies_to_draw(decoded).items():
        if body.role == "goal":
            continue
        solid = body if len(body.outline) else body._replace(outline=_round(body))
        outlines = outlines_of(solid, decoded.pose(name))
        ink = TEE if body.role == "object" else PUSHER
        shape = Polygon(outlines[0], facecolor=(ink, 0.7), edgecolor=ink, linewidth=1.5)
        axes.add_patch(shape)
        moved.append((shape, outlines))

    def move(frame: int) -> list[Artist]:
        for shape, outlines in moved:
            shape.set_xy(outlines[frame])
        return [shape for shape, _ in moved]

    return move


def _round(body: Body) -> Floats:
    around = np.linspace(0, 2 * np.pi, 48, endpoint=False)
    return body.reach * np.stack([np.cos(around), np.sin(around)], axis=1)


def draw_path(axes: Axes, path: Floats, color: str, what: str) -> None:
    """Draw a path, (n, 2) [m], with a dot where it starts and a cross where it ends."""
    axes.plot(*path.T, color=color, linewidth=1, gid=f"{what} path")
    axes.plot(*path[0], "o", color=color, markersize=5, gid=f"{what} start")
    axes.plot(*path[-1], "X", color=color, markersize=8, markeredgecolor=CARD, gid=f"{what} end")


def pick_moments(pose: Pose, body: Body, n_moments: int) -> list[int]:
    """Pick frames between which a body moves about equally far, so that drawings of it do not pile up."""
    moved = np.hypot(np.diff(pose.x), np.diff(pose.y))
    if pose.yaw is not None:
        moved += body.outline[:, 0].max() * np.abs(wrap_angle(np.diff(pose.yaw)))
    travelled = np.concatenate([[0.0], np.cumsum(moved)])
    picked = np.searchsorted(travelled, np.linspace(0, travelled[-1], n_moments)[1:-1]).tolist()
    return sorted({0, *picked, len(travelled) - 1})


def walls(reading: Reading) -> Floats | None:
    """Corners of the walls that the scene of a reading has, (4, 2); None where it has none."""
    scene = scene_of(reading)
    return None if scene is None else Box((0.0, 0.0), (scene.half_width, scene.half_width, 0.0)).corners


def set_frame(axes: Axes, reading: Reading, points: Floats, margin: float, ratio: float = 0) -> None:
    """Set equal axes around the points, `ratio` times as wide as high if given, and draw the walls, if any."""
    low, high = points.min(axis=0) - margin, points.max(axis=0) + margin
    width, height = high - low
    half = np.array([max(width, ratio * height), max(height, width / ratio if ratio else 0)]) / 2
    (left, bottom), (right, top) = (low + high) / 2 - half, (low + high) / 2 + half
    corners = walls(reading)
    if corners is not None:
        axes.plot(*np.append(corners, corners[:1], axis=0).T, color=GREY, linewidth=2, gid="walls")
    unit = next(iter(reading.poses.values())).unit
    axes.set(aspect="equal", xlabel=f"x [{unit}]", ylabel=f"y [{unit}]", xlim=(left, right), ylim=(bottom, top))
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
