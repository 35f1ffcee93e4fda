"""How do I know that I read it right? Read it wrong on purpose, and learn what that looks like.

A break mode is a dataset read with one assumption wrong: about what its columns mean, or about where its frames are.
The files never change; what is believed about them does, and each wrong belief leaves a signature.

A belief changes one of three things: the reading; the dataset, which says what is where; or what the numbers of some
columns are taken for (`Misread`), which everybody who reads frames then gets to see, whatever the reading says.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # the command line lists the modes in its help, which must not wait for numpy and pyarrow
    from z2r.arrays import Floats
    from z2r.format.dataset import Dataset
    from z2r.format.episodes import EpisodeIndex
    from z2r.format.misread import Misread
    from z2r.format.schema import Schema
    from z2r.reading.reading import Reading


def _right_reading(reading: Reading) -> Reading:
    return reading


def _right_dataset(dataset: Dataset) -> Dataset:
    return dataset


def _read_as_they_are(schema: Schema, reading: Reading | None) -> Misread | None:
    return None


@dataclass(frozen=True)
class BreakMode:
    """One way to read a dataset wrong.

    Attributes
    ----------
    name : str
        What `--break` takes.
    assumption : str
        What it gets wrong, in a few words.
    signature : str
        What that looks like.
    about : str
        What there must be for the mistake to be possible; empty where any dataset has it.
    reading : callable
        Turns the right reading into the wrong one; one that has nothing of what the mode is about stays as it is.
    dataset : callable
        Turns the dataset, as it is, into what somebody takes it for.
    misread : callable
        Says, from the schema and the right reading, which columns are taken for what; None where there are none.
    seen_in : str
        Where it was met in the wild: an address.
    """

    name: str
    assumption: str
    signature: str
    about: str = ""
    reading: Callable[[Reading], Reading] = _right_reading
    dataset: Callable[[Dataset], Dataset] = _right_dataset
    misread: Callable[[Schema, Reading | None], Misread | None] = _read_as_they_are
    seen_in: str = ""

    def believe(self, dataset: Dataset, reading: Reading | None) -> tuple[Dataset, Reading | None]:
        """Return a dataset and its reading as somebody takes them who gets this wrong."""
        believed, misread = self.dataset(dataset), self.misread(dataset.schema, reading)
        return replace(believed, misread=misread) if misread else believed, reading and self.reading(reading)

    def applies_to(self, dataset: Dataset, reading: Reading | None) -> bool:
        """Tell whether there is anything to get wrong: whether what is believed differs from what is."""
        believed, wrong = self.believe(dataset, reading)
        return wrong != reading or not _is_same(believed, dataset)

    def columns(self, schema: Schema, reading: Reading | None) -> tuple[str, ...]:
        """Name the columns that are taken for something else, as a reading does; none where it is not about any."""
        from z2r.reading.reading import column_names

        misread = self.misread(schema, reading)
        return tuple(column_names(name, schema)[dim] for name, dim in misread.columns) if misread else ()


def _is_same(one: Dataset, other: Dataset) -> bool:
    import numpy as np

    if one.misread is not other.misread or one.schema != other.schema or one.files != other.files:
        return False
    episodes = zip(vars(one.episodes).values(), vars(other.episodes).values(), strict=True)
    return all(np.array_equal(*each) for each in episodes)


def _swapped(reading: Reading, name: str) -> Reading:
    """Exchange sine and cosine of one pose, where its yaw is stored so."""
    from msgspec.structs import replace as replace_in

    yaw = reading.poses[name].yaw
    if yaw is None or yaw.sin is None:
        return reading
    return reading.with_pose(name, yaw=replace_in(yaw, sin=yaw.cos, cos=yaw.sin))


def _swap_yaw(reading: Reading) -> Reading:
    return _swapped(reading, reading.moved) if reading.moved else reading


def _swap_every_yaw(reading: Reading) -> Reading:
    for name in reading.poses:
        reading = _swapped(reading, name)
    return reading


def _do_not_wrap(reading: Reading) -> Reading:
    """Take the plain difference of two yaws; two quaternions have none."""
    yaws = [goal.name for goal in reading.goal if goal.turn and reading.poses[goal.turn[0]].yaw]
    for name in yaws:
        reading = reading.with_goal(name, wraps=False)
    return reading


def _measure_from_another_body(reading: Reading) -> Reading:
    """Take the position of a body that no goal is about for that of the one that a goal moves."""
    in_goals = {name for goal in reading.goal for name in goal.poses}
    other = next((pose for name, pose in reading.poses.items() if name not in in_goals), None)
    if reading.moved is None or other is None:
        return reading
    return reading.with_pose(reading.moved, x=other.x, y=other.y, z=other.z)


def _take_degrees_for_radians(reading: Reading) -> Reading:
    for goal in reading.goal:
        if goal.turn and goal.within is not None:
            reading = reading.with_goal(goal.name, within=math.radians(goal.within))
    return reading


def _let_the_first_frame_decide(reading: Reading) -> Reading:
    from msgspec.structs import replace as replace_in

    return replace_in(reading, decisive="first") if reading.goal else reading


def _drop_boundaries(dataset: Dataset) -> Dataset:
    return replace(dataset, episodes=dataset.episodes.merged())


def _include_the_end(dataset: Dataset) -> Dataset:
    import numpy as np

    to_index = dataset.episodes.to_index
    return replace(dataset, episodes=replace(dataset.episodes, to_index=np.minimum(to_index + 1, to_index.max())))


def _first_shard_only(dataset: Dataset) -> Dataset:
    from z2r.format.episodes import shard_paths
    from z2r.format.parquet import open_parquet

    n_episodes = open_parquet(shard_paths(dataset.root)[0]).metadata.num_rows
    return dataset.first(min(n_episodes, len(dataset.episodes)))


def _stale_file_pointer(dataset: Dataset) -> Dataset:
    """Drop the first episode of every file but the first: it is looked for in the file before, and is not there."""
    import numpy as np

    lost = np.isin(dataset.episodes.from_index, [file.from_index for file in dataset.files[1:]])
    return replace(dataset, episodes=dataset.episodes.only(~lost))


def _sort_files_by_name(dataset: Dataset) -> Dataset:
    files, first = [], 0
    for file in sorted(dataset.files, key=lambda file: file.path.as_posix()):
        n_frames = file.to_index - file.from_index
        files.append(replace(file, from_index=first, to_index=first + n_frames))
        first += n_frames
    return replace(dataset, files=tuple(files))


def _triple_fps(dataset: Dataset) -> Dataset:
    from msgspec.structs import replace as replace_in

    return replace(dataset, schema=replace_in(dataset.schema, fps=3 * dataset.schema.fps))


def _act_a_frame_early(schema: Schema, reading: Reading | None) -> Misread | None:
    from z2r.format.misread import Misread
    from z2r.format.schema import ACTION

    if ACTION not in schema.signals():
        return None
    return Misread(tuple((ACTION, dim) for dim in range(schema.features[ACTION].size)), _of_the_next_frame)


def _take_the_other_unit(schema: Schema, reading: Reading | None) -> Misread | None:
    from z2r.format.misread import Misread
    from z2r.reading.joints import angles_of

    angles = angles_of(schema, reading)
    factors = tuple(math.degrees(1) if unit == "deg" else math.radians(1) for unit in angles.values())
    return Misread(tuple(angles), partial(_scaled, factors)) if angles else None


def _exchange_two_joints(schema: Schema, reading: Reading | None) -> Misread | None:
    from z2r.format.misread import Misread
    from z2r.reading.joints import joints_of

    joints = dict.fromkeys(joint.state for joint in joints_of(schema, reading) if not joint.is_gripper)
    return Misread(tuple(joints)[:2], _exchanged) if len(joints) > 1 else None


def _exchange_scalar_and_vector(schema: Schema, reading: Reading | None) -> Misread | None:
    """Take one order of a quaternion for the other: that of the pose that a goal moves, or else of the first one."""
    from z2r.format.misread import Misread
    from z2r.reading.reading import is_there, locate

    if reading is None:
        return None
    poses = [reading.poses[name] for name in (reading.moved, *reading.poses) if name is not None]
    stored = next((pose.quaternion for pose in poses if pose.quaternion), None)
    if stored is None or not all(is_there(name, reading.feature, schema) for name in stored.names):
        return None
    # Who takes xyzw for wxyz finds in each place the number of the next one; the reverse, that of the one before.
    names = stored.xyzw or (stored.wxyz or ())[::-1]
    return Misread(tuple(locate(name, reading.feature, schema) for name in names), _one_further)


def _take_targets_for_changes(schema: Schema, reading: Reading | None) -> Misread | None:
    from z2r.format.misread import Misread
    from z2r.reading.joints import joints_of

    if reading is None or reading.action is None or reading.action.drives != "position":
        return None
    joints = [] if reading.missing_action(schema) else joints_of(schema, reading)
    action, state = tuple(joint.action for joint in joints), tuple(joint.state for joint in joints)
    return Misread(action, _summed_up, beside=state) if joints else None


def _turn_the_gripper_round(schema: Schema, reading: Reading | None) -> Misread | None:
    from z2r.format.misread import Misread
    from z2r.reading.joints import gripper_limits

    limits = gripper_limits(schema, reading)
    return Misread(tuple(limits), partial(_mirrored, tuple(map(sum, limits.values())))) if limits else None


def _scaled(factors: tuple[float, ...], values: Floats, episodes: EpisodeIndex) -> Floats:
    scaled: Floats = values * factors
    return scaled


def _mirrored(sums: tuple[float, ...], values: Floats, episodes: EpisodeIndex) -> Floats:
    """Count from the other end of the range, of which the sum of both ends is given."""
    mirrored: Floats = -values + sums
    return mirrored


def _exchanged(values: Floats, episodes: EpisodeIndex) -> Floats:
    return values[:, ::-1]


def _one_further(values: Floats, episodes: EpisodeIndex) -> Floats:
    return values[:, [1, 2, 3, 0]]


def _of_the_next_frame(values: Floats, episodes: EpisodeIndex) -> Floats:
    """Take the values that are stored a frame later; the last frame of an episode keeps its own."""
    import numpy as np

    rows = np.arange(len(values))
    rows[episodes.frame_numbers] += 1
    rows[episodes.to_index - 1] -= 1
    later: Floats = values[rows]
    return later


def _summed_up(values: Floats, episodes: EpisodeIndex) -> Floats:
    """Add up the changes of each episode, which are the first half of the columns, from where the others begin."""
    import numpy as np

    changes, state = np.split(values, 2, axis=1)
    first, frames = np.repeat(episodes.from_index, episodes.lengths), episodes.frame_numbers
    before, targets = np.cumsum(changes, axis=0) - changes, changes.copy()
    targets[frames] += state[first] + before[frames] - before[first]
    return targets


BREAK_MODES: dict[str, BreakMode] = {
    mode.name: mode
    for mode in (
        BreakMode(
            name="yaw-swap",
            assumption="the yaw of what is moved is atan2(cos, sin)",
            signature="same frames and lengths; hardly any episode reaches the goal; a body is drawn turned wrong",
            reading=_swap_yaw,
            about="a yaw that is stored as (sin, cos), of a body that a goal moves",
            seen_in="https://github.com/rust-embedded/discovery/pull/444",
        ),
        BreakMode(
            name="drop-boundaries",
            assumption="there are no episodes",
            signature="all episodes become one, reached 0 of 1 or 1 of 1; bodies teleport",
            dataset=_drop_boundaries,
            about="more than one episode",
            seen_in="https://github.com/strands-labs/robots/issues/708",
        ),
        BreakMode(
            name="yaw-swap-everywhere",
            assumption="every yaw is atan2(cos, sin), that of the target too",
            signature="the two mistakes cancel: as many are reached; every direction is mirrored, no position is",
            reading=_swap_every_yaw,
            about="a yaw that is stored as (sin, cos)",
            seen_in="https://github.com/ngageoint/hootenanny/issues/2804",
        ),
        BreakMode(
            name="no-wrap",
            assumption="the error in yaw is the plain difference of two angles",
            signature="nothing, while the target's yaw is 0; errors of almost a whole turn as soon as it is near 180°",
            reading=_do_not_wrap,
            about="a goal on the turn between two yaws",
            seen_in="https://github.com/AtsushiSakai/PythonRobotics/pull/1422",
        ),
        BreakMode(
            name="inclusive-end",
            assumption="an episode's range includes its end",
            signature="every length but the last is one more; reached is read off the next episode; a leap at each end",
            dataset=_include_the_end,
            about="more than one episode",
            seen_in="https://github.com/jayleicn/TVQA/issues/15",
        ),
        BreakMode(
            name="first-shard-only",
            assumption="the episode metadata is one file",
            signature="where there are more shards, fewer episodes than info.json says; the rest looks perfect",
            dataset=_first_shard_only,
            about="episode metadata in more than one file",
            seen_in="https://github.com/huggingface/lerobot-dataset-visualizer/pull/11",
        ),
        BreakMode(
            name="stale-file-pointer",
            assumption="the first episode of a data file is in the file before it",
            signature="one episode is missing for each further data file; the rest looks perfect",
            dataset=_stale_file_pointer,
            about="more than one data file",
            seen_in="https://github.com/huggingface/lerobot/issues/2401",
        ),
        BreakMode(
            name="name-sorted-files",
            assumption="sorting file names sorts their numbers: file-10 comes before file-9",
            signature="where numbers are not padded, frames go to the wrong episodes, and bodies leap inside them",
            dataset=_sort_files_by_name,
            about="data files whose names sort in another order than their numbers",
            seen_in="https://github.com/NVlabs/MobilityGen/pull/54",
        ),
        BreakMode(
            name="wrong-reference-point",
            assumption="the distance to the target is measured from another body",
            signature="a distance remains at the end; one body is drawn inside another",
            reading=_measure_from_another_body,
            about="a goal on a distance, and a body that no goal is about",
            seen_in="https://github.com/huggingface/gym-xarm/pull/14",
        ),
        BreakMode(
            name="degrees-for-radians",
            assumption="the tolerance on a turn is in degrees",
            signature="same errors and pictures; almost no frame is in tolerance",
            reading=_take_degrees_for_radians,
            about="a goal on a turn",
            seen_in="https://github.com/strands-labs/robots/pull/693",
        ),
        BreakMode(
            name="first-frame-for-last",
            assumption="the first frame of an episode says whether it reached the goal",
            signature="same frames and picture; nothing seems to be reached, the errors are those of the start",
            reading=_let_the_first_frame_decide,
            about="a goal",
        ),
        BreakMode(
            name="wrong-fps",
            assumption="three times as many frames were taken in a second",
            signature="as many are reached; everything lasts a third as long and moves three times as fast",
            dataset=_triple_fps,
            seen_in="https://github.com/huggingface/lerobot/issues/336",
        ),
        BreakMode(
            name="action-lag",
            assumption="the action in a frame is the one that led to it, not the one taken in it",
            signature="as many are reached, same picture; the action explains the step after the next one",
            misread=_act_a_frame_early,
            about="an action",
            seen_in="https://github.com/Lifelong-Robot-Learning/LIBERO/issues/54",
        ),
        BreakMode(
            name="wrong-angle-unit",
            assumption="the angles of the state are in the other unit: degrees for radians, or radians for degrees",
            signature="same frames and lengths; the state moves 57 times as far as it is asked to, or as little",
            misread=_take_the_other_unit,
            about="an angle in the state, or a joint that the action drives and of which nobody says the unit",
            seen_in="https://github.com/iblnkn/rosetta/pull/7",
        ),
        BreakMode(
            name="joints-exchanged",
            assumption="the first two joints that the action drives have each other's place in the state",
            signature="same frames and lengths; each of the two does what the other one is asked to do",
            misread=_exchange_two_joints,
            about="two joints that the action drives, as the reading says, or by their names",
            seen_in="https://github.com/physical-superintelligence-lab/Humanoid-Everyday/issues/10",
        ),
        BreakMode(
            name="quaternion-order",
            assumption="a quaternion is in the other order: wxyz for xyzw, or xyzw for wxyz",
            signature="same frames, lengths and places; a body is drawn turned wrong",
            misread=_exchange_scalar_and_vector,
            about="an orientation that is stored as a quaternion",
            seen_in="https://github.com/isaac-sim/IsaacLab/pull/5754",
        ),
        BreakMode(
            name="delta-for-absolute",
            assumption="the action is by how much to move on, not where to be",
            signature="same state, frames and lengths; what is asked for runs away, and the arm does not follow",
            misread=_take_targets_for_changes,
            about="an action of which the reading says that it is a position",
            seen_in="https://github.com/TEA-Lab/DemoGen/issues/4",
        ),
        BreakMode(
            name="gripper-inverted",
            assumption="the gripper of the state is open where it is closed",
            signature="goals on the gripper turn round; it opens where it is asked to close",
            misread=_turn_the_gripper_round,
            about="a gripper in the state, by its name, of which the reading says both limits",
            seen_in="https://github.com/OpenDriveLab/AgiBot-World/issues/133",
        ),
    )
}


def break_mode(name: str) -> BreakMode:
    """Look a break mode up.

    Raises
    ------
    ValueError
        If there is none of that name; the message lists those that there are.
    """
    if name not in BREAK_MODES:
        raise ValueError(f"found break mode {name!r}, expected one of {', '.join(BREAK_MODES)}")
    return BREAK_MODES[name]
