"""What does a video hold? The index of an mp4, its `moov` box, read without a decoder.

An mp4 is a row of boxes, each with its size and four letters in front; some hold boxes again. The layout is that of
ISO/IEC 14496-12, which is also QuickTime's. A picture is shown when FFmpeg shows it, and so LeRobot.
"""

import struct
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from z2r.arrays import Bools, Floats, Ints
from z2r.errors import DatasetError, Fault, printable
from z2r.format.store import check_no_pointer, fault_of, inside, open_mapped

if TYPE_CHECKING:
    import pyarrow as pa

_MAX_PICTURES = 2**22  # in one file: 39 hours at 30 fps; LeRobot begins a new one every 200 MB
_MAX_INDEX_BYTES = 64 * 2**20
_MAX_BOXES = 1000  # side by side: an mp4 has some ten
_A_VIDEO, _WHOLE = "a video", "a whole mp4"
_AGAIN = "Copy, download or encode it again"

# What FFmpeg calls them, and so LeRobot, by the four letters in the file.
_CODECS = {"avc1": "h264", "avc3": "h264", "hvc1": "hevc", "hev1": "hevc", "av01": "av1", "vp09": "vp9"}

type _Boxes = dict[bytes, memoryview]


class VideoIndex(NamedTuple):
    """What the index of a video says of its pictures, in the order in which they are shown.

    Attributes
    ----------
    codec : str
        As LeRobot names it, such as ``av1``; another one by the four letters in the file.
    height, width : int
        In pixels.
    times : ndarray, float64[n_pictures]
        When each is shown [s], from the beginning of the file.
    sizes : ndarray, int64[n_pictures]
        How many bytes each takes.
    is_key : ndarray, bool[n_pictures]
        Whether it can be decoded without those before it.
    duration : float
        Until the last one is taken away [s].
    """

    codec: str
    height: int
    width: int
    times: Floats
    sizes: Ints
    is_key: Bools
    duration: float

    @property
    def fps(self) -> float | None:
        """How many pictures are shown in a second; None where there are too few to say."""
        step = float(np.median(np.diff(self.times))) if len(self.times) > 1 else 0.0
        return 1 / step if step > 0 else None


class _DamagedError(ValueError):
    """What is in the index cannot be."""


def read_video_index(root: Path, path: Path) -> VideoIndex:
    """Read the index of a video; `path` is relative to `root`. No picture is decoded, and no size is believed.

    Raises
    ------
    DatasetError
        If the file is missing, a pointer of Git LFS, cut off, or no mp4; if there is no video in it, or its index
        cannot be, or is spread over the file.
    """
    whole = inside(root, path)
    try:
        check_no_pointer(whole, _A_VIDEO)
        with open_mapped(whole) as file:
            return _read_tracks(_find_index(file, whole), file.size())
    except OSError as error:
        raise DatasetError(fault_of(error, whole, _A_VIDEO)) from None
    except (struct.error, ValueError, IndexError) as error:  # the last two: numpy, of a table that ends too soon
        found = f"an index (moov) that cannot be: {error}"
        raise DatasetError(Fault(whole, "", found, _WHOLE, _AGAIN)) from None


