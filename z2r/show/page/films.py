"""What did the cameras see? Clips of the episodes that a page shows, as many as it has room for.

A clip is cut out of the video on disk and never encoded again. Where there is none, the page says why.
"""

from pathlib import Path
from typing import NamedTuple

import numpy as np

from z2r.errors import DatasetError, MissingExtraError, printable
from z2r.format.about import Camera
from z2r.format.dataset import Dataset
from z2r.format.decoding import Cut, check_can_decode, cut_clip, plan_cut
from z2r.format.episodes import EpisodeIndex, shard_paths
from z2r.format.mp4 import VideoIndex
from z2r.format.tables import read_shard, read_stated
from z2r.format.videos import read_video, read_videos
from z2r.reading.inspection import Inspection

_IMAGES = "Its pictures are images in the data files, and this page plays videos only."
_NOT_NAMED = "The episode metadata do not say where its videos are."
_TOO_SHORT = "Its video ends before this episode."
_NO_ROOM = "The page has no room for a clip of this episode."
_ALL = 2**62  # bytes


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


class _Plan(NamedTuple):
    """Where a clip is cut from, and how many bytes it will take."""

    path: Path
    video: VideoIndex
    cut: Cut
    n_bytes: int
    offset: float


class Film(NamedTuple):
    """All clips of one camera.

    Attributes
    ----------
    camera : Camera
        What the dataset says of it.
    clips : tuple of Clip
        Of the first episodes that the page shows.
    missing : str
        Why there is none of the others.
    """

    camera: Camera
    clips: tuple[Clip, ...]
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
        How many bytes the pictures of all clips together may take.
    """
    cameras, features = inspection.about.cameras, inspection.schema.features
    videos = [each.name for each in cameras if features[each.name].dtype == "video"]
    clips: dict[str, list[Clip]] = {}
    missing = {each.name: _NOT_NAMED if each.name in videos else _IMAGES for each in cameras}
    try:
        if videos:
            check_can_decode()
            clips, why = _cut_clips(inspection.dataset, shown, max_bytes)
            missing |= why
    except (MissingExtraError, DatasetError) as error:
        missing |= dict.fromkeys(videos, printable(f"No clips: {error}"))
    return [Film(camera, tuple(clips.get(camera.name, ())), missing[camera.name]) for camera in cameras]


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
                missing[name] = printable(f"{error}")
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
                missing[name] = printable(f"{error}")
    return clips, missing
