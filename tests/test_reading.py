"""What a reading says: as a file, as an object, and of frames; against oracles that know nothing of it."""

import pickle
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from hypothesis import given
from hypothesis import strategies as st
from robots import write_arm, write_hand

import z2r
from z2r import BREAK_MODES, PUSHT, Goal, PoseColumns, Reading, Schema, YawColumns
from z2r.course.damage import split
from z2r.reading.poses import QuaternionColumns
from z2r.reading.reading import ActionMeaning, ColumnMeaning, locate
from z2r.show.page.content import WRONG_READINGS, side_by_side, wrong_view

SHIPPED = {"standin": z2r.STANDIN, "messy": z2r.MESSY}


def schema_of(**features: list[str] | int) -> Schema:
    """A schema with features of these dimensions: their names, or how many without names."""
    kinds = {
        name.replace("__", "."): z2r.Feature("float32", (dims if isinstance(dims, int) else len(dims),), dims)
        for name, dims in features.items()
    }
    return Schema("v3.0", 10, 1, 1, kinds, "")


# What ships, against the rules of PushT written out


@pytest.mark.parametrize("name", SHIPPED)
def test_pusht_is_its_rules_bit_for_bit_on_every_frame(name):
    dataset = z2r.load(SHIPPED[name])
    state = dataset.read("observation.state").astype(np.float64)
    _, _, x, y, sin, cos, target_x, target_y, target_sin, target_cos = state.T
    pos_err = np.hypot(x - target_x, y - target_y)
    turn = np.arctan2(sin, cos) - np.arctan2(target_sin, target_cos)
    turn = np.mod(turn + np.pi, 2 * np.pi) - np.pi
    ang_err = np.abs(np.where(turn >= np.pi, -np.pi, turn))
    decoded = z2r.decode(dataset.read("observation.state"), PUSHT, dataset.schema)
    found = z2r.frame_errors(decoded)
    assert found["pos_err"].tobytes() == pos_err.tobytes()
    assert found["ang_err"].tobytes() == ang_err.tobytes()
    fine = (pos_err < 0.03) & (ang_err < 0.2)
    assert 0 < fine.sum() < len(fine)
    np.testing.assert_array_equal(z2r.in_tolerance(found, PUSHT), fine)
    reached = [bool(fine[dataset.episodes[episode]][-1]) for episode in range(len(dataset.episodes))]
    assert z2r.inspect_dataset(dataset).outcome.reached.tolist() == reached


def test_a_tolerance_is_not_within_itself():
    goal = Goal(name="x", value="x", within=0.03)
    numbers = np.array([0.03, np.nextafter(0.03, 0), -0.03, np.nextafter(-0.03, 0), np.nan, np.inf])
    assert goal.holds(numbers).tolist() == [False, True, False, True, False, False]


# File and object


PUSHT_IN_PYTHON = Reading(
    name="pusht",
    scene="pusht",
    poses={
        "pusher": PoseColumns("pusher_x", "pusher_y"),
        "tee": PoseColumns("tee_x", "tee_y", yaw=YawColumns(sin="sin_tee_yaw", cos="cos_tee_yaw")),
        "target": PoseColumns("target_x", "target_y", yaw=YawColumns(sin="sin_target_yaw", cos="cos_target_yaw")),
    },
    columns={f"action/pusher_v{axis}": ColumnMeaning(unit="m/s", low=-1, high=1) for axis in "xy"},
    goal=(
        Goal(name="pos_err", distance=("tee", "target"), within=0.03),
        Goal(name="ang_err", turn=("tee", "target"), within=0.2),
    ),
    action=ActionMeaning(drives="velocity", columns=("pusher_vx", "pusher_vy"), of=("pusher_x", "pusher_y")),
)


def test_the_file_that_ships_is_the_object_written_in_python():
    assert PUSHT == PUSHT_IN_PYTHON
    assert z2r.find_reading("pusht") is PUSHT
    assert z2r.read_reading(Path(z2r.__file__).parent / "pusht/pusht.toml") == PUSHT


def test_a_reading_is_called_as_its_file_unless_it_says_otherwise(tmp_path):
    (tmp_path / "mine.toml").write_text("decisive = 'first'")
    assert z2r.read_reading(tmp_path / "mine.toml") == Reading(name="mine", decisive="first")


@pytest.mark.parametrize("value", [PUSHT, *BREAK_MODES.values()], ids=lambda value: value.name)
def test_readings_and_break_modes_survive_pickling(value):
    again = pickle.loads(pickle.dumps(value))
    assert again == value
    assert repr(again) == repr(value)


