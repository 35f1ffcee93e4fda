"""What lies between two episodes? Frames on both sides of an end, to scrub across, and how far things move in each."""

import base64
import io
import os

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.ticker import MaxNLocator
from PIL import Image

from z2r.api import choose_reading, load
from z2r.arrays import Floats
from z2r.course import animated, drawing
from z2r.course.cameras import picture
from z2r.course.figures import camera_pictures
from z2r.course.moving.bodies import bodies_in, rounded, square_around
from z2r.course.moving.picture import MovingPicture, make, new_still
from z2r.format.dataset import Dataset
from z2r.format.schema import STATE
from z2r.format.videos import video_features
from z2r.reading.decode import Decoded, decode, features_of
from z2r.reading.reading import Reading

_FRAMES = 10  # on each side of the end
_PICTURES = 6  # the same, where cameras saw it: these take more room
_QUALITY = 75
_MILLISECONDS = 400


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
    MissingExtraError
        If there is a film to show, and PyAV is not installed.
    ValueError
        If there is no such episode, or it is the last; or it has neither bodies nor a film.

    Examples
    --------
    >>> seam("standin", 0)
    Moving picture: Where episode 0 ends and episode 1 begins
    """
    dataset = dataset if isinstance(dataset, Dataset) else load(dataset)
    if not 0 <= episode < len(dataset.episodes) - 1:
        raise ValueError(f"found episode {episode}, expected one of {len(dataset.episodes)} that is not the last")
    reading = choose_reading(dataset.schema)
    if reading and reading.poses and not reading.missing(dataset.schema):
        return _from_above(dataset, reading, episode)
    if not video_features(dataset.schema):
        raise ValueError("found neither poses in a reading nor a video, expected one of them to show")
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
    """Show what the cameras saw, and how far the joint went that went farthest."""
    frames = _around(dataset, episode, _PICTURES)
    changes = np.abs(np.diff(dataset.read(STATE)[frames].astype(np.float64), axis=0))
    steps, labels = changes.max(axis=1), dataset.schema.features[STATE].labels
    farthest = zip(changes.argmax(axis=1), steps, strict=True)
    data: dict[str, object] = {
        "first": frames.start,
        "pictures": [_seen(dataset, frame) for frame in range(frames.start, frames.stop)],
        "steps": rounded(steps),
        "said": [f"{labels[joint]} changed by {step:.1f}, more than any other" for joint, step in farthest],
    }
    says = "Scrub across the end, with the slider or along the bars. What happened between the two frames?"
    end, still = int(dataset.episodes.to_index[episode]), io.BytesIO()
    camera_pictures(dataset, [end - 1, end]).savefig(still, format="png")
    return _make(dataset, episode, says, data, still.getvalue())


def _seen(dataset: Dataset, frame: int) -> str:
    """Return what all cameras saw in a frame, side by side, as an address that holds the picture itself."""
    pictures = [picture(dataset, camera, frame) for camera in video_features(dataset.schema)]
    made = io.BytesIO()
    Image.fromarray(np.concatenate(pictures, axis=1)).save(made, "WEBP", quality=_QUALITY, method=6)
    return f"data:image/webp;base64,{base64.b64encode(made.getvalue()).decode()}"


def _draw_steps(axes: Axes, steps: Floats, first: int, end: int) -> None:
    numbers = first + 1 + np.arange(len(steps))
    axes.bar(numbers, steps, color=np.where(numbers == end, drawing.WRONG, drawing.RIGHT).tolist())
    axes.set(xlabel="frame of the dataset", ylabel="change since the frame before")
    axes.xaxis.set_major_locator(MaxNLocator(integer=True))
