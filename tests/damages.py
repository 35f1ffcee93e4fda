"""Kinds of damage: what is done to a copy of a whole dataset, and what must be said of it.

`DAMAGES` is one table for both: the audit names every kind (`test_audit.py`), and the reader, which stops at the first
fault, names those without which the frames cannot be read (`test_bad_input.py`). Where values are changed, the stored
statistics are made right again (`restated`), so that the check that is named has to find the damage by itself.
"""

import hashlib
import json
import shutil
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from layouts import (
    STATS_PATH,
    Frames,
    Layout,
    data_files,
    lay_out_again,
    read_dataset,
    restate,
    rewrite,
    shard_files,
    to_arrow,
    to_numpy,
)

import z2r
from z2r.audits.findings import Finding
from z2r.pusht.task import ACTION_NAMES, STATE_NAMES
from z2r.reading.verdict import verdict_path

INFO, TASKS, EPISODES_DIR = "meta/info.json", "meta/tasks.parquet", "meta/episodes"
EPISODES, DATA = "meta/episodes/chunk-000/file-000.parquet", "data/chunk-000/file-000.parquet"
VIDEO = "videos/observation.images.top/chunk-000/file-000.mp4"
STATE = "observation.state"
NAMES = {STATE: STATE_NAMES, "action": ACTION_NAMES}
SIN_COS = ("sin_tee_yaw", "cos_tee_yaw")
TARGET_SIN_COS = ("sin_target_yaw", "cos_target_yaw")
TEE_COLUMNS = ("tee_x", "tee_y", *SIN_COS)
POSITIONS = ("pusher_x", "pusher_y", "tee_x", "tee_y", "target_x", "target_y")


@dataclass(frozen=True)
class Damage:
    """One kind of damage.

    Attributes
    ----------
    do : callable
        Takes the folder of a whole dataset.
    checks : str
        Names of checks, of which one must hit the nail.
    file : str
        How the file begins that this check must name.
    says : str
        What its finding must hold.
    base : str
        Which of `BASES` it is done to.
    reader : str or None
        What the one error of the reader must hold; None where the reader has no reason to stop.
    reader_file : str or None
        How the file begins that the reader names, where it is another one.
    harmless : bool
        Whether a note is enough.
    """

    do: Callable[[Path], object]
    checks: str
    file: str
    says: str = ""
    base: str = "standin"
    reader: str | None = None
    reader_file: str | None = None
    harmless: bool = False


READINESS = ("constant", "idle", "short-episode", "chunk", "echo")
"""Checks that note what is true of many a healthy dataset, and no fault of it."""


def wrong_in(audit: z2r.Audit) -> list[Finding]:
    """Return what is wrong with a dataset, beside what is merely good to know before training."""
    return [each for each in audit.findings if each.severity != "note" or each.check not in READINESS]


PUSH = "push the T onto the target"
FAILED, LUCKY = 2, 10  # of `messy`: an episode that is read as not reached, and the one that is, without success


def forget(root: Path, name: str) -> None:
    """Let a feature never have been there."""
    drop_column(root, DATA, name)
    edit_info(root, features={key: value for key, value in read_json(root, INFO)["features"].items() if key != name})
    restate(root)


def label(root: Path) -> None:
    """Let `messy` store itself what the simulator said of it: success and a reward in the last frame, and done.

    The one episode that is reached and no success becomes one: of that, the audit has something to say.
    """
    shutil.copytree(z2r.MESSY, root)
    said = json.loads(verdict_path(z2r.MESSY).read_text())
    success = [episode["success"] or number == LUCKY for number, episode in enumerate(said["episodes"])]

    def in_place(frames: Frames, slices: list[slice]) -> None:
        last = np.zeros(len(frames["index"]), dtype=bool)
        last[[own.stop - 1 for own in slices]] = True
        frames["next.success"] = last & np.repeat(success, [own.stop - own.start for own in slices])
        frames["next.reward"] = frames["next.success"].astype(np.float32)
        frames["next.done"] = last

    edit_frames(root, in_place, restated=False)
    for name, dtype in (("next.success", "bool"), ("next.reward", "float32"), ("next.done", "bool")):
        edit_feature(root, name, dtype=dtype, shape=[1], names=None)
    restate(root)


BASES: dict[str, Callable[[Path], object]] = {
    "standin": lambda root: shutil.copytree(z2r.STANDIN, root),
    "messy": lambda root: shutil.copytree(z2r.MESSY, root),
    "labelled": label,
    "split": lambda root: lay_out_again(z2r.MESSY, root, Layout([3, 4, 1, 4, 2], [5, 6, 3], episode_stats=True)),
    "unpadded": lambda root: lay_out_again(
        z2r.MESSY,
        root,
        Layout([1] * 14, [14], data_path="data/chunk-{chunk_index}/file-{file_index}.parquet", episode_stats=True),
    ),
}


# --- meta/info.json and meta/stats.json


def read_json(root: Path, file: str) -> Any:
    return json.loads((root / file).read_text())


def edit_info(root: Path, **changes: Any) -> None:
    """Set keys of `meta/info.json`, or drop those that are set to `...`."""
    info = read_json(root, INFO) | changes
    (root / INFO).write_text(json.dumps({key: value for key, value in info.items() if value is not ...}))


def edit_feature(root: Path, name: str, **changes: Any) -> None:
    """Set keys of one feature; `...` drops them."""
    features = read_json(root, INFO)["features"]
    feature = features.get(name, {}) | changes
    edit_info(root, features=features | {name: {key: value for key, value in feature.items() if value is not ...}})


def exchange_names(root: Path, *pairs: tuple[str, str], feature: str = STATE) -> None:
    """Exchange names of dimensions in the schema."""
    other = dict(pairs) | {second: first for first, second in pairs}
    edit_feature(root, feature, names=[other.get(name, name) for name in NAMES[feature]])


def edit_stats(root: Path, feature: str, statistic: str, change: Callable[[np.ndarray], Any]) -> None:
    """Change one statistic of one feature in `meta/stats.json`."""
    stats = read_json(root, STATS_PATH)
    stats[feature][statistic] = np.asarray(change(np.array(stats[feature][statistic]))).tolist()
    (root / STATS_PATH).write_text(json.dumps(stats))


def drop_from_stats(root: Path, feature: str, statistic: str = "") -> None:
    """Drop one statistic of a feature, or all of them."""
    stats = read_json(root, STATS_PATH)
    if statistic:
        del stats[feature][statistic]
    else:
        del stats[feature]
    (root / STATS_PATH).write_text(json.dumps(stats))


def declare_video(root: Path, name: str = "observation.images.top") -> None:
    """Give every episode a video that is not there."""
    edit_feature(root, name, dtype="video", shape=[8, 8, 3], names=["height", "width", "channels"])
    edit_info(root, video_path="videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4")
    for path in shard_files(root):
        table = pq.read_table(path)
        for key in ("chunk_index", "file_index", "from_timestamp", "to_timestamp"):
            column = pa.array([0.0 if "timestamp" in key else 0] * len(table))
            table = table.append_column(f"videos/{name}/{key}", column)
        pq.write_table(table, path)


def orphan_video(root: Path) -> None:
    path = root / VIDEO
    path.parent.mkdir(parents=True)
    path.write_bytes(b"")


# --- bytes and paths


def truncate(path: Path, share: float) -> None:
    path.write_bytes(path.read_bytes()[: int(path.stat().st_size * share)])


def flip(path: Path, place: int, mask: int = 0xFF) -> None:
    data = bytearray(path.read_bytes())
    data[place] ^= mask
    path.write_bytes(data)


def spoil_column(path: Path, column: str) -> None:
    """Overwrite the pages of one column."""
    data, group = bytearray(path.read_bytes()), pq.read_metadata(path).row_group(0)
    for chunk in (group.column(i) for i in range(group.num_columns)):
        if f"{chunk.path_in_schema}.".startswith(f"{column}."):
            start = chunk.dictionary_page_offset or chunk.data_page_offset
            data[start : start + chunk.total_compressed_size] = b"\xff" * chunk.total_compressed_size
    path.write_bytes(data)


def leave_pointer(path: Path) -> None:
    """Leave what Git LFS leaves of a file that was not fetched."""
    size, digest = path.stat().st_size, hashlib.sha256(path.read_bytes()).hexdigest()
    path.write_text(f"version https://git-lfs.github.com/spec/v1\noid sha256:{digest}\nsize {size}\n")


def put_folder(path: Path) -> None:
    path.unlink()
    path.mkdir()


def exchange(first: Path, second: Path) -> None:
    aside = first.with_suffix(".aside")
    first.rename(aside)
    second.rename(first)
    aside.rename(second)


def rename_all(paths: Sequence[Path], names: Sequence[Path]) -> None:
    """Give each file the name that stands at its place."""
    for path in paths:
        path.rename(path.with_suffix(".aside"))
    for path, name in zip(paths, names, strict=True):
        path.with_suffix(".aside").rename(name)


def footer_start(data: bytes) -> int:
    return len(data) - 8 - int.from_bytes(data[-8:-4], "little")


def claim_rows(path: Path, n_rows: int) -> None:
    """Let the footer of a file say that there are `n_rows` rows, in the one row group that it then has."""
    pq.write_table(pq.read_table(path), path)
    data = path.read_bytes()
    start = footer_start(data)
    before, after = (b"\x16" + zigzag(n) for n in (pq.read_metadata(path).num_rows, n_rows))
    footer = data[start:-8].replace(before, after)
    path.write_bytes(data[:start] + footer + len(footer).to_bytes(4, "little") + b"PAR1")


def zigzag(number: int) -> bytes:
    """Encode a number >= 0 as thrift's compact protocol does."""
    number, out = 2 * number, bytearray()
    while number >= 0x80:
        out.append(number & 0x7F | 0x80)
        number >>= 7
    return bytes([*out, number])


def escape_by_symlink(root: Path, file: str = DATA) -> None:
    outside = root.parent / f"outside-{Path(file).name}"
    (root / file).rename(outside)
    (root / file).symlink_to(outside)


def escape_by_folder(root: Path, folder: str) -> None:
    outside = root.parent / f"outside-{Path(folder).name}"
    (root / folder).rename(outside)
    (root / folder).symlink_to(outside)


def link_to_itself(root: Path, file: str = DATA) -> None:
    (root / file).unlink()
    (root / file).symlink_to(root / file)


# --- parquet columns


def edit_column(root: Path, file: str, column: str, change: Callable[[list], list], kind: Any = None) -> None:
    """Change the values of one column, and its type where one is given."""
    table = pq.read_table(root / file)
    place = table.schema.get_field_index(column)
    values = pa.array(change(table.column(column).to_pylist()), kind or table.schema.field(column).type)
    pq.write_table(table.set_column(place, column, values), root / file)