def test_frames_that_were_read_survive_pickling():
    dataset = z2r.load(z2r.STANDIN)
    frames = {name: dataset.read(name)[:5] for name in dataset.schema.signals()}
    decoded = z2r.decode(frames, PUSHT, dataset.schema)
    again = pickle.loads(pickle.dumps(decoded))
    assert again.reading == PUSHT
    assert list(again.columns) == list(decoded.columns)
    for name, values in decoded.columns.items():
        np.testing.assert_array_equal(again.columns[name], values)
    np.testing.assert_array_equal(again.action, decoded.action)


# Errors in a file


POSE = '[poses.cup]\nx = "x"\ny = "y"\n'
CASES = {
    "unknown key": ("feeture = 'a'", ["feeture", "Did you mean feature?", "poses", "decisive"]),
    "unknown key of a pose": (f"{POSE}yow = 3", ["poses.cup.yow", "Did you mean yaw?", "quaternion"]),
    "unknown key of a yaw": (f"{POSE}yaw = {{ degrees = 'a' }}", ["poses.cup.yaw.degrees", "sin, cos, rad, deg"]),
    "unknown key of a quaternion": (f"{POSE}quaternion = {{ xyz = [] }}", ["poses.cup.quaternion.xyz", "xyzw, wxyz"]),
    "unknown key of a goal": (
        "[[goal]]\nname = 'a'\nvalue = 'x'\nwithn = 3",
        ["goal[0].withn", "Did you mean within?", "at_most"],
    ),
    "unknown key of a column": ("[columns]\na = { units = 'm' }", ["columns.a.units", "Did you mean unit?", "low"]),
    "unknown key of an action": (
        "[action]\ndrive = 'x'",
        ["action.drive", "Did you mean drives?", "columns, of, lag"],
    ),
    "wrong type": ("feature = 3", ["feature", "int", "str"]),
    "wrong type of a pose": (f"{POSE}z = 3", ["poses.cup.z", "int", "str"]),
    "wrong type of all poses": ("poses = 3", ["poses", "int", "object"]),
    "wrong type of a limit": ("[[goal]]\nname = 'a'\nvalue = 'x'\nwithin = 'b'", ["goal[0].within", "str", "float"]),
    "three for a pair": ("[[goal]]\nname = 'a'\nturn = ['a', 'b', 'c']\nwithin = 1", ["goal[0].turn", "length"]),
    "no choice": ("decisive = 'middle'", ["decisive", "'middle'", "first, last"]),
    "no choice of an action": (
        "[action]\ndrives = 'torque'\ncolumns = []\nof = []",
        ["action.drives", "'torque'", "velocity, position, delta"],
    ),
    "missing x": ("[poses.cup]\ny = 'y'", ["poses.cup", "no x", "x, y, z, yaw"]),
    "missing name": ("[[goal]]\nvalue = 'x'\nwithin = 1", ["goal[0]", "no name"]),
    "two kinds of goal": (
        "[[goal]]\nname = 'a'\nvalue = 'x'\nstored = 'y'\nwithin = 1",
        ["goal[0]", "value and stored", "distance, turn, value, stored"],
    ),
    "no kind of goal": ("[[goal]]\nname = 'a'\nwithin = 1", ["goal[0]", "distance, turn, value, stored"]),
    "no limit": ("[[goal]]\nname = 'a'\nvalue = 'x'", ["goal[0]", "no limit", "within, at_most, at_least"]),
    "second goal": ("[[goal]]\nname = 'a'\nstored = 'x'\n[[goal]]\nname = 'b'\nvalue = 'x'", ["goal[1]", "no limit"]),
    "two goals of one name": ("[[goal]]\nname = 'a'\nstored = 'x'\n" * 2, ["two goals of one name", "a, a"]),
    "unknown pose": (
        f"{POSE}[[goal]]\nname = 'a'\ndistance = ['cup', 'mug']\nwithin = 1",
        ["mug", "goal a", "a pose: cup"],
    ),
    "pose that cannot turn": (
        f"{POSE}[[goal]]\nname = 'a'\nturn = ['cup', 'cup']\nwithin = 1",
        ["cup", "goal a", "pose that can turn: there is none"],
    ),
    "sine alone": (f"{POSE}yaw = {{ sin = 'a' }}", ["poses.cup.yaw", "found sin", "sin and cos, or rad, or deg"]),
    "two yaws": (f"{POSE}yaw = {{ rad = 'a', deg = 'b' }}", ["poses.cup.yaw", "rad and deg", "or deg"]),
    "quaternion without an order": (f"{POSE}quaternion = {{}}", ["poses.cup.quaternion", "no order", "wxyz"]),
    "quaternion with two": (
        f"{POSE}quaternion = {{ xyzw = ['a', 'b', 'c', 'd'], wxyz = ['a', 'b', 'c', 'd'] }}",
        ["poses.cup.quaternion", "or two", "xyzw"],
    ),
    "yaw and quaternion": (
        f"{POSE}yaw = {{ rad = 'a' }}\nquaternion = {{ xyzw = ['a', 'b', 'c', 'd'] }}",
        ["poses.cup", "yaw and quaternion", "one of them at most"],
    ),
    "more columns than driven": (
        "[action]\ndrives = 'position'\ncolumns = ['a']\nof = []",
        ["action", "1 columns that drive 0"],
    ),
    "broken": ("feature = ", ["no TOML"]),
    "no text": ("\udcff", ["no TOML"]),
    "too large": ("#" * 2_000_000, ["at most 1048576"]),
}


