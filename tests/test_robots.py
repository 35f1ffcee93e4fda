"""Other robots: a hand and an arm with readings of their own are summed up, shown, drawn and read wrong like PushT."""

import re
from html.parser import HTMLParser
from io import BytesIO
from pathlib import Path

import numpy as np
import pytest
import rerun as rr
from damages import wrong_in
from robots import ARM_REACHED, HAND_REACHED, JOINTS, write_arm, write_hand
from test_replay import read_layout, read_rows, values
from test_report import answers

import z2r
from z2r.course import field_guide, figures

PUSHT_WORDS = re.compile(r"pusher|\btee\b|pusht|\bblock\b|\bpos_err\b|\bang_err\b", re.IGNORECASE)
ROBOTS = {"hand": (write_hand, HAND_REACHED), "arm": (write_arm, ARM_REACHED)}
WRITTEN = ["hand", "arm"]

type Robot = tuple[z2r.Dataset, z2r.Reading]


@pytest.fixture(scope="module")
def robots(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Robot]:
    return {name: write(tmp_path_factory.mktemp(name)) for name, (write, _) in ROBOTS.items()}


@pytest.fixture(scope="module")
def hand(robots) -> Robot:
    return robots["hand"]


@pytest.fixture(scope="module")
def arm(robots) -> Robot:
    return robots["arm"]


def decoded(robot: Robot, reading: z2r.Reading | None = None) -> z2r.Decoded:
    dataset, right = robot
    return z2r.decode({name: dataset.read(name) for name in dataset.schema.signals()}, reading or right, dataset.schema)


class _Said(HTMLParser):
    """What a reader of a page is told: its text and its attributes, and the data of its script; no code, no style."""

    def __init__(self, page: str) -> None:
        super().__init__()
        self.said: list[str] = []
        self._skip = False
        self.feed(page)

    def handle_starttag(self, tag, attrs):
        given = dict(attrs)
        self._skip = tag == "style" or (tag == "script" and "type" not in given)
        self.said += [f"{given[name]}" for name in given if name not in ("content", "d", "points")]

    def handle_endtag(self, tag):
        self._skip = False

    def handle_data(self, data):
        if not self._skip:
            self.said.append(re.sub(r'"(frames|held)":"[^"]*"', "", data))


def write_page(robot: Robot, path: Path) -> str:
    z2r.write_report(robot[0], path, robot[1])
    return path.read_text()


@pytest.mark.parametrize("name", WRITTEN)
def test_a_reading_that_ships_is_taken_only_where_its_columns_are_those_of_the_robot(name, robots):
    dataset, _ = robots[name]
    inspection = z2r.inspect_dataset(dataset)
    assert inspection.outcome is None
    assert (inspection.reading and inspection.reading.name) == {"arm": "so101"}.get(name)


@pytest.mark.parametrize("name", WRITTEN)
def test_as_many_are_reached_as_the_recording_made(name, robots):
    dataset, reading = robots[name]
    inspection = z2r.inspect_dataset(dataset, reading=reading)
    assert inspection.outcome.reached.tolist() == list(ROBOTS[name][1])
    metrics = inspection.metrics(name, None)
    assert metrics["reached"] == list(ROBOTS[name][1])
    assert metrics["reading"] == reading.name
    assert {f"final_{goal.name}" for goal in reading.goal} <= set(metrics)
    assert metrics["final_pos_err"] is metrics["final_ang_err"] is None


@pytest.mark.parametrize("name", WRITTEN)
def test_the_page_and_the_panel_tell_the_same_and_nothing_of_another_task(name, robots, tmp_path):
    page = write_page(robots[name], tmp_path / "page.html")
    expected = f"{sum(ROBOTS[name][1])} of {len(ROBOTS[name][1])}"
    assert answers(page)["right"][0] == expected
    assert expected in z2r.panel(*robots[name]).title
    said = "\n".join(_Said(page).said)
    assert robots[name][0].schema.features["action"].dim_names[0] in said
    assert not PUSHT_WORDS.findall(said)


