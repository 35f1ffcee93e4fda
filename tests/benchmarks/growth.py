"""What does it cost when a dataset grows? CPU and memory against the peers, both sides in turn on one machine.

    python tests/benchmarks/growth.py [--runs 3] [--only many joints episodes metadata frames] [--frames 100000000]

| `--only` | dataset | question |
| --- | --- | --- |
| many | 10,000 files of 100 frames | what does a file cost? |
| joints | 1,000,000 frames of 32 joints and 32 commands | what does an audit cost beyond the reading? |
| episodes | 20,000,000 frames in 200,000 episodes | what does it cost beyond a bare read? |
| metadata | 1,000,000 episodes of 2 frames, a row group for each file | what does an episode cost? |
| frames | a quarter of `--frames`, and all of them | do CPU of a frame and memory of an episode stay? |

All are generated, into a folder that is removed at the end: 7 GB for a hundred million frames. polars and DuckDB are
put by `uv` into an environment of their own. They are asked for the smallest, the largest, the first and the last value
of each dimension of state and action in each episode, and for their sums, which is what `inspect` keeps. A bare read of
state and action keeps nothing: by `pq.read_table`, which is what one writes, and by a `ParquetFile` on mapped memory,
which is the leanest there is and what `inspect` is built on. Exit code 1 where a target is missed.

Measured on two busy cores of Linux, CPU [s] and peak memory, which counts mapped files:

| dataset | inspect | polars 2.1.0 | DuckDB 2.0.1 | `pq.read_table` | leanest pyarrow | audit |
| --- | --- | --- | --- | --- | --- | --- |
| 10,000 files of 100 frames | 2.3, 124 MiB | 2.3, 259 MiB | 1.9, 156 MiB | | 1.9, 82 MiB | 47, 280 MiB |
| 1,000,000 frames of 64 columns | 0.9, 242 MiB | | | | | 2.4, 365 MiB |
| 20,000,000 frames in 200,000 episodes | 6.6, 1.2 GiB | 26, 3.0 GiB | 23, 1.2 GiB | 16, 0.4 GiB | 3.9, 0.3 GiB | |
| 10,000,000 frames in one file, episodes of 1,000 | 226 MiB | | | | | 362 MiB |
| 1,000,000 episodes of 2 frames | 2.9, 0.8 GiB | 5 to 28, 0.6 GiB | 1.5, 0.6 GiB | | | 39, 5.3 GiB |
| 25,000,000 frames in 250,000 episodes | 16, 1.2 GiB | | | | | |
| 100,000,000 frames in 1,000,000 episodes | 68, 2.4 GiB | | | | | |

Of the hundred million, three quarters were copies of data files, whose bookkeeping `inspect` does not read. All but the
first row, without its audit, was measured once; with what else ran, CPU varied by half, and once by a factor of two.
Four times the frames take 4.3 times the CPU of `inspect` and 1.9 times its memory. If that goes on, which nobody
measured, a billion frames are eleven minutes of CPU, and what is kept of ten million episodes is 16 GiB.
"""

import argparse
import json
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from run import Z2R, Process, Row, alternate, even, median, print_rows, run_process

sys.path.insert(0, str(Path(__file__).resolve().parents[1]))

from layouts import (
    BOOKKEEPING,
    SHARD_PATH,
    Layout,
    data_files,
    lay_out,
    shard_files,
    to_arrow,
    write_dataset,
)

PEERS = ("polars==2.1.0", "duckdb==2.0.1", "pyarrow==26.0.1", "numpy==2.2.6")
LENGTH = 100  # frames of an episode

