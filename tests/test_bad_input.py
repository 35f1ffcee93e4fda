"""Every fault is one DatasetError that names the place, and no run writes to a dataset."""

import os
import shutil
from collections.abc import Callable
from pathlib import Path

import pytest
from damages import BASES, DAMAGES, DATA, ON_DATA, ON_VALUES, edit_info, fingerprint, make

import z2r
from z2r.api import choose_reading, scene_of
from z2r.audits.both import inspect_and_audit
from z2r.errors import DatasetError
from z2r.format.schema import data_file_path, read_schema
from z2r.format.store import all_inside, inside

FAULTS = {kind: damage for kind, damage in DAMAGES.items() if damage.reader is not None}


def read_all(root: Path) -> None:
    z2r.inspect_dataset(z2r.load(root))


@pytest.mark.parametrize("kind", FAULTS)
def test_a_fault_is_named(kind, tmp_path):
    damage, root = FAULTS[kind], tmp_path / "dataset"
    make(kind, root)
    before = fingerprint(tmp_path)
    with pytest.raises(z2r.DatasetError) as caught:
        read_all(root)
    file = damage.file if damage.reader_file is None else damage.reader_file
    assert str(caught.value.fault.path).startswith(str(root / file))
    assert damage.reader in str(caught.value)
    assert "\n" not in str(caught.value)
    assert fingerprint(tmp_path) == before


def said_of(dataset: z2r.Dataset, *, in_one_pass: bool) -> tuple[object, ...] | str:
    """Say what inspection and audit find, or at what they stop."""
    reading = choose_reading(dataset.schema)
    try:
        if in_one_pass:
            inspection, audit = inspect_and_audit(dataset, reading, scene_of(reading), keep=60)
        else:
            inspection, audit = z2r.inspect_dataset(dataset, keep=60), z2r.audit(dataset)
    except z2r.DatasetError as error:
        return str(error)
    kept = {name: values.tolist() for name, values in inspection.kept.items()}
    return inspection.metrics("", None), kept, audit.to_dict("")


@pytest.mark.parametrize("kind", ON_DATA | ON_VALUES)
def test_one_pass_for_the_report_says_what_each_says_alone(kind, tmp_path):
    make(kind, tmp_path / "dataset")
    try:
        dataset = z2r.load(tmp_path / "dataset")
    except z2r.DatasetError:
        return  # before any pass
    assert said_of(dataset, in_one_pass=True) == said_of(dataset, in_one_pass=False)


@pytest.mark.parametrize("change", ["whole", "first", "joints-exchanged", "drop-boundaries"])
def test_one_pass_inspects_what_it_is_given(change, tmp_path):
    BASES["split"](tmp_path / "dataset")
    dataset = z2r.load(tmp_path / "dataset")
    if change == "first":
        dataset = dataset.first(5)
    elif change != "whole":
        dataset = z2r.break_mode(change).dataset(dataset)
    assert said_of(dataset, in_one_pass=True) == said_of(dataset, in_one_pass=False)


@pytest.mark.parametrize("kind", sorted(DAMAGES.keys() - FAULTS.keys()))
def test_what_does_not_stop_the_reader_is_left_to_the_audit(kind, tmp_path):
    make(kind, tmp_path / "dataset")
    read_all(tmp_path / "dataset")


def test_an_undamaged_copy_has_no_fault(standin_copy):
    read_all(standin_copy)


def test_a_name_from_a_dataset_cannot_steer_the_terminal(standin_copy):
    edit_info(standin_copy, features={"\x1b[2J\nname": {"shape": [1]}})
    with pytest.raises(z2r.DatasetError) as caught:
        read_all(standin_copy)
    assert str(caught.value).isprintable()


def test_links_of_the_hugging_face_cache_are_followed(standin_copy, tmp_path):
    repository = tmp_path / "datasets--someone--pusht"
    (repository / "blobs").mkdir(parents=True)
    snapshot = shutil.copytree(standin_copy, repository / "snapshots/0123abcd")
    for number, path in enumerate(sorted(path for path in snapshot.rglob("*") if path.is_file())):
        blob = path.rename(repository / f"blobs/{number}")
        path.symlink_to(blob)
    read_all(snapshot)


def test_a_link_within_the_dataset_is_followed(standin_copy):
    (standin_copy / DATA).rename(standin_copy / "frames.parquet")
    (standin_copy / DATA).symlink_to(standin_copy / "frames.parquet")
    read_all(standin_copy)


def test_a_linked_dataset_folder_is_followed(standin_copy, tmp_path):
    (tmp_path / "link").symlink_to(standin_copy)
    read_all(tmp_path / "link")


def test_an_unpadded_template_is_fine(standin_copy):
    (standin_copy / DATA).rename(standin_copy / "data/0-0.parquet")
    edit_info(standin_copy, data_path="data/{chunk_index}-{file_index:d}.parquet")
    read_all(standin_copy)
    assert data_file_path(read_schema(standin_copy), 3, 14) == Path("data/3-14.parquet")


@pytest.mark.parametrize("place", ["dataset", "snapshots/dataset"])
def test_many_paths_are_inside_where_each_is(place, tmp_path):
    root, beside = tmp_path / place, tmp_path / "beside"
    for folder in (root / "own", beside, tmp_path / "blobs"):
        folder.mkdir(parents=True)
        (folder / "file").touch()
    (root / "in").symlink_to(root / "own")
    (root / "out").symlink_to(beside)
    (root / "own/out").symlink_to(beside / "file")
    (root / "own/in").symlink_to(root / "own/file")
    (root / "own/blob").symlink_to(tmp_path / "blobs/file")
    (root / "own/round").symlink_to(root / "own/round")
    (beside / "back").symlink_to(root / "own/file")
    os.mkfifo(root / "own/pipe")
    names = ["file", "out", "in", "blob", "round", "back", "pipe", "missing", "../file", "nul\0"]

    def said(paths: Callable[[], object]) -> object:
        try:
            return paths()
        except DatasetError as error:
            return error.fault

    for relative in (Path(folder, name) for folder in ("own", "in", "out", "no", "..") for name in names):
        each = said(lambda relative=relative: inside(root, relative))
        assert said(lambda relative=relative: all_inside(root, [relative])[0]) == each
        assert said(lambda relative=relative: all_inside(root, [Path("own/file"), relative])[1]) == each
