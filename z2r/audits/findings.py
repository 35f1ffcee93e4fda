"""What was found, what was expected, how to mend it, and which check says so: a finding."""

import hashlib
import re
from collections.abc import Iterable, Iterator
from pathlib import Path

import msgspec

from z2r.check import Answer, Check, Part, Severity
from z2r.errors import Fault, printable, short

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


def finding(check: Check, answer: Answer) -> Finding:
    """Name what a check answers."""
    severity, fault = (check.severity, answer) if isinstance(answer, Fault) else answer
    place, field, found, expected = (short(part) for part in (fault.path.as_posix(), *fault[1:4]))
    return Finding(check.name, severity, place, field, found, expected, fault.mend, fault.episodes, fault.frame)


def failed(what: str, error: Exception) -> Finding:
    """Say that the audit itself went wrong, so that its silence is not taken for health."""
    found = f"{type(error).__name__}: {error}"
    return finding(AUDIT, Fault(Path(), what, found, "it to run to its end", _REPORT))


def ask[T](parts: Iterable[Part[T]], subject: T) -> Iterator[Finding]:
    """Ask all that there is to ask of one subject; a check that fails is a finding, and never the end."""
    for part in parts:
        try:
            yield from [finding(part.check, answer) for answer in part.run(subject)]
        except Exception as error:
            yield failed(part.check.name, error)
