"""Which videos does a dataset name, where in them are its episodes, and what is in them?

`meta/info.json` gives the template of their paths, and each row of the episode metadata the numbers that go into it,
and from when to when the episode is shown.
"""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pyarrow as pa

from z2r.arrays import Floats, Ints
from z2r.errors import DatasetError, Fault
from z2r.format.episodes import EpisodeIndex, shard_paths
from z2r.format.mp4 import VideoIndex, read_video_index
from z2r.format.parquet import integers, open_parquet, read_columns, vectors
from z2r.format.schema import INFO_PATH, Schema
from z2r.format.store import inside, is_file
from z2r.format.tables import Read, count_files, join_shards, read_shard, read_stated

_EXAMPLE = "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4"


class Spans(NamedTuple):
    """Where the episodes are in the videos of one camera: a row for each, in the order of the episode metadata.

    Attributes
    ----------
    paths : tuple of Path
        Its videos, relative to the dataset, in the order of their numbers.
    file_number : ndarray, int64[n_episodes]
        Which of them shows the episode.
    start, stop : ndarray, float64[n_episodes]
        From when to when [s].
    """

    paths: tuple[Path, ...]
    file_number: Ints
    start: Floats
    stop: Floats


class Film(NamedTuple):
    """Which picture of a camera belongs to each of some frames.

    Attributes
    ----------
    paths : tuple of Path
        The videos that show them, relative to the dataset.
    file_number : ndarray, int64[n_frames]
        Which of them shows the frame.
    time : ndarray, float64[n_frames]
        When it shows it [s]: `from_timestamp` of the episode, and as long as the frame comes after its first one.
    """

    paths: tuple[Path, ...]
    file_number: Ints
    time: Floats


def video_features(schema: Schema) -> list[str]:
    """Return the names of the features that are stored as videos."""
    return [name for name, feature in schema.features.items() if feature.dtype == "video"]


def read_videos(root: Path, schema: Schema, video_path: str | None, shards: Sequence[Path]) -> Read[dict[str, Spans]]:
    """Read what these shards of the episode metadata say of the videos: those of each camera of which they say it all.

    Parameters
    ----------
    root : Path
        The folder.
    schema : Schema
        Which features are videos.
    video_path : str or None
        The template of their paths that `meta/info.json` gives.
    shards : sequence of Path
        Relative to `root`, those that `read_episodes` could read.
    """
    spans: dict[str, Spans] = {}
    faults = []
    for name in video_features(schema):
        try:
            spans[name] = _spans(root, name, _checked_template(video_path), shards)
        except DatasetError as error:
            faults.append(error.fault.relative_to(root))
    return Read(spans, tuple(dict.fromkeys(faults)))


def read_films(root: Path, schema: Schema, episodes: EpisodeIndex) -> Read[dict[str, Film]]:
    """Find the pictures of all frames of some episodes, of each camera of which the metadata says it all.

    No video is opened, and there need not be one.

    Parameters
    ----------
    root : Path
        The folder.
    schema : Schema
        Which features are videos, and how many frames are a second.
    episodes : EpisodeIndex
        How long they are, and what the dataset calls them.
    """
    if not video_features(schema):
        return Read({})
    try:
        shards = [path.relative_to(root) for path in shard_paths(root)]
        table, _ = join_shards(schema, [read_shard(root / shard) for shard in shards])
    except DatasetError as error:
        return Read({}, (error.fault.relative_to(root),))
    spans, faults = read_videos(root, schema, read_stated(root).value.video_path, shards)
    order = np.argsort(table.number, kind="stable")
    row = np.repeat(order[np.searchsorted(table.number[order], episodes.numbers, side="right") - 1], episodes.lengths)
    after = (episodes.frame_numbers - np.repeat(episodes.from_index, episodes.lengths)) / schema.fps
    return Read({name: _film(span, row, after) for name, span in spans.items()}, faults)


def read_video(root: Path, path: Path) -> VideoIndex:
    """Read the index of a video that the metadata names; `path` is relative to `root`.

    Raises
    ------
    DatasetError
        If it is not there, or cannot be read.
    """
    if not is_file(inside(root, path)):
        raise DatasetError(Fault(root / path, "", "no such file", "a video", _way_to_a_video(root, path)))
    return read_video_index(root, path)


def _spans(root: Path, name: str, template: str, shards: Sequence[Path]) -> Spans:
    whole = [f"videos/{name}/{key}" for key in ("chunk_index", "file_index")]
    times = [f"videos/{name}/{key}" for key in ("from_timestamp", "to_timestamp")]
    pointers: list[Ints] = [np.empty((2, 0), np.int64)]
    spans: list[Floats] = [np.empty((2, 0))]
    for shard in (root / shard for shard in shards):
        table = read_columns(open_parquet(shard), shard, [*whole, *times])
        pointers.append(np.stack([integers(table, column, shard) for column in whole]))
        spans.append(np.stack([_seconds(table, column, shard) for column in times]))
    file_number, named = count_files(*np.concatenate(pointers, axis=1))
    paths = [Path(template.format(video_key=name, chunk_index=chunk, file_index=file)) for chunk, file in named]
    return Spans(tuple(paths), file_number, *np.concatenate(spans, axis=1))


def _film(span: Spans, row: Ints, after: Floats) -> Film:
    needed, file_number = np.unique(span.file_number[row], return_inverse=True)
    return Film(tuple(span.paths[number] for number in needed), file_number, span.start[row] + after)


def _seconds(table: pa.Table, column: str, path: Path) -> Floats:
    values = vectors(table, column, (1,), path)[:, 0].astype(np.float64)
    if not (known := np.isfinite(values)).all():
        row = int(known.argmin())
        raise DatasetError(Fault(path, f"{column} in row {row}", values[row], "a number of seconds"))
    return values


def _checked_template(video_path: str | None) -> str:
    """Let a template name its camera, its chunk and its file, and nothing else: `str.format` can do far more."""
    fields = re.sub(r"\{(video_key|(chunk|file)_index(:0\dd)?)\}", "", video_path or "")
    if not video_path or "{" in fields or "}" in fields:
        raise DatasetError(Fault(INFO_PATH, "video_path", repr(video_path), _EXAMPLE))
    return video_path


def _way_to_a_video(root: Path, path: Path) -> str:
    """Some people's videos stand in `video/`, where no reader looks for them."""
    if path.parts[0] == "videos" and is_file(inside(root, Path("video", *path.parts[1:]))):
        return "It is in a folder video: rename that to videos"
    return "Copy or download it again"
