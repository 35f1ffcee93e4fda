"""Synthetic robots: what each would have recorded, and what each dimension of its action truly is.

`ROBOTS` is one table. Every robot is made as a real one is: a command (a teleoperator, a script, a policy) goes through
a plant (dead time, first-order tracking, rate limits, stiction, gravity, contact) and is seen by a sensor (noise,
encoder ticks, float32). Nothing in here knows how one action is told from another: the truth comes from the making.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from z2r.reading.action import ActionSample

PLAIN, HARD, OPEN = "plain", "hard", "open"
DEGREES = 180 / np.pi
TICK = 360 / 4096
KNOWN_FACTORS = (1.0, DEGREES, 1 / DEGREES, 1000.0, 0.001, 100.0, 0.01)
FACTOR_WITHIN = 0.15
LONGEST_LAG = 40


@dataclass(frozen=True)
class Claim:
    """One true thing to say of a dimension. Where `within` is None, only the sign of the factor is certain."""

    kind: str
    column: str
    factor: float
    ahead: tuple[float, float]
    within: float | None = FACTOR_WITHIN


@dataclass(frozen=True)
class Truth:
    """What may be said of a dimension: no claims when it drives no column at all.

    `level` is "plain" when anyone would see it, "hard" when a careful reader would, "open" when the data cannot decide.
    """

    name: str
    claims: tuple[Claim, ...]
    level: str
    copied: bool = False


@dataclass(frozen=True)
class Robot:
    sample: ActionSample
    truths: tuple[Truth, ...]


def minimum_jerk(n: int) -> np.ndarray:
    tau = np.linspace(0, 1, n)
    return 10 * tau**3 - 15 * tau**4 + 6 * tau**5


def wrap(angle: np.ndarray, turn: float) -> np.ndarray:
    return (angle + turn / 2) % turn - turn / 2


def per_dim(value: Any, n_dims: int) -> list:
    """One value for each dimension, from one for all or a sequence of them."""
    alone = isinstance(value, str | int | float | np.floating) or value is None
    return [value] * n_dims if alone else list(value)


class Rig:
    """A laboratory: makes commands, lets a plant follow them, and writes down action, state and truth."""

    def __init__(self, seed: int, fps: float, lengths: Sequence[int]):
        self.rng = np.random.default_rng(seed)
        self.fps = fps
        self.lengths = tuple(lengths)
        self.stretch = np.repeat(np.arange(len(lengths)), lengths)
        self.actions: dict[str, np.ndarray] = {}
        self.columns: dict[str, np.ndarray] = {}
        self.truths: list[Truth] = []

    def each(self, make: Callable[[int], np.ndarray]) -> np.ndarray:
        return np.concatenate([make(n) for n in self.lengths])

    def split(self, values: np.ndarray) -> list[np.ndarray]:
        return np.split(values, np.cumsum(self.lengths)[:-1])

    # Commands, about within [-1, 1].

    def smooth(self, n: int, n_dims: int, hertz: float) -> np.ndarray:
        """Smooth noise with next to nothing above `hertz`."""
        n_padded = max(2 * n, int(8 * self.fps / hertz))
        bend = np.fft.rfftfreq(n_padded, 1 / self.fps)[:, None] / hertz
        spectrum = np.fft.rfft(self.rng.normal(size=(n_padded, n_dims)), axis=0) / (1 + bend**2) ** 2
        spectrum[0] = 0
        path = np.fft.irfft(spectrum, n_padded, axis=0)
        return 0.5 * path[:n] / path.std(axis=0)

    def teleop(self, n_dims: int, hertz: float = 0.4) -> np.ndarray:
        """A person leads every joint at their own pace, and now and then stops to think."""

        def make(n):
            pace = np.clip(0.6 + 1.2 * self.smooth(n, 1, 0.3)[:, 0], 0, 1.5)
            clock = np.cumsum(pace)
            path = self.smooth(2 * n + 2, n_dims, hertz)
            return np.stack([np.interp(clock, np.arange(len(path)), p) for p in path.T], axis=1)

        return self.each(make)

    def reach(self, n_dims: int, seconds: float = 1.0, pause: float = 0.5, stays: float = 0.2) -> np.ndarray:
        """Minimum-jerk moves from point to point with pauses, all joints in time, some of them staying."""

        def make(n):
            here, parts, total = self.rng.uniform(-1, 1, n_dims), [], 0
            while total < n:
                stay = self.rng.random(n_dims) < stays
                goal = np.where(stay, here, self.rng.uniform(-1, 1, n_dims))
                moving = minimum_jerk(max(2, int(self.fps * seconds * self.rng.uniform(0.6, 1.6))))
                still = np.ones(int(self.fps * pause * self.rng.uniform(0, 2)))
                shape = np.concatenate([moving, still])
                parts.append(here + (goal - here) * shape[:, None])
                here, total = goal, total + len(shape)
            return np.concatenate(parts)[:n]

        return self.each(make)

    def switch(self, seconds: float = 2.0) -> np.ndarray:
        """A button: 0 or 1, changed now and then."""

        def make(n):
            flips = self.rng.random(n) < 1 / (seconds * self.fps)
            return (np.cumsum(flips) % 2).astype(float)

        return self.each(make)

    def walk(self, n_dims: int) -> np.ndarray:
        return self.each(lambda n: np.cumsum(self.rng.normal(size=(n, n_dims)), axis=0) / np.sqrt(n))

    def clock(self) -> np.ndarray:
        return self.each(np.arange) / self.fps

    # Plants.

    def track(self, command, gain=1.0, dead=0, rate=np.inf, stick=0.0) -> np.ndarray:
        """What follows the command: x[t + 1] = x[t] + gain * (command[t - dead] - x[t]), limited and sticking."""

        def follow(wanted):
            late = np.concatenate([np.repeat(wanted[:1], max(dead, 0), axis=0), wanted])
            x = np.empty_like(wanted)
            x[0] = wanted[0]
            for t in range(len(wanted) - 1):
                error = late[t] - x[t]
                x[t + 1] = x[t] + np.clip(gain * np.where(np.abs(error) > stick, error, 0), -rate, rate)
            return x

        return np.concatenate([follow(c) for c in self.split(command)])

    def delay(self, values: np.ndarray, frames: int) -> np.ndarray:
        """The values `frames` later; the first one is held."""
        held = [np.concatenate([np.repeat(v[:1], frames, axis=0), v])[: len(v)] for v in self.split(values)]
        return np.concatenate(held)

    def servo(self, command, hertz: float, damping: float = 0.9, substeps: int = 8) -> np.ndarray:
        """A second-order servo (PD with inertia)."""
        omega, dt = 2 * np.pi * hertz, 1 / self.fps / substeps

        def follow(wanted):
            x, v, out = wanted[0].copy(), np.zeros(wanted.shape[1]), np.empty_like(wanted)
            for t in range(len(wanted)):
                out[t] = x
                for _ in range(substeps):
                    v = v + dt * (omega**2 * (wanted[t] - x) - 2 * damping * omega * v)
                    x = x + dt * v
            return out

        return np.concatenate([follow(c) for c in self.split(command)])

    def change(self, values: np.ndarray) -> np.ndarray:
        """By how much values changed since the frame before; nothing at the first frame."""
        return np.concatenate([np.diff(v, axis=0, prepend=v[:1]) for v in self.split(values)])

    def integrate(self, changes: np.ndarray) -> np.ndarray:
        return np.concatenate([np.cumsum(c, axis=0) for c in self.split(changes)])

    def sense(self, values, noise=0.0, quantum=0.0) -> np.ndarray:
        seen = values + noise * self.rng.normal(size=np.shape(values))
        return np.round(seen / quantum) * quantum if quantum else seen

    # The record.

    def lags(self, command: np.ndarray, response: np.ndarray) -> tuple[float, float]:
        """How late the response is, noise apart: by where it is, and by how it changes."""
        pairs = [(command, response), (self.change(command), self.change(response))]
        found = [min(range(LONGEST_LAG), key=lambda k, p=p: self.misfit(*p, k)) for p in pairs]
        return min(found), max(found)

    def misfit(self, command: np.ndarray, response: np.ndarray, k: int) -> float:
        n = len(command)
        same = self.stretch[: max(n - k, 0)] == self.stretch[k:]
        return float(np.std((response[k:] - command[: max(n - k, 0)])[same])) if np.sum(same) > 1 else np.inf

    def column(self, name: str, values: np.ndarray) -> None:
        self.columns[name] = np.asarray(values, dtype=float)

    def dim(self, name: str, values: np.ndarray, *claims: Claim, level: str = OPEN, copied: bool = False) -> None:
        self.actions[name] = np.asarray(values, dtype=float)
        self.truths.append(Truth(name, claims, level, copied))

    def unrelated(self, name: str, values: np.ndarray) -> None:
        self.dim(name, values)

    def joints(
        self,
        names: Sequence[str],
        command: np.ndarray,
        response: np.ndarray,
        *,
        kind: str = "target",
        factor: Any = 1.0,
        offset: Any = 0.0,
        level: Any = PLAIN,
        ahead: tuple[float, float] | None = None,
        within: float | None = FACTOR_WITHIN,
        noise: Any = 0.0,
        quantum: float = 0.0,
        action_noise: float = 0.0,
        suffix: str = ".pos",
    ) -> None:
        """Joints that follow a command, sent as a target, a step or a velocity: a dimension and a column each."""
        sent = command if kind == "target" else self.change(command) * (self.fps if kind == "velocity" else 1)
        sent = sent + action_noise * self.rng.normal(size=sent.shape)
        rows = zip(*(per_dim(v, len(names)) for v in (names, factor, offset, level, noise)), strict=True)
        for i, (name, scale, shift, how, sigma) in enumerate(rows):
            late = self.lags(command[:, i], response[:, i]) if ahead is None else ahead
            self.column(name + suffix, self.sense(response[:, i], sigma, quantum))
            claim = Claim(kind, name + suffix, scale, late, within)
            self.dim(name, scale * sent[:, i] + shift, claim, level=how)

    def also(self, name: str, *claims: Claim) -> None:
        """Say what else is true of a dimension."""
        at = [t.name for t in self.truths].index(name)
        old = self.truths[at]
        self.truths[at] = Truth(name, old.claims + claims, old.level, old.copied)

    def extras(self, names: Sequence[str], response: np.ndarray, noise: float = 0.01) -> None:
        """Measured velocities and efforts, as a driver reports them beside the positions."""
        speed = self.change(response) * self.fps
        for i, name in enumerate(names):
            self.column(f"{name}.vel", self.sense(speed[:, i], noise * speed[:, i].std()))
        for i, name in enumerate(names):
            effort = 2 * np.cos(response[:, i]) + 0.3 * self.change(speed)[:, i] * self.fps
            self.column(f"{name}.effort", self.sense(effort, 0.3))

    def build(self, *, columns: Sequence[int] | None = None, float32: bool = True) -> Robot:
        """The robot; `columns` is another order of the state."""
        names = list(self.columns)
        names = names if columns is None else [names[i] for i in columns]
        kind = np.float32 if float32 else np.float64
        action = np.stack(list(self.actions.values()), axis=1).astype(kind).astype(np.float64)
        state = np.stack([self.columns[n] for n in names], axis=1).astype(kind).astype(np.float64)
        stretch = self.stretch.astype(np.int64)
        sample = ActionSample(
            action=action,
            state=state,
            stretch=stretch,
            names=tuple(self.actions),
            columns=tuple(names),
            fps=float(self.fps),
        )
        return Robot(sample, tuple(self.truths))


def known(factor: float) -> bool:
    return any(abs(abs(factor) / k - 1) <= FACTOR_WITHIN for k in KNOWN_FACTORS)


def factors(claim: Claim, fps: float) -> tuple[float, float]:
    """Of a change: action units per unit of state and frame, and per unit of state and second."""
    per_frame = claim.factor if claim.kind == "step" else claim.factor * fps
    return per_frame, per_frame / fps


def faults(answer: Any, claim: Claim, fps: float) -> list[str]:
    """What a decided answer has wrong, if this claim is what is true."""
    change = claim.kind != "target" and answer.kind == "step or velocity"
    true = factors(claim, fps) if change else (claim.factor,)
    low, high = claim.ahead[0] - 1, claim.ahead[1] + 1
    within = claim.within
    near = any(within is None or abs(answer.factor / f - 1) <= within for f in true)
    found = {
        f"kind {answer.kind}, not {claim.kind}": answer.kind != claim.kind and not change,
        f"column {answer.column}, not {claim.column}": answer.column != claim.column,
        f"ahead {answer.ahead}, not {claim.ahead}": not low <= answer.ahead <= high,
        f"sign of {answer.factor:.4g}": answer.factor * claim.factor <= 0,
        f"factor {answer.factor:.4g}, not {claim.factor:.4g}": not near,
    }
    return [fault for fault, is_so in found.items() if is_so]


def judge(answer: Any, truth: Truth, fps: float) -> tuple[str, str]:
    """One of right, withheld (unknown, and rightly so), undecided and wrong; and why."""
    if answer.kind == "unknown":
        return ("withheld" if truth.level == OPEN else "undecided"), answer.evidence
    if not truth.claims:
        return "wrong", f"{answer.kind} of {answer.column}, when it drives no column"
    found = {claim: faults(answer, claim, fps) for claim in truth.claims}
    true = [claim for claim, wrong in found.items() if not wrong]
    if not true:
        return "wrong", "; ".join(min(found.values(), key=len))
    if answer.kind != "step or velocity" or any(len({known(f) for f in factors(c, fps)}) == 1 for c in true):
        return "right", ""
    return "undecided", "only one of the two has a known factor"


ROBOTS: dict[str, Callable[[], Robot]] = {}


def robot(make: Callable[[], Robot]) -> Callable[[], Robot]:
    ROBOTS[make.__name__] = cache(make)
    return ROBOTS[make.__name__]


SO100 = ("shoulder_pan", "shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll")
XYZ = ("x", "y", "z")
RPY = ("roll", "pitch", "yaw")


def numbered(prefix: str, n: int) -> tuple[str, ...]:
    return tuple(f"{prefix}_{i}" for i in range(n))


# Leader and follower arms.


@robot
def so100_leader_and_follower():
    """Degrees, a follower that sticks and sags, encoder ticks, and a jaw that stops at the object."""
    rig = Rig(1, 30, (240,) * 12)
    command = rig.teleop(5) * (50, 40, 45, 35, 60)
    response = rig.track(command, gain=0.45, dead=1, stick=0.4) - 3 * np.cos(command / DEGREES)
    rig.joints(SO100, command, response, quantum=TICK, noise=0.05)
    wanted = rig.track(90 - 85 * rig.switch()[:, None], gain=0.2)
    held = np.repeat(rig.rng.choice([0, 25, 40], len(rig.lengths)), rig.lengths)[:, None]
    jaw = np.maximum(rig.track(wanted, gain=0.5, dead=1), held)
    rig.joints(("gripper",), wanted, jaw, level=OPEN, ahead=(2, 4), quantum=TICK)
    return rig.build()


@robot
def so100_with_a_roll_that_hardly_ever_moves():
    rig = Rig(2, 30, (300,) * 8)
    command = rig.teleop(5) * (50, 40, 45, 35, 0.05)
    response = rig.track(command, gain=0.5, dead=1)
    rig.joints(SO100, command, response, quantum=TICK, level=[PLAIN] * 4 + [OPEN])
    return rig.build()


@robot
def so100_calibrated_elsewhere():
    """The zero of the leader is not the zero of the follower: 90 degrees and more apart."""
    rig = Rig(3, 30, (200,) * 10)
    command = rig.teleop(5) * (40, 40, 40, 40, 70)
    response = rig.track(command, gain=0.6)
    rig.joints(SO100, command, response, offset=(90, -90, 180, 12, -45), noise=0.1)
    return rig.build()


@robot
def koch_in_ticks_with_flipped_joints():
    """The action in ticks of the leader (2048 at rest), the state in degrees, some joints the other way round."""
    rig = Rig(4, 30, (250,) * 10)
    command = rig.teleop(6) * 45
    response = rig.track(command, gain=0.5, dead=1)
    signs = np.array([1, -1, 1, 1, -1, 1]) * 4096 / 360
    rig.joints(numbered("motor", 6), command, response, factor=signs, offset=2048, quantum=TICK)
    return rig.build()


@robot
def follower_read_after_it_arrived():
    """The state is read in the same turn of the loop, when the servo is there already: no lag at all."""
    rig = Rig(5, 10, (100,) * 12)
    command = rig.teleop(4) * 1.2
    rig.joints(numbered("joint", 4), command, command - 0.02, noise=0.004)
    return rig.build()


def aloha(seed: int, lag: int, level: str = PLAIN, idle: bool = False) -> Rig:
    rig = Rig(seed, 50, (300,) * 10)
    command = rig.teleop(12) * 0.7
    if idle:
        asleep = np.isin(rig.stretch, (0, 2, 4, 6, 8))
        command[asleep, 6:] = np.array([0.0, -0.96, 1.16, 0.0, -0.3, 0.0])
    response = rig.track(command, gain=0.7, dead=lag)
    names = [f"{side}_{joint}" for side in ("left", "right") for joint in (*SO100, "forearm_roll")]
    rig.joints(names, command, response, noise=0.001, quantum=TICK / DEGREES, level=level)
    return rig


@robot
def aloha_bimanual():
    """Fourteen dimensions at 50 frames per second, grippers from 0 to 1 that track late."""
    rig = aloha(6, 1)
    wanted = np.concatenate([rig.track(rig.switch()[:, None], gain=0.15) for _ in range(2)], axis=1)
    rig.joints(("left_gripper", "right_gripper"), wanted, rig.track(wanted, gain=0.3), noise=0.002, level=HARD)
    return rig.build()


@robot
def aloha_with_an_idle_arm_in_half_of_the_episodes():
    return aloha(7, 2, idle=True).build()


@robot
def aloha_whose_arms_mirror_each_other():
    """A script moves the right arm as the mirror image of the left one: nothing tells them apart."""
    rig = Rig(8, 50, (200,) * 8)
    left = rig.reach(6) * 0.6
    both = np.concatenate([left, -left], axis=1)
    response = rig.track(both, gain=0.6)
    rig.joints(numbered("left", 6) + numbered("right", 6), both, response, level=OPEN)
    return rig.build()


@robot
def aloha_whose_arms_nearly_mirror_each_other():
    """As above, but for a person: the right arm is the mirror image to within a tenth."""
    rig = Rig(9, 50, (200,) * 8)
    left = rig.teleop(6) * 0.6
    both = np.concatenate([left, -left + 0.1 * rig.teleop(6)], axis=1)
    response = rig.track(both, gain=0.6)
    rig.joints(numbered("left", 6) + numbered("right", 6), both, response, level=HARD, noise=0.002)
    return rig.build()


@robot
def follower_fifteen_frames_late():
    """Servoed at 125 frames per second through a filter: as late as the window is long."""
    rig = Rig(10, 125, (900,) * 5)
    command = rig.teleop(6, 0.5) * 0.8
    response = rig.track(command, gain=1.0, dead=14)
    rig.joints(numbered("joint", 6), command, response, noise=0.0005, level=HARD)
    return rig.build()


@robot
def follower_eleven_frames_late():
    rig = Rig(11, 100, (700,) * 6)
    command = rig.teleop(7, 0.5) * 0.8
    response = rig.track(command, gain=0.2, dead=6)
    rig.joints(numbered("joint", 7), command, response, noise=0.0005)
    return rig.build()


@robot
def heavy_arm_twenty_five_frames_late():
    rig = Rig(12, 50, (600,) * 6)
    command = rig.teleop(6, 0.3) * 0.8
    response = rig.track(command, gain=0.1, dead=15)
    rig.joints(numbered("axis", 6), command, response, noise=0.0005, level=OPEN)
    return rig.build()


@robot
def arm_limited_in_rate():
    """A fast person leads a slow follower: it lags more the faster they go."""
    rig = Rig(13, 30, (300,) * 8)
    command = rig.teleop(5, 0.5) * 50
    response = rig.track(command, gain=0.7, rate=2.2)
    rig.joints(SO100, command, response, quantum=TICK, level=HARD, ahead=(1, 7))
    return rig.build()


@robot
def arm_that_pushes_on_the_table():
    """An impedance controller: the height asked for is below the table for a third of the time."""
    rig = Rig(14, 20, (200,) * 10)
    command = rig.teleop(3) * (0.2, 0.25, 0.15)
    response = rig.track(command, gain=0.5)
    response[:, 2] = np.maximum(response[:, 2], -0.04)
    rig.joints(XYZ, command, response, noise=0.0005, level=[PLAIN, PLAIN, OPEN], ahead=(1, 2))
    return rig.build()


@robot
def state_polled_at_half_the_rate():
    """The driver answers at 15 frames per second, the recorder asks at 30: every other state is the one before."""
    rig = Rig(15, 30, (240,) * 8)
    command = rig.teleop(6) * 40
    response = rig.track(command, gain=0.6)
    stale = rig.each(np.arange) % 2 == 1
    rig.joints(numbered("joint", 6), command, response, ahead=(1, 3))
    for name in rig.columns:
        rig.columns[name][stale] = np.roll(rig.columns[name], 1)[stale]
    return rig.build()


@robot
def action_held_by_a_slow_policy():
    """A policy at 10 frames per second, its target held for five frames of a recording at 50."""
    rig = Rig(16, 50, (300,) * 8)
    command = rig.teleop(6) * 0.7
    held = np.concatenate([np.repeat(c[::5], 5, axis=0)[: len(c)] for c in rig.split(command)])
    response = rig.track(held, gain=0.35)
    rig.joints(numbered("joint", 6), held, response, noise=0.001, level=HARD)
    return rig.build()


# Targets in other units, places and orders.


@robot
def degrees_sent_radians_read():
    rig = Rig(17, 30, (250,) * 8)
    command = rig.teleop(6) * 0.8
    response = rig.track(command, gain=0.6)
    rig.joints(numbered("joint", 6), command, response, factor=DEGREES * np.array([1, 1, -1, 1, -1, 1]), noise=0.001)
    return rig.build()


@robot
def radians_sent_degrees_read():
    rig = Rig(18, 60, (400,) * 6)
    command = rig.reach(6) * 60
    response = rig.track(command, gain=0.4)
    rig.joints(numbered("joint", 6), command, response, factor=1 / DEGREES, quantum=TICK, noise=0.05)
    return rig.build()


@robot
def millimetres_sent_metres_read():
    """An end effector, its pose sent in millimetres and degrees."""
    rig = Rig(19, 25, (250,) * 8)
    command = rig.reach(6) * (0.2, 0.3, 0.15, 0.4, 0.4, 0.8)
    response = rig.servo(command, 3.0)
    rig.joints(XYZ, command[:, :3], response[:, :3], factor=1000, noise=0.0003)
    rig.joints(RPY, command[:, 3:], response[:, 3:], factor=DEGREES, noise=0.001)
    return rig.build()


@robot
def percent_sent_radians_read():
    """Leader joints normalised to [-100, 100] each by its own range, as after a calibration."""
    rig = Rig(20, 30, (250,) * 8)
    command = rig.teleop(6) * 0.8
    response = rig.track(command, gain=0.6)
    ranges = np.array([1.92, 1.75, 1.69, 1.66, 2.74, 1.1])
    rig.joints(numbered("joint", 6), command, response, factor=100 / ranges, offset=3.0, noise=0.001)
    return rig.build()


@robot
def joints_in_another_order():
    """What a change of driver does: action[0] drives column 3, and one joint is the other way round."""
    rig = Rig(21, 30, (250,) * 8)
    command = rig.teleop(6) * 0.8
    response = rig.track(command, gain=0.6, dead=1)
    rig.joints(numbered("joint", 6), command, response, factor=[1, -1, 1, 1, 1, 1], noise=0.001)
    return rig.build(columns=(3, 5, 1, 0, 2, 4))


@robot
def joints_with_names_exchanged():
    """The names of two columns are exchanged: the data says what is so, whatever the names."""
    rig = Rig(22, 30, (250,) * 8)
    command = rig.teleop(4) * 0.8
    response = rig.track(command, gain=0.6, dead=1)
    names = numbered("joint", 4)
    for i, j in enumerate((1, 0, 2, 3)):
        rig.column(f"{names[j]}.pos", rig.sense(response[:, i], 0.001))
        claim = Claim("target", f"{names[j]}.pos", 1.0, rig.lags(command[:, i], response[:, i]))
        rig.dim(names[i], command[:, i], claim, level=PLAIN)
    return rig.build()


@robot
def end_effector_that_looks_down():
    """Euler angles of a hand that looks down: the roll is about half a turn, and its sign flips all the time."""
    rig = Rig(23, 15, (200,) * 10)
    command = rig.teleop(6) * (0.2, 0.25, 0.15, 0.3, 0.3, 0.9) + (0.5, 0, 0.3, np.pi, 0, 0)
    response = rig.track(command, gain=0.6)
    rig.joints(XYZ + RPY, command, response, noise=0.001, level=[PLAIN] * 3 + [HARD] + [PLAIN] * 2)
    rig.actions["roll"] = wrap(rig.actions["roll"], 2 * np.pi)
    rig.columns["roll.pos"] = wrap(rig.columns["roll.pos"], 2 * np.pi)
    return rig.build()


@robot
def wrist_that_turns_without_end():
    """The last joint spins on and on; action and state are wrapped to half a turn either way."""
    rig = Rig(24, 30, (250,) * 8)
    command = rig.teleop(3) * 50
    spin = rig.integrate(6 * rig.teleop(1) + 4)
    command = np.concatenate([command, spin], axis=1)
    response = rig.track(command, gain=0.6)
    rig.joints(numbered("joint", 4), command, response, noise=0.05, level=[PLAIN] * 3 + [HARD])
    for record, key in ((rig.actions, "joint_3"), (rig.columns, "joint_3.pos")):
        record[key] = wrap(record[key], 360)
    return rig.build()


@robot
def pusht():
    """Pixels at 10 frames per second; a block that goes where the pusher pushes it is in the state too."""
    rig = Rig(25, 10, (120,) * 20)
    command = 256 + 120 * rig.teleop(2, 0.25)
    response = rig.servo(command, 1.6, 1.0)
    rig.joints(("target_x", "target_y"), command, response)
    block = 256 + 0.5 * (rig.track(response, gain=0.15) - 256) + 10 * rig.walk(2)
    rig.column("block_x", block[:, 0])
    rig.column("block_y", block[:, 1])
    rig.column("block_yaw", rig.track(response, gain=0.1)[:, 0] / 200 + rig.walk(1)[:, 0])
    return rig.build()


@robot
def pick_and_place():
    """A scripted hand: minimum-jerk moves with pauses, a gripper that closes on things, the object in the state."""
    rig = Rig(26, 20, (240,) * 12)
    command = rig.reach(3, 1.0, 0.8) * (0.25, 0.3, 0.12)
    response = rig.track(command, gain=0.5)
    rig.joints(XYZ, command, response, noise=0.0005)
    closed = rig.switch(1.5)[:, None]
    width = np.maximum(rig.track(0.08 * (1 - closed), rate=0.008), 0.03)
    late = (1.0, 10.0)
    rig.joints(("gripper",), 0.08 * (1 - closed), width, factor=12.5, ahead=late, within=None, level=OPEN)
    carried = np.where(closed > 0, response, rig.track(response, gain=0.02))
    for i, name in enumerate(XYZ):
        rig.column(f"object_{name}", carried[:, i])
    return rig.build()


@robot
def scripted_point_to_point():
    """Straight lines in joint space: all joints share one time law, and differ in where they go."""
    rig = Rig(27, 50, (250,) * 12)
    command = rig.reach(7, 1.5, 0.3, stays=0.0)
    response = rig.track(command, gain=0.5)
    rig.joints(numbered("joint", 7), command, response, noise=0.0005)
    return rig.build()


@robot
def episodes_of_nearly_the_same_motion():
    """One straight line in joint space, thirty times over: every joint is a picture of every other."""
    rig = Rig(28, 30, (90,) * 30)
    shape = rig.each(lambda n: minimum_jerk(n)[:, None])
    command = shape * rig.rng.uniform(0.3, 1, 5) + 0.004 * rig.teleop(5)
    response = rig.track(command, gain=0.5)
    rig.joints(numbered("joint", 5), command, response, noise=0.002, level=OPEN)
    return rig.build()


@robot
def episodes_of_the_same_demonstration():
    """A person repeats one motion of several parts, with small differences: each joint has its own shape."""
    rig = Rig(29, 30, (200,) * 15)
    one = rig.teleop(6)[:200] * 0.7
    command = rig.each(lambda n: one[:n] + 0.1 * rig.smooth(n, 6, 0.3))
    response = rig.track(command, gain=0.5)
    rig.joints(numbered("joint", 6), command, response, noise=0.001)
    return rig.build()


@robot
def idle_joints():
    """Half of the joints rest in half of the episodes, and two rest in all but one."""
    rig = Rig(30, 30, (200,) * 10)
    command = rig.teleop(6) * 0.6
    command[np.ix_(rig.stretch % 2 == 0, (0, 1, 2))] = 0.2
    command[np.ix_(rig.stretch != 3, (4, 5))] = -0.1
    response = rig.track(command, gain=0.5)
    rig.joints(numbered("joint", 6), command, response, noise=0.001, level=[PLAIN] * 4 + [HARD] * 2)
    return rig.build()


@robot
def humanoid():
    """Thirty-four joints: arms that move, legs that stand, a waist that is locked."""
    rig = Rig(31, 50, (300,) * 6)
    command = rig.teleop(34) * np.repeat([0.6, 0.3, 0.0015, 0.0], [14, 6, 12, 2])
    response = rig.servo(command, 4.0, substeps=4) - 0.02 * np.cos(command)
    levels = [PLAIN] * 20 + [OPEN] * 14
    rig.joints(numbered("joint", 34), command, response, noise=0.002, level=levels)
    return rig.build()


@robot
def dexterous_hand_with_coupled_joints():
    """The last two joints of a finger hang on one tendon: the state has both, the action one."""
    rig = Rig(32, 30, (250,) * 8)
    command = np.clip(0.7 + 0.7 * rig.teleop(5, 0.6), 0, 1.5)
    response = rig.track(command, gain=0.4)
    fingers = ("thumb", "index", "middle", "ring", "little")
    rig.joints(fingers, command, response, level=OPEN)
    for i, name in enumerate(fingers):
        rig.column(f"{name}.tip", 0.8 * response[:, i])
        rig.also(name, Claim("target", f"{name}.tip", 1.25, rig.lags(command[:, i], response[:, i])))
    return rig.build()


@robot
def head_of_two_joints():
    rig = Rig(33, 10, (150,) * 8)
    command = rig.teleop(2, 0.3) * (1.0, 0.4)
    rig.joints(("pan", "tilt"), command, rig.track(command, gain=0.8), noise=0.005)
    return rig.build()


@robot
def single_joint_with_a_heavy_load():
    """One servo that sags by a tenth of its range, without an integrator."""
    rig = Rig(34, 50, (400,) * 5)
    command = rig.teleop(1) * 0.8
    response = rig.track(command - 0.15 * np.cos(command), gain=0.4)
    rig.joints(("arm",), command, response, noise=0.002)
    return rig.build()


@robot
def arm_with_velocities_and_efforts():
    """A state of 21 columns: positions, velocities, efforts."""
    rig = Rig(35, 50, (300,) * 8)
    command = rig.teleop(7) * 0.7
    response = rig.track(command, gain=0.4, dead=1)
    rig.joints(numbered("joint", 7), command, response, noise=0.0005)
    rig.extras(numbered("joint", 7), response)
    return rig.build()


@robot
def arm_that_reports_its_last_target():
    """The driver echoes the target it was given, beside where the joint is."""
    rig = Rig(36, 30, (250,) * 8)
    command = rig.teleop(5) * 50
    rig.joints(SO100, command, rig.track(command, gain=0.5, dead=1), quantum=TICK)
    for i, name in enumerate(SO100):
        rig.column(f"{name}.goal", rig.delay(command, 1)[:, i])
        rig.also(name, Claim("target", f"{name}.goal", 1.0, (1, 1)))
    return rig.build()


@robot
def arm_with_both_spaces_in_the_state():
    """Joint targets; the state holds the joints and the hand, which is where the joints put it."""
    rig = Rig(37, 30, (250,) * 8)
    command = rig.teleop(3) * 0.9
    response = rig.track(command, gain=0.5)
    rig.joints(numbered("joint", 3), command, response, noise=0.001)
    shoulder, elbow = response[:, 1], response[:, 1] + response[:, 2]
    radius = 0.3 * np.cos(shoulder) + 0.25 * np.cos(elbow)
    rig.column("hand_x", radius * np.cos(response[:, 0]))
    rig.column("hand_y", radius * np.sin(response[:, 0]))
    rig.column("hand_z", 0.3 * np.sin(shoulder) + 0.25 * np.sin(elbow))
    return rig.build()


@robot
def joint_targets_with_only_the_hand_in_the_state():
    """No column is a joint: each is bent by several of them, and no dimension drives one alone."""
    rig = Rig(38, 30, (250,) * 8)
    command = rig.teleop(3) * 1.3
    response = rig.track(command, gain=0.5)
    shoulder, elbow = response[:, 1], response[:, 1] + 2 * response[:, 2]
    radius = 0.3 * np.cos(shoulder) + 0.35 * np.cos(elbow)
    rig.column("hand_x", radius * np.cos(response[:, 0]))
    rig.column("hand_y", radius * np.sin(response[:, 0]))
    rig.column("hand_z", 0.3 * np.sin(shoulder) + 0.35 * np.sin(elbow))
    for i in range(3):
        rig.unrelated(f"joint_{i}", command[:, i])
    return rig.build()


@robot
def differential_wrist():
    """Two motors turn one wrist: their sum bends it, their difference rolls it, so none drives one column."""
    rig = Rig(39, 30, (250,) * 8)
    command = rig.teleop(2) * 50
    response = rig.track(command, gain=0.5)
    rig.column("pitch", response.mean(axis=1))
    rig.column("roll", (response[:, 0] - response[:, 1]) / 2)
    rig.unrelated("motor_a", command[:, 0])
    rig.unrelated("motor_b", command[:, 1])
    return rig.build()


# Copies.


def copied(seed: int, fps: float, ahead: int, noise: float, level: str = PLAIN) -> Robot:
    """The action is the state of another frame, written down bit for bit."""
    rig = Rig(seed, fps, (160,) * 10)
    path = rig.teleop(7) * (0.2, 0.25, 0.15, 0.5, 0.4, 0.8, 0.3)
    seen = rig.sense(path, noise).astype(np.float32).astype(float)
    for i, name in enumerate((*XYZ, *RPY, "gripper")):
        column = [s[:, i] for s in rig.split(seen)]
        if ahead >= 0:
            moved = [np.concatenate([c[ahead:], np.repeat(c[-1:], ahead)]) for c in column]
        else:
            moved = [np.concatenate([np.repeat(c[:1], -ahead), c[:ahead]]) for c in column]
        rig.column(f"{name}.pos", seen[:, i])
        claim = Claim("target", f"{name}.pos", 1.0, (ahead, ahead))
        rig.dim(name, np.concatenate(moved), claim, level=level, copied=ahead > 0)
    return rig.build()


@robot
def handheld_gripper_whose_action_is_the_next_state():
    return copied(40, 20, 1, 0.0005)


@robot
def noisy_tracker_whose_action_is_the_next_state():
    """The noise is larger than the motion from frame to frame, and is in both."""
    return copied(41, 60, 1, 0.01)


@robot
def chunk_of_four_frames_ahead():
    return copied(42, 30, 4, 0.001)


@robot
def taught_by_hand_action_is_the_current_state():
    return copied(43, 30, 0, 0.001)


@robot
def action_is_the_state_before():
    """A recorder that is one frame late: the action follows the state."""
    return copied(44, 30, -1, 0.001, level=OPEN)


# Steps.


@robot
def bridge_like():
    """Five frames per second, the action is how far the hand went until the next frame; the gripper is 0 or 1."""
    rig = Rig(45, 5, (40,) * 40)
    path = rig.teleop(6, 0.25) * (0.15, 0.2, 0.1, 0.2, 0.2, 0.6)
    rig.joints(XYZ + RPY, path, rig.track(path), kind="step", noise=0.0005)
    closed = rig.switch(2.0)[:, None]
    rig.joints(("gripper",), 1 - closed, rig.track(1 - closed, rate=0.5), ahead=(1, 3), level=HARD, noise=0.005)
    return rig.build()


@robot
def steps_of_what_was_measured():
    """A step made afterwards from the noisy state itself: the difference of neighbouring frames, exactly."""
    rig = Rig(46, 10, (80,) * 20)
    seen = rig.sense(rig.teleop(6) * (0.2, 0.2, 0.15, 0.3, 0.3, 0.6), 0.002)
    for i, name in enumerate(XYZ + RPY):
        step = np.concatenate([np.append(np.diff(s[:, i]), 0) for s in rig.split(seen)])
        rig.column(f"{name}.pos", seen[:, i])
        rig.dim(name, step, Claim("step", f"{name}.pos", 1.0, (1, 1)), level=PLAIN)
    return rig.build()


@robot
def operational_space_steps_scaled_to_one():
    """Steps within [-1, 1], one of them 5 cm or half a radian, of which the controller makes most; two fingers."""
    rig = Rig(47, 20, (250,) * 12)
    path = rig.teleop(6, 0.5) * (0.2, 0.2, 0.15, 0.4, 0.4, 0.8)
    response = rig.track(path, gain=0.6)
    rig.joints(XYZ, path[:, :3], response[:, :3], kind="step", factor=1 / 0.05, noise=0.0002)
    for i, name in enumerate(XYZ):  # 5 cm in a twentieth of a second is a metre per second
        rig.also(name, Claim("velocity", f"{name}.pos", 1.0, rig.lags(path[:, i], response[:, i])))
    rig.joints(RPY, path[:, 3:], response[:, 3:], kind="step", factor=1 / 0.5, noise=0.0005)
    closed = rig.switch(1.5)[:, None]
    finger = rig.track(0.04 * (1 - closed), rate=0.008)
    late = (1.0, 6.0)
    sent = 2 * closed[:, 0] - 1
    claims = [Claim("target", f"finger_{i}", s, late, None) for i, s in enumerate((-50.0, 50.0))]
    rig.column("finger_0", finger[:, 0])
    rig.column("finger_1", -finger[:, 0])
    rig.dim("gripper", sent, *claims, level=OPEN)
    return rig.build()


@robot
def steps_onto_a_target_that_runs_ahead():
    """Steps add up in the controller, and the arm is four frames behind the sum."""
    rig = Rig(48, 30, (250,) * 10)
    path = rig.teleop(6, 0.5) * 0.7
    response = rig.track(path, gain=0.5, dead=2)
    rig.joints(numbered("joint", 6), path, response, kind="step", noise=0.0003)
    return rig.build()


@robot
def steps_in_millimetres():
    rig = Rig(49, 30, (250,) * 10)
    path = rig.reach(3, 1.2) * (0.2, 0.3, 0.15)
    rig.joints(XYZ, path, rig.track(path, gain=0.8), kind="step", factor=[1000, -1000, 1000], noise=0.0002)
    return rig.build()


@robot
def steps_with_noisy_encoders():
    """The noise of the state is about as large as the step."""
    rig = Rig(50, 10, (200,) * 10)
    path = rig.teleop(4, 0.3) * 0.6
    noise = list(rig.change(path).std(axis=0))
    rig.joints(numbered("joint", 4), path, rig.track(path), kind="step", noise=noise, level=HARD)
    return rig.build()


@robot
def steps_in_coarse_ticks():
    """Encoder ticks of 0.088 degrees, and slow joints that go about one tick per frame."""
    rig = Rig(51, 60, (500,) * 6)
    path = rig.teleop(4, 0.2) * (60, 40, 20, 6)
    rig.joints(numbered("joint", 4), path, rig.track(path), kind="step", quantum=TICK, level=[PLAIN] * 2 + [HARD] * 2)
    return rig.build()


@robot
def targets_relative_to_now():
    """The action is how far the target is from the joint; the arm makes four tenths of it in each frame."""
    rig = Rig(52, 30, (250,) * 10)
    command = rig.teleop(5) * 0.7
    response = rig.track(command, gain=0.4)
    for i, name in enumerate(numbered("joint", 5)):
        rig.column(f"{name}.pos", rig.sense(response[:, i], 0.0002))
        claim = Claim("step", f"{name}.pos", 2.5, (1, 1))
        rig.dim(name, (command - response)[:, i], claim, level=PLAIN)
    return rig.build()


@robot
def steps_over_five_frames():
    """The action is how far the joint will have gone in five frames: five steps at once."""
    rig = Rig(53, 30, (250,) * 10)
    path = rig.teleop(5) * 0.7
    for i, name in enumerate(numbered("joint", 5)):
        far = [np.concatenate([p[5:, i], np.repeat(p[-1:, i], 5)]) - p[:, i] for p in rig.split(path)]
        rig.column(f"{name}.pos", path[:, i])
        rig.dim(name, np.concatenate(far), Claim("step", f"{name}.pos", 5.0, (2, 4)), level=OPEN)
    return rig.build()


@robot
def steps_in_the_frame_of_the_hand():
    """The hand turns about the vertical while it steps along its own axes: x and y of the world get a mixture."""
    rig = Rig(54, 20, (250,) * 10)
    steps = rig.change(rig.teleop(3) * (0.4, 0.4, 0.2))
    yaw = 2.5 * rig.teleop(1)[:, 0]
    world = steps[:, :2] @ np.eye(2)
    world[:, 0] = np.cos(yaw) * steps[:, 0] - np.sin(yaw) * steps[:, 1]
    world[:, 1] = np.sin(yaw) * steps[:, 0] + np.cos(yaw) * steps[:, 1]
    place = rig.delay(rig.integrate(np.column_stack([world, steps[:, 2]])), 1)
    for i, name in enumerate(XYZ):
        rig.column(name, place[:, i])
    rig.column("yaw", rig.delay(yaw, 1))
    rig.unrelated("forward", steps[:, 0])
    rig.unrelated("sideways", steps[:, 1])
    rig.dim("up", steps[:, 2], Claim("step", "z", 1.0, (1, 1)), level=PLAIN)
    rig.dim("turn", rig.change(yaw), Claim("step", "yaw", 1.0, (1, 1)), level=PLAIN)
    return rig.build()


# Velocities.


@robot
def joint_velocities_in_radians_per_second():
    rig = Rig(55, 125, (800,) * 5)
    path = rig.teleop(6, 0.5) * 0.8
    rig.joints(numbered("joint", 6), path, rig.track(path, gain=0.5), kind="velocity", noise=0.00005)
    return rig.build()


@robot
def droid_like():
    """Joint velocities normalised to [-1, 1] by an odd scale, at 15 frames per second, and a gripper from 0 to 1."""
    rig = Rig(56, 15, (150,) * 16)
    path = rig.teleop(7) * 0.7
    rig.joints(numbered("joint", 7), path, rig.track(path, gain=0.7), kind="velocity", factor=1 / 2.61, noise=0.0008)
    wanted = rig.track(rig.switch()[:, None], gain=0.6)
    grip = rig.track(wanted, rate=0.12)
    rig.joints(("gripper",), wanted, grip, level=HARD, ahead=(1, 6))
    return rig.build()


@robot
def joystick_velocities():
    """A spacemouse with a dead zone, scaled by an odd number, flipped axes, and a button that does nothing."""
    rig = Rig(57, 20, (250,) * 10)
    stick = rig.teleop(3, 0.5)
    stick = np.where(np.abs(stick) < 0.15, 0, stick)
    path = rig.delay(rig.integrate(0.45 * stick / 20), 1)
    for i, (name, sign) in enumerate(zip(XYZ, (1, -1, -1), strict=True)):
        rig.column(f"{name}.pos", rig.sense(sign * path[:, i], 0.0005))
        rig.dim(name, stick[:, i], Claim("velocity", f"{name}.pos", sign / 0.45, (1, 1)), level=PLAIN)
    rig.unrelated("button", rig.switch())
    return rig.build()


@robot
def velocities_with_velocities_in_the_state():
    """The state has the speed as well as the place: the action is the target of one, and the velocity of the other."""
    rig = Rig(58, 50, (300,) * 8)
    path = rig.teleop(6, 0.5) * 0.8
    response = rig.track(path, gain=0.4)
    names = numbered("joint", 6)
    rig.joints(names, path, response, kind="velocity", noise=0.0001)
    rig.extras(names, response)
    for i, name in enumerate(names):
        rig.also(name, Claim("target", f"{name}.vel", 1.0, rig.lags(path[:, i], response[:, i])))
    return rig.build()


@robot
def velocities_in_degrees_of_a_slow_drive():
    """Degrees per second against radians, and a drive that takes five frames to get up to speed."""
    rig = Rig(59, 50, (400,) * 8)
    path = rig.teleop(4, 0.5) * 0.8
    rig.joints(numbered("joint", 4), path, rig.track(path, gain=0.2), kind="velocity", factor=DEGREES, noise=0.0002)
    return rig.build()


@robot
def velocities_at_two_hundred_frames_per_second():
    """So many frames that the motion in one of them drowns in the noise."""
    rig = Rig(60, 200, (1500,) * 4)
    path = rig.teleop(3, 0.5) * 0.8
    rig.joints(numbered("joint", 3), path, rig.track(path, gain=0.5), kind="velocity", noise=0.004, level=HARD)
    return rig.build()


@robot
def lekiwi():
    """An arm with targets on a base with velocities, of which the state has the measured ones and no place."""
    rig = Rig(61, 30, (250,) * 8)
    command = rig.teleop(6) * 45
    names = (*SO100, "gripper")
    rig.joints(names, command, rig.track(command, gain=0.5), quantum=TICK)
    drive = np.round(2 * rig.teleop(3)) * (0.1, 0.1, 30)
    moved = rig.track(drive, gain=0.4)
    noise = list(0.03 * drive.std(axis=0))
    rig.joints(("base_x", "base_y", "base_turn"), drive, moved, noise=noise, suffix=".vel", level=HARD)
    return rig.build()


def drive_about(seed: int, turning: float) -> tuple[Rig, np.ndarray, np.ndarray, np.ndarray]:
    """A base on two wheels: how fast it is told to go and turn, and where it is."""
    rig = Rig(seed, 20, (400,) * 8)
    speed = np.clip(0.4 + 0.5 * rig.teleop(1)[:, 0], 0, 1)
    turn = turning * rig.teleop(1)[:, 0]
    yaw = rig.delay(rig.integrate(rig.delay(turn, 1) / 20), 1)
    way = rig.delay(speed, 1)[:, None] * np.stack([np.cos(yaw), np.sin(yaw)], axis=1) / 20
    return rig, np.stack([speed, turn], axis=1), rig.integrate(way), yaw


@robot
def base_on_two_wheels():
    """Forward is along no axis of the world for long; the yaw is wrapped."""
    rig, sent, place, yaw = drive_about(62, 1.6)
    rig.column("x", rig.sense(place[:, 0], 0.002))
    rig.column("y", rig.sense(place[:, 1], 0.002))
    rig.column("yaw", wrap(rig.sense(yaw, 0.002), 2 * np.pi))
    rig.unrelated("forward", sent[:, 0])
    rig.dim("turn", sent[:, 1], Claim("velocity", "yaw", 1.0, (2, 2)), level=HARD)
    return rig.build()


@robot
def base_that_goes_mostly_straight():
    """Forward is nearly along x all the time."""
    rig, sent, place, yaw = drive_about(63, 0.1)
    rig.column("x", rig.sense(place[:, 0], 0.001))
    rig.column("y", rig.sense(place[:, 1], 0.001))
    rig.column("yaw", rig.sense(yaw, 0.0005))
    rig.dim("forward", sent[:, 0], Claim("velocity", "x", 1.0, (1, 2)), level=HARD)
    rig.dim("turn", sent[:, 1], Claim("velocity", "yaw", 1.0, (2, 2)), level=HARD)
    return rig.build()


@robot
def drone():
    """Velocity setpoints followed like a second-order system; speeds and attitude are in the state."""
    rig = Rig(64, 30, (400,) * 8)
    path = rig.integrate(1.5 * rig.teleop(3, 0.3) / 30)
    response = rig.servo(path, 1.2, 0.9)
    rig.joints(XYZ, path, response, kind="velocity", noise=0.001)
    speed = rig.change(response) * 30
    for i, name in enumerate(XYZ):
        rig.column(f"{name}.vel", rig.sense(speed[:, i], 0.01))
        rig.also(name, Claim("target", f"{name}.vel", 1.0, rig.lags(path[:, i], response[:, i])))
    lean = rig.change(speed) * 30 / 9.81
    rig.column("pitch", rig.sense(lean[:, 0], 0.01))
    rig.column("roll", rig.sense(-lean[:, 1], 0.01))
    return rig.build()


# Neither.


@robot
def nothing_but_unrelated_dimensions():
    """Beside an arm of which the action tells nothing: walks, waves, buttons, constants, a clock."""
    rig = Rig(65, 30, (200,) * 10)
    path = rig.teleop(6) * 0.8
    for i in range(6):
        rig.column(f"joint_{i}", rig.sense(path[:, i], 0.001))
    rig.unrelated("walk_0", rig.walk(1)[:, 0])
    rig.unrelated("walk_1", 40 * rig.walk(1)[:, 0])
    rig.unrelated("smooth", rig.teleop(1)[:, 0])
    rig.unrelated("smooth_slow", rig.teleop(1, 0.1)[:, 0])
    rig.unrelated("wave", np.sin(2 * np.pi * 0.5 * rig.clock()))
    rig.unrelated("button", rig.switch())
    rig.unrelated("rare_button", rig.switch(30))
    rig.unrelated("clock", rig.clock())
    rig.unrelated("constant", np.full(len(rig.stretch), 0.3))
    rig.unrelated("zero", np.zeros(len(rig.stretch)))
    rig.unrelated("episode", rig.stretch.astype(float))
    rig.unrelated("noise", rig.rng.normal(size=len(rig.stretch)))
    return rig.build()


@robot
def unrelated_in_a_single_short_episode():
    """Eighty frames of smooth things: with so few of them, something always looks like something."""
    rig = Rig(66, 30, (80,))
    path = rig.teleop(8)
    other = rig.teleop(6)
    for i in range(8):
        rig.column(f"joint_{i}", path[:, i])
    for i in range(6):
        rig.unrelated(f"action_{i}", other[:, i])
    return rig.build()


@robot
def unrelated_in_two_slow_episodes():
    """Slow drifts on both sides: spurious correlation at its best."""
    rig = Rig(67, 30, (300, 300))
    path, other = rig.teleop(8, 0.05), rig.teleop(6, 0.05)
    for i in range(8):
        rig.column(f"joint_{i}", rig.sense(path[:, i], 0.0005))
    for i in range(6):
        rig.unrelated(f"action_{i}", other[:, i])
    return rig.build()


@robot
def arm_with_unrelated_dimensions():
    """Three joints that mean something among dimensions that do not, and a wave in action and state at one beat."""
    rig = Rig(68, 30, (250,) * 8)
    command = rig.teleop(3) * 0.8
    rig.joints(numbered("joint", 3), command, rig.track(command, gain=0.5), noise=0.001)
    rig.column("wave_seen", np.sin(2 * np.pi * 0.31 * rig.clock()))
    rig.column("battery", 12 - 0.001 * np.arange(len(rig.stretch)))
    rig.unrelated("wave_sent", np.sin(2 * np.pi * 0.37 * rig.clock() + 0.5))
    rig.unrelated("terminate", rig.each(lambda n: (np.arange(n) >= n - 5).astype(float)))
    rig.unrelated("mode", np.ones(len(rig.stretch)))
    return rig.build()


@robot
def torques():
    """Torques on light, free joints: they set the acceleration, neither the place nor the speed."""
    rig = Rig(69, 100, (600,) * 6)
    path = rig.teleop(4, 0.5) * 0.8
    push = rig.change(rig.change(path)) * 100**2
    for i in range(4):
        rig.column(f"joint_{i}", rig.sense(rig.delay(path, 1)[:, i], 0.0001))
        rig.unrelated(f"torque_{i}", push[:, i])
    return rig.build()


@robot
def legs_that_trot():
    """Twelve position targets of a policy, as offsets over a scale of 0.25, jittering; diagonal legs move alike."""
    rig = Rig(70, 50, (400,) * 6)
    clock = rig.clock()[:, None]
    phase = np.repeat([0, np.pi, np.pi, 0], 3) + np.tile([0, 0.7, 1.9], 4)
    command = np.tile([0.05, 0.25, 0.35], 4) * np.sin(2 * np.pi * 2 * clock + phase) + 0.05 * rig.teleop(12, 1.0)
    response = rig.servo(command, 5.0, 0.7) - 0.03
    rig.joints(numbered("leg", 12), command, response, factor=4, level=OPEN, noise=0.002, action_noise=0.02)
    return rig.build()


@robot
def identical_waves():
    """A demonstration script sends one and the same sine to all joints."""
    rig = Rig(71, 30, (300,) * 4)
    command = np.sin(2 * np.pi * 0.5 * rig.clock())[:, None] * np.ones(6) * 40
    rig.joints(numbered("joint", 6), command, rig.track(command, gain=0.5), quantum=TICK, level=OPEN)
    return rig.build()


@robot
def waves_out_of_step():
    """One beat, another phase for each joint: a joint later is another joint."""
    rig = Rig(72, 30, (300,) * 4)
    command = np.sin(2 * np.pi * 0.5 * rig.clock()[:, None] + np.linspace(0, 2, 6)) * 40
    rig.joints(numbered("joint", 6), command, rig.track(command, gain=0.5), noise=0.05, level=OPEN)
    return rig.build()


@robot
def waves_of_different_beats():
    """A frequency for each joint."""
    rig = Rig(73, 30, (300,) * 4)
    command = np.sin(2 * np.pi * np.linspace(0.2, 0.9, 5) * rig.clock()[:, None]) * 40
    rig.joints(numbered("joint", 5), command, rig.track(command, gain=0.5), noise=0.05, level=HARD)
    return rig.build()


# Grippers.


@robot
def parallel_gripper_the_other_way_round():
    """Sent as how far it is closed, from 0 to 1; read as how wide it is, in metres."""
    rig = Rig(74, 30, (250,) * 10)
    width = 0.04 + 0.04 * np.clip(rig.teleop(1, 0.6), -1, 1)
    rig.joints(("gripper",), width, rig.track(width, gain=0.5), factor=-12.5, offset=1.0, noise=0.0002)
    hand = rig.reach(3) * 0.2
    rig.joints(XYZ, hand, rig.track(hand, gain=0.5), noise=0.0005)
    return rig.build()


@robot
def binary_grippers():
    """Open and close, 0 and 1: one gripper that is free, one that grasps, one whose state is the command."""
    rig = Rig(75, 30, (300,) * 12)
    for name, rate, stop in (("free", 0.01, 0.0), ("grasping", 0.01, 0.035), ("echoed", np.inf, 0.0)):
        closed = rig.switch()[:, None]
        wanted = 0.08 * (1 - closed)
        width = np.maximum(rig.track(wanted, rate=rate), stop)
        within = None if stop else FACTOR_WITHIN
        level = OPEN if stop else HARD
        late = (1.0, 1.0) if name == "echoed" else (1.0, 9.0)
        rig.joints((name,), wanted, width, factor=-12.5, offset=1.0, ahead=late, within=within, level=level)
    return rig.build()


@robot
def gripper_velocity_that_runs_into_its_stops():
    """The trigger opens and closes at a speed; the jaw runs into its stops and stays."""
    rig = Rig(76, 20, (250,) * 10)
    trigger = np.clip(np.round(2 * rig.teleop(1, 0.4)), -1, 1)

    def jaw(sent):
        width = np.empty_like(sent)
        width[0] = 0.04
        for t in range(len(sent) - 1):
            width[t + 1] = np.clip(width[t] + 0.003 * sent[t], 0, 0.08)
        return width

    rig.column("gripper", np.concatenate([jaw(s) for s in rig.split(trigger)])[:, 0])
    rig.dim("gripper", trigger[:, 0], Claim("step", "gripper", 1 / 0.003, (1, 1)), level=OPEN)
    rig.also("gripper", Claim("velocity", "gripper", 1 / 0.06, (1, 1)))
    hand = rig.reach(2) * 0.2
    rig.joints(("x", "y"), hand, rig.track(hand, gain=0.5), noise=0.0005)
    return rig.build()


# Noise, and little or much data.


@robot
def encoders_with_moderate_noise():
    """Two degrees of noise on moves of fifty."""
    rig = Rig(77, 30, (250,) * 8)
    command = rig.teleop(6) * 50
    rig.joints(numbered("joint", 6), command, rig.track(command, gain=0.5, dead=1), noise=2.0)
    return rig.build()


@robot
def encoders_with_large_noise():
    """The noise is half as large as the motion."""
    rig = Rig(78, 30, (250,) * 8)
    command = rig.teleop(6) * 50
    rig.joints(numbered("joint", 6), command, rig.track(command, gain=0.5, dead=1), noise=12.0, level=OPEN)
    return rig.build()


@robot
def leader_with_noise():
    """A cheap leader: the noise is in the action, of which the follower makes a smooth path."""
    rig = Rig(79, 30, (250,) * 8)
    command = rig.teleop(6) * 50
    response = rig.track(command, gain=0.5)
    rig.joints(numbered("joint", 6), command, response, action_noise=1.5, quantum=TICK)
    return rig.build()


@robot
def simulator_without_noise():
    """The target is reached in the next frame, exactly, in float64."""
    rig = Rig(80, 50, (200,) * 6)
    command = rig.reach(7)
    rig.joints(numbered("joint", 7), command, rig.track(command))
    return rig.build(float32=False)


@robot
def one_episode_of_eight_frames():
    rig = Rig(81, 30, (8,))
    command = rig.teleop(6)
    rig.joints(numbered("joint", 6), command, rig.track(command, gain=0.5), noise=0.001, level=OPEN, ahead=(1, 3))
    return rig.build()


@robot
def many_episodes_of_six_frames():
    rig = Rig(82, 10, (6,) * 40)
    command = rig.teleop(4) * 0.8
    rig.joints(numbered("joint", 4), command, rig.track(command), noise=0.001, level=OPEN)
    return rig.build()


@robot
def one_short_demonstration():
    """Four seconds, one episode."""
    rig = Rig(83, 30, (120,))
    command = rig.teleop(6, 0.6) * 50
    rig.joints(numbered("joint", 6), command, rig.track(command, gain=0.5), quantum=TICK, level=HARD)
    return rig.build()


@robot
def one_very_long_episode():
    rig = Rig(84, 30, (20000,))
    command = rig.teleop(3) * 50
    rig.joints(numbered("joint", 3), command, rig.track(command, gain=0.5, dead=1), quantum=TICK)
    return rig.build()


@robot
def five_frames_per_second():
    """The arm is where it was sent before the next frame."""
    rig = Rig(85, 5, (60,) * 15)
    command = rig.teleop(6, 0.3) * 0.8
    rig.joints(numbered("joint", 6), command, rig.track(command), noise=0.002)
    return rig.build()


@robot
def two_hundred_frames_per_second():
    rig = Rig(86, 200, (1500,) * 4)
    command = rig.teleop(6, 0.5) * 0.8
    rig.joints(numbered("joint", 6), command, rig.track(command, gain=0.3, dead=3), noise=0.0003)
    return rig.build()


@robot
def everything_mixed():
    """One robot with a target, a step and a velocity, in another order than its state."""
    rig = Rig(87, 30, (250,) * 10)
    path = rig.teleop(3) * 0.8
    late = rig.track(path, gain=0.6)
    for i, kind in enumerate(("target", "step", "velocity")):
        rig.joints((kind,), path[:, i : i + 1], late[:, i : i + 1], kind=kind, noise=0.0002)
    rig.unrelated("walk", rig.walk(1)[:, 0])
    rig.column("free", rig.teleop(1)[:, 0])
    return rig.build(columns=(3, 2, 0, 1))
