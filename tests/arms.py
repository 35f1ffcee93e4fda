"""Arms that nobody built, and what was recorded of them: the healthy datasets that `arm_damages.py` spoils.

Each is made as a real one is. An operator leads the arm through the poses of a task, with a hand that is never quite
still, pauses to think and closes the gripper further than the thing in it allows; the arm follows late, by a dead time
and a first-order lag, and sags under its weight; encoders tell both in ticks. Nothing here knows how faults are found.

A `Recording` is what a recorder holds before it writes. A fault that happened while recording is planted in it, so that
the statistics and the metadata, which are made when it is written, agree with the fault.
"""

import copy
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
from layouts import BOOKKEEPING, Frames, Layout, write_dataset

STATE, ACTION, TASK = "observation.state", "action", "task_index"
JOINTS = ("shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll", "gripper")
POS = tuple(f"{joint}.pos" for joint in JOINTS)
VIPER = ("waist", "shoulder", "elbow", "forearm_roll", "wrist_angle", "wrist_rotate", "gripper")
SIDES = tuple(f"{side}_{joint}" for side in ("left", "right") for joint in VIPER)
WHEELS = ("x.vel", "y.vel", "theta.vel")
HAND = ("x", "y", "z", "qx", "qy", "qz", "qw", "gripper")

TICK = 360 / 4096  # deg, of the encoder of a Feetech STS3215 and of a Dynamixel XL330
UPPER, FORE = 0.116, 0.135  # m, about the links of an SO-101
PLAY = (0.6, 3.0, 4.5, 2.5, 0.6, 4.0)  # deg and percent: what an SO-101 leaves of an error, from one side to the other
REST = (0.0, -98.0, 97.0, 72.0, 0.0, 2.0)  # deg and percent: folded, where an SO-101 is switched on and off


@dataclass(frozen=True)
class Recording:
    """What a recorder holds: the frames of each episode, and what it knows of the robot.

    Attributes
    ----------
    episodes : list of dict
        Of each feature, (n, size), or (n,) where it has no `names`; and `task_index`, (n,).
    names : dict
        The names of the dimensions of each feature; None where it has none.
    tasks : list of str
        Their texts.
    finish : list of callable
        What happens to the folder after it is written.
    """

    robot: str
    fps: float
    names: dict[str, Any]
    episodes: list[Frames]
    tasks: list[str]
    files: int = 3
    dtype: str = "float32"
    info: dict[str, Any] = field(default_factory=dict)
    finish: list[Callable[[Path], object]] = field(default_factory=list)

    def copy(self) -> "Recording":
        return copy.deepcopy(self)

    def column(self, name: str) -> list[tuple[str, int]]:
        """Where a name stands: in which features, and in which place."""
        return [(feature, names.index(name)) for feature, names in self.names.items() if names and name in names]


def write(recording: Recording, root: Path) -> None:
    """Write it as LeRobot does, with statistics that are true."""
    frames = {name: np.concatenate([episode[name] for episode in recording.episodes]) for name in recording.episodes[0]}
    frames = {
        name: values.astype(recording.dtype) if values.dtype == float else values for name, values in frames.items()
    }
    lengths = [len(episode[TASK]) for episode in recording.episodes]
    n_files = min(recording.files, len(lengths))
    files = np.diff(np.linspace(0, len(lengths), n_files + 1).astype(int)).tolist()
    features = {name: _feature(values, recording.names.get(name)) for name, values in frames.items() if name != TASK}
    write_dataset(
        root,
        frames,
        lengths,
        Layout(files, [len(lengths)], episode_stats=True),
        recording.tasks,
        **{"features": features | BOOKKEEPING, "fps": recording.fps, "robot_type": recording.robot} | recording.info,
    )
    for change in recording.finish:
        change(root)


def _feature(values: np.ndarray, names: Any) -> dict[str, Any]:
    dtype = values.dtype.name if values.dtype.kind in "biuf" else "string"
    return {"dtype": dtype, "shape": list(values.shape[1:]) or [1], "names": names if names is None else list(names)}


# --- what an operator does


@dataclass(frozen=True)
class Operator:
    """How somebody leads an arm.

    Attributes
    ----------
    speed : float
        How fast a joint is led [deg/s].
    pause : float
        The longest pause between two moves [s].
    rest : tuple of float
        The shortest and the longest time of stillness at both ends of an episode [s].
    wobble : float
        How far the hand strays [deg].
    retry : float
        The chance that a grip misses, and is tried again.
    """

    speed: float = 110
    pause: float = 0.3
    rest: tuple[float, float] = (0.3, 0.9)
    wobble: float = 0.5
    retry: float = 0.0


