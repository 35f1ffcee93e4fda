"""What is wrong with a dataset? Every check in one pass over its files; each fault is a finding, and none an exception.

The reader believes its input or refuses it at the first fault. The audit does neither: it holds what a dataset says of
itself in one place against what it says in another, and goes on.
"""

import os
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from difflib import get_close_matches
from itertools import chain
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
import numpy as np

from z2r.arrays import Bools, Columns, Ints, Progress, no_progress
from z2r.audits import CHECKS, frames, index, values
from z2r.audits.claims import Story, believe, read_story
from z2r.audits.findings import Finding, from_fault, warning
from z2r.errors import DatasetError
from z2r.format.dataset import in_threads
from z2r.format.episodes import EpisodeIndex
from z2r.format.parquet import open_parquet
from z2r.format.schema import ACTION, BOOKKEEPING, INFO_PATH, MAX_SIGNAL_SIZE, Schema, inside
from z2r.pusht import checks as physics
from z2r.pusht.verdict import read_verdict, verdict_path
from z2r.pusht.world import PUSHT
from z2r.reading.breaks import BreakMode
from z2r.reading.reading import Reading

MAX_OF_A_CHECK = 5  # findings in detail: a fault that is in every file would hide the others

_SOME = 5  # names in one line
_ORDER = {name: number for number, name in enumerate(CHECKS)}


class Audit(msgspec.Struct, frozen=True):
    """What is wrong with a dataset, and what nobody looked at.

    Attributes
    ----------
    findings : tuple of Finding
        In the order of the checks; empty where nothing is wrong.
    more : dict of str to int
        How many further findings of a check are left out.
    not_checked : tuple of str
        What was not checked, and why.
    n_episodes, n_frames : int
        How many there are, as far as they could be read.
    break_mode : str or None
        Which assumption was wrong on purpose.
    readable : bool
        False where `meta/info.json` or all episode metadata cannot be read, so that no frame was looked at.
    """

    findings: tuple[Finding, ...]
    more: dict[str, int]
    not_checked: tuple[str, ...]
    n_episodes: int
    n_frames: int
    break_mode: str | None
    readable: bool

    @property
    def exit_code(self) -> int:
        """0 where there is no error and no warning, 1 where there is one, 2 where the dataset is not readable."""
        if not self.readable:
            return 2
        return int(any(finding.severity != "note" for finding in self.findings))

    def to_dict(self, source: str) -> dict[str, Any]:
        """Return the audit as plain Python values for `z2r audit --json`; keys are added and never renamed.

        Parameters
        ----------
        source : str
            What was audited, such as ``standin``.

        Returns
        -------
        dict
            ``source``, ``break_mode``, ``exit_code``, ``n_episodes``, ``n_frames``; ``n_errors``, ``n_warnings``,
            ``n_notes``, of those in ``findings``; ``findings``, each with ``check``, ``severity``, ``file``, ``field``,
            ``found``, ``expected`` and ``mend``; ``more``, how many findings of a check are left out; and
            ``not_checked``.
        """
        counts = Counter(finding.severity for finding in self.findings)
        return {
            "source": source,
            "break_mode": self.break_mode,
            "exit_code": self.exit_code,
            "n_episodes": self.n_episodes,
            "n_frames": self.n_frames,
            **{f"n_{severity}s": counts[severity] for severity in ("error", "warning", "note")},
            "findings": [msgspec.to_builtins(finding) for finding in self.findings],
            "more": self.more,
            "not_checked": list(self.not_checked),
        }


