"""How much faster than the reference flow? Ratios of medians, both sides in one run on one machine.

    python tests/benchmarks/run.py [--runs 5] [--frames 1000000] [--ledger]

The reference flow is in `reference.py`; on a million frames it takes minutes. It also counts how often each command
opens a data file. `--ledger` measures the rows of this machine in `z2r/show/wallclock.csv` instead, and writes them
there and into the table of the README. Exit code 1 where a target is missed.
"""

import argparse
import csv
import importlib.metadata
import json
import os
import platform
import statistics
import subprocess
import sys
import tempfile
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, fields
from pathlib import Path
from typing import NamedTuple, NoReturn

import numpy as np
import pyarrow.parquet as pq
from rich.console import Console
from rich.table import Table

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(HERE), str(HERE.parent)]

from launcher import launcher  # noqa: E402 -- siblings of this folder
from layouts import Layout, lay_out, read_dataset, write_dataset  # noqa: E402

import z2r  # noqa: E402
from z2r.format.dataset import map_files  # noqa: E402
from z2r.show.wallclock import LEDGER, Run, ledger_table, machine_tier, read_ledger  # noqa: E402

FEATURES = ["observation.state", "action"]
Z2R = [sys.executable, "-c", "from z2r.cli import main; main()"]
LEDGER_BEGINS, LEDGER_ENDS = "<!-- ledger: z2r.show.wallclock.ledger_table() -->", "<!-- end of ledger -->"
REFERENCE = [sys.executable, str(HERE / "reference.py")]


class Process(NamedTuple):
    seconds: float
    cpu_seconds: float
    mebibytes: float
    output: str


class Row(NamedTuple):
    """One measure: ours, the reference's, and what the ratio must be."""

    measure: str
    ours: str
    reference: str
    ratio: float
    target: str
    met: bool


# Run a command, and print on the last line how often it opened each parquet file.
COUNT_OPENS = """
import collections, contextlib, json
import pyarrow as pa

opens, map_file = collections.Counter(), pa.memory_map

def counted(path, *args, **kwargs):
    opens[str(path)] += 1
    return map_file(path, *args, **kwargs)

pa.memory_map = counted
from z2r.cli import main

with contextlib.suppress(SystemExit):
    main()
print(json.dumps(opens))
"""
COMMANDS = ("inspect --no-rerun", "inspect --rerun", "report --no-audit", "report", "audit")


def run_process(command: list[str], cwd: Path) -> Process:
    environment = {name: value for name, value in os.environ.items() if name != "PYTHONDONTWRITEBYTECODE"}
    environment["PYTHONPATH"] = os.pathsep.join([str(HERE.parent), str(ROOT)])
    with launcher(environment) as run:
        cost = run(command, cwd)
    if cost.code:
        raise subprocess.CalledProcessError(cost.code, command, stderr=(cwd / "errors.txt").read_text())
    return Process(*cost[1:], (cwd / "output.txt").read_text())


def alternate(*sides: Callable[[], object], runs: int) -> list[list]:
    """Run all in turn, so that a slow minute of the machine hits each; once before, to fill caches."""
    rounds = [[side() for side in sides] for _ in range(runs + 1)]
    return [list(results) for results in zip(*rounds[1:], strict=True)]


def timed(work: Callable[[], object]) -> Callable[[], float]:
    def run() -> float:
        start = time.perf_counter()
        work()
        return time.perf_counter() - start

    return run


def median(processes: list[Process], field: str) -> float:
    return statistics.median(getattr(process, field) for process in processes)


def inspect_against_reference(name: str, root: Path, scratch: Path, runs: int, faster: float) -> list[Row]:
    ours, theirs = alternate(
        lambda: run_process([*Z2R, "inspect", str(root), "--no-rerun", "--out", name], scratch),
        lambda: run_process([*REFERENCE, "inspect", str(root)], scratch),
        runs=runs,
    )
    metrics = json.loads((scratch / name / "metrics.json").read_text())
    expected = json.loads(theirs[0].output)
    assert {key: metrics[key] for key in expected} == expected, "the two flows disagree"
    seconds = median(ours, "seconds"), median(theirs, "seconds")
    memory = median(ours, "mebibytes"), median(theirs, "mebibytes")
    return [
        Row(
            f"inspect, {name}: time",
            f"{seconds[0]:.2f} s",
            f"{seconds[1]:.2f} s",
            seconds[1] / seconds[0],
            f">= {faster:g}",
            seconds[1] / seconds[0] >= faster,
        ),
        Row(
            f"inspect, {name}: peak memory",
            f"{memory[0]:.0f} MiB",
            f"{memory[1]:.0f} MiB",
            memory[1] / memory[0],
            ">= 5",
            memory[1] / memory[0] >= 5,
        ),
    ]


