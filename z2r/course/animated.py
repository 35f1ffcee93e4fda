"""How does a picture move where no script runs? As an animated PNG: whatever shows a PNG shows it."""

import io
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import pairwise

import numpy as np
from matplotlib.artist import Artist
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from PIL import Image
from PIL.PngImagePlugin import Blend

_COLORS = 63  # surfaces are plain. One more is transparent.
_HOLD = 2000  # ms: the last picture stays before it begins again


def film(figure: Figure, move: Callable[[int], Sequence[Artist]], frames: Iterable[int], milliseconds: int) -> bytes:
    """Return a moving picture of a figure.

    Parameters
    ----------
    figure : Figure
        What is drawn.
    move : callable
        Brings it to how it is in a frame, and returns all that it moves, from below to above.
    frames : iterable of int
        Which are shown, at least one.
    milliseconds : int
        How long each is shown. The last one, which is also what is shown where nothing moves, stays longer.
    """
    return _animate(list(_snapshots(figure, move, list(frames))), milliseconds)


def _snapshots(figure: Figure, move: Callable[[int], Sequence[Artist]], frames: list[int]) -> Iterator[Image.Image]:
    """Draw what stays once, and what moves for each frame."""
    canvas = FigureCanvasAgg(figure)
    moving = move(frames[0])
    canvas.draw()  # lays it out
    figure.set_layout_engine("none")
    for each in moving:  # an axis draws its label even where that is animated: hide all of them
        each.set_visible(False)
    canvas.draw()
    ground = canvas.copy_from_bbox(figure.bbox)
    for each in moving:
        each.set_visible(True)
    for frame in frames:
        canvas.restore_region(ground)
        for each in move(frame):
            figure.draw_artist(each)
        yield Image.fromarray(np.asarray(canvas.buffer_rgba()).copy()).convert("RGB")


def _animate(pictures: Sequence[Image.Image], milliseconds: int) -> bytes:
    some = [np.asarray(pictures[len(pictures) * part // 4]) for part in range(4)]
    palette = Image.fromarray(np.concatenate([*some, np.asarray(pictures[-1])])).quantize(_COLORS)
    palette.putpalette([*(palette.getpalette() or []), 0, 0, 0])  # and what is transparent
    flat = [each.quantize(palette=palette, dither=Image.Dither.NONE) for each in pictures]
    changes = [_changed(before, now) for before, now in pairwise(flat)]
    made = io.BytesIO()
    flat[-1].save(
        made,
        "PNG",
        save_all=True,
        default_image=True,
        append_images=[flat[0], *changes],
        duration=[0] + [milliseconds] * len(changes) + [_HOLD],
        loop=0,
        blend=Blend.OP_OVER,
        transparency=_COLORS,
        optimize=True,
    )
    return made.getvalue()


def _changed(before: Image.Image, now: Image.Image) -> Image.Image:
    """Return a picture that is transparent where it is as before, and so takes little room."""
    same = np.asarray(before) == np.asarray(now)
    changed = Image.fromarray(np.where(same, np.uint8(_COLORS), np.asarray(now)), "P")
    changed.putpalette(now.getpalette() or [])
    return changed
