"""An older dataset is met with the command that converts it where it is, and pushes nothing."""

import argparse
import ast
import importlib.util
import shlex
import sys
from pathlib import Path

import pytest
from damages import edit_info

import z2r
from z2r.format.schema import CONVERTER, conversion


def advice(root: Path, version: str) -> str:
    edit_info(root, codebase_version=version)
    with pytest.raises(z2r.DatasetError) as caught:
        z2r.load(root)
    return caught.value.fault.mend


def test_the_converter_of_lerobot_takes_the_command_that_is_given(monkeypatch):
    """What it runs as a script is run here, but for the conversion itself: importing all of it takes seconds."""
    if importlib.util.find_spec("lerobot") is None:
        pytest.skip("no lerobot")
    source = Path(importlib.util.find_spec(CONVERTER).origin).read_text()
    [script] = [node for node in ast.parse(source).body if isinstance(node, ast.If) and "__main__" in ast.unparse(node)]
    command = shlex.split(conversion(Path("/somewhere/my data")))
    assert command[:3] == ["python", "-m", CONVERTER]
    monkeypatch.setattr(sys, "argv", command[2:])
    asked = {}
    names = {
        "argparse": argparse,
        "init_logging": lambda: None,
        "convert_dataset": lambda **options: asked.update(options),
    }
    exec(compile(ast.Module(script.body, []), CONVERTER, "exec"), names)
    assert asked["root"] == "/somewhere/my data"
    assert asked["push_to_hub"] is False


def test_of_v2_1_the_command_names_the_folder_in_full(standin_copy, monkeypatch):
    monkeypatch.chdir(standin_copy)
    assert advice(Path(), "v2.1") == f"Convert it; the old one is kept as standin_old: {conversion(standin_copy)}"


def test_what_the_converter_would_put_in_the_place_of_the_dataset_is_to_be_moved_away_first(standin_copy):
    (standin_copy.parent / "standin_old").mkdir()
    assert advice(standin_copy, "v2.1").startswith(f"Move {standin_copy}_old away")


def test_a_dataset_in_the_cache_is_copied_before_it_is_converted(standin_copy, tmp_path):
    snapshot = tmp_path / "datasets--user--name/snapshots/0123abcd"
    snapshot.parent.mkdir(parents=True)
    standin_copy.rename(snapshot)
    assert advice(snapshot, "v2.1").startswith("Copy it out of the cache (cp -rL)")


def test_of_v2_0_it_is_said_that_no_converter_does_it_here(standin_copy):
    said = advice(standin_copy, "v2.0")
    assert "LeRobot 0.6.1 converts from v2.1 only" in said
    assert "--push-to-hub=false" not in said


def test_of_what_nobody_converts_nothing_is_advised(standin_copy):
    assert advice(standin_copy, "v1.6") == advice(standin_copy, "v4.0") == ""
