"""What is read of the pictures, and what is kept of them? A few numbers for each episode; none of them is decoded.

Videos are files of their own, of which the index is read. Images stand in the data files, with the frames.
"""

import hashlib
from collections.abc import Sequence
from concurrent.futures import Executor
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from z2r.arrays import Bools, Floats, Ints, reduce_parts
from z2r.audits.claims import Claims
from z2r.audits.frames import FileFrames
from z2r.errors import DatasetError, Fault
from z2r.format.about import cameras_of
from z2r.format.dataset import in_order
from z2r.format.images import Format, Images, Prints, read_images
from z2r.format.mp4 import VideoIndex
from z2r.format.schema import ACTION, STATE
from z2r.format.videos import read_video

_ALIKE = 2  # bytes: what is encoded alike differs by no more
_ENDS = 2  # pictures
_MANY = 4  # pictures from one that can be decoded alone to the next
_PLACES = 129  # of the robot in each episode: enough to know where it is in between
_MAX_LENGTH = 2**31  # frames of an episode: a sum of lengths that somebody claims must not overflow

# Measured on h264, hevc and av1 as LeRobot encodes them, 96 x 96 to 480 x 640: a picture that is the same as the one
# before takes 18 to 66 bytes.
_SAME, _PIXELS_TO_A_SAME_BYTE = 48, 4096

# Measured from 96 x 96 to 480 x 640: one colour takes 107 to 1,949 bytes as PNG (level 6), and 771 to 5,429 as JPEG;
# the plainest drawing 492 to 2,726, and 1,317 to 8,710.
_FLAT = {"png": (300, 450), "jpeg": (700, 171)}


# --- videos


class VideoClaims(NamedTuple):
    """What the metadata says of one video.

    Attributes
    ----------
    camera : str
        Which feature it is.
    path : Path
        Relative to the dataset.
    rows : ndarray, int64[n_episodes]
        Which rows of the episode metadata name it.
    lengths : ndarray, int64[n_episodes]
        How many frames these episodes have.
    start, stop : ndarray, float64[n_episodes]
        From when to when they are shown [s].
    """

    camera: str
    path: Path
    rows: Ints
    lengths: Ints
    start: Floats
    stop: Floats

    @property
    def n_frames(self) -> int:
        """How many frames all of these episodes have."""
        return int(self.lengths.sum())


class Pictures(NamedTuple):
    """What the index of a video says of the pictures of each episode in it.

    Attributes
    ----------
    off : ndarray, float64[n_episodes]
        How far the nearest picture is from the time of a frame, where it is farthest [s]; nan where there are fewer
        pictures than frames.
    key, other : ndarray, float64[n_episodes]
        What a picture takes that can be decoded alone, and one that cannot [bytes]: their geometric mean, which a few
        large ones hardly change; nan where there is none.
    alike : ndarray, bool[n_episodes]
        Whether all pictures of each of the two sorts take the same, within two bytes; at both ends, where an encoder
        knows less or introduces itself, two are left out.
    """

    off: Floats
    key: Floats
    other: Floats
    alike: Bools


class VideoSums(NamedTuple):
    """What is kept of one video that can be read.

    Attributes
    ----------
    codec, height, width, fps, duration : str, int, int, float or None, float
        As in its index.
    n_pictures : int
        How many it has.
    sizes : bytes
        A digest of how many bytes each of them takes.
    in_a_row : int
        How many pictures in a row cannot be decoded alone, at most.
    pictures : Pictures
        Of each episode in it.
    """

    codec: str
    height: int
    width: int
    fps: float | None
    duration: float
    n_pictures: int
    sizes: bytes
    in_a_row: int
    pictures: Pictures


class Footage(NamedTuple):
    """All videos of a dataset: what the metadata says of each, and what it says itself, or why it cannot be read."""

    claims: Claims
    videos: Sequence[VideoClaims]
    sums: Sequence[VideoSums | Fault]


def read_footage(claims: Claims, executor: Executor | None) -> Footage:
    """Read the indices of all videos, some at a time; no picture is decoded."""
    videos = _video_claims(claims)
    work = partial(_fold_video, claims.root, claims.schema.fps)
    return Footage(claims, videos, [*in_order(work, videos, executor)])


def _video_claims(claims: Claims) -> list[VideoClaims]:
    """Say of each video what the metadata says of it."""
    lengths, videos = np.clip(claims.stored.episodes.value.table.length, 0, _MAX_LENGTH), []
    for camera, spans in claims.videos.value.items():
        order = np.argsort(spans.file_number, kind="stable")
        parts = np.split(order, np.searchsorted(spans.file_number[order], np.arange(1, len(spans.paths))))
        for path, rows in zip(spans.paths, parts, strict=True):
            videos.append(VideoClaims(camera, path, rows, lengths[rows], spans.start[rows], spans.stop[rows]))
    return videos


