import json

import pytest

import z2r
from z2r.format.schema import read_schema
from z2r.reading.reading import locate

NAMES = ["x", "y", "z"]


@pytest.mark.parametrize(
    ("names", "expected"),
    [
        (NAMES, tuple(NAMES)),
        ({"motors": NAMES}, tuple(NAMES)),
        (None, ()),
        (["x", "y"], ()),
        ({"a": ["x"], "b": ["y", "z"]}, tuple(NAMES)),
        ({"a": ["x", "y"], "b": ["x"]}, ("a.x", "y", "b.x")),
        ({"a": {"y": 1, "x": 0}, "b": ["z"]}, tuple(NAMES)),
        ({"z": 2, "x": 0, "y": 1}, tuple(NAMES)),
        ([["x"], ["y", "z"]], tuple(NAMES)),
        ([["x", "y", "z"]], tuple(NAMES)),
        ({"x": 0, "y": 2, "z": 3}, ()),
        ({"x": 0, "y": 1, "z": True}, ()),
        ({"x": 0, "y": 1}, ()),
        ({"a": ["x"], "b": ["y"]}, ()),
        ([["x"], ["y", 7]], ()),
        ([[[[[["x", "y", "z"]]]]]], ()),
        ([], ()),
        ({}, ()),
        ("xyz", ()),
        (3, ()),
    ],
)
def test_dimensions_have_names_only_where_there_is_one_for_each(names, expected):
    feature = z2r.Feature("float32", (3,), names)
    assert feature.dim_names == expected
    assert feature.labels == (expected or ("[0]", "[1]", "[2]"))


def test_groups_of_a_picture_name_its_axes_and_not_its_numbers():
    assert z2r.Feature("float32", (2, 2), {"rows": ["top", "bottom"], "columns": ["left", "right"]}).dim_names == ()


@pytest.mark.parametrize("names", [["x", "y", "x"], {"arm": ["x", "x"], "hand": ["y"]}, {"a": [["x"], ["x"], ["y"]]}])
def test_a_name_that_comes_twice_is_refused_and_the_others_are_found(names):
    feature = z2r.Feature("float32", (3,), names)
    schema = z2r.Schema("v3.0", 10, 1, 1, {"action": feature}, "")
    with pytest.raises(ValueError, match=r"action: 2 dimensions are called 'x', at \d, \d: name one by its place"):
        schema.columns("action", ["x"])
    assert schema.columns("action", ["y"]) == [feature.dim_names.index("y")]
    with pytest.raises(ValueError, match="2 dimensions are called 'x'"):
        locate("x", "action", schema)
    with pytest.raises(ValueError, match="2 dimensions are called 'x'"):
        locate("action/x", "observation.state", schema)
    assert locate("action/2", "observation.state", schema) == ("action", 2)


@pytest.mark.parametrize(
    ("dtype", "numeric"),
    [("float32", True), ("int64", True), ("bool", True), ("image", False), ("video", False), ("string", False)],
)
def test_pictures_and_text_are_not_numeric(dtype, numeric):
    assert z2r.Feature(dtype, (1,)).is_numeric is numeric


def test_columns_are_where_their_names_are_in_the_order_asked_for():
    schema = z2r.load(z2r.STANDIN).schema
    names = schema.features["observation.state"].dim_names
    found = schema.columns("observation.state", ["cos_tee_yaw", "pusher_x"])
    assert found == [names.index("cos_tee_yaw"), names.index("pusher_x")]


@pytest.mark.parametrize(
    ("feature", "name", "message"),
    [("observation", "tee_x", "observation.state, action"), ("action", "tee_x", "pusher_vx, pusher_vy")],
)
def test_a_name_that_is_not_there_is_answered_with_those_that_are(feature, name, message):
    with pytest.raises(ValueError, match=message):
        z2r.load(z2r.STANDIN).schema.columns(feature, [name])


def test_signals_are_numbers_that_are_neither_bookkeeping_nor_pictures(standin_copy):
    path = standin_copy / "meta/info.json"
    info = json.loads(path.read_text())
    info["features"] |= {
        "observation.camera": {"dtype": "video", "shape": [480, 640, 3], "names": ["h", "w", "c"]},
        "observation.depth": {"dtype": "float32", "shape": [480, 640], "names": None},
        "observation.gripper": {"dtype": "float32", "shape": [1], "names": None},
    }
    path.write_text(json.dumps(info))
    assert list(read_schema(standin_copy).signals()) == ["observation.state", "action", "observation.gripper"]
