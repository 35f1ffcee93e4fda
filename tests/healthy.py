"""Shapes of datasets that are as they should be, odd as some of them look: of none may a finding say that it is wrong.

`HEALTHY` is one table of what is recorded, `FILMED` one of what cameras see, and `EDITED` one of what LeRobot's own
tools make of a recording. A shape is here because something that looks for faults could take it for one.
"""

import json
import shutil
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any

import arm_cameras as cameras
import numpy as np
from arm_damages import Place
from arms import (
    ACTION,
    CUBE,
    CUP,
    POS,
    REST,
    ROBOTS,
    STATE,
    TASK,
    TICK,
    VIPER,
    Operator,
    Plant,
    Recording,
    Task,
    aloha,
    demonstrate,
    episode,
    follow,
    in_space,
    lead,
    lekiwi,
    make,
    one_joint,
    respond,
    smooth,
    so101,
    ticks,
    write,
)
from layouts import Frames

PUSH = Task("Push the plate to the edge", (-30, 30), (40, 0.2, -0.02), (0, 0), (0, 0))
LEFT_BOX, RIGHT_BOX = (
    Task(f"Put the cube into the {side} box", put=(pan, 0.19, 0.06)) for side, pan in (("left", -55), ("right", 55))
)
MANY = [Task(f"Put the cube on place {number}", put=(15 * number - 40, 0.2, 0.01)) for number in range(6)]


@dataclass(frozen=True)
class Shape:
    """A healthy shape: why it is as it is, and what makes it."""

    story: str
    make: Callable[[int], Recording]


type Change = Callable[[Frames, np.random.Generator], Frames]
type Value = Callable[[Frames, np.random.Generator], Any]


def write_healthy(name: str, root: Path, seed: int = 0) -> None:
    """Write the dataset of a shape."""
    if name in EDITED:
        what, edit = EDITED[name]
        edited(edit, what, root, seed)
    elif name in FILMED:
        FILMED[name](root, seed)
    else:
        write(HEALTHY[name].make(seed), root)


# --- what is recorded


def paced(
    seed: int,
    operators: Sequence[Operator],
    tasks: Sequence[Task] = (CUBE, CUP),
) -> Recording:
    """An SO-101 that each episode is led by the operator whose turn it is."""
    rng = np.random.default_rng([seed, 5])
    episodes = []
    for number in range(12):
        which = number // len(operators) % len(tasks)
        state, action = demonstrate(rng, 30, tasks[which], operators[number % len(operators)], Plant())
        episodes.append(episode(state, action, which))
    return Recording("so101_follower", 30, {STATE: POS, ACTION: POS}, episodes, [task.text for task in tasks])


def changed(recording: Recording, change: Change, episodes: Sequence[int] = ()) -> Recording:
    """Replace what `change` returns, in some of the episodes, or in all where none is named."""
    for number in episodes or range(len(recording.episodes)):
        recording.episodes[number] |= change(recording.episodes[number], np.random.default_rng(number))
    return recording


def column(own: Frames, place: int, action: Any, state: Any) -> Frames:
    """An episode with other values in one column of both."""
    new = {STATE: own[STATE].copy(), ACTION: own[ACTION].copy()}
    new[STATE][:, place], new[ACTION][:, place] = state, action
    return new


def with_feature(name: str, value: Value, names: Any = None) -> Callable[[int], Recording]:
    """An SO-101 that stores one more thing."""

    def of(seed: int) -> Recording:
        recording = changed(so101(seed), lambda own, rng: {name: value(own, rng)})
        return replace(recording, names=recording.names | {name: names})

    return of


def with_columns(names: Sequence[str], value: Value, feature: str = STATE) -> Callable[[int], Recording]:
    """An SO-101 whose state, or action, has more columns."""

    def of(seed: int) -> Recording:
        recording = changed(
            so101(seed), lambda own, rng: {feature: np.concatenate([own[feature], value(own, rng)], axis=1)}
        )
        return replace(recording, names=recording.names | {feature: (*POS, *names)})

    return of


