"""A scripted expert that pushes the T onto the target, much as a person would. It reads the observation, nothing else.

It knows one piece of physics. Friction on the block is viscous, so a force f along the normal n of a face, at a point p
of the block, moves the block by (x, y, yaw) ~ f * (n_x, n_y, m / R^2), with the lever arm m = p_x n_y - p_y n_x and the
block's rough radius R. A push aimed at the origin only shifts the block, one far from it mostly turns it. For each
metre that the pusher travels, this twist is constant in the frame of the block, so the block ends up on an arc that has
a closed form, however long the push (quasi-static pushing under an ellipsoidal limit surface: K. M. Lynch, H. Maekawa
and K. Tanie, "Manipulation and active sensing by pushing using tactile feedback", IROS 1992).

An episode is a few pushes, each chosen among a fixed set of contacts, and each goes through named phases:

- ``approach``: let go of the block and go around it, to wait a little off the chosen contact;
- ``shove``: push along the normal of the face, for as long as that brings the block closer to the target;
- ``correct``: the same, gently, for a block that is nearly there;
- ``hold``: the block is there, so let go of it and keep still.
"""

from typing import Literal, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from z2r.arrays import Floats
from z2r.pusht.task import (
    ANG_TOL,
    CONTROL_HZ,
    POS_TOL,
    PUSHER_RADIUS,
    STATE_NAMES,
    WALL,
)
from z2r.pusht.world import TEE_BOXES, in_tolerance
from z2r.reading.angles import decode_yaw, wrap_angle

Phase = Literal["approach", "shove", "correct", "hold"]

BLOCK_RADIUS = 0.05  # m: R above, the root of yaw damping over slide damping in the simulator
YAW_WEIGHT = POS_TOL / ANG_TOL  # m/rad: a radian of yaw error counts as this many metres

APPROACH_SPEED = 0.30  # m/s
SHOVE_SPEED = 0.20  # m/s
CORRECT_SPEED = 0.10  # m/s
SLOWEST_SPEED = 0.03  # m/s: a shove does not creep to its end more slowly than this
ACCELERATION = 2.0  # m/s^2: limits how fast the commanded velocity changes
SETTLE_RATE = 5.0  # 1/s: speed towards a place, for each metre away from it
SWITCH_TIME = 0.8  # s: what letting go of one contact and settling at another costs, beside the way

NEAR_GAP = 0.008  # m: least gap between pusher and block on the way around
WIDE_GAP = 0.018  # m: gap between pusher and block where it waits to push, and where it turns a corner
ALIGNED = 0.008  # m: how far from its place the pusher may begin to shove
SLIPPED = 0.016  # m: how far the pusher may slide along the face before the shove is given up

NEARLY_THERE = 0.06  # m: with less error than this, a push is a correction
THERE = 0.5  # of both tolerances: a push goes on until the block is this near, although the whole would do
NOTHING_LEFT = 0.002  # m: a push is over when this much more of it would bring nothing
LENGTHS = np.concatenate((np.arange(0.0, 0.04, 0.002), np.arange(0.04, 0.4, 0.01)))  # m: the pushes considered

CONTACT_SPACING = 0.015  # m: between neighbouring contacts on a face
CONTACT_INSET = 0.010  # m: from a contact to the end of its face, at least

_BOXES = tuple((np.array(box.center), np.array(box.half_size[:2])) for box in TEE_BOXES)


class View(NamedTuple):
    """What one observation says: `pose` and `target` are (x, y, yaw), `pusher` is (x, y) in the frame of the block."""

    pose: Floats
    target: Floats
    pusher: Floats


def _clearance(points: Floats) -> Floats:
    """Distance [m] of `points` (..., 2), in the frame of the block, from its outline: shape (...), negative inside."""
    distances = []
    for center, half_size in _BOXES:
        beyond = np.abs(points - center) - half_size
        outside = np.linalg.norm(np.maximum(beyond, 0.0), axis=-1)
        distances.append(outside + np.minimum(beyond.max(axis=-1), 0.0))
    nearest: Floats = np.minimum(*distances)
    return nearest


