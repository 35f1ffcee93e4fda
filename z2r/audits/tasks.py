"""Which task is an episode of, and on which side of a split? The texts, who has them, and the splits that are named."""

import difflib
import re
from collections.abc import Iterable, Iterator, Sequence
from typing import NamedTuple

import numpy as np

from z2r.arrays import Ints
from z2r.audits import edit
from z2r.audits.claims import Claims
from z2r.audits.frames import FileFrames
from z2r.audits.runs import Runs
from z2r.check import Answer, Check, Severity
from z2r.errors import DatasetError, Fault, short, some
from z2r.format.about import tasks_of_episodes
from z2r.format.episodes import DATA_DIR, EPISODES_DIR
from z2r.format.rules import and_more, episodes_of
from z2r.format.schema import INFO_PATH
from z2r.format.tables import TASKS_PATH
from z2r.reading.stored import episodes_named

_IN_PLACE = "in the folder itself, where each episode then has one task"
_MAX_COMPARED = 200  # texts, each with each
# What is typed where something must be, once signs and numbers are left out.
_SAYS_NOTHING = {"abc", "asdf", "debug", "default", "demo", "dummy", "example", "foo", "my task", "n a", "new task"}
_SAYS_NOTHING |= {"none", "null", "placeholder", "sample", "task", "tbd", "test", "testing", "todo", "unknown", "xxx"}
_TO_DO = r"\b(todo|tbd|fixme|placeholder|task description|insert (task|text))\b"
_FIELD = r"\{\w*\}|\$\w+|<[A-Za-z_]+>|(?<![\d%])%s"  # what a template leaves open
_OF_A_TAKE = r"\b(bad|failed|failure|fail|redo|retake|delete|discard|do not use|don't use|unusable|dropped it|oops)\b"
_REMARK = rf"[(\[][^)\]]*{_OF_A_TAKE}|\s[-\u2013\u2014]+\s.*{_OF_A_TAKE}|\s(failed|redo|retake|bad take|do not use)\W*$"
_SLIP = 0.93  # alike
_SLIP_OF_A_WORD = 0.75
_MAX_TEXT = 60  # characters of a text that are shown


@Check("task-text", "every task says what to do, and no two say the same", "warning").of(Claims)
def task_text(claims: Claims) -> Iterator[Answer]:
    """Is there a task that says nothing, or one that is there twice?"""
    tasks = claims.stored.tasks.value
    if tasks is None:
        return
    number, text = tasks.number, tasks.text
    plain = [" ".join(each.split()).casefold() for each in text]
    empty = [row for row, each in enumerate(plain) if not each]
    if empty:
        mend = f"Name it, {_IN_PLACE}: {edit.replace_tasks(claims.root, {text[empty[0]]: 'WHAT THE ROBOT DOES'})}"
        found = f"{text[empty[0]]!r}{and_more(len(empty))}"
        yield Fault(TASKS_PATH, f"task {number[empty[0]]}", found, "what the robot is to do", mend)
    same = _repeated(text)
    alike = {row: first for row, first in _repeated(plain).items() if row not in same}
    severities: tuple[tuple[Severity, dict[int, int]], ...] = (("warning", same), ("note", alike))
    for severity, repeated in severities:
        for row, first in [*repeated.items()][:1]:
            mend = f"Make them one, {_IN_PLACE}: {edit.replace_tasks(claims.root, {text[row]: text[first]})}"
            found = f"{_shown(text[row])}{and_more(len(repeated))}"
            expected = f"another text than task {number[first]} has, {_shown(text[first])}"
            yield severity, Fault(TASKS_PATH, f"task {number[row]}", found, expected, mend)


@Check("task-typo", "no text of a task is left from an example or a template, or nearly that of another", "note").of(
    Claims
)
def task_typo(claims: Claims) -> Iterator[Answer]:
    """Is a text a placeholder, or so near to another one that it may be a slip of the pen?"""
    tasks = claims.stored.tasks.value
    if tasks is None:
        return
    for number, text in zip(tasks.number.tolist(), tasks.text, strict=True):
        is_left = re.fullmatch(r"\s*[<\[{].*[>\]}]\s*", text) or re.search(_TO_DO, text, re.IGNORECASE)
        if is_left or _without_signs(text) in _SAYS_NOTHING:
            yield Fault(TASKS_PATH, f"task {number}", _shown(text), "what the robot is to do")
        elif field := re.search(_FIELD, text):
            mend = "Was a template never filled in? A policy learns the name of the field as a word"
            expected = f"a word in the place of {field[0]}"
            yield Fault(TASKS_PATH, f"task {number}", _shown(text), expected, mend)
    if len(tasks.text) > _MAX_COMPARED:
        return
    for row, text in enumerate(tasks.text):
        for other in range(row):
            if _is_a_slip(text, tasks.text[other]):
                expected = f"the same as task {tasks.number[other]}, {_shown(tasks.text[other])}, or a text of its own"
                yield Fault(TASKS_PATH, f"task {tasks.number[row]}", _shown(text), expected, "Is one of them misspelt?")