def humanoid(seed: int) -> Recording:
    """34 joints in rad, each led on a smooth path of its own, eight of them hardly at all."""
    rng = np.random.default_rng([seed, 34])
    names = tuple(f"joint_{number:02d}" for number in range(34))
    size = np.where(np.arange(34) % 4 == 3, 0.004, rng.uniform(0.1, 0.6, 34))
    centre = rng.uniform(-0.8, 0.8, 34)
    episodes = []
    for _ in range(10):
        n = int(rng.integers(150, 400))
        command = centre + size * smooth(rng, n, 34, 50, seconds=1.5)
        state = ticks(follow(command, 2 + rng.uniform(-0.3, 0.3)), 2 * np.pi / 65536, rng, 2)
        episodes.append(episode(state, command))
    return Recording("unitree_g1", 50, {STATE: names, ACTION: names}, episodes, ["Walk to the shelf"])


def idle_arm(seed: int) -> Recording:
    """Two arms, of which the right one rests through every other episode: its task does not need it."""
    recording = aloha(seed)
    recording.tasks.append("Turn the cup with the left hand")
    right = slice(len(VIPER), 2 * len(VIPER))
    for number, own in enumerate(recording.episodes):
        if number % 2:
            own[TASK] = own[TASK] + 1
            rng = np.random.default_rng(number)
            own[ACTION][:, right] = own[ACTION][0, right]
            flicker = np.round(rng.normal(0, 0.4, (len(own[TASK]), 6))) * np.radians(TICK)
            own[STATE][:, right] = own[STATE][0, right]
            own[STATE][:, 7:13] += flicker
    return recording


def wheels_at_rest(episodes: Callable[[int], bool]) -> Callable[[int], Recording]:
    def of(seed: int) -> Recording:
        recording = lekiwi(seed)
        for number, own in enumerate(recording.episodes):
            if episodes(number):
                own[ACTION][:, 6:] = 0
                own[STATE][:, 6:] = np.random.default_rng(number).normal(0, [0.003, 0.003, 0.7], (len(own[TASK]), 3))
        return recording

    return of


def still(
    name: str, value: float | None, flicker: float = 0.35, which: Sequence[int] = ()
) -> Callable[[int], Recording]:
    """A joint that stands at a value in state and action, in some of the episodes; its encoder flickers."""
    place = POS.index(name)

    def change(own: Frames, rng: np.random.Generator) -> Frames:
        at = own[ACTION][0, place] if value is None else value
        return column(own, place, at, at + TICK * np.round(rng.normal(0, flicker, len(own[TASK]))))

    return lambda seed: changed(so101(seed), change, which)


def relative(own: Frames, rng: np.random.Generator) -> Frames:
    return {ACTION: own[ACTION] - own[STATE]}


def step(own: Frames, rng: np.random.Generator) -> Frames:
    return {ACTION: np.diff(own[ACTION], axis=0, append=own[ACTION][-1:])}


def next_state(own: Frames, rng: np.random.Generator) -> Frames:
    return {ACTION: np.concatenate([own[STATE][1:], own[STATE][-1:]])}


