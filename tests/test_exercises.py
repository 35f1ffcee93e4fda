"""Every exercise of every notebook: untouched, solved, and answered wrong in several ways.

The worked solutions are in `tests/solutions`, where nobody stumbles on them who wants to learn.
"""

import contextlib
import io
import os
import re
from collections.abc import Iterator
from functools import cache
from itertools import pairwise
from pathlib import Path

import jupytext
import pytest

from z2r.course.exercises._core import NOT_ATTEMPTED, NOT_YET, RIGHT
from z2r.course.replies import answers_of, chosen, folded

TESTS = Path(__file__).parent
NOTEBOOKS = sorted((TESTS.parent / "notebooks").glob("*.py"))
FOLDED = re.compile(r"<details><summary>(\w+)</summary>\n\n(.*?)\n\n</details>", re.DOTALL)


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


@cache
def unfolded(path: Path) -> dict[str, dict[str, str]]:
    """What can be unfolded below each exercise, by its heading."""
    cells = pairwise(jupytext.read(path).cells)
    exercises = ((cell.metadata.get("tags", []), below.source) for cell, below in cells)
    return {tags[1]: dict(FOLDED.findall(source)) for tags, source in exercises if tags[:1] == ["exercise"]}


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
    assert set(exercise_cells(path)) == set(answers_of(path.stem))


def test_an_untouched_exercise_is_not_attempted(notebook):
    path, names = notebook
    for source in exercise_cells(path).values():
        assert run(source, dict(names)).startswith(NOT_ATTEMPTED)


def test_the_solution_is_right(notebook):
    path, names = notebook
    for exercise in answers_of(path.stem).values():
        printed = run(exercise["solution"], dict(names))
        assert printed.startswith(RIGHT), printed


def test_planted_wrong_answers_are_told_what_is_wrong(notebook):
    path, names = notebook
    for exercise in answers_of(path.stem).values():
        assert len(exercise["wrong"]) >= 3
        for source, message in exercise["wrong"].values():
            printed = run(source, dict(names))
            assert printed.startswith(NOT_YET), printed
            assert message in printed, printed


def test_after_a_wrong_prediction_there_is_another_question_that_can_be_answered(notebook):
    path, names = notebook
    for exercise in answers_of(path.stem).values():
        if "again" in exercise:
            wrong, right = exercise["again"]
            [first, *_] = exercise["wrong"].values()
            assert "Another one: " in run(first[0], dict(names))
            assert run(wrong, dict(names)).startswith(NOT_YET)
            assert run(right, dict(names)).startswith(RIGHT)
            assert "Another one: " not in run(wrong, dict(names)) + run(exercise["solution"], dict(names))


def test_a_hint_and_a_solution_can_be_unfolded_and_the_solution_is_right(notebook):
    path, names = notebook
    cells = exercise_cells(path)
    for name, parts in unfolded(path).items() if any(unfolded(path).values()) else ():
        assert "Hint" in parts, name
        if cells[name].lstrip().startswith("def "):
            code = parts["Solution"].removeprefix("```python\n").removesuffix("\n```")
            assert run(f"{code}\n{cells[name].splitlines()[-1]}", dict(names)).startswith(RIGHT), name


def test_a_solution_is_on_the_page_only_where_it_is_unfolded(notebook):
    path, _ = notebook
    prose = jupytext.read(path).cells
    on_the_page = {line.strip() for cell in prose for line in FOLDED.sub("", cell.source).splitlines()}
    for exercise in answers_of(path.stem).values():
        assert {line.strip() for line in exercise["solution"].splitlines()} - on_the_page


def test_the_saved_run_is_what_the_checkers_reply(notebook):
    path, names = notebook
    page = jupytext.read(path)
    saved = [cell.source for cell in page.cells if "replies" in cell.metadata.get("tags", [])]
    shown = chosen(page, answers_of(path.stem)) if saved else []
    assert saved == [folded([(answer.title, run(answer.source, dict(names))) for answer in shown])] * len(saved)
