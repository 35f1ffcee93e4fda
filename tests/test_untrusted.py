"""A dataset from a stranger: whatever it claims, the answer is one clear line, soon, and in little memory.

Each case is read in a process of its own with bounds on memory and time, by `z2r inspect`, which writes the replay too,
and by `z2r audit`.
"""

import json
import os
import shutil
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from damages import (
    DATA,
    EPISODES,
    INFO,
    STATE,
    TASKS,
    VIDEO,
    claim_rows,
    declare_video,
    edit_column,
    edit_episodes,
    edit_feature,
    edit_info,
    fingerprint,
    footer_start,
    orphan_video,
    read_json,
    set_at,
)
from layouts import STATS_PATH, Frames

import z2r

CAMERA = VIDEO.split("/")[1]
SECONDS = 60
PEAK = 800 * 2**20  # bytes, of which Python with pyarrow and rerun takes about 250 MiB

# Reads what to look at line by line, and forks for each: Python, pyarrow and rerun are loaded once.
PROGRAM = f"""
import contextlib, gc, io, json, os, resource, signal, sys, traceback
import z2r.api, z2r.audits.audit, z2r.reading.inspection, z2r.reading.verdict
import z2r.show.replay, z2r.show.terminal, z2r.show.wallclock
from z2r.cli import main

gc.freeze()  # so that no child copies what it only inherits

def run(*args):
    sys.argv = ["z2r", *args]
    out, err = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err):
        try:
            main()
            code = 0
        except SystemExit as end:
            code = end.code or 0
        except BaseException:
            code = traceback.format_exc(limit=-3)
    status = open("/proc/self/status").read()  # getrusage would tell of the parent, too
    peak = 1024 * int(status.partition("VmHWM:")[2].split()[0])
    return dict(code=code, out=out.getvalue(), err=err.getvalue(), peak=peak)

for line in sys.stdin:
    root, out = json.loads(line)
    if not (child := os.fork()):
        resource.setrlimit(resource.RLIMIT_AS, (8 * 2**30, 8 * 2**30))
        resource.setrlimit(resource.RLIMIT_CPU, ({SECONDS}, {SECONDS}))
        signal.alarm({SECONDS})
        print(json.dumps([run("audit", root), run("inspect", root, "--out", out)]), flush=True)
        os._exit(0)
    if code := os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]):
        print(json.dumps(f"ended with {{code}}"), flush=True)
"""

type Answers = tuple[dict[str, Any], dict[str, Any]]


@pytest.fixture(scope="module")
def ask() -> Iterator[Callable[[Path], Answers]]:
    """Ask `z2r audit` and `z2r inspect` about a dataset, within bounds."""
    with subprocess.Popen(
        [sys.executable, "-c", PROGRAM], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
    ) as server:

        def ask(root: Path) -> Answers:
            server.stdin.write(json.dumps([str(root), str(root.with_name("out"))]) + "\n")
            server.stdin.flush()
            answers = json.loads(server.stdout.readline())
            assert isinstance(answers, list), answers
            return answers

        yield ask
        server.stdin.close()


class Case(NamedTuple):
    """What a stranger does, and how the audit and the reader end: 0 is nothing wrong, 2 and 3 not readable."""

    do: Callable[[Path], object]
    audit: int
    inspect: int
    says: str = ""  # what both must say
    can_be_read_whole: bool = True  # to see that nothing was written


def write_text(file: str, text: str) -> Callable[[Path], object]:
    return lambda root: (root / file).write_text(text)


def declare(n_frames: int) -> Callable[[Path], None]:
    """Let all of the metadata say that there is one more episode with this many frames."""

    def do(root: Path) -> None:
        edit_column(root, EPISODES, "dataset_to_index", set_at(5, 369 + n_frames))
        edit_column(root, EPISODES, "length", set_at(5, n_frames))
        edit_info(root, total_frames=369 + n_frames)

    return do


def many_features(root: Path) -> None:
    features = read_json(root, INFO)["features"]
    edit_info(root, features=features | {f"f{i}": {"dtype": "float32", "shape": [1]} for i in range(10**5)})


def sparse(file: str) -> Callable[[Path], None]:
    return lambda root: os.truncate(root / file, 10**10)


def pipe(file: str) -> Callable[[Path], None]:
    """Put a named pipe in place of a file: who opens it waits for ever."""

    def do(root: Path) -> None:
        (root / file).unlink()
        os.mkfifo(root / file)

    return do


