"""What do some pictures of each episode look like, once they are decoded? What is kept of them is a few numbers.

About fifty pictures of each episode of each camera are looked at, spread over it, and made small; of each third one the
next two as well, as what flickers, hangs or is out of order is seen from one picture to the next only. The first and
the last three are among them.
"""

from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import Executor
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from z2r.arrays import Array, Bools, Floats, Ints, Progress, join_all
from z2r.audits.footage import Footage, ImageSums, VideoSums, longest_rests
from z2r.audits.frames import FileClaims
from z2r.audits.hues import hues_of
from z2r.audits.runs import FileSums, Runs
from z2r.audits.signs import Signs, signs_of
from z2r.errors import DatasetError, Fault
from z2r.format.about import cameras_of
from z2r.format.dataset import in_order
from z2r.format.decoding import Small, decode_images, decode_video
from z2r.format.rules import episodes_of
from z2r.format.videos import read_video

_PICTURES = 48  # of an episode
_ENOUGH = 24  # that can be decoded alone: where there are fewer, the others are decoded too
_EACH = 3  # of these, with which the next two are looked at
_FEW = 8  # pictures: from fewer nothing is said
_EPISODES = 8  # at a time
_BANDS = 12  # of a picture, one above the other
_BRIGHTNESS = np.array([0.299, 0.587, 0.114], dtype=np.float32)  # of red, green and blue: ITU-R BT.601
_PRINTS = np.array([0.1, 0.4, 0.6, 0.9])  # of the way through an episode


class Filmed(NamedTuple):
    """All that is known of the pictures before any is decoded.

    Attributes
    ----------
    footage : Footage
        Of the videos.
    runs : Runs
        Where the frames of the episodes are.
    images : dict of str to ImageSums
        Of the cameras whose pictures stand in the data files, and can be read in all of them; for each run.
    places : ndarray, float32[n_runs, 129, size], or None
        Where the robot is in each run, from `sum_places`; only where pictures are decoded.
    files : dict of int to FileClaims
        The data files that can be read, by their numbers.
    """

    footage: Footage
    runs: Runs
    images: dict[str, ImageSums]
    places: Floats | None
    files: dict[int, FileClaims]


def join_filmed(footage: Footage, runs: Runs, parts: Sequence[tuple[FileClaims, FileSums]]) -> Filmed:
    """Put what is kept of the data files that can be read after each other."""
    return Filmed(
        footage=footage,
        runs=runs,
        images=join_all([said.images for _, said in parts]),
        places=join_all([said.places for _, said in parts]),
        files=dict(zip(runs.read, (file for file, _ in parts), strict=True)),
    )


class Glance(NamedTuple):
    """What is kept of the pictures of one episode of one camera.

    Attributes
    ----------
    frame : ndarray, float64[n]
        Which frames they are of, counted from 0 in the episode.
    level, spread : ndarray, float64[n]
        How bright each is, from 0 to 255, and how far from one brightness: the standard deviation over it.
    grain : ndarray, float64[n]
        As in `Small`.
    change, peak : ndarray, float64[n - 1]
        How far each is from the one before, on average over the picture, and where it is farthest.
    prints : ndarray, uint8[4, 24, 32]
        Some of them, smaller still.
    near, far, across : ndarray, float64[n_threes], float64[n - 1], float64[n - n // 2]
        How far the first of three frames in a row is from the next frame, each of `frame` from the next of these, and
        from that half the episode later: on average over the picture, all made as bright.
    threes : ndarray, float64[n_threes, 3]
        Of three frames in a row: how far the first is from the second, the second from the third, and the first from
        the third, as a root mean square over 12 x 16 parts of them, in which noise hardly counts.
    swing : ndarray, float64[n_threes]
        How much brighter or darker the second is than the two around it, on average over bands from edge to edge: a
        rolling shutter sees the swing of a lamp in bands.
    colours : ndarray, float64[2, 3]
        Red, green and blue on average, from 0 to 1, and so of their squares.
    cells : ndarray, float16[n, 48]
        How bright each of 6 x 8 parts of them is, where the whole is 128: so that no exposure matters.
    view : ndarray, uint8[12, 16, 3]
        What is there most of the time: the median of all of them, in RGB.
    still : ndarray, uint8[48, 64]
        The same of brightness and of a third of them, and not as small.
    hues : ndarray, float64[3, 4]
        As in `hues_of`.
    signs : Signs
        How they are made.
    ends : ndarray, uint8[2, 3, 24, 32], or None
        The first three frames, and the last three, the last of them first: how bright. None where one is not decoded.
    rest : ndarray, int64[2], or None
        Of a video, from `longest_rests`: from which frame on pictures hardly change for longest, and for how many.
    """

    frame: Floats
    level: Floats
    spread: Floats
    grain: Floats
    change: Floats
    peak: Floats
    near: Floats
    threes: Floats
    swing: Floats
    far: Floats
    across: Floats
    prints: NDArray[np.uint8]
    colours: Floats
    cells: NDArray[np.float16]
    view: NDArray[np.uint8]
    still: NDArray[np.uint8]
    hues: Floats
    signs: Signs
    ends: NDArray[np.uint8] | None
    rest: Ints | None


