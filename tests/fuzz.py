"""Damage datasets at random, and see that nothing but an answer comes of it. Run by hand:

    python tests/fuzz.py --seconds 600          # says what it finds, by the number of the case
    python tests/fuzz.py --case 12345           # shows that case again, with its traceback

A finding is: any exception of the reader but `DatasetError`, any exception or warning of the audit or of one of its
checks, a process that dies, and a case that takes more than 5 s or 1 GiB. With `--silent`, also what the audit is
silent on. Cases are made from their number alone. What a run finds is kept as a kind in `damages.py` or a case in
`test_untrusted.py`.
"""

import argparse
import json
import math
import random
import resource
import shutil
import signal
import subprocess
import sys
import tempfile
import time
import traceback
import warnings
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pyarrow as pa
import pyarrow.parquet as pq
from damages import BASES, DATA, EPISODES, INFO, TASKS, wrong_in
from layouts import STATS_PATH

import z2r
from z2r.audits.findings import AUDIT

SECONDS, PEAK = 5, 2**30
STUCK = 30  # seconds in one case
STATUS, CLEAR = Path("/proc/self/status"), Path("/proc/self/clear_refs")

FILES = (INFO, STATS_PATH, TASKS, EPISODES, DATA)
TABLES = (TASKS, EPISODES, EPISODES, DATA, DATA)

VALUES: tuple[Any, ...] = (
    *(None, True, False, 0, 1, -1, 2, 9, 10, 11, 427, 0.5, -0.0, 1e-300, 1e308, math.nan, math.inf),
    *(2**31, 2**63 - 1, 2**63, -(2**63), 10**30, 10**400, [10**6], [10**9, 10**9], [0], [-1], [], {}, [[]]),
    *("", "x", "v3.0", "v2.1", "float32", "int64", "video", "image", "string", "bool", "float16", "complex64", "0:6"),
    *(
        "../{file_index}",
        "{",
        "{}",
        "{chunk_index}",
        "data/{file_index:09d}",
        "\0",
        "\x1b[2J",
        "[red]",
        "a\nb",
        "\ud800",
    ),
    *("x" * 10**5, ["x"] * 10, {"motors": ["x"] * 10}, {"a": {"b": [1]}}, "observation.state", "action", "task_index"),
)
NUMBERS = (0, 1, -1, 2, 5, 6, 7, 66, 67, 68, 426, 427, 428, 10**6, 2**31, 2**62, 2**63 - 1, -(2**63))
FLOATS = (0.0, -0.0, 1.0, -1.0, 0.1, 1e-300, 1e30, 1e38, math.nan, math.inf, -math.inf)
KINDS = (
    *(
        pa.int8(),
        pa.int32(),
        pa.uint64(),
        pa.int64(),
        pa.float16(),
        pa.float32(),
        pa.float64(),
        pa.bool_(),
        pa.string(),
    ),
    *(
        pa.large_string(),
        pa.binary(),
        pa.null(),
        pa.timestamp("us"),
        pa.date32(),
        pa.duration("s"),
        pa.decimal128(30, 3),
    ),
    *(pa.list_(pa.int64()), pa.list_(pa.float32()), pa.list_(pa.float32(), 2), pa.large_list(pa.float64())),
    *(pa.list_(pa.list_(pa.float32())), pa.struct([("a", pa.int64())]), pa.dictionary(pa.int32(), pa.string())),
    *(pa.map_(pa.string(), pa.int64()), pa.list_(pa.float32(), 0), pa.list_(pa.string())),
)


# --- bytes


def flip_bytes(data: bytearray, rng: random.Random) -> None:
    for _ in range(rng.choice((1, 1, 2, 8, 64))):
        data[rng.randrange(len(data))] ^= rng.randrange(1, 256)


def flip_end(data: bytearray, rng: random.Random) -> None:
    """Flip what says most: the footer of a parquet file, the end of a text."""
    for _ in range(rng.choice((1, 2, 8))):
        data[-rng.randrange(1, min(len(data), 3000))] ^= 1 << rng.randrange(8)


def cut(data: bytearray, rng: random.Random) -> None:
    del data[rng.randrange(len(data)) :]


def cut_out(data: bytearray, rng: random.Random) -> None:
    start = rng.randrange(len(data))
    del data[start : start + rng.choice((1, 4, 100, 5000))]


def splice(data: bytearray, rng: random.Random) -> None:
    size = rng.choice((1, 8, 100, 3000))
    source, target = rng.randrange(len(data)), rng.randrange(len(data))
    data[target : target + size * rng.randrange(2)] = data[source : source + size]


def blank(data: bytearray, rng: random.Random) -> None:
    start, size = rng.randrange(len(data)), rng.choice((1, 8, 100, 3000))
    data[start : start + size] = bytes([rng.choice((0, 0xFF))]) * len(data[start : start + size])


def damage_bytes(root: Path, rng: random.Random) -> str:
    file, how = rng.choice(FILES), rng.choice((flip_bytes, flip_end, cut, cut_out, splice, blank))
    data = bytearray((root / file).read_bytes())
    how(data, rng)
    (root / file).write_bytes(data)
    return f"{file}: {how.__name__}"


