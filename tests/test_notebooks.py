"""The pages of the course: each runs as it is committed, on any machine, and is what its script says it is."""

import hashlib
import re
import shutil
import statistics
import subprocess
import sys
from collections import Counter
from pathlib import Path
from typing import NamedTuple

import jupytext
import nbformat
import numpy as np
import pytest
from jupytext.compare import compare_notebooks
from nbformat import NotebookNode
from notebook_tools import (
    STEMS,
    cell_tags,
    code_cells,
    committed,
    differences,
    shown,
    without_network,
)
from rerun.chunk import RrdReader

import z2r
from z2r.course.build import (
    NOTEBOOKS,
    ROOT,
    execute,
    faults,
    is_up_to_date,
    kernel_variables,
    minutes_of,
    read_script,
    with_header,
)

each_notebook = pytest.mark.parametrize("stem", STEMS)
DECODING, REPLAY = "03_atan2_decoding", "05_rerun_replay"
MADE = {"badge", "setup", "colophon"}  # by the build, on every page
FOLDED = {"tags": ["setup"], "jupyter": {"source_hidden": True}, "cellView": "form"}


class Run(NamedTuple):
    folder: Path
    done: subprocess.CompletedProcess[str]
    notebooks: dict[str, NotebookNode]


@pytest.fixture(scope="session")
def search_path(tmp_path_factory: pytest.TempPathFactory) -> list[Path]:
    return without_network(tmp_path_factory.mktemp("site"))


@pytest.fixture(scope="session")
def run(tmp_path_factory: pytest.TempPathFactory, search_path: list[Path]) -> Run:
    """Run every notebook once, on a clean copy, without a network: `pytest --nbmake notebooks`, outputs kept."""
    folder = clone(tmp_path_factory.mktemp("clone"))
    variables = kernel_variables(tmp_path_factory.mktemp("profile"), *search_path)
    done = nbmake(folder, variables, "--overwrite", "--durations=0")
    pages = {stem: nbformat.read(folder / "notebooks" / f"{stem}.ipynb", as_version=4) for stem in STEMS}
    return Run(folder / "notebooks", done, pages)


def clone(folder: Path, stems: list[str] = STEMS) -> Path:
    """Make a repository of pages, their scripts and the settings."""
    (folder / "notebooks").mkdir()
    for path in (NOTEBOOKS / f"{stem}{suffix}" for stem in stems for suffix in (".py", ".ipynb")):
        shutil.copy(path, folder / "notebooks")
    for name in ("pyproject.toml", ".gitignore"):
        shutil.copy(ROOT / name, folder)
    git(folder, "init", "--quiet")
    git(folder, "add", ".")
    return folder


def git(folder: Path, *arguments: str) -> str:
    return subprocess.run(["git", *arguments], cwd=folder, capture_output=True, text=True, check=True).stdout


def nbmake(folder: Path, variables: dict[str, str], *options: str) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-m", "pytest", "--nbmake", "notebooks", *options]
    return subprocess.run(command, cwd=folder, env=variables, capture_output=True, text=True, check=False)


def test_nbmake_passes(run):
    print(run.done.stdout)
    assert run.done.returncode == 0, run.done.stdout + run.done.stderr
    assert re.search(rf" {len(STEMS)} passed in ", run.done.stdout)


def test_the_notebooks_write_only_what_git_ignores(run):
    changed = git(run.folder.parent, "diff", "--name-only").splitlines()
    assert set(changed) <= {f"notebooks/{stem}.ipynb" for stem in STEMS}  # outputs were kept, as was asked for
    assert git(run.folder.parent, "ls-files", "--others", "--exclude-standard") == ""


@pytest.mark.parametrize("processes", [[], ["-n", "2"]])
def test_nbmake_runs_each_notebook_once_and_no_script(processes, tmp_path):
    two = STEMS[:2]  # each starts a kernel, and how they are found does not depend on how many there are
    folder = clone(tmp_path, two)
    for stem in two:  # of each page only this, which leaves a mark for each run
        cell = nbformat.v4.new_code_cell(f"open('z2r-out-{stem}', 'a').write('.')", id="cell")
        nbformat.write(nbformat.v4.new_notebook(cells=[cell]), folder / f"notebooks/{stem}.ipynb")
        (folder / f"notebooks/{stem}.py").write_text("raise SystemExit('a script was run')")
    done = nbmake(folder, kernel_variables(tmp_path / "profile", ROOT), *processes)
    assert re.search(r" 2 passed in ", done.stdout), done.stdout + done.stderr
    assert [path.read_text() for path in folder.glob("notebooks/z2r-out-*")] == [".", "."]


