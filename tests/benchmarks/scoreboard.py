"""What does each checker of datasets say of every kind of damage, and of every healthy shape?

    python tests/benchmarks/scoreboard.py OUT [--first N]

Writes each dataset once, below OUT, and asks every one of `peers.py` about the same copy. Each is installed in an
environment of its own there, which takes `uv` and a package index; nothing else is fetched. What was asked before is
not asked again, so that a run can be ended and taken up; `--first` takes so many datasets, spread over all kinds. In
the end, the tables are in OUT/scoreboard.md, and what was said of each dataset in OUT/scoreboard.csv.

*Any alarm counts*: whatever is said of a damaged dataset and not of the undamaged one, notes too, right or wrong. A
finding is another one where its check, how bad it is, its text without numbers, or the episode, feature or joint that
it is about differs. Where there is no report, an exit code that is not 0 is an alarm. How often that is chance, the
column *recorded again* says: the same robot does the same once more, nothing is wrong, and any alarm counts as well.
On a healthy shape, warnings and worse are alarms, notes are none.

*That stops* counts only what would end a pipeline (`peers.py` says what that is of each). *Crashed* are tracebacks, and
what a checker calls its own fault; *too long* is a minute of CPU.

CPU and memory are those of fresh processes, on the undamaged datasets. About the others, each is asked in a fork of a
process that has imported it: to start them afresh each time is several hours on two cores.

The kinds were collected while z2r was written, and its tests hold it to most of them; the others never saw one. So this
says what each looks for, and not how good it is at what it looks for. Each kind is there once, as wide as can be told:
in all episodes, else in half of them, else in one. What nobody could know is left out, and so is what is wrong with the
file of a verdict, which only z2r reads.
"""

import argparse
import csv
import json
import os
import platform
import re
import shlex
import shutil
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor, as_completed
from datetime import UTC, datetime
from functools import partial
from itertools import batched
from pathlib import Path
from typing import Any, NamedTuple

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(HERE), str(HERE.parent)]

import arm_cameras  # noqa: E402 -- siblings of this folder
import arm_damages  # noqa: E402
import arms  # noqa: E402
import damages  # noqa: E402
import healthy  # noqa: E402
from arm_bench import prepare  # noqa: E402
from launcher import TOO_LONG, launcher  # noqa: E402
from peers import LEVELS, NOTE, PEERS, STOP, Peer  # noqa: E402
from rich.progress import track  # noqa: E402

CPU_LIMIT = 60
"""How much CPU a peer may use on one dataset [s]."""
STRIDE = 10
N_WORKERS = 2
BASE, HEALTHY, AGAIN = "undamaged", "healthy", "recorded again"
UNDAMAGED = {"unpadded": "messy"}
"""What is laid out so that it is a fault in itself, and what it was before."""
# What the words of each say when it comes to nothing itself, whether or not it goes on.
CRASHED = re.compile(
    "Traceback .most recent call last|_CRASHED|crashed unexpectedly|Check crashed|check could not run"
    '|it to run to its end|Internal Physlint error|"error_kind": "internal"'
)


class Case(NamedTuple):
    """A dataset: what is written, and which one it was before it was damaged."""

    group: str
    write: Callable[[Path], object]
    base: str = ""


class Said(NamedTuple):
    """What one peer said of one dataset."""

    peer: str
    dataset: str
    code: int
    cpu_seconds: float
    mebibytes: float
    crashed: bool
    findings: list[str]

    @property
    def too_long(self) -> bool:
        return self.code in TOO_LONG


# --- the datasets


def all_cases() -> dict[str, Case]:
    """Every kind of damage, once, all healthy shapes, and what was damaged."""
    return {f"{case.group}/{name}": case for name, case in _cases()}


