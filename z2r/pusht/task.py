"""The numbers that the simulator and the reading share. One copy, and no MuJoCo behind it.

Planar, SI units: positions in metres, angles in radians, velocities in metres per second.
"""

STATE_NAMES: tuple[str, ...] = (
    "pusher_x",
    "pusher_y",
    "tee_x",
    "tee_y",
    "sin_tee_yaw",
    "cos_tee_yaw",
    "target_x",
    "target_y",
    "sin_target_yaw",
    "cos_target_yaw",
)
ACTION_NAMES: tuple[str, ...] = ("pusher_vx", "pusher_vy")

CONTROL_HZ = 10  # frames a second: this is the dataset's fps
PHYSICS_HZ = 100
ACTION_LIMIT = 1.0  # m/s, for each of the two velocities

MAX_STEPS = 300  # control steps, after which an episode times out
SUCCESS_HOLD = 5  # control steps in a row in tolerance that latch success
POS_TOL = 0.03  # m
ANG_TOL = 0.2  # rad

TARGET_POSE: tuple[float, float, float] = (0.0, 0.0, 0.0)  # x [m], y [m], yaw [rad]
WALL = 0.40  # m: the pusher stays within +-WALL on both axes

# The T is two boxes, in the frame of the block. Its origin is the centre of the bar.
BAR_CENTER: tuple[float, float] = (0.0, 0.0)
BAR_HALF_SIZE: tuple[float, float, float] = (0.06, 0.015, 0.015)
STEM_CENTER: tuple[float, float] = (0.0, -0.06)
STEM_HALF_SIZE: tuple[float, float, float] = (0.015, 0.045, 0.015)
TEE = ((BAR_CENTER, BAR_HALF_SIZE), (STEM_CENTER, STEM_HALF_SIZE))
TEE_Z = 0.0152  # m: the block rides this high, just off the floor

PUSHER_RADIUS = 0.015  # m
PUSHER_LENGTH = 0.04  # m
PUSHER_Z = 0.02  # m

DEMO_NOISE = 0.08  # m/s: standard deviation of the noise on each action of a demonstration
TASK = "push the T onto the target"
