"""What a dataset says of itself is shown; what is missing or odd is unknown, and never an error."""

import json
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from damages import EPISODES, TASKS, edit_feature, edit_info
from layouts import Layout, lay_out_again, shard_files
from rich.console import Console
from test_replay import read_rows
from test_report import write

import z2r
from z2r.format.about import About, Camera, Task, read_about
from z2r.show.replay import write_replay
from z2r.show.terminal import summary

FRONT, WRIST, NOTE = "observation.images.front", "observation.images.wrist", "note"
HOSTILE = "<b>[red]pick\x1b[2J"


def set_tasks(root: Path, table: list[str], of_episodes: list[list[str]]) -> None:
    """Name the tasks, in the table from the last to the first, and of each episode."""
    numbers = range(len(table))[::-1]
    pq.write_table(pa.table({"task_index": numbers, "task": table[::-1]}), root / TASKS)
    first = 0
    for path in shard_files(root):
        shard = pq.read_table(path)
        column = pa.array(of_episodes[first : first + len(shard)], pa.list_(pa.string()))
        pq.write_table(shard.set_column(shard.column_names.index("tasks"), "tasks", column), path, row_group_size=2)
        first += len(shard)


def about(root: Path) -> About:
    return z2r.inspect_dataset(root).about


def printed(inspection: z2r.Inspection) -> str:
    console = Console(width=200, markup=False, highlight=False)
    with console.capture() as capture:
        console.print(summary(inspection, "here"))
    return capture.get()


@pytest.fixture
def told(tmp_path) -> Path:
    """Fourteen episodes in three shards: seven tasks, two of them in some episodes, one that nobody was given."""
    root = tmp_path / "told"
    lay_out_again(z2r.MESSY, root, Layout([14], [5, 6, 3]))
    tasks = [HOSTILE, *(f"task {number}" for number in range(1, 7))]
    set_tasks(root, tasks, [[tasks[0], tasks[1]]] * 3 + [[tasks[2]]] * 7 + [[tasks[n]] for n in (3, 4, 5, 5)])
    edit_info(root, robot_type="so101_follower")
    return root


def test_episodes_are_counted_for_each_task_in_the_order_of_their_numbers(told):
    tasks = about(told).tasks
    assert [task.task for task in tasks] == [HOSTILE, *(f"task {number}" for number in range(1, 7))]
    assert [task.n_episodes for task in tasks] == [3, 3, 7, 1, 1, 2, 0]


def test_only_the_episodes_that_were_read_are_counted(told):
    tasks = z2r.inspect_dataset(z2r.load(told).first(4)).about.tasks
    assert [task.n_episodes for task in tasks] == [3, 3, 1, 0, 0, 0, 0]


def test_the_metrics_end_on_what_the_dataset_says_of_itself(told):
    metrics = z2r.inspect_dataset(told).metrics("told", None)
    assert list(metrics)[-4:] == ["robot_type", "tasks", "cameras", "text_columns"]
    assert metrics["robot_type"] == "so101_follower"
    assert metrics["tasks"][2] == {"task": "task 2", "n_episodes": 7}
    last = {key: metrics[key] for key in list(metrics)[-4:]}
    assert json.loads(json.dumps(last)) == last


def test_the_terminal_shows_the_five_tasks_of_most_episodes(told):
    said = printed(z2r.inspect_dataset(told))
    assert "robot  so101_follower" in said
    assert "tasks  task 2 (7 episodes)" in said
    assert r"<b>[red]pick\x1b[2J (3 episodes)" in said
    assert "and 2 more" in said
    assert "task 6" not in said
    assert "cameras" not in said


def test_the_page_shows_it_escaped(told, tmp_path):
    page = write(z2r.load(told), tmp_path)
    assert "<dt>robot</dt><dd>so101_follower</dd>" in page
    assert r"<dt>tasks</dt><dd>task 2 (7 episodes)</dd><dd>&lt;b&gt;[red]pick\x1b[2J (3 episodes)</dd>" in page


def test_the_recording_holds_it_as_plain_text(told, tmp_path):
    write_replay(z2r.inspect_dataset(told, keep=100), tmp_path / "a.rrd")
    rows = read_rows(tmp_path / "a.rrd", "frame")
    [(time, [text])] = rows["/about", "TextDocument:text"]
    assert time is None
    assert text.splitlines()[:2] == ["robot: so101_follower", "tasks: task 2 (7 episodes)"]
    assert text.splitlines()[2] == r"tasks: <b>[red]pick\x1b[2J (3 episodes)"
    assert "markdown" not in str(rows.get(("/about", "TextDocument:media_type")))


def declare_cameras(root: Path) -> None:
    info = {"video.fps": 30, "video.codec": "av1", "video.height": 1, "video.width": 1}
    edit_feature(root, FRONT, dtype="video", shape=[480, 640, 3], names=["height", "width", "channels"], info=info)
    edit_feature(root, WRIST, dtype="image", shape=[3, 96, 128], names=["channels", "height", "width"])
    edit_feature(root, NOTE, dtype="string", shape=[1], names=None)


