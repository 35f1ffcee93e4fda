"""What is in a dataset? One row for each episode, then the totals.

The summary is a fold over the data files: each file gives one row for every episode that it holds a part of, and the
rows are merged at the end. Nothing else of a file is kept.
"""

from dataclasses import dataclass
from typing import Any

import msgspec
import numpy as np

from z2r.arrays import Array, Bools, Columns, Floats, Ints, Progress, no_progress, reduce_parts
from z2r.format.dataset import Dataset, map_files
from z2r.format.episodes import DataFile, EpisodeIndex, parts_within
from z2r.format.schema import ACTION, STATE, Schema
from z2r.reading.breaks import BreakMode
from z2r.reading.reading import PUSHT, Reading
from z2r.reading.success import frame_errors, in_tolerance


@dataclass(frozen=True, eq=False)
class Ranges:
    """The smallest and the largest value of every dimension of one feature in each episode.

    Attributes
    ----------
    low, high : ndarray, (n_episodes, size of the feature)
        Of the dtype in the file.
    """

    low: Array
    high: Array


@dataclass(frozen=True, eq=False)
class Outcome:
    """How each episode ended, as the reading has it.

    Attributes
    ----------
    final_pos_err : ndarray, float64[n_episodes]
        Distance from the block to the target in the last stored frame [m].
    final_ang_err : ndarray, float64[n_episodes]
        How far the block is turned away from the target there [rad], in [0, pi].
    reached : ndarray, bool[n_episodes]
        Whether both are within the tolerances.
    """

    final_pos_err: Floats
    final_ang_err: Floats
    reached: Bools

    @property
    def n_reached(self) -> int:
        """Number of episodes that reached the target."""
        return int(self.reached.sum())

    @property
    def success_rate(self) -> float:
        """Share of the episodes that reached the target, in [0, 1]."""
        return float(self.reached.mean())


@dataclass(frozen=True, eq=False)
class Inspection:
    """What was found in a dataset.

    Attributes
    ----------
    schema : Schema
        Fact one.
    episodes : EpisodeIndex
        Fact two, as the break mode leaves it.
    ranges : dict of str to Ranges
        For every numeric feature that the robot saw or did.
    outcome : Outcome or None
        None where there is no reading.
    reading : Reading or None
        What the columns were taken to mean, as the break mode leaves it; None where the schema lacks its columns.
    missing : tuple of str
        The columns that the reading would have needed.
    break_mode : str or None
        Which assumption was wrong on purpose.
    """

    schema: Schema
    episodes: EpisodeIndex
    ranges: dict[str, Ranges]
    outcome: Outcome | None
    reading: Reading | None
    missing: tuple[str, ...]
    break_mode: str | None

    def metrics(self, source: str, seed: int | None) -> dict[str, Any]:
        """Return the numbers as plain Python values for `metrics.json`, floats rounded to 6 places.

        Parameters
        ----------
        source : str
            What was read, such as ``standin``.
        seed : int or None
            The seed of the first episode, where it is known.

        Returns
        -------
        dict
            What depends on a reading is None where there is none.
        """
        lengths, outcome = self.episodes.lengths, self.outcome
        return {
            "source": source,
            "seed": seed,
            "break_mode": self.break_mode,
            "obs_dim": _size(self.schema, STATE),
            "act_dim": _size(self.schema, ACTION),
            "fps": self.schema.fps,
            "feature_keys": list(self.schema.features),
            "n_episodes": len(self.episodes),
            "n_frames": self.episodes.n_frames,
            "episode_lengths": lengths.tolist(),
            "mean_episode_length": round(float(lengths.mean()), 6),
            "reached": outcome and outcome.reached.tolist(),
            "n_reached": outcome and outcome.n_reached,
            "success_rate": outcome and round(outcome.success_rate, 6),
            "final_pos_err": outcome and outcome.final_pos_err.round(6).tolist(),
            "final_ang_err": outcome and outcome.final_ang_err.round(6).tolist(),
        }


def inspect_dataset(
    dataset: Dataset,
    mode: BreakMode | None = None,
    reading: Reading = PUSHT,
    progress: Progress = no_progress,
) -> Inspection:
    """Read every frame of a dataset and sum it up.

    Parameters
    ----------
    dataset : Dataset
        From `z2r.load`.
    mode : BreakMode, optional
        Get one assumption wrong on purpose.
    reading : Reading, optional
        What the columns mean. Where the schema lacks its columns, there is no outcome.
    progress : callable, optional
        Called with the number of frames done and the number of all, after each data file.

    Returns
    -------
    Inspection

    Raises
    ------
    DatasetError
        If a data file is missing, damaged, or not what the schema and the index say.
    """
    if mode:
        dataset, reading = mode.dataset(dataset), mode.reading(reading)
    schema, episodes = dataset.schema, dataset.episodes
    missing = reading.missing(schema)
    features = list(schema.signals())

    def fold(file: DataFile, frames: Columns) -> _Rows:
        return _summarise(file, frames, episodes)

    rows = _merge(map_files(dataset, features, fold, progress))
    return Inspection(
        schema=schema,
        episodes=episodes,
        ranges={name: Ranges(rows.low[name], rows.high[name]) for name in features},
        outcome=None if missing else _outcome(getattr(rows, reading.decisive)[reading.feature], reading, schema),
        reading=None if missing else reading,
        missing=missing,
        break_mode=mode.name if mode else None,
    )


def metrics_json(metrics: dict[str, Any]) -> bytes:
    """Return the bytes of `metrics.json`: the same for the same numbers."""
    return msgspec.json.format(msgspec.json.encode(metrics), indent=2) + b"\n"


@dataclass(frozen=True, eq=False)
class _Rows:
    """One row for each part of an episode; all arrays have a row for each."""

    episode: Ints
    low: Columns
    high: Columns
    first: Columns
    last: Columns


def _summarise(file: DataFile, frames: Columns, episodes: EpisodeIndex) -> _Rows:
    here, starts, stops = parts_within(episodes, file.from_index, file.to_index)
    return _Rows(
        episode=here,
        low={name: reduce_parts(np.minimum, values, starts, stops) for name, values in frames.items()},
        high={name: reduce_parts(np.maximum, values, starts, stops) for name, values in frames.items()},
        first={name: values[starts] for name, values in frames.items()},
        last={name: values[stops - 1] for name, values in frames.items()},
    )


def _merge(parts: list[_Rows]) -> _Rows:
    """Join the rows of all files; an episode that lies in several files becomes one row again."""
    episode = np.concatenate([part.episode for part in parts])
    starts = np.flatnonzero(np.diff(episode, prepend=-1))
    stops = np.append(starts[1:], len(episode))

    def joined(column: str) -> Columns:
        return {name: np.concatenate([getattr(part, column)[name] for part in parts]) for name in parts[0].low}

    return _Rows(
        episode=episode[starts],
        low={name: np.minimum.reduceat(values, starts, axis=0) for name, values in joined("low").items()},
        high={name: np.maximum.reduceat(values, starts, axis=0) for name, values in joined("high").items()},
        first={name: values[starts] for name, values in joined("first").items()},
        last={name: values[stops - 1] for name, values in joined("last").items()},
    )


def _outcome(decisive_frames: Array, reading: Reading, schema: Schema) -> Outcome:
    errors = frame_errors(decisive_frames, reading, schema)
    return Outcome(errors.pos_err, errors.ang_err, in_tolerance(errors, reading))


def _size(schema: Schema, feature: str) -> int | None:
    return schema.features[feature].size if feature in schema.features else None
