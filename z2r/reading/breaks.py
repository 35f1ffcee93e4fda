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
    from z2r.reading.reading import PoseColumns, Reading


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
    reading : callable
        Turns the right reading into the wrong one.
    dataset : callable
        Turns the dataset, as it is, into what somebody takes it for.
    met : str
        Where it was met in the wild: an address, or a few words.
    """

    name: str
    assumption: str
    signature: str
    reading: Callable[[Reading], Reading] = lambda reading: reading
    dataset: Callable[[Dataset], Dataset] = lambda dataset: dataset
    met: str = ""


def _swap(pose: PoseColumns) -> PoseColumns:
    return replace(pose, sin_yaw=pose.cos_yaw, cos_yaw=pose.sin_yaw)


def _measure_from_pusher(reading: Reading) -> Reading:
    x, y = reading.pusher
    return replace(reading, tee=replace(reading.tee, x=x, y=y))


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
            assumption="the block's yaw is atan2(cos, sin)",
            signature="same frames and lengths; the success rate collapses; the block is drawn turned the wrong way",
            reading=lambda reading: replace(reading, tee=_swap(reading.tee)),
            met="https://github.com/rust-embedded/discovery/pull/444",
        ),
        BreakMode(
            name="drop-boundaries",
            assumption="there are no episodes",
            signature="all episodes become one, a success rate of 0/1 or 1/1; the block teleports",
            dataset=_drop_boundaries,
            met="https://github.com/strands-labs/robots/issues/708",
        ),
        BreakMode(
            name="yaw-swap-everywhere",
            assumption="every yaw is atan2(cos, sin), the target's too",
            signature="the two mistakes cancel: the success rate stays; every direction is mirrored, no position is",
            reading=lambda reading: replace(reading, tee=_swap(reading.tee), target=_swap(reading.target)),
            met="https://github.com/ngageoint/hootenanny/issues/2804",
        ),
        BreakMode(
            name="no-wrap",
            assumption="the error in yaw is the plain difference of two angles",
            signature="nothing, while the target's yaw is 0; errors of almost a whole turn as soon as it is near 180°",
            reading=lambda reading: replace(reading, wraps=False),
            met="https://github.com/AtsushiSakai/PythonRobotics/pull/1422",
        ),
        BreakMode(
            name="inclusive-end",
            assumption="an episode's range includes its end",
            signature="every length but the last is one more; success is read off the next episode; a leap at each end",
            dataset=_include_the_end,
            met="https://github.com/jayleicn/TVQA/issues/15",
        ),
        BreakMode(
            name="first-shard-only",
            assumption="the episode metadata is one file",
            signature="where there are more shards, fewer episodes than info.json says; the rest looks perfect",
            dataset=_first_shard_only,
            met="https://github.com/huggingface/lerobot-dataset-visualizer/pull/11",
        ),
        BreakMode(
            name="stale-file-pointer",
            assumption="the first episode of a data file is in the file before it",
            signature="one episode is missing for each further data file; the rest looks perfect",
            dataset=_stale_file_pointer,
            met="https://github.com/huggingface/lerobot/issues/2401",
        ),
        BreakMode(
            name="name-sorted-files",
            assumption="sorting file names sorts their numbers: file-10 comes before file-9",
            signature="where numbers are not padded, frames go to the wrong episodes, and the block leaps inside them",
            dataset=_sort_files_by_name,
            met="https://github.com/NVlabs/MobilityGen/pull/54",
        ),
        BreakMode(
            name="wrong-reference-point",
            assumption="the distance to the target is measured from the pusher",
            signature="distances of a few centimetres remain at the end; the pusher is drawn inside the block",
            reading=_measure_from_pusher,
            met="https://github.com/huggingface/gym-xarm/pull/14",
        ),
        BreakMode(
            name="degrees-for-radians",
            assumption="the tolerance on the yaw is in degrees",
            signature="same errors and pictures; almost no frame is in tolerance",
            reading=lambda reading: replace(reading, ang_tol=math.radians(reading.ang_tol)),
            met="https://github.com/strands-labs/robots/pull/693",
        ),
        BreakMode(
            name="first-frame-for-last",
            assumption="the first frame of an episode says whether it reached the target",
            signature="same frames and picture; nothing seems to reach the target, the errors are those of the start",
            reading=lambda reading: replace(reading, decisive="first"),
        ),
        BreakMode(
            name="wrong-fps",
            assumption="three times as many frames were taken in a second",
            signature="same success rate; everything lasts a third as long and moves three times as fast",
            dataset=_triple_fps,
            met="https://github.com/huggingface/lerobot/issues/336",
        ),
        BreakMode(
            name="action-lag",
            assumption="the action in a frame is the one that led to it, not the one taken in it",
            signature="same success rate and picture; the action explains the step before it, and not the one after",
            reading=lambda reading: replace(reading, action_lag=1),
            met="https://github.com/Lifelong-Robot-Learning/LIBERO/issues/54",
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
