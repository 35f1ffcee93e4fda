"""The PushT scene in MuJoCo, and the environment that runs it: what recorded the demonstrations.

A disc shoves a T-shaped block over a table, seen from above. Nothing falls and nothing tips: both bodies only have
planar joints, and gravity is off. The table is therefore not a floor that the block touches but the friction in the
block's joints, mostly viscous and strong for the block's mass, so that the block stops as soon as nobody pushes it.
It resists turning about its origin, the centre of the bar, rather than about its centre of mass: a simplification that
makes the pose the three joint positions as they are.
"""

import math
from typing import NamedTuple

import mujoco
import numpy as np
from numpy.typing import ArrayLike, NDArray

from z2r.pusht.task import (
    ACTION_LIMIT,
    ACTION_NAMES,
    BAR_CENTER,
    BAR_HALF_SIZE,
    CONTROL_HZ,
    MAX_STEPS,
    PHYSICS_HZ,
    PUSHER_LENGTH,
    PUSHER_RADIUS,
    PUSHER_Z,
    STEM_CENTER,
    STEM_HALF_SIZE,
    SUCCESS_HOLD,
    TARGET_POSE,
    TEE_Z,
    WALL,
)
from z2r.pusht.world import in_tolerance
from z2r.reading.angles import wrap_angle

TEE_DENSITY = 1000.0  # kg/m^3: a plastic block of 0.19 kg
SLIDE_DAMPING = 8.0  # N s/m: the mass over this is 24 ms, the time in which coasting dies away
YAW_DAMPING = 0.02  # N m s: SLIDE_DAMPING times the square of 5 cm, the block's rough radius
SLIDE_FRICTION = 0.1  # N: brings the block to a full stop; small, since it acts along x and y separately
YAW_FRICTION = 0.005  # N m

PUSHER_MASS = 1.0  # kg
PUSHER_GAIN = 100.0  # N s/m: far above the block's damping, so that the pusher moves as fast as it was told to
PUSHER_FORCE = 20.0  # N: the most that the pusher presses with, so that it is not squeezed into a block at a wall

CONTACT_FRICTION = 0.3  # between pusher, block and walls
CONTACT_SOLREF = (0.02, 1.0)  # s and 1: as stiff as a physics step of 10 ms allows, critically damped
CONTACT_SOLIMP = (0.98, 0.99, 0.001)  # nearly hard, also at first touch

START_REACH = 0.22  # m: the block starts within +-START_REACH on both axes, so that the pusher fits behind it
START_GAP = 0.02  # m: at least this much free space between pusher, block and walls at the start

# The corner of the T that is farthest from its origin [m].
_TEE_REACH = math.hypot(STEM_HALF_SIZE[0], abs(STEM_CENTER[1]) + STEM_HALF_SIZE[1])
# Addresses in qpos, in the order in which the scene declares the joints.
_PUSHER = slice(0, 2)
_TEE = slice(2, 5)


class StepResult(NamedTuple):
    """What one control step gives back.

    Attributes
    ----------
    observation : ndarray of float32, shape (10,)
        The observation after the step, in the order of ``STATE_NAMES``.
    success : bool
        Whether the simulator has latched success.
    timed_out : bool
        Whether the episode ended without success, at its last step.
    pos_err : float
        Distance [m] of the block's origin from the target's.
    ang_err : float
        Absolute yaw error [rad], in [0, pi].
    """

    observation: NDArray[np.float32]
    success: bool
    timed_out: bool
    pos_err: float
    ang_err: float

    @property
    def done(self) -> bool:
        """Whether the episode is over, either way."""
        return self.success or self.timed_out


def _numbers(*values: float) -> str:
    """Write numbers as an MJCF attribute, without rounding them."""
    return " ".join(repr(float(value)) for value in values)


