"""What do pictures look like? Some are decoded, and made so small that those of many episodes fit into memory.

And what is a part of a video by itself? It is cut out and not encoded again. Both need PyAV, the extra ``video``.
"""

import importlib.util
import io
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple, cast

import numpy as np
from numpy.typing import NDArray

from z2r.arrays import Array, Ints
from z2r.errors import DatasetError, Fault, MissingExtraError
from z2r.format.images import format_of, read_pictures
from z2r.format.mp4 import VideoIndex
from z2r.format.store import inside, open_mapped

if TYPE_CHECKING:
    import av
    from av.video.reformatter import VideoReformatter

HEIGHT, WIDTH = 48, 64
_MAX_PIXELS = 2**26  # of a picture; a decoder refuses what is larger
_AHEAD = 32  # pictures: at most so many are decoded before one that is shown earlier
_MOMENT = 1e-6  # s
_AT_ONCE = 2**21  # bytes of a video that is far away: a decoder asks for little, and then for what comes next
_DECODERS = {"jpeg": "mjpeg"}  # of the formats whose decoder has another name
_ROWS = 8  # of a picture, of which one is looked at in its full size
_PARTS = (4, 8)  # of a picture: rows and columns of them


class Small(NamedTuple):
    """What is kept of a picture.

    Attributes
    ----------
    colours : ndarray, uint8[48, 64, 3]
        The picture, whatever its shape was: each cell is the mean of what it covers, in RGB, from 0 to 255.
    grain : float
        How far each pixel is from the next, as a root mean square, in standard deviations of the picture: about 1.4
        where each is by chance, little where the picture is blurred.
    sharpness : float
        How far a pixel is from the next one on average, in a part as most are, beside the mean brightness.
    comb : tuple of float
        How far a row is from the middle of the two around it, and these from each other, both squared.
    """

    colours: NDArray[np.uint8]
    grain: float
    sharpness: float
    comb: tuple[float, float]


def can_decode() -> bool:
    """Tell whether PyAV is there."""
    return importlib.util.find_spec("av") is not None


def check_can_decode() -> None:
    """Check that PyAV is there.

    Raises
    ------
    MissingExtraError
        If it is not.
    """
    if not can_decode():
        raise MissingExtraError("decoding pictures needs PyAV. In a clone of the course: pip install '.[video]'")


def decode_video(root: Path, path: Path, index: VideoIndex, wanted: Ints) -> Iterator[tuple[int, Small]]:
    """Decode some pictures of a video, and of the others only those that they need.

    Parameters
    ----------
    root, path : Path
        The dataset, and the video relative to it.
    index : VideoIndex
        What the video says of itself.
    wanted : ndarray, int64[n]
        The numbers of the pictures in the order in which they are shown, from 0; ascending, at least one.

    Yields
    ------
    number, picture : int, ndarray of uint8
        In whatever order.

    Raises
    ------
    DatasetError
        If the bytes cannot be decoded.
    """
    from av import FFmpegError
    from av import open as open_container
    from av.video.reformatter import VideoReformatter

    whole, reformatter = inside(root, path), VideoReformatter()
    try:
        # Left to itself, FFmpeg takes bytes for whatever they look like, a list of other files and addresses as well.
        with open_mapped(whole, _AT_ONCE) as bytes_of_it, open_container(bytes_of_it, format="mp4") as file:
            stream = file.streams.video[0]
            decoder = stream.codec_context
            decoder.options = {"max_pixels": str(_MAX_PIXELS)}
            unit = float(stream.time_base or 1)  # s
            file.seek(int(index.times[key_before(index, wanted[0])] / unit), stream=stream)
            for packet in (*_packets(file.demux(stream), index, unit, wanted), None):
                for frame in decoder.decode(packet):
                    number = _number(index, unit, frame.pts)
                    if number in wanted:
                        yield number, _small(frame, reformatter)
    except (FFmpegError, OSError) as error:
        raise _undecodable(whole, "", error) from None


