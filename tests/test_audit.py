"""Every damage of the bench is named by the audit, none is silent, and nothing is said of a dataset that is whole."""

import dataclasses
import json
import multiprocessing
import os
import re
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from concurrent.futures import ProcessPoolExecutor
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from damages import (
    BASES,
    DAMAGES,
    DATA,
    EPISODES,
    INFO,
    POSITIONS,
    STATE,
    change_values,
    drop_column,
    edit_column,
    edit_feature,
    edit_info,
    fingerprint,
    flip,
    make,
    read_json,
    set_at,
    truncate,
    wrong_in,
)
from framed import FRAMED, turn_the_world
from hypothesis import given, settings
from hypothesis import strategies as st
from layouts import (
    BOOKKEEPING,
    FEATURES,
    SHARD_PATH,
    Layout,
    data_files,
    lay_out,
    lay_out_again,
    shard_files,
    write_dataset,
)
from msgspec.structs import replace
from test_motion import MADE_TO_FAIL

import z2r
from z2r import Feature
from z2r.api import CHECKS, scene_of
from z2r.audits import audit as audit_module
from z2r.audits import cameras, pictures
from z2r.audits import claims as claims_module
from z2r.audits.findings import AUDIT
from z2r.audits.steps import run_sums
from z2r.audits.values import jumps
from z2r.check import Answer, parts_in
from z2r.format.tables import EPISODE_COLUMNS
from z2r.pusht import checks as checks_module
from z2r.pusht.scene import SCENE, PushTScene
from z2r.reading.verdict import verdict_path

pytestmark = pytest.mark.filterwarnings("error")  # a warning of numpy would end up on the screen


def said(audit: z2r.Audit) -> str:
    return "\n".join(f"[{finding.check}] {finding}" for finding in audit.findings) or "nothing"


def silent(root: Path) -> z2r.Audit:
    """Audit what has no fault."""
    audit = z2r.audit(root)
    assert not wrong_in(audit), said(audit)
    return audit


# --- every damage


@pytest.fixture
def opened(monkeypatch: pytest.MonkeyPatch) -> Iterator[set[Path]]:
    """What is opened, links followed: by Python itself, and by pyarrow."""
    paths: set[Path] = set()
    watching = [paths]

    def watch(event: str, args: tuple) -> None:
        if event == "open" and watching and isinstance(args[0], str | os.PathLike):
            paths.add(Path(args[0]).absolute())

    def memory_map(path, *args, **kwargs):
        paths.add(Path(path).absolute())
        return map_file(path, *args, **kwargs)

    map_file = pa.memory_map
    sys.addaudithook(watch)
    monkeypatch.setattr(pa, "memory_map", memory_map)
    yield paths
    watching.clear()


def outside(opened: set[Path], root: Path) -> set[Path]:
    """Files that are no business of an audit: beside the dataset, but for the verdict, and of the system."""
    beside = {path for path in opened if path.is_relative_to(root.parent) or path.is_relative_to("/etc")}
    real = {path.resolve() for path in beside if path.is_file()}
    return {path for path in real if not path.is_relative_to(root) and not path.name.endswith(".verdict.json")}


@pytest.mark.parametrize("kind", DAMAGES)
def test_a_damage_is_named(kind, tmp_path, opened):
    damage, root = DAMAGES[kind], tmp_path / "dataset"
    make(kind, root)
    before = fingerprint(tmp_path)
    opened.clear()
    audit = z2r.audit(root)
    assert not outside(opened, root)
    assert fingerprint(tmp_path) == before
    assert any(
        finding.check in damage.checks.split()
        and finding.file.startswith(damage.file)
        and damage.says in str(finding)
        and (damage.harmless or finding.severity != "note")
        for finding in audit.findings
    ), said(audit)
    assert audit.exit_code == (3 if not audit.readable else 0 if damage.harmless else 1)
    # One rule book: what the reader refuses is an error here, too.
    assert damage.reader is None or any(finding.severity == "error" for finding in audit.findings), said(audit)
    for finding in audit.findings:
        assert finding.check != AUDIT.name
        assert finding.frame is None or finding.check in FRAMED
        assert str(finding).isprintable()
        assert len(str(finding).replace(str(root), "")) <= 400  # a command names the folder


# --- no damage


