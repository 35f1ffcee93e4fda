"""What does a dataset say of itself? Its robot, its tasks, its cameras, its columns of text.

Nothing of it is needed to read the frames. So nothing here is a fault: what is missing, or not what it should be, is
unknown, and that is written as None. Where each stands is what lerobot 0.6.1 writes (`lerobot/datasets/utils.py`:
`DatasetInfo`; `dataset_metadata.py`: `update_video_info`, and the `tasks` of each episode).
"""

from collections import Counter
from collections.abc import Iterator, Sequence
from itertools import chain
from pathlib import Path
from typing import Any

import msgspec

from z2r.arrays import Ints
from z2r.errors import DatasetError, count, short
from z2r.format.episodes import shard_paths
from z2r.format.parquet import integers, open_parquet, read_columns, text_sets
from z2r.format.schema import Feature, Schema
from z2r.format.tables import read_tasks

_TEXT = ("string", "language")
_PICTURES = ("video", "image")
_MAX_RATE = 1e6  # of pictures a second: beyond, nothing that is recorded makes sense
_MAX_LINES = 5  # of one kind: a summary is no list


class Task(msgspec.Struct, frozen=True):
    """What the robot was told to do.

    Attributes
    ----------
    task : str
        The text.
    n_episodes : int or None
        In how many of the episodes that were read; None where the metadata does not say.
    """

    task: str
    n_episodes: int | None

    @property
    def says(self) -> str:
        """The text, and how many episodes are about it."""
        episodes = "" if self.n_episodes is None else f" ({count(self.n_episodes, 'episode')})"
        return f"{short(self.task)}{episodes}"


class Camera(msgspec.Struct, frozen=True):
    """A feature that is stored as pictures.

    Attributes
    ----------
    name : str
        Of the feature.
    height, width : int or None
        In pixels.
    fps : float or None
        Pictures a second, where the feature says so itself.
    codec : str or None
        Such as ``av1``.
    """

    name: str
    height: int | None
    width: int | None
    fps: float | None
    codec: str | None

    @property
    def says(self) -> str:
        """All that is known of it, in a few words."""
        size = f"{self.height} x {self.width}" if self.width and self.height else "size unknown"
        fps = f"{self.fps:g} fps" if self.fps else ""
        return ", ".join(filter(None, [short(self.name), size, fps, short(self.codec or "")]))


class About(msgspec.Struct, frozen=True):
    """What a dataset says of itself.

    Attributes
    ----------
    robot_type : str or None
        What recorded it.
    tasks : tuple of Task or None
        In the order of their numbers; None where no text can be read.
    cameras : tuple of Camera
        In the order of the schema.
    text_columns : tuple of str
        The features that are text.
    """

    robot_type: str | None
    tasks: tuple[Task, ...] | None
    cameras: tuple[Camera, ...]
    text_columns: tuple[str, ...]

    def to_dict(self) -> dict[str, Any]:
        """Return it as plain Python values, as they stand in `metrics.json`; None where something is unknown."""
        values = msgspec.to_builtins(self)
        return {key: [*value] if isinstance(value, tuple) else value for key, value in values.items()}

    @property
    def lines(self) -> dict[str, list[str]]:
        """What it comes to in words, by its kind; of many tasks, those of most episodes.

        Examples
        --------
        >>> About("so101", (Task("pick", 3), Task("place", 4)), (), ()).lines
        {'robot': ['so101'], 'tasks': ['place (4 episodes)', 'pick (3 episodes)']}
        """
        tasks = sorted(self.tasks or (), key=lambda task: -(task.n_episodes or 0))
        said = {
            "robot": [self.robot_type or "unknown"],
            "tasks": [task.says for task in tasks] or ["unknown"],
            "cameras": [camera.says for camera in self.cameras],
            "text": list(self.text_columns),
        }
        return {kind: _first(lines) for kind, lines in said.items() if lines}


def read_about(root: Path, schema: Schema, numbers: Ints) -> About:
    """Read what a dataset says of itself: its table of tasks, and one column of its episode metadata.

    Parameters
    ----------
    root : Path
        The folder.
    schema : Schema
        From there.
    numbers : ndarray, int64[n_episodes]
        What the dataset calls the episodes whose tasks are counted.
    """
    return About(robot_of(schema), _tasks(root, numbers), cameras_of(schema), _text_columns(schema))


