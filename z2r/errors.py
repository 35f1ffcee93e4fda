"""What is wrong with a dataset, in one line."""

from pathlib import Path

_MAX_LENGTH = 200


class DatasetError(Exception):
    """A fault in a dataset: where it is, what was found, what was expected, and how to mend it.

    Parameters
    ----------
    path : Path
        The file or folder at fault.
    field : str
        The key, column or part of it at fault; empty when it is the whole file.
    found, expected : str
        What is there, and what should be.
    mend : str, optional
        What the reader can do about it: a command where there is one.

    Examples
    --------
    >>> print(DatasetError(Path("meta/info.json"), "fps", found="-10", expected="a positive number"))
    meta/info.json: fps: found -10, expected a positive number
    """

    def __init__(self, path: Path, field: str, *, found: str, expected: str, mend: str = "") -> None:
        self.path, self.field, self.found, self.expected, self.mend = path, field, found, expected, mend
        where = f"{short(path, 4 * _MAX_LENGTH)}: {short(field)}" if field else short(path, 4 * _MAX_LENGTH)
        advice = f". {mend}" if mend else ""
        # Names in a dataset are data: a line break or a control character in one must not break the line.
        super().__init__(printable(f"{where}: found {short(found)}, expected {short(expected)}{advice}"))


class MissingExtraError(ImportError):
    """Recording needs packages that reading does not."""


def short(text: object, length: int = _MAX_LENGTH) -> str:
    """Return a text as it is, or its beginning: a dataset may give a name, or a number, of any length.

    >>> len(short("1" * 10**6))
    203
    """
    said = str(text)
    return said if len(said) <= length else f"{said[:length]}..."


def printable(text: str) -> str:
    r"""Return text that a dataset gave, with what could steer a terminal spelled out.

    >>> print(printable("name\x1b[2J"))
    name\x1b[2J
    """
    return "".join(char if char.isprintable() else repr(char)[1:-1] for char in text)