def memory_by_number_of_files(few: Path, many: Path, scratch: Path, runs: int) -> Row:
    def inspect(root: Path) -> Process:
        return run_process([*Z2R, "inspect", str(root), "--no-rerun"], scratch)

    ours, theirs = alternate(lambda: inspect(many), lambda: inspect(few), runs=runs)
    memory = median(ours, "mebibytes"), median(theirs, "mebibytes")
    ratio = memory[0] / memory[1]
    return Row(
        "inspect: memory of 4 times the files of one size",
        f"{memory[0]:.0f} MiB",
        f"{memory[1]:.0f} MiB",
        ratio,
        "<= 1.15",
        ratio <= 1.15,
    )


def read_against_bare_pyarrow(root: Path, runs: int) -> Row:
    dataset = z2r.load(root)

    def bare() -> None:
        for file in dataset.files:
            pq.ParquetFile(file.path, memory_map=True).read(columns=FEATURES)

    ours, theirs = alternate(
        timed(lambda: map_files(dataset, FEATURES, lambda _, frames: frames)), timed(bare), runs=3 * runs
    )
    ratio = statistics.median(ours) / statistics.median(theirs)
    return Row(
        "state and action, every frame",
        f"{statistics.median(ours):.3f} s",
        f"{statistics.median(theirs):.3f} s (bare pyarrow)",
        ratio,
        "<= 1.3",
        ratio <= 1.3,
    )


def replay_against_rows(root: Path, scratch: Path, runs: int) -> Row:
    dataset = z2r.load(root)
    assert dataset.episodes.n_frames == 10_000
    z2r.write_replay(dataset, scratch / "warm.rrd")
    from reference import replay

    ours, theirs = alternate(
        timed(lambda: z2r.write_replay(dataset, scratch / "ours.rrd")),
        timed(lambda: replay(10_000, str(scratch / "theirs.rrd"))),
        runs=runs,
    )
    ratio = statistics.median(theirs) / statistics.median(ours)
    return Row(
        "write the .rrd of 10,000 frames",
        f"{statistics.median(ours):.2f} s",
        f"{statistics.median(theirs):.2f} s",
        ratio,
        ">= 10",
        ratio >= 10,
    )


def import_against_bare_interpreter(scratch: Path, runs: int) -> Row:
    ours, theirs = alternate(
        lambda: run_process([sys.executable, "-c", "import z2r"], scratch),
        lambda: run_process([sys.executable, "-c", "pass"], scratch),
        runs=5 * runs,
    )
    seconds = median(ours, "seconds"), median(theirs, "seconds")
    return Row(
        "import z2r over a bare interpreter",
        f"{seconds[0]:.3f} s",
        f"{seconds[1]:.3f} s",
        seconds[0] / seconds[1],
        "<= 0.1 s more",
        seconds[0] - seconds[1] <= 0.1,
    )


def replay_against_reading(scratch: Path, runs: int) -> Row:
    """How much CPU the replay costs beyond reading and beyond loading rerun, against the reading."""
    reading = "import numpy, pyarrow.parquet, rich"
    commands = [
        [*Z2R, "inspect", "--rerun"],
        [*Z2R, "inspect", "--no-rerun"],
        [sys.executable, "-c", f"{reading}, rerun, rerun.blueprint"],
        [sys.executable, "-c", reading],
    ]
    sides = [lambda command=command: run_process(command, scratch) for command in commands]
    both, read, rerun, bare = (median(side, "cpu_seconds") for side in alternate(*sides, runs=2 * runs))
    replay = (both - read) - (rerun - bare)
    said = f"{replay:.2f} s of {both:.2f} s", f"{read:.2f} s (inspect --no-rerun)"
    ratio = replay / read
    return Row("six episodes' replay, less import rerun: CPU", *said, ratio, "<= 1.5", ratio <= 1.5)


def opens_of_data_files(root: Path, scratch: Path) -> Table:
    table = Table("command", "data files", "opens", "most of one file", title="how often data files are opened")
    files = [str(file.path) for file in z2r.load(root).files]
    for command in COMMANDS:
        words = [sys.executable, "-c", COUNT_OPENS, *command.split(), str(root)]
        counted = json.loads(run_process(words, scratch).output.splitlines()[-1])
        opens = [counted.get(file, 0) for file in files]
        table.add_row(command, f"{len(files)}", f"{sum(opens)}", f"{max(opens)}")
    return table


def command_against_inspect(command: str, most: float, root: Path, scratch: Path, runs: int) -> Row:
    ours, theirs = alternate(
        lambda: run_process([*Z2R, *command.split(), str(root)], scratch),
        lambda: run_process([*Z2R, "inspect", str(root), "--no-rerun"], scratch),
        runs=runs,
    )
    seconds = median(ours, "cpu_seconds"), median(theirs, "cpu_seconds")
    ratio = seconds[0] / seconds[1]
    said = f"{seconds[0]:.2f} s", f"{seconds[1]:.2f} s (inspect)"
    return Row(f"{command} over inspect: CPU", *said, ratio, f"<= {most:g}", ratio <= most)


def size_of_page(page: Path) -> Row:
    megabytes = page.stat().st_size / 1e6
    return Row("the page of it", f"{megabytes:.1f} MB", "5 MB (limit)", megabytes / 5, "<= 1", megabytes <= 5)