def repeat_row_groups(path: Path, doublings: int) -> None:
    """Make a bomb: a footer that names the same row group 2 ** doublings times, all of which can be read."""
    pq.write_table(pq.read_table(path), path)
    data, footer = path.read_bytes(), pq.read_metadata(path)
    for _ in range(doublings):
        footer.append_row_groups(footer)
    footer.write_metadata_file(path)
    end = path.read_bytes()
    path.write_bytes(data[: footer_start(data)] + end[footer_start(end) :])


def bomb(file: str, rows: int, doublings: int) -> Callable[[Path], None]:
    """Repeat the first row of a file `rows * 2 ** doublings` times, in some kilobytes."""

    def do(root: Path) -> None:
        table = pq.read_table(root / file)
        table = table.select([name for name in table.column_names if not name.startswith("stats/")])
        pq.write_table(table.take(pa.array(np.zeros(rows, dtype=np.int64))), root / file)
        repeat_row_groups(root / file, doublings)

    return do


def bomb_that_is_expected(root: Path) -> None:
    """Let all metadata agree with a bomb."""
    n_frames = 10**6 * 2**10
    bomb(DATA, 10**6, 10)(root)
    table = pq.read_table(root / EPISODES).slice(0, 1)
    pq.write_table(table, root / EPISODES)

    def one_episode(columns: Frames) -> None:
        columns["length"][:] = columns["dataset_to_index"][:] = n_frames

    edit_episodes(root, one_episode)
    edit_info(root, total_episodes=1, total_frames=n_frames, splits={"train": "0:1"})


def add_text_column(root: Path) -> None:
    table = pq.read_table(root / DATA)
    pq.write_table(table.append_column("note", pa.array(["x" * 10**5] * len(table))), root / DATA)


def large_images(root: Path) -> None:
    """Store one image, which is none, in all rows; in the file it stands once."""
    edit_feature(root, CAMERA, dtype="image", shape=[10, 10, 3], names=None)
    table, image = pq.read_table(root / DATA), {"bytes": b"x" * 30 * 10**6, "path": None}
    rows = pa.array([0] * len(table), pa.int32())
    column = pa.DictionaryArray.from_arrays(rows, pa.array([image["bytes"]]))
    struct = pa.StructArray.from_arrays([column, pa.nulls(len(table), pa.string())], ["bytes", "path"])
    pq.write_table(table.append_column(CAMERA, struct), root / DATA, store_schema=False)


def limits(low: int, high: int) -> Callable[[Path], None]:
    def change(columns: Frames) -> None:
        columns["dataset_from_index"][:] = low
        columns["dataset_to_index"][:] = high
        with np.errstate(over="ignore"):
            columns["length"][:] = columns["dataset_to_index"] - columns["dataset_from_index"]

    return lambda root: edit_episodes(root, change)


def link(place: str, target: str) -> Callable[[Path], None]:
    return lambda root: (root / place).symlink_to(target)