def test_a_page_has_no_room_for_what_a_reading_lacks(arm, tmp_path):
    page = write_page(arm, tmp_path / "page.html")
    assert 'id="scene"' not in page
    assert set(answers(page)) == {"right", "drop-boundaries"}
    assert z2r.panel(*arm).picture == b""


def test_a_hand_that_is_not_stored_as_sine_and_cosine_cannot_be_swapped(hand, tmp_path):
    page = write_page(hand, tmp_path / "page.html")
    assert set(answers(page)) == {"right", "yaw-swap-everywhere", "drop-boundaries"}
    wrong = z2r.inspect_dataset(hand[0], z2r.break_mode("yaw-swap-everywhere"), hand[1])
    assert answers(page)["yaw-swap-everywhere"][0] == wrong.outcome.tally


def test_the_recording_of_the_hand_is_what_its_columns_say(hand, tmp_path):
    dataset, reading = hand
    z2r.write_replay(dataset, tmp_path / "hand.rrd", reading)
    rows, state = read_rows(tmp_path / "hand.rrd", "frame"), dataset.read("observation.state").astype(float)
    assert {entity for entity, _ in rows if entity.startswith("/world")} == {
        "/world/robot/hand",
        "/world/objects/spot",
        "/world/paths/hand",
    }
    for entity, x, turn in (
        ("world/robot/hand", 0, np.deg2rad(state[:, 2])),
        ("world/objects/spot", 3, np.arctan2(state[:, 5], state[:, 6])),
    ):
        place = values(rows, entity, "Transform3D:translation").reshape(-1, 3)
        np.testing.assert_allclose(place, np.column_stack([state[:, x : x + 2], 0 * turn]), atol=1e-6)
        *_, z, w = values(rows, entity, "Transform3D:quaternion").reshape(-1, 4).T
        np.testing.assert_allclose(np.exp(2j * np.arctan2(z, w)), np.exp(1j * turn), atol=1e-6)
    errors = z2r.frame_errors(decoded(hand))
    for name in ("miss", "slant"):
        np.testing.assert_allclose(values(rows, f"eval/{name}", "Scalars:scalars")[:, 0], errors[name])
    strips = [strip for time, [strip] in rows["/world/paths/hand", "LineStrips3D:strips"] if time is not None]
    assert [len(strip) for strip in strips] == dataset.episodes.lengths.tolist()


def test_the_recording_of_the_arm_shows_its_joints_and_its_goal(arm, tmp_path):
    dataset, reading = arm
    z2r.write_replay(dataset, tmp_path / "arm.rrd", reading)
    rows, state = read_rows(tmp_path / "arm.rrd", "frame"), dataset.read("observation.state")
    np.testing.assert_allclose(values(rows, "observation/state", "Scalars:scalars"), state)
    np.testing.assert_allclose(values(rows, "eval/grip", "Scalars:scalars")[:, 0], state[:, 5])
    assert rows["/observation/state", "SeriesLines:names"][0][1] == list(JOINTS)
    assert [value for _, value in rows["/eval/grip/at_most", "Scalars:scalars"]] == [[20], [20]]
    assert not [entity for entity, _ in rows if entity.startswith("/world")]


@pytest.mark.parametrize("name", WRITTEN)
def test_a_recording_speaks_of_no_other_task(name, robots, tmp_path):
    dataset, reading = robots[name]
    z2r.write_replay(dataset, tmp_path / f"{name}.rrd", reading)
    assert not PUSHT_WORDS.findall(" ".join(entity for entity, _ in read_rows(tmp_path / f"{name}.rrd", "frame")))
    layout = read_layout(tmp_path / f"{name}.rrd")
    assert f"reached where {reading.goal[0].says(reading.unit(reading.goal[0]))}" in layout
    assert not PUSHT_WORDS.findall(layout)
    assert not PUSHT_WORDS.findall((tmp_path / f"{name}.rrd").read_bytes().decode("latin-1"))


