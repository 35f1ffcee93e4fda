"""Where outputs may go, and where not: never into a dataset, by whatever name; and never through a link out of one."""

import json
import os
import stat
from collections.abc import Callable
from pathlib import Path

import pytest
from click.testing import CliRunner
from damages import declare_video, fingerprint

import z2r
from z2r.cli import cli
from z2r.format.store import find, write

INFO = "meta/info.json"

# What each command writes, and the option that names it.
WRITERS: dict[str, tuple[list[str], str]] = {
    "metrics": (["inspect", "--no-rerun", "--out"], "metrics.json"),
    "replay": (["inspect", "--rerun", "--out"], "inspect.rrd"),
    "page": (["report", "--no-audit", "--out"], "page.html"),
    "kept": (["audit", "--keep"], "kept.json"),
    "draft": (["reading", "--out"], "draft.toml"),
}


def name_of(writer: str, folder: Path) -> tuple[list[str], Path]:
    """The command that writes into a folder, and the file that it writes."""
    args, name = WRITERS[writer]
    return [*args, str(folder if args[0] == "inspect" else folder / name)], folder / name


def in_itself(root: Path, out: Path) -> Path:
    return root / "meta" / out.name


def by_a_link(root: Path, out: Path) -> Path:
    out.symlink_to(root / INFO)
    return out


def by_a_link_to_nothing(root: Path, out: Path) -> Path:
    out.symlink_to(root / "meta/new")
    return out


def by_a_hard_link(root: Path, out: Path) -> Path:
    os.link(root / INFO, out)
    return out


def by_a_folder(root: Path, out: Path) -> Path:
    (out.parent / "folder").symlink_to(root / "meta")
    return out.parent / "folder" / out.name


def as_a_blob(root: Path, out: Path) -> Path:
    """In a cache of the hub, the files of a dataset are links."""
    blobs = root.parents[1] / "blobs"
    blobs.mkdir()
    (root / INFO).rename(blobs / out.name)
    (root / INFO).symlink_to(blobs / out.name)
    return blobs / out.name


@pytest.mark.parametrize("place", [in_itself, by_a_link, by_a_link_to_nothing, by_a_hard_link, by_a_folder, as_a_blob])
@pytest.mark.parametrize("writer", WRITERS)
def test_no_output_is_a_file_of_the_dataset(
    writer: str, place: Callable[[Path, Path], Path], standin_copy: Path, tmp_path: Path
) -> None:
    (tmp_path / "hub/snapshots").mkdir(parents=True)
    (tmp_path / "out").mkdir()
    root = standin_copy.rename(tmp_path / "hub/snapshots/standin")
    out = place(root, tmp_path / "out" / WRITERS[writer][1])
    args, out = name_of(writer, out.parent)
    before = fingerprint(root), (root / INFO).read_bytes()
    done = CliRunner().invoke(cli, [args[0], str(root), *args[1:]])
    assert done.exit_code
    assert "place in the dataset" in str(done.exception) or (writer == "draft" and "exists" in done.stderr)
    assert (fingerprint(root), (root / INFO).read_bytes()) == before
    assert not list(tmp_path.rglob("*.part"))


def test_the_functions_refuse_it_too(standin_copy: Path) -> None:
    before = fingerprint(standin_copy)
    for write_output in (z2r.write_report, z2r.write_replay):
        with pytest.raises(z2r.DatasetError, match="found a place in the dataset"):
            write_output(standin_copy, standin_copy / "meta/info.json")
    assert fingerprint(standin_copy) == before


def test_a_link_that_leads_elsewhere_stays_one(tmp_path: Path) -> None:
    (tmp_path / "link").symlink_to(tmp_path / "folder/file")
    write(tmp_path / "link", b"here")
    assert (tmp_path / "link").is_symlink()
    assert (tmp_path / "folder/file").read_bytes() == b"here"


def test_a_file_gets_the_rights_that_any_new_file_gets(tmp_path: Path) -> None:
    (tmp_path / "any").touch()
    write(tmp_path / "file", b"")
    assert stat.S_IMODE((tmp_path / "file").stat().st_mode) == stat.S_IMODE((tmp_path / "any").stat().st_mode)


@pytest.mark.parametrize("make", [Path.mkdir, os.mkfifo])
def test_what_is_no_file_is_left_alone(make: Callable[[Path], None], tmp_path: Path) -> None:
    make(tmp_path / "place")
    before = (tmp_path / "place").stat()
    with pytest.raises(z2r.DatasetError, match="found a folder, a pipe or a device"):
        write(tmp_path / "place", b"")
    assert (tmp_path / "place").stat() == before


def test_videos_that_are_elsewhere_are_not_looked_at(standin_copy: Path, tmp_path: Path) -> None:
    elsewhere = tmp_path / "elsewhere"
    elsewhere.mkdir()
    (elsewhere / "private.mp4").touch()
    (standin_copy / "videos").symlink_to(elsewhere)
    with pytest.raises(z2r.DatasetError, match="leads out of the dataset"):
        find(standin_copy, "videos", "**/*.mp4")
    said = json.dumps(z2r.audit(standin_copy).to_dict(""))
    assert "private" not in said
    assert "leads out of the dataset" in said
    declare_video(standin_copy)
    assert "private" not in json.dumps(z2r.audit(standin_copy).to_dict(""))
