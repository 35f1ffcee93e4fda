"""What the field guide says of each break mode is what happens, and its figure shows it."""

import shutil
from pathlib import Path

import pytest
from notebook_tools import code_cells, committed, shown

import z2r
from z2r.course import figures
from z2r.course.damage import split, turn_half
from z2r.course.field_guide import KINDS, Change, by_kind, guide, what_changes
from z2r.reading.breaks import BREAK_MODES

DORMANT_IN_ONE_FILE = {"no-wrap", "first-shard-only", "stale-file-pointer", "name-sorted-files"}
# What each mode changes in a copy with a file for each episode; no-wrap waits for a target that points elsewhere.
CHANGED = {
    "yaw-swap": "reached ang_err picture",
    "drop-boundaries": "missing lengths pos_err ang_err picture action",
    "yaw-swap-everywhere": "picture",
    "no-wrap": "",
    "inclusive-end": "lengths reached pos_err ang_err picture action",
    "first-shard-only": "missing picture action",
    "stale-file-pointer": "missing picture action",
    "name-sorted-files": "reached pos_err ang_err picture action",
    "wrong-reference-point": "reached pos_err picture",
    "degrees-for-radians": "reached",
    "first-frame-for-last": "reached pos_err ang_err",
    "wrong-fps": "speed",
    "action-lag": "action",
    "joints-exchanged": "picture",
}
NOBODY_NOTICES = {"no-wrap", "degrees-for-radians"}


@pytest.fixture(scope="module")
def root(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return split(z2r.MESSY, tmp_path_factory.mktemp("guide") / "split")


@pytest.fixture(scope="module")
def changes(root) -> dict[str, Change]:
    return {change.name: change for change in what_changes(root)}


def test_there_is_one_for_each_mode_that_applies_in_their_order(changes, root):
    dataset = z2r.load(root)
    applying = [name for name, mode in BREAK_MODES.items() if mode.applies_to(dataset, z2r.PUSHT)]
    assert list(changes) == applying == list(CHANGED)


@pytest.mark.parametrize("mode", CHANGED)
def test_each_mode_changes_what_it_is_about_and_nothing_else(mode, changes):
    change = changes[mode]
    fields = ("missing", "lengths", "reached", "pos_err", "ang_err", "picture", "action")
    found = vars(change) | change.errors
    changed = {field for field in fields if found[field]} | ({"speed"} if change.speed != 1 else set())
    assert changed == set(CHANGED[mode].split())
    assert change.is_dormant == (not changed)
    assert bool(change.checks) == (mode not in NOBODY_NOTICES)
    assert "file-order" not in change.checks


@pytest.mark.parametrize("mode", CHANGED)
def test_the_counts_are_those_of_an_inspection(mode, changes, root):
    inspection, change = z2r.inspect_dataset(z2r.load(root), z2r.break_mode(mode)), changes[mode]
    assert (change.n_episodes, change.n_reached) == (len(inspection.episodes), inspection.outcome.n_reached)
    assert change.missing == 14 - change.n_episodes


def test_how_much_is_what_one_computes_by_hand(changes):
    dataset = z2r.load(z2r.MESSY)
    lengths = dataset.episodes.lengths
    assert changes["yaw-swap"].errors["ang_err"] == pytest.approx(1.5708, abs=1e-3)
    assert changes["first-shard-only"].picture == pytest.approx(lengths[5:].sum() / lengths.sum())
    assert changes["inclusive-end"].picture == pytest.approx(13 / (1108 + 13))
    assert changes["action-lag"].action == pytest.approx(1 - 14 / 1108)
    assert changes["wrong-fps"].speed == 3


def test_modes_about_files_are_dormant_where_there_is_one():
    changes = what_changes(z2r.MESSY, map(z2r.break_mode, CHANGED))
    assert {change.name for change in changes if change.is_dormant} == DORMANT_IN_ONE_FILE


def test_no_wrap_wakes_on_the_other_side_of_the_table(root, tmp_path):
    turned = Path(shutil.copytree(root, tmp_path / "turned"))
    turn_half(turned)
    [change] = what_changes(turned, [z2r.break_mode("no-wrap")])
    assert not change.is_dormant
    assert change.errors["ang_err"] > 6
    assert change.checks == ("yaw-error",)


def test_another_robot_is_refused(standin_copy):
    path = standin_copy / "meta/info.json"
    path.write_text(path.read_text().replace("tee_x", "cube_x"))
    with pytest.raises(ValueError, match="no tee_x, expected a reading that fits"):
        what_changes(standin_copy)


def test_every_mode_is_of_one_kind():
    assert sorted(name for names in KINDS.values() for name in names) == sorted(BREAK_MODES)


def test_the_figure_has_a_row_for_each_and_marks_what_changes(changes):
    axes = figures.what_changes(list(changes.values())).axes[0]
    rows = dict(zip((label.get_text() for label in axes.get_yticklabels()), axes.get_yticks().tolist(), strict=True))
    assert rows.keys() == changes.keys()
    marked = {(round(text.get_position()[1]), text.get_position()[0]) for text in axes.texts if text.get_bbox_patch()}
    columns = ("missing", "lengths", "reached", "pos_err", "ang_err", "picture", "action", "speed")
    expected = {(rows[name], columns.index(field)) for name, fields in CHANGED.items() for field in fields.split()}
    assert marked == expected
    heights = {text.get_text(): text.get_position()[1] for text in axes.texts}
    for kind, own in by_kind(changes.values()).items():
        assert [rows[change.name] - heights[kind] for change in own] == list(range(1, len(own) + 1))
    said = [text.get_text() for text in axes.texts]
    assert said.count("nothing to find here") == said.count("NONE") == 1
    with pytest.raises(ValueError, match="at least one"):
        figures.what_changes([])


@pytest.mark.parametrize("kind", KINDS)
def test_the_guide_has_a_row_for_each_of_its_kind_and_is_on_the_page(kind):
    _, _, *rows = guide(kind).splitlines()
    for row, name in zip(rows, KINDS[kind], strict=True):
        mode = BREAK_MODES[name]
        assert f"| `{name}` | {mode.assumption} | {mode.signature} |" in row
        assert (f"[met]({mode.seen_in})" in row) == bool(mode.seen_in)
        assert row.count("|") == 5  # a bar in the text would make a column
    pages = [shown(cell) for cell in code_cells(committed("09_field_guide"))]
    assert [("text/markdown", guide(kind)), ("text/plain", repr(guide(kind)))] in pages


@pytest.mark.parametrize("mode", [mode for mode in BREAK_MODES.values() if mode.seen_in])
def test_a_case_is_an_address(mode):
    assert mode.seen_in.startswith("https://github.com/")
