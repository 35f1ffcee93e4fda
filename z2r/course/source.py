"""Is the source on the page the source that runs? It is read from the package at the moment it is shown.

Pasted source drifts. What was shown is listed at the end of the page, with the lines and the fingerprint of each.
"""

import ast
import hashlib
import inspect
import textwrap
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple

_PACKAGE = Path(__file__).parents[1]


class Place(NamedTuple):
    """Where some source is: its file in the project, its name, its first and its last line, and the sha256 of these."""

    file: str
    name: str
    first: int
    last: int
    sha256: str


_shown: dict[str, Place] = {}  # by name, in the order in which they were shown


class Source(str):
    """Source text that a notebook renders as code, under the name of its file."""

    file: str

    def __repr__(self) -> str:
        return f"{self.file}\n{self}"

    def _repr_markdown_(self) -> str:
        return f"`{self.file}`\n\n```python\n{self}\n```"


class Colophon(tuple[Place, ...]):
    """The source that was shown; a notebook renders it as a table."""

    def _repr_markdown_(self) -> str:
        rows = (f"| `{file}` | `{name}` | {first}-{last} | `{sha256}` |" for file, name, first, last, sha256 in self)
        table = "\n".join(("| file | name | lines | sha256 |", "| --- | --- | --- | --- |", *rows))
        return f"The source on this page is read from the package.\n\n{table}"


def show_source(thing: Callable[..., Any] | type) -> Source:
    """Return the source of a function or class of the package, without its docstring, for a page to show.

    Parameters
    ----------
    thing : callable
        A function or class of `z2r`.

    Returns
    -------
    Source
        The text; in a notebook it is rendered under the name of its file. The colophon has the rest.

    Examples
    --------
    >>> import z2r
    >>> show_source(z2r.decode_yaw).file
    'z2r/reading/angles.py'
    """
    lines, first = inspect.getsourcelines(thing)
    text = "".join(lines)
    file = Path(inspect.getfile(inspect.unwrap(thing))).relative_to(_PACKAGE.parent).as_posix()
    name, last = thing.__qualname__, first + len(lines) - 1
    _shown[f"{file}#{name}"] = Place(file, name, first, last, hashlib.sha256(text.encode()).hexdigest())
    source = Source(_without_docstring(text).rstrip())
    source.file = file
    return source


def colophon() -> Colophon:
    """List all source that was shown so far.

    ``sed -n FIRST,LASTp FILE | sha256sum`` gives the same fingerprint.

    Returns
    -------
    Colophon
        File, name, lines and sha256 of each, in the order in which they were shown.
    """
    return Colophon(_shown.values())


def _without_docstring(text: str) -> str:
    [node] = ast.parse(textwrap.dedent(text)).body
    if not isinstance(node, ast.FunctionDef | ast.ClassDef) or ast.get_docstring(node) is None:
        return text
    lines, docstring = text.splitlines(keepends=True), node.body[0]
    return "".join(lines[: docstring.lineno - 1]) + "".join(lines[docstring.end_lineno :]).lstrip("\n")
