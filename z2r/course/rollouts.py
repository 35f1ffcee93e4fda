"""What did the policies do? Rollouts from the same start, side by side: as paths, and as a film."""

from collections.abc import Callable, Mapping
from functools import cache

from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from z2r.course import animated, drawing
from z2r.data import STANDIN
from z2r.format.dataset import load
from z2r.format.schema import Schema
from z2r.pusht.played import Rollout
from z2r.pusht.task import CONTROL_HZ
from z2r.pusht.world import BODIES, PUSHT
from z2r.reading.decode import Decoded, decode

type Rollouts = Mapping[str, Rollout]
"""By what they are called on the page."""

WALL = {
    "read right": "right",
    "actions half a second late": "late-5",
    "x and y exchanged": "exchanged",
    "yaw read as atan2(cos, sin)": "yaw-swap-in-training",
}
"""What the README opens with: rows of the table, by what was read wrong. Its film is `.github/cost.png`."""

_COLUMNS = 3
_STEP = 2  # frames of a rollout from one picture of the film to the next


@drawing.in_style
def paths(rollouts: Rollouts) -> Figure:
    """Draw rollouts from above: where the block began and where it ended, its path, and that of the pusher.

    Parameters
    ----------
    rollouts : mapping of str to Rollout
        At least one, by what it is called.
    """
    columns = min(_COLUMNS, len(rollouts))
    n_rows = -(-len(rollouts) // columns)
    figure = drawing.new_figure(2.9 * columns, 3.4 * n_rows)
    panels = figure.subplots(n_rows, columns, squeeze=False).flat
    for axes, (name, rollout) in zip(panels, rollouts.items(), strict=False):
        decoded = _set_stage(axes, name, rollout)
        tee = decoded.pose("tee")
        for body, color in (("tee", drawing.TEE), ("pusher", drawing.PUSHER)):
            drawing.draw_path(axes, drawing.place(decoded.pose(body)), color, body)
        ends = drawing.select_frames(tee, [0, len(tee.x) - 1])
        drawing.draw_bodies(axes, BODIES["tee"], ends, drawing.TEE, "tee", [0.35, 1], linewidth=1.5)
        axes.set_xlabel(_outcome(rollout))
    for axes in panels:
        axes.axis("off")
    return figure


@drawing.in_style
def film(rollouts: Rollouts, seconds: float) -> bytes:
    """Return rollouts as one moving picture, an animated PNG: whatever shows a PNG shows it.

    Parameters
    ----------
    rollouts : mapping of str to Rollout
        At least one, by what it is called.
    seconds : float
        How much of each is shown, as fast as it was. One that ends earlier stands still.
    """
    figure = drawing.new_figure(2.4 * len(rollouts), 2.8)
    panels = figure.subplots(1, len(rollouts), squeeze=False)[0]
    move_all = [_put_actors(axes, name, each) for axes, (name, each) in zip(panels, rollouts.items(), strict=True)]

    def move(frame: int) -> list[Artist]:
        return [part for move_one in move_all for part in move_one(frame)]

    return animated.film(figure, move, range(0, round(seconds * CONTROL_HZ), _STEP), 1000 * _STEP // CONTROL_HZ)


def _put_actors(axes: Axes, name: str, rollout: Rollout) -> Callable[[int], list[Artist]]:
    """Draw block and pusher where they began; return what moves them to where they are in a frame."""
    decoded = _set_stage(axes, name, rollout)
    path, move_bodies = drawing.place(decoded.pose("pusher")), drawing.put_bodies(axes, decoded)
    [line] = axes.plot([], [], color=drawing.PUSHER, linewidth=1)
    label = axes.set_xlabel(" ")

    def move(frame: int) -> list[Artist]:
        now = min(frame, len(path) - 1)
        line.set_data(*path[: now + 1].T)
        label.set_text(_outcome(rollout) if rollout.success and now < frame else f"{now / CONTROL_HZ:.1f} s")
        return [line, *move_bodies(now), label]

    return move


def _set_stage(axes: Axes, name: str, rollout: Rollout) -> Decoded:
    """Draw what does not move, and return what the frames mean."""
    decoded = decode(rollout.states, PUSHT, _schema())
    drawing.draw_goal(axes, BODIES["target"], decoded.pose("target"))
    corners = drawing.walls(PUSHT)
    assert corners is not None
    drawing.set_frame(axes, PUSHT, corners, margin=0.02)
    axes.set(title=name, xticks=[], yticks=[], ylabel="")
    axes.spines[:].set_visible(False)
    return decoded


@cache
def _schema() -> Schema:
    return load(STANDIN).schema


def _outcome(rollout: Rollout) -> str:
    seconds = len(rollout.actions) / CONTROL_HZ
    return f"success after {seconds:.1f} s" if rollout.success else f"no success in {seconds:.0f} s"
