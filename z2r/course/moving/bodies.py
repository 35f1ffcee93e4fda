"""What is a body to a moving picture? Its outline or its radius, its role, and where it is in some frames."""

import numpy as np

from z2r.arrays import Floats
from z2r.course import drawing
from z2r.reading.bodies import Body
from z2r.reading.decode import Decoded

_DIGITS = 5  # of a metre or a radian: finer than a pixel
_MARGIN = 0.03  # m, around what is drawn


def shape_of(body: Body) -> dict[str, object]:
    """Return what a script draws a body from."""
    return {
        "label": body.label,
        "role": body.role,
        "outline": rounded(body.outline),
        "radius": body.disc.radius if body.disc else 0,
    }


def bodies_in(decoded: Decoded) -> list[dict[str, object]]:
    """Return the bodies of a reading, and where each is in every frame: x, y and yaw."""
    bodies = []
    for name, body in drawing.bodies_to_draw(decoded).items():
        pose = decoded.pose(name)
        yaw = np.zeros_like(pose.x) if pose.yaw is None else pose.yaw
        bodies.append(shape_of(body) | {"track": [rounded(values) for values in (pose.x, pose.y, yaw)]})
    return bodies


def square_around(decoded: Decoded) -> Floats:
    """Return the square that holds all that is drawn: its least x and y, and its width [m]."""
    bodies = drawing.bodies_to_draw(decoded)
    outlines = [drawing.outlines_of(body, decoded.pose(name)).reshape(-1, 2) for name, body in bodies.items()]
    points = np.concatenate([*outlines, *(drawing.place(decoded.pose(name)) for name in bodies)])
    low, high = points.min(axis=0) - _MARGIN, points.max(axis=0) + _MARGIN
    width = (high - low).max()
    return np.array([*((low + high - width) / 2), width])


def rounded(values: Floats) -> list[object]:
    """Return numbers as lists, as fine as a picture shows them."""
    numbers: list[object] = values.round(_DIGITS).tolist()
    return numbers