def _cases() -> Iterator[tuple[str, Case]]:
    tables = {
        "files and metadata": damages.ON_INFO | damages.ON_META | damages.ON_TASKS | damages.ON_INDEX | damages.ON_DATA,
        "values of PushT": damages.ON_VALUES,
        "labels, and what a policy needs": damages.ON_LABELS | damages.ON_READINESS,
    }
    for base in sorted(damages.BASES.keys() - UNDAMAGED):
        yield base, Case(BASE, damages.BASES[base])
    arm_writers = {robot: partial(write_arm, robot) for robot in arms.ROBOTS} | {"filmed": arm_cameras.copy_filmed}
    for robot, write in arm_writers.items():
        yield robot, Case(BASE, write)
        for seed in (1, 2, 3):
            yield f"{robot} {seed}", Case(AGAIN, partial(write, seed=seed), f"{BASE}/{robot}")
    for group, kinds in tables.items():
        for name, damage in kinds.items():
            if damage.file != "dataset.verdict.json":  # a file that nobody but z2r reads
                base = f"{BASE}/{UNDAMAGED.get(damage.base, damage.base)}"
                yield name, Case(group, partial(damages.make, name), base)
    for name, variant in once_each(arm_damages.KINDS):
        base = f"{BASE}/{arm_damages.KINDS[name].robot}"
        yield name, Case("recordings of arms", partial(arm_damages.write_case, name, variant), base)
    for group, kinds in {"pictures": arm_cameras.ON_PICTURES, "video files": arm_cameras.ON_VIDEO_FILES}.items():
        for name, variant in once_each(kinds):
            yield name, Case(group, partial(arm_cameras.write_camera_case, name, variant), f"{BASE}/filmed")
    for name in healthy.SHAPES:
        yield name, Case(HEALTHY, partial(healthy.write_healthy, name))


def write_arm(robot: str, root: Path, seed: int = 0) -> None:
    arms.write(arms.make(robot, seed), root)


def once_each(kinds: Mapping[str, arm_damages.Kind]) -> Iterator[tuple[str, str]]:
    """Each kind that can be told at all, in the widest variant in which it can: all episodes, half of them, one."""
    for name, kind in kinds.items():
        if variants := [own for own in kind.plant if not kind.why_not(own)]:
            yield name, max(variants, key=arm_damages.VARIANTS.index)


def spread(cases: Mapping[str, Case]) -> list[str]:
    """The undamaged ones first, then every tenth of the others, so that a part of them is a sample of all."""
    bases = [name for name, case in cases.items() if case.group == BASE]
    others = [name for name in cases if name not in bases]
    return bases + [name for first in range(STRIDE) for name in others[first::STRIDE]]


def folder_of(name: str, out: Path) -> Path:
    return out / "datasets" / re.sub(r"\W+", "-", name)


def write_datasets(names: Sequence[str], out: Path) -> None:
    """Write those that are not there yet; those of LeRobot's tools in one process, which records them only once."""
    missing = [name for name in names if not (folder_of(name, out) / "whole").exists()]
    missing.sort(key=lambda name: name.startswith(f"{HEALTHY}/lerobot-"))
    with (
        tempfile.TemporaryDirectory(dir=out) as folder,
        ProcessPoolExecutor(N_WORKERS, initializer=prepare, initargs=(folder,)) as pool,
    ):
        written = pool.map(partial(write_dataset, out=out), missing, chunksize=16)
        list(track(written, "writing", total=len(missing)))


def write_dataset(name: str, out: Path) -> None:
    folder = folder_of(name, out)
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir(parents=True)
    all_cases()[name].write(folder / "dataset")
    (folder / "whole").touch()


# --- the peers


def install(peer: Peer, out: Path) -> Path:
    """Return the folder of its programs: those of its own environment, or of this one."""
    if not peer.requirement:
        return Path(sys.executable).parent
    environment = out / "environments" / re.sub(r"\W+", "-", peer.requirement)
    if not (environment / "whole").exists():
        subprocess.run(["uv", "venv", "--clear", "--python", platform.python_version(), environment], check=True)
        command = ["uv", "pip", "install", "--compile-bytecode", "--python", environment / "bin/python"]
        subprocess.run([*command, peer.requirement], check=True)
        (environment / "whole").touch()
    return environment / "bin"


def ask(name: str, peer: Peer, datasets: Mapping[str, Path], programs: Path, fresh: bool) -> list[Said]:
    """Ask one of some datasets: each in a fork of what has imported it, or in a fresh process."""
    with tempfile.TemporaryDirectory() as home:
        environment = {"PATH": f"{programs}:{os.environ['PATH']}", "HOME": home, "HF_HUB_OFFLINE": "1", "NO_COLOR": "1"}
        environment |= {"OMP_NUM_THREADS": "1", "OPENBLAS_NUM_THREADS": "1", "TQDM_DISABLE": "1"}
        if not peer.requirement:
            environment["PYTHONPATH"] = str(ROOT)
        modules = () if fresh else peer.modules
        with launcher(environment, CPU_LIMIT, modules, str(programs / "python")) as run:
            said = []
            for dataset, path in datasets.items():
                with tempfile.TemporaryDirectory(dir=home) as folder:
                    words = (word.format(dataset=path, report="report.json") for word in shlex.split(peer.command))
                    program, *arguments = words
                    cost = run([str(programs / program), *arguments], Path(folder))
                    crashed, findings = hear(peer, cost.code, Path(folder), path)
                said.append(Said(name, dataset, cost.code, cost.cpu_seconds, cost.mebibytes, crashed, findings))
    return said