@pytest.mark.parametrize("case", CASES)
def test_a_mistake_in_a_file_is_named_in_one_line(case, tmp_path):
    content, expected = CASES[case]
    path = tmp_path / "mine.toml"
    path.write_bytes(content.encode(errors="surrogateescape"))
    with pytest.raises(z2r.DatasetError) as error:
        z2r.find_reading(path)
    said = str(error.value)
    assert said.startswith(f"{path}: ")
    assert "\n" not in said
    assert [part for part in expected if part not in said] == [], said
    assert str(pickle.loads(pickle.dumps(error.value))) == said


@pytest.mark.parametrize("name", ["nowhere.toml", "puscht"])
def test_a_file_that_is_missing_is_named(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(z2r.DatasetError, match=rf"^{name}: found no such file"):
        z2r.find_reading(name)


def test_a_scene_that_is_unknown_or_lacks_a_pose_is_named(tmp_path):
    path = tmp_path / "mine.toml"
    for content, expected in (("scene = 'kitchen'", "scene: found .*'kitchen'.* pusht"), ("scene = 'pusht'", "tee")):
        path.write_text(content)
        with pytest.raises(z2r.DatasetError, match=expected):
            z2r.find_reading(path)


# Where a column stands


WHERE = schema_of(
    observation__state=["shoulder_pan.pos", "arm/joint", "3"],
    action=["shoulder_pan.pos", "action/joint"],
    observation__force=4,
    next__success=1,
)


@pytest.mark.parametrize(
    ("name", "place"),
    [
        ("shoulder_pan.pos", ("observation.state", 0)),
        ("arm/joint", ("observation.state", 1)),
        ("3", ("observation.state", 2)),
        ("observation.state/arm/joint", ("observation.state", 1)),
        ("observation.state/2", ("observation.state", 2)),
        ("action/shoulder_pan.pos", ("action", 0)),
        ("action/1", ("action", 1)),
        ("observation.force/3", ("observation.force", 3)),
        ("observation.force/4", None),
        ("observation.force/-1", None),
        ("observation.force/³", None),
        ("observation.force/99999999999999999999", None),
        ("next.success", ("next.success", 0)),
        ("next.success/0", ("next.success", 0)),
        ("observation.force", None),
        ("nothing/0", None),
    ],
)
def test_a_column_is_found_by_name_or_by_number(name, place):
    if place:
        assert locate(name, "observation.state", WHERE) == place
        return
    with pytest.raises(ValueError, match="no dimension") as error:
        locate(name, "observation.state", WHERE)
    assert "\n" not in str(error.value)


def test_what_is_not_there_is_answered_with_what_is():
    with pytest.raises(ValueError, match=r"no dimension 'x' in observation.state: shoulder_pan.pos, arm/joint, 3"):
        locate("x", "observation.state", WHERE)
    with pytest.raises(ValueError, match=r"no dimension 'action/x' in action: shoulder_pan.pos"):
        locate("action/x", "observation.state", WHERE)
    with pytest.raises(ValueError, match=r"no dimension 'observation.force/9'.*its dimensions have no names"):
        locate("observation.force/9", "observation.state", WHERE)
    with pytest.raises(ValueError, match=r"no feature 'observation.pose' of numbers among observation.state, action"):
        locate("x", "observation.pose", WHERE)


# Orientations and distances, against rotation matrices


angles = st.floats(-10, 10)
units = st.tuples(*[st.floats(-1, 1)] * 4).filter(lambda four: np.linalg.norm(four) > 0.1)


def matrix(x: float, y: float, z: float, w: float) -> np.ndarray:
    """The rotation of a quaternion, (3, 3)."""
    x, y, z, w = np.array([x, y, z, w]) / np.linalg.norm([x, y, z, w])
    return np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )


