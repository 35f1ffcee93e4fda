"""Exercises of `07_break_modes`: how do I know that I read it right?"""

from collections.abc import Callable

import matplotlib.pyplot as plt
import numpy as np
from matplotlib.figure import Figure
from matplotlib.patches import Circle, Rectangle

from z2r.api import inspect_dataset, load
from z2r.course.exercises._core import Case, Question, judge_function, judge_prediction
from z2r.data import MESSY, STANDIN
from z2r.format.schema import STATE, Feature, Schema
from z2r.pusht import task
from z2r.pusht.overlap import pusher_in_block
from z2r.pusht.world import PUSHT
from z2r.reading.breaks import break_mode
from z2r.reading.decode import decode
from z2r.reading.poses import YawColumns

_OTHER = YawColumns(sin="sin_box", cos="cos_box")
_SCHEMA = Schema("v3.0", 10, 1, 1, {STATE: Feature("float32", (10,), list(task.STATE_NAMES))}, "")
# Pusher x, y and block x, y [m] and the block's yaw [degrees]; in none of them does the pusher touch the block.
_PLACES = ((0.05, 0.1, 0.02, 0, 90), (0.05, 0.02, 0.05, -0.04, 0), (0, -0.07, 0.03, 0.02, -135), (-0.1, 0, 0, 0, 30))


def predict_drop_boundaries(
    n_frames: int | None, longest: int | None, n_reached: int | None, again: int | None = None
) -> None:
    """Judge what the learner expects `drop-boundaries` to make of the metrics of the first three episodes.

    Parameters
    ----------
    n_frames, longest, n_reached : int or None
        Number of frames, length of the longest episode [frames], number of episodes that seem to reach the target;
        None where there is no prediction yet.
    again : int, optional
        The last of these where the last episode misses the target, which is asked of whoever was wrong.
    """
    found = inspect_dataset(load(STANDIN).first(3), break_mode("drop-boundaries"))
    # Of these, the first two reached it and the third did not.
    missed = inspect_dataset(load(MESSY).first(3), break_mode("drop-boundaries"))
    assert found.outcome is not None
    assert missed.outcome is not None
    answers = n_frames, longest, n_reached
    said = None if None in answers else answers
    truth = found.episodes.n_frames, int(max(found.episodes.lengths)), found.outcome.n_reached
    why = (
        "No frame is lost, and all are in one episode. It has one last frame, the last of all, which is on the target."
    )
    second = Question(
        missed.outcome.n_reached,
        "The last frame of all is the only one that is asked, and the first two episodes count for nothing.",
        "In three other episodes, the first two reached the target and the third did not. How many reached it, under "
        "drop-boundaries?",
    )
    judge_prediction(said, truth, why, second, again)


def check_swap(function: Callable[[YawColumns], object]) -> None:
    """Try a function that exchanges the two columns of a yaw.

    Parameters
    ----------
    function : callable
        The learner's: takes a YawColumns, returns one that names sine and cosine the wrong way round.
    """
    cases = [
        Case("the yaw of the block", (PUSHT.poses["tee"].yaw,)),
        Case("the yaw of the target", (PUSHT.poses["target"].yaw,)),
        Case("a yaw with other names", (_OTHER,)),
    ]

    def shown(yaw: YawColumns) -> object:
        answer = function(yaw)
        return _shown(answer.sin, answer.cos) if isinstance(answer, YawColumns) else answer

    def reference(yaw: YawColumns) -> str:
        return _shown(yaw.cos, yaw.sin)

    hint = "A YawColumns, whose sin is the name that yaw.cos holds. And the other one?"
    judge_function(shown, reference, cases, hint)


def check_seen_from_block(function: Callable[[float, float, float, float, float], object]) -> Figure | None:
    """Try a function that says where the pusher is as seen from the block.

    Parameters
    ----------
    function : callable
        The learner's: takes x and y of the pusher and of the block [m] and the block's yaw [rad], returns the two
        coordinates of the pusher in the frame of the block [m].

    Returns
    -------
    Figure or None
        Where the pusher is and where the answer has it, around the block, for the first place that went wrong.
    """
    cases = [
        Case(
            f"a pusher at ({px:g}, {py:g}) and a block at ({x:g}, {y:g}), turned by {degrees:g} degrees",
            (px, py, x, y, float(np.deg2rad(degrees))),
        )
        for px, py, x, y, degrees in _PLACES
    ]
    hint = "Turn the block back to yaw 0, and the pusher with it. Which way is back?"
    wrong = judge_function(function, _seen_from_block, cases, hint, untouched=_seen_from_block_as_handed_out)
    if wrong is None:
        return None
    try:
        across, along = np.asarray(function(*wrong.args), dtype=float)
    except (TypeError, ValueError):  # not two numbers: nothing to draw
        return None
    return _draw_around_block(_seen_from_block(*wrong.args), (across, along))


def _shown(sin: str | None, cos: str | None) -> str:
    return f"sin={sin}, cos={cos}"


def _seen_from_block(pusher_x: float, pusher_y: float, x: float, y: float, yaw: float) -> tuple[float, float]:
    state = np.array([[pusher_x, pusher_y, x, y, np.sin(yaw), np.cos(yaw), 0.0, 0.0, 0.0, 1.0]])
    across, along = pusher_in_block(decode(state, PUSHT, _SCHEMA))
    return float(across[0]), float(along[0])


def _seen_from_block_as_handed_out(
    pusher_x: float, pusher_y: float, x: float, y: float, yaw: float
) -> tuple[float, float]:
    dx, dy = pusher_x - x, pusher_y - y
    return float(np.cos(yaw) * dx - np.sin(yaw) * dy), float(np.sin(yaw) * dx + np.cos(yaw) * dy)


def _draw_around_block(expected: tuple[float, float], got: tuple[float, float]) -> Figure:
    figure = plt.figure(figsize=(5, 5), layout="constrained", facecolor="#faf9f6")
    plt.close(figure)
    axes = figure.subplots()
    for (x, y), (half_x, half_y, _) in task.TEE:
        axes.add_patch(Rectangle((x - half_x, y - half_y), 2 * half_x, 2 * half_y, color="#b9c6d4"))
    for place, color, style, what in ((expected, "#0072b2", "-", "expected"), (got, "#d55e00", "--", "your answer")):
        axes.add_patch(Circle(place, task.PUSHER_RADIUS, fill=False, color=color, linestyle=style, linewidth=2))
        axes.annotate(what, (place[0], place[1] + 1.2 * task.PUSHER_RADIUS), color=color, ha="center", va="bottom")
    reach = 1.3 * max(0.12, *np.abs([*expected, *got]))
    axes.set(aspect="equal", xlim=(-reach, reach), ylim=(-reach, reach), xlabel="across the block [m]")
    axes.set(ylabel="along the block [m]", title="The pusher, as seen from the block")
    return figure
