"""What lies between two episodes? Frames on both sides of an end, to scrub across, and how far things move in each."""

import base64
import io
import os
from collections.abc import Iterator
from itertools import islice

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator
from numpy.typing import NDArray
from PIL import Image

from z2r.api import choose_reading, load
from z2r.arrays import Floats
from z2r.course import animated, drawing
from z2r.course.moving.bodies import bodies_in, rounded, square_around
from z2r.course.moving.picture import MovingPicture, make, new_still
from z2r.format.dataset import Dataset
from z2r.format.decoding import can_decode, decode_clip
from z2r.format.schema import STATE
from z2r.reading.decode import Decoded, decode, features_of
from z2r.reading.inspection import inspect_dataset
from z2r.reading.reading import Reading
from z2r.show.page.films import Clip, read_films

_FRAMES = 10  # on each side of the end
_PICTURES = 6  # the same, where cameras saw it: these take more room
_WIDTH = 200  # of what a camera saw [pixels]
_QUALITY = 75
_MILLISECONDS = 400
_ALL = 2**31  # bytes


def seam(dataset: Dataset | str | os.PathLike[str] = "standin", episode: int = 0) -> MovingPicture:
    """Show the frames around the end of an episode: its bodies from above, or else what the cameras saw.

    Parameters
    ----------
    dataset : Dataset, str or path, optional
        From `z2r.load`, or what that takes. Its frames are in memory at once.
    episode : int, optional
        The one that ends; another one comes after it.

    Raises
    ------
    DatasetError
        If a file is missing, damaged, or not what the schema and the index say.
    ValueError
        If there is no such episode, or it is the last.

    Examples
    --------
    >>> seam("standin", 0)
    Moving picture: Where episode 0 ends and episode 1 begins
    """
    dataset = dataset if isinstance(dataset, Dataset) else load(dataset)
    if not 0 <= episode < len(dataset.episodes) - 1:
        raise ValueError(f"found episode {episode}, expected one of {len(dataset.episodes)} that is not the last")
    reading = choose_reading(dataset.schema)
    if reading and reading.poses:
        return _from_above(dataset, reading, episode)
    return _filmed(dataset, episode)


def _around(dataset: Dataset, episode: int, n_frames: int) -> slice:
    before, after = dataset.episodes[episode], dataset.episodes[episode + 1]
    return slice(max(before.start, before.stop - n_frames), min(after.stop, after.start + n_frames))


def _make(dataset: Dataset, episode: int, says: str, data: dict[str, object], still: bytes) -> MovingPicture:
    end = int(dataset.episodes.to_index[episode])
    return make("seams", _title(episode), says, data | {"end": end, "episode": episode}, still)


def _title(episode: int) -> str:
    return f"Where episode {episode} ends and episode {episode + 1} begins"


def _from_above(dataset: Dataset, reading: Reading, episode: int) -> MovingPicture:
    frames = _around(dataset, episode, _FRAMES)
    columns = {name: dataset.read(name)[frames] for name in features_of(reading, dataset.schema)}
    decoded = decode(columns, reading, dataset.schema)
    bodies = drawing.bodies_to_draw(decoded)
    name = drawing.moved_of(bodies)
    steps = np.hypot(*np.diff(drawing.place(decoded.pose(name)), axis=0).T)
    label, unit = bodies[name].label, reading.poses[name].unit
    data: dict[str, object] = {
        "first": frames.start,
        "bodies": bodies_in(decoded),
        "view": rounded(square_around(decoded)),
        "steps": rounded(steps),
        "said": [f"the {label} moved by {step:.3f} {unit}".strip() for step in steps],
    }
    most = f"How far can a {label} go in {1 / dataset.schema.fps:.2g} s?"
    says = f"Scrub across the end, with the slider or along the bars. {most}"
    end = int(dataset.episodes.to_index[episode])
    still = _still_from_above(decoded, steps, frames.start, end, episode)
    return _make(dataset, episode, says, data, still)