@each_notebook
def test_it_shows_what_is_committed(stem, run):
    assert not list(faults(run.notebooks[stem]))
    assert not differences(run.notebooks[stem], committed(stem))


def test_a_kernel_without_network_reaches_none(tmp_path, search_path):
    attempt = """
import socket
try:
    socket.create_connection(({!r}, 80), timeout=1)
except ConnectionError as error:
    print(error)"""
    cells = [nbformat.v4.new_code_cell(attempt.format(host)) for host in ("192.0.2.1", "example.invalid")]
    executed = execute(nbformat.v4.new_notebook(cells=cells), tmp_path, *search_path)
    for cell in executed.cells:
        [(_, text)] = shown(cell)
        assert text.startswith("no network in the tests")


def test_every_recording_that_the_notebooks_write_can_be_read(run):
    recordings = list(run.folder.glob("z2r-out/*.rrd"))
    assert recordings
    for path in recordings:
        assert sum(rows_of(path).values()) > 0


def test_the_recording_has_a_row_for_every_frame_that_the_page_names(run):
    n_frames = z2r.load(z2r.STANDIN).episodes.n_frames
    assert rows_of(run.folder / "z2r-out" / "replay.rrd")["/eval/pos_err"] == n_frames
    assert f"{n_frames} frames" in str([shown(cell) for cell in code_cells(committed(REPLAY))])


def rows_of(path: Path) -> Counter[str]:
    """Number of rows of every entity that changes over time, but for those that only end a line."""
    rows: Counter[str] = Counter()
    for chunk in RrdReader(path).stream():
        table = chunk.to_record_batch()
        if not chunk.is_static and "Clear:is_recursive" not in table.schema.names:
            rows[chunk.entity_path] += table.num_rows
    return rows


def test_page_and_script_have_the_same_stems():
    assert sorted(path.stem for path in NOTEBOOKS.glob("*.ipynb")) == STEMS


@each_notebook
def test_page_and_script_agree_cell_by_cell(stem):
    compare_notebooks(committed(stem), read_script(NOTEBOOKS / f"{stem}.py"))


@each_notebook
def test_badge_setup_and_metadata_are_those_of_the_template(stem):
    assert is_up_to_date(NOTEBOOKS / f"{stem}.py")
    page, expected = committed(stem), with_header(committed(stem), stem)
    assert page.metadata == expected.metadata
    assert page.metadata.kernelspec.name == "python3"
    assert [cell.id for cell in page.cells] == [cell.id for cell in expected.cells]
    assert [cell.source for cell in page.cells] == [cell.source for cell in expected.cells]


def test_a_script_without_its_header_is_not_up_to_date(tmp_path):
    script = tmp_path / "00_bare.py"
    script.write_text("# %% [markdown]\n# # Title\n\n# %%\n1 + 1\n")
    assert not is_up_to_date(script)
    script.write_text(jupytext.writes(read_script(script), fmt="py:percent"))
    assert is_up_to_date(script)
    script.write_text(script.read_text().replace("00_bare.ipynb", "other.ipynb"))
    assert not is_up_to_date(script)


@each_notebook
def test_a_page_holds_nothing_of_the_machine_that_built_it(stem):
    page = committed(stem)
    assert not list(faults(page))
    assert not [output for cell in code_cells(page) for output in cell.outputs if output.get("name") == "stderr"]
    assert [cell.execution_count for cell in code_cells(page)] == list(range(1, len(code_cells(page)) + 1))
    folded = [cell for cell in page.cells if set(cell.metadata) - {"tags"}]
    assert [dict(cell.metadata) for cell in folded] == [FOLDED]
    assert (NOTEBOOKS / f"{stem}.ipynb").stat().st_size < 600_000


def test_what_would_leak_into_a_page_is_found(tmp_path):
    sources = [
        "print('https://example.org/home/page', './var/x', 'data/root')",
        "import os; print(os.getcwd())",
        "object()",
        "print('Traceback (most recent call last)')",
        "1 / 0",
        "print('not reached')",
    ]
    cells = [nbformat.v4.new_code_cell(source, id=f"cell{i}") for i, source in enumerate(sources)]
    found = faults(execute(nbformat.v4.new_notebook(cells=cells), tmp_path))
    assert [fault.partition(":")[0] for fault in found if "cell4 shows" not in fault] == [
        "cell1 shows a path of this machine",
        "cell2 shows a memory address",
        "cell3 shows a traceback",
        "cell4 raised ZeroDivisionError",
    ]


