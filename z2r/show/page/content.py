"""What goes into a page: the summary, the readings, what the audit found, and the frames that it has room for."""

import re
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from z2r.arrays import Bools, Columns, Ints
from z2r.audits.audit import Audit
from z2r.audits.findings import Finding
from z2r.audits.following import pairs_of
from z2r.errors import printable
from z2r.format.about import cameras_of
from z2r.format.dataset import Dataset
from z2r.format.episodes import EpisodeIndex
from z2r.format.schema import ACTION, Schema
from z2r.format.store import folder_name
from z2r.reading.bodies import Body, bodies_of
from z2r.reading.breaks import BreakMode, break_mode
from z2r.reading.decode import Decoded, decode
from z2r.reading.goal import Goal
from z2r.reading.inspection import Inspection, Outcome, beginning, outcome_of
from z2r.reading.joints import Place
from z2r.reading.reading import Reading
from z2r.reading.scene import Scene
from z2r.reading.stored import StoredSuccess
from z2r.show.page.films import Film, read_films

WRONG_READINGS = ("yaw-swap", "yaw-swap-everywhere", "drop-boundaries")

MAX_EPISODES = 500  # to pick from: more are no list

_PLACE = re.compile(r" (?:in|of) (?:row|episode|frame)\b")  # what follows says where, and not what
_WORD = "(?<![A-Za-z0-9_.]){}(?![A-Za-z0-9_.])"


@dataclass(frozen=True, eq=False)
class View:
    """The dataset as one reading has it, its episodes side by side; without a goal, there is no outcome either."""

    mode: BreakMode | None
    reading: Reading | None
    episodes: EpisodeIndex
    outcome: Outcome | None
    stored: StoredSuccess | None

    @property
    def fine(self) -> Bools | None:
        """Which episodes reached the goal, or where nothing says, which are stored as a success, bool[n_episodes]."""
        return self.outcome.reached if self.outcome else self.stored.any_frame if self.stored else None

    @property
    def name(self) -> str:
        """Name of the break mode, or ``right``."""
        return self.mode.name if self.mode else "right"


@dataclass(frozen=True)
class Chart:
    """What one chart shows over time: a column, and where the action says where it is to be, that command.

    Attributes
    ----------
    group : str
        The feature, or the two, that it is from.
    name : str
        The dimension.
    unit : str
        Empty where nobody says.
    measured, command : int or None
        Which of the columns of the page.
    low, high : float
        The least and the greatest value in the dataset.
    """

    group: str
    name: str
    unit: str
    measured: int | None
    command: int | None
    low: float
    high: float


