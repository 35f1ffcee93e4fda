"""How do words get into a page? Through templates that escape whatever they are given.

Markup is written in templates, beside this module or in another folder, and nowhere else. What is put into one is text:
control characters are spelled out, then it is escaped. Only a filter in a template can say that something is markup.
"""

from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from z2r.errors import printable

if TYPE_CHECKING:
    from jinja2 import Environment

FOLDER = Path(__file__).parent


def fill(template: str, folder: Path = FOLDER, /, **parts: object) -> str:
    """Fill one of the templates of a folder, which may use those beside this module.

    Raises
    ------
    jinja2.UndefinedError
        If it asks for a part that is not there.
    """
    return _environment(folder).get_template(template).render(parts)


@cache
def _environment(folder: Path) -> "Environment":
    from jinja2 import Environment, FileSystemLoader, StrictUndefined  # costs time that only a page should take

    return Environment(
        autoescape=True,
        finalize=_text,
        loader=FileSystemLoader([folder, FOLDER]),
        lstrip_blocks=True,
        trim_blocks=True,
        undefined=StrictUndefined,
    )


def _text(value: object) -> object:
    return value if hasattr(value, "__html__") else printable(str(value))
