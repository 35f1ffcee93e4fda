"""Datasets with cameras: a hand wanders over a table, by fits and starts, and every camera films it.

They are laid out by hand as lerobot 0.6.1 does it: for each camera a video, in which the episodes come one after
another. `test_cameras.py` shows that LeRobotDataset reads them, and that of what it writes itself nothing is said.
"""

import io
import json
from collections.abc import Callable, Iterator, Sequence
from pathlib import Path

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


def write_filmed(
    root: Path,
    film: Film = film,
    *,
    cameras: Sequence[str] = CAMERAS,
    lengths: Sequence[int] = LENGTHS,
    files: Sequence[int] | None = None,
    codec: str = "libx264",
) -> None:
    """Write a dataset in which every episode is filmed; `files` says how many episodes each video holds."""
    states = [wander(episode, n_frames) for episode, n_frames in enumerate(lengths)]
    frames = {"observation.state": np.concatenate(states), "action": np.concatenate(states)}
    names = {"dtype": "float32", "shape": [2], "names": ["x", "y"]}
    features = {"observation.state": names, "action": names, **dict.fromkeys(cameras, SEEN)}
    layout = Layout(files=[len(lengths)], shards=[len(lengths)], episode_stats=True)
    write_dataset(root, frames, lengths, layout, features=features | BOOKKEEPING, video_path=VIDEO_PATH)
    files = [len(lengths)] if files is None else files
    for camera in cameras:
        point_at_videos(root, camera, lengths, files)
        first = 0
        for number, n_episodes in enumerate(files):
            own = range(first, first + n_episodes)
            pictures = [list(film(camera, episode, states[episode])) for episode in own]
            write_video(video(root, camera, number), pictures, codec)
            first += n_episodes


def write_photographed(root: Path, film: Film = film, kind: str = "png") -> None:
    """Write a dataset whose pictures stand in the data file, as a PNG or JPEG in each row."""
    write_filmed(root, film, cameras=())
    info = json.loads((root / "meta/info.json").read_text())
    info["features"] |= dict.fromkeys(CAMERAS, SEEN | {"dtype": "image"})
    (root / "meta/info.json").write_text(json.dumps(info))
    [path] = data_files(root)
    table = pq.read_table(path)
    for camera in CAMERAS:
        states = (wander(episode, n_frames) for episode, n_frames in enumerate(LENGTHS))
        pictures = (picture for episode, own in enumerate(states) for picture in film(camera, episode, own))
        rows = [{"bytes": encoded(picture, kind), "path": f"{row}.{kind}"} for row, picture in enumerate(pictures)]
        table = table.append_column(camera, pa.array(rows, pa.struct({"bytes": pa.binary(), "path": pa.string()})))
    pq.write_table(table, path, row_group_size=100)


def encoded(picture: np.ndarray, kind: str = "png") -> bytes:
    """Return a picture as a PNG, as LeRobot stores it, or as another kind."""
    file = io.BytesIO()
    Image.fromarray(picture).save(file, kind, compress_level=6)
    return file.getvalue()


def point_at_videos(root: Path, camera: str, lengths: Sequence[int], files: Sequence[int]) -> None:
    """Let the metadata say which video each episode is in, and from when to when."""
    number = np.repeat(np.arange(len(files)), files)
    stop = np.concatenate([np.cumsum(part) for part in np.split(np.asarray(lengths), np.cumsum(files)[:-1])]) / FPS
    columns = {"chunk_index": 0 * number, "file_index": number}
    columns |= {"from_timestamp": stop - np.asarray(lengths) / FPS, "to_timestamp": stop}
    [path] = shard_files(root)
    table = pq.read_table(path)
    for key, values in columns.items():
        table = table.append_column(f"videos/{camera}/{key}", pa.array(values))
    pq.write_table(table, path)


def video(root: Path, camera: str, number: int = 0) -> Path:
    return root / VIDEO_PATH.format(video_key=camera, chunk_index=0, file_index=number)


def write_video(
    path: Path, episodes: Sequence[Sequence[np.ndarray]], codec: str = "libx264", fps: float = FPS, **options: str
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
                frame.pict_type = av.video.frame.PictureType.NONE if number else av.video.frame.PictureType.I
                file.mux(stream.encode(frame))
        file.mux(stream.encode())
