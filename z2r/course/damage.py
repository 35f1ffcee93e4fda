"""What does a damaged dataset look like? Copies to look at: laid out in many files, or with one thing wrong.

The other functions change the folder that they are given, so they are given a copy. Nothing here is used to read a
dataset. Small datasets are meant: all frames are in memory at once.
"""

import shutil
from collections.abc import Callable, Mapping, Sequence
from functools import partial
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from numpy.typing import NDArray

from z2r.arrays import Ints
from z2r.format.dataset import Dataset, load
from z2r.format.episodes import EPISODES_DIR, DataFile, shard_paths
from z2r.format.schema import ACTION, INFO_PATH, STATE
from z2r.format.tables import STATS_PATH
from z2r.format.videos import video_features

_DATA_PATH = "data/chunk-{chunk_index:03d}/file-{file_index}.parquet"  # without zeros: file-10 sorts before file-9
_N_SHARDS = 3
# What becomes of a statistic when all values change their sign: minus the one named here.
_OPPOSITE = {"min": "max", "max": "min", "q01": "q99", "q10": "q90", "q90": "q10", "q99": "q01"}

type _Row = dict[str, Any]
type _Values = NDArray[np.float32]


def split(root: Path, out: Path, episodes_per_file: int = 1) -> Path:
    """Copy a dataset into many files, as a large recording has them.

    Data files are numbered without leading zeros, and there are three shards of episode metadata, or one for each
    episode where there are fewer. All else stays as it is, and is right.

    Parameters
    ----------
    root : Path
        The dataset, which is not written to.
    out : Path
        The copy, which must not exist yet, nor lie in `root`.
    episodes_per_file : int, optional
        How many episodes a data file holds.

    Returns
    -------
    Path
        `out`.

    Raises
    ------
    DatasetError
        If `root` is no whole dataset.
    FileExistsError
        If `out` exists.
    ValueError
        If `out` lies in `root`, or `episodes_per_file` is less than 1.
    """
    root, out = Path(root), Path(out)
    if out.resolve().is_relative_to(root.resolve()) or episodes_per_file < 1:
        raise ValueError(
            f"found {out} and {episodes_per_file} a file, expected a place outside of {root}, and 1 or more"
        )
    dataset = load(root)
    left_out = {root: {"data"}, root / EPISODES_DIR.parent: {EPISODES_DIR.name}}
    shutil.copytree(root, out, ignore=lambda folder, _: left_out.get(Path(folder), set()))
    file = np.arange(len(dataset.episodes)) // episodes_per_file
    _write_data(dataset, out, file)
    _write_shards(dataset, out, file)
    _edit_info(out, lambda info: info.update(data_path=_DATA_PATH))
    return out


def turn_half(root: Path) -> None:
    """Walk around the table by half a turn: every position, direction and velocity changes its sign.

    Nothing is damaged by that. The stored statistics are turned too.

    Parameters
    ----------
    root : Path
        A copy of a PushT dataset: it is written to.
    """
    for file in load(root).files:
        for feature in (STATE, ACTION):
            _edit_feature(file.path, feature, np.negative)
    path = root / STATS_PATH
    stats = msgspec.json.decode(path.read_bytes())
    turned = {feature: _negated(stats[feature]) for feature in (STATE, ACTION)}
    path.write_bytes(msgspec.json.encode(stats | turned))
    _edit_rows(root, _turn_row)


def record_badly(root: Path, out: Path) -> Path:
    """Copy the recording of an arm, as three mistakes of its owner would have left it.

    The follower's ``elbow_flex.pos`` is measured in radians. Every command is stored five frames after it was sent. The
    last camera had its cap on. The stored statistics are those of a recorder, which saw nothing else.

    Parameters
    ----------
    root : Path
        The dataset of an arm whose joints are in degrees, with videos in h264; it is not written to.
    out : Path
        The copy. What was there before is gone.

    Returns
    -------
    Path
        `out`.
    """
    root, out = Path(root), Path(out)
    if out.exists():
        load(out)  # so that nothing but a dataset is ever removed
        shutil.rmtree(out)
    shutil.copytree(root, out)
    dataset = load(out)
    [elbow] = dataset.schema.columns(STATE, ["elbow_flex.pos"])
    for file in dataset.files:
        _edit_feature(file.path, STATE, partial(_in_radians, elbow))
        _edit_feature(file.path, ACTION, partial(_held_back, _ranges(dataset, file), 5))
    camera = video_features(dataset.schema)[-1]
    for path in sorted((out / "videos" / camera).rglob("*.mp4")):
        _blacken(path)
    _renew_statistics(load(out), (STATE, ACTION), camera)
    return out


def _in_radians(column: int, values: _Values) -> _Values:
    values[:, column] = np.deg2rad(values[:, column])
    return values


def _held_back(ranges: Sequence[tuple[int, int]], by: int, values: _Values) -> _Values:
    """Store each row so many rows later, within its range; the first one waits."""
    rows = np.concatenate([np.maximum(np.arange(start, stop) - by, start) for start, stop in ranges])
    held: _Values = values[rows]
    return held


def _blacken(path: Path) -> None:
    """Write a video anew, with as many pictures, all of them black."""
    import av  # of the extra `video`, which nothing else here needs

    with av.open(str(path)) as film:
        own = film.streams.video[0]
        n, rate, width, height = own.frames, own.average_rate, own.width, own.height
    black = av.VideoFrame.from_ndarray(np.zeros((height, width, 3), dtype=np.uint8), format="rgb24")
    with av.open(str(path), "w") as film:
        stream = film.add_stream("libx264", rate=rate, options={"g": "2", "preset": "ultrafast"})
        stream.width, stream.height, stream.pix_fmt = width, height, "yuv420p"
        for number in range(n):
            black.pts = number
            film.mux(stream.encode(black))
        film.mux(stream.encode())


