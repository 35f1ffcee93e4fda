"""The datasets that ship with the package, written by `z2r record`.

Next to each is a verdict: what the simulator said of every episode, and the stack that it ran on (`z2r.verdict`).
"""

from pathlib import Path

STANDIN = Path(__file__).parent / "standin"
MESSY = Path(__file__).parent / "messy"
SHIPPED = {"standin": STANDIN, "messy": MESSY}
