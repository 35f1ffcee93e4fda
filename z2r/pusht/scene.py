"""What does PushT add to its reading? Its bodies, its walls and its checks, handed down to who audits or draws."""

from collections.abc import Mapping
from dataclasses import dataclass

from z2r.pusht.task import WALL
from z2r.pusht.world import BODIES, PUSHT
from z2r.reading.bodies import Body


@dataclass(frozen=True)
class PushTScene:
    """The scene that readings call ``pusht``; its attributes are those of `z2r.reading.scene.Scene`."""

    name: str
    bodies: Mapping[str, Body]
    half_width: float


SCENE = PushTScene(str(PUSHT.scene), BODIES, WALL)