def half_rate(own: Frames, rng: np.random.Generator) -> Frames:
    return {ACTION: own[ACTION][np.arange(len(own[TASK])) // 2 * 2]}


def binary(own: Frames, rng: np.random.Generator) -> Frames:
    """The gripper is told 0 or 1, and takes its time."""
    told = (own[ACTION][:, 5] > 40).astype(float)
    held = np.where(told > 0, 0, np.minimum(own[STATE][:, 5], 30) / 100)
    return column(own, 5, told, np.maximum(follow(told[:, None], 9)[:, 0], held))


def by_keys(own: Frames, rng: np.random.Generator) -> Frames:
    """Keys open and close the gripper: -1, 0 or 1 a frame."""
    speed = np.gradient(own[ACTION][:, 5])
    return column(own, 5, np.where(np.abs(speed) > 1, np.sign(speed), 0), own[STATE][:, 5])


def pushed(own: Frames, rng: np.random.Generator) -> Frames:
    """While the arm holds its place somebody pushes it: it gives way by a few degrees, and comes back."""
    held = np.repeat([own[ACTION][-1]], 75, axis=0)
    way = np.sin(np.linspace(0, np.pi, 75))[:, None] * rng.uniform(-6, 6, 6) * [1, 1, 1, 0.5, 0.3, 0]
    state = own[STATE][-1] + TICK * np.round(way / TICK + rng.normal(0, 0.35, (75, 6)))
    return episode(np.concatenate([own[STATE], state]), np.concatenate([own[ACTION], held]), own[TASK][0])


def pressed(own: Frames, rng: np.random.Generator) -> Frames:
    """The hand presses on the table: the shoulder cannot follow its command any further."""
    deepest = np.percentile(own[STATE][:, 1], 97)
    command = own[ACTION][:, 1] + 6 * smooth_step(own[ACTION][:, 1] - deepest)
    return column(own, 1, command, np.minimum(own[STATE][:, 1], np.round(deepest / TICK) * TICK))


def smooth_step(values: np.ndarray) -> np.ndarray:
    share = np.clip(values / 3, 0, 1)
    return share * share * (3 - 2 * share)


def turning(own: Frames, rng: np.random.Generator) -> Frames:
    """A wrist that turns round and round; angles are in -180 to 180, in state and action."""
    pace = rng.choice([-1, 1]) * np.clip(1.5 + smooth(rng, len(own[TASK]), 1, 30)[:, 0], 0, 5)
    command = rng.uniform(-180, 180) + np.cumsum(pace)
    both = (command, follow(command[:, None], 4.5)[:, 0])
    return column(own, 4, *(ticks((turn + 180) % 360 - 180, TICK, rng) for turn in both))


def without(name: str, feature: str) -> Callable[[int], Recording]:
    place = POS.index(name)

    def of(seed: int) -> Recording:
        recording = changed(so101(seed), lambda own, rng: {feature: np.delete(own[feature], place, axis=1)})
        return replace(recording, names=recording.names | {feature: tuple(other for other in POS if other != name)})

    return of


def cut(first: tuple[float, float], last: tuple[float, float]) -> Change:
    """Keep what lies between two shares of an episode."""

    def change(own: Frames, rng: np.random.Generator) -> Frames:
        n = len(own[TASK])
        rows = slice(int(n * rng.uniform(*first)), int(n * rng.uniform(*last)))
        return {name: values[rows] for name, values in own.items()}

    return change


def a_few_frames(own: Frames, rng: np.random.Generator) -> Frames:
    first, n = rng.integers([20, 5], [60, 10])
    return {name: values[first : first + n] for name, values in own.items()}


def another_home(own: Frames, rng: np.random.Generator) -> Frames:
    return {name: own[name] + [12, 3, -5, 4, -9, 0] for name in (STATE, ACTION)}


def limited(own: Frames, rng: np.random.Generator) -> Frames:
    """Commands are clipped to limits before they are sent, and stored as sent."""
    command = np.clip(own[ACTION], [-40, -90, -40, 40, -70, 3], [35, 40, 90, 95, 70, 70])
    state = ticks(follow(command, 4.5), TICK, rng, 0.35)
    state[:, 5] = np.minimum(own[STATE][:, 5], 70)
    return {ACTION: command, STATE: state}


def ideal(own: Frames, rng: np.random.Generator) -> Frames:
    """The arm of a simulator: each episode begins in the very same pose."""
    command = own[ACTION] + (np.array(REST) - own[ACTION][0]) * np.exp(-np.arange(len(own[TASK])) / 10)[:, None]
    return {ACTION: command, STATE: follow(command, 2)}


def policy(seed: int) -> Recording:
    """A policy acts in chunks of 20: its commands leap a little from one to the next, and the arm follows."""
    rng = np.random.default_rng([seed, 20])
    episodes = []
    for number in range(12):
        command, held = lead(rng, 30, (CUBE, CUP)[number % 2], Operator())
        leaps = np.repeat(rng.normal(0, 1.2, (len(command) // 20 + 1, 6)), 20, axis=0)[: len(command)]
        episodes.append(episode(*respond(rng, command + leaps, held, Plant()), number % 2))
    return replace(so101(seed), episodes=episodes)


def catching_up(own: Frames, rng: np.random.Generator) -> Frames:
    """The leader was elsewhere when the recorder began: the follower goes there within the first second."""
    away = rng.choice([-1, 1], 6) * rng.uniform(8, 25, 6) * [1, 0.6, 1, 1, 1, 0]
    return {STATE: own[STATE] + np.round(away * np.exp(-np.arange(len(own[TASK])) / 7)[:, None] / TICK) * TICK}


def setpoints(own: Frames, rng: np.random.Generator) -> Frames:
    """The command is where the arm has to be in the end, and leaps; the arm takes a second or so to come there."""
    command = own[ACTION][np.minimum(np.arange(len(own[TASK])) // 45 * 45 + 44, len(own[TASK]) - 1)]
    state = ticks(follow(np.concatenate([own[STATE][:1], command[:-1]]), 12, share=0.1), TICK, rng, 0.35)
    return {ACTION: command, STATE: state}


def scaled(own: Frames, rng: np.random.Generator) -> Frames:
    """Commands are -1 to 1 of what a joint may do; the state is in degrees and percent."""
    low, high = np.array([-110, -105, -100, -100, -170, 0]), np.array([110, 105, 100, 120, 170, 100])
    return {ACTION: (own[ACTION] - low) / (high - low) * 2 - 1}


def fingers(own: Frames, rng: np.random.Generator) -> Frames:
    """The gripper's command is -1 to open and 1 to shut; its state is how far its fingers are apart [m]."""
    return column(own, 5, np.where(own[ACTION][:, 5] > 40, -1.0, 1.0), own[STATE][:, 5] * 8e-4)


def renamed(state: str, action: str) -> Callable[[int], Recording]:
    """The same under other names of features."""
    other = {STATE: state, ACTION: action, TASK: TASK}

    def of(seed: int) -> Recording:
        recording = so101(seed)
        episodes = [{other[name]: values for name, values in own.items()} for own in recording.episodes]
        return replace(recording, episodes=episodes, names={other[name]: POS for name in recording.names})

    return of


def lacking(feature: str) -> Callable[[int], Recording]:
    def of(seed: int) -> Recording:
        recording = so101(seed)
        episodes = [{name: values for name, values in own.items() if name != feature} for own in recording.episodes]
        return replace(recording, episodes=episodes)

    return of


def in_a_dict(root: Path) -> None:
    """Names as some recorders give them."""
    path = root / "meta/info.json"
    info = json.loads(path.read_text())
    for name in (STATE, ACTION):
        info["features"][name]["names"] = {"motors": info["features"][name]["names"]}
    path.write_text(json.dumps(info))


def with_episode(number: int, operator: Operator) -> Callable[[int], Recording]:
    """One episode is led by another operator."""

    def of(seed: int) -> Recording:
        recording, rng = so101(seed), np.random.default_rng([seed, 77])
        recording.episodes[number] = episode(*demonstrate(rng, 30, CUBE, operator, Plant()))
        return recording

    return of


def many_short(seed: int) -> Recording:
    """Episodes of a second."""
    whole = so101(seed, n=16).episodes
    parts = [(own, range(start, start + 30)) for start in range(30, 190, 30) for own in whole]
    episodes = [{name: values[rows] for name, values in own.items()} for own, rows in parts]
    return replace(so101(seed), episodes=episodes, files=5)


def first(n: int, **how: Any) -> Callable[[int], Recording]:
    return lambda seed: replace(so101(seed, n=n, **how), files=1)


def lagging(lag: float) -> Callable[[int], Recording]:
    return lambda seed: so101(seed, plant=Plant(lag=lag, jitter=min(0.4, lag / 4)))


def matrix(own: Frames, rng: np.random.Generator) -> np.ndarray:
    """Where the gripper is, as a matrix, (n, 4, 4)."""
    place = in_space(own[STATE], rng, 0)[:, :3]
    pan = np.radians(own[STATE][:, 0])
    out = np.tile(np.eye(4), (len(place), 1, 1))
    out[:, 0, 0], out[:, 0, 1], out[:, 1, 0], out[:, 1, 1] = np.cos(pan), -np.sin(pan), np.sin(pan), np.cos(pan)
    out[:, :3, 3] = place
    return out


def velocities(own: Frames, rng: np.random.Generator) -> np.ndarray:
    return np.gradient(own[STATE], axis=0) * 30


def goal(own: Frames, rng: np.random.Generator) -> np.ndarray:
    """What stays the same through an episode: where the thing is to go, and which one it is."""
    return np.tile([rng.uniform(-0.2, 0.2), rng.uniform(-0.2, 0.2), float(rng.integers(3))], (len(own[TASK]), 1))


def one_hot(own: Frames, rng: np.random.Generator) -> np.ndarray:
    return np.eye(2)[own[TASK]]


def terminate(own: Frames, rng: np.random.Generator) -> np.ndarray:
    return (np.arange(len(own[TASK])) == len(own[TASK]) - 1).astype(float)[:, None]


def currents(own: Frames, rng: np.random.Generator) -> np.ndarray:
    """Of the motors [mA]: what pulls, and noise; in steps of 6.5."""
    pull = 60 * np.abs(own[ACTION] - own[STATE]) + rng.exponential(20, own[STATE].shape)
    return np.round(pull.clip(0, 1200) / 6.5) * 6.5


def nameless(seed: int) -> Recording:
    return replace(so101(seed), names={STATE: None, ACTION: None})


def with_info(**info: Any) -> Callable[[int], Recording]:
    return lambda seed: replace(so101(seed), info=info)


HEALTHY: dict[str, Shape] = {
    **{name: Shape(f"the robot {name} of `arms.py`", lambda seed, name=name: make(name, seed)) for name in ROBOTS},
    "fps-1": Shape("a motor that a greenhouse turns in minutes", lambda seed: replace(one_joint(seed), fps=1)),
    "fps-15": Shape("a slow loop", lambda seed: so101(seed, fps=15, plant=Plant(lag=2.3))),
    "fps-60": Shape("a fast loop", lambda seed: so101(seed, fps=60, plant=Plant(lag=9))),
    "fps-1000": Shape("a loop of a motor controller", lambda seed: one_joint(seed, 1000)),
    "34-joints": Shape("a humanoid", humanoid),
    "bool-column": Shape(
        "whether the gripper is shut", with_feature("observation.shut", lambda own, rng: own[STATE][:, 5] < 20)
    ),
    "text-column": Shape(
        "what the operator said",
        with_feature(
            "observation.note", lambda own, rng: np.array(["", "mind the cup"])[(np.arange(len(own[TASK])) > 50) * 1]
        ),
    ),
    "float64": Shape("numbers in float64", lambda seed: replace(so101(seed), dtype="float64")),
    "integers": Shape(
        "raw ticks as integers beside the angles",
        with_feature("observation.ticks", lambda own, rng: np.round(own[STATE] / TICK).astype(np.int64), list(POS)),
    ),
    "matrix": Shape("a pose as a matrix of 4 by 4", with_feature("observation.pose", matrix)),
    "no-names": Shape("columns have no names", nameless),
    "one-task": Shape("one task, one file", first(12, tasks=(CUBE,))),
    "six-tasks": Shape("six tasks, two episodes each", lambda seed: so101(seed, tasks=MANY)),
    "a-task-an-episode": Shape("each episode has a task of its own", lambda seed: so101(seed, n=6, tasks=MANY)),
    "a-file-an-episode": Shape("each episode has a file of its own", lambda seed: replace(so101(seed), files=12)),
    "one-episode": Shape("one episode", first(1)),
    "two-episodes": Shape("two episodes, of two tasks", first(2)),
    "short-episodes": Shape("episodes of 5 to 9 frames", lambda seed: changed(so101(seed), a_few_frames)),
    "many-episodes": Shape("many episodes of a second", many_short),
    "idle-joint": Shape("a joint that no task needs: its encoder flickers", still("wrist_roll.pos", None)),
    "idle-joint-exact": Shape(
        "a joint that no task needs, and whose encoder does not flicker", still("wrist_roll.pos", 0.0, 0)
    ),
    "idle-joint-in-a-task": Shape(
        "a joint that one of two tasks needs", still("wrist_roll.pos", 0.0, 0.35, range(0, 12, 2))
    ),
    "idle-joint-in-some": Shape(
        "a joint that some episodes do without", still("shoulder_pan.pos", None, 0.35, (3, 7, 8))
    ),
    "idle-arm": Shape("an arm that one of two tasks does without", idle_arm),
    "noisy": Shape("encoders that are ten times as noisy, all of them", lambda seed: so101(seed, plant=Plant(noise=4))),
    "unsteady": Shape("an unsteady hand leads", lambda seed: so101(seed, operator=Operator(wobble=1.6))),
    "tight": Shape("gears without play", lambda seed: so101(seed, plant=Plant(play=0))),
    "worn": Shape("gears with much play, all of them", lambda seed: so101(seed, plant=Plant(play=2))),
    "sagging": Shape("a weak arm that hangs below its command", lambda seed: so101(seed, plant=Plant(sag=4))),
    **{f"lag-{lag}": Shape(f"an arm that follows {lag} frames late", lagging(lag)) for lag in (0, 1, 2, 4, 8, 15)},
    "uneven-lag": Shape(
        "an arm whose lag differs by 3 frames from episode to episode",
        lambda seed: so101(seed, plant=Plant(lag=6, jitter=1.5)),
    ),
    "two-lags": Shape(
        "half of the episodes were recorded by another computer: a frame more of lag",
        lambda seed: replace(
            so101(seed), episodes=so101(seed).episodes[:6] + so101(seed, plant=Plant(lag=5.8)).episodes[6:]
        ),
    ),
    "gripper-open": Shape("a gripper that stays open: the task is to push", still("gripper.pos", 60.0)),
    "gripper-shut": Shape("a gripper that stays shut: the task is to point", still("gripper.pos", 1.0, 0)),
    "gripper-open-in-a-task": Shape(
        "a gripper that one of two tasks does without", still("gripper.pos", 60.0, 0.35, range(0, 12, 2))
    ),
    "gripper-shut-in-one": Shape("an episode in which nobody used the gripper", still("gripper.pos", 2.0, 0.35, (5,))),
    "thick-thing": Shape(
        "a thing so thick that the gripper never shuts", lambda seed: so101(seed, tasks=[replace(CUBE, width=(48, 55))])
    ),
    "base-at-rest": Shape("wheels that no task needs", wheels_at_rest(lambda number: True)),
    "base-in-a-task": Shape("wheels that one of two tasks needs", wheels_at_rest(lambda number: number % 2 == 0)),
    "relative-actions": Shape(
        "actions are relative to the state, in all episodes", lambda seed: changed(so101(seed), relative)
    ),
    "steps": Shape("actions are steps", lambda seed: changed(so101(seed, plant=Plant(lag=1, jitter=0)), step)),
    "next-state": Shape("actions are the next state, in all episodes", lambda seed: changed(so101(seed), next_state)),
    "binary-gripper": Shape("a gripper that is told 0 or 1", lambda seed: changed(so101(seed), binary)),
    "bang-bang-gripper": Shape("a gripper that keys open and close", lambda seed: changed(so101(seed), by_keys)),
    "pushed": Shape(
        "an arm that is pushed while its command stands", lambda seed: changed(so101(seed), pushed, (2, 5, 8, 9))
    ),
    "pressed": Shape("a contact that holds a joint away from its command", lambda seed: changed(so101(seed), pressed)),
    "limited": Shape(
        "commands that are clipped to limits before they are sent", lambda seed: changed(so101(seed), limited)
    ),
    "thinking": Shape("an operator who pauses for up to 4 s", lambda seed: paced(seed, [Operator(pause=4)])),
    "a-slow-task": Shape(
        "one of two tasks is led four times as slow",
        lambda seed: paced(seed, [Operator(speed=130)] * 2 + [Operator(speed=35)] * 2, (CUBE, CUP)),
    ),
    "one-long-episode": Shape(
        "an episode that is four times as long as the others", with_episode(6, Operator(30, 3, (2, 4), retry=1))
    ),
    "retry": Shape("an episode in which the grip missed, and was tried again", with_episode(4, Operator(retry=1))),
    "two-operators": Shape(
        "two operators, one twice as fast",
        lambda seed: paced(seed, [Operator(speed=70, pause=0.6), Operator(speed=140, pause=0.1)]),
    ),
    "turning": Shape("a joint that turns round and round", lambda seed: changed(so101(seed), turning)),
    "other-poses": Shape(
        "episodes that begin and end anywhere, in motion",
        lambda seed: changed(so101(seed), cut((0.1, 0.25), (0.8, 0.95))),
    ),
    "two-homes": Shape(
        "half of the episodes were recorded at another table",
        lambda seed: changed(so101(seed), another_home, range(6, 12)),
    ),
    "failures": Shape(
        "two demonstrations that were given up half way",
        lambda seed: changed(so101(seed), cut((0, 0), (0.45, 0.6)), (4, 9)),
    ),
    "left-and-right": Shape("two tasks that mirror each other", lambda seed: so101(seed, tasks=(LEFT_BOX, RIGHT_BOX))),
    "policy": Shape("rollouts of a policy that acts in chunks", policy),
    "held-commands": Shape("commands at half the rate of the frames", lambda seed: changed(so101(seed), half_rate)),
    "simulated": Shape(
        "a simulator: no noise, and one starting pose",
        lambda seed: changed(so101(seed, operator=Operator(wobble=0)), ideal),
    ),
    "with-velocities": Shape(
        "the state has velocities too", with_columns([f"{name[:-4]}.vel" for name in POS], velocities)
    ),
    "with-currents": Shape(
        "the state has the currents of the motors too", with_columns([f"{name[:-4]}.current" for name in POS], currents)
    ),
    "with-a-goal": Shape(
        "the state has what stays the same through an episode", with_columns(["goal.x", "goal.y", "object.id"], goal)
    ),
    "with-one-hot": Shape("the state says which task it is", with_columns(["task_0", "task_1"], one_hot)),
    "with-terminate": Shape(
        "the action has a column that is 1 in the last frame", with_columns(["terminate"], terminate, ACTION)
    ),
    "gripper-not-told": Shape("the gripper is seen and not told", without("gripper.pos", ACTION)),
    "gripper-not-seen": Shape("the gripper is told and not seen", without("gripper.pos", STATE)),
    "catching-up": Shape(
        "leader and follower begin in different poses", lambda seed: changed(so101(seed), catching_up)
    ),
    "setpoints": Shape("commands that leap to where the arm has to be", lambda seed: changed(so101(seed), setpoints)),
    "scaled-actions": Shape("commands as a share of each joint's range", lambda seed: changed(so101(seed), scaled)),
    "fingers": Shape(
        "a gripper whose command and state count in opposite ways", lambda seed: changed(so101(seed), fingers)
    ),
    "mimic-finger": Shape(
        "a second finger that is where the first one is",
        with_columns(["finger.pos"], lambda own, rng: own[STATE][:, 5:]),
    ),
    "other-features": Shape("features have names of their own", renamed("observation.qpos", "actions")),
    "no-state": Shape("only the action is stored", lacking(STATE)),
    "no-action": Shape("only the state is stored", lacking(ACTION)),
    "names-in-a-dict": Shape("names stand in a dict", lambda seed: replace(so101(seed), finish=[in_a_dict])),
    "splits": Shape("two splits that share nothing", with_info(splits={"train": "0:9", "val": "9:12"})),
    "three-splits": Shape("three splits", with_info(splits={"train": "0:8", "val": "8:10", "test": "10:12"})),
    "no-robot-type": Shape("nobody said which robot it is", with_info(robot_type=None)),
}


# --- what is filmed


def settled(change: cameras.Change, every: bool = False) -> Callable[[Path, int], None]:
    """The filmed arm, with a camera that shows all episodes so, or with two."""

    def of(root: Path, seed: int) -> None:
        cameras.copy_filmed(root, seed)
        n_episodes = len(cameras.column(root, "length"))
        everywhere = [Place(episode, slice(None)) for episode in range(n_episodes)]
        cameras.seen(change, every)(root, everywhere, np.random.default_rng(seed))

    return of


def a_hand(own: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """Somebody's hand is before the lens for half a second, in some of the episodes."""
    first = int(rng.integers(5, len(own) - 12))
    own[first : first + 8 * int(rng.integers(2)), 10:, 20:80] = (190, 140, 120)
    return own


def dusk(own: np.ndarray, rng: np.random.Generator) -> np.ndarray:
    """The daylight differs from episode to episode."""
    return cameras.bright(rng.uniform(0.6, 1.2))(own, rng)


FILMED: dict[str, Callable[[Path, int], None]] = {
    "filmed": cameras.copy_filmed,
    "filmed-av1": lambda root, seed: cameras.write_filmed(root, seed, codec="av1", files=(3, 2)),
    "filmed-a-file-an-episode": lambda root, seed: cameras.write_filmed(root, seed, files=(1, 1, 1, 1)),
    "filmed-one-file": lambda root, seed: cameras.write_filmed(root, seed, files=(5,)),
    "filmed-grey": settled(cameras.grey),
    "filmed-dark": settled(cameras.bright(0.3)),
    "filmed-upside-down": settled(cameras.upside_down),
    "filmed-blurred": settled(cameras.blurred),
    "filmed-a-hand": settled(a_hand),
    "filmed-daylight": settled(dusk, every=True),
    "filmed-two-frames-late": settled(cameras.late(2), every=True),
}


# --- what LeRobot's tools make


def record(recording: Recording, root: Path, film: cameras.Film, dtype: str = "video") -> None:
    """Let LeRobotDataset record it, frame by frame, with what cameras saw; a file for about every episode."""
    from lerobot.datasets.lerobot_dataset import LeRobotDataset

    features = {name: {"dtype": "float32", "shape": (6,), "names": list(POS)} for name in (STATE, ACTION)}
    camera = {"dtype": dtype, "shape": (cameras.HEIGHT, cameras.WIDTH, 3), "names": ["height", "width", "channels"]}
    dataset = LeRobotDataset.create(
        "test/arm",
        int(recording.fps),
        features | dict.fromkeys(film, camera),
        root,
        recording.robot,
        use_videos=dtype == "video",
        data_files_size_in_mb=0.02,
        video_files_size_in_mb=0.05,
    )
    for number, own in enumerate(recording.episodes):
        for row in range(len(own[TASK])):
            frame = {name: own[name][row].astype(np.float32) for name in features}
            pictures = {name: episodes[number][row] for name, episodes in film.items()}
            dataset.add_frame(frame | pictures | {"task": recording.tasks[own[TASK][row]]})
        dataset.save_episode()
    dataset.finalize()


@cache
def _recorded(seed: int, what: str) -> tuple[Path, Path]:
    """Two datasets to be edited; of `what`: "numbers", or "video" or "image" too, but then short ones."""
    folder = Path(tempfile.mkdtemp(prefix="healthy-"))
    for number, (name, n) in enumerate({"one": 6, "other": 3}.items()):
        recording = so101(seed + number, n) if what == "numbers" else so101(seed + number, n, 5, operator=Operator(200))
        film = {} if what == "numbers" else cameras.film(recording, seed)
        record(recording, folder / name, film, what)
    return folder / "one", folder / "other"


type Edit = Callable[[Any, Any, Any, Path], object]
"""Takes `dataset_tools`, two datasets, and where the edited one has to be."""


def edited(edit: Edit, what: str, root: Path, seed: int) -> None:
    from lerobot.datasets import dataset_tools
    from lerobot.datasets.lerobot_dataset import LeRobotDataset

    edit(dataset_tools, *(LeRobotDataset("test/arm", folder) for folder in _recorded(seed, what)), root)


def _split(tools: Any, one: Any, other: Any, root: Path) -> None:
    parts = root.with_name(f"{root.name}-parts")
    tools.split_dataset(one, {"train": 0.67, "test": 0.33}, parts)
    shutil.move(parts / "train", root)


def _relabel(tools: Any, one: Any, other: Any, root: Path) -> None:
    from lerobot.datasets.lerobot_dataset import LeRobotDataset

    shutil.copytree(one.root, root)
    tools.modify_tasks(LeRobotDataset("test/arm", root), episode_tasks={1: "Stand the cup on the plate"})


def _reduce(tools: Any, one: Any, other: Any, root: Path) -> None:
    """Add a feature, and drop it: adding alone leaves it without statistics."""
    feature = {"dtype": "float32", "shape": (1,), "names": None}
    more = root.with_name(f"{root.name}-more")
    added = tools.add_features(one, {"next.reward": (np.zeros(one.num_frames, np.float32), feature)}, more, "test/arm")
    tools.remove_feature(added, "next.reward", root, "test/arm")


def _copy(tools: Any, one: Any, other: Any, root: Path) -> None:
    shutil.copytree(one.root, root)


def _delete(tools: Any, one: Any, other: Any, root: Path) -> None:
    tools.delete_episodes(one, [1, 4], root, "test/arm")


def _merge(tools: Any, one: Any, other: Any, root: Path) -> None:
    tools.merge_datasets([one, other], "test/arm", root)


EDITED: dict[str, tuple[str, Edit]] = {
    "lerobot-recorded": ("numbers", _copy),
    "lerobot-deleted": ("numbers", _delete),
    "lerobot-split": ("numbers", _split),
    "lerobot-merged": ("numbers", _merge),
    "lerobot-reduced": ("numbers", _reduce),
    "lerobot-relabelled": ("numbers", _relabel),
    "lerobot-images": ("image", _copy),
    "lerobot-videos": ("video", _copy),
    "lerobot-videos-deleted": ("video", _delete),
    "lerobot-videos-split": ("video", _split),
    "lerobot-videos-merged": ("video", _merge),
}

SHAPES: list[str] = [*HEALTHY, *FILMED, *EDITED]
