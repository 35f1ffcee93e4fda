"""Is the dataset whole? The files that must be there, and the totals that `meta/info.json` states."""

import re
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import msgspec
import numpy as np
import pyarrow as pa

from z2r.arrays import Ints
from z2r.audits.findings import Finding, error, from_fault, note, warning
from z2r.errors import DatasetError, Fault
from z2r.format.episodes import COLUMNS, EPISODES_DIR, file_numbers, read_shard, shard_paths
from z2r.format.parquet import integers, open_parquet, read_columns
from z2r.format.schema import BOOKKEEPING, INFO_PATH, Schema, inside

TASKS_PATH = Path("meta/tasks.parquet")
STATS_PATH = Path("meta/stats.json")

_MAX_STATS_BYTES = 64 * 2**20
_SOME = 3  # names in one line


class Rows(NamedTuple):
    """What the episode metadata says, a row for each episode: all int64[n_episodes].

    `file` counts the data files that are named, in the order of their numbers.
    """

    number: Ints
    start: Ints
    stop: Ints
    length: Ints
    file: Ints


class Totals(msgspec.Struct):
    """What `meta/info.json` states beside the schema."""

    total_tasks: int | None = None
    splits: dict[str, str] | None = None
    video_path: str | None = None


def read_totals(root: Path) -> tuple[Totals, list[Finding]]:
    """Read what `meta/info.json` states beside the schema; what cannot be read there is left out."""
    try:
        return msgspec.json.decode((root / INFO_PATH).read_bytes(), type=Totals), []
    except msgspec.ValidationError as fault:
        what, _, where = str(fault).partition(" - at `$.")
        expected = what.removeprefix("Expected ")
        return Totals(), [error("info", INFO_PATH, where.rstrip("`"), "another type", expected)]


def read_rows(root: Path) -> tuple[dict[str, Ints], list[Path], list[Finding]]:
    """Read the shards of the episode metadata that can be read, and say which these are; the columns may be empty."""
    nothing = {name: np.array([], dtype=np.int64) for name in COLUMNS}
    try:
        paths = shard_paths(root)
    except DatasetError as fault:
        return nothing, [], [from_fault("episodes-file", fault, root)]
    shards, readable, findings = [nothing], [], list(_skipped_numbers(root, paths))
    for path in paths:
        try:
            parquet = open_parquet(path)
            stored = parquet.schema_arrow.names
            read_columns(parquet, path, stored)  # LeRobot reads them all
            if "tasks" not in stored:
                inner = path.relative_to(root)
                findings.append(error("episodes-file", inner, "tasks", "no such column", "the tasks of each episode"))
            shards.append(read_shard(path))
            readable.append(path)
        except DatasetError as fault:
            findings.append(from_fault("episodes-file", fault, root))
    columns = {name: np.concatenate([shard[name] for shard in shards]) for name in COLUMNS}
    if not len(columns["length"]) and not findings:
        findings.append(error("episodes-file", EPISODES_DIR, "", "no episodes", "at least one"))
    return columns, readable, findings


def name_files(schema: Schema, columns: dict[str, Ints]) -> tuple[Rows, list[Path]]:
    """List the data files that the index names, in the order of their numbers, relative to the dataset."""
    pointers = np.stack([columns["data/chunk_index"], columns["data/file_index"]], axis=1)
    named, file = np.unique(pointers, axis=0, return_inverse=True)
    paths = [Path(schema.data_path.format(chunk_index=chunk, file_index=file)) for chunk, file in named.tolist()]
    rows = Rows(
        number=columns["episode_index"],
        start=columns["dataset_from_index"],
        stop=columns["dataset_to_index"],
        length=columns["length"],
        file=file.ravel(),
    )
    return rows, paths