@dataclass(frozen=True)
class Plant:
    """How an arm follows.

    Attributes
    ----------
    lag : float
        Frames from a command to the motion, all told.
    jitter : float
        By how much that differs between episodes.
    noise : float
        Of the sensor, in ticks.
    play : float
        How much of `PLAY` the joints have: gears, and motors that let a small error be.
    sag : float
        How far the shoulder and the elbow hang below their command where the arm is stretched out [deg].
    """

    lag: float = 4.5
    jitter: float = 0.4
    noise: float = 0.15
    play: float = 1
    sag: float = 1.2


def reach(pan: float, distance: float, height: float, roll: float) -> list[float]:
    """The five joints [deg] that point the gripper down at a place: pan [deg], distance and height [m]."""
    far = np.clip(np.hypot(distance, height), 0.06, 0.98 * (UPPER + FORE))
    inner = np.degrees(np.arccos((UPPER**2 + FORE**2 - far**2) / (2 * UPPER * FORE)))
    above = np.degrees(np.arccos((UPPER**2 + far**2 - FORE**2) / (2 * UPPER * far)))
    lift = np.degrees(np.arctan2(distance, height)) - above
    return [pan, lift, 90 - inner, 90 - lift - (90 - inner), roll]


@dataclass(frozen=True)
class Task:
    """Where a thing is taken from and put to: ranges of pan [deg] and distance [m], heights [m], a turn [deg]."""

    text: str
    take: tuple[float, float] = (-35, 35)
    put: tuple[float, float, float] = (-55, 0.19, 0.06)
    roll: tuple[float, float] = (-20, 20)
    width: tuple[float, float] = (10, 24)


CUBE = Task("Put the cube into the box")
CUP = Task("Stand the cup on the saucer", (5, 60), (20, 0.21, 0.02), (60, 85), (26, 38))


def lead(rng: np.random.Generator, fps: float, task: Task, operator: Operator) -> tuple[np.ndarray, np.ndarray]:
    """One demonstration: the command (n, 6) in deg and percent, and how wide the thing in the gripper is, (n,)."""
    pan, far, roll = rng.uniform(*task.take), rng.uniform(0.15, 0.22), rng.uniform(*task.roll)
    goal, away, high = task.put[0] + rng.normal(0, 3), task.put[1] + rng.normal(0, 0.006), task.put[2]
    wide, width = rng.uniform(60, 85), rng.uniform(*task.width)
    shut = max(1, width - rng.uniform(3, 18))
    start = np.array(REST) + rng.normal(0, [1.5, 0.4, 0.6, 1.2, 1.5, 0.3])
    over, down = reach(pan, far, 0.08, roll), reach(pan, far, -0.02, roll)
    up = reach(pan, far, 0.09, roll)
    there, low = reach(goal, away, high + 0.08, roll * 0.4), reach(goal, away, high, roll * 0.4)
    miss = [(*down, wide), (*down, shut), (*over, shut), (*over, wide)] if rng.random() < operator.retry else []
    poses = [start, (*over, wide), *miss, (*down, wide), (*down, shut), (*up, shut), (*there, shut), (*low, shut)]
    poses += [(*low, wide), (*there, wide), start + rng.normal(0, 0.4, 6)]
    poses = np.array(poses)
    grip = len(miss) + 3  # the pose of `poses` at which the gripper is shut
    rests = (fps * rng.uniform(*operator.rest, 2)).astype(int)
    path, marks = [np.repeat(poses[:1], rests[0], axis=0)], []
    for here, next_ in pairwise(poses):
        marks.append(sum(map(len, path)))
        seconds = max(0.35, 1.5 * np.abs(next_ - here).max() / operator.speed / rng.uniform(0.8, 1.25))
        tau = np.linspace(0, 1, max(3, int(fps * seconds)))[:, None]
        path.append(here + (next_ - here) * (10 * tau**3 - 15 * tau**4 + 6 * tau**5))
        path.append(np.repeat(next_[None], int(fps * rng.uniform(0, operator.pause)), axis=0))
    path.append(np.repeat(poses[-1:], rests[1], axis=0))
    command = np.concatenate(path)
    busy = np.zeros(len(command))
    busy[marks[0] : len(command) - len(path[-1])] = 1
    command = command + busy[:, None] * operator.wobble * smooth(rng, len(command), 6, fps)
    held = np.zeros(len(command))
    held[marks[grip - 1] : marks[grip + 4]] = width  # once open, nothing holds it
    return command, held


