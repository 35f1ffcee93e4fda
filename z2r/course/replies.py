"""What do the checkers reply? One saved run of each page with answers, for who reads it without running it.

The answers are those that the tests hold the checkers to, so this works in a clone of the repository only. The replies
go into the one cell of a page that is tagged for them; the answers go nowhere.
"""

import runpy
import textwrap
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import jupytext
from nbformat import NotebookNode, v4

ANSWERS = Path(__file__).resolve().parents[2] / "tests" / "solutions"

_TAG = "replies"
_WIDTH = 80  # of a line: wider ones are cut on a page
_TITLE = "One saved run: what the checkers reply"

type Answers = dict[str, dict[str, Any]]
"""By the name of an exercise: a right answer, as the source of a cell, and wrong ones, each with what it is called."""


class Answer(NamedTuple):
    """An answer to an exercise: what to call it, and the source of the cell."""

    title: str
    source: str


def answers_of(stem: str) -> Answers:
    """Read the answers to the exercises of a page, and to its hunt; none where there are none."""
    of_hunts: dict[str, Answers] = _answers_in("hunts")
    return _answers_in(stem) | of_hunts.get(stem, {})


def _answers_in(name: str) -> dict[str, Any]:
    path = ANSWERS / f"{name}.py"
    return dict(runpy.run_path(str(path))["EXERCISES"]) if path.exists() else {}


def chosen(notebook: NotebookNode, answers: Answers) -> list[Answer]:
    """Choose what is shown: of each exercise, in the order of the page, its first wrong answer and its right one."""
    tags = (cell.metadata.get("tags", []) for cell in notebook.cells)
    names = [each[1] for each in tags if each[:1] == ["exercise"] and each[1] in answers]
    shown = []
    for name in names:
        wrong, (source, _) = next(iter(answers[name]["wrong"].items()))
        shown += [Answer(f"{name}: {wrong}", source), Answer(f"{name}: a right answer", answers[name]["solution"])]
    return shown


def folded(replies: Sequence[tuple[str, str]]) -> str:
    """Return replies, each with its title, as the text of a cell that can be unfolded."""
    parts = [f"**{title}**\n\n```text\n{_wrapped(reply)}\n```" for title, reply in replies]
    return "\n\n".join([f"<details><summary>{_TITLE}</summary>", *parts, "</details>"])


def run_with_replies(notebook: NotebookNode, script: Path, run: Callable[[NotebookNode], NotebookNode]) -> NotebookNode:
    """Run a notebook, and in the same kernel all answers; put the replies into their cell, in the script too.

    Parameters
    ----------
    notebook : NotebookNode
        It is not changed. One without a cell that is tagged ``replies`` is just run.
    script : Path
        Where it comes from: rewritten if the replies are others than before.
    run : callable
        Returns a notebook with its outputs.

    Returns
    -------
    NotebookNode
        The notebook with its outputs and the replies, without the answers.

    Raises
    ------
    ValueError
        If an answer raises, which a checker never does.
    """
    places = [place for place, cell in enumerate(notebook.cells) if _TAG in cell.metadata.get("tags", [])]
    shown = chosen(notebook, answers_of(script.stem)) if places else []
    if not shown:
        return run(notebook)
    solved = v4.new_notebook(
        cells=[*notebook.cells, *(v4.new_code_cell(answer.source) for answer in shown)], metadata=notebook.metadata
    )
    executed = run(solved)
    executed.cells, answered = executed.cells[: -len(shown)], executed.cells[-len(shown) :]
    if any(output.output_type == "error" for cell in executed.cells for output in cell.get("outputs", [])):
        return executed  # the run ended there
    text = folded([(answer.title, _printed(answer, cell)) for answer, cell in zip(shown, answered, strict=True)])
    if text != notebook.cells[places[0]].source:
        executed.cells[places[0]].source = text
        script.write_text(jupytext.writes(executed, fmt="py:percent"), encoding="utf-8")
    return executed


def _printed(answer: Answer, cell: NotebookNode) -> str:
    for output in cell.outputs:
        if output.output_type == "error":
            raise ValueError(f"{answer.title}: expected a reply, found {output.ename}: {output.evalue}")
    return "".join(each.text for each in cell.outputs if each.get("name") == "stdout")


def _wrapped(reply: str) -> str:
    lines = []
    for line in reply.strip().splitlines():
        indent = line[: len(line) - len(line.lstrip())]
        lines += textwrap.wrap(line, _WIDTH, subsequent_indent=f"{indent}    ", break_on_hyphens=False) or [""]
    return "\n".join(lines)
