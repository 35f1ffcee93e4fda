"""What somebody measures by hand who solves the finale without an instrument: one question after the other."""

import numpy as np

from z2r.course.hunts.arm import JAWS, JOINTS
from z2r.course.hunts.finale import HEALTHY, Recording

ALL = (*JOINTS, JAWS)


def diagnosed(it: Recording) -> str:
    """Say what is wrong with a dataset."""
    episodes = [{name: own[it.episodes[k]] for name, own in it.columns.items()} for k in range(len(it.episodes))]
    return of_the_pusher(episodes, it.fps) if "pusher_x" in it.columns else of_the_arm(episodes)


def of_the_pusher(episodes: list[dict], fps: float) -> str:
    def motion(axis: str) -> list[np.ndarray]:
        return [fps * np.diff(each[f"pusher_{axis}"]) for each in episodes]

    def told(axis: str, shift: int = 0) -> list[np.ndarray]:
        return [each[f"action/pusher_v{axis}"][shift:][: len(each["pusher_x"]) - 1] for each in episodes]

    def alike(asked: list[np.ndarray], seen: list[np.ndarray]) -> float:
        pairs = [(one[: len(other)], other[: len(one)]) for one, other in zip(asked, seen, strict=True)]
        return np.corrcoef(*(np.concatenate(part) for part in zip(*pairs, strict=True)))[0, 1]

    if alike(told("x"), motion("y")) > 0.9:
        return "pusher-x-and-y-exchanged"
    if leaps_at_ends(episodes, ("pusher_x", "pusher_y", "tee_x", "tee_y")) > 2:
        return "index-shifted"
    if max(range(5), key=lambda shift: alike(told("x", shift), motion("x"))):
        return "commands-late"
    factor = np.polyfit(np.concatenate(told("x")), np.concatenate(motion("x")), 1)[0]
    if factor > 2:
        return "clock-three-times-too-fast"
    if factor < 0.1:
        return "actions-in-centimetres"
    beside = [
        np.hypot(*(motion(axis)[k] - factor * told(axis)[k] for axis in "xy")).max() / fps for k in range(len(episodes))
    ]
    if max(beside) > 0.06:
        return "second-lost"
    return "sine-and-cosine-exchanged" if sum(map(frames_inside_the_block, episodes)) > 5 else HEALTHY


def frames_inside_the_block(own: dict) -> int:
    yaw = np.arctan2(own["sin_tee_yaw"], own["cos_tee_yaw"])
    dx, dy = own["pusher_x"] - own["tee_x"], own["pusher_y"] - own["tee_y"]
    across, along = np.cos(yaw) * dx + np.sin(yaw) * dy, np.cos(yaw) * dy - np.sin(yaw) * dx
    bar = (np.abs(across) < 0.06) & (np.abs(along) < 0.015)
    stem = (np.abs(across) < 0.015) & (np.abs(along + 0.06) < 0.045)
    return int((bar | stem).sum())


def of_the_arm(episodes: list[dict]) -> str:
    def stacked(prefix: str, shift: int = 0, names: tuple[str, ...] = ALL) -> np.ndarray:
        rows = (np.stack([each[prefix + name] for name in names], axis=1) for each in episodes)
        return np.concatenate([own[15 + shift : len(own) - 15 + shift] for own in rows])

    if max(np.ptp(each["goal_x"]) for each in episodes) > 0.01 > max(np.ptp(each["block_z"]) for each in episodes):
        return "cube-and-goal-exchanged"
    if leaps_at_ends(episodes, ALL) > 2:
        return "index-shifted"
    likeness = {lag: np.corrcoef(stacked("action/").T, stacked("", lag).T)[:6, 6:] for lag in range(-14, 15)}
    lag = max(likeness, key=lambda lag: np.abs(likeness[lag]).max(axis=1).mean())
    if lag < 0:
        return "commands-late"
    if any(map(stood_still, episodes)):
        return "encoders-stuck"
    if likeness[lag].diagonal().min() < 0.8:
        return "joints-exchanged"
    if (stacked("", 0, JOINTS).std(axis=0) < 0.1 * stacked("action/", 0, JOINTS).std(axis=0)).any():
        return "joint-in-radians"
    if sum(map(way_with_open_jaws, episodes)) > 0.05:
        return "jaws-turned-round" if all(each[JAWS][0] > 50 for each in episodes) else "cube-too-early"
    return "second-lost" if max(map(longest_jerk, episodes)) > 3 else HEALTHY


def leaps_at_ends(episodes: list[dict], names: tuple[str, ...]) -> int:
    """In how many episodes the last step is a leap."""
    steps = [np.abs(np.diff(np.stack([each[name] for name in names], axis=1), axis=0)) for each in episodes]
    usual = np.quantile(np.concatenate(steps), 0.99, axis=0)
    return sum(bool((own[-1] > 2 * usual).any()) for own in steps)


def stood_still(own: dict) -> bool:
    """Whether no joint moves for 20 frames while one is told to."""
    seen, told = (np.stack([own[prefix + name] for name in ALL], axis=1) for prefix in ("", "action/"))
    windows = [slice(k, k + 20) for k in range(len(seen) - 20)]
    return any(not np.ptp(seen[here], axis=0).any() and np.ptp(told[here], axis=0).max() > 3 for here in windows)


def way_with_open_jaws(own: dict) -> float:
    """How far the cube goes while nobody holds it [m]."""
    steps = np.linalg.norm(np.diff([own[f"block_{axis}"] for axis in "xyz"], axis=1), axis=0)
    return float(steps[own[JAWS][1:] > 50].sum())


def longest_jerk(own: dict) -> float:
    """How much further a joint goes in a frame than in those beside it [degrees]."""
    steps = np.abs(np.diff(np.stack([own[name] for name in JOINTS], axis=1), axis=0))
    return float((steps[1:-1] - np.maximum(steps[:-2], steps[2:])).max())
