"""What the tests of the notebooks share: which there are, what they show, and a world without a network."""

import os
from pathlib import Path

import nbformat
import pytest
from nbformat import NotebookNode

from z2r.course.build import NOTEBOOKS, ROOT

STEMS = sorted(path.stem for path in NOTEBOOKS.glob("*.py"))
IN_CI = os.environ.get("CI") == "true"
SHOWN_TEXT = ("text/plain", "text/markdown")

# Python runs a module of this name at its start, in the kernel and in whatever a cell starts.
NO_NETWORK = """
import ipaddress
import socket

def _only_loopback(method):
    def checked(self, address, *rest):
        if self.family in (socket.AF_INET, socket.AF_INET6) and not ipaddress.ip_address(address[0]).is_loopback:
            raise ConnectionError(f"no network in the tests: {address}")
        return method(self, address, *rest)
    return checked

def _only_numbers(getaddrinfo):
    def checked(host, *rest, **options):
        if host not in (None, "localhost", "127.0.0.1", "::1"):
            raise ConnectionError(f"no network in the tests: {host}")
        return getaddrinfo(host, *rest, **options)
    return checked

socket.socket.connect = _only_loopback(socket.socket.connect)
socket.socket.connect_ex = _only_loopback(socket.socket.connect_ex)
socket.getaddrinfo = _only_numbers(socket.getaddrinfo)
"""


def committed(stem: str) -> NotebookNode:
    return nbformat.read(NOTEBOOKS / f"{stem}.ipynb", as_version=4)


def without_outputs(notebook: NotebookNode) -> NotebookNode:
    for cell in code_cells(notebook):
        cell.outputs, cell.execution_count = [], None
    return notebook


def code_cells(notebook: NotebookNode) -> list[NotebookNode]:
    return [cell for cell in notebook.cells if cell.cell_type == "code"]


def cell_tags(cell: NotebookNode) -> set[str]:
    return set(cell.metadata.get("tags", []))


def shown(cell: NotebookNode) -> list[tuple[str, str]]:
    """What a code cell shows: every kind of output, and the text of those that are the same on every machine."""
    parts: list[tuple[str, str]] = []
    for output in cell.outputs:
        if output.output_type == "stream":
            if output.name == "stdout":  # which comes in pieces, as the kernel happens to send it
                before = parts.pop()[1] if parts and parts[-1][0] == "stdout" else ""
                parts.append(("stdout", before + output.text))
        elif output.output_type == "error":
            parts.append(("error", output.ename))
        else:
            parts += [(kind, data if kind in SHOWN_TEXT else "") for kind, data in sorted(output.data.items())]
    return parts


def differences(notebook: NotebookNode, reference: NotebookNode) -> list[str]:
    """Cells that do not show what the same cells of the reference show."""
    pairs = zip(code_cells(notebook), code_cells(reference), strict=True)
    return [
        f"{expected.id} shows {shown(cell)}\ncommitted:{' ' * len(expected.id)} {shown(expected)}"
        for cell, expected in pairs
        if shown(cell) != shown(expected)
    ]


def without_network(folder: Path) -> list[Path]:
    """Return a search path for a kernel that imports this package and reaches no other machine."""
    (folder / "sitecustomize.py").write_text(NO_NETWORK)
    return [folder, ROOT]


def cannot_run(reason: str) -> None:
    """Skip what this machine has no means for; in CI, where it must have them, fail."""
    if IN_CI:
        pytest.fail(reason)
    pytest.skip(reason)