def audit(
    root: str | os.PathLike[str],
    mode: BreakMode | None = None,
    reading: Reading = PUSHT,
    progress: Progress = no_progress,
) -> Audit:
    """Look for everything that can be wrong with a dataset, in one pass over its files.

    Parameters
    ----------
    root : str or path
        The folder of a LeRobot v3 dataset. It is not written to, and nothing outside of it is read but the simulator's
        verdict beside it.
    mode : BreakMode, optional
        Audit what somebody believes who gets this assumption wrong. The dataset must be whole.
    reading : Reading, optional
        What the columns mean. Where the schema lacks its columns, the checks of the reading are left out.
    progress : callable, optional
        Called with the number of data files done and the number of all, after each.

    Returns
    -------
    Audit
        Memory is bounded by the data files in flight, at most four, and a few numbers for each episode.

    Raises
    ------
    DatasetError
        Only with a `mode`: if the dataset is not whole.

    Examples
    --------
    >>> import z2r
    >>> z2r.audit(z2r.STANDIN).findings
    ()
    >>> [finding.check for finding in z2r.audit(z2r.STANDIN, z2r.break_mode("yaw-swap-everywhere")).findings]
    ['overlap']
    """
    root = Path(root)
    if mode:
        reading = mode.reading(reading)
    try:
        story = believe(root, mode) if mode else read_story(root)
    except DatasetError as fault:
        if mode:
            raise
        check = "version" if fault.fault.field == "codebase_version" else "info"
        return _ended([from_fault(check, fault, root)])
    if not len(story.rows.number):
        return _ended(story.findings)
    bases = _first_frames(root, story, mode)
    parts = _fold_files(root, story, bases, reading, progress)
    findings = [
        *story.findings,
        *_check_names(reading, story.schema),
        *_judge(root, story, parts, bases, reading),
    ]
    n_frames = sum(part.n_rows or 0 for part in parts)
    left_out = _not_checked(root, story, parts, reading)
    return _audit(findings, left_out, len(story.rows.number), n_frames, mode, readable=True)


class _Part(NamedTuple):
    """What is kept of one data file."""

    n_rows: int | None
    findings: list[Finding]
    starts: Ints  # first row of each run of frames with one episode_index
    numbers: Ints | None  # their episode_index
    runs: dict[str, values.RunStats]
    sums: physics.Sums | None


def _fold_files(
    root: Path, story: Story, bases: Sequence[int], reading: Reading, progress: Callable[[int, int], None]
) -> list[_Part]:
    parts = []
    for part in in_threads(lambda file: _fold(root, story, file, bases[file], reading), range(len(story.files))):
        parts.append(part)
        progress(len(parts), len(story.files))
    return parts


def _first_frames(root: Path, story: Story, mode: BreakMode | None) -> list[int]:
    """Say which frame of the dataset each file begins with: by the metadata, or by the rows where that is no story."""
    if story.trusted and not mode:
        return [int(story.rows.start[story.rows.file == file].min()) for file in range(len(story.files))]
    bases = [0]
    for file, path in enumerate(story.files):
        try:
            n_rows = open_parquet(inside(root, path)).metadata.num_rows
        except DatasetError:
            n_rows = int(story.rows.length[story.rows.file == file].sum())
        bases.append(bases[-1] + n_rows)
    return bases[:-1]


def _fold(root: Path, story: Story, file: int, base: int, reading: Reading) -> _Part:
    path, schema = story.files[file], story.schema
    read = frames.read_file(root, schema, path)
    findings = read.findings
    if not read.n_rows:
        if read.n_rows == 0:
            findings += index.check_file_length(story.rows, file, 0, path)
        return _Part(read.n_rows, findings, np.array([], dtype=np.int64), None, {}, None)
    told = {name: values[:, 0] for name, values in read.frames.items() if name in BOOKKEEPING}
    findings += index.check_file_length(story.rows, file, read.n_rows, path)
    findings += _check_columns(told, story, base, path)
    number = told.get("episode_index")
    changes = np.zeros(read.n_rows, dtype=bool) if number is None else np.diff(number, prepend=number[0]) != 0
    changes[0] = True
    starts = np.flatnonzero(changes)
    findings += values.check_unit_circle(read.frames, schema, path)
    # Not the bookkeeping: LeRobot does not renew its statistics when it edits a dataset.
    runs = {name: values.sum_up(column, starts) for name, column in read.frames.items() if name not in BOOKKEEPING}
    numbers = None if number is None else number[starts].astype(np.int64)
    sums = None
    if _fits(reading, schema) and {reading.feature, ACTION} <= set(read.frames):
        episodes = story.episodes if story.trusted else _of_runs(starts, numbers, base, read.n_rows)
        sums = physics.fold(read.frames, base, episodes, reading, schema)
    return _Part(read.n_rows, findings, starts, numbers, runs, sums)


