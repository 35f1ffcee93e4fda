"""Fact one: the schema. What is a frame?

`meta/info.json` names every feature that is stored for a frame, with its dtype and shape, and the names of its
dimensions. The layout is that of LeRobot's dataset format v3.0 (lerobot 0.6.1, `lerobot/datasets/utils.py`).
"""

import math
import re
import shlex
import string
from collections.abc import Sequence
from functools import cached_property
from pathlib import Path
from typing import Annotated, Any

import msgspec

from z2r.errors import DatasetError, Fault
from z2r.format.names import names_of, repeated
from z2r.format.store import check_folder, exists, in_full, inside, read_bytes

INFO_PATH = Path("meta/info.json")
STATE = "observation.state"
ACTION = "action"

# Every LeRobot dataset has these five beside what the robot saw and did.
BOOKKEEPING = ("timestamp", "frame_index", "episode_index", "index", "task_index")

_NOT_NUMERIC = ("image", "video", "string", "language")
CONVERTER = "lerobot.scripts.convert_dataset_v21_to_v30"
_MAX_INFO_BYTES = 64 * 2**20
_MAX_FEATURES = 10_000
MAX_SIGNAL_SIZE = 1024  # numbers a frame: more than that is a picture


class Feature(msgspec.Struct, frozen=True, dict=True):  # where `dim_names`, which everybody asks for, is kept
    """One thing that is stored for every frame.

    Attributes
    ----------
    dtype : str
        Name of a numpy dtype, or ``image``, ``video``, ``string``.
    shape : tuple of int
        Shape of one frame's value.
    names : object
        What the file gives as names of the dimensions: a list, a dict, or nothing. `dim_names` reads them.
    info, video_info : object
        What the file says of a camera; `z2r.format.about` reads it.
    """

    dtype: str
    shape: tuple[Annotated[int, msgspec.Meta(ge=0)], ...]
    names: Any = None
    info: Any = None
    video_info: Any = None

    @property
    def size(self) -> int:
        """How many numbers one frame holds."""
        return math.prod(self.shape)

    @property
    def is_numeric(self) -> bool:
        """Whether the values are numbers in the data files (not pictures or text)."""
        return not self.dtype.startswith(_NOT_NUMERIC)

    @cached_property
    def dim_names(self) -> tuple[str, ...]:
        """The name of each dimension; empty where the file does not give one for each."""
        return names_of(self.names, self.shape)

    @property
    def labels(self) -> tuple[str, ...]:
        """What to call each dimension: its name, or else its place, such as ``[2]``."""
        return self.dim_names or tuple(f"[{place}]" for place in range(self.size))

    def at(self, place: int) -> str:
        """Return how one dimension is written after the name of the feature; nothing where it is all there is.

        >>> Feature("float32", (2,), ["x", "y"]).at(1), Feature("float32", (2,)).at(1), Feature("bool", (1,)).at(0)
        ('[y]', '[1]', '')
        """
        return f"[{self.dim_names[place]}]" if self.dim_names else f"[{place}]" if self.size > 1 else ""

    def place(self, name: str) -> int:
        """Return where the dimension of a name stands.

        Raises
        ------
        ValueError
            If no dimension has this name, or two have: then nobody knows which one is meant.
        """
        dims = self.dim_names
        if dims.count(name) == 1:
            return dims.index(name)
        if name not in dims:
            raise ValueError(f"no dimension {name!r}: {', '.join(dims) or 'its dimensions have no names'}")
        places = [str(place) for place, each in enumerate(dims) if each == name]
        raise ValueError(f"{len(places)} dimensions are called {name!r}, at {', '.join(places)}: name one by its place")


def column_label(name: str, feature: Feature, column: int) -> str:
    """Name one dimension of a feature, as a finding does: by its name, or else by its place.

    >>> column_label("action", Feature("float32", (2,), ["x", "y"]), 1)
    'action[y]'
    >>> column_label("next.done", Feature("bool", (1,)), 0)
    'next.done'
    """
    if feature.dim_names:
        return f"{name}[{feature.dim_names[column]}]"
    return f"{name}[{column}]" if feature.size > 1 else name