def test_no_wheel_lies_among_the_notebooks():
    assert {path.suffix for path in NOTEBOOKS.iterdir() if path.is_file()} <= {".py", ".ipynb"}


@each_notebook
def test_cells_are_short(stem):
    cells = code_cells(committed(stem))
    setup = [cell for cell in cells if "setup" in cell_tags(cell)]
    assert [len(code_lines(cell)) <= 8 for cell in setup] == [True]
    assert max(len(line) for cell in cells for line in cell.source.splitlines()) <= 80  # wider ones are cut on a page
    lengths = [len(code_lines(cell)) for cell in cells if cell not in setup]
    assert statistics.median(lengths) <= 5
    assert np.percentile(lengths, 90) <= 12


def code_lines(cell: NotebookNode) -> list[str]:
    return [line for line in cell.source.splitlines() if line.strip()]


def test_the_course_has_more_prose_than_code():
    cells = [
        cell for stem in STEMS for cell in committed(stem).cells if not {"badge", "setup", "colophon"} & cell_tags(cell)
    ]
    words = sum(len(cell.source.split()) for cell in cells if cell.cell_type == "markdown")
    lines = sum(len(code_lines(cell)) for cell in cells if cell.cell_type == "code")
    assert words >= 8 * lines, f"{words / lines:.1f} words for each line of code"


@each_notebook
def test_the_recap_names_what_the_beginning_promised(stem):
    prose = "\n".join(cell.source for cell in committed(stem).cells if cell.cell_type == "markdown")
    promised, kept = verbs_after("By the end you can", prose), verbs_after("You can now", prose)
    assert promised
    assert promised == kept


def verbs_after(heading: str, prose: str) -> list[str]:
    """What is bold at the start of each bullet of the list under a heading."""
    [found] = re.findall(rf"^\W*{heading}\W*\n\n((?:[-*] .*\n(?:  .*\n)*)+)", prose + "\n", re.MULTILINE)
    return re.findall(r"^[-*] \*\*(.+?)\*\*", found, re.MULTILINE)


def test_jupytext_makes_the_same_cells(tmp_path):
    """`jupytext --to notebook notebooks/*.py`, as an instructor runs it, in a folder without pages."""
    scripts = [Path(shutil.copy(NOTEBOOKS / f"{stem}.py", tmp_path)) for stem in STEMS]
    subprocess.run([sys.executable, "-m", "jupytext", "--to", "notebook", *scripts], capture_output=True, check=True)
    for script in scripts:
        compare_notebooks(nbformat.read(script.with_suffix(".ipynb"), as_version=4), committed(script.stem))


def test_an_update_by_jupytext_keeps_the_outputs(tmp_path):
    """`jupytext --update --to notebook`, which the README recommends over the same without `--update`."""
    script, page = (Path(shutil.copy(NOTEBOOKS / f"{DECODING}{suffix}", tmp_path)) for suffix in (".py", ".ipynb"))
    command = [sys.executable, "-m", "jupytext", "--update", "--to", "notebook", script]
    subprocess.run(command, capture_output=True, check=True)
    kept = nbformat.read(page, as_version=4)
    assert [cell.outputs for cell in code_cells(kept)] == [cell.outputs for cell in code_cells(committed(DECODING))]
    assert any(cell.outputs for cell in code_cells(kept))


def test_a_wrong_decode_is_seen_on_the_page(tmp_path):
    package = Path(shutil.copytree(Path(z2r.__file__).parent, tmp_path / "package" / "z2r"))
    angles = (package / "reading/angles.py").read_text()
    right = "np.arctan2(np.asarray(sin_yaw, dtype=np.float64), np.asarray(cos_yaw, dtype=np.float64))"
    assert angles.count(right) == 1
    wrong = "np.arctan2(np.asarray(cos_yaw, dtype=np.float64), np.asarray(sin_yaw, dtype=np.float64))"
    (package / "reading/angles.py").write_text(angles.replace(right, wrong))
    (tmp_path / "run").mkdir()
    notebook = execute(read_script(NOTEBOOKS / f"{DECODING}.py"), tmp_path / "run", package.parent)
    shows_source = "`z2r/reading/angles.py`"  # the source itself, and its fingerprint: any change at all would show
    pairs = zip(code_cells(notebook), code_cells(committed(DECODING)), strict=True)
    assert any(shown(cell) != shown(page) and shows_source not in str(shown(page)) for cell, page in pairs)


