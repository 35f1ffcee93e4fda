"""What is wrong with a dataset: one record for who stops at the first fault and for who collects them all."""

import contextlib
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

MAX_LENGTH = 200  # of one part of a line: a dataset may give a name, or a number, of any length
_SOME = 8  # names or numbers in one line: more say no more


class Fault(NamedTuple):
    """One thing that is wrong: where, what was found, what was expected, and how to mend it.

    Attributes
    ----------
    path : Path
        The file or folder at fault. A rule that is given no folder names it relative to the dataset.
    field : str
        The key, column or part of it at fault; empty when it is the whole file.
    found, expected : object
        What is there, and what should be; written with `str`.
    mend : str
        What to do about it: a command where there is one; empty where nothing better can be said than what is expected.
    episodes : tuple of int
        The `episode_index` of every episode that it is about; empty where it is about none of them in particular.
    frame : int or None
        The `index` of the frame where it is worst, or seen first; None where it is in no frame in particular.

    Examples
    --------
    >>> print(Fault(Path("meta/info.json"), "fps", -10, "a positive number"))
    meta/info.json: fps: found -10, expected a positive number
    """

    path: Path
    field: str
    found: object
    expected: object
    mend: str = ""
    episodes: tuple[int, ...] = ()
    frame: int | None = None

    def below(self, root: Path) -> "Fault":
        """Return the fault with its path, which is relative to the dataset, below `root`."""
        return self._replace(path=root / self.path)

    def relative_to(self, root: Path) -> "Fault":
        """Return the fault with its path relative to the dataset, where it is inside."""
        return self._replace(path=self.path.relative_to(root)) if self.path.is_relative_to(root) else self

    def __str__(self) -> str:
        where = ": ".join(filter(None, [short(self.path.as_posix(), 4 * MAX_LENGTH), short(self.field)]))
        advice = f". {self.mend}" if self.mend else ""
        # Names in a dataset are data: a line break or a control character in one must not break the line.
        return printable(f"{where}: found {short(self.found)}, expected {short(self.expected)}{advice}")


class DatasetError(Exception):
    """A dataset that cannot be read as asked. It says why in one line, and survives pickling.

    Attributes
    ----------
    fault : Fault
        Where it is, what was found, what was expected, and how to mend it.

    Examples
    --------
    >>> print(DatasetError(Fault(Path("meta/info.json"), "fps", -10, "a positive number")))
    meta/info.json: fps: found -10, expected a positive number
    """

    def __init__(self, fault: Fault) -> None:
        super().__init__(fault)
        self.fault = fault

    def __str__(self) -> str:
        return str(self.fault)


class Unreachable(BaseException):
    """A dataset that is far away and does not answer. It survives pickling.

    That is no fault of the dataset. So it is no exception that an audit may collect among the faults that it finds, or
    that anybody may catch to go on without a file: what is said of the rest would be wrong. `one_error` makes a
    `DatasetError` of it, where there is nothing left to go on with.
    """

    def __init__(self, fault: Fault) -> None:
        super().__init__(fault)
        self.fault = fault


@contextlib.contextmanager
def one_error() -> Iterator[None]:
    """Let a dataset that does not answer be a `DatasetError`, as whatever else is wrong with one.

    Raises
    ------
    DatasetError
        If it is `Unreachable`.
    """
    try:
        yield
    except Unreachable as lost:
        raise DatasetError(lost.fault) from None


class MissingExtraError(ImportError):
    """Something was asked for that needs packages which are not installed."""


def short(text: object, length: int = MAX_LENGTH) -> str:
    """Return a text as it is, or its beginning: a dataset may give a name, or a number, of any length.

    >>> len(short("1" * 10**6))
    203
    """
    said = str(text)
    return said if len(said) <= length else f"{said[:length]}..."


def some(names: Sequence[object]) -> str:
    """List names or numbers, or the first of them where they are many.

    >>> some(range(100))
    '0, 1, 2, 3, 4, 5, 6, 7 ...'
    """
    return ", ".join(map(str, names[:_SOME])) + (" ..." if len(names) > _SOME else "")


def count(number: int, noun: str) -> str:
    """Say how many there are of something.

    >>> count(1, "episode"), count(1000, "frame")
    ('1 episode', '1,000 frames')
    """
    return f"{number:,} {noun}{'' if number == 1 else 's'}"


def printable(text: str) -> str:
    r"""Return text that a dataset gave, with what could steer a terminal spelled out.

    >>> print(printable("name\x1b[2J"))
    name\x1b[2J
    """
    return "".join(char if char.isprintable() else repr(char)[1:-1] for char in text)