def retype(kind: pa.DataType) -> Callable[[Path, str], None]:
    return lambda root, column: edit_column(root, DATA, column, list, kind)


def drop_column(root: Path, file: str, column: str) -> None:
    pq.write_table(pq.read_table(root / file).drop_columns(column), root / file)


def rename_column(root: Path, file: str, old: str, new: str) -> None:
    table = pq.read_table(root / file)
    pq.write_table(table.rename_columns([new if name == old else name for name in table.column_names]), root / file)


def add_column(root: Path, file: str, name: str) -> None:
    table = pq.read_table(root / file)
    pq.write_table(table.append_column(name, pa.array([0.5] * len(table))), root / file)


def take_rows(root: Path, file: str, rows: Callable[[int], Sequence[int]]) -> None:
    """Keep these rows of a file, in this order; `rows` takes their number."""
    table = pq.read_table(root / file)
    pq.write_table(table.take(pa.array(rows(len(table)), pa.int64())), root / file)


def put(value: float | None, row: int, column: int) -> Callable[[list], list]:
    def change(rows: list) -> list:
        rows[row][column] = value
        return rows

    return change


def set_at(row: int, value: Any) -> Callable[[list], list]:
    return lambda values: [value if i == row % len(values) else old for i, old in enumerate(values)]


def add_at(row: int, value: int) -> Callable[[list], list]:
    return lambda values: [old + value if i == row else old for i, old in enumerate(values)]


def rename_feature(root: Path, old: str, new: str) -> None:
    """Give a feature another name, in all places."""
    features = read_json(root, INFO)["features"]
    edit_info(root, features={new if name == old else name: feature for name, feature in features.items()})
    rename_column(root, DATA, old, new)
    restate(root)


def add_feature(root: Path, name: str, value: float) -> None:
    """Add a feature of one number, the same in all frames."""
    table = pq.read_table(root / DATA)
    pq.write_table(table.append_column(name, pa.array(np.full(len(table), value, dtype=np.float32))), root / DATA)
    edit_feature(root, name, dtype="float32", shape=[1], names=None)
    restate(root)


def set_tasks(root: Path, *texts: str, of_episode: dict[int, int] | None = None, of_frame: int | None = None) -> None:
    """Let these be the tasks, the first that of every frame but those of some episodes, or of one frame."""
    import pandas as pd

    pd.DataFrame({"task_index": range(len(texts))}, index=pd.Index(texts, name="task")).to_parquet(root / TASKS)
    edit_info(root, total_tasks=len(texts))

    def in_place(frames: Frames, slices: list[slice]) -> None:
        for episode, task in (of_episode or {}).items():
            frames["task_index"][slices[episode]] = task
        if of_frame is not None:
            frames["task_index"][of_frame] = 1

    edit_frames(root, in_place)
    tasks = [texts[(of_episode or {}).get(episode, 0)] for episode in range(pq.read_metadata(root / EPISODES).num_rows)]
    edit_column(root, EPISODES, "tasks", lambda _: [[task] for task in tasks])


def garble_a_column_name(root: Path) -> None:
    data = (root / DATA).read_bytes()
    (root / DATA).write_bytes(data.replace(b"task_index", b"t\xffsk_index"))


# --- the episode index


def edit_episodes(root: Path, change: Callable[[Frames], None]) -> None:
    """Change whole-number columns of the episode metadata, of all shards at once."""
    paths = shard_files(root)
    tables = [pq.read_table(path) for path in paths]
    whole = pa.concat_tables(tables)
    columns = {
        field.name: whole.column(field.name).to_numpy().copy()
        for field in whole.schema
        if pa.types.is_integer(field.type)
    }
    change(columns)
    first = 0
    for path, table in zip(paths, tables, strict=True):
        for name, values in columns.items():
            place = table.schema.get_field_index(name)
            table = table.set_column(place, name, pa.array(values[first : first + len(table)]))
        pq.write_table(table, path)
        first += len(table)


def move_boundaries(columns: Frames, episodes: Any, by: int) -> None:
    """Let these episodes begin later, and those before them end later."""
    start, stop = columns["dataset_from_index"], columns["dataset_to_index"]
    start[episodes] += by
    stop[:-1] = start[1:]
    columns["length"][:] = stop - start


def renumber_ranges(columns: Frames) -> None:
    """Let all ranges follow from the lengths."""
    columns["dataset_to_index"][:] = np.cumsum(columns["length"])
    columns["dataset_from_index"][:] = columns["dataset_to_index"] - columns["length"]


def count_in_files(columns: Frames) -> None:
    """Count the frames of the ranges in each file afresh."""
    start = columns["dataset_from_index"]
    for file in np.unique(columns["data/file_index"]):
        own = columns["data/file_index"] == file
        first = start[own][0]
        columns["dataset_from_index"][own] -= first
        columns["dataset_to_index"][own] -= first


def scramble(columns: Frames) -> None:
    order = np.random.default_rng(0).permutation(len(columns["length"]))
    columns["dataset_from_index"][:] = columns["dataset_from_index"][order]


def shift_from(columns: Frames) -> None:
    columns["dataset_from_index"][1:] += 1


def shift_ranges(columns: Frames) -> None:
    columns["dataset_from_index"][1:] += 1
    columns["dataset_to_index"][1:] += 1


def empty_episode(columns: Frames) -> None:
    """Give the frames of episode 2 to episode 3; all sums still agree."""
    start, stop = columns["dataset_from_index"], columns["dataset_to_index"]
    stop[2] = start[3] = start[2]
    columns["length"][:] = stop - start


def repoint(episode: int, file: int) -> Callable[[Frames], None]:
    def change(columns: Frames) -> None:
        columns["data/file_index"][episode] = file

    return change


def set_field(column: str, episode: int, value: int) -> Callable[[Path], None]:
    def change(columns: Frames) -> None:
        columns[column][episode] = value

    return lambda root: edit_episodes(root, change)


def point_at_the_file_before(columns: Frames) -> None:
    """Let the first episode of every file but the first be in the file before."""
    file = columns["data/file_index"]
    file[1:][file[1:] != file[:-1]] -= 1


def lose_last_episodes(root: Path, total: bool = True) -> None:
    """Forget the last two episodes of the metadata; the frames are there."""
    take_rows(root, EPISODES, lambda n: range(n - 2))
    left = pq.read_table(root / EPISODES)
    n_frames = left.column("dataset_to_index")[-1].as_py()
    if total:
        edit_info(root, total_episodes=len(left), total_frames=n_frames, splits={"train": f"0:{len(left)}"})


def crash(root: Path) -> None:
    """Cut a recording off: the last file has no footer, and the last shard was never written."""
    last = data_files(root)[-1]
    data = last.read_bytes()
    last.write_bytes(data[: footer_start(data)])
    shard_files(root)[-1].unlink()


def crash_before_the_metadata(root: Path) -> None:
    """Cut a recording off when the frames were written, and the totals and the last shard were not."""
    lost = pq.read_table(shard_files(root)[-1])
    shard_files(root)[-1].unlink()
    first, n_frames = lost.column("episode_index")[0].as_py(), lost.column("dataset_from_index")[0].as_py()
    edit_info(root, total_episodes=first, total_frames=n_frames, splits={"train": f"0:{first}"})


# --- frames


def edit_frames(
    root: Path, change: Callable[[Frames, list[slice]], object], *, restated: bool = True, exact: bool = True
) -> None:
    """Change frames in place; `change` takes all columns of all files, and where the episodes are."""
    paths = data_files(root)
    tables = [pq.read_table(path) for path in paths]
    whole = pa.concat_tables(tables)
    frames = {name: to_numpy(whole.column(name)).copy() for name in whole.column_names}
    stops = np.cumsum(np.bincount(frames["episode_index"]))
    change(frames, [slice(start, stop) for start, stop in zip(np.r_[0, stops[:-1]], stops, strict=True)])
    first = 0
    for path, table in zip(paths, tables, strict=True):
        own = slice(first, first + len(table))
        pq.write_table(pa.table({name: to_arrow(values[own]) for name, values in frames.items()}), path)
        first = own.stop
    if restated:
        restate(root)


def column(frames: Frames, name: str) -> np.ndarray:
    """Return one named dimension of the state or the action, to be changed in place."""
    feature = STATE if name in STATE_NAMES else "action"
    return frames[feature][:, NAMES[feature].index(name)]


def change_values(
    names: Sequence[str],
    change: Callable[[np.ndarray], Any],
    episodes: Sequence[int] | None = None,
    *,
    restated: bool = True,
) -> Callable[[Path], None]:
    """Change named dimensions, in all episodes or in some."""

    def in_place(frames: Frames, slices: list[slice]) -> None:
        for own in slices if episodes is None else [slices[episode] for episode in episodes]:
            for name in names:
                column(frames, name)[own] = change(column(frames, name)[own])

    return lambda root: edit_frames(root, in_place, restated=restated)


def turn(pose: str, change: Callable[[np.ndarray], np.ndarray]) -> Callable[[Path], None]:
    """Change the yaw of the block or of the target; (sin, cos) stay on the unit circle."""

    def in_place(frames: Frames, _: list[slice]) -> None:
        sine, cosine = column(frames, f"sin_{pose}_yaw"), column(frames, f"cos_{pose}_yaw")
        yaw = change(np.arctan2(sine, cosine))
        sine[:], cosine[:] = np.sin(yaw), np.cos(yaw)

    return lambda root: edit_frames(root, in_place)


def each_episode(
    change: Callable[[np.ndarray], np.ndarray], feature: str, only: int | None = None
) -> Callable[[Path], None]:
    """Change one feature, episode by episode."""

    def in_place(frames: Frames, slices: list[slice]) -> None:
        for own in slices if only is None else [slices[only]]:
            frames[feature][own] = change(frames[feature][own])

    return lambda root: edit_frames(root, in_place)


def lag(by: int) -> Callable[[np.ndarray], np.ndarray]:
    """Shift rows; the first or the last stands in for what is missing."""
    return lambda rows: rows[np.clip(np.arange(len(rows)) - by, 0, len(rows) - 1)]


def glitch(name: str, row: int, value: float) -> Callable[[Path], None]:
    def in_place(frames: Frames, _: list[slice]) -> None:
        column(frames, name)[row] += value

    return lambda root: edit_frames(root, in_place)


