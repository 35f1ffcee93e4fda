"""Kinds of faults that happen to owners of arms while they record, and what a finding has to be about.

`KINDS` is one table. A fault is planted in a `Recording`, before it is written: the statistics and the metadata agree
with it, as a recorder would have written them, and only what the numbers say of each other gives it away. Most kinds
are planted in several ways, the `VARIANTS`: for a while in one episode ("place"), in the whole of one ("one"), in half
of them ("half": the later half, or any), and in all. Where nobody could know from what is stored, the kind says why.

What is a fault of the files is in `damages.py`; what is one of the pictures, in `arm_cameras.py`.
"""

import json
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from arms import ACTION, POS, SIDES, STATE, TASK, TICK, VIPER, Recording, follow, make, normalised, play, write
from layouts import Frames

PLACE, ONE, HALF, ALL = VARIANTS = ("place", "one", "half", "all")
THREE, WIDE, EVERY = (PLACE, ONE, HALF), (ONE, HALF, ALL), VARIANTS

type Rng = np.random.Generator
type Change = Callable[[np.ndarray, Rng], np.ndarray]


class Place(NamedTuple):
    """Where a fault is: an episode, and which of its frames."""

    episode: int
    rows: slice


type Do = Callable[[Recording, Sequence[Place], Rng], Sequence[Place] | None]
"""Plants a fault in a recording, at these places; says where it is, where that is elsewhere."""


@dataclass(frozen=True)
class Kind:
    """One kind of fault.

    Attributes
    ----------
    story : str
        What went wrong in the world.
    do : callable
        Plants it in a recording that is its own, at these places.
    names : tuple of str
        A finding must name one of these: columns, or what else is at fault.
    robot : str
        Which of `arms.ROBOTS` it happens to.
    plant : tuple of str
        The variants in which it is planted.
    undecidable : dict
        Why nobody could know, by variant; `any` stands for every one.
    seconds : float
        How long a place is.
    harmless : bool
        Whether a note is enough.
    """

    story: str
    do: Do
    names: tuple[str, ...]
    robot: str = "so101"
    plant: tuple[str, ...] = THREE
    undecidable: Mapping[str, str] = field(default_factory=dict)
    seconds: float = 2.0
    harmless: bool = False

    def why_not(self, variant: str) -> str | None:
        """Why this variant cannot be told from a healthy recording; None where it can."""
        return self.undecidable.get(variant, self.undecidable.get("any"))


@dataclass(frozen=True)
class Case:
    """A fault that was planted.

    Attributes
    ----------
    kind : Kind
        The kind.
    variant : str
        Where it is planted.
    episodes : frozenset of int
        In which episodes of the recording, as it became, a finding may lie.
    rows : tuple of range
        And in which of its frames; a place is given with a second on either side.
    file : str
        The file that was harmed, if it was one: who names it has said where.
    """

    kind: Kind
    variant: str
    episodes: frozenset[int]
    rows: tuple[range, ...]
    file: str = ""

    def is_named_by(self, text: str) -> bool:
        """Whether a finding is about this: it names what is at fault and, where some episodes are, where that is.

        Of a fault in half of the episodes nobody knows which half is right.
        """
        if not any(name in text for name in self.kind.names):
            return False
        if self.variant == ALL or (self.file and self.file in text):
            return True
        named = {int(number) for number in re.findall(r"(?:episodes?|and|to|,) (\d+)", text)}
        frames = {int(number) for number in re.findall(r"(?:frames?|rows?) (\d+)", text)}
        if self.variant == HALF:
            return bool(named) or bool(frames) or "episodes" in text
        return bool(named & self.episodes) or any(row in rows for row in frames for rows in self.rows)


def plant(name: str, variant: str, seed: int = 0) -> tuple[Recording, Case]:
    """Plant a fault in a healthy recording."""
    kind, rng = KINDS[name], rng_of(name, variant, seed)
    recording = make(kind.robot, seed)
    places = choose(recording, kind, variant, rng)
    places = kind.do(recording, places, rng) or places
    return recording, case_of(kind, variant, recording, places)


def rng_of(name: str, variant: str, seed: int) -> Rng:
    return np.random.default_rng([seed, *name.encode(), VARIANTS.index(variant)])


def case_of(kind: Kind, variant: str, recording: Recording, places: Sequence[Place]) -> Case:
    """What was planted in a recording, at these places."""
    lengths = [len(episode[TASK]) for episode in recording.episodes]
    starts = np.cumsum(lengths) - lengths
    places = [place for place in places if place.episode < len(lengths)]
    rows = tuple(_around(place, variant, starts, lengths, int(recording.fps)) for place in places)
    return Case(kind, variant, frozenset(place.episode for place in places), rows)


def _around(place: Place, variant: str, starts: Any, lengths: Sequence[int], margin: int) -> range:
    """The frames of the dataset that a place covers; the whole episode, unless it is one place in it."""
    first, n = int(starts[place.episode]), lengths[place.episode]
    if variant != PLACE:
        return range(first, first + n)
    return range(first + max(0, place.rows.start - margin), first + min(n, place.rows.stop + margin))


def write_case(name: str, variant: str, root: Path, seed: int = 0) -> Case:
    """Write a dataset with a fault, and say what is in it."""
    recording, case = plant(name, variant, seed)
    write(recording, root)
    return case


