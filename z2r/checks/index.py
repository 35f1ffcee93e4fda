"""Is the index one story? It is told three times: by the episode metadata, by columns of the frames, and by totals."""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from z2r.checks.findings import Finding, error
from z2r.checks.structure import Ints, Rows
from z2r.episodes import EPISODES_DIR

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
    yield from _first_wrong("episode-order", "episode_index", rows.number, np.arange(len(rows.number)), rows)
    yield from _first_wrong("range-length", "length", rows.length, rows.stop - rows.start, rows)
    ends_before = np.concatenate([[0], rows.stop[:-1]])
    empty = rows.stop <= rows.start
    for check, wrong, expected in (
        ("range-length", empty, "more than dataset_from_index, "),
        ("range-overlap", (rows.start < ends_before) & ~empty, ""),
        ("range-gap", (rows.start > ends_before) & ~empty, ""),
    ):
        if not wrong.any():
            continue
        row = int(wrong.argmax())
        found, wanted = (rows.stop, rows.start) if expected else (rows.start, ends_before)
        yield error(
            check,
            EPISODES_DIR,
            f"{'dataset_to_index' if expected else 'dataset_from_index'} of episode {rows.number[row]}",
            f"{found[row]}{and_more(wrong)}",
            f"{expected}{wanted[row]}" + ("" if expected else ", where the episode before ends"),
            "The episode metadata was written or edited wrong: rebuild it from the columns of the frames",
        )


def check_runs(rows: Rows, runs: Runs, files: Sequence[Path], read: Sequence[int]) -> Iterator[Finding]:
    """Does the episode metadata say of each episode what the frames say? Of `files`, those at `read` could be read."""
    order = np.argsort(rows.number, kind="stable")
    place = np.minimum(np.searchsorted(rows.number[order], runs.number), len(order) - 1)
    row = order[place]
    unknown = rows.number[row] != runs.number
    if unknown.any():
        run = int(unknown.argmax())
        yield error(
            "episode-column",
            files[runs.file[run]],
            f"episode_index of frame {runs.start[run]}",
            f"{runs.number[run]}{and_more(unknown)}",
            "an episode that is in meta/episodes",
            "If the recording crashed, `z2r inspect --salvage` reads the episodes that are in both",
        )
    repeated = np.ones(len(runs.number), dtype=bool)
    repeated[np.unique(runs.number, return_index=True)[1]] = False
    if repeated.any():
        run = int(repeated.argmax())
        yield error(
            "episode-column",
            files[runs.file[run]],
            f"episode_index of frame {runs.start[run]}",
            f"{runs.number[run]} again{and_more(repeated)}",
            "the frames of an episode side by side",
        )
    known = ~unknown & ~repeated
    yield from _pointers(rows, runs, row, known, files)
    alone = known & ~np.isin(runs.number, runs.number[repeated])
    for field, told, seen in (
        ("dataset_from_index", rows.start[row], runs.start),
        ("dataset_to_index", rows.stop[row], runs.stop),
    ):
        wrong = alone & (told != seen)
        if wrong.any():
            run = int(wrong.argmax())
            yield error(
                "episode-column",
                EPISODES_DIR,
                f"{field} of episode {runs.number[run]}",
                f"{told[run]}{and_more(wrong)}",
                f"{seen[run]}, as episode_index in {files[runs.file[run]].as_posix()} says",
            )
    missing = ~np.isin(rows.number, runs.number) & np.isin(rows.file, read)
    if missing.any():
        episode = int(missing.argmax())
        yield error(
            "episode-column",
            files[rows.file[episode]] if len(files) else "data",
            "episode_index",
            f"no frame of episode {rows.number[episode]}{and_more(missing)}",
            f"{rows.length[episode]} frames",
        )


def _pointers(rows: Rows, runs: Runs, row: Ints, known: NDArray[np.bool_], files: Sequence[Path]) -> Iterator[Finding]:
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


def check_frame_index(
    frame_index: Ints, number: Ints | None, begins: NDArray[np.bool_] | None, path: Path
) -> Iterator[Finding]:
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


def check_timestamps(timestamp: NDArray[np.float64], frame_index: Ints, fps: float, path: Path) -> Iterator[Finding]:
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
    mend = f"Its frames are {step:.3g} s apart, which would be {1 / step:.3g} fps" if off_everywhere else ""
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


def _first_wrong(check: str, field: str, told: Ints, expected: Ints, rows: Rows) -> Iterator[Finding]:
    wrong = told != expected
    if wrong.any():
        row = int(wrong.argmax())
        place = f"{field} in row {row}" if field == "episode_index" else f"{field} of episode {rows.number[row]}"
        yield error(check, EPISODES_DIR, place, f"{told[row]}{and_more(wrong)}", f"{expected[row]}")


def and_more(wrong: NDArray[np.bool_]) -> str:
    """Say how many more there are beside the first, if any."""
    more = int(wrong.sum()) - 1
    return f" (and {more:,} more like it)" if more else ""
