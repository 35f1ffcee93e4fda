"""A saved run: the replies are on the page, and neither the answers nor anything else of the run is."""

from pathlib import Path

import jupytext
import pytest
from nbformat import NotebookNode, v4

from z2r.course import replies
from z2r.course.build import execute
from z2r.course.replies import run_with_replies

EXERCISES = """
EXERCISES = {
    "double": {
        "solution": "check(lambda number: 2 * number)",
        "wrong": {"half": ("check(lambda number: number / 2)", "not yet"), "none": ("check(print)", "not yet")},
    },
    "of another page": {"solution": "nothing", "wrong": {"nothing": ("nothing", "")}},
}
"""
CHECK = """
def check(function):
    print("right" if function(2) == 4 else f"not yet: you said {function(2)!r}")
    print("    " + 30 * "words ")
    total = 17
"""


@pytest.fixture
def page(tmp_path, monkeypatch) -> tuple[NotebookNode, Path]:
    """A page with an exercise and a cell for the replies; its answers are in a folder of their own."""
    monkeypatch.setattr(replies, "ANSWERS", tmp_path / "answers")
    (tmp_path / "answers").mkdir()
    (tmp_path / "answers/page.py").write_text(EXERCISES)
    cells = [
        v4.new_code_cell(CHECK),
        v4.new_code_cell("answer = 'untouched'\nprint(answer)", metadata={"tags": ["exercise", "double"]}),
        v4.new_markdown_cell("later", metadata={"tags": ["replies"]}),
        v4.new_code_cell("print(answer)"),
    ]
    script = tmp_path / "page.py"
    script.write_text(jupytext.writes(v4.new_notebook(cells=cells), fmt="py:percent"))
    return jupytext.read(script), script


def in_a_kernel(tmp_path: Path):
    return lambda notebook: execute(notebook, tmp_path)


def test_the_replies_are_in_their_cell_and_in_the_script(page, tmp_path):
    notebook, script = page
    executed = run_with_replies(notebook, script, in_a_kernel(tmp_path))
    text = executed.cells[2].source
    assert text.startswith("<details><summary>One saved run: what the checkers reply</summary>\n\n**double: half**\n\n")
    assert text.endswith("</details>")
    assert "```text\nnot yet: you said 1.0\n" in text
    assert "**double: a right answer**\n\n```text\nright\n" in text
    assert "of another page" not in text
    assert max(map(len, text.splitlines())) <= 80
    assert jupytext.read(script).cells[2].source == text


def test_nothing_else_of_the_run_is_on_the_page(page, tmp_path):
    notebook, script = page
    executed = run_with_replies(notebook, script, in_a_kernel(tmp_path))
    kept = [cell.source for cell in notebook.cells]
    assert [cell.source for cell in executed.cells if "replies" not in cell.metadata.get("tags", [])] == [
        source for source in kept if source != "later"
    ]
    assert [cell.outputs[0].text for cell in executed.cells[1::2]] == ["untouched\n", "untouched\n"]
    assert "lambda" not in executed.cells[2].source
    assert notebook.cells[2].source == "later"


def test_a_script_with_the_same_replies_is_left_alone(page, tmp_path):
    notebook, script = page
    run_with_replies(notebook, script, in_a_kernel(tmp_path))
    before = script.stat().st_mtime_ns
    run_with_replies(jupytext.read(script), script, in_a_kernel(tmp_path))
    assert script.stat().st_mtime_ns == before


def test_a_page_without_a_place_for_replies_is_just_run(page, tmp_path):
    notebook, script = page
    del notebook.cells[2]
    executed = run_with_replies(notebook, script, in_a_kernel(tmp_path))
    assert [cell.source for cell in executed.cells] == [cell.source for cell in notebook.cells]


def test_an_answer_that_raises_is_told_and_not_shown(page, tmp_path):
    notebook, script = page
    (tmp_path / "answers/page.py").write_text(EXERCISES.replace("2 * number", "unknown"))
    with pytest.raises(ValueError, match=r"double: a right answer.*NameError"):
        run_with_replies(notebook, script, in_a_kernel(tmp_path))


def test_a_page_that_raises_keeps_its_replies(page, tmp_path):
    notebook, script = page
    notebook.cells[0].source = "raise SystemError"
    executed = run_with_replies(notebook, script, in_a_kernel(tmp_path))
    assert executed.cells[0].outputs[0].ename == "SystemError"
    assert executed.cells[2].source == jupytext.read(script).cells[2].source == "later"
