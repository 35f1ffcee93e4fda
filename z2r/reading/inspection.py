"""What is in a dataset? One row for each episode, then the totals.

The summary is a fold over the data files: each file gives one row for every episode that it holds a part of, and the
rows are merged at the end. Nothing else of a file is kept, but the first frames where somebody wants to draw them.
"""

from collections.abc import Callable, Sequence
from concurrent.futures import Executor
from dataclasses import dataclass
from typing import Any

import msgspec
import numpy as np

from z2r.arrays import Array, Bools, Columns, Floats, Ints, Progress, no_progress, reduce_parts, sum_parts
from z2r.format.about import About, read_about
from z2r.format.dataset import Dataset, map_files
from z2r.format.episodes import DataFile, EpisodeIndex, parts_within
from z2r.format.schema import ACTION, STATE, Schema
from z2r.reading.action import DrivenColumn, infer_action, sample_of, sample_windows, sampled_features
from z2r.reading.breaks import BreakMode
from z2r.reading.decode import Decoded, decode
from z2r.reading.reading import Reading
from z2r.reading.stored import REWARD, StoredSuccess, levels_of, stored_success
from z2r.reading.success import FrameErrors, frame_errors, in_tolerance

_NAMED = 3  # columns in a headline: who lacks more has another robot


@dataclass(frozen=True, eq=False)
class Ranges:
    """The smallest and the largest value of every dimension of one feature in each episode, and the mean of all.

    Attributes
    ----------
    low, high : ndarray, (n_episodes, size of the feature)
        Of the dtype in the file.
    mean : ndarray, float64[size of the feature]
        Of all frames.
    """

    low: Array
    high: Array
    mean: Floats


@dataclass(frozen=True, eq=False)
class Outcome:
    """How each episode ended, as the reading has it.

    Attributes
    ----------
    final_errors : dict of str to ndarray, float64[n_episodes]
        What each goal measures in the decisive frame, by its name: ``final_errors["pos_err"]`` [m].
    reached : ndarray, bool[n_episodes]
        Whether all goals hold there.
    """

    final_errors: FrameErrors
    reached: Bools

    @property
    def n_reached(self) -> int:
        """Number of episodes that reached the goal."""
        return int(self.reached.sum())

    @property
    def share_reached(self) -> float:
        """Share of the episodes that reached the goal, in [0, 1]; the key ``success_rate`` of `metrics.json`."""
        return float(self.reached.mean())

    @property
    def tally(self) -> str:
        """How many reached the goal, of how many."""
        return f"{self.n_reached:,} of {len(self.reached):,}"