def scene_xml() -> str:
    """Build the scene from the task's constants.

    Returns
    -------
    str
        MJCF. Joints in order: pusher x, pusher y, tee x, tee y, tee yaw. The target is drawn and cannot be touched.
    """

    def tee_boxes(attributes: str) -> str:
        return "".join(
            f'<geom type="box" size="{_numbers(*half_size)}" pos="{_numbers(*center, 0)}" {attributes}/>'
            for center, half_size in ((BAR_CENTER, BAR_HALF_SIZE), (STEM_CENTER, STEM_HALF_SIZE))
        )

    # A plane is solid behind its face, so nothing can tunnel through a wall. Its z axis points into the workspace.
    walls = "".join(
        f'<geom type="plane" size="{_numbers(WALL, 0.05, 0.01)}" pos="{_numbers(-WALL * x, -WALL * y, 0)}"'
        f' zaxis="{_numbers(x, y, 0)}" rgba="0.6 0.6 0.6 0.3"/>'
        for x, y in ((1, 0), (-1, 0), (0, 1), (0, -1))
    )
    target_x, target_y, target_yaw = TARGET_POSE
    return f"""
<mujoco model="pusht">
  <compiler angle="radian"/>
  <option timestep="{_numbers(1 / PHYSICS_HZ)}" gravity="0 0 0" integrator="implicitfast">
    <!-- With several contacts a pair, MuJoCo 4.0 misplaces those of a cylinder at a box's edge by up to 4 mm. -->
    <flag multiccd="disable"/>
  </option>
  <default>
    <geom friction="{_numbers(CONTACT_FRICTION, 0, 0)}" solref="{_numbers(*CONTACT_SOLREF)}"
          solimp="{_numbers(*CONTACT_SOLIMP)}"/>
  </default>
  <worldbody>
    <light pos="0 0 2"/>
    <geom type="plane" size="{_numbers(WALL, WALL, 0.01)}" rgba="0.9 0.9 0.9 1" contype="0" conaffinity="0"/>
    {walls}
    <body name="target" pos="{_numbers(target_x, target_y, 0)}" euler="{_numbers(0, 0, target_yaw)}">
      {tee_boxes('contype="0" conaffinity="0" rgba="0.35 0.80 0.39 0.4"')}
    </body>
    <body name="pusher" pos="{_numbers(0, 0, PUSHER_Z)}">
      <joint name="pusher_x" type="slide" axis="1 0 0"/>
      <joint name="pusher_y" type="slide" axis="0 1 0"/>
      <geom type="cylinder" size="{_numbers(PUSHER_RADIUS, PUSHER_LENGTH / 2)}" mass="{_numbers(PUSHER_MASS)}"
            rgba="0.90 0.40 0.35 1"/>
    </body>
    <body name="tee" pos="{_numbers(0, 0, TEE_Z)}">
      <joint name="tee_x" type="slide" axis="1 0 0" damping="{SLIDE_DAMPING}" frictionloss="{SLIDE_FRICTION}"/>
      <joint name="tee_y" type="slide" axis="0 1 0" damping="{SLIDE_DAMPING}" frictionloss="{SLIDE_FRICTION}"/>
      <joint name="tee_yaw" type="hinge" axis="0 0 1" damping="{YAW_DAMPING}" frictionloss="{YAW_FRICTION}"/>
      {tee_boxes(f'density="{TEE_DENSITY}" rgba="0.45 0.50 0.95 1"')}
    </body>
  </worldbody>
  <actuator>
    <velocity joint="pusher_x" kv="{PUSHER_GAIN}" forcerange="{_numbers(-PUSHER_FORCE, PUSHER_FORCE)}"/>
    <velocity joint="pusher_y" kv="{PUSHER_GAIN}" forcerange="{_numbers(-PUSHER_FORCE, PUSHER_FORCE)}"/>
  </actuator>
</mujoco>
"""


