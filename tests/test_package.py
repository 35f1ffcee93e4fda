"""How the package is built: cheap to import, layered, and reading without what recording needs."""

import ast
import importlib.metadata
import re
import subprocess
import sys
import tomllib
from graphlib import TopologicalSorter
from pathlib import Path

import pytest
from packaging.requirements import Requirement

import z2r

PACKAGE = Path(z2r.__file__).parent
ROOT = PACKAGE.parent
PYPROJECT = tomllib.loads((ROOT / "pyproject.toml").read_text())
PROJECT = PYPROJECT["project"]
LOCK = ROOT / "environment.lock"
PINS = Path(__file__).with_name("colab-pins.txt")

# Folders and modules of the package, low to high. What stands on one floor knows nothing of what stands beside it.
FLOORS = [
    ["errors"],
    ["arrays", "check", "cluster", "data"],
    ["format"],
    ["reading"],
    ["audits", "pusht"],
    ["show"],
    ["api"],
    ["course"],
    ["cli"],
]
FLOOR = {name: number for number, floor in enumerate(FLOORS) for name in floor}
SIMULATOR, CLONING = "pusht.simulator", "pusht.cloning"
MEASURED = "pusht.cloning.results"  # read without what measures


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
            by_right = module.startswith((SIMULATOR, CLONING)) or module == "cli"
            assert by_right, f"{module} imports the simulator's {imported}"
        if imported.startswith(CLONING) and imported != MEASURED:
            assert module.startswith(CLONING), f"{module} imports {imported}"


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
    assert not loaded & {"pyarrow.compute", "jinja2"}
    assert "pyarrow" in loaded


def test_what_was_measured_is_read_without_what_measures():
    loaded = loaded_by("from z2r.pusht.cloning.results import read_results; read_results()")
    assert not loaded & {"torch", "mujoco", "lerobot", "rich"}


def test_a_test_that_opens_no_browser_needs_none():
    folder = str(Path(__file__).parent)
    assert not loaded_by(f"sys.path.insert(0, {folder!r}); import conftest") & {
        "playwright",
        "lerobot",
        "torch",
        "rerun",
    }


def test_every_public_name_is_there():
    assert len(z2r.__all__) > 20
    for name in z2r.__all__:
        assert getattr(z2r, name).__doc__
    with pytest.raises(AttributeError):
        _ = z2r.no_such_name


def test_the_version_is_that_of_the_installed_package_and_costs_nothing_to_have():
    assert z2r.__version__ == importlib.metadata.version("z2r")
    assert "__version__: str" in (PACKAGE / "__init__.pyi").read_text()
    assert not loaded_by("import z2r") & {"importlib.metadata"} - loaded_by("import lazy_loader")


def test_every_message_that_names_an_install_command_names_one_that_works_in_a_clone():
    extras = set(PROJECT["optional-dependencies"])
    for path in [*PACKAGE.rglob("*.py"), *ROOT.glob("notebooks/*.py"), ROOT / "README.md"]:
        text = path.read_text()
        assert not re.search(r"install ['\"]?z2r", text), path
        assert set(re.findall(r"install '\.\[(\w+)\]'", text)) <= extras, path


def test_the_links_of_the_readme_lead_somewhere_here_and_on_pypi():
    text = (ROOT / "README.md").read_text()
    beside = re.findall(r"\]\((?!https?:|#)([^)]+)\)", text)
    assert beside
    assert not [link for link in beside if not (ROOT / link).exists()]
    for each in PYPROJECT["tool"]["hatch"]["metadata"]["hooks"]["fancy-pypi-readme"]["substitutions"]:
        text = re.sub(each["pattern"], each["replacement"], text)
    owner_and_name = PROJECT["urls"]["Repository"].removeprefix("https://github.com/")
    whole = re.findall(r"\]\((https?:[^)]+)\)", text)
    assert not re.search(r"\]\((?!https?:|#)", text)
    for link in beside:
        host = "raw.githubusercontent.com" if link.endswith(".png") else "github.com"
        inside = "main" if link.endswith(".png") else "blob/main"
        assert f"https://{host}/{owner_and_name}/{inside}/{link}" in whole


def test_every_command_of_the_readme_says_which_python_and_which_uv():
    lines = re.findall(r"^    (.*\buvx? .*)$", (ROOT / "README.md").read_text(), re.MULTILINE)
    assert "--from '.[view]' --constraints environment.lock z2r inspect" in lines[0]
    pinned = re.findall(r"uv==\S+", (ROOT / ".ci/run").read_text())[0]
    for line in lines:
        assert re.search(r"uv(x| venv) --python '>=3\.12,<3\.14' ", line)
        assert line.startswith(("uvx", f"pip install {pinned} && uv"))