# --- JSON


def places(value: Any, at: tuple = ()) -> Iterator[tuple]:
    """Yield the path to every value inside of another."""
    inner = value.items() if isinstance(value, dict) else enumerate(value) if isinstance(value, list) else ()
    for key, child in inner:
        yield (*at, key)
        yield from places(child, (*at, key))


def damage_json(root: Path, rng: random.Random) -> str:
    file = rng.choice((INFO, INFO, INFO, STATS_PATH))
    whole = json.loads((root / file).read_text())
    done = []
    for _ in range(rng.choice((1, 1, 1, 2, 3))):
        *outer, key = rng.choice(list(places(whole)))
        parent = whole
        for step in outer:
            parent = parent[step]
        place = ".".join(map(str, [*outer, key]))
        how = rng.choice(("set", "set", "set", "drop", "add", "wrap"))
        value = rng.choice(VALUES)
        if how == "drop":
            del parent[key]
        elif how == "wrap":
            parent[key] = [parent[key]] if rng.randrange(2) else {"a": parent[key]}
        elif how == "add" and isinstance(parent, dict):
            parent[str(rng.choice(VALUES))[:2000]] = parent[key]
        else:
            parent[key] = value
        done.append(f"{place}: {how} {str(value)[:60]!r}")
    (root / file).write_text(json.dumps(whole))
    return f"{file}: {'; '.join(done)}"


# --- columns


def set_values(table: pa.Table, name: str, rng: random.Random) -> pa.Table:
    values, kind = table.column(name).to_pylist(), table.schema.field(name).type
    for _ in range(rng.choice((1, 1, 3)) if values else 0):
        row = rng.randrange(len(values))
        pool = NUMBERS if pa.types.is_integer(kind) else FLOATS
        value = None if not rng.randrange(6) else rng.choice(pool)
        if isinstance(values[row], list) and values[row]:
            values[row][rng.randrange(len(values[row]))] = value
        else:
            values[row] = value
    return put_column(table, name, values, kind)


def set_all(table: pa.Table, name: str, rng: random.Random) -> pa.Table:
    return put_column(table, name, [rng.choice(NUMBERS)] * len(table), table.schema.field(name).type)


def set_kind(table: pa.Table, name: str, rng: random.Random) -> pa.Table:
    kind = rng.choice(KINDS)
    try:
        return table.set_column(table.schema.get_field_index(name), name, table.column(name).cast(kind))
    except (pa.ArrowException, NotImplementedError):
        pass
    return put_column(table, name, [None] * len(table), kind)


def resize(table: pa.Table, name: str, rng: random.Random) -> pa.Table:
    values = [
        (value * rng.randrange(3))[: rng.randrange(12)] if isinstance(value, list) and not rng.randrange(50) else value
        for value in table.column(name).to_pylist()
    ]
    kind = table.schema.field(name).type
    is_list = pa.types.is_list(kind) or pa.types.is_fixed_size_list(kind)
    return put_column(table, name, values, pa.list_(kind.value_type) if is_list else kind)


def drop(table: pa.Table, name: str, _: random.Random) -> pa.Table:
    return table.drop_columns(name)


def rename(table: pa.Table, name: str, rng: random.Random) -> pa.Table:
    new = rng.choice(("", "x", "\0", "[red]", "a.b", "stats/action/mean", *table.column_names))
    return table.rename_columns([new if other == name else other for other in table.column_names])


def shuffle_rows(table: pa.Table, _: str, rng: random.Random) -> pa.Table:
    return table.take(pa.array(rng.sample(range(len(table)), len(table)), pa.int64()))


def choose_rows(table: pa.Table, _: str, rng: random.Random) -> pa.Table:
    return table.take(pa.array(sorted(rng.choices(range(len(table)), k=rng.randrange(len(table) + 1))), pa.int64()))


def repeat(table: pa.Table, name: str, rng: random.Random) -> pa.Table:
    return table.append_column(rng.choice((name, "x")), table.column(name))


def put_column(table: pa.Table, name: str, values: list, kind: pa.DataType) -> pa.Table:
    try:
        column = pa.array(values, kind)
    except (pa.ArrowException, OverflowError, ValueError, TypeError):
        return table
    return table.set_column(table.schema.get_field_index(name), name, column)


HOW: tuple[Callable[[pa.Table, str, random.Random], pa.Table], ...] = (
    *(set_values, set_values, set_values, set_all, set_kind, set_kind, resize),
    *(drop, rename, shuffle_rows, choose_rows, repeat),
)


def damage_columns(root: Path, rng: random.Random) -> str:
    file = rng.choice(TABLES)
    table = pq.read_table(root / file)
    done = []
    for _ in range(rng.choice((1, 1, 1, 2))):
        names = table.column_names[:7] if rng.randrange(3) else table.column_names
        name, how = rng.choice(names), rng.choice(HOW)
        if table.column_names.count(name) == 1:
            table = how(table, name, rng)
            done.append(
                f"{how.__name__} {name} {table.schema.field(name).type if table.column_names.count(name) == 1 else ''}"
            )
        if not table.column_names:
            break
    pq.write_table(table, root / file, row_group_size=rng.choice((3, 100, 10**6)))
    return f"{file}: {'; '.join(done)}"


