"""Is the dataset whole? The files that must be there, their columns, and the totals that `meta/info.json` states."""

import re
from collections.abc import Iterator
from difflib import get_close_matches
from pathlib import Path

import numpy as np

from z2r.audits.claims import Claims, NoSchema, Stored
from z2r.audits.frames import FileColumns
from z2r.check import Answer, Check
from z2r.errors import Fault, count, some
from z2r.format import rules
from z2r.format.episodes import EPISODES_DIR
from z2r.format.names import in_a_row, repeated
from z2r.format.schema import BOOKKEEPING, INFO_PATH, STATE, Feature
from z2r.format.tables import TASKS_PATH

_MOTORS = 8  # of one arm and its gripper, at most

INFO = Check("info", "meta/info.json is there, and every field in it is what it should be", "error")


@INFO.of(NoSchema)
def info_is_readable(dataset: NoSchema) -> Iterator[Answer]:
    """Of a version that cannot be read, `version` says so."""
    if dataset.fault.field != "codebase_version":
        yield dataset.fault


@INFO.of(Stored)
def features_are_possible(stored: Stored) -> Iterator[Answer]:
    """Is every feature of a type that exists, with a name for each dimension or none?"""
    yield from stored.stated.faults
    for name, feature in stored.schema.features.items():
        if feature.is_numeric:
            yield from _dtype_faults(name, feature)
            yield from _name_faults(name, feature)


@INFO.of(Claims)
def no_name_is_misspelt(claims: Claims) -> Iterator[Answer]:
    """Is a name of the reading misspelt? Then the reading does not fit, and nothing says what the columns mean."""
    reading = claims.reading
    if reading is None:
        return
    feature = claims.schema.features.get(reading.feature)
    others = [name for name in (feature.dim_names if feature else ()) if name not in reading.names]
    mend = "If it is this column, mend its name: without it, nothing says what the columns mean"
    for name in reading.missing(claims.schema):
        for close in get_close_matches(name, others, n=1, cutoff=0.85):
            yield "warning", Fault(INFO_PATH, f"features.{reading.feature}.names", close, name, mend)


@Check("version", "the dataset is of format v3", "error").of(NoSchema)
def version(dataset: NoSchema) -> Iterator[Answer]:
    """Is it of a version that can be read?"""
    if dataset.fault.field == "codebase_version":
        yield dataset.fault


@Check("episodes-file", "every shard of the episode metadata is there and can be read", "error").of(Stored)
def episodes_file(stored: Stored) -> Iterator[Answer]:
    """Can every shard be read?"""
    for fault in stored.episodes.value.skipped:
        yield "warning", fault
    yield from stored.episodes.faults


@Check("tasks-file", "meta/tasks.parquet is there, and numbers its tasks 0, 1, 2 ...", "error").of(Stored)
def tasks_file(stored: Stored) -> Iterator[Answer]:
    """Can the tasks be read?"""
    yield from stored.tasks.faults


@Check("stats-file", "meta/stats.json is there and can be read", "warning").of(Stored)
def stats_file(stored: Stored) -> Iterator[Answer]:
    """Can the statistics be read?"""
    yield from stored.stats.faults


DATA_FILE = Check("data-file", "every data file that the index names is there and can be read", "error")


@DATA_FILE.of(FileColumns)
def data_file(file: FileColumns) -> Iterator[Answer]:
    """Can the file be read?"""
    yield from file.read.unreadable


VIDEO_FILE = Check("video-file", "every video that the index names is there and can be read", "error")


@VIDEO_FILE.of(Claims)
def videos_are_named(claims: Claims) -> Iterator[Answer]:
    """Does the metadata say which videos there are? Whether they are, their index says."""
    yield from claims.videos.faults


@Check("file-order", "files sorted by name are sorted by number, as LeRobot reads them", "warning").of(Claims)
def file_order(claims: Claims) -> Iterator[Answer]:
    """Do names sort like numbers?"""
    names = [path.as_posix() for path in claims.stored.episodes.value.files]
    for name, sorted_name in zip(names, sorted(names), strict=True):
        if name != sorted_name:
            found, expected = f"it before {name} when names are sorted", "names that sort like their numbers"
            mend = "LeRobot 0.6.1 sorts files by name and would mix up the frames: pad the numbers with zeros"
            yield Fault(Path(sorted_name), "", found, expected, mend)
            return


ORPHAN_FILE = Check("orphan-file", "there is no parquet file or video that nothing names", "warning")


@ORPHAN_FILE.of(Claims)
def no_orphan_table(claims: Claims) -> Iterator[Answer]:
    """Is there a parquet file that nothing names?"""
    known, expected = {*claims.stored.episodes.value.files, TASKS_PATH}, "only files that the index names"
    yield from claims.found.faults
    for path in (path for path in claims.found.value if path.suffix == ".parquet" and path not in known):
        if path.is_relative_to(EPISODES_DIR) and path.match("chunk-*/file-*.parquet"):
            continue
        if path.is_relative_to("data"):
            mend = "LeRobot reads every file below data/: move it away, or mend the index"
            yield "error", Fault(path, "", "a file that no episode is in", expected, mend)
        else:
            yield Fault(path, "", "a file that no episode is in", expected, "Move it away")


