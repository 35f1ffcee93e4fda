import json

import pytest

import z2r
from z2r.format.schema import read_schema

NAMES = ["x", "y", "z"]


@pytest.mark.parametrize(
    ("names", "expected"),
    [
        (NAMES, tuple(NAMES)),
        ({"motors": NAMES}, tuple(NAMES)),
        (None, ()),
        (["x", "y"], ()),
        ({"a": ["x"], "b": ["y", "z"]}, ()),
        ({"x": 0, "y": 1, "z": 2}, ()),
        ([["x"], ["y"], ["z"]], ()),
        ("xyz", ()),
        (3, ()),
    ],
)
def test_dimensions_have_names_only_where_there_is_one_for_each(names, expected):
    assert z2r.Feature("float32", (3,), names).dim_names == expected


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
