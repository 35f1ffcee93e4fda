"""Whatever goes wrong while a command writes, each of its outputs is whole or absent, and what was there before stays.

Each row of the table is a command; each fault is injected wherever it writes (see `faulty`).
"""

import json
import shutil
import signal
import subprocess
import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any, NamedTuple

import pytest

import z2r

OLD = b"what was there before\n"
DATASET, VERDICT = "dataset", "dataset.verdict.json"


class Row(NamedTuple):
    """A command, what it writes, and whether there may be something of that name."""

    args: list[str]
    outputs: tuple[str, ...]
    replaces: bool = True


TABLE = {
    "inspect": Row(["inspect", "--episodes", "1", "--rerun", "--out", "."], ("metrics.json", "inspect.rrd")),
    "inspect, new folder": Row(["inspect", "--no-rerun", "--out", "new"], ("new/metrics.json",), replaces=False),
    "inspect --json": Row(["inspect", "--json", "--out", "."], ("metrics.json",)),
    "report": Row(["report", "--no-audit", "--out", "page.html"], ("page.html",)),
    "audit --keep": Row(["audit", "--keep", "kept.json"], ("kept.json",)),
    "reading": Row(["reading", "--out", "draft.toml"], ("draft.toml",), replaces=False),
    "record": Row(["record", DATASET, "--episodes", "2", "--max-steps", "3"], (DATASET, VERDICT), replaces=False),
    "inspect --smoke": Row(["inspect", "--smoke", "--episodes", "2", "--out", "."], (DATASET, VERDICT, "metrics.json")),
}
WRITERS = [name for name, row in TABLE.items() if DATASET not in row.outputs]
MIN_FAULTS = 200
KILLED = (-signal.SIGKILL, -signal.SIGXFSZ)

type Job = tuple[Path, list[str], tuple[str, int]]
type Ask = Callable[..., list[dict[str, Any]]]


@pytest.fixture(scope="module")
def ask() -> Iterator[Ask]:
    """Runs jobs at the same time, and says how each ended."""
    # What is written is what a command writes, and no bytecode (-B).
    command = [sys.executable, "-B", "-W", "ignore", Path(__file__).with_name("faulty.py")]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as process:

        def ask(*jobs: Job) -> list[dict[str, Any]]:
            process.stdin.write(json.dumps([(str(folder), *rest) for folder, *rest in jobs]) + "\n")
            process.stdin.flush()
            return json.loads(process.stdout.readline())

        yield ask
        process.stdin.close()


class Right(NamedTuple):
    """What is written where nothing goes wrong, and at how many places; and what a run before it had written."""

    new: Path
    n_places: int
    old: Path


@pytest.fixture(scope="module")
def rights(ask: Ask, tmp_path_factory: pytest.TempPathFactory) -> dict[str, Right]:
    recorded = tmp_path_factory.mktemp("recorded")
    [done] = ask((recorded, ["record", DATASET, "--episodes", "1", "--max-steps", "3"], ("count", 0)))
    assert done["code"] == 0
    found = {}
    for name, row in TABLE.items():
        old, new = tmp_path_factory.mktemp("old"), tmp_path_factory.mktemp("new")
        if row.replaces and DATASET in row.outputs:
            shutil.copytree(recorded, old, dirs_exist_ok=True)
        for output in row.outputs if row.replaces else ():
            if not (old / output).exists():
                (old / output).write_bytes(OLD)
        [done] = ask((new, row.args, ("count", 0)))
        assert (done["code"], done["said"]) == (0, "")
        assert {path.name for path in new.iterdir()} == {output.split("/")[0] for output in row.outputs}
        found[name] = Right(new, done["seen"], old)
    return found


def state_of(path: Path, new: Path) -> str:
    """Whether an output is absent, the old one or the new one; anything else is a failure."""
    if not path.exists():
        return "absent"
    if path.name == DATASET:
        return _which(len(z2r.inspect_dataset(path).episodes))
    if path.name == VERDICT:
        return _which(len(z2r.read_verdict(path.with_name(DATASET)).episodes))
    contents, whole = path.read_bytes(), new.read_bytes()
    if contents == OLD:
        return "old"
    if path.suffix == ".rrd":  # its bytes differ from run to run: its ends do not, nor by much its size
        assert (contents[:4], contents[-12:]) == (whole[:4], whole[-12:])
        assert abs(len(contents) - len(whole)) < 2000
    else:
        assert contents == whole
    return "new"


def _which(n_episodes: int) -> str:
    return {1: "old", 2: "new"}[n_episodes]


