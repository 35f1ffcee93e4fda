"""What do the numbers look like? Each joint has a plot and a colour of its own, for its state and its action.

Where the action is a position that a joint is to take, the two are drawn together: the state thick, the action thin and
pale in the same colour. All other numbers are drawn a feature at a time.
"""

import colorsys
import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from z2r.arrays import Array, Columns
from z2r.errors import printable
from z2r.format.schema import ACTION, Schema
from z2r.reading.action import DrivenColumn
from z2r.reading.joints import Joint, Place, joints_of
from z2r.reading.reading import Reading
from z2r.show.recorder import Recorder

type Color = tuple[int, int, int]

_MAX_LINES = 10  # in a plot: the legend names them all
_MAX_PLOTS = 12  # beside each other
_MAX_SIZE = 64  # numbers of a feature that are named: of more, one plot shows the bulk
_LIGHTNESS = (0.64, 0.74, 0.69)  # in turn, as hues alone do not tell many lines apart
_MARGIN = 0.05  # of what a plot shows, above and below
_PALE = 0.6  # how far an action is on the way to white
_FIRST_HUE, _GOLDEN = 0.58, (5**0.5 - 1) / 2  # of one circle: so many turns never come near where they were


class _Plot(NamedTuple):
    """A plot, the entities that it shows, and all numbers of these."""

    title: str
    entities: tuple[str, ...]
    values: Array
    legend: bool = True

    @property
    def view(self) -> rrb.View:
        """Shows all of it; left to itself, the viewer takes the end of an episode for a 0."""
        finite = self.values[np.isfinite(self.values)].astype(float)
        low, high = (finite.min(), finite.max()) if len(finite) else (0.0, 1.0)
        margin = _MARGIN * (high - low) or 1.0
        return view_of(self.title, *self.entities, legend=self.legend, span=(low - margin, high + margin))


def colors_of(number: int) -> tuple[Color, Color]:
    """Return the colours of the state and the action of one of many joints: no two joints are alike.

    >>> colors_of(0), colors_of(1)
    (((94, 166, 232), (191, 219, 246)), ((224, 245, 132), (243, 251, 206)))
    """
    hue = (_FIRST_HUE + number * _GOLDEN) % 1
    strong = colorsys.hls_to_rgb(hue, _LIGHTNESS[number % len(_LIGHTNESS)], 0.75 + 0.1 * (number % 2))
    return _rounded(strong), _rounded(tuple(part + _PALE * (1 - part) for part in strong))


def send_numbers(
    recorder: Recorder,
    schema: Schema,
    reading: Reading | None,
    action: Sequence[DrivenColumn],
    frames: Columns,
    left_out: Sequence[str] = (),
) -> dict[str, list[rrb.View]]:
    """Send all that the robot saw and did; return the plots of it, some to a page, by the titles of the pages.

    Parameters
    ----------
    recorder : Recorder
        Where it goes: `policy/action`, `observation/state` and so on as they are stored, and `joints` one by one.
    schema : Schema
        Names the dimensions.
    reading : Reading or None
        Says which column of the action drives which of the state, and units.
    action : sequence of DrivenColumn
        What each dimension of the action was inferred to be.
    frames : dict of str to ndarray, (n_frames, size)
        The features that are shown.
    left_out : sequence of str
        Features that are sent only where a joint is in them.
    """
    joints = _positions(schema, reading, action)
    plots = [_send_joint(recorder, joint, colors_of(number), frames) for number, joint in enumerate(joints)]
    colors = {joint.state: colors_of(number)[0] for number, joint in enumerate(joints)}
    colors |= {joint.action: colors_of(number)[1] for number, joint in enumerate(joints)}
    others = [
        plot
        for name, values in frames.items()
        if name not in left_out
        for plot in _send_feature(recorder, name, values, schema, reading, colors)
    ]
    return _pages(plots) | {plot.title: [plot.view] for plot in others}


def view_of(title: str, *entities: str, legend: bool = True, span: tuple[float, float] | None = None) -> rrb.View:
    """Return a plot of the whole recording, whatever the cursor points at; from one number to another, if need be."""
    return rrb.TimeSeriesView(
        name=title,
        origin="/",
        contents=[f"/{entity}" for entity in entities],
        axis_x=whole_time(),
        axis_y=rrb.ScalarAxis(range=span) if span else None,
        plot_legend=rrb.PlotLegend(rrb.Corner2D.RightTop, visible=legend),
    )


def whole_time() -> rrb.TimeAxis:
    """Return an axis from the first frame to the last."""
    everywhere = rr.TimeRange(start=rr.TimeRangeBoundary.infinite(), end=rr.TimeRangeBoundary.infinite())
    return rrb.TimeAxis(view_range=everywhere)


