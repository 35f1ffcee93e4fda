"""A verdict is read for any robot, held against a reading where it is of these episodes, and never in the way."""

import json

import numpy as np
import pytest
from test_cli import run

import z2r
from z2r.format.episodes import EpisodeIndex
from z2r.reading.verdict import Recording, Verdict, verdict_path, write_verdict

STACK = {"python": "3.12"}


def index(lengths, numbers):
    ends = np.cumsum(lengths)
    return EpisodeIndex(ends - lengths, ends, np.array(numbers))


def test_a_dataset_without_a_verdict_has_none(standin_copy):
    assert z2r.read_verdict(standin_copy) is None


@pytest.mark.parametrize(
    "content",
    [
        *(b"", b"{}", b"[]", b"\xff", b"[" * 10**6),
        b'{"command": "", "stack": {}, "episodes": []}',
        b'{"command": "", "stack": {}, "episodes": [3]}',
        b'{"command": "", "stack": {}, "episodes": [{"n_frames": 3}]}',
        b'{"command": "", "stack": {}, "episodes": [{"n_frames": 3, "success": "yes"}]}',
        b'{"stack": {}, "episodes": [{"n_frames": 3, "success": true}]}',
    ],
)
def test_a_file_that_is_no_verdict_is_named_and_does_not_stop_who_reads_the_dataset(content, standin_copy, tmp_path):
    verdict_path(standin_copy).write_bytes(content)
    with pytest.raises(z2r.DatasetError, match=r"standin\.verdict\.json"):
        z2r.read_verdict(standin_copy)
    if content in (b"{}", b"\xff"):  # a process for each of them would take long
        said = run("inspect", standin_copy, "--no-rerun", cwd=tmp_path)
        assert (said.returncode, said.stderr) == (0, "")
        [line] = [line for line in said.stdout.splitlines() if "verdict" in line]
        assert line.startswith("verdict: it cannot be read. ")
        assert json.loads((tmp_path / "z2r-out/metrics.json").read_text())["seed"] is None


def test_what_any_robot_has_is_enough_and_the_rest_is_kept(tmp_path):
    common = {"n_frames": 3, "success": True}
    other = {"seed": 7, "n_frames": 4, "success": False, "ended": "limit", "far": 0.2, "parts": [1, None]}
    told = {"command": "make", "stack": STACK, "robot": "mine", "episodes": [common, other]}
    (tmp_path / "mine.verdict.json").write_text(json.dumps(told))
    rest = {"ended": "limit", "far": 0.2, "parts": [1, None]}
    assert z2r.read_verdict(tmp_path / "mine") == Recording(
        "make", STACK, [Verdict(3, True), Verdict(4, False, 7, rest)]
    )


def test_what_is_written_is_read(tmp_path):
    recording = Recording("make", STACK, [Verdict(3, True), Verdict(4, False, 7, {"far": 0.25})])
    write_verdict(tmp_path / "mine", recording)
    assert z2r.read_verdict(tmp_path / "mine") == recording


@pytest.mark.parametrize(
    ("lengths", "numbers", "expected"),
    [
        ([3, 4, 5], [0, 1, 2], [True, False, True]),
        ([3, 5], [0, 2], [True, True]),  # as after a salvage
        ([3, 4], [0, 2], None),
        ([3, 4, 5, 6], [0, 1, 2, 3], None),
        ([12], [0], None),
    ],
)
def test_episodes_are_graded_by_their_numbers_where_they_are_the_ones_that_were_recorded(lengths, numbers, expected):
    recording = Recording("", {}, [Verdict(3, True), Verdict(4, False), Verdict(5, True)])
    success = recording.success_of(index(lengths, numbers))
    assert (success if success is None else success.tolist()) == expected


@pytest.mark.parametrize(
    ("options", "expected"),
    [
        ((), ["verdict: success in 10 of 14 (messy.verdict.json)", "agree in 13 of 14; they differ in episode 10"]),
        (("--episodes", 3), ["verdict: success in 2 of 3", "the two agree in 3 of 3"]),
        (("--break", "yaw-swap"), ["verdict: success in 10 of 14", "the two agree in 4 of 14"]),
        (("--break", "drop-boundaries"), ["verdict: it is of others, 14 episodes with 1,108 frames"]),
    ],
)
def test_inspect_holds_a_reading_against_the_verdict_where_it_is_of_these_episodes(options, expected, tmp_path):
    said = run("inspect", "messy", "--no-rerun", *options, cwd=tmp_path)
    assert said.returncode == 0
    for line in expected:
        assert line in " ".join(said.stdout.split())
    assert said.stdout.count("verdict: ") == len(expected)