@drawing.in_style
def _still_from_above(decoded: Decoded, steps: Floats, first: int, end: int, episode: int) -> bytes:
    figure = new_still(_title(episode), 3.9)
    scene, chart = figure.subplots(1, 2, width_ratios=[4, 5])
    x, y, width = square_around(decoded)
    scene.set(aspect="equal", xlim=(x, x + width), ylim=(y, y + width), xticks=[], yticks=[])
    bodies = drawing.bodies_to_draw(decoded)
    name, goal = drawing.moved_of(bodies), drawing.body_of_role(bodies, "goal")
    if goal is not None:
        drawing.draw_goal(scene, bodies[goal], decoded.pose(goal))
    move_bodies = drawing.put_bodies(scene, decoded)
    _draw_steps(chart, steps, first, end)
    chart.set_ylabel(f"moved since the frame before [{decoded.reading.poses[name].unit}]")
    chart.set_title(f"episode {episode} to frame {end - 1}, episode {episode + 1} from {end}", size=11)
    now = chart.axvline(first, color=drawing.INK, linewidth=1)

    def move(frame: int) -> list[Artist]:
        now.set_xdata([first + frame])
        return [*move_bodies(frame), now, scene.set_title(f"frame {first + frame}", size=11)]

    return animated.film(figure, move, range(len(decoded)), _MILLISECONDS)


def _filmed(dataset: Dataset, episode: int) -> MovingPicture:
    """Show what the cameras saw, if it can be decoded, and how far the joint went that went farthest."""
    frames = _around(dataset, episode, _PICTURES)
    changes = np.abs(np.diff(dataset.read(STATE)[frames].astype(np.float64), axis=0))
    steps, labels = changes.max(axis=1), dataset.schema.features[STATE].labels
    pictures = _pictures(dataset, episode, frames)
    data: dict[str, object] = {
        "first": frames.start,
        "pictures": [_webp(each) for each in pictures],
        "steps": rounded(steps),
        "said": [
            f"{labels[joint]} changed by {step:.1f}, more than any other"
            for joint, step in zip(changes.argmax(axis=1), steps, strict=True)
        ],
    }
    says = "Scrub across the end, with the slider or along the bars. What happened between the two frames?"
    end = int(dataset.episodes.to_index[episode])
    pair = pictures[end - frames.start - 1 :][:2]
    still = _still_of_cameras(pair, steps, frames.start, end, _title(episode))
    return _make(dataset, episode, says, data, still)


def _pictures(dataset: Dataset, episode: int, frames: slice) -> list[Image.Image]:
    """Decode what all cameras saw in some frames of an episode and the next one, side by side."""
    if not can_decode():
        return []
    inspection = inspect_dataset(dataset)
    pair = dataset.episodes.only(np.isin(np.arange(len(dataset.episodes)), (episode, episode + 1)))
    end = int(dataset.episodes.to_index[episode])
    before, after = end - frames.start, frames.stop - end
    clips = [film.clips for film in read_films(inspection, pair, _ALL) if len(film.clips) == 2]
    fps = dataset.schema.fps
    strips = [
        [*_decoded(one, one.n_frames - before, before, fps), *_decoded(other, 0, after, fps)] for one, other in clips
    ]
    return [Image.fromarray(np.concatenate(row, axis=1)) for row in zip(*strips, strict=True)]


def _decoded(clip: Clip, frame: int, n_frames: int, fps: float) -> Iterator[NDArray[np.uint8]]:
    return islice(decode_clip(clip.data, clip.offset + frame / fps, 1 / fps, _WIDTH), n_frames)


def _webp(picture: Image.Image) -> str:
    made = io.BytesIO()
    picture.save(made, "WEBP", quality=_QUALITY, method=6)
    return f"data:image/webp;base64,{base64.b64encode(made.getvalue()).decode()}"


@drawing.in_style
def _still_of_cameras(pair: list[Image.Image], steps: Floats, first: int, end: int, title: str) -> bytes:
    """Show the last picture of one episode and the first of the next; without them, how far things moved."""
    figure = new_still(title, 2.4)
    if not pair:
        _draw_steps(figure.subplots(), steps, first, end)
    for number, (picture, what) in enumerate(zip(pair, ("the last", "the first"), strict=False), 1):
        axes = figure.add_subplot(1, 2, number)
        axes.imshow(np.asarray(picture))
        axes.set(title=f"frame {end - 2 + number}: {what}", xticks=[], yticks=[])
    made = io.BytesIO()
    figure.savefig(made, format="png")
    return made.getvalue()


def _draw_steps(axes: Axes, steps: Floats, first: int, end: int) -> None:
    numbers = first + 1 + np.arange(len(steps))
    axes.bar(numbers, steps, color=np.where(numbers == end, drawing.WRONG, drawing.RIGHT).tolist())
    axes.set(xlabel="frame of the dataset", ylabel="change since the frame before")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