CASES: dict[str, Case] = {
    # sizes that are only claimed
    "a billion frames in info": Case(lambda root: edit_info(root, total_frames=10**9), 1, 2, "1000000000"),
    "a billion episodes in info": Case(lambda root: edit_info(root, total_episodes=10**9), 1, 2, "1000000000"),
    "a billion frames in all metadata": Case(declare(10**9), 1, 2, "rows"),
    "10**18 frames in all metadata": Case(declare(10**18), 1, 2, "rows"),
    "a state a million wide": Case(lambda root: edit_feature(root, STATE, shape=[10**6], names=None), 1, 0),
    "a state of 10**9": Case(lambda root: edit_feature(root, STATE, shape=[10**9], names=None), 1, 0),
    "a state of 10**18 twice": Case(lambda root: edit_feature(root, STATE, shape=[10**18] * 2, names=None), 1, 0),
    "a state of 1000 axes": Case(lambda root: edit_feature(root, STATE, shape=[1] * 999 + [10]), 1, 2, STATE),
    "a state of nothing": Case(lambda root: edit_feature(root, STATE, shape=[0]), 1, 2, STATE),
    "frame_index of nothing": Case(lambda root: edit_feature(root, "frame_index", shape=[0]), 1, 0),
    "frame_index of two": Case(lambda root: edit_feature(root, "frame_index", shape=[2]), 1, 0),
    "100,000 features": Case(many_features, 3, 2, "features"),
    "a million names": Case(lambda root: edit_feature(root, STATE, names=["x"] * 10**6), 1, 0),
    "data claims a billion rows": Case(lambda root: claim_rows(root / DATA, 10**9), 1, 2, DATA),
    "info of 10 GB": Case(sparse(INFO), 3, 2, "bytes", can_be_read_whole=False),
    "stats of 10 GB": Case(sparse(STATS_PATH), 1, 0, can_be_read_whole=False),
    # sizes that are there
    "a bomb of frames": Case(bomb(DATA, 10**6, 10), 1, 2, DATA),
    "a bomb of frames that is expected": Case(bomb_that_is_expected, 1, 2, DATA),
    "a bomb of episodes": Case(bomb(EPISODES, 10**6, 7), 3, 2, EPISODES),
    "a bomb of tasks": Case(bomb(TASKS, 10**6, 10), 1, 0),
    "texts of 40 MB": Case(add_text_column, 1, 0),
    "a task of 50 MB": Case(lambda root: edit_column(root, TASKS, "task", lambda _: ["x" * 50 * 10**6]), 1, 0),
    "a version of 1 MB": Case(lambda root: edit_info(root, codebase_version="v4" * 10**6), 3, 2),
    "a template of 1 MB": Case(
        lambda root: edit_info(root, data_path="data/" + "a" * 10**6 + "{file_index}.parquet"), 1, 2
    ),
    "a feature name of 1 MB": Case(lambda root: edit_feature(root, "x" * 10**6, dtype="float32", shape=[1]), 1, 2),
    "a video name of 5000 letters": Case(lambda root: declare_video(root, "x" * 5000), 1, 0),
    "a video name with NUL": Case(lambda root: declare_video(root, "x\0"), 1, 0),
    "a video name that leads up": Case(lambda root: declare_video(root, "../../../../etc"), 1, 0),
    "a video of 10 GB of nothing": Case(
        lambda root: (declare_video(root), orphan_video(root), sparse(VIDEO)(root)), 1, 0, can_be_read_whole=False
    ),
    "a video that is a pipe": Case(
        lambda root: (declare_video(root), orphan_video(root), pipe(VIDEO)(root)), 1, 0, can_be_read_whole=False
    ),
    "a camera of 10**400 pictures a second": Case(
        lambda root: (declare_video(root), edit_feature(root, CAMERA, info={"video.fps": 10**400})), 1, 0
    ),
    "an image of 30 MB in every row": Case(large_images, 1, 0),
    # numbers
    "fps of NaN": Case(lambda root: edit_info(root, fps=float("nan")), 3, 2, INFO),
    "fps of infinity": Case(lambda root: edit_info(root, fps=float("inf")), 3, 2, INFO),
    "fps of 1e308": Case(lambda root: edit_info(root, fps=1e308), 3, 2, "fps"),
    "fps of 1e-300": Case(lambda root: edit_info(root, fps=1e-300), 3, 2, "fps"),
    "fps of 400 digits": Case(lambda root: edit_info(root, fps=10**400), 3, 2, "fps"),
    "ranges at the limits of int64": Case(limits(-(2**63), 2**63 - 1), 1, 2),
    "ranges at the upper limit": Case(limits(2**63 - 3, 2**63 - 1), 1, 2),
    "negative ranges": Case(limits(-427, 0), 1, 2),
    # nesting
    "info nested a million deep": Case(write_text(INFO, "[" * 10**6), 3, 2, INFO),
    "features nested deep": Case(
        write_text(INFO, '{"codebase_version":"v3.0","features":' + '{"a":' * 10**6), 3, 2, INFO
    ),
    "names nested deep": Case(
        lambda root: (root / INFO).write_text(
            (root / INFO).read_text().replace('"names": null', '"names": ' + "[" * 10**5 + "]" * 10**5, 1)
        ),
        3,
        2,
        INFO,
    ),
    "stats nested deep": Case(write_text(STATS_PATH, '{"action":{"mean":' + "[" * 10**6), 1, 0),
    "stats nested and whole": Case(write_text(STATS_PATH, '{"action":{"mean":' + "[" * 900 + "]" * 900 + "}}"), 1, 0),
    "a verdict nested deep": Case(
        lambda root: root.with_name("dataset.verdict.json").write_text('{"episodes":' + "[" * 10**6), 1, 0
    ),
    # links and pipes
    "a data file that is /dev/zero": Case(
        lambda root: ((root / DATA).unlink(), link(DATA, "/dev/zero")(root)), 1, 2, "leads out"
    ),
    "info that is /dev/zero": Case(
        lambda root: ((root / INFO).unlink(), link(INFO, "/dev/zero")(root)), 3, 2, "leads out"
    ),
    "a folder in itself": Case(link("data/chunk-000/again", ".."), 0, 0),
    "a shard folder in itself": Case(link("meta/episodes/chunk-001", "../episodes"), 0, 0),
    "a folder that leads out": Case(link("data/chunk-001", "/etc"), 0, 0),
    "info that is a pipe": Case(pipe(INFO), 3, 2, INFO, can_be_read_whole=False),
    "a shard that is a pipe": Case(pipe(EPISODES), 3, 2, EPISODES, can_be_read_whole=False),
    "a data file that is a pipe": Case(pipe(DATA), 1, 2, DATA, can_be_read_whole=False),
    "tasks that are a pipe": Case(pipe(TASKS), 1, 0, can_be_read_whole=False),
    "stats that are a pipe": Case(pipe(STATS_PATH), 1, 0, can_be_read_whole=False),
}


