"""Do the pictures belong to the frames? Indices of videos against FFmpeg, and every fault of a camera is named."""

import itertools
import json
import multiprocessing
import os
import random
import re
import shutil
import struct
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from fractions import Fraction
from pathlib import Path
from types import SimpleNamespace

import av
import numpy as np
import pandas as pd
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
from damages import (
    DATA,
    EPISODES,
    EPISODES_DIR,
    INFO,
    edit_column,
    edit_feature,
    edit_info,
    leave_pointer,
    read_json,
    spoil_column,
    truncate,
)
from filmed import (
    CAMERAS,
    FPS,
    FRONT,
    LENGTHS,
    SIDE,
    SIZE,
    Film,
    encoded,
    film,
    photograph,
    shoot,
    video,
    wander,
    write_filmed,
    write_photographed,
    write_video,
)
from hypothesis import given, settings
from hypothesis import strategies as st
from layouts import data_files
from test_audit import said

import z2r
from z2r.audits import cameras, looks, pictures, together
from z2r.audits.copies import pictures_of_neighbours
from z2r.audits.findings import AUDIT, Finding
from z2r.audits.footage import _longest_rest
from z2r.audits.hues import hues_of, misnamed
from z2r.audits.signs import Signs, parted
from z2r.audits.together import Take, fit
from z2r.check import parts_in
from z2r.cli import main
from z2r.format import decoding, mp4
from z2r.format.mp4 import VideoIndex, read_video_index

pytestmark = pytest.mark.filterwarnings("error")

N_FRAMES = sum(LENGTHS)


@pytest.fixture(scope="session")
def filmed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("filmed") / "dataset"
    write_filmed(root)
    return root


@pytest.fixture
def root(filmed: Path, tmp_path: Path) -> Path:
    """A copy, to be damaged."""
    return Path(shutil.copytree(filmed, tmp_path / "dataset"))


# --- the index of a video, against FFmpeg


def index_of(path: Path) -> VideoIndex:
    return read_video_index(path.parent, Path(path.name))


def assert_is_what_ffmpeg_says(path: Path) -> None:
    index = index_of(path)
    with av.open(path) as file:
        stream = file.streams.video[0]
        times = [float(frame.pts * stream.time_base) for frame in file.decode(stream)]
        assert (index.codec, index.height, index.width) == (stream.codec.canonical_name, stream.height, stream.width)
        assert index.duration == pytest.approx(float((stream.start_time + stream.duration) * stream.time_base))
    assert index.times == pytest.approx(times)
    assert index.fps == pytest.approx(1 / np.median(np.diff(times)))
    with av.open(path) as file:
        packets = [packet for packet in file.demux(video=0) if packet.size and not packet.is_discard]
    packets.sort(key=lambda packet: packet.pts)
    assert index.sizes.tolist() == [packet.size for packet in packets]
    assert index.is_key.tolist() == [packet.is_keyframe for packet in packets]


PICTURES = [list(film(FRONT, 0, wander(0, 50)))]
QUIET = {"x265-params": "log-level=none"}


@pytest.mark.parametrize("fps", [7, 30])
@pytest.mark.parametrize(
    ("codec", "options"),
    [
        ("libx264", {"g": "2"}),
        ("libx264", {"g": "20", "bf": "3"}),
        ("libx265", {"g": "2"} | QUIET),
        ("libx265", {"g": "20"} | QUIET),
        ("libsvtav1", {"g": "2"}),
        ("libsvtav1", {"g": "30"}),
        ("libvpx-vp9", {"g": "20", "deadline": "realtime"}),
    ],
)
def test_an_index_is_what_ffmpeg_says(codec, options, fps, tmp_path):
    write_video(tmp_path / "a.mp4", PICTURES, codec, fps, **options)
    assert_is_what_ffmpeg_says(tmp_path / "a.mp4")


def remux(source: Path, target: Path, options: tuple = (), after: Fraction = Fraction(0), sound: bool = False) -> None:
    """Write the same pictures into another file: later, or beside sound."""
    with av.open(source) as old, av.open(target, "w", options=dict(options)) as new:
        noise = new.add_stream("aac", rate=8000, layout="mono") if sound else None
        copy = new.add_stream_from_template(old.streams.video[0], opaque=True)
        copy.time_base = old.streams.video[0].time_base
        if noise:
            silence = av.AudioFrame.from_ndarray(np.zeros((1, 1024), np.float32), format="fltp", layout="mono")
            silence.sample_rate = 8000
            new.mux(noise.encode(silence) + noise.encode())
        for packet in old.demux(video=0):
            if packet.dts is not None:
                packet.pts += int(after / packet.time_base)
                packet.dts += int(after / packet.time_base)
                packet.stream = copy
                new.mux(packet)


@pytest.mark.parametrize(
    "how",
    [
        {},
        {"options": [("use_editlist", "0")]},
        {"after": Fraction(3, 10)},
        {"after": Fraction(-2, 10)},
        {"sound": True},
    ],
    ids=["index at the end", "no list of cuts", "begins later", "begins earlier", "with sound"],
)
def test_an_index_of_another_layout_is_what_ffmpeg_says(how, tmp_path):
    write_video(tmp_path / "a.mp4", PICTURES, g="20", bf="3")
    remux(tmp_path / "a.mp4", tmp_path / "b.mp4", **how)
    assert_is_what_ffmpeg_says(tmp_path / "b.mp4")