def _renew_statistics(dataset: Dataset, features: Sequence[str], camera: str) -> None:
    """Write the statistics of these features anew, those of the dataset and of each episode; a camera's become 0."""
    values = {feature: dataset.read(feature).astype(np.float64) for feature in features}
    path = dataset.root / STATS_PATH
    stats = msgspec.json.decode(path.read_bytes())
    for feature in features:
        stats[feature] |= _statistics(values[feature])
    stats[camera] = {kind: own if kind == "count" else _zeros(own) for kind, own in stats[camera].items()}
    path.write_bytes(msgspec.json.encode(stats))

    def renew(row: _Row) -> None:
        part = dataset.episodes[row["episode_index"]]
        for feature in features:
            row |= {f"stats/{feature}/{kind}": own for kind, own in _statistics(values[feature][part]).items()}
        dark = (name for name in row if name.startswith(f"stats/{camera}/") and not name.endswith("/count"))
        row |= {name: _zeros(row[name]) for name in dark}

    _edit_rows(dataset.root, renew)


def _statistics(values: NDArray[np.float64]) -> dict[str, list[float]]:
    """Return what LeRobot stores of the values of a feature, (n, size)."""
    plain = {kind: getattr(values, kind)(axis=0) for kind in ("min", "max", "mean", "std")}
    quantiles = {f"q{share:02d}": np.quantile(values, share / 100, axis=0) for share in (1, 10, 50, 90, 99)}
    return {kind: own.tolist() for kind, own in (plain | quantiles).items()}


def _zeros(nested: Any) -> Any:
    return [_zeros(each) for each in nested] if isinstance(nested, list) else 0.0


def _ranges(dataset: Dataset, file: DataFile) -> list[tuple[int, int]]:
    """Which rows of a file belong to the same episode."""
    starts, stops = dataset.episodes.from_index, dataset.episodes.to_index
    here = (starts >= file.from_index) & (stops <= file.to_index)
    first = file.from_index
    return [
        (start - first, stop - first) for start, stop in zip(starts[here].tolist(), stops[here].tolist(), strict=True)
    ]


def _write_data(dataset: Dataset, out: Path, file: Ints) -> None:
    frames = pa.concat_tables([pq.ParquetFile(each.path).read() for each in dataset.files])
    for number in range(file[-1] + 1):
        inside = file == number
        start, stop = dataset.episodes.from_index[inside][0], dataset.episodes.to_index[inside][-1]
        _write(frames.slice(start, stop - start), out / _DATA_PATH.format(chunk_index=0, file_index=number))


def _write_shards(dataset: Dataset, out: Path, file: Ints) -> None:
    shards = [pq.ParquetFile(path).read() for path in shard_paths(dataset.root)]
    rows, schema = [row for shard in shards for row in shard.to_pylist()], shards[0].schema
    parts = np.array_split(np.arange(len(rows)), min(_N_SHARDS, len(rows)))
    for number, part in enumerate(parts):
        here = [rows[episode] | _pointers(int(file[episode]), number) for episode in part.tolist()]
        path = out / EPISODES_DIR / "chunk-000" / f"file-{number:03d}.parquet"
        _write(pa.Table.from_pylist(here, schema=schema), path)


def _pointers(file: int, shard: int) -> _Row:
    """Where an episode is, in the metadata's own words."""
    return {
        "data/chunk_index": 0,
        "data/file_index": file,
        "meta/episodes/chunk_index": 0,
        "meta/episodes/file_index": shard,
    }


def _write(table: pa.Table, path: Path) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    pq.write_table(table, path)


def _edit_info(root: Path, edit: Callable[[_Row], None]) -> None:
    path = root / INFO_PATH
    info = msgspec.json.decode(path.read_bytes())
    edit(info)
    path.write_bytes(msgspec.json.format(msgspec.json.encode(info), indent=4))


def _edit_rows(root: Path, edit: Callable[[_Row], None]) -> None:
    """Edit the metadata of each episode."""
    for path in shard_paths(root):
        table = pq.ParquetFile(path).read()
        rows = table.to_pylist()
        for row in rows:
            edit(row)
        pq.write_table(pa.Table.from_pylist(rows, schema=table.schema), path)


def _edit_feature(path: Path, feature: str, edit: Callable[[_Values], _Values]) -> None:
    """Edit the values of one feature in a data file, (n_rows, size)."""
    table = pq.ParquetFile(path).read()
    place = table.schema.get_field_index(feature)
    values = edit(np.array(table.column(place).to_pylist(), dtype=np.float32))
    field = table.schema.field(place)
    pq.write_table(table.set_column(place, field, pa.array(values.tolist(), type=field.type)), path)


def _turn_row(row: _Row) -> None:
    """Turn the statistics of one episode, which are stored beside its range."""
    for feature in (STATE, ACTION):
        prefix = f"stats/{feature}/"
        stats = {name.removeprefix(prefix): row[name] for name in row if name.startswith(prefix)}
        row.update({prefix + kind: values for kind, values in _negated(stats).items()})


def _negated(stats: Mapping[str, Sequence[float]]) -> dict[str, Sequence[float]]:
    """Return the statistics of minus the values."""
    same = {kind: stats[kind] for kind in ("std", "count") if kind in stats}
    return {kind: [-value for value in stats[_OPPOSITE.get(kind, kind)]] for kind in stats} | same
