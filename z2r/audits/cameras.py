"""Do the pictures belong to the frames? Videos and images, as far as that is told without decoding a picture."""

from collections.abc import Iterator
from typing import Any

import numpy as np

from z2r.arrays import Bools, Ints
from z2r.audits.footage import FileImages, Footage, VideoClaims, VideoSums
from z2r.audits.frames import FileFrames
from z2r.audits.index import TIME_TOLERANCE
from z2r.audits.structure import COLUMN_TYPE, DATA_FILE, VIDEO_FILE
from z2r.audits.values import FINITE
from z2r.check import Answer, Check
from z2r.errors import Fault, count
from z2r.format.about import axes_of, cameras_of, said_of
from z2r.format.episodes import EPISODES_DIR
from z2r.format.images import Format, Images
from z2r.format.rules import and_more, episodes_of
from z2r.format.schema import INFO_PATH, Feature
from z2r.format.store import digest

_CODECS = ("h264", "hevc", "av1", "vp9")  # those that the index of an mp4 tells apart
_COLOURS = 3  # LeRobot 0.6.1 decodes every video to RGB, but for depth maps (`lerobot/datasets/video_utils.py`)
_SAME_RATE = 0.01  # of the rate
_IN_A_ROW = 300  # pictures: encoders that are not told otherwise write 250
_NOT_ITS_OWN = "The metadata and the videos are of different recordings, or one was edited without the other"


@VIDEO_FILE.of(Footage)
def videos_can_be_read(footage: Footage) -> Iterator[Answer]:
    """Is every video there, whole, and with its index?"""
    for video, said in zip(footage.videos, footage.sums, strict=True):
        if isinstance(said, Fault):
            yield said._replace(episodes=_numbers(footage, video))


CAMERA_FORMAT = Check("camera-format", "pictures have the size, rate and codec that meta/info.json says", "error")


@CAMERA_FORMAT.of(Footage)
def videos_have_their_format(footage: Footage) -> Iterator[Answer]:
    """Has every video the size, the rate and the codec that the schema says?"""
    schema = footage.claims.schema
    sizes = {camera: _claimed_sizes(schema.features[camera]) for camera in footage.claims.videos.value}
    for video, said in _read(footage):
        size, named = (said.height, said.width), _numbers(footage, video)
        others = sizes.keys() - {video.camera}
        like = sorted(camera for camera in others if any(size in possible for possible in sizes[camera].values()))
        for place, possible in sizes[video.camera].items():
            if size not in possible:
                mend = f"{like[0]} has that size: are the two exchanged?" if like else ""
                expected = f"{_by(*possible[0])}, as {place} in meta/info.json says"
                yield Fault(video.path, "height x width", _by(*size), expected, mend, named)
        if _is_off(said.fps, schema.fps):
            mend = "LeRobot looks for the picture of a frame by its time: encode it again, or mend fps"
            expected = f"{schema.fps:g}, as meta/info.json says"
            yield Fault(video.path, "fps", f"{said.fps:.4g}", expected, mend, named)
        codec = said_of(schema.features[video.camera]).get("video.codec")
        if codec in _CODECS and said.codec != codec:
            expected = f"{codec}, as meta/info.json says"
            yield "note", Fault(video.path, "codec", said.codec, expected, episodes=named)


@CAMERA_FORMAT.of(Footage)
def the_schema_agrees_with_itself(footage: Footage) -> Iterator[Answer]:
    """Do the parts of `meta/info.json` that speak of a camera say the same, and what LeRobot makes of it?"""
    schema = footage.claims.schema
    for camera, fps in ((each.name, each.fps) for each in cameras_of(schema)):
        said, axes = said_of(schema.features[camera]), axes_of(schema.features[camera])
        is_depth = said.get("is_depth_map") or said.get("video.is_depth_map")
        channels = axes.get("channels", axes.get("channel"))
        is_video = schema.features[camera].dtype == "video"
        if is_video and not is_depth and channels not in (None, _COLOURS):
            expected = f"{_COLOURS}: LeRobot decodes every video to RGB that is not said to be a depth map"
            yield "warning", Fault(INFO_PATH, f"features.{camera}.shape", f"{channels} channels", expected)
        if _is_off(fps, schema.fps):
            place = f"features.{camera}.info.video.fps"
            yield "warning", Fault(INFO_PATH, place, fps, f"{schema.fps:g}, as fps says")