# --- one case


def make_case(number: int, folder: Path, bases: dict[str, Path]) -> tuple[Path, str]:
    rng = random.Random(number)
    base = rng.choice(list(bases))
    root = Path(shutil.copytree(bases[base], folder / "dataset"))
    how = rng.choice((damage_bytes, damage_json, damage_columns))
    return root, f"{base}: {how(root, rng)}"


def peak() -> int:
    return 1024 * int(STATUS.read_text().partition("VmHWM:")[2].split()[0]) if STATUS.exists() else 0


def judge(root: Path, *, silent: bool) -> Iterator[str]:
    """Yield what is wrong with what the audit and the reader make of a dataset."""

    def read() -> None:
        try:
            z2r.inspect_dataset(z2r.load(root))
        except z2r.DatasetError as fault:
            check_line(str(fault))

    def audit() -> None:
        found = z2r.audit(root)
        for finding in found.findings:
            check_line(str(finding))
            if finding.check == AUDIT.name:
                raise AssertionError(f"a check failed: {finding}")
        json.dumps(found.to_dict("x"))
        if silent and not wrong_in(found):
            raise AssertionError("the audit says nothing")

    for what in (audit, read):
        if CLEAR.exists():
            CLEAR.write_text("5")
        before, started = peak(), time.perf_counter()
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("error" if what is audit else "ignore")
                what()
        except Exception as error:
            place = traceback.extract_tb(error.__traceback__)[-1]
            yield f"{what.__name__}: {error!r:.200} at {Path(place.filename).name}:{place.lineno}"
        if time.perf_counter() - started > SECONDS:
            yield f"{what.__name__}: {time.perf_counter() - started:.0f} s"
        if peak() - before > PEAK:
            yield f"{what.__name__}: {(peak() - before) / 2**30:.1f} GiB"


def check_line(line: str) -> None:
    if not line.isprintable() or len(line) > 1000:
        raise AssertionError(f"a line that is not printable, or too long: {line[:100]!r}")


def work(first: int, until: float, silent: bool) -> None:
    """Go through cases, and print the number of each before it is begun."""
    resource.setrlimit(resource.RLIMIT_AS, (6 * 2**30, 6 * 2**30))
    with tempfile.TemporaryDirectory() as folder:
        bases = {name: Path(folder) / name for name in ("standin", "split")}
        for name, path in bases.items():
            BASES[name](path)
        number = first
        while time.time() < until:
            print(json.dumps([number, "begun"]), flush=True)
            signal.alarm(STUCK)  # which ends the process
            with tempfile.TemporaryDirectory() as scratch:
                root, what = make_case(number, Path(scratch), bases)
                for wrong in judge(root, silent=silent):
                    print(json.dumps([number, f"{wrong} <- {what}".replace(scratch, "")]), flush=True)
            number += 1


def watch(first: int, seconds: float, silent: bool) -> int:
    """Let another process go through the cases, and begin after the one at which it dies or gets stuck."""
    until, number, found = time.time() + seconds, first, 0
    while time.time() < until:
        args = [
            sys.executable,
            __file__,
            "--work",
            "--first",
            str(number),
            "--until",
            str(until),
            *["--silent"] * silent,
        ]
        with subprocess.Popen(args, stdout=subprocess.PIPE, text=True) as worker:
            assert worker.stdout is not None
            for line in worker.stdout:
                number, what = json.loads(line)
                if what != "begun":
                    found += 1
                    print(f"case {number}: {what}", flush=True)
        if worker.returncode:
            found += 1
            print(f"case {number}: the process ended with {worker.returncode}", flush=True)
        number += 1
    print(f"{number - first} cases, {found} findings")
    return min(found, 1)


def show(number: int) -> None:
    with tempfile.TemporaryDirectory() as folder:
        bases = {name: Path(folder) / name for name in ("standin", "split")}
        for name, path in bases.items():
            BASES[name](path)
        (Path(folder) / "case").mkdir()
        root, what = make_case(number, Path(folder) / "case", bases)
        print(what)
        for run in (z2r.audit, lambda root: z2r.inspect_dataset(z2r.load(root))):
            try:
                answer = run(root)
            except Exception:
                traceback.print_exc()
            else:
                for finding in getattr(answer, "findings", ["read"]):
                    print(f"  {finding}")


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seconds", type=float, default=60)
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument("--case", type=int, help="show this case")
    parser.add_argument("--silent", action="store_true")
    parser.add_argument("--work", action="store_true", help=argparse.SUPPRESS)
    parser.add_argument("--until", type=float, help=argparse.SUPPRESS)
    args = parser.parse_args()
    if args.case is not None:
        show(args.case)
    elif args.work:
        work(args.first, args.until, args.silent)
    else:
        sys.exit(watch(args.first, args.seconds, args.silent))


if __name__ == "__main__":
    main()
