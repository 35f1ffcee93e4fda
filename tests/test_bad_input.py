"""Every fault is one DatasetError that names the place, and no run writes to a dataset."""

import hashlib
import json
import shutil
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest

import z2r
from z2r.schema import data_file_path, read_schema

INFO, EPISODES, DATA = "meta/info.json", "meta/episodes/chunk-000/file-000.parquet", "data/chunk-000/file-000.parquet"


def edit_info(root: Path, **changes) -> None:
    info = json.loads((root / INFO).read_text())
    (root / INFO).write_text(json.dumps({key: value for key, value in (info | changes).items() if value is not ...}))


def edit_column(root: Path, file: str, column: str, change: Callable[[list], list]) -> None:
    table = pq.read_table(root / file)
    place, kind = table.schema.get_field_index(column), table.schema.field(column).type
    values = pa.array(change(table.column(column).to_pylist()), kind)
    pq.write_table(table.set_column(place, column, values), root / file)


def drop_column(root: Path, file: str, column: str) -> None:
    pq.write_table(pq.read_table(root / file).drop_columns(column), root / file)


def truncate(path: Path, share: float) -> None:
    path.write_bytes(path.read_bytes()[: int(path.stat().st_size * share)])


def put(value: float, row: int, column: int) -> Callable[[list], list]:
    def change(rows: list) -> list:
        rows[row][column] = value
        return rows

    return change


def set_at(row: int, value: int) -> Callable[[list], list]:
    return lambda values: [value if i == row else old for i, old in enumerate(values)]


def escape_by_symlink(root: Path) -> None:
    outside = root.parent / "outside.parquet"
    (root / DATA).rename(outside)
    (root / DATA).symlink_to(outside)


def link_to_itself(root: Path) -> None:
    (root / DATA).unlink()
    (root / DATA).symlink_to(root / DATA)


def shape_9(root: Path) -> None:
    features = json.loads((root / INFO).read_text())["features"]
    features["observation.state"]["shape"] = [9]
    edit_info(root, features=features)


def ragged(root: Path) -> None:
    table = pq.read_table(root / DATA)
    rows = table.column("action").to_pylist()
    rows[5] = rows[5][:1]
    pq.write_table(table.set_column(1, "action", pa.array(rows, pa.list_(pa.float32()))), root / DATA)


def empty_episode(root: Path) -> None:
    """Give the frames of episode 2 to episode 3; all sums still agree."""
    start, stop = (pq.read_table(root / EPISODES).column(f"dataset_{end}_index").to_pylist() for end in ("from", "to"))
    edit_column(root, EPISODES, "dataset_to_index", set_at(2, start[2]))
    edit_column(root, EPISODES, "dataset_from_index", set_at(3, start[2]))
    edit_column(root, EPISODES, "length", set_at(2, 0))
    edit_column(root, EPISODES, "length", set_at(3, stop[3] - start[2]))


def garble_a_column_name(root: Path) -> None:
    data = (root / DATA).read_bytes()
    (root / DATA).write_bytes(data.replace(b"task_index", b"t\xffsk_index"))


def feature_without_a_dtype(root: Path) -> None:
    edit_info(root, features={"observation.state": {"shape": [10]}})


def append_rows(root: Path) -> None:
    table = pq.read_table(root / DATA)
    pq.write_table(pa.concat_tables([table, table.slice(0, 3)]), root / DATA)


