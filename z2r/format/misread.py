"""What does somebody see who takes some columns for something else? The same files, with other numbers in them."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from z2r.arrays import Columns, Floats
from z2r.format.episodes import EpisodeIndex, parts_within


class Misread(NamedTuple):
    """Columns that are taken for something else.

    Attributes
    ----------
    columns : tuple of (str, int)
        Which ones: a feature, and a dimension of it.
    change : callable
        Takes their values in some frames, float64[n_frames, n_columns], those of `beside` behind them, and which of
        the frames each episode has. Returns what the columns are taken for. It survives pickling.
    beside : tuple of (str, int)
        Columns that are what they are, and without which nobody can say what the others are taken for.
    """

    columns: tuple[tuple[str, int], ...]
    change: Callable[[Floats, EpisodeIndex], Floats]
    beside: tuple[tuple[str, int], ...] = ()

    @property
    def features(self) -> tuple[str, ...]:
        """The features that its columns are in."""
        return tuple(dict.fromkeys(name for name, _ in self.columns))

    @property
    def needed(self) -> tuple[str, ...]:
        """The features that must be there."""
        return tuple(dict.fromkeys(name for name, _ in (*self.columns, *self.beside)))

    def __call__(self, frames: Columns, first: int, episodes: EpisodeIndex) -> Columns:
        """Return some frames as they are taken; as they are, where something that is needed is not among them.

        Parameters
        ----------
        frames : dict of str to ndarray, (n_frames, size of the feature)
            Frames that follow each other, such as those of a data file. They are left as they are.
        first : int
            Which frame of the dataset they begin with.
        episodes : EpisodeIndex
            Where episodes end; those that have no part in the frames do not matter.
        """
        if not set(self.needed) <= set(frames):
            return frames
        columns = [frames[name][:, dim].astype(np.float64) for name, dim in (*self.columns, *self.beside)]
        _, starts, stops = parts_within(episodes, first, first + len(columns[0]))
        changed = self.change(np.stack(columns, axis=1), EpisodeIndex(starts, stops))  # (n, k)
        # Copies; what is stored as whole numbers need not be taken for whole numbers.
        taken: Columns = {name: frames[name].astype(np.result_type(frames[name], np.float32)) for name in self.features}
        for (name, dim), column in zip(self.columns, changed.T, strict=True):
            taken[name][:, dim] = column
        return frames | taken
