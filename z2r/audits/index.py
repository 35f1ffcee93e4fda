"""Is the index one story? It is told three times: by the episode metadata, by columns of the frames, and by totals."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from z2r.arrays import Bools, Floats, Ints
from z2r.audits.findings import Finding, error
from z2r.audits.structure import Rows
from z2r.format.episodes import EPISODES_DIR

# What LeRobot 0.6.1 allows between a timestamp and frame_index / fps [s] (`tolerance_s` of LeRobotDataset).
TIME_TOLERANCE = 1e-4

_FLOAT32_STEP = 2.0**-23  # of a number, to the next one


class Runs(NamedTuple):
    """Frames of one data file that follow each other and have one `episode_index`: a row for each such run.

    All int64[n_runs]; `start` and `stop` count the frames of the whole dataset.
    """

    number: Ints
    start: Ints
    stop: Ints
    file: Ints


def check_rows(rows: Rows) -> Iterator[Finding]:
    """Do the ranges of the episode metadata follow each other?"""
    ends_before = np.concatenate([[0], rows.stop[:-1]])
    empty = rows.stop <= rows.start
    begins, ends = "dataset_from_index", "dataset_to_index"
    follows = ", where the episode before ends"
    yield from _wrong_row("episode-order", "episode_index", rows, rows.number, np.arange(len(rows.number)))
    yield from _wrong_row("range-length", "length", rows, rows.length, rows.stop - rows.start)
    yield from _wrong_row("range-length", ends, rows, rows.stop, rows.start, empty, before="more than ")
    overlap, gap = (rows.start < ends_before) & ~empty, (rows.start > ends_before) & ~empty
    yield from _wrong_row("range-overlap", begins, rows, rows.start, ends_before, overlap, after=follows)
    yield from _wrong_row("range-gap", begins, rows, rows.start, ends_before, gap, after=follows)


def _wrong_row(
    check: str,
    field: str,
    rows: Rows,
    told: Ints,
    expected: Ints,
    wrong: Bools | None = None,
    before: str = "",
    after: str = "",
) -> Iterator[Finding]:
    """Name the first wrong row of the metadata; wrong is, unless given, what is not as expected."""
    wrong = told != expected if wrong is None else wrong
    if wrong.any():
        row = int(wrong.argmax())
        place = f"{field} in row {row}" if field == "episode_index" else f"{field} of episode {rows.number[row]}"
        mend = "The episode metadata was written or edited wrong: rebuild it from the columns of the frames"
        found = f"{told[row]}{and_more(wrong)}"
        yield error(check, EPISODES_DIR, place, found, f"{before}{expected[row]}{after}", mend)


def check_runs(rows: Rows, runs: Runs, files: Sequence[Path], read: Sequence[int]) -> Iterator[Finding]:
    """Does the episode metadata say of each episode what the frames say? Of `files`, those at `read` could be read."""
    order = np.argsort(rows.number, kind="stable")
    row = order[np.minimum(np.searchsorted(rows.number[order], runs.number), len(order) - 1)]
    unknown = rows.number[row] != runs.number
    again = np.ones(len(runs.number), dtype=bool)
    again[np.unique(runs.number, return_index=True)[1]] = False
    crashed = "If the recording crashed, `z2r inspect --salvage` reads the episodes that are in both"
    yield from _wrong_run(runs, files, unknown, "", "an episode that is in meta/episodes", crashed)
    yield from _wrong_run(runs, files, again, " again", "the frames of an episode side by side", "")
    once = ~unknown & ~np.isin(runs.number, runs.number[again])
    yield from _pointers(rows, runs, row, ~unknown & ~again, files)
    yield from _ranges(runs, files, "dataset_from_index", rows.start[row], runs.start, once)
    yield from _ranges(runs, files, "dataset_to_index", rows.stop[row], runs.stop, once)
    missing = ~np.isin(rows.number, runs.number) & np.isin(rows.file, read)
    if missing.any():
        episode = int(missing.argmax())
        found, expected = f"no frame of episode {rows.number[episode]}{and_more(missing)}", rows.length[episode]
        yield error("episode-column", files[rows.file[episode]], "episode_index", found, f"{expected} frames")


def _wrong_run(
    runs: Runs, files: Sequence[Path], wrong: Bools, what: str, expected: str, mend: str
) -> Iterator[Finding]:
    if wrong.any():
        run = int(wrong.argmax())
        found = f"{runs.number[run]}{what}{and_more(wrong)}"
        place = f"episode_index of frame {runs.start[run]}"
        yield error("episode-column", files[runs.file[run]], place, found, expected, mend)


def _ranges(runs: Runs, files: Sequence[Path], field: str, told: Ints, seen: Ints, once: Bools) -> Iterator[Finding]:
    wrong = once & (told != seen)
    if wrong.any():
        run = int(wrong.argmax())
        expected = f"{seen[run]}, as episode_index in {files[runs.file[run]].as_posix()} says"
        found = f"{told[run]}{and_more(wrong)}"
        yield error("episode-column", EPISODES_DIR, f"{field} of episode {runs.number[run]}", found, expected)


def _pointers(rows: Rows, runs: Runs, row: Ints, known: Bools, files: Sequence[Path]) -> Iterator[Finding]:
    wrong = known & (rows.file[row] != runs.file)
    if wrong.any():
        run = int(wrong.argmax())
        yield error(
            "file-pointer",
            EPISODES_DIR,
            f"data/file_index of episode {runs.number[run]}",
            f"{files[rows.file[row][run]].as_posix()}{and_more(wrong)}",
            f"{files[runs.file[run]].as_posix()}, which holds its frames",
            "Whoever looks where the index points finds nothing, or another episode: correct the index",
        )


def check_file_length(rows: Rows, file: int, n_rows: int, path: Path) -> Iterator[Finding]:
    """Has a data file as many rows as the episodes that are in it have frames?"""
    claimed = int(rows.length[rows.file == file].sum())
    if claimed != n_rows:
        cut_off = "If it was cut off, `z2r inspect --salvage` reads the whole episodes"
        yield error("file-rows", path, "rows", n_rows, f"{claimed}, the frames of its episodes", cut_off)


def check_counting(index: Ints, base: int, path: Path) -> Iterator[Finding]:
    """Does `index` count on over all files?"""
    expected = base + np.arange(len(index))
    wrong = index != expected
    if wrong.any():
        row = int(wrong.argmax())
        yield error("index-column", path, f"index in row {row}", f"{index[row]}{and_more(wrong)}", expected[row])


def check_frame_index(frame_index: Ints, number: Ints | None, begins: Bools | None, path: Path) -> Iterator[Finding]:
    """Does `frame_index` start at 0 and count on, and start again where `episode_index` changes?

    Where the two disagree, `begins` has the casting vote: whether an episode begins in a row by the metadata.
    """
    starts = frame_index == 0
    wrong = ~starts
    wrong[1:] &= np.diff(frame_index) != 1
    if wrong.any():
        row = int(wrong.argmax())
        expected = f"{frame_index[row - 1] + 1}, or 0 for a new episode" if row else "0, as an episode begins"
        yield error("frame-column", path, f"frame_index in row {row}", f"{frame_index[row]}{and_more(wrong)}", expected)
    if number is None:
        return
    changes = np.concatenate([[True], np.diff(number) != 0])
    differs = (changes != starts) & ~wrong
    if differs.any():
        row = int(differs.argmax())
        if begins is not None and begins[row] == changes[row]:
            found, expected = f"{frame_index[row]}{and_more(differs)}", "0 where an episode begins, and only there"
            yield error("frame-column", path, f"frame_index in row {row}", found, expected)
            return
        found = ("a new episode" if changes[row] else f"episode {number[row]} still") + and_more(differs)
        expected = f"a new episode where frame_index is 0, and it is {frame_index[row]} here"
        yield error("episode-column", path, f"episode_index in row {row}", found, expected)


def check_timestamps(timestamp: Floats, frame_index: Ints, fps: float, path: Path) -> Iterator[Finding]:
    """Is every timestamp frame_index / fps?"""
    expected = frame_index / fps
    # A timestamp is stored in float32, whose steps grow with the number.
    wrong = ~(np.abs(timestamp - expected) <= TIME_TOLERANCE + _FLOAT32_STEP * np.abs(expected))
    if not wrong.any():
        return
    row = int(wrong.argmax())
    steps = np.diff(timestamp)[np.diff(frame_index) == 1]
    step = np.median(steps) if len(steps) else 0.0
    off_everywhere = step > 1e-9 and abs(step * fps - 1) > 0.01
    found = f"{timestamp[row]:g} s{and_more(wrong)}"
    wanted = f"{expected[row]:g} s, which is frame {frame_index[row]} at {fps:g} fps"
    mend = f"Its frames are {step:.3g} s apart: if that is right, fps is {1 / step:.3g}" if off_everywhere else ""
    yield error("timestamp", path, f"timestamp in row {row}", found, wanted, mend)
    backwards = np.concatenate([[False], (np.diff(timestamp) <= 0) & (np.diff(frame_index) > 0)])
    if backwards.any():
        row = int(backwards.argmax())
        found = f"{timestamp[row]:g} s after {timestamp[row - 1]:g} s{and_more(backwards)}"
        yield error("timestamp", path, f"timestamp in row {row}", found, "time that runs forwards inside an episode")


def check_task_index(task_index: Ints, tasks: Ints | None, path: Path) -> Iterator[Finding]:
    """Is every task of a frame a task of the dataset?"""
    if tasks is None:
        return
    wrong = ~np.isin(task_index, tasks)
    if wrong.any():
        row = int(wrong.argmax())
        found = f"{task_index[row]}{and_more(wrong)}"
        expected = f"one of the {len(tasks)} in meta/tasks.parquet"
        yield error("task-index", path, f"task_index in row {row}", found, expected)


def and_more(wrong: Bools) -> str:
    """Say how many more there are beside the first, if any."""
    more = int(wrong.sum()) - 1
    return f" (and {more:,} more like it)" if more else ""