def test_no_workflow_takes_an_action_by_a_name_that_can_be_moved():
    used = [
        line
        for path in (ROOT / ".github").rglob("*.yml")
        for line in re.findall(r"^\s*- uses: (.*)", path.read_text(), re.M)
    ]
    assert len(used) >= 2
    for line in used:
        assert re.fullmatch(r"actions/[\w-]+@[0-9a-f]{40} # v\d+\.\d+\.\d+", line), line


def requirements(*extras: str) -> set[str]:
    """Names of what is wanted for the given extras, and for what these are made of."""
    found: set[str] = set()
    for line in (line for extra in extras for line in PROJECT["optional-dependencies"][extra]):
        wanted = Requirement(line)
        found |= requirements(*wanted.extras) if wanted.name == "z2r" else {wanted.name}
    return found


def test_the_extras_are_made_of_one_another():
    core = {Requirement(line).name for line in PROJECT["dependencies"]}
    assert core == {"jinja2", "lazy-loader", "msgspec", "numpy", "pyarrow", "rich", "rich-click"}
    assert requirements("view") == {"matplotlib", "rerun-sdk"}
    assert requirements("all") == requirements("view", "video", "remote")
    assert requirements("record") == requirements("sim") | {"lerobot"}
    assert requirements("train") == requirements("record") | {"torch"}
    assert requirements("notebook") == requirements("view", "video", "sim")
    assert requirements("course") == requirements("notebook") | {"jupyterlab", "jupytext", "nbclient"}


def test_the_lock_names_no_registry_and_how_it_was_made():
    first, second, *rest = LOCK.read_text().splitlines()
    assert first.startswith("# This file was autogenerated by uv")
    assert "--python-version 3.12 --universal --all-extras --group dev --generate-hashes -o environment.lock" in second
    assert not [line for line in rest if "://" in line or line.startswith("-")]
    locked = {line.partition("==")[0] for line in rest if "==" in line}
    assert locked >= requirements(*PROJECT["optional-dependencies"])


def test_the_map_in_the_readme_is_whole():
    readme = (PACKAGE.parent / "README.md").read_text()
    rows = {row[1]: row[0] for row in re.findall(r"(?m)^(\| `z2r/(\w+)(?:/|\.py)`.*)$", readme)}
    for module in SOURCES:
        folder, _, rest = module.partition(".")
        assert folder in rows or folder in ("arrays", "check", "cluster"), f"{folder} is not in the README's map"
        if rest:
            assert f"`{rest.split('.')[0]}" in rows[folder], f"{module} is not in the README's map"


def test_the_reading_in_the_readme_reads_an_arm(tmp_path):
    readme = (PACKAGE.parent / "README.md").read_text()
    [text] = re.findall("```toml\n(.*?)```", readme, re.DOTALL)
    (tmp_path / "pick.toml").write_text(text)
    assert z2r.read_reading(tmp_path / "pick.toml").goal[0].value == "gripper.pos"


def test_what_the_readme_says_of_the_action_is_what_is_said():
    readme = (PACKAGE.parent / "README.md").read_text()
    for driven in z2r.infer_action("standin"):
        assert f"    {driven.name}   {driven.evidence}\n" in readme


def test_the_example_in_the_readme_runs():
    readme = (PACKAGE.parent / "README.md").read_text()
    [example] = re.findall("```python\n(.*?)```", readme, re.DOTALL)
    names: dict[str, object] = {}
    exec(example, names)
    assert len(names["pos_err"]) == z2r.load(z2r.STANDIN).episodes.lengths[0]
    assert z2r.episode_reached(names["decoded"])


def test_what_colab_has_preinstalled_is_admitted():
    pins = dict(line.split("==") for line in PINS.read_text().splitlines() if "==" in line)
    wanted = [Requirement(line) for line in PROJECT["dependencies"] + PROJECT["optional-dependencies"]["view"]]
    shared = [requirement for requirement in wanted if requirement.name in pins]
    assert {requirement.name for requirement in shared} >= {"numpy", "pyarrow", "matplotlib", "rich"}
    for requirement in shared:
        assert pins[requirement.name] in requirement.specifier, f"{requirement} would replace {pins[requirement.name]}"