def _away(point: Floats) -> Floats:
    """Direction (2,) in which `point` (2,), in the frame of the block, gets away from the block fastest."""
    step = 1e-4 * np.eye(2)
    slope = _clearance(point + step) - _clearance(point - step)
    direction: Floats = slope / max(float(np.linalg.norm(slope)), 1e-9)
    return direction


def _rotate(vectors: Floats, yaw: Floats | float) -> Floats:
    """Turn `vectors` (..., 2) counter-clockwise by `yaw` [rad]."""
    x, y = vectors[..., 0], vectors[..., 1]
    return np.stack((np.cos(yaw) * x - np.sin(yaw) * y, np.sin(yaw) * x + np.cos(yaw) * y), axis=-1)


def _distances(starts: Floats, ends: Floats, pose: Floats) -> Floats:
    """Distance [m] between `starts` and `ends`, both (..., 2) in the frame of a block at `pose` (3,).

    Infinite where the block is in the straight way, or where the end is too close to a wall for the pusher.
    """
    fraction = np.linspace(0.0, 1.0, 33)[:, None]
    way = starts[..., None, :] * (1 - fraction) + ends[..., None, :] * fraction
    clear = _clearance(way).min(axis=-1) >= PUSHER_RADIUS + NEAR_GAP
    fits = np.abs(pose[:2] + _rotate(ends, pose[2])).max(axis=-1) < WALL - PUSHER_RADIUS
    return np.where(clear & fits, np.linalg.norm(ends - starts, axis=-1), np.inf)


def _find_contacts() -> tuple[Floats, Floats]:
    """Contacts (C, 2): the pusher's centre where it touches a face, evenly spaced, and (C, 2): that face's normal in.

    Those are left out where the pusher cannot wait: inside the T, and too deep in the corners between bar and stem.
    """
    touch, inward = [], []
    for center, half_size in _BOXES:
        for axis, side in ((0, -1.0), (0, 1.0), (1, -1.0), (1, 1.0)):
            count = 1 + int(2 * (half_size[1 - axis] - CONTACT_INSET) / CONTACT_SPACING)
            normal = -side * np.eye(2)[axis]
            middle = center - normal * (half_size[axis] + PUSHER_RADIUS)
            along = (np.arange(count) - (count - 1) / 2) * CONTACT_SPACING
            touch.extend(middle + along[:, None] * np.eye(2)[1 - axis])
            inward.extend([normal] * count)
    touches, normals = np.array(touch), np.array(inward)
    reachable = _clearance(touches - WIDE_GAP * normals) > PUSHER_RADIUS + NEAR_GAP
    return touches[reachable], normals[reachable]


def _find_corners() -> Floats:
    """Where the pusher turns on its way around the block: (6, 2), diagonally off the outer corners of the T."""
    diagonals = np.array(((-1, -1), (-1, 1), (1, 1), (1, -1)))
    gap = PUSHER_RADIUS + WIDE_GAP
    corners = np.concatenate([center + (half_size + gap) * diagonals for center, half_size in _BOXES])
    outer: Floats = corners[_clearance(corners) >= gap]
    return outer


TOUCH, INWARD = _find_contacts()
WAIT = TOUCH - WIDE_GAP * INWARD
CORNERS = _find_corners()
_LEVER = TOUCH[:, 0] * INWARD[:, 1] - TOUCH[:, 1] * INWARD[:, 0]
# (C, 3): how the block moves, in its own frame, for each metre that the pusher travels along the normal.
TWIST = np.column_stack((INWARD, _LEVER / BLOCK_RADIUS**2)) / (1 + (_LEVER / BLOCK_RADIUS) ** 2)[:, None]


def predict_push(pose: Floats, twist: Floats, length: Floats) -> Floats:
    """Predict where a push leaves the block.

    Parameters
    ----------
    pose : ndarray of float64, shape (3,)
        The block's x [m], y [m] and yaw [rad] before the push.
    twist : ndarray of float64, shape (..., 3)
        A row of ``TWIST``, or several.
    length : ndarray of float64, shape (...)
        How far the pusher travels along the normal [m].

    Returns
    -------
    ndarray of float64, shape (..., 3)
        The pose after the push; its yaw is not wrapped.
    """
    turn = twist[..., 2] * length
    # Along the arc the block faces between its first and its last yaw: on average half way, and the chord is shorter.
    chord = twist[..., :2] * (length * np.sinc(turn / (2 * np.pi)))[..., None]
    return np.concatenate((pose[:2] + _rotate(chord, pose[2] + turn / 2), (pose[2] + turn)[..., None]), axis=-1)


