"""Which wrong beliefs a dataset refutes, which it cannot, and which do not apply, on PushT and on an arm."""

import json
import subprocess
import sys
from collections.abc import Sequence
from concurrent.futures import ThreadPoolExecutor
from io import StringIO
from pathlib import Path

import numpy as np
import pytest
from damages import edit_column, edit_info, set_at
from layouts import BOOKKEEPING, Layout, write_dataset
from rich.console import Console
from robots import ARM_REACHED, write_arm

import z2r
from z2r.audits.beliefs import Belief, Beliefs
from z2r.show.terminal import beliefs_report

REFUTED = {  # on PushT with the verdict beside it, and a check that says so
    "yaw-swap": "overlap",
    "drop-boundaries": "leap",
    "yaw-swap-everywhere": "overlap",
    "inclusive-end": "range-overlap",
    "wrong-reference-point": "overlap",
    "degrees-for-radians": "verdict",
    "first-frame-for-last": "decisive-frame",
    "wrong-fps": "action-motion",
    "action-lag": "action-motion",
    "joints-exchanged": "action-motion",
}
NOT_REFUTED = {"no-wrap"}


type Robot = tuple[z2r.Dataset, z2r.Reading]


def by_mode(beliefs: Beliefs) -> dict[str, Belief]:
    return {belief.mode: belief for belief in beliefs.beliefs}


@pytest.fixture(scope="module")
def standin() -> Beliefs:
    return z2r.audit_beliefs("standin")


@pytest.fixture(scope="module")
def labelled_arm(tmp_path_factory: pytest.TempPathFactory) -> Robot:
    """The arm, with a column that says where the gripper closed."""
    return label(tmp_path_factory.mktemp("arm"), ARM_REACHED)


def label(folder: Path, reached: Sequence[bool]) -> Robot:
    dataset, reading = write_arm(folder)
    frames = {name: dataset.read(name) for name in ("observation.state", "action")}
    success = np.zeros(len(frames["action"]), dtype=bool)
    success[dataset.episodes.to_index - 1] = reached
    features = {name: json.loads((dataset.root / "meta/info.json").read_text())["features"][name] for name in frames}
    features |= {"next.success": {"dtype": "bool", "shape": [1], "names": None}} | BOOKKEEPING
    lengths = dataset.episodes.lengths.tolist()
    write_dataset(folder / "labelled", frames | {"next.success": success}, lengths, Layout([5], [5]), features=features)
    return z2r.load(folder / "labelled"), reading


def test_there_is_a_belief_for_each_mode_in_their_order(standin):
    assert [belief.mode for belief in standin.beliefs] == list(z2r.BREAK_MODES)
    assert [belief.believed for belief in standin.beliefs] == [mode.assumption for mode in z2r.BREAK_MODES.values()]


def test_what_the_shipped_data_refutes_and_what_it_cannot(standin):
    verdicts = {name: belief.verdict for name, belief in by_mode(standin).items()}
    assert {name for name, verdict in verdicts.items() if verdict == "refuted"} == set(REFUTED)
    assert {name for name, verdict in verdicts.items() if verdict == "not refuted"} == NOT_REFUTED
    for mode, check in REFUTED.items():
        assert check in by_mode(standin)[mode].refuted_by


def test_what_does_not_apply_says_what_it_is_about(standin):
    dataset = z2r.load("standin")
    for mode, belief in by_mode(standin).items():
        applies = z2r.break_mode(mode).applies_to(dataset, z2r.PUSHT)
        assert belief.lacking == ("" if applies else z2r.break_mode(mode).about)
        assert (belief.verdict == "does not apply") == (not applies)
        assert applies or not (belief.columns or belief.refuted_by)


def test_each_is_what_an_audit_under_the_mode_finds(standin):
    assert standin.as_it_is == z2r.audit("standin")
    for mode, belief in by_mode(standin).items():
        found = z2r.audit("standin", z2r.break_mode(mode)).findings
        assert set(belief.refuted_by) == {finding.check for finding in found if finding.severity != "note"}


def test_a_label_refutes_what_the_frames_cannot(labelled_arm):
    beliefs = by_mode(z2r.audit_beliefs(*labelled_arm))
    assert beliefs["gripper-inverted"].refuted_by == ("stored-success",)
    assert beliefs["gripper-inverted"].columns == ("gripper.pos",)
    assert beliefs["first-frame-for-last"].refuted_by == ("stored-success",)
    assert beliefs["yaw-swap"].verdict == beliefs["quaternion-order"].verdict == "does not apply"


def test_a_note_refutes_nothing(tmp_path):
    """A label that was never filled in is a note, whatever the reading says; other episodes make no other of it."""
    found = z2r.audit_beliefs(*label(tmp_path, [False] * 5))
    assert {finding.severity for finding in found.as_it_is.findings} == {"note"}
    assert found.found_anyway == ()
    assert by_mode(found)["gripper-inverted"].verdict == "not refuted"


def test_what_is_wrong_anyway_refutes_nothing(standin_copy):
    """Its timestamps are wrong whatever is believed; three times as many frames a second make them wrong once more."""
    edit_column(standin_copy, "data/chunk-000/file-000.parquet", "timestamp", set_at(100, 99.0))
    found = z2r.audit_beliefs(standin_copy)
    assert "timestamp" in found.found_anyway
    assert not any(set(belief.refuted_by) & set(found.found_anyway) for belief in found.beliefs)
    assert by_mode(found)["wrong-fps"].refuted_by == ("action-motion",)