@ORPHAN_FILE.of(Claims)
def no_orphan_video(claims: Claims) -> Iterator[Answer]:
    """Is there a video that no episode is in?"""
    named = {path for spans in claims.videos.value.values() for path in spans.paths}
    for path in () if claims.videos.faults else claims.found.value:
        if path.suffix == ".mp4" and path not in named:
            yield Fault(path, "", "a video that no episode is in", "only those that the index names")


@Check("columns", "every feature has a column, and every column is a feature", "error").of(FileColumns)
def columns(file: FileColumns) -> Iterator[Answer]:
    """Videos are files of their own; every other feature is a column."""
    if file.read.n_rows is None:
        return
    features, present = file.schema.features, file.read.present
    stored = [name for name, feature in features.items() if feature.dtype != "video"]
    yield from rules.missing_columns(file.claims.path, stored, present)
    mend = "LeRobot refuses such a file: name it in the features, or drop it"
    for name in present:
        if name not in features:
            yield Fault(file.claims.path, name, "a column", "only features that meta/info.json names", mend)


COLUMN_TYPE = Check("column-type", "every column has the type and the width that the schema says", "error")


@COLUMN_TYPE.of(FileColumns)
def columns_have_their_shape(file: FileColumns) -> Iterator[Answer]:
    """Has every column the width that the schema says, those too that are too wide to be read?"""
    for name, width in file.read.widths.items():
        size = file.schema.features[name].size
        if width != size:
            expected = f"{size:,}, as its shape in meta/info.json says"
            yield Fault(file.claims.path, name, f"{width:,} numbers in each row", expected)
    yield from file.in_order(file.read.misshapen)


@COLUMN_TYPE.of(FileColumns)
def columns_have_their_dtype(file: FileColumns) -> Iterator[Answer]:
    """Another float is harmless."""
    for name, stored in file.read.dtypes.items():
        said = file.schema.features[name].dtype
        if said == stored or (said == "bool" and stored == "uint8"):  # as booleans are read
            continue
        harmless = np.dtype(stored).kind == "f" and said.startswith("float")
        fault = Fault(file.claims.path, name, f"values of type {stored}", f"{said}, as meta/info.json says")
        yield "note" if harmless else "warning", fault


@Check("totals", "the totals in meta/info.json are those that are counted", "error").of(Claims)
def totals(claims: Claims) -> Iterator[Answer]:
    """Are the totals of episodes, frames and tasks those that are counted?"""
    yield from rules.totals(claims.schema, claims.table)
    stated, tasks = claims.stored.stated.value.total_tasks, claims.stored.task_numbers
    if stated is not None and tasks is not None and stated != len(tasks):
        yield Fault(INFO_PATH, "total_tasks", stated, f"{len(tasks)}, the number of rows of meta/tasks.parquet")


@Check("robot-type", "the robot that is named has as many arms as the names of its state", "note").of(Claims)
def robot_has_the_arms_of_its_state(claims: Claims) -> Iterator[Answer]:
    """Does the name of a robot say one arm, and those of its state two, or the reverse?"""
    kind, state = claims.schema.robot_type, claims.schema.features.get(STATE)
    names = state.dim_names if state else ()
    if not isinstance(kind, str) or not names:
        return
    is_two = re.match("aloha|bi_", kind.lower())
    is_one = re.match("so10[01]|koch", kind.lower()) and not re.search("bi|dual|two", kind.lower())
    arms = {side for side in ("left", "right") for name in names if re.match(rf"{side}(?![a-z])", name.lower())}
    if (is_one and len(arms) == 2) or (is_two and not arms and len(names) <= _MOTORS):
        found = f"{kind!r}, which has {'one arm' if is_one else 'two arms'}"
        expected = f"the robot whose state has the columns {some([*names])}"
        yield Fault(INFO_PATH, "robot_type", found, expected, "Was it left from another recording? Name the robot")


def _dtype_faults(name: str, feature: Feature) -> Iterator[Answer]:
    try:
        np.dtype(feature.dtype)
    except (TypeError, ValueError, SyntaxError):
        yield Fault(INFO_PATH, f"features.{name}.dtype", feature.dtype, "a dtype that numpy knows")


def _name_faults(name: str, feature: Feature) -> Iterator[Answer]:
    if feature.names is None or name in BOOKKEEPING:
        return
    names, place = in_a_row(feature.names), f"features.{name}.names"
    if len(feature.shape) == 1 and not feature.dim_names:
        texts = all(isinstance(each, str) for each in names)
        found = f"{count(len(names), 'name')}: {some(names)}" if texts else feature.names
        fault = Fault(INFO_PATH, place, found, f"{feature.size} texts, one for each dimension")
        yield "note" if texts and len(names) == 1 else "warning", fault  # some converters write one name for all
    for each in repeated(names)[:1]:
        mend = "A reading that names it is refused: nobody knows which one is meant"
        yield "warning", Fault(INFO_PATH, place, f"{each} twice", "another name for each dimension", mend)
