"""The command line as a whole process: what it prints, what it writes, what it exits with."""

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from filmed import FRONT, video, write_filmed
from layouts import lay_out

import z2r
from z2r.reading.inspection import metrics_json

MAIN = "from z2r.cli import main; main()"
WITHOUT_RERUN = f"import sys; sys.modules['rerun'] = None; {MAIN}"  # as where it is not installed


def run(
    *args: object, cwd: Path, program: str = MAIN, variables: dict[str, str] | None = None
) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", program, *map(str, args)]
    environment = os.environ | (variables or {})
    return subprocess.run(
        command, cwd=cwd, env=environment, capture_output=True, text=True, errors="replace", timeout=300, check=False
    )


def shell(line: str, cwd: Path) -> subprocess.CompletedProcess[str]:
    command = ["bash", "-c", line.replace("z2r", f"{sys.executable} -c '{MAIN}'")]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=300, check=False)


def in_one_line(result: subprocess.CompletedProcess[str]) -> str:
    """What is said on stderr, without the box that is drawn around it."""
    return " ".join(result.stderr.replace("│", " ").split())


def test_inspect_reads_the_shipped_dataset_and_writes_both_files(tmp_path):
    result = run("inspect", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    assert "reached target: 6/6" in result.stdout
    assert "machine tier" in result.stdout
    written = {path.relative_to(tmp_path).as_posix() for path in tmp_path.rglob("*") if path.is_file()}
    assert written == {"z2r-out/metrics.json", "z2r-out/inspect.rrd"}
    expected = z2r.inspect_dataset(z2r.load(z2r.STANDIN)).metrics("standin", 0)
    assert (tmp_path / "z2r-out/metrics.json").read_bytes() == metrics_json(expected)


def test_one_episode_is_replayed_and_all_are_summed_up(tmp_path):
    result = run("inspect", "--episode", "4", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    assert "reached target: 6/6" in result.stdout
    assert "it shows episode 4, one of 6 (66 of 427 frames); the others are left out" in result.stdout
    refused = run("inspect", "--episode", "6", cwd=tmp_path)
    assert refused.returncode == 2
    assert "--episode: found no episode 6, expected one of 0 to 5" in in_one_line(refused)


def test_a_camera_without_its_video_is_named_and_all_else_is_replayed(tmp_path):
    write_filmed(tmp_path / "dataset")
    video(tmp_path / "dataset", FRONT).unlink()
    result = run("inspect", "dataset", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    assert "not in it: videos/observation.images.front/chunk-000/file-000.mp4: found no such file" in result.stdout


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
    assert "reached: unknown" in result.stdout
    assert "its reading needs tee_x, which is not there" in " ".join(result.stdout.split())
    assert "cube_x" in result.stdout
    assert (tmp_path / "z2r-out/inspect.rrd").exists()


def test_smoke_records_short_episodes_afresh(tmp_path):
    result = run("inspect", "--smoke", "--episodes", 2, "--seed", 7, "--json", cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    metrics = json.loads(result.stdout)
    assert metrics["episode_lengths"] == [40, 40]
    assert (metrics["source"], metrics["seed"]) == ("recorded afresh", 7)
    assert not (tmp_path / "z2r-out/inspect.rrd").exists()


def test_what_was_recorded_afresh_is_kept_and_the_next_recording_takes_its_place(tmp_path):
    first = run("inspect", "--seed", 3, "--episodes", 1, "--out", "here", cwd=tmp_path)
    assert (first.returncode, first.stderr) == (0, "")
    assert first.stdout.splitlines()[0] == "recording 1 episode into here/dataset"
    assert (tmp_path / "here/inspect.rrd").exists()
    assert z2r.read_verdict(tmp_path / "here/dataset").episodes[0].seed == 3
    second = run("inspect", "--smoke", "--episodes", 2, "--out", "here", cwd=tmp_path)
    assert second.stdout.splitlines()[0] == "recording 2 episodes into here/dataset"
    assert z2r.load(tmp_path / "here/dataset").episodes.lengths.tolist() == [40, 40]
    names = {path.name for path in (tmp_path / "here").iterdir()}
    assert names == {"dataset", "dataset.verdict.json", "metrics.json", "inspect.rrd"}


def test_a_recording_is_not_lost_when_the_next_one_fails(tmp_path):
    z2r.record(tmp_path / "z2r-out/dataset", [0], max_steps=5)
    result = run("inspect", "--smoke", cwd=tmp_path, program=f"import sys; sys.modules['lerobot'] = None; {MAIN}")
    assert result.returncode == 2
    assert "pip install '.[record]'" in result.stderr
    assert z2r.load(tmp_path / "z2r-out/dataset").episodes.n_frames == 5
    assert {path.name for path in (tmp_path / "z2r-out").iterdir()} == {"dataset", "dataset.verdict.json"}


def test_no_dataset_but_an_earlier_recording_is_replaced(standin_copy, tmp_path):
    (tmp_path / "z2r-out").mkdir()
    mine = standin_copy.rename(tmp_path / "z2r-out/dataset")
    result = run("inspect", "--smoke", cwd=tmp_path)
    assert result.returncode == 2
    assert "Move it away, or name another --out" in result.stderr
    assert z2r.load(mine).episodes.n_frames == z2r.load(z2r.STANDIN).episodes.n_frames


def test_more_episodes_than_ship_are_not_recorded_unasked(tmp_path):
    result = run("inspect", "--episodes", 99, cwd=tmp_path)
    assert (result.returncode, result.stdout) == (2, "")
    assert "at most 6. To record 99: z2r inspect --seed 0 --episodes 99" in in_one_line(result)
    assert not list(tmp_path.iterdir())


def test_a_dataset_is_an_argument_or_an_option(standin_copy, tmp_path):
    for args in (["standin"], ["--dataset", "standin"], ["standin", "--dataset", "standin"]):
        result = run("inspect", *args, "--episodes", 1, "--json", cwd=tmp_path)
        assert (json.loads(result.stdout)["source"], json.loads(result.stdout)["n_episodes"]) == ("standin", 1)
    audited = run("audit", "--dataset", standin_copy, cwd=tmp_path)
    assert audited.returncode == 0
    assert "nothing wrong was found in what was checked" in audited.stdout
    result = run("inspect", "standin", "--dataset", "messy", cwd=tmp_path)
    assert result.returncode == 2
    assert "standin and --dataset messy" in in_one_line(result)


def test_break_none_reads_it_right(tmp_path):
    result = run("inspect", "--break", "none", "--json", cwd=tmp_path)
    assert result.stdout == run("inspect", "--json", cwd=tmp_path).stdout
    assert json.loads(result.stdout)["break_mode"] is None


def test_json_writes_a_replay_only_where_it_is_asked_for(tmp_path):
    run("inspect", "--json", cwd=tmp_path)
    assert not (tmp_path / "z2r-out/inspect.rrd").exists()
    run("inspect", "--json", "--rerun", cwd=tmp_path)
    assert (tmp_path / "z2r-out/inspect.rrd").exists()


def test_without_rerun_it_reads_and_says_how_to_get_a_replay(tmp_path):
    result = run("inspect", cwd=tmp_path, program=WITHOUT_RERUN)
    assert (result.returncode, result.stderr) == (0, "")
    assert result.stdout.splitlines()[-1] == (
        "no replay, which needs rerun. In a clone of the course: pip install '.[view]'"
    )
    assert not (tmp_path / "z2r-out/inspect.rrd").exists()
    result = run("inspect", "--rerun", cwd=tmp_path, program=WITHOUT_RERUN)
    assert (result.returncode, result.stdout) == (2, "")
    assert result.stderr == "z2r: no replay, which needs rerun. In a clone of the course: pip install '.[view]'\n"
    assert "no replay" not in run("inspect", "--no-rerun", cwd=tmp_path, program=WITHOUT_RERUN).stdout


def test_a_closed_standard_output_is_one_line(tmp_path):
    result = shell("z2r inspect --json >&-", tmp_path)
    assert result.returncode == 2
    assert result.stderr == "z2r: standard output is closed: send it to a file, or to /dev/null\n"


@pytest.mark.parametrize("reader", ["true", "head -1"])
@pytest.mark.parametrize("command", ["inspect", "inspect --json", "audit", "report", "reading"])
def test_a_reader_that_leaves_early_is_no_fault(command, reader, tmp_path):
    result = shell(f"z2r {command} | {reader}", tmp_path)
    assert result.stderr == ""


@pytest.mark.parametrize("encoding", ["ascii", "cp1252"])
def test_an_output_that_lacks_characters_gets_others(encoding, standin_copy, tmp_path):
    path = standin_copy / "meta/info.json"
    path.write_text(path.read_text().replace("pusher_vx", "pusher_→"), encoding="utf-8")
    for command in ("inspect", "audit", "report"):
        result = run(command, standin_copy, cwd=tmp_path, variables={"PYTHONIOENCODING": encoding})
        assert (result.returncode, result.stderr) == (0, "")
    result = run("inspect", z2r.STANDIN, cwd=tmp_path, variables={"PYTHONIOENCODING": encoding})
    [longest] = [line for line in result.stdout.splitlines() if "------------ " in line and "86" in line]
    assert "?" not in result.stdout
    assert "217" in longest


def test_a_narrow_terminal_cuts_no_value(tmp_path):
    wide = run("inspect", "messy", "--no-rerun", cwd=tmp_path, variables={"COLUMNS": "200"}).stdout
    narrow = run("inspect", "messy", "--no-rerun", cwd=tmp_path, variables={"COLUMNS": "60"}).stdout
    assert "━" in wide
    assert "…" not in wide + narrow
    assert max(map(len, narrow.splitlines()[1:])) <= 60
    assert numbers(narrow) == numbers(wide)


def numbers(text: str) -> list[str]:
    return re.findall(r"-?\d+\.\d{3}", text)


def test_a_large_number_of_episodes_is_not_listed_in_full(tmp_path):
    root = tmp_path / "many"
    lay_out(root, [3] * 25, files=[25], shards=[25])
    assert "... and 5 more" in run("inspect", root, "--no-rerun", cwd=tmp_path).stdout


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


def test_commands_tell_the_linear_algebra_to_use_one_thread_before_it_is_there():
    """It reads the variable once."""
    code = """
import os, sys
class Watch:
    def find_spec(self, name, *_):
        if name == "numpy":
            print(os.environ.get("OPENBLAS_NUM_THREADS"))
sys.meta_path.insert(0, Watch())
from z2r.cli import main
import numpy
"""
    environment = {name: value for name, value in os.environ.items() if name != "OPENBLAS_NUM_THREADS"}
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True, env=environment)
    assert done.stdout == "1\n"
