"""Is the source on the page the source that runs? It is read from the package at the moment it is shown.

Pasted source drifts. This carries its file, its name and its fingerprint.
"""

import ast
import hashlib
import inspect
import textwrap
from collections.abc import Callable
from pathlib import Path
from typing import Any

_PACKAGE = Path(__file__).parents[1]


class Source(str):
    """Source text that a notebook renders as code under its fingerprint."""

    fingerprint: str

    def __repr__(self) -> str:
        return f"{self.fingerprint}\n{self}"

    def _repr_markdown_(self) -> str:
        return f"`{self.fingerprint}`\n\n```python\n{self}\n```"


def show_source(thing: Callable[..., Any] | type) -> Source:
    """Return the source of a function or class of the package, without its docstring.

    Parameters
    ----------
    thing : callable
        A function or class of `z2r`.

    Returns
    -------
    Source
        The text; in a notebook it is rendered with the file, the name and the first eight digits of the sha256 of the
        whole source, docstring included.

    Examples
    --------
    >>> import z2r
    >>> show_source(z2r.decode_yaw).fingerprint.split(" ")[0]
    'z2r/reading/angles.py#decode_yaw'
    """
    text = inspect.getsource(thing)
    file = Path(inspect.getfile(inspect.unwrap(thing))).relative_to(_PACKAGE.parent).as_posix()
    source = Source(_without_docstring(text).rstrip())
    source.fingerprint = f"{file}#{thing.__qualname__} · {hashlib.sha256(text.encode()).hexdigest()[:8]}…"
    return source


def _without_docstring(text: str) -> str:
    [node] = ast.parse(textwrap.dedent(text)).body
    if not isinstance(node, ast.FunctionDef | ast.ClassDef) or ast.get_docstring(node) is None:
        return text
    lines, docstring = text.splitlines(keepends=True), node.body[0]
    return "".join(lines[: docstring.lineno - 1]) + "".join(lines[docstring.end_lineno :]).lstrip("\n")