class Reel(NamedTuple):
    """Some episodes that one camera shows in one file.

    Attributes
    ----------
    camera, path : str, Path
        Which feature it is, and the file, relative to the dataset.
    rows, lengths : ndarray of int
        Which rows of the episode metadata they are, and how many frames they have.
    begins : ndarray
        When each begins in a video [s], or in which row of a data file.
    is_video : bool
        Which of the two it is.
    """

    camera: str
    path: Path
    rows: Ints
    lengths: Ints
    begins: Floats | Ints
    is_video: bool


class Glances(NamedTuple):
    """What was seen: of each camera the episodes, by their rows in the metadata; and what cannot be decoded."""

    cameras: dict[str, dict[int, Glance]]
    faults: tuple[Fault, ...]


def glance_at(filmed: Filmed, progress: Progress, executor: Executor | None) -> Glances:
    """Decode some pictures of each episode, of a few episodes at a time."""
    claims = filmed.footage.claims
    reels = [part for reel in (*_reels_of_videos(filmed), *_reels_of_images(filmed)) for part in _parts(reel)]
    cameras: dict[str, dict[int, Glance]] = {camera.name: {} for camera in cameras_of(claims.schema)}
    n_episodes = sum(len(reel.rows) for reel in reels)
    number = claims.stored.episodes.value.table.number
    work, faults, done = partial(_look, claims.root, claims.schema.fps), dict[Fault, list[int]](), 0
    for reel, said in zip(reels, in_order(work, reels, executor), strict=True):
        if isinstance(said, Fault):
            faults.setdefault(said, []).extend(reel.rows.tolist())
        else:
            cameras[reel.camera] |= said
        done += len(reel.rows)
        progress(done, n_episodes)
    named = (fault._replace(episodes=episodes_of(number, np.array(rows))) for fault, rows in faults.items())
    return Glances(cameras, tuple(named))


def _reels_of_videos(filmed: Filmed) -> Iterator[Reel]:
    for video, said in zip(filmed.footage.videos, filmed.footage.sums, strict=True):
        if isinstance(said, VideoSums):
            yield Reel(video.camera, video.path, video.rows, video.lengths, video.start, is_video=True)


def _reels_of_images(filmed: Filmed) -> Iterator[Reel]:
    """Only of episodes that are in one data file as a whole."""
    runs, table = filmed.runs, filmed.runs.claims.stored.episodes.value.table
    order = np.argsort(table.number, kind="stable")
    row = order[np.minimum(np.searchsorted(table.number[order], runs.number), len(order) - 1)]
    whole = (table.number[row] == runs.number) & (table.length[row] == runs.stop - runs.start)
    for file_number, file in filmed.files.items():
        own = whole & (runs.file_number == file_number)
        for camera in filmed.images:
            yield Reel(camera, file.path, row[own], table.length[row[own]], runs.start[own] - file.base, is_video=False)


