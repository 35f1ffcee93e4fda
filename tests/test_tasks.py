"""Which task is an episode of, and on which side of a split? Nothing is said of what LeRobot records.

A task is a text; frames have its number, episodes its text, and `meta/tasks.parquet` both.
"""

import shlex
from collections.abc import Sequence
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
from damages import EPISODES, PUSH, TASKS, drop_column, edit_column, edit_info, set_at, set_tasks, wrong_in
from hypothesis import given
from hypothesis import strategies as st
from test_readiness import found, line_of, obey, one

import z2r
from z2r.audits import edit
from z2r.audits.claims import read_claims
from z2r.audits.findings import ask
from z2r.audits.tasks import splits
from z2r.format.tables import Read, Stated

PULL = "pull it"


def record_tasks(root: Path, tasks: Sequence[Sequence[str]]) -> None:
    """Record episodes with LeRobotDataset; `tasks` gives the task of every frame of each."""
    from lerobot.datasets.lerobot_dataset import LeRobotDataset

    feature = {"dtype": "float32", "shape": (2,), "names": None}
    features = {"observation.state": feature, "action": feature}
    where = {"repo_id": "test/test", "root": root, "video_backend": "pyav"}
    dataset = LeRobotDataset.create(**where, fps=10, features=features, use_videos=False)
    rng = np.random.default_rng(0)
    for episode in tasks:
        for task in episode:
            state, action = rng.normal(size=(2, 2)).astype(np.float32)
            dataset.add_frame({"observation.state": state, "action": action, "task": task})
        dataset.save_episode()
    dataset.finalize()


def test_nothing_is_said_of_several_tasks_that_lerobot_records(tmp_path):
    record_tasks(tmp_path / "dataset", [[PUSH] * 30, [PULL] * 30, [PUSH] * 30, ["Wait."] * 30])
    assert not wrong_in(z2r.audit(tmp_path / "dataset"))


def test_subtasks_that_lerobot_records_are_a_note(tmp_path):
    record_tasks(tmp_path / "dataset", [[PUSH] * 30, [PUSH] * 15 + [PULL] * 15])
    audit = z2r.audit(tmp_path / "dataset")
    assert [(each.check, each.severity, each.episodes) for each in wrong_in(audit)] == [("episode-tasks", "note", (1,))]
    assert audit.exit_code == 0


@pytest.mark.parametrize(
    ("texts", "severity"),
    [
        ((PUSH, PULL), None),
        ((PUSH, PUSH), "warning"),
        ((PUSH, f"{PUSH} "), "note"),
        ((PUSH, PUSH.capitalize()), "note"),
        ((PUSH, PUSH.replace(" ", "\n")), "note"),
        ((PUSH, ""), "warning"),
        (("", ""), "warning"),
        (("\u2003", PUSH), "warning"),
        ((PUSH, "push the L onto the target"), None),
    ],
)
def test_a_text_twice_or_empty_is_named(texts, severity, standin_copy):
    set_tasks(standin_copy, *texts, of_episode={2: 1})
    findings = wrong_in(z2r.audit(standin_copy))
    assert [(each.check, each.severity) for each in findings] == ([("task-text", severity)] if severity else [])


@pytest.mark.parametrize(
    ("text", "says"), [("TODO", True), ("test 2!", True), ("<task>", True), ("test the lamp", False)]
)
def test_a_text_that_says_nothing_is_a_note(text, says, standin_copy):
    set_tasks(standin_copy, PUSH, text, of_episode={2: 1})
    assert [(each.check, each.severity) for each in wrong_in(z2r.audit(standin_copy))] == [("task-typo", "note")] * says


@pytest.mark.parametrize(
    ("text", "check"),
    [
        ("push the {object} onto it", "task-typo"),
        ("push the <shape> onto it", "task-typo"),
        ("push the %s onto it", "task-typo"),
        ("push 5 % of it for < 3 s and > 1 s", None),
        ("push it (dropped it, redo!)", "task-remark"),
        ("push it - BAD TAKE, delete", "task-remark"),
        ("push it failed", "task-remark"),
        ("press delete, and discard the bad apple (the red one)", None),
        ("push-and-fail-safe it", None),
        ("Schiebe den WÃ¼rfel", "task-encoding"),
        ("Schiebe den Würfel à côté", None),
        ("推动方块", None),
    ],
)
def test_what_is_no_instruction_in_a_text_is_named(text, check, standin_copy):
    set_tasks(standin_copy, PUSH, text, of_episode={2: 1})
    assert [each.check for each in wrong_in(z2r.audit(standin_copy))] == [check] * (check is not None)


def test_a_text_read_in_another_encoding_is_mended_by_the_line(standin_copy, monkeypatch):
    set_tasks(standin_copy, PUSH, "Wünsch dir “was”".encode().decode("cp1252", "replace"), of_episode={2: 1})
    assert not found(standin_copy, "task-encoding")  # a sign was lost: nobody knows what it was
    set_tasks(standin_copy, PUSH, "Würfel".encode().decode("latin-1"), of_episode={2: 1})
    obey(line_of(one(standin_copy, "task-encoding")), monkeypatch)
    assert {task.task for task in z2r.inspect_dataset(standin_copy).about.tasks} == {PUSH, "Würfel"}


