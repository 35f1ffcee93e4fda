"""What is a check? Its name, what it asks, how bad an answer is, and the functions that answer, in one place.

A check is declared once, above the function that answers it; who runs it finds it there:

    @Check("file-order", "files sorted by name are sorted by number, as LeRobot reads them", "warning").of(Claims)
    def file_order(claims: Claims) -> Iterator[Answer]: ...

What is asked in several places is a constant, and each place is one part of it.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from types import ModuleType
from typing import Any, Literal

from z2r.errors import Fault

type Severity = Literal["error", "warning", "note"]

SEVERITIES: tuple[Severity, ...] = ("error", "warning", "note")
"""All of them, the worst first."""

type Answer = Fault | tuple[Severity, Fault]
"""What is wrong; with a severity where it is not that of the check."""


@dataclass(frozen=True)
class Check:
    """One question that is asked of a dataset.

    Attributes
    ----------
    name : str
        Stable: scripts may rely on it.
    asks : str
        What holds where nothing is wrong, in a few words.
    severity : str
        How bad an answer is, unless it says otherwise. ``error``: a reader will fail or read something wrong.
        ``warning``: it looks wrong; have a look. ``note``: good to know, and nothing fails because of it.
    """

    name: str
    asks: str
    severity: Severity

    def of[T](self, subject: type[T]) -> Callable[[Callable[[T], Iterator[Answer]]], "Part[T]"]:
        """Return a decorator: the function below it asks this of a `subject`, and yields what is wrong."""
        return lambda run: Part(self, subject, run)


@dataclass(frozen=True)
class Part[T]:
    """A check, what it is asked of, and the function that answers."""

    check: Check
    subject: type[T]
    run: Callable[[T], Iterator[Answer]]


def parts_in(*modules: ModuleType) -> tuple[Part[Any], ...]:
    """Return all parts of checks that modules declare, in the order in which they stand there."""
    return tuple(value for module in modules for value in vars(module).values() if isinstance(value, Part))


def asked_of[T](subject: type[T], parts: tuple[Part[Any], ...]) -> tuple[Part[T], ...]:
    """Return those of the parts that are asked of one kind of subject."""
    return tuple(part for part in parts if part.subject is subject)
