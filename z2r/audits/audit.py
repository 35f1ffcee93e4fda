"""What is wrong with a dataset? Every check in one pass over its files; each fault is a finding, and none an exception.

The reader believes its input or refuses it at the first fault. The audit does neither: it holds what a dataset says of
itself in one place against what it says in another, and goes on.
"""

import itertools
import os
import re
import threading
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Iterator, Sequence
from concurrent.futures import Executor
from functools import partial
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
import numpy as np
from msgspec.structs import replace

from z2r.arrays import Floats, Ints, Pile, Progress, join_all, keep_freed_memory, no_progress
from z2r.audits import (
    cameras,
    deeds,
    ends,
    gears,
    index,
    joints,
    kinds,
    labels,
    motion,
    pictures,
    quantiles,
    readiness,
    relations,
    scales,
    stats,
    structure,
    tasks,
    values,
)
from z2r.audits.claims import Claims, NoSchema, Stored, claims_under, read_claims
from z2r.audits.deeds import fold_comes
from z2r.audits.findings import AUDIT, Finding, Said, answers, ask, failed, together
from z2r.audits.following import MIN_FRAMES, Pair, Usual, fold_following, pairs_of
from z2r.audits.footage import FileImages, Footage, read_file_images, read_footage, sum_images, sum_places
from z2r.audits.frames import HEAD_FRAMES, Before, FileClaims, FileColumns, FileFrames, file_claims
from z2r.audits.glances import glance_at, join_filmed
from z2r.audits.joints import Joints
from z2r.audits.labels import Labels, fold_labels, labels_of_episodes
from z2r.audits.looks import Looks, looks_of_glances, looks_of_sizes
from z2r.audits.readiness import fold_idle
from z2r.audits.relations import keep_moments, moments_to_keep
from z2r.audits.runs import FileSums, Motion, Runs, join_runs
from z2r.audits.steps import moves, run_sums
from z2r.audits.tasks import fold_tasks
from z2r.check import SEVERITIES, Check, asked_of, parts_in
from z2r.data.urls import place_of
from z2r.errors import DatasetError, count, some
from z2r.format.about import cameras_of
from z2r.format.dataset import in_order
from z2r.format.decoding import check_can_decode
from z2r.format.schema import ACTION, MAX_SIGNAL_SIZE, STATE, Schema, column_label
from z2r.format.tables import DataColumns, read_data_blocks, read_data_file, read_data_footer
from z2r.reading.breaks import BreakMode
from z2r.reading.decode import Decoded, can_decode, decode
from z2r.reading.joints import is_gripper
from z2r.reading.reading import Reading
from z2r.reading.scene import Scene, SceneSums
from z2r.reading.stored import label_in

NOTHING_AUDITED = 3
"""The exit code where no frame was looked at: neither 0, for nothing is known, nor 1, for nothing was found."""

MAX_OF_A_CHECK = 5  # findings in detail: a fault that is in every file would hide the others
_AT_ONCE = 2**15  # rows that a scene looks at
# Threads read beside each other. Two that fold get in each other's way at every array: for a fifth more of processor
# time, in no less time.
_FOLDING = threading.Lock()

PARTS = parts_in(
    structure,
    index,
    tasks,
    values,
    joints,
    gears,
    scales,
    motion,
    ends,
    relations,
    stats,
    quantiles,
    labels,
    kinds,
    deeds,
    readiness,
    cameras,
    pictures,
)
"""What every dataset is asked, in the order in which findings come."""


def all_checks(scene: Scene | None = None) -> tuple[Check, ...]:
    """Return all checks, each once, in the order in which their findings come; those of a scene come after the others.

    >>> [check.name for check in all_checks()][:3]
    ['info', 'version', 'episodes-file']
    """
    parts = (*PARTS, *(scene.checks if scene else ()))
    return tuple(dict.fromkeys([*(part.check for part in parts), AUDIT]))