@pytest.mark.parametrize("base", sorted(BASES.keys() - {"unpadded"}))
def test_nothing_is_said_of_a_whole_dataset(base, tmp_path):
    BASES[base](tmp_path / "dataset")
    audit = silent(tmp_path / "dataset")
    assert audit.exit_code == 0


def mirror_the_world(root: Path) -> None:
    """Look at it in a mirror; the block looks the same in it."""
    BASES["split"](root)
    change_values(["pusher_x", "tee_x", "target_x", "sin_tee_yaw", "sin_target_yaw", "pusher_vx"], np.negative)(root)


def shift_the_world(root: Path) -> None:
    BASES["split"](root)
    change_values(POSITIONS, lambda values: values + 0.25)(root)


@pytest.mark.parametrize("change", [turn_the_world, mirror_the_world, shift_the_world])
def test_nothing_is_said_of_the_same_story_seen_from_elsewhere(change, tmp_path):
    change(tmp_path / "dataset")
    silent(tmp_path / "dataset")


@pytest.mark.parametrize("name", ["STANDIN", "MESSY"])
def test_nothing_is_said_of_what_is_shipped_with_its_verdict(name):
    audit = silent(getattr(z2r, name))
    assert audit.not_checked


def test_nothing_is_said_of_what_lerobot_records(recorded, tmp_path):
    root = Path(shutil.copytree(recorded, tmp_path / "dataset"))
    forget_names(root)
    audit = silent(root)
    assert (audit.n_episodes, audit.n_frames) == (12, 202)


@pytest.mark.parametrize("n_frames", [373, 2000])
def test_nothing_is_said_of_columns_that_stand_still_as_lerobot_sums_them_up(n_frames, tmp_path, monkeypatch):
    from lerobot.datasets.lerobot_dataset import LeRobotDataset

    # To embed pictures, LeRobot goes through all rows, one by one. Here are none.
    monkeypatch.setattr("lerobot.datasets.dataset_writer.embed_images", lambda dataset: dataset)
    rng = np.random.default_rng(0)
    still = (rng.uniform(-1, 1, 16) * 10 ** rng.uniform(-2, 2.5, 16)).astype(np.float32)
    features = {name: {"dtype": "float32", "shape": still.shape, "names": None} for name in (STATE, "action")}
    where = {"repo_id": "test/test", "root": tmp_path / "dataset", "video_backend": "pyav"}
    dataset = LeRobotDataset.create(**where, fps=30, features=features, use_videos=False)
    for length in (n_frames, n_frames + 1):  # two of one length would be one demonstration twice
        for _ in range(length):
            dataset.add_frame({STATE: still, "action": still, "task": "push it"})
        dataset.save_episode()
    dataset.finalize()
    silent(tmp_path / "dataset")


@pytest.mark.parametrize(("noise", "max_steps"), [(0.3, 300), (0.3, 5)])
def test_nothing_is_said_of_noisy_or_very_short_demonstrations(noise, max_steps, tmp_path):
    z2r.record(tmp_path / "dataset", range(100, 106), noise=noise, max_steps=max_steps)
    silent(tmp_path / "dataset")


def test_nothing_is_said_of_a_matrix_that_lerobot_records(tmp_path):
    from lerobot.datasets.lerobot_dataset import LeRobotDataset

    matrix = {"dtype": "float32", "shape": (4, 5), "names": None}
    features = {"observation.matrix": matrix, "action": matrix}
    where = {"repo_id": "test/test", "root": tmp_path / "dataset", "video_backend": "pyav"}
    dataset = LeRobotDataset.create(**where, fps=10, features=features, use_videos=False)
    for matrix, action in np.random.default_rng(0).normal(size=(60, 2, 4, 5)).astype(np.float32):
        dataset.add_frame({"observation.matrix": matrix, "action": action, "task": "push it"})
    dataset.save_episode()
    dataset.finalize()
    silent(tmp_path / "dataset")


def seldom_used(rng: np.random.Generator, episode: int) -> np.ndarray:
    """A gripper that closes and opens in three of ten episodes, and a sensor that is never quite still."""
    used = 20 * np.clip(np.sin(np.linspace(0, np.pi, 100)) - 0.3, 0, None) * (episode in (2, 5, 8))
    return np.round(used + rng.normal(0, 0.02, 100), 2)


def sparse_reward(rng: np.random.Generator, episode: int) -> np.ndarray:
    return (np.arange(100) >= 98) * (episode in (1, 4, 7)) + rng.normal(0, 1e-3, 100)