@Check("task-remark", "the text of a task is no place for what was thought of a take", "note").of(Claims)
def task_remark(claims: Claims) -> Iterator[Answer]:
    """Does a text say of an episode that it failed or is to be left out, in brackets, after a dash, or as its end?"""
    tasks = claims.stored.tasks.value
    if tasks is None:
        return
    said = [(row, text) for row, text in enumerate(tasks.text) if re.search(_REMARK, text, re.IGNORECASE)]
    if said:
        row, text = said[0]
        found = f"{_shown(text)}{and_more(len(said))}"
        mend = (
            "Somebody meant to leave these episodes out: do so, or take the remark out of the text. A policy reads it"
        )
        yield Fault(TASKS_PATH, f"task {tasks.number[row]}", found, "what the robot is to do, and no more", mend)


@Check("task-encoding", "every letter of a task is the one that was typed", "warning").of(Claims)
def task_encoding(claims: Claims) -> Iterator[Answer]:
    """Was a text written as UTF-8 and read as Latin-1 or Windows-1252? Then two signs stand for a letter."""
    tasks = claims.stored.tasks.value
    if tasks is None:
        return
    meant = {text: right for text in tasks.text if (right := _read_as_utf8(text)) != text}
    if meant:
        text, right = next(iter(meant.items()))
        mend = "It was read in another encoding than it was written in. Mend it, "
        mend += f"{_IN_PLACE}: {edit.replace_tasks(claims.root, meant)}"
        place, found = f"task {tasks.number[tasks.text.index(text)]}", f"{_shown(text)}{and_more(len(meant))}"
        yield Fault(TASKS_PATH, place, found, _shown(right), mend)


def _read_as_utf8(text: str) -> str:
    """Return what a text says that was read as Windows-1252 or Latin-1; the text itself where it was not.

    >>> _read_as_utf8("WÃ¼rfel"), _read_as_utf8("Würfel"), _read_as_utf8("cube")
    ('Würfel', 'Würfel', 'cube')
    """
    for encoding in ("cp1252", "latin-1"):
        try:
            return text.encode(encoding).decode()
        except UnicodeError:
            continue
    return text


def _without_signs(text: str) -> str:
    return " ".join(re.findall("[^\\W\\d_]+", text.casefold()))


@Check("task-unused", "every task is one that some frame has", "note").of(Runs)
def task_unused(runs: Runs) -> Iterator[Answer]:
    """Is there a task that nobody does?"""
    tasks = runs.claims.stored.tasks.value
    if tasks is None or runs.tasks is None or len(runs.read) < len(runs.claims.paths):
        return
    unused = np.flatnonzero(~np.isin(tasks.number, runs.tasks[:, 1])).tolist()
    if unused:
        found = f"{_shown(tasks.text[unused[0]])}, which no frame has{and_more(len(unused))}"
        yield Fault(TASKS_PATH, f"task {tasks.number[unused[0]]}", found, "tasks that the robot does")


class _Tasks(NamedTuple):
    """The tasks of one episode, as its metadata names them, and as its frames have them."""

    episode: int
    named: frozenset[str]
    there: frozenset[str]


@Check("episode-tasks", "the tasks of an episode are those of its frames", "error").of(Runs)
def tasks_of_an_episode(runs: Runs) -> Iterator[Answer]:
    """Does the metadata of an episode name the tasks that its frames have? LeRobot trains on those of the frames."""
    try:
        episodes = [*_tasks_of_episodes(runs)]
    except DatasetError as error:
        fault = error.fault.relative_to(runs.claims.root)
        if fault[:2] not in [said[:2] for said in runs.claims.stored.episodes.faults]:
            yield fault
        return
    unlike = [each for each in episodes if each.named != each.there]
    unsaid = [each for each in unlike if each.named < each.there]
    differ = [each for each in unlike if not each.named < each.there]
    several = [each for each in episodes if len(each.there) > 1 and each.named == each.there]
    answers: tuple[tuple[Severity, list[_Tasks], str], ...] = (
        ("error", differ, "A policy is told what the frames say. Whoever edits goes by the metadata"),
        ("warning", unsaid, "Its task_index changes: where that is meant, as for subtasks, name them all"),
    )
    for severity, wrong, mend in answers:
        for each in wrong[:1]:
            place, found = f"tasks of episode {each.episode}", f"{_listed(each.named)}{and_more(len(wrong))}"
            expected = f"{_listed(each.there)}, as task_index of its frames says"
            yield severity, Fault(EPISODES_DIR, place, found, expected, mend, _numbers(wrong))
    for each in several[:1]:
        found = f"{_listed(each.there)} in turn{and_more(len(several))}"
        place, expected = f"task_index in episode {each.episode}", "one task, unless these are subtasks"
        mend = f"Whoever edits tasks with {edit.PROGRAM} leaves each episode one"
        yield "note", Fault(DATA_DIR, place, found, expected, mend, _numbers(several))


