"""Is a data file that is read in blocks the same as one that is read at once? And does memory stay where it is?"""

import json
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from arm_damages import KINDS, write_case
from damages import DAMAGES, DATA, make
from healthy import HEALTHY, write_healthy
from hypothesis import given, settings
from hypothesis import strategies as st
from layouts import BOOKKEEPING, Layout, read_dataset, write_dataset
from robots import write_arm

import z2r
from z2r.arrays import Pile, join_all
from z2r.audits import audit as audit_module
from z2r.audits import frames as frames_module
from z2r.audits.audit import Audit, audit
from z2r.audits.both import inspect_and_audit
from z2r.data import STANDIN
from z2r.format import parquet
from z2r.format.dataset import load
from z2r.format.tables import read_data_blocks, read_data_file
from z2r.pusht.scene import SCENE

TINY = 700  # numbers: some tens of frames
# What the metadata calls one episode lies in two blocks, which are cut where the frames say so.
ACROSS_A_CUT = (
    "one boundary off by one",
    "all boundaries off by one",
    "a boundary episode points at the file before",
    "a row dropped in the middle",
    "all rows backwards",
)


def write_fault(name: str, root: Path) -> None:
    write_case(name, KINDS[name].plant[0], root)


CASES = {
    **{f"damage: {kind}": (make, kind) for kind in (*list(DAMAGES)[::12], *ACROSS_A_CUT)},
    **{f"fault: {name}": (write_fault, name) for name in list(KINDS)[::12]},
    **{f"healthy: {name}": (write_healthy, name) for name in list(HEALTHY)[::8]},
}


@pytest.fixture
def head(monkeypatch: pytest.MonkeyPatch) -> Callable[[int], None]:
    """Let so many frames tell what is usual in a file: as many as are read at once at least."""

    def change(n_frames: int) -> None:
        for module in (audit_module, frames_module):
            monkeypatch.setattr(module, "HEAD_FRAMES", n_frames)

    return change


def whole_and_in_blocks(root: Path, n_numbers: int = TINY) -> tuple[Audit, Audit, int]:
    """Audit a dataset whole, and in blocks, and say how many of these there were."""
    n_blocks, fold = 0, audit_module._fold_block

    def counted(*args):
        nonlocal n_blocks
        n_blocks += 1
        return fold(*args)

    whole = audit(root, None, z2r.PUSHT, SCENE)
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(parquet, "_BLOCK", n_numbers)
        patch.setattr(audit_module, "_fold_block", counted)
        return whole, audit(root, None, z2r.PUSHT, SCENE), n_blocks


@pytest.mark.parametrize("case", CASES)
def test_an_audit_in_blocks_says_what_one_of_whole_files_says(case, head, tmp_path):
    head(150)
    write, name = CASES[case]
    write(name, tmp_path / "dataset")
    whole, in_blocks, _ = whole_and_in_blocks(tmp_path / "dataset")
    assert in_blocks == whole


@pytest.mark.parametrize("case", [case for case in CASES if case.startswith("damage")])
def test_a_scene_says_some_episodes_at_a_time_what_it_says_of_all(case, monkeypatch, tmp_path):
    write, name = CASES[case]
    write(name, tmp_path / "dataset")
    whole = audit(tmp_path / "dataset", None, z2r.PUSHT, SCENE)
    monkeypatch.setattr(audit_module, "_AT_ONCE", 100)
    assert audit(tmp_path / "dataset", None, z2r.PUSHT, SCENE) == whole


def test_rows_are_parted_where_a_run_starts():
    starts = np.array([0, 70, 150, 190, 300])
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(audit_module, "_AT_ONCE", 100)
        parts = [*audit_module._some_at_a_time(starts, 450)]
    assert [(rows.start, rows.stop) for rows in parts] == [(0, 150), (150, 300), (300, 450)]


