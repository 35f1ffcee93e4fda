"""Source on the page: a function of the package, shown as it is now, with its file, its name and its fingerprint.

Pasted source drifts. This is read from the installed package at the moment it is shown.
"""

import hashlib
import inspect
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
    file = Path(inspect.getfile(thing)).relative_to(_PACKAGE.parent).as_posix()
    source = Source(_without_docstring(text, inspect.getdoc(thing) is not None).rstrip())
    source.fingerprint = f"{file}#{thing.__qualname__} · {hashlib.sha256(text.encode()).hexdigest()[:8]}…"
    return source


def _without_docstring(text: str, has_docstring: bool) -> str:
    if not has_docstring:
        return text
    before, _, rest = text.partition('"""')
    _, _, after = rest.partition('"""')
    return before.rstrip() + "\n" + after.lstrip("\n")
