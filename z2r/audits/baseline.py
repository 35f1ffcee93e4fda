"""Which findings has somebody accepted? What an earlier `z2r audit --json` printed says so.

Where a dataset has lived with a warning for a year, the next one should still stop a pipeline.
"""

from pathlib import Path

import msgspec

from z2r.errors import DatasetError, Fault
from z2r.format.store import read_bytes

_MAX_BYTES = 2**28
_MEND = "Write it with: z2r audit DATASET --json > FILE"


class _Accepted(msgspec.Struct):
    fingerprint: str


class _File(msgspec.Struct):
    findings: list[_Accepted]
    more_fingerprints: list[str]


def read_baseline(path: Path) -> frozenset[str]:
    """Return the fingerprints of all findings in a file.

    Raises
    ------
    DatasetError
        If it cannot be read, or holds no audit.
    """
    expected = "what z2r audit --json printed"
    try:
        said = msgspec.json.decode(read_bytes(path, _MAX_BYTES, expected, _MEND), type=_File)
    except (msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as error:
        raise DatasetError(Fault(path, "", f"{error}", expected, _MEND)) from None
    return frozenset({*(each.fingerprint for each in said.findings), *said.more_fingerprints})