def _pose_error(pose: Floats, target: Floats) -> Floats:
    """Distance [m] between poses (..., 3) and a target (3,), with yaw weighed in by ``YAW_WEIGHT``: shape (...)."""
    off = pose - target
    distance: Floats = np.sqrt(off[..., 0] ** 2 + off[..., 1] ** 2 + (YAW_WEIGHT * wrap_angle(off[..., 2])) ** 2)
    return distance


def _ways_around(start: Floats, ends: Floats, pose: Floats) -> tuple[Floats, Floats]:
    """Find the shortest ways for the pusher around a block at `pose` (3,): straight, or from corner to corner.

    From `start` (2,) to each of `ends` (N, 2), both in the frame of the block. Returns the lengths [m] of the ways,
    (N,), infinite if there is none, and where each of them heads first, (N, 2): a corner, or the end itself.
    """
    hops = _distances(CORNERS[:, None], CORNERS, pose)
    for k in range(len(CORNERS)):  # Floyd and Warshall: hops becomes the shortest way between any two corners
        hops = np.minimum(hops, hops[:, k, None] + hops[k])
    rest = (hops[:, :, None] + _distances(CORNERS[:, None], ends, pose)).min(axis=1)
    via = _distances(start, CORNERS, pose)[:, None] + rest
    lengths = np.vstack((_distances(start, ends, pose), via))  # straight, then by way of each corner
    best = lengths.argmin(axis=0)
    return lengths.min(axis=0), np.where(best[:, None] == 0, ends, CORNERS[best - 1])


def _read_view(observation: ArrayLike) -> View:
    """Read an observation (10,), in the order of ``STATE_NAMES``."""
    state = dict(zip(STATE_NAMES, np.asarray(observation, dtype=np.float64), strict=True))
    yaw = decode_yaw(sin_yaw=state["sin_tee_yaw"], cos_yaw=state["cos_tee_yaw"])
    target_yaw = decode_yaw(sin_yaw=state["sin_target_yaw"], cos_yaw=state["cos_target_yaw"])
    pose = np.array((state["tee_x"], state["tee_y"], yaw))
    target = np.array((state["target_x"], state["target_y"], target_yaw))
    pusher = np.array((state["pusher_x"], state["pusher_y"]))
    return View(pose, target, _rotate(pusher - pose[:2], -pose[2]))


def _choose_contact(view: View) -> int:
    """Choose the push that brings the block closer fastest: error taken away [m] for each second spent, over `TOUCH`.

    The seconds are those on the way to the contact, of the push itself, and of the switch between the two.
    """
    outcome = predict_push(view.pose, TWIST[:, None], LENGTHS)
    gained = _pose_error(view.pose, view.target) - _pose_error(outcome, view.target)
    way, _ = _ways_around(view.pusher + _let_go(view.pusher), WAIT, view.pose)
    spent = way[:, None] / APPROACH_SPEED + LENGTHS / SHOVE_SPEED + SWITCH_TIME
    return int((gained / spent).max(axis=1).argmax())


def _length_left(view: View, contact: int) -> float:
    """How much longer [m] to push at a contact until the block is as close to the target as that push can bring it."""
    outcome = predict_push(view.pose, TWIST[contact], LENGTHS)
    return float(LENGTHS[_pose_error(outcome, view.target).argmin()])


def _let_go(pusher: Floats) -> Floats:
    """Displacement (2,) [m] that takes the pusher off the block; zero when it is far enough."""
    return max(PUSHER_RADIUS + WIDE_GAP - float(_clearance(pusher)), 0.0) * _away(pusher)


def _gap_and_slip(pusher: Floats, contact: int) -> tuple[float, float]:
    """Where the pusher is, seen from a contact: its distance [m] from the face, and along the face."""
    off, normal = pusher - TOUCH[contact], INWARD[contact]
    return float(-off @ normal), float(normal[0] * off[1] - normal[1] * off[0])