class Audit(msgspec.Struct, frozen=True):
    """What is wrong with a dataset, and what nobody looked at.

    Attributes
    ----------
    findings : tuple of Finding
        In the order of the checks; empty where nothing is wrong.
    rest : tuple of Finding
        Further findings of a check that has many, in the same order: what is told leaves them out.
    not_checked : tuple of str
        What was not checked, and why.
    n_episodes, n_frames : int
        How many there are, as far as they could be read.
    break_mode : str or None
        Which assumption was wrong on purpose.
    kept : tuple of int
        The `episode_index` of every episode that no error is about: what `lerobot-train --dataset.episodes` takes. An
        error that is about no episode in particular keeps none out (`of_all`), nor does a warning. LeRobot opens all
        files below `data`: one that is broken must be moved away all the same.
    readable : bool
        False where `meta/info.json` or all episode metadata cannot be read, so that no frame was looked at.
    n_accepted : int
        How many findings were accepted before, and are not among these.
    """

    findings: tuple[Finding, ...]
    rest: tuple[Finding, ...]
    not_checked: tuple[str, ...]
    n_episodes: int
    n_frames: int
    break_mode: str | None
    kept: tuple[int, ...]
    readable: bool
    n_accepted: int = 0

    @property
    def more(self) -> dict[str, int]:
        """How many further findings of a check are left out."""
        return dict(Counter(finding.check for finding in self.rest))

    @property
    def exit_code(self) -> int:
        """0 where there is no error and no warning, 1 where there is one, 3 where nothing could be audited."""
        if not self.readable:
            return NOTHING_AUDITED
        return int(any(finding.severity != "note" for finding in self.findings))

    @property
    def of_all(self) -> tuple[str, ...]:
        """The checks of which an error is about no episode in particular, and keeps none out of `kept`."""
        errors = (each for each in self.findings if each.severity == "error" and not each.episodes)
        return tuple(dict.fromkeys(each.check for each in errors))

    def without(self, accepted: Collection[str]) -> "Audit":
        """Return the audit without the findings that somebody has accepted, by their fingerprints."""
        order = [*dict.fromkeys(finding.check for finding in self.findings)]
        all_of_it = sorted((*self.findings, *self.rest), key=lambda each: order.index(each.check))
        new = [finding for finding in all_of_it if finding.fingerprint not in accepted]
        findings, rest = _first_of_each(new)
        return replace(self, findings=findings, rest=rest, n_accepted=len(all_of_it) - len(new))

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
            ``found``, ``expected``, ``mend``, ``episodes``, ``frame`` and ``fingerprint``; ``more``, how many findings
            of a check are left out, and ``more_fingerprints``; ``n_accepted``; and ``not_checked``.
        """
        counts = Counter(finding.severity for finding in self.findings)
        return {
            "source": source,
            "break_mode": self.break_mode,
            "exit_code": self.exit_code,
            "n_episodes": self.n_episodes,
            "n_frames": self.n_frames,
            **{f"n_{severity}s": counts[severity] for severity in SEVERITIES},
            "n_accepted": self.n_accepted,
            "findings": [
                msgspec.to_builtins(each) | {"episodes": [*each.episodes], "fingerprint": each.fingerprint}
                for each in self.findings
            ],
            "more": self.more,
            "more_fingerprints": [each.fingerprint for each in self.rest],
            "not_checked": list(self.not_checked),
        }


def audit(
    root: str | os.PathLike[str],
    mode: BreakMode | None = None,
    reading: Reading | None = None,
    scene: Scene | None = None,
    progress: Progress = no_progress,
    executor: Executor | None = None,
    *,
    pictures: bool = False,
    meta_only: bool = False,
) -> Audit:
    """Look for everything that can be wrong with the dataset in a folder: `z2r.audit`, with all of it handed down.

    It is not written to, and nothing outside of it is read but what the scene reads beside it. Where the schema lacks
    the columns of the scene, that is left out. Memory is bounded by the data files in flight, one for each worker, and
    a few numbers for each episode.

    Raises
    ------
    DatasetError
        Only with a `mode`: if the dataset is not whole.
    MissingExtraError
        Only with `pictures`: if PyAV is not installed.
    """
    return audit_beside(root, None, mode, reading, scene, progress, executor, pictures=pictures, meta_only=meta_only)[0]


def audit_beside[T](
    root: str | os.PathLike[str],
    beside: Callable[[Path, DataColumns], T] | None,
    mode: BreakMode | None = None,
    reading: Reading | None = None,
    scene: Scene | None = None,
    progress: Progress = no_progress,
    executor: Executor | None = None,
    *,
    pictures: bool = False,
    meta_only: bool = False,
) -> tuple[Audit, list[T]]:
    """Audit a dataset as `audit` does, and hand what is read to somebody else beside it.

    Parameters
    ----------
    root, mode, reading, scene, progress, executor, pictures, meta_only
        As for `audit`.
    beside : callable or None
        Takes the path of a data file, relative to `root`, and what could be read of it; it survives pickling. What it
        raises is not caught.

    Returns
    -------
    audit : Audit
    made : list
        What `beside` returned, in the order of the numbers of the files; empty where no file was read.
    """
    if pictures:
        check_can_decode()
    root = place_of(root)
    try:
        claims = claims_under(mode, root, reading) if mode else read_claims(root, reading)
    except DatasetError as error:
        if mode:
            raise
        unreadable = ask(asked_of(NoSchema, PARTS), NoSchema(error.fault.relative_to(root)))
        return _ended([*unreadable], mode), []
    except Exception as error:
        return _ended([failed("what the dataset says of itself", error)], mode), []
    findings = [*ask(asked_of(Stored, PARTS), claims.stored)]
    if not len(claims.table.number):
        return _ended(findings, mode), []
    findings += ask(asked_of(Claims, PARTS), claims)
    files = file_claims(claims, under_mode=mode is not None)
    if meta_only:
        sums, moved, made = _fold_footers(claims, files, progress, executor), None, list[T]()
        findings += ask(asked_of(stats.Summaries, PARTS), stats.Summaries(claims))
    else:
        sums, moved, made = _fold_files(claims, files, scene, pictures, beside, progress, executor)
    findings += [finding for part in sums for finding in part.findings]
    runs = join_runs(claims, files, sums, moved)
    findings += _ask_of_all(claims, files, sums, runs, scene)
    try:
        footage = read_footage(claims, executor)
        of_cameras, unseen = _ask_of_cameras(files, sums, footage, runs, progress if pictures else None, executor)
    except Exception as error:
        of_cameras, unseen = [failed("the pictures", error)], ()
    findings += of_cameras
    left_out = [_not_in_metadata(scene)] if meta_only else [*_not_checked(claims, sums, scene, moved), *unseen]
    audited = Audit(
        *_in_order(findings, all_checks(scene)),
        not_checked=(*_failed(findings), *left_out),
        n_episodes=len(claims.table.number),
        n_frames=sum(part.n_rows or 0 for part in sums),
        break_mode=mode.name if mode else None,
        kept=_without_error(claims.table.number, findings),
        readable=True,
    )
    return audited, made


def _fold_footers(
    claims: Claims, files: Sequence[FileClaims], progress: Progress, executor: Executor | None
) -> list[FileSums]:
    """Ask of each data file what its footer answers."""
    sums = []
    for part in in_order(partial(_fold_footer, claims.root, claims.schema), files, executor):
        sums.append(part)
        progress(len(sums), len(files))
    return sums


def _fold_footer(root: Path, schema: Schema, claims: FileClaims) -> FileSums:
    try:
        read = read_data_footer(root, schema, claims.path)
    except Exception as error:
        return FileSums(None, [failed(claims.path.as_posix(), error)])
    said = answers(asked_of(FileColumns, PARTS), FileColumns(claims, schema, read))
    return FileSums(read.n_rows, [_of_the_file(each.finding, claims) for each in said])


def _not_in_metadata(scene: Scene | None) -> str:
    """Name the checks that ask of more than metadata, the footers of data files and the indices of videos."""
    subjects = (NoSchema, Stored, Claims, FileColumns, Footage, stats.Summaries)
    parts = (*PARTS, *(scene.checks if scene else ()))
    values_too = (values.FINITE, structure.COLUMN_TYPE)
    asked = [part.check for part in parts if part.subject not in subjects or part.check in values_too]
    names = ", ".join(dict.fromkeys(check.name for check in asked))
    return f"what frames and pictures say: only metadata and the ends of files were read. All or a part of {names}"


def _fold_files[T](
    claims: Claims,
    files: Sequence[FileClaims],
    scene: Scene | None,
    pictures: bool,
    beside: Callable[[Path, DataColumns], T] | None,
    progress: Progress,
    executor: Executor | None,
) -> tuple[list[FileSums], Motion | None, list[T]]:
    """Fold all data files; what is kept of their motion is taken out of their sums, and put together."""
    schema, numbers, pairs = claims.schema, claims.stored.task_numbers, pairs_of(claims.schema, claims.reading)
    n_moments = moments_to_keep(schema, len(claims.table.number))
    fold = partial(_fold_block, claims.root, schema, numbers, claims.reading, pairs, scene, pictures, n_moments)
    read = partial(_read, claims.root, schema, _wants_whole_files(claims), len(files) == 1)
    work = partial(_read_and_fold, read, fold, beside, schema)
    sums, pile, made = [], Pile(len(claims.table.number)), []
    for part, other in in_order(work, files, executor):
        if part.n_rows:
            pile.add(Motion(part.stats, part.steps, part.moments))
        sums.append(part._replace(stats={}, steps={}, moments=None))
        made += other
        progress(len(sums), len(files))
    return sums, pile.whole, made


def _wants_whole_files(claims: Claims) -> bool:
    """Tell whether a data file is read at once: a misreading and pictures ask of all of its frames."""
    return claims.misread is not None or any(feature.dtype == "image" for feature in claims.schema.features.values())


def _read(root: Path, schema: Schema, whole: bool, alone: bool, path: Path) -> Iterator[DataColumns]:
    if whole:
        yield read_data_file(root, schema, path)
    else:
        yield from read_data_blocks(root, schema, path, HEAD_FRAMES, alone=alone)


class _Block(NamedTuple):
    """What is kept of a block of a data file.

    Attributes
    ----------
    sums : FileSums
        As for a whole file, but that rows and runs are counted on from those of the blocks before.
    said : list of Said
        What is wrong with its rows.
    n_runs : int
        How many runs of frames there are up to its end.
    before, usual, reach, last
        What the next block builds on: from `known_after`, `fold_following` and `fold_idle`, and the last two frames,
        as the scene sees them.
    """

    sums: FileSums
    said: list[Said]
    n_runs: int = 0
    before: Before | None = None
    usual: Sequence[Usual] = ()
    reach: Sequence[Floats] = ()
    last: Decoded | None = None


def _read_and_fold[T](
    read_file: Callable[[Path], Iterator[DataColumns]],
    fold: Callable[[FileClaims, DataColumns, _Block], _Block],
    beside: Callable[[Path, DataColumns], T] | None,
    schema: Schema,
    claims: FileClaims,
) -> tuple[FileSums, list[T]]:
    """Read one data file, once for all who want to know of it, and in blocks where it is large."""
    keep_freed_memory()
    blocks, nothing = read_file(claims.path), _Block(FileSums(None, []), [])
    while True:
        try:
            read = next(blocks, None)
        except Exception as error:
            return FileSums(None, [failed(claims.path.as_posix(), error)]), []
        if read is None:
            break
        if read.first == 0:
            block, pile, said, made = nothing, Pile(len(claims.numbers)), list[Said](), list[T]()
        made += [beside(claims.path, read)] if beside else []
        block = fold(claims, read, block)
        if block.sums.n_rows is None and block.sums.findings:
            return block.sums, made
        pile.add(block.sums._replace(n_rows=None))
        said += block.said
        n_rows = None if read.n_rows is None else read.first + read.n_rows
        file = FileColumns(claims, schema, read._replace(first=0, n_rows=n_rows, frames={}))
    return _with_findings(pile.whole, file, said), made


def _with_findings(sums: FileSums, file: FileColumns, said: Sequence[Said]) -> FileSums:
    """Ask of a whole data file what there is to ask, and put together what was said of its rows."""
    said = [*answers(asked_of(FileColumns, PARTS), file), *together(said)]
    findings = [*(_of_the_file(each.finding, file.claims) for each in said), *sums.findings]
    return sums._replace(n_rows=file.read.n_rows, findings=findings)


def _fold_block(
    root: Path,
    schema: Schema,
    tasks: Ints | None,
    reading: Reading | None,
    pairs: Sequence[Pair],
    scene: Scene | None,
    pictures: bool,
    n_moments: int,
    claims: FileClaims,
    read: DataColumns,
    last: _Block,
) -> _Block:
    """Ask of the rows of a block all that there is to ask, and keep what others are held against."""
    try:
        frames = FileFrames(claims, schema, tasks, claims.taken(read), last.before)
        if not frames.read.n_rows:
            return _Block(FileSums(frames.read.n_rows, []), [*answers(asked_of(FileFrames, PARTS), frames)])
        images = read_file_images(root, frames)
        with _FOLDING:
            said = [*answers(asked_of(FileFrames, PARTS), frames)]
            findings = [*ask(asked_of(FileImages, PARTS), images)]
            number, starts, signals = frames.counts.get("episode_index"), frames.run_starts, frames.signals
            marked = {STATE: schema.fps}
            sums = {name: run_sums(signal, starts, marked.get(name)) for name, signal in signals.items()}
            stats = {name: stats for name, (stats, _) in sums.items()}
            task_pairs = fold_tasks(frames)
            following, usual = fold_following(pairs, signals, stats, starts, frames.head, last.usual)
            idle, reach = fold_idle(frames, stats, last.reach)
            seen, last_seen = _fold_scene(scene, frames, reading, last.last, findings)
            kept = FileSums(
                n_rows=frames.read.n_rows,
                findings=findings,
                starts=read.first + starts,
                numbers=None if number is None else number[starts],
                stats=stats,
                steps={name: steps for name, (_, steps) in sums.items() if moves(name)},
                following=following,
                labels=fold_labels(frames, reading),
                scene=seen,
                idle=idle,
                tasks=None if task_pairs is None else task_pairs + np.array([last.n_runs, 0]),
                images=sum_images(images),
                places=sum_places(frames) if pictures else None,
                moments=keep_moments(schema, signals, starts, n_moments),
                comes=fold_comes(frames),
            )
            return _Block(kept, said, last.n_runs + len(starts), index.known_after(frames), usual, reach, last_seen)
    except Exception as error:
        return _Block(FileSums(None, [failed(claims.path.as_posix(), error)]), [])


def _of_the_file(finding: Finding, claims: FileClaims) -> Finding:
    """Where nobody can say in which rows of a file something is wrong, it is wrong with all of its episodes."""
    return finding if finding.episodes else replace(finding, episodes=claims.numbers)


def _fold_scene(
    scene: Scene | None, frames: FileFrames, reading: Reading | None, before: Decoded | None, findings: list[Finding]
) -> tuple[list[Any] | None, Decoded | None]:
    """Return what the scene makes of these frames, some episodes at a time, and the last two of them."""
    schema, columns = frames.schema, frames.read.frames | frames.signals  # of these, each column is in one piece
    if scene is None or reading is None or not can_decode(columns, reading, schema):
        return None, None
    sums = []
    try:
        for rows in _some_at_a_time(frames.run_starts, frames.read.n_rows or 0):
            decoded = decode({name: values[rows] for name, values in columns.items()}, reading, schema)
            sums.append(scene.fold(decoded, frames.base + rows.start, frames.episodes, schema.fps, before))
            before = decoded.take(np.arange(len(decoded))[-2:])  # a copy: of the others, nothing stays
    except Exception as error:
        findings.append(failed(f"the scene in {frames.path.as_posix()}", error))
        return None, None
    return None if any(each is None for each in sums) else sums, before


def _some_at_a_time(starts: Ints, n_rows: int) -> Iterator[slice]:
    """Part rows where a run starts, so that what is made of each part fits into a cache."""
    ends = np.unique(np.searchsorted(starts, np.arange(_AT_ONCE, n_rows, _AT_ONCE)))
    cuts = [0, *starts[ends[ends < len(starts)]].tolist(), n_rows]
    yield from (slice(*cut) for cut in itertools.pairwise(cuts))


def _ask_of_all(
    claims: Claims, files: Sequence[FileClaims], sums: Sequence[FileSums], runs: Runs | None, scene: Scene | None
) -> Iterator[Finding]:
    """Ask what only all files together can answer."""
    if runs:
        yield from ask(asked_of(Runs, PARTS), runs)
        said = [part for number in runs.read if (part := sums[number].labels)]
        yield from ask(
            asked_of(Labels, PARTS), labels_of_episodes(claims.schema, claims.reading, runs.number, join_all(said))
        )
        following = [each for number in runs.read if (each := sums[number].following)]
        if len(following) == len(runs.read):
            pairs = pairs_of(claims.schema, claims.reading)
            ranges = runs.spans(ACTION)[[pair.dim for pair in pairs]]
            joints_of_all = Joints(pairs, runs.number, join_all(following), ranges, runs)
            yield from ask(asked_of(Joints, PARTS), joints_of_all)
    if scene and claims.reading and _has_scene(sums):
        folded = [(file.path, each) for file, part in zip(files, sums, strict=True) for each in part.scene or ()]
        paths, scene_sums = zip(*folded, strict=True)
        yield from ask(scene.checks, SceneSums(claims.root, claims.episodes, claims.reading, paths, scene_sums))


def _ask_of_cameras(
    files: Sequence[FileClaims],
    sums: Sequence[FileSums],
    footage: Footage,
    runs: Runs | None,
    decode: Progress | None,
    executor: Executor | None,
) -> tuple[list[Finding], Sequence[str]]:
    """Ask of the indices of videos, and of what the pictures look like; say also what nobody looked at."""
    findings = [*ask(asked_of(Footage, PARTS), footage)]
    names = [camera.name for camera in cameras_of(footage.claims.schema)]
    if runs is None or not names:
        return findings, [f"what {some(names)} show: `episode_index` of some file cannot be used"] if names else []
    filmed = join_filmed(footage, runs, [(files[number], sums[number]) for number in runs.read])
    looks = looks_of_glances(filmed, glance_at(filmed, decode, executor)) if decode else looks_of_sizes(filmed)
    return [*findings, *ask(asked_of(Looks, PARTS), looks)], looks.not_checked


def _has_scene(sums: Sequence[FileSums]) -> bool:
    read = [part for part in sums if part.n_rows]
    return bool(read) and all(part.scene is not None for part in read)


def _not_checked(claims: Claims, sums: Sequence[FileSums], scene: Scene | None, moved: Motion | None) -> Iterator[str]:
    """Say what nobody looked at."""
    unread = sum(part.n_rows is None for part in sums)
    if unread:
        yield f"the frames of {unread} of {len(sums)} data files: they cannot be read"
    if any(part.n_rows and part.numbers is None for part in sums):
        yield "episodes against each other: `episode_index` of some file cannot be used"
    yield from _meaning_not_checked(claims, sums, scene)
    yield from _motion_not_checked(claims, sums, moved)
    yield from _kinds_not_checked(claims)
    findings = (finding for part in sums for finding in part.findings)
    gaps = {re.split(r"\[| in row ", each.field)[0] for each in findings if each.check == values.FINITE.name}
    if gaps:
        yield f"jumps, standstill and statistics of {some(sorted(gaps))}: not all values are numbers"
    features = claims.schema.features.items()
    texts = [name for name, feature in features if feature.dtype.startswith(("string", "language"))]
    if texts:
        yield f"the text in {some(texts)}"
    wide = [name for name, feature in features if feature.is_numeric and feature.size > MAX_SIGNAL_SIZE]
    if wide:
        yield f"the values of {some(wide)}: more than {MAX_SIGNAL_SIZE} numbers a frame"
    if claims.misread:
        yield f"stored statistics of {some(claims.misread.features)}: of what is stored, whatever that is taken for"
    yield "stored quantiles (q01, q10 ...) against the frames: LeRobot estimates them, episode by episode"
    yield "whether the text of a task is true, and whether the demonstrations are any good"


def _motion_not_checked(claims: Claims, sums: Sequence[FileSums], moved: Motion | None) -> Iterator[str]:
    """Say of which joints and episodes nobody knows whether they move as they should."""
    pairs = pairs_of(claims.schema, claims.reading)
    if (action := claims.schema.signals().get(ACTION)) is not None:
        driving = {pair.dim for pair in pairs}
        alone = [column_label(ACTION, action, dim) for dim in range(action.size) if dim not in driving]
        what = some(alone) if pairs else "any command"
        if alone:
            yield f"whether {what} is followed: neither names nor a reading say which column it drives"
    lags = [part.following.lag for part in sums if part.following]
    if lags:
        lag = np.concatenate(lags)
        unknown = np.atleast_1d(np.isnan(lag).all(axis=0))
        if names := [pair.command for pair, lost in zip(pairs, unknown.tolist(), strict=True) if lost]:
            yield f"whether {some(names)} is followed: no motion tells"
        if not unknown.all() and (usual := float(np.nanmedian(lag))) >= 2:
            yield f"whether commands are late by less than the {usual:.0f} frames that joints are behind them"
    if short := int((claims.table.length < MIN_FRAMES).sum()):
        yield f"how the robot moves in {count(short, 'episode')} of fewer than {MIN_FRAMES} frames"
    if len(claims.table.number) > motion.MAX_COMPARED:
        yield f"near copies of a demonstration: there are more than {motion.MAX_COMPARED:,} episodes"
    if why := relations.not_related(claims.schema, len(claims.table.number), moved.moments if moved else None):
        told_too = "how finely it is stored, whether an episode goes as its task, and left stays left"
        yield f"whether each column goes with the others, {told_too}: {why}"


def _kinds_not_checked(claims: Claims) -> Iterator[str]:
    """Say what is not told of so few episodes, where there is something to tell."""
    others = [name for name in claims.schema.signals() if name not in (STATE, ACTION)]
    label = deeds.label_of(claims.schema)
    states = claims.schema.signals().get(STATE)
    grips = [name for name in (states.labels if states else ()) if is_gripper(name)]
    asked = (
        (states, deeds.ENOUGH, "whether each episode is one demonstration"),
        (grips, deeds.MIN_EPISODES, "what a gripper holds"),
        (others, kinds.MIN_EPISODES, f"whether {some(others)} means the same in all episodes"),
        (label, deeds.MIN_EPISODES, f"whether {label} comes where it does in the other episodes"),
    )
    for is_there, least, what in asked:
        if is_there and len(claims.table.number) < least:
            yield f"{what}: there are fewer than {least}"


def _meaning_not_checked(claims: Claims, sums: Sequence[FileSums], scene: Scene | None) -> Iterator[str]:
    if claims.reading is None or claims.reading.missing(claims.schema):
        yield "what the columns mean: no reading fits"
        yield "whether an action is possible: nothing states its limits"
        if label_in(claims.schema) is None:
            yield "success: nothing says what it would be"
    elif scene is None:
        yield "solid bodies: the reading has no scene"
        if claims.reading.goal:
            yield "whether what is reached was a success: `z2r inspect` holds it against a verdict beside the dataset"
    elif not _has_scene(sums):
        yield "solid bodies and limits: columns that the scene needs are not there, or cannot be used in some file"
    else:
        yield from _left_out_by(scene, claims.root)


def _left_out_by(scene: Scene, root: Path) -> list[str]:
    try:
        return [*scene.not_checked(root)]
    except Exception as error:
        return [f"what the scene leaves out: it could not say so ({type(error).__name__})"]


def _failed(findings: Iterable[Finding]) -> Iterator[str]:
    for finding in findings:
        if finding.check == AUDIT.name:
            yield f"{finding.field}: the audit itself failed there"


def _ended(findings: Sequence[Finding], mode: BreakMode | None) -> Audit:
    nothing_else = "everything else: without meta/info.json and the episode metadata, frames mean nothing"
    kept, rest = _in_order(findings, all_checks())
    name = mode.name if mode else None
    return Audit(kept, rest, (*_failed(findings), nothing_else), 0, 0, name, kept=(), readable=False)


def _without_error(numbers: Ints, findings: Iterable[Finding]) -> tuple[int, ...]:
    wrong = {number for finding in findings if finding.severity == "error" for number in finding.episodes}
    return tuple(number for number in numbers.tolist() if number not in wrong)


def _in_order(findings: Iterable[Finding], checks: Sequence[Check]) -> tuple[tuple[Finding, ...], tuple[Finding, ...]]:
    """Sort findings by their checks, the worst of each first; part the first of each from the others."""
    order = [check.name for check in checks]
    return _first_of_each(sorted(findings, key=lambda each: (order.index(each.check), SEVERITIES.index(each.severity))))


def _first_of_each(findings: Iterable[Finding]) -> tuple[tuple[Finding, ...], tuple[Finding, ...]]:
    seen: Counter[str] = Counter()
    first: list[Finding] = []
    rest: list[Finding] = []
    for finding in findings:
        seen[finding.check] += 1
        (first if seen[finding.check] <= MAX_OF_A_CHECK else rest).append(finding)
    return tuple(first), tuple(rest)
