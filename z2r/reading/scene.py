"""What does only one task know? Its bodies, its walls: a scene, which a reading names."""

from collections.abc import Mapping
from typing import Protocol

from z2r.reading.bodies import Body


class Scene(Protocol):
    """What a task knows beyond what its reading says.

    Attributes
    ----------
    name : str
        What readings call it.
    bodies : mapping of str to Body
        What they look like, by the names of their poses: a reading that names the scene has these poses.
    half_width : float
        The walls stand so far from the origin, on both axes [m].
    """

    @property
    def name(self) -> str: ...  # noqa: D102

    @property
    def bodies(self) -> Mapping[str, Body]: ...  # noqa: D102

    @property
    def half_width(self) -> float: ...  # noqa: D102
