"""What an audit says to other programs, what it no longer counts, and why its checks are there."""

import json
import os
import re
import shlex
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any, Literal
from xml.etree import ElementTree

import msgspec
import pytest
import yaml
from damages import INFO, VIDEO, edit_feature, edit_info, make, orphan_video
from test_untrusted import NAMES

import z2r
from z2r.api import ALL_CHECKS, CHECKS, SCENE, explain
from z2r.audits.audit import MAX_OF_A_CHECK, NOTHING_AUDITED, PARTS
from z2r.audits.explain import EXPLANATIONS, read_explanations
from z2r.cli import _FORMATS
from z2r.pusht.scene import EXPLANATIONS as PUSHT_EXPLANATIONS
from z2r.show.formats import FORMATS

ROOT = Path(__file__).parents[1]
MAIN = "from z2r.cli import main; main()"


def run(*args: object, cwd: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", MAIN, *map(str, args)]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, check=False)


def written(form: str, root: Path, audit: Any = None) -> str:
    return FORMATS[form](audit or z2r.audit(root), root, ALL_CHECKS)


@pytest.fixture
def hostile(standin_copy: Path) -> Path:
    """A dataset whose names would end a line, an element or a command, and steer a terminal."""
    for name in (*NAMES, "a::error::b", "100%\r\n::warning::x", "\x00\x0b\ufffe"):
        edit_feature(standin_copy, name, dtype="float32", shape=[1])
    orphan_video(standin_copy)
    shutil.copy(standin_copy / VIDEO, standin_copy / "videos/a, b: 50%.mp4")
    assert len(z2r.audit(standin_copy).rest) > MAX_OF_A_CHECK
    return standin_copy


# --- SARIF: what of the schema of 2.1.0 is written here. No other field is, and none of another type.


class Strict(msgspec.Struct, forbid_unknown_fields=True, rename="camel"):
    pass


class Message(Strict):
    text: str


class Artifact(Strict):
    uri: str


class Physical(Strict):
    artifact_location: Artifact


class Logical(Strict):
    fully_qualified_name: str


class Location(Strict):
    physical_location: Physical
    logical_locations: list[Logical] = []


type Level = Literal["none", "note", "warning", "error"]


class Configuration(Strict):
    level: Level


class Rule(Strict):
    id: str
    short_description: Message
    help: Message
    default_configuration: Configuration


class Driver(Strict):
    name: str
    version: str
    rules: list[Rule]


class Tool(Strict):
    driver: Driver


class Notification(Strict):
    level: Level
    message: Message


class Invocation(Strict):
    execution_successful: bool
    exit_code: int
    tool_execution_notifications: list[Notification]


class Result(Strict):
    rule_id: str
    rule_index: int
    level: Level
    message: Message
    locations: list[Location]
    partial_fingerprints: dict[str, str]
    properties: dict[str, Any]


class Run(Strict):
    tool: Tool
    invocations: list[Invocation]
    results: list[Result]


class Log(msgspec.Struct, forbid_unknown_fields=True):
    version: Literal["2.1.0"]
    runs: list[Run]
    schema: str = msgspec.field(name="$schema")


def test_sarif_is_what_its_schema_says(hostile: Path) -> None:
    audit = z2r.audit(hostile)
    [told] = msgspec.json.decode(written("sarif", hostile, audit), type=Log).runs
    findings = [*audit.findings, *audit.rest]
    rules = told.tool.driver.rules
    assert len({rule.id for rule in rules}) == len(rules) == len(CHECKS)
    assert [result.message.text for result in told.results] == [str(finding) for finding in findings]
    assert [rules[result.rule_index].id for result in told.results] == [result.rule_id for result in told.results]
    assert len(told.invocations[0].tool_execution_notifications) == len(audit.not_checked)
    for result in told.results:
        uri = result.locations[0].physical_location.artifact_location.uri
        assert re.fullmatch(r"[A-Za-z0-9._~:/%-]+", uri), uri


def test_a_path_in_sarif_is_as_the_dataset_was_named(hostile: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(hostile.parent)
    told = json.loads(written("sarif", Path(hostile.name), z2r.audit(hostile)))
    uris = {each["locations"][0]["physicalLocation"]["artifactLocation"]["uri"] for each in told["runs"][0]["results"]}
    assert "standin/videos/a%2C%20b%3A%2050%25.mp4" in uris


# --- JUnit, GitHub, JSON


def test_junit_has_a_case_for_each_finding(hostile: Path) -> None:
    audit = z2r.audit(hostile)
    suite = ElementTree.fromstring(written("junit", hostile, audit))
    findings = [*audit.findings, *audit.rest]
    failed = [case.get("message") for case in suite.iter("failure")]
    assert failed == [str(finding) for finding in findings if finding.severity != "note"]
    assert [case.text for case in suite.iter("system-out")] == [
        str(each) for each in findings if each.severity == "note"
    ]
    assert len([*suite.iter("skipped")]) == len(audit.not_checked)
    assert int(suite.attrib["tests"]) == len(suite) == len(findings) + len(audit.not_checked)
    assert int(suite.attrib["failures"]) == len(failed)


def test_no_name_ends_a_command_of_a_workflow(hostile: Path) -> None:
    audit = z2r.audit(hostile)
    lines = written("github", hostile, audit).split("\n")
    assert len(lines) == len(audit.findings) + len(audit.more) + 1
    for line, finding in zip(lines, audit.findings, strict=False):
        command, _, said = line.removeprefix("::").partition("::")
        level, _, properties = command.partition(" ")
        assert level == finding.severity.replace("note", "notice")
        assert [each.split("=")[0] for each in properties.split(",")] == ["file", "title"]
        assert said.replace("%25", "%") == str(finding)
    assert all(line.isprintable() for line in lines)
    assert lines[-1].count("not checked: ") == len(audit.not_checked)


@pytest.mark.parametrize("form", FORMATS)
def test_the_command_prints_it_and_nothing_else(form: str, tmp_path: Path) -> None:
    make("a timestamp jump", tmp_path / "dataset")
    result = run("audit", "dataset", "--format", form, cwd=tmp_path)
    assert (result.returncode, result.stderr) == (1, "")
    audit = z2r.audit(tmp_path / "dataset")
    assert result.stdout == written(form, Path("dataset"), audit).replace(str(tmp_path) + "/", "") + "\n" or (
        form == "json" and json.loads(result.stdout) == audit.to_dict("dataset")
    )


def test_json_may_be_asked_for_in_two_ways(tmp_path: Path) -> None:
    told = [run("audit", *args, cwd=tmp_path).stdout for args in (["--json"], ["--format", "json"])]
    assert told[0] == told[1]
    assert json.loads(told[0])["source"] == "standin"
    assert ("text", *FORMATS) == _FORMATS


# --- what was accepted


def accepted(audit: z2r.Audit) -> set[str]:
    return {finding.fingerprint for finding in (*audit.findings, *audit.rest)}


def test_what_was_accepted_no_longer_counts(tmp_path: Path) -> None:
    root = tmp_path / "dataset"
    make("a timestamp jump", root)
    (tmp_path / "accepted.json").write_text(run("audit", root, "--json", cwd=tmp_path).stdout)
    again = run("audit", root, "--baseline", "accepted.json", cwd=tmp_path)
    assert (again.returncode, again.stderr) == (0, "")
    assert "accepted before, and left out" in again.stdout
    orphan_video(root)
    new = json.loads(run("audit", root, "--baseline", "accepted.json", "--json", cwd=tmp_path).stdout)
    assert [finding["check"] for finding in new["findings"]] == ["orphan-file"]
    assert (new["exit_code"], new["n_accepted"] > 0) == (1, True)


def test_a_fault_that_is_nowhere_in_the_first_few_is_accepted_too(standin_copy: Path) -> None:
    for number in range(3 * MAX_OF_A_CHECK):
        (standin_copy / f"data/chunk-000/other-{number}.parquet").touch()
    audit = z2r.audit(standin_copy)
    assert sum(audit.more.values()) == len(audit.rest) >= 2 * MAX_OF_A_CHECK
    told = audit.without(accepted(audit))
    assert (told.findings, told.rest, told.exit_code) == ((), (), 0)
    one_less = audit.without(accepted(audit) - {audit.rest[-1].fingerprint})
    assert one_less.findings == (audit.rest[-1],)
    assert one_less.exit_code == 1


def test_a_fingerprint_knows_no_order_and_no_count(standin_copy: Path) -> None:
    edit_info(standin_copy, total_frames=3)
    [before] = [each for each in z2r.audit(standin_copy).findings if each.check == "totals"]
    edit_info(standin_copy, total_frames=4)
    orphan_video(standin_copy)
    [after] = [each for each in z2r.audit(standin_copy).findings if each.check == "totals"]
    assert before.found != after.found
    assert before.fingerprint == after.fingerprint
    for other in ({"severity": "note"}, {"file": "x"}, {"field": "x"}, {"check": "info"}, {"found": "none"}):
        assert msgspec.structs.replace(before, **other).fingerprint != before.fingerprint


@pytest.mark.parametrize("contents", [b"", b"[]", b'{"findings": []}', b"\xff", b'{"findings":' + b"[" * 10**5])
def test_what_is_no_baseline_is_refused(contents: bytes, tmp_path: Path) -> None:
    (tmp_path / "accepted.json").write_bytes(contents)
    result = run("audit", "--baseline", "accepted.json", cwd=tmp_path)
    assert (result.returncode, result.stdout, result.stderr.count("\n")) == (2, "", 1)
    assert "z2r audit DATASET --json > FILE" in result.stderr


# --- nothing was audited


def test_nothing_audited_has_an_exit_code_of_its_own(standin_copy: Path, tmp_path: Path) -> None:
    (standin_copy / INFO).unlink()
    assert z2r.audit(standin_copy).exit_code == NOTHING_AUDITED == 3
    told = z2r.audit(standin_copy)
    assert told.without(accepted(told)).exit_code == NOTHING_AUDITED
    assert run("audit", standin_copy, cwd=tmp_path).returncode == 3
    assert run("audit", "nowhere", cwd=tmp_path).returncode == 2


# --- why


def test_every_check_is_explained_beside_it() -> None:
    of_task = {part.check.name for part in SCENE.checks} - {part.check.name for part in PARTS}
    assert read_explanations(PUSHT_EXPLANATIONS).keys() == of_task
    assert read_explanations(EXPLANATIONS).keys() == CHECKS.keys() - of_task


@pytest.mark.parametrize("name", CHECKS)
def test_an_explanation_says_why_and_how_to_mend_it(name: str) -> None:
    why = explain(name)
    for text in filter(None, (why.why, why.mend, why.case)):
        assert text.endswith(".")
        assert len(text) < 400
    assert not why.source or (why.case and re.fullmatch(r"https://github\.com/\S+/(issues|pull)/\d+", why.source))


def test_the_command_explains(tmp_path: Path) -> None:
    said = " ".join(run("explain", "late", cwd=tmp_path).stdout.split())
    for text in (
        CHECKS["late"],
        explain("late").why,
        explain("late").mend,
        explain("late").case,
        explain("late").source,
    ):
        assert text in said
    listed = run("explain", cwd=tmp_path).stdout
    assert all(name in listed for name in CHECKS)
    refused = run("explain", "lat", cwd=tmp_path)
    assert (refused.returncode, "did you mean late?" in refused.stderr) == (2, True)


# --- the hook and the action


def with_z2r(folder: Path) -> dict[str, str]:
    """An environment in which `z2r` is the one that is tested."""
    command = folder / "bin/z2r"
    command.parent.mkdir()
    command.write_text(f'#!/bin/sh\nexec {shlex.quote(sys.executable)} -c "{MAIN}" "$@"\n')
    command.chmod(0o755)
    return os.environ | {"PATH": f"{command.parent}:{os.environ['PATH']}"}


@pytest.mark.parametrize(("broken", "code"), [(False, 0), (True, 1)])
def test_the_hook_audits_each_dataset_once(broken: bool, code: int, tmp_path: Path) -> None:
    [hook] = yaml.safe_load((ROOT / ".pre-commit-hooks.yaml").read_text())
    for name in ("a b", "data/c"):
        shutil.copytree(z2r.STANDIN, tmp_path / "repository" / name)
    if broken:
        edit_info(tmp_path / "repository/a b", total_frames=3)
    changed = ["a b/meta/info.json", "a b/data/chunk-000/file-000.parquet", "data/c/meta/stats.json", "data/other.json"]
    assert all(re.search(hook["files"], name) for name in changed)
    assert not re.search(hook["files"], "README.md")
    done = subprocess.run(
        [*shlex.split(hook["entry"]), *changed],
        cwd=tmp_path / "repository",
        env=with_z2r(tmp_path),
        capture_output=True,
        text=True,
        check=False,
    )
    assert done.returncode == code, done.stderr
    assert [line.split("  ")[0] for line in done.stdout.splitlines() if "6 episodes, 427 frames" in line] == [
        "a b",
        "c",
    ]


def test_the_action_hands_its_inputs_over_as_they_are(tmp_path: Path) -> None:
    action = yaml.safe_load((ROOT / ".github/actions/audit/action.yml").read_text())
    [step] = action["runs"]["steps"]
    assert set(re.findall(r"inputs\.(\w+)", str(step["env"]))) == set(action["inputs"])
    assert "${{" not in step["run"]
    assert re.findall(r"uv==\S+", step["run"]) == re.findall(r"uv==\S+", (ROOT / ".ci/run").read_text())
    stubs = {"bin/python3": "true", "uv/bin/uvx": 'printf "%s\\n" "$@"'}
    for name, line in stubs.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(f"#!/bin/sh\n{line}\n")
        (tmp_path / name).chmod(0o755)
    given = {"DATASET": "my data; echo", "READING": "", "BASELINE": "$(x) y.json"}
    place = {"GITHUB_ACTION_PATH": str(ROOT / ".github/actions/audit"), "RUNNER_TEMP": str(tmp_path)}
    variables = os.environ | given | place | {"PATH": f"{tmp_path}/bin:{os.environ['PATH']}"}
    done = subprocess.run(["bash", "-e", "-c", step["run"]], env=variables, capture_output=True, text=True, check=True)
    asked = done.stdout.splitlines()
    assert asked[asked.index("z2r") :] == [
        *("z2r", "audit", "my data; echo", "--format", "github", "--baseline", "$(x) y.json")
    ]
    assert Path(asked[asked.index("--from") + 1]).resolve() == ROOT
