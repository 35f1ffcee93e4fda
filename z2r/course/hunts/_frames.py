"""What do the hunts draw from? The episodes of the datasets that ship, column by column."""

from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from z2r.api import load
from z2r.arrays import Floats
from z2r.format.schema import ACTION, STATE
from z2r.reading.reading import column_names

COMMAND = f"{ACTION}/"
"""What the name of a column begins with that is a command."""

_WORLD = "observation.environment_state"

type Frames = dict[str, NDArray[Any]]
"""The columns of some frames by their names, float64[n_frames] each; and pictures, where there are any."""


@cache
def names_of(root: Path) -> dict[str, list[str]]:
    """Name the columns of each feature as a reading does, but for those of the world, which need no address here."""
    schema = load(root).schema
    features = [feature for feature in (STATE, _WORLD, ACTION) if feature in schema.features]
    return {name: [each.removeprefix(f"{_WORLD}/") for each in column_names(name, schema)] for name in features}


@cache
def _recorded(root: Path) -> tuple[Frames, ...]:
    dataset = load(root)
    columns: Frames = {}
    for feature, names in names_of(root).items():
        columns |= dict(zip(names, dataset.read(feature).T.astype(np.float64), strict=True))
    episodes = (dataset.episodes[number] for number in range(len(dataset.episodes)))
    return tuple({name: values[frames] for name, values in columns.items()} for frames in episodes)


def episodes_of(root: Path) -> list[Frames]:
    """Return the columns of each episode of a dataset, which are the caller's own."""
    return [{name: values.copy() for name, values in frames.items()} for frames in _recorded(root)]


def side_by_side(frames: Frames, names: Sequence[str]) -> Floats:
    """Return some columns as an array, float64[n_frames, n]."""
    return np.stack([frames[name] for name in names], axis=1)