def drawn_text(figure) -> str:
    """Draw a figure, and return all that is written in it."""
    figure.savefig(BytesIO())
    texts = [text.get_text() for axes in figure.axes for text in axes.texts]
    titles = [axes.get_title(loc="left") + axes.get_xlabel() + axes.get_ylabel() for axes in figure.axes]
    return "\n".join(texts + titles)


def gids(figure) -> set[str]:
    return {f"{artist.get_gid()}" for axes in figure.axes for artist in axes.get_children() if artist.get_gid()}


def test_the_figures_of_the_hand_speak_of_the_hand(hand):
    dataset, reading = hand
    first = decoded(hand).take(dataset.episodes[0])
    wrong = decoded(hand, z2r.break_mode("yaw-swap-everywhere").reading(reading)).take(dataset.episodes[0])
    drawn = [
        figures.episode_path(first),
        figures.right_and_wrong(first, wrong),
        figures.final_poses(dataset, reading),
        figures.error_traces(z2r.frame_errors(first), reading, dataset.schema.fps),
    ]
    assert not PUSHT_WORDS.findall("\n".join(drawn_text(figure) for figure in drawn))
    assert {"hand path", "hand start", "hand end", "spot"} <= gids(drawn[0])
    [path] = [line for line in drawn[0].axes[0].lines if line.get_gid() == "hand path"]
    np.testing.assert_array_equal(path.get_xydata(), np.stack([first.pose("hand").x, first.pose("hand").y], axis=1))
    assert "spot: atan2(spot.cos, spot.sin)" in drawn_text(drawn[1])
    assert "hand: " not in drawn_text(drawn[1])
    assert "7 episodes: 4 reached, 3 not reached" in drawn_text(drawn[2])
    assert {"miss", "slant"} <= gids(drawn[3])


def test_the_trace_of_the_arm_has_its_limit(arm):
    dataset, reading = arm
    figure = figures.error_traces(z2r.frame_errors(decoded(arm).take(dataset.episodes[0])), reading, 10)
    assert "at most 20 percent" in drawn_text(figure)
    [band] = [artist for artist in figure.axes[0].get_children() if artist.get_gid() == "tolerance"]
    assert (band.get_y(), band.get_y() + band.get_height()) == (0, 20)
    with pytest.raises(ValueError, match="0 poses"):
        figures.episode_path(decoded(arm))
    with pytest.raises(ValueError, match="between two poses"):
        figures.final_poses(dataset, reading)


def test_where_the_first_frame_decides_the_trace_marks_it(hand):
    dataset, reading = hand
    first = z2r.break_mode("first-frame-for-last").reading(reading)
    errors = z2r.frame_errors(decoded(hand, first).take(dataset.episodes[0]))
    figure = figures.error_traces(errors, first, 10)
    [dot] = [line for line in figure.axes[0].lines if line.get_gid() == "first frame"]
    assert dot.get_xydata().tolist() == [[0, errors["miss"][0]]]
    assert "last stored frame" not in drawn_text(figure)


@pytest.mark.parametrize("name", WRITTEN)
def test_an_audit_finds_nothing_and_says_what_it_left_out(name, robots):
    dataset, reading = robots[name]
    audit = z2r.audit(dataset, reading=reading)
    assert not wrong_in(audit)
    assert any("the reading has no scene" in line for line in audit.not_checked)
    assert not {"pusher", "block", "tee", "pusht"} & set(re.findall(r"\w+", " ".join(audit.not_checked).lower()))


