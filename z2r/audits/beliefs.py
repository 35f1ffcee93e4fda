"""Which wrong beliefs does a dataset refute? Audit it as it is, and then as it is believed with one thing wrong.

It is a mutation test of what one believes about a dataset: where a wrong belief changes something and no check finds
more than before, nothing in the data would tell a right belief from this one.
"""

from collections import Counter
from concurrent.futures import Executor
from pathlib import Path
from typing import Any, Literal

import msgspec

from z2r.arrays import Progress, no_progress
from z2r.audits.audit import Audit, audit
from z2r.format.dataset import load
from z2r.reading.breaks import BREAK_MODES, BreakMode
from z2r.reading.reading import Reading
from z2r.reading.scene import Scene


class Belief(msgspec.Struct, frozen=True):
    """What came of one wrong belief.

    Attributes
    ----------
    mode : str
        The break mode.
    believed : str
        What it believes.
    columns : tuple of str
        Which columns it takes for something else; none where it is about the reading, the files or time.
    refuted_by : tuple of str
        The checks that find more that is wrong, notes aside, than in the dataset as it is.
    lacking : str
        What there would have to be for the belief to be possible; empty where it is.
    """

    mode: str
    believed: str
    columns: tuple[str, ...] = ()
    refuted_by: tuple[str, ...] = ()
    lacking: str = ""

    @property
    def verdict(self) -> Literal["refuted", "not refuted", "does not apply"]:
        """What came of it, in a word."""
        return "does not apply" if self.lacking else "refuted" if self.refuted_by else "not refuted"


class Beliefs(msgspec.Struct, frozen=True):
    """Which wrong beliefs a dataset refutes.

    Attributes
    ----------
    as_it_is : Audit
        Of the dataset, read right.
    beliefs : tuple of Belief
        In the order of `z2r.BREAK_MODES`.
    """

    as_it_is: Audit
    beliefs: tuple[Belief, ...]

    @property
    def found_anyway(self) -> tuple[str, ...]:
        """The checks that find something wrong, notes aside, in the dataset as it is."""
        return tuple(_n_wrong(self.as_it_is))

    def to_dict(self, source: str) -> dict[str, Any]:
        """Return all of it as plain Python values for `z2r audit --break all --json`.

        Parameters
        ----------
        source : str
            What was audited, such as ``standin``.

        Returns
        -------
        dict
            ``source``; ``found_anyway``, the checks that find something in the dataset as it is; and ``beliefs``, each
            with ``mode``, ``believed``, ``verdict``, ``refuted_by``, ``columns`` and ``lacking``.
        """
        beliefs = [{**msgspec.to_builtins(belief), "verdict": belief.verdict} for belief in self.beliefs]
        return {"source": source, "found_anyway": list(self.found_anyway), "beliefs": beliefs}


def audit_beliefs(
    root: Path,
    reading: Reading | None = None,
    scene: Scene | None = None,
    progress: Progress = no_progress,
    executor: Executor | None = None,
) -> Beliefs:
    """Audit a dataset as it is, and once under every break mode that applies: `z2r.audit_beliefs`, all handed down.

    Raises
    ------
    DatasetError
        If the dataset is not whole: of one that is broken, nobody can say what is believed.
    """
    dataset = load(root)
    applying = [mode for mode in BREAK_MODES.values() if mode.applies_to(dataset, reading)]
    audits: list[Audit] = []
    for mode in (None, *applying):
        audits.append(audit(root, mode, reading, scene, executor=executor))
        progress(len(audits), len(applying) + 1)
    as_it_is, *believed = audits
    refuted_by = {found.break_mode: _found_more(found, as_it_is) for found in believed}

    def belief(mode: BreakMode) -> Belief:
        if mode.name not in refuted_by:
            return Belief(mode.name, mode.assumption, lacking=mode.about)
        return Belief(mode.name, mode.assumption, mode.columns(dataset.schema, reading), refuted_by[mode.name])

    return Beliefs(as_it_is, tuple(map(belief, BREAK_MODES.values())))


def _found_more(found: Audit, as_it_is: Audit) -> tuple[str, ...]:
    """Name the checks that find more: what is wrong anyway looks different to another reader, and refutes nobody."""
    before = _n_wrong(as_it_is)
    return tuple(check for check, number in _n_wrong(found).items() if number > before[check])


def _n_wrong(found: Audit) -> Counter[str]:
    """Count what each check finds, notes aside."""
    wrong = Counter(finding.check for finding in found.findings if finding.severity != "note")
    return Counter({check: number + found.more.get(check, 0) for check, number in wrong.items()})
