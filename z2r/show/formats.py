"""What do the programs around an audit read? JSON, SARIF, JUnit's XML, and the annotations of GitHub's workflows.

- SARIF 2.1.0: https://docs.oasis-open.org/sarif/sarif/v2.1.0/sarif-v2.1.0.html
- workflow commands: https://docs.github.com/en/actions/reference/workflow-commands-for-github-actions; what they escape
  is in `actions/toolkit`, `packages/core/src/command.ts`

Names of files and features are data: none of them can end a line, an element or a command.
"""

from collections.abc import Callable, Sequence
from importlib.metadata import version
from pathlib import Path
from urllib.parse import quote
from xml.etree import ElementTree

import msgspec

from z2r.audits.audit import Audit
from z2r.audits.findings import Finding
from z2r.check import Check
from z2r.errors import printable
from z2r.format.store import folder_name

_SARIF = "https://docs.oasis-open.org/sarif/sarif/v2.1.0/errata01/os/schemas/sarif-schema-2.1.0.json"
_NOTICES = {"error": "error", "warning": "warning", "note": "notice"}


def to_json(audit: Audit, root: Path, checks: Sequence[Check]) -> str:
    """Return what `Audit.to_dict` says."""
    return _json(audit.to_dict(folder_name(root)))


def to_sarif(audit: Audit, root: Path, checks: Sequence[Check]) -> str:
    """Return a SARIF log with every finding, and what was not checked as notifications."""
    names = [check.name for check in checks]
    driver = {"name": "z2r", "version": version("z2r"), "rules": [*map(_rule, checks)]}
    notes = [{"level": "note", "message": {"text": printable(f"not checked: {what}")}} for what in audit.not_checked]
    run = {
        "tool": {"driver": driver},
        "invocations": [
            {
                "executionSuccessful": audit.readable,
                "exitCode": audit.exit_code,
                "toolExecutionNotifications": notes,
            }
        ],
        "results": [_result(each, root, names.index(each.check)) for each in (*audit.findings, *audit.rest)],
    }
    return _json({"$schema": _SARIF, "version": "2.1.0", "runs": [run]})


def _rule(check: Check) -> dict[str, object]:
    return {
        "id": check.name,
        "shortDescription": {"text": check.asks},
        "help": {"text": f"z2r explain {check.name}"},
        "defaultConfiguration": {"level": check.severity},
    }


def _result(finding: Finding, root: Path, rule: int) -> dict[str, object]:
    path = root / finding.file
    uri = path.as_uri() if path.is_absolute() else quote(path.as_posix(), errors="backslashreplace")
    place: dict[str, object] = {"physicalLocation": {"artifactLocation": {"uri": uri}}}
    if finding.field:
        place["logicalLocations"] = [{"fullyQualifiedName": printable(finding.field)}]
    return {
        "ruleId": finding.check,
        "ruleIndex": rule,
        "level": finding.severity,
        "message": {"text": str(finding)},
        "locations": [place],
        "partialFingerprints": {"z2r/v1": finding.fingerprint},
        "properties": {"episodes": finding.episodes, "frame": finding.frame},
    }


def to_junit(audit: Audit, root: Path, checks: Sequence[Check]) -> str:
    """Return a test suite: a case for each finding, failed unless it is a note, and one, skipped, for what nobody saw.

    A check that found nothing is no case: it may have had nothing to look at.
    """
    suite = ElementTree.Element("testsuite", name=printable(f"z2r audit {folder_name(root)}"))
    for finding in (*audit.findings, *audit.rest):
        where = printable(f"{root / finding.file} {finding.field}").strip()
        case = ElementTree.SubElement(suite, "testcase", classname=f"z2r.{finding.check}", name=where)
        if finding.severity == "note":
            ElementTree.SubElement(case, "system-out").text = str(finding)
        else:
            ElementTree.SubElement(case, "failure", type=finding.severity, message=str(finding))
    for what in audit.not_checked:
        case = ElementTree.SubElement(suite, "testcase", classname="z2r.not-checked", name=printable(what))
        ElementTree.SubElement(case, "skipped")
    counts = {"tests": "testcase", "failures": "testcase/failure", "skipped": "testcase/skipped"}
    suite.attrib |= {name: str(len(suite.findall(path))) for name, path in counts.items()} | {"errors": "0"}
    ElementTree.indent(suite)
    written: bytes = ElementTree.tostring(suite, encoding="us-ascii", xml_declaration=True)
    return written.decode()


def to_github(audit: Audit, root: Path, checks: Sequence[Check]) -> str:
    """Return an annotation for each finding, and one for what was not checked."""
    lines = [
        f"::{_NOTICES[each.severity]} file={_property(root / each.file)},title={_property(f'z2r {each.check}')}"
        f"::{_data(str(each))}"
        for each in audit.findings
    ]
    left_out = [f"{check}: {number:,} more" for check, number in audit.more.items()]
    unseen = [printable(f"not checked: {what}") for what in audit.not_checked]
    lines += [f"::notice title=z2r::{_data(line)}" for line in (*left_out, "\n".join(unseen))]
    return "\n".join(lines)


def _data(text: str) -> str:
    return text.replace("%", "%25").replace("\r", "%0D").replace("\n", "%0A")


def _property(value: object) -> str:
    return _data(printable(str(value))).replace(":", "%3A").replace(",", "%2C")


def _json(value: object) -> str:
    return msgspec.json.format(msgspec.json.encode(value), indent=2).decode()


FORMATS: dict[str, Callable[[Audit, Path, Sequence[Check]], str]] = {
    "json": to_json,
    "sarif": to_sarif,
    "junit": to_junit,
    "github": to_github,
}
"""By name, what writes an audit of the dataset in a folder so that a program reads it."""
