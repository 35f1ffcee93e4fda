"""Source on the page is that of the package, whatever the package is."""

import hashlib
import inspect

import pytest

import z2r
from z2r.course.source import show_source


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
    from z2r.errors import DatasetError

    assert show_source(DatasetError.__init__) == inspect.getsource(DatasetError.__init__).rstrip()
