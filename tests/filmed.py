"""Datasets with cameras: a hand wanders over a table, by fits and starts, and every camera films it.

They are laid out by hand as lerobot 0.6.1 does it: for each camera a video, in which the episodes come one after
another. `test_cameras.py` shows that LeRobotDataset reads them, and that of what it writes itself nothing is said.
"""

import io
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import av
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from layouts import BOOKKEEPING, Layout, data_files, shard_files, write_dataset
from PIL import Image

FPS = 10  # that of `layouts`
SIZE = (72, 96)
LENGTHS = (60, 72, 56, 64, 60, 68, 60, 52)
FRONT, SIDE = CAMERAS = ("observation.images.front", "observation.images.side")
SEEN = {"dtype": "video", "shape": [*SIZE, 3], "names": ["height", "width", "channels"]}
VIDEO_PATH = "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4"

type Film = Callable[[str, int, np.ndarray], Iterator[np.ndarray]]
"""Yields the pictures of a camera in an episode with these states: uint8[height, width, 3]."""


def wander(episode: int, n_frames: int) -> np.ndarray:
    """Where the hand is: float32[n_frames, 2], in [-1, 1]."""
    rng = np.random.default_rng(episode)
    awake = np.repeat(rng.random(n_frames // 6 + 1) < 0.5, 6)[:n_frames]
    awake[: n_frames // 4] |= ~awake[: n_frames // 4].any()
    turn = np.cumsum(rng.normal(0, 0.3, n_frames)) + rng.uniform(0, 6)
    way = rng.uniform(-1, 1, 2) + np.cumsum(0.12 * awake[:, None] * np.stack([np.cos(turn), np.sin(turn)], 1), axis=0)
    return (1 - np.abs(np.mod(way + 1, 4) - 2)).astype(np.float32)  # the walls throw it back


def film(camera: str, episode: int, states: np.ndarray) -> Iterator[np.ndarray]:
    """Film the hand over a table, with the noise of a sensor; each camera has its own table, and its own angle."""
    height, width = SIZE
    of_camera, of_episode = (np.random.default_rng([CAMERAS.index(camera), number]) for number in (0, episode))
    table = of_camera.integers(60, 190, (height // 8, width // 8, 3)).repeat(8, 0).repeat(8, 1)
    places = (states if camera == FRONT else states[:, ::-1] * 0.8) * 0.5 + 0.5
    for x, y in places:
        picture = table + of_episode.normal(0, 2, table.shape)
        row, column = round(y * (height - 16)), round(x * (width - 16))
        picture[row : row + 16, column : column + 16] = (250, 30, 30)
        yield picture.clip(0, 255).astype(np.uint8)


def write_filmed(root: Path, film: Film = film, rests: int | None = None, **how: Any) -> None:
    """Write a dataset in which every episode is filmed, as `shoot` does; in one of them, the hand may rest."""
    _write_states(root, _states(rests), SEEN)
    for camera in CAMERAS:
        shoot(root, camera, film, rests=rests, **how)


def shoot(
    root: Path,
    camera: str,
    film: Film = film,
    *,
    files: Sequence[int] = (len(LENGTHS),),
    codec: str = "libx264",
    rests: int | None = None,
) -> None:
    """Film all episodes with one camera; `files` says how many of them each video holds."""
    _point_at_videos(root, camera, files)
    episodes = [list(film(camera, episode, states)) for episode, states in enumerate(_states(rests))]
    ends = np.cumsum(files).tolist()
    for number, (first, end) in enumerate(pairwise([0, *ends])):
        write_video(video(root, camera, number), episodes[first:end], codec)


def write_photographed(root: Path, film: Film = film, kind: str = "png") -> None:
    """Write a dataset whose pictures stand in the data file, as a PNG or JPEG in each row."""
    _write_states(root, _states(), SEEN | {"dtype": "image"})
    for camera in CAMERAS:
        photograph(root, camera, film, kind)


def photograph(root: Path, camera: str, film: Film = film, kind: str = "png") -> None:
    """Take the pictures of one camera."""
    pictures = (picture for episode, states in enumerate(_states()) for picture in film(camera, episode, states))
    rows = [{"bytes": encoded(picture, kind), "path": f"{row}.{kind}"} for row, picture in enumerate(pictures)]
    [path] = data_files(root)
    table = pq.read_table(path)
    column = pa.array(rows, pa.struct({"bytes": pa.binary(), "path": pa.string()}))
    others = table.drop_columns([camera] if camera in table.column_names else [])
    pq.write_table(others.append_column(camera, column), path, row_group_size=100)


def encoded(picture: np.ndarray, kind: str = "png") -> bytes:
    """Return a picture as a PNG, as LeRobot stores it, or as another kind."""
    file = io.BytesIO()
    Image.fromarray(picture).save(file, kind, compress_level=6)
    return file.getvalue()


def video(root: Path, camera: str, number: int = 0) -> Path:
    return root / VIDEO_PATH.format(video_key=camera, chunk_index=0, file_index=number)


def write_video(
    path: Path,
    episodes: Sequence[Sequence[np.ndarray]],
    codec: str = "libx264",
    fps: float = FPS,
    *,
    forced: bool = True,
    **options: str,
) -> None:
    """Encode pictures as LeRobot does: every second picture stands alone, and so does the first of each episode."""
    path.parent.mkdir(parents=True, exist_ok=True)
    with av.open(path, "w", options={"movflags": "faststart"}) as file:
        stream = file.add_stream(codec, fps, options={"g": "2", "crf": "30"} | options)
        stream.pix_fmt = "yuv420p"
        stream.height, stream.width = episodes[0][0].shape[:2]
        for pictures in episodes:
            for number, picture in enumerate(pictures):
                frame = av.VideoFrame.from_ndarray(picture)
                is_first = forced and number == 0
                frame.pict_type = av.video.frame.PictureType.I if is_first else av.video.frame.PictureType.NONE
                file.mux(stream.encode(frame))
        file.mux(stream.encode())


def _states(rests: int | None = None) -> list[np.ndarray]:
    states = [wander(episode, n_frames) for episode, n_frames in enumerate(LENGTHS)]
    noise = np.random.default_rng(0).normal(0, 1e-3, (max(LENGTHS), 2)).astype(np.float32)
    return [own[:1] + noise[: len(own)] if episode == rests else own for episode, own in enumerate(states)]


def _write_states(root: Path, states: Sequence[np.ndarray], seen: dict[str, Any]) -> None:
    ahead = [np.concatenate([own[2:], own[-1:].repeat(2, 0)]) for own in states]  # a command comes before its motion
    frames = {"observation.state": np.concatenate(states), "action": np.concatenate(ahead)}
    features = {name: {"dtype": "float32", "shape": [2], "names": ["x", "y"]} for name in frames}
    features |= dict.fromkeys(CAMERAS, seen) | BOOKKEEPING
    layout = Layout(files=[len(states)], shards=[len(states)], episode_stats=True)
    write_dataset(root, frames, LENGTHS, layout, features=features, video_path=VIDEO_PATH)


def _point_at_videos(root: Path, camera: str, files: Sequence[int]) -> None:
    """Let the metadata say which video each episode is in, and from when to when."""
    number, lengths = np.repeat(np.arange(len(files)), files), np.asarray(LENGTHS)
    stop = np.concatenate([np.cumsum(part) for part in np.split(lengths, np.cumsum(files)[:-1])]) / FPS
    columns = {"chunk_index": 0 * number, "file_index": number, "from_timestamp": stop - lengths / FPS}
    [path] = shard_files(root)
    table = pq.read_table(path)
    for key, values in (columns | {"to_timestamp": stop}).items():
        name = f"videos/{camera}/{key}"
        table = table.drop_columns([name] if name in table.column_names else [])
        table = table.append_column(name, pa.array(values))
    pq.write_table(table, path)
