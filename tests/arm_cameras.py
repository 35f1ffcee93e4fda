"""An arm that is filmed by two cameras, and what goes wrong with pictures and their files.

The pictures are drawn: a side view and a view from above of the arm that the state tells of, and of the thing that it
moves, so that what is seen goes with what is stored. A fault is a function of any folder with videos: it decodes them,
changes the frames, and writes them as LeRobot does, with spans and statistics that agree; or it harms the files.
"""

import json
import shutil
import tempfile
from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import Any

import av
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
from arm_damages import ALL, EVERY, HALF, ONE, WIDE, Case, Kind, Place, Rng, case_of, choose, rng_of
from arms import ACTION, CUBE, FORE, STATE, TASK, UPPER, Operator, Recording, so101, write
from layouts import STATS_PATH, Frames, read_dataset, shard_files

SIDE, TOP = "observation.images.side", "observation.images.top"
VIDEO_PATH = "videos/{video_key}/chunk-{chunk_index:03d}/file-{file_index:03d}.mp4"
FPS, HEIGHT, WIDTH = 15, 64, 96
ENCODERS = {"h264": "libx264", "av1": "libsvtav1"}

type Film = dict[str, list[np.ndarray]]
"""Of each camera, the pictures of each episode, (n, height, width, 3), uint8."""


# --- what the cameras see


def film(recording: Recording, seed: int) -> Film:
    """Draw an arm from the side and from above."""
    rng = np.random.default_rng([seed, 96])
    scenes = {name: scenery(rng, name) for name in (SIDE, TOP)}
    return {name: [draw(own, name, scenes[name], rng) for own in recording.episodes] for name in scenes}