def choose(recording: Recording, kind: Kind, variant: str, rng: Rng) -> list[Place]:
    """Where a variant is planted; a place is where the columns that a kind names move most, for there it shows."""
    lengths = [len(own[TASK]) for own in recording.episodes]
    n = len(lengths)
    if variant == PLACE:
        episode = int(rng.integers(2, n - 2))
        size = min(int(kind.seconds * recording.fps), lengths[episode] // 2)
        start = busiest(recording, episode, kind.names, size)
        return [Place(episode, slice(start, start + size))]
    later_half = rng.random() < 0.5
    chosen = {
        ONE: [int(rng.integers(2, n - 2))],
        HALF: range(n - n // 2, n) if later_half else sorted(rng.choice(n, n // 2, replace=False).tolist()),
        ALL: range(n),
    }[variant]
    return [Place(episode, slice(0, lengths[episode])) for episode in chosen]


def busiest(recording: Recording, episode: int, names: Sequence[str], size: int) -> int:
    """The first of so many frames in which these columns move most, or all where they name none."""
    columns = [place for name in names for place in recording.column(name)]
    columns = columns or [(ACTION, place) for place in range(recording.episodes[episode][ACTION].shape[1])]
    values = np.stack([recording.episodes[episode][feature][:, place] for feature, place in columns], axis=1)
    values = values / (values.std(axis=0) + 1e-9)
    starts = range(8, len(values) - size - 8)
    return max(starts, key=lambda start: np.abs(np.diff(values[start : start + size], axis=0)).sum())


# --- how it is planted


def columns(recording: Recording, feature: str, names: Sequence[str]) -> list[int]:
    own = recording.names[feature]
    return [own.index(name) for name in names] if names else list(range(len(own)))


def values(features: str | tuple[str, ...], names: str | Sequence[str], change: Change) -> Do:
    """Change the values (n, k) of columns, all where none is named, of one feature or two."""
    features, names = _all(features), _all(names)

    def do(recording: Recording, places: Sequence[Place], rng: Rng) -> None:
        for episode, rows in places:
            for feature in features:
                whole = recording.episodes[episode][feature]
                own = columns(recording, feature, names)
                whole[rows, own] = change(whole[rows, own], rng)

    return do


def _all(one_or_more: str | Sequence[str]) -> tuple[str, ...]:
    return (one_or_more,) if isinstance(one_or_more, str) else tuple(one_or_more)


def frames(change: Callable[[Frames, slice, Rng], Frames]) -> Do:
    """Replace what is returned, in the episode of each place."""

    def do(recording: Recording, places: Sequence[Place], rng: Rng) -> None:
        for episode, rows in places:
            recording.episodes[episode] |= change(recording.episodes[episode], rows, rng)

    return do


def take(which: Callable[[np.ndarray, Rng], np.ndarray], features: Sequence[str] = ()) -> Do:
    """Store other frames than those that were: `which` says them, of the numbers of those of the place.

    Where `features` are named, only they are from other frames, and there have to be as many.
    """

    def change(own: Frames, rows: slice, rng: Rng) -> Frames:
        here = which(np.arange(rows.start, rows.stop), rng)
        kept = np.concatenate([np.arange(rows.start), here, np.arange(rows.stop, len(own[TASK]))]).astype(int)
        return {name: own[name][kept] for name in features or own}

    return frames(change)


def later(by: int) -> Change:
    """Values of `by` frames ago; those of the future where it is negative."""
    return lambda own, rng: own[np.clip(np.arange(len(own)) - by, 0, len(own) - 1)]


def negative_at_times(values: np.ndarray, rng: Rng) -> np.ndarray:
    """Turn the sign round for the second third of the frames."""
    third = len(values) // 3
    return np.concatenate([values[:third], -values[third : 2 * third], values[2 * third :]])


def times(factor: float) -> Change:
    return lambda own, rng: own * factor


def plus(offset: float) -> Change:
    return lambda own, rng: own + offset


def constant(value: float | None = None) -> Change:
    """Stay at a value, or where it was at first."""
    return lambda own, rng: own * 0 + (own[:1] if value is None else value)


def noise(size: float) -> Change:
    return lambda own, rng: own + rng.normal(0, size, own.shape)


def rolled(own: np.ndarray, rng: Rng) -> np.ndarray:
    return np.roll(own, 1, axis=1)


def reversed_columns(own: np.ndarray, rng: Rng) -> np.ndarray:
    return own[:, ::-1]


def grid(step: float) -> Change:
    return lambda own, rng: np.round(own / step) * step


def bfloat16(own: np.ndarray, rng: Rng) -> np.ndarray:
    """Keep the upper half of the bits of a float32."""
    return (own.astype(np.float32).view(np.uint32) & 0xFFFF0000).view(np.float32).astype(float)


def smoothed(seconds_in_frames: float) -> Change:
    return lambda own, rng: follow(own, seconds_in_frames, share=0)


def ramp(to: float) -> Change:
    return lambda own, rng: own + np.linspace(0, to, len(own))[:, None]


def clip(low: float, high: float) -> Change:
    return lambda own, rng: own.clip(low, high)


def at(value: Callable[[np.ndarray, Rng], Any], share: float = 0.01) -> Change:
    """Single samples, at least one, are something else; none of the first or the last ones."""

    def change(own: np.ndarray, rng: Rng) -> np.ndarray:
        n = max(1, int(share * len(own)))
        rows = rng.choice(np.arange(len(own) // 4, 3 * len(own) // 4), n, replace=False)
        own = own.copy()
        own[rows] = value(own[rows], rng)
        return own

    return change


def stall(own: np.ndarray, rng: Rng) -> np.ndarray:
    """Numbers of frames: the first is repeated for as long as all of them last."""
    return np.full(len(own), own[0])


def stalls(length: int, share: float = 0.25) -> Callable[[np.ndarray, Rng], np.ndarray]:
    """Numbers of frames, now and then held for a while."""

    def which(own: np.ndarray, rng: Rng) -> np.ndarray:
        held = own.copy()
        for start in rng.choice(max(1, len(own) - length), max(1, int(share * len(own) / length)), replace=False):
            held[start : start + length] = own[start]
        return held

    return which


def in_stalls(length: int, share: float = 0.25) -> Change:
    return lambda own, rng: own[stalls(length, share)(np.arange(len(own)), rng)]


def every_other(own: np.ndarray, rng: Rng) -> np.ndarray:
    return own[::2]


def twice(own: np.ndarray, rng: Rng) -> np.ndarray:
    """Numbers of frames: every other one is stored twice, and as many are lost."""
    return np.repeat(own[::2], 2)[: len(own)]


def doubled(own: np.ndarray, rng: Rng) -> np.ndarray:
    """Numbers of frames: all are stored twice."""
    return np.repeat(own, 2)


def jittered(own: np.ndarray, rng: Rng) -> np.ndarray:
    """Numbers of frames: whatever had come when the recorder looked."""
    return np.clip(own + rng.integers(-2, 3, len(own)), own[0], own[-1])


def out_of_order(own: np.ndarray, rng: Rng) -> np.ndarray:
    """Numbers of frames: each three in another order."""
    order = own.copy()
    for start in range(0, len(own) - 3, 3):
        order[start : start + 3] = rng.permutation(own[start : start + 3])
    return order


def gaps(n: int, length: int) -> Callable[[np.ndarray, Rng], np.ndarray]:
    """Numbers of frames: some runs of them are lost."""

    def which(own: np.ndarray, rng: Rng) -> np.ndarray:
        starts = len(own) // (n + 1) * np.arange(1, n + 1)
        lost = np.concatenate([np.arange(start, start + length) for start in starts])
        return np.delete(own, lost[lost < len(own)])

    return which


def resampled(factor: float) -> Do:
    """As if recorded at another rate: so many times as many frames."""

    return frames(lambda own, rows, rng: stretched(own, factor))


def fit(own: np.ndarray, n: int) -> np.ndarray:
    """So many rows of it: cut, or with the last one repeated."""
    return own[np.minimum(np.arange(n), len(own) - 1)]


def of_fellow(feature: str, by: int = 1) -> Do:
    """What is stored of a feature is that of another episode."""

    def do(recording: Recording, places: Sequence[Place], rng: Rng) -> None:
        others = recording.copy().episodes
        for episode, _ in places:
            own = recording.episodes[episode]
            own[feature] = fit(others[(episode + by) % len(others)][feature], len(own[TASK]))

    return do


def copied(source: str, target: str, ahead: int = 0, names: Sequence[str] = ()) -> Do:
    """One feature is a copy of the other, or of what it is `ahead` frames later."""

    def do(recording: Recording, places: Sequence[Place], rng: Rng) -> None:
        for episode, rows in places:
            own = recording.episodes[episode]
            here, there = columns(recording, source, names), columns(recording, target, names)
            own[target][rows, there] = later(-ahead)(own[source], rng)[rows, here]

    return do


def moved(source: Sequence[str], target: Sequence[str], features: Sequence[str]) -> Do:
    """Columns `target` hold what is in the columns `source`."""

    def do(recording: Recording, places: Sequence[Place], rng: Rng) -> None:
        for episode, rows in places:
            for feature in features:
                own = recording.episodes[episode][feature]
                own[rows, columns(recording, feature, target)] = own[rows, columns(recording, feature, source)]

    return do


def exchanged(one: Sequence[str], other: Sequence[str], *features: str) -> Do:
    return moved([*one, *other], [*other, *one], features)


def after_frames(add: Callable[[Frames, Rng], Frames], before: bool = False) -> Do:
    """More is recorded at the end of episodes, or before they begin."""

    def do(recording: Recording, places: Sequence[Place], rng: Rng) -> None:
        for episode, _ in places:
            own = recording.episodes[episode]
            more = add(own, rng)
            parts = (more, own) if before else (own, more)
            recording.episodes[episode] = {name: np.concatenate([part[name] for part in parts]) for name in own}

    return do


def repeated(own: Frames, row: int, n: int, rng: Rng) -> Frames:
    """The arm stands still for so many frames, as at one of them; its encoders flicker."""
    more = {name: np.repeat(own[name][row][None], n, axis=0) for name in own}
    return more | {STATE: more[STATE] + TICK * np.round(rng.normal(0, 0.35, more[STATE].shape))}


def reset(own: Frames, rng: Rng) -> Frames:
    """The arm is put back by hand, its motors off: it moves, and nobody commands it."""
    more = repeated(own, -1, 60, rng)
    way = (1 - np.cos(np.linspace(0, 2 * np.pi, 60))) / 2
    more[STATE] = more[STATE] + way[:, None] * [-30, 45, -40, 20, 10, 30]
    return more


def nobody(own: Frames, rows: slice, rng: Rng) -> Frames:
    return repeated(own, 0, 200, rng)


def teleport(own: Frames, rng: Rng) -> Frames:
    """The simulator is reset while the recorder still runs: the arm is at once where it starts."""
    more = repeated(own, 0, 12, rng)
    more[STATE] = more[STATE] + np.array([30, 40, -40, 10, 5, 20])
    return more


def with_names(recording: Recording, change: Callable[[list[str]], list[str]], *features: str) -> None:
    for feature in features:
        recording.names[feature] = change(list(recording.names[feature]))


def row(number: int, change: Change, *features: str) -> Do:
    """One frame of an episode: its first (0), its last (-1)."""

    def do(recording: Recording, places: Sequence[Place], rng: Rng) -> None:
        for episode, _ in places:
            for feature in features:
                own = recording.episodes[episode][feature]
                own[number] = change(own[number][None], rng)[0]

    return do


def slipped(recording: Recording, places: Sequence[Place], rng: Rng) -> None:
    """From a frame on, the elbow reads 12 degrees less."""
    for episode, rows in places:
        recording.episodes[episode][STATE][rows.start :, 2] -= 12


def answered_by_the_neighbour(recording: Recording, places: Sequence[Place], rng: Rng) -> None:
    """In every 17th frame, the wrist's angle is the elbow's."""
    for episode, rows in places:
        own = recording.episodes[episode][STATE]
        own[rows.start + 9 : rows.stop : 17, 3] = own[rows.start + 9 : rows.stop : 17, 2]


def relative(recording: Recording, places: Sequence[Place], rng: Rng) -> None:
    for episode, rows in places:
        own = recording.episodes[episode]
        own[ACTION][rows] -= own[STATE][rows]


def stale_first(recording: Recording, places: Sequence[Place], rng: Rng) -> None:
    """The first frame of an episode is the observation of another moment of the one before."""
    before = recording.copy().episodes
    for episode, _ in places:
        other = before[episode - 1][STATE]
        recording.episodes[episode][STATE][:2] = other[len(other) // 2]


# --- copies, joins and cuts


def near_copy(change: Callable[[Frames, Rng], Frames]) -> Do:
    """Episodes are what the first one was, but for a little."""

    def do(recording: Recording, places: Sequence[Place], rng: Rng) -> list[Place]:
        source = recording.copy().episodes[0]
        for episode, _ in places:
            recording.episodes[episode] = change({name: values.copy() for name, values in source.items()}, rng)
        return [Place(0, slice(0, 0)), *places]

    return do


def only(which: Callable[[int], slice]) -> Callable[[Frames, Rng], Frames]:
    return lambda own, rng: {name: values[which(len(values))] for name, values in own.items()}


def with_noise(own: Frames, rng: Rng) -> Frames:
    return own | {name: own[name] + rng.normal(0, TICK, own[name].shape) for name in (STATE, ACTION)}


def replayed(own: Frames, rng: Rng) -> Frames:
    """The commands were played to the robot once more, and it followed as well as it did."""
    pull = own[STATE] - follow(own[ACTION], 4.5)
    return own | {
        STATE: grid(TICK)(follow(own[ACTION], 4.2) + pull * 0.9, rng) + rng.integers(-1, 2, own[STATE].shape) * TICK
    }


def stretched(own: Frames, factor: float) -> Frames:
    """The same motion in so many times as many frames."""
    new = np.linspace(0, len(own[TASK]) - 1, int(len(own[TASK]) * factor))
    return {name: _interpolated(values, new) for name, values in own.items()}


def _interpolated(own: np.ndarray, new: np.ndarray) -> np.ndarray:
    if own.ndim == 1:
        return own[new.astype(int)]
    return np.stack([np.interp(new, np.arange(len(own)), column) for column in own.T], axis=1)


def other_task(own: Frames, rng: Rng) -> Frames:
    return own | {TASK: 1 - own[TASK]}


def join_next(recording: Recording, places: Sequence[Place], rng: Rng) -> None:
    """Nobody pressed the key between two episodes: the second one follows in the first."""
    for episode, _ in sorted(places[::2], reverse=True):
        following = recording.episodes.pop(episode + 1) if episode + 1 < len(recording.episodes) else {}
        own = recording.episodes[episode]
        n = len(own[TASK]) * 7 // 10  # before the arm is home again
        recording.episodes[episode] = {
            name: np.concatenate([own[name][:n], following.get(name, own[name])]) for name in own
        }


def cut_in_two(recording: Recording, places: Sequence[Place], rng: Rng) -> list[Place]:
    """The key was pressed in the middle of a motion: the next episode goes on where this one ends."""
    [(episode, rows)] = places
    own, middle = recording.episodes[episode], (rows.start + rows.stop) // 2
    parts = [{name: values[part] for name, values in own.items()} for part in (slice(middle), slice(middle, None))]
    recording.episodes[episode : episode + 1] = parts
    return [Place(episode, slice(rows.start, middle)), Place(episode + 1, slice(0, rows.stop - middle))]


# --- labels


def texts(change: Callable[[list[str]], list[str]]) -> Do:
    def do(recording: Recording, places: Sequence[Place], rng: Rng) -> None:
        recording.tasks[:] = change(recording.tasks)

    return do


def relabelled(change: Callable[[np.ndarray], np.ndarray]) -> Do:
    def do(recording: Recording, places: Sequence[Place], rng: Rng) -> None:
        for episode, rows in places:
            own = recording.episodes[episode][TASK]
            own[rows] = change(own[rows])

    return do


def a_third_task(text: str) -> Do:
    """Some frames are of a task that none is of otherwise."""

    def do(recording: Recording, places: Sequence[Place], rng: Rng) -> None:
        recording.tasks.append(text)
        for episode, rows in places:
            recording.episodes[episode][TASK][rows] = len(recording.tasks) - 1

    return do


def splits(**which: str) -> Do:
    return lambda recording, places, rng: recording.info.update(splits=which)


def label(name: str, change: Callable[[np.ndarray], Any]) -> Do:
    """A stored label of whole episodes says something else."""
    return frames(lambda own, rows, rng: {name: np.full_like(own[name], change(own[name]))})


def wrong_statistics(change: Callable[[dict[str, Any]], object]) -> Do:
    """`meta/stats.json` is that of something else."""

    def damage(root: Path) -> None:
        path = root / "meta/stats.json"
        stats = json.loads(path.read_text())
        change(stats)
        path.write_text(json.dumps(stats))

    return lambda recording, places, rng: recording.finish.append(damage)


# --- the table

LIFT, ELBOW, FLEX, ROLL, PAN, GRIP = (
    f"{joint}.pos" for joint in ("shoulder_lift", "elbow_flex", "wrist_flex", "wrist_roll", "shoulder_pan", "gripper")
)
BOTH = (STATE, ACTION)
ARM = POS[:5]
MOTION = (STATE, ACTION)  # where a finding may name the whole of a feature
LEFT, RIGHT = SIDES[: len(VIPER)], SIDES[len(VIPER) :]
DEG = np.degrees(1)
ALIKE = "the other sign, order or unit in both is a robot of its own: nothing in the dataset says which is right"
SLOW = "a motor, or an arm, that is slower than its fellows, and has been all along"
LONGER = "another constant lag: healthy arms follow 0 to 15 frames late"

ON_TIME: dict[str, Kind] = {
    "action-late": Kind(
        "commands were stored 5 frames after they were sent",
        values(ACTION, (), later(5)),
        (ACTION, *POS),
        plant=EVERY,
        undecidable={ALL: "another constant lag, of about none: healthy arms follow 0 to 15 frames late"},
    ),
    "action-very-late": Kind(
        "commands were stored 12 frames after they were sent, so that the arm moves before it is told to",
        values(ACTION, (), later(12)),
        (ACTION, *POS),
        plant=EVERY,
        seconds=3,
    ),
    "action-late-by-one": Kind(
        "commands were stored a frame late",
        values(ACTION, (), later(1)),
        (ACTION, *POS),
        undecidable={"any": "a frame of lag comes and goes with the load of the computer: healthy episodes differ so"},
    ),
    "action-early": Kind(
        "commands of 5 frames later were stored",
        values(ACTION, (), later(-5)),
        (ACTION, *POS),
        plant=EVERY,
        undecidable={ALL: LONGER},
    ),
    "joint-late": Kind(
        "one motor is read from a cache that is 8 frames old",
        values(STATE, FLEX, later(8)),
        (FLEX,),
        plant=EVERY,
        seconds=3,
        undecidable={ALL: SLOW},
    ),
    "drifting-lag": Kind(
        "a buffer fills up: the lag of the state grows from 0 to 15 frames within an episode",
        take(lambda own, rng: own - np.linspace(0, 15, len(own)).astype(int).clip(max=np.arange(len(own))), [STATE]),
        (STATE, ACTION, *POS),
        plant=(ONE, HALF),
    ),
    "action-of-the-next": Kind(
        "a list was off by one: the commands are those of the next episode",
        of_fellow(ACTION),
        (ACTION, *POS),
        plant=WIDE,
    ),
    "action-of-the-one-before": Kind(
        "a buffer was not cleared: the commands are those of the episode before, of the other task",
        of_fellow(ACTION, -1),
        (ACTION, *POS),
        plant=WIDE,
    ),
    "action-zero": Kind(
        "commands were never stored: zeros", values(ACTION, (), constant(0)), (ACTION, *POS), plant=EVERY
    ),
    "action-copied": Kind(
        "the leader was not read: the action is the state of the same frame",
        copied(STATE, ACTION),
        (ACTION, *POS),
        plant=EVERY,
    ),
    "action-next-state": Kind(
        "the leader was not read: the action is the state of the next frame",
        copied(STATE, ACTION, 1),
        (ACTION, *POS),
        plant=EVERY,
        undecidable={ALL: "many datasets are made so on purpose; only who mixes it with commands is wrong"},
    ),
    "action-held": Kind(
        "the leader's process hung: its last command is stored, while the arm is led on",
        values(ACTION, (), constant()),
        (ACTION, *POS),
    ),
    "state-copied": Kind(
        "the motors were not read: the state is the command of the same frame",
        copied(ACTION, STATE),
        (STATE, *POS),
        plant=EVERY,
    ),
    "state-held": Kind(
        "the observation is a stale one, while the arm is led on",
        values(STATE, (), constant()),
        (STATE, *POS),
    ),
    "stall": Kind(
        "the network stood still for a second: state and action of before are repeated, then both leap",
        take(stall),
        (STATE, ACTION, *POS),
        plant=(PLACE,),
        seconds=1,
    ),
    "stalls": Kind(
        "the network stood still for half a second again and again",
        take(stalls(15)),
        (STATE, ACTION, *POS),
        plant=WIDE,
    ),
    "every-other-lost": Kind(
        "every other frame was dropped and never counted: all goes twice as fast",
        take(every_other),
        (STATE, ACTION, *POS),
        plant=(ONE, HALF),
        undecidable={
            ONE: "an episode that is led twice as fast, with half the lag: both differ as much between healthy ones"
        },
    ),
    "gap": Kind(
        "a second of frames was dropped in the middle of a motion, and never counted",
        take(gaps(1, 30)),
        (STATE, ACTION, *POS),
        plant=(PLACE,),
        seconds=4,
    ),
    "gaps": Kind(
        "half a second of frames was dropped, three times",
        take(gaps(3, 15)),
        (STATE, ACTION, *POS),
        plant=(ONE, HALF),
    ),
    "frames-twice": Kind(
        "the loop ran at half the rate: every other frame is the one before",
        take(twice),
        (STATE, ACTION, *POS),
        plant=EVERY,
    ),
    "frames-doubled": Kind(
        "every frame was stored twice: all goes half as fast, in steps",
        take(doubled),
        (STATE, ACTION, *POS),
        plant=EVERY,
    ),
    "state-at-half-rate": Kind(
        "the motors were read at half the rate of the loop",
        take(twice, [STATE]),
        (STATE, *POS),
        plant=EVERY,
    ),
    "action-at-half-rate": Kind(
        "commands came at half the rate of the loop",
        take(twice, [ACTION]),
        (ACTION, *POS),
        plant=EVERY,
        undecidable={ALL: "a policy or a leader may well command at 15 Hz an arm that is recorded at 30 Hz"},
    ),
    "jitter": Kind(
        "frames came in bursts and were stored as if evenly spaced",
        take(jittered),
        (STATE, ACTION, *POS),
        plant=(PLACE, ONE, HALF, ALL),
    ),
    "out-of-order": Kind(
        "writers raced: each three frames are in another order",
        take(out_of_order),
        (STATE, ACTION, *POS),
        plant=EVERY,
    ),
    "slow-motion": Kind(
        "recorded at 60 Hz and stored as 30",
        resampled(2),
        (STATE, ACTION, *POS, "fps"),
        plant=(ONE, HALF, ALL),
        undecidable={ALL: "a slow arm that lags twice as long"},
    ),
    "backwards": Kind(
        "an episode that was recorded to reset the scene was turned around: the arm moves before it is told to",
        take(lambda own, rng: own[::-1]),
        (STATE, ACTION, *POS),
        plant=WIDE,
    ),
    "joined": Kind(
        "the key was not pressed: two episodes are one, and the arm leaps inside it",
        join_next,
        (STATE, ACTION, *POS),
        plant=(PLACE, HALF),
    ),
    "cut-in-two": Kind(
        "the key was pressed in the middle: an episode begins in full motion, where the one before ends",
        cut_in_two,
        (STATE, ACTION, *POS, "episode"),
        plant=(PLACE,),
    ),
    "teleport-home": Kind(
        "the reset of the simulator was recorded: in the last frames the arm is elsewhere at once",
        after_frames(teleport),
        (STATE, ACTION, *POS),
        plant=WIDE,
    ),
    "reset-recorded": Kind(
        "the arm was put back by hand while the recorder ran: it moves, and no command does",
        after_frames(reset),
        (STATE, ACTION, *POS),
        plant=WIDE,
    ),
    "idle-head": Kind(
        "the recorder ran for 10 s before anybody led the arm",
        after_frames(lambda own, rng: repeated(own, 0, 300, rng), before=True),
        (STATE, ACTION, *POS, "episode"),
        plant=WIDE,
        harmless=True,
    ),
    "idle-tail": Kind(
        "the recorder ran for 10 s after all was done",
        after_frames(lambda own, rng: repeated(own, -1, 300, rng)),
        (STATE, ACTION, *POS, "episode"),
        plant=WIDE,
        harmless=True,
    ),
    "nobody-there": Kind(
        "an episode in which nobody led the arm",
        frames(nobody),
        (STATE, ACTION, *POS),
        plant=(ONE,),
    ),
    "aborted": Kind(
        "a key was pressed by accident: an episode of 8 frames, in which nothing moves",
        take(lambda own, rng: own[:8]),
        ("episode", STATE, ACTION, "length"),
        plant=(ONE,),
        harmless=True,
    ),
    "begins-late": Kind(
        "the recorder was started late: an episode begins with the thing in the gripper",
        take(lambda own, rng: own[len(own) // 2 :]),
        ("episode", STATE),
        plant=(ONE, HALF),
        undecidable={"any": "an episode may begin in any pose, with a thing in hand"},
    ),
    "ends-early": Kind(
        "the recorder was stopped early: the thing was never put down",
        take(lambda own, rng: own[: len(own) // 2]),
        ("episode", STATE),
        plant=(ONE, HALF),
        undecidable={"any": "an episode may end in any pose; whether the task was done is not in the numbers"},
    ),
}

ON_UNITS: dict[str, Kind] = {
    "joint-rad-state": Kind(
        "one joint's state is in radians, its command in degrees",
        values(STATE, LIFT, times(1 / DEG)),
        (LIFT,),
        plant=EVERY,
    ),
    "joint-rad-action": Kind(
        "one joint's command is in radians, its state in degrees",
        values(ACTION, ROLL, times(1 / DEG)),
        (ROLL,),
        plant=EVERY,
    ),
    "joint-rad-both": Kind(
        "one joint is in radians, all others in degrees",
        values(BOTH, ELBOW, times(1 / DEG)),
        (ELBOW,),
        plant=EVERY,
        undecidable={ALL: "a joint that hardly moves looks the same; its ticks hint at it, but no more"},
    ),
    "rad-state": Kind(
        "the state of all joints is in radians", values(STATE, ARM, times(1 / DEG)), (STATE, *ARM), plant=EVERY
    ),
    "rad-action": Kind(
        "the commands of all joints are in radians", values(ACTION, ARM, times(1 / DEG)), (ACTION, *ARM), plant=EVERY
    ),
    "rad-both": Kind(
        "all joints are in radians",
        values(BOTH, ARM, times(1 / DEG)),
        (STATE, ACTION, *ARM),
        plant=EVERY,
        undecidable={ALL: ALIKE},
    ),
    "normalised-state": Kind(
        "`use_degrees` was off for the follower: -100 to 100, its leader in degrees",
        values(STATE, (), lambda own, rng: normalised(own)),
        (STATE, *ARM),
        plant=WIDE,
    ),
    "normalised-both": Kind(
        "`use_degrees` was off: joints are in -100 to 100 of their range",
        values(BOTH, (), lambda own, rng: normalised(own)),
        (STATE, ACTION, *ARM),
        plant=WIDE,
        undecidable={
            ALL: ALIKE,
            ONE: "a pose a few degrees off, in one episode, is a pose",
            HALF: "a home pose a few degrees off is another home pose; only the ticks of the encoder differ",
        },
    ),
    "raw-ticks": Kind(
        "no calibration was loaded: steps of the encoder, 0 to 4095",
        values(BOTH, ARM, lambda own, rng: own / TICK + 2048),
        (STATE, ACTION, *ARM),
        plant=WIDE,
        undecidable={ALL: ALIKE},
    ),
    "gripper-0-to-1-state": Kind(
        "the gripper's state is 0 to 1, its command 0 to 100",
        values(STATE, GRIP, times(0.01)),
        (GRIP,),
        plant=EVERY,
    ),
    "gripper-0-to-1-both": Kind(
        "the gripper is 0 to 1, in the other episodes 0 to 100",
        values(BOTH, GRIP, times(0.01)),
        (GRIP,),
        plant=EVERY,
        undecidable={ALL: "0 to 1 is as good as 0 to 100 where nothing says percent; a reading that does says so"},
    ),
    "gripper-inverted-state": Kind(
        "the gripper's state says closed for open",
        values(STATE, GRIP, lambda own, rng: 100 - own),
        (GRIP,),
        plant=EVERY,
    ),
    "gripper-inverted-action": Kind(
        "the gripper's command says closed for open",
        values(ACTION, GRIP, lambda own, rng: 100 - own),
        (GRIP,),
        plant=EVERY,
    ),
    "gripper-inverted-both": Kind(
        "the gripper was calibrated the other way round",
        values(BOTH, GRIP, lambda own, rng: 100 - own),
        (GRIP,),
        plant=EVERY,
        undecidable={ALL: ALIKE},
    ),
    "gear-state": Kind(
        "the follower has another gear: its joint turns 1.25 times as far",
        values(STATE, ELBOW, times(1.25)),
        (ELBOW,),
        plant=EVERY,
    ),
    "gear-action": Kind(
        "the leader's joint is scaled by 2",
        values(ACTION, PAN, times(2)),
        (PAN,),
        plant=EVERY,
    ),
    "float16": Kind(
        "stored as float16 on the way",
        values(BOTH, (), lambda own, rng: own.astype(np.float16).astype(float)),
        (STATE, ACTION, *POS),
        plant=WIDE,
        undecidable={"any": "up to 128 its steps are below a tick of the encoder: nothing is lost"},
    ),
    "bfloat16": Kind(
        "stored as bfloat16 on the way: steps of half a degree",
        values(BOTH, (), bfloat16),
        (STATE, ACTION, *POS),
        plant=WIDE,
        harmless=True,
    ),
    "whole-numbers": Kind(
        "cast to integers on the way",
        values(STATE, (), grid(1)),
        (STATE, *POS),
        plant=WIDE,
        harmless=True,
    ),
    "half-turns": Kind(
        "one of the arms counts in turns",
        values(STATE, ARM, times(1 / 360)),
        (STATE, *ARM),
        plant=WIDE,
    ),
    "mm-state": Kind(
        "the place of the gripper is in mm, its command in m",
        values(STATE, ("x", "y", "z"), times(1000)),
        ("x", "y", "z"),
        "hand",
        EVERY,
    ),
    "mm-both": Kind(
        "the place of the gripper is in mm, in the other episodes in m",
        values(BOTH, ("x", "y", "z"), times(1000)),
        ("x", "y", "z"),
        "hand",
        EVERY,
        {ALL: ALIKE},
    ),
    "gripper-metres": Kind(
        "a gripper's command is in metres of its fingers, its state 0 to 1",
        values(ACTION, "right_gripper", times(0.057)),
        ("right_gripper",),
        "aloha",
        WIDE,
    ),
    "waist-deg": Kind(
        "a new driver tells one joint in degrees",
        values(BOTH, "right_waist", times(DEG)),
        ("right_waist",),
        "aloha",
        (PLACE, ONE, HALF),
    ),
    "wheel-rad": Kind(
        "the base turns in rad/s and is told so in deg/s",
        values(STATE, "theta.vel", times(1 / DEG)),
        ("theta.vel",),
        "lekiwi",
        WIDE,
    ),
}

ON_SIGNS: dict[str, Kind] = {
    "sign-state": Kind("a motor was mounted the other way round", values(STATE, FLEX, times(-1)), (FLEX,), plant=EVERY),
    "sign-action": Kind("the leader's joint turns the other way", values(ACTION, PAN, times(-1)), (PAN,), plant=EVERY),
    "sign-both": Kind(
        "one joint counts the other way, in state and action",
        values(BOTH, LIFT, times(-1)),
        (LIFT,),
        plant=EVERY,
        undecidable={ALL: ALIKE},
    ),
    "exchanged-state": Kind(
        "two motors have each other's id", exchanged([LIFT], [ELBOW], STATE), (LIFT, ELBOW), plant=EVERY
    ),
    "exchanged-action": Kind(
        "two of the leader's motors have each other's id", exchanged([PAN], [ROLL], ACTION), (PAN, ROLL), plant=EVERY
    ),
    "exchanged-both": Kind(
        "two motors have each other's id, in the leader too",
        exchanged([FLEX], [LIFT], *BOTH),
        (FLEX, LIFT),
        plant=EVERY,
        undecidable={ALL: ALIKE},
    ),
    "reversed-state": Kind(
        "the state came from the gripper to the base", values(STATE, (), reversed_columns), (STATE, *POS), plant=WIDE
    ),
    "reversed-both": Kind(
        "joints came from the gripper to the base, in state and action",
        values(BOTH, (), reversed_columns),
        (STATE, ACTION, *POS),
        plant=WIDE,
        undecidable={ALL: ALIKE},
    ),
    "shifted-columns": Kind(
        "a parser was off by one: each joint holds its neighbour", values(STATE, (), rolled), (STATE, *POS), plant=EVERY
    ),
    "names-sorted": Kind(
        "the action's names were sorted by the alphabet, its values were not",
        lambda recording, places, rng: with_names(recording, sorted, ACTION),
        (ACTION, *POS),
        plant=(ALL,),
    ),
    "arms-exchanged-state": Kind(
        "two followers have each other's port", exchanged(LEFT, RIGHT, STATE), (STATE, *SIDES), "aloha", EVERY
    ),
    "arms-exchanged-action": Kind(
        "two leaders have each other's port", exchanged(LEFT, RIGHT, ACTION), (ACTION, *SIDES), "aloha", EVERY
    ),
    "arms-exchanged-both": Kind(
        "the arms were exchanged altogether",
        exchanged(LEFT, RIGHT, *BOTH),
        (STATE, ACTION, *SIDES),
        "aloha",
        WIDE,
        {"any": "both arms are of one kind: an operator may use either hand for either part of a task"},
    ),
    "one-arm-twice": Kind(
        "the right follower is never read: its columns are copies of the left one",
        moved(LEFT, RIGHT, [STATE]),
        (STATE, *RIGHT),
        "aloha",
        EVERY,
    ),
    "one-leader-twice": Kind(
        "the right leader is never read: its columns are copies of the left one",
        moved(LEFT, RIGHT, [ACTION]),
        (ACTION, *RIGHT),
        "aloha",
        EVERY,
    ),
    "grippers-exchanged": Kind(
        "the pedals of the two grippers were exchanged",
        exchanged(["left_gripper"], ["right_gripper"], ACTION),
        ("left_gripper", "right_gripper"),
        "aloha",
        EVERY,
    ),
    "mirrored": Kind(
        "an episode was mirrored to have more of them",
        values(BOTH, (PAN, ROLL), times(-1)),
        (PAN, ROLL),
        plant=(ONE, HALF),
        undecidable={"any": "a thing that lies on the other side is led to like this; only the cameras know"},
    ),
    "wheel-sign": Kind("a wheel turns the other way", values(STATE, "x.vel", times(-1)), ("x.vel",), "lekiwi", EVERY),
    "wheels-exchanged": Kind(
        "forward and sideways are exchanged in the command",
        exchanged(["x.vel"], ["y.vel"], ACTION),
        ("x.vel", "y.vel"),
        "lekiwi",
        EVERY,
    ),
    "dial-sign": Kind(
        "the only motor turns the other way", values(STATE, "motor.pos", times(-1)), ("motor.pos",), "dial", EVERY
    ),
    "quaternion-sign": Kind(
        "the quaternion was made from a matrix and leaps to its negative: the same turn, in other numbers",
        values(STATE, ("qx", "qy", "qz", "qw"), times(-1)),
        ("qx", "qy", "qz", "qw", STATE),
        "hand",
        (PLACE, ONE, HALF),
    ),
    "quaternion-order": Kind(
        "w comes first in the state, last in the action",
        moved(("qw", "qx", "qy", "qz"), ("qx", "qy", "qz", "qw"), [STATE]),
        ("qx", "qy", "qz", "qw", STATE),
        "hand",
        WIDE,
    ),
    "quaternion-order-both": Kind(
        "w comes first, in the other episodes last",
        moved(("qw", "qx", "qy", "qz"), ("qx", "qy", "qz", "qw"), BOTH),
        ("qx", "qy", "qz", "qw", STATE, ACTION),
        "hand",
        WIDE,
        {ALL: ALIKE},
    ),
    "quaternion-sign": Kind(
        "a library gives q where it gave -q before: one turn, and a leap to a policy",
        values(STATE, ("qx", "qy", "qz", "qw"), negative_at_times),
        ("qx", "qy", "qz", "qw", STATE),
        "hand",
        EVERY,
    ),
    "quaternion-norm": Kind(
        "quaternions were averaged and never made of length 1 again",
        values(STATE, ("qx", "qy", "qz", "qw"), times(0.9)),
        ("qx", "qy", "qz", "qw", STATE),
        "hand",
        EVERY,
    ),
}

ON_OFFSETS: dict[str, Kind] = {
    "leader-17-degrees": Kind(
        "leader and follower differ by 17 degrees (lerobot#3758)",
        values(STATE, LIFT, plus(17)),
        (LIFT,),
        plant=EVERY,
    ),
    "recalibrated-follower": Kind(
        "the follower was calibrated anew: another zero of each joint",
        values(STATE, ARM, lambda own, rng: np.add(own, [9, -7, 6, -11, 8])),
        (STATE, *ARM),
        plant=EVERY,
    ),
    "recalibrated-both": Kind(
        "both arms were calibrated anew: another zero of each joint",
        values(BOTH, ARM, lambda own, rng: np.add(own, [9, -7, 6, -11, 8])),
        (STATE, ACTION, *ARM),
        plant=(ONE, HALF),
        undecidable={"any": "another home pose looks the same, and is none of anybody's business"},
    ),
    "another-robot": Kind(
        "some episodes are of another arm of the same kind: other zeros, and an elbow with another gear",
        values(STATE, ARM, lambda own, rng: np.add(own * [1, 1, 0.8, 1, 1], [-6, 5, 4, 7, -15])),
        (STATE, *ARM),
        plant=(ONE, HALF),
    ),
    "slipping": Kind(
        "a belt slips: the joint drifts away from its command by 15 degrees in an episode",
        values(STATE, PAN, ramp(15)),
        (PAN,),
        plant=(ONE, HALF),
    ),
    "horn-slipped": Kind(
        "the horn slipped on its shaft: from one frame on, 12 degrees are missing",
        slipped,
        (ELBOW,),
        plant=(PLACE,),
    ),
    "a-turn-off": Kind("the encoder counted a turn too many", values(STATE, ROLL, plus(360)), (ROLL,), plant=EVERY),
    "wrapped-state": Kind(
        "the follower was centred wrongly: its encoder wraps inside the range of the elbow, by a turn",
        values(STATE, ELBOW, lambda own, rng: own - 360 * (own > 60)),
        (ELBOW,),
        plant=EVERY,
        seconds=4,
    ),
    "wrapped-both": Kind(
        "angles are stored in 0 to 360, in the other episodes in -180 to 180",
        values(BOTH, LIFT, lambda own, rng: own % 360),
        (LIFT,),
        plant=WIDE,
        undecidable={ALL: "a joint that turns round and round leaps like that, where it wraps; worth a note at most"},
    ),
    "wrapped-rad": Kind(
        "the waist of one arm leaps by a turn",
        values(STATE, "left_waist", lambda own, rng: own + 2 * np.pi * (own > 0.1)),
        ("left_waist",),
        "aloha",
        EVERY,
    ),
    "first-command-zero": Kind(
        "before the leader answers, the command is zeros",
        row(0, constant(0), ACTION),
        (ACTION, *POS),
        plant=WIDE,
    ),
    "first-state-stale": Kind(
        "the first observations of an episode are left over from the one before",
        stale_first,
        (STATE, *POS),
        plant=WIDE,
    ),
    "last-frame-zero": Kind(
        "the motors were switched off before the last frame was read: zeros",
        row(-1, constant(0), STATE),
        (STATE, *POS),
        plant=WIDE,
    ),
}

ON_SENSORS: dict[str, Kind] = {
    "stuck-state": Kind("one encoder stays where it is", values(STATE, ELBOW, constant()), (ELBOW,), plant=EVERY),
    "stuck-action": Kind(
        "one joint of the leader stays where it is", values(ACTION, FLEX, constant()), (FLEX,), plant=EVERY
    ),
    "zero-state": Kind("one joint was never read: zeros", values(STATE, LIFT, constant(0)), (LIFT,), plant=EVERY),
    "zero-action": Kind(
        "one joint was never commanded: zeros", values(ACTION, ROLL, constant(0)), (ROLL,), plant=EVERY
    ),
    "zero-gripper": Kind("the gripper was never read: zeros", values(STATE, GRIP, constant(0)), (GRIP,), plant=EVERY),
    "intermittent": Kind(
        "a loose cable: an encoder stays for half a second, again and again",
        values(STATE, PAN, in_stalls(15, 0.4)),
        (PAN,),
        plant=WIDE,
    ),
    "spike": Kind(
        "a byte was read wrong: single samples are 60 degrees off",
        values(STATE, PAN, at(lambda own, rng: own + 60)),
        (PAN,),
        plant=EVERY,
    ),
    "spike-zero": Kind("a read failed and gave 0", values(STATE, LIFT, at(lambda own, rng: 0)), (LIFT,), plant=EVERY),
    "spike-sentinel": Kind(
        "a read failed and gave -1000", values(STATE, FLEX, at(lambda own, rng: -1000)), (FLEX,), plant=EVERY
    ),
    "small-spikes": Kind(
        "crosstalk: single samples are 6 degrees off",
        values(STATE, ELBOW, at(lambda own, rng: own + 6, 0.02)),
        (ELBOW,),
        plant=EVERY,
    ),
    "spike-action": Kind(
        "a command was read wrong: single samples are 40 degrees off",
        values(ACTION, LIFT, at(lambda own, rng: own - 40)),
        (LIFT,),
        plant=EVERY,
    ),
    "neighbour-read": Kind(
        "now and then a motor answers for its neighbour",
        answered_by_the_neighbour,
        (FLEX,),
        plant=EVERY,
    ),
    "noise-burst": Kind(
        "a motor nearby disturbs the encoder: noise of 4 degrees", values(STATE, FLEX, noise(4)), (FLEX,), plant=THREE
    ),
    "noisy-sensor": Kind(
        "a sensor is ten times as noisy",
        values(STATE, (), noise(0.5)),
        (STATE, *POS),
        plant=WIDE,
        undecidable={ALL: "then it is how noisy this robot is"},
    ),
    "noisy-leader": Kind(
        "a cheap potentiometer: the command trembles by 2 degrees",
        values(ACTION, PAN, noise(2)),
        (PAN,),
        plant=WIDE,
        undecidable={ALL: "then it is how noisy this leader is"},
    ),
    "trembling": Kind(
        "a gain is too high: the joint trembles by 2 degrees at 5 Hz",
        values(STATE, ELBOW, lambda own, rng: own + 2 * np.sin(2 * np.pi * 5 / 30 * np.arange(len(own)))[:, None]),
        (ELBOW,),
        plant=THREE,
    ),
    "filtered-state": Kind(
        "a filter was left on: the state is smoothed over half a second",
        values(STATE, (), smoothed(12)),
        (STATE, *POS),
        plant=EVERY,
        undecidable={ALL: "a slow arm"},
        seconds=4,
    ),
    "filtered-joint": Kind(
        "one joint's readings are smoothed over half a second",
        values(STATE, LIFT, smoothed(15)),
        (LIFT,),
        plant=(ONE, HALF, ALL),
        undecidable={ALL: SLOW},
    ),
    "clipped-state": Kind(
        "the sensor ends before the joint does: its upper third reads the same",
        values(STATE, FLEX, clip(0, 85)),
        (FLEX,),
        plant=WIDE,
    ),
    "clipped-action": Kind(
        "the command was clipped when it was stored, not when it was sent: the arm goes further than it was told",
        values(ACTION, LIFT, clip(-180, 15)),
        (LIFT,),
        plant=WIDE,
    ),
    "limp": Kind(
        "a motor lost its torque: the joint sinks, whatever it is told",
        values(
            STATE,
            LIFT,
            lambda own, rng: (
                own[:1]
                + 25 * (1 - np.exp(-np.arange(len(own)) / 10))[:, None]
                + np.round(rng.normal(0, 0.3, own.shape)) * TICK
            ),
        ),
        (LIFT,),
        plant=THREE,
        seconds=3,
    ),
    "overheated": Kind(
        "a motor overheats: it follows three times as late",
        values(STATE, ELBOW, smoothed(10)),
        (ELBOW,),
        plant=(ONE, HALF),
    ),
    "backlash": Kind(
        "a gear is worn: the joint has a play of 8 degrees",
        values(STATE, PAN, lambda own, rng: play(own, 8)),
        (PAN,),
        plant=WIDE,
        undecidable={ALL: "then it is how worn this robot is"},
    ),
    "garbage": Kind(
        "memory that was never written: any values within the joint's range",
        values(STATE, ROLL, lambda own, rng: rng.uniform(own.min() - 1, own.max() + 1, own.shape)),
        (ROLL,),
        plant=EVERY,
    ),
    "counter": Kind(
        "a column holds the number of the frame",
        values(STATE, ROLL, lambda own, rng: np.arange(len(own), dtype=float)[:, None]),
        (ROLL,),
        plant=WIDE,
    ),
    "velocities": Kind(
        "the velocity was read in place of the position",
        values(STATE, (), lambda own, rng: np.gradient(own, axis=0) * 30),
        (STATE, *POS),
        plant=EVERY,
    ),
    "relative-action": Kind(
        "commands are relative to the state, in the other episodes absolute",
        relative,
        (ACTION, *POS),
        plant=(PLACE, ONE, HALF),
    ),
    "arm-dead": Kind(
        "the right follower was never plugged in", values(STATE, RIGHT, constant()), (STATE, *RIGHT), "aloha", EVERY
    ),
    "leader-dead": Kind(
        "the right leader was unplugged: its last command stays",
        values(ACTION, RIGHT, constant()),
        (ACTION, *RIGHT),
        "aloha",
        EVERY,
    ),
    "arm-late": Kind(
        "one arm is on another computer: its state is 12 frames late",
        values(STATE, LEFT, later(12)),
        (STATE, *LEFT),
        "aloha",
        EVERY,
        undecidable={ALL: SLOW},
    ),
    "left-elbow-stuck": Kind(
        "an encoder of one of two arms stays where it is",
        values(STATE, "left_elbow", constant()),
        ("left_elbow",),
        "aloha",
        EVERY,
    ),
    "odometry-zero": Kind(
        "odometry was off: the base never moves",
        values(STATE, ("x.vel", "y.vel", "theta.vel"), constant(0)),
        ("x.vel", "y.vel", "theta.vel", STATE),
        "lekiwi",
        WIDE,
    ),
    "key-stuck": Kind(
        "a key was stuck: the base is told to go, and stands",
        values(ACTION, "y.vel", constant(0.1)),
        ("y.vel",),
        "lekiwi",
        THREE,
    ),
    "dial-stuck": Kind(
        "the only encoder stays where it is",
        values(STATE, "motor.pos", constant()),
        ("motor.pos",),
        "dial",
        THREE,
        seconds=0.5,
    ),
    "dial-late": Kind(
        "the only motor's commands are stored 15 frames late",
        values(ACTION, "motor.pos", later(15)),
        ("motor.pos", ACTION),
        "dial",
        EVERY,
    ),
    "koch-offset": Kind(
        "a Koch's elbow is half a turn off in its state",
        values(STATE, "main_elbow_flex", plus(180)),
        ("main_elbow_flex",),
        "koch",
        WIDE,
    ),
    "koch-sign": Kind(
        "a Koch's shoulder counts the other way in its state",
        values(STATE, "main_shoulder_lift", times(-1)),
        ("main_shoulder_lift",),
        "koch",
        WIDE,
    ),
    "normalised-clipped": Kind(
        "the follower goes beyond what its calibration saw: its state ends at 30, where its command goes on",
        values(STATE, LIFT, clip(-100, 30)),
        (LIFT,),
        "so100",
        WIDE,
    ),
}


ON_COPIES: dict[str, Kind] = {
    "copy": Kind("an episode was uploaded twice", near_copy(lambda own, rng: own), ("episode",), plant=(ONE, HALF)),
    "copy-cut": Kind(
        "an episode is another one, cut at its end",
        near_copy(only(lambda n: slice(0, int(0.8 * n)))),
        ("episode",),
        plant=(ONE,),
    ),
    "copy-trimmed": Kind(
        "an episode is another one without its first second",
        near_copy(only(lambda n: slice(30, n))),
        ("episode",),
        plant=(ONE,),
    ),
    "copy-with-noise": Kind(
        "an episode is another one with noise, to have more of them",
        near_copy(with_noise),
        ("episode",),
        plant=(ONE, HALF),
    ),
    "copy-shifted": Kind(
        "an episode is another one, a frame later", near_copy(only(lambda n: slice(1, n))), ("episode",), plant=(ONE,)
    ),
    "copy-resampled": Kind(
        "an episode is another one, 1.1 times as slow",
        near_copy(lambda own, rng: stretched(own, 1.1)),
        ("episode",),
        plant=(ONE,),
    ),
    "copy-of-another-task": Kind(
        "an episode is stored under two tasks", near_copy(other_task), ("episode",), plant=(ONE,)
    ),
    "replayed": Kind(
        "an episode was replayed on the robot and recorded once more",
        near_copy(replayed),
        ("episode", ACTION),
        plant=(ONE,),
    ),
}

TEXT = "whether the text of a task is true is not in the numbers"

ON_LABELS: dict[str, Kind] = {
    "task-exchanged": Kind(
        "an episode has the label of the other task",
        relabelled(lambda own: 1 - own),
        ("task",),
        plant=(ONE, HALF),
        undecidable={"any": TEXT},
    ),
    "one-label-for-all": Kind(
        "the label was never changed: two tasks have the text of one",
        relabelled(lambda own: own * 0),
        ("task",),
        plant=(ALL,),
        undecidable={ALL: TEXT},
    ),
    "task-empty": Kind("the text of a task was left empty", texts(lambda own: ["", own[1]]), ("task",), plant=(ALL,)),
    "task-blank": Kind("the text of a task is a space", texts(lambda own: [own[0], " "]), ("task",), plant=(ALL,)),
    "task-placeholder": Kind(
        "the text of the example was never replaced",
        texts(lambda own: ["<your task>", own[1]]),
        ("task",),
        plant=(ALL,),
    ),
    "task-twice": Kind(
        "one task has two numbers: its text has a space at its end",
        texts(lambda own: [own[0], own[0] + " "]),
        ("task",),
        plant=(ALL,),
    ),
    "task-twice-case": Kind(
        "one task has two numbers: its text begins with a small letter",
        texts(lambda own: [own[0], own[0].lower()]),
        ("task",),
        plant=(ALL,),
    ),
    "task-same-text": Kind(
        "one task has two numbers, and the very same text", texts(lambda own: [own[0], own[0]]), ("task",), plant=(ALL,)
    ),
    "task-changes": Kind(
        "the label was changed inside an episode",
        relabelled(lambda own: 1 - own),
        ("task",),
        plant=(PLACE,),
        harmless=True,
    ),
    "task-of-one": Kind(
        "a misspelt text for one episode",
        a_third_task("Put the cube into the bx"),
        ("task",),
        plant=(ONE,),
        harmless=True,
    ),
    "task-unused": Kind(
        "a text that no frame has",
        texts(lambda own: [*own, "Wipe the table"]),
        ("task",),
        plant=(ALL,),
        harmless=True,
    ),
    "splits-overlap": Kind(
        "episodes are in two splits: who trains on one has seen the other",
        splits(train="0:9", test="7:12"),
        ("splits",),
        plant=(ALL,),
    ),
    "splits-same": Kind("the two splits are the same", splits(train="0:12", val="0:12"), ("splits",), plant=(ALL,)),
    "splits-gap": Kind(
        "two episodes are in no split",
        splits(train="0:7", test="9:12"),
        ("splits",),
        plant=(ALL,),
        harmless=True,
    ),
    "splits-outside": Kind(
        "a split ends after the last episode", splits(train="0:10", test="10:14"), ("splits",), plant=(ALL,)
    ),
    "splits-of-before": Kind(
        "episodes were added, and the split was not",
        splits(train="0:8"),
        ("splits",),
        plant=(ALL,),
        harmless=True,
    ),
    "splits-empty": Kind(
        "a split has no episode",
        splits(train="0:12", test="12:12"),
        ("splits",),
        plant=(ALL,),
        harmless=True,
    ),
    "splits-turned": Kind("a split ends before it begins", splits(train="0:8", test="12:8"), ("splits",), plant=(ALL,)),
    "splits-text": Kind("a split is in words", splits(train="first 8", test="8:12"), ("splits",), plant=(ALL,)),
    "done-everywhere": Kind(
        "every frame is said to be the last", label("next.done", lambda own: True), ("next.done",), "scored", WIDE
    ),
    "done-never": Kind(
        "no frame is said to be the last", label("next.done", lambda own: False), ("next.done",), "scored", WIDE
    ),
    "success-from-the-start": Kind(
        "success holds from the first frame",
        label("next.success", lambda own: True),
        ("next.success",),
        "scored",
        (ONE, HALF),
    ),
    "success-without-reward": Kind(
        "success and reward say different things",
        label("next.reward", lambda own: 1 - own),
        ("next.reward", "next.success"),
        "scored",
        (ONE, HALF),
    ),
    "success-flickers": Kind(
        "success comes and goes",
        label("next.success", lambda own: np.arange(len(own)) % 40 < 4),
        ("next.success",),
        "scored",
        (ONE, HALF),
    ),
    "stats-of-others": Kind(
        "the statistics are those of another robot",
        wrong_statistics(lambda stats: stats[STATE].update(mean=[value + 20 for value in stats[STATE]["mean"]])),
        ("stats", STATE),
        plant=(ALL,),
    ),
    "stats-std": Kind(
        "a std is 8 times too large for one joint",
        wrong_statistics(lambda stats: stats[ACTION]["std"].__setitem__(3, stats[ACTION]["std"][3] * 8)),
        ("stats", FLEX),
        plant=(ALL,),
    ),
}

KINDS: dict[str, Kind] = ON_TIME | ON_UNITS | ON_SIGNS | ON_OFFSETS | ON_SENSORS | ON_COPIES | ON_LABELS

CASES: list[tuple[str, str]] = [(name, variant) for name, kind in KINDS.items() for variant in kind.plant]
