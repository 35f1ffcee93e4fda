"""What happened in an episode? Its film, told push by push: a push is a run of frames in which the block moves."""

import os
from itertools import pairwise
from typing import NamedTuple

import numpy as np
from matplotlib.artist import Artist

from z2r.api import load
from z2r.course import animated, drawing
from z2r.course.moving.bodies import bodies_in, rounded, square_around
from z2r.course.moving.picture import MovingPicture, make, new_still
from z2r.format.dataset import Dataset
from z2r.pusht.world import BODIES, PUSHT
from z2r.reading.decode import Decoded, decode
from z2r.reading.success import FrameErrors, episode_reached, frame_errors

_MOVES = 0.001  # m from one frame to the next: less is at rest
_WALKS = "The block rests while the pusher walks around it."
_SAYS = "Play it, move through it, or go to a part of the story."
_STEP = 2  # frames from one picture of the still to the next


class Part(NamedTuple):
    """A part of the story: its first frame, the one after its last, what it is, and what happens."""

    start: int
    stop: int
    what: str
    says: str


def story(dataset: Dataset | str | os.PathLike[str] = "standin", episode: int = 0) -> MovingPicture:
    """Show an episode of PushT as a film with captions.

    Parameters
    ----------
    dataset : Dataset, str or path, optional
        From `z2r.load`, or what that takes; with the columns of PushT.
    episode : int, optional
        Which one.

    Raises
    ------
    DatasetError
        If a file is missing, damaged, or not what the schema and the index say.
    ValueError
        If the schema lacks a column of PushT.

    Examples
    --------
    >>> story("standin", 0)
    Moving picture: Episode 0, push by push
    """
    dataset = dataset if isinstance(dataset, Dataset) else load(dataset)
    frames = dataset.read(PUSHT.feature)[dataset.episodes[episode]]
    decoded = decode(frames, PUSHT, dataset.schema)
    errors, title = frame_errors(decoded), f"Episode {episode}, push by push"
    parts = _parts(decoded, errors)
    data = {
        "fps": dataset.schema.fps,
        "bodies": bodies_in(decoded),
        "view": rounded(square_around(decoded)),
        "traces": [
            {"name": goal.name, "unit": PUSHT.unit(goal), "limit": goal.within, "values": rounded(errors[goal.name])}
            for goal in PUSHT.goal
        ],
        "parts": parts,
    }
    return make("pushes", title, _SAYS, data, _still(decoded, errors, parts, title, dataset.schema.fps))


def _parts(decoded: Decoded, errors: FrameErrors) -> list[Part]:
    """Cut an episode into pushes and what is between them, and say what each did."""
    steps = np.hypot(*np.diff(drawing.place(decoded.pose("tee")), axis=0).T)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], steps > _MOVES, [False]]).astype(int))).tolist()
    pushes, cuts = edges[::2], sorted({0, *edges})
    parts = []
    for start, stop in pairwise(cuts):
        what = f"Push {pushes.index(start) + 1}" if start in pushes else "Walk"
        parts.append(Part(start, stop, what, _did(errors, start, stop) if start in pushes else _WALKS))
    reached = "within both limits: reached" if episode_reached(decoded) else "not within both limits: not reached"
    return [*parts, Part(cuts[-1], len(decoded), "End", f"The last stored frame is {reached}.")]


def _did(errors: FrameErrors, start: int, stop: int) -> str:
    distance, turn = (errors[name][[start, stop]] for name in ("pos_err", "ang_err"))
    way = "brings the block nearer" if distance[1] < distance[0] else "pushes the block away"
    sense = "turns it the right way" if turn[1] < turn[0] else "turns it the wrong way"
    lengths = "{:.0f} to {:.0f} mm".format(*1000 * distance)
    return f"It {way}, {lengths}, and {sense}, {turn[0]:.2f} to {turn[1]:.2f} rad."


@drawing.in_style
def _still(decoded: Decoded, errors: FrameErrors, parts: list[Part], title: str, fps: float) -> bytes:
    figure = new_still(title, 3.9)
    grid = figure.add_gridspec(len(PUSHT.goal), 2)
    scene = figure.add_subplot(grid[:, 0])
    x, y, width = square_around(decoded)
    scene.set(aspect="equal", xlim=(x, x + width), ylim=(y, y + width), xticks=[], yticks=[])
    drawing.draw_goal(scene, BODIES["target"], decoded.pose("target"))
    move_bodies, caption = drawing.put_bodies(scene, decoded), figure.supxlabel(" ", size=11)
    path, seconds = drawing.place(decoded.pose("pusher")), np.arange(len(decoded)) / fps
    [line] = scene.plot([], [], color=drawing.PUSHER, linewidth=1)
    cursors = []
    for row, goal in enumerate(PUSHT.goal):
        axes = figure.add_subplot(grid[row, 1])
        axes.axhspan(0, goal.within or 0, color=drawing.GREEN, alpha=0.2, linewidth=0)
        axes.plot(seconds, errors[goal.name], color=drawing.BLUE)
        axes.set(ylabel=f"{goal.name} [{PUSHT.unit(goal)}]", ylim=(0, None), xlim=(0, seconds[-1]))
        cursors.append(axes.axvline(0, color=drawing.INK, linewidth=1))

    def move(frame: int) -> list[Artist]:
        part = next(part for part in parts if part.start <= frame < part.stop)
        caption.set_text(f"{part.what}. {part.says}")
        line.set_data(*path[: frame + 1].T)
        for cursor in cursors:
            cursor.set_xdata([frame / fps])
        return [line, *move_bodies(frame), *cursors, caption, scene.set_title(f"{frame / fps:.1f} s", size=11)]

    frames = sorted({*range(0, len(decoded), _STEP), len(decoded) - 1})
    return animated.film(figure, move, frames, round(1000 * _STEP / fps))
