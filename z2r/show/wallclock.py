"""How long will it take here? A ledger of runs that were measured, by kind of machine.

`wallclock.csv` holds one row for each kind of run that was measured: the median of several whole processes. What nobody
measured has no row, and nothing is estimated from one: a tier, or a size, is measured or it is not.
"""

import csv
import platform
import shutil
import subprocess
from dataclasses import dataclass
from pathlib import Path

LEDGER = Path(__file__).with_name("wallclock.csv")
TIERS = ("cpu-laptop", "mps", "t4", "4090")
NOT_YET = "not yet measured"

_GPUS = {"T4": "t4", "4090": "4090"}  # part of the name that the driver gives a device -> its tier


@dataclass(frozen=True)
class Run:
    """One measured kind of run.

    Attributes
    ----------
    tier : str
        Kind of machine, one of `TIERS`.
    command : str
        Such as ``inspect --no-rerun``.
    size : int
        How much was read or recorded, in `unit`.
    unit : str
        ``frames``, or ``episodes`` of a recording.
    seconds : float
        Median wall-clock time of the whole process [s].
    runs : int
        How many runs the median is of.
    stack : str
        The machine, and the versions that matter.
    """

    tier: str
    command: str
    size: int
    unit: str
    seconds: float
    runs: int
    stack: str

    def __str__(self) -> str:
        return f"{self.size:,} {self.unit} in {self.seconds:.2f} s"


class LedgerTable(str):
    """A table in Markdown, which a notebook renders."""

    def __repr__(self) -> str:
        return str(self)

    def _repr_markdown_(self) -> str:
        return str(self)


def machine_tier() -> str:
    """Name the kind of machine that this is: one of `TIERS`. What has none of the accelerators is a `cpu-laptop`."""
    if (platform.system(), platform.machine()) == ("Darwin", "arm64"):
        return "mps"
    return next((tier for name, tier in _GPUS.items() if name in _gpus()), "cpu-laptop")


def _gpus() -> str:
    """Return what the driver calls the devices, a line each; nothing where there is no driver, or none that answers."""
    asked = shutil.which("nvidia-smi")
    if asked is None:
        return ""
    command = [asked, "--query-gpu=name", "--format=csv,noheader"]
    try:
        return subprocess.run(command, capture_output=True, text=True, timeout=5, check=False).stdout
    except (OSError, subprocess.TimeoutExpired):
        return ""


def read_ledger() -> list[Run]:
    """Return every measured run, small before large."""
    with LEDGER.open(newline="") as file:
        return sorted(map(_run, csv.DictReader(file)), key=lambda run: run.size)


def _run(row: dict[str, str]) -> Run:
    size, seconds, runs = int(row["size"]), float(row["seconds"]), int(row["runs"])
    return Run(row["tier"], row["command"], size, row["unit"], seconds, runs, row["stack"])


def expectation(command: str, size: int, tier: str) -> str:
    """Say what was measured for a run that is to come: the shortest one that was not smaller, if there is any.

    Parameters
    ----------
    command : str
        As in the ledger.
    size : int
        How much there is to read or record, in the unit of the command.
    tier : str
        Kind of machine.

    Examples
    --------
    >>> expectation("inspect", 10**12, "cpu-laptop")
    'not yet measured at this size'
    >>> expectation("inspect", 427, "t4")
    'not yet measured'
    """
    runs = [run for run in read_ledger() if (run.tier, run.command) == (tier, command)]
    if not runs:
        return NOT_YET
    enough = next((run for run in runs if run.size >= size), None)
    return f"measured: {enough}" if enough else f"{NOT_YET} at this size"


def ledger_table() -> LedgerTable:
    """Return the ledger as a table: a row for each kind of run, a column for each tier, measured or not.

    Examples
    --------
    >>> print(ledger_table().splitlines()[0])
    | `z2r` | of | cpu-laptop | mps | t4 | 4090 |
    """
    ledger = read_ledger()
    seconds = {(run.command, run.size, run.tier): f"{run.seconds:.2f} s" for run in ledger}
    kinds = sorted({(run.command, run.size, run.unit) for run in ledger})
    rows = [("`z2r`", "of", *TIERS), ("---",) * (2 + len(TIERS))]
    for command, size, unit in kinds:
        cells = [seconds.get((command, size, tier), NOT_YET) for tier in TIERS]
        rows.append((f"`{command}`", f"{size:,} {unit}", *cells))
    stacks = sorted({f"{run.tier}: medians of {run.runs} runs; {run.stack}." for run in ledger})
    return LedgerTable("\n".join([*("| " + " | ".join(row) + " |" for row in rows), "", *stacks]))
