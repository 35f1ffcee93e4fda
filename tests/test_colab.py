"""Run All in Colab, or as near to it as a test gets: its Python, its packages, a page, a wheel, and nothing else."""

import os
import re
import shutil
import subprocess
from pathlib import Path
from typing import NamedTuple

import nbformat
import pytest
from nbformat import NotebookNode
from notebook_tools import STEMS, cannot_run, cell_tags, committed, differences, shown, without_outputs

from z2r.course.build import ROOT, faults

PINS = Path(__file__).with_name("colab-pins.txt")
UV = os.environ.get("UV") or shutil.which("uv")
EXECUTE = """
import sys, nbformat
from nbclient import NotebookClient
from nbclient.exceptions import CellExecutionError
for stem in sys.argv[1:]:
    page = nbformat.read(f"{stem}/{stem}.ipynb", as_version=4)
    try:
        NotebookClient(page, timeout=300, resources={"metadata": {"path": stem}}, coalesce_streams=True).execute()
    except CellExecutionError:
        pass  # the page says so
    nbformat.write(page, f"{stem}/{stem}.ipynb")
"""


class Colab(NamedTuple):
    notebooks: dict[str, NotebookNode]
    before: set[str]
    after: set[str]


def uv(*arguments: str | Path) -> str:
    return subprocess.run([UV, *arguments], capture_output=True, text=True, check=True).stdout


def python_3_13() -> str:
    """What uv is asked for: one that pyenv has but does not show, or else what uv finds or downloads."""
    hidden = sorted(Path(os.environ.get("PYENV_ROOT", Path.home() / ".pyenv")).glob("versions/3.13*/bin/python"))
    return str(hidden[-1]) if hidden else "3.13"


@pytest.fixture(scope="session")
def colab(tmp_path_factory: pytest.TempPathFactory) -> Colab:
    """Every notebook after Run All. The setup cell of the first installed z2r; the others found it there."""
    if UV is None:
        cannot_run("uv is not installed, which makes the environment that stands in for Colab")
    folder = tmp_path_factory.mktemp("colab")
    python = folder / "venv" / "bin" / "python"
    try:
        uv("venv", "--seed", "--python", python_3_13(), folder / "venv")
        uv("pip", "install", "--python", python, "--requirements", PINS)
    except subprocess.CalledProcessError as error:
        cannot_run(f"no Python 3.13 with Colab's packages:\n{error.stderr}")
    uv("build", "--wheel", "--out-dir", folder / "dist", ROOT)
    for stem in STEMS:
        (folder / stem).mkdir()
        nbformat.write(without_outputs(committed(stem)), folder / stem / f"{stem}.ipynb")
        shutil.copy(*(folder / "dist").glob("z2r-*.whl"), folder / stem)
    before = packages(python)
    # Neither this package nor a setting of this environment reaches the kernel.
    variables = {key: value for key, value in os.environ.items() if not re.match("PYTHON|IPYTHON|JUPYTER|VIRTUAL", key)}
    variables |= {"IPYTHONDIR": str(folder / "profile"), "PYDEVD_DISABLE_FILE_VALIDATION": "1"}
    subprocess.run([python, "-c", EXECUTE, *STEMS], cwd=folder, env=variables, check=True)
    notebooks = {stem: nbformat.read(folder / stem / f"{stem}.ipynb", as_version=4) for stem in STEMS}
    return Colab(notebooks, before, packages(python))


def packages(python: Path) -> set[str]:
    return set(uv("pip", "freeze", "--python", python).splitlines())


def names(packages: set[str]) -> set[str]:
    return {re.split("[=@ ]", line)[0] for line in packages}


def test_it_is_what_colab_has(colab):
    pins = {line for line in PINS.read_text().splitlines() if not line.startswith("#")}
    assert pins <= colab.before
    assert not {"z2r", "torch", "lerobot", "mujoco", "rerun-sdk"} & names(colab.before)


def test_the_setup_cell_installs_the_wheel_and_replaces_nothing(colab):
    assert colab.before <= colab.after
    assert [line for line in colab.after if line.startswith("z2r @ file:")]
    assert {"rerun-sdk", "mujoco"} <= names(colab.after)
    assert not {"torch", "lerobot"} & names(colab.after)


@pytest.mark.parametrize("stem", STEMS)
def test_run_all_shows_what_is_committed(stem, colab):
    page, reference = colab.notebooks[stem], committed(stem)
    assert not list(faults(page))
    # What pip says is of no interest, and a cell tagged `record` shows more where that extra is installed.
    for notebook in (page, reference):
        notebook.cells = [cell for cell in notebook.cells if not {"setup", "record"} & cell_tags(cell)]
    assert not differences(page, reference)


def test_a_cell_that_needs_the_simulator_says_something_without_it(colab):
    cells = [cell for page in colab.notebooks.values() for cell in page.cells if "record" in cell_tags(cell)]
    assert all(shown(cell) for cell in cells)