@pytest.mark.parametrize("name", WRITTEN)
def test_the_field_guide_says_what_each_mistake_changes(name, robots):
    dataset, reading = robots[name]
    modes = z2r.BREAK_MODES.values()
    changes = {change.name: change for change in field_guide.what_changes(dataset.root, modes, reading)}
    for mode in z2r.BREAK_MODES.values():
        found = z2r.inspect_dataset(dataset, mode, reading)
        assert changes[mode.name].n_reached == found.outcome.n_reached
        if not mode.applies_to(dataset, reading):
            assert changes[mode.name].is_dormant
        elif mode.misread(dataset.schema, reading):
            assert not changes[mode.name].is_dormant
    assert set(changes["wrong-fps"].errors) == {goal.name for goal in reading.goal}
    assert changes["stale-file-pointer"].missing == 1
    assert changes["action-lag"].action > 0.8
    assert figures.what_changes(list(changes.values())).axes[0].get_yticklabels()[0].get_text() == "yaw-swap"


def test_a_body_that_can_turn_points_ahead_in_the_recording(hand, tmp_path):
    dataset, reading = hand
    z2r.write_replay(dataset, tmp_path / "hand.rrd", reading)
    rows = read_rows(tmp_path / "hand.rrd", "frame")
    for entity in ("/world/robot/hand", "/world/objects/spot"):
        [(time, [[x, y, z]])] = rows[entity, "Arrows3D:vectors"]
        assert (time, y, z) == (None, 0, 0)
        assert x > 0


def test_names_with_slashes_and_spaces_are_one_part_of_an_entity(hand, tmp_path, capfd):
    dataset, _ = hand
    text = (Path(dataset.root).parent / "reading.toml").read_text()
    text = text.replace("poses.spot", 'poses."hand/its goal"').replace('"spot"', '"hand/its goal"')
    (tmp_path / "odd.toml").write_text(text.replace('"miss"', '"how far/<b>$x"'))
    odd = z2r.read_reading(tmp_path / "odd.toml")
    z2r.write_replay(dataset, tmp_path / "odd.rrd", odd)
    assert "WARN" not in capfd.readouterr().err
    rows = read_rows(tmp_path / "odd.rrd", "frame")
    assert (r"/world/objects/hand\/its\ goal", "Transform3D:translation") in rows
    entity = f"/eval/{rr.escape_entity_path_part('how far/<b>$x')}"
    assert rows[entity, "SeriesLines:names"] == [(None, ["how far/<b>$x [m]"])]
    page = write_page((dataset, odd), tmp_path / "page.html")
    assert "<b>$x" not in page
    figures.error_traces(z2r.frame_errors(decoded(hand, odd).take(dataset.episodes[0])), odd, 10).savefig(BytesIO())


GOALS = {
    "at most": ({"at_most": -3}, (None, -3)),
    "at most 0": ({"at_most": 0}, (None, 0)),
    "at least": ({"at_least": -5}, (-5, None)),
    "between": ({"at_most": 2, "at_least": 1}, (1, 2)),
    "within": ({"within": 3}, (-3, 3)),
    "within and at least": ({"within": 3, "at_least": 1}, (1, 3)),
}


@pytest.mark.parametrize("goal", GOALS)
def test_the_band_of_a_trace_is_where_the_goal_holds(goal):
    limits, (low, high) = GOALS[goal]
    reading = z2r.Reading(goal=(z2r.Goal(name="g", value="x", **limits),))
    numbers = np.linspace(-4, 4, 801)
    axes = figures.error_traces({"g": numbers}, reading, 10).axes[0]
    [band] = [artist for artist in axes.get_children() if artist.get_gid() == "tolerance"]
    bottom, top = axes.get_ylim()
    assert bottom <= -4 < 4 <= top
    assert band.get_y() == pytest.approx(bottom if low is None else max(low, bottom))
    assert band.get_y() + band.get_height() == pytest.approx(top if high is None else high)
    inside = (numbers > band.get_y() + 1e-9) & (numbers < band.get_y() + band.get_height() - 1e-9)
    assert reading.goal[0].holds(numbers)[inside].all()