class Cut(NamedTuple):
    """Which pictures of a video a clip is made of.

    Attributes
    ----------
    key, first, end : int
        It begins with picture `key`, since the `first` one that is wanted cannot be decoded without it, and goes to the
        one before `end`.
    """

    key: int
    first: int
    end: int


def key_before(index: VideoIndex, number: int) -> int:
    """Return the number of the last picture up to one that can be decoded alone; 0 where none can."""
    keys = np.flatnonzero(index.is_key[: number + 1])
    return int(keys[-1]) if len(keys) else 0


def plan_cut(index: VideoIndex, start: float, stop: float, max_bytes: int) -> tuple[Cut, int]:
    """Plan a clip of the pictures from one time to another [s], or of as many of the first ones as there is room for.

    Returns
    -------
    cut : Cut
        Where nothing is shown at that time, or there is no room, its `end` is its `first`.
    n_bytes : int
        How many bytes its pictures take.
    """
    half = 0.5 / (index.fps or 1)
    first, end = np.searchsorted(index.times, (start - half, stop - half)).tolist()
    key = key_before(index, first)
    sizes = np.cumsum(index.sizes[key:end])
    end = max(first, key + int(np.searchsorted(sizes, max_bytes, side="right")))
    return Cut(key, first, end), int(sizes[end - key - 1]) if end > first else 0


def cut_clip(root: Path, path: Path, index: VideoIndex, cut: Cut) -> bytes:
    """Cut a clip out of a video, with the same bytes: an mp4 of its own that begins with picture `cut.key` at 0 s.

    Parameters
    ----------
    root, path : Path
        The dataset, and the video relative to it.
    index : VideoIndex
        What the video says of itself.
    cut : Cut
        Of `plan_cut`.

    Raises
    ------
    DatasetError
        If the video cannot be taken apart.
    """
    from av import FFmpegError
    from av import open as open_container

    whole, made = inside(root, path), io.BytesIO()
    try:
        with (
            open_mapped(whole, _AT_ONCE) as bytes_of_it,
            open_container(bytes_of_it, format="mp4") as file,
            open_container(made, "w", format="mp4", options={"fflags": "bitexact"}) as clip,
        ):
            stream = file.streams.video[0]
            copy = clip.add_stream_from_template(stream)
            unit = float(stream.time_base or 1)  # s
            begin, after = round(index.times[cut.key] / unit), round(index.times[cut.end - 1] / unit)
            file.seek(begin, stream=stream)
            for packet in file.demux(stream):
                # Packets come in the order of decoding: whatever a picture needs has come before its own time.
                if packet.pts is None or packet.dts is None or packet.dts > after:
                    break
                if packet.pts < begin:
                    continue
                packet.pts, packet.dts = packet.pts - begin, packet.dts - begin
                packet.stream = copy
                clip.mux(packet)
    except (FFmpegError, OSError, ValueError) as error:
        raise _undecodable(whole, "", error) from None
    return made.getvalue()


def decode_clip(clip: bytes, begin: float, every: float, width: int) -> Iterator[NDArray[np.uint8]]:
    """Decode a picture of a clip every so many seconds.

    Parameters
    ----------
    clip : bytes
        From `cut_clip`.
    begin : float
        The time of the first [s].
    every : float
        How long to the next [s].
    width : int
        How wide to make them [pixels].

    Yields
    ------
    ndarray, uint8[height, width, 3]
        In RGB.

    Raises
    ------
    DatasetError
        If the bytes cannot be decoded.
    """
    from av import FFmpegError
    from av import open as open_container

    due = begin
    try:
        with open_container(io.BytesIO(clip), "r", format="mp4") as file:
            file.streams.video[0].codec_context.options = {"max_pixels": str(_MAX_PIXELS)}
            for frame in file.decode(video=0):
                if frame.time is not None and frame.time >= due - _MOMENT:
                    due += every
                    height = max(2, round(width * frame.height / frame.width))
                    small = frame.reformat(width, height, "rgb24", interpolation="AREA")
                    yield small.to_ndarray().astype(np.uint8, copy=False)
    except FFmpegError as error:
        raise _undecodable(Path(), "", error) from None


