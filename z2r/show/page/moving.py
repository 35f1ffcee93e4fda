"""What does a dataset look like where no script runs? A small picture that moves: its first episode, again and again.

It shows the bodies from above, or else what the cameras saw. It needs Pillow, which Matplotlib brings along.
"""

import importlib.util
import io
import math
from itertools import islice
from typing import TYPE_CHECKING

import numpy as np

from z2r.arrays import Floats
from z2r.errors import DatasetError
from z2r.format.decoding import can_decode, decode_clip
from z2r.reading.bodies import Body, Role
from z2r.reading.poses import Pose
from z2r.reading.reading import Reading
from z2r.show.page.content import Content
from z2r.show.page.films import Film
from z2r.show.page.pictures import Camera, camera_of, disc_radius, floor_of

if TYPE_CHECKING:
    from PIL.Image import Image

MAX_BYTES = 200_000  # in a notebook, it becomes a third more
_MAX_PICTURES = 48
_MAX_CAMERAS = 3  # side by side
_HALF = 200  # half the width of the bodies from above [pixels]
_WIDTH = 240  # of what a camera saw [pixels]
_FINE = 2  # so much larger it is drawn, so that its edges are smooth
_HOLD = 1500  # ms: the last picture stays before it begins again

_INKS: dict[Role, tuple[int, int, int]] = {"object": (0, 114, 178), "goal": (0, 158, 115), "robot": (213, 94, 0)}
_FILL: dict[Role, int] = {"object": 210, "goal": 36, "robot": 255}  # of 255: how little shines through
_FLOOR, _GRID, _WALLS = (255, 254, 251), (233, 230, 221), (123, 127, 134)


def moving_picture(content: Content) -> bytes:
    """Return an animated WebP of the first episode that is shown; nothing where there is nothing to see it with.

    It is never larger than `MAX_BYTES`.
    """
    if not importlib.util.find_spec("PIL"):
        return b""
    reading = content.inspection.reading
    pictures = _from_above(content, reading) if reading and reading.poses else _filmed(content)
    seconds = float(content.shown.lengths[0]) / content.schema.fps
    while pictures and len(made := _encode(pictures, 1000 * seconds / len(pictures))) > MAX_BYTES:
        pictures = pictures[::2] if len(pictures) > 1 else []
    return made if pictures else b""


def _encode(pictures: "list[Image]", milliseconds: float) -> bytes:
    made = io.BytesIO()
    first, *others = pictures
    durations = [round(milliseconds)] * len(others) + [_HOLD]
    first.save(made, "WEBP", save_all=True, append_images=others, duration=durations, loop=0, quality=80)
    return made.getvalue()


def _some(n: int) -> range:
    """Return which of `n` are shown: all, or every second one, and so on."""
    return range(0, n, math.ceil(n / _MAX_PICTURES))


def _from_above(content: Content, reading: Reading) -> "list[Image]":
    """Draw the bodies where they are in some frames, with the paths that led there."""
    from PIL import ImageDraw

    decoded, camera = content.decoded(reading).take(content.shown[0]), camera_of(content, reading)
    poses = {name: decoded.pose(name) for name in content.bodies}
    empty, pictures = _floor(content, camera), []
    for frame in _some(int(content.shown.lengths[0])):
        picture = empty.copy()
        draw = ImageDraw.Draw(picture, "RGBA")  # so that what is below shines through
        for name, body in content.bodies.items():
            path = np.stack([poses[name].x, poses[name].y], axis=1)[: frame + 1]
            draw.line(_seen(path, camera), fill=_INKS[body.role], width=_FINE)
        for name, body in content.bodies.items():
            if corners := _seen(_corners(body, poses[name], frame, camera), camera):
                ink = _INKS[body.role]
                draw.polygon(corners, fill=(*ink, _FILL[body.role]), outline=ink, width=2 * _FINE)
        pictures.append(picture.reduce(_FINE))
    return pictures


def _floor(content: Content, camera: Camera) -> "Image":
    from PIL import Image, ImageDraw

    picture = Image.new("RGB", (2 * _FINE * _HALF,) * 2, _FLOOR)
    draw, floor = ImageDraw.Draw(picture), floor_of(content, camera)
    for line in floor.lines:
        draw.line(_seen(np.array(line), camera), fill=_GRID, width=_FINE)
    if content.scene:
        [(x, y)] = _seen(np.array([floor.corner]), camera)
        width = floor.width * _scale(camera)
        draw.rectangle((x, y - width, x + width, y), outline=_WALLS, width=2 * _FINE)
    return picture


def _corners(body: Body, pose: Pose, frame: int, camera: Camera) -> Floats:
    """Return the outline of a body in a frame, float64[n, 2]; a disc where it has none."""
    corners, turn = body.outline, 0.0 if pose.yaw is None else float(pose.yaw[frame])
    if not len(corners):
        around = np.linspace(0, 2 * np.pi, 32)
        corners = disc_radius(body, camera) * np.stack([np.cos(around), np.sin(around)], axis=1)
    rotation = np.array([(np.cos(turn), np.sin(turn)), (-np.sin(turn), np.cos(turn))])
    turned: Floats = corners @ rotation + (pose.x[frame], pose.y[frame])
    return turned


def _scale(camera: Camera) -> float:
    return _FINE * _HALF / camera.half


def _seen(points: Floats, camera: Camera) -> list[tuple[float, float]]:
    """Return where points are in the picture [pixels], as far as they are known."""
    pixels = (points - camera.middle) * (1, -1) * _scale(camera) + _FINE * _HALF
    return [(x, y) for x, y in pixels[np.isfinite(pixels).all(axis=1)].tolist()]


def _filmed(content: Content) -> "list[Image]":
    """Put some pictures of the cameras side by side."""
    from PIL import Image

    length, fps = int(content.shown.lengths[0]), content.schema.fps
    strips = [strip for strip in (_watch(film, length, fps) for film in content.films) if strip][:_MAX_CAMERAS]
    pictures = []
    for row in zip(*strips, strict=False):
        ends = np.cumsum([each.width for each in row]).tolist()
        picture = Image.new("RGB", (ends[-1], max(each.height for each in row)))
        for each, end in zip(row, ends, strict=True):
            picture.paste(each, (end - each.width, 0))
        pictures.append(picture)
    return pictures


def _watch(film: Film, length: int, fps: float) -> "list[Image]":
    """Decode some pictures of an episode, the first of so many frames; none where that cannot be done."""
    from PIL import Image

    own = [each.data for each in film.pictures if each.at < length]
    try:
        if own:
            return [_small(own[place]) for place in _some(len(own))]
        if film.clips and can_decode():
            clip, shown = film.clips[0], _some(min(length, film.clips[0].n_frames))
            pictures = decode_clip(clip.data, clip.offset, shown.step / fps, _WIDTH)
            return [Image.fromarray(each) for each in islice(pictures, len(shown))]
    except (DatasetError, OSError, ValueError, Image.DecompressionBombError):
        pass  # the page says what is wrong with them
    return []


def _small(picture: bytes) -> "Image":
    from PIL import Image

    with Image.open(io.BytesIO(picture)) as whole:
        return whole.convert("RGB").resize((_WIDTH, max(1, round(_WIDTH * whole.height / whole.width))))