@pytest.mark.parametrize("texts", [(PUSH, PUSH), (PUSH, PUSH.upper()), (PUSH, " ")])
def test_the_line_that_is_printed_mends_a_text(texts, standin_copy, monkeypatch):
    set_tasks(standin_copy, *texts, of_episode={2: 1})
    obey(line_of(one(standin_copy, "task-text")), monkeypatch)
    assert not wrong_in(z2r.audit(standin_copy))
    left = {task.task: task.n_episodes for task in z2r.inspect_dataset(standin_copy).about.tasks}
    assert left == ({PUSH: 6} if texts[1].strip() else {PUSH: 5, "WHAT THE ROBOT DOES": 1})


def test_a_text_cannot_steer_a_shell(tmp_path):
    line = edit.replace_tasks(tmp_path, {"'; rm -rf ~; '": "$(reboot)\n"})
    assert line.isprintable()
    assert shlex.split(line)[-1] == """--operation.task_replacements={"'; rm -rf ~; '": "$(reboot)\\n"}"""


def test_tasks_that_nobody_does_are_a_note(standin_copy):
    set_tasks(standin_copy, PUSH, PULL, "wait")
    finding = one(standin_copy, "task-unused")
    assert finding.severity == "note"
    assert "1 more" in finding.found
    set_tasks(standin_copy, PUSH, PULL, "wait", of_episode={1: 1, 2: 2})
    assert not found(standin_copy, "task-unused")


@pytest.mark.parametrize(
    ("named", "severity"),
    [
        ([PUSH], "warning"),
        ([], "warning"),
        ([PULL], "warning"),
        (["wait"], "error"),
        ([PUSH, "wait"], "error"),
        ([PUSH, PULL, "wait"], "error"),
        ([PULL, PUSH], "note"),
    ],
)
def test_an_episode_has_the_tasks_of_its_frames(named, severity, standin_copy):
    set_tasks(standin_copy, PUSH, PULL, "wait", of_episode={5: 2}, of_frame=100)
    edit_column(standin_copy, EPISODES, "tasks", set_at(1, named))
    finding = one(standin_copy, "episode-tasks")
    assert (finding.severity, finding.episodes) == (severity, (1,))
    assert (1 in z2r.audit(standin_copy).kept) == (severity != "error")


def test_tasks_that_are_not_there_are_named_once(standin_copy):
    drop_column(standin_copy, EPISODES, "tasks")
    assert [each.check for each in wrong_in(z2r.audit(standin_copy))] == ["episodes-file"]


def test_tasks_out_of_order_are_those_that_lerobot_mixes_up(standin_copy):
    """It takes the row of a task for its number."""
    from lerobot.datasets.lerobot_dataset import LeRobotDataset

    set_tasks(standin_copy, PUSH, PULL, of_episode={2: 1})
    assert not found(standin_copy, "tasks-file")
    backwards = pd.DataFrame({"task_index": [1, 0]}, index=pd.Index([PULL, PUSH], name="task"))
    backwards.to_parquet(standin_copy / TASKS)
    assert one(standin_copy, "tasks-file").severity == "error"
    first = LeRobotDataset("test/test", root=standin_copy, video_backend="pyav")[0]
    assert (first["task"], int(first["task_index"])) == (PULL, 0)


# --- splits

CLAIMS = read_claims(z2r.STANDIN, None)
ends = st.integers(0, 8)


@given(stated=st.dictionaries(st.sampled_from("abc"), st.tuples(ends, ends), min_size=1))
def test_every_episode_is_in_one_split_or_named(stated):
    said = Read(Stated(splits={name: f"{start}:{stop}" for name, (start, stop) in stated.items()}))
    claims = CLAIMS._replace(stored=CLAIMS.stored._replace(stated=said))
    told = {(each.severity, each.episodes) for each in ask([splits], claims)}
    right = [(start, stop) for start, stop in stated.values() if start <= stop <= 6]
    times = [sum(start <= episode < stop for start, stop in right) for episode in range(6)]
    shared, nowhere = (tuple(np.flatnonzero(which).tolist()) for which in (np.array(times) > 1, np.array(times) == 0))
    expected = {("error", ())} if len(right) < len(stated) else {("note", nowhere)} if nowhere else set()
    empty = {("note", ())} if any(start == stop for start, stop in right) else set()
    assert told == expected | empty | ({("warning", shared)} if shared else set())


@pytest.mark.parametrize("stated", [{}, ..., {"train": "0:6"}, {"train": "0:4", "val": "4:6"}])
def test_splits_that_part_the_episodes_are_no_fault(stated, standin_copy):
    edit_info(standin_copy, splits=stated)
    assert not wrong_in(z2r.audit(standin_copy))