@Check("splits", "every split is a range of episodes that exist, and no two share one", "error").of(Claims)
def splits(claims: Claims) -> Iterator[Answer]:
    """Is every split a range of the episodes that are stored, and every episode on one side?"""
    numbers = claims.stored.episodes.value.table.number
    stated = claims.stored.stated.value.splits or {}
    ranges: dict[str, slice] = {}
    for name, split in stated.items():
        ends = re.fullmatch(r"(\d{1,18}):(\d{1,18})", split, re.ASCII)
        if not ends or not int(ends[1]) <= int(ends[2]) <= len(numbers):
            expected = f"a range of episodes within 0:{len(numbers)}"
            yield Fault(INFO_PATH, f"splits.{name}", repr(split[:60]), expected)
            continue
        ranges[name] = slice(int(ends[1]), int(ends[2]))
        if int(ends[1]) == int(ends[2]):
            yield "note", Fault(INFO_PATH, f"splits.{name}", f"{split}, no episode", "episodes in every split")
    times = np.zeros(len(numbers), dtype=np.int64)
    for each in ranges.values():
        times[each] += 1
    if (shared := times > 1).any():
        named = episodes_of(numbers, shared)
        names = [name for name, each in ranges.items() if shared[each].any()]
        found, mend = f"{episodes_named(named)} in several of {some(names)}", "What was trained on is no test"
        yield "warning", Fault(INFO_PATH, "splits", found, "every episode in one split", mend, named)
    if len(ranges) == len(stated) > 0 and not times.all():
        named = episodes_of(numbers, times == 0)
        mend = "Whoever goes by splits leaves them out. LeRobot 0.6.1 does not: it trains on all episodes"
        yield (
            "note",
            Fault(INFO_PATH, "splits", f"{episodes_named(named)} in none", "every episode in one", mend, named),
        )


def fold_tasks(frames: FileFrames) -> Ints | None:
    """Pair each run of frames with the tasks of its frames, int64[n, 2]; None where they cannot be read."""
    task, starts = frames.counts.get("task_index"), frames.run_starts
    if task is None:
        return None
    begins = np.union1d(starts, np.flatnonzero(np.diff(task)) + 1)
    pairs = np.stack([np.searchsorted(starts, begins, side="right") - 1, task[begins]], axis=1)
    return pairs if len(begins) == len(starts) else np.unique(pairs, axis=0)  # as a rule, each has one


def _tasks_of_episodes(runs: Runs) -> Iterator[_Tasks]:
    """Yield both of every episode in which they differ or are several: of many episodes, few."""
    tasks = runs.claims.stored.tasks.value
    if tasks is None or runs.tasks is None:
        return
    alone = {task: frozenset([text]) for task, text in zip(tasks.number.tolist(), tasks.text, strict=True)}
    seen: dict[int, frozenset[str]] = {}
    for episode, task in zip(runs.number[runs.tasks[:, 0]].tolist(), runs.tasks[:, 1].tolist(), strict=True):
        if task in alone:  # of one that is not, `task-index` says so
            seen[episode] = seen[episode] | alone[task] if episode in seen else alone[task]
    for shard in runs.claims.stored.episodes.value.shards:
        for episode, named in tasks_of_episodes(runs.claims.root / shard):
            there = seen.get(episode)
            if there and (named != there or len(there) > 1):
                yield _Tasks(episode, named, there)


def _is_a_slip(one: str, other: str) -> bool:
    """Tell whether two texts differ in letters, and not in a number, a case, or a word of its own."""
    plain = [" ".join(each.split()).casefold() for each in (one, other)]
    if plain[0] == plain[1] or re.sub(r"\d+", "", plain[0]) == re.sub(r"\d+", "", plain[1]):
        return False
    words, others = (set(each.split()) for each in plain)
    odd = sorted(words - others), sorted(others - words)
    if [len(each) for each in odd] != [1, 1] or difflib.SequenceMatcher(None, plain[0], plain[1]).ratio() < _SLIP:
        return False
    return difflib.SequenceMatcher(None, odd[0][0], odd[1][0]).ratio() > _SLIP_OF_A_WORD


def _repeated(texts: Sequence[str]) -> dict[int, int]:
    """Find the rows whose text an earlier one has: which it is, by the row that has it again; none without a text."""
    first: dict[str, int] = {}
    said = ((row, text) for row, text in enumerate(texts) if text.strip())
    return {row: before for row, text in said if (before := first.setdefault(text, row)) != row}


def _numbers(tasks: Iterable[_Tasks]) -> tuple[int, ...]:
    return tuple(sorted({each.episode for each in tasks}))


def _shown(text: str) -> str:
    return repr(short(text, _MAX_TEXT))


def _listed(texts: frozenset[str]) -> str:
    return some([_shown(text) for text in sorted(texts)]) or "no task"