def _check_columns(told: Columns, story: Story, base: int, path: Path) -> Iterator[Finding]:
    whole = {name: column.astype(np.int64) for name, column in told.items() if name != "timestamp"}
    if "index" in whole:
        yield from index.check_counting(whole["index"], base, path)
    if "frame_index" in whole:
        begins = np.isin(base + np.arange(len(whole["frame_index"])), story.rows.start) if story.trusted else None
        yield from index.check_frame_index(whole["frame_index"], whole.get("episode_index"), begins, path)
    if "timestamp" in told and "frame_index" in whole:
        timestamp = told["timestamp"].astype(np.float64)
        yield from index.check_timestamps(timestamp, whole["frame_index"], story.schema.fps, path)
    if "task_index" in whole:
        yield from index.check_task_index(whole["task_index"], story.tasks, path)


def _of_runs(starts: Ints, numbers: Ints | None, base: int, n_rows: int) -> EpisodeIndex:
    """Where episodes end by the frames' own `episode_index`: the metadata is no story to go by."""
    stops = np.append(starts[1:], n_rows)
    return EpisodeIndex(base + starts, base + stops, np.arange(len(starts)) if numbers is None else numbers)


def _judge(
    root: Path, story: Story, parts: Sequence[_Part], bases: Sequence[int], reading: Reading
) -> Iterator[Finding]:
    yield from chain.from_iterable(part.findings for part in parts)
    readable = [part for part in parts if part.n_rows]
    if readable and all(part.numbers is not None for part in readable):
        yield from _judge_runs(root, story, parts, bases)
    if readable and all(part.sums for part in readable):
        sums = [part.sums for part in readable if part.sums]
        files = [path for path, part in zip(story.files, parts, strict=True) if part.sums]
        yield from physics.judge(sums, files, reading)
        yield from _judge_verdict(root, story, physics.reached(sums, reading))


def _judge_runs(root: Path, story: Story, parts: Sequence[_Part], bases: Sequence[int]) -> Iterator[Finding]:
    """Hold the runs of frames against the metadata, and the values of each run against those of the others."""
    tables = [
        index.Runs(
            part.numbers,
            base + part.starts,
            base + np.append(part.starts[1:], part.n_rows or 0),
            np.full(len(part.starts), file),
        )
        for file, (part, base) in enumerate(zip(parts, bases, strict=True))
        if part.numbers is not None
    ]
    runs = index.Runs(*(np.concatenate(columns) for columns in zip(*tables, strict=True)))
    yield from index.check_runs(story.rows, runs, story.files, [i for i, part in enumerate(parts) if part.n_rows])
    readable = [part.runs for part in parts if part.n_rows]
    signals = story.schema.signals()
    shared = [name for name in signals if all(name in part for part in readable)]
    stats = {name: values.joined([part[name] for part in readable]) for name in shared}
    for name in shared:
        yield from values.check_jumps(name, signals[name], stats[name], runs.number)
    yield from values.check_frozen(story.schema, stats, runs.number)
    yield from values.check_dead(story.schema, stats)
    yield from values.check_twins(stats, runs.number)
    # Of a matrix, LeRobot stores the statistics of the last axis only.
    flat = {name: stats[name] for name in shared if len(signals[name].shape) == 1}
    if story.stats is not None and all(part.n_rows for part in parts):
        yield from values.check_stats(story.stats, flat, story.schema)
    run_of_episode = {number: run for run, number in enumerate(runs.number.tolist())}
    yield from values.check_episode_stats(root, story.shards, story.schema, flat, run_of_episode)


