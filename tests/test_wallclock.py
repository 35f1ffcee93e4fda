"""The ledger says what was measured, and nothing of what was not."""

import subprocess
from pathlib import Path

import pytest

from z2r.show import wallclock
from z2r.show.wallclock import LEDGER, NOT_YET, TIERS, expectation, ledger_table, machine_tier, read_ledger

README = Path(__file__).parents[1] / "README.md"


def test_it_holds_measured_runs_of_known_tiers():
    runs = read_ledger()
    assert len(runs) == len(LEDGER.read_text().splitlines()) - 1 > 0
    assert {run.tier for run in runs} <= set(TIERS)
    assert len({(run.tier, run.command, run.size) for run in runs}) == len(runs)
    assert all(run.seconds > 0 and run.runs >= 3 and run.size > 0 for run in runs)


def test_a_smaller_run_is_told_the_size_that_was_measured_and_a_larger_one_nothing():
    small, large = (run for run in read_ledger() if run.command == "inspect --no-rerun")
    assert expectation(small.command, small.size, small.tier) == f"measured: {small}"
    assert expectation(small.command, small.size + 1, small.tier) == f"measured: {large}"
    assert expectation(small.command, large.size + 1, small.tier) == f"{NOT_YET} at this size"
    assert expectation(small.command, 1, "4090") == NOT_YET
    assert f"{large}".startswith("1,000,000 frames in ")


@pytest.mark.parametrize(
    ("system", "gpus", "tier"),
    [
        ("Linux x86_64", "", "cpu-laptop"),
        ("Linux x86_64", "Tesla T4\n", "t4"),
        ("Linux x86_64", "NVIDIA GeForce RTX 4090\n", "4090"),
        ("Linux x86_64", "NVIDIA GeForce GT 710\n", "cpu-laptop"),
        ("Darwin arm64", "", "mps"),
        ("Darwin x86_64", "", "cpu-laptop"),
    ],
)
def test_the_tier_is_that_of_the_machine(system, gpus, tier, monkeypatch):
    monkeypatch.setattr(wallclock.platform, "system", lambda: system.split()[0])
    monkeypatch.setattr(wallclock.platform, "machine", lambda: system.split()[1])
    monkeypatch.setattr(wallclock.shutil, "which", lambda name: (gpus and f"/bin/{name}") or None)
    monkeypatch.setattr(wallclock.subprocess, "run", lambda *_, **__: subprocess.CompletedProcess([], 0, gpus, ""))
    assert machine_tier() == tier


def test_a_driver_that_hangs_is_no_gpu(monkeypatch):
    def hangs(*_: object, **__: object) -> None:
        raise subprocess.TimeoutExpired("nvidia-smi", 5)

    monkeypatch.setattr(wallclock.shutil, "which", lambda name: name)
    monkeypatch.setattr(wallclock.subprocess, "run", hangs)
    assert machine_tier() in {"cpu-laptop", "mps"}


def test_the_table_has_every_tier_measured_or_not_and_stands_in_the_readme():
    table = ledger_table()
    assert repr(table) == str(table) == table._repr_markdown_()
    for run in read_ledger():
        assert any(f"`{run.command}` | {run.size:,} {run.unit}" in line for line in table.splitlines())
        assert f"{run.seconds:.2f} s" in table
        assert run.stack in table
    assert f"| {NOT_YET} | {NOT_YET} | {NOT_YET} |" in table
    before, _, rest = README.read_text().partition("<!-- ledger: z2r.show.wallclock.ledger_table() -->\n\n")
    assert before
    assert rest.partition("\n\n<!-- end of ledger -->")[0] == str(table)
