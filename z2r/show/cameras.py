"""What did the robot see? The pictures of its cameras, as they lie on disk: none is decoded.

A video goes into the recording as a whole, and every frame refers to its own moment of it. Where all videos together
are too large, they are cut to what is shown, which PyAV does without decoding either.
"""

from itertools import islice
from pathlib import Path
from typing import NamedTuple

import numpy as np
import rerun as rr

from z2r.arrays import Floats, Ints
from z2r.errors import DatasetError, Fault, count
from z2r.format.about import cameras_of, short_names
from z2r.format.dataset import Dataset
from z2r.format.decoding import Cut, can_decode, cut_clip, key_before
from z2r.format.episodes import EpisodeIndex
from z2r.format.images import encoded_pictures
from z2r.format.mp4 import VideoIndex
from z2r.format.store import inside, read_bytes
from z2r.format.videos import read_films, read_video
from z2r.show.recorder import Recorder

MAX_BYTES = 200 * 2**20
"""Of all pictures in a recording; LeRobot begins a new video at this size."""

_SLACK = 1.0  # s: so far outside of a video, its first or its last picture is shown
_WRONG_TIME = "meta/episodes (from_timestamp) says where in it they are"
_MAX_IMAGES = 64  # at a time
_LESS = "Show one episode of it: z2r inspect --episode N. With PyAV, the extra video, it is cut to that"


class Seen(NamedTuple):
    """What of the cameras is in a recording.

    Attributes
    ----------
    cameras : dict of str to str
        Where the pictures of each camera are, by what to call it.
    left_out : tuple of str
        What is not there, and why.
    """

    cameras: dict[str, str]
    left_out: tuple[str, ...]


class _Clip(NamedTuple):
    """A video, which of the frames that are shown are in it, and when it shows them [s]."""

    camera: str
    path: Path
    video: VideoIndex
    frames: Ints
    time: Floats

    @property
    def cut(self) -> Cut:
        """The pictures that are needed."""
        at = np.searchsorted(self.video.times, [self.time.min(), self.time.max()], side="right") - 1
        first, last = at.clip(min=0).tolist()
        return Cut(key_before(self.video, first), first, last + 1)


def send_cameras(recorder: Recorder, dataset: Dataset, episodes: EpisodeIndex) -> Seen:
    """Send the pictures of all frames of some episodes, those of each camera as `cameras/<name>`.

    Parameters
    ----------
    recorder : Recorder
        Where they go.
    dataset : Dataset
        Where they are.
    episodes : EpisodeIndex
        What is shown, counted over the whole dataset.
    """
    names = [camera.name for camera in cameras_of(dataset.schema)]
    labels = dict(zip(names, short_names(names), strict=True))
    entities = {name: f"cameras/{rr.escape_entity_path_part(label)}" for name, label in labels.items()}
    clips, lost, faults = _find_clips(dataset, episodes)
    sent, left = set(), MAX_BYTES
    cut = sum(int(clip.video.sizes.sum()) for clip in clips) > MAX_BYTES and can_decode()
    for clip in clips:
        try:
            left -= _send_video(recorder, dataset.root, clip, entities[clip.camera], cut=cut, most=left)
            sent.add(clip.camera)
        except DatasetError as error:
            faults.append(error.fault.relative_to(dataset.root))
            lost.append((clip.camera, clip.frames))
    for name in (name for name in names if dataset.schema.features[name].dtype == "image"):
        try:
            left -= _send_images(recorder, dataset, name, entities[name], episodes.frame_numbers, left)
            sent.add(name)
        except DatasetError as error:
            faults.append(error.fault.relative_to(dataset.root))
    for name, frames in lost:
        if name in sent:  # or what was seen last would stay
            recorder.clear(entities[name], frames[(np.diff(frames, prepend=-1) > 1)])
    return Seen(
        {labels[name]: entities[name] for name in names if name in sent}, tuple(map(str, dict.fromkeys(faults)))
    )


def _find_clips(dataset: Dataset, episodes: EpisodeIndex) -> tuple[list[_Clip], list[tuple[str, Ints]], list[Fault]]:
    """Find the videos that are needed; of those that cannot be read, the frames that nobody sees, and why."""
    films, faults = read_films(dataset.root, dataset.schema, episodes)
    clips, lost, found = [], [], list(faults)
    for camera, film in films.items():
        for number, path in enumerate(film.paths):
            frames = np.flatnonzero(film.file_number == number)
            try:
                video = read_video(dataset.root, path)
            except DatasetError as error:
                found.append(error.fault.relative_to(dataset.root))
                lost.append((camera, frames))
                continue
            time = film.time[frames]
            inside_it = (time > -_SLACK) & (time < video.duration + _SLACK)
            if inside_it.any():
                clips.append(_Clip(camera, path, video, frames[inside_it], time[inside_it]))
            if not inside_it.all():
                what = f"{count(int((~inside_it).sum()), 'frame')} outside of it"
                found.append(Fault(path, "", what, f"moments from 0 to {video.duration:g} s", _WRONG_TIME))
                lost.append((camera, frames[~inside_it]))
    return clips, lost, found


def _send_video(recorder: Recorder, root: Path, clip: _Clip, entity: str, *, cut: bool, most: int) -> int:
    """Send a video, or what is needed of it, and for each frame when that shows it; return how many bytes it takes."""
    needed, sizes = clip.cut, clip.video.sizes
    size = int(sizes[needed.key : needed.end].sum() if cut else sizes.sum())
    if size > most:
        raise DatasetError(Fault(root / clip.path, "", f"{size:,} bytes to show", f"at most {most:,}", _LESS))
    if cut:
        contents, begins = cut_clip(root, clip.path, clip.video, needed), clip.video.times[needed.key]
    else:
        contents, begins = read_bytes(inside(root, clip.path), 2 * MAX_BYTES, "a video"), 0.0
    part = f"{entity}/{rr.escape_entity_path_part('-'.join(clip.path.with_suffix('').parts[-2:]))}"
    recorder.static(part, rr.AssetVideo(contents=contents, media_type="video/mp4"))
    videos = rr.VideoFrameReference.columns(video_reference=[part] * len(clip.frames))
    times = rr.VideoFrameReference.columns_nanos(np.rint(1e9 * (clip.time - begins)).astype(np.int64))
    recorder.columns(entity, rr.ComponentColumnList([*times, *videos]), clip.frames)
    return len(contents)


def _send_images(recorder: Recorder, dataset: Dataset, name: str, entity: str, frames: Ints, most: int) -> int:
    """Send the images of a feature as they are encoded; return how many bytes they take."""
    size, pictures = 0, encoded_pictures(dataset.root, dataset.files, name, frames)
    while some := list(islice(pictures, _MAX_IMAGES)):
        size += sum(len(picture) for _, picture, _ in some)
        if size > most:
            found = f"more than {most:,} bytes to show"
            raise DatasetError(Fault(dataset.files[0].path, name, found, f"at most {most:,}", _LESS))
        at, blobs, kinds = zip(*some, strict=True)
        recorder.columns(entity, rr.EncodedImage.columns(blob=blobs, media_type=kinds), np.array(at))
    return size