@pytest.mark.parametrize("name", CASES)
def test_a_stranger_gets_a_clear_answer(name, standin_copy, tmp_path, ask):
    case, root = CASES[name], standin_copy.rename(tmp_path / "dataset")
    case.do(root)
    before = fingerprint(root) if case.can_be_read_whole else {}
    audit, inspect = ask(root)
    assert (audit["code"], inspect["code"]) == (case.audit, case.inspect), (audit, inspect)
    assert inspect["err"].count("\n") == (inspect["code"] == 2)
    assert case.says in audit["out"]
    assert case.says in inspect["out"] + inspect["err"]
    assert max(len(line) for line in (audit["out"] + inspect["err"]).splitlines()) < 2000
    assert max(audit["peak"], inspect["peak"]) < PEAK
    assert before == (fingerprint(root) if before else {})


NAMES = (
    *("[red]loud[/red]", "[/]", "[link=http://example.com]x[/link]", "\x1b[2J\x1b]0;title\x07", "\u202eabc"),
    *("<script>x()</script>", "a\nb\r", "{chunk_index}", "%s"),
)


def test_names_are_shown_as_they_are_and_steer_nothing(standin_copy, ask):
    """Names of features that have no column, and the first of them in the reader's one line."""
    features = {name: {"dtype": "float32", "shape": [1], "names": [name]} for name in NAMES}
    edit_info(standin_copy, features=features | read_json(standin_copy, INFO)["features"])
    audit, inspect = ask(standin_copy)
    assert (audit["code"], inspect["code"]) == (1, 2)
    assert inspect["err"].count("\n") == 1
    assert NAMES[0] in inspect["err"]
    assert all(line.isprintable() for text in (audit["out"], inspect["err"]) for line in text.splitlines())
    assert NAMES[0] in audit["out"]


@pytest.mark.parametrize("name", NAMES)
def test_a_finding_holds_a_name_as_it_is(name, standin_copy):
    edit_feature(standin_copy, name, dtype="float32", shape=[1])
    findings = [str(finding) for finding in z2r.audit(standin_copy).findings if finding.check == "columns"]
    assert any(repr(name)[1:-1] in finding for finding in findings)
    assert all(finding.isprintable() for finding in findings)


def test_file_names_steer_nothing(standin_copy, ask):
    for name in NAMES:
        shutil.copy(standin_copy / DATA, standin_copy / f"data/chunk-000/{name.replace('/', '_')}.parquet")
    audit, inspect = ask(standin_copy)
    assert (audit["code"], inspect["code"]) == (1, 0)
    assert all(line.isprintable() for line in audit["out"].splitlines())


def test_dimension_names_steer_nothing(standin_copy, ask):
    """Inspect prints them in its table."""
    edit_feature(standin_copy, "action", names=[NAMES[0], NAMES[3]])
    audit, inspect = ask(standin_copy)
    assert (audit["code"], inspect["code"]) == (0, 0)
    assert NAMES[0] in inspect["out"]
    assert all(line.isprintable() for text in (audit["out"], inspect["out"]) for line in text.splitlines())
