"""Can two solid bodies be in one place? The pusher and the block of a frame, to move by hand, and their overlap."""

import os

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.patches import Circle

from z2r.api import load
from z2r.arrays import Floats
from z2r.course import animated, drawing
from z2r.course.moving.bodies import shape_of
from z2r.course.moving.picture import MovingPicture, make, new_still
from z2r.format.dataset import Dataset
from z2r.format.schema import Schema
from z2r.pusht.overlap import LIMIT, overlap, pusher_in_block
from z2r.pusht.task import PUSHER_RADIUS
from z2r.pusht.world import BODIES, PUSHT, TEE_BOXES
from z2r.reading.breaks import break_mode
from z2r.reading.decode import Decoded, decode

_TITLE = "Can the pusher be inside of the block?"
_SAYS = "Drag the pusher, or use the sliders. Then read the block's yaw swapped."
_REACH = 0.16  # m: how far from the block the pusher can be moved
_PICTURES = 24
_FROM = 1.5  # times the way from the block to the pusher: there it begins
_MILLISECONDS = 150


def push_in(dataset: Dataset | str | os.PathLike[str] = "standin") -> MovingPicture:
    """Show the frame of a dataset in which a swapped yaw has the pusher deepest in the block, with the pusher to move.

    Parameters
    ----------
    dataset : Dataset, str or path, optional
        From `z2r.load`, or what that takes; with the columns of PushT.

    Raises
    ------
    DatasetError
        If a file is missing, damaged, or not what the schema and the index say.
    ValueError
        If the schema lacks a column of PushT.

    Examples
    --------
    >>> push_in("standin")
    Moving picture: Can the pusher be inside of the block?
    """
    dataset = dataset if isinstance(dataset, Dataset) else load(dataset)
    frames, readings = dataset.read(PUSHT.feature), (PUSHT, break_mode("yaw-swap").reading(PUSHT))
    deepest = int(overlap(decode(frames, readings[1], dataset.schema)).argmax())
    row = frames[deepest : deepest + 1].astype(np.float64)
    right, wrong = (decode(row, reading, dataset.schema) for reading in readings)
    block, pusher = right.pose("tee"), right.pose("pusher")
    data = {
        "frame": deepest,
        "bodies": [shape_of(BODIES[name]) for name in ("tee", "pusher")],
        "boxes": TEE_BOXES,
        "limit": LIMIT,
        "reach": _REACH,
        # The numbers that all is worked out from stay as they are.
        "pusher": [(pusher.x - block.x).item(), (pusher.y - block.y).item()],
        "yaws": [right.yaw("tee").item(), wrong.yaw("tee").item()],
    }
    return make("contact", _TITLE, _SAYS, data, _still(_pushed_in(row, dataset.schema)))


def _pushed_in(row: Floats, schema: Schema) -> Decoded:
    """Return frames in which the pusher goes from where it is to the middle of the block's bar."""
    places = schema.columns(PUSHT.feature, ["pusher_x", "pusher_y", "tee_x", "tee_y"])
    (pusher, block), frames = np.split(row[0, places], 2), np.repeat(row, _PICTURES, axis=0)
    way = np.linspace(_FROM, 0, _PICTURES)[:, None]
    frames[:, places[:2]] = block + way * (pusher - block)
    return decode(frames, PUSHT, schema)


@drawing.in_style
def _still(decoded: Decoded) -> bytes:
    figure = new_still(_TITLE, 3.6)
    above, inside = figure.subplots(1, 2)
    block, depth = decoded.pose("tee"), 1000 * overlap(decoded)
    _set_view(above, "seen from above", (block.x[0], block.y[0]))
    drawing.draw_bodies(inside, BODIES["tee"], drawing.single_pose(0, 0, 0), drawing.TEE, "block", fill=0.7)
    _set_view(inside, "seen from the block", (0, 0))
    move_bodies, seen = drawing.put_bodies(above, decoded), np.stack(pusher_in_block(decoded), axis=1)
    pusher = inside.add_patch(Circle((0, 0), PUSHER_RADIUS, facecolor=(drawing.PUSHER, 0.7), edgecolor=drawing.PUSHER))
    caption = figure.supxlabel(" ", size=11)

    def move(frame: int) -> list[Artist]:
        pusher.set_center(tuple(seen[frame]))
        verdict = ", which no contact gives" if depth[frame] > 1000 * LIMIT else ""
        caption.set_text(f"overlap {depth[frame]:.1f} mm{verdict}")
        return [*move_bodies(frame), pusher, caption]

    return animated.film(figure, move, range(_PICTURES), _MILLISECONDS)


def _set_view(axes: Axes, title: str, middle: tuple[float, float]) -> None:
    x, y = middle
    axes.set(aspect="equal", xlim=(x - _REACH, x + _REACH), ylim=(y - _REACH, y + _REACH), xticks=[], yticks=[])
    axes.set_title(title, size=11)