FAULTS: dict[str, tuple[Callable[[Path], object], str, str]] = {
    # what is done to a whole dataset, the file that must be named, and what else the message must hold
    "no folder": (shutil.rmtree, "", "no such folder"),
    "no dataset": (lambda root: shutil.rmtree(root / "meta"), INFO, "no such file"),
    "a file for a folder": (lambda root: (shutil.rmtree(root), root.write_text("")), "", "no such folder"),
    "empty info": (lambda root: (root / INFO).write_text(""), INFO, "broken JSON"),
    "broken JSON": (lambda root: truncate(root / INFO, 0.5), INFO, "broken JSON"),
    "deep JSON": (lambda root: (root / INFO).write_text("[" * 10**6), INFO, "expected"),
    "JSON of another kind": (lambda root: (root / INFO).write_text("[1]"), INFO, "object"),
    "no text": (lambda root: (root / INFO).write_bytes(b"\xff\xfe\x00"), INFO, "broken JSON"),
    "version 2.1": (
        lambda root: edit_info(root, codebase_version="v2.1"),
        INFO,
        "lerobot.scripts.convert_dataset_v21_to_v30",
    ),
    "version 4": (lambda root: edit_info(root, codebase_version="v4.0"), INFO, "'v4.0'"),
    "no version": (lambda root: edit_info(root, codebase_version=...), INFO, "codebase_version"),
    "no fps": (lambda root: edit_info(root, fps=...), INFO, "fps"),
    "fps of 0": (lambda root: edit_info(root, fps=0), INFO, "fps: found 0"),
    "fps in words": (lambda root: edit_info(root, fps="ten"), INFO, 'fps: found "ten"'),
    "a feature without a dtype": (feature_without_a_dtype, INFO, "features.observation.state.dtype"),
    "totals: episodes": (lambda root: edit_info(root, total_episodes=7), INFO, "total_episodes: found 7, expected 6"),
    "totals: frames": (lambda root: edit_info(root, total_frames=10**9), INFO, "total_frames: found 1000000000"),
    "template: up": (lambda root: edit_info(root, data_path="../{chunk_index}/{file_index}"), INFO, "data_path"),
    "template: absolute": (lambda root: edit_info(root, data_path="/etc/{file_index}"), INFO, "data_path"),
    "template: attribute": (lambda root: edit_info(root, data_path="{file_index.real}"), INFO, "data_path"),
    "template: item": (lambda root: edit_info(root, data_path="{file_index[0]}"), INFO, "data_path"),
    "template: other field": (lambda root: edit_info(root, data_path="{episode_index}"), INFO, "data_path"),
    "template: huge": (lambda root: edit_info(root, data_path="{file_index:0999999999d}"), INFO, "data_path"),
    "template: nested": (lambda root: edit_info(root, data_path="{file_index:{chunk_index}}"), INFO, "data_path"),
    "template: broken": (lambda root: edit_info(root, data_path="{file_index"), INFO, "data_path"),
    "template: elsewhere": (
        lambda root: edit_info(root, data_path="data/{file_index}.parquet"),
        "data/0.parquet",
        "no such file",
    ),
    "symlink to itself": (link_to_itself, DATA, "found"),
    "symlink out": (escape_by_symlink, DATA, "leads out"),
    "no episode metadata": (lambda root: shutil.rmtree(root / "meta/episodes"), "meta/episodes", "at least one"),
    "episode metadata cut": (lambda root: truncate(root / EPISODES, 0.5), EPISODES, "cut off"),
    "episode column missing": (lambda root: drop_column(root, EPISODES, "length"), EPISODES, "length"),
    "episode column of floats": (
        lambda root: pq.write_table(
            (table := pq.read_table(root / EPISODES)).set_column(
                table.schema.get_field_index("length"), "length", pa.array([0.5] * len(table))
            ),
            root / EPISODES,
        ),
        EPISODES,
        "whole numbers",
    ),
    "episode column with gaps": (
        lambda root: edit_column(root, EPISODES, "length", set_at(2, None)),
        EPISODES,
        "no value in 1 of 6 rows",
    ),
    "episode missing": (
        lambda root: edit_column(root, EPISODES, "episode_index", set_at(2, 3)),
        "meta/episodes",
        "episode_index of episode 2: found 3, expected 2",
    ),
    "range beyond the table": (
        lambda root: edit_column(root, EPISODES, "dataset_to_index", set_at(5, 10**6)),
        "meta/episodes",
        "length of episode 5",
    ),
    "ranges overlap": (
        lambda root: edit_column(root, EPISODES, "dataset_from_index", set_at(3, 1)),
        "meta/episodes",
        "dataset_from_index of episode 3: found 1",
    ),
    "an episode without a frame": (empty_episode, "meta/episodes", "dataset_to_index of episode 2"),
    "file pointer to nowhere": (
        lambda root: edit_column(root, EPISODES, "data/file_index", set_at(5, 7)),
        "data/chunk-000/file-0",
        "",
    ),
    "file pointer back and forth": (
        lambda root: edit_column(root, EPISODES, "data/file_index", set_at(2, 1)),
        "meta/episodes",
        "data/file_index of episode 3",
    ),
    "negative file pointer": (
        lambda root: edit_column(root, EPISODES, "data/chunk_index", lambda values: [-1] * len(values)),
        "data/chunk--01",
        "no such file",
    ),
    "data missing": (lambda root: (root / DATA).unlink(), DATA, "no such file"),
    "data cut": (lambda root: truncate(root / DATA, 0.5), DATA, "cut off"),
    "data empty": (lambda root: (root / DATA).write_bytes(b""), DATA, "cut off"),
    "data with a garbled column name": (garble_a_column_name, DATA, "cut off or damaged"),
    "data is a folder": (lambda root: ((root / DATA).unlink(), (root / DATA).mkdir()), DATA, "expected"),
    "rows too many": (append_rows, DATA, "rows"),
    "data column missing": (lambda root: drop_column(root, DATA, "observation.state"), DATA, "observation.state"),
    "shape 9 for 10": (shape_9, DATA, "observation.state: found 10 in each row, expected 9"),
    "ragged rows": (ragged, DATA, "action: found 1 in row 5, expected 2"),
    "NaN": (
        lambda root: edit_column(root, DATA, "observation.state", put(np.nan, 17, 4)),
        DATA,
        "observation.state[sin_tee_yaw] in row 17: found nan",
    ),
    "infinity": (
        lambda root: edit_column(root, DATA, "action", put(-np.inf, 3, 1)),
        DATA,
        "action[pusher_vy] in row 3: found -inf",
    ),
    "gap": (
        lambda root: edit_column(root, DATA, "action", lambda rows: [None, *rows[1:]]),
        DATA,
        "action: found no value in 1 of",
    ),
}