def scenery(rng: Rng, camera: str) -> np.ndarray:
    """A wall and a table, or the table alone, with some grain: (height, width, 3)."""
    rows = np.linspace(0, 1, HEIGHT)[:, None, None]
    wall, table = np.array([150, 160, 170]) - 40 * rows, np.array([120, 95, 70]) + 30 * rows
    picture = np.where((rows > 0.7) | (camera == TOP), table, wall) + np.zeros((HEIGHT, WIDTH, 3))
    patches = np.kron(rng.normal(0, 12, (HEIGHT // 8, WIDTH // 8, 1)), np.ones((8, 8, 1)))
    return picture + patches + rng.normal(0, 3, picture.shape)


def draw(own: Frames, camera: str, scene: np.ndarray, rng: Rng) -> np.ndarray:
    """The pictures of one episode."""
    points, thing = places(own)
    to_pixels = from_the_side if camera == SIDE else from_above
    points, thing = to_pixels(points), to_pixels(thing)
    pictures = np.repeat(scene[None].astype(np.float32), len(points), axis=0) * np.float32(rng.uniform(0.93, 1.07))
    for colour, width, (start, stop) in (
        ((40, 40, 45), 2.6, (0, 1)),
        ((215, 190, 60), 2.1, (1, 2)),
        ((60, 150, 90), 1.5, (2, 3)),
    ):
        pictures[along(points[:, start], points[:, stop]) < width] = colour
    pictures[along(thing, thing) < 2.8] = (200, 70, 40)
    return np.clip(pictures + 2 * rng.standard_normal(pictures.shape, np.float32), 0, 255).astype(np.uint8)


def places(own: Frames) -> tuple[np.ndarray, np.ndarray]:
    """Shoulder, elbow, wrist and tip (n, 4, 3) and the thing (n, 3), in m."""
    pan, lift, elbow, flex = np.radians(own[STATE][:, :4]).T
    bends, lengths = np.cumsum([lift, np.pi / 2 + elbow, flex], axis=0), (UPPER, FORE, 0.05)
    far = np.cumsum([0 * lift, *(length * np.sin(bend) for length, bend in zip(lengths, bends, strict=True))], axis=0)
    high = np.cumsum([0 * lift, *(length * np.cos(bend) for length, bend in zip(lengths, bends, strict=True))], axis=0)
    points = np.stack([far * np.cos(pan), far * np.sin(pan), high], axis=2).swapaxes(0, 1)
    opened = own[ACTION][:, 5] > 40
    changes = np.flatnonzero(np.diff(opened))
    taken, left = (changes[1] + 8, changes[2] + 4) if len(changes) > 2 else (len(pan), len(pan))
    when = np.clip(np.arange(len(pan)), taken, max(taken, min(left, len(pan) - 1))).clip(max=len(pan) - 1)
    return points, points[when, 3]


def from_the_side(points: np.ndarray) -> np.ndarray:
    return np.stack([26 + 230 * points[..., 0], 42 - 200 * points[..., 2]], axis=-1)


def from_above(points: np.ndarray) -> np.ndarray:
    return np.stack([48 - 190 * points[..., 1], 58 - 190 * points[..., 0]], axis=-1)


def along(start: np.ndarray, stop: np.ndarray) -> np.ndarray:
    """How far each pixel is from a line between two pixels (n, 2): (n, height, width)."""
    start, stop = start.astype(np.float32), stop.astype(np.float32)
    columns, rows = np.arange(WIDTH, dtype=np.float32)[None, None], np.arange(HEIGHT, dtype=np.float32)[None, :, None]
    x, y = columns - start[:, 0, None, None], rows - start[:, 1, None, None]
    dx, dy = (stop - start).T[..., None, None]
    share = np.clip((x * dx + y * dy) / np.maximum(dx**2 + dy**2, 1e-9), 0, 1)
    return np.sqrt((x - share * dx) ** 2 + (y - share * dy) ** 2)


# --- a folder with videos


def write_filmed(root: Path, seed: int = 0, codec: str = "h264", files: Sequence[int] = (4, 4)) -> None:
    """Write an SO-101 that two cameras film: 8 episodes at 15 fps, so many of them in each file."""
    operator = Operator(speed=170, pause=0.2, rest=(0.3, 0.6))
    recording = so101(seed + 5000, n=sum(files), fps=FPS, tasks=(CUBE,), operator=operator)
    write(recording, root)
    declare(root, codec)
    put_spans(root, {name: list(np.repeat(np.arange(len(files)), files)) for name in (SIDE, TOP)})
    write_film(root, film(recording, seed))


def declare(root: Path, codec: str) -> None:
    """Name the two cameras in `meta/info.json`, as LeRobot 0.6.1 does."""
    about = {"height": HEIGHT, "width": WIDTH, "codec": codec, "pix_fmt": "yuv420p", "is_depth_map": False}
    about = {f"video.{key}": value for key, value in (about | {"fps": FPS, "channels": 3}).items()}
    feature = {"dtype": "video", "shape": [HEIGHT, WIDTH, 3], "names": ["height", "width", "channels"]}
    info = read_info(root)
    info["features"] |= {name: feature | {"info": about | {"has_audio": False}} for name in (SIDE, TOP)}
    write_info(root, info | {"video_path": VIDEO_PATH})


def read_info(root: Path) -> dict[str, Any]:
    return json.loads((root / "meta/info.json").read_text())


def write_info(root: Path, info: dict[str, Any]) -> None:
    (root / "meta/info.json").write_text(json.dumps(info, indent=4))


def cameras(root: Path) -> list[str]:
    return [name for name, feature in read_info(root)["features"].items() if feature["dtype"] == "video"]


def column(root: Path, name: str) -> list[Any]:
    """A column of the episode metadata."""
    return [value for path in shard_files(root) for value in pq.read_table(path, columns=[name])[name].to_pylist()]


def put_columns(root: Path, columns: dict[str, list[Any]]) -> None:
    """Set columns of the episode metadata, those that are there and others."""
    first = 0
    for path in shard_files(root):
        table = pq.ParquetFile(path).read()
        for name, values in columns.items():
            own = pa.array(values[first : first + len(table)])
            known = name in table.column_names
            table = (
                table.set_column(table.column_names.index(name), name, own) if known else table.append_column(name, own)
            )
        first += len(table)
        pq.write_table(table, path)


def put_spans(root: Path, files: dict[str, list[int]]) -> None:
    """Say in which file each episode is, and from when to when, where they follow each other without a gap."""
    seconds = np.array(column(root, "length")) / read_info(root)["fps"]
    for name, numbers in files.items():
        stops = np.concatenate([np.cumsum(seconds[np.equal(numbers, number)]) for number in dict.fromkeys(numbers)])
        spans = {
            "chunk_index": [0] * len(numbers),
            "file_index": [int(number) for number in numbers],
            "from_timestamp": (stops - seconds).tolist(),
            "to_timestamp": stops.tolist(),
        }
        put_columns(root, {f"videos/{name}/{key}": values for key, values in spans.items()})


def video_files(root: Path, camera: str) -> list[Path]:
    """Of each episode, the file that its pictures are in."""
    numbers = zip(*(column(root, f"videos/{camera}/{key}_index") for key in ("chunk", "file")), strict=True)
    template = read_info(root)["video_path"]
    return [root / template.format(video_key=camera, chunk_index=chunk, file_index=file) for chunk, file in numbers]


def read_film(root: Path, camera: str) -> list[np.ndarray]:
    """Decode the pictures of a camera, episode by episode."""
    starts, lengths = column(root, f"videos/{camera}/from_timestamp"), column(root, "length")
    fps, decoded = read_info(root)["fps"], {}
    episodes = []
    for path, start, length in zip(video_files(root, camera), starts, lengths, strict=True):
        if path not in decoded:
            with av.open(str(path)) as container:
                decoded[path] = np.stack([frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)])
        first = round(start * fps)
        episodes.append(decoded[path][first : first + length])
    return episodes


def write_film(root: Path, pictures: Film) -> None:
    """Write the videos of some cameras, into the files that the metadata names, and their statistics."""
    info, statistics = read_info(root), json.loads((root / STATS_PATH).read_text())
    for camera, episodes in pictures.items():
        paths = video_files(root, camera)
        codec = info["features"][camera]["info"]["video.codec"]
        for path in dict.fromkeys(paths):
            own = [frames for frames, place in zip(episodes, paths, strict=True) if place == path]
            encode(path, np.concatenate(own), info["fps"], codec)
        statistics[camera] = picture_statistics(np.concatenate(episodes))
        rows = [picture_statistics(frames) for frames in episodes]
        put_columns(root, {f"stats/{camera}/{key}": [row[key] for row in rows] for key in rows[0]})
    (root / STATS_PATH).write_text(json.dumps(statistics))


def picture_statistics(frames: np.ndarray) -> dict[str, Any]:
    """What LeRobot says of pictures: of each channel, in 0 to 1, from a sample of the frames."""
    sample = frames[::4]
    channels = np.ascontiguousarray(sample.reshape(-1, 3).T)
    values = {key: getattr(channels, key)(axis=1) / 255 for key in ("min", "max", "mean", "std")}
    return {key: own.reshape(3, 1, 1).tolist() for key, own in values.items()} | {"count": [len(sample)]}


def encode(path: Path, frames: np.ndarray, fps: int, codec: str = "h264", keyframes: int = 2) -> None:
    """Write an mp4 whose every second frame is a key frame, as LeRobot does."""
    av.logging.set_level(av.logging.PANIC)
    path.parent.mkdir(parents=True, exist_ok=True)
    options = {"g": str(keyframes), "crf": "20", "preset": "ultrafast" if codec == "h264" else "10"}
    with av.open(str(path), "w") as container:
        stream = container.add_stream(ENCODERS[codec], rate=fps, options=options)
        stream.width, stream.height, stream.pix_fmt = frames.shape[2], frames.shape[1], "yuv420p"
        for picture in frames:
            container.mux(stream.encode(av.VideoFrame.from_ndarray(picture, format="rgb24")))
        container.mux(stream.encode())


def read_recording(root: Path) -> Recording:
    """What a folder holds, but for its pictures."""
    info, (frames, lengths) = read_info(root), read_dataset(root)
    episodes = [
        {name: frames[name][stop - length : stop] for name in (STATE, ACTION, TASK)}
        for length, stop in zip(lengths, np.cumsum(lengths), strict=True)
    ]
    names = {name: info["features"][name]["names"] for name in (STATE, ACTION)}
    return Recording(info["robot_type"], info["fps"], names, episodes, [])


@cache
def _filmed(seed: int) -> Path:
    root = Path(tempfile.mkdtemp(prefix="filmed-")) / "dataset"
    write_filmed(root, seed)
    return root


def copy_filmed(root: Path, seed: int = 0) -> None:
    """Write what `write_filmed` writes, which is made only once."""
    shutil.copytree(_filmed(seed), root)


def write_camera_case(name: str, variant: str, root: Path, seed: int = 0) -> Case:
    """Write a filmed arm with a fault, and say what is in it."""
    copy_filmed(root, seed)
    return harm(name, variant, root, seed)


def harm(name: str, variant: str, root: Path, seed: int = 0) -> Case:
    """Plant a fault in any folder whose videos are whole; what is `TOP` in the table is the last of its cameras."""
    kind, rng = CAMERA_KINDS[name], rng_of(name, variant, seed)
    called = {SIDE: cameras(root)[0], TOP: last_camera(root)}
    kind = replace(kind, names=tuple(called.get(name, name) for name in kind.names))
    recording = read_recording(root)
    places = choose(recording, kind, variant, rng)
    paths = video_files(root, last_camera(root))
    kind.do(root, places, rng)
    if name not in ON_VIDEO_FILES:
        return case_of(kind, variant, recording, places)
    own = paths[places[0].episode]
    places = [Place(episode, slice(0, 0)) for episode, path in enumerate(paths) if path == own]
    return replace(case_of(kind, variant, recording, places), file=own.relative_to(root).as_posix())


# --- how faults are planted

type Change = Callable[[np.ndarray, Rng], np.ndarray]
type OnFolder = Callable[[Path, Sequence[Place], Rng], object]


def seen(change: Change, every: bool = False) -> OnFolder:
    """Change the pictures (n, height, width, 3) of the last camera, or of every one, at each place."""

    def do(root: Path, places: Sequence[Place], rng: Rng) -> None:
        names = cameras(root) if every else [last_camera(root)]
        pictures = {name: [own.copy() for own in read_film(root, name)] for name in names}
        for own in pictures.values():
            for episode, rows in places:
                own[episode][rows] = change(own[episode][rows], rng)
        write_film(root, pictures)

    return do


def last_camera(root: Path) -> str:
    return cameras(root)[-1]


def filmed(change: Callable[[Film, Sequence[Place], Rng], object]) -> OnFolder:
    """Change the pictures of all cameras, of which each may look at the others."""

    def do(root: Path, places: Sequence[Place], rng: Rng) -> None:
        pictures = {name: [own.copy() for own in read_film(root, name)] for name in cameras(root)}
        change(pictures, places, rng)
        write_film(root, pictures)

    return do


def black(own: np.ndarray, rng: Rng) -> np.ndarray:
    return own * 0


def filled(*colour: int) -> Change:
    return lambda own, rng: own * 0 + np.array(colour, np.uint8)


def held(own: np.ndarray, rng: Rng) -> np.ndarray:
    return np.repeat(own[:1], len(own), axis=0)


def held_from_the_middle(own: np.ndarray, rng: Rng) -> np.ndarray:
    return own[np.minimum(np.arange(len(own)), len(own) // 2)]


def late(by: int) -> Change:
    return lambda own, rng: own[np.clip(np.arange(len(own)) - by, 0, len(own) - 1)]


def drifting(own: np.ndarray, rng: Rng) -> np.ndarray:
    """The camera runs at 14 frames a second where 15 are stored: 0 to half a second late, or more."""
    return own[(np.arange(len(own)) * 14 // 15)]


def each_third(own: np.ndarray, rng: Rng) -> np.ndarray:
    return own[np.arange(len(own)) // 3 * 3]


def bright(factor: float) -> Change:
    return lambda own, rng: np.clip(own * factor, 0, 255).astype(np.uint8)


def grey(own: np.ndarray, rng: Rng) -> np.ndarray:
    return np.repeat(own.mean(axis=3, keepdims=True).astype(np.uint8), 3, axis=3)


def upside_down(own: np.ndarray, rng: Rng) -> np.ndarray:
    return own[:, ::-1, ::-1]


def mirrored(own: np.ndarray, rng: Rng) -> np.ndarray:
    return own[:, :, ::-1]


def blue_for_red(own: np.ndarray, rng: Rng) -> np.ndarray:
    return own[..., ::-1]


def blurred(own: np.ndarray, rng: Rng) -> np.ndarray:
    shifts = [np.roll(own.astype(float), (dy, dx), (1, 2)) for dy in range(-3, 4) for dx in range(-3, 4)]
    return np.mean(shifts, axis=0).astype(np.uint8)


def moved(own: np.ndarray, rng: Rng) -> np.ndarray:
    """The camera was pushed: what it sees lies 14 pixels further to the right."""
    return own[:, :, np.clip(np.arange(own.shape[2]) - 14, 0, None)]


def half_covered(own: np.ndarray, rng: Rng) -> np.ndarray:
    own = own.copy()
    own[:, :, own.shape[2] // 2 :] = 12
    return own


def boxed(own: np.ndarray, rng: Rng) -> np.ndarray:
    """Black bars above and below: made to fit by a resize."""
    own, n = own.copy(), own.shape[1] // 6
    own[:, n:-n] = own[:, np.linspace(0, own.shape[1] - 1, own.shape[1] - 2 * n).astype(int)]
    own[:, :n] = own[:, -n:] = 0
    return own


def torn(own: np.ndarray, rng: Rng) -> np.ndarray:
    """The lower half of each frame is of half a second before."""
    half = own.shape[1] // 2
    return np.concatenate([own[:, :half], late(7)(own, rng)[:, half:]], axis=1)


def green_flashes(own: np.ndarray, rng: Rng) -> np.ndarray:
    """Single frames that a decoder could not make sense of."""
    own = own.copy()
    own[rng.choice(np.arange(1, len(own) - 1), max(1, len(own) // 30), replace=False)] = (0, 135, 0)
    return own


def as_they_were_ready(own: np.ndarray, rng: Rng) -> np.ndarray:
    """Of three threads that write pictures, the last is always the first to be ready."""
    order = np.arange(len(own))
    whole = order[: len(own) // 3 * 3].reshape(-1, 3)
    whole[:] = whole[:, [2, 0, 1]]
    return own[order]


def under_lamps(own: np.ndarray, rng: Rng) -> np.ndarray:
    """The light goes with the mains, and the shutter with another rate."""
    light = 1 + 0.2 * np.sin(2 * np.pi * 0.31 * np.arange(len(own)) + rng.uniform(0, 6))
    return np.clip(own * light[:, None, None, None], 0, 255).astype(np.uint8)


def packets_lost(own: np.ndarray, rng: Rng) -> np.ndarray:
    """For some frames at a time, the lower part is one colour, or one row again and again."""
    own, row = own.copy(), own.shape[1] // 2
    for first in rng.choice(np.arange(4, len(own) - 8), 4, replace=False):
        own[first : first + 5, row:] = (62, 132, 74) if rng.random() < 0.5 else own[first : first + 5, row : row + 1]
    return own


def snow(own: np.ndarray, rng: Rng) -> np.ndarray:
    return rng.integers(0, 256, own.shape).astype(np.uint8)


def copied(pictures: Film, places: Sequence[Place], rng: Rng) -> None:
    first, second, *_ = pictures
    for episode, _ in places:
        pictures[second][episode] = pictures[first][episode]


def exchanged(pictures: Film, places: Sequence[Place], rng: Rng) -> None:
    first, second, *_ = pictures
    for episode, _ in places:
        one, other = pictures[first][episode], pictures[second][episode]
        pictures[first][episode], pictures[second][episode] = other, one


def of_the_next(pictures: Film, places: Sequence[Place], rng: Rng) -> None:
    """What is stored for an episode of the last camera is what was seen in the next one."""
    own = pictures[list(pictures)[-1]]
    before = list(own)
    for episode, _ in places:
        other = before[(episode + 1) % len(before)]
        own[episode] = other[np.minimum(np.arange(len(before[episode])), len(other) - 1)]


def by_file(change: Callable[[Path], object]) -> OnFolder:
    """Harm the file of the last camera in which the first place is."""

    def do(root: Path, places: Sequence[Place], rng: Rng) -> None:
        change(video_files(root, last_camera(root))[places[0].episode])

    return do


def cut_off(path: Path) -> None:
    path.write_bytes(path.read_bytes()[: path.stat().st_size * 6 // 10])


def holed(path: Path) -> None:
    """A sector of the disk was lost: zeros in the middle of the pictures."""
    whole = bytearray(path.read_bytes())
    start = len(whole) // 3
    whole[start : start + len(whole) // 8] = bytes(len(whole) // 8)
    path.write_bytes(whole)


def pointer(path: Path) -> None:
    path.write_text(f"version https://git-lfs.github.com/spec/v1\noid sha256:{'0' * 64}\nsize {path.stat().st_size}\n")


def web_page(path: Path) -> None:
    path.write_text("<!DOCTYPE html><html><body>401 Unauthorized</body></html>")


def empty(path: Path) -> None:
    path.write_bytes(b"")


def again(change: Change, fps: int = FPS, **how: Any) -> Callable[[Path], None]:
    """Encode a file anew with other frames, or otherwise; nothing else is told of it."""

    def do(path: Path) -> None:
        with av.open(str(path)) as container:
            frames = np.stack([frame.to_ndarray(format="rgb24") for frame in container.decode(video=0)])
        encode(path, change(frames, np.random.default_rng(0)), fps, **how)

    return do


def same(own: np.ndarray, rng: Rng) -> np.ndarray:
    return own


def smaller(own: np.ndarray, rng: Rng) -> np.ndarray:
    return own[:, ::2, ::2]


def spans(change: Callable[[np.ndarray, np.ndarray, int], tuple[np.ndarray, np.ndarray]]) -> OnFolder:
    """Change from when to when the episodes of the last camera are said to be, (n,) each."""

    def do(root: Path, places: Sequence[Place], rng: Rng) -> None:
        keys = [f"videos/{last_camera(root)}/{which}_timestamp" for which in ("from", "to")]
        start, stop = change(*(np.array(column(root, key)) for key in keys), places[0].episode)
        put_columns(root, dict(zip(keys, (start.tolist(), stop.tolist()), strict=True)))

    return do


def spans_exchanged(start: np.ndarray, stop: np.ndarray, episode: int) -> tuple[np.ndarray, np.ndarray]:
    """Two episodes of one file have each other's span."""
    other = episode - 1 if start[episode] > 0 else episode + 1
    order = np.arange(len(start))
    order[[episode, other]] = order[[other, episode]]
    return start[order], stop[order]


def spans_overlap(start: np.ndarray, stop: np.ndarray, episode: int) -> tuple[np.ndarray, np.ndarray]:
    other = episode if start[episode] > 0 else episode + 1
    return start - (np.arange(len(start)) == other) * 1.0, stop


def spans_late(start: np.ndarray, stop: np.ndarray, episode: int) -> tuple[np.ndarray, np.ndarray]:
    return start + 1.0, stop + 1.0


def span_turned(start: np.ndarray, stop: np.ndarray, episode: int) -> tuple[np.ndarray, np.ndarray]:
    here = np.arange(len(start)) == episode
    return np.where(here, stop, start), np.where(here, start, stop)


def spans_of_frames(start: np.ndarray, stop: np.ndarray, episode: int) -> tuple[np.ndarray, np.ndarray]:
    return start * FPS, stop * FPS


def spans_of_zero(start: np.ndarray, stop: np.ndarray, episode: int) -> tuple[np.ndarray, np.ndarray]:
    return start * 0, stop - start


def said(**changes: Any) -> OnFolder:
    """`meta/info.json` says something else of the last camera: of its `info`, or of its shape."""

    def do(root: Path, places: Sequence[Place], rng: Rng) -> None:
        info = read_info(root)
        feature = info["features"][last_camera(root)]
        feature |= {key: value for key, value in changes.items() if key in feature}
        feature["info"] |= {f"video.{key}": value for key, value in changes.items() if key not in feature}
        write_info(root, info)

    return do


def file_copied(root: Path, places: Sequence[Place], rng: Rng) -> None:
    """One camera's file lies where the other's should be."""
    first, second, *_ = (video_files(root, name)[places[0].episode] for name in cameras(root))
    shutil.copy(first, second)


def files_exchanged(root: Path, places: Sequence[Place], rng: Rng) -> None:
    """The two files of one camera have each other's number."""
    paths = list(dict.fromkeys(video_files(root, last_camera(root))))
    whole = [path.read_bytes() for path in paths]
    for path, content in zip(paths, [*whole[1:], whole[0]], strict=True):
        path.write_bytes(content)


def missing(root: Path, places: Sequence[Place], rng: Rng) -> None:
    video_files(root, last_camera(root))[places[0].episode].unlink()


# --- the table

FIXED = "a camera may be mounted and set so: nothing in the dataset says which way is right"
EITHER = (SIDE, TOP)

ON_PICTURES: dict[str, Kind] = {
    "black": Kind("the lens cap was on", seen(black), (TOP,), plant=EVERY),
    "white": Kind("the sun shone into the lens", seen(filled(255, 255, 255)), (TOP,), plant=EVERY),
    "one-colour": Kind("the stream never came: green", seen(filled(0, 135, 0)), (TOP,), plant=WIDE),
    "no-signal": Kind("the receiver had no signal: snow", seen(snow), (TOP,), plant=EVERY),
    "frozen": Kind("the driver gave the same picture again and again", seen(held), (TOP,), plant=EVERY),
    "frozen-from-the-middle": Kind("the driver hung in the middle", seen(held_from_the_middle), (TOP,), plant=WIDE),
    "both-frozen": Kind("the hub hung: both cameras show one picture", seen(held, every=True), EITHER, plant=EVERY),
    "dark": Kind(
        "the light was switched off",
        seen(bright(0.12)),
        (TOP,),
        plant=EVERY,
        undecidable={ALL: "a dark room is a room"},
    ),
    "late": Kind("a buffer: pictures of a second before", seen(late(15)), (TOP,), plant=EVERY, seconds=3),
    "both-late": Kind("both cameras are a second late", seen(late(15), every=True), EITHER, plant=WIDE),
    "early": Kind("the state is half a second late, the pictures are not", seen(late(-8)), (TOP,), plant=WIDE),
    "drifting": Kind("the camera runs at another rate: it falls behind", seen(drifting), (TOP,), plant=WIDE),
    "slow-camera": Kind(
        "the camera gives 5 pictures a second, each stored three times", seen(each_third), (TOP,), plant=EVERY
    ),
    "same-camera-twice": Kind("both names are one device", filmed(copied), EITHER, plant=WIDE),
    "cameras-exchanged": Kind(
        "after a restart the cameras had each other's number",
        filmed(exchanged),
        EITHER,
        plant=WIDE,
        undecidable={ALL: "a name is a name: what a camera sees does not say what it is called"},
    ),
    "pictures-of-the-next": Kind(
        "a list was off by one: the pictures are of another episode", filmed(of_the_next), (TOP,), plant=WIDE
    ),
    "upside-down": Kind("the camera was turned round", seen(upside_down), (TOP,), plant=WIDE, undecidable={ALL: FIXED}),
    "mirrored-picture": Kind(
        "a setting mirrors the picture", seen(mirrored), (TOP,), plant=WIDE, undecidable={ALL: FIXED}
    ),
    "grey": Kind("colours were off", seen(grey), (TOP,), plant=WIDE, undecidable={ALL: "there are grey cameras"}),
    "blue-for-red": Kind(
        "OpenCV's BGR was stored as RGB",
        seen(blue_for_red),
        (TOP,),
        plant=WIDE,
        undecidable={ALL: "nobody knows the colours of somebody's table"},
    ),
    "moved-camera": Kind("somebody pushed the camera", seen(moved), (TOP,), plant=(ONE, HALF)),
    "blurred": Kind("autofocus went astray", seen(blurred), (TOP,), plant=EVERY, undecidable={ALL: "a cheap lens"}),
    "half-covered": Kind(
        "a cable hangs before the lens",
        seen(half_covered),
        (TOP,),
        plant=EVERY,
        undecidable={ALL: "half of a view may well be dark"},
    ),
    "boxed": Kind("another resize: black bars", seen(boxed), (TOP,), plant=WIDE),
    "torn": Kind("frames are torn: the lower half is older", seen(torn), (TOP,), plant=WIDE),
    "green-flashes": Kind("single frames were not decoded", seen(green_flashes), (TOP,), plant=EVERY),
    "out-of-order": Kind(
        "threads wrote the pictures, each when it was ready", seen(as_they_were_ready), (TOP,), plant=WIDE
    ),
    "mains-flicker": Kind("lamps flicker with the mains", seen(under_lamps), (TOP,), plant=WIDE),
    "packets-lost": Kind("packets of the stream were lost", seen(packets_lost), (TOP,), plant=WIDE),
}

ON_VIDEO_FILES: dict[str, Kind] = {
    "video-missing": Kind("a file was never uploaded", missing, (TOP,), plant=(ONE,)),
    "video-cut-off": Kind("the disk was full: a file ends in the middle", by_file(cut_off), (TOP,), plant=(ONE,)),
    "video-empty": Kind("a file has no byte", by_file(empty), (TOP,), plant=(ONE,)),
    "video-pointer": Kind("a file is a pointer of Git LFS", by_file(pointer), (TOP,), plant=(ONE,)),
    "video-web-page": Kind("a download was refused: the file is a web page", by_file(web_page), (TOP,), plant=(ONE,)),
    "video-holed": Kind("a part of a file was lost: zeros", by_file(holed), (TOP,), plant=(ONE,)),
    "video-shorter": Kind(
        "the encoder was killed: the last 25 pictures are not there",
        by_file(again(lambda own, rng: own[:-25])),
        (TOP,),
        plant=(ONE,),
    ),
    "video-frame-short": Kind(
        "one picture is not there, and all after it are a frame early",
        by_file(again(lambda own, rng: np.delete(own, len(own) // 2, axis=0))),
        (TOP,),
        plant=(ONE,),
    ),
    "video-longer": Kind(
        "pictures of a deleted episode are still there: nobody reads them",
        by_file(again(lambda own, rng: np.concatenate([own, own[:40]]))),
        (TOP,),
        plant=(ONE,),
        harmless=True,
    ),
    "video-fps": Kind("a file was encoded as 30 fps", by_file(again(same, fps=30)), (TOP,), plant=(ONE,)),
    "video-size": Kind("a file was encoded at half the size", by_file(again(smaller)), (TOP,), plant=(ONE,)),
    "video-key-frames": Kind(
        "only the first picture is a key frame: reading one in the middle decodes all before",
        by_file(again(same, keyframes=9999)),
        (TOP,),
        plant=(ONE,),
        harmless=True,
    ),
    "video-codec": Kind(
        "a file is AV1, the others are h264", by_file(again(same, codec="av1")), (TOP,), plant=(ONE,), harmless=True
    ),
    "info-fps": Kind("info.json says another rate of a camera", said(fps=30), (TOP, "fps"), plant=(ALL,)),
    "info-size": Kind("info.json says another size of a camera", said(height=480, width=640), (TOP,), plant=(ALL,)),
    "info-shape": Kind("the shape of a camera is that of another", said(shape=[480, 640, 3]), (TOP,), plant=(ALL,)),
    "info-codec": Kind("info.json says another codec", said(codec="av1"), (TOP, "codec"), plant=(ALL,), harmless=True),
    "file-of-the-other-camera": Kind(
        "one camera's file lies where the other's should be", file_copied, EITHER, plant=(ONE,)
    ),
    "files-exchanged": Kind("two files of a camera have each other's number", files_exchanged, (TOP,), plant=(ALL,)),
    "spans-exchanged": Kind(
        "two episodes have each other's span of a video", spans(spans_exchanged), (TOP,), plant=(ONE,)
    ),
    "spans-overlap": Kind(
        "an episode begins a second before the one before it ends", spans(spans_overlap), (TOP,), plant=(ONE,)
    ),
    "spans-late": Kind("all spans are a second late", spans(spans_late), (TOP,), plant=(ALL,)),
    "span-turned": Kind("a span ends before it begins", spans(span_turned), (TOP,), plant=(ONE,)),
    "spans-in-frames": Kind("spans count frames, not seconds", spans(spans_of_frames), (TOP,), plant=(ALL,)),
    "spans-of-zero": Kind(
        "each span begins at 0, as if each episode had a file", spans(spans_of_zero), (TOP,), plant=(ALL,)
    ),
}

CAMERA_KINDS: dict[str, Kind] = ON_PICTURES | ON_VIDEO_FILES
CAMERA_CASES: list[tuple[str, str]] = [(name, variant) for name, kind in CAMERA_KINDS.items() for variant in kind.plant]