def _find_index(file: "pa.NativeFile", path: Path) -> memoryview:
    """Walk over the outermost boxes, of which only the heads are read, and see that none of them is cut off."""
    size, start, index = file.size(), 0, b""
    for _ in range(_MAX_BOXES):
        if start == size:
            break
        kind, head, length = _head(file.read_at(16, start), size - start)
        if not start and not kind.isalnum():
            raise DatasetError(Fault(path, "", "bytes that are no mp4", _WHOLE, _AGAIN))
        if kind == b"moof":
            mend = "This puts it there: ffmpeg -i old.mp4 -c copy -movflags faststart new.mp4"
            raise DatasetError(Fault(path, "", "an index in many parts (a fragmented mp4)", "one index (moov)", mend))
        if length > size - start:
            found, expected = f"{size:,} bytes: it is cut off", f"{start + length:,} bytes, as it says itself"
            raise DatasetError(Fault(path, "", found, expected, _AGAIN))
        if kind == b"moov":
            if length > _MAX_INDEX_BYTES:
                expected = f"at most {_MAX_INDEX_BYTES:,}"
                raise DatasetError(Fault(path, "moov", f"an index of {length:,} bytes", expected))
            index = file.read_at(length - head, start + head)
        start += length
    if not index:
        mend = "A recording that crashed never wrote it, and no picture is found without it: record it again"
        raise DatasetError(Fault(path, "", f"no index (moov) in its {size:,} bytes: it is cut off", _WHOLE, mend))
    return memoryview(index)


def _head(begins: bytes | memoryview, left: int) -> tuple[bytes, int, int]:
    """Read which box begins here, and how many bytes its head, and all of it, take; 0 says all that are left."""
    if len(begins) < 8:
        return b"", 0, left + 1
    size, kind = struct.unpack_from(">I4s", begins)
    head, size = (16, struct.unpack_from(">Q", begins, 8)[0]) if size == 1 else (8, size or left)
    return kind, head, max(size, head)


def _boxes(data: memoryview) -> Iterator[tuple[bytes, memoryview]]:
    """Yield what is in each of the boxes that lie side by side."""
    start = 0
    for _ in range(_MAX_BOXES):
        if len(data) - start < 8:  # QuickTime closes some rows with four zeros
            return
        kind, head, size = _head(data[start : start + 16], len(data) - start)
        if size > len(data) - start:
            raise _DamagedError(f"its part {_spelled(kind)} is longer than the whole")
        yield kind, data[start + head : start + size]
        start += size
    raise _DamagedError(f"more than {_MAX_BOXES} parts side by side")


def _get(boxes: _Boxes, kind: bytes, n_bytes: int = 0) -> memoryview:
    """Return what is in one of the boxes, of at least so many bytes."""
    data = boxes.get(kind)
    if data is None or len(data) < n_bytes:
        raise _DamagedError(f"no {_spelled(kind)}" if data is None else f"{_spelled(kind)} of {len(data)} bytes")
    return data


def _spelled(kind: bytes) -> str:
    return printable(kind.decode("latin-1"))


def _read_tracks(moov: memoryview, file_size: int) -> VideoIndex:
    """Read the first track that is a video."""
    movie = dict(_boxes(moov))
    for track in (dict(_boxes(data)) for kind, data in _boxes(moov) if kind == b"trak"):
        media = dict(_boxes(_get(track, b"mdia")))
        if bytes(_get(media, b"hdlr")[8:12]) == b"vide":
            return _read_video(movie, track, media, file_size)
    raise _DamagedError("no video among its tracks")


def _read_video(movie: _Boxes, track: _Boxes, media: _Boxes, file_size: int) -> VideoIndex:
    tables = dict(_boxes(_get(dict(_boxes(_get(media, b"minf"))), b"stbl")))
    codec, height, width = _sample_entry(_get(tables, b"stsd"))
    sizes = _sample_sizes(_get(tables, b"stsz", 12), file_size)
    scale, movie_scale = _timescale(media, b"mdhd"), _timescale(movie, b"mvhd")
    step = _each(_get(tables, b"stts"), ">u4", len(sizes))
    at = np.cumsum(step) - step
    if b"ctts" in tables:  # a picture that others need is decoded before it is shown
        at += _each(tables[b"ctts"], ">i4", len(sizes))
    number = np.arange(len(sizes)) + 1
    is_key = np.isin(number, _numbers(tables[b"stss"], ">u4", 1) if b"stss" in tables else number)
    order = np.argsort(at, kind="stable")
    place, times = _edited(track, at[order], scale, movie_scale)
    rows = order[place]
    ends = times + step[rows] / scale
    return VideoIndex(codec, height, width, times, sizes[rows], is_key[rows], float(ends.max(initial=0)))