BARE = """
import sys
from pathlib import Path
import pyarrow.parquet as pq
for path in sorted(Path(sys.argv[1]).glob("data/*/*.parquet")):
    {read}
"""
READ_TABLE = BARE.format(read='pq.read_table(path, columns=["observation.state", "action"])')
LEANEST = BARE.format(read='pq.ParquetFile(path, memory_map=True).read(columns=["observation.state", "action"])')
POLARS = """
import sys
from pathlib import Path
import polars as pl
paths, sums = sorted(Path(sys.argv[1]).glob("data/*/*.parquet")), []
frames = pl.scan_parquet(paths)
for name, kind in frames.collect_schema().items():
    if name in ("observation.state", "action"):
        for place in range(kind.shape[0]):
            value, label = pl.col(name).arr.get(place), f"{name}{place}"
            sums += [getattr(value, what)().alias(label + what) for what in ("min", "max", "first", "last", "sum")]
print(frames.group_by("episode_index").agg(sums).collect(engine="streaming").shape)
"""
DUCKDB = """
import sys
import duckdb
source = f"read_parquet('{sys.argv[1]}/data/*/*.parquet')"
sizes = duckdb.sql(f'select len("observation.state"), len(action) from {source} limit 1').fetchall()[0]
sums = [
    f'{what}("{name}"[{place + 1}])'
    for name, size in zip(("observation.state", "action"), sizes)
    for place in range(size)
    for what in ("min", "max", "first", "last", "sum")
]
print(len(duckdb.sql(f"select episode_index, {', '.join(sums)} from {source} group by episode_index").fetchall()))
"""


INSPECT, AUDIT = [*Z2R, "inspect", "--no-rerun", "--dataset"], [*Z2R, "audit"]
# The audit of what is generated finds something, which is no failure.
FOUND = "import subprocess, sys; sys.exit(subprocess.run(sys.argv[1:]).returncode not in (0, 1))"


def grow(root: Path, n_files: int, n_episodes: int, length: int = LENGTH, in_a_group: int = 1) -> Path:
    """Lay out so many data files of so many episodes; all but the first repeat it a bit further on the table.

    LeRobot writes a row group for each episode.
    """
    lay_out(root, [length] * n_episodes, files=[n_episodes], shards=[n_episodes])
    table, shard = pq.read_table(data_files(root)[0]), pq.read_table(shard_files(root)[0])
    state = np.array(table["observation.state"].combine_chunks().flatten()).reshape(len(table), -1)
    pq.write_table(table, data_files(root)[0], row_group_size=in_a_group * length)
    for number in range(1, n_files):
        state[:, 0] += 1e-6
        moved = shifted(table, {"index": number * len(table), "episode_index": number * n_episodes})
        moved = put(moved, "observation.state", to_arrow(state))
        path = data_files(root)[0].with_name(f"file-{number:03d}.parquet")
        pq.write_table(moved, path, row_group_size=in_a_group * length)
        frames = dict.fromkeys(("dataset_from_index", "dataset_to_index"), number * len(table))
        files = dict.fromkeys(("data/file_index", "meta/episodes/file_index"), number)
        path = root / SHARD_PATH.format(chunk_index=0, file_index=number)
        pq.write_table(shifted(shard, {"episode_index": number * n_episodes} | frames | files), path)
    total = n_files * n_episodes
    info = json.loads((root / "meta/info.json").read_text())
    info |= {"total_episodes": total, "total_frames": total * length, "splits": {"train": f"0:{total}"}}
    (root / "meta/info.json").write_text(json.dumps(info))
    return root


def shifted(table: pa.Table, by: dict[str, int]) -> pa.Table:
    for name, much in by.items():
        table = put(table, name, pa.array(table[name].to_numpy() + much))
    return table


def put(table: pa.Table, name: str, values: pa.Array) -> pa.Table:
    return table.set_column(table.column_names.index(name), name, values)


def swing(root: Path, n_episodes: int, length: int, size: int, n_files: int) -> Path:
    """Lay out an arm whose joints follow smooth commands three frames later."""
    rng, time = np.random.default_rng(0), np.arange(n_episodes * length) / 30
    rate, phase = rng.uniform(0.1, 0.5, size), rng.uniform(0, 6, size)
    action = np.sin(time[:, None] * rate + phase).astype(np.float32)
    state = np.roll(action, 3, axis=0) + rng.normal(0, 1e-3, action.shape).astype(np.float32)
    names = [f"joint_{number}.pos" for number in range(size)]
    features = {name: {"dtype": "float32", "shape": [size], "names": names} for name in ("observation.state", "action")}
    layout = Layout(files=even(n_episodes, n_files), shards=[n_episodes])
    frames = {"observation.state": state, "action": action}
    write_dataset(root, frames, [length] * n_episodes, layout, features=features | BOOKKEEPING, fps=30)
    return root


