"""A finding: what was found, what was expected, how to mend it, and the check that says so."""

from pathlib import Path
from typing import Literal

import msgspec

from z2r.errors import DatasetError, printable, short

type Severity = Literal["error", "warning", "note"]


class Finding(msgspec.Struct, frozen=True):
    """One thing that is wrong with a dataset.

    Attributes
    ----------
    check : str
        The name of the check, one of `z2r.audits.CHECKS`.
    severity : str
        ``error``: a reader will fail or read something wrong. ``warning``: it looks wrong; have a look.
        ``note``: harmless, and better mended.
    file : str
        The file at fault, relative to the dataset; ``.`` for the folder itself.
    field : str
        The key, column or place in it; empty where it is the whole file.
    found, expected : str
        What is there, and what should be.
    mend : str
        What to do about it.

    Examples
    --------
    >>> print(Finding("totals", "error", "meta/info.json", "total_frames", "444", "427, as meta/episodes says", ""))
    meta/info.json: total_frames: found 444, expected 427, as meta/episodes says
    """

    check: str
    severity: Severity
    file: str
    field: str
    found: str
    expected: str
    mend: str

    def __str__(self) -> str:
        where = ": ".join(filter(None, [self.file, self.field]))
        advice = f". {self.mend}" if self.mend else ""
        return printable(f"{where}: found {self.found}, expected {self.expected}{advice}")


def error(check: str, file: Path | str, field: str, found: object, expected: object, mend: str = "") -> Finding:
    """Return a finding that is an error; `file` is relative to the dataset."""
    return _finding(check, "error", file, field, found, expected, mend)


def warning(check: str, file: Path | str, field: str, found: object, expected: object, mend: str = "") -> Finding:
    """Return a finding that is a warning; `file` is relative to the dataset."""
    return _finding(check, "warning", file, field, found, expected, mend)


def note(check: str, file: Path | str, field: str, found: object, expected: object, mend: str = "") -> Finding:
    """Return a finding that is a note; `file` is relative to the dataset."""
    return _finding(check, "note", file, field, found, expected, mend)


def from_fault(check: str, fault: DatasetError, root: Path) -> Finding:
    """Turn what the reader raised into a finding that is an error."""
    return _finding(check, "error", *fault.fault.relative_to(root))


def _finding(
    check: str, severity: Severity, file: Path | str, field: str, found: object, expected: object, mend: str
) -> Finding:
    place = Path(file).as_posix()
    return Finding(check, severity, short(place), short(field), short(found), short(expected), mend)