def test_more_of_what_is_wrong_anyway_does(tmp_path):
    """One total is wrong; who loses an episode counts two more that are."""
    dataset, reading = write_arm(tmp_path)
    edit_info(dataset.root, total_tasks=3)
    found = z2r.audit_beliefs(dataset, reading)
    assert "totals" in found.found_anyway
    assert "totals" in by_mode(found)["stale-file-pointer"].refuted_by
    assert "totals" not in by_mode(found)["wrong-fps"].refuted_by


def test_of_what_is_not_whole_nobody_can_say_what_is_believed(standin_copy):
    edit_info(standin_copy, total_frames=3)
    with pytest.raises(z2r.DatasetError, match="total_frames"):
        z2r.audit_beliefs(standin_copy)
    with pytest.raises(z2r.DatasetError):
        z2r.audit_beliefs(standin_copy / "nowhere")


def test_it_says_how_far_it_is_and_runs_where_it_is_told(labelled_arm):
    told: list[tuple[int, int]] = []
    files: list[object] = []

    class Counted(ThreadPoolExecutor):
        def submit(self, function, /, *args, **options):
            files.append(args)
            return super().submit(function, *args, **options)

    with Counted(2) as threads:
        found = z2r.audit_beliefs(*labelled_arm, lambda *done: told.append(done), threads)
        assert threads.submit(int).result() == 0  # it is not shut down
    n_audits = 1 + sum(not belief.lacking for belief in found.beliefs)
    assert told == [(done, n_audits) for done in range(1, n_audits + 1)]
    assert len(files) == n_audits + 1  # there is one data file
    assert found == z2r.audit_beliefs(*labelled_arm)


def test_the_dataset_is_never_written_to(labelled_arm):
    dataset, reading = labelled_arm
    before = {path: path.read_bytes() for path in dataset.root.rglob("*") if path.is_file()}
    z2r.audit_beliefs(dataset, reading)
    assert before == {path: path.read_bytes() for path in dataset.root.rglob("*") if path.is_file()}


def test_the_table_has_what_applies_and_says_why_the_rest_does_not(standin):
    screen = Console(width=300, file=StringIO(), markup=False)
    with screen.capture() as printed:
        screen.print(beliefs_report(standin, "a[bold]b"))
    lines = printed.get().splitlines()
    assert "a[bold]b" in lines[0]
    for belief in standin.beliefs:
        [line] = [line for line in lines if belief.mode in line.replace(",", " ").split()]
        if belief.lacking:
            assert line.startswith("does not apply: ")
            assert line.rstrip().endswith(f"which is about {belief.lacking}")
        else:
            assert (", ".join(belief.refuted_by) or "not refuted") in line
    assert "10 refuted, 1 not refuted" in (line.strip() for line in lines)


def run(*args: object, cwd: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", "from z2r.cli import main; main()", *map(str, args)]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=120, check=False)


def test_json_is_the_beliefs_and_nothing_else(standin, tmp_path):
    result = run("audit", "--break", "all", "--json", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    told = json.loads(result.stdout)
    assert told == json.loads(json.dumps(standin.to_dict("standin")))
    assert told.keys() == {"source", "found_anyway", "beliefs"}
    assert told["beliefs"][0].keys() == {"mode", "believed", "verdict", "columns", "refuted_by", "lacking"}
    assert not list(tmp_path.iterdir())


def test_the_exit_code_is_0_whatever_is_found_and_2_where_it_is_not_whole(standin_copy, tmp_path):
    edit_column(standin_copy, "data/chunk-000/file-000.parquet", "timestamp", set_at(100, 99.0))
    result = run("audit", standin_copy, "--break", "all", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    assert "refutes nothing: timestamp" in result.stdout
    edit_info(standin_copy, total_frames=3)
    result = run("audit", standin_copy, "--break", "all", cwd=tmp_path)
    assert result.returncode == 2
    assert "total_frames" in result.stderr
    assert run("inspect", "--break", "all", cwd=tmp_path).returncode == 2  # a table is no reading


def test_one_belief_says_of_which_columns_it_is(tmp_path):
    result = run("audit", "--break", "joints-exchanged", cwd=tmp_path)
    assert result.returncode == 1
    assert "pusher_x, pusher_y" in result.stdout
    lacking = run("audit", "--break", "quaternion-order", cwd=tmp_path)
    assert lacking.returncode == 0
    assert "here it changes nothing" in lacking.stdout


@pytest.mark.parametrize("option", ["--pictures", "--keep=good.json"])
def test_what_the_table_would_leave_undone_is_refused(option, tmp_path):
    done = subprocess.run(
        [sys.executable, "-c", "from z2r.cli import main; main()", "audit", "--break", "all", option],
        cwd=tmp_path,
        capture_output=True,
        text=True,
    )
    assert done.returncode == 2
    assert "neither --keep nor --pictures" in " ".join(done.stderr.replace("│", " ").split())
    assert not [*tmp_path.iterdir()]