def _parts(reel: Reel) -> Iterator[Reel]:
    """Cut it into parts of a few episodes."""
    for first in range(0, len(reel.rows), _EPISODES):
        some = slice(first, first + _EPISODES)
        yield reel._replace(rows=reel.rows[some], lengths=reel.lengths[some], begins=reel.begins[some])


def _look(root: Path, fps: float, reel: Reel) -> dict[int, Glance] | Fault:
    try:
        return dict(_look_at_video(root, fps, reel) if reel.is_video else _look_at_images(root, reel))
    except DatasetError as error:
        return error.fault.relative_to(root)


def _look_at_video(root: Path, fps: float, reel: Reel) -> Iterator[tuple[int, Glance]]:
    index = read_video(root, reel.path)
    starts = np.searchsorted(index.times, reel.begins - 0.5 / fps)
    stops = np.searchsorted(index.times, reel.begins + (reel.lengths - 0.5) / fps)
    spans = [*zip(starts.tolist(), stops.tolist(), strict=True)]
    wanted = [_some(index.is_key, *span) for span in spans]
    more = [_with_next(some, *span) for some, span in zip(wanted, spans, strict=True)]
    numbers = np.unique(np.concatenate(more))
    pictures = dict(decode_video(root, reel.path, index, numbers)) if len(numbers) else {}
    rests = longest_rests(index, np.array(spans))
    for row, begins, some, span, rest in zip(reel.rows.tolist(), reel.begins, wanted, spans, rests, strict=True):
        seen = some[np.isin(some, list(pictures))]
        if len(seen) >= _FEW:
            yield row, _glance((index.times[seen] - begins) * fps, seen, pictures, span, rest)


def _look_at_images(root: Path, reel: Reel) -> Iterator[tuple[int, Glance]]:
    wanted = [_evenly(np.arange(n)) + first for n, first in zip(reel.lengths, reel.begins, strict=True)]
    begins = reel.begins.astype(np.int64)
    spans = [*zip(begins.tolist(), (begins + reel.lengths).tolist(), strict=True)]
    more = [_with_next(some, *span) for some, span in zip(wanted, spans, strict=True)]
    pictures = dict(decode_images(root, reel.path, reel.camera, np.unique(np.concatenate(more))))
    for row, some, span in zip(reel.rows.tolist(), wanted, spans, strict=True):
        seen = some[np.isin(some, list(pictures))]
        if len(seen) >= _FEW:
            yield row, _glance((seen - span[0]).astype(np.float64), seen, pictures, span, None)