def end_of_range(rng: np.random.Generator, episode: int) -> np.ndarray:
    """An angle that goes to and fro about the place where it is wrapped."""
    turning = np.pi * (episode == 3) + rng.normal(0, 0.01, 100)
    return np.mod(turning + np.pi, 2 * np.pi) - np.pi


def spike(rng: np.random.Generator, episode: int) -> np.ndarray:
    values = np.cumsum(rng.normal(0, 0.01, 100))
    values[50] += 3.0 * (episode == 6)
    return values


@pytest.mark.parametrize(("signal", "n_jumps"), [(seldom_used, 0), (sparse_reward, 0), (end_of_range, 0), (spike, 1)])
def test_a_jump_leaps_away_and_back(signal, n_jumps):
    rng = np.random.default_rng(0)
    values = np.concatenate([signal(rng, episode) for episode in range(10)])[:, None].astype(np.float32)
    stats, _ = run_sums(values, 100 * np.arange(10), fps=10)
    assert len(list(jumps("observation.state", Feature("float32", (1,)), stats, np.arange(10)))) == n_jumps


def forget_names(root: Path) -> None:
    """Take random frames for what they are: no pusher, no block."""
    edit_feature(root, STATE, names=None)
    edit_feature(root, "action", names=None)


@st.composite
def layouts(draw):
    """Lengths of episodes, and how many of them each data file and each shard holds."""
    lengths = draw(st.lists(st.integers(1, 30), min_size=1, max_size=12))

    def parts() -> list[int]:
        cuts = sorted(draw(st.sets(st.integers(1, len(lengths) - 1)))) if len(lengths) > 1 else []
        return np.diff([0, *cuts, len(lengths)]).tolist()

    return lengths, parts(), parts()


@settings(max_examples=40)
@given(layout=layouts(), chunk_size=st.integers(1, 4), seed=st.integers(0, 99))
def test_nothing_is_said_of_any_layout(layout, chunk_size, seed):
    with tempfile.TemporaryDirectory() as folder:
        root = Path(folder) / "dataset"
        lay_out(root, *layout, seed=seed, chunk_size=chunk_size)
        forget_names(root)
        audit = silent(root)
        assert (audit.n_episodes, audit.n_frames) == (len(layout[0]), sum(layout[0]))


def test_nothing_is_said_of_thousands_of_episodes(tmp_path):
    lengths = np.random.default_rng(0).integers(1, 9, 3000)
    lay_out(tmp_path / "dataset", lengths, files=[250] * 12, shards=[1000] * 3)
    forget_names(tmp_path / "dataset")
    audit = silent(tmp_path / "dataset")
    assert audit.n_episodes == 3000


def test_nothing_is_said_of_episodes_of_hours(tmp_path):
    """The timestamps of LeRobot are float32: after an hour, a step between two of them is more than the tolerance."""
    lay_out(tmp_path / "dataset", [80_000, 1, 2], files=[2, 1], shards=[3])
    forget_names(tmp_path / "dataset")
    silent(tmp_path / "dataset")


def test_nothing_is_said_of_hundreds_of_files(tmp_path):
    n = 250
    lay_out(tmp_path / "dataset", [1] * n, files=[1] * n, shards=[1] * n)
    forget_names(tmp_path / "dataset")
    silent(tmp_path / "dataset")


def rest_everywhere(state: np.ndarray, action: np.ndarray) -> None:
    """A fixed target, a gripper that stays shut, an action that nobody uses: constant everywhere, and nothing wrong."""
    state[:, 2] = 0.1
    action[:, 1] = 0


def rest_in_some_episodes(state: np.ndarray, action: np.ndarray) -> None:
    """A joint that 3 of 8 demonstrations do not need."""
    state[60:150, 2] = state[60, 2]


def rest_in_a_short_episode(state: np.ndarray, action: np.ndarray) -> None:
    state[-10:, 2] = state[-1, 2]


def switch(state: np.ndarray, action: np.ndarray) -> None:
    """A gripper that one demonstration never closes."""
    state[:, 2] = np.arange(len(state)) % 30 > 20
    state[30:60, 2] = 0


def drift(state: np.ndarray, action: np.ndarray) -> None:
    """Slow motion far from the origin: rounding is large, steps are small."""
    state[:] = 1000 + np.arange(len(state))[:, None] * 1e-3