def compare(name: str, root: Path, sides: dict[str, list[str]], targets: dict[str, float], runs: int) -> Iterator[Row]:
    """Run all sides in turn; say how much more CPU the first takes than each of the others, and how much memory."""
    work = [lambda command=command: run_process([*command, str(root)], root.parent) for command in sides.values()]
    measured = dict(zip(sides, alternate(*work, runs=runs), strict=True))
    ours, *others = sides
    for other in others:
        seconds = median(measured[ours], "cpu_seconds"), median(measured[other], "cpu_seconds")
        ratio, most = seconds[0] / seconds[1], targets[other]
        said = (f"{_said(measured[side])} ({side})" for side in (ours, other))
        yield Row(f"{name}: CPU", *said, ratio, f"<= {most:g}", ratio <= most)


def _said(runs: list[Process]) -> str:
    return f"{median(runs, 'cpu_seconds'):.2f} s, {median(runs, 'mebibytes'):.0f} MiB"


def growth(small: Path, large: Path, command: list[str], name: str, times: int) -> Iterator[Row]:
    """Say how much more CPU and memory a dataset takes that is so many times as large."""
    less, more = (run_process([*command, str(root)], root.parent) for root in (small, large))
    cpu, memory = more.cpu_seconds / less.cpu_seconds, more.mebibytes / less.mebibytes
    yield Row(
        f"{name}, {times} times the frames: CPU",
        f"{more.cpu_seconds:.1f} s",
        f"{less.cpu_seconds:.1f} s",
        cpu,
        f"<= {1.1 * times:g}",
        cpu <= 1.1 * times,
    )
    yield Row(
        f"{name}, {times} times the frames: peak memory",
        f"{more.mebibytes:.0f} MiB",
        f"{less.mebibytes:.0f} MiB",
        memory,
        f"<= {times}",
        memory <= times,
    )


def peers_in(folder: Path) -> str:
    """Make an environment for the peers, and return its interpreter."""
    python = str(folder / "bin/python")
    subprocess.run(["uv", "venv", "--quiet", "--python", sys.executable, str(folder)], check=True)
    subprocess.run(["uv", "pip", "install", "--quiet", "--python", python, *PEERS], check=True)
    return python


def measure(only: list[str], scratch: Path, n_frames: int, runs: int) -> Iterator[Row]:
    python = peers_in(scratch / "peers")
    polars, duckdb = {"polars": [python, "-c", POLARS]}, {"DuckDB": [python, "-c", DUCKDB]}
    inspect, audit = {"inspect": INSPECT}, {"audit": [sys.executable, "-c", FOUND, *AUDIT]}
    if "many" in only:
        root = scratch / "many"
        lay_out(root, [LENGTH] * 10_000, files=[1] * 10_000, shards=[10_000])
        yield from compare("10,000 files", root, inspect | polars | duckdb, {"polars": 1.2, "DuckDB": 1.2}, runs)
        yield from compare("10,000 files", root, audit | inspect, {"inspect": 10}, 1)
    if "joints" in only:
        root = swing(scratch / "joints", n_episodes=2_500, length=400, size=32, n_files=10)
        yield from compare("64 columns", root, audit | inspect, {"inspect": 2}, runs)
    if "episodes" in only:
        root, targets = grow(scratch / "episodes", 32, 6_250), {"polars": 0.6, "DuckDB": 0.6}
        targets |= {"pq.read_table": 0.8, "leanest pyarrow": 2}
        bare = {"pq.read_table": [sys.executable, "-c", READ_TABLE]}
        bare |= {"leanest pyarrow": [sys.executable, "-c", LEANEST]}
        yield from compare("200,000 episodes", root, inspect | bare | polars | duckdb, targets, runs)
    if "metadata" in only:
        root = grow(scratch / "metadata", 8, 125_000, length=2, in_a_group=125_000)
        yield from compare("1,000,000 episodes", root, inspect | polars | duckdb, {"polars": 1, "DuckDB": 1}, runs)
    if "frames" in only:
        n_files = max(4, n_frames // 1_000_000)
        quarter, whole = (grow(scratch / f"{n}", n, n_frames // LENGTH // n_files) for n in (n_files // 4, n_files))
        for name, command in (inspect | audit).items():
            yield from growth(quarter, whole, command, name, 4)


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--runs", type=int, default=3)
    parser.add_argument("--only", nargs="+", default=["many", "joints", "episodes", "metadata", "frames"])
    parser.add_argument("--frames", type=int, default=100_000_000)
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        rows = [*measure(args.only, Path(folder), args.frames, args.runs)]
    print_rows(rows)


if __name__ == "__main__":
    main()
