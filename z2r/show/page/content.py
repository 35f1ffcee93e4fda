"""What goes into a page: the summary, the readings, and the frames that it has room for."""

import base64
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from z2r.arrays import Array, Columns, Progress, no_progress
from z2r.errors import printable
from z2r.format.dataset import Dataset, map_files
from z2r.format.episodes import DataFile, EpisodeIndex
from z2r.format.schema import ACTION, Feature
from z2r.reading.breaks import BreakMode, break_mode
from z2r.reading.inspection import Inspection, Outcome, inspect_dataset
from z2r.reading.reading import PoseColumns, Reading
from z2r.reading.success import frame_errors, in_tolerance

WRONG_READINGS = ("yaw-swap", "yaw-swap-everywhere", "drop-boundaries")

LONGEST_PATH = 2000  # frames: of a longer one, this many are drawn, which any browser does between two frames

_MAX_EPISODES = 500  # to pick from: more are no list


@dataclass(frozen=True, eq=False)
class View:
    """The dataset as one reading has it, its episodes side by side; without a reading, there is no outcome either."""

    mode: BreakMode | None
    reading: Reading | None
    episodes: EpisodeIndex
    outcome: Outcome | None

    @property
    def name(self) -> str:
        """Name of the break mode, or ``right``."""
        return self.mode.name if self.mode else "right"

    @property
    def tally(self) -> str:
        """How many episodes reached the target, of how many; empty where nobody can say."""
        return f"{self.outcome.n_reached:,} of {len(self.outcome.reached):,}" if self.outcome else ""


@dataclass(frozen=True, eq=False)
class Content:
    """What a page is made of: the summary, the views, and the frames of the episodes that it shows."""

    title: str
    inspection: Inspection
    views: list[View]
    shown: EpisodeIndex
    frames: Columns
    left_out: str

    @property
    def columns(self) -> list[tuple[str, str]]:
        """Feature and dimension of every column of `frames`, in order."""
        features = self.inspection.schema.features
        return [(name, dim) for name in self.frames for dim in dims(features[name])]


def dims(feature: Feature) -> tuple[str, ...]:
    """Return what to call each dimension of a feature: its name, or else its place."""
    return feature.dim_names or tuple(f"[{i}]" for i in range(feature.size))


def formula(pose: PoseColumns) -> str:
    """Return how a reading decodes a yaw, such as ``atan2(sin_tee_yaw, cos_tee_yaw)``."""
    return f"atan2({pose.sin_yaw}, {pose.cos_yaw})"