class PushTEnv:
    """One PushT episode at a time: reset with a seed, then step until it is over.

    It is over when the block has been in tolerance for ``SUCCESS_HOLD`` control steps in a row, or after `max_steps`.
    The same seed and the same actions give the same bytes on one machine and one MuJoCo version, not across them.

    Parameters
    ----------
    max_steps : int
        Control steps after which an episode times out, at least 1.
    fps : int
        Control steps in a second, 1 to ``PHYSICS_HZ``: as near as whole steps of physics allow. Other than at
        ``CONTROL_HZ``, the block must be in tolerance for as long as ``SUCCESS_HOLD`` steps last there.

    Raises
    ------
    ValueError
        If `max_steps` is less than 1, or `fps` is out of range.
    """

    def __init__(self, max_steps: int = MAX_STEPS, fps: int = CONTROL_HZ) -> None:
        if max_steps < 1:
            raise ValueError(f"max_steps is {max_steps}; expected at least 1")
        if not 1 <= fps <= PHYSICS_HZ:
            raise ValueError(f"fps is {fps}; expected 1 to {PHYSICS_HZ}")
        self.max_steps = max_steps
        self._substeps = PHYSICS_HZ // fps
        self._hold = math.ceil(SUCCESS_HOLD * fps / CONTROL_HZ)
        self._model = mujoco.MjModel.from_xml_string(scene_xml())
        self._data = mujoco.MjData(self._model)
        self._steps = 0
        self._held = 0  # control steps in a row in tolerance
        self._success = False
        self._running = False

    @property
    def steps(self) -> int:
        """Control steps since the last reset."""
        return self._steps

    @property
    def success(self) -> bool:
        """Whether success has been latched in this episode: the simulator's own verdict."""
        return self._success

    @property
    def running(self) -> bool:
        """Whether an episode has begun and is not over."""
        return self._running

    @property
    def pos_err(self) -> float:
        """Distance [m] of the block's origin from the target's, from the simulator's float64 state."""
        x, y, _ = self._data.qpos[_TEE]
        return math.hypot(x - TARGET_POSE[0], y - TARGET_POSE[1])

    @property
    def ang_err(self) -> float:
        """Absolute yaw error [rad], in [0, pi], from the simulator's float64 state."""
        return abs(float(wrap_angle(self._data.qpos[_TEE][2] - TARGET_POSE[2])))

    @property
    def in_tolerance(self) -> bool:
        """Whether the block is within both tolerances right now."""
        return in_tolerance(self.pos_err, self.ang_err)

    def reset(self, seed: int) -> NDArray[np.float32]:
        """Begin an episode.

        Parameters
        ----------
        seed : int
            Non-negative. Draws the block's pose and the pusher's position: clear of each other, and not solved.

        Returns
        -------
        ndarray of float32, shape (10,)
            The first observation, in the order of ``STATE_NAMES``.
        """
        rng = np.random.default_rng(seed)
        mujoco.mj_resetData(self._model, self._data)
        while True:
            self._data.qpos[_TEE] = rng.uniform((-START_REACH, -START_REACH, -np.pi), (START_REACH, START_REACH, np.pi))
            if not self.in_tolerance:
                break
        pusher_reach = WALL - PUSHER_RADIUS - START_GAP
        while True:
            self._data.qpos[_PUSHER] = rng.uniform(-pusher_reach, pusher_reach, size=2)
            apart = math.dist(self._data.qpos[_PUSHER], self._data.qpos[_TEE][:2])
            if apart > _TEE_REACH + PUSHER_RADIUS + START_GAP:
                break
        mujoco.mj_forward(self._model, self._data)
        self._steps = 0
        self._held = 0
        self._success = False
        self._running = True
        return self._observation()

    def step(self, action: ArrayLike) -> StepResult:
        """Hold one action for a control step.

        Parameters
        ----------
        action : array_like of float, shape (2,)
            Target velocity of the pusher along x and y [m/s]; clipped to +-``ACTION_LIMIT``.

        Returns
        -------
        StepResult
            The observation after the step, and the simulator's verdict.

        Raises
        ------
        RuntimeError
            If no episode is running.
        ValueError
            If `action` has another shape, or a value that is not finite.
        """
        if not self._running:
            raise RuntimeError(f"no episode is running (steps taken: {self._steps}); call reset(seed) first")
        velocity = np.asarray(action, dtype=np.float64)
        if velocity.shape != (len(ACTION_NAMES),):
            raise ValueError(f"action has shape {velocity.shape}; expected ({len(ACTION_NAMES)},)")
        if not np.isfinite(velocity).all():
            raise ValueError(f"action is {velocity}; expected finite velocities [m/s]")
        self._data.ctrl[:] = np.clip(velocity, -ACTION_LIMIT, ACTION_LIMIT)
        mujoco.mj_step(self._model, self._data, nstep=self._substeps)
        self._steps += 1
        self._held = self._held + 1 if self.in_tolerance else 0
        self._success = self._held >= self._hold
        timed_out = not self._success and self._steps >= self.max_steps
        self._running = not (self._success or timed_out)
        return StepResult(self._observation(), self._success, timed_out, self.pos_err, self.ang_err)

    def _observation(self) -> NDArray[np.float32]:
        """Return the current observation: float32, shape (10,), in the order of ``STATE_NAMES``."""
        pusher_x, pusher_y = self._data.qpos[_PUSHER]
        x, y, yaw = self._data.qpos[_TEE]
        target_x, target_y, target_yaw = TARGET_POSE
        tee = (x, y, math.sin(yaw), math.cos(yaw))
        target = (target_x, target_y, math.sin(target_yaw), math.cos(target_yaw))
        return np.array((pusher_x, pusher_y, *tee, *target), dtype=np.float32)
