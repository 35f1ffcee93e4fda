"""Which videos does a dataset name, and are they there?

`meta/info.json` gives the template of their paths, and each row of the episode metadata the numbers that go into it.
"""

import re
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from z2r.errors import DatasetError, Fault
from z2r.format.parquet import integers, open_parquet, read_columns
from z2r.format.schema import INFO_PATH, Schema
from z2r.format.store import check_no_pointer, inside, is_file
from z2r.format.tables import Read

_EXAMPLE = "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4"


class Videos(NamedTuple):
    """The videos that the episode metadata names, relative to the dataset; `known` where all names could be read."""

    paths: tuple[str, ...]
    known: bool


def video_features(schema: Schema) -> list[str]:
    """Return the names of the features that are stored as videos."""
    return [name for name, feature in schema.features.items() if feature.dtype == "video"]


def read_videos(root: Path, schema: Schema, video_path: str | None, shards: Sequence[Path]) -> Read[Videos]:
    """Find the videos that these shards of the episode metadata name, and look whether they are there.

    Parameters
    ----------
    root : Path
        The folder.
    schema : Schema
        Which features are videos.
    video_path : str or None
        The template of their paths that `meta/info.json` gives.
    shards : sequence of Path
        Relative to `root`.
    """
    paths: dict[str, list[int]] = {}
    try:
        for name in video_features(schema):
            paths |= _named(root, name, _checked_template(video_path), shards)
    except DatasetError as error:
        return Read(Videos(tuple(paths), known=False), (error.fault.relative_to(root),))
    faults = (
        fault._replace(episodes=tuple(episodes)) for path, episodes in paths.items() for fault in _missing(root, path)
    )
    return Read(Videos(tuple(paths), known=True), tuple(faults))


def _named(root: Path, name: str, template: str, shards: Sequence[Path]) -> dict[str, list[int]]:
    """Find the videos of one camera, in the order of their numbers, and the episodes that are in each."""
    columns = [f"videos/{name}/chunk_index", f"videos/{name}/file_index", "episode_index"]
    named: dict[tuple[int, int], list[int]] = {}
    for shard in shards:
        table = read_columns(open_parquet(root / shard), root / shard, columns)
        values = (integers(table, column, root / shard).tolist() for column in columns)
        for chunk, file, episode in zip(*values, strict=True):
            named.setdefault((chunk, file), []).append(episode)
    return {
        template.format(video_key=name, chunk_index=chunk, file_index=file): episodes
        for (chunk, file), episodes in sorted(named.items())
    }


def _checked_template(video_path: str | None) -> str:
    """Let a template name its camera, its chunk and its file, and nothing else: `str.format` can do far more."""
    fields = re.sub(r"\{(video_key|(chunk|file)_index(:0\dd)?)\}", "", video_path or "")
    if not video_path or "{" in fields or "}" in fields:
        raise DatasetError(Fault(INFO_PATH, "video_path", repr(video_path), _EXAMPLE))
    return video_path


def _missing(root: Path, path: str) -> list[Fault]:
    try:
        if is_file(inside(root, path)):
            check_no_pointer(root / path, "a video")
            return []
        return [Fault(Path(path), "", "no such file", "a video", _way_to_a_video(root, path))]
    except DatasetError as error:
        return [error.fault.relative_to(root)]


def _way_to_a_video(root: Path, path: str) -> str:
    """Some people's videos stand in `video/`, where no reader looks for them."""
    first, _, rest = path.partition("/")
    if first == "videos" and is_file(inside(root, f"video/{rest}")):
        return "It is in a folder video: rename that to videos"
    return "Copy or download it again"
