"""What is a check? Its name, what it asks, how bad an answer is, and the function that answers, in one place."""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal

from z2r.errors import Fault

type Severity = Literal["error", "warning", "note"]


@dataclass(frozen=True)
class Check[**P]:
    """One question that is asked of a dataset.

    Attributes
    ----------
    name : str
        Stable: scripts may rely on it.
    asks : str
        What holds where nothing is wrong, in a few words.
    severity : str
        How bad a fault is, unless the fault says otherwise. ``error``: a reader will fail or read something wrong.
        ``warning``: it looks wrong; have a look. ``note``: harmless, and better mended.
    run : callable
        Yields faults, or pairs of a severity and a fault.
    """

    name: str
    asks: str
    severity: Severity
    run: Callable[P, Iterator[Fault | tuple[Severity, Fault]]]