def _some(is_key: Bools, start: int, stop: int) -> Ints:
    """Choose some pictures of a span: of those that can be decoded alone, if they are enough."""
    keys = start + np.flatnonzero(is_key[start:stop])
    enough = min(_ENOUGH, (stop - start) // 2)
    return _evenly(keys if len(keys) >= enough else np.arange(start, stop))


def _with_next(numbers: Ints, start: int, stop: int) -> Ints:
    """Add the two pictures after each third one, if they are not the next episode's, and both ends of this one."""
    following = (numbers[::_EACH, None] + np.arange(1, 3)).ravel()
    more = np.union1d(numbers, following[following < stop])
    return np.union1d(more, _ends(start, stop)) if len(numbers) >= _FEW else more


def _ends(start: int, stop: int) -> Ints:
    """Return the first three pictures of a span, and the last three, the last of them first: int64[2, 3]."""
    return np.stack([np.arange(start, start + 3), np.arange(stop - 1, stop - 4, -1)])


def _evenly(numbers: Ints) -> Ints:
    n = min(_PICTURES, len(numbers))
    return numbers[np.linspace(0, len(numbers) - 1, n).round().astype(np.int64)] if n else numbers


def _glance(
    frame: Floats, numbers: Ints, pictures: Mapping[int, Small], span: tuple[int, int], rest: Ints | None
) -> Glance:
    colours = np.stack([pictures[number].colours for number in numbers.tolist()]).astype(np.float32)  # (n, 48, 64, 3)
    seen = colours @ _BRIGHTNESS  # (n, 48, 64)
    first = [number for number in numbers[::_EACH].tolist() if {number + 1, number + 2} <= pictures.keys()]
    rows = [[pictures[number + ahead].colours for ahead in range(3)] for number in first]
    threes = np.array(rows, dtype=np.float32).reshape(-1, 3, *colours.shape[1:])
    in_a_row = threes @ _BRIGHTNESS  # (n_threes, 3, 48, 64)
    bright, (one, two, three) = _as_bright(seen), np.moveaxis(_as_bright(in_a_row), 1, 0)
    bands = in_a_row.reshape(len(threes), 3, _BANDS, -1).mean(axis=3, dtype=np.float64)
    apart = np.abs(np.diff(seen, axis=0))
    pixels = colours[::_EACH].reshape(-1, 3) / 255
    n, height, width = seen.shape
    quarters = colours.reshape(n, height // 4, 4, width // 4, 4, 3).mean(axis=(2, 4))
    return Glance(
        frame=frame,
        level=seen.mean(axis=(1, 2)).astype(np.float64),
        spread=seen.std(axis=(1, 2)).astype(np.float64),
        grain=np.array([pictures[number].grain for number in numbers.tolist()]),
        change=apart.mean(axis=(1, 2)).astype(np.float64),
        peak=apart.max(axis=(1, 2)).astype(np.float64),
        near=_apart(one, two),
        threes=np.stack([_coarsely_apart(one, two), _coarsely_apart(two, three), _coarsely_apart(one, three)], axis=1),
        swing=np.abs(bands[:, 1] - bands[:, ::2].mean(axis=1)).mean(axis=1),
        far=_apart(bright[:-1], bright[1:]),
        across=_apart(bright[: n - n // 2], bright[n // 2 :]),
        colours=np.stack([each.mean(axis=0, dtype=np.float64) for each in (pixels, np.square(pixels))]),
        prints=_smaller(seen[(_PRINTS * (n - 1)).round().astype(np.int64)]),
        cells=bright.reshape(n, height // 8, 8, width // 8, 8).mean(axis=(2, 4)).reshape(n, -1).astype(np.float16),
        view=np.median(quarters, axis=0).round().astype(np.uint8),
        still=np.median(seen[::_EACH], axis=0).round().astype(np.uint8),
        hues=hues_of(colours),
        signs=signs_of([pictures[number] for number in numbers.tolist()], colours, seen),
        ends=_how_bright(_ends(*span), pictures),
        rest=rest,
    )


def _how_bright(numbers: Ints, pictures: Mapping[int, Small]) -> NDArray[np.uint8] | None:
    """Return how bright some pictures are, (a, b): (a, b, 24, 32)."""
    flat = numbers.ravel().tolist()
    if not set(flat) <= pictures.keys():
        return None
    small = _smaller(np.stack([pictures[number].colours for number in flat]).astype(np.float32) @ _BRIGHTNESS)
    return small.reshape(*numbers.shape, *small.shape[1:])


def _smaller(seen: Array) -> NDArray[np.uint8]:
    """Make pictures (n, height, width) half as high and half as wide."""
    n, height, width = seen.shape
    quarters = seen.reshape(n, height // 2, 2, width // 2, 2).mean(axis=(2, 4))
    small: NDArray[np.uint8] = quarters.round().astype(np.uint8)
    return small


def _as_bright(seen: Array) -> Floats:
    """Make pictures (..., height, width) as bright as each other: 128 on average."""
    as_bright: Floats = seen * (128 / np.maximum(seen.mean(axis=(-2, -1), keepdims=True), 1))
    return as_bright


def _apart(some: Floats, others: Floats) -> Floats:
    """Return how far pictures are from others, on average over each: (n,)."""
    apart: Floats = np.abs(others - some).mean(axis=(1, 2)).astype(np.float64)
    return apart


def _coarsely_apart(some: Floats, others: Floats) -> Floats:
    """Return how far parts of pictures are from those of others, as a root mean square over each: (n,)."""
    n, height, width = some.shape
    parts = (others - some).reshape(n, height // 4, 4, width // 4, 4).mean(axis=(2, 4))
    apart: Floats = np.sqrt(np.square(parts).mean(axis=(1, 2))).astype(np.float64)
    return apart
