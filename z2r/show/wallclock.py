"""How long will it take here? A ledger of runs that were measured, by kind of machine.

`wallclock.csv` holds one row for each kind of run that was measured: the median of several whole processes. A tier
that nobody measured has no row.
"""

import csv
import os
import platform
from dataclasses import dataclass
from pathlib import Path

LEDGER = Path(__file__).with_name("wallclock.csv")


@dataclass(frozen=True)
class Run:
    """One measured kind of run.

    Attributes
    ----------
    tier : str
        Kind of machine, as `machine_tier` names it.
    command : str
        ``inspect``, ``inspect --no-rerun`` or ``record``.
    size : int
        How much was read or recorded: frames for ``inspect``, episodes for ``record``.
    seconds : float
        Median wall-clock time of the whole process [s].
    runs : int
        How many runs the median is of.
    stack : str
        The versions that matter.
    """

    tier: str
    command: str
    size: int
    seconds: float
    runs: int
    stack: str


def machine_tier() -> str:
    """Name the kind of machine that this is: where it runs, and how many cores it has.

    Returns
    -------
    str
        Such as ``linux-x86_64-2-cores``, or ``colab-2-cores``.
    """
    place = "colab" if "COLAB_RELEASE_TAG" in os.environ else f"{platform.system()}-{platform.machine()}".lower()
    return f"{place}-{os.cpu_count()}-cores"


def read_ledger() -> list[Run]:
    """Return every measured run."""
    with LEDGER.open(newline="") as file:
        return [
            Run(row["tier"], row["command"], int(row["size"]), float(row["seconds"]), int(row["runs"]), row["stack"])
            for row in csv.DictReader(file)
        ]


def nearest_run(command: str, size: int, tier: str | None = None) -> Run | None:
    """Return the measured run that tells most about one that is to come.

    Parameters
    ----------
    command : str
        As in the ledger.
    size : int
        How much there is to read or record, in the unit of the command.
    tier : str, optional
        Kind of machine; this one unless given.

    Returns
    -------
    Run or None
        The shortest run of at least this size, or else the longest; None where nobody measured this tier.
    """
    tier = tier or machine_tier()
    runs = sorted(
        (run for run in read_ledger() if (run.tier, run.command) == (tier, command)), key=lambda run: run.size
    )
    return next((run for run in runs if run.size >= size), runs[-1] if runs else None)