@dataclass(frozen=True, eq=False)
class Inspection:
    """What was found in a dataset.

    Attributes
    ----------
    dataset : Dataset
        What was read, as the break mode leaves it.
    ranges : dict of str to Ranges
        For every numeric feature that the robot saw or did.
    ends : dict of str to Columns
        The ``first`` and the ``last`` frame of every episode: every such feature, (n_episodes, size).
    outcome : Outcome or None
        None where no reading fits, or the one that does has no goal.
    stored : StoredSuccess or None
        Which episodes the dataset itself calls a success; None where no column says so.
    stored_note : str
        What else there is to say of such a column: why it says nothing, mostly; empty where there is nothing.
    reading : Reading or None
        What the columns were taken to mean, as the break mode leaves it; None where none was given, or the schema lacks
        its columns.
    missing : tuple of str
        The columns that the reading would have needed.
    break_mode : str or None
        Which assumption was wrong on purpose.
    action : tuple of DrivenColumn
        What each dimension of the action is, told from the data; empty where there is no action.
    shown : EpisodeIndex
        The first episodes, or the one that was asked for: as many as there are frames of in `kept`, and of a longer
        first one its beginning; counted from the first frame in `kept`.
    kept : Columns
        Their frames, for who wants to draw them; none unless asked for.
    kept_from : int
        Which frame of the dataset is the first of them.
    about : About
        What the dataset says of itself.
    """

    dataset: Dataset
    ranges: dict[str, Ranges]
    ends: dict[str, Columns]
    outcome: Outcome | None
    stored: StoredSuccess | None
    stored_note: str
    reading: Reading | None
    missing: tuple[str, ...]
    break_mode: str | None
    action: tuple[DrivenColumn, ...]
    shown: EpisodeIndex
    kept: Columns
    kept_from: int
    about: About

    def __repr__(self) -> str:
        reached = f"reached {self.outcome.tally}" if self.outcome else "nothing says what counts as reached"
        stored = f", stored {self.stored.says}" if self.stored else ""
        return f"Inspection({len(self.episodes):,} episodes, {reached}{stored})"

    @property
    def schema(self) -> Schema:
        """Fact one."""
        return self.dataset.schema

    @property
    def episodes(self) -> EpisodeIndex:
        """Fact two, as the break mode leaves it."""
        return self.dataset.episodes

    @property
    def agreement(self) -> str:
        """In how many episodes reading and dataset agree, and in which not; empty where they are not two witnesses."""
        if self.outcome is None or self.stored is None or self.reading is None:
            return ""
        if all(goal.stored == self.stored.source for goal in self.reading.goal):
            return ""
        return self.stored.agreement(self.outcome.reached, self.episodes)

    @property
    def lacking(self) -> str:
        """The columns that the reading would have needed, and of which of them there is more than one."""
        twice = self.schema.repeated()
        return ", ".join(f"{name} (twice there, so unclear)" if name in twice else name for name in self.missing)

    @property
    def why_unknown(self) -> str:
        """Why nothing can be said of what was reached; empty where there is an outcome."""
        if self.outcome:
            return ""
        if self.reading is not None:
            return f"the reading {self.reading.name} has no goal"
        if self.missing:
            if len(self.missing) > _NAMED:
                return f"its reading needs {len(self.missing)} columns that are not there, such as {self.missing[0]}"
            return f"its reading needs {self.lacking}, which is not there"
        return "no reading says what its columns mean, and what counts as reached"

    @property
    def last_frames(self) -> Columns:
        """The last frame of every episode: every numeric feature, (n_episodes, size)."""
        return self.ends["last"]

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
            ``success_rate`` is the share of episodes that *reached* the goal: the key is the seed course's. What each
            goal measures at the end is ``final_`` and its name. What depends on a reading is None where there is none.
            ``stored_success`` says of each episode whether the dataset calls it a success in some frame, and
            ``stored_success_source`` which column does; None where none does.
            What the dataset should say of itself and does not is None too.
        """
        lengths, outcome, stored = self.episodes.lengths, self.outcome, self.stored
        errors = {"pos_err": None, "ang_err": None} | (outcome.final_errors if outcome else {})
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
            "success_rate": outcome and round(outcome.share_reached, 6),
            **{f"final_{name}": None if each is None else each.round(6).tolist() for name, each in errors.items()},
            "reading": self.reading and self.reading.name,
            "action": [_rounded(driven) for driven in self.action],
            "stored_success": stored and stored.any_frame.tolist(),
            "n_stored_success": stored and stored.n_success,
            "stored_success_source": stored and stored.source,
            **self.about.to_dict(),
        }


def inspect_dataset(
    dataset: Dataset,
    mode: BreakMode | None = None,
    reading: Reading | None = None,
    progress: Progress = no_progress,
    keep: int = 0,
    executor: Executor | None = None,
    episode: int | None = None,
) -> Inspection:
    """Read every frame of a dataset once, and sum it up: `z2r.inspect_dataset`, with the reading handed down.

    Where the schema lacks a column of the reading, or there is none, there is no outcome.

    Raises
    ------
    DatasetError
        If a data file is missing, damaged, or not what the schema and the index say.
    ValueError
        If there is no such episode.
    """
    if mode:
        dataset, reading = mode.believe(dataset, reading)
    fold = fold_for(dataset, keep, episode)
    parts = map_files(dataset, list(dataset.schema.signals()), fold, progress, executor)
    return sum_up(dataset, parts, mode, reading, keep, episode)


def fold_for(dataset: Dataset, keep: int = 0, episode: int | None = None) -> Callable[[DataFile, Columns], "FileSums"]:
    """Return what sums up one data file of a dataset; it survives pickling.

    Raises
    ------
    ValueError
        If there is no such episode.
    """
    first = int(_wanted(dataset, episode).from_index[0])
    windows, sampled = sample_windows(dataset.episodes), sampled_features(dataset.schema)
    return _Fold(dataset.episodes, first, first + keep, windows, sampled)


def sum_up(
    dataset: Dataset,
    parts: Sequence["FileSums"],
    mode: BreakMode | None = None,
    reading: Reading | None = None,
    keep: int = 0,
    episode: int | None = None,
) -> Inspection:
    """Put together what `fold_for` made of all data files, in the order of their frames."""
    schema, missing = dataset.schema, reading.missing(dataset.schema) if reading else ()
    wanted, windows = _wanted(dataset, episode), sample_windows(dataset.episodes)
    sums = _merge([part.sums for part in parts])
    fits = reading if reading and not missing else None
    ends = {"first": sums.first, "last": sums.last}
    levels = levels_of(np.concatenate([part.reward_levels for part in parts]))
    total = {name: np.sum([part.total[name] for part in parts], axis=0) for name in sums.low}
    n_frames = dataset.episodes.n_frames
    stored, stored_note = stored_success(schema, sums.high, sums.last, levels)
    return Inspection(
        dataset=dataset,
        ranges={name: Ranges(sums.low[name], sums.high[name], total[name] / n_frames) for name in sums.low},
        ends=ends,
        outcome=outcome_of(decode(ends[fits.decisive], fits, schema)) if fits and fits.goal else None,
        stored=stored,
        stored_note=stored_note,
        reading=fits,
        missing=missing,
        break_mode=mode.name if mode else None,
        action=infer_action(sample_of(_joined([part.sample for part in parts]), windows, schema), _units(fits, schema)),
        shown=beginning(wanted, keep),
        kept=_joined([part.kept for part in parts]) if keep else {},
        kept_from=int(wanted.from_index[0]),
        about=read_about(dataset.root, schema, dataset.episodes.numbers),
    )


def beginning(episodes: EpisodeIndex, n_frames: int) -> EpisodeIndex:
    """Return the first episodes that fit into so many frames, of a longer first one its beginning, counted from 0.

    Examples
    --------
    >>> index = EpisodeIndex(from_index=np.array([5, 8]), to_index=np.array([8, 13]))
    >>> [beginning(index, n).to_index.tolist() for n in (2, 7, 8)]
    [[2], [3], [3, 8]]
    """
    first = episodes.from_index[0]
    fitting = int(np.searchsorted(episodes.to_index - first, n_frames, side="right"))
    fit = episodes.only(slice(max(fitting, 1)))
    return EpisodeIndex(fit.from_index - first, np.minimum(fit.to_index - first, n_frames), fit.numbers)


def outcome_of(decisive_frames: Decoded) -> Outcome:
    """Say how each episode ended, from the frame of each that decides, in the order of the episodes."""
    errors = frame_errors(decisive_frames)
    return Outcome(errors, in_tolerance(errors, decisive_frames.reading))


def metrics_json(metrics: dict[str, Any]) -> bytes:
    """Return the bytes of `metrics.json`: the same for the same numbers."""
    return msgspec.json.format(msgspec.json.encode(metrics), indent=2) + b"\n"


@dataclass(frozen=True, eq=False)
class _EpisodeSums:
    """One row for each part of an episode; all arrays have a row for each."""

    episode: Ints
    low: Columns
    high: Columns
    first: Columns
    last: Columns


@dataclass(frozen=True, eq=False)
class FileSums:
    """What is kept of one data file."""

    sums: _EpisodeSums
    total: dict[str, Floats]
    kept: Columns
    sample: Columns
    reward_levels: Floats


@dataclass(frozen=True, eq=False)
class _Fold:
    """Sums one data file up; an object and no closure, so that another process can be sent it."""

    episodes: EpisodeIndex
    keep_from: int
    keep_to: int
    windows: EpisodeIndex
    sampled: tuple[str, ...]

    def __call__(self, file: DataFile, frames: Columns) -> FileSums:
        place, starts, stops = parts_within(self.episodes, file.from_index, file.to_index)
        kept = slice(max(self.keep_from - file.from_index, 0), max(self.keep_to - file.from_index, 0))
        sums = _EpisodeSums(
            episode=place,
            low={name: reduce_parts(np.minimum, values, starts, stops) for name, values in frames.items()},
            high={name: reduce_parts(np.maximum, values, starts, stops) for name, values in frames.items()},
            first={name: values[starts] for name, values in frames.items()},
            last={name: values[stops - 1] for name, values in frames.items()},
        )
        total = {name: sum_parts(values, starts, stops) for name, values in frames.items()}
        # A copy: a slice would hold the whole file in memory.
        first_frames = {name: values[kept].copy() for name, values in frames.items()}
        _, starts, stops = parts_within(self.windows, file.from_index, file.to_index)
        rows = EpisodeIndex(starts, stops).frame_numbers
        sample = {name: frames[name][rows] for name in self.sampled}
        return FileSums(sums, total, first_frames, sample, levels_of(frames.get(REWARD, np.empty(0))))


def _wanted(dataset: Dataset, episode: int | None) -> EpisodeIndex:
    return dataset.episodes if episode is None else dataset.episodes.one(episode)


def _merge(parts: list[_EpisodeSums]) -> _EpisodeSums:
    """Join the rows of all files; an episode that lies in several files becomes one row again."""
    episode = np.concatenate([part.episode for part in parts])
    starts = np.flatnonzero(np.diff(episode, prepend=-1))
    stops = np.append(starts[1:], len(episode))

    def joined(column: str) -> Columns:
        return {name: np.concatenate([getattr(part, column)[name] for part in parts]) for name in parts[0].low}

    return _EpisodeSums(
        episode=episode[starts],
        low={name: np.minimum.reduceat(values, starts, axis=0) for name, values in joined("low").items()},
        high={name: np.maximum.reduceat(values, starts, axis=0) for name, values in joined("high").items()},
        first={name: values[starts] for name, values in joined("first").items()},
        last={name: values[stops - 1] for name, values in joined("last").items()},
    )


def _units(reading: Reading | None, schema: Schema) -> dict[str, str]:
    """Return what a reading says of the units of the action, by dimension."""
    names = schema.features[ACTION].labels if reading and ACTION in schema.features else ()
    return {name: reading.meaning(ACTION, name).unit for name in names} if reading else {}


def _joined(parts: list[Columns]) -> Columns:
    return {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}


def _rounded(driven: DrivenColumn) -> dict[str, Any]:
    """Return what one dimension of the action is as plain Python values, floats rounded to 6 places."""
    values = msgspec.to_builtins(driven)
    return {key: round(value, 6) if isinstance(value, float) else value for key, value in values.items()}


def _size(schema: Schema, feature: str) -> int | None:
    return schema.features[feature].size if feature in schema.features else None
