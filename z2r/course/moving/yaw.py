"""What is a yaw that is stored as two numbers? Turn it: the point on the circle, and the T, right and swapped."""

import numpy as np
from matplotlib.artist import Artist
from matplotlib.axes import Axes
from matplotlib.patches import Polygon

from z2r.course import animated, drawing
from z2r.course.moving.bodies import shape_of
from z2r.course.moving.picture import MovingPicture, make, new_still
from z2r.pusht.world import BODIES
from z2r.reading.angles import decode_yaw

_TITLE = "One yaw, two numbers, and what a swap makes of them"
_SAYS = "Turn the block: move the slider, or drag the point. At which two yaws does the swap change nothing?"
_STEP = 15  # degrees from one picture of the still to the next
_MILLISECONDS = 200
_SIZE = 0.13  # m: half the width of the picture of a T


def yaw_slider(degrees: int = 30) -> MovingPicture:
    """Show a yaw, its sine and cosine as a point on the circle, and the T as it is decoded, right and swapped.

    Parameters
    ----------
    degrees : int, optional
        The yaw to begin with, from -180 to 180.

    Examples
    --------
    >>> yaw_slider()
    Moving picture: One yaw, two numbers, and what a swap makes of them
    """
    data = {"degrees": degrees, "body": shape_of(BODIES["tee"])}
    return make("yaw", _TITLE, _SAYS, data, _still(degrees))


@drawing.in_style
def _still(degrees: int) -> bytes:
    """Turn the block once around."""
    figure = new_still(_TITLE, 3.3)
    circle, right, wrong = figure.subplots(1, 3, width_ratios=[1.15, 1, 1])
    around = np.linspace(0, 2 * np.pi, 100)
    circle.plot(np.cos(around), np.sin(around), color=drawing.GREY, linewidth=1)
    circle.plot((-1.1, 1.1), (-1.1, 1.1), color=drawing.GREY, linestyle=(0, (6, 3)), linewidth=1)
    circle.set(aspect="equal", xlim=(-1.3, 1.3), ylim=(-1.3, 1.3), xticks=[-1, 0, 1], yticks=[-1, 0, 1])
    circle.set(xlabel="cos(yaw)", ylabel="sin(yaw)")
    [ray] = circle.plot([], [], "o-", color=drawing.RIGHT, linewidth=2, markersize=7, markevery=[1])
    [other] = circle.plot([], [], "o--", color=drawing.WRONG, linewidth=1.5, fillstyle="none", markevery=[1])
    blocks = [(_block(axes, color), axes) for axes, color in ((right, drawing.RIGHT), (wrong, drawing.WRONG))]

    def move(yaw: int) -> list[Artist]:
        sine, cosine = np.sin(np.deg2rad(yaw)), np.cos(np.deg2rad(yaw))
        ray.set_data((0, cosine), (0, sine))
        other.set_data((0, sine), (0, cosine))
        titles = [circle.set_title(f"sin {sine:+.3f}, cos {cosine:+.3f}", size=11)]
        for (block, axes), names, pair in zip(
            blocks, ("sin, cos", "cos, sin"), ((sine, cosine), (cosine, sine)), strict=True
        ):
            turned = float(decode_yaw(*pair))
            block.set_xy(drawing.outlines_of(BODIES["tee"], drawing.single_pose(0, 0, turned))[0])
            titles.append(axes.set_title(f"atan2({names}) = {np.rad2deg(turned):.0f}°", size=11))
        return [other, ray, *(block for block, _ in blocks), *titles]

    first = degrees - 360 + _STEP
    return animated.film(figure, move, range(first, degrees + 1, _STEP), _MILLISECONDS)


def _block(axes: Axes, color: str) -> Polygon:
    axes.set(aspect="equal", xlim=(-_SIZE, _SIZE), ylim=(-_SIZE, _SIZE), xticks=[], yticks=[])
    axes.spines[:].set_visible(False)
    block = Polygon([(0, 0)], facecolor=(color, 0.3), edgecolor=color, linewidth=2)
    axes.add_patch(block)
    axes.set_xlabel("read right" if color == drawing.RIGHT else "arguments swapped", color=color)
    return block