class Schema(msgspec.Struct, frozen=True, dict=True):
    """The schema of a dataset, and the totals that it states.

    Attributes
    ----------
    codebase_version : str
        Version of the dataset format, such as ``v3.0``.
    fps : int or float
        Frames a second, from 1e-6 to 1e6: beyond, nothing that is recorded makes sense.
    total_episodes, total_frames : int
        What the file says; `z2r.format.episodes` holds it against the episode index.
    features : dict of str to Feature
        In the order of the file.
    data_path : str
        Template of a data file's path: ``data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet``.
    robot_type : object
        What the file says of the robot; `z2r.format.about` reads it.
    """

    codebase_version: str
    fps: Annotated[int, msgspec.Meta(ge=1, le=10**6)] | Annotated[float, msgspec.Meta(ge=1e-6, le=1e6)]
    total_episodes: Annotated[int, msgspec.Meta(ge=0)]
    total_frames: Annotated[int, msgspec.Meta(ge=0)]
    features: dict[str, Feature]
    data_path: str
    robot_type: Any = None

    def __repr__(self) -> str:
        return f"Schema({len(self.features)} features at {self.fps:g} fps)"

    def columns(self, feature: str, names: Sequence[str]) -> list[int]:
        """Find dimensions of a feature by their names.

        Parameters
        ----------
        feature : str
            Such as ``observation.state``.
        names : sequence of str
            Such as ``["sin_tee_yaw", "cos_tee_yaw"]``.

        Returns
        -------
        list of int
            Where each stands in the feature, in the order asked for.

        Raises
        ------
        ValueError
            If the feature or a name is not in the schema, where the message lists those that are; or a name comes
            twice.
        """
        if feature not in self.features:
            raise ValueError(f"no feature {feature!r} among {', '.join(self.features)}")
        try:
            return [self.features[feature].place(name) for name in names]
        except ValueError as error:
            raise ValueError(f"{feature}: {error}") from None

    def repeated(self) -> set[str]:
        """Return the names that stand for several dimensions of one signal, so that nobody knows which one is meant."""
        return {name for feature in self.signals().values() for name in repeated(feature.dim_names)}

    def signals(self) -> dict[str, Feature]:
        """Return the numeric features that the robot saw or did: all but the bookkeeping, pictures and depth maps."""
        return dict(self._signals)

    @cached_property
    def _signals(self) -> dict[str, Feature]:
        return {
            name: feature
            for name, feature in self.features.items()
            if feature.is_numeric and feature.size <= MAX_SIGNAL_SIZE and name not in BOOKKEEPING
        }


def is_for_a_policy(name: str) -> bool:
    """Tell whether LeRobot's policies see a feature, or do it (0.6.1, `lerobot/utils/feature_utils.py`).

    >>> [is_for_a_policy(name) for name in ("action", "observation.state", "next.reward")]
    [True, True, False]
    """
    return name == ACTION or name.startswith("observation.")


def read_schema(root: Path) -> Schema:
    """Read `meta/info.json`.

    Parameters
    ----------
    root : Path
        The folder of a LeRobot v3 dataset.

    Raises
    ------
    DatasetError
        If the folder or the file is missing, the file is not JSON, the format is not version 3, a field has the wrong
        type, or the path template does more than name a chunk and a file.
    """
    path = root / INFO_PATH
    raw = read_info(root)
    _check_version(_decode(raw, _Version, path).codebase_version, path)
    features = _decode(raw, _Features, path).features
    if len(features) > _MAX_FEATURES:
        raise DatasetError(Fault(path, "features", f"{len(features):,} features", f"at most {_MAX_FEATURES:,}"))
    for name, feature in features.items():
        _decode(feature, Feature, path, f"features.{name}")  # one by one, so that an error says which
    schema = _decode(raw, Schema, path)
    _check_template(schema.data_path, path)
    return schema


def data_file_path(schema: Schema, chunk_index: int, file_index: int) -> Path:
    """Return the path of one data file relative to the dataset, from the schema's template."""
    return Path(schema.data_path.format(chunk_index=chunk_index, file_index=file_index))


def read_info(root: Path) -> bytes:
    """Read the bytes of `meta/info.json`.

    Raises
    ------
    DatasetError
        If the folder or the file is missing, or it cannot be read.
    """
    path = inside(root, INFO_PATH)
    check_folder(root)
    return read_bytes(
        path, _MAX_INFO_BYTES, "the schema of a LeRobot dataset", "Name the folder that holds meta/ and data/"
    )