def read_all(root: Path) -> None:
    z2r.inspect_dataset(z2r.load(root))


def fingerprint(root: Path) -> dict[Path, str]:
    return {path: hashlib.sha256(path.read_bytes()).hexdigest() for path in sorted(root.rglob("*")) if path.is_file()}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_is_named(fault, standin_copy):
    damage, file, message = FAULTS[fault]
    damage(standin_copy)
    before = fingerprint(standin_copy) if standin_copy.is_dir() else {}
    with pytest.raises(z2r.DatasetError) as caught:
        read_all(standin_copy)
    assert str(caught.value.path).startswith(str(standin_copy / file))
    assert message in str(caught.value)
    assert "\n" not in str(caught.value)
    assert (fingerprint(standin_copy) if standin_copy.is_dir() else {}) == before


def test_an_undamaged_copy_has_no_fault(standin_copy):
    read_all(standin_copy)


def test_a_name_from_a_dataset_cannot_steer_the_terminal(standin_copy):
    edit_info(standin_copy, features={"\x1b[2J\nname": {"shape": [1]}})
    with pytest.raises(z2r.DatasetError) as caught:
        read_all(standin_copy)
    assert str(caught.value).isprintable()


def test_links_of_the_hugging_face_cache_are_followed(standin_copy, tmp_path):
    repository = tmp_path / "datasets--someone--pusht"
    (repository / "blobs").mkdir(parents=True)
    snapshot = shutil.copytree(standin_copy, repository / "snapshots/0123abcd")
    for number, path in enumerate(sorted(path for path in snapshot.rglob("*") if path.is_file())):
        blob = path.rename(repository / f"blobs/{number}")
        path.symlink_to(blob)
    read_all(snapshot)


def test_a_link_within_the_dataset_is_followed(standin_copy):
    (standin_copy / DATA).rename(standin_copy / "frames.parquet")
    (standin_copy / DATA).symlink_to(standin_copy / "frames.parquet")
    read_all(standin_copy)


def test_a_linked_dataset_folder_is_followed(standin_copy, tmp_path):
    (tmp_path / "link").symlink_to(standin_copy)
    read_all(tmp_path / "link")


def test_an_unpadded_template_is_fine(standin_copy):
    (standin_copy / DATA).rename(standin_copy / "data/0-0.parquet")
    edit_info(standin_copy, data_path="data/{chunk_index}-{file_index:d}.parquet")
    read_all(standin_copy)
    assert data_file_path(standin_copy, read_schema(standin_copy), 3, 14) == standin_copy / "data/3-14.parquet"