def smooth(rng: np.random.Generator, n: int, size: int, fps: float, seconds: float = 0.4) -> np.ndarray:
    """Noise of about 1 that changes slowly, (n, size), and is 0 where it begins and ends."""
    window = np.hanning(max(3, int(seconds * fps)) + 2)[1:-1]
    noise = rng.normal(size=(n + 2 * len(window), size))
    slow = np.stack([np.convolve(column, window / np.linalg.norm(window), "same") for column in noise.T], axis=1)
    fade = np.minimum(1, np.minimum(np.arange(n), np.arange(n)[::-1]) / (0.3 * fps))
    return slow[len(window) : len(window) + n] * fade[:, None]


def follow(command: np.ndarray, lag: float, share: float = 0.5) -> np.ndarray:
    """Where the joints are: half of the lag (in frames) is dead time, the other half a first-order lag."""
    if lag <= 0:
        return command.copy()
    now = np.arange(len(command))
    late = np.stack([np.interp(now - lag * share, now, column) for column in command.T], axis=1)
    gain, here, out = 1 - np.exp(-1 / max(lag * (1 - share), 1e-6)), late[0].copy(), np.empty_like(late)
    for number, goal in enumerate(late):
        here += gain * (goal - here)
        out[number] = here
    return out


def play(values: np.ndarray, width: float | np.ndarray) -> np.ndarray:
    """What is left of a motion that first has to cross a play of this width, (n, size)."""
    here, out = values[0].copy(), values.copy()
    for number, value in enumerate(values):
        here = np.clip(here, value - width / 2, value + width / 2)
        out[number] = here
    return out


def ticks(values: np.ndarray, tick: float | np.ndarray, rng: np.random.Generator, noise: float = 0) -> np.ndarray:
    """What an encoder says: whole ticks, with noise of so many of them."""
    return np.round(values / tick + rng.normal(0, noise, values.shape)) * tick


def demonstrate(
    rng: np.random.Generator, fps: float, task: Task, operator: Operator, plant: Plant
) -> tuple[np.ndarray, np.ndarray]:
    """State and action of one arm in one episode, (n, 6) each, in deg and percent."""
    command, held = lead(rng, fps, task, operator)
    return respond(rng, command, held, plant)


def respond(
    rng: np.random.Generator, command: np.ndarray, held: np.ndarray, plant: Plant
) -> tuple[np.ndarray, np.ndarray]:
    """State and action, (n, 6) each, of an arm that was sent a command."""
    lag = max(0, plant.lag + rng.uniform(-plant.jitter, plant.jitter))
    stretched = np.cos(np.radians(command[:, 1] - 80))  # 1 where the upper arm lies level
    pull = np.array([0, 1, 0.6, 0.2, 0, 0]) * plant.sag * np.clip(stretched, 0, 1)[:, None]
    state = play(follow(command + pull, lag), plant.play * np.array(PLAY))
    state[:, 5] = np.maximum(state[:, 5], held + 0.02 * (state[:, 5] - held))
    grid = np.array([TICK] * 5 + [0.0674])
    return ticks(state, grid, rng, plant.noise), ticks(command, np.array([TICK] * 5 + [0.0804]), rng)


# --- the robots


def so101(
    seed: int = 0,
    n: int = 12,
    fps: float = 30,
    tasks: Sequence[Task] = (CUBE, CUP),
    operator: Operator = Operator(),
    plant: Plant = Plant(),
) -> Recording:
    """Six joints, in degrees and percent; tasks take turns, and each episode is led at a pace of its own."""
    rng = np.random.default_rng([seed, 101])
    episodes = []
    for number in range(n):
        which = number % len(tasks)
        paced = replace(operator, speed=operator.speed * rng.uniform(0.8, 1.25))
        episodes.append(episode(*demonstrate(rng, fps, tasks[which], paced, plant), which))
    return Recording("so101_follower", fps, {STATE: POS, ACTION: POS}, episodes, [task.text for task in tasks])


def episode(state: np.ndarray, action: np.ndarray, task: int = 0) -> Frames:
    return {STATE: state, ACTION: action, TASK: np.full(len(state), task)}


def so100_normalised(seed: int = 0) -> Recording:
    """As LeRobot recorded before 0.6: joints in -100 to 100 of their range, each of another one."""
    recording = so101(seed + 1000)
    for own in recording.episodes:
        own[STATE], own[ACTION] = normalised(own[STATE]), normalised(own[ACTION])
    return replace(recording, robot="so100_follower")