def _fold_video(root: Path, fps: float, claims: VideoClaims) -> VideoSums | Fault:
    """Read the index of a video, and keep what the rest of the dataset is held against."""
    try:
        index = read_video(root, claims.path)
    except DatasetError as error:
        return error.fault.relative_to(root)
    return VideoSums(
        codec=index.codec,
        height=index.height,
        width=index.width,
        fps=index.fps,
        duration=index.duration,
        n_pictures=len(index.times),
        sizes=hashlib.sha256(index.sizes).digest(),
        in_a_row=int(np.diff(np.flatnonzero(index.is_key), prepend=-1, append=len(index.is_key)).max()) - 1,
        pictures=_pictures(index, claims, 1 / fps),
    )


def _pictures(index: VideoIndex, claims: VideoClaims, step: float) -> Pictures:
    start = np.searchsorted(index.times, claims.start - step / 2)
    stop = np.searchsorted(index.times, claims.start + (claims.lengths - 0.5) * step)
    sorts = index.is_key, ~index.is_key
    key, other = (_typical_size(index.sizes, sort, start, stop) for sort in sorts)
    alike = np.logical_and(*(_are_alike(index.sizes, sort, start + _ENDS, stop - _ENDS) for sort in sorts))
    return Pictures(_distances(index.times, claims, step), key, other, alike)


def longest_rests(index: VideoIndex, spans: Ints) -> Ints:
    """Find where it takes next to nothing for longest that pictures change, in each span of a video.

    Parameters
    ----------
    index : VideoIndex
        Of which only that part is looked at in which the spans lie.
    spans : ndarray, int64[n_spans, 2]
        The first picture of each, and one past its last.

    Returns
    -------
    ndarray, int64[n_spans, 2]
        From which picture of the span on, and for how many.
    """
    first, end = int(spans[:, 0].min()), int(spans[:, 1].max())
    part = index._replace(times=index.times[first:end], is_key=index.is_key[first:end], sizes=index.sizes[first:end])
    rests = ~part.is_key & (part.sizes <= size_of_the_same(index.height * index.width))
    return _longest_rest(rests, rests | _keys_that_rest(part, rests), spans - first)


def _keys_that_rest(index: VideoIndex, rests: Bools) -> Bools:
    """Tell which of the pictures that can be decoded alone may be the same as the one before: bool[n_pictures].

    Of the same picture they take the same as the one before or after. One may differ where many others lie between.
    """
    may_rest, keys = np.zeros_like(rests), np.flatnonzero(index.is_key)
    alike = np.abs(np.diff(index.sizes[keys])) <= _ALIKE
    many = np.diff(keys, prepend=keys[:1]) >= _MANY
    between = many & rests[keys - 1] & rests[np.minimum(keys + 1, len(rests) - 1)]
    may_rest[keys] = np.append(alike, False) | np.append(False, alike) | between if len(keys) else False
    return may_rest


def size_of_the_same[T: (float, Floats)](n_pixels: T) -> T:
    """Return how many bytes a picture takes at most that is the same as the one before."""
    return _SAME + n_pixels / _PIXELS_TO_A_SAME_BYTE