@dataclass(frozen=True, eq=False)
class Content:
    """What a page is made of: the summary, the views, and the frames of the episodes that it shows.

    Attributes
    ----------
    title : str
        Name of the dataset.
    inspection : Inspection
        The summary of all of it.
    scene : Scene or None
        What the bodies look like.
    views : list of View
        The right one first.
    shown : EpisodeIndex
        The episodes whose frames are there, side by side from 0.
    frames : Columns
        Their frames.
    left_out : str
        Which episodes are not there, in a sentence; empty where all are.
    films : list of Film
        What its cameras saw.
    audit : Audit or None
        What is wrong with it; None where nobody looked.
    """

    title: str
    inspection: Inspection
    scene: Scene | None
    views: list[View]
    shown: EpisodeIndex
    frames: Columns
    left_out: str
    films: list[Film]
    audit: Audit | None

    @property
    def schema(self) -> Schema:
        """Fact one."""
        return self.inspection.schema

    @property
    def columns(self) -> list[tuple[str, str]]:
        """Feature and dimension of every column of `frames`, in order."""
        return [(name, dim) for name in self.frames for dim in self.schema.features[name].labels]

    @cached_property
    def charts(self) -> list[Chart]:
        """A chart for every column; a joint and the command that says where it is to be are in one, and come first."""
        pairs = pairs_of(self.schema, self.inspection.reading) if self._action_is_a_place else ()
        commands = {(pair.feature, pair.column): (ACTION, pair.dim) for pair in pairs}
        places = [(name, dim) for name in self.frames for dim in range(self.schema.features[name].size)]
        together = [self._chart(place, commands[place]) for place in places if place in commands]
        alone = [place for place in places if place not in commands and place not in commands.values()]
        return together + [self._chart(*((None, at) if at[0] == ACTION else (at, None))) for at in alone]

    @property
    def _action_is_a_place(self) -> bool:
        """Whether the action says where joints are to be: a reading says so, or else the data does not deny it."""
        reading = self.inspection.reading
        if reading and reading.action:
            return reading.action.drives == "position"
        kinds = [driven.kind for driven in self.inspection.action]
        return kinds.count("target") >= sum(kind not in ("target", "unknown") for kind in kinds)

    def _chart(self, measured: Place | None, command: Place | None) -> Chart:
        places = [place for place in (measured, command) if place]
        (feature, dim), reading = places[0], self.inspection.reading
        label = self.schema.features[feature].labels[dim]
        ends = [self._ends(*place) for place in places]
        return Chart(
            group=" and ".join(name for name, _ in places),
            name=label,
            unit=reading.meaning(feature, label).unit if reading else "",
            measured=self.place(*measured) if measured else None,
            command=self.place(*command) if command else None,
            low=min(low for low, _ in ends),
            high=max(high for _, high in ends),
        )

    def _ends(self, feature: str, dim: int) -> tuple[float, float]:
        ranges = self.inspection.ranges[feature]
        return float(ranges.low[:, dim].min()), float(ranges.high[:, dim].max())

    @cached_property
    def bodies(self) -> dict[str, Body]:
        """A body for every pose of the reading; none where there is no reading."""
        reading = self.inspection.reading
        return bodies_of(reading, self.scene.bodies if self.scene else {}) if reading else {}

    def decoded(self, reading: Reading) -> Decoded:
        """Return the shown frames as a reading has them."""
        return decode(self.frames, reading, self.schema)

    def place(self, feature: str, dim: int) -> int:
        """Say which of `columns` a dimension is."""
        names = list(self.frames)
        before = names[: names.index(feature)]
        return sum(self.schema.features[name].size for name in before) + dim

    def place_of(self, frame: int | None) -> tuple[int, int] | None:
        """Find a frame by its `index`: the number of its episode, and which of its frames it is; None where none."""
        episodes = self.inspection.dataset.episodes
        if frame is None:
            return None
        inside = np.flatnonzero((episodes.from_index <= frame) & (frame < episodes.to_index))
        return (episodes.number(inside[0]), int(frame - episodes.from_index[inside[0]])) if len(inside) else None

    def shown_frame(self, frame: int | None) -> int | None:
        """Say which of the frames that the page holds one is, by its `index`; None where it holds it not."""
        place = self.place_of(frame)
        if place is None or place[0] not in self.shown.numbers:
            return None
        episode = int(np.flatnonzero(self.shown.numbers == place[0])[0])
        at = int(self.shown.from_index[episode]) + place[1]
        return at if at < self.shown.to_index[episode] else None

    def columns_of(self, finding: Finding) -> list[int] | None:
        """Say which of `columns` a finding names: all of a feature where it names that alone; None where it names none.

        It says so in its field: ``observation.state[x] in ...``, or ``observation.state: x, y in row 3``.
        """
        named = [name for name in self.frames if re.match(rf"{re.escape(name)}(?![\w.])", finding.field)]
        if not named:
            return None
        name = max(named, key=len)
        said, labels = _PLACE.split(finding.field.removeprefix(name), maxsplit=1)[0], self.schema.features[name].labels
        dims = [dim for dim, label in enumerate(labels) if re.search(_WORD.format(re.escape(label)), said)]
        return [self.place(name, dim) for dim in dims or range(len(labels))]

    def label(self, pose: str) -> str:
        """Say what to call the body of a pose, or what a goal is about."""
        return self.bodies[pose].label if pose in self.bodies else pose

    @property
    def source(self) -> str:
        """From where it is known what was reached: ``stored`` where goals read only what says it outright."""
        reading = self.inspection.reading
        return "stored" if reading and all(goal.stored for goal in reading.goal) else "reconstructed"

    @property
    def destination(self) -> str:
        """What is to be reached, with its article."""
        reading = self.inspection.reading
        label = self.label(reading.destination) if reading else "the goal"
        return label if label.startswith("the ") else f"the {label}"

    def goal_title(self, goal: Goal) -> str:
        """Say what a goal measures, in the words of the bodies."""
        if goal.distance:
            return f"Distance to the {self.label(goal.distance[1])}"
        if goal.turn:
            return f"Turned away from the {self.label(goal.turn[1])}"
        return goal.name if goal.column == goal.name else f"{goal.name}: {goal.column}"