LOW = np.array([-114, -104, -96, -101, -168, 0.0])  # deg: what a calibration found
HIGH = np.array([112, 102, 98, 104, 162, 100.0])


def normalised(values: np.ndarray) -> np.ndarray:
    """Degrees of the five joints as -100 to 100 of their range; the gripper stays."""
    scaled = (values - LOW) / (HIGH - LOW) * 200 - 100
    return np.where(np.arange(6) < 5, scaled, values)


def koch(seed: int = 0) -> Recording:
    """Dynamixel motors, faster, with the names of the first version of LeRobot, and one task."""
    recording = so101(
        seed + 2000, tasks=(CUBE,), operator=Operator(speed=140), plant=Plant(lag=2, noise=0.5, play=0.3, sag=0.4)
    )
    names = tuple(f"main_{joint}" for joint in JOINTS)
    return replace(recording, robot="koch", names={STATE: names, ACTION: names}, files=2)


def aloha(seed: int = 0, n: int = 10) -> Recording:
    """Two ViperX arms in radians, grippers 0 to 1, 50 fps: the right arm acts, the left one steadies, begun later."""
    rng = np.random.default_rng([seed, 14])
    plant = Plant(lag=3.5, noise=0.5, play=0.2, sag=0.6)
    episodes = []
    for _ in range(n):
        operator = Operator(speed=rng.uniform(170, 220), pause=0.15)
        right, left = (lead(rng, 50, task, operator) for task in (CUBE, CUP))
        wait = int(50 * rng.uniform(0.2, 0.8))
        longest = max(len(right[0]), len(left[0]) + wait)
        sides = [viper(rng, *_padded(*side, before, longest), plant) for side, before in ((left, wait), (right, 0))]
        episodes.append(episode(*(np.concatenate(both, axis=1) for both in zip(*sides, strict=True))))
    return Recording("aloha", 50, {STATE: SIDES, ACTION: SIDES}, episodes, ["Hand the cube over"])


def _padded(command: np.ndarray, held: np.ndarray, before: int, n: int) -> tuple[np.ndarray, np.ndarray]:
    pad = (before, n - before - len(held))
    return np.pad(command, (pad, (0, 0)), "edge"), np.pad(held, pad)


def viper(
    rng: np.random.Generator, command: np.ndarray, held: np.ndarray, plant: Plant
) -> tuple[np.ndarray, np.ndarray]:
    """State and action of one arm with a joint more, (n, 7), in rad and 0 to 1."""
    both = respond(rng, command, held, plant)
    turn = 14 * np.sin(np.radians(command[:, 0] * 2)) + 5 * smooth(rng, len(command), 1, 50)[:, 0]
    turns = follow(turn[:, None], plant.lag), turn[:, None]
    whole = [
        np.concatenate([arm[:, :3], ticks(more, TICK, rng, 0.3), arm[:, 3:]], axis=1)
        for arm, more in zip(both, turns, strict=True)
    ]
    return tuple(np.concatenate([np.radians(arm[:, :6]), arm[:, 6:] / 100], axis=1) for arm in whole)  # type: ignore[return-value]


def lekiwi(seed: int = 0) -> Recording:
    """An SO-101 on three wheels: the joints as `arm_…`, and the speed of the base [m/s, deg/s], led by keys."""
    rng = np.random.default_rng([seed, 3])
    recording = so101(seed + 3000, n=10)
    for own in recording.episodes:
        n = len(own[TASK])
        keys = np.stack([_presses(rng, n, 30) for _ in WHEELS], axis=1) * [0.1, 0.1, 30]
        speed = follow(keys, 5) + rng.normal(0, [0.003, 0.003, 0.7], (n, 3))
        own[STATE], own[ACTION] = np.concatenate([own[STATE], speed], 1), np.concatenate([own[ACTION], keys], 1)
    names = (*(f"arm_{name}" for name in POS), *WHEELS)
    return replace(recording, robot="lekiwi", names={STATE: names, ACTION: names})


def _presses(rng: np.random.Generator, n: int, fps: float) -> np.ndarray:
    """A key pressed now and then: -1, 0 or 1."""
    changes = rng.random(n) < 1.6 / fps
    return rng.integers(-1, 2, n)[np.maximum.accumulate(np.where(changes, np.arange(n), 0))] * (changes.cumsum() > 0)


