"""How good is good enough? The last frame of every episode as a dot, and the box of the two tolerances, to drag."""

import os
from math import floor, log10
from typing import NamedTuple

from matplotlib.artist import Artist
from matplotlib.patches import Rectangle
from msgspec.structs import replace

from z2r.api import choose_reading, inspect_dataset, load
from z2r.arrays import Bools, Floats
from z2r.course import animated, drawing
from z2r.course.moving.picture import MovingPicture, make, new_still
from z2r.format.dataset import Dataset
from z2r.reading.goal import Goal

_SAYS = "A dot is an episode, in its last stored frame. Drag the corner of the box, or move a limit."
_WIDEST = 2  # times the limit of the reading: so far a slider goes
_GROWS = 4 / 3  # in the still: from 0.03 to 0.04
_PICTURES = 11
_MILLISECONDS = 350


def tolerance_box(dataset: Dataset | str | os.PathLike[str] = "messy") -> MovingPicture:
    """Show the errors in the last frames of all episodes, and how many are within limits that the reader sets.

    Parameters
    ----------
    dataset : Dataset, str or path, optional
        From `z2r.load`, or what that takes; a reading fits it that has two goals with a limit ``within``.

    Raises
    ------
    DatasetError
        If a file is missing, damaged, or not what the schema and the index say.
    ValueError
        If there are not two such goals.

    Examples
    --------
    >>> tolerance_box("messy")
    Moving picture: How good is good enough? With the limits of the task, 11 of 14 reached
    """
    dataset = dataset if isinstance(dataset, Dataset) else load(dataset)
    reading, outcome = choose_reading(dataset.schema), inspect_dataset(dataset).outcome
    goals = [goal for goal in reading.goal if goal.within] if reading else []
    if reading is None or outcome is None or len(goals) != 2:
        raise ValueError(f"found {len(goals)} goals with a limit `within`, expected a dataset whose reading has two")
    sides = [_Side(goal, reading.unit(goal), goal.within or 0.0, outcome.final_errors[goal.name]) for goal in goals]
    title = f"How good is good enough? With the limits of the task, {outcome.tally} reached"
    return make("tolerance", title, _SAYS, {"sides": [side.data for side in sides]}, _still(title, *sides))


class _Side(NamedTuple):
    """A goal, the unit and the limit of its number, and that number in the last frames."""

    goal: Goal
    unit: str
    limit: float
    errors: Floats

    @property
    def data(self) -> dict[str, object]:
        """What the script is given; the errors stay as they are, since they are compared."""
        return {
            "name": self.goal.name,
            "unit": self.unit,
            "limit": self.limit,
            "most": _WIDEST * self.limit,
            "step": 10.0 ** (floor(log10(self.limit)) - 1),  # 0.001 for 0.03
            "errors": self.errors.tolist(),
        }

    def inside(self, limit: float) -> Bools:
        """Tell which are within another limit."""
        return replace(self.goal, within=limit).holds(self.errors)


@drawing.in_style
def _still(title: str, across: _Side, up: _Side) -> bytes:
    """Let the first limit grow, and count."""
    figure = new_still(title, 3.8)
    axes = figure.subplots()
    axes.set(xlabel=f"{across.goal.name} [{across.unit}]", ylabel=f"{up.goal.name} [{up.unit}]")
    for set_limits, side in ((axes.set_xlim, across), (axes.set_ylim, up)):
        set_limits(0, 1.08 * max(side.errors.max(), _WIDEST * side.limit))
    box = Rectangle((0, 0), 0, up.limit, facecolor=(drawing.GREEN, 0.15), edgecolor=drawing.GREEN)
    axes.add_patch(box)
    [dots] = axes.plot([], [], "o", color=drawing.RIGHT, markersize=8)
    [crosses] = axes.plot([], [], "X", color=drawing.WRONG, markersize=9)

    def move(picture: int) -> list[Artist]:
        limit = across.limit * (1 + (_GROWS - 1) * picture / (_PICTURES - 1))
        box.set_width(limit)
        inside = across.inside(limit) & up.inside(up.limit)
        dots.set_data(across.errors[inside], up.errors[inside])
        crosses.set_data(across.errors[~inside], up.errors[~inside])
        said = f"{across.goal.name} < {limit:.3f} {across.unit}, {up.goal.says(up.unit)}"
        return [box, dots, crosses, axes.set_title(f"{said}: {inside.sum()} of {len(inside)}", size=11)]

    return animated.film(figure, move, range(_PICTURES), _MILLISECONDS)