class ScriptedExpert:
    """Maps observations to actions. Knows the phase it is in, so call `reset` before each episode.

    Attributes
    ----------
    phase : {"approach", "shove", "correct", "hold"}
        What it is doing.
    """

    def __init__(self) -> None:
        self.reset()

    def reset(self) -> None:
        """Forget the last episode."""
        self.phase: Phase = "hold"  # until the first observation says that there is something to do
        self._contact = 0  # row of TOUCH
        self._velocity: Floats = np.zeros(2)  # commanded last [m/s]

    def __call__(self, observation: ArrayLike) -> NDArray[np.float32]:
        """Choose the next action.

        Parameters
        ----------
        observation : array_like of float, shape (10,)
            In the order of ``STATE_NAMES``.

        Returns
        -------
        ndarray of float32, shape (2,)
            Velocity of the pusher along x and y [m/s], well inside +-``ACTION_LIMIT``.

        Raises
        ------
        ValueError
            If `observation` does not have one value for each of ``STATE_NAMES``.
        """
        view = _read_view(observation)
        change = _rotate(self._decide(view), float(view.pose[2])) - self._velocity
        allowed = ACCELERATION / CONTROL_HZ
        self._velocity = self._velocity + change * min(1.0, allowed / max(float(np.linalg.norm(change)), allowed))
        return self._velocity.astype(np.float32)

    def _decide(self, view: View) -> Floats:
        """Move on to the phase that the view asks for; return its velocity (2,) [m/s] in the frame of the block."""
        pushing = self.phase in ("shove", "correct") and not self._is_over(view)
        if self._is_there(view, share=THERE if pushing else 1.0):
            self.phase = "hold"
            return SETTLE_RATE * _let_go(view.pusher)
        if not pushing and self.phase != "approach":
            self.phase, self._contact = "approach", _choose_contact(view)
        if self.phase == "approach":
            if not self._is_aligned(view):
                return self._approach(view)
            self.phase = "correct" if _pose_error(view.pose, view.target) < NEARLY_THERE else "shove"
        return self._push(view)

    def _is_there(self, view: View, share: float) -> bool:
        """Whether the block is on the target, within a share of both tolerances."""
        off = view.pose - view.target
        return in_tolerance(float(np.hypot(off[0], off[1])) / share, abs(float(wrap_angle(off[2]))) / share)

    def _is_aligned(self, view: View) -> bool:
        """Whether the pusher is in place to begin the push: between waiting and touching, on the contact's line."""
        gap, slip = _gap_and_slip(view.pusher, self._contact)
        return abs(slip) <= ALIGNED and -ALIGNED <= gap <= WIDE_GAP + ALIGNED

    def _is_over(self, view: View) -> bool:
        """Whether the push is over: there is nothing left to gain, or the contact is lost."""
        gap, slip = _gap_and_slip(view.pusher, self._contact)
        return _length_left(view, self._contact) < NOTHING_LEFT or abs(slip) > SLIPPED or gap > 2 * WIDE_GAP

    def _approach(self, view: View) -> Floats:
        """Velocity (2,) that lets go of the block, then goes around it, then settles where the push will start."""
        if _clearance(view.pusher) < PUSHER_RADIUS + NEAR_GAP:
            return APPROACH_SPEED * _away(view.pusher)
        wait = WAIT[self._contact]
        _, heads = _ways_around(view.pusher, wait[None], view.pose)
        way: Floats = heads[0] - view.pusher
        distance = max(float(np.linalg.norm(way)), 1e-9)
        settles = (heads[0] == wait).all()  # and only turns at a corner, without slowing down
        return way * min(APPROACH_SPEED / distance, SETTLE_RATE if settles else np.inf)

    def _push(self, view: View) -> Floats:
        """Velocity (2,) that pushes along the normal, ever more slowly, and keeps to the contact as the block turns."""
        gap, slip = _gap_and_slip(view.pusher, self._contact)
        left = _length_left(view, self._contact) + max(gap, 0.0)
        fastest = SHOVE_SPEED if self.phase == "shove" else CORRECT_SPEED
        speed = float(np.clip(SETTLE_RATE * left, SLOWEST_SPEED, fastest))
        normal = INWARD[self._contact]
        along_face = np.array((-normal[1], normal[0]))
        velocity: Floats = speed * normal - SETTLE_RATE * slip * along_face
        return velocity
