"""What does one task know beyond its columns? Its bodies and its limits: a scene, handed down from the top.

A reading names columns, and knows no task. What only a task knows stays with the task, and meets the rest of the
package here: the audit takes a scene's checks as they are, names their faults and sorts them in.
"""

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple, Protocol

from z2r.check import Check, Part
from z2r.format.episodes import EpisodeIndex
from z2r.reading.bodies import Body
from z2r.reading.decode import Decoded
from z2r.reading.reading import Reading

# The audit asks it of every sensor, and a scene of its bodies.
FROZEN = Check("frozen", "no sensor stands still for an episode while it moves in the others", "warning")


class SceneSums(NamedTuple):
    """What a scene's checks are asked of: all data files, folded.

    Attributes
    ----------
    root : Path
        The dataset.
    episodes : EpisodeIndex
        Where episodes end, as the dataset claims.
    reading : Reading
        What the columns mean.
    paths : sequence of Path
        Of each block of frames its data file, relative to the dataset, in the order of the frames.
    sums : sequence
        What `Scene.fold` made of each block.
    """

    root: Path
    episodes: EpisodeIndex
    reading: Reading
    paths: Sequence[Path]
    sums: Sequence[Any]


class Scene(Protocol):
    """What a task knows beyond what its reading says. It survives pickling, as does what it folds a block into.

    Attributes
    ----------
    name : str
        What readings call it.
    bodies : mapping of str to Body
        What they look like, by the names of their poses: a reading that names the scene has these poses.
    half_width : float
        The walls stand so far from the origin, on both axes [m].
    checks : tuple of Part
        What it asks in an audit.
    """

    @property
    def name(self) -> str: ...  # noqa: D102

    @property
    def bodies(self) -> Mapping[str, Body]: ...  # noqa: D102

    @property
    def half_width(self) -> float: ...  # noqa: D102

    @property
    def checks(self) -> "tuple[Part[SceneSums], ...]": ...  # noqa: D102

    def fold(
        self, decoded: Decoded, base: int, episodes: EpisodeIndex, fps: float, before: Decoded | None = None
    ) -> Any:
        """Sum up the frames of a data file, or of a block of one; None where an action is missing.

        Parameters
        ----------
        decoded : Decoded
            The frames. A block is cut where the frames say that another episode begins.
        base : int
            Which frame of the dataset the first is.
        episodes : EpisodeIndex
            Where episodes end, as the dataset claims.
        fps : float
            Frames per second.
        before : Decoded or None
            The last two frames of the block before, or one if it has no more; None where the file begins.
        """

    def not_checked(self, root: Path) -> Iterator[str]:
        """Say what it could not look at, although it has all of its columns."""
