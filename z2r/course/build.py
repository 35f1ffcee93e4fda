"""How do the notebooks of the course come to be? Built one way: from each `.py`, its `.ipynb` with outputs.

Run `python -m z2r.course.build [STEM ...]` in a clone of the repository. It needs the packages of the extra `course`.
"""

import contextlib
import copy
import os
import re
import sys
import tempfile
import time
import tomllib
from collections.abc import Iterator, Sequence
from itertools import filterfalse, pairwise
from pathlib import Path
from typing import Any
from urllib.parse import urlsplit

import jupytext
import nbformat
from jupytext.compare import NotebookDifference, compare_notebooks
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError
from nbformat import NotebookNode, v4
from rich.console import Console
from rich.table import Column, Table

from z2r.course.replies import run_with_replies

ROOT = Path(__file__).resolve().parents[2]
NOTEBOOKS = ROOT / "notebooks"

_METADATA = {
    "jupytext": {
        "cell_metadata_filter": "tags,jupyter,cellView,-all",
        "formats": "ipynb,py:percent",
        "notebook_metadata_filter": "-jupytext.text_representation.jupytext_version",
    },
    "kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"},
}
_BADGE = """\
[![Open in Colab](https://colab.research.google.com/assets/colab-badge.svg)](https://colab.research.google.com/github/\
{owner_and_name}/blob/main/notebooks/{stem}.ipynb)
About {minutes} minutes. That is an estimate, from words, cells and exercises."""
_SETUP = """\
# @title Set up: installs z2r where it is missing, as in Colab
from importlib.util import find_spec
from pathlib import Path

if not find_spec("z2r"):  # from a wheel beside this page, or its repository
    source = "git+{repository}"
    for wheel in Path().glob("z2r-*.whl"):
        source = wheel.resolve().as_uri()
    get_ipython().run_line_magic("pip", f'install -q "z2r[notebook]@{{source}}"')"""
_COLOPHON = """\
from z2r.course.source import colophon

colophon()"""
_FOLDED: dict[str, Any] = {"jupyter": {"source_hidden": True}, "cellView": "form"}  # in JupyterLab, in Colab
_MADE_HERE = {"badge", "setup", "colophon"}

# One formula for all pages, from a first reader's minutes: so many words a minute, and so long for a cell and a task.
_WORDS_A_MINUTE, _MINUTES_A_CELL, _MINUTES_AN_EXERCISE, _MINUTES_A_HUNT = 180, 0.4, 1.6, 8.0
_FOLDED_TEXT = re.compile(r"<details>.*?</details>", re.DOTALL)
_TASK = re.compile(r"^(#+ (?:Practice|Hunt)\b.*?)(?: \(about \d+ min\))?$", re.MULTILINE)

# What differs between two machines, or between two runs on one, has no place on a page.
_SYSTEM_FOLDERS = "Users|content|etc|home|mnt|opt|private|proc|root|run|srv|tmp|usr|var"
_OWN_FOLDERS = "|".join(re.escape(str(path)) for path in (ROOT, Path.home(), Path(sys.prefix)) if len(path.parts) > 1)
_LEAKS = {
    "a traceback": re.compile(r"Traceback \(most recent call last\)"),
    "a memory address": re.compile(r"\bat 0x[0-9a-fA-F]{6,}"),
    "a path of this machine": re.compile(rf"(?<![\w.:/])(?:/(?:{_SYSTEM_FOLDERS})/|[A-Z]:\\\w|(?:{_OWN_FOLDERS})\b)"),
}
# Variables of the shell that change how a page looks.
_UNWANTED_VARIABLES = {"COLUMNS", "LINES", "FORCE_COLOR", "NO_COLOR", "JUPYTER_COLUMNS", "MPLBACKEND", "PYTHONWARNINGS"}


class BuildError(Exception):
    """A notebook cannot be built: which one, which cell, and why."""


def header(stem: str, minutes: int) -> tuple[NotebookNode, NotebookNode]:
    """Return the badge cell and the setup cell of a notebook, the same in all of them but for its stem and its time."""
    # The address of the repository stands there and nowhere else.
    address = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]["urls"]["Repository"]
    badge = _BADGE.format(owner_and_name=urlsplit(address).path.strip("/"), stem=stem, minutes=minutes)
    setup = v4.new_code_cell(_SETUP.format(repository=address), metadata=_FOLDED | {"tags": ["setup"]})
    return v4.new_markdown_cell(badge, metadata={"tags": ["badge"]}), setup