def check_features(schema: Schema) -> Iterator[Finding]:
    """Is every feature of a type that exists, with a name for each dimension or none?"""
    for name, feature in schema.features.items():
        if not feature.is_numeric:
            continue
        try:
            np.dtype(feature.dtype)
        except (TypeError, ValueError, SyntaxError):
            yield error("info", INFO_PATH, f"features.{name}.dtype", feature.dtype, "a dtype that numpy knows")
        names = feature.names
        if isinstance(names, dict) and len(names) == 1:
            (names,) = names.values()
        if not isinstance(names, list) or name in BOOKKEEPING:
            continue
        place = f"features.{name}.names"
        if len(feature.shape) == 1 and (len(names) != feature.size or not all(isinstance(each, str) for each in names)):
            found = f"{len(names)} names: {', '.join(map(str, names))}"
            tell = note if len(names) == 1 else warning  # one name for all is what some converters write
            yield tell("info", INFO_PATH, place, found, f"{feature.size} texts, one for each dimension")
        repeated = [each for each, times in Counter(map(str, names)).items() if times > 1]
        if repeated:
            yield warning("info", INFO_PATH, place, f"{repeated[0]} twice", "another name for each dimension")


def check_order(files: Sequence[Path]) -> Iterator[Finding]:
    """Do names sort like numbers?"""
    names = [file.as_posix() for file in files]
    for name, sorted_name in zip(names, sorted(names), strict=True):
        if name != sorted_name:
            found, expected = f"it before {name} when names are sorted", "names that sort like their numbers"
            mend = "LeRobot 0.6.1 sorts files by name and would mix up the frames: pad the numbers with zeros"
            yield warning("file-order", sorted_name, "", found, expected, mend)
            return


def check_orphans(root: Path, files: Sequence[Path]) -> Iterator[Finding]:
    """Is there a parquet file that nothing names?"""
    known = {*files, TASKS_PATH}
    for path in sorted(root.rglob("*.parquet")):
        inner = path.relative_to(root)
        if inner in known or (inner.is_relative_to(EPISODES_DIR) and inner.match("chunk-*/file-*.parquet")):
            continue
        in_data = inner.is_relative_to("data")
        yield (error if in_data else warning)(
            "orphan-file",
            inner,
            "",
            "a file that no episode is in",
            "only files that the index names",
            "LeRobot reads every file below data/: move it away, or mend the index" if in_data else "Move it away",
        )


def check_totals(root: Path, schema: Schema, totals: Totals, rows: Rows, n_tasks: int | None) -> Iterator[Finding]:
    """Are the totals those that are counted?"""
    counted = {"total_episodes": (schema.total_episodes, len(rows.number), "rows of meta/episodes")}
    counted["total_frames"] = (schema.total_frames, int(rows.length.sum()), "frames by meta/episodes")
    if totals.total_tasks is not None and n_tasks is not None:
        counted["total_tasks"] = (totals.total_tasks, n_tasks, "rows of meta/tasks.parquet")
    for field, (stated, found, what) in counted.items():
        if stated != found:
            yield error("totals", INFO_PATH, field, stated, f"{found}, the number of {what}")


def check_splits(totals: Totals, n_episodes: int) -> Iterator[Finding]:
    """Is every split a range of episodes that exist?"""
    for name, split in (totals.splits or {}).items():
        ends = re.fullmatch(r"(\d{1,18}):(\d{1,18})", split, re.ASCII)
        if not ends or not int(ends[1]) <= int(ends[2]) <= n_episodes:
            expected = f"a range of episodes within 0:{n_episodes}"
            yield error("splits", INFO_PATH, f"splits.{name}", repr(split[:60]), expected)


def read_tasks(root: Path) -> tuple[Ints | None, list[Finding]]:
    """Read the numbers of the tasks; None where they cannot be read."""
    try:
        path = inside(root, TASKS_PATH)
        parquet = open_parquet(path)
        stored = parquet.schema_arrow  # the text is in the index of a pandas table, whose name may be any
        texts = [
            field.name for field in stored if pa.types.is_string(field.type) or pa.types.is_large_string(field.type)
        ]
        table = read_columns(parquet, path, ["task_index", *texts])
        tasks = integers(table, "task_index", path)
        if not any(not table.column(text).null_count for text in texts):
            raise DatasetError(Fault(path, "task", "no such column, or gaps in it", "the text of each task"))
    except DatasetError as fault:
        return None, [from_fault("tasks-file", fault, root)]
    if not np.array_equal(np.sort(tasks), np.arange(len(tasks))) or not len(tasks):
        found = ", ".join(map(str, tasks[:_SOME].tolist())) or "no task"
        return tasks, [error("tasks-file", TASKS_PATH, "task_index", found, "0, 1, 2 ..., each once")]
    return tasks, []