def with_unit(name: str, unit: str) -> str:
    """Return a name and its unit; the name alone where nobody knows the unit.

    >>> with_unit("pan", "deg"), with_unit("pan", "")
    ('pan [deg]', 'pan')
    """
    return printable(f"{name} [{unit}]" if unit else name)


def _rounded(color: Sequence[float]) -> Color:
    red, green, blue = (round(255 * part) for part in color)
    return red, green, blue


def _positions(schema: Schema, reading: Reading | None, action: Sequence[DrivenColumn]) -> list[Joint]:
    """Return the joints whose action is a position, so that it can be drawn with the state; each of them once.

    That is what the reading says, or else what the data does not speak against.
    """
    joints = list({joint.state: joint for joint in joints_of(schema, reading)}.values())
    if reading and reading.action and not reading.missing_action(schema):
        return joints if reading.action.drives == "position" else []
    changes = {place for place, driven in enumerate(action) if driven.kind not in ("target", "unknown")}
    return [joint for joint in joints if joint.action[1] not in changes]


def _send_joint(recorder: Recorder, joint: Joint, colors: tuple[Color, Color], frames: Columns) -> _Plot:
    entity = f"joints/{rr.escape_entity_path_part(joint.name)}"
    roles = zip(("state", "action"), (joint.state, joint.action), colors, (2, 1), strict=True)
    for role, (feature, dim), color, width in roles:
        recorder.static(f"{entity}/{role}", rr.SeriesLines(names=role, colors=color, widths=width))
        recorder.lines(f"{entity}/{role}", frames[feature][:, dim])
    values = np.concatenate([frames[feature][:, dim] for feature, dim in (joint.state, joint.action)])
    return _Plot(with_unit(joint.name, joint.unit), (f"{entity}/state", f"{entity}/action"), values)


def _send_feature(
    recorder: Recorder,
    name: str,
    values: Array,
    schema: Schema,
    reading: Reading | None,
    colors: dict[Place, Color],
) -> Iterator[_Plot]:
    """Send a feature as it is stored, and yield the plots of those of its numbers that have none yet."""
    feature, entity = schema.features[name], _entity(name)
    rest = [dim for dim in range(feature.size) if (name, dim) not in colors]
    labels = [printable(label) for label in feature.labels]
    for dim in rest:  # the others have their unit in the plot of their joint
        known = feature.dim_names[dim] if feature.dim_names else str(dim)
        labels[dim] = with_unit(labels[dim], reading.meaning(name, known).unit if reading else "")
    shades = [colors.get((name, dim)) or colors_of(len(colors) + dim)[0] for dim in range(feature.size)]
    recorder.static(entity, rr.SeriesLines(names=labels, colors=shades))
    recorder.lines(entity, values)
    title = name.removeprefix("observation.")
    if rest and (len(rest) == feature.size <= _MAX_LINES or feature.size > _MAX_SIZE):
        yield _Plot(title, (entity,), values, legend=feature.size <= _MAX_LINES)
        return
    for part in _parts(rest, _MAX_LINES):
        yield _Plot(
            f"{title}: {labels[part[0]]} … {labels[part[-1]]}",
            tuple(f"{entity}/{dim}" for dim in part),
            values[:, part],
        )
        for dim in part:
            recorder.static(f"{entity}/{dim}", rr.SeriesLines(names=labels[dim], colors=shades[dim]))
            recorder.lines(f"{entity}/{dim}", values[:, dim])


def _entity(feature: str) -> str:
    """Return where a feature stands: `observation/state`, and the action where a policy would put it."""
    parts = ["policy", feature] if feature == ACTION else feature.split(".")
    return "/".join(rr.escape_entity_path_part(part) for part in parts if part)


def _pages(plots: Sequence[_Plot]) -> dict[str, list[rrb.View]]:
    """Lay out the plots of joints, as many to a page as can be read, on pages of about the same size."""
    parts = list(_parts(plots, _MAX_PLOTS))
    titles = [f"{part[0].title} … {part[-1].title}" for part in parts] if len(parts) > 1 else ["joints"]
    pages = ([plot.view for plot in part] for part in parts)
    return dict(zip(titles, pages, strict=False))


def _parts[T](items: Sequence[T], most: int) -> Iterator[Sequence[T]]:
    n_parts = math.ceil(len(items) / most)
    for places in np.array_split(np.arange(len(items)), n_parts) if n_parts else ():
        yield items[places[0] : places[-1] + 1]
