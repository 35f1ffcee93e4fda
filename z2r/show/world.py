"""Where was every body? The world of a recording: bodies that move, and the paths that they took."""

from typing import NamedTuple

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from z2r.arrays import Floats
from z2r.reading.angles import yaw_quaternions
from z2r.reading.bodies import Body, Role, bodies_of
from z2r.reading.decode import Decoded
from z2r.reading.poses import Pose
from z2r.reading.scene import Scene
from z2r.show.recorder import Recorder

COLORS: dict[Role, tuple[int, ...]] = {"object": (115, 128, 242), "goal": (90, 205, 100), "robot": (230, 102, 90)}
_SEE_THROUGH = 120  # of 255: a marking lets what stands on it be seen
_GREY = (128, 128, 128)
_LINE_WIDTH = 0.003  # of what is looked at: radius of a path
_POINT_SIZE = 0.02  # of what is looked at: radius of a body of which nothing but the place is known
_PATH_Z = 0.002  # m: just above the table


class _View(NamedTuple):
    """What the camera looks at: the middle of it, and how far it goes from there, in the unit of the positions."""

    middle: tuple[float, float, float]
    reach: float


def send_world(recorder: Recorder, decoded: Decoded, scene: Scene | None) -> rrb.View:
    """Send the bodies of a reading that has poses; return the view that shows them.

    Parameters
    ----------
    recorder : Recorder
        Where they go: `world/objects`, `world/robot` and `world/paths`.
    decoded : Decoded
        All frames that are shown.
    scene : Scene, optional
        What the bodies look like; without it, each is a point.
    """
    view = _view(decoded, scene)
    if scene:
        recorder.static("world/walls", _walls(scene.half_width, view))
    for name, body in bodies_of(decoded.reading, scene.bodies if scene else {}).items():
        pose, color = decoded.pose(name), COLORS[body.role]
        part = rr.escape_entity_path_part(name)  # a "/" would make one body move with another
        entity = f"world/{'robot' if body.role == 'robot' else 'objects'}/{part}"
        recorder.static(entity, *_shapes(body, color, view, turns=bool(decoded.reading.poses[name].orientation)))
        if body.flat and _stays(pose):
            recorder.static(entity, _first_transform(pose, body))
            continue
        recorder.columns(entity, rr.Transform3D.columns(translation=_points(pose, body.z), quaternion=_turns(pose)))
        if body.role != "goal":
            _send_path(recorder, f"world/paths/{part}", _points(pose, _PATH_Z), color, view)
    return _world_view(view)


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


def _send_path(recorder: Recorder, entity: str, points: Floats, color: tuple[int, ...], view: _View) -> None:
    """Show the whole path of an episode from its first frame on; without boundaries, one path leaps between them."""
    strips = np.split(points, recorder.starts[1:])
    recorder.static(entity, rr.LineStrips3D.from_fields(colors=[color], radii=[_LINE_WIDTH * view.reach]))
    recorder.columns(entity, rr.LineStrips3D.columns(strips=strips), frames=recorder.starts)


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


def _world_view(view: _View) -> rrb.View:
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
