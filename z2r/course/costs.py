"""What did each misreading cost? The rows that were measured, in words and as bars.

A row that nobody has measured yet is left out, and so nothing is said of it.
"""

from collections.abc import Iterable, Mapping, Sequence
from functools import cache

from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.patheffects import withStroke

from z2r.course import drawing
from z2r.pusht.cloning.results import Cost, costs_of, read_results

type Groups = Mapping[str, Sequence[str]]
"""Rows, under what they have in common."""

MISREADINGS: Groups = {
    "nothing is wrong": ("right",),
    "where an episode ends": ("drop-boundaries", "inclusive-end"),
    "when an action happens": ("early-1", "late-1", "late-2", "late-5"),
    "what an action is": ("velocity-by-10-fps", "velocity-by-30-fps", "step-for-velocity", "centimetres", "exchanged"),
    "how fast the clock goes": ("fps-30-at-rollout",),
    "which way the block points": ("yaw-swap-throughout", "yaw-swap-in-training", "yaw-swap-at-rollout"),
    "what numbers are divided by": (
        "scale-of-another-set-at-rollout",
        "scale-eightfold-throughout",
        "scale-eightfold-at-rollout",
    ),
}
"""What can be read wrong, by kind; each is held against `right`."""

FAULTS = ("actions-of-another", "frozen", "late", "leaping", "mixture")
DEMONSTRATIONS: Groups = {
    "a tenth of the episodes bad, against none": ("idle-tenth", "damaged-tenth"),
    "three in ten faulty, against none": tuple(f"faulty-{name}" for name in FAULTS),
    "noisier, and three in ten fail": ("failed-kept",),
}
"""What can be wrong with some of the demonstrations; each is held against `right`."""

DROPPED: Groups = {
    "dropped what the audit names": (
        "idle-tenth-unnamed",
        "damaged-tenth-unnamed",
        *(f"faulty-{name}-unnamed" for name in FAULTS),
    ),
    "kept what z2r audit --keep leaves": ("faulty-mixture-kept",),
    "kept as many, but others": ("faulty-mixture-as-many-at-random", "faulty-mixture-as-many-shortest"),
    "dropped those that did not reach": ("failed-dropped", "failed-dropped-by-degrees"),
    "kept as many as reached, at random": ("failed-as-many-at-random",),
}
"""What can be left out; each is held against all of the same demonstrations."""

RIVALS = ("faulty-mixture-unnamed", "faulty-mixture-as-many-shortest", "faulty-mixture-as-many-at-random")
"""What the audit leaves of the mixture, and as many by a measure that looks at no fault."""

RECIPE = ("no-mirror", "from-the-table", "plain", "one-frame")
"""The policy without a part of what makes it work; each is held against `right`."""

PLAIN = ("plain-yaw-swap-throughout", "plain-yaw-swap-in-training")
"""The swapped yaw again, with a policy that computes nothing from it; each is held against `plain`."""

TELLING = ("right", "drop-boundaries", "late-2", "late-5", "yaw-swap-throughout", "yaw-swap-in-training")
"""What was trained with 2,000 demonstrations too: then called ``ROW-2000``, and held against `right-2000`."""

_GAINS, _COSTS = (drawing.RIGHT, ">"), (drawing.WRONG, "<")  # by marker as well as by colour


@cache
def cost_of(row: str) -> Cost | None:
    """Return what was measured of a row of the table; None if nobody has measured it yet."""
    found = costs_of([each for each in read_results() if each.row == row])
    return found[0] if found else None


def measured(rows: Iterable[str]) -> list[Cost]:
    """Return what was measured of some rows, as far as it was."""
    return [cost for cost in map(cost_of, rows) if cost]


def verdict(cost: Cost) -> str:
    """Say what the interval of a paired difference allows one to say, and no more."""
    _, low, high = (100 * value for value in cost.cost)
    if high < 0:
        return f"costs {_points(-high)} to {_points(-low)} points"
    if low > 0:
        return f"gains {_points(low)} to {_points(high)} points"
    return f"no difference seen, {low:+.0f} to {high:+.0f} points"


def _points(value: float) -> str:
    """Round to whole points, but for less than half a one: that is not none."""
    return f"{value:.0f}" if value >= 0.5 else f"{value:.1f}"


