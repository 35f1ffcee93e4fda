"""What does a check ask, and why? The words stand in a file beside the checks: `explanations.toml`."""

from pathlib import Path

import msgspec

from z2r.format.store import read_bytes

_MAX_BYTES = 2**20
EXPLANATIONS = Path(__file__).with_name("explanations.toml")
"""Those of the checks in this folder."""


class Explanation(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """Why a check is there.

    Attributes
    ----------
    why : str
        What goes wrong where it is not heeded.
    mend : str
        What to do.
    case : str
        Where it happened; empty where no public case is known.
    source : str
        Where that is told; empty where it is in no public place.
    """

    why: str
    mend: str
    case: str = ""
    source: str = ""


def read_explanations(path: Path) -> dict[str, Explanation]:
    """Read the explanations in a file, by the names of their checks."""
    return msgspec.toml.decode(read_bytes(path, _MAX_BYTES, "explanations"), type=dict[str, Explanation])
