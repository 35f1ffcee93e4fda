"""The command line as a whole process: what it prints, what it writes, what it exits with."""

import json
import subprocess
import sys
from pathlib import Path

import pytest

import z2r
from z2r.reading.inspection import metrics_json


def run(*args: object, cwd: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", "from z2r.cli import main; main()", *map(str, args)]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=300, check=False)


def test_inspect_reads_the_shipped_dataset_and_writes_both_files(tmp_path):
    result = run("inspect", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    assert "reached target: 6/6" in result.stdout
    assert "machine tier" in result.stdout
    written = {path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*") if path.is_file()}
    assert written == {"z2r-out/metrics.json", "z2r-out/inspect.rrd"}
    expected = z2r.inspect_dataset(z2r.load(z2r.STANDIN)).metrics("standin", 0)
    assert (tmp_path / "z2r-out/metrics.json").read_bytes() == metrics_json(expected)


def test_json_prints_the_metrics_and_nothing_else(tmp_path):
    result = run("inspect", "messy", "--json", "--no-rerun", "--out", "here", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    assert result.stdout == (tmp_path / "here/metrics.json").read_text()
    assert json.loads(result.stdout)["source"] == "messy"
    assert not (tmp_path / "here/inspect.rrd").exists()


@pytest.mark.parametrize(
    ("mode", "reached"), [("yaw-swap", "0/3"), ("drop-boundaries", "1/1"), ("yaw-swap-everywhere", "3/3")]
)
def test_a_break_mode_says_what_it_gets_wrong_and_shows_its_signature(tmp_path, mode, reached):
    result = run("inspect", "--episodes", 3, "--break", mode, "--no-rerun", cwd=tmp_path)
    assert result.returncode == 0
    assert z2r.BREAK_MODES[mode].assumption in result.stdout
    assert f"reached target: {reached}" in result.stdout
    assert json.loads((tmp_path / "z2r-out/metrics.json").read_text())["break_mode"] == mode


def test_a_fault_in_a_dataset_is_one_line_and_exit_code_2(standin_copy, tmp_path):
    (standin_copy / "meta/info.json").write_text("{")
    result = run("inspect", standin_copy, cwd=tmp_path)
    assert (result.returncode, result.stdout) == (2, "")
    assert result.stderr.startswith(f"z2r: {standin_copy}/meta/info.json: ")
    assert result.stderr.count("\n") == 1


@pytest.mark.parametrize(
    "args",
    [
        ["inspect", "--break", "nope"],
        ["inspect", "--episodes", "0"],
        ["inspect", "standin", "--episodes", "7"],
        ["inspect", "standin", "--smoke"],
        ["inspect", "standin", "--seed", "3"],
        ["inspect", "nowhere"],
        ["inspect", "--nope"],
        ["inspect", str(z2r.STANDIN), "--out", str(z2r.STANDIN / "out")],
        ["record", "."],
        ["record", "x", "--noise", "-1"],
    ],
)
def test_bad_arguments_exit_with_2_and_write_nothing(args, tmp_path):
    result = run(*args, cwd=tmp_path)
    assert result.returncode == 2
    assert result.stderr
    assert "Traceback" not in result.stderr
    assert not list(tmp_path.iterdir())


def test_names_from_a_dataset_are_not_taken_for_markup_or_escapes(standin_copy, tmp_path):
    path = standin_copy / "meta/info.json"
    path.write_text(path.read_text().replace("pusher_vx", "[bold red]:smile:[/]\\u001b[2J"))
    result = run("inspect", standin_copy, "--no-rerun", cwd=tmp_path)
    assert result.returncode == 0
    assert "[bold red]:smile:[/]" in result.stdout
    assert "\x1b[2J" not in result.stdout


def test_a_dataset_of_another_robot_is_inspected_and_the_missing_reading_named(standin_copy, tmp_path):
    path = standin_copy / "meta/info.json"
    path.write_text(path.read_text().replace("tee_x", "cube_x"))
    result = run("inspect", standin_copy, cwd=tmp_path)
    assert result.returncode == 0
    assert "no reading for success" in result.stdout
    assert "cube_x" in result.stdout
    assert (tmp_path / "z2r-out/inspect.rrd").exists()


def test_smoke_records_short_episodes_afresh(tmp_path):
    result = run("inspect", "--smoke", "--episodes", 2, "--seed", 7, "--json", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    metrics = json.loads(result.stdout)
    assert metrics["episode_lengths"] == [40, 40]
    assert (metrics["source"], metrics["seed"]) == ("recorded afresh", 7)
    assert not (tmp_path / "z2r-out/inspect.rrd").exists()


def test_record_then_inspect(tmp_path):
    result = run("record", "mine", "--episodes", 1, "--max-steps", 5, cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    assert "z2r inspect mine" in result.stdout
    assert json.loads(run("inspect", "mine", "--json", cwd=tmp_path).stdout)["episode_lengths"] == [5]


def test_help_teaches(tmp_path):
    for args in ([], ["inspect"], ["record"]):
        result = run(*args, "--help", cwd=tmp_path)
        assert result.returncode == 0
        assert "z2r" in result.stdout
    assert run("--version", cwd=tmp_path).stdout.startswith("z2r ")
