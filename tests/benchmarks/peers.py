"""Who else looks for faults in a LeRobot dataset, how is it asked, and what does it answer?

Each is asked by the command that diagnoses, with all that it has switched on. Commands that rank episodes (`rdq rank`,
`robovet score`, `lerobot-doctor score`) are not run: of any dataset, some episode is the last.
"""

from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass
from typing import Any

type Told = tuple[str, str, Sequence[object], str]
"""A finding: how bad it is, in their word, the name of the check, where it is, and what it says."""

NOTE, WARNING, STOP = LEVELS = ("note", "warning", "stop")
"""How bad a finding is. *Stop* is what ends a pipeline with an exit code, as its own pages set it up; of rdq, which
sets a score for that, it is what it calls critical."""


@dataclass(frozen=True)
class Peer:
    """One that is asked.

    Attributes
    ----------
    command : str
        A shell's words; the first is a program of its environment, or of this one where nothing is required.
    read : callable
        Takes its report, parsed, and gives its findings.
    levels : dict
        What its words of severity amount to; what is none of them is no finding.
    requirement : str
        What is installed, with its version.
    modules : tuple of str
        What of it is imported once for many datasets (`launcher.py`): most of its time goes there.
    held_back : tuple of str
        Checks that it has switched off because they say too much. They count as notes.
    """

    command: str
    read: Callable[[Any], Iterable[Told]]
    levels: dict[str, str]
    requirement: str = ""
    modules: tuple[str, ...] = ()
    held_back: tuple[str, ...] = ()


def z2r(report: Any) -> Iterator[Told]:
    for own in report["findings"]:
        yield own["severity"], own["check"], [own["field"], *own["episodes"]], own["found"]


def rdq(report: Any) -> Iterator[Told]:
    for own in report["findings"]:
        yield own["severity"], own["check"], own["episodes"], own["message"]


def robovet(report: Any) -> Iterator[Told]:
    for own in report["results"]:
        yield own["severity"], own["check_id"], own["episodes"], own["summary"]


def lerobot_doctor(report: Any) -> Iterator[Told]:
    for check in report["checks"]:
        for own in check["messages"]:
            yield own["severity"], check["name"], [], own["message"]


def adduct(report: Any) -> Iterator[Told]:
    for cluster in report["clusters"]:
        for own in cluster["findings"]:
            where = own["locus"]
            places = [*where["episodes"], *where["dimensions"], where["camera"] or ""]
            yield own["severity"], own["detector_id"], places, own["title"]


def physlint(report: Any) -> Iterator[Told]:
    for rule in report["results"]:
        if rule["status"] == "errored":
            yield "error", rule["rule_id"], [], rule["reason"]
        for own in rule["findings"]:
            where = own["location"]
            yield own["severity"], own["rule_id"], [where["episode"], where["stream"]], own["message"]


def lelint(report: Any) -> Iterator[Told]:
    for own in report["findings"]:
        yield own["severity"], own["check"], [f"episode {own['episode']} joint {own['joint']}"], own["message"]


Z2R = "z2r audit {dataset} --json"
Z2R_LEVELS = {"note": NOTE, "warning": STOP, "error": STOP}
Z2R_MODULES = ("z2r.cli", "z2r.api", "z2r.audits.audit", "z2r.audits.pictures", "z2r.show.formats", "av")

PEERS: dict[str, Peer] = {
    "z2r": Peer(Z2R, z2r, Z2R_LEVELS, modules=Z2R_MODULES),
    "z2r --pictures": Peer(f"{Z2R} --pictures", z2r, Z2R_LEVELS, modules=Z2R_MODULES),
    "rdq": Peer(
        "rdq check {dataset} --video-full --json {report}",
        rdq,
        {"info": NOTE, "warning": WARNING, "critical": STOP},
        "rdq[video]==0.3.4",
        ("rdq.cli", "rdq.report", "rdq.video", "pyarrow.dataset", "av"),
    ),
    "robovet": Peer(
        "robovet doctor {dataset} --json {report}",
        robovet,
        {"INFO": NOTE, "WARN": WARNING, "FAIL": STOP},
        "robovet[video]==0.2.2",
        ("robovet.cli", "pyarrow.dataset", "pydantic"),
    ),
    "lerobot-doctor": Peer(
        "lerobot-doctor check {dataset} --verbose --json",
        lerobot_doctor,
        {"WARN": WARNING, "FAIL": STOP},
        "lerobot-doctor==0.2.0",
        ("lerobot_doctor.cli", "lerobot_doctor.runner", "lerobot_doctor.dataset_loader", "pyarrow.parquet", "av"),
    ),
    "adduct": Peer(
        "adduct scan {dataset} --full --all --target act --json {report}",
        adduct,
        {"INFO": NOTE, "LOW": NOTE, "MEDIUM": WARNING, "HIGH": STOP},
        "adduct[video]==0.2.2",
        ("adduct.cli", "adduct.detectors.kinematics", "adduct.adapters.lerobot", "polars", "sklearn.neighbors", "av"),
        held_back=("smoothness.discontinuity_jump", "integrity.declared_mismatch", "dynamics.inverse_residual"),
    ),
    "physlint": Peer(
        "physlint check {dataset} --json-output {report}",
        physlint,
        {"notice": NOTE, "warning": WARNING, "error": STOP, "critical": STOP},
        "physlint[all]==0.4.0",
        ("physlint.cli", "pyarrow.dataset", "cv2"),
    ),
    "lerobot-lint": Peer(
        "lelint check {dataset} --json {report}",
        lelint,
        {"info": NOTE, "warning": WARNING, "error": STOP},
        "lerobot-lint==0.1.1",
        ("lerobot_lint.cli", "lerobot.datasets.lerobot_dataset"),
    ),
}
