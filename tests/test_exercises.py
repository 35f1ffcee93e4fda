"""Every exercise of every notebook: untouched, solved, and answered wrong in several ways.

The worked solutions are in `tests/solutions`, where nobody stumbles on them who wants to learn.
"""

import contextlib
import importlib.util
import io
import os
from collections.abc import Iterator
from functools import cache
from pathlib import Path

import jupytext
import pytest

from z2r.course.exercises._core import NOT_ATTEMPTED, NOT_YET, RIGHT

TESTS = Path(__file__).parent
NOTEBOOKS = sorted((TESTS.parent / "notebooks").glob("*.py"))


@cache
def solutions(stem: str) -> dict:
    spec = importlib.util.spec_from_file_location("solutions", TESTS / f"solutions/{stem}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module.EXERCISES


def is_code(cell) -> bool:
    return cell.cell_type == "code" and "setup" not in cell.metadata.get("tags", [])


@cache
def exercise_cells(path: Path) -> dict[str, str]:
    tagged = {cell: cell.metadata.get("tags", []) for cell in map(_Cell, jupytext.read(path).cells)}
    return {tags[1]: cell.source for cell, tags in tagged.items() if tags[:1] == ["exercise"]}


class _Cell:
    """A notebook cell that can be a key."""

    def __init__(self, cell) -> None:
        self.metadata, self.source = cell.metadata, cell.source


def run(source: str, names: dict) -> str:
    """What a cell prints."""
    printed = io.StringIO()
    with contextlib.redirect_stdout(printed):
        exec(compile(source, "<cell>", "exec"), names)
    return printed.getvalue()


@pytest.fixture(scope="module", params=NOTEBOOKS, ids=lambda path: path.stem)
def notebook(request, tmp_path_factory) -> Iterator[tuple[Path, dict]]:
    """A notebook, and the names that are there after a run of all its cells."""
    home, names = Path.cwd(), {}
    os.chdir(tmp_path_factory.mktemp("notebook"))
    for cell in filter(is_code, jupytext.read(request.param).cells):
        run(cell.source, names)
    yield request.param, names
    os.chdir(home)


def test_there_are_two_exercises_or_more_and_all_have_solutions(notebook):
    path, _ = notebook
    assert len(exercise_cells(path)) >= 2
    assert set(exercise_cells(path)) == set(solutions(path.stem))


def test_an_untouched_exercise_is_not_attempted(notebook):
    path, names = notebook
    for source in exercise_cells(path).values():
        assert run(source, dict(names)).startswith(NOT_ATTEMPTED)


def test_the_solution_is_right(notebook):
    path, names = notebook
    for exercise in solutions(path.stem).values():
        printed = run(exercise["solution"], dict(names))
        assert printed.startswith(RIGHT), printed


def test_planted_wrong_answers_are_told_what_is_wrong(notebook):
    path, names = notebook
    for exercise in solutions(path.stem).values():
        assert len(exercise["wrong"]) >= 3
        for source, message in exercise["wrong"].values():
            printed = run(source, dict(names))
            assert printed.startswith(NOT_YET), printed
            assert message in printed, printed


def test_a_solution_is_nowhere_on_the_page(notebook):
    path, _ = notebook
    on_the_page = {line.strip() for line in path.read_text().splitlines()}
    for exercise in solutions(path.stem).values():
        assert {line.strip() for line in exercise["solution"].splitlines()} - on_the_page