@CAMERA_FORMAT.of(Footage)
def pictures_can_be_read_by_themselves(footage: Footage) -> Iterator[Answer]:
    """How many pictures must be decoded to see one? All since the last that can be decoded alone."""
    for video, said in _read(footage):
        if said.in_a_row > _IN_A_ROW:
            found = f"{said.in_a_row:,} in a row that cannot be decoded alone"
            mend = "To read one frame, all before it are decoded: slow. Encode it again, with a smaller g"
            expected = f"{_IN_A_ROW} at most; LeRobot writes every second so that it can"
            yield "note", Fault(video.path, "pictures", found, expected, mend, _numbers(footage, video))


@Check("video-length", "a video has as many pictures as its episodes have frames", "error").of(Footage)
def video_length(footage: Footage) -> Iterator[Answer]:
    """Has every video as many pictures as its episodes have frames? More of them are harmless."""
    for video, said in _read(footage):
        n_frames = video.n_frames
        if said.n_pictures < n_frames:
            order = np.argsort(video.start, kind="stable")
            unseen = order[np.searchsorted(np.cumsum(video.lengths[order]), said.n_pictures, side="right") :]
            mend = f"There is no picture for what comes after: from episode {_number(footage, video, unseen[0])} on"
            found, named = count(said.n_pictures, "picture"), _numbers(footage, video, unseen)
            yield Fault(video.path, "", found, _for_frames(video), mend, named)
        elif said.n_pictures > n_frames:
            mend = "No frame needs the others"
            yield "note", Fault(video.path, "", count(said.n_pictures, "picture"), _for_frames(video), mend)


VIDEO_SPAN = Check("video-span", "an episode's span in its video is as long as its frames, and its own", "error")


@VIDEO_SPAN.of(Footage)
def spans_are_as_long_as_their_frames(footage: Footage) -> Iterator[Answer]:
    """Does every span run forwards, for as long as the episode takes?"""
    fps = footage.claims.schema.fps
    for camera, spans in footage.claims.videos.value.items():
        table = footage.claims.stored.episodes.value.table
        wrong = ~(np.abs(spans.stop - spans.start - table.length / fps) <= 0.5 / fps) | (spans.start < 0)
        if wrong.any():
            row = int(wrong.argmax())
            found = f"from {spans.start[row]:.6g} s to {spans.stop[row]:.6g} s{and_more(wrong)}"
            expected = f"{table.length[row] / fps:.6g} s, which is {count(table.length[row], 'frame')} at {fps:g} fps"
            place, named = f"videos/{camera} of episode {table.number[row]}", episodes_of(table.number, wrong)
            yield Fault(EPISODES_DIR, place, found, expected, _NOT_ITS_OWN, named)