def test_the_badge_of_the_readme_has_the_one_address():
    assert committed("00_start_here").cells[0].source.splitlines()[0] in (ROOT / "README.md").read_text()


@each_notebook
def test_the_time_is_one_formula_and_stands_in_one_place(stem):
    """180 words a minute, 0.4 minutes a code cell, 1.6 an exercise and 8 a hunt, in fives."""
    page = committed(stem)
    own = [cell for cell in page.cells if not MADE & cell_tags(cell)]
    prose = re.sub(r"<details>[^$]*?</details>", "", "\n".join(c.source for c in own if c.cell_type == "markdown"))
    words = len(re.sub(r" \(about \d+ min\)$", "", prose, flags=re.MULTILINE).split())
    tags = [cell_tags(cell) for cell in own if cell.cell_type == "code"]
    hunts = sum("hunt" in each for each in tags)
    exercises = sum("exercise" in each for each in tags) - hunts
    minutes = words / 180 + 0.4 * (len(tags) - exercises - hunts) + 1.6 * exercises + 8 * hunts
    assert f"About {5 * round(minutes / 5)} minutes. That is an estimate" in page.cells[0].source
    assert not re.search(r"takes \d+ minutes", prose)


def test_a_time_is_written_into_the_heading_of_an_exercise_and_again_without_a_trace():
    task = "Text.\n\n### Practice: which?\n\n" + "word " * 180 + "\n\n<details>folded text</details>"
    cells = [
        nbformat.v4.new_markdown_cell(task),
        nbformat.v4.new_code_cell("answer = None", metadata={"tags": ["exercise", "which"]}),
        nbformat.v4.new_markdown_cell("### Practice in general"),
    ]
    once = with_header(nbformat.v4.new_notebook(cells=cells), "00_page")
    assert "### Practice: which? (about 3 min)\n" in once.cells[1].source
    assert once.cells[-1].source == "### Practice in general"
    assert minutes_of(once.cells[1:2]) == minutes_of(cells[:1])
    assert [cell.source for cell in with_header(once, "00_page").cells] == [cell.source for cell in once.cells]


@each_notebook
def test_the_colophon_lists_what_the_page_shows(stem):
    cells = code_cells(committed(stem))
    shows = sum(cell.source.count("show_source(") for cell in cells)
    colophons = [cell for cell in cells if "colophon" in cell_tags(cell)]
    assert len(colophons) == (shows > 0)
    for cell in colophons:
        rows = re.findall(r"\| `(.+?)` \| `.+?` \| (\d+)-(\d+) \| `(.+?)` \|", str(shown(cell)))
        assert len(rows) == shows
        for file, first, last, sha256 in rows:
            lines = (ROOT / file).read_text().splitlines(keepends=True)[int(first) - 1 : int(last)]
            assert hashlib.sha256("".join(lines).encode()).hexdigest() == sha256


# Numbers that no cell has: what somebody else reported, a version, a unit in another, a difference of two.
ELSEWHERE = {
    "06_what_is_an_action": {"10", "57.3", "1000", "0.1", "99.5", "99.9"},
    "07_break_modes": {"57"},
    "08_your_dataset": {"17"},
    "09_field_guide": {"0.6.1", "13", "6"},
    "10_cost_of_a_misreading": {"95", "0.2", "2,000"},
}


@pytest.mark.parametrize("stem", ELSEWHERE)
def test_a_number_in_the_prose_is_one_that_a_cell_has(stem):
    cells = code_cells(committed(stem))
    there = set(numbers("\n".join([*(cell.source for cell in cells), *(str(shown(cell)) for cell in cells)])))
    own = (c for c in committed(stem).cells if c.cell_type == "markdown" and not MADE & cell_tags(c))
    own = (c for c in own if not re.match("#+ Hunt", c.source))  # which is about data that the page does not show
    prose = re.sub(
        r"<details>.*?</details>|```.*?```|\]\(.*?\)|`.*?`", "", "\n".join(c.source for c in own), flags=re.S
    )
    prose = re.sub(r" \(about \d+ min\)$|^\d+\. ", "", prose, flags=re.MULTILINE)
    assert set(numbers(prose)) - there <= ELSEWHERE[stem]


def numbers(text: str) -> list[str]:
    return re.findall(r"(?<![\w.-])\d+(?:[.,]\d+)*", text)
