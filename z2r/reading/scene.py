"""What does one task know beyond its columns? Its bodies and its limits: a scene, handed down from the top.

A reading names columns, and knows no task. What only a task knows stays with the task, and meets the rest of the
package here: the audit takes a scene's checks as they are, names their faults and sorts them in.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, NamedTuple, Protocol

from z2r.arrays import Columns
from z2r.check import Check, Part
from z2r.format.episodes import EpisodeIndex
from z2r.format.schema import Schema
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
        The data files, relative to the dataset, in the order of their frames.
    sums : sequence
        What `SceneChecks.fold` made of each.
    """

    root: Path
    episodes: EpisodeIndex
    reading: Reading
    paths: Sequence[Path]
    sums: Sequence[Any]


class SceneChecks(Protocol):
    """What a task adds to the audit. It survives pickling, as does what it folds a file into."""

    @property
    def checks(self) -> tuple[Part[SceneSums], ...]:
        """What it asks."""

    def fold(self, frames: Columns, base: int, episodes: EpisodeIndex, reading: Reading, schema: Schema) -> Any:
        """Sum up one data file, whose first row is frame `base`; None where the scene's columns are not there."""

    def not_checked(self, root: Path) -> Iterator[str]:
        """Say what it could not look at, although it has all of its columns."""