def angle_between(one: np.ndarray, other: np.ndarray) -> float:
    """The angle of the rotation that leads from one to the other: sine from its axis, cosine from its trace."""
    turn = one.T @ other
    axis = np.array([turn[2, 1] - turn[1, 2], turn[0, 2] - turn[2, 0], turn[1, 0] - turn[0, 1]]) / 2
    return float(np.arctan2(np.linalg.norm(axis), (np.trace(turn) - 1) / 2))


def turn_error(columns: dict[str, float], one: dict[str, object], other: dict[str, object]) -> float:
    place = {"x": "zero", "y": "zero"}
    reading = Reading(
        name="test",
        poses={"one": PoseColumns(**place, **one), "other": PoseColumns(**place, **other)},
        goal=(Goal(name="turn", turn=("one", "other"), within=1),),
    )
    columns = {"zero": 0.0} | columns
    schema = schema_of(observation__state=list(columns))
    return float(z2r.frame_errors(z2r.decode(np.array([list(columns.values())]), reading, schema))["turn"][0])


def about_z(angle: float) -> np.ndarray:
    return np.array([[np.cos(angle), -np.sin(angle), 0], [np.sin(angle), np.cos(angle), 0], [0, 0, 1]])


@given(one=angles, other=angles)
def test_a_turn_is_the_same_however_it_is_stored(one, other):
    expected = angle_between(about_z(one), about_z(other))
    stored = {
        "rad": lambda name, a: ({name: a}, {"yaw": YawColumns(rad=name)}),
        "deg": lambda name, a: ({name: np.rad2deg(a)}, {"yaw": YawColumns(deg=name)}),
        "sin, cos": lambda name, a: (
            {f"{name} sin": np.sin(a), f"{name} cos": np.cos(a)},
            {"yaw": YawColumns(sin=f"{name} sin", cos=f"{name} cos")},
        ),
    }
    for first in stored.values():
        for second in stored.values():  # two bodies need not be stored alike
            (columns, pose), (others, other_pose) = first("one", one), second("other", other)
            assert turn_error(columns | others, pose, other_pose) == pytest.approx(expected, abs=1e-6)
    quaternions = (0, 0, np.sin(one / 2), np.cos(one / 2)), (0, 0, np.sin(other / 2), np.cos(other / 2))
    assert turn_in_space(*quaternions, "xyzw") == pytest.approx(expected, abs=1e-6)
    assert turn_in_space(*quaternions, "wxyz") == pytest.approx(expected, abs=1e-6)


def turn_in_space(one: tuple[float, ...], other: tuple[float, ...], order: str) -> float:
    """The error between two quaternions x, y, z, w, stored in an order."""
    columns = {
        f"{name}_{axis}": each["xyzw".index(axis)]
        for name, each in zip("ab", (one, other), strict=True)
        for axis in order
    }
    poses = [{"quaternion": QuaternionColumns(**{order: tuple(f"{name}_{axis}" for axis in order)})} for name in "ab"]
    return turn_error(columns, *poses)


@given(one=units, other=units, order=st.sampled_from(["xyzw", "wxyz"]))
def test_a_turn_in_space_is_that_of_the_rotation_between(one, other, order):
    expected = angle_between(matrix(*one), matrix(*other))
    assert turn_in_space(one, other, order) == pytest.approx(expected, abs=1e-6)
    assert turn_in_space(one, tuple(-np.array(other)), order) == pytest.approx(expected, abs=1e-6)
    assert 0 <= turn_in_space(one, other, order) <= np.pi + 1e-12


@given(one=st.tuples(*[st.floats(-5, 5)] * 3), other=st.tuples(*[st.floats(-5, 5)] * 3), flat=st.booleans())
def test_a_distance_is_measured_in_space_where_both_have_a_height(one, other, flat):
    reading = Reading(
        poses={"one": PoseColumns("x", "y", "z"), "other": PoseColumns("u", "v", None if flat else "w")},
        goal=(Goal(name="d", distance=("one", "other"), within=1),),
    )
    decoded = z2r.decode(np.array([[*one, *other]]), reading, schema_of(observation__state=list("xyzuvw")))
    difference = np.subtract(one, other)[: 2 if flat else 3]
    assert z2r.frame_errors(decoded)["d"] == pytest.approx(np.linalg.norm(difference))


# Goals on values


def reached(numbers: list[float], decisive: str = "last", **goal: object) -> bool:
    reading = Reading(goal=(Goal(name="goal", **goal),), decisive=decisive)
    values = np.array(numbers)[:, None]
    features = {"observation.state": values, "next.success": values}
    schema = schema_of(observation__state=["x"], next__success=1)
    return z2r.episode_reached(z2r.decode(features, reading, schema))