@VIDEO_SPAN.of(Footage)
def spans_are_apart(footage: Footage) -> Iterator[Answer]:
    """Does each span begin where the one before it in the video has ended, in the order of the episodes?"""
    half = 0.5 / footage.claims.schema.fps  # of a picture, in s
    for video in footage.videos:
        order = np.argsort(video.start, kind="stable")
        start, stop = video.start[order], video.stop[order]
        overlaps = start[1:] < stop[:-1] - half
        if overlaps.any():
            place = int(overlaps.argmax())
            before, after = (_number(footage, video, order[each]) for each in (place, place + 1))
            found = f"{start[place + 1]:.6g} s{and_more(overlaps)}"
            expected = f"{stop[place]:.6g} s or more: until then, {video.path.as_posix()} shows episode {before}"
            field = f"videos/{video.camera}/from_timestamp of episode {after}"
            both = np.append(order[1:][overlaps], order[:-1][overlaps])
            yield Fault(EPISODES_DIR, field, found, expected, episodes=_numbers(footage, video, both))
        elif (back := np.diff(video.start) < 0).any():
            place = int(back.argmax())
            before, after = (_number(footage, video, each) for each in (place, place + 1))
            found = f"{video.start[place + 1]:.6g} s{and_more(back)}"
            expected = f"more than {video.start[place]:.6g} s, where episode {before} begins"
            field = f"videos/{video.camera}/from_timestamp of episode {after}"
            mend, both = "Two episodes may be exchanged: look at them", np.flatnonzero(back)
            named = _numbers(footage, video, np.append(both, both + 1))
            yield "warning", Fault(EPISODES_DIR, field, found, expected, mend, named)


@VIDEO_SPAN.of(Footage)
def spans_are_within_their_video(footage: Footage) -> Iterator[Answer]:
    """Does every span end before its video does?"""
    half = 0.5 / footage.claims.schema.fps  # of a picture, in s
    for video, said in _with_a_picture_for_each_frame(footage):
        wrong = video.stop > said.duration + half
        if wrong.any():
            place = int(wrong.argmax())
            found = f"{video.stop[place]:.6g} s{and_more(wrong)}"
            expected = f"{said.duration:.6g} s at most: then {video.path.as_posix()} ends"
            field = f"videos/{video.camera}/to_timestamp of episode {_number(footage, video, place)}"
            yield Fault(EPISODES_DIR, field, found, expected, _NOT_ITS_OWN, _numbers(footage, video, wrong))


@Check("video-time", "every frame has a picture at its time", "error").of(Footage)
def video_time(footage: Footage) -> Iterator[Answer]:
    """Has every frame a picture at its time, as near as LeRobot wants it? It reads no other."""
    for video, said in _with_a_picture_for_each_frame(footage):
        wrong = said.pictures.off > TIME_TOLERANCE
        if wrong.any():
            place = int(wrong.argmax())
            found = f"the nearest picture of a frame {1000 * said.pictures.off[place]:.4g} ms away{and_more(wrong)}"
            expected = f"{1000 * TIME_TOLERANCE:g} ms at most, the `tolerance_s` of LeRobot"
            field = f"videos/{video.camera}/from_timestamp of episode {_number(footage, video, place)}"
            mend = "LeRobot stops at such a frame"
            yield Fault(video.path, field, found, expected, mend, _numbers(footage, video, wrong))


@DATA_FILE.of(FileImages)
def images_can_be_read(images: FileImages) -> Iterator[Answer]:
    """Can the bytes of all pictures be read?"""
    yield from (said for said in images.read.values() if isinstance(said, Fault) and not said.field)


@COLUMN_TYPE.of(FileImages)
def images_are_bytes(images: FileImages) -> Iterator[Answer]:
    """Is a column of pictures one of bytes?"""
    yield from (said for said in images.read.values() if isinstance(said, Fault) and said.field)


@FINITE.of(FileImages)
def an_image_in_each_row(images: FileImages) -> Iterator[Answer]:
    """Is there a picture in each row?"""
    for name, said in images.read.items():
        if isinstance(said, Images) and (missing := said.sizes == 0).any():
            place = f"{name} in row {int(missing.argmax())}"
            found, named = f"no picture{and_more(missing)}", images.frames.episodes_in(missing)
            yield Fault(images.frames.path, place, found, "a picture for each frame", episodes=named)


@CAMERA_FORMAT.of(FileImages)
def images_have_their_format(images: FileImages) -> Iterator[Answer]:
    """Is every image one, of the size that the schema says?"""
    for name, said in images.read.items():
        for kind, row in said.formats.items() if isinstance(said, Images) else ():
            yield from _format_faults(images.frames, name, kind, row)