def check(folder: Path, row: Row, right: Right, done: dict[str, Any]) -> set[str]:
    """Check that each output is whole or absent, and that nothing else is left; return in which states they are."""
    states = {output: state_of(folder / output, right.new / output) for output in row.outputs}
    seen = set(states.values())
    if DATASET in states:
        assert states[DATASET] == states[VERDICT] or "absent" in (states[DATASET], states[VERDICT])
    else:
        assert seen <= {"old" if row.replaces else "absent", "new"}
    left = {path.name for path in folder.iterdir()} - {output.split("/")[0] for output in row.outputs}
    assert all(name.startswith(".z2r-") and done["code"] in KILLED for name in left)
    return seen


def check_said(row: Row, done: dict[str, Any], states: set[str]) -> None:
    """Check that one line says what is wrong, where something is."""
    if done["code"] == 0:
        assert states == {"new"}
        return
    assert done["code"] == 2, done["code"]
    assert "new" not in states or len(row.outputs) > 1
    assert "absent" not in states or not row.replaces
    assert done["said"].startswith("z2r: ")
    assert done["said"].count("\n") == 1


def places(kind: str, right: Right) -> list[int]:
    """Where to break: at every step, but few of the many that LeRobot takes; or at some bytes of every file."""
    if kind in ("kill", "full"):
        tail = range(max(right.n_places - 8, 0), right.n_places)
        return [*range(0, tail.start, 7), *tail]
    sizes = {path.stat().st_size for path in right.new.rglob("*") if path.is_file()}
    return sorted({0, 1, *(size // 2 for size in sizes), *(size - 1 for size in sizes)})


@pytest.mark.parametrize("kind", ["kill", "kill_in", "full", "full_in"])
@pytest.mark.parametrize("name", TABLE)
def test_outputs_are_whole_or_absent(name: str, kind: str, ask: Ask, rights: dict[str, Right], tmp_path: Path) -> None:
    row, right = TABLE[name], rights[name]
    for place in places(kind, right):
        folder = shutil.copytree(right.old, tmp_path / str(place))
        [done] = ask((folder, row.args, (kind, place)))
        states = check(folder, row, right, done)
        if kind.startswith("full"):
            check_said(row, done, states)
        else:
            assert done["code"] in (*KILLED, 0)


@pytest.mark.parametrize("kind", ["pipe", "dev_full", "homeless"])
@pytest.mark.parametrize("name", WRITERS)
def test_what_is_wrong_elsewhere_leaves_outputs_whole(
    name: str, kind: str, ask: Ask, rights: dict[str, Right], tmp_path: Path
) -> None:
    row, right = TABLE[name], rights[name]
    folder = shutil.copytree(right.old, tmp_path / "out")
    [done] = ask((folder, row.args, (kind, 0)))
    check(folder, row, right, done)
    assert done["code"] == {"pipe": 1, "dev_full": 2, "homeless": 0}[kind]
    assert done["said"] == ("z2r: standard output: no space left on device\n" if kind == "dev_full" else "")


@pytest.mark.parametrize("name", WRITERS)
def test_a_folder_that_is_closed_is_said_in_one_line(
    name: str, ask: Ask, rights: dict[str, Right], tmp_path: Path
) -> None:
    row, right = TABLE[name], rights[name]
    folder = shutil.copytree(right.old, tmp_path / "out")
    folder.chmod(0o555)
    [done] = ask((folder, row.args, ("read_only", 0)))
    states = check(folder, row, right, done)
    check_said(row, done, states)
    assert "permission denied" in done["said"]
    assert states == {"old" if row.replaces else "absent"}


@pytest.mark.parametrize("name", TABLE)
def test_runs_at_the_same_time_into_one_folder(name: str, ask: Ask, rights: dict[str, Right], tmp_path: Path) -> None:
    row, right = TABLE[name], rights[name]
    folder = shutil.copytree(right.old, tmp_path / "out")
    ended = ask(*[(folder, row.args, ("none", 0))] * 3)
    assert check(folder, row, right, ended[0]) == {"new"}
    assert 0 in [done["code"] for done in ended]
    assert all("Traceback" not in str(done) for done in ended)


def test_a_home_need_not_be(ask: Ask, tmp_path: Path) -> None:
    for args in (["ls"], ["inspect", "nobody/nothing"]):
        [done] = ask((tmp_path, args, ("homeless", 0)))
        assert (done["code"], "Traceback" in done["said"]) == (0 if args == ["ls"] else 2, False)


def test_there_are_many_faults(rights: dict[str, Right]) -> None:
    kinds = ("kill", "kill_in", "full", "full_in")
    assert sum(len(places(kind, right)) for kind in kinds for right in rights.values()) >= MIN_FAULTS
