"""Copies that are laid out anew say what the original says, and a damage is what its name says."""

import hashlib
import shutil
from pathlib import Path

import numpy as np
import pytest
from damages import wrong_in
from test_dataset import oracle

import z2r
from z2r.course.cameras import picture
from z2r.course.damage import record_badly, split, turn_half
from z2r.format.schema import ACTION, STATE

FEATURES = (STATE, ACTION)


def checks(root: Path) -> set[str]:
    return {finding.check for finding in wrong_in(z2r.audit(root))}


def fingerprint(root: Path) -> dict[str, str]:
    files = (path for path in root.rglob("*") if path.is_file())
    return {str(path.relative_to(root)): hashlib.sha256(path.read_bytes()).hexdigest() for path in files}


@pytest.fixture
def copy(tmp_path: Path) -> Path:
    return Path(shutil.copytree(z2r.MESSY, tmp_path / "copy"))


@pytest.mark.parametrize("root", [z2r.STANDIN, z2r.MESSY])
@pytest.mark.parametrize("episodes_per_file", [1, 5, 100])
def test_a_split_copy_says_what_the_original_says(root, episodes_per_file, tmp_path):
    before = fingerprint(root)
    right, copied = z2r.load(root), z2r.load(split(root, tmp_path / "copy", episodes_per_file))
    assert fingerprint(root) == before
    assert copied.episodes.to_index.tolist() == right.episodes.to_index.tolist()
    for feature in FEATURES:
        np.testing.assert_array_equal(copied.read(feature), right.read(feature))
    assert len(copied.files) == -(-len(right.episodes) // episodes_per_file)
    assert len(list((copied.root / "meta/episodes").rglob("*.parquet"))) == 3


def test_only_the_names_of_its_files_are_a_hazard(tmp_path):
    assert checks(split(z2r.MESSY, tmp_path / "one")) == {"file-order"}
    assert not checks(split(z2r.MESSY, tmp_path / "five", episodes_per_file=5))  # fewer than ten files


def test_what_is_split_can_be_split_again(tmp_path):
    twice = split(split(z2r.MESSY, tmp_path / "once"), tmp_path / "twice", episodes_per_file=2)
    np.testing.assert_array_equal(z2r.load(twice).read(STATE), z2r.load(z2r.MESSY).read(STATE))
    assert not checks(twice)


def test_lerobot_reads_the_same_values_where_names_sort_like_numbers(tmp_path):
    other = oracle(split(z2r.MESSY, tmp_path / "copy", episodes_per_file=2))
    right = z2r.load(z2r.MESSY)
    assert list(other.meta.episodes["dataset_to_index"]) == right.episodes.to_index.tolist()
    for frame in (0, 85, 500, 1107):
        np.testing.assert_array_equal(other[frame]["observation.state"].numpy(), right.read(STATE)[frame])


def test_lerobot_mixes_up_the_frames_where_they_do_not(tmp_path):
    """What the page says of it: LeRobot 0.6.1 sorts data files by name."""
    root = split(z2r.MESSY, tmp_path / "copy")
    other, dataset = oracle(root), z2r.load(root)
    believed = z2r.break_mode("name-sorted-files").dataset(dataset)
    first_of_third = int(dataset.episodes.from_index[2])
    frame = other[first_of_third]
    assert frame["episode_index"] == 10
    np.testing.assert_array_equal(frame["observation.state"].numpy(), believed.read(STATE)[first_of_third])


def test_nothing_is_overwritten(tmp_path, copy):
    before = fingerprint(copy)
    with pytest.raises(FileExistsError):
        split(z2r.MESSY, copy)
    with pytest.raises(ValueError, match="outside"):
        split(copy, copy / "inside")
    with pytest.raises(ValueError, match="1 or more"):
        split(copy, tmp_path / "other", episodes_per_file=0)
    assert fingerprint(copy) == before


def test_half_a_turn_changes_every_sign_and_nothing_else(copy):
    right = z2r.inspect_dataset(z2r.load(copy)).outcome
    turn_half(copy)
    dataset = z2r.load(copy)
    for feature in FEATURES:
        np.testing.assert_array_equal(dataset.read(feature), -z2r.load(z2r.MESSY).read(feature))
    turned = z2r.inspect_dataset(dataset).outcome
    np.testing.assert_allclose(turned.final_errors["pos_err"], right.final_errors["pos_err"], atol=1e-9)
    np.testing.assert_allclose(turned.final_errors["ang_err"], right.final_errors["ang_err"], atol=1e-6)
    assert not checks(copy)


def test_an_error_that_is_not_wrapped_shows_after_half_a_turn(copy):
    turn_half(copy)
    audit = z2r.audit(copy, z2r.break_mode("no-wrap"))
    assert "yaw-error" in {finding.check for finding in audit.findings}


def test_a_bad_recording_of_an_arm_has_its_three_faults_and_statistics_that_agree(tmp_path):
    before = fingerprint(z2r.ARM)
    bad, arm = z2r.load(record_badly(z2r.ARM, tmp_path / "bad")), z2r.load(z2r.ARM)
    state = arm.read(STATE)
    state[:, 2] = np.deg2rad(state[:, 2])
    np.testing.assert_array_equal(bad.read(STATE), state)
    for episode in range(len(arm.episodes)):
        told, late = (each.read(ACTION)[each.episodes[episode]] for each in (arm, bad))
        np.testing.assert_array_equal(late, np.concatenate([np.repeat(told[:1], 5, axis=0), told[:-5]]))
    pictures = camera_pictures(bad)
    assert pictures["observation.images.side"].max() < 20 < pictures["observation.images.front"].max()
    found = wrong_in(z2r.audit(bad.root, pictures=True))
    named = {finding.check for finding in found if finding.severity != "note"}
    assert named == {"late", "unit", "follow", "camera-flat"}
    assert fingerprint(z2r.ARM) == before
    once = fingerprint(bad.root)
    assert fingerprint(record_badly(z2r.ARM, bad.root)) == once


def camera_pictures(dataset: z2r.Dataset) -> dict[str, np.ndarray]:
    return {name: picture(dataset, name, 1880) for name in dataset.schema.features if "images" in name}


def test_a_bad_recording_replaces_nothing_but_a_dataset(tmp_path):
    (tmp_path / "mine").mkdir()
    (tmp_path / "mine" / "thesis.txt").write_text("years of work")
    with pytest.raises(z2r.DatasetError):
        record_badly(z2r.ARM, tmp_path / "mine")
    assert (tmp_path / "mine" / "thesis.txt").exists()
