"""What was found, what was expected, how to mend it, and which check says so: a finding."""

import hashlib
import re
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import NamedTuple

import msgspec

from z2r.check import Check, Part, Severity
from z2r.errors import Fault, printable, short
from z2r.format import rules

AUDIT = Check("audit", "every check of the audit ran to its end", "warning")
_REPORT = "This is a fault of z2r and not of the dataset: https://github.com/zero2robot/seeing-like-a-robot/issues"


class Finding(msgspec.Struct, frozen=True):
    """One thing that is wrong with a dataset.

    Attributes
    ----------
    check : str
        The name of the check, one of `z2r.api.CHECKS`.
    severity : str
        ``error``: a reader will fail or read something wrong. ``warning``: it looks wrong; have a look.
        ``note``: good to know, and nothing fails because of it.
    file : str
        The file at fault, relative to the dataset; ``.`` for the folder itself.
    field : str
        The key, column or place in it; empty where it is the whole file.
    found, expected : str
        What is there, and what should be.
    mend : str
        What to do about it.
    episodes : tuple of int
        The `episode_index` of every episode that it is about; empty where it is about none of them in particular.
    frame : int or None
        The `index` of the frame where it is worst, or seen first; None where it is in no frame in particular.

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
    episodes: tuple[int, ...] = ()
    frame: int | None = None

    @property
    def fingerprint(self) -> str:
        """What tells it from other findings, as 16 hex digits, whatever order they come in.

        The numbers in what was found and expected do not count: they change with every episode that is recorded.
        """
        said = re.sub(r"\d[\d.,]*", "#", f"{self.found}\0{self.expected}")
        parts = "\0".join((self.check, self.severity, self.file, self.field, said))
        return hashlib.sha256(parts.encode(errors="backslashreplace")).hexdigest()[:16]

    def __str__(self) -> str:
        where = ": ".join(filter(None, [self.file, self.field]))
        advice = f". {self.mend}" if self.mend else ""
        return printable(f"{where}: found {self.found}, expected {self.expected}{advice}")


class Said(NamedTuple):
    """What a part of a check answered: the name of its function, the check, how bad it is, and what is wrong."""

    part: str
    check: Check
    severity: Severity
    fault: Fault

    @property
    def finding(self) -> Finding:
        """It, with the name of the check."""
        fault = self.fault
        place, field, found, expected = (short(part) for part in (fault.path.as_posix(), *fault[1:4]))
        return Finding(
            self.check.name, self.severity, place, field, found, expected, fault.mend, fault.episodes, fault.frame
        )


def failed(what: str, error: Exception) -> Finding:
    """Say that the audit itself went wrong, so that its silence is not taken for health."""
    return _failed(what, error).finding


def ask[T](parts: Iterable[Part[T]], subject: T) -> Iterator[Finding]:
    """Ask all that there is to ask of one subject; a check that fails is a finding, and never the end."""
    return (said.finding for said in answers(parts, subject))


def answers[T](parts: Iterable[Part[T]], subject: T) -> Iterator[Said]:
    """Ask as `ask` does, and say which part of a check answered what."""
    for part in parts:
        try:
            for answer in list(part.run(subject)):
                severity, fault = (part.check.severity, answer) if isinstance(answer, Fault) else answer
                yield Said(part.run.__name__, part.check, severity, fault)
        except Exception as error:
            yield _failed(part.check.name, error)


def together(said: Iterable[Said]) -> list[Said]:
    """Put what the same part of a check says of the same column in several blocks of rows into one, by the first row.

    The place of what is wrong with rows ends with the number of the first one (`FileFrames.fault`).
    """
    same: dict[tuple[str, str, str], list[Said]] = {}
    for each in said:
        same.setdefault((each.part, each.severity, re.sub(r"\d+$", "", each.fault.field)), []).append(each)
    joined = [every[0]._replace(fault=rules.together([each.fault for each in every])) for every in same.values()]
    return sorted(joined, key=_first_row)


def _first_row(said: Said) -> int:
    number = re.search(r"\d+$", said.fault.field)
    return int(number[0]) if number else -1


def _failed(what: str, error: Exception) -> Said:
    found = f"{type(error).__name__}: {error}"
    fault = Fault(Path(), what, found, "it to run to its end", _REPORT)
    return Said("", AUDIT, AUDIT.severity, fault)