def hear(peer: Peer, code: int, folder: Path, dataset: Path) -> tuple[bool, list[str]]:
    """Whether something of it crashed, and what it found, each once; of whichever dataset, in the same words."""
    paths = filter(Path.exists, (folder / name for name in ("output.txt", "errors.txt", "report.json")))
    told = {path.name: path.read_text(errors="replace").replace(str(dataset), "it") for path in paths}
    killed = code < 0 and code not in TOO_LONG
    crashed = killed or any(CRASHED.search(text) for text in told.values())
    try:
        return crashed, sorted(set(findings(peer, json.loads(told.get("report.json", told["output.txt"])))))
    except ValueError:
        return crashed, [f"{STOP} exit code {code}"] if killed or code > 0 else []


def findings(peer: Peer, report: Any) -> Iterator[str]:
    """A line for each place that each finding is about, without the numbers that say how much."""
    for word, check, places, text in peer.read(report):
        if level := peer.levels.get(word):
            level = NOTE if check in peer.held_back else level
            yield from (f"{level} {check} [{place}] {unnumbered(text)}" for place in places or [""])


def unnumbered(text: str) -> str:
    """A text without its numbers, but for those that say where something is."""
    return re.sub(r"(?<![\d.,])(?<!pisode )(?<!\[)\d[\d.,]*", "#", text)


# --- all of it


def ask_all(names: Sequence[str], cases: Mapping[str, Case], out: Path, peers: Mapping[str, Peer] = PEERS) -> None:
    """Ask every peer of every dataset, and keep what is said in OUT/said.jsonl; nothing twice."""
    programs = {name: install(peer, out) for name, peer in peers.items()}
    done = {(said.peer, said.dataset) for said in heard(out)}
    jobs = []
    for some in batched(names, 4 * STRIDE):
        for name in peers:
            wanted = {own: folder_of(own, out) / "dataset" for own in some if (name, own) not in done}
            for fresh in (True, False):
                own = {each: path for each, path in wanted.items() if (cases[each].group == BASE) == fresh}
                jobs += [(name, peers[name], own, programs[name], fresh)] if own else []
    with ThreadPoolExecutor(N_WORKERS) as pool, (out / "said.jsonl").open("a") as file:
        asked = [pool.submit(ask, *job) for job in jobs]
        for future in track(as_completed(asked), "asking", total=len(asked)):
            print(*map(json.dumps, future.result()), sep="\n", file=file, flush=True)


def heard(out: Path) -> list[Said]:
    path = out / "said.jsonl"
    return [Said(*json.loads(line)) for line in path.read_text().splitlines()] if path.exists() else []


# --- what came of it


def alarms(board: Mapping[tuple[str, str], Said], cases: Mapping[str, Case]) -> dict[tuple[str, str], str]:
    """Of each peer and dataset, how bad the worst is that it says and did not say before the damage; empty if none."""
    return {(peer, name): worst(new(board, peer, name, cases[name].base)) for peer, name in board}


def new(board: Mapping[tuple[str, str], Said], peer: str, name: str, base: str) -> set[str]:
    before = board[peer, base].findings if base else []
    return set(board[peer, name].findings) - set(before)


def worst(findings: Iterable[str]) -> str:
    return max((own.split()[0] for own in findings), key=LEVELS.index, default="")


def share(levels: Iterable[str], *counted: str) -> str:
    levels = list(levels)
    return f"{sum(level in counted for level in levels)} of {len(levels)}"


def table(title: Sequence[str], rows: Iterable[Sequence[str]]) -> str:
    lines = [title, ["---"] * len(title), *rows]
    return "\n".join(f"| {' | '.join(line)} |" for line in lines)


