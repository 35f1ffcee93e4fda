"""Source on the page is that of the package, whatever the package is."""

import hashlib
import inspect
from pathlib import Path

import pytest

import z2r
from z2r.course import source as sources
from z2r.course.source import colophon, show_source
from z2r.errors import printable

ROOT = Path(z2r.__file__).parents[1]


THINGS = (z2r.decode_yaw, z2r.frame_errors, z2r.episode_reached, z2r.EpisodeIndex, z2r.load)


@pytest.mark.parametrize("thing", THINGS)
def test_source_is_the_packages_own_and_says_where_it_is(thing):
    source = show_source(thing)
    assert set(source.splitlines()) <= {*inspect.getsource(thing).splitlines()}
    assert (ROOT / source.file).name == Path(inspect.getfile(inspect.unwrap(thing))).name
    assert source in source._repr_markdown_()
    assert source.file in source._repr_markdown_()


def test_the_colophon_has_the_lines_and_the_fingerprint_of_all_that_was_shown_once(monkeypatch):
    monkeypatch.setattr(sources, "_shown", {})
    for thing in (*THINGS, *THINGS):
        show_source(thing)
    places = colophon()
    assert [place.name for place in places] == [thing.__qualname__ for thing in THINGS]
    for place, thing in zip(places, THINGS, strict=True):
        lines = (ROOT / place.file).read_text().splitlines(keepends=True)[place.first - 1 : place.last]
        assert "".join(lines) == inspect.getsource(thing)
        assert place.sha256 == hashlib.sha256("".join(lines).encode()).hexdigest()
        assert f"| {place.first}-{place.last} | `{place.sha256}` |" in places._repr_markdown_()


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