def n_frames_for(schema: Schema, reading: Reading | None, max_bytes: int) -> int:
    """Say how many frames, 4 bytes a number, fit into a page that shows what a reading makes of them; at least one.

    Where there are cameras, half of the room is theirs.
    """
    room = max_bytes // 2 if cameras_of(schema) else max_bytes
    return max(room // (4 * _n_columns(schema, reading)), 1)


def _n_columns(schema: Schema, reading: Reading | None) -> int:
    return sum(feature.size for feature in schema.signals().values()) + (_n_derived(reading) if reading else 0)


def _n_derived(reading: Reading) -> int:
    """Count the columns that the readings of a page add to the frames, at most: yaws, and distances and turns."""
    readings = [reading, *(break_mode(name).reading(reading) for name in WRONG_READINGS)]
    yaws = {pose.yaw for each in readings for pose in each.poses.values() if pose.yaw}
    goals = {
        (goal, *(each.poses[name] for name in goal.poses)) for each in readings for goal in each.goal if goal.poses
    }
    return len(yaws) + len(goals)


def read_content(
    inspection: Inspection, max_bytes: int, scene: Scene | None = None, audit: Audit | None = None
) -> Content:
    """Put together what a page shows.

    Parameters
    ----------
    inspection : Inspection
        From `z2r.reading.inspection.inspect_dataset`, which was asked to keep as many frames as `n_frames_for` says.
    max_bytes : int
        How large the frames and the clips of the cameras may be, together.
    scene : Scene, optional
        What the bodies look like.
    audit : Audit, optional
        What is wrong with the dataset.
    """
    dataset = inspection.dataset
    # Where a dataset was salvaged, there are other frames between its episodes: they stand side by side here.
    packed = replace(dataset, episodes=side_by_side(dataset.episodes))
    width = dtype_of(inspection).itemsize
    room = n_frames_for(dataset.schema, inspection.reading, max_bytes) * 4 // width
    kept = inspection.shown.only(slice(MAX_EPISODES))
    shown = beginning(side_by_side(kept), max(room, 1))
    rows = kept.frame_numbers[: shown.n_frames]
    left = max_bytes - shown.n_frames * width * _n_columns(dataset.schema, inspection.reading)
    return Content(
        title=printable(folder_name(dataset.root)),
        inspection=inspection,
        scene=scene,
        views=_views(inspection, packed),
        shown=shown,
        frames={name: values[rows] for name, values in inspection.kept.items()},
        left_out=_left_out(dataset.episodes, shown),
        films=read_films(inspection, shown, left),
        audit=audit,
    )


def side_by_side(episodes: EpisodeIndex) -> EpisodeIndex:
    """Count frames over the episodes alone."""
    ends = np.cumsum(episodes.lengths)
    return EpisodeIndex(ends - episodes.lengths, ends, episodes.numbers)


def dtype_of(inspection: Inspection) -> np.dtype[np.generic]:
    """Return the type that holds every value as it is: float32, or float64 where a feature needs it."""
    dtype = np.result_type(np.float32, *(ranges.low.dtype for ranges in inspection.ranges.values()))
    return np.dtype("<f4" if dtype == np.float32 else "<f8")


def _left_out(episodes: EpisodeIndex, shown: EpisodeIndex) -> str:
    if shown.n_frames == episodes.n_frames:
        return ""
    sentences = []
    if shown.n_frames < episodes.lengths[0]:
        sentences.append(f"Of episode {episodes.number(0):,}, the page holds the first {shown.n_frames:,} frames.")
    if n_left := len(episodes) - len(shown):
        first, last = episodes.number(len(shown)), episodes.number(len(episodes) - 1)
        which = f"episode {last:,}" if n_left == 1 else f"episodes {first:,} to {last:,}"
        sentences.append(f"The frames of {which} are left out.")
    return " ".join([*sentences, "The sums and the ribbon cover every episode."])


def _views(inspection: Inspection, packed: Dataset) -> list[View]:
    right = View(None, inspection.reading, packed.episodes, inspection.outcome, inspection.stored)
    modes = [break_mode(name) for name in WRONG_READINGS] if inspection.outcome else []
    applying = (mode for mode in modes if mode.applies_to(packed, inspection.reading))
    return [right, *(wrong_view(inspection, packed, mode) for mode in applying)]


def wrong_view(inspection: Inspection, packed: Dataset, mode: BreakMode) -> View:
    """Return the dataset as a break mode has it, from the first and last frames that the inspection has kept.

    Raises
    ------
    ValueError
        If the mode lets a frame decide that was not kept, takes the files in another order, or columns for something
        else.
    """
    believed, reading = mode.believe(packed, inspection.reading)
    assert reading is not None  # only what has an outcome is read wrong
    if believed.misread is not packed.misread:
        raise ValueError(f"found the mode {mode.name}, expected one that leaves the numbers as they are")
    if believed.files != packed.files[: len(believed.files)]:
        raise ValueError(f"found the mode {mode.name}, expected one that leaves the files in their order")
    episodes = believed.episodes
    decisive = episodes.to_index - 1 if reading.decisive == "last" else episodes.from_index
    frames = _kept_frames(inspection, packed.episodes, decisive)
    stored = inspection.stored if len(episodes) == len(packed.episodes) else None
    return View(mode, reading, episodes, outcome_of(decode(frames, reading, inspection.schema)), stored)


def _kept_frames(inspection: Inspection, right: EpisodeIndex, wanted: Ints) -> Columns:
    """Pick frames by their numbers out of the first and the last one of each episode."""
    known = np.concatenate([right.from_index, right.to_index - 1])
    order = np.argsort(known, kind="stable")
    place = order[np.minimum(np.searchsorted(known[order], wanted), len(order) - 1)]
    if not np.array_equal(known[place], wanted):
        raise ValueError(f"found frame {int(wanted[known[place] != wanted][0])}, expected the end of an episode")
    first, last = inspection.ends["first"], inspection.ends["last"]
    ends: Columns = {name: np.concatenate([first[name], last[name]]) for name in first}
    return {name: frames[place] for name, frames in ends.items()}