def edit_bookkeeping(
    name: str, change: Callable[[np.ndarray], Any], *, restated: bool = True
) -> Callable[[Path], None]:
    """Change one bookkeeping column of all frames."""

    def in_place(frames: Frames, _: list[slice]) -> None:
        frames[name] = np.asarray(change(frames[name])).astype(frames[name].dtype)

    def do(root: Path) -> None:
        edit_frames(root, in_place, restated=False)
        if restated and name != "episode_index":
            restate(root)

    return do


def from_row(row: int, by: float) -> Callable[[np.ndarray], np.ndarray]:
    return lambda values: values + by * (np.arange(len(values)) >= row)


def at_row(row: int, by: float) -> Callable[[np.ndarray], np.ndarray]:
    return lambda values: values + by * (np.arange(len(values)) == row)


def relabel(name: str, change: Callable[[np.ndarray], Any], *episodes: int) -> Callable[[Path], None]:
    """Change one label, in all episodes or in some."""

    def in_place(frames: Frames, slices: list[slice]) -> None:
        for own in [slices[episode] for episode in episodes] or slices:
            frames[name][own] = change(frames[name][own])

    return lambda root: edit_frames(root, in_place)


def only_success(change: Callable[[np.ndarray], Any], *episodes: int, names: bool = True) -> Callable[[Path], None]:
    """Change the success, where there is no reward to contradict it, and without names no reading either."""

    def do(root: Path) -> None:
        relabel("next.success", change, *episodes)(root)
        forget(root, "next.reward")
        if not names:
            edit_feature(root, STATE, names=None)

    return do


def true_from(row: int, to: int | None = None) -> Callable[[np.ndarray], np.ndarray]:
    """Say yes in these frames of an episode, and no in the others."""

    def change(values: np.ndarray) -> np.ndarray:
        rows = np.arange(len(values))
        return (rows >= row % len(values)) & (rows < (len(values) if to is None else to))

    return change


def zero_row(frames: Frames, _: list[slice]) -> None:
    frames[STATE][100] = 0


def positions_for_velocities(frames: Frames, _: list[slice]) -> None:
    frames["action"][:] = frames[STATE][:, :2]