def _judge_verdict(root: Path, story: Story, reached: Bools) -> Iterator[Finding]:
    name = verdict_path(root).name
    try:
        verdict = read_verdict(root)
    except DatasetError as fault:
        yield warning("verdict", name, *fault.fault[1:4])
        return
    if verdict and len(reached) == len(story.episodes):
        yield from physics.check_verdict(reached, story.episodes, verdict, name)


def _check_names(reading: Reading, schema: Schema) -> Iterator[Finding]:
    """Is a name of the reading misspelt? Then the reading does not fit, and nothing says what the columns mean."""
    feature = schema.features.get(reading.feature)
    others = [name for name in (feature.dim_names if feature else ()) if name not in reading.names]
    for name in reading.missing(schema):
        for close in get_close_matches(name, others, n=1, cutoff=0.85):
            mend = "If it is this column, mend its name: without it, nothing says what the columns mean"
            yield warning("info", INFO_PATH, f"features.{reading.feature}.names", close, name, mend)


def _fits(reading: Reading, schema: Schema) -> bool:
    return not reading.missing(schema) and not reading.missing_action(schema)


def _not_checked(root: Path, story: Story, parts: Sequence[_Part], reading: Reading) -> tuple[str, ...]:
    """Say what nobody looked at."""
    schema = story.schema
    missing = []
    unread = sum(part.n_rows is None for part in parts)
    if unread:
        missing.append(f"the frames of {unread} of {len(parts)} data files: they cannot be read")
    if not _fits(reading, schema):
        missing.append("what the columns mean: they are not those of the PushT task, the only reading there is")
        missing.append("whether an action is possible, and whether it does what it says: nothing states its limits")
        missing.append("success: nothing says what it would be")
    elif not all(part.sums for part in parts):
        missing.append("the reading: the state or the action of some file cannot be used")
    elif not verdict_path(root).is_file():
        missing.append(
            "whether the tolerances are those of the task: no verdict of the simulator is beside the dataset"
        )
    unclean = sorted(
        {finding.field.split("[")[0] for part in parts for finding in part.findings if finding.check == "finite"}
    )
    if unclean:
        missing.append(f"jumps, standstill and statistics of {', '.join(unclean[:_SOME])}: not all values are numbers")
    pictures = [name for name, feature in schema.features.items() if not feature.is_numeric]
    if pictures:
        missing.append(f"pictures and text: {', '.join(pictures[:_SOME])} (only that the files are there)")
    unsummed = [name for name, f in schema.features.items() if f.is_numeric and f.size > MAX_SIGNAL_SIZE]
    if unsummed:
        missing.append(f"the values of {', '.join(unsummed[:_SOME])}: more than {MAX_SIGNAL_SIZE} numbers a frame")
    missing.append("stored quantiles (q01, q10 ...): LeRobot estimates them, so they need not be those of the data")
    missing.append("whether the text of a task is true, and whether the demonstrations are any good")
    return tuple(missing)


def _ended(findings: Sequence[Finding]) -> Audit:
    nothing_else = "everything else: without meta/info.json and the episode metadata, frames mean nothing"
    return _audit(findings, (nothing_else,), 0, 0, None, readable=False)


def _audit(
    findings: Sequence[Finding],
    not_checked: tuple[str, ...],
    n_episodes: int,
    n_frames: int,
    mode: BreakMode | None,
    *,
    readable: bool,
) -> Audit:
    seen: Counter[str] = Counter()
    kept = []
    for finding in sorted(findings, key=lambda finding: _ORDER[finding.check]):
        seen[finding.check] += 1
        if seen[finding.check] <= MAX_OF_A_CHECK:
            kept.append(finding)
    more = {check: count - MAX_OF_A_CHECK for check, count in seen.items() if count > MAX_OF_A_CHECK}
    return Audit(tuple(kept), more, not_checked, n_episodes, n_frames, mode.name if mode else None, readable)