@given(numbers=st.lists(st.floats(-3, 3), min_size=1), limit=st.floats(-3, 3))
def test_the_frame_that_decides_is_held_against_the_limit(numbers, limit):
    for decisive, number in (("last", numbers[-1]), ("first", numbers[0])):
        assert reached(numbers, decisive, value="x", at_most=limit) == (number <= limit)
        assert reached(numbers, decisive, value="x", at_least=limit) == (number >= limit)
        assert reached(numbers, decisive, value="x", within=limit) == (abs(number) < limit)
        assert reached(numbers, decisive, stored="next.success") == (number > 0)
        between = {"at_least": limit, "at_most": limit + 1}
        assert reached(numbers, decisive, value="x", **between) == (limit <= number <= limit + 1)


@pytest.mark.parametrize(
    "goal",
    [
        {"value": "x", "within": 1},
        {"value": "x", "at_most": 1},
        {"value": "x", "at_least": 1},
        {"stored": "next.success"},
    ],
)
def test_what_is_no_number_is_never_reached(goal):
    assert not reached([np.nan], **goal)


# Wrong readings of the page, from the frames that an inspection keeps


@pytest.fixture(scope="module", params=["standin", "messy", "many files", "hand", "arm"])
def dataset_and_reading(request, tmp_path_factory) -> tuple[z2r.Dataset, Reading]:
    folder = tmp_path_factory.mktemp(request.param.replace(" ", "-"))
    if request.param in SHIPPED:
        return z2r.load(SHIPPED[request.param]), PUSHT
    if request.param == "many files":
        return z2r.load(split(z2r.MESSY, folder / "split")), PUSHT
    return {"hand": write_hand, "arm": write_arm}[request.param](folder)


@pytest.mark.parametrize("mode", list(BREAK_MODES.values()), ids=lambda mode: mode.name)
def test_a_page_reads_wrong_as_an_inspection_does(mode, dataset_and_reading):
    dataset, reading = dataset_and_reading
    packed = replace(dataset, episodes=side_by_side(dataset.episodes))
    if mode.misread(dataset.schema, reading):
        assert mode.name not in WRONG_READINGS
        with pytest.raises(ValueError, match="numbers as they are"):
            wrong_view(z2r.inspect_dataset(dataset, reading=reading), packed, mode)
        return
    expected = z2r.inspect_dataset(dataset, mode, reading)
    inspection = z2r.inspect_dataset(dataset, reading=reading)
    if mode.name == "name-sorted-files" and len(dataset.files) > 9:
        assert mode.name not in WRONG_READINGS  # any frame may decide then, and but the ends of episodes are kept
        with pytest.raises(ValueError, match="files in their order"):
            wrong_view(inspection, packed, mode)
        return
    found = wrong_view(inspection, packed, mode)
    assert found.outcome.reached.tolist() == expected.outcome.reached.tolist()
    assert list(found.outcome.final_errors) == list(expected.outcome.final_errors)
    for name, errors in expected.outcome.final_errors.items():
        np.testing.assert_array_equal(found.outcome.final_errors[name], errors)
    assert found.episodes.lengths.tolist() == expected.episodes.lengths.tolist()


# How often a file is opened


@pytest.mark.parametrize(
    "work",
    [
        lambda dataset, out: z2r.inspect_dataset(dataset, keep=10**6),
        lambda dataset, out: z2r.write_report(dataset, out / "page.html"),
        lambda dataset, out: z2r.write_report(dataset, out / "page.html", with_audit=False),
        lambda dataset, out: z2r.audit(dataset),
        lambda dataset, out: z2r.write_replay(dataset, out / "x.rrd"),
        lambda dataset, out: z2r.panel(dataset),
    ],
    ids=["inspect", "report", "report without audit", "audit", "replay", "panel"],
)
def test_each_data_file_is_opened_once(work: Callable[[z2r.Dataset, Path], object], tmp_path, monkeypatch):
    dataset = z2r.load(split(z2r.MESSY, tmp_path / "split"))
    opened: list[str] = []

    def memory_map(path: str, *args: object) -> pa.NativeFile:
        opened.append(path)
        return map_file(path, *args)

    map_file = pa.memory_map
    monkeypatch.setattr(pa, "memory_map", memory_map)
    work(dataset, tmp_path)
    data = [path for path in opened if "meta" not in Path(path).parts]
    assert sorted(data) == sorted(f"{file.path}" for file in dataset.files)
    assert len(dataset.files) == 14
