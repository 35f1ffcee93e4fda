"""What did the cameras see? Clips of the episodes that a page shows, as many as it has room for.

A clip is cut out of the video on disk and never encoded again. Where a camera has no video but a picture in each row,
some of these are taken as they are. Where there is nothing, the page says why.
"""

from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from z2r.arrays import Ints
from z2r.errors import DatasetError, MissingExtraError
from z2r.format.about import Camera
from z2r.format.dataset import Dataset
from z2r.format.decoding import Cut, check_can_decode, cut_clip, plan_cut
from z2r.format.episodes import EpisodeIndex, shard_paths
from z2r.format.images import encoded_pictures
from z2r.format.mp4 import VideoIndex
from z2r.format.tables import read_shard, read_stated
from z2r.format.videos import read_video, read_videos
from z2r.reading.inspection import Inspection

_NO_PICTURES = "There is no picture in the data files."
_NO_ROOM_FOR_PICTURES = "The page has no room for a picture of this episode."
_NOT_NAMED = "The episode metadata do not say where its videos are."
_TOO_SHORT = "Its video ends before this episode."
_NO_ROOM = "The page has no room for a clip of this episode."
_ALL = 2**62  # bytes
_PICTURES = 12  # of an episode, as soon as there is room for as many of the first: so many show how it went


class Clip(NamedTuple):
    """The video of one camera in one episode.

    Attributes
    ----------
    data : bytes
        An mp4.
    offset : float
        When the first frame of the episode is shown in it [s].
    n_frames : int
        Of how many frames it has the pictures.
    """

    data: bytes
    offset: float
    n_frames: int


class Picture(NamedTuple):
    """What one camera saw in a frame.

    Attributes
    ----------
    at : int
        The frame, counted over all that the page shows.
    data : bytes
        As it is stored.
    media_type : str
        Such as ``image/png``.
    """

    at: int
    data: bytes
    media_type: str


class _Plan(NamedTuple):
    """Where a clip is cut from, and how many bytes it will take."""

    path: Path
    video: VideoIndex
    cut: Cut
    n_bytes: int
    offset: float


class Film(NamedTuple):
    """All clips of one camera, or pictures where it has no video.

    Attributes
    ----------
    camera : Camera
        What the dataset says of it.
    clips : tuple of Clip
        Of the first episodes that the page shows.
    pictures : tuple of Picture
        Of these, some frames.
    missing : str
        Why there is none of the others.
    """

    camera: Camera
    clips: tuple[Clip, ...]
    pictures: tuple[Picture, ...]
    missing: str


def read_films(inspection: Inspection, shown: EpisodeIndex, max_bytes: int) -> list[Film]:
    """Cut the clips of all cameras, episode by episode while there is room; of a long first one its beginning.

    Parameters
    ----------
    inspection : Inspection
        What was found in the dataset.
    shown : EpisodeIndex
        The episodes, each as far as it is shown.
    max_bytes : int
        How many bytes all clips and pictures together may take.
    """
    cameras, features = inspection.about.cameras, inspection.schema.features
    videos = [each.name for each in cameras if features[each.name].dtype == "video"]
    images = [each.name for each in cameras if each.name not in videos]
    room = max_bytes // max(len(cameras), 1)
    clips: dict[str, list[Clip]] = {}
    missing = dict.fromkeys(videos, _NOT_NAMED)
    try:
        if videos:
            check_can_decode()
            clips, why = _cut_clips(inspection.dataset, shown, len(videos) * room)
            missing |= why
    except MissingExtraError as error:
        missing |= dict.fromkeys(videos, f"No clips: {error}")
    except DatasetError as error:
        missing |= dict.fromkeys(videos, f"No clips: {_why(inspection.dataset, error)}")
    pictures: dict[str, list[Picture]] = {}
    for name in images:
        pictures[name], missing[name] = _pick_pictures(inspection.dataset, name, shown, room)
    return [
        Film(camera, tuple(clips.get(camera.name, ())), tuple(pictures.get(camera.name, ())), missing[camera.name])
        for camera in cameras
    ]