@pytest.fixture(scope="module")
def arm(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_arm(tmp_path_factory.mktemp("arm"))[0].root


def change_a_value(table: pa.Table, column: str, row: int, value: object) -> pa.Table:
    """Put something else into a row, or into the first place of the list in it; None puts nothing there."""
    place, kind, values = table.column_names.index(column), table.schema.field(column), table[column].to_pylist()
    row %= len(values)
    if isinstance(values[row], list) and value is not None:
        values[row][0] = value
    elif values[row] is not None:
        values[row] = value
    return table.set_column(place, kind, pa.array(values, kind.type))


columns = st.sampled_from(["action", "observation.state", *BOOKKEEPING])
changes = st.lists(st.tuples(columns, st.integers(0, 999), st.sampled_from([None, 0, 1, 7, np.nan])), max_size=4)


@settings(max_examples=40)
@given(changes=changes, groups=st.sampled_from([7, 60, 10_000]), numbers=st.integers(200, 6_000))
def test_any_rows_may_be_wrong_in_any_block(arm, changes, groups, numbers, tmp_path_factory):
    root = tmp_path_factory.mktemp("any") / "dataset"
    frames, lengths = read_dataset(arm)
    info = json.loads((arm / "meta/info.json").read_text())
    names = [name for name in info["features"] if name in ("action", "observation.state")]
    layout = Layout(files=[len(lengths)], shards=[len(lengths)], data_path=info["data_path"])
    features = {name: info["features"][name] for name in names} | BOOKKEEPING
    write_dataset(root, {name: frames[name] for name in names}, lengths, layout, features=features, fps=info["fps"])
    table = pq.read_table(root / DATA)
    for column, row, value in changes:
        if value is None or pa.types.is_floating(table.schema.field(column).type) or value == value:
            table = change_a_value(table, column, row, value)
    pq.write_table(table, root / DATA, row_group_size=groups)
    with pytest.MonkeyPatch.context() as patch:
        for module in (audit_module, frames_module):
            patch.setattr(module, "HEAD_FRAMES", 100)
        whole, in_blocks, _ = whole_and_in_blocks(root, numbers)
    assert in_blocks == whole


def test_a_block_is_one_of_whole_episodes(monkeypatch):
    dataset = load(STANDIN)
    root, schema, path = dataset.root, dataset.schema, dataset.files[0].path.relative_to(dataset.root)
    whole = read_data_file(root, schema, path)
    assert len([*read_data_blocks(root, schema, path, least=1)]) == 1  # it fits one block, its last episode too
    monkeypatch.setattr(parquet, "_BLOCK", TINY)
    blocks = [*read_data_blocks(root, schema, path, least=1)]
    assert len(blocks) > 2
    assert [block.first for block in blocks] == np.cumsum([0, *(block.n_rows for block in blocks)])[:-1].tolist()
    for name, values in whole.frames.items():
        np.testing.assert_array_equal(np.concatenate([block.frames[name] for block in blocks]), values)
    numbers = [set(block.frames["episode_index"].ravel().tolist()) for block in blocks]
    assert sum(map(len, numbers)) == len(set().union(*numbers))
    assert len([*read_data_blocks(root, schema, path, least=10**9)]) == 1


def test_an_inspection_beside_an_audit_in_blocks_is_the_same(arm, monkeypatch, head):
    head(100)
    dataset = load(arm)
    whole = inspect_and_audit(dataset, keep=50)[0].metrics("arm", None)
    monkeypatch.setattr(parquet, "_BLOCK", TINY)
    assert inspect_and_audit(dataset, keep=50)[0].metrics("arm", None) == whole


class Some(NamedTuple):
    rows: np.ndarray
    names: list[int]
    perhaps: np.ndarray | None


@given(st.lists(st.integers(0, 5), min_size=1, max_size=6), st.integers(0, 20))
def test_a_pile_is_what_numpy_puts_together(sizes, room):
    every = [Some(np.arange(2.0 * n).reshape(n, 2), [n], None if n == 3 else np.ones(n)) for n in sizes]
    parts = [{"all": some} if n < 5 else {"all": some, "more": some} for n, some in zip(sizes, every, strict=True)]
    pile = Pile(room)
    for part in parts:
        pile.add(part)
    for whole in (pile.whole, join_all(parts)):
        np.testing.assert_array_equal(whole["all"].rows, np.concatenate([some.rows for some in every]))
        assert whole["all"].names == sizes
        assert (whole["all"].perhaps is None) == (3 in sizes)
        assert ("more" in whole) == (set(sizes) == {5})


# --- memory

PEAK = """
import resource, sys
from pathlib import Path
from z2r.audits.audit import audit
from z2r.format.dataset import load
from z2r.reading.inspection import inspect_dataset

root = Path(sys.argv[2])
inspect_dataset(load(root)) if sys.argv[1] == "inspect" else audit(root)
print(resource.getrusage(resource.RUSAGE_SELF).ru_maxrss // 1024)
"""


def peak(what: str, root: Path) -> int:
    """Return the peak memory of reading a dataset in a process of its own [MiB]."""
    launch = "import subprocess, sys; subprocess.run(sys.argv[1:], check=True)"  # a child begins with its parent's peak
    done = subprocess.run(
        [sys.executable, "-c", launch, sys.executable, "-c", PEAK, what, str(root)], capture_output=True, check=True
    )
    return int(done.stdout)


@pytest.fixture(scope="module", params=["one row group", "row groups of an episode"])
def large(request, tmp_path_factory) -> Path:
    """One data file of 900,000 frames of 40 numbers, in 300 episodes."""
    root, n_episodes, length = tmp_path_factory.mktemp("large") / "dataset", 300, 3_000
    rng, names = np.random.default_rng(0), [f"joint_{number}" for number in range(20)]
    one = np.cumsum(rng.normal(size=(length, 20)), axis=0).astype(np.float32)
    frames = {name: np.tile(one, (n_episodes, 1)) for name in ("observation.state", "action")}
    features = {name: {"dtype": "float32", "shape": [20], "names": names} for name in frames} | BOOKKEEPING
    lengths = [length] * n_episodes
    layout = Layout(files=[n_episodes], shards=[n_episodes])
    write_dataset(root, frames, lengths, layout, features=features, fps=30)
    if request.param == "one row group":
        table = pq.read_table(root / DATA)
        pq.write_table(table, root / DATA, row_group_size=len(table))
    return root


@pytest.mark.parametrize("what", ["inspect", "audit"])
def test_memory_does_not_grow_with_a_data_file(large, what):
    assert peak(what, large) < 300