def _timescale(boxes: _Boxes, kind: bytes) -> int:
    """Return how many units of time are a second; two dates stand before it, in 4 or in 8 bytes."""
    data = _get(boxes, kind, 24)
    scale: int = struct.unpack_from(">I", data, 20 if data[0] else 12)[0]
    if not scale:
        raise _DamagedError(f"{_spelled(kind)} counts no time")
    return scale


def _sample_entry(stsd: memoryview) -> tuple[str, int, int]:
    """Read the codec, the height and the width of the first sort of picture; there is but one, or they differ."""
    for kind, entry in _boxes(stsd[8:]):
        height, width = struct.unpack_from(">HH", entry, 24)[::-1]
        name = _spelled(kind)
        return _CODECS.get(name, name), height, width
    raise _DamagedError("no codec (stsd)")


def _sample_sizes(stsz: memoryview, file_size: int) -> Ints:
    of_all, n = struct.unpack_from(">II", stsz, 4)
    if n > _MAX_PICTURES or of_all * n > file_size:
        raise _DamagedError(f"{n:,} pictures, more than {_MAX_PICTURES:,} or than the file has room for")
    sizes = np.full(n, of_all) if of_all else np.frombuffer(stsz, ">u4", n, 12).astype(np.int64)
    if sizes.sum() > file_size:
        raise _DamagedError(f"pictures of {sizes.sum():,} bytes in a file of {file_size:,}")
    return sizes


def _numbers(data: memoryview, dtype: str, columns: int) -> Ints:
    """Read a table of numbers, which says in front how many rows it has."""
    [n] = struct.unpack_from(">I", data, 4)
    return np.frombuffer(data, dtype, n * columns, 8).astype(np.int64).reshape(n, columns)


def _each(data: memoryview, dtype: str, n: int) -> Ints:
    """Read a number for each picture from a table that says how often each number comes."""
    times, values = _numbers(data, dtype, 2).T
    if times.min(initial=0) < 0 or times.sum() != n:
        raise _DamagedError(f"numbers for {times.sum():,} pictures, and there are {n:,}")
    return np.repeat(values, times)


def _edited(track: _Boxes, at: Ints, scale: int, movie_scale: int) -> tuple[Ints, Floats]:
    """Say which pictures are shown, and when [s], by the list of cuts; all of them, where there is none."""
    edits = dict(_boxes(track[b"edts"])).get(b"elst") if b"edts" in track else None
    if edits is None:
        return np.arange(len(at)), at / scale
    cuts, begins = [], 0.0
    for length, first in _cuts(edits):
        if first >= 0:  # else nothing is shown for so long
            end = first + length * scale / movie_scale if length else np.inf
            start, stop = np.searchsorted(at, [first, end]).tolist()
            cuts.append((np.arange(start, stop), begins + (at[start:stop] - first) / scale))
        if sum(len(rows) for rows, _ in cuts) > _MAX_PICTURES:
            raise _DamagedError("a list of cuts (elst) that shows pictures again and again")
        begins += length / movie_scale
    rows, times = (np.concatenate([np.arange(0), *parts]) for parts in zip(*cuts, strict=True)) if cuts else ([], [])
    return np.asarray(rows, np.int64), np.asarray(times, np.float64)


def _cuts(elst: memoryview) -> Iterator[tuple[int, int]]:
    """Yield how long each cut is, in the units of the movie, and where it begins, in those of the track; or -1."""
    form = ">Qq4x" if _get({b"elst": elst}, b"elst", 8)[0] else ">Ii4x"
    [n] = struct.unpack_from(">I", elst, 4)
    if n > _MAX_BOXES:
        raise _DamagedError(f"a list of {n:,} cuts (elst)")
    yield from struct.iter_unpack(form, elst[8 : 8 + n * struct.calcsize(form)])
