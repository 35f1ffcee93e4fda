"""A dataset is found by its folder or its name; where it is not, a name that is nearly the same is offered."""

import os
import shutil
from pathlib import Path

import msgspec
import pytest
from test_cli import run

import z2r
from z2r.data import find_dataset
from z2r.show.listing import list_datasets

VARIABLES = ("HF_HOME", "HF_LEROBOT_HOME", "HF_HUB_CACHE", "HUGGINGFACE_HUB_CACHE", "XDG_CACHE_HOME")


@pytest.fixture(autouse=True)
def home(tmp_path_factory, monkeypatch) -> Path:
    """A home without anything in a cache."""
    home = tmp_path_factory.mktemp("home")
    for name in VARIABLES:
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setenv("HOME", str(home))
    return home


def put(folder: Path) -> Path:
    return Path(shutil.copytree(z2r.STANDIN, folder))


def put_snapshot(cache: Path, name: str, revision: str, changed: float = 0) -> Path:
    folder = put(cache / f"datasets--{name.replace('/', '--')}/snapshots/{revision}")
    os.utime(folder, (changed, changed))
    return folder


def test_a_name_that_ships_is_found_and_a_folder_of_that_name_goes_first(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert find_dataset(None) == find_dataset("standin") == z2r.STANDIN
    assert find_dataset("messy") == z2r.MESSY
    (tmp_path / "messy").mkdir()
    assert find_dataset("messy").resolve() == tmp_path / "messy"


@pytest.mark.parametrize(
    ("name", "offered"),
    [("standing", "standin"), ("mesy", "messy"), ("my_datset", "my_dataset"), ("there/my_dat", "there/my_data")],
)
def test_a_misspelt_name_offers_the_near_ones(name, offered, tmp_path, monkeypatch):
    (tmp_path / "my_dataset").mkdir()
    (tmp_path / "there/my_data").mkdir(parents=True)
    monkeypatch.chdir(tmp_path)
    with pytest.raises(z2r.DatasetError, match=rf"found no such folder, .*\. Did you mean {offered}\?$"):
        find_dataset(name)


@pytest.mark.parametrize("name", ["qqqq", "no/such/parent", "../qqqq/zzzz", "no.such/pa..rent", "-a/b", "a/-b"])
def test_a_name_that_is_like_no_other_offers_nothing(name, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(z2r.DatasetError, match=r"standin or messy or arm$") as caught:
        find_dataset(name)
    assert caught.value.fault.mend == ""


def test_a_name_of_the_hub_that_is_nowhere_is_said_to_be_and_how_to_get_it(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    with pytest.raises(z2r.DatasetError) as caught:
        z2r.load("someone/standing")
    assert caught.value.fault.mend == "To get it: hf download someone/standing --repo-type dataset"
    assert "no such dataset in a cache" in str(caught.value)


@pytest.mark.parametrize(
    ("variables", "cache"),
    [
        ({}, ".cache/huggingface/lerobot"),
        ({"XDG_CACHE_HOME": "xdg"}, "xdg/huggingface/lerobot"),
        ({"HF_HOME": "hf"}, "hf/lerobot"),
        ({"HF_HOME": "hf", "HF_LEROBOT_HOME": "~/own"}, "own"),
    ],
)
def test_lerobots_cache_is_where_its_variables_say(variables, cache, home, monkeypatch):
    for name, value in variables.items():
        monkeypatch.setenv(name, value if value.startswith("~") else str(home / value))
    folder = put(home / cache / "user/name")
    snapshot = put_snapshot(home / cache / "hub", "user/other", "0123")
    assert find_dataset("user/name") == folder
    assert find_dataset("user/other") == snapshot
    assert repr(z2r.load("user/other")) == "Dataset(user/other: 6 episodes, 427 frames)"


@pytest.mark.parametrize(
    ("variables", "cache"),
    [
        ({}, ".cache/huggingface/hub"),
        ({"HF_HOME": "hf"}, "hf/hub"),
        ({"HF_HOME": "hf", "HUGGINGFACE_HUB_CACHE": "old"}, "old"),
        ({"HUGGINGFACE_HUB_CACHE": "old", "HF_HUB_CACHE": "new"}, "new"),
    ],
)
def test_the_hubs_cache_is_where_its_variables_say(variables, cache, home, monkeypatch):
    for name, value in variables.items():
        monkeypatch.setenv(name, str(home / value))
    snapshot = put_snapshot(home / cache, "user/name", "0123")
    assert find_dataset("user/name") == snapshot


def test_of_snapshots_the_one_that_main_means_goes_first_and_then_the_newest(home):
    cache = home / ".cache/huggingface/hub"
    old, new = (put_snapshot(cache, "user/name", revision, time) for revision, time in (("b", 100), ("a", 200)))
    assert find_dataset("user/name") == new
    main = cache / "datasets--user--name/refs/main"
    main.parent.mkdir()
    main.write_text("b\n")
    assert find_dataset("user/name") == old
    for elsewhere in ("gone", "../../../..", "\x00"):
        main.write_text(elsewhere)
        assert find_dataset("user/name") == new


def test_a_folder_goes_before_a_cache_and_lerobots_before_the_hubs(home, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    put_snapshot(home / ".cache/huggingface/hub", "user/name", "0123")
    own = put(home / ".cache/huggingface/lerobot/user/name")
    assert find_dataset("user/name") == own
    put(tmp_path / "user/name")
    assert find_dataset("user/name") == Path("user/name")


def test_the_links_of_a_snapshot_may_lead_to_its_blobs_and_nowhere_else(home):
    snapshot = put_snapshot(home / ".cache/huggingface/hub", "user/name", "0123")
    blobs = snapshot.parents[1] / "blobs"
    blobs.mkdir()
    info = snapshot / "meta/info.json"
    info.rename(blobs / "1")
    info.symlink_to("../../../blobs/1")
    assert len(z2r.load("user/name").episodes) == 6
    (blobs / "1").rename(home / "info.json")
    info.unlink()
    info.symlink_to(home / "info.json")
    with pytest.raises(z2r.DatasetError, match="leads out of the dataset"):
        z2r.load("user/name")


def test_a_misspelt_name_of_a_cached_dataset_offers_it(home):
    put(home / ".cache/huggingface/lerobot/user/pick_place")
    with pytest.raises(z2r.DatasetError, match=r"Did you mean user/pick_place\?$"):
        find_dataset("user/pick_plase")


@pytest.mark.parametrize("inner", ["meta", "data", "videos", "meta/info.json", "data/chunk-000", "meta/tasks.parquet"])
def test_a_path_into_a_dataset_means_the_dataset(inner, tmp_path, monkeypatch):
    root = put(tmp_path / "data")  # a folder of this name is no part of a dataset by itself
    (root / "videos").mkdir()
    assert find_dataset(root) == find_dataset(root / inner) == root
    monkeypatch.chdir(tmp_path)
    assert find_dataset(Path("data") / inner) == Path("data")
    if (root / inner).is_dir():
        monkeypatch.chdir(root / inner)
        assert find_dataset(".") == root


def test_a_folder_beside_the_parts_of_a_dataset_means_itself(tmp_path):
    root = put(tmp_path / "mine")
    (root / "notes").mkdir()
    assert find_dataset(root / "notes") == root / "notes"


def test_all_that_is_there_is_listed_with_what_it_says_of_itself(home, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    put(tmp_path / "here")
    put(tmp_path / "broken")
    (tmp_path / "broken/meta/info.json").write_text("{")
    (tmp_path / "no_dataset").mkdir()
    put(home / ".cache/huggingface/lerobot/user/name")
    put_snapshot(home / ".cache/huggingface/hub", "other/name", "0123")
    (home / ".cache/huggingface/hub/datasets--no--dataset/snapshots/0123").mkdir(parents=True)
    put(home / ".cache/huggingface/hub/models--no--dataset/snapshots/0123")
    found = {each.name: each for each in list_datasets(Path())}
    assert list(found) == ["standin", "messy", "arm", "broken", "here", "user/name", "other/name"]
    assert [each.where for each in found.values()] == ["ships", "ships", "ships", "here", "here", "LeRobot", "hub"]
    assert (found["here"].n_episodes, found["here"].n_frames, found["here"].fps) == (6, 427, 10)
    assert found["here"].robot_type == "pusht"
    assert found["broken"].n_episodes is None
    assert found["broken"].fault.startswith("meta/info.json: found broken JSON")
    for name in set(found) - {"broken"}:
        assert find_dataset(name).samefile(found[name].path)


def test_the_command_lists_them_for_people_and_for_scripts(tmp_path):
    put(tmp_path / "here")
    path = tmp_path / "here/meta/info.json"
    camera = {"observation.images.top": {"dtype": "video", "shape": [8, 8, 3], "names": None}}
    info = msgspec.json.decode(path.read_bytes())
    path.write_bytes(msgspec.json.encode(info | {"features": info["features"] | camera, "robot_type": "[b]\x1b[2J"}))
    put(tmp_path / "broken")
    (tmp_path / "broken/meta/info.json").write_text("{")
    said = run("ls", cwd=tmp_path)
    assert (said.returncode, said.stderr) == (0, "")
    [line] = [line.split() for line in said.stdout.splitlines() if line.startswith("here ")]
    assert line == ["here", "here", "6", "427", "10", "[b]\\x1b[2J", "top"]
    assert "broken: meta/info.json: found broken JSON" in said.stdout
    listed = msgspec.json.decode(run("ls", "--json", cwd=tmp_path).stdout)
    assert [each["name"] for each in listed] == ["standin", "messy", "arm", "broken", "here"]
    assert listed[4]["cameras"] == ["observation.images.top"]
    assert set(listed[3]) == set(listed[4])


def test_a_command_takes_what_is_listed_and_calls_it_by_its_name(tmp_path, home):
    put_snapshot(home / ".cache/huggingface/hub", "user/name", "0123")
    said = run("inspect", "user/name", "--no-rerun", cwd=tmp_path)
    assert said.returncode == 0
    assert "user/name  6 episodes" in said.stdout
    assert msgspec.json.decode((tmp_path / "z2r-out/metrics.json").read_bytes())["source"] == "user/name"