def one_joint(seed: int = 0, fps: float = 100) -> Recording:
    """One motor in radians that is turned to marks on a dial."""
    rng = np.random.default_rng([seed, 1])
    episodes = []
    for _ in range(12):
        marks = np.concatenate([[0], rng.uniform(-1.4, 1.4, rng.integers(3, 6))])
        parts = [np.zeros(int(0.2 * fps))]
        for here, next_ in pairwise(marks):
            tau = np.linspace(0, 1, int(fps * rng.uniform(0.4, 0.8)))
            parts += [
                here + (next_ - here) * (3 * tau**2 - 2 * tau**3),
                np.full(int(fps * rng.uniform(0.05, 0.3)), next_),
            ]
        command = np.concatenate(parts)[:, None]
        tick = np.radians(TICK)
        state = ticks(follow(command, 6 + rng.uniform(-0.5, 0.5)), tick, rng, 0.3)
        episodes.append(episode(state, ticks(command, tick, rng)))
    names = ("motor.pos",)
    return Recording("dial", fps, {STATE: names, ACTION: names}, episodes, ["Turn the dial to the mark"])


def hand(seed: int = 0) -> Recording:
    """A gripper in space: place [m], turn as a unit quaternion (x, y, z, w), opening 0 to 1; actions are targets."""
    rng = np.random.default_rng([seed, 7])
    episodes = []
    for _ in range(12):
        command, held = lead(rng, 20, CUBE, Operator(speed=rng.uniform(75, 110)))
        angles, _ = respond(rng, command, held, Plant(lag=0, noise=0, play=0, sag=0))
        state = follow(angles, 3 + rng.uniform(-0.3, 0.3))
        episodes.append(episode(in_space(state, rng, 4e-4), in_space(angles, rng, 0)))
    return Recording("hand", 20, {STATE: HAND, ACTION: HAND}, episodes, [CUBE.text])


def in_space(joints: np.ndarray, rng: np.random.Generator, noise: float) -> np.ndarray:
    """Where the gripper of an arm with these joints [deg, percent] is: x y z [m], quaternion, opening, (n, 8)."""
    pan, lift, elbow, flex, roll = np.radians(joints[:, :5]).T
    pitch = lift + np.pi / 2 + elbow
    far = UPPER * np.sin(lift) + FORE * np.sin(pitch)
    place = np.stack([far * np.cos(pan), far * np.sin(pan), UPPER * np.cos(lift) + FORE * np.cos(pitch)], axis=1)
    turn = np.stack([np.sin(roll / 2), 0 * roll, 0 * roll, np.cos(roll / 2)], axis=1)  # about x, then y, then z
    turn = times(about(1, pitch + flex - np.pi), turn)
    turn = times(about(2, pan), turn)
    return np.concatenate([place + rng.normal(0, noise, place.shape), turn, joints[:, 5:] / 100], axis=1)


def about(axis: int, angle: np.ndarray) -> np.ndarray:
    """The quaternion (x, y, z, w) of a turn [rad] about one axis."""
    out = np.zeros((len(angle), 4))
    out[:, axis], out[:, 3] = np.sin(angle / 2), np.cos(angle / 2)
    return out


def times(a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """The product of quaternions (x, y, z, w)."""
    vector = a[:, 3:] * b[:, :3] + b[:, 3:] * a[:, :3] + np.cross(a[:, :3], b[:, :3])
    return np.concatenate([vector, a[:, 3:] * b[:, 3:] - (a[:, :3] * b[:, :3]).sum(1, keepdims=True)], axis=1)


def scored(seed: int = 0) -> Recording:
    """An SO-101 of a simulator, which stores whether it succeeded: two of the episodes never do."""
    recording = so101(seed + 4000, tasks=(CUBE,))
    for number, own in enumerate(recording.episodes):
        n = len(own[TASK])
        done = np.arange(n) == n - 1
        success = (np.arange(n) >= n - 5) & (number not in (3, 8))
        own |= {"next.reward": success.astype(np.float32), "next.success": success, "next.done": done}
    return replace(recording, robot="so101_sim")


ROBOTS: dict[str, Callable[[int], Recording]] = {
    "so101": so101,
    "so100": so100_normalised,
    "koch": koch,
    "aloha": aloha,
    "lekiwi": lekiwi,
    "dial": one_joint,
    "hand": hand,
    "scored": scored,
}


@cache
def _made(robot: str, seed: int) -> Recording:
    return ROBOTS[robot](seed)


def make(robot: str, seed: int = 0) -> Recording:
    """One of the robots, to be changed at will."""
    return _made(robot, seed).copy()