def read_stats(root: Path) -> tuple[dict[str, dict[str, Any]] | None, list[Finding]]:
    """Read the stored statistics of each feature, None where they cannot be read; a policy scales its input by them."""
    try:
        path = inside(root, STATS_PATH)
        if path.stat().st_size > _MAX_STATS_BYTES:
            raise DatasetError(Fault(path, "", f"{path.stat().st_size} bytes", f"at most {_MAX_STATS_BYTES}"))
        return msgspec.json.decode(path.read_bytes(), type=dict[str, dict[str, Any]]), []
    except DatasetError as fault:
        return None, [from_fault("stats-file", fault, root)]
    except (OSError, msgspec.MsgspecError, UnicodeDecodeError, RecursionError) as fault:
        found = fault.strerror.lower() if isinstance(fault, OSError) and fault.strerror else f"broken JSON ({fault})"
        return None, [warning("stats-file", STATS_PATH, "", found, "the statistics of each feature")]


def check_videos(root: Path, schema: Schema, totals: Totals) -> Iterator[Finding]:
    """Is every video there that the episode metadata names, and no other?"""
    known: set[str] = set()
    for name in (name for name, feature in schema.features.items() if feature.dtype == "video"):
        try:
            paths = _named_videos(root, name, _video_template(root, totals))
        except DatasetError as fault:
            yield from_fault("video-file", fault, root)
            return
        for path in paths:
            yield from _check_video(root, path)
        known.update(paths)
    for video in sorted((root / "videos").rglob("*.mp4")):
        inner = video.relative_to(root)
        if inner.as_posix() not in known:
            yield warning("orphan-file", inner, "", "a video that no episode is in", "only those that the index names")


def _named_videos(root: Path, name: str, template: str) -> list[str]:
    columns = [f"videos/{name}/chunk_index", f"videos/{name}/file_index"]
    named: set[tuple[int, ...]] = set()
    for path in shard_paths(root):
        shard = read_columns(open_parquet(path), path, columns)
        named.update(zip(*(integers(shard, column, path).tolist() for column in columns), strict=True))
    return [template.format(video_key=name, chunk_index=chunk, file_index=file) for chunk, file in sorted(named)]


def _video_template(root: Path, totals: Totals) -> str:
    template = totals.video_path or ""
    fields = re.sub(r"\{(video_key|(chunk|file)_index(:0\dd)?)\}", "", template)
    if not template or "{" in fields or "}" in fields:
        raise DatasetError(
            Fault(
                root / INFO_PATH,
                "video_path",
                repr(totals.video_path),
                "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4",
            )
        )
    return template


def _check_video(root: Path, path: str) -> Iterator[Finding]:
    try:
        if not inside(root, path).is_file():
            yield error("video-file", path, "", "no such file", "a video", "Copy or download it again")
    except DatasetError as fault:
        yield from_fault("video-file", fault, root)


def _skipped_numbers(root: Path, paths: Sequence[Path]) -> Iterator[Finding]:
    """Shards count on within a chunk, or begin the next one."""
    before = [0, -1]
    for path in paths:
        numbers = file_numbers(path)
        if numbers not in ([before[0], before[1] + 1], [before[0] + 1, 0]):
            yield warning(
                "episodes-file",
                path.relative_to(root),
                "",
                f"this shard after file {before[1]} of chunk {before[0]}" if before[1] >= 0 else "this shard first",
                f"file {before[1] + 1} of chunk {before[0]}",
                "A shard is missing: copy or download it again",
            )
        before = [*numbers, 0, 0][:2]
