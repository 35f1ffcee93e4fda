"""Do solid bodies overlap? A check of a reading that needs no label.

The pusher is a disc and the block is two boxes, both solid. Whatever a dataset is about, the disc cannot stand inside a
box, apart from the millimetres by which a simulated contact gives way. A reading that puts it there is wrong.
"""

import numpy as np

from z2r.arrays import Array, Floats
from z2r.format.schema import Schema
from z2r.pusht import task
from z2r.reading.reading import Reading, named_columns, read_pose

# m: deeper than this, no contact gives way. Right readings were seen to reach 3.4 mm on the shipped data and 5.6 mm on
# another simulated recording of the task, wrong ones 30 mm.
LIMIT = 0.010

_BOXES = ((task.BAR_CENTER, task.BAR_HALF_SIZE), (task.STEM_CENTER, task.STEM_HALF_SIZE))


def overlap(state: Array, reading: Reading, schema: Schema) -> Floats:
    """Measure how far the pusher sinks into the block in every frame.

    Parameters
    ----------
    state : ndarray, (n_frames, size of the feature)
        Values of the feature that `reading` reads.
    reading : Reading
        What the columns mean.
    schema : Schema
        Where the columns stand.

    Returns
    -------
    ndarray, float64[n_frames]
        How far the edge of the pusher is inside the bar or the stem, whichever is more [m]; 0 where it is outside both.
        Of a pusher whose centre is inside a box, the way out to the nearest side counts.

    Raises
    ------
    ValueError
        If the schema lacks a column of the reading.
    """
    across, along = pusher_in_block(state, reading, schema)
    distances = [_distance_to_box(across - x, along - y, half_size) for (x, y), half_size in _BOXES]
    return np.maximum(task.PUSHER_RADIUS - np.minimum(*distances), 0.0)


def pusher_in_block(state: Array, reading: Reading, schema: Schema) -> tuple[Floats, Floats]:
    """Say where the pusher is as seen from the block.

    Parameters
    ----------
    state : ndarray, (n_frames, size of the feature)
        Values of the feature that `reading` reads.
    reading : Reading
        What the columns mean.
    schema : Schema
        Where the columns stand.

    Returns
    -------
    across, along : ndarray, float64[n_frames]
        Coordinates of the pusher's centre in the frame of the block [m]: the bar lies across, the stem along.
    """
    columns = named_columns(state, reading, schema)
    block = read_pose(columns, reading.tee)
    dx, dy = (columns[name] - at for name, at in zip(reading.pusher, (block.x, block.y), strict=True))
    sine, cosine = np.sin(block.yaw), np.cos(block.yaw)
    return cosine * dx + sine * dy, -sine * dx + cosine * dy


def _distance_to_box(x: Floats, y: Floats, half_size: tuple[float, float, float]) -> Floats:
    """Measure from points to the nearest side of a box around the origin [m], negative where they are inside it."""
    beyond_x, beyond_y = np.abs(x) - half_size[0], np.abs(y) - half_size[1]
    outside: Floats = np.hypot(np.maximum(beyond_x, 0.0), np.maximum(beyond_y, 0.0))
    inside: Floats = np.minimum(np.maximum(beyond_x, beyond_y), 0.0)
    return outside + inside