@pytest.fixture(scope="session")
def small_video(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    path = tmp_path_factory.mktemp("video") / "a.mp4"
    write_video(path, PICTURES, g="20", bf="3")
    return path.read_bytes()


def answer(data: bytes) -> VideoIndex | z2r.DatasetError:
    with tempfile.TemporaryDirectory() as folder:
        (Path(folder) / "a.mp4").write_bytes(data)
        try:
            return read_video_index(Path(folder), Path("a.mp4"))
        except z2r.DatasetError as error:
            return error


@settings(max_examples=300)
@given(seed=st.integers(0, 2**32))
def test_a_damaged_video_is_an_error_or_an_index(small_video, seed):
    rng, data = random.Random(seed), bytearray(small_video)
    index = data.index(b"moov")
    for _ in range(rng.choice((1, 1, 2, 8))):
        place = rng.randrange(rng.choice((0, index)), len(data) - 4)
        data[place : place + rng.choice((1, 1, 4, 4, 100))] = rng.choice(
            (b"", b"\0", b"\xff", b"\xff" * 4, b"\0" * 4, b"\0\0\0\1", b"\x7f\xff\xff\xff", rng.randbytes(4))
        )
    found = answer(bytes(data))
    if isinstance(found, VideoIndex):
        assert len(found.times) == len(found.sizes) == len(found.is_key)
        assert found.sizes.sum() <= len(data)


@given(share=st.floats(0, 0.999))
def test_a_video_that_is_cut_anywhere_is_an_error(small_video, share):
    for data in (small_video, index_first(small_video)):
        assert isinstance(answer(data[: int(share * len(data))]), z2r.DatasetError)


def index_first(data: bytes) -> bytes:
    """Put the index before the pictures, as LeRobot does when it joins videos; where they are then does not matter."""
    start = data.index(b"moov") - 4
    [size] = struct.unpack_from(">I", data, start)
    first = data.index(b"mdat") - 4
    return data[:first] + data[start : start + size] + data[first:start] + data[start + size :]


def in_table(kind: bytes, *numbers: int, at: int = 4) -> Callable[[bytes], bytes]:
    """Write numbers into a box, `at` so many bytes after its name."""

    def change(data: bytes) -> bytes:
        place = data.index(kind) + 4 + at
        new = struct.pack(f">{len(numbers)}I", *numbers)
        return data[:place] + new + data[place + len(new) :]

    return change


def boxes(n: int) -> bytes:
    return struct.pack(">I4s", 8, b"free") * n


@pytest.mark.parametrize(
    ("change", "says"),
    [
        (lambda data: b"", "no index (moov) in its 0 bytes"),
        (lambda data: b"RIFF" + data, "no mp4"),
        (lambda data: data[:32] + boxes(5000), "no index (moov)"),
        (lambda data: data.replace(b"vide", b"soun"), "no video among its tracks"),
        (lambda data: data.replace(b"stsz", b"stsy"), "no stsz"),
        (in_table(b"stsz", 0, 2**32 - 1), "4,294,967,295 pictures"),
        (in_table(b"stsz", 1, 2**22), "4,194,304 pictures"),
        (in_table(b"stsz", 2**31, 50), "50 pictures"),
        (in_table(b"stsz", 0, 50, 2**31), "bytes in a file of"),
        (in_table(b"stts", 1, 2**31), "for 2,147,483,648 pictures"),
        (in_table(b"stts", 2**32 - 1), "moov"),
        (in_table(b"stss", 2**30), "moov"),
        (in_table(b"mdhd", 0, at=12), "mdhd counts no time"),
        (in_table(b"elst", 2**31), "2,147,483,648 cuts"),
        (lambda data: data.replace(b"moov", b"moof"), "fragmented"),
        (in_table(b"moov", 2**31 - 1, at=-8), "cut off"),
    ],
)
def test_no_size_in_a_video_is_believed(change, says, small_video):
    error = answer(change(small_video))
    assert isinstance(error, z2r.DatasetError)
    assert says in str(error)


def test_an_index_of_a_gigabyte_is_not_read(tmp_path):
    path = tmp_path / "a.mp4"
    path.write_bytes(struct.pack(">I4s", 2**30, b"moov"))
    os.truncate(path, 2**30)
    with pytest.raises(z2r.DatasetError, match="at most"):
        index_of(path)


def test_cuts_that_show_pictures_again_and_again_are_not_followed(small_video, monkeypatch):
    monkeypatch.setattr(mp4, "_MAX_PICTURES", 60)
    cut = struct.pack(">IiI", 0, 0, 1 << 16)
    place = small_video.index(b"edts") - 4
    again = b"elst" + struct.pack(">II", 0, 2) + 2 * cut
    elst = struct.pack(">I", len(again) + 4) + again
    edts = struct.pack(">I4s", len(elst) + 8, b"edts") + elst
    [size] = struct.unpack_from(">I", small_video, place)
    data = bytearray(small_video[:place] + edts + small_video[place + size :])
    for kind in (b"moov", b"trak"):
        start = data.index(kind) - 4
        struct.pack_into(">I", data, start, struct.unpack_from(">I", data, start)[0] + len(edts) - size)
    assert "again and again" in str(answer(bytes(data)))
    monkeypatch.undo()
    assert len(answer(bytes(data)).times) == 100


# --- no fault


OF_CAMERAS = {AUDIT.name, *(part.check.name for part in parts_in(cameras, pictures))}


def of_cameras(audit: z2r.Audit) -> list[Finding]:
    """Leave out what is said of a robot that hardly does anything."""
    return [finding for finding in audit.findings if finding.check in OF_CAMERAS]


def silent(root: Path, **how: bool) -> z2r.Audit:
    audit = z2r.audit(root, **how)
    assert not of_cameras(audit), said(audit)
    return audit


def test_nothing_is_said_of_videos_that_are_whole(filmed):
    audit = silent(filmed)
    assert audit.n_frames == N_FRAMES


@pytest.mark.parametrize("codec", ["libsvtav1", "libx265"])
def test_nothing_is_said_of_several_videos_of_another_codec(codec, root):
    shoot(root, SIDE, codec=codec, files=[3, 1, 4])
    silent(root)


def test_nothing_is_said_of_what_lerobot_writes_and_it_reads_what_is_laid_out_here(filmed, tmp_path):
    from lerobot.datasets.lerobot_dataset import LeRobotDataset

    features = {name: value for name, value in read_json(filmed, INFO)["features"].items() if name.count("index") == 0}
    del features["timestamp"]
    where = {"repo_id": "test/test", "root": tmp_path / "dataset", "video_backend": "pyav"}
    written = LeRobotDataset.create(**where, fps=FPS, features=features, video_files_size_in_mb=0.02)
    for episode, n_frames in enumerate(LENGTHS[:4]):
        states = wander(episode, n_frames)
        for state, *views in zip(states, *(film(camera, episode, states) for camera in CAMERAS), strict=True):
            seen = dict(zip(CAMERAS, views, strict=True))
            written.add_frame({"observation.state": state, "action": state, "task": "push it"} | seen)
        written.save_episode()
    written.finalize()
    assert len(list(tmp_path.rglob("*.mp4"))) > len(CAMERAS)
    silent(tmp_path / "dataset")

    read = LeRobotDataset("test/test", root=filmed, video_backend="pyav")
    pictures = list(film(SIDE, 1, wander(1, LENGTHS[1])))
    for frame in (0, 40, LENGTHS[1] - 1):
        seen = read[LENGTHS[0] + frame][SIDE].numpy().transpose(1, 2, 0)
        assert np.abs(255 * seen - pictures[frame]).mean() < 12


# --- every fault


@dataclass(frozen=True)
class Fault:
    """One fault: what is done, the checks that must find it and no other, and what the first must say."""

    do: Callable[[Path], object]
    checks: str
    file: str
    says: str = ""
    severity: str = "error"


def lay(camera: str, **how: object) -> Callable[[Path], None]:
    """Encode the video of a camera again, otherwise."""
    size, lengths = how.pop("size", SIZE), how.pop("lengths", LENGTHS)

    def do(root: Path) -> None:
        episodes = [list(film(camera, episode, wander(episode, n))) for episode, n in enumerate(lengths)]
        episodes = [[picture[: size[0], : size[1]] for picture in pictures] for pictures in episodes]
        write_video(video(root, camera), episodes, **how)

    return do


def smaller_side(root: Path) -> None:
    """Let one camera have a smaller picture, and say so."""
    lay(SIDE, size=(64, 64))(root)
    edit_feature(root, SIDE, shape=[64, 64, 3], info={"video.height": 64, "video.width": 64})


def exchange_cameras(root: Path) -> None:
    front, side = (video(root, camera) for camera in CAMERAS)
    aside = front.with_name("aside")
    front.rename(aside)
    side.rename(front)
    aside.rename(side)


def change_span(key: str, change: Callable[[np.ndarray], object], camera: str = SIDE) -> Callable[[Path], None]:
    def in_place(values: list[float]) -> list[float]:
        array = np.array(values)
        change(array)
        return array.tolist()

    return lambda root: edit_column(root, EPISODES, f"videos/{camera}/{key}", in_place)


def at(row: int, value: float, keys: tuple[str, ...] = ("from_timestamp", "to_timestamp")) -> Callable[[Path], None]:
    """Move the span of one episode, or one end of it."""

    def do(root: Path) -> None:
        for key in keys:
            change_span(key, lambda values: np.add.at(values, row, value))(root)

    return do


def exchange_spans(root: Path) -> None:
    for key in ("from_timestamp", "to_timestamp"):
        change_span(key, lambda values: np.copyto(values, values[[4, 1, 2, 3, 0, *range(5, len(values))]]))(root)


def one_more(root: Path) -> None:
    lay(SIDE, lengths=[*LENGTHS[:-1], LENGTHS[-1] + 5])(root)


def retype(column: str, kind: pa.DataType, values: list) -> Callable[[Path], None]:
    return lambda root: edit_column(root, EPISODES, column, lambda _: values, kind)


def drop(column: str) -> Callable[[Path], None]:
    def do(root: Path) -> None:
        table = pq.read_table(root / EPISODES)
        pq.write_table(table.drop_columns(column), root / EPISODES)

    return do


SIDE_VIDEO = f"videos/{SIDE}/chunk-000/file-000.mp4"
SPAN = f"videos/{SIDE}"
FAULTS = {
    "missing": Fault(lambda root: video(root, SIDE).unlink(), "video-file", SIDE_VIDEO, "no such file"),
    "a pointer": Fault(lambda root: leave_pointer(video(root, SIDE)), "video-file", SIDE_VIDEO, "git lfs pull"),
    "a folder": Fault(
        lambda root: (video(root, SIDE).unlink(), video(root, SIDE).mkdir()), "video-file", SIDE_VIDEO, "no such file"
    ),
    "empty": Fault(lambda root: video(root, SIDE).write_bytes(b""), "video-file", SIDE_VIDEO, "0 bytes"),
    "cut off": Fault(lambda root: truncate(video(root, SIDE), 0.8), "video-file", SIDE_VIDEO, "cut off"),
    "another kind of file": Fault(
        lambda root: shutil.copy(root / EPISODES, video(root, SIDE)), "video-file", SIDE_VIDEO, "no mp4"
    ),
    "its file not named": Fault(drop(f"{SPAN}/file_index"), "video-file", EPISODES, f"{SPAN}/file_index"),
    "its span not named": Fault(drop(f"{SPAN}/from_timestamp"), "video-file", EPISODES, f"{SPAN}/from_timestamp"),
    "no span for one episode": Fault(
        retype(f"{SPAN}/to_timestamp", pa.float64(), [None] * 8), "video-file", EPISODES, "no value in 8 of 8"
    ),
    "a span in words": Fault(
        retype(f"{SPAN}/to_timestamp", pa.string(), ["x"] * 8), "video-file", EPISODES, f"{SPAN}/to_timestamp"
    ),
    "another size": Fault(lay(SIDE, size=(64, 64)), "camera-format", SIDE_VIDEO, "found 64 x 64, expected 72 x 96"),
    "another size than info": Fault(
        lambda root: edit_feature(root, SIDE, info={"video.height": 480, "video.width": 640}),
        "camera-format",
        SIDE_VIDEO,
        "expected 480 x 640, as info",
    ),
    "another size, without names": Fault(
        lambda root: edit_feature(root, SIDE, shape=[3, 96, 72], names=None), "camera-format", SIDE_VIDEO, "72 x 96"
    ),
    "two cameras exchanged": Fault(
        lambda root: (smaller_side(root), exchange_cameras(root)),
        "camera-format",
        f"videos/{FRONT}/chunk-000/file-000.mp4",
        f"{SIDE} has that size: are the two exchanged?",
    ),
    "another rate": Fault(lay(SIDE, fps=2 * FPS), "camera-format", SIDE_VIDEO, "found 20, expected 10"),
    "another rate in info": Fault(
        lambda root: edit_feature(root, SIDE, info={"video.fps": 30}), "camera-format", INFO, "video.fps", "warning"
    ),
    "another codec than info": Fault(
        lambda root: edit_feature(root, SIDE, info={"video.codec": "av1"}),
        "camera-format",
        SIDE_VIDEO,
        "found h264, expected av1",
        "note",
    ),
    "one channel": Fault(
        lambda root: edit_feature(root, SIDE, shape=[*SIZE, 1]), "camera-format", INFO, "1 channel", "warning"
    ),
    "few pictures that can be decoded alone": Fault(
        lay(SIDE, g="9999", sc_threshold="0", **{"x264-params": "keyint=infinite"}, forced=False),
        "camera-format",
        SIDE_VIDEO,
        "found 491 in a row that cannot be decoded alone",
        "note",
    ),
    "shorter": Fault(lay(SIDE, lengths=LENGTHS[:-2]), "video-length", SIDE_VIDEO, "found 380 pictures, expected 492"),
    "longer": Fault(one_more, "video-length", SIDE_VIDEO, "found 497 pictures, expected 492", "note"),
    "a span that is too long": Fault(
        at(7, 0.2, ("to_timestamp",)), "video-span", EPISODES_DIR, "from 44 s to 49.4 s, expected 5.2 s"
    ),
    "a span that is too short": Fault(at(7, -0.2, ("to_timestamp",)), "video-span", EPISODES_DIR, "episode 7"),
    "a span that runs backwards": Fault(
        change_span("to_timestamp", lambda values: values.fill(0)),
        "video-span",
        EPISODES_DIR,
        "to 0 s",
    ),
    "a span of nan": Fault(at(2, np.nan), "video-file", EPISODES, "from_timestamp in row 2: found nan"),
    "a span of infinity": Fault(at(2, np.inf), "video-file", EPISODES, "from_timestamp in row 2: found inf"),
    "a span before the video": Fault(at(0, -1.0), "video-span video-time", EPISODES_DIR, "from -1 s"),
    "two spans that overlap": Fault(
        at(3, -1.0), "video-span", EPISODES_DIR, "expected 18.8 s or more: until then, videos"
    ),
    "a span behind the video": Fault(at(7, 1.0), "video-span video-time", EPISODES_DIR, "expected 49.2 s at most"),
    "two spans exchanged": Fault(exchange_spans, "video-span", EPISODES_DIR, "may be exchanged", "warning"),
    "spans beside the pictures": Fault(at(2, 0.03), "video-time", SIDE_VIDEO, "30 ms away, expected 0.1 ms at most"),
    "one path for two cameras": Fault(
        lambda root: (
            shutil.move(video(root, FRONT), root / "videos/0-0.mp4"),
            video(root, SIDE).unlink(),
            edit_info(root, video_path="videos/{chunk_index}-{file_index}.mp4"),
        ),
        "camera-twin",
        "videos/0-0.mp4",
        f"{SIDE}: found the video of {FRONT}",
        "warning",
    ),
    "one video for two cameras": Fault(
        lambda root: shutil.copy(video(root, FRONT), video(root, SIDE)),
        "camera-twin",
        SIDE_VIDEO,
        f"a copy of videos/{FRONT}",
        "warning",
    ),
}


@pytest.mark.parametrize("kind", FAULTS)
def test_a_fault_of_a_camera_is_named_and_nothing_else(kind, root):
    fault = FAULTS[kind]
    fault.do(root)
    audit = z2r.audit(root)
    assert {finding.check for finding in of_cameras(audit)} == set(fault.checks.split()), said(audit)
    first = of_cameras(audit)[0]
    assert (first.severity, first.file) == (fault.severity, fault.file), said(audit)
    assert fault.says in str(first)
    assert audit.exit_code == (fault.severity != "note")


# --- what the pictures show, as far as their sizes tell


def black(camera: str, episode: int, states: np.ndarray) -> Iterator[np.ndarray]:
    return (0 * picture for picture in film(camera, episode, states))


def frozen(camera: str, episode: int, states: np.ndarray) -> Iterator[np.ndarray]:
    return itertools.repeat(next(film(camera, episode, states)), len(states))


def only(wrong: Film, *episodes: int, camera: str = SIDE) -> Film:
    """Film some episodes wrong with one camera, or all of them."""
    return lambda name, episode, states: (wrong if name == camera and (not episodes or episode in episodes) else film)(
        name, episode, states
    )


@pytest.mark.parametrize("codec", ["libx264", "libsvtav1"])
@pytest.mark.parametrize(
    ("wrong", "check", "severity", "place"),
    [
        (only(black, 3), "camera-flat", "warning", "in episode 3: found"),
        (black, "camera-flat", "warning", "in episode [01]: found .*and [67] more"),
        (only(frozen, 3), "camera-frozen", "warning", "in episode 3: found"),
        (frozen, "camera-frozen", "note", "in episode [01]: found .*and [67] more"),
    ],
    ids=["black for an episode", "always black", "frozen for an episode", "always frozen"],
)
def test_the_sizes_of_pictures_hint_at_what_they_show(wrong, check, severity, place, codec, root):
    shoot(root, SIDE, wrong, codec=codec)
    [finding] = of_cameras(z2r.audit(root))
    assert (finding.check, finding.severity) == (check, severity)
    assert re.search(f"{SIDE} {place}", str(finding))
    assert "--pictures" in finding.mend


# --- images that stand in the data file


@pytest.fixture(scope="session")
def photographed(tmp_path_factory: pytest.TempPathFactory) -> Path:
    root = tmp_path_factory.mktemp("photographed") / "dataset"
    write_photographed(root)
    return root


@pytest.fixture
def album(photographed: Path, tmp_path: Path) -> Path:
    """A copy, to be damaged."""
    return Path(shutil.copytree(photographed, tmp_path / "dataset"))


def test_nothing_is_said_of_images_that_are_whole(album):
    silent(album)
    photograph(album, SIDE, kind="jpeg")
    silent(album)


def put_image(row: int, picture: bytes | None) -> Callable[[Path], None]:
    def change(rows: list[dict]) -> list[dict]:
        return [{"bytes": picture, "path": "x"} if i == row else old for i, old in enumerate(rows)]

    return lambda root: edit_column(root, DATA, SIDE, change)


def other_images(camera: str, pictures: Callable[[list[bytes]], list[bytes | None]]) -> Callable[[Path], None]:
    def change(rows: list[dict]) -> list[dict]:
        return [{"bytes": picture, "path": None} for picture in pictures([row["bytes"] for row in rows])]

    return lambda root: edit_column(root, DATA, camera, change)


GRAY = np.zeros(SIZE, np.uint8)
IMAGE_FAULTS = {
    "no image in a row": Fault(put_image(70, None), "finite", DATA, f"{SIDE} in row 70: found no picture"),
    "an image of no bytes": Fault(put_image(70, b""), "finite", DATA, "row 70"),
    "bytes that are no image": Fault(put_image(70, b"no picture"), "camera-format", DATA, "in row 70: found bytes"),
    "an image that is cut off": Fault(
        put_image(70, encoded(next(film(SIDE, 0, wander(0, 1))))[:-20]), "camera-format", DATA, "no whole picture"
    ),
    "a jpeg that is cut off": Fault(put_image(70, encoded(GRAY, "jpeg")[:20]), "camera-format", DATA, "row 70"),
    "an image of another size": Fault(
        put_image(70, encoded(np.zeros((8, 9, 3), np.uint8))), "camera-format", DATA, "found 8 x 9, expected 72 x 96"
    ),
    "a jpeg of another size": Fault(
        put_image(70, encoded(np.zeros((8, 9, 3), np.uint8), "jpeg")), "camera-format", DATA, "found 8 x 9"
    ),
    "an image without colours": Fault(put_image(70, encoded(GRAY)), "camera-format", DATA, "1 channels, expected 3"),
    "a column of numbers": Fault(
        lambda root: edit_column(root, DATA, SIDE, lambda rows: [0.0] * len(rows), pa.float32()),
        "column-type",
        DATA,
        "values of type float",
    ),
    "a column that is damaged": Fault(lambda root: spoil_column(root / DATA, SIDE), "data-file", DATA, "pyarrow"),
    "the images of another camera": Fault(
        lambda root: copy_column(root, FRONT, SIDE), "camera-twin", "data", f"the same pictures as {FRONT}", "warning"
    ),
}


def copy_column(root: Path, source: str, target: str) -> None:
    table = pq.read_table(root / DATA)
    place = table.schema.get_field_index(target)
    pq.write_table(table.set_column(place, target, table.column(source)), root / DATA)


@pytest.mark.parametrize("kind", IMAGE_FAULTS)
def test_a_fault_of_images_is_named_and_nothing_else(kind, album):
    fault = IMAGE_FAULTS[kind]
    fault.do(album)
    audit = z2r.audit(album)
    assert {finding.check for finding in of_cameras(audit)} == {fault.checks}, said(audit)
    first = of_cameras(audit)[0]
    assert (first.severity, first.file) == (fault.severity, fault.file), said(audit)
    assert fault.says in str(first)


@pytest.mark.parametrize("kind", ["png", "jpeg"])
@pytest.mark.parametrize(
    ("wrong", "check", "severity", "place"),
    [
        (only(black, 3), "camera-flat", "warning", "in episode 3: found the same picture in all frames, no larger"),
        (black, "camera-flat", "warning", "in episode [01]: found .*and [67] more"),
        (only(frozen, 3), "camera-frozen", "warning", "in episode 3: found the same picture in all frames,"),
        (frozen, "camera-frozen", "note", "in episode [01]: found .*and [67] more"),
    ],
    ids=["black for an episode", "always black", "frozen for an episode", "always frozen"],
)
def test_images_that_are_the_same_are_named(wrong, check, severity, place, kind, album):
    photograph(album, SIDE, wrong, kind)
    [finding] = of_cameras(z2r.audit(album))
    assert (finding.check, finding.severity) == (check, severity)
    assert re.search(f"{SIDE} {place}", str(finding))


def test_images_that_are_the_same_for_a_while_are_named(album):
    photograph(album, SIDE, only(hung_for_a_while, 4))
    [finding] = [each for each in of_cameras(z2r.audit(album, pictures=True)) if each.check == "camera-frozen"]
    assert re.search(rf"{SIDE} in episode 4: found the same picture in 1\d frames from frame 21 on", str(finding))


@given(st.lists(st.tuples(st.booleans(), st.booleans()), min_size=1, max_size=30), st.data())
def test_the_longest_rest_of_each_episode_is_found(frames, data):
    rests, other = np.array(frames).T
    may_rest = rests | other
    cuts = data.draw(st.lists(st.integers(0, len(frames)), min_size=2, max_size=5).map(sorted))
    spans = np.stack([cuts[:-1], cuts[1:]], axis=1)
    for (start, stop), (first, n) in zip(spans.tolist(), _longest_rest(rests, may_rest, spans).tolist(), strict=True):
        every = [(i, j) for i in range(start, stop) for j in range(i, stop) if rests[j] and may_rest[i : j + 1].all()]
        assert n == max((j + 1 - i for i, j in every), default=0)
        assert n == 0 or (start + first, start + first + n - 1) in every


# --- what the pictures show, once they are decoded


def gray(camera: str, episode: int, states: np.ndarray) -> Iterator[np.ndarray]:
    """One colour, with the noise of a sensor that sees no light."""
    rng = np.random.default_rng(episode)
    return (rng.normal(90, 2, (*SIZE, 3)).astype(np.uint8) for _ in states)


def hung(camera: str, episode: int, states: np.ndarray) -> Iterator[np.ndarray]:
    """A camera that hangs after a third of the episode."""
    pictures = list(film(camera, episode, states))
    return (pictures[min(frame, len(states) // 3)] for frame in range(len(states)))


def front_again(camera: str, episode: int, states: np.ndarray) -> Iterator[np.ndarray]:
    return film(FRONT, episode, states)


def exchanged(camera: str, episode: int, states: np.ndarray) -> Iterator[np.ndarray]:
    """Episodes 0 and 4, which are as long, are exchanged."""
    other = {0: 4, 4: 0}[episode]
    return film(camera, other, wander(other, len(states)))


def stranger(camera: str, episode: int, states: np.ndarray) -> Iterator[np.ndarray]:
    return film(camera, 99, wander(99, len(states)))


def late(n_frames: int) -> Film:
    """A camera whose pictures come so many frames late, or early."""

    def filmed(camera: str, episode: int, states: np.ndarray) -> Iterator[np.ndarray]:
        seen = np.clip(np.arange(len(states)) - n_frames, 0, len(states) - 1)
        return film(camera, episode, states[seen])

    return filmed


def changed(change: Callable[[np.ndarray], np.ndarray]) -> Film:
    """Change every picture in the same way."""

    def filmed(camera: str, episode: int, states: np.ndarray) -> Iterator[np.ndarray]:
        return (change(picture).astype(np.uint8) for picture in film(camera, episode, states))

    return filmed


def out_of_focus(picture: np.ndarray) -> np.ndarray:
    return np.mean([np.roll(picture, (dy, dx), (0, 1)) for dy in range(-3, 4) for dx in range(-3, 4)], axis=0)


def snow(camera: str, episode: int, states: np.ndarray) -> Iterator[np.ndarray]:
    rng = np.random.default_rng(episode)
    return (rng.integers(0, 256, (*SIZE, 3)).astype(np.uint8) for _ in states)


def flashes(camera: str, episode: int, states: np.ndarray) -> Iterator[np.ndarray]:
    """Some pictures that a decoder could not make sense of."""
    pictures = enumerate(film(camera, episode, states))
    green = np.zeros((*SIZE, 3), np.uint8) + np.uint8([0, 135, 0])
    return (green if frame in (20, 21, 40, 41) else picture for frame, picture in pictures)


def thrice(camera: str, episode: int, states: np.ndarray) -> Iterator[np.ndarray]:
    """A camera that gives a third of the pictures."""
    pictures = list(film(camera, episode, states))
    return (pictures[frame // 3 * 3] for frame in range(len(pictures)))


def in_turn(camera: str, episode: int, states: np.ndarray) -> Iterator[np.ndarray]:
    """Pictures of both cameras, one after the other."""
    other = FRONT if camera == SIDE else SIDE
    both = zip(film(camera, episode, states), film(other, episode, states), strict=True)
    return (pictures[frame % 2] for frame, pictures in enumerate(both))


def pushed(camera: str, episode: int, states: np.ndarray) -> Iterator[np.ndarray]:
    """Somebody pushes the camera in frame 32."""
    pictures = enumerate(film(camera, episode, states))
    return (picture if frame < 32 else np.roll(picture, 20, 1) for frame, picture in pictures)


def hung_for_a_while(camera: str, episode: int, states: np.ndarray) -> Iterator[np.ndarray]:
    pictures = list(film(camera, episode, states))
    return (pictures[20 if 20 <= frame < 34 else frame] for frame in range(len(pictures)))


def of_a_neighbour(n: int, *, again: bool = False) -> Film:
    """So many pictures are of the episode before, or of the next: the video is late, or its last one stays."""

    def filmed(camera: str, episode: int, states: np.ndarray) -> Iterator[np.ndarray]:
        own, other = list(film(camera, episode, states)), episode - (1 if n > 0 else -1)
        if not 0 <= other < len(LENGTHS):
            return iter(own)
        its = list(film(camera, other, wander(other, LENGTHS[other])))
        if again:
            return iter([*its[-1:] * n, *own[n:]] if n > 0 else [*own[:n], *its[:1] * -n])
        return iter([*its[-n:], *own[:-n]] if n > 0 else [*own[-n:], *its[:-n]])

    return filmed


def under_lamps(camera: str, episode: int, states: np.ndarray) -> Iterator[np.ndarray]:
    """A lamp that goes as bright as the mains, seen through a shutter that is not in step with it."""
    light = 1 + 0.2 * np.sin(2 * np.pi * 0.31 * np.arange(len(states)))
    return (
        np.clip(picture * by, 0, 255).astype(np.uint8)
        for picture, by in zip(film(camera, episode, states), light, strict=True)
    )


def under_lamps_in_bands(camera: str, episode: int, states: np.ndarray) -> Iterator[np.ndarray]:
    """The same lamp through a rolling shutter: each row sees it at its own time, and the whole is as bright as ever."""
    row = np.arange(SIZE[0])[:, None, None] / SIZE[0]
    for frame, picture in enumerate(film(camera, episode, states)):
        light = 1 + 0.25 * np.sin(2 * np.pi * (2 * row + 0.31 * frame))
        yield np.clip(picture * light, 0, 255).astype(np.uint8)


def two_of_three(camera: str, episode: int, states: np.ndarray) -> Iterator[np.ndarray]:
    """A camera that gives two pictures where three are stored, of something that never stops."""
    goes = np.stack([np.sin(0.4 * np.arange(len(states)) + phase) for phase in (episode, episode + 1.6)], axis=1)
    pictures = list(film(camera, episode, goes))
    return (pictures[frame - (frame % 3 == 2)] for frame in range(len(pictures)))


def hunting(camera: str, episode: int, states: np.ndarray) -> Iterator[np.ndarray]:
    """An autofocus that loses the scene for six frames out of sixteen."""
    pictures = enumerate(film(camera, episode, states))
    return (out_of_focus(each).astype(np.uint8) if frame % 16 < 6 else each for frame, each in pictures)


def smeared(camera: str, episode: int, states: np.ndarray) -> Iterator[np.ndarray]:
    """Packets are lost: for some frames, a row is repeated down to the lower edge."""
    for frame, picture in enumerate(film(camera, episode, states)):
        row = SIZE[0] // 3 if frame % 20 in range(5, 10) else SIZE[0]
        yield np.concatenate([picture[:row], np.repeat(255 - picture[row - 1 : row], SIZE[0] - row, axis=0)])


def hunting_for_white(camera: str, episode: int, states: np.ndarray) -> Iterator[np.ndarray]:
    """A white balance that goes from red to blue and back."""
    for frame, picture in enumerate(film(camera, episode, states)):
        yield np.clip(picture * (1 + 0.2 * np.sin(frame / 3) * np.array([1, 0, -1])), 0, 255).astype(np.uint8)


def sinking(camera: str, episode: int, states: np.ndarray) -> Iterator[np.ndarray]:
    """A camera whose mount gives way."""
    return (np.roll(picture, episode, 0) for picture in film(camera, episode, states))


def bumped(camera: str, episode: int, states: np.ndarray) -> Iterator[np.ndarray]:
    """Somebody hits the table in episode 4: from then on the camera sees it two pixels lower."""
    pictures = enumerate(film(camera, episode, states))
    return (np.roll(picture, 2 * (episode + frame / 32 >= 5), 0) for frame, picture in pictures)


def interlaced(picture: np.ndarray) -> np.ndarray:
    return np.where(np.arange(SIZE[0])[:, None, None] % 2, np.roll(picture, 3, 1), picture)


def with_colours_beside(picture: np.ndarray) -> np.ndarray:
    bright = picture @ [0.299, 0.587, 0.114]
    return np.clip(bright[..., None] + np.roll(picture - bright[..., None], 5, 1), 0, 255)


def denoised(camera: str, episode: int, states: np.ndarray) -> Iterator[np.ndarray]:
    """A table with a texture, which is smoothed away in some episodes."""
    texture = np.random.default_rng(0).normal(0, 8, (*SIZE, 1)) * (episode not in (1, 3, 5))
    return (np.clip(picture + texture, 0, 255).astype(np.uint8) for picture in film(camera, episode, states))


TURNED = changed(lambda picture: picture[::-1, ::-1])
COVERED = changed(lambda picture: np.where(np.arange(SIZE[0])[:, None, None] < SIZE[0] // 3, 8, picture))
ONE, ODD = r"in episode 3: found pictures ", r"in episodes 1, 3, 5: found pictures "
THAN_EVEN = ", compared with those of episodes 0, 2, 4, 6, 7, expected"
STRIPED = changed(lambda picture: np.where(np.arange(SIZE[1])[None, :, None] // 4 == 5, [255, 0, 255], picture))
DARKER = changed(lambda picture: picture * 0.66)
GREY = changed(lambda picture: picture.mean(axis=2, keepdims=True).repeat(3, 2))
UNLIKE = {
    "upside down": (only(TURNED, 3), ONE + "upside down, compared with those of episodes 0, 1, 2, 4"),
    "mirrored": (only(changed(lambda picture: picture[:, ::-1]), 3), ONE + "mirrored"),
    "blue for red": (only(changed(lambda picture: picture[..., ::-1]), 3), ONE + "with red and blue exchanged"),
    "grey": (only(GREY, 3), ONE + "without colour"),
    "blurred": (only(changed(out_of_focus), 3), ONE + r"blurred, with \d+% of the sharpness"),
    "covered": (only(COVERED, 3), ONE + r"black in 3\d% of the picture"),
    "a stripe": (only(STRIPED, 3), ONE + "with a stripe from edge to edge"),
}
SORTS = {
    "some upside down": (only(TURNED, 1, 3, 5), ODD + "upside down" + THAN_EVEN),
    "half upside down": (only(TURNED, 0, 1, 2, 3), "in episodes 4, 5, 6, 7: found pictures upside down"),
    "some blurred": (only(changed(out_of_focus), 1, 3, 5), ODD + r"blurred.*" + THAN_EVEN),
    "some darker": (
        only(changed(lambda picture: picture * 0.66), 1, 3, 5),
        ODD + r"of a brightness of \d+ of 255, where \d+ is usual" + THAN_EVEN,
    ),
    "some covered": (only(COVERED, 0, 1, 2, 4, 6), "in episodes 0, 1, 2, 4, 6: found pictures black in 3"),
    "moved": (only(changed(lambda picture: np.roll(picture, 20, 1)), 3), ONE + "of something else, compared with"),
}
MADE = {
    "two views side by side": (
        only(changed(lambda picture: np.concatenate([picture[:, ::2]] * 2, 1)), 1, 3, 5),
        ODD + r"with two halves with a correlation of 1, where episodes 0, 2, 4, 6, 7 have",
    ),
    "colours beside": (only(changed(with_colours_beside), 1, 3, 5), ODD + "with colours beside their edges"),
    "a white balance that hunts": (only(hunting_for_white, 1, 3, 5), ODD + "with a ratio of red to blue that swings"),
    "black is grey": (only(changed(lambda picture: 40 + 0.6 * picture), 1, 3, 5), ODD + "with a contrast of 0"),
    "interlaced": (only(changed(interlaced), 1, 3, 5), ODD + "with rows that differ from those around them"),
    "a texture that is smoothed away": (denoised, ODD + "with a sharpness of"),
    "bumped": (bumped, r"found what stands still moved by \d\.\d% of the height and 0.\d% .* from episode 5 on"),
    "sinking": (sinking, "found what stands still moved by 10% of the height, bit by bit"),
}
SEEN = {
    **{kind: (wrong, "camera-unlike", "warning", says) for kind, (wrong, says) in UNLIKE.items()},
    **{kind: (wrong, "camera-unlike", "note", says) for kind, (wrong, says) in SORTS.items()},
    **{kind: (wrong, "camera-quality", "note", says) for kind, (wrong, says) in MADE.items()},
    "noise in some": (only(snow, 1, 2, 3, 4), "camera-flat", "warning", "in episode 1: found noise.*and 3 more"),
    "flashes": (only(flashes, 3), "camera-flat", "warning", "in episode 3: found one colour, .* in 2 of .* frame 20"),
    "of both cameras in turn": (
        only(in_turn, 3),
        "camera-leap",
        "warning",
        "in episode 3: found pictures that differ from",
    ),
    "pushed in an episode": (
        only(pushed, 3),
        "camera-leap",
        "warning",
        "in episode 3: found another picture from frame 32",
    ),
    "lamps that flicker in bands": (
        only(under_lamps_in_bands, 3),
        "camera-leap",
        "note",
        "in episode 3: found a brightness that goes up and down by",
    ),
    "lamps that flicker": (
        only(under_lamps, 3),
        "camera-leap",
        "note",
        r"in episode 3: found a brightness that goes up and down by \d\d of 255",
    ),
    "a focus that hunts": (
        only(hunting, 3),
        "camera-leap",
        "note",
        r"in episode 3: found pictures of which some have \d\d% of the usual sharpness",
    ),
    "packets lost": (only(smeared, 3), "camera-leap", "note", r"in episode 3: found \d+ leaps of \d\d of 255"),
    "hung for a while": (
        only(hung_for_a_while, 4),
        "camera-frozen",
        "note",
        r"in episode 4: found the same picture in 1\d frames from frame 2[01] on, for \d\d% of the robot's way",
    ),
    "two pictures late": (
        of_a_neighbour(2),
        "camera-motion",
        "warning",
        r"in episode 1: found first two pictures like the last of the episode before \(and [3-6] more",
    ),
    "two pictures of the next": (
        of_a_neighbour(-2, again=True),
        "camera-motion",
        "warning",
        r"in episode 0: found last two pictures like the first of the next \(and [2-6] more",
    ),
    "slow in an episode": (only(thrice, 3), "camera-frozen", "warning", "in episode 3: found the picture of before"),
    "two pictures for three": (two_of_three, "camera-frozen", "note", r"in episode 0: .* for \d\d% of the steps"),
    "always slow": (thrice, "camera-frozen", "note", "in episode 0: found the picture of before again"),
    "black for an episode": (only(black, 3), "camera-flat", "warning", r"in episode 3: found one colour, black,"),
    "always black": (black, "camera-flat", "warning", r"in episode 0: found one colour, black \(and 7 more"),
    "always one colour": (gray, "camera-flat", "warning", "in episode 0: found one colour, of a brightness of 88"),
    "frozen for an episode": (only(frozen, 3), "camera-frozen", "warning", "in episode 3: found the same picture for "),
    "frozen in a few": (only(frozen, 1, 2, 3), "camera-frozen", "warning", "in episode 1: .*and 2 more"),
    "hung in an episode": (only(hung, 3), "camera-frozen", "warning", "in episode 3: found the same picture for [67]"),
    "always frozen": (frozen, "camera-frozen", "note", "in episode 0: .*and 7 more"),
    "one camera twice in an episode": (
        only(front_again, 3),
        "camera-twin",
        "warning",
        f"in episode 3: found the same .* {FRONT}",
    ),
    "two episodes exchanged": (
        only(exchanged, 0, 4),
        "camera-motion",
        "warning",
        r"in episode 0: found the pictures of episode 4: a correlation of 0.[6-9].*, and of -?0.[0-4].* \(and 1 more",
    ),
    "another episode": (
        only(stranger, 3),
        "camera-motion",
        "warning",
        "in episode 3: found pictures of something else: a correlation of 0.[12]",
    ),
    "pictures 1.5 s late": (
        only(late(15), 3),
        "camera-motion",
        "warning",
        "in episode 3: found pictures 1.5 s later than those",
    ),
    "pictures 1.5 s early": (
        only(late(-15), 3),
        "camera-motion",
        "warning",
        "in episode 3: found pictures 1.5 s earlier than those",
    ),
    "all pictures 1.5 s late": (
        late(15),
        "camera-motion",
        "warning",
        r"in episode 0: found pictures that are 1.[45] s late: .* \(and 7 more",
    ),
}


@pytest.mark.parametrize("kind", SEEN)
def test_what_decoded_pictures_show_is_named(kind, root):
    wrong, check, severity, says = SEEN[kind]
    shoot(root, SIDE, wrong)
    audit = z2r.audit(root, pictures=True)
    [finding] = [each for each in of_cameras(audit) if (each.check, each.severity) == (check, severity)]
    assert re.search(f"{SIDE}:? {says}", str(finding)), said(audit)
    assert all(each.severity == "note" for each in of_cameras(audit) if each != finding), said(audit)
    assert "--pictures" not in str(finding) + "".join(audit.not_checked)


def test_two_episodes_with_the_same_pictures_are_named_if_their_robots_go_two_ways(root):
    shoot(root, SIDE, only(exchanged, 0))  # which shows episode 4
    [twin] = [each for each in of_cameras(z2r.audit(root, pictures=True)) if each.check == "camera-twin"]
    assert (twin.severity, twin.episodes) == ("warning", (0, 4))
    assert f"{SIDE} in episode 0: found the same pictures, although the robot is elsewhere, as episode 4" in str(twin)


def test_nothing_is_said_of_two_episodes_in_which_the_robot_does_the_same(root):
    [path] = data_files(root)
    table = pq.read_table(path)
    episode = np.array(table["episode_index"])
    states = np.array(table["observation.state"].to_pylist(), dtype=np.float32)
    states[episode == 0] = states[episode == 4] + np.float32(1e-3)
    values = pa.FixedSizeListArray.from_arrays(pa.array(states.ravel()), states.shape[1])
    place = table.column_names.index("observation.state")
    pq.write_table(table.set_column(place, "observation.state", values.cast(table.schema.field(place).type)), path)
    shoot(root, SIDE, only(exchanged, 0))
    assert not [each for each in of_cameras(z2r.audit(root, pictures=True)) if each.check == "camera-twin"]


@pytest.mark.parametrize(("turn", "says"), [(False, "above and below"), (True, "left and right")])
def test_pictures_with_bars_are_a_note(turn, says, root):
    def boxed(picture: np.ndarray) -> np.ndarray:
        picture = picture.copy()
        lines = picture.swapaxes(0, 1) if turn else picture
        lines[: len(lines) // 5] = lines[-(len(lines) // 5) :] = 0
        return picture

    shoot(root, SIDE, changed(boxed))
    [finding] = [each for each in of_cameras(z2r.audit(root, pictures=True)) if each.check == "camera-flat"]
    assert (finding.severity, finding.episodes) == ("note", ())
    assert f"{SIDE}: found black {says}" in str(finding)


def test_two_cameras_that_are_exchanged_in_an_episode_are_named(root):
    for camera, other in (CAMERAS, CAMERAS[::-1]):
        shoot(root, camera, only(lambda _, *what, other=other: film(other, *what), 3, camera=camera))
    found = of_cameras(z2r.audit(root, pictures=True))
    assert [(each.check, each.severity, each.episodes) for each in found] == 2 * [("camera-unlike", "warning", (3,))]
    for finding, (camera, other) in zip(found, (CAMERAS, CAMERAS[::-1]), strict=True):
        assert f"{camera} in episode 3: found pictures like those of {other}" in str(finding)


def test_statistics_of_another_camera_are_named_where_pictures_are_decoded(root):
    path = root / "meta" / "stats.json"
    stats = json.loads(path.read_text())
    for camera, colour in ((FRONT, (0.5, 0.5, 0.5)), (SIDE, (0.2, 0.8, 0.4))):
        stats[camera] = {"mean": [[[each]] for each in colour], "std": [[[0.2]]] * 3}
    path.write_text(json.dumps(stats))
    [finding] = [each for each in z2r.audit(root, pictures=True).findings if each.check == "stats"]
    assert (finding.field, finding.found) == (f"{SIDE}.mean", "0.20 0.80 0.40")
    assert not [each for each in z2r.audit(root).findings if each.check == "stats"]


def test_a_standard_deviation_of_something_else_than_pixels_is_named(root):
    path = root / "meta" / "stats.json"
    with_stats = json.loads(path.read_text()) | {FRONT: {"std": [[[0.006]]] * 3}, SIDE: {"std": [[[0.15]]] * 3}}
    path.write_text(json.dumps(with_stats))
    [finding] = [each for each in z2r.audit(root, pictures=True).findings if each.check == "stats"]
    assert (finding.field, finding.found, finding.severity) == (f"{FRONT}.std", "0.006 0.006 0.006", "warning")


def test_what_goes_with_the_task_is_no_other_kind_of_picture():
    pictures_of_two_kinds = {row: Signs(0.0, 0.0, 0.2 + 0.6 * (row % 2), 0.0, 0.0, 0.0) for row in range(8)}
    [each] = parted(pictures_of_two_kinds, tasks=dict.fromkeys(range(8), 0))
    assert each.some.tolist() == [0, 2, 4, 6]  # of as many, those with less contrast
    assert not parted(pictures_of_two_kinds, tasks={row: row % 2 for row in range(8)})


def test_pictures_are_not_held_against_a_robot_that_is_where_it_never_was():
    rng, times = np.random.default_rng(0), np.arange(60) / 10
    places = np.sin(np.cumsum(rng.normal(0, 0.4, size=(8, 60, 2)), axis=1))
    seen = np.tanh(places @ rng.normal(size=(2, 5)))
    takes = {number: Take(seen[number], times, places[number], times) for number in range(8)}
    wrong = np.roll(seen[4], 30, axis=0)
    assert fit(takes | {4: Take(wrong, times, places[4], times)}).astray.keys() == {4}
    assert not fit(takes | {4: Take(wrong, times, places[4] + 3, times)}).astray


@pytest.mark.parametrize(("n_wrong", "n_named"), [(5, 5), (6, 0)])
def test_most_episodes_are_never_the_odd_ones(n_wrong, n_named):
    rng, times = np.random.default_rng(1), np.arange(60) / 10
    places = np.cumsum(rng.normal(size=(10, 60, 2)), axis=1)
    seen = np.tanh(places @ rng.normal(size=(2, 5)) / 9)
    noise = rng.normal(0, 0.3, size=(10, 60, 5))
    shown = np.where(np.arange(10)[:, None, None] < n_wrong, noise, seen)
    astray = fit({number: Take(shown[number], times, places[number], times) for number in range(10)}).astray
    assert [*astray] == [*range(n_named)]
    assert all(found.startswith("pictures of something else") for found in astray.values())


@pytest.mark.parametrize(
    ("own", "typical", "spread", "named"),
    [
        (0.24, 0.9, 0.02, True),  # it must fit nothing
        (0.26, 0.9, 0.02, False),
        (0.14, 0.5, 0.02, True),  # and be far below what is usual, in correlation
        (0.16, 0.5, 0.02, False),
        (0.19, 0.9, 0.1, True),  # and in spreads
        (0.21, 0.9, 0.1, False),
    ],
)
def test_pictures_of_something_else_are_far_below_what_is_usual(own, typical, spread, named, monkeypatch):
    monkeypatch.setattr(together, "_fits_of_others", lambda learned, number: [(-1.0, 1)])
    monkeypatch.setattr(together, "_fit_of_half", lambda learned, number, delay: own)
    monkeypatch.setattr(together, "_leverage", lambda learned, number: 0.0)
    learned = together._Learned({}, None, {}, {0: np.full(31, own)})
    assert bool(together._odd(learned, 0, 15, np.zeros(31), typical, spread)) == named


def test_one_episode_that_begins_with_a_neighbours_picture_is_found():
    rng = np.random.default_rng(0)
    ends = np.repeat(rng.integers(0, 256, (8, 2, 1, 24, 32)), 3, axis=2).astype(np.uint8)
    assert not pictures_of_neighbours({row: SimpleNamespace(ends=own) for row, own in enumerate(ends)})
    ends[3, 0, 0] = ends[2, 1, 0]
    seen = {row: SimpleNamespace(ends=own) for row, own in enumerate(ends)} | {8: SimpleNamespace(ends=None)}
    assert pictures_of_neighbours(seen) == {3: "first picture like the last of the episode before"}


def test_pictures_that_fit_in_half_of_an_episode_are_not_of_something_else():
    rng, times = np.random.default_rng(2), np.arange(60) / 10
    places = np.sin(np.cumsum(rng.normal(0, 0.4, size=(8, 60, 2)), axis=1))
    seen = np.tanh(places @ rng.normal(size=(2, 5)))
    takes = {number: Take(seen[number], times, places[number], times) for number in range(8)}
    beside = seen[4] + np.where(times < 3, 4.0, 0)[:, None] * [1, -1, 1, -1, 1]
    assert not fit(takes | {4: Take(beside, times, places[4], times)}).astray


def test_one_picture_of_a_robot_that_rests_is_held_against_it():
    frame, way = np.arange(0.0, 60, 2), np.interp(np.arange(60), [0, 16, 44, 59], [0, 0.5, 0.5, 1])
    rests = (frame >= 16) & (frame <= 44)
    path = looks.Way(np.arange(60), way[:, None], way)
    still = SimpleNamespace(frame=frame, peak=np.where(rests[1:] & rests[:-1], 2, 90), cells=np.zeros((30, 48)))
    moving = SimpleNamespace(frame=frame, peak=np.full(29, 90), cells=np.zeros((30, 48)))
    assert np.isin(looks.take_of(still, path, 1).at, frame[rests]).sum() == 1
    assert len(looks.take_of(moving, path, 1).at) == len(frame)  # what moves may be late


@pytest.mark.parametrize(
    ("text", "says"),
    [
        ("push the red block", ""),
        ("push the block", ""),
        ("push the green block", "found pictures with up to .*% red, expected something green, as it says"),
    ],
)
def test_a_colour_that_is_nowhere_is_named(text, says, root):
    def on_grey(camera: str, episode: int, states: np.ndarray) -> Iterator[np.ndarray]:
        for picture in film(camera, episode, states):
            is_hand = (picture[..., :1] > 200) & (picture[..., 1:2] < 60)
            yield np.where(is_hand, picture, 128).astype(np.uint8)

    for camera in CAMERAS:
        shoot(root, camera, on_grey)
    pd.DataFrame({"task_index": [0]}, index=pd.Index([text], name="task")).to_parquet(root / "meta/tasks.parquet")
    found = [str(each) for each in z2r.audit(root, pictures=True).findings if each.check == "task-colour"]
    assert len(found) == bool(says)
    assert not says or re.search(says, found[0])


def test_tasks_that_end_with_each_others_colour_are_named():
    red, blue = np.zeros((2, 3, 4))
    red[:, 0], blue[:, 3] = 0.1, 0.1
    seen = {0: red, 1: red, 2: blue, 3: blue}
    seen = {row: hues + np.array([[0.05], [0.05], [0]]) for row, hues in seen.items()}
    tasks, texts = {0: 0, 1: 0, 2: 1, 3: 1}, ["go to the red post", "go to the blue post"]
    assert not misnamed([seen], tasks, dict(enumerate(texts)))
    exchanged = misnamed([seen], tasks, dict(enumerate(texts[::-1])))
    assert [(each.task, each.rows.tolist()) for each in exchanged] == [(0, [0, 1]), (1, [2, 3])]
    assert not misnamed([seen], dict.fromkeys(range(4), 0), {0: texts[0]})


@pytest.mark.parametrize("place", range(4))
def test_a_colour_is_told_from_the_others(place):
    of_one = np.array([(200, 20, 20), (220, 200, 20), (20, 160, 40), (30, 40, 200)], dtype=np.float32)[place]
    pictures = np.full((6, 8, 8, 3), 128, dtype=np.float32)
    pictures[:, :2] = of_one
    assert hues_of(pictures) == pytest.approx(np.repeat([np.arange(4) == place], 3, axis=0) * 0.25)


def test_statistics_from_0_to_255_are_named(root):
    path = root / "meta" / "stats.json"
    path.write_text(json.dumps(json.loads(path.read_text()) | {FRONT: {"mean": [[[120.0]]] * 3}}))
    [finding] = [each for each in z2r.audit(root).findings if each.check == "stats"]
    assert (finding.field, finding.found) == (f"{FRONT}.mean", "120")


def test_nothing_is_said_of_what_lies_elsewhere_nor_of_daylight(root):
    """Nor of a camera that sees something else in each episode."""

    def at_home(camera: str, episode: int, states: np.ndarray) -> Iterator[np.ndarray]:
        for picture in film(camera, episode, states):
            picture[8:24, 8 * episode : 8 * episode + 20] = 30
            yield (picture * (0.6 + 0.08 * episode)).clip(0, 255).astype(np.uint8)

    def on_a_wrist(camera: str, episode: int, states: np.ndarray) -> Iterator[np.ndarray]:
        return (np.roll(picture, (9 * episode, 5 * episode**2), (0, 1)) for picture in film(camera, episode, states))

    shoot(root, FRONT, at_home)
    shoot(root, SIDE, on_a_wrist)
    silent(root, pictures=True)


@pytest.mark.parametrize(("wrong", "episodes"), [(only(black, 1, 6), (1, 6)), (only(hung, 3), (3,))])
def test_the_episodes_are_listed(wrong, episodes, root):
    shoot(root, SIDE, wrong)
    [finding] = of_cameras(z2r.audit(root, pictures=True))
    assert finding.episodes == episodes


@pytest.mark.parametrize(
    ("kind", "episodes"),
    [
        ("missing", range(8)),
        ("shorter", [6, 7]),
        ("a span that is too long", [7]),
        ("spans beside the pictures", [2]),
    ],
)
def test_the_episodes_of_an_error_are_not_kept(kind, episodes, root):
    FAULTS[kind].do(root)
    audit = z2r.audit(root)
    assert of_cameras(audit)[0].episodes == tuple(episodes)
    assert audit.kept == tuple(set(range(8)) - set(episodes))


@pytest.mark.parametrize("codec", ["libx264", "libsvtav1", "libx265"])
def test_nothing_is_said_of_decoded_pictures_that_are_right(codec, root):
    """Nor of a camera that is a little late, as real ones are."""
    shoot(root, SIDE, late(1), codec=codec, files=[3, 5])
    audit = silent(root, pictures=True)
    assert not any("pictures" in line for line in audit.not_checked)


def test_nothing_is_said_of_a_camera_that_is_two_tenths_of_a_second_late(root):
    shoot(root, SIDE, late(2))
    silent(root, pictures=True)


def test_of_a_camera_that_is_four_tenths_of_a_second_late_it_is_only_said(root):
    shoot(root, SIDE, late(4))
    [finding] = of_cameras(z2r.audit(root, pictures=True))
    assert (finding.check, finding.severity, finding.field) == ("camera-motion", "note", SIDE)
    assert re.search("of where the robot was 0.[34] s before, in all episodes", finding.found)


def test_nothing_is_said_of_two_cameras_over_the_same_table(root):
    """They see the same, but for a small hand."""
    table = next(film(FRONT, 0, wander(0, 1)))

    def small_hand(camera: str, episode: int, states: np.ndarray) -> Iterator[np.ndarray]:
        for x, y in (0.5 * (states if camera == FRONT else -states) + 0.5) * np.subtract(SIZE[::-1], 8):
            picture = table.copy()
            picture[round(y) : round(y) + 8, round(x) : round(x) + 8] = (250, 30, 30)
            yield picture

    for camera in CAMERAS:
        shoot(root, camera, small_hand)
    silent(root, pictures=True)


def test_nothing_is_said_of_two_videos_whose_pictures_only_take_the_same(root):
    data = bytearray(video(root, FRONT).read_bytes())
    data[-1] ^= 1
    video(root, SIDE).write_bytes(data)
    silent(root)


def test_nothing_is_said_where_the_robot_rests_or_is_not_in_the_picture(tmp_path):
    """An episode in which nobody moves, and a camera that looks at a street instead."""

    def street(camera: str, episode: int, states: np.ndarray) -> Iterator[np.ndarray]:
        return film(camera, episode + 50, wander(episode + 50, len(states)))

    write_filmed(tmp_path / "dataset", rests=3)
    shoot(tmp_path / "dataset", SIDE, street)
    audit = silent(tmp_path / "dataset", pictures=True)
    assert any(line.startswith(f"whether the pictures of {SIDE} show where") for line in audit.not_checked)


@pytest.mark.parametrize("kind", ["frozen for an episode", "one camera twice in an episode", "two episodes exchanged"])
def test_decoded_images_show_the_same_as_decoded_videos(kind, album):
    wrong, check, severity, says = SEEN[kind]
    photograph(album, SIDE, wrong)
    [finding] = of_cameras(z2r.audit(album, pictures=True))
    assert (finding.check, finding.severity) == (check, severity)
    assert re.search(f"{SIDE} {says}", str(finding))


def test_nothing_is_said_of_decoded_images_that_are_right(photographed):
    silent(photographed, pictures=True)


def spoil_pictures(path: Path) -> None:
    """Let the index of a video be whole, and its pictures be nothing."""
    data = path.read_bytes()
    start = data.index(b"mdat") + 4
    path.write_bytes(data[:start] + bytes(len(data) - start))


def test_pictures_that_cannot_be_decoded_are_named(root):
    spoil_pictures(video(root, SIDE))
    silent(root)
    audit = z2r.audit(root, pictures=True)
    [finding] = of_cameras(audit)
    assert (finding.check, finding.severity, finding.file) == ("video-file", "error", SIDE_VIDEO)
    assert any(f"what {SIDE} shows in 8 of 8 episodes" in line for line in audit.not_checked)


def test_an_image_that_cannot_be_decoded_is_named(album):
    whole = encoded(next(film(SIDE, 0, wander(0, 1))))
    put_image(0, whole[:60] + bytes(len(whole) - 80) + whole[-20:])(album)
    silent(album)
    [finding] = of_cameras(z2r.audit(album, pictures=True))
    assert (finding.check, finding.field) == ("camera-format", f"{SIDE} in row 0")


def test_an_image_that_is_too_large_is_not_decoded(photographed, monkeypatch):
    monkeypatch.setattr(decoding, "_MAX_PIXELS", SIZE[0] * SIZE[1] - 1)
    assert {finding.check for finding in of_cameras(z2r.audit(photographed, pictures=True))} == {"camera-format"}


def test_a_video_of_too_large_pictures_is_not_decoded(filmed, monkeypatch):
    monkeypatch.setattr(decoding, "_MAX_PIXELS", SIZE[0] * SIZE[1] - 1)
    assert {finding.check for finding in of_cameras(z2r.audit(filmed, pictures=True))} == {"video-file"}


def test_bytes_that_name_other_files_open_none(root, monkeypatch):
    """FFmpeg takes some texts for lists of files."""
    index = read_video_index(root, Path(SIDE_VIDEO))
    monkeypatch.chdir(video(root, FRONT).parent)
    video(root, SIDE).write_text(f"ffconcat version 1.0\nfile {video(root, FRONT).name}\n")
    with pytest.raises(z2r.DatasetError):
        list(decoding.decode_video(root, Path(SIDE_VIDEO), index, np.arange(8)))


def test_all_pictures_of_a_long_group_are_decoded(tmp_path):
    write_video(tmp_path / "a.mp4", PICTURES, g="40", bf="3")
    index, wanted = index_of(tmp_path / "a.mp4"), np.array([3, 17, 18, 41, 49])
    decoded = dict(decoding.decode_video(tmp_path, Path("a.mp4"), index, wanted))
    assert sorted(decoded) == wanted.tolist()
    for number, small in decoded.items():
        assert np.abs(small.colours.mean(axis=(0, 1)) - PICTURES[0][number].mean(axis=(0, 1))).max() < 3


def test_progress_is_told_of_files_and_of_episodes(filmed):
    told = []
    z2r.audit(filmed, progress=lambda done, total: told.append((done, total)), pictures=True)
    assert told[0] == (1, 1)
    assert told[-1] == (2 * len(LENGTHS), 2 * len(LENGTHS))


def test_other_processes_see_what_threads_see(root):
    shoot(root, SIDE, only(frozen, 3), codec="libsvtav1")
    with ProcessPoolExecutor(2, mp_context=multiprocessing.get_context("spawn")) as processes:
        for how in ({}, {"pictures": True}):
            audit = z2r.audit(root, executor=processes, **how)
            assert of_cameras(audit)
            assert audit == z2r.audit(root, **how)


def test_what_nobody_looked_at_is_said(filmed, photographed):
    for dataset in (filmed, photographed):
        [line] = (line for line in z2r.audit(dataset).not_checked if "--pictures" in line)
        assert FRONT in line
        assert SIDE in line


@pytest.mark.parametrize("module", ["footage", "glances"])
def test_a_reader_of_pictures_that_fails_is_a_finding_and_not_the_end(module, filmed, monkeypatch):
    monkeypatch.setattr(f"z2r.audits.{module}.read_video", lambda *_: 1 / 0)
    audit = z2r.audit(filmed, pictures=True)
    assert [finding.check for finding in of_cameras(audit)] == [AUDIT.name]
    assert any("the pictures" in line for line in audit.not_checked)
    assert audit.n_frames == N_FRAMES


def run(*args: object) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, "-c", "from z2r.cli import main; main()", "audit", *map(str, args)]
    return subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)


def test_the_command_decodes_pictures_only_when_it_is_told_to(root):
    shoot(root, SIDE, only(exchanged, 0, 4))
    assert run(root).returncode == 0
    decoded = run(root, "--pictures")
    assert (decoded.returncode, decoded.stderr) == (1, "")
    assert "camera-motion" in decoded.stdout


def test_the_command_says_what_it_needs_to_decode(filmed, monkeypatch, capsys):
    monkeypatch.setattr("importlib.util.find_spec", lambda name: None)
    monkeypatch.setattr(sys, "argv", ["z2r", "audit", str(filmed), "--pictures"])
    with pytest.raises(SystemExit) as end:
        main()
    assert end.value.code == 2
    said = capsys.readouterr()
    assert said.out == ""
    assert re.fullmatch(r"z2r: .*pip install '.\[video\]'\n", said.err)


def test_every_check_of_a_camera_is_made_to_fail():
    named = {check for fault in (*FAULTS.values(), *IMAGE_FAULTS.values()) for check in fault.checks.split()}
    of_cameras = {part.check.name for part in parts_in(cameras, pictures)} - {
        "stats",
        "task-colour",
    }  # they have tests of their own
    assert named | {check for _, check, *_ in SEEN.values()} >= of_cameras
