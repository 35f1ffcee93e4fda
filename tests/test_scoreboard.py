"""The scoreboard asks each peer about the same copies and counts what is new; no peer but z2r is run here."""

import csv
import re
import shutil
import signal
import sys
from dataclasses import replace
from pathlib import Path

import pytest

import z2r

sys.path.insert(0, str(Path(__file__).parent / "benchmarks"))
import scoreboard
from peers import LEVELS, PEERS, Peer
from scoreboard import (
    AGAIN,
    BASE,
    HEALTHY,
    Case,
    alarms,
    all_cases,
    ask_all,
    heard,
    new,
    spread,
    unnumbered,
    write_table,
)

# It says of the dataset in its name what it says of the undamaged one, more, or nothing, or it never comes to an end.
FAKE = f"""#!{sys.executable}
import json, sys
name, report = sys.argv[1].split("/")[-2].removeprefix("damaged-"), sys.argv[2]
while name == "endless":
    pass
if name == "crash":
    raise KeyError(name)
places = {{"more": [0, 1], "silent": []}}.get(name, [0])
findings = [{{"check": "jump", "severity": "warning", "episodes": [place], "message": f"{{len(name)}} jumps"}}
            for place in places]
json.dump({{"findings": findings}}, open(report, "w"))
sys.exit(name == "more")
"""
KINDS = {"more": "warning", "silent": "", "same as before": "", "crash": "stop", "endless": ""}


@pytest.fixture
def fake(tmp_path):
    path = tmp_path / "fake.py"
    path.write_text(FAKE)
    path.chmod(0o755)
    return replace(PEERS["rdq"], command=f"{path} {{dataset}} {{report}}", requirement="", modules=())


def test_what_is_new_counts_and_nothing_is_asked_twice(tmp_path, fake, monkeypatch):
    monkeypatch.setattr(scoreboard, "CPU_LIMIT", 1)
    cases = {f"{BASE}/one": Case(BASE, Path.mkdir)}
    cases |= {f"damaged/{name}": Case("damaged", Path.mkdir, f"{BASE}/one") for name in KINDS}
    for name in cases:
        (scoreboard.folder_of(name, tmp_path) / "dataset").mkdir(parents=True)
    ask_all(list(cases)[:3], cases, tmp_path, {"rdq": fake})
    ask_all(list(cases), cases, tmp_path, {"rdq": fake})
    said = heard(tmp_path)
    assert sorted(own.dataset for own in said) == sorted(cases)
    board = {(own.peer, own.dataset): own for own in said}
    assert alarms(board, cases) == {("rdq", f"damaged/{name}"): level for name, level in KINDS.items()} | {
        ("rdq", f"{BASE}/one"): "warning"
    }
    assert new(board, "rdq", "damaged/more", f"{BASE}/one") == {"warning jump [1] # jumps"}
    assert [own.dataset for own in said if own.crashed] == ["damaged/crash"]
    assert [(own.dataset, own.code) for own in said if own.too_long] == [("damaged/endless", -signal.SIGXCPU)]
    write_table(board, cases, tmp_path)
    with (tmp_path / "scoreboard.csv").open() as file:
        cells = {row["dataset"]: row["rdq"] for row in csv.DictReader(file)}
    assert cells["damaged/crash"] == "stop crash"
    assert cells["damaged/endless"] == "too long"
    assert "| rdq | 2 of 5 | 1 of 5 |" in (tmp_path / "scoreboard.md").read_text()


def test_z2r_is_asked_as_the_others_are(tmp_path):
    cases = {f"{BASE}/standin": Case(BASE, Path.mkdir), "damaged/info": Case("damaged", Path.mkdir, f"{BASE}/standin")}
    for name in cases:
        shutil.copytree(z2r.STANDIN, scoreboard.folder_of(name, tmp_path) / "dataset")
    (scoreboard.folder_of("damaged/info", tmp_path) / "dataset/meta/info.json").write_text("{")
    ask_all(list(cases), cases, tmp_path, {"z2r": PEERS["z2r"]})
    board = {(own.peer, own.dataset): own for own in heard(tmp_path)}
    assert alarms(board, cases) == {("z2r", f"{BASE}/standin"): "note", ("z2r", "damaged/info"): "stop"}
    assert not any(own.crashed for own in board.values())
    assert all(own.cpu_seconds > 0 and 30 < own.mebibytes < 1000 for own in board.values())


def test_what_it_holds_back_is_a_note():
    told = [("HIGH", "loud", ["episode_0"], "jumps"), ("HIGH", "sure", [], "a dead joint"), ("PASS", "fine", [], "")]
    peer = Peer("", lambda report: report, {"HIGH": "stop"}, held_back=("loud",))
    assert list(scoreboard.findings(peer, told)) == ["note loud [episode_0] jumps", "stop sure [] a dead joint"]


@pytest.mark.parametrize(
    ("text", "expected"),
    [
        ("7.5% of episode 12 is frozen", "#% of episode 12 is frozen"),
        ("observation.state[10]: constant 0.0000", "observation.state[10]: constant #"),
        ("1,086 frames, 3 dropped", "# frames, # dropped"),
    ],
)
def test_numbers_that_say_how_much_do_not_count(text, expected):
    assert unnumbered(text) == expected


def test_every_kind_is_there_and_knows_what_it_was():
    cases = all_cases()
    assert {case.base for case in cases.values()} - {""} == {name for name, case in cases.items() if case.group == BASE}
    assert all(bool(case.base) != (case.group in (BASE, HEALTHY)) for case in cases.values())
    assert len({scoreboard.folder_of(name, Path()) for name in cases}) == len(cases)
    ordered = spread(cases)
    assert sorted(ordered) == sorted(cases)
    n_bases = sum(case.group == BASE for case in cases.values())
    tenth = ordered[n_bases : n_bases + len(cases) // 10]
    assert {cases[name].group for name in tenth} == {case.group for case in cases.values()} - {BASE}


def test_the_readme_says_what_was_measured():
    with (Path(scoreboard.__file__).parent / "scoreboard.csv").open() as file:
        rows = list(csv.DictReader(file))
    damaged = [row for row in rows if row["before"] and not row["dataset"].startswith(AGAIN)]
    whole = [row for row in rows if row["dataset"].startswith(HEALTHY)]
    readme = " ".join((scoreboard.ROOT / "README.md").read_text().split())
    assert f"the same {len(rows)} datasets" in readme
    assert f"Of {len(damaged)} kinds of damage" in readme
    of_damage, of_health = re.search(r"`z2r audit --pictures` says something (.*?)\. Of 114 (.*?)\. ", readme).groups()
    for peer in set(PEERS) - {"z2r"}:
        name = "" if peer.startswith("z2r") else f"{peer} "
        assert f"{name}at {sum(counts(row[peer], *LEVELS) for row in damaged)}" in of_damage
        named = peer.split()[0]
        assert re.search(rf"\b{named}\b[^\d]* at {sum(counts(row[peer], *LEVELS[1:]) for row in whole)}\b", of_health)


def counts(cell, *levels):
    return cell.partition(" ")[0] in levels