def other_actions(frames: Frames, _: list[slice]) -> None:
    frames["action"][:] = np.roll(frames["action"], len(frames["action"]) // 2, axis=0)


def yaw_in_degrees(frames: Frames, _: list[slice]) -> None:
    sine, cosine = (column(frames, name) for name in SIN_COS)
    sine[:], cosine[:] = np.degrees(np.arctan2(sine, cosine)), 0


def shuffle(frames: Frames, slices: list[slice]) -> None:
    order = np.random.default_rng(0).permutation(frames[STATE][slices[2]])
    frames[STATE][slices[2]] = order


# --- whole episodes, written again with everything else right

type Episodes = list[Frames]


def reorder(change: Callable[[Episodes], Episodes]) -> Callable[[Path], None]:
    """Write other episodes in place of those that are there."""

    def do(root: Path) -> None:
        frames, lengths = read_dataset(root)
        stops = np.cumsum(lengths)[:-1]
        parts = {name: np.split(frames[name], stops) for name in (STATE, "action")}
        rewrite(root, change([dict(zip(parts, rows, strict=True)) for rows in zip(*parts.values(), strict=True)]))

    return do


def rows_of(episode: Frames, rows: Any) -> Frames:
    return {name: values[rows] for name, values in episode.items()}


def joined(*episodes: Frames) -> Frames:
    return {name: np.concatenate([episode[name] for episode in episodes]) for name in episodes[0]}


def in_each(rows: Callable[[int], Any]) -> Callable[[Path], None]:
    """Keep these rows of every episode, in this order; `rows` takes its length."""
    return reorder(lambda episodes: [rows_of(episode, rows(len(episode["action"]))) for episode in episodes])


def in_one(number: int, rows: Callable[[int], Any]) -> Callable[[Path], None]:
    """Keep these rows of one episode, in this order."""
    return reorder(
        lambda episodes: [
            rows_of(episode, rows(len(episode["action"]))) if i == number else episode
            for i, episode in enumerate(episodes)
        ]
    )


def wait_in(number: int, before: int = 0, after: int = 0) -> Callable[[Path], None]:
    """Let the robot of one episode stand still for so many frames, which nobody asks to move."""

    def waiting(episode: Frames) -> Frames:
        first, last = (rows_of(episode, [row] * n) for row, n in ((0, before), (-1, after)))
        for rest in (first, last):
            rest["action"][:] = 0
        return joined(first, episode, last)

    return reorder(lambda episodes: [waiting(each) if i == number else each for i, each in enumerate(episodes)])


def move_all_boundaries(episodes: Episodes, by: int = 1) -> Episodes:
    """Give the first frames of every episode but the first to the episode before."""
    nexts = [*episodes[1:], None]
    return [
        joined(rows_of(episode, slice(by * bool(i), None)), *([rows_of(after, slice(by))] if after else []))
        for i, (episode, after) in enumerate(zip(episodes, nexts, strict=True))
    ]


def exchange_episodes_in_data(root: Path) -> None:
    """Exchange the frames of episodes 1 and 2 as a whole, bookkeeping too; the metadata stays."""

    def in_place(frames: Frames, slices: list[slice]) -> None:
        order = np.r_[slices[0], slices[2], slices[1], slices[2].stop : len(frames["index"])]
        for name in frames:
            frames[name] = frames[name][order]

    edit_frames(root, in_place, restated=False)


def stop_too_early(root: Path) -> None:
    """Cut the last 25 frames off every episode, and keep what the simulator said of the whole ones."""
    in_each(lambda n: np.arange(n - 25))(root)
    shutil.copy(verdict_path(z2r.STANDIN), verdict_path(root))


def verdict_of_another(root: Path) -> None:
    shutil.copy(verdict_path(z2r.MESSY), verdict_path(root))


def verdict_too_good(root: Path) -> None:
    """Let the simulator have seen a success in every episode of `messy`, where some timed out."""
    said = json.loads(verdict_path(z2r.MESSY).read_text())
    for episode in said["episodes"]:
        episode["success"] = True
    verdict_path(root).write_text(json.dumps(said))


LAST = "data/chunk-000/file-004.parquet"

ON_INFO: dict[str, Damage] = {
    "no folder": Damage(shutil.rmtree, "info", ".", "no such folder", reader="no such folder"),
    "no dataset": Damage(lambda root: shutil.rmtree(root / "meta"), "info", INFO, reader="no such file"),
    "a file for a folder": Damage(
        lambda root: (shutil.rmtree(root), root.write_text("")), "info", "", "no such folder", reader="no such folder"
    ),
    "info missing": Damage(lambda root: (root / INFO).unlink(), "info", INFO, "no such file", reader="no such file"),
    "info is a folder": Damage(lambda root: put_folder(root / INFO), "info", INFO, reader="directory"),
    "info empty": Damage(lambda root: (root / INFO).write_text(""), "info", INFO, "JSON", reader="broken JSON"),
    "info cut short": Damage(lambda root: truncate(root / INFO, 0.5), "info", INFO, "JSON", reader="broken JSON"),
    "info cut by one byte": Damage(lambda root: truncate(root / INFO, 0.999), "info", INFO, "JSON", reader="JSON"),
    "info deep": Damage(lambda root: (root / INFO).write_text("[" * 10**6), "info", INFO, reader="expected"),
    "info of another kind": Damage(lambda root: (root / INFO).write_text("[1]"), "info", INFO, reader="object"),
    "info no text": Damage(
        lambda root: (root / INFO).write_bytes(b"\xff\xfe\x00"), "info", INFO, "JSON", reader="broken JSON"
    ),
    "version 2.1 on v3 files": Damage(
        lambda root: edit_info(root, codebase_version="v2.1"),
        "version",
        INFO,
        "v2.1",
        reader="--push-to-hub=false",
    ),
    "version 2.0": Damage(
        lambda root: edit_info(root, codebase_version="v2.0"), "version", INFO, "on the hub", reader="from v2.1 only"
    ),
    "info a pointer of Git LFS": Damage(
        lambda root: leave_pointer(root / INFO), "info", INFO, "git lfs pull", reader="git lfs pull"
    ),
    "a shard a pointer of Git LFS": Damage(
        lambda root: leave_pointer(root / EPISODES), "episodes-file", EPISODES, "git lfs pull", reader="git lfs pull"
    ),
    "tasks a pointer of Git LFS": Damage(lambda root: leave_pointer(root / TASKS), "tasks-file", TASKS, "git lfs pull"),
    "statistics a pointer of Git LFS": Damage(
        lambda root: leave_pointer(root / STATS_PATH), "stats-file", STATS_PATH, "git lfs pull"
    ),
    "a video a pointer of Git LFS": Damage(
        lambda root: (declare_video(root), orphan_video(root), leave_pointer(root / VIDEO)),
        "video-file",
        VIDEO,
        "git lfs pull",
    ),
    "videos in a folder of another name": Damage(
        lambda root: (declare_video(root), orphan_video(root), (root / "videos").rename(root / "video")),
        "video-file",
        VIDEO,
        "rename that to videos",
    ),
    "version 4": Damage(
        lambda root: edit_info(root, codebase_version="v4.0"), "version", INFO, "v4.0", reader="'v4.0'"
    ),
    "no version": Damage(
        lambda root: edit_info(root, codebase_version=...), "version", INFO, "codebase_version", reader="version"
    ),
    "no fps": Damage(lambda root: edit_info(root, fps=...), "info", INFO, "fps", reader="fps"),
    "fps of 0": Damage(lambda root: edit_info(root, fps=0), "info", INFO, "fps: found 0", reader="fps: found 0"),
    "fps of 400 digits": Damage(lambda root: edit_info(root, fps=10**400), "info", INFO, "fps", reader="fps"),
    "fps of almost nothing": Damage(lambda root: edit_info(root, fps=1e-300), "info", INFO, "fps", reader="fps"),
    "fps beyond everything": Damage(lambda root: edit_info(root, fps=1e308), "info", INFO, "fps", reader="fps"),
    "fps in words": Damage(lambda root: edit_info(root, fps="ten"), "info", INFO, "ten", reader='fps: found "ten"'),
    "no features": Damage(lambda root: edit_info(root, features=...), "info", INFO, "features", reader="features"),
    "a feature without a dtype": Damage(
        lambda root: edit_feature(root, STATE, dtype=...),
        "info",
        INFO,
        "features.observation.state.dtype",
        reader="features.observation.state.dtype",
    ),
    "a shape in words": Damage(
        lambda root: edit_feature(root, STATE, shape="ten"), "info", INFO, "shape", reader="shape"
    ),
    "a state a million wide": Damage(
        lambda root: edit_feature(root, STATE, shape=[10**6], names=None), "column-type", DATA, STATE
    ),
    "a negative shape": Damage(
        lambda root: edit_feature(root, STATE, shape=[-10]), "info", INFO, "shape", reader="shape"
    ),
    "a dtype of another world": Damage(
        lambda root: edit_feature(root, STATE, dtype="float33"), "info", INFO, "float33"
    ),
    "a dtype that numpy chokes on": Damage(
        lambda root: edit_feature(root, "index", dtype="0:6"), "info", INFO, "features.index.dtype"
    ),
    "a name twice": Damage(
        lambda root: edit_feature(root, STATE, names=["pusher_x", "pusher_x", *STATE_NAMES[2:]]),
        "info",
        INFO,
        "pusher_x",
    ),
    "a name that is no text": Damage(
        lambda root: edit_feature(root, STATE, names=["pusher_x", 7, *STATE_NAMES[2:]]), "info", INFO, "names"
    ),
    "a name misspelt": Damage(
        lambda root: edit_feature(root, STATE, names=["pusher_X", *STATE_NAMES[1:]]), "info", INFO, "pusher_x"
    ),
    "a name too few": Damage(
        lambda root: edit_feature(root, STATE, names=list(STATE_NAMES[:9])), "info", INFO, "names"
    ),
    "total_episodes one too many": Damage(
        lambda root: edit_info(root, total_episodes=7),
        "totals",
        INFO,
        "total_episodes: found 7",
        reader="total_episodes: found 7, expected 6",
    ),
    "total_frames off by 17": Damage(
        lambda root: edit_info(root, total_frames=427 + 17), "totals", INFO, "total_frames", reader="total_frames"
    ),
    "total_frames of a billion": Damage(
        lambda root: edit_info(root, total_frames=10**9), "totals", INFO, "total_frames", reader="found 1000000000"
    ),
    "total_frames of 4000 digits": Damage(
        lambda root: edit_info(root, total_frames=10**3999), "totals", INFO, "total_frames", reader="total_frames"
    ),
    "total_tasks of 4000 digits": Damage(
        lambda root: edit_info(root, total_tasks=10**3999), "totals", INFO, "total_tasks"
    ),
    "total_tasks off by one": Damage(lambda root: edit_info(root, total_tasks=2), "totals", INFO, "total_tasks"),
    "splits beyond the end": Damage(lambda root: edit_info(root, splits={"train": "0:9"}), "splits", INFO, "0:9"),
    "splits before the end": Damage(lambda root: edit_info(root, splits={"train": "-1:6"}), "splits", INFO, "-1:6"),
    "splits in words": Damage(lambda root: edit_info(root, splits={"train": "all"}), "splits", INFO, "all"),
    "splits backwards": Damage(lambda root: edit_info(root, splits={"train": "6:0"}), "splits", INFO, "6:0"),
    "splits of 5000 digits": Damage(
        lambda root: edit_info(root, splits={"train": f"0:{'9' * 5000}"}), "splits", INFO, "splits"
    ),
    "an episode in two splits": Damage(
        lambda root: edit_info(root, splits={"train": "0:4", "test": "3:6"}), "splits", INFO, "episode 3 in several"
    ),
    "episodes in no split": Damage(
        lambda root: edit_info(root, splits={"train": "0:4"}), "splits", INFO, "episodes 4, 5 in none", harmless=True
    ),
    "splits of another kind": Damage(lambda root: edit_info(root, splits=[0, 6]), "info", INFO, "splits"),
    "template leads up": Damage(
        lambda root: edit_info(root, data_path="../{chunk_index}/{file_index}"),
        "info",
        INFO,
        "data_path",
        reader="data_path",
    ),
    "template absolute": Damage(
        lambda root: edit_info(root, data_path="/etc/{file_index}"), "info", INFO, "data_path", reader="data_path"
    ),
    "template with an attribute": Damage(
        lambda root: edit_info(root, data_path="{file_index.real}"), "info", INFO, "data_path", reader="data_path"
    ),
    "template with an item": Damage(
        lambda root: edit_info(root, data_path="{file_index[0]}"), "info", INFO, "data_path", reader="data_path"
    ),
    "template with another field": Damage(
        lambda root: edit_info(root, data_path="{episode_index}"), "info", INFO, "data_path", reader="data_path"
    ),
    "template huge": Damage(
        lambda root: edit_info(root, data_path="{file_index:0999999999d}"),
        "info",
        INFO,
        "data_path",
        reader="data_path",
    ),
    "template nested": Damage(
        lambda root: edit_info(root, data_path="{file_index:{chunk_index}}"),
        "info",
        INFO,
        "data_path",
        reader="data_path",
    ),
    "template broken": Damage(
        lambda root: edit_info(root, data_path="{file_index"), "info", INFO, "data_path", reader="data_path"
    ),
    "template elsewhere": Damage(
        lambda root: edit_info(root, data_path="data/{file_index}.parquet"),
        "data-file",
        "data/0.parquet",
        reader="no such",
    ),
    "shape 9 against data 10": Damage(
        lambda root: edit_feature(root, STATE, shape=[9]),
        "column-type",
        DATA,
        STATE,
        reader="observation.state: found 10 in each row, expected 9",
        reader_file=DATA,
    ),
    "dtype float64 against float32": Damage(
        lambda root: edit_feature(root, "action", dtype="float64"), "column-type", DATA, "action", harmless=True
    ),
    "a feature without a column": Damage(
        lambda root: edit_feature(root, "observation.gripper", dtype="float32", shape=[1]),
        "columns",
        DATA,
        "observation.gripper",
        reader="observation.gripper",
        reader_file=DATA,
    ),
    "fps 30 on 10 Hz data": Damage(lambda root: edit_info(root, fps=30), "timestamp", DATA, "timestamp"),
    "video missing": Damage(declare_video, "video-file", "videos/observation.images.top"),
}

ON_META: dict[str, Damage] = {
    "no episode metadata": Damage(
        lambda root: shutil.rmtree(root / EPISODES_DIR), "episodes-file", EPISODES_DIR, reader="at least one"
    ),
    "episode metadata cut in half": Damage(
        lambda root: truncate(root / EPISODES, 0.5), "episodes-file", EPISODES, reader="cut off"
    ),
    "episode metadata of no byte": Damage(
        lambda root: (root / EPISODES).write_bytes(b""), "episodes-file", EPISODES, reader="cut off"
    ),
    "episode metadata is a folder": Damage(
        lambda root: put_folder(root / EPISODES), "episodes-file", EPISODES_DIR, reader="expected"
    ),
    "episode metadata links out": Damage(
        lambda root: escape_by_symlink(root, EPISODES), "episodes-file", EPISODES, reader="leads out"
    ),
    "episode metadata links to itself": Damage(
        lambda root: link_to_itself(root, EPISODES), "episodes-file", EPISODES, reader="found"
    ),
    "episode metadata without a row": Damage(
        lambda root: take_rows(root, EPISODES, lambda n: []),
        "episodes-file",
        EPISODES_DIR,
        reader="",
        reader_file="meta",
    ),
    "episode metadata claims rows": Damage(
        lambda root: claim_rows(root / EPISODES, 10**6), "episodes-file", EPISODES, reader="", reader_file="meta"
    ),
    "a column of episode metadata spoilt": Damage(
        lambda root: spoil_column(root / EPISODES, "length"), "episodes-file", EPISODES, reader=""
    ),
    "quantiles of the episode metadata spoilt": Damage(
        lambda root: spoil_column(root / EPISODES, "stats/action/q50"), "episodes-file", EPISODES
    ),
    "first shard missing": Damage(
        lambda root: shard_files(root)[0].unlink(),
        "episodes-file",
        EPISODES_DIR,
        base="split",
        reader="",
        reader_file="meta",
    ),
    "middle shard missing": Damage(
        lambda root: shard_files(root)[1].unlink(),
        "episodes-file",
        EPISODES_DIR,
        base="split",
        reader="",
        reader_file="meta",
    ),
    "last shard missing": Damage(
        lambda root: shard_files(root)[2].unlink(), "totals", INFO, "total_", base="split", reader="total_episodes"
    ),
    "middle shard cut": Damage(
        lambda root: truncate(shard_files(root)[1], 0.7),
        "episodes-file",
        "meta/episodes/chunk-000/file-001",
        base="split",
        reader="cut off",
    ),
    "a shard without a row": Damage(
        lambda root: take_rows(root, EPISODES, lambda n: []),
        "episode-order",
        EPISODES_DIR,
        base="split",
        reader="in row 0",
    ),
    "a shard number skipped": Damage(
        lambda root: (path := shard_files(root)[2]).rename(path.with_name("file-005.parquet")),
        "episodes-file",
        EPISODES_DIR,
        base="split",
    ),
    "shards exchanged": Damage(
        lambda root: exchange(*shard_files(root)[:2]), "episode-order", EPISODES_DIR, base="split", reader="in row 0"
    ),
    "a shard twice": Damage(
        lambda root: shutil.copy(shard_files(root)[2], shard_files(root)[2].with_name("file-003.parquet")),
        "episode-order",
        EPISODES_DIR,
        base="split",
        reader="episode_index",
    ),
    "an episode column missing": Damage(
        lambda root: drop_column(root, EPISODES, "length"), "episodes-file", EPISODES, "length", reader="length"
    ),
    "tasks of episodes missing": Damage(
        lambda root: drop_column(root, EPISODES, "tasks"), "episodes-file", EPISODES, "tasks"
    ),
    "an episode column renamed": Damage(
        lambda root: rename_column(root, EPISODES, "dataset_from_index", "from_index"),
        "episodes-file",
        EPISODES,
        "dataset_from_index",
        reader="dataset_from_index",
    ),
    "an episode column of floats": Damage(
        lambda root: edit_column(root, EPISODES, "length", list, pa.float64()),
        "episodes-file",
        EPISODES,
        "length",
        reader="whole numbers",
    ),
    "an episode column with gaps": Damage(
        lambda root: edit_column(root, EPISODES, "length", set_at(2, None)),
        "episodes-file",
        EPISODES,
        "length",
        reader="no value in 1 of 6 rows",
    ),
    "an episode row dropped": Damage(
        lambda root: take_rows(root, EPISODES, lambda n: [0, 1, 3, 4, 5]),
        "episode-order",
        EPISODES_DIR,
        reader="episode_index in row 2: found 3",
    ),
    "the first episode row dropped": Damage(
        lambda root: take_rows(root, EPISODES, lambda n: range(1, n)), "episode-order", EPISODES_DIR, reader="in row 0"
    ),
    "an episode row twice": Damage(
        lambda root: take_rows(root, EPISODES, lambda n: [0, 1, 2, 2, 3, 4, 5]),
        "episode-order",
        EPISODES_DIR,
        reader="episode_index in row 3: found 2",
    ),
    "episode rows exchanged": Damage(
        lambda root: take_rows(root, EPISODES, lambda n: [0, 2, 1, 3, 4, 5]),
        "episode-order",
        EPISODES_DIR,
        reader="episode_index in row 1: found 2",
    ),
    "an episode renumbered": Damage(
        set_field("episode_index", 2, 3), "episode-order", EPISODES_DIR, reader="found 3, expected 2"
    ),
    "tasks missing": Damage(lambda root: (root / TASKS).unlink(), "tasks-file", TASKS, "no such file"),
    "tasks cut": Damage(lambda root: truncate(root / TASKS, 0.6), "tasks-file", TASKS),
    "tasks of no byte": Damage(lambda root: (root / TASKS).write_bytes(b""), "tasks-file", TASKS),
    "tasks are a folder": Damage(lambda root: put_folder(root / TASKS), "tasks-file", TASKS),
    "tasks link out": Damage(lambda root: escape_by_symlink(root, TASKS), "tasks-file", TASKS),
    "tasks without their column": Damage(
        lambda root: drop_column(root, TASKS, "task_index"), "tasks-file", TASKS, "task_index"
    ),
    "tasks without a text": Damage(lambda root: drop_column(root, TASKS, "task"), "tasks-file", TASKS, "task"),
    "a task without a text": Damage(
        lambda root: edit_column(root, TASKS, "task", lambda _: [None]), "tasks-file", TASKS, "task"
    ),
    "tasks from 1": Damage(
        lambda root: edit_column(root, TASKS, "task_index", lambda _: [1]), "tasks-file", TASKS, "task_index"
    ),
    "stats missing": Damage(lambda root: (root / STATS_PATH).unlink(), "stats-file", STATS_PATH),
    "stats cut": Damage(lambda root: truncate(root / STATS_PATH, 0.5), "stats-file", STATS_PATH),
    "stats of another kind": Damage(lambda root: (root / STATS_PATH).write_text("[1]"), "stats-file", STATS_PATH),
    "stats deep": Damage(lambda root: (root / STATS_PATH).write_text('{"a":' * 10**6), "stats-file", STATS_PATH),
    "stats are a folder": Damage(lambda root: put_folder(root / STATS_PATH), "stats-file", STATS_PATH),
    "stats in words": Damage(
        lambda root: edit_stats(root, "action", "mean", lambda _: "a"), "stats", STATS_PATH, "action"
    ),
    "stats of 400 digits": Damage(
        lambda root: edit_stats(root, "action", "mean", lambda _: np.array([10**400, 0], dtype=object)),
        "stats",
        STATS_PATH,
        "action",
    ),
    "stats of another width": Damage(
        lambda root: edit_stats(root, "action", "mean", lambda v: v[:1]), "stats", STATS_PATH, "action"
    ),
    "stats of another dataset": Damage(
        lambda root: shutil.copy(z2r.MESSY / STATS_PATH, root / STATS_PATH), "stats", STATS_PATH
    ),
    "stats quantiles halved": Damage(
        lambda root: edit_stats(root, "action", "q99", lambda v: v / 2), "stats", STATS_PATH, "action.q99"
    ),
    "stats quantiles of another unit": Damage(
        lambda root: edit_stats(root, STATE, "q01", lambda v: np.degrees(v)), "stats", STATS_PATH, f"{STATE}.q01"
    ),
    "stats without a feature": Damage(lambda root: drop_from_stats(root, "action"), "stats", STATS_PATH, "action"),
    "stats without a statistic": Damage(
        lambda root: drop_from_stats(root, "action", "max"), "stats", STATS_PATH, "action.max"
    ),
    "stored mean shifted": Damage(
        lambda root: edit_stats(root, STATE, "mean", lambda v: v + 0.05), "stats", STATS_PATH, "mean"
    ),
    "stored mean of one dimension shifted": Damage(
        lambda root: edit_stats(root, STATE, "mean", lambda v: v + 0.01 * (np.arange(10) == 3)),
        "stats",
        STATS_PATH,
        "tee_y",
    ),
    "stored std halved": Damage(
        lambda root: edit_stats(root, "action", "std", lambda v: v / 2), "stats", STATS_PATH, "std"
    ),
    "stored max too small": Damage(
        lambda root: edit_stats(root, "action", "max", lambda v: v - 0.1), "stats", STATS_PATH, "max"
    ),
    "stored min too small": Damage(
        lambda root: edit_stats(root, "action", "min", lambda v: v - 0.1), "stats", STATS_PATH, "min"
    ),
    "stored count off": Damage(
        lambda root: edit_stats(root, "action", "count", lambda v: v + 17), "stats", STATS_PATH, "count", harmless=True
    ),
    "stored std of NaN": Damage(
        lambda root: edit_stats(root, "action", "std", lambda v: v * np.nan), "stats-file", STATS_PATH
    ),
    "an episode's stored mean shifted": Damage(
        lambda root: edit_column(root, EPISODES, "stats/action/mean", put(0.5, 2, 0)),
        "stats",
        EPISODES_DIR,
        "action",
        harmless=True,
    ),
    "an episode's statistics of another width": Damage(
        lambda root: edit_column(root, EPISODES, "stats/action/mean", lambda rows: [row[:1] for row in rows]),
        "stats",
        EPISODES,
        "action",
    ),
    "stored statistics of two episodes exchanged": Damage(
        lambda root: [
            edit_column(root, EPISODES, f"stats/{STATE}/{what}", lambda rows: [rows[i] for i in (0, 2, 1, 3, 4, 5)])
            for what in ("min", "max", "mean", "std", "count")
        ],
        "stats",
        EPISODES_DIR,
        STATE,
        harmless=True,
    ),
}

ON_TASKS: dict[str, Damage] = {
    "the same task twice": Damage(
        lambda root: set_tasks(root, PUSH, PUSH, of_episode={3: 1}), "task-text", TASKS, "task 1: found"
    ),
    "the same task in other letters": Damage(
        lambda root: set_tasks(root, PUSH, f" {PUSH.upper()}", of_episode={3: 1}),
        "task-text",
        TASKS,
        "task 1: found",
        harmless=True,
    ),
    "a task that says nothing": Damage(lambda root: set_tasks(root, " \t"), "task-text", TASKS, r"' \t'"),
    "a task that nobody does": Damage(
        lambda root: set_tasks(root, PUSH, "pull it"), "task-unused", TASKS, "pull it", harmless=True
    ),
    "tasks out of order": Damage(
        lambda root: (
            set_tasks(root, PUSH, "pull it", of_episode={3: 1}),
            take_rows(root, TASKS, lambda n: [1, 0]),
        ),
        "tasks-file",
        TASKS,
        "1, 0",
    ),
    "an episode of another task than its frames": Damage(
        lambda root: (
            set_tasks(root, PUSH, "pull it"),
            edit_column(root, EPISODES, "tasks", set_at(3, ["pull it"])),
        ),
        "episode-tasks",
        EPISODES_DIR,
        "episode 3",
    ),
    "an episode of no task": Damage(
        lambda root: edit_column(root, EPISODES, "tasks", set_at(3, [])), "episode-tasks", EPISODES_DIR, "no task"
    ),
    "tasks of episodes by their numbers": Damage(
        lambda root: edit_column(root, EPISODES, "tasks", lambda rows: [0] * len(rows), pa.int64()),
        "episode-tasks",
        EPISODES,
        "tasks",
    ),
    "a task that changes inside an episode": Damage(
        lambda root: set_tasks(root, PUSH, "pull it", of_frame=120), "episode-tasks", EPISODES_DIR, "episode 1"
    ),
    "subtasks": Damage(
        lambda root: (
            set_tasks(root, PUSH, "pull it", of_frame=120),
            edit_column(root, EPISODES, "tasks", set_at(1, ["pull it", PUSH])),
        ),
        "episode-tasks",
        "data",
        "episode 1",
        harmless=True,
    ),
}

ON_READINESS: dict[str, Damage] = {
    "an action of another name": Damage(
        lambda root: rename_feature(root, "action", "actions"), "policy-features", INFO, "actions"
    ),
    "a state of another name": Damage(
        lambda root: rename_feature(root, STATE, "state"), "policy-features", INFO, "state, action"
    ),
    "a sensor that says the same in every frame": Damage(
        lambda root: add_feature(root, "observation.light", 0.5),
        "constant",
        "data",
        "remove_feature",
        harmless=True,
    ),
    "a robot that waits before it begins": Damage(
        wait_in(3, before=40), "idle", "data", "1 episode beginning with a standstill", base="messy", harmless=True
    ),
    "a robot that waits at the end": Damage(
        wait_in(3, after=60), "idle", "data", "1 episode ending with a standstill", base="messy", harmless=True
    ),
    "an episode stopped as it began": Damage(
        in_one(3, lambda n: range(3)), "short-episode", "data", "[3]", base="messy", harmless=True
    ),
    "an episode shorter than a chunk": Damage(
        in_one(3, lambda n: range(40)), "chunk", "data", "5 shorter than 50", base="messy", harmless=True
    ),
}

ON_INDEX: dict[str, Damage] = {
    "ranges overlap": Damage(
        set_field("dataset_from_index", 3, 1),
        "range-overlap",
        EPISODES_DIR,
        "episode 3",
        reader="dataset_from_index of episode 3: found 1",
    ),
    "ranges overlap by one frame": Damage(
        lambda root: edit_episodes(root, lambda columns: columns["dataset_to_index"].__setitem__(2, 218)),
        "range-overlap",
        EPISODES_DIR,
        reader="episode 3",
    ),
    "ranges overlap and lengths agree": Damage(
        lambda root: (
            edit_column(root, EPISODES, "dataset_to_index", add_at(2, 5)),
            edit_column(root, EPISODES, "length", add_at(2, 5)),
        ),
        "range-overlap",
        EPISODES_DIR,
        reader="episode 3",
    ),
    "frames that no episode claims": Damage(
        lambda root: (
            edit_column(root, EPISODES, "dataset_to_index", add_at(2, -5)),
            edit_column(root, EPISODES, "length", add_at(2, -5)),
        ),
        "range-gap",
        EPISODES_DIR,
        reader="episode 3",
    ),
    "the first range begins at 1": Damage(
        set_field("dataset_from_index", 0, 1), "range-gap", EPISODES_DIR, "episode 0", reader="episode 0"
    ),
    "range beyond the table": Damage(
        set_field("dataset_to_index", 5, 10**6),
        "range-length",
        EPISODES_DIR,
        "episode 5",
        reader="length of episode 5",
    ),
    "range backwards": Damage(set_field("dataset_to_index", 2, 1), "range-length", EPISODES_DIR, reader="episode"),
    "a negative range": Damage(
        set_field("dataset_from_index", 0, -5), "range-length range-overlap range-gap", EPISODES_DIR, reader="episode 0"
    ),
    "a length off by one": Damage(
        set_field("length", 3, 85), "range-length", EPISODES_DIR, "episode 3", reader="length of episode 3: found 85"
    ),
    "an episode without a frame": Damage(
        lambda root: edit_episodes(root, empty_episode),
        "range-length",
        EPISODES_DIR,
        "episode 2",
        reader="dataset_to_index of episode 2",
    ),
    "scrambled dataset_from_index": Damage(
        lambda root: edit_episodes(root, scramble),
        "range-overlap",
        EPISODES_DIR,
        base="split",
        reader="dataset_from_index of episode",
    ),
    "ranges counted in each file afresh": Damage(
        lambda root: edit_episodes(root, count_in_files),
        "range-overlap",
        EPISODES_DIR,
        base="split",
        reader="dataset_from_index of episode",
    ),
    "off by one after the first episode": Damage(
        lambda root: edit_episodes(root, shift_ranges), "range-gap", EPISODES_DIR, "episode 1", reader="episode 1"
    ),
    "dataset_from_index off by one after the first": Damage(
        lambda root: edit_episodes(root, shift_from), "range-gap", EPISODES_DIR, reader="episode 1"
    ),
    "one boundary off by one": Damage(
        lambda root: edit_episodes(root, lambda columns: move_boundaries(columns, 3, 1)),
        "episode-column",
        EPISODES_DIR,
        "217",
    ),
    "all boundaries off by one": Damage(
        lambda root: edit_episodes(root, lambda columns: move_boundaries(columns, slice(1, None), -1)),
        "episode-column",
        EPISODES_DIR,
        "episode 1",
    ),
    "lengths of two episodes exchanged": Damage(
        lambda root: edit_episodes(
            root, lambda columns: (columns["length"].put([1, 3], columns["length"][[3, 1]]), renumber_ranges(columns))
        ),
        "episode-column",
        EPISODES_DIR,
        "episode 2",
    ),
    "file pointer to nowhere": Damage(
        set_field("data/file_index", 5, 7),
        "data-file",
        "data/chunk-000/file-007",
        reader="",
        reader_file="data/chunk-000/file-0",
    ),
    "file pointer back and forth": Damage(
        set_field("data/file_index", 2, 1),
        "file-pointer",
        EPISODES_DIR,
        reader="data/file_index of episode 3",
        reader_file=EPISODES_DIR,
    ),
    "negative file pointer": Damage(
        lambda root: edit_episodes(root, lambda columns: columns["data/chunk_index"].fill(-1)),
        "data-file",
        "data/chunk--01",
        reader="no such file",
        reader_file="data/chunk--01",
    ),
    "file pointer of int64's limit": Damage(
        lambda root: edit_episodes(root, lambda columns: columns["data/file_index"].fill(2**63 - 1)),
        "data-file",
        "data/chunk-000/file-9223372036854775807",
        reader="no such file",
        reader_file="data",
    ),
    "a boundary episode points at the file before": Damage(
        lambda root: edit_episodes(root, repoint(3, 0)),
        "file-pointer",
        EPISODES_DIR,
        "data/file_index",
        base="split",
        reader="rows",
        reader_file="data",
    ),
    "every boundary episode points at the file before": Damage(
        lambda root: edit_episodes(root, point_at_the_file_before),
        "file-pointer",
        EPISODES_DIR,
        "data/file_index",
        base="split",
        reader="",
        reader_file="",
    ),
    "a last episode points at the next file": Damage(
        lambda root: edit_episodes(root, repoint(2, 1)),
        "file-pointer",
        EPISODES_DIR,
        "data/file_index",
        base="split",
        reader="rows",
        reader_file="data",
    ),
    "two file pointers exchanged": Damage(
        lambda root: edit_episodes(root, lambda columns: columns["data/file_index"].put([5, 6], [6, 5])),
        "file-pointer",
        EPISODES_DIR,
        base="unpadded",
        reader="rows",
        reader_file="data",
    ),
    "all file pointers off by one": Damage(
        lambda root: edit_episodes(root, lambda columns: columns["data/file_index"].__iadd__(1)),
        "file-pointer",
        EPISODES_DIR,
        base="unpadded",
        reader="",
        reader_file="data",
    ),
    "metadata short of the data": Damage(lose_last_episodes, "file-rows", DATA, reader="rows", reader_file=DATA),
    "metadata and splits short, totals right": Damage(
        lambda root: lose_last_episodes(root, total=False), "totals", INFO, reader="total_episodes"
    ),
    "index starts over in each file": Damage(
        edit_bookkeeping("index", lambda values: values - 313 * (values >= 313)), "index-column", "data", base="split"
    ),
    "index off by one": Damage(edit_bookkeeping("index", lambda values: values + 1), "index-column", DATA, "index"),
    "one index twice": Damage(edit_bookkeeping("index", at_row(100, -1)), "index-column", DATA, "index"),
    "index of zeros": Damage(edit_bookkeeping("index", lambda values: values * 0), "index-column", DATA, "index"),
    "episode_index one late": Damage(
        edit_bookkeeping("episode_index", lambda values: np.roll(values, 1) * (np.arange(len(values)) > 0)),
        "episode-column",
        DATA,
        "episode_index",
    ),
    "episode_index from 1": Damage(
        edit_bookkeeping("episode_index", lambda values: values + 1),
        "episode-column",
        DATA,
        "an episode that is in meta/episodes",
    ),
    "episode_index of zeros": Damage(
        edit_bookkeeping("episode_index", lambda values: values * 0), "episode-column", DATA, "no frame of episode 1"
    ),
    "one wrong episode_index": Damage(
        edit_bookkeeping("episode_index", at_row(100, 1)), "episode-column", DATA, "again"
    ),
    "frame_index runs on": Damage(
        edit_bookkeeping("frame_index", lambda values: np.arange(len(values))),
        "frame-column",
        DATA,
        "frame_index",
    ),
    "frame_index from 1": Damage(
        edit_bookkeeping("frame_index", lambda values: values + 1), "frame-column", DATA, "frame_index"
    ),
    "frame_index of zeros": Damage(
        edit_bookkeeping("frame_index", lambda values: values * 0), "frame-column", DATA, "frame_index"
    ),
    "one frame_index twice": Damage(
        edit_bookkeeping("frame_index", at_row(100, -1)), "frame-column", DATA, "frame_index"
    ),
    "a timestamp jump": Damage(edit_bookkeeping("timestamp", from_row(100, 1.0)), "timestamp", DATA, "timestamp"),
    "one timestamp late": Damage(edit_bookkeeping("timestamp", at_row(100, 0.03)), "timestamp", DATA, "timestamp"),
    "timestamps backwards": Damage(edit_bookkeeping("timestamp", at_row(100, -0.25)), "timestamp", DATA, "timestamp"),
    "timestamps in milliseconds": Damage(
        edit_bookkeeping("timestamp", lambda values: values * 1000), "timestamp", DATA, "timestamp"
    ),
    "timestamps of zero": Damage(
        edit_bookkeeping("timestamp", lambda values: values * 0), "timestamp", DATA, "timestamp"
    ),
    "timestamps that run on": Damage(
        edit_bookkeeping("timestamp", lambda values: np.arange(len(values)) / 10), "timestamp", DATA, "timestamp"
    ),
    "timestamps that drift": Damage(
        edit_bookkeeping("timestamp", lambda values: values * 1.02), "timestamp", DATA, "timestamp"
    ),
    "timestamps of a clock": Damage(
        edit_bookkeeping("timestamp", lambda values: values + 1.7e9), "timestamp", DATA, "timestamp"
    ),
    "a timestamp of NaN": Damage(
        edit_bookkeeping("timestamp", lambda values: np.where(values == values[100], np.nan, values), restated=False),
        "finite",
        DATA,
        "timestamp",
    ),
    "task_index out of range": Damage(
        edit_bookkeeping("task_index", from_row(300, 1)), "task-index", DATA, "task_index"
    ),
    "a negative task_index": Damage(edit_bookkeeping("task_index", at_row(300, -1)), "task-index", DATA, "task_index"),
}

ON_DATA: dict[str, Damage] = {
    "data missing": Damage(lambda root: (root / DATA).unlink(), "data-file", DATA, reader="no such file"),
    "data folder missing": Damage(lambda root: shutil.rmtree(root / "data"), "data-file", DATA, reader="no such file"),
    "a middle data file missing": Damage(
        lambda root: data_files(root)[2].unlink(),
        "data-file",
        "data/chunk-000/file-002",
        base="split",
        reader="no such file",
    ),
    "data cut in half": Damage(lambda root: truncate(root / DATA, 0.5), "data-file", DATA, reader="cut off"),
    "data cut by one byte": Damage(lambda root: truncate(root / DATA, 0.99999), "data-file", DATA, reader="cut off"),
    "data of no byte": Damage(lambda root: (root / DATA).write_bytes(b""), "data-file", DATA, reader="cut off"),
    "data of text": Damage(
        lambda root: (root / DATA).write_text("<html>404</html>"), "data-file", DATA, reader="cut off"
    ),
    "data of a git-lfs pointer": Damage(
        lambda root: leave_pointer(root / DATA), "data-file", DATA, "git lfs pull", reader="git lfs pull"
    ),
    "data without a row": Damage(
        lambda root: take_rows(root, DATA, lambda n: []), "file-rows", DATA, reader="rows", reader_file=DATA
    ),
    "data is a folder": Damage(lambda root: put_folder(root / DATA), "data-file", DATA, reader="expected"),
    "data links to itself": Damage(link_to_itself, "data-file", DATA, reader="found"),
    "data links out": Damage(escape_by_symlink, "data-file", DATA, reader="leads out"),
    "the data folder links out": Damage(
        lambda root: escape_by_folder(root, "data"), "data-file", DATA, reader="leads out"
    ),
    "a garbled column name": Damage(garble_a_column_name, "data-file", DATA, reader="cut off or damaged"),
    "magic bytes flipped": Damage(lambda root: flip(root / DATA, -1), "data-file", DATA, reader="cut off"),
    "footer length flipped": Damage(lambda root: flip(root / DATA, -6), "data-file", DATA, reader="cut off"),
    "footer flipped": Damage(
        lambda root: flip(root / DATA, footer_start((root / DATA).read_bytes()) + 3), "data-file", DATA, reader=""
    ),
    "footer of another file": Damage(
        lambda root: (root / DATA).write_bytes(
            (root / DATA).read_bytes()[:9000] + (root / EPISODES).read_bytes()[-9000:]
        ),
        "data-file",
        DATA,
        reader="",
    ),
    "first page flipped": Damage(lambda root: flip(root / DATA, 6), "data-file", DATA, reader=""),
    "a column of the data spoilt": Damage(
        lambda root: spoil_column(root / DATA, "action"), "data-file", DATA, reader=""
    ),
    "pages of zeros": Damage(
        lambda root: (root / DATA).write_bytes((data := (root / DATA).read_bytes())[:400] + bytes(1200) + data[1600:]),
        "data-file",
        DATA,
        reader="",
    ),
    "data claims rows it does not have": Damage(
        lambda root: claim_rows(root / DATA, 10**6),
        "data-file",
        DATA,
        reader="",
        reader_file=DATA,
    ),
    "the last file has no footer": Damage(
        lambda root: (path := root / LAST).write_bytes((data := path.read_bytes())[: footer_start(data)]),
        "data-file",
        LAST,
        base="split",
        reader="cut off",
    ),
    "cut off by a crash": Damage(crash, "orphan-file", LAST, base="split", reader="", reader_file="meta"),
    "cut off before the metadata": Damage(
        crash_before_the_metadata, "orphan-file", LAST, base="split", reader="", reader_file="data"
    ),
    "rows too many": Damage(
        lambda root: take_rows(root, DATA, lambda n: [*range(n), 0, 1, 2]),
        "file-rows",
        DATA,
        reader="rows",
        reader_file=DATA,
    ),
    "rows too few": Damage(
        lambda root: take_rows(root, DATA, lambda n: range(n - 9)), "file-rows", DATA, reader="rows", reader_file=DATA
    ),
    "a row dropped in the middle": Damage(
        lambda root: take_rows(root, DATA, lambda n: [i for i in range(n) if i != 99]),
        "file-rows",
        DATA,
        reader="rows",
        reader_file=DATA,
    ),
    "a row exchanged for its neighbour": Damage(
        lambda root: take_rows(root, DATA, lambda n: [99 if i == 100 else i for i in range(n)]), "index-column", DATA
    ),
    "all rows backwards": Damage(lambda root: take_rows(root, DATA, lambda n: range(n)[::-1]), "index-column", DATA),
    "two data files exchanged": Damage(
        lambda root: exchange(*data_files(root)[:2]),
        "file-pointer",
        EPISODES_DIR,
        base="split",
        reader="rows",
        reader_file="data",
    ),
    "data files renumbered by name": Damage(
        # Files that were sorted by name, where 10 comes before 2, and then numbered again.
        lambda root: rename_all(data_files(root), sorted(data_files(root))),
        "file-pointer",
        EPISODES_DIR,
        base="unpadded",
        reader="rows",
        reader_file="data",
    ),
    "two episodes exchanged in the data": Damage(exchange_episodes_in_data, "index-column", DATA),
    "file names without leading zeros": Damage(  # LeRobot sorts them as text, where 10 comes before 2
        lambda root: None, "file-order", "data/chunk-0/file-10.parquet", base="unpadded"
    ),
    "an orphan data file": Damage(
        lambda root: shutil.copy(root / DATA, root / "data/chunk-000/file-007.parquet"),
        "orphan-file",
        "data/chunk-000/file-007.parquet",
    ),
    "an orphan in another chunk": Damage(
        lambda root: ((root / "data/chunk-001").mkdir(), shutil.copy(root / DATA, root / "data/chunk-001")),
        "orphan-file",
        "data/chunk-001",
    ),
    "an orphan of the metadata": Damage(
        lambda root: shutil.copy(root / EPISODES, root / "meta/episodes/chunk-000/copy.parquet"),
        "orphan-file",
        "meta/episodes/chunk-000/copy.parquet",
    ),
    "an orphan video": Damage(orphan_video, "orphan-file", "videos/observation.images.top"),
    "a data column missing": Damage(
        lambda root: drop_column(root, DATA, STATE), "columns", DATA, STATE, reader=STATE, reader_file=DATA
    ),
    "a data column renamed": Damage(
        lambda root: rename_column(root, DATA, STATE, "state"), "columns", DATA, STATE, reader=STATE
    ),
    "frame_index missing": Damage(lambda root: drop_column(root, DATA, "frame_index"), "columns", DATA, "frame_index"),
    "timestamp missing": Damage(lambda root: drop_column(root, DATA, "timestamp"), "columns", DATA, "timestamp"),
    "a column without a feature": Damage(lambda root: add_column(root, DATA, "reward"), "columns", DATA, "reward"),
    "a column missing in one file": Damage(
        lambda root: drop_column(root, "data/chunk-000/file-002.parquet", "task_index"),
        "columns",
        "data/chunk-000/file-002.parquet",
        "task_index",
        base="split",
    ),
    "a column twice": Damage(
        lambda root: pq.write_table(
            (table := pq.read_table(root / DATA)).append_column("action", table.column("action")), root / DATA
        ),
        "data-file",
        DATA,
        "action",
        reader="",
    ),
    "state of float64": Damage(
        lambda root: retype(pa.list_(pa.float64(), 10))(root, STATE), "column-type", DATA, "float64", harmless=True
    ),
    "state of whole numbers": Damage(
        lambda root: edit_column(
            root, DATA, STATE, lambda rows: [[int(x) for x in row] for row in rows], pa.list_(pa.int64(), 10)
        ),
        "column-type",
        DATA,
        "int64",
    ),
    "action of text": Damage(
        lambda root: edit_column(root, DATA, "action", lambda rows: [str(row) for row in rows], pa.string()),
        "column-type",
        DATA,
        "action",
        reader="action",
    ),
    "frame_index of floats": Damage(
        lambda root: retype(pa.float64())(root, "frame_index"), "column-type", DATA, "frame_index"
    ),
    "timestamp of float64": Damage(
        lambda root: retype(pa.float64())(root, "timestamp"), "column-type", DATA, "timestamp", harmless=True
    ),
    "episode_index of int32": Damage(
        lambda root: retype(pa.int32())(root, "episode_index"), "column-type", DATA, "episode_index"
    ),
    "index of text": Damage(
        lambda root: edit_column(root, DATA, "index", lambda rows: [str(row) for row in rows], pa.string()),
        "column-type",
        DATA,
        "index",
    ),
    "one dimension too few in the data": Damage(
        lambda root: edit_column(root, DATA, STATE, lambda rows: [row[:9] for row in rows], pa.list_(pa.float32(), 9)),
        "column-type",
        DATA,
        STATE,
        reader="observation.state: found 9",
    ),
    "ragged rows": Damage(
        lambda root: edit_column(
            root,
            DATA,
            "action",
            lambda rows: [row[: 1 if i == 5 else 2] for i, row in enumerate(rows)],
            pa.list_(pa.float32()),
        ),
        "column-type",
        DATA,
        "action",
        reader="action: found 1 in row 5, expected 2",
    ),
    "NaN in the state": Damage(
        lambda root: edit_column(root, DATA, STATE, put(np.nan, 17, 4)),
        "finite",
        DATA,
        "sin_tee_yaw",
        reader="observation.state[sin_tee_yaw] in row 17: found nan",
    ),
    "an episode of NaN": Damage(
        change_values(["tee_x"], lambda values: values * np.nan, [2], restated=False),
        "finite",
        DATA,
        "tee_x",
        reader="nan",
    ),
    "a column of NaN": Damage(
        change_values(["tee_x"], lambda values: values * np.nan, restated=False), "finite", DATA, "tee_x", reader="nan"
    ),
    "infinity in the action": Damage(
        lambda root: edit_column(root, DATA, "action", put(-np.inf, 3, 1)),
        "finite",
        DATA,
        "pusher_vy",
        reader="action[pusher_vy] in row 3: found -inf",
    ),
    "a gap in the action": Damage(
        lambda root: edit_column(root, DATA, "action", lambda rows: [None, *rows[1:]]),
        "finite",
        DATA,
        "action",
        reader="action: found no value in 1 of",
    ),
    "a gap within a row": Damage(
        lambda root: edit_column(root, DATA, STATE, put(None, 17, 4)), "finite", DATA, STATE, reader="no value"
    ),
    "a gap in frame_index": Damage(
        lambda root: edit_column(root, DATA, "frame_index", set_at(17, None)),
        "finite",
        DATA,
        "frame_index",
    ),
    "all gaps in timestamp": Damage(
        lambda root: edit_column(root, DATA, "timestamp", lambda rows: [None] * len(rows)),
        "finite",
        DATA,
        "timestamp",
    ),
}

ON_VALUES: dict[str, Damage] = {
    "values changed under the statistics": Damage(
        change_values(["tee_x"], lambda values: values + 0.004, restated=False),
        "stats",
        STATS_PATH,
        "tee_x",
        harmless=True,
    ),
    "a frozen sensor in one episode": Damage(
        change_values(["pusher_x"], lambda values: values * 0 + values[0], [3]),
        "frozen",
        "data",
        "pusher_x",
        base="messy",
    ),
    "a sensor frozen from the start": Damage(
        change_values(["pusher_y"], lambda values: values * 0 + 0.1), "action-motion", "data", "along y"
    ),
    "a block frozen in one episode": Damage(
        change_values(["tee_x", "tee_y", *SIN_COS], lambda values: values * 0 + values[0], [2]), "frozen", "data", "tee"
    ),
    "an action frozen in one episode": Damage(
        change_values(["pusher_vx"], lambda values: values * 0, [3]),
        "action-motion",
        "data",
        "in episode 3: found motion of 0.19 m/s along x",
        base="messy",
    ),
    "a state stuck for 20 frames": Damage(
        each_episode(
            lambda rows: rows[np.where((np.arange(len(rows)) // 20) == 1, 20, np.arange(len(rows)))], STATE, 2
        ),
        "frozen",
        DATA,
    ),
    "one glitched value": Damage(glitch("tee_x", 100, 0.3), "jump", "data", "tee_x"),
    "one glitched sine": Damage(glitch("sin_tee_yaw", 100, 0.4), "unit-circle", DATA, "sin_tee_yaw"),
    "a sentinel of 999": Damage(glitch("pusher_x", 100, 999), "jump", "data", "pusher"),
    "a row of zeros": Damage(lambda root: edit_frames(root, zero_row), "unit-circle", DATA),
    "cosine halved": Damage(
        change_values(["cos_tee_yaw"], lambda values: values / 2), "unit-circle", DATA, "cos_tee_yaw"
    ),
    "cosine halved in one episode": Damage(
        change_values(["cos_tee_yaw"], lambda values: values / 2, [4]), "unit-circle", DATA, "cos_tee_yaw"
    ),
    "sine and cosine of zero": Damage(
        change_values(SIN_COS, lambda values: values * 0), "unit-circle", DATA, "tee_yaw"
    ),
    "the target's cosine halved": Damage(
        change_values(["cos_target_yaw"], lambda values: values / 2), "unit-circle", DATA, "cos_target_yaw"
    ),
    "degrees in the sine's place": Damage(
        lambda root: edit_frames(root, yaw_in_degrees), "unit-circle", DATA, "tee_yaw"
    ),
    "sine and cosine of degrees": Damage(turn("tee", np.degrees), "overlap", DATA),
    "yaw negated": Damage(turn("tee", np.negative), "overlap", DATA),
    "yaw off by 90°": Damage(turn("tee", lambda yaw: yaw + np.pi / 2), "overlap", DATA),
    "the target's yaw off by 90°": Damage(
        turn("target", lambda yaw: yaw + np.pi / 2), "final-offset", "data", "turned"
    ),
    "the target shifted by 10 cm": Damage(
        change_values(["target_x"], lambda values: values + 0.1), "final-offset", "data", "-100"
    ),
    "names: tee's sin and cos": Damage(lambda root: exchange_names(root, SIN_COS), "overlap", DATA),
    "names: target's sin and cos": Damage(lambda root: exchange_names(root, TARGET_SIN_COS), "final-offset", "data"),
    "names: every sin and cos": Damage(lambda root: exchange_names(root, SIN_COS, TARGET_SIN_COS), "overlap", DATA),
    "names: pusher's x and y": Damage(
        lambda root: exchange_names(root, ("pusher_x", "pusher_y")), "overlap action-motion", "data"
    ),
    "names: tee's x and y": Damage(lambda root: exchange_names(root, ("tee_x", "tee_y")), "overlap", DATA),
    "names: every x and y": Damage(
        lambda root: exchange_names(root, ("pusher_x", "pusher_y"), ("tee_x", "tee_y"), ("target_x", "target_y")),
        "overlap action-motion",
        "data",
    ),
    "names: pusher and tee": Damage(
        lambda root: exchange_names(root, ("pusher_x", "tee_x"), ("pusher_y", "tee_y")), "action-motion overlap", "data"
    ),
    "names: tee and target": Damage(
        lambda root: exchange_names(
            root, *((name, name.replace("tee", "target")) for name in z2r.PUSHT.poses["tee"].names)
        ),
        "overlap",
        DATA,
    ),
    "names: action's x and y": Damage(
        lambda root: exchange_names(root, tuple(ACTION_NAMES), feature="action"), "action-motion", "data", "correlation"
    ),
    "positions in mm": Damage(
        change_values(POSITIONS, lambda values: values * 1000), "action-motion", "data", "957 times"
    ),
    "the block in mm": Damage(change_values(["tee_x", "tee_y"], lambda values: values * 1000), "leap", DATA),
    "the pusher off by 5 cm": Damage(change_values(["pusher_x"], lambda values: values + 0.05), "overlap", DATA),
    "x mirrored for the pusher": Damage(change_values(["pusher_x"], np.negative), "overlap action-motion", "data"),
    "actions in cm/s": Damage(
        change_values(ACTION_NAMES, lambda values: values * 100), "action-range", "data", "action"
    ),
    "actions in m per step": Damage(
        change_values(ACTION_NAMES, lambda values: values / 10), "action-motion", "data", "9.57 times"
    ),
    "actions of zero": Damage(
        change_values(ACTION_NAMES, lambda values: values * 0), "action-motion", "data", "0 m/s asked"
    ),
    "actions one frame late": Damage(each_episode(lag(1), "action"), "action-motion", "data", "1 frame before"),
    "actions two frames late": Damage(each_episode(lag(2), "action"), "action-motion", "data", "2 frames before"),
    "actions one frame early": Damage(each_episode(lag(-1), "action"), "action-motion", "data", "1 frame after"),
    "actions one frame late in one episode": Damage(
        each_episode(lag(1), "action", only=3), "action-motion", "data", "episode 3"
    ),
    "an action's sign flipped": Damage(change_values(["pusher_vy"], np.negative), "action-motion", "data", "along y"),
    "an action's sign flipped in one episode": Damage(
        change_values(["pusher_vy"], np.negative, [3]), "action-motion", "data", "episode 3"
    ),
    "all actions' signs flipped": Damage(
        change_values(ACTION_NAMES, np.negative), "action-motion", "data", "along x and y"
    ),
    "positions for actions": Damage(
        lambda root: edit_frames(root, positions_for_velocities), "action-motion", "data", "correlation"
    ),
    "actions of other frames": Damage(
        lambda root: edit_frames(root, other_actions), "action-motion", "data", "correlation"
    ),
    "fps 30 and timestamps too": Damage(
        lambda root: (edit_info(root, fps=30), edit_bookkeeping("timestamp", lambda values: values / 3)(root)),
        "action-motion",
        "data",
        "2.87 times",
    ),
    "fps 1000 and timestamps too": Damage(
        lambda root: (edit_info(root, fps=1000), edit_bookkeeping("timestamp", lambda values: values / 100)(root)),
        "action-motion",
        "data",
        "95.7 times",
    ),
    "states of one episode shuffled": Damage(lambda root: edit_frames(root, shuffle), "leap", DATA),
    "frames backwards": Damage(in_each(lambda n: np.arange(n)[::-1]), "action-motion", "data"),
    "frames of one episode backwards": Damage(
        in_one(3, lambda n: np.arange(n)[::-1]), "action-motion", "data", "episode 3"
    ),
    "every frame twice": Damage(in_each(lambda n: np.arange(2 * n) // 2), "action-motion", "data", "times the speed"),
    "every second frame dropped": Damage(
        in_each(lambda n: np.arange(0, n, 2)), "action-motion", "data", "times the speed"
    ),
    "3 frames dropped in one episode": Damage(in_one(3, lambda n: np.r_[0:30, 33:n]), "leap", DATA, "frame 247"),
    "10 frames dropped in one episode": Damage(in_one(2, lambda n: np.r_[0:30, 40:n]), "leap", DATA, "frame 171"),
    "a demonstration twice": Damage(reorder(lambda e: [*e[:4], e[1], *e[4:]]), "twin", "data", "episode 1 again"),
    "two episodes merged": Damage(reorder(lambda e: [e[0], joined(e[1], e[2]), *e[3:]]), "leap", DATA, "frame 141"),
    "all episodes merged": Damage(reorder(lambda e: [joined(*e)]), "leap", DATA),
    "one episode split in two": Damage(
        reorder(lambda e: [*e[:2], rows_of(e[2], slice(35)), rows_of(e[2], slice(35, None)), *e[3:]]),
        "leap",
        DATA,
        "frame 176",
    ),
    "all boundaries off by one, in the frames too": Damage(reorder(move_all_boundaries), "leap", DATA, "5 like it"),
    "all boundaries 15 frames late, in the frames too": Damage(
        reorder(lambda episodes: move_all_boundaries(episodes, 15)), "decisive-frame", "data"
    ),
    "the last frames of every episode missing": Damage(stop_too_early, "verdict", "dataset.verdict.json", "277"),
    "the verdict of another dataset": Damage(verdict_of_another, "verdict", "dataset.verdict.json", "1108"),
    "a verdict of success where nothing was reached": Damage(
        verdict_too_good, "verdict", "dataset.verdict.json", "success of episode 2", base="messy"
    ),
}

ON_LABELS: dict[str, Damage] = {
    "a success without its reward": Damage(
        relabel("next.reward", np.zeros_like, 1), "success-reward", "data", "episode 1,", base="labelled"
    ),
    "a reward without its success": Damage(
        relabel("next.success", np.zeros_like, 1), "success-reward", "data", "never true in episode 1", base="labelled"
    ),
    "a success that is lost": Damage(
        relabel("next.success", true_from(5, 9), 1), "success-lost", "data", "episode 1", base="labelled", harmless=True
    ),
    "done in the middle": Damage(
        relabel("next.done", true_from(5, 6), 1), "done", "data", "episode 1", base="labelled"
    ),
    "done from the first frame on": Damage(
        relabel("next.done", np.ones_like, 1), "done", "data", "episode 1", base="labelled"
    ),
    "done for the last ten frames": Damage(
        relabel("next.done", true_from(-10), 1), "done", "data", "up to the end", base="labelled", harmless=True
    ),
    "never done": Damage(
        relabel("next.done", np.zeros_like), "done", "data", "false in every frame", base="labelled", harmless=True
    ),
    "a reward that never comes": Damage(
        relabel("next.reward", np.zeros_like), "label-constant", "data", "0 in every", base="labelled", harmless=True
    ),
    "a reward that is no number": Damage(
        relabel("next.reward", lambda values: values * np.nan, 1), "finite", "data", "next.reward", base="labelled"
    ),
    "a success everywhere": Damage(
        only_success(np.ones_like, names=False),
        "label-constant",
        "data",
        "true in every",
        base="labelled",
        harmless=True,
    ),
    "no success anywhere": Damage(
        only_success(np.zeros_like, names=False), "label-constant", "data", "false in", base="labelled", harmless=True
    ),
    "a success that is read as not reached": Damage(
        relabel("next.success", true_from(-1), FAILED),
        "stored-success",
        "data",
        f"episode {FAILED}, read as not reached",
        base="labelled",
    ),
    "no success, and read as reached": Damage(
        only_success(np.zeros_like, 1),
        "stored-success",
        "data",
        "no success in episode 1, read as reached",
        base="labelled",
        harmless=True,
    ),
    "a reward alone, where the reading says not reached": Damage(
        lambda root: (relabel("next.reward", true_from(-1), FAILED)(root), forget(root, "next.success")),
        "stored-success",
        "data",
        "next.reward with next.done",
        base="labelled",
    ),
}

DAMAGES: dict[str, Damage] = ON_INFO | ON_META | ON_TASKS | ON_INDEX | ON_DATA | ON_VALUES | ON_LABELS | ON_READINESS


def make(kind: str, root: Path) -> None:
    """Make a dataset with this kind of damage."""
    BASES[DAMAGES[kind].base](root)
    DAMAGES[kind].do(root)


def fingerprint(folder: Path) -> dict[Path, str]:
    """Return the sum of every file below a folder."""
    files = sorted(path for path in folder.rglob("*") if path.is_file())
    return {path: hashlib.sha256(path.read_bytes()).hexdigest() for path in files}