def robot_of(schema: Schema) -> str | None:
    """Return the robot that `meta/info.json` names; None where it names none."""
    return _text(schema.robot_type)


def cameras_of(schema: Schema) -> tuple[Camera, ...]:
    """Return the features that are pictures, with what the schema says of them."""
    features = schema.features.items()
    return tuple(_camera(name, feature) for name, feature in features if feature.dtype in _PICTURES)


def short_names(names: Sequence[str]) -> list[str]:
    """Return what to call cameras: the last part of what LeRobot calls them, if that tells them apart.

    >>> short_names(["observation.images.front", "observation.image"])
    ['front', 'image']
    """
    last = [name.removeprefix("observation.").removeprefix("images.") for name in names]
    return last if len(set(last)) == len(names) else list(names)


def axes_of(feature: Feature) -> dict[Any, int]:
    """Name the sizes of a picture, which is stored as (height, width, channels) or the other way round."""
    names = feature.names if isinstance(feature.names, list | tuple) else []
    fits = len(names) == len(feature.shape) and all(isinstance(name, str) for name in names)
    return dict(zip(names, feature.shape, strict=True)) if fits else {}


def said_of(feature: Feature) -> dict[str, Any]:
    """Return what the schema says of a video beside its shape, such as ``video.fps``: any value may stand there."""
    said = [info for info in (feature.video_info, feature.info) if isinstance(info, dict)]
    return {key: value for info in said for key, value in info.items()}


def _first(lines: list[str]) -> list[str]:
    more = len(lines) - _MAX_LINES
    return lines if more <= 0 else [*lines[:_MAX_LINES], f"and {more:,} more"]


def _text_columns(schema: Schema) -> tuple[str, ...]:
    return tuple(name for name, feature in schema.features.items() if feature.dtype.startswith(_TEXT))


def _camera(name: str, feature: Feature) -> Camera:
    said, axes = said_of(feature), axes_of(feature)
    return Camera(
        name=name,
        height=_count(axes.get("height", said.get("video.height"))),
        width=_count(axes.get("width", said.get("video.width"))),
        fps=_rate(said.get("video.fps")),
        codec=_text(said.get("video.codec")),
    )


def _text(value: Any) -> str | None:
    return value if isinstance(value, str) and value.strip() else None


def _count(value: Any) -> int | None:
    return value if type(value) is int and value > 0 else None


def _rate(value: Any) -> float | None:
    return value if type(value) in (int, float) and 0 < value <= _MAX_RATE else None


def _tasks(root: Path, numbers: Ints) -> tuple[Task, ...] | None:
    """Count the episodes of each task; one that only the episodes name comes after those of the table."""
    tasks = read_tasks(root).value
    named = tasks.text if tasks else None
    try:
        counted = _count_episodes(root, frozenset(numbers.tolist()))
    except DatasetError:
        return None if named is None else tuple(Task(text, None) for text in named)
    return tuple(Task(text, counted[text]) for text in dict.fromkeys([*(named or ()), *counted]))


def _count_episodes(root: Path, wanted: frozenset[int]) -> Counter[str]:
    return Counter(chain.from_iterable(tasks for number, tasks in _all_episodes(root) if number in wanted))


def _all_episodes(root: Path) -> Iterator[tuple[int, frozenset[str]]]:
    return chain.from_iterable(tasks_of_episodes(shard) for shard in shard_paths(root))


def read_task_texts(root: Path, numbers: Ints) -> list[str] | None:
    """Return what the robot was told in each of some episodes; None where nobody can read it."""
    try:
        said = dict(_all_episodes(root))
    except DatasetError:
        return None
    return ["; ".join(sorted(said.get(number, ()))) for number in numbers.tolist()]


def tasks_of_episodes(shard: Path) -> Iterator[tuple[int, frozenset[str]]]:
    """Yield the `episode_index` and the tasks of every episode in one metadata shard.

    Raises
    ------
    DatasetError
        If the shard cannot be read, or holds something else.
    """
    parquet = open_parquet(shard)
    numbers = integers(read_columns(parquet, shard, ["episode_index"]), "episode_index", shard)
    return zip(numbers.tolist(), text_sets(parquet, "tasks", shard), strict=False)