def with_header(notebook: NotebookNode, stem: str) -> NotebookNode:
    """Return the notebook with all that is the same on every page, and ids from its stem.

    That is the badge cell first, with an estimate of the time; the setup cell before the first code; at the end, where
    the page shows source, its colophon; and the time of each exercise, in its heading.
    """
    cells = [copy.copy(cell) for cell in notebook.cells if not _MADE_HERE & _tags(cell)]
    for heading, task in _tasks(cells):
        minutes = max(1, round(minutes_of(task)))
        heading["source"] = _TASK.sub(rf"\1 (about {minutes} min)", heading.source)
    badge, setup = header(stem, 5 * max(1, round(minutes_of(cells) / 5)))
    first_code = next((i for i, cell in enumerate(cells) if cell.cell_type == "code"), len(cells))
    cells = [badge, *cells[:first_code], setup, *cells[first_code:]]
    if any("show_source(" in cell.source for cell in cells if cell.cell_type == "code"):
        cells.append(v4.new_code_cell(_COLOPHON, metadata={"tags": ["colophon"]}))
    for position, cell in enumerate(cells):
        cell["id"] = f"{stem}-{position:02d}"
    with_ids: NotebookNode = v4.new_notebook(cells=cells, metadata=copy.deepcopy(_METADATA))
    return with_ids


def minutes_of(cells: Sequence[NotebookNode]) -> float:
    """Estimate how long cells take, in minutes: from their words, their code cells and their exercises.

    What is folded is not counted, and a time that is written in a heading is no words.
    """
    prose = (_FOLDED_TEXT.sub("", _TASK.sub(r"\1", cell.source)) for cell in cells if cell.cell_type == "markdown")
    minutes = sum(len(text.split()) for text in prose) / _WORDS_A_MINUTE
    for tags in (_tags(cell) for cell in cells if cell.cell_type == "code"):
        kind = _MINUTES_A_HUNT if "hunt" in tags else _MINUTES_AN_EXERCISE if "exercise" in tags else _MINUTES_A_CELL
        minutes += kind
    return minutes


def _tasks(cells: Sequence[NotebookNode]) -> Iterator[tuple[NotebookNode, list[NotebookNode]]]:
    """Yield each cell with the heading of an exercise, and the cells from there to the last exercise under it."""
    headings = {i: _TASK.search(cell.source) for i, cell in enumerate(cells) if cell.cell_type == "markdown"}
    found = [(i, heading.start()) for i, heading in headings.items() if heading]
    for (start, place), (stop, _) in pairwise([*found, (len(cells), 0)]):
        asked = [i for i in range(start, stop) if "exercise" in _tags(cells[i])]
        if asked:
            task = v4.new_markdown_cell(cells[start].source[place:])
            yield cells[start], [task, *cells[start + 1 : asked[-1] + 1]]


def _tags(cell: NotebookNode) -> set[str]:
    return set(cell.metadata.get("tags", []))


def read_script(path: Path) -> NotebookNode:
    """Return the notebook that a script makes, header included; the script itself stays as it is."""
    return with_header(jupytext.read(path, fmt="py:percent"), path.stem)


def is_up_to_date(path: Path) -> bool:
    """Whether the script already has the header that the template gives it."""
    found, expected = jupytext.read(path, fmt="py:percent"), read_script(path)
    representation = found.metadata.get("jupytext", {}).pop("text_representation", {})
    try:
        compare_notebooks(found, expected)
    except NotebookDifference:
        return False
    return found.metadata == expected.metadata and "jupytext_version" not in representation


def kernel_variables(profile: Path, *search_path: Path) -> dict[str, str]:
    """Return the environment of a kernel that looks the same on every machine: no shell settings, no IPython profile.

    What is on the search path is imported ahead of what is installed.
    """
    inherited = {name: value for name, value in os.environ.items() if name not in _UNWANTED_VARIABLES}
    return inherited | {"IPYTHONDIR": str(profile), "PYTHONPATH": os.pathsep.join(map(str, search_path))}


