"""What do the pictures show? Something, and it moves when the robot does."""

from collections.abc import Callable, Iterator, Sequence
from functools import partial
from itertools import combinations
from pathlib import Path
from typing import NamedTuple

import numpy as np

from z2r.arrays import Bools, Floats, Ints
from z2r.audits.cameras import CAMERA_TWIN
from z2r.audits.footage import Footage, ImageSums, VideoSums
from z2r.audits.runs import Runs
from z2r.check import Answer, Check
from z2r.errors import Fault
from z2r.format.episodes import DATA_DIR
from z2r.format.rules import and_more
from z2r.format.schema import ACTION, STATE

_MIN_EPISODES = 5  # from fewer nothing can be said about what is usual
_LONG = 20  # frames: a picture may well stand still for less
_SELDOM = 0.1  # of the episodes
_LOOK = "To be sure, look at the pictures: z2r audit --pictures"

# Measured on h264, hevc and av1 as LeRobot encodes them, 96 x 96 to 480 x 640: a picture of one colour takes 36 to 162
# bytes, the plainest drawing 255 to 2,135; a picture that is the same as the one before takes 18 to 66.
_FLAT, _PIXELS_TO_A_FLAT_BYTE = 64, 512
_SAME, _PIXELS_TO_A_SAME_BYTE = 48, 4096
_LITTLE = 0.25  # of what a change usually takes


class Look(NamedTuple):
    """What the pictures of one camera look like in each episode.

    Attributes
    ----------
    camera : str
        Which feature it is.
    place : Path
        Where they are stored.
    number : ndarray, int64[n_episodes]
        What the dataset calls the episodes.
    flat, still : ndarray, bool[n_episodes]
        Whether they are of one colour, and whether they stay the same although the robot moves.
    flat_found, still_found : callable
        Say what was found of one of the episodes, by its row.
    mend : str
        How to be surer of that; empty where it is sure.
    """

    camera: str
    place: Path
    number: Ints
    flat: Bools
    still: Bools
    flat_found: Callable[[int], str]
    still_found: Callable[[int], str]
    mend: str


class Twin(NamedTuple):
    """Two cameras, and in which of the episodes, by their rows, they show the same."""

    look: Look
    other: Look
    same: Bools


class Looks(NamedTuple):
    """What the pictures of all cameras look like, and which of them show the same, as far as that is known."""

    cameras: Sequence[Look]
    twins: Sequence[Twin]


CAMERA_FLAT = Check("camera-flat", "no camera shows one colour, as one that is covered or unplugged does", "warning")


@CAMERA_FLAT.of(Looks)
def no_camera_shows_one_colour(looks: Looks) -> Iterator[Answer]:
    """Does a camera show one flat colour throughout an episode?"""
    for look in looks.cameras:
        yield from _looks_wrong(look, look.flat, look.flat_found, "a picture of something")


CAMERA_FROZEN = Check(
    "camera-frozen", "no camera shows the same picture for an episode while the robot moves", "warning"
)


@CAMERA_FROZEN.of(Looks)
def no_camera_is_frozen(looks: Looks) -> Iterator[Answer]:
    """Does a camera show the same picture throughout an episode? One that always does may not see the robot: a note."""
    for look in looks.cameras:
        still = look.still & ~look.flat
        for fault in _looks_wrong(look, still, look.still_found, "pictures that change, as the robot moves"):
            yield ("warning" if _is_seldom(still, len(still)) else "note"), fault


@CAMERA_TWIN.of(Looks)
def no_two_cameras_show_the_same(looks: Looks) -> Iterator[Answer]:
    """Do two cameras show the same pictures throughout an episode? Of those of one colour, that is no wonder."""
    for twin in looks.twins:
        found = partial("the same pictures as {}".format, twin.other.camera)
        yield from _looks_wrong(twin.look, twin.same & ~twin.look.flat, found, "pictures of its own")


def _looks_wrong(look: Look, wrong: Bools, found: Callable[[int], str], expected: str) -> Iterator[Fault]:
    if wrong.any():
        row = int(wrong.argmax())
        place = f"{look.camera} in episode {look.number[row]}"
        yield Fault(look.place, place, f"{found(row)}{and_more(wrong)}", expected, look.mend)


def _is_seldom(wrong: Bools, n: int) -> bool:
    return bool(wrong.sum() <= max(1, _SELDOM * n))