def test_cameras_and_text_are_shown_with_what_is_known_of_them(standin_copy, tmp_path):
    declare_cameras(standin_copy)
    inspection = z2r.inspect_dataset(standin_copy)
    assert inspection.about.cameras == (Camera(FRONT, 480, 640, 30, "av1"), Camera(WRIST, 96, 128, None, None))
    assert inspection.about.text_columns == (NOTE,)
    said = printed(inspection)
    assert f"cameras  {FRONT}, 480 x 640, 30 fps, av1" in said
    assert f"         {WRIST}, 96 x 128 " in said
    assert f"text     {NOTE}" in said
    assert f"<dt>cameras</dt><dd>{FRONT}, 480 x 640, 30 fps, av1</dd><dd>{WRIST}, 96 x 128</dd>" in write(
        inspection.dataset, tmp_path
    )
    assert inspection.metrics("", None)["cameras"][1] == {
        "name": WRIST,
        "height": 96,
        "width": 128,
        "fps": None,
        "codec": None,
    }


@pytest.mark.parametrize(
    ("said", "expected"),
    [
        ({"video_info": {"video.fps": 15.0, "video.codec": "h264"}}, Camera(FRONT, None, None, 15.0, "h264")),
        ({"info": {"video.height": 48, "video.width": 64}}, Camera(FRONT, 48, 64, None, None)),
        ({"info": {"video.fps": "fast", "video.codec": 7, "video.height": -1, "video.width": True}}, None),
        ({"info": {"video.fps": 10**400}}, None),
        ({"info": {"video.fps": 0, "video.codec": " "}, "video_info": [1]}, None),
        ({"info": 7, "names": ["height", 7, None]}, None),
        ({"names": {"height": 0, "width": 1}}, None),
    ],
)
def test_what_is_odd_about_a_camera_is_unknown(said, expected, standin_copy):
    edit_feature(standin_copy, FRONT, dtype="video", shape=[480, 640, 3], **said)
    assert about(standin_copy).cameras == (expected or Camera(FRONT, None, None, None, None),)
    assert "size unknown" in printed(z2r.inspect_dataset(standin_copy)) or expected


@pytest.mark.parametrize("robot", [None, 7, "", "  ", ["arm"], {"a": 1}, ...])
def test_a_robot_that_is_no_text_is_unknown(robot, standin_copy):
    edit_info(standin_copy, robot_type=robot)
    assert about(standin_copy).robot_type is None
    assert "robot  unknown" in printed(z2r.inspect_dataset(standin_copy))


def replace_tasks(root: Path, column: pa.Array | None) -> None:
    table = pq.read_table(root / EPISODES)
    place, table = table.column_names.index("tasks"), table.drop_columns(["tasks"])
    pq.write_table(table if column is None else table.add_column(place, "tasks", column), root / EPISODES)


@pytest.mark.parametrize(
    "column",
    [
        None,
        pa.array(range(6)),
        pa.array(["push"] * 6),
        pa.array([[1]] * 6),
        pa.array([["a"]] * 6, pa.list_(pa.string(), 1)),
        pa.array([[b"\xff"]] * 6),
    ],
)
def test_without_the_tasks_of_the_episodes_their_number_is_unknown(column, standin_copy):
    replace_tasks(standin_copy, column)
    assert about(standin_copy).tasks == (Task("push the T onto the target", None),)


def test_an_episode_without_a_task_is_counted_nowhere(standin_copy):
    replace_tasks(standin_copy, pa.array([["a", "a"], [], None, [None], ["b", None], ["a"]]))
    tasks = {task.task: task.n_episodes for task in about(standin_copy).tasks}
    assert tasks == {"push the T onto the target": 0, "a": 2, "b": 1}


@pytest.mark.parametrize("spoil", [Path.unlink, lambda path: path.write_text("x"), lambda path: path.write_bytes(b"")])
def test_without_the_table_of_tasks_those_that_the_episodes_name_are_there(spoil, standin_copy):
    spoil(standin_copy / TASKS)
    assert about(standin_copy).tasks == (Task("push the T onto the target", 6),)


def test_where_nothing_says_what_the_tasks_are_they_are_unknown(standin_copy):
    (standin_copy / TASKS).unlink()
    replace_tasks(standin_copy, None)
    assert about(standin_copy).tasks is None
    assert "tasks  unknown" in printed(z2r.inspect_dataset(standin_copy))


def test_a_text_that_is_repeated_by_a_small_file_is_held_once(standin_copy):
    """A megabyte in each of a hundred thousand rows would be 100 GB; the file has less than a hundredth of one."""
    long, n_rows = "x" * 10**6, 10**5
    repeated = pa.DictionaryArray.from_arrays(np.zeros(n_rows, np.int32), pa.array([long]))
    lists = pa.ListArray.from_arrays(np.arange(n_rows + 1, dtype=np.int32), repeated)
    path = standin_copy / EPISODES
    pq.write_table(pa.table({"episode_index": np.arange(n_rows), "tasks": lists}), path, store_schema=False)
    assert path.stat().st_size < 10**6
    found = read_about(standin_copy, z2r.load(z2r.STANDIN).schema, np.arange(n_rows))
    assert found.tasks[-1].n_episodes == n_rows
