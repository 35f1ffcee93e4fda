"""A draft of a reading: it reads as it stands, says where each line comes from, and needs a goal and nothing else."""

import shutil
from pathlib import Path

import msgspec
import numpy as np
import pytest
from layouts import BOOKKEEPING, Layout, write_dataset
from test_cli import run

import z2r
from z2r.api import choose_reading, shipped_readings
from z2r.show.draft import draft_reading, find_poses

SHIPPED = {"standin": z2r.STANDIN, "messy": z2r.MESSY}


def draft_of(dataset: Path, tmp_path: Path) -> z2r.Reading:
    text = draft_reading(z2r.inspect_dataset(dataset), "mine")
    (tmp_path / "mine.toml").write_text(text)
    return z2r.read_reading(tmp_path / "mine.toml")


@pytest.mark.parametrize("name", SHIPPED)
def test_a_draft_of_the_shipped_datasets_says_what_their_reading_says_but_for_the_goal(name, tmp_path):
    draft = draft_of(SHIPPED[name], tmp_path)
    assert draft.poses == z2r.PUSHT.poses
    assert draft.action == z2r.PUSHT.action
    assert not draft.goal


def test_with_the_goal_that_it_suggests_a_draft_counts(tmp_path):
    text = draft_reading(z2r.inspect_dataset(z2r.MESSY), "mine")
    suggested = '# [[goal]]\n# name = "distance"\n# distance = ["tee", "target"]\n# within = 0.03'
    assert suggested in text
    (tmp_path / "mine.toml").write_text(text.replace(suggested, suggested.replace("# ", "")))
    outcome = z2r.inspect_dataset(z2r.MESSY, reading=z2r.read_reading(tmp_path / "mine.toml")).outcome
    by_pusht = z2r.inspect_dataset(z2r.MESSY).outcome.final_errors["pos_err"]
    np.testing.assert_array_equal(outcome.reached, by_pusht < 0.03)


@pytest.fixture
def nameless(tmp_path: Path) -> Path:
    """Two joints without names, one of which follows its command, and one that has none."""
    rng = np.random.default_rng(0)
    state = np.cumsum(rng.normal(size=(600, 2)), axis=0).astype(np.float32)
    action = np.roll(state[:, :1], -2, axis=0)
    features = BOOKKEEPING | {
        "observation.state": {"dtype": "float32", "shape": [2], "names": None},
        "action": {"dtype": "float32", "shape": [1], "names": None},
    }
    root = tmp_path / "nameless"
    frames = {"observation.state": state, "action": action}
    write_dataset(root, frames, [100] * 6, Layout([6], [6], episode_stats=True), features=features)
    return root


def test_columns_without_names_are_numbered_as_a_reading_numbers_them(nameless, tmp_path):
    draft = draft_of(nameless, tmp_path)
    assert set(draft.columns) == {"observation.state/0", "observation.state/1"}
    assert draft.action.columns == ("action",)  # a feature of one number is a column
    assert draft.action.of == ("observation.state/0",)
    assert not draft.missing(z2r.load(nameless).schema)
    assert not draft.missing_action(z2r.load(nameless).schema)


@pytest.mark.parametrize(
    ("columns", "bodies"),
    [
        (["observation.environment_state/block_x", "observation.environment_state/block_y"], {"block": "xy"}),
        (["a.x", "a.y", "a.z", "b_x"], {"a": "xyz"}),
        (["shoulder_pan.pos", "gripper.pos"], {}),
        (["hand_x", "hand_y", "hand_sin", "cos_hand_yaw"], {"hand": ["x", "y", "sin", "cos"]}),
        (["sin_yaw", "cos_yaw"], {}),
    ],
)
def test_poses_are_found_by_the_names_of_their_columns(columns, bodies):
    assert {body: set(parts) for body, parts in find_poses(columns).items()} == {b: set(p) for b, p in bodies.items()}


def test_the_command_writes_a_draft_and_never_over_what_somebody_filled_in(tmp_path):
    printed = run("reading", cwd=tmp_path)
    assert printed.returncode == 0
    written = run("reading", "--out", "mine.toml", cwd=tmp_path)
    assert written.returncode == 0
    assert (tmp_path / "mine.toml").read_text() == printed.stdout
    again = run("reading", "--out", "mine.toml", cwd=tmp_path)
    assert again.returncode == 2
    assert "exists" in again.stderr


def test_a_draft_of_a_dataset_in_a_cache_is_called_as_on_the_hub(tmp_path):
    snapshot = shutil.copytree(z2r.STANDIN, tmp_path / "datasets--someone--pusht/snapshots/0123abcd")
    draft = run("reading", snapshot, cwd=tmp_path).stdout
    assert msgspec.toml.decode(draft)["name"] == "someone/pusht"


def test_readings_that_ship_are_readings_and_are_found_by_their_names():
    assert list(shipped_readings()) == ["pusht", "lerobot_pusht", "so101", "koch", "aloha"]
    for name, reading in shipped_readings().items():
        assert z2r.find_reading(name) == reading
        if reading.action:
            assert len(reading.action.columns) == len(set(reading.action.columns)) == len(reading.action.of)
    with pytest.raises(z2r.DatasetError, match="Did you mean so101"):
        z2r.find_reading("so10")


def schema_of(names: list[str]) -> z2r.Schema:
    state = z2r.Feature("float32", (len(names),), names)
    return z2r.Schema("v3.0", 30, 1, 1, {"observation.state": state, "action": state}, "")


@pytest.mark.parametrize("name", ["so101", "aloha"])
def test_the_reading_of_a_robot_is_chosen_where_its_columns_fit(name):
    names = [column for column in shipped_readings()[name].columns if "/" not in column]
    assert choose_reading(schema_of(names)).name == name
    assert choose_reading(schema_of([f"other_{column}" for column in names])) is None


def test_of_robots_with_the_same_columns_the_type_tells(tmp_path):
    names = [column for column in shipped_readings()["koch"].columns if "/" not in column]
    schema = schema_of(names)
    assert choose_reading(msgspec.structs.replace(schema, robot_type="koch_follower")).name == "koch"
    assert choose_reading(msgspec.structs.replace(schema, robot_type="so101_follower")).name == "so101"
    assert choose_reading(msgspec.structs.replace(schema, robot_type=7)).name == "so101"
