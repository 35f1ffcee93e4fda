"""What does a body look like? Its shape and what it is there for, which is all that a picture of any kind needs."""

from collections.abc import Mapping
from typing import Literal, NamedTuple

import numpy as np

from z2r.arrays import Floats
from z2r.reading.reading import Reading

type Role = Literal["object", "goal", "robot"]
"""What a body is there for, which gives it its colour: what is moved, where it is to be, or what moves it."""

_FROM_THE_GROUND: tuple[Role, ...] = ("goal", "object", "robot")


class Box(NamedTuple):
    """A box in the frame of its body: centre (x, y) and half sizes along x, y and z, all [m]."""

    center: tuple[float, float]
    half_size: tuple[float, float, float]

    @property
    def corners(self) -> Floats:
        """Seen from above, float64[4, 2] [m]: top left, top right, bottom right, bottom left."""
        signs = np.array([(-1, 1), (1, 1), (1, -1), (-1, -1)])
        corners: Floats = np.asarray(self.center) + signs * self.half_size[:2]
        return corners


class Disc(NamedTuple):
    """An upright cylinder around the origin of its body, radius and height [m]."""

    radius: float
    height: float


class Body(NamedTuple):
    """A body that a scene knows.

    Attributes
    ----------
    label : str
        What to call it.
    role : str
        What it is there for.
    shapes : tuple of Box or Disc
        Together they are the body; none where only its place is known.
    outline : ndarray, float64[n, 2]
        Around its boxes, seen from above, in its own frame [m].
    z : float
        How high its origin is [m].
    flat : bool
        Whether it is but a marking on the table.
    """

    label: str
    role: Role
    shapes: tuple[Box | Disc, ...] = ()
    outline: Floats = np.empty((0, 2))
    z: float = 0.0
    flat: bool = False

    @property
    def disc(self) -> Disc | None:
        """The disc, where it is one."""
        return next((shape for shape in self.shapes if isinstance(shape, Disc)), None)

    @property
    def boxes(self) -> tuple[Box, ...]:
        """The boxes that it is made of."""
        return tuple(shape for shape in self.shapes if isinstance(shape, Box))

    @property
    def reach(self) -> float:
        """How far it goes from its origin, seen from above [m]."""
        if self.disc:
            return self.disc.radius
        return float(np.hypot(*self.outline.T).max(initial=0.0))


def bodies_of(reading: Reading, known: Mapping[str, Body]) -> dict[str, Body]:
    """Return a body for every pose of a reading: the one that a scene knows, or else only its name and its role.

    What is only marked on the ground comes first, what moves the others last, as they are drawn on each other.

    Parameters
    ----------
    reading : Reading
        Has the poses, and the goals that say which body is brought to which.
    known : mapping of str to Body
        Bodies of a scene, by the names of their poses; empty where there is no scene.
    """
    moved = {goal.poses[0] for goal in reading.goal if goal.poses}
    goals = {goal.poses[1] for goal in reading.goal if goal.poses} - moved
    driven = reading.action.of if reading.action else ()
    # Where there is nothing else to move it, what the action drives brings itself to the goal.
    by_itself = set() if set(reading.poses) - moved - goals else {n for n in moved if reading.poses[n].x in driven}

    def unknown(name: str) -> Body:
        return Body(name, "object" if name in moved - by_itself else "goal" if name in goals else "robot")

    found = {name: known.get(name) or unknown(name) for name in reading.poses}
    return dict(sorted(found.items(), key=lambda item: _FROM_THE_GROUND.index(item[1].role)))