def _pick_pictures(dataset: Dataset, name: str, shown: EpisodeIndex, max_bytes: int) -> tuple[list[Picture], str]:
    """Return pictures of one camera that are evenly spread over episodes, and why there are none of the others."""
    begins = dataset.episodes.from_index[np.searchsorted(dataset.episodes.numbers, shown.numbers)]
    stored = partial(encoded_pictures, dataset.root, dataset.files, name)
    picked: list[Picture] = []
    try:
        first = next(stored(begins[:1]), None)
        if first is None:
            return [], _NO_PICTURES
        at = _spread(shown, max_bytes // len(first[1]))
        episode = np.searchsorted(shown.to_index, at, side="right")
        for place, data, media_type in stored(begins[episode] + at - shown.from_index[episode]):
            max_bytes -= len(data)
            if max_bytes < 0:
                break
            picked.append(Picture(int(at[place]), data, media_type))
    except DatasetError as error:
        return picked, _why(dataset, error)
    return picked, _NO_ROOM_FOR_PICTURES


def _why(dataset: Dataset, error: DatasetError) -> str:
    """Say what is wrong with a file by its place in the dataset: a page goes to people who have it elsewhere."""
    return str(error.fault.relative_to(dataset.root))


def _spread(shown: EpisodeIndex, n: int) -> Ints:
    """Spread up to `n` frames over the first episodes; each has its first and its last one, if it has two."""
    n_episodes = min(len(shown), max(n // _PICTURES, 1))
    each = n // n_episodes
    spans = zip(shown.from_index[:n_episodes].tolist(), shown.to_index[:n_episodes].tolist(), strict=True)
    parts = [np.linspace(begin, end - 1, min(each, end - begin)).round() for begin, end in spans]
    return np.concatenate(parts).astype(np.int64)


class _Videos:
    """The videos of a dataset whose place the metadata know; the index of each is read once."""

    def __init__(self, dataset: Dataset) -> None:
        self.root, self.fps = dataset.root, dataset.schema.fps
        shards = shard_paths(self.root)
        numbers = np.concatenate([read_shard(shard)["episode_index"] for shard in shards])
        self.rows = {number: row for row, number in enumerate(numbers.tolist())}
        self.spans = read_videos(self.root, dataset.schema, read_stated(self.root).value.video_path, shards).value
        self.indices: dict[Path, VideoIndex] = {}

    def plan(self, camera: str, number: int, n_frames: int, max_bytes: int) -> _Plan:
        """Plan the clip of an episode; where it would be too large, of its beginning."""
        spans, row = self.spans[camera], self.rows[number]
        path, start = spans.paths[spans.file_number[row]], float(spans.start[row])
        if path not in self.indices:
            self.indices[path] = read_video(self.root, path)
        index = self.indices[path]
        cut, n_bytes = plan_cut(index, start, start + n_frames / self.fps, max_bytes)
        offset = start - float(index.times[cut.key]) if cut.end > cut.first else 0.0
        return _Plan(path, index, cut, n_bytes, offset)

    def cut(self, plan: _Plan) -> Clip:
        """Cut a clip as planned."""
        data = cut_clip(self.root, plan.path, plan.video, plan.cut)
        return Clip(data, plan.offset, plan.cut.end - plan.cut.first)


def _cut_clips(dataset: Dataset, shown: EpisodeIndex, max_bytes: int) -> tuple[dict[str, list[Clip]], dict[str, str]]:
    """Return the clips of each camera whose videos the metadata name, and why there are no more of them."""
    videos = _Videos(dataset)
    clips: dict[str, list[Clip]] = {name: [] for name in videos.spans}
    missing = dict.fromkeys(videos.spans, "")
    left = max_bytes
    for place, (number, length) in enumerate(zip(shown.numbers.tolist(), shown.lengths.tolist(), strict=True)):
        room = _ALL if place else max_bytes // max(len(clips), 1)
        plans: dict[str, _Plan] = {}
        for name in (name for name in clips if not missing[name]):
            try:
                plans[name] = videos.plan(name, number, length, room)
            except DatasetError as error:
                missing[name] = _why(dataset, error)
        left -= sum(plan.n_bytes for plan in plans.values())
        if left < 0:
            return clips, missing | dict.fromkeys(plans, _NO_ROOM)
        for name, plan in plans.items():
            try:
                if plan.n_bytes:
                    clips[name].append(videos.cut(plan))
                else:
                    missing[name] = _NO_ROOM if plan.cut.first < len(plan.video.times) else _TOO_SHORT
            except DatasetError as error:
                missing[name] = _why(dataset, error)
    return clips, missing