def execute(notebook: NotebookNode, folder: Path, *search_path: Path) -> NotebookNode:
    """Run every cell, and return the notebook with its outputs; one that raises ends the run, and `faults` tells.

    Parameters
    ----------
    notebook : NotebookNode
        What to run; it is not changed.
    folder : Path
        Working directory of the kernel.
    *search_path : Path
        Where the kernel looks for packages first; nothing means this package.
    """
    executed = copy.deepcopy(notebook)
    with tempfile.TemporaryDirectory() as profile, contextlib.suppress(CellExecutionError):
        client = NotebookClient(executed, timeout=300, record_timing=False, coalesce_streams=True)
        client.resources = {"metadata": {"path": str(folder)}}
        if os.name == "posix":  # over TCP, another program can take the port that a kernel was promised
            manager = client.create_kernel_manager()
            manager.transport, manager.ip = "ipc", f"{profile}/kernel"
        client.execute(env=kernel_variables(Path(profile), *(search_path or (ROOT,))))
    executed.metadata = copy.deepcopy(notebook.metadata)
    return executed


def faults(notebook: NotebookNode) -> Iterator[str]:
    """Say of every output that is an error, or holds something of one machine or one run: which cell, and what."""
    for cell in notebook.cells:
        for output in filter(_is_for_the_page, cell.get("outputs", [])):
            if output.output_type == "error":
                yield f"{cell.id} raised {output.ename}: {output.evalue}\n" + "\n".join(output.traceback)
            data = output.get("data", {})
            text = output.get("text", "") + "\n".join(str(data[kind]) for kind in data if not kind.startswith("image/"))
            for name, pattern in _LEAKS.items():
                if found := pattern.search(text):
                    yield f"{cell.id} shows {name}: {text[found.start() :][:80]!r}"


def build(script: Path) -> NotebookNode:
    """Bring the header of a script up to date, run it in an empty folder, and write the notebook beside it.

    If a cell raises, or an output holds something of this machine, that is a `BuildError`, and no notebook is written.
    """
    notebook = read_script(script)
    if not is_up_to_date(script):
        script.write_text(jupytext.writes(notebook, fmt="py:percent"), encoding="utf-8")
    with tempfile.TemporaryDirectory() as folder:
        executed = run_with_replies(notebook, script, lambda each: execute(each, Path(folder)))
    if found := list(faults(executed)):
        raise BuildError(f"{script.name}: " + "\n".join(found))
    for cell in (cell for cell in executed.cells if cell.cell_type == "code"):
        for output in filterfalse(_is_for_the_page, cell.outputs):
            print(f"{cell.id} wrote to stderr, which is kept off the page:\n{output.text}", file=sys.stderr)
        cell.outputs = list(filter(_is_for_the_page, cell.outputs))
    for cell in executed.cells:
        cell.metadata.pop("lines_to_next_cell", None)  # how the script is laid out
    nbformat.write(executed, script.with_suffix(".ipynb"))
    return executed


def _is_for_the_page(output: NotebookNode) -> bool:
    """Whether this is not stderr: warnings and progress bars depend on the machine, and are for the author."""
    return bool(output.get("name") != "stderr")


def main(stems: list[str]) -> None:
    """Build the named notebooks, or all of them, and say how long each took and how large it is."""
    console = Console()
    scripts = [NOTEBOOKS / f"{stem}.py" for stem in stems] or sorted(NOTEBOOKS.glob("*.py"))
    table = Table("notebook", *(Column(name, justify="right") for name in ("cells", "seconds", "KB")))
    for number, script in enumerate(scripts, 1):
        console.print(f"{number} of {len(scripts)}: {script.stem}", highlight=False)
        start = time.perf_counter()
        cells = len(build(script).cells)
        seconds, size = time.perf_counter() - start, script.with_suffix(".ipynb").stat().st_size
        table.add_row(script.stem, str(cells), f"{seconds:.1f}", f"{size / 1024:.0f}")
    console.print(table)


if __name__ == "__main__":
    try:
        main(sys.argv[1:])
    except (BuildError, OSError) as error:
        sys.exit(f"z2r.course.build: {error}")
