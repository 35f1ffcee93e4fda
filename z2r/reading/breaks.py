"""How do I know that I read it right? Read it wrong on purpose, and learn what that looks like.

A break mode is a dataset read with one assumption wrong: about what its columns mean, or about where its frames are.
The files never change; what is believed about them does, and each wrong belief leaves a signature.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING

if TYPE_CHECKING:  # the command line lists the modes in its help, which must not wait for numpy and pyarrow
    from z2r.format.dataset import Dataset
    from z2r.reading.reading import Reading


def _right_reading(reading: Reading) -> Reading:
    return reading


def _right_dataset(dataset: Dataset) -> Dataset:
    return dataset


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
        What a reading must have for the mistake to be possible; empty where any dataset has it.
    reading : callable
        Turns the right reading into the wrong one; one that has nothing of what the mode is about stays as it is.
    dataset : callable
        Turns the dataset, as it is, into what somebody takes it for.
    seen_in : str
        Where it was met in the wild: an address.
    """

    name: str
    assumption: str
    signature: str
    about: str = ""
    reading: Callable[[Reading], Reading] = _right_reading
    dataset: Callable[[Dataset], Dataset] = _right_dataset
    seen_in: str = ""

    def applies_to(self, reading: Reading | None) -> bool:
        """Tell whether there is anything to get wrong: always, for a belief about files; else if the reading has it."""
        return not self.about or (reading is not None and self.reading(reading) != reading)


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


def _act_a_frame_late(reading: Reading) -> Reading:
    from msgspec.structs import replace as replace_in

    return replace_in(reading, action=replace_in(reading.action, lag=1)) if reading.action else reading


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
            seen_in="https://github.com/jayleicn/TVQA/issues/15",
        ),
        BreakMode(
            name="first-shard-only",
            assumption="the episode metadata is one file",
            signature="where there are more shards, fewer episodes than info.json says; the rest looks perfect",
            dataset=_first_shard_only,
            seen_in="https://github.com/huggingface/lerobot-dataset-visualizer/pull/11",
        ),
        BreakMode(
            name="stale-file-pointer",
            assumption="the first episode of a data file is in the file before it",
            signature="one episode is missing for each further data file; the rest looks perfect",
            dataset=_stale_file_pointer,
            seen_in="https://github.com/huggingface/lerobot/issues/2401",
        ),
        BreakMode(
            name="name-sorted-files",
            assumption="sorting file names sorts their numbers: file-10 comes before file-9",
            signature="where numbers are not padded, frames go to the wrong episodes, and bodies leap inside them",
            dataset=_sort_files_by_name,
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
            signature="as many are reached, same picture; the action explains the step before it, not the one after",
            reading=_act_a_frame_late,
            about="an action of which the reading says what it drives",
            seen_in="https://github.com/Lifelong-Robot-Learning/LIBERO/issues/54",
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
