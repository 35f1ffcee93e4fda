"""The examples in the docstrings of the package hold.

They are run here, and not by `--doctest-modules`: that would also run each script of the course before its notebook.
"""

import doctest
import importlib
from pathlib import Path

import pytest

import z2r

PACKAGE = Path(z2r.__file__).parent
WITH_EXAMPLES = sorted(
    ".".join(path.relative_to(PACKAGE.parent).with_suffix("").parts).removesuffix(".__init__")
    for path in PACKAGE.rglob("*.py")
    if ">>> " in path.read_text()
)


@pytest.mark.parametrize("module", WITH_EXAMPLES)
def test_its_examples_hold(module):
    done = doctest.testmod(importlib.import_module(module))
    assert done.attempted > 0
    assert done.failed == 0
