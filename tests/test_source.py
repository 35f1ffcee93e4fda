"""Source on the page is that of the package, whatever the package is."""

import hashlib
import inspect

import pytest

import z2r
from z2r.course.source import show_source
from z2r.errors import printable


@pytest.mark.parametrize("thing", [z2r.decode_yaw, z2r.frame_errors, z2r.episode_reached, z2r.EpisodeIndex, z2r.load])
def test_source_is_the_packages_own_and_carries_its_fingerprint(thing):
    source = show_source(thing)
    whole = inspect.getsource(thing)
    assert set(source.splitlines()) <= {*whole.splitlines()}
    assert source.fingerprint.endswith(f"{thing.__qualname__} · {hashlib.sha256(whole.encode()).hexdigest()[:8]}…")
    assert source in source._repr_markdown_()
    assert source.fingerprint in source._repr_markdown_()


def test_the_docstring_is_left_out_and_the_code_is_whole():
    source = show_source(z2r.decode_yaw)
    assert '"""' not in source
    assert source.startswith("def decode_yaw(")
    assert source.splitlines()[-1] == inspect.getsource(z2r.decode_yaw).splitlines()[-1]


def test_a_function_without_a_docstring_is_shown_as_it_is():
    assert show_source(z2r.DatasetError.__init__) == inspect.getsource(z2r.DatasetError.__init__).rstrip()


def test_a_raw_docstring_leaves_nothing_behind():
    source = show_source(printable)
    assert source.splitlines() == [line for line in inspect.getsource(printable).splitlines() if is_code(line)]


def is_code(line: str) -> bool:
    return line.startswith("def ") or line.strip().startswith("return ")


def test_the_docstring_of_a_class_is_left_out_and_its_methods_stay():
    source = show_source(z2r.DatasetError)
    assert source.splitlines()[:2] == [
        "class DatasetError(Exception):",
        "    def __init__(self, fault: Fault) -> None:",
    ]
