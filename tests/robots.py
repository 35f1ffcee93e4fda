"""Two robots that are not PushT: a hand that moves to a place in a plane, and an arm of six joints with a gripper.

What each episode comes to is drawn at random here, and kept, so that a test knows it without reading the dataset.
"""

from pathlib import Path

import numpy as np
from layouts import BOOKKEEPING, Layout, write_dataset

import z2r

HAND_COLUMNS = ("palm/x", "palm/y", "palm.heading", "spot.x", "spot.y", "spot.sin", "spot.cos")
HAND_ACTION = ("go.x", "go.y")
HAND_READING = """
name = "reach"

[poses.hand]
x = "palm/x"
y = "palm/y"
yaw = { deg = "palm.heading" }

[poses.spot]
x = "spot.x"
y = "spot.y"
yaw = { sin = "spot.sin", cos = "spot.cos" }

[[goal]]
name = "miss"
distance = ["hand", "spot"]
within = 0.05

[[goal]]
name = "slant"
turn = ["hand", "spot"]
within = 0.3

[action]
drives = "position"
columns = ["go.x", "go.y"]
of = ["palm/x", "palm/y"]
"""
HAND_REACHED = (True, False, False, True, False, True, True)  # of the others, two are off and one is turned away

JOINTS = ("shoulder_pan.pos", "shoulder_lift.pos", "elbow_flex.pos", "wrist_flex.pos", "wrist_roll.pos", "gripper.pos")
ARM_READING = f"""
name = "closed"

[[goal]]
name = "grip"
value = "gripper.pos"
at_most = 20

[columns]
"gripper.pos" = {{ unit = "percent", low = 0, high = 100 }}

[action]
drives = "position"
columns = {list(JOINTS)}
of = {list(JOINTS)}
"""
ARM_REACHED = (False, True, True, False, True)


def write_hand(folder: Path) -> tuple[z2r.Dataset, z2r.Reading]:
    """Write a dataset of the hand, in two data files, and its reading."""
    rng = np.random.default_rng(3)
    episodes = [_reach(rng, reached, number) for number, reached in enumerate(HAND_REACHED)]
    return _write(folder, episodes, HAND_COLUMNS, HAND_ACTION, [3, 4], HAND_READING)


def write_arm(folder: Path) -> tuple[z2r.Dataset, z2r.Reading]:
    """Write a dataset of the arm, in two data files, and its reading."""
    rng = np.random.default_rng(4)
    episodes = [_grip(rng, reached) for reached in ARM_REACHED]
    return _write(folder, episodes, JOINTS, JOINTS, [2, 3], ARM_READING)


def _write(
    folder: Path,
    episodes: list[tuple[np.ndarray, np.ndarray]],
    columns: tuple[str, ...],
    action: tuple[str, ...],
    files: list[int],
    reading: str,
) -> tuple[z2r.Dataset, z2r.Reading]:
    features = {
        "observation.state": {"dtype": "float32", "shape": [len(columns)], "names": list(columns)},
        "action": {"dtype": "float32", "shape": [len(action)], "names": list(action)},
    }
    frames = {name: np.concatenate(parts) for name, parts in zip(features, zip(*episodes, strict=True), strict=True)}
    lengths = [len(state) for state, _ in episodes]
    layout = Layout(files=files, shards=[len(lengths)])
    write_dataset(folder / "data", frames, lengths, layout, features=features | BOOKKEEPING)
    path = folder / "reading.toml"
    path.write_text(reading)
    return z2r.load(folder / "data"), z2r.read_reading(path)


def _reach(rng: np.random.Generator, reached: bool, number: int) -> tuple[np.ndarray, np.ndarray]:
    """One episode of the hand: a smooth way from somewhere to the spot, or to where it misses it."""
    n_frames = int(rng.integers(12, 30))
    spot, turn = rng.uniform(1.0, 1.6, 2), rng.uniform(-3, 3)
    off = 0.04 if reached or number % 2 else 0.3  # m
    aside = 0.2 if reached else 2.0 if number % 2 else 0.1  # rad
    direction = rng.uniform(-np.pi, np.pi)
    end = [*(spot + off * np.array([np.cos(direction), np.sin(direction)])), np.rad2deg(turn + aside)]
    start = [*rng.uniform(0.2, 0.6, 2), rng.uniform(-500, 500)]
    share = (1 - np.cos(np.linspace(0, np.pi, n_frames + 1))) / 2
    way = np.array(start) + share[:, None] * np.subtract(end, start)  # (n_frames + 1, 3)
    still = np.tile([*spot, np.sin(turn), np.cos(turn)], (n_frames, 1))
    return np.concatenate([way[1:], still], axis=1).astype(np.float32), np.roll(way, -1, 0)[1:, :2].astype(np.float32)


def _grip(rng: np.random.Generator, reached: bool) -> tuple[np.ndarray, np.ndarray]:
    """One episode of the arm: joints that wander [deg], and a gripper that ends closed or open [percent]."""
    n_frames = int(rng.integers(10, 25))
    joints = np.cumsum(rng.normal(0, 2, (n_frames, 5)), axis=0)
    gripper = np.linspace(20 if not reached else 90, 20 if reached else 90, n_frames)  # a limit that is met exactly
    state = np.column_stack([joints, gripper]).astype(np.float32)
    return state, np.concatenate([state[1:], state[-1:]])
