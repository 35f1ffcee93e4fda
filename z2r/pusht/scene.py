"""What does PushT add to its reading? Its bodies, its walls and its checks, handed down to who audits or draws."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path

from z2r.check import Part
from z2r.format.episodes import EpisodeIndex
from z2r.pusht.checks import PARTS, PushTSums, fold_block, ungraded
from z2r.pusht.task import WALL
from z2r.pusht.world import BODIES, PUSHT
from z2r.reading.bodies import Body
from z2r.reading.decode import Decoded
from z2r.reading.scene import SceneSums


@dataclass(frozen=True)
class PushTScene:
    """The scene that readings call ``pusht``: a `z2r.reading.scene.Scene`, where its members are explained."""

    name: str = str(PUSHT.scene)
    half_width: float = WALL

    @property
    def bodies(self) -> Mapping[str, Body]:
        """Pusher, block and target."""
        return BODIES

    @property
    def checks(self) -> tuple[Part[SceneSums], ...]:
        """What it asks in an audit."""
        return PARTS

    def fold(
        self, decoded: Decoded, base: int, episodes: EpisodeIndex, fps: float, before: Decoded | None = None
    ) -> PushTSums | None:
        """Sum up the frames of a block of a data file."""
        return fold_block(decoded, base, episodes, fps, before)

    def not_checked(self, root: Path) -> Iterator[str]:
        """Say what it could not look at."""
        return ungraded(root)


SCENE = PushTScene()

EXPLANATIONS = Path(__file__).with_name("explanations.toml")
"""Why its checks are there: `z2r.audits.explain` reads it."""
