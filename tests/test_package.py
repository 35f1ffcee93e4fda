"""How the package is built: cheap to import, layered, and reading without what recording needs."""

import ast
import csv
import re
import subprocess
import sys
import tomllib
from graphlib import TopologicalSorter
from pathlib import Path

import pytest
from packaging.requirements import Requirement

import z2r
from z2r.show.wallclock import LEDGER, nearest_run, read_ledger

PACKAGE = Path(z2r.__file__).parent
PYPROJECT = PACKAGE.parent / "pyproject.toml"
PINS = Path(__file__).with_name("colab-pins.txt")

# Folders and modules of the package, low to high. What stands on one floor knows nothing of what stands beside it.
FLOORS = [
    ["errors", "arrays", "data"],
    ["check"],
    ["format"],
    ["reading"],
    ["audits", "pusht"],
    ["show"],
    ["api"],
    ["course"],
    ["cli"],
]
FLOOR = {name: number for number, floor in enumerate(FLOORS) for name in floor}
SIMULATOR = "pusht.simulator"


def module_name(path: Path) -> str:
    return ".".join(path.relative_to(PACKAGE).with_suffix("").parts).removesuffix(".__init__")


SOURCES = {name: path for path in PACKAGE.rglob("*.py") if (name := module_name(path)) != "__init__"}


def imports(path: Path) -> set[str]:
    """Modules of the package that one of its files imports, also inside functions."""
    found = set()
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.ImportFrom) and (node.module or "").split(".")[0] == "z2r":
            inner = (node.module or "").removeprefix("z2r").lstrip(".")
            names = {f"{inner}.{alias.name}".lstrip(".") for alias in node.names}
            found |= (names & set(SOURCES)) or {inner} - {""} or {alias.name for alias in node.names}
    return found


@pytest.mark.parametrize("module", SOURCES)
def test_imports_point_downwards(module):
    here = module.split(".")[0]
    for imported in imports(SOURCES[module]):
        there = imported.split(".")[0]
        assert there == here or FLOOR[there] < FLOOR[here], f"{module} imports {imported}"
        if imported.startswith(SIMULATOR):
            assert module.startswith(SIMULATOR) or module == "cli", f"{module} imports the simulator's {imported}"


def test_no_modules_import_each_other_in_a_circle():
    TopologicalSorter({module: imports(path) for module, path in SOURCES.items()}).prepare()


# Methods of a path, and the built-in.
TOUCHES_FILES = {
    *("open", ".open", ".read_bytes", ".read_text", ".stat", ".glob", ".rglob", ".iterdir"),
    *(".resolve", ".exists", ".is_file", ".is_dir"),
}


def called(path: Path) -> set[str]:
    """What a module calls: functions by their name, methods with a dot before it."""
    calls = (node.func for node in ast.walk(ast.parse(path.read_text())) if isinstance(node, ast.Call))
    return {f".{call.attr}" if isinstance(call, ast.Attribute) else getattr(call, "id", "") for call in calls}


@pytest.mark.parametrize("module", [name for name in SOURCES if name.split(".")[0] in ("format", "audits")])
def test_one_module_touches_the_file_system(module):
    """One door: who keeps datasets elsewhere, such as in object storage, has one module to look at."""
    assert module == "format.store" or not called(SOURCES[module]) & TOUCHES_FILES


def loaded_by(statement: str) -> set[str]:
    program = f"import sys; {statement}; print(*sys.modules)"
    done = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    return set(done.stdout.split())


def test_importing_the_package_loads_nothing_heavy():
    assert not loaded_by("import z2r") & {"numpy", "pyarrow", "rich", "rerun", "matplotlib", "msgspec"}


def test_reading_loads_nothing_that_it_does_not_need():
    loaded = loaded_by("import z2r; z2r.inspect_dataset(z2r.load(z2r.STANDIN))")
    assert not loaded & {"pandas", "torch", "lerobot", "mujoco", "datasets", "rerun", "matplotlib", "pyarrow.dataset"}
    assert "pyarrow.compute" not in loaded
    assert "pyarrow" in loaded


def test_every_public_name_is_there():
    assert len(z2r.__all__) > 20
    for name in z2r.__all__:
        assert getattr(z2r, name).__doc__
    with pytest.raises(AttributeError):
        _ = z2r.no_such_name


def test_the_ledger_holds_measured_runs():
    with LEDGER.open() as file:
        assert len(list(csv.DictReader(file))) == len(read_ledger()) > 0
    for run in read_ledger():
        assert run.seconds > 0
        assert run.runs >= 3
        assert run.size > 0


def test_the_ledger_answers_with_the_next_larger_run_of_the_same_tier():
    runs = [run for run in read_ledger() if run.command == "inspect --no-rerun"]
    small, large = min(runs, key=lambda run: run.size), max(runs, key=lambda run: run.size)
    assert small.size < large.size
    assert nearest_run(small.command, small.size, small.tier) == small
    assert nearest_run(small.command, large.size * 10, small.tier) == large
    assert nearest_run(small.command, 1, "a tier that nobody measured") is None


def test_the_example_in_the_readme_runs():
    readme = (PACKAGE.parent / "README.md").read_text()
    [example] = re.findall("```python\n(.*?)```", readme, re.DOTALL)
    names: dict[str, object] = {}
    exec(example, names)
    assert len(names["pos_err"]) == z2r.load(z2r.STANDIN).episodes.lengths[0]
    assert z2r.episode_reached(names["first"], z2r.PUSHT, names["dataset"].schema)


def test_what_colab_has_preinstalled_is_admitted():
    pins = dict(line.split("==") for line in PINS.read_text().splitlines() if "==" in line)
    wanted = [Requirement(line) for line in tomllib.loads(PYPROJECT.read_text())["project"]["dependencies"]]
    shared = [requirement for requirement in wanted if requirement.name in pins]
    assert {requirement.name for requirement in shared} >= {"numpy", "pyarrow", "matplotlib", "rich"}
    for requirement in shared:
        assert pins[requirement.name] in requirement.specifier, f"{requirement} would replace {pins[requirement.name]}"