def read_content(dataset: Dataset, max_bytes: int, progress: Progress = no_progress) -> Content:
    """Read a dataset, and keep as many frames of its first episodes as fit.

    Parameters
    ----------
    dataset : Dataset
        From `z2r.load`.
    max_bytes : int
        How large the frames that are kept may be.
    progress : callable, optional
        Called with the number of frames done and the number of all, after each data file.

    Raises
    ------
    DatasetError
        If a data file is missing, damaged, or not what the schema and the index say.
    """
    inspection = inspect_dataset(dataset, progress=progress)
    features = list(dataset.schema.signals())
    dtype_size = _dtype(inspection).itemsize
    n_columns = sum(dataset.schema.features[name].size for name in features)
    views = _views(dataset, inspection)
    shown = _episodes_to_show(views[0].episodes, max(max_bytes // max(dtype_size * n_columns, 1), 1))
    beginning = dataset.first(len(shown))
    parts = map_files(beginning, features, lambda _, frames: frames)
    rows = beginning.episodes.frame_numbers[: shown.n_frames]
    return Content(
        title=printable(dataset.root.resolve().name),
        inspection=inspection,
        views=views,
        shown=shown,
        frames={name: np.concatenate([part[name] for part in parts])[rows] for name in features},
        left_out=_left_out(dataset.episodes, shown),
    )


def _side_by_side(episodes: EpisodeIndex) -> EpisodeIndex:
    """Count frames over the episodes alone: where a dataset was salvaged, there are others between them."""
    ends = np.cumsum(episodes.lengths)
    return EpisodeIndex(ends - episodes.lengths, ends, episodes.numbers)


def _dtype(inspection: Inspection) -> np.dtype[Any]:
    """Return the type that holds every value as it is: float32, or float64 where a feature needs it."""
    dtype = np.result_type(np.float32, *(ranges.low.dtype for ranges in inspection.ranges.values()))
    return np.dtype("<f4" if dtype == np.float32 else "<f8")


def _episodes_to_show(episodes: EpisodeIndex, max_frames: int) -> EpisodeIndex:
    """Return the first episodes, as many as fit; of a longer first one, its beginning."""
    fitting = int(np.searchsorted(episodes.to_index, max_frames, side="right"))
    n_episodes = min(max(fitting, 1), _MAX_EPISODES)
    shown = episodes.only(slice(n_episodes))
    return replace(shown, to_index=np.minimum(shown.to_index, max_frames))


def _left_out(episodes: EpisodeIndex, shown: EpisodeIndex) -> str:
    if shown.n_frames == episodes.n_frames:
        return ""
    sentences = []
    if shown.n_frames < episodes.lengths[0]:
        sentences.append(f"Of episode {episodes.number(0):,}, the page holds the first {shown.n_frames:,} frames.")
    if n_left := len(episodes) - len(shown):
        first, last = episodes.number(len(shown)), episodes.number(len(episodes) - 1)
        which = f"episode {last:,}" if n_left == 1 else f"episodes {first:,} to {last:,}"
        sentences.append(f"The frames of {which} are left out.")
    return " ".join([*sentences, "The sums and the ribbon cover every episode."])


def _views(dataset: Dataset, inspection: Inspection) -> list[View]:
    packed = replace(dataset, episodes=_side_by_side(dataset.episodes))
    right = View(None, inspection.reading, packed.episodes, inspection.outcome)
    if inspection.reading is None:
        return [right]
    last = _last_frames(dataset, inspection.reading.feature)
    return [right, *(_wrong_view(packed, inspection.reading, break_mode(name), last) for name in WRONG_READINGS)]


def _last_frames(dataset: Dataset, feature: str) -> Array:
    """Read the last frame of every episode, (n_episodes, size of the feature)."""
    ends = dataset.episodes.to_index - 1

    def fold(file: DataFile, frames: Columns) -> Array:
        here = (ends >= file.from_index) & (ends < file.to_index)
        return frames[feature][ends[here] - file.from_index]

    return np.concatenate(map_files(dataset, [feature], fold))


def _wrong_view(dataset: Dataset, right: Reading, mode: BreakMode, last: Array) -> View:
    reading, episodes = mode.reading(right), mode.dataset(dataset).episodes
    ends = np.searchsorted(dataset.episodes.to_index, episodes.to_index)
    errors = frame_errors(last[ends], reading, dataset.schema)
    return View(mode, reading, episodes, Outcome(errors.pos_err, errors.ang_err, in_tolerance(errors, reading)))


def script_data(content: Content) -> dict[str, Any]:
    """Return what the script needs: the frames, column after column, and the readings."""
    schema, dtype = content.inspection.schema, _dtype(content.inspection)
    values = [frames.astype(dtype) for frames in content.frames.values()] or [np.empty((content.shown.n_frames, 0))]
    columns = np.ascontiguousarray(np.concatenate(values, axis=1).T)
    return {
        "fps": schema.fps,
        "longestPath": LONGEST_PATH,
        "shown": content.shown.n_frames,
        "total": content.inspection.episodes.n_frames,
        "names": [[feature, printable(name)] for feature, name in content.columns],
        "bytes": dtype.itemsize,
        "frames": base64.b64encode(columns.tobytes()).decode(),
        "readings": [_reading_data(view, content) for view in content.views],
    }


def _reading_data(view: View, content: Content) -> dict[str, Any]:
    spans = np.stack([view.episodes.from_index, view.episodes.to_index], axis=1)
    episodes = spans[view.episodes.from_index < content.shown.n_frames].tolist()
    data = {"name": view.name, "episodes": episodes, "numbers": list(map(view.episodes.number, range(len(episodes))))}
    if view.reading is None or view.outcome is None:
        return data
    schema, velocity = content.inspection.schema, view.reading.velocity
    has_action = set(velocity) <= set(schema.features[ACTION].dim_names if ACTION in content.frames else ())

    def places(names: Sequence[str], feature: str = view.reading.feature) -> list[int]:
        before = list(content.frames)[: list(content.frames).index(feature)]
        return [sum(schema.features[name].size for name in before) + at for at in schema.columns(feature, names)]

    return data | {
        "reached": view.outcome.reached[: len(episodes)].tolist(),
        "said": f"{view.name}: {view.tally} reached the target, {view.outcome.success_rate:.0%}",
        "pusher": places(view.reading.pusher),
        "tee": places(view.reading.tee.names),
        "target": places(view.reading.target.names),
        "action": places(velocity, ACTION) if has_action else None,
        "formulas": [formula(view.reading.tee), formula(view.reading.target)],
        "posTol": view.reading.pos_tol,
        "angTol": view.reading.ang_tol,
    }