def summary(board: Mapping[tuple[str, str], Said], cases: Mapping[str, Case]) -> str:
    """The tables, in Markdown."""
    found = alarms(board, cases)
    peers = [name for name in PEERS if any(peer == name for peer, _ in board)]
    groups = {case.group: None for case in cases.values() if case.group not in (BASE, HEALTHY, AGAIN)}

    def levels(peer: str, *of: str) -> list[str]:
        return [level for (own, name), level in found.items() if own == peer and cases[name].group in of]

    def row(peer: str) -> Sequence[str]:
        damaged, whole = levels(peer, *groups), levels(peer, HEALTHY)
        own = [said for said in board.values() if said.peer == peer]
        fresh = [said for said in own if cases[said.dataset].group == BASE]
        return (
            *(peer, share(damaged, *LEVELS), share(damaged, STOP), share(levels(peer, AGAIN), *LEVELS)),
            *(share(whole, *LEVELS[1:]), share(whole, STOP)),
            *(f"{sum(said.crashed for said in own)}", f"{sum(said.too_long for said in own)}"),
            f"{statistics.median(said.cpu_seconds for said in fresh):.2f} s",
            f"{max(said.mebibytes for said in fresh):.0f} MiB",
        )

    title = ["", "damaged: any alarm", "damaged: that stops", f"{AGAIN}: any alarm", "healthy: a warning or worse"]
    title += ["healthy: that stops", "crashed", "too long", "CPU, median", "most memory"]
    whole = table(title, map(row, peers))
    by_group = table(
        ["any alarm", *groups], ([peer, *(share(levels(peer, group), *LEVELS) for group in groups)] for peer in peers)
    )
    return f"{whole}\n\n{by_group}\n\n{missed(found, cases, peers)}"


def missed(found: Mapping[tuple[str, str], str], cases: Mapping[str, Case], peers: Sequence[str]) -> str:
    """The kinds of which z2r says nothing, and who does, with more than a note."""
    ours = [name for name in peers if name.startswith("z2r")]
    rows = []
    for name, case in cases.items():
        if case.base and case.group != AGAIN and not any(found.get((peer, name), "missing") for peer in ours):
            others = [peer for peer in peers if found.get((peer, name), "") in LEVELS[1:]]
            rows.append([name, ", ".join(others) or "nobody"])
    return table(["z2r says nothing of", "a warning or worse by"], rows)


def write_table(board: Mapping[tuple[str, str], Said], cases: Mapping[str, Case], out: Path) -> None:
    """Write OUT/scoreboard.md, and OUT/scoreboard.csv with a row for each dataset, how bad it is said to be by each."""
    found = alarms(board, cases)
    n_asked = sum(any((peer, name) in board for peer in PEERS) for name in cases)
    last_change = ["git", "log", "-1", "--format=%h", "--", "z2r"]
    commit = subprocess.run(last_change, cwd=ROOT, capture_output=True, text=True).stdout.strip()
    versions = ", ".join([f"z2r at {commit}", *(peer.requirement for peer in PEERS.values() if peer.requirement)])
    stack = f"Python {platform.python_version()}, {platform.system()} {platform.machine()}"
    asked = f"`python tests/benchmarks/scoreboard.py OUT`: {n_asked} of {len(cases)} datasets"
    head = f"Measured on {datetime.now(UTC):%Y-%m-%d} by {asked}; {versions}; {stack}."
    _, _, _, *rules = __doc__.strip().split("\n\n")
    (out / "scoreboard.md").write_text("\n\n".join([head, summary(board, cases), *rules]) + "\n")
    with (out / "scoreboard.csv").open("w", newline="") as file:
        rows = csv.writer(file, lineterminator="\n")
        rows.writerow(["dataset", "before", *PEERS])
        for name, case in cases.items():
            cells = [cell(board.get((peer, name)), found.get((peer, name), "")) for peer in PEERS]
            rows.writerow([name, case.base, *cells])


def cell(said: Said | None, level: str) -> str:
    if said is None:
        return "not asked"
    return " ".join(filter(None, [level, "crash" * said.crashed, "too long" * said.too_long]))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("out", type=Path, help="a folder for all that is written")
    parser.add_argument("--first", type=int, help="how many datasets, spread over all")
    args = parser.parse_args()
    out, cases = args.out.resolve(), all_cases()
    names = spread(cases)[: args.first]
    out.mkdir(parents=True, exist_ok=True)
    write_datasets(names, out)
    ask_all(names, cases, out)
    write_table({(said.peer, said.dataset): said for said in heard(out)}, cases, out)


if __name__ == "__main__":
    main()