def tell(*rows: str) -> None:
    """Print of each row how often it succeeded, the interval (Wilson), and the difference from what it is held against.

    Parameters
    ----------
    *rows : str
        Their names. Those that nobody has measured yet are named as such.
    """
    width = max(map(len, rows))
    for row in rows:
        cost = cost_of(row)
        if cost is None:
            print(f"{row:{width}}  not yet measured")
            continue
        print(f"{row:{width}}  {_tally(cost):>10} ({cost.low:.0%} to {cost.high:.0%})", end="")
        print("" if cost.against == row else f"  {verdict(cost)} against {cost.against}")


def _tally(cost: Cost) -> str:
    return f"{cost.n_successes} of {cost.n_rollouts}"


@drawing.in_style
def bars(groups: Groups) -> Figure:
    """Draw how often each row succeeded, with its interval (Wilson), in groups.

    Parameters
    ----------
    groups : mapping of str to sequence of str
        The names of the rows, under what they have in common.

    Raises
    ------
    ValueError
        If none of them was measured.
    """
    figure, axes, places = _rows_of(groups)
    for cost, place in places:
        costs = cost.cost[2] < 0
        color, hatch = (drawing.WRONG, "////") if costs else (drawing.RIGHT, "")
        axes.barh(place, cost.rate, 0.72, facecolor=color, alpha=0.35, hatch=hatch, edgecolor=color, gid=cost.row)
        axes.plot((cost.low, cost.high), (place, place), color=drawing.INK, linewidth=2, gid=f"{cost.row} interval")
        _write_at_the_end(axes, place, _tally(cost))
    against = {cost.against for cost, _ in places}
    for base in filter(None, map(cost_of, sorted(against))):
        axes.axvline(base.rate, color=drawing.GREY, linestyle=":", linewidth=1.2, zorder=0)
    axes.set(xlim=(0, 1), xlabel=f"success, dotted: {', '.join(sorted(against))}; line: where the true rate lies, 95 %")
    axes.xaxis.set_major_formatter("{x:.0%}")
    axes.set_title("plain: no difference seen     hatched: it costs")
    return figure


@drawing.in_style
def differences(groups: Groups) -> Figure:
    """Draw by how much each row differs from what it is held against, and how far chance may have moved it, in groups.

    Parameters
    ----------
    groups : mapping of str to sequence of str
        The names of the rows, under what they have in common.

    Raises
    ------
    ValueError
        If none of them was measured.
    """
    figure, axes, places = _rows_of(groups)
    for cost, place in places:
        difference, low, high = (100 * value for value in cost.cost)
        color, marker = (drawing.GREY, "o") if low <= 0 <= high else _GAINS if low > 0 else _COSTS
        axes.plot((low, high), (place, place), color=color, linewidth=2.5, gid=f"{cost.row} interval")
        axes.plot(difference, place, marker, color=color, markersize=9, gid=cost.row)
        _write_at_the_end(axes, place, f"{difference:+.0f}")
    axes.axvline(0, color=drawing.INK, linewidth=1, zorder=0)
    axes.set(xlabel="points of success more or less than what it is held against; line: 95 %")
    axes.set_title("< costs     o no difference seen     > gains")
    return figure


def _rows_of(groups: Groups) -> tuple[Figure, Axes, list[tuple[Cost, float]]]:
    """Open a figure with a line for each row that was measured, and return where each stands."""
    there = {title: found for title, rows in groups.items() if (found := measured(rows))}
    if not there:
        raise ValueError("found no row that was measured, expected one at least")
    places, titles, place = [], [], 0.0
    for title, costs in there.items():
        titles.append((title, place))
        places += [(cost, place + 1 + number) for number, cost in enumerate(costs)]
        place += len(costs) + 1.2
    figure = drawing.new_figure(7.8, 0.9 + 0.27 * place)
    axes = figure.subplots()
    axes.set(ylim=(place - 0.4, -0.6), yticks=[at for _, at in places], yticklabels=[cost.row for cost, _ in places])
    axes.tick_params(axis="y", length=0)
    axes.spines["left"].set_visible(False)
    halo = [withStroke(linewidth=4, foreground=drawing.CARD)]
    for title, at in titles:
        text = axes.text(0.0, at, title, weight="bold", size=10, va="center", path_effects=halo)
        text.set_transform(axes.get_yaxis_transform())
    return figure, axes, places


def _write_at_the_end(axes: Axes, place: float, text: str) -> None:
    axes.text(1.01, place, text, va="center", size=10, transform=axes.get_yaxis_transform())
