"""What does the owner of an SO-101 hear of a black camera, an elbow in radians, and commands five frames late?

Each is planted in `arm` alone, and all of them together; each must be named, with the joint or the camera and its size.
"""

import json
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from arm_cameras import harm
from damages import DATA, edit_column

import z2r
from z2r.audits.findings import Finding

README = Path(__file__).parents[1] / "README.md"

ELBOW, LATE = 2, 5  # which joint, and how many frames


def black(root: Path) -> None:
    harm("black", "all", root)


def elbow_in_radians(root: Path) -> None:
    """The follower's elbow is measured in radians, and commanded in degrees."""

    def convert(rows: list) -> list:
        state = np.array(rows)
        state[:, ELBOW] = np.deg2rad(state[:, ELBOW])
        return state.tolist()

    edit_column(root, DATA, "observation.state", convert)


def late(root: Path) -> None:
    """Each command is stored five frames after it was sent."""
    numbers = z2r.load(root).episodes

    def shift(rows: list) -> list:
        action = np.array(rows)
        for start, stop in zip(numbers.from_index, numbers.to_index, strict=True):
            action[start:stop] = action[np.maximum(np.arange(start, stop) - LATE, start)]
        return action.tolist()

    edit_column(root, DATA, "action", shift)


def forget_statistics(root: Path) -> None:
    """As recorded, they would be those of the data: none of them may give a fault away."""
    for name in ("observation.state", "action"):
        values = z2r.load(root).read(name).astype(np.float64)
        stats = json.loads((root / "meta/stats.json").read_text())
        stats[name] |= {"min": values.min(0).tolist(), "max": values.max(0).tolist()}
        stats[name] |= {"mean": values.mean(0).tolist(), "std": values.std(0).tolist()}
        (root / "meta/stats.json").write_text(json.dumps(stats))


FAULTS: dict[str, tuple[Callable[[Path], None], tuple[str, ...]]] = {
    "black": (black, ("observation.images.side", "black")),
    "elbow": (elbow_in_radians, ("elbow_flex.pos", "degrees for radians")),
    "late": (late, ("action", "before it")),
}


def found_in(root: Path) -> list[Finding]:
    forget_statistics(root)
    return [each for each in z2r.audit(root, pictures=True).findings if each.severity != "note"]


def said_of(root: Path) -> list[str]:
    return [str(each) for each in found_in(root)]


def test_the_readme_says_what_the_audit_says(tmp_path):
    root = Path(shutil.copytree(z2r.ARM, tmp_path / "arm"))
    for plant, _ in FAULTS.values():
        plant(root)
    readme = README.read_text(encoding="utf-8")
    shown = [each for each in found_in(root) if f"{each.severity}  {each.check}  " in readme]
    assert {each.check for each in shown} == {"late", "unit", "camera-flat"}
    assert all(f"found {each.found}\n" in readme and f"expected {each.expected}\n" in readme for each in shown)


@pytest.mark.parametrize("names", [*([name] for name in FAULTS), [*FAULTS]], ids="+".join)
def test_each_fault_of_an_owners_arm_is_named(names, tmp_path):
    root = Path(shutil.copytree(z2r.ARM, tmp_path / "arm"))
    for name in names:
        FAULTS[name][0](root)
    said = said_of(root)
    for name in names:
        assert any(all(word in each for word in FAULTS[name][1]) for each in said), (name, said)


def test_nothing_is_wrong_with_the_arm_itself(tmp_path):
    assert not said_of(Path(shutil.copytree(z2r.ARM, tmp_path / "arm")))