def decode_images(root: Path, path: Path, feature: str, wanted: Ints) -> Iterator[tuple[int, Small]]:
    """Decode some of the images that stand in a data file: the same for rows of it, and in their order.

    Raises
    ------
    DatasetError
        If the bytes cannot be decoded.
    """
    import av
    from av.video.reformatter import VideoReformatter

    reformatter = VideoReformatter()
    for row, picture in read_pictures(root, path, feature, wanted):
        kind = format_of(picture)
        if kind is None:
            continue
        decoder = cast(av.VideoCodecContext, av.CodecContext.create(_DECODERS.get(kind.kind, kind.kind), "r"))
        decoder.options = {"max_pixels": str(_MAX_PIXELS)}
        try:
            for frame in (*decoder.decode(av.Packet(picture)), *decoder.decode(None)):
                yield row, _small(frame, reformatter)
        except av.error.FFmpegError as error:
            raise _undecodable(inside(root, path), f"{feature} in row {row}", error) from None


def _packets(packets: "Iterator[av.Packet]", index: VideoIndex, unit: float, wanted: Ints) -> "Iterator[av.Packet]":
    """Yield the packets that must be decoded: those from a key picture to the last one that is wanted and needs it."""
    ahead = 0 if index.is_key[wanted].all() else _AHEAD
    key_of = np.cumsum(index.is_key)
    last = dict(zip(key_of[wanted].tolist(), wanted.tolist(), strict=True))  # of the wanted ones of each key picture
    for packet in packets:
        if packet.pts is None:
            return
        number = _number(index, unit, packet.pts)
        if number <= last.get(int(key_of[number]), -1 - ahead) + ahead:
            yield packet
        if number >= wanted[-1] + ahead:
            return


def _number(index: VideoIndex, unit: float, pts: int | None) -> int:
    """Return which picture is shown at a time, given in units of so many seconds."""
    return -1 if pts is None else int(np.searchsorted(index.times, pts * unit - _MOMENT))


def _small(frame: "av.VideoFrame", reformatter: "VideoReformatter") -> Small:
    small = reformatter.reformat(frame, WIDTH, HEIGHT, "rgb24", interpolation="AREA").to_ndarray()
    bright = _brightness(frame)
    rows = bright[::_ROWS].astype(np.float32)
    steps = np.diff(rows, axis=1) if frame.width > 1 else np.zeros_like(rows)
    return Small(
        colours=small.astype(np.uint8, copy=False),
        grain=float(steps.std() / max(rows.std(), 1)),
        sharpness=float(np.median(_means(np.abs(steps))) / max(rows.mean(), 1)),
        comb=_comb(bright),
    )


def _means(steps: NDArray[np.float32]) -> NDArray[np.float32]:
    """Return the mean of each part of the picture, as far as they are of one size."""
    height, width = (max(size // n_parts, 1) for size, n_parts in zip(steps.shape, _PARTS, strict=True))
    down, along = steps.shape[0] // height, steps.shape[1] // width
    means: NDArray[np.float32] = (
        steps[: down * height, : along * width].reshape(down, height, along, width).mean(axis=(1, 3))
    )
    return means


def _comb(bright: Array) -> tuple[float, float]:
    above, between, below = (bright[first : len(bright) - 2 + first : _ROWS].astype(np.float32) for first in range(3))
    off, apart = between - (above + below) / 2, below - above
    return float(np.vdot(off, off)), float(np.vdot(apart, apart))


def _brightness(frame: "av.VideoFrame") -> Array:
    """Return how bright each pixel is, (height, width): videos have it, and others are converted."""
    if frame.format.name != "yuv420p":
        return frame.reformat(format="gray").to_ndarray()
    plane = frame.planes[0]
    return np.frombuffer(plane, np.uint8).reshape(-1, plane.line_size)[: frame.height, : frame.width]


def _undecodable(path: Path, field: str, error: Exception) -> DatasetError:
    found = f"pictures that cannot be decoded ({type(error).__name__})"
    return DatasetError(Fault(path, field, found, "whole pictures", "Copy, download or encode it again"))