def looks_of_sizes(footage: Footage, runs: Runs, images: dict[str, ImageSums]) -> Looks:
    """Tell from how many bytes each picture takes what it looks like: where nothing is decoded, most of it is a guess.

    Of images that stand in the data files, it is known which are the same.
    """
    moves = robot_moves(runs)
    of_videos = [_look_of_sizes(footage, camera, moves) for camera in footage.claims.videos.value]
    of_images = {camera: _look_of_images(camera, runs, sums, moves) for camera, sums in images.items()}
    twins = [
        Twin(of_images[camera], of_images[other], _episodes(runs, images[camera].prints == images[other].prints))
        for other, camera in combinations(images, 2)
    ]
    return Looks([*of_videos, *of_images.values()], twins)


def robot_moves(runs: Runs) -> Bools:
    """Tell of each episode of the metadata whether the robot moves in it, half as far as is usual or more."""
    number, of_signal = runs.claims.stored.episodes.value.table.number, runs.stats.get(STATE, runs.stats.get(ACTION))
    if of_signal is None:
        return np.zeros(len(number), dtype=bool)
    span = of_signal.high - of_signal.low  # (n_runs, size)
    usual = np.median(span, axis=0)
    share = np.minimum(span[:, usual > 0] / usual[usual > 0], 1)
    return np.isin(number, runs.number[share.sum(axis=1) >= 0.5 * np.maximum(1, (usual > 0).sum())])


def _look_of_sizes(footage: Footage, camera: str, moves: Bools) -> Look:
    table = footage.claims.stored.episodes.value.table
    key, other, pixels = np.full((3, len(table.number)), np.nan)
    alike = np.zeros(len(table.number), dtype=bool)
    place = Path()
    for video, said in zip(footage.videos, footage.sums, strict=True):
        if video.camera == camera and isinstance(said, VideoSums):
            rows, place = video.rows, video.path.parent
            key[rows], other[rows], alike[rows] = said.pictures.key, said.pictures.other, said.pictures.alike
            pixels[rows] = said.height * said.width
    long, usual = table.length >= _LONG, _median(other)
    return Look(
        camera=camera,
        place=place,
        number=table.number,
        flat=long & (key <= _FLAT + pixels / _PIXELS_TO_A_FLAT_BYTE),
        still=moves & _seem_still(long, other, alike, _SAME + pixels / _PIXELS_TO_A_SAME_BYTE),
        flat_found=lambda row: f"{key[row]:.0f} bytes a picture, no more than one colour takes",
        still_found=lambda row: f"{other[row]:.0f} bytes for a change of the picture, where {usual:.0f} are usual",
        mend=_LOOK,
    )


def _look_of_images(camera: str, runs: Runs, sums: ImageSums, moves: Bools) -> Look:
    same = sums.n_changes == 0
    return Look(
        camera=camera,
        place=DATA_DIR,
        number=runs.claims.stored.episodes.value.table.number,
        flat=_episodes(runs, same & sums.tiny),
        still=_episodes(runs, same) & moves,
        flat_found=lambda _: "the same picture in all frames, no larger than one colour takes",
        still_found=lambda _: "the same picture in all frames",
        mend="",
    )


def _episodes(runs: Runs, wrong: Bools) -> Bools:
    """Tell of each episode of the metadata whether it is one of these runs, and a long one."""
    found: Bools = np.isin(runs.claims.stored.episodes.value.table.number, _numbers(runs, wrong))
    return found


def _numbers(runs: Runs, wrong: Bools) -> Ints:
    return runs.number[wrong & (runs.stop - runs.start >= _LONG)]


def _seem_still(long: Bools, change: Floats, alike: Bools, little: Floats) -> Bools:
    """Tell in which episodes a change takes next to nothing, or always the same: in a few of them, or in nearly all."""
    less = change <= np.minimum(little, _LITTLE * _median(change))
    seldom, always = long & (less | alike), long & alike & ~(change > little)
    if long.sum() >= _MIN_EPISODES and _is_seldom(seldom, long.sum()):
        return seldom
    return always if _is_seldom(long & ~always, long.sum()) else np.zeros_like(long)


def _median(values: Floats) -> float:
    return float(np.median(values[~np.isnan(values)])) if not np.isnan(values).all() else np.nan
