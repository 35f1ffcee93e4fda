"""Does the index agree with itself? It is stored three times: in the episode metadata, in the frames, and in totals."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from z2r.arrays import Bools, Floats, Ints
from z2r.audits.claims import Claims
from z2r.audits.frames import Before, FileColumns, FileFrames
from z2r.audits.runs import Runs
from z2r.check import Answer, Check
from z2r.errors import Fault
from z2r.format import rules
from z2r.format.episodes import EPISODES_DIR
from z2r.format.rules import and_more, episodes_of

# What LeRobot 0.6.1 allows between a timestamp and frame_index / fps [s] (`tolerance_s` of LeRobotDataset).
TIME_TOLERANCE = 1e-4

_FLOAT32_STEP = 2.0**-23  # of a number, to the next one


@Check("episode-order", "episodes are numbered 0, 1, 2 ... in order", "error").of(Claims)
def episode_order(claims: Claims) -> Iterator[Answer]:
    """Do the numbers of the episodes count on?"""
    yield from rules.episode_order(claims.table)


@Check("range-length", "every episode has frames, and as many as its range", "error").of(Claims)
def range_length(claims: Claims) -> Iterator[Answer]:
    """Is every range as long as the episode?"""
    yield from rules.range_length(claims.table)


@Check("range-overlap", "no frame belongs to two episodes", "error").of(Claims)
def range_overlap(claims: Claims) -> Iterator[Answer]:
    """Does an episode begin before the one before ends?"""
    yield from rules.range_overlap(claims.table)


@Check("range-gap", "every frame belongs to an episode", "error").of(Claims)
def range_gap(claims: Claims) -> Iterator[Answer]:
    """Does an episode begin after the one before ends?"""
    yield from rules.range_gap(claims.table)


FILE_POINTER = Check("file-pointer", "every episode is in the data file that the index names", "error")


@FILE_POINTER.of(Runs)
def pointers_lead_to_the_frames(runs: Runs) -> Iterator[Answer]:
    """Are the frames of each episode in the file that the metadata names?"""
    table, paths, places = runs.claims.table, runs.claims.paths, _places(runs)
    wrong = places.known & ~places.again & (table.file_number[places.row] != runs.file_number)
    if wrong.any():
        run = int(wrong.argmax())
        found = f"{paths[table.file_number[places.row][run]].as_posix()}{and_more(wrong)}"
        expected = f"{paths[runs.file_number[run]].as_posix()}, which holds its frames"
        mend = "Whoever looks where the index points finds nothing, or another episode: correct the index"
        place = f"data/file_index of episode {runs.number[run]}"
        yield Fault(EPISODES_DIR, place, found, expected, mend, episodes_of(runs.number, wrong))


@FILE_POINTER.of(Claims)
def episodes_of_a_file_are_side_by_side(claims: Claims) -> Iterator[Answer]:
    """Does the index name each data file once? The reader refuses what goes back and forth."""
    yield from rules.side_by_side(claims.table, claims.paths)


@Check("file-rows", "every data file has as many rows as its episodes have frames", "error").of(FileColumns)
def file_rows(file: FileColumns) -> Iterator[Answer]:
    """Has the file as many rows as its episodes have frames?"""
    if file.read.n_rows is not None:
        for fault in rules.file_rows(file.claims.path, file.read.n_rows, file.claims.n_claimed):
            yield fault._replace(mend="If it was cut off, `z2r inspect --salvage` reads the whole episodes")


@Check("index-column", "`index` counts all frames without a break", "error").of(FileFrames)
def index_column(frames: FileFrames) -> Iterator[Answer]:
    """Does `index` count on over all files?"""
    index = frames.counts.get("index")
    if index is None:
        return
    expected = frames.base + np.arange(len(index))
    wrong = index != expected
    if wrong.any():
        row = int(wrong.argmax())
        yield frames.fault("index", wrong, index[row], expected[row])


FRAME_COLUMN = Check("frame-column", "`frame_index` starts at 0 in every episode and counts on", "error")


@FRAME_COLUMN.of(FileFrames)
def frame_index_counts(frames: FileFrames) -> Iterator[Answer]:
    """Does `frame_index` start at 0 and count on?"""
    frame_index = frames.counts.get("frame_index")
    if frame_index is None:
        return
    wrong = _miscounted(frame_index, frames.before)
    if wrong.any():
        row = int(wrong.argmax())
        last = frame_index[row - 1] if row else frames.before and frames.before.frame_index
        expected = "0, as an episode begins" if last is None else f"{last + 1}, or 0 for a new episode"
        yield frames.fault("frame_index", wrong, frame_index[row], expected)


@FRAME_COLUMN.of(FileFrames)
def frame_index_starts_where_an_episode_begins(frames: FileFrames) -> Iterator[Answer]:
    """Is `frame_index` 0 where the metadata and `episode_index` both let an episode begin?"""
    seam = _seam(frames)
    if seam and seam.frame_index_is_wrong:
        found, expected = frames.counts["frame_index"][seam.row], "0 where an episode begins, and only there"
        yield frames.fault("frame_index", seam.differs, found, expected)


EPISODE_COLUMN = Check("episode-column", "`episode_index` changes where the index says that an episode ends", "error")


@EPISODE_COLUMN.of(FileFrames)
def episode_index_changes_where_frame_index_starts(frames: FileFrames) -> Iterator[Answer]:
    """Does `episode_index` change where `frame_index` starts again, and only there?"""
    seam = _seam(frames)
    if seam and not seam.frame_index_is_wrong:
        number, frame_index = frames.counts["episode_index"], frames.counts["frame_index"]
        found = "a new episode" if seam.changes else f"episode {number[seam.row]} still"
        expected = f"a new episode where frame_index is 0, and it is {frame_index[seam.row]} here"
        yield frames.fault("episode_index", seam.differs, found, expected)


@EPISODE_COLUMN.of(Runs)
def the_frames_agree_with_the_metadata(runs: Runs) -> Iterator[Answer]:
    """Does the episode metadata say of each episode what the frames say?"""
    places = _places(runs)
    crashed = "If the recording crashed, `z2r inspect --salvage` reads the episodes that are in both"
    yield from _wrong_run(runs, ~places.known, "", "an episode that is in meta/episodes", crashed)
    yield from _wrong_run(runs, places.again, " again", "the frames of an episode side by side", "")
    once = places.known & ~np.isin(runs.number, runs.number[places.again])
    table = runs.claims.table
    yield from _range_faults(runs, "dataset_from_index", table.start[places.row], runs.start, once)
    yield from _range_faults(runs, "dataset_to_index", table.stop[places.row], runs.stop, once)
    missing = ~np.isin(table.number, runs.number) & np.isin(table.file_number, runs.read)
    if missing.any():
        episode = int(missing.argmax())
        path, found = runs.claims.paths[table.file_number[episode]], f"no frame of episode {table.number[episode]}"
        named = episodes_of(table.number, missing)
        yield Fault(path, "episode_index", found + and_more(missing), f"{table.length[episode]} frames", episodes=named)


TIMESTAMP = Check("timestamp", "`timestamp` is frame_index / fps", "error")


@TIMESTAMP.of(FileFrames)
def timestamp(frames: FileFrames) -> Iterator[Answer]:
    """Is every timestamp frame_index / fps?"""
    stored, frame_index, fps = frames.timestamp, frames.counts.get("frame_index"), frames.schema.fps
    if stored is None or frame_index is None:
        return
    expected = frame_index / fps
    # A timestamp is stored in float32, whose steps grow with the number.
    wrong = ~(np.abs(stored - expected) <= TIME_TOLERANCE + _FLOAT32_STEP * np.abs(expected))
    if not wrong.any():
        return
    row = int(wrong.argmax())
    step = _step(stored, frame_index, frames.run_starts, row)
    off_everywhere = step > 1e-9 and abs(step * fps - 1) > 0.01
    wanted = f"{expected[row]:g} s, which is frame {frame_index[row]} at {fps:g} fps"
    mend = f"Its frames are {step:.3g} s apart: if that is right, fps is {1 / step:.3g}" if off_everywhere else ""
    yield frames.fault("timestamp", wrong, f"{stored[row]:g} s", wanted, mend, framed=True)


@TIMESTAMP.of(FileFrames)
def time_runs_forwards(frames: FileFrames) -> Iterator[Answer]:
    """Does time run forwards inside an episode?"""
    stored, frame_index = frames.timestamp, frames.counts.get("frame_index")
    if stored is None or frame_index is None:
        return
    backwards = np.concatenate([[False], (np.diff(stored) <= 0) & (np.diff(frame_index) > 0)])
    backwards[frames.run_starts] = False
    if backwards.any():
        row = int(backwards.argmax())
        found = f"{stored[row]:g} s after {stored[row - 1]:g} s"
        yield frames.fault("timestamp", backwards, found, "time that runs forwards inside an episode")


@Check("task-index", "every `task_index` is a task", "error").of(FileFrames)
def task_index(frames: FileFrames) -> Iterator[Answer]:
    """Is every task of a frame a task of the dataset?"""
    task, tasks = frames.counts.get("task_index"), frames.tasks
    if task is None or tasks is None:
        return
    wrong = ~np.isin(task, tasks)
    if wrong.any():
        row = int(wrong.argmax())
        yield frames.fault("task_index", wrong, task[row], f"one of the {len(tasks)} in meta/tasks.parquet")


class _Seam(NamedTuple):
    """Where `frame_index` and `episode_index` first disagree about an episode that begins."""

    row: int
    differs: Bools
    changes: bool
    frame_index_is_wrong: bool


def known_after(frames: FileFrames) -> Before:
    """Return what is known before the block that comes after these frames, of which there is one."""
    frame_index, seam = frames.counts.get("frame_index"), _seam(frames)
    wrong = seam.frame_index_is_wrong if seam else frames.before and frames.before.frame_index_is_wrong
    return Before(None if frame_index is None else int(frame_index[-1]), wrong)


def _step(stored: Floats, frame_index: Ints, starts: Ints, row: int) -> float:
    """Say how far apart the frames are of the run that a row is in [s]."""
    stops = np.append(starts[1:], len(stored))
    run = int(np.searchsorted(starts, row, side="right")) - 1
    rows = slice(int(starts[run]), int(stops[run]))
    steps = np.diff(stored[rows])[np.diff(frame_index[rows]) == 1]
    return float(np.median(steps)) if len(steps) else 0.0


def _miscounted(frame_index: Ints, before: Before | None) -> Bools:
    last = before.frame_index if before and before.frame_index is not None else frame_index[0]
    wrong: Bools = (frame_index != 0) & (np.diff(frame_index, prepend=last) != 1)
    return wrong


def _seam(frames: FileFrames) -> _Seam | None:
    """Where the two disagree, the metadata has the casting vote at the first such row, if it hangs together."""
    frame_index, number = frames.counts.get("frame_index"), frames.counts.get("episode_index")
    if frame_index is None or number is None:
        return None
    changes = np.concatenate([[True], np.diff(number) != 0])
    differs = (changes != (frame_index == 0)) & ~_miscounted(frame_index, frames.before)
    if not differs.any():
        return None
    row, claimed = int(differs.argmax()), frames.claims.episodes
    begins = None if claimed is None else bool(np.isin(frames.base + row, claimed.from_index))
    wrong = frames.before and frames.before.frame_index_is_wrong
    return _Seam(
        row, differs, bool(changes[row]), (begins is not None and begins == changes[row]) if wrong is None else wrong
    )


class _Places(NamedTuple):
    """Of each run of frames: the row of its episode, whether there is one, and whether an earlier run has it too."""

    row: Ints
    known: Bools
    again: Bools


def _places(runs: Runs) -> _Places:
    table = runs.claims.table
    order = np.argsort(table.number, kind="stable")
    row = order[np.minimum(np.searchsorted(table.number[order], runs.number), len(order) - 1)]
    again = np.ones(len(runs.number), dtype=bool)
    again[np.unique(runs.number, return_index=True)[1]] = False
    return _Places(row, table.number[row] == runs.number, again)


def _wrong_run(runs: Runs, wrong: Bools, what: str, expected: str, mend: str) -> Iterator[Answer]:
    if wrong.any():
        run = int(wrong.argmax())
        found, place = f"{runs.number[run]}{what}{and_more(wrong)}", f"episode_index of frame {runs.start[run]}"
        named = episodes_of(runs.number, wrong)
        yield Fault(runs.claims.paths[runs.file_number[run]], place, found, expected, mend, named)


def _range_faults(runs: Runs, field: str, claimed: Ints, seen: Ints, once: Bools) -> Iterator[Answer]:
    wrong = once & (claimed != seen)
    if wrong.any():
        run = int(wrong.argmax())
        expected = f"{seen[run]}, as episode_index in {runs.claims.paths[runs.file_number[run]].as_posix()} says"
        place = f"{field} of episode {runs.number[run]}"
        found, named = f"{claimed[run]}{and_more(wrong)}", episodes_of(runs.number, wrong)
        yield Fault(EPISODES_DIR, place, found, expected, episodes=named)
