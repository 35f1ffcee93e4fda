"""What are the pictures that stand in a data file? Of which format and size, and which of them are the same.

LeRobot stores a feature of dtype ``image`` as a column of ``struct<bytes, path>``, a whole PNG in each row (the feature
`Image` of the `datasets` library). None is decoded: the head of a picture says what it is, and its length and some of
its bytes whether it is the same as another.
"""

import struct
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from z2r.arrays import Bools, Ints
from z2r.format.episodes import DataFile
from z2r.format.parquet import blobs, open_parquet
from z2r.format.store import inside

type Prints = NDArray[np.uint64]

_SAMPLE = 32  # bytes: the last of a PNG hold a check sum of all of them
_HEAD = 26  # bytes: in a PNG, up to its size, its depth and its colours
_MAX_SEGMENTS = 64  # of a JPEG, before the one that says its size
_MAX_FORMATS = 100
_PNG, _PNG_END = b"\x89PNG\r\n\x1a\n", b"IEND\xaeB`\x82"
_PNG_CHANNELS = {0: 1, 2: 3, 3: 3, 4: 2, 6: 4}  # by its type of colours
_OTHERS = {b"II*\0": "tiff", b"MM\0*": "tiff", b"RIFF": "webp", b"GIF8": "gif", b"BM": "bmp"}
_WEIGHTS = np.random.default_rng(0).integers(2**63, size=3 * _SAMPLE, dtype=np.uint64) * 2 + 1


class Format(NamedTuple):
    """What the head of a picture says of it; of formats other than PNG and JPEG, only which one it is."""

    kind: str
    height: int = 0
    width: int = 0
    channels: int = 0


class Images(NamedTuple):
    """The pictures of one feature in one data file.

    Attributes
    ----------
    sizes : ndarray, int64[n_rows]
        What each takes [bytes]; 0 where there is none.
    prints : ndarray, uint64[n_rows]
        The same number for the same picture.
    formats : dict of Format or None to int
        Which formats there are, each with its first row; None is something else than a whole picture.
    """

    sizes: Ints
    prints: Prints
    formats: dict[Format | None, int]


def read_images(root: Path, path: Path, feature: str) -> Images:
    """Look at the pictures of a feature in a data file, some at a time; `path` is relative to `root`.

    Raises
    ------
    DatasetError
        If there is no such column, it is of another type, or its bytes cannot be read.
    """
    whole = inside(root, path)
    sizes: list[Ints] = [np.empty(0, np.int64)]
    prints: list[Prints] = [np.empty(0, np.uint64)]
    heads: set[bytes] = set()
    formats: dict[Format | None, int] = {}
    n_rows = 0
    for data, offsets in blobs(open_parquet(whole), feature, "bytes", whole):
        size = np.diff(offsets)
        samples = _samples(data, offsets[:-1], size)
        for row, head in enumerate(np.ascontiguousarray(samples[:, :_HEAD]).view(f"V{_HEAD}")[:, 0].tolist()):
            if size[row] and head not in heads and len(formats) < _MAX_FORMATS:
                heads.add(head)
                formats.setdefault(format_of(data[offsets[row] : offsets[row + 1]].tobytes()), n_rows + row)
        if (cut := _are_cut(samples)).any():
            formats.setdefault(None, n_rows + int(cut.argmax()))
        sizes.append(size)
        prints.append(samples.astype(np.uint64) @ _WEIGHTS + size.astype(np.uint64))
        n_rows += len(size)
    return Images(np.concatenate(sizes), np.concatenate(prints), formats)