def _format_faults(frames: FileFrames, name: str, kind: Format | None, row: int) -> Iterator[Answer]:
    feature, place = frames.schema.features[name], f"{name} in row {row}"
    if kind is None:
        yield Fault(frames.path, place, "bytes that are no whole picture", "a PNG or a JPEG")
        return
    possible = _claimed_sizes(feature).get("shape", [])
    if kind.height and possible and (kind.height, kind.width) not in possible:
        found, expected = _by(kind.height, kind.width), f"{_by(*possible[0])}, as shape in meta/info.json says"
        yield Fault(frames.path, place, found, expected)
    axes = axes_of(feature)
    channels = axes.get("channels", axes.get("channel", kind.channels))
    if kind.channels and kind.channels != channels:
        expected = f"{channels}, as shape in meta/info.json says"
        yield Fault(frames.path, place, f"a picture of {kind.channels} channels", expected)


CAMERA_TWIN = Check("camera-twin", "no two cameras, no two videos and no two episodes show the same", "warning")


@CAMERA_TWIN.of(Footage)
def no_video_is_there_twice(footage: Footage) -> Iterator[Answer]:
    """Is the same video there twice? All of it is read only where all of its pictures take the same."""
    root, first = footage.claims.root, dict[bytes, VideoClaims]()
    whole = dict[bytes, VideoClaims]()
    for video, said in _read(footage):
        like = first.setdefault(said.sizes, video)
        if like is video:
            continue
        whole.setdefault(digest(root / like.path), like)
        same = whole.setdefault(digest(root / video.path), video)
        if same is not video:
            of_another = (
                f"the video of {same.camera}" if same.path == video.path else f"a copy of {same.path.as_posix()}"
            )
            named = _numbers(footage, video)
            yield Fault(video.path, video.camera, of_another, "a video of its own", episodes=named)


def _read(footage: Footage) -> Iterator[tuple[VideoClaims, VideoSums]]:
    """Yield the videos that can be read."""
    pairs = zip(footage.videos, footage.sums, strict=True)
    return ((video, said) for video, said in pairs if isinstance(said, VideoSums))


def _with_a_picture_for_each_frame(footage: Footage) -> Iterator[tuple[VideoClaims, VideoSums]]:
    """Yield the videos of the right rate that are long enough: what is wrong with the others has been said."""
    fps = footage.claims.schema.fps
    pairs = _read(footage)
    return ((video, said) for video, said in pairs if said.n_pictures >= video.n_frames and not _is_off(said.fps, fps))


def _number(footage: Footage, video: VideoClaims, place: int) -> int:
    """Return what the dataset calls an episode, by its place among those of a video."""
    return int(footage.claims.stored.episodes.value.table.number[video.rows[place]])


def _numbers(footage: Footage, video: VideoClaims, places: Bools | Ints | slice = slice(None)) -> tuple[int, ...]:
    """List what the dataset calls some episodes of a video, or all of them."""
    return episodes_of(footage.claims.stored.episodes.value.table.number, video.rows[places])


def _for_frames(video: VideoClaims) -> str:
    return f"{video.n_frames:,}, one for each frame of its {count(len(video.rows), 'episode')}"


def _is_off(fps: float | None, expected: float) -> bool:
    return fps is not None and abs(fps / expected - 1) > _SAME_RATE


def _by(height: int, width: int) -> str:
    return f"{height} x {width}"


def _claimed_sizes(feature: Feature) -> dict[str, list[tuple[Any, Any]]]:
    """Return the heights and widths that the schema leaves possible, by the place where it does."""
    axes, said, shape = axes_of(feature), said_of(feature), feature.shape
    sizes = {}
    if "height" in axes and "width" in axes:
        sizes["shape"] = [(axes["height"], axes["width"])]
    elif len(shape) == 3:  # (height, width, channels), or the other way round
        sizes["shape"] = [(shape[0], shape[1]), (shape[1], shape[2])]
    if "video.height" in said and "video.width" in said:
        sizes["info"] = [(said["video.height"], said["video.width"])]
    return sizes
