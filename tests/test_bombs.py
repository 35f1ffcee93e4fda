"""A few bytes on disk may be very many in memory: their number is believed before they are spent, and refused.

Each bomb is a dataset whose files are small, in which one column repeats something large.
"""

import json
import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from damages import DATA, EPISODES, STATE, TASKS

import z2r
from z2r.format.tables import STATS_PATH
from z2r.reading.verdict import verdict_path

MAX_MIB = 400

READ = """
import resource
from z2r.cli import main

try:
    main()
except SystemExit as end:
    print(end.code)
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024)
"""
COMMANDS = {
    "inspect": ["--no-rerun", "--out", "out"],
    "audit": ["--json"],
    "report": ["--out", "page.html"],
}


def add(root: Path, file: str, name: str, column: pa.Array) -> None:
    """Put a column in the place of another, or beside the others."""
    table = pq.read_table(root / file)
    others = table.drop_columns([name]) if name in table.column_names else table
    pq.write_table(others.append_column(name, column), root / file, compression="zstd")


def lists(n_rows: int, size: int, dtype: type) -> pa.Array:
    offsets = pa.array(np.arange(n_rows + 1) * size, pa.int32())
    return pa.ListArray.from_arrays(offsets, pa.array(np.zeros(n_rows * size, dtype)))


def frames(root: Path) -> None:
    add(root, DATA, STATE, lists(427, 400_000, np.float32))


def statistics(root: Path) -> None:
    add(root, EPISODES, f"stats/{STATE}/mean", lists(6, 25_000_000, np.float64))


def text_of_episodes(root: Path) -> None:
    add(root, EPISODES, "note", pa.array(["x" * 2**26] * 6))


def tasks_of_episodes(root: Path) -> None:
    texts = pa.array(["x" * 2**20] * 600)
    add(root, EPISODES, "tasks", pa.ListArray.from_arrays(pa.array(np.arange(7) * 100, pa.int32()), texts))


def one_task(root: Path) -> None:
    pq.write_table(pa.table({"task_index": [0], "task": ["x" * 2**28]}), root / TASKS, compression="zstd")


def many_tasks(root: Path) -> None:
    table = pa.table({"task_index": np.arange(1_000), "task": ["x" * 2**20] * 1_000})
    pq.write_table(table, root / TASKS, compression="zstd")


# Which file is named, and whether `inspect` must read what is in it.
BOMBS = {
    frames: (DATA, True),
    statistics: (EPISODES, False),
    text_of_episodes: (EPISODES, False),
    tasks_of_episodes: (EPISODES, False),
    one_task: (TASKS, False),
    many_tasks: (TASKS, False),
}


def run(command: str, root: Path) -> tuple[int, int, str]:
    """Run a command in a process of its own: its exit code, its peak memory [MiB], and all that it said."""
    launch = "import subprocess, sys; sys.exit(subprocess.run(sys.argv[1:]).returncode)"  # who has a peak of its own
    words = [sys.executable, "-c", launch, sys.executable, "-c", READ, command, str(root), *COMMANDS[command]]
    done = subprocess.run(words, capture_output=True, text=True, cwd=root.parent, check=True)
    *said, code, peak = done.stdout.splitlines()
    return int(code), int(peak), "\n".join([*said, done.stderr])


@pytest.mark.parametrize("bomb", BOMBS, ids=lambda bomb: bomb.__name__)
def test_what_a_few_bytes_claim_is_not_spent(bomb, tmp_path):
    root = tmp_path / "dataset"
    shutil.copytree(z2r.STANDIN, root)
    bomb(root)
    file, is_read = BOMBS[bomb]
    assert (root / file).stat().st_size < 200_000
    for command in COMMANDS:
        code, peak, said = run(command, root)
        assert peak < MAX_MIB, command
        if command == "audit":
            assert code in (1, 3)
            [finding, *_] = [each for each in json.loads(said)["findings"] if each["file"] == file]
            assert finding["severity"] == "error"
            assert finding["expected"]
        elif is_read:
            assert (code, file in said) == (2, True)


@pytest.mark.parametrize("file", [lambda root: root / STATS_PATH, verdict_path], ids=["statistics", "verdict"])
def test_a_file_beside_the_frames_has_a_largest_size(file, tmp_path):
    root = tmp_path / "dataset"
    shutil.copytree(z2r.STANDIN, root)
    with file(root).open("wb") as written:
        written.truncate(2**32)  # which takes nothing on disk
    code, peak, said = run("audit", root)
    assert peak < MAX_MIB
    assert code == 1
    assert any(file(root).name in finding["file"] for finding in json.loads(said)["findings"])