class _Version(msgspec.Struct):
    codebase_version: str


class _Features(msgspec.Struct):
    features: dict[str, msgspec.Raw]


def _decode[T](raw: bytes | msgspec.Raw, kind: type[T], path: Path, inside_field: str = "") -> T:
    try:
        return msgspec.json.decode(raw, type=kind)
    except msgspec.ValidationError as error:
        raise _wrong_value(bytes(raw), str(error), path, inside_field) from error
    except (msgspec.DecodeError, UnicodeDecodeError, RecursionError) as error:
        raise DatasetError(
            Fault(
                path,
                inside_field,
                f"broken JSON ({error})",
                "whole JSON",
                mend="Copy or download the file again",
            )
        ) from error


def _wrong_value(raw: bytes, message: str, path: Path, inside_field: str) -> DatasetError:
    """Turn msgspec's "Expected `int`, got `str` - at `$.fps`" into an error that shows the value."""
    what, _, where = message.partition(" - at `$")
    if missing := re.search("missing required field `(.*)`", what):
        field = ".".join(filter(None, [inside_field, missing[1]]))
        return DatasetError(Fault(path, field, "nothing", "this field"))
    field = (inside_field + where.rstrip("`")).lstrip(".")
    expected = what.removeprefix("Expected ").split(",")[0]
    return DatasetError(Fault(path, field, _excerpt(raw, re.findall(r"\.(\w+)", where)), expected))


def _excerpt(raw: bytes, keys: Sequence[str]) -> str:
    try:
        for key in keys:
            raw = bytes(msgspec.json.decode(raw, type=dict[str, msgspec.Raw])[key])
    except (msgspec.MsgspecError, RecursionError):
        return "something else"
    return raw[:60].decode(errors="replace")


def _check_version(version: str, path: Path) -> None:
    if version.startswith("v3."):
        return
    mend = _way_to_v3(in_full(path.parents[1]), version)
    raise DatasetError(Fault(path, "codebase_version", repr(version), "'v3.0' or a later v3", mend=mend))


def conversion(root: Path) -> str:
    """Return the command that converts a folder of format v2.1 where it is, and pushes nothing to the hub.

    The converter wants a name for what it would push, and never uses it here (lerobot 0.6.1,
    `lerobot/scripts/convert_dataset_v21_to_v30.py`).

    >>> print(conversion(Path("my data")))
    python -m lerobot.scripts.convert_dataset_v21_to_v30 --repo-id=my/own '--root=my data' --push-to-hub=false
    """
    return f"python -m {CONVERTER} --repo-id=my/own {shlex.quote(f'--root={root}')} --push-to-hub=false"


def _way_to_v3(root: Path, version: str) -> str:
    """Say how to convert an older dataset, and what of that does not go well."""
    if version == "v2.1":
        aside = root.with_name(f"{root.name}_old")
        if root.parent.name == "snapshots":
            return f"Copy it out of the cache (cp -rL), and convert the copy: {conversion(Path('COPY'))}"
        if exists(aside):
            return f"Move {aside} away, or the converter puts that in its place; then {conversion(root)}"
        return f"Convert it; the old one is kept as {aside.name}: {conversion(root)}"
    if version == "v2.0":
        return (
            "LeRobot 0.6.1 converts from v2.1 only. LeRobot 0.3.3 makes v2.1 of v2.0 (python -m"
            " lerobot.datasets.v21.convert_dataset_v20_to_v21), but only of a dataset on the hub, and pushes it there"
        )
    return ""


def _check_template(template: str, path: Path) -> None:
    """Let a template name its chunk and its file, zero-padded, and nothing else: `str.format` can do far more."""
    expected = "a path such as data/chunk-{chunk_index:03d}/file-{file_index:03d}.parquet"
    try:
        fields = [(name, spec, how) for _, name, spec, how in string.Formatter().parse(template) if name is not None]
    except ValueError:
        fields = [("", "", None)]
    plain = all(
        name in ("chunk_index", "file_index") and spec in ("", "d", "02d", "03d", "04d", "05d", "06d") and how is None
        for name, spec, how in fields
    )
    if not plain or Path(template).is_absolute() or ".." in Path(template).parts or "\0" in template:
        raise DatasetError(Fault(path, "data_path", repr(template), expected))
