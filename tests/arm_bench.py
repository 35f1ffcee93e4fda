"""How many faults of a recording does the audit name, and of how many healthy datasets does it say something?

    PYTHONPATH=. python tests/arm_bench.py [--only TEXT] [--healthy | --damages] [--first SEED] [--seeds N] [--wrong]

Each dataset is made, written and audited, its pictures decoded where there are videos. A fault is *named* where a
finding that its healthy twin has not is about the right thing: it names the column that is at fault, and the episode or
the frame. It is *seen* where there is a finding that is not about that; else it is *silent*. A note counts as a finding
of a fault, and is no alarm on what is healthy. A kind that nobody could know of is marked by a `?`, and is not counted.
Exit code 1 where a decidable fault is not named, or a healthy dataset is not left alone.
"""

import argparse
import logging
import os
import sys
import tempfile
import warnings
from collections import Counter
from collections.abc import Iterable, Sequence
from concurrent.futures import ProcessPoolExecutor
from functools import cache
from pathlib import Path
from typing import NamedTuple

from arm_cameras import CAMERA_CASES, CAMERA_KINDS, ON_VIDEO_FILES, copy_filmed, write_camera_case
from arm_damages import CASES, KINDS, Case, write_case
from arms import make, write
from healthy import EDITED, SHAPES, write_healthy

import z2r

ALL_KINDS = KINDS | CAMERA_KINDS
NAMED, SEEN, SILENT, BROKEN = "named", "seen", "SILENT", "BROKEN"


type Job = tuple[str, str, int]
"""A kind or a shape, its variant, and a seed."""


class Row(NamedTuple):
    """What came of one dataset: its checks with their findings, and the verdict."""

    kind: str
    variant: str
    seed: int
    verdict: str
    checks: tuple[str, ...]
    texts: tuple[str, ...]


def findings(root: Path, *, notes: bool, pictures: bool = False) -> list[tuple[str, str]]:
    """The check and the text of each finding; of notes, only where they are wanted."""
    found = z2r.audit(root, pictures=pictures).findings
    return [(own.check, str(own)) for own in found if notes or own.severity != "note"]


@cache
def of_the_healthy(robot: str | None, seed: int) -> frozenset[str]:
    """What is said of a robot of which nothing is wrong; of the one that is filmed, if None."""
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder) / "dataset"
        write(make(robot, seed), root) if robot else copy_filmed(root, seed)
        return frozenset(text for _, text in findings(root, notes=True, pictures=robot is None))


def try_damage(name: str, variant: str, seed: int) -> Row:
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder) / "dataset"
        case = (write_camera_case if name in CAMERA_KINDS else write_case)(name, variant, root, seed)
        if name not in ON_VIDEO_FILES:
            z2r.load(root)  # what was recorded wrongly can be read
        found = findings(root, notes=True, pictures=name in CAMERA_KINDS)
    before = of_the_healthy(None if name in CAMERA_KINDS else case.kind.robot, seed)
    return _row(name, variant, seed, verdict(case, [text for _, text in found if text not in before]), found)


def verdict(case: Case, texts: Iterable[str]) -> str:
    texts = list(texts)
    return NAMED if any(map(case.is_named_by, texts)) else SEEN if texts else SILENT


def try_healthy(name: str, seed: int) -> Row:
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder) / "dataset"
        write_healthy(name, root, seed)
        z2r.load(root)
        found = findings(root, notes=False, pictures=(root / "videos").exists())
    return _row(name, "healthy", seed, SEEN if found else SILENT, found)


def _row(kind: str, variant: str, seed: int, says: str, found: list[tuple[str, str]]) -> Row:
    checks = Counter(check for check, _ in found)
    return Row(
        kind, variant, seed, says, tuple(f"{n} {name}" for name, n in checks.items()), tuple(t for _, t in found)
    )


def attempt(job: Job) -> Row:
    kind, variant, seed = job
    try:
        return try_healthy(kind, seed) if variant == "healthy" else try_damage(kind, variant, seed)
    except Exception as error:  # one dataset that cannot be made must not hide all others
        return Row(kind, variant, seed, BROKEN, (type(error).__name__,), (str(error),))


def attempt_all(jobs: Sequence[Job]) -> list[Row]:
    return [attempt(job) for job in jobs]


def batches(jobs: Sequence[Job]) -> list[list[Job]]:
    """What one process does at a time: LeRobot is slow to import, and what it records is recorded only once so."""
    by_lerobot = [job for job in jobs if job[0] in EDITED]
    others = [job for job in jobs if job[0] not in EDITED]
    return [by_lerobot, *(others[first : first + 8] for first in range(0, len(others), 8))]


def prepare(folder: str) -> None:
    """Write below a folder that goes away; and LeRobot, where it is imported, has much to say of what it lacks."""
    tempfile.tempdir = folder
    os.environ |= {"HF_HUB_OFFLINE": "1", "TQDM_DISABLE": "1", "SVT_LOG": "1"}
    logging.disable()
    warnings.simplefilter("ignore")


def counted(row: Row) -> bool:
    return row.variant == "healthy" or not ALL_KINDS[row.kind].why_not(row.variant)


def wrong(row: Row) -> bool:
    """Whether a row is not as it should be."""
    return row.verdict != (SILENT if row.variant == "healthy" else NAMED) and counted(row)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--only", default="", help="kinds, shapes and variants whose name holds this text")
    parser.add_argument("--first", type=int, default=0, help="the first seed")
    parser.add_argument("--seeds", type=int, default=1, help="how many seeds")
    parser.add_argument("--healthy", action="store_true", help="healthy shapes only")
    parser.add_argument("--damages", action="store_true", help="faults only")
    parser.add_argument("--wrong", action="store_true", help="print only what is not as it should be")
    parser.add_argument("--texts", type=int, default=1, help="how many findings to print of each dataset")
    options = parser.parse_args()
    shapes = [] if options.damages else [(name, "healthy") for name in SHAPES]
    faults = [] if options.healthy else [*CASES, *CAMERA_CASES]
    seeds = range(options.first, options.first + options.seeds)
    jobs = [(*what, seed) for what in [*shapes, *faults] for seed in seeds if options.only in "/".join(what)]
    with (
        tempfile.TemporaryDirectory() as folder,
        ProcessPoolExecutor(2, initializer=prepare, initargs=(folder,)) as pool,
    ):
        rows = [row for batch in pool.map(attempt_all, batches(jobs)) for row in batch]
    show([row for row in rows if wrong(row) or not options.wrong], options.texts)
    sum_up(rows)
    return int(any(map(wrong, rows)))


def show(rows: Iterable[Row], n_texts: int) -> None:
    for row in rows:
        mark = "" if counted(row) else "?"
        print(f"{row.verdict + mark:8} {row.kind}/{row.variant} #{row.seed}  {', '.join(row.checks)}")
        for text in row.texts[:n_texts] if wrong(row) else ():
            print(f"           {text}")


def sum_up(rows: Iterable[Row]) -> None:
    rows = list(rows)
    for title, own in {
        "healthy": [row for row in rows if row.variant == "healthy"],
        "faults": [row for row in rows if row.variant != "healthy" and counted(row)],
        "undecidable": [row for row in rows if not counted(row)],
    }.items():
        counts = Counter(row.verdict for row in own)
        print(f"{title}: {len(own)}; " + ", ".join(f"{n} {name}" for name, n in counts.most_common()))


if __name__ == "__main__":
    sys.exit(main())