@pytest.mark.parametrize("names", [None, ["x", "y", "held"]])
@pytest.mark.parametrize("how", [rest_everywhere, rest_in_some_episodes, rest_in_a_short_episode, switch, drift])
def test_a_column_that_rests_is_no_dead_joint(how, names, tmp_path):
    time = np.arange(250)[:, None]
    state, action = (np.sin(time * speed).astype(np.float32) for speed in ([0.3, 0.5, 0.7], [0.2, 0.4]))
    how(state, action)
    features = FEATURES | BOOKKEEPING
    features |= {
        STATE: {"dtype": "float32", "shape": [3], "names": names},
        "action": {"dtype": "float32", "shape": [2], "names": None},
    }
    layout = Layout([9], [9], episode_stats=True)
    write_dataset(tmp_path / "dataset", {STATE: state, "action": action}, [30] * 8 + [10], layout, features=features)
    silent(tmp_path / "dataset")


# --- a random change is never silent

FEW = settings(max_examples=30)


@pytest.fixture(scope="module")
def split(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("split") / "dataset"
    lay_out_again(z2r.MESSY, root, Layout([3, 4, 1, 4, 2], [5, 6, 3]))
    return root


def copied(source: Path, folder: str) -> Path:
    return Path(shutil.copytree(source, Path(folder) / "dataset"))


numbers = st.one_of(st.integers(-3, 20), st.integers(-(2**63), 2**63 - 1), st.sampled_from([313, 314, 1108, 10**9]))


@FEW
@given(column=st.sampled_from(EPISODE_COLUMNS), shard=st.integers(0, 2), row=st.integers(0, 2), value=numbers)
def test_a_random_value_in_the_episode_metadata_is_not_silent(split, column, shard, row, value):
    with tempfile.TemporaryDirectory() as folder:
        root = copied(split, folder)
        file = SHARD_PATH.format(chunk_index=0, file_index=shard)
        if pq.read_table(root / file).column(column)[row].as_py() == value:
            return
        edit_column(root, file, column, set_at(row, value))
        assert z2r.audit(root).exit_code == 1


@FEW
@given(
    column=st.sampled_from(["frame_index", "episode_index", "index", "task_index"]), row=st.integers(0), value=numbers
)
def test_a_random_number_in_the_bookkeeping_is_not_silent(split, column, row, value):
    with tempfile.TemporaryDirectory() as folder:
        root = copied(split, folder)
        values = pq.read_table(root / DATA).column(column)
        if values[row % len(values)].as_py() == value:
            return
        edit_column(root, DATA, column, set_at(row, value))
        assert z2r.audit(root).exit_code == 1


@FEW
@given(row=st.integers(0), value=st.floats(width=32))
def test_a_random_timestamp_is_not_silent(split, row, value):
    with tempfile.TemporaryDirectory() as folder:
        root = copied(split, folder)
        values = pq.read_table(root / DATA).column("timestamp")
        if abs(values[row % len(values)].as_py() - value) < 1e-3:
            return
        edit_column(root, DATA, "timestamp", set_at(row, value))
        assert z2r.audit(root).exit_code == 1


PLACES = (INFO, EPISODES, "meta/tasks.parquet", "meta/stats.json", DATA)


@FEW
@given(file=st.sampled_from(PLACES), share=st.floats(0, 0.999))
def test_a_file_that_is_cut_anywhere_is_named(file, share):
    with tempfile.TemporaryDirectory() as folder:
        root = copied(z2r.STANDIN, folder)
        truncate(root / file, share)
        audit = z2r.audit(root)
        assert any(finding.file == file for finding in audit.findings), said(audit)


@settings(max_examples=100)
@given(file=st.sampled_from([EPISODES, "meta/tasks.parquet", DATA]), place=st.integers(0), mask=st.integers(1, 255))
def test_a_flipped_byte_is_named_if_it_changes_what_matters(file, place, mask):
    with tempfile.TemporaryDirectory() as folder:
        root = copied(z2r.STANDIN, folder)
        whole = pq.read_table(root / file)
        flip(root / file, place % (root / file).stat().st_size, mask)
        audit = z2r.audit(root)
        if matters(whole, root / file):
            assert set(audit.findings) - SAID_OF_THE_WHOLE


SAID_OF_THE_WHOLE = set(z2r.audit(z2r.STANDIN).findings)


def matters(whole: pa.Table, path: Path) -> bool:
    """Tell whether a file cannot be read any more, or says something else that the audit is there to see.

    A number that is off by less than what statistics can show is not, nor are quantiles, which are estimates, nor
    statistics of the bookkeeping, which LeRobot leaves behind when it edits; and nobody misses one of an episode.
    """
    seen = [
        name
        for name in whole.column_names
        if not re.search("/q[0-9]+$|^task$|^tasks$|^meta/|^stats/(timestamp|.*index)/", name)
    ]
    try:
        present = pq.ParquetFile(path).schema_arrow.names
        seen = [name for name in seen if name in present or not name.startswith("stats/")]
        found = pq.ParquetFile(path).read(columns=seen)
    except Exception:
        return True
    return found.schema.names != seen or any(differs(whole.column(name), found.column(name)) for name in seen)


def differs(before: pa.ChunkedArray, after: pa.ChunkedArray) -> bool:
    if before.type != after.type or len(before) != len(after) or after.null_count:
        return not before.equals(after)
    try:
        before, after = (np.array(column.to_pylist(), dtype=float) for column in (before, after))
    except ValueError:  # rows of different length, which the whole column has not
        return True
    return before.shape != after.shape or not np.allclose(before, after, rtol=1e-2, atol=2e-2)


# --- what else the audit says


BREAKS = {
    # the check that must see it, and in which dataset
    "yaw-swap": ("overlap", "split"),
    "drop-boundaries": ("leap", "split"),
    "yaw-swap-everywhere": ("overlap", "split"),
    "no-wrap": ("yaw-error", "turned"),
    "inclusive-end": ("range-overlap", "split"),
    "first-shard-only": ("totals", "split"),
    "stale-file-pointer": ("episode-order", "split"),
    "name-sorted-files": ("episode-column", "unpadded"),
    "wrong-reference-point": ("overlap", "split"),
    "degrees-for-radians": ("verdict", "shipped"),
    "first-frame-for-last": ("decisive-frame", "split"),
    "wrong-fps": ("timestamp", "split"),
    "action-lag": ("action-motion", "split"),
    "joints-exchanged": ("action-motion", "split"),
}


@pytest.mark.parametrize("mode", BREAKS)
def test_a_break_mode_leaves_its_trace(mode, tmp_path):
    check, base = BREAKS[mode]
    root = z2r.STANDIN if base == "shipped" else tmp_path / "dataset"
    if base != "shipped":
        (turn_the_world if base == "turned" else BASES[base])(root)
    assert check in {finding.check for finding in z2r.audit(root, z2r.BREAK_MODES[mode]).findings}


def test_what_leaves_no_trace(split):
    """As long as the target's yaw is 0, no difference is more than half a turn, wrapped or not."""
    assert not wrong_in(z2r.audit(split, z2r.break_mode("no-wrap")))


def test_only_what_is_whole_can_be_believed_wrong(standin_copy):
    edit_info(standin_copy, total_frames=3)
    with pytest.raises(z2r.DatasetError, match="total_frames"):
        z2r.audit(standin_copy, z2r.break_mode("yaw-swap"))


def test_every_check_is_made_to_fail_by_some_damage():
    named = {check for damage in DAMAGES.values() for check in damage.checks.split()}
    of_cameras = {part.check.name for part in parts_in(cameras, pictures)}  # which `test_cameras.py` damages
    # Of motion: `test_motion.py`, `test_scales.py`, `test_relations.py` and `test_deeds.py`.
    deeds = {
        "task-motion",
        "grasp",
        "long-episode",
        "left-right",
        "label-moment",
        "resolution",
        "two-kinds",
        "stick",
        "play",
        "robot-type",
        "echo",
    }
    of_tasks = {"task-remark", "task-encoding"}  # `test_tasks.py`
    elsewhere = of_cameras | set(MADE_TO_FAIL) | {"velocity", "relation"} | deeds | of_tasks
    assert (named | {check for check, _ in BREAKS.values()}) - elsewhere == set(CHECKS) - elsewhere - {AUDIT.name}


def test_a_check_is_declared_once():
    """A scene may ask what the audit asks: then both are parts of one check."""
    checks = [part.check for part in (*audit_module.PARTS, *SCENE.checks)]
    assert len({check.name for check in checks}) == len(set(checks)) == len(CHECKS) - 1


def test_findings_come_in_the_order_of_the_checks(standin_copy):
    edit_info(standin_copy, total_frames=3, splits={"train": "0:9"})
    edit_column(standin_copy, DATA, "timestamp", set_at(100, 99.0))
    order = [list(CHECKS).index(finding.check) for finding in z2r.audit(standin_copy).findings]
    assert order == sorted(order)
    assert len(set(order)) >= 3


def test_a_fault_in_every_file_does_not_hide_the_others(tmp_path):
    n = 40
    lay_out(tmp_path / "dataset", [3] * n, files=[1] * n, shards=[n])
    forget_names(tmp_path / "dataset")
    for path in data_files(tmp_path / "dataset"):
        edit_column(tmp_path / "dataset", str(path.relative_to(tmp_path / "dataset")), "index", lambda v: [9] * len(v))
    edit_info(tmp_path / "dataset", total_tasks=7)
    audit = z2r.audit(tmp_path / "dataset")
    assert {"index-column", "totals"} <= {finding.check for finding in audit.findings}
    assert len(audit.findings) < 20
    assert sum(finding.check == "index-column" for finding in audit.findings) + audit.more["index-column"] >= n - 1


def test_what_cannot_be_read_is_said_to_be_unchecked(tmp_path):
    BASES["split"](tmp_path / "dataset")
    data_files(tmp_path / "dataset")[1].write_bytes(b"")
    audit = z2r.audit(tmp_path / "dataset")
    assert any("1 of 5 data files" in line for line in audit.not_checked)
    assert audit.n_frames == sum(
        pq.read_metadata(path).num_rows for i, path in enumerate(data_files(tmp_path / "dataset")) if i != 1
    )


def test_a_reading_that_does_not_fit_is_said_to_be_unchecked(standin_copy):
    forget_names(standin_copy)
    audit = silent(standin_copy)
    assert len(audit.not_checked) > len(z2r.audit(z2r.STANDIN).not_checked)


def test_progress_is_told_of_every_file(split):
    told = []
    z2r.audit(split, progress=lambda done, total: told.append((done, total)))
    assert told == [(done, 5) for done in range(1, 6)]


def test_thousands_of_bad_rows_are_one_line(tmp_path):
    BASES["split"](tmp_path / "dataset")
    for path in shard_files(tmp_path / "dataset"):
        edit_column(tmp_path / "dataset", str(path.relative_to(tmp_path / "dataset")), "length", lambda v: [1] * len(v))
    lines = [finding for finding in z2r.audit(tmp_path / "dataset").findings if finding.check == "range-length"]
    assert len(lines) == 1
    assert "13 more" in str(lines[0])


# --- what the audit must not be stopped by


def break_check(monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    """Let one check, one that any dataset is asked, fail by itself."""

    def fail(_: object) -> Iterator[Answer]:
        raise KeyError("typo")
        yield

    parts = tuple(
        dataclasses.replace(part, run=fail) if part.check.name == name else part for part in audit_module.PARTS
    )
    monkeypatch.setattr(audit_module, "PARTS", parts)


@pytest.mark.parametrize("name", ["info", "totals", "index-column", "unit-circle", "twin"])
def test_a_check_that_fails_is_a_finding_and_not_the_end(name, standin_copy, monkeypatch):
    edit_info(standin_copy, splits={"train": "0:99"})
    break_check(monkeypatch, name)
    audit = z2r.audit(standin_copy)
    assert {finding.check for finding in wrong_in(audit)} == {"splits", AUDIT.name}
    [said_of_it] = {(finding.field, finding.found) for finding in audit.findings if finding.check == AUDIT.name}
    assert said_of_it == (name, "KeyError: 'typo'")
    assert any(line.startswith(name) for line in audit.not_checked)
    assert audit.exit_code == 1


def test_a_check_of_what_cannot_be_read_that_fails_is_a_finding(standin_copy, monkeypatch):
    (standin_copy / INFO).unlink()
    break_check(monkeypatch, "info")
    audit = z2r.audit(standin_copy)
    assert [finding.check for finding in audit.findings] == [AUDIT.name]
    assert audit.exit_code == 3


def test_a_scene_that_fails_is_a_finding_and_not_the_end(monkeypatch):
    monkeypatch.setattr(PushTScene, "fold", lambda *_: 1 / 0)
    audit = z2r.audit(z2r.STANDIN)
    [finding] = wrong_in(audit)
    assert (finding.check, finding.found) == (AUDIT.name, "ZeroDivisionError: division by zero")
    assert any("scene" in line for line in audit.not_checked)


def test_a_check_of_a_scene_that_fails_is_a_finding_and_not_the_end(monkeypatch):
    monkeypatch.setattr(checks_module, "read_verdict", lambda _: [][0])
    audit = z2r.audit(z2r.STANDIN)
    assert ("verdict", "IndexError: list index out of range") in {(each.field, each.found) for each in audit.findings}


@pytest.mark.parametrize(
    ("reader", "mode"), [("read_stats", None), ("read_data_file", "action-lag"), ("read_data_blocks", None)]
)
def test_a_reader_that_fails_is_a_finding_and_not_the_end(reader, mode, monkeypatch):
    believed = mode and z2r.break_mode(mode)
    known = {finding.check for finding in wrong_in(z2r.audit(z2r.STANDIN, believed))}
    for module in (claims_module, audit_module):
        if hasattr(module, reader):
            monkeypatch.setattr(module, reader, lambda *_, **__: 1 / 0)
    audit = z2r.audit(z2r.STANDIN, believed)
    assert audit.exit_code
    assert {finding.check for finding in wrong_in(audit)} - known == {AUDIT.name}


@pytest.mark.parametrize("feature", ["action", STATE])
def test_a_dataset_without_an_action_or_a_state_is_audited(feature, standin_copy):
    """The rest of it is; what the scene would see is not."""
    info, stats = (read_json(standin_copy, file) for file in (INFO, "meta/stats.json"))
    del stats[feature]
    (standin_copy / "meta/stats.json").write_text(json.dumps(stats))
    edit_info(standin_copy, features={name: value for name, value in info["features"].items() if name != feature})
    drop_column(standin_copy, DATA, feature)
    audit = z2r.audit(standin_copy)
    assert [finding.check for finding in wrong_in(audit)] == ["policy-features"]
    assert audit.n_frames == 427
    assert len(audit.not_checked) > len(z2r.audit(z2r.STANDIN).not_checked)


def test_a_reading_without_a_scene_says_what_nobody_looked_at(standin_copy):
    audit = z2r.audit(standin_copy, reading=replace(z2r.PUSHT, scene=None))
    assert not wrong_in(audit)
    assert any("the reading has no scene" in line for line in audit.not_checked)
    assert "PushT" not in " ".join(audit.not_checked)
    nothing = audit_module.audit(standin_copy)
    assert not wrong_in(nothing)
    assert any("no reading fits" in line for line in nothing.not_checked)


def test_a_scene_is_named_by_its_reading_and_has_bodies_that_the_reading_must_have():
    assert scene_of(z2r.PUSHT) is not None
    assert scene_of(z2r.PUSHT.with_goal("ang_err", within=0.1)) is not None
    assert scene_of(replace(z2r.PUSHT, scene=None)) is None
    with pytest.raises(ValueError, match="expected one of pusht"):
        scene_of(replace(z2r.PUSHT, scene="kitchen"))
    with pytest.raises(ValueError, match="pusher"):
        scene_of(replace(z2r.PUSHT, poses={name: z2r.PUSHT.poses[name] for name in ("tee", "target")}))


def test_a_dataset_is_audited_where_it_lies():
    assert z2r.audit(z2r.load(z2r.MESSY)) == z2r.audit(z2r.MESSY)


def test_other_processes_find_what_threads_find(split, tmp_path):
    root = copied(split, str(tmp_path))
    data_files(root)[1].write_bytes(b"")
    edit_column(root, DATA, "timestamp", set_at(100, 99.0))
    threads = z2r.audit(root)
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as processes:
        assert z2r.audit(root, executor=processes) == threads
        assert wrong_in(z2r.audit(split, z2r.break_mode("wrong-fps"), executor=processes))
    assert {finding.check for finding in threads.findings} >= {"data-file", "timestamp"}


def denied(path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """Take the right to read one file away, also from who may read everything."""

    def guard(read):
        def guarded(file, *args, **kwargs):
            if Path(file) == path:
                raise PermissionError(13, "Permission denied", str(file))
            return read(file, *args, **kwargs)

        return guarded

    for owner, name in ((Path, "read_bytes"), (pa, "memory_map")):
        monkeypatch.setattr(owner, name, guard(getattr(owner, name)))


@pytest.mark.parametrize(
    ("file", "check", "readable"),
    [
        (INFO, "info", False),
        (EPISODES, "episodes-file", False),
        ("meta/tasks.parquet", "tasks-file", True),
        ("meta/stats.json", "stats-file", True),
        (DATA, "data-file", True),
    ],
)
def test_a_file_that_nobody_may_read_is_not_called_damaged(file, check, readable, standin_copy, monkeypatch):
    denied(standin_copy / file, monkeypatch)
    audit = z2r.audit(standin_copy)
    [finding] = wrong_in(audit)
    assert (finding.check, finding.file, finding.found) == (check, file, "permission denied")
    assert "chmod" in finding.mend
    assert audit.readable == readable


@pytest.mark.parametrize("spoil", [lambda path, _: path.write_bytes(b"\xff{"), denied], ids=["broken", "denied"])
def test_a_verdict_that_cannot_be_read_is_a_finding(spoil, standin_copy, monkeypatch):
    path = verdict_path(standin_copy)
    shutil.copy(verdict_path(z2r.STANDIN), path)
    spoil(path, monkeypatch)
    [finding] = wrong_in(z2r.audit(standin_copy))
    assert (finding.check, finding.severity, finding.file) == ("verdict", "warning", path.name)
    assert finding.mend


def test_a_folder_that_nobody_may_look_into_is_said_to_be_one(standin_copy, monkeypatch):
    def closed(folder):
        raise PermissionError(13, "Permission denied", str(folder))

    monkeypatch.setattr(Path, "iterdir", closed)
    [finding] = wrong_in(z2r.audit(standin_copy))
    assert (finding.check, finding.found) == ("episodes-file", "permission denied")


# --- the command


def run(*args: object, cwd: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", "from z2r.cli import main; main()", "audit", *map(str, args)]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=60, check=False)


def test_the_command_on_a_whole_dataset(tmp_path):
    result = run(cwd=tmp_path)
    assert (result.returncode, result.stderr) == (0, "")
    assert "not checked" in result.stdout.lower()
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("command", [["audit"], ["inspect", "--no-rerun", "--out", "../out"]], ids=lambda args: args[0])
def test_the_folder_one_stands_in_is_a_dataset(command, standin_copy):
    program = f"import sys; from z2r.cli import main; sys.argv = ['z2r', *{command}, '.']; main()"
    done = subprocess.run(
        [sys.executable, "-c", program], cwd=standin_copy, capture_output=True, text=True, check=False
    )
    assert (done.returncode, done.stderr) == (0, "")
    assert standin_copy.name in done.stdout


@pytest.mark.parametrize(
    ("kind", "code"),
    [("total_frames off by 17", 1), ("info missing", 3), ("no episode metadata", 3), ("stats missing", 1)],
)
def test_the_command_on_a_damaged_one(kind, code, tmp_path):
    make(kind, tmp_path / "dataset")
    result = run(tmp_path / "dataset", cwd=tmp_path)
    assert result.returncode == code
    assert "Traceback" not in result.stdout + result.stderr
    assert DAMAGES[kind].checks in result.stdout
    assert DAMAGES[kind].file in result.stdout


KEYS = {
    "source",
    "exit_code",
    "n_episodes",
    "n_frames",
    "n_errors",
    "n_warnings",
    "n_notes",
    "findings",
    "more",
    "not_checked",
}


@pytest.mark.parametrize(("kind", "code"), [(None, 0), ("a timestamp jump", 1), ("info missing", 3)])
def test_json_is_the_audit_and_nothing_else(kind, code, tmp_path):
    root = tmp_path / "dataset"
    make(kind, root) if kind else shutil.copytree(z2r.STANDIN, root)
    result = run(root, "--json", cwd=tmp_path)
    told = json.loads(result.stdout)
    assert (result.returncode, told["exit_code"], result.stderr) == (code, code, "")
    assert told.keys() >= KEYS
    assert told == z2r.audit(root).to_dict("dataset")
    for finding in told["findings"]:
        assert finding.keys() >= {"check", "severity", "file", "field", "found", "expected", "mend", "episodes"}
        assert finding["severity"] in ("error", "warning", "note")