def read_pictures(root: Path, path: Path, feature: str, wanted: Ints) -> Iterator[tuple[int, bytes]]:
    """Yield some rows of a data file, and the bytes of the picture that is stored in each: none where there is none.

    Parameters
    ----------
    root, path : Path
        The dataset, and the data file relative to it.
    feature : str
        Of dtype ``image``.
    wanted : ndarray, int64[n]
        Rows, ascending.

    Raises
    ------
    DatasetError
        If there is no such column, it is of another type, or its bytes cannot be read.
    """
    whole, first = inside(root, path), 0
    for data, offsets in blobs(open_parquet(whole), feature, "bytes", whole):
        if not len(wanted) or first > wanted[-1]:
            return
        for row in wanted[(wanted >= first) & (wanted < first + len(offsets) - 1)].tolist():
            yield row, data[offsets[row - first] : offsets[row - first + 1]].tobytes()
        first += len(offsets) - 1


def encoded_pictures(
    root: Path, files: Sequence[DataFile], feature: str, frames: Ints
) -> Iterator[tuple[int, bytes, str]]:
    """Yield which of some frames it is, ascending, its picture as it is encoded, and of which media type that is.

    Frames without a picture, or with bytes that are none, are left out.

    Parameters
    ----------
    root : Path
        The dataset.
    files : sequence of DataFile
        Its data files.
    feature : str
        Of dtype ``image``.
    frames : ndarray, int64[n]
        Counted over the dataset, ascending.

    Raises
    ------
    DatasetError
        If there is no such column, it is of another type, or its bytes cannot be read.
    """
    for file in files:
        places = np.flatnonzero((frames >= file.from_index) & (frames < file.to_index))
        rows = frames[places] - file.from_index
        pictures = read_pictures(root, file.path.relative_to(root), feature, rows) if len(rows) else ()
        for place, (_, picture) in zip(places.tolist(), pictures, strict=False):
            if kind := format_of(picture):
                yield place, picture, f"image/{kind.kind}"


def format_of(picture: bytes) -> Format | None:
    """Read what the head of a picture says; None where it is none, or one that was cut off before it says its size.

    >>> format_of(b"GIF89a")
    Format(kind='gif', height=0, width=0, channels=0)
    """
    try:
        if picture.startswith(_PNG):
            width, height, colours = struct.unpack_from(">IIxB", picture, 16)
            return Format("png", height, width, _PNG_CHANNELS[colours])
        if picture.startswith(b"\xff\xd8"):
            return _format_of_jpeg(picture)
    except (struct.error, KeyError):
        return None
    return next((Format(kind) for magic, kind in _OTHERS.items() if picture.startswith(magic)), None)


def _format_of_jpeg(picture: bytes) -> Format | None:
    """Go from segment to segment to the one that begins a frame, which says its size."""
    place = 2
    for _ in range(_MAX_SEGMENTS):
        mark, kind, size = struct.unpack_from(">BBH", picture, place)
        if mark != 0xFF:
            return None
        if 0xC0 <= kind <= 0xCF and kind not in (0xC4, 0xC8, 0xCC):
            return Format("jpeg", *struct.unpack_from(">HHB", picture, place + 5))
        place += 2 + size
    return None


def _are_cut(samples: NDArray[np.uint8]) -> Bools:
    """Tell which of them begin as a PNG, and do not end as one."""
    begins, ends = (np.frombuffer(mark, np.uint8) for mark in (_PNG, _PNG_END))
    cut: Bools = (samples[:, : len(begins)] == begins).all(axis=1) & (samples[:, -len(ends) :] != ends).any(axis=1)
    return cut


def _samples(data: NDArray[np.uint8], start: Ints, size: Ints) -> NDArray[np.uint8]:
    """Take some bytes from the head, the middle and the end of each: (n, 3 * _SAMPLE)."""
    if not len(data):
        return np.zeros((len(start), 3 * _SAMPLE), np.uint8)
    firsts = 0 * size, size // 2, size - _SAMPLE
    places = np.concatenate([first[:, None] + np.arange(_SAMPLE) for first in firsts], axis=1)
    within = np.clip(places, 0, np.maximum(size - 1, 0)[:, None])
    samples: NDArray[np.uint8] = data[np.minimum(start[:, None] + within, len(data) - 1)]
    return samples
