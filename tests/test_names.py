"""Names of dimensions in all the shapes that people write are shown everywhere, and the audit has no complaint."""

import pytest
from damages import edit_feature
from test_about import printed
from test_replay import read_rows
from test_report import write

import z2r
from z2r.show.replay import write_replay

STATE, SIZE = "observation.state", 10
PLAIN = [f"joint_{number}" for number in range(SIZE)]
SHAPES = {
    "a list": PLAIN,
    "a list in a group": {"motors": PLAIN},
    "places": {name: PLAIN.index(name) for name in reversed(PLAIN)},
    "groups": {"arm": PLAIN[:7], "hand": PLAIN[7:]},
    "a list in a list": [PLAIN[:9], PLAIN[9:]],
}
TWO_ARMS = {"left": ["x", "y", "z", "grip", "lift"], "right": ["x", "y", "z", "grip", "tilt"]}
TWO_ARMS_NAMES = [*(f"left.{name}" for name in ("x", "y", "z", "grip")), "lift"]
TWO_ARMS_NAMES += [*(f"right.{name}" for name in ("x", "y", "z", "grip")), "tilt"]


def info_findings(root):
    return [finding for finding in z2r.audit(root).findings if finding.check == "info"]


@pytest.mark.parametrize(
    ("names", "expected"), [*((names, PLAIN) for names in SHAPES.values()), (TWO_ARMS, TWO_ARMS_NAMES), (None, None)]
)
def test_they_are_shown_in_the_terminal_on_the_page_and_in_the_recording(names, expected, standin_copy, tmp_path):
    edit_feature(standin_copy, STATE, names=names)
    expected = expected or [f"[{place}]" for place in range(SIZE)]
    assert not info_findings(standin_copy)
    inspection = z2r.inspect_dataset(standin_copy, keep=100)
    rows = [line.split() for line in printed(inspection).splitlines()]
    assert [row[-3] for row in rows if len(row) in (3, 5) and row[-3] in expected] == expected
    page = write(inspection.dataset, tmp_path)
    assert all(f"<tr><td>{name} <span>" in page for name in expected)
    write_replay(inspection, tmp_path / "a.rrd")
    [(_, shown)] = read_rows(tmp_path / "a.rrd", "frame")["/observation/state", "SeriesLines:names"]
    assert shown == expected


@pytest.mark.parametrize(
    ("names", "found"),
    [
        ({name: place + 1 for place, name in enumerate(PLAIN)}, "joint_0"),
        ({"arm": PLAIN[:7]}, "7 names"),
        ({"arm": PLAIN[:7], "hand": [*PLAIN[:3], "more"]}, "11 names"),
        ([PLAIN[:7], [7, 8, 9]], "joint_0"),
        ({}, "0 names"),
        (7, "7"),
        ({"arm": PLAIN[:9] + PLAIN[:1]}, "joint_0 twice"),
    ],
)
def test_the_audit_names_what_names_nothing(names, found, standin_copy):
    edit_feature(standin_copy, STATE, names=names)
    [finding] = [each for each in info_findings(standin_copy) if each.field == f"features.{STATE}.names"]
    assert found in finding.found
    assert finding.severity == "warning"


def test_a_reading_that_needs_a_name_which_comes_twice_is_told_so(standin_copy, tmp_path):
    edit_feature(standin_copy, STATE, names=[*z2r.load(z2r.STANDIN).schema.features[STATE].dim_names[:9], "tee_x"])
    inspection = z2r.inspect_dataset(standin_copy)
    assert inspection.outcome is None
    assert "tee_x (twice there, so unclear)" in printed(inspection)
    assert "tee_x (twice there, so unclear)" in write(inspection.dataset, tmp_path)