def repeat_messy(root: Path, n_frames: int, n_files: int) -> Path:
    """Lay out real demonstrations, again and again, each time a bit further on the table: an audit finds no fault."""
    frames, lengths = read_dataset(z2r.MESSY)
    times = -(-n_frames // sum(lengths))
    n_episodes = times * len(lengths)
    layout = Layout(even(n_episodes, n_files), even(n_episodes, 4))
    frames = {name: np.tile(frames[name], (times, 1)) for name in FEATURES}
    frames["observation.state"][:, [0, 2, 6]] += 1e-6 * np.repeat(np.arange(times), sum(lengths))[:, None]
    write_dataset(root, frames, lengths * times, layout)
    return root


def even(total: int, parts: int) -> list[int]:
    return [len(part) for part in np.array_split(np.arange(total), parts)]


def lay_out_even(root: Path, n_frames: int, n_files: int) -> Path:
    n_episodes = n_frames // 100
    lay_out(root, even(n_frames, n_episodes), files=even(n_episodes, n_files), shards=even(n_episodes, 4))
    return root


def measure_ledger(big: Path, scratch: Path, runs: int) -> Iterator[Run]:
    versions = [f"{name} {importlib.metadata.version(name)}" for name in ("pyarrow", "rerun-sdk", "mujoco", "lerobot")]
    machine = f"{os.cpu_count()} cores of {platform.system()} {platform.machine()}"
    stack = "; ".join([machine, f"Python {platform.python_version()}", *versions])
    kinds = [
        (command, z2r.load(root).episodes.n_frames, "frames", [*command.split(), str(root)])
        for root in (z2r.STANDIN, big)
        for command in ("inspect", "inspect --no-rerun", "report --no-audit")
    ]
    kinds += [("record", n, "episodes", ["record", "recorded", "--episodes", str(n)]) for n in (6, 60)]
    for command, size, unit, args in kinds:
        seconds = []
        for _ in range(runs + 1):
            with tempfile.TemporaryDirectory(dir=scratch) as folder:
                seconds.append(run_process([*Z2R, *args], Path(folder)).seconds)
        yield Run(machine_tier(), command, size, unit, round(statistics.median(seconds[1:]), 2), runs, stack)


def write_ledger(measured: list[Run]) -> None:
    """Put the rows of this tier in place of those that are there, and the table into the README."""
    kept = [run for run in read_ledger() if run.tier != machine_tier()]
    runs = sorted([*kept, *measured], key=lambda run: (run.tier, run.command, run.size))
    with LEDGER.open("w", newline="") as file:
        rows = csv.DictWriter(file, [field.name for field in fields(Run)], lineterminator="\n")
        rows.writeheader()
        rows.writerows({**asdict(run), "seconds": f"{run.seconds:.2f}"} for run in runs)
    readme = ROOT / "README.md"
    before, begin, rest = readme.read_text().partition(LEDGER_BEGINS)
    _, end, after = rest.partition(LEDGER_ENDS)
    readme.write_text(f"{before}{begin}\n\n{ledger_table()}\n\n{end}{after}")


def print_rows(rows: list[Row]) -> NoReturn:
    """Table what was measured, and exit with 1 where a target is missed."""
    table = Table("measure", "z2r", "reference", "ratio", "target", "", title=f"{machine_tier()}, medians")
    for row in rows:
        table.add_row(
            row.measure, row.ours, row.reference, f"{row.ratio:.2f}", row.target, "met" if row.met else "MISSED"
        )
    Console().print(table)
    sys.exit(not all(row.met for row in rows))


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=5)
    parser.add_argument("--frames", type=int, default=1_000_000)
    parser.add_argument("--ledger", action="store_true")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        scratch = Path(folder)
        big = lay_out_even(scratch / "big", args.frames, n_files=32)
        if args.ledger:
            write_ledger(list(measure_ledger(big, scratch, args.runs)))
            return
        quarter = lay_out_even(scratch / "quarter", args.frames // 4, n_files=8)
        small = lay_out_even(scratch / "small", 10_000, n_files=1)
        real = repeat_messy(scratch / "messy", args.frames, n_files=32)
        rows = [
            *inspect_against_reference("six episodes", z2r.STANDIN, scratch, args.runs, faster=15),
            *inspect_against_reference(f"{args.frames:,} frames", big, scratch, min(args.runs, 3), faster=100),
            memory_by_number_of_files(quarter, big, scratch, args.runs),
            read_against_bare_pyarrow(big, args.runs),
            replay_against_rows(small, scratch, min(args.runs, 3)),
            command_against_inspect("report --no-audit", 3, big, scratch, args.runs),
            size_of_page(scratch / "z2r-out/report.html"),
            command_against_inspect("audit", 2, real, scratch, args.runs),
            command_against_inspect("report", 3, real, scratch, args.runs),
            replay_against_reading(scratch, args.runs),
            import_against_bare_interpreter(scratch, args.runs),
        ]
        opens = opens_of_data_files(quarter, scratch)
    Console().print(opens)
    print_rows(rows)


if __name__ == "__main__":
    main()
