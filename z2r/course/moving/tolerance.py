"""How good is good enough? The last frame of every episode as a dot, and the box of the two tolerances, to drag."""

import os
from collections.abc import Sequence
from math import floor, log10

import numpy as np
from matplotlib.artist import Artist
from matplotlib.patches import Rectangle

from z2r.api import choose_reading, inspect_dataset, load
from z2r.arrays import Floats
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
    Moving picture: How good is good enough? Read as usual, 11 of 14 reached
    """
    dataset = dataset if isinstance(dataset, Dataset) else load(dataset)
    reading, outcome = choose_reading(dataset.schema), inspect_dataset(dataset).outcome
    limits = {goal.name: goal.within for goal in reading.goal if goal.within} if reading else {}
    if reading is None or outcome is None or len(limits) != 2:
        raise ValueError(f"found {len(limits)} goals with a limit `within`, expected a dataset whose reading has two")
    errors = [outcome.final_errors[name] for name in limits]
    units = [reading.unit(goal) for goal in reading.goal if goal.within]
    title = f"How good is good enough? Read as usual, {outcome.tally} reached"
    data = [
        {"name": name, "unit": unit, "limit": limit, "step": _step(limit), "most": _WIDEST * limit, "errors": own.tolist()}
        for (name, limit), unit, own in zip(limits.items(), units, errors, strict=True)
    ]
    return make("tolerance", title, _SAYS, {"sides": data}, _still(title, limits, units, np.stack(errors)))


def _step(limit: float) -> float:
    """Return a tenth of the digit that comes first: 0.001 for 0.03."""
    return float(10.0 ** (floor(log10(limit)) - 1))


@drawing.in_style
def _still(title: str, limits: dict[str, float], units: Sequence[str], errors: Floats) -> bytes:
    """Let the first limit grow, and count."""
    figure = new_still(title, 3.8)
    axes = figure.subplots()
    (x, width), (y, height) = limits.items()
    axes.set(xlabel=f"{x} [{units[0]}]", ylabel=f"{y} [{units[1]}]")
    axes.set(xlim=(0, 1.08 * max(errors[0].max(), _WIDEST * width)), ylim=(0, 1.08 * max(errors[1].max(), height)))
    box = axes.add_patch(Rectangle((0, 0), width, height, facecolor=(drawing.GREEN, 0.15), edgecolor=drawing.GREEN))
    [dots] = axes.plot([], [], "o", color=drawing.RIGHT, markersize=8)
    [crosses] = axes.plot([], [], "X", color=drawing.WRONG, markersize=9)
    goals = [Goal(name=name, value=name, within=limit) for name, limit in limits.items()]

    def move(picture: int) -> list[Artist]:
        limit = width * (1 + (_GROWS - 1) * picture / (_PICTURES - 1))
        box.set_width(limit)
        inside = Goal(name=x, value=x, within=limit).holds(errors[0]) & goals[1].holds(errors[1])
        dots.set_data(*errors[:, inside])
        crosses.set_data(*errors[:, ~inside])
        said = f"{x} < {limit:.3f} {units[0]}, {y} < {height:g} {units[1]}: {inside.sum()} of {len(inside)}"
        return [box, dots, crosses, axes.set_title(said, size=11)]

    return animated.film(figure, move, range(_PICTURES), _MILLISECONDS)