def _longest_rest(rests: Bools, may_rest: Bools, spans: Ints) -> Ints:
    """Find where pictures rest for longest in each span: its first frame in it, and how many; int64[n_spans, 2].

    Between pictures that rest, others may, of which nobody knows.
    """
    longest = np.zeros_like(spans)
    some = spans[:, 0] < spans[:, 1]
    if not some.any():
        return longest
    row, n = np.arange(len(rests)), len(rests) + 1
    begin = np.maximum.accumulate(np.where(may_rest, 0, row + 1))  # of the stretch that each is in
    marks = np.zeros(len(rests), dtype=np.int64)
    marks[spans[some, 0]] = spans[some, 0]
    begin = np.maximum(begin, np.maximum.accumulate(marks))
    length = np.where(rests, row + 1 - begin, 0)
    best = reduce_parts(np.maximum, (length * n + begin)[:, None], *spans[some].T)[:, 0]
    longest[some] = np.stack([best % n - spans[some, 0], best // n], axis=1)
    return longest


def _distances(times: Floats, claims: VideoClaims, step: float) -> Floats:
    """Find how far the nearest picture is from the time of a frame, the farthest in each episode [s]."""
    off = np.full(len(claims.rows), np.nan)
    if not 0 < claims.n_frames <= len(times):
        return off
    first = np.cumsum(claims.lengths) - claims.lengths
    frame = np.arange(claims.n_frames) - np.repeat(first, claims.lengths)
    due = np.repeat(claims.start, claims.lengths) + frame * step
    after = np.minimum(np.searchsorted(times, due), len(times) - 1)
    distance = np.minimum(np.abs(times[after] - due), np.abs(times[np.maximum(after - 1, 0)] - due))
    some = claims.lengths > 0
    off[some] = np.maximum.reduceat(distance, first[some])
    return off


def _typical_size(sizes: Ints, sort: Bools, start: Ints, stop: Ints) -> Floats:
    """Take the geometric mean of the sizes of one sort of pictures in each span."""
    logs = np.concatenate([[0.0], np.cumsum(np.where(sort, np.log(np.maximum(sizes, 1)), 0))])
    n = np.concatenate([[0], np.cumsum(sort)])
    with np.errstate(invalid="ignore"):
        mean: Floats = np.exp((logs[stop] - logs[start]) / (n[stop] - n[start]))
    return mean


def _are_alike(sizes: Ints, sort: Bools, start: Ints, stop: Ints) -> Bools:
    """Tell of each span whether all pictures of one sort take the same, within some bytes."""
    some = start < stop
    alike = np.zeros(len(start), dtype=bool)
    if some.any():
        spans = start[some], stop[some]
        least = reduce_parts(np.minimum, np.where(sort, sizes, np.iinfo(np.int64).max)[:, None], *spans)
        most = reduce_parts(np.maximum, np.where(sort, sizes, 0)[:, None], *spans)
        alike[some] = ((most < least) | (most - least <= _ALIKE))[:, 0]
    return alike


# --- the robot


def sum_places(frames: FileFrames) -> Floats | None:
    """Say where the robot is, in each run, at `place_frames`: float32[n_runs, 129, size], in its own units.

    None where there is no camera, and neither state nor action.
    """
    moved = frames.read.frames.get(STATE, frames.read.frames.get(ACTION))
    if moved is None or not cameras_of(frames.schema):
        return None
    starts = frames.run_starts
    places: Floats = moved.astype(np.float32)[starts[:, None] + place_frames(np.diff(np.append(starts, len(moved))))]
    return places


def place_frames(n_frames: Ints) -> Ints:
    """Return at which frames of an episode the place of its robot is kept: int64[n, 129]."""
    return (np.linspace(0, 1, _PLACES) * (np.asarray(n_frames)[..., None] - 1)).round().astype(np.int64)


# --- images


class FileImages(NamedTuple):
    """The pictures that stand in one data file, by their feature, or why they cannot be read."""

    frames: FileFrames
    read: dict[str, Images | Fault]


class ImageSums(NamedTuple):
    """What is kept of the pictures of one camera, for each run of frames: all (n_runs,).

    Attributes
    ----------
    n_changes : ndarray of int
        How many pictures are another than the one before.
    prints : ndarray of uint64
        The same number where all pictures are the same, in the same order.
    tiny : ndarray of bool
        Whether none takes more than one of one colour does.
    rest : ndarray of int, (n_runs, 2)
        From which frame on they are the same for longest, and for how many frames.
    """

    n_changes: Ints
    prints: Prints
    tiny: Bools
    rest: Ints


def read_file_images(root: Path, frames: FileFrames) -> FileImages:
    """Look at all pictures in a data file, one feature after another."""
    read: dict[str, Images | Fault] = {}
    for name in (name for name in frames.read.present if _is_image(frames, name)):
        try:
            read[name] = read_images(root, frames.path, name)
        except DatasetError as error:
            read[name] = error.fault.relative_to(root)
    return FileImages(frames, read)


def sum_images(images: FileImages) -> dict[str, ImageSums]:
    """Sum the pictures up for each run of frames: those of features of which all can be read."""
    frames = images.frames
    said = {name: read for name, read in images.read.items() if isinstance(read, Images)}
    return {
        name: _sums(read, frames.run_starts)
        for name, read in said.items()
        if len(read.sizes) == frames.read.n_rows and read.formats
    }


def _is_image(frames: FileFrames, name: str) -> bool:
    feature = frames.schema.features.get(name)
    return feature is not None and feature.dtype == "image"


def _sums(images: Images, starts: Ints) -> ImageSums:
    changes = np.diff(images.prints, prepend=images.prints[:1]) != 0
    changes[starts] = False
    rests = ~changes
    rests[starts] = False  # the first may be like the last of the run before
    spans = np.stack([starts, np.append(starts[1:], len(rests))], axis=1)
    row = np.arange(len(images.prints), dtype=np.uint64)
    place = row - np.repeat(row[starts], np.diff(np.append(starts, len(row))))  # in its run
    return ImageSums(
        n_changes=np.add.reduceat(changes.astype(np.int64), starts),
        prints=np.add.reduceat(images.prints * (2 * place + 1), starts),
        tiny=np.maximum.reduceat(images.sizes, starts) <= _size_of_one_colour(next(iter(images.formats))),
        rest=_longest_rest(rests, rests, spans),
    )


def _size_of_one_colour(kind: Format | None) -> int:
    """Return how many bytes such a picture takes at most, if it shows but one colour."""
    if kind is None or kind.kind not in _FLAT:
        return 0
    least, per_byte = _FLAT[kind.kind]
    return least + kind.height * kind.width * kind.channels // per_byte
