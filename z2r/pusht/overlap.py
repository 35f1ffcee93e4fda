"""Do solid bodies overlap? A check of a reading that needs no label.

The pusher is a disc and the block is two boxes, both solid. Whatever a dataset is about, the disc cannot stand inside a
box, apart from the millimetres by which a simulated contact gives way. A reading that puts it there is wrong.
"""

import numpy as np

from z2r.arrays import Floats, lengths
from z2r.pusht.task import PUSHER_RADIUS
from z2r.pusht.world import TEE_BOXES
from z2r.reading.bodies import Box
from z2r.reading.decode import Decoded

# m: deeper than this, no contact gives way. Right readings were seen to reach 3.4 mm on the shipped data and 5.6 mm on
# another simulated recording of the task, wrong ones 30 mm.
LIMIT = 0.010


def overlap(decoded: Decoded) -> Floats:
    """Measure how far the pusher sinks into the block in every frame.

    Parameters
    ----------
    decoded : Decoded
        From `z2r.decode`, with a reading that has the poses ``pusher`` and ``tee``.

    Returns
    -------
    ndarray, float64[n_frames]
        How far the edge of the pusher is inside the bar or the stem, whichever is more [m]; 0 where it is outside both.
        Of a pusher whose centre is inside a box, the way out to the nearest side counts.
    """
    across, along = pusher_in_block(decoded)
    distances = [_distance_to_box(across, along, box) for box in TEE_BOXES]
    return np.maximum(PUSHER_RADIUS - np.minimum(*distances), 0.0)


def pusher_in_block(decoded: Decoded) -> tuple[Floats, Floats]:
    """Say where the pusher is as seen from the block.

    Parameters
    ----------
    decoded : Decoded
        From `z2r.decode`, with a reading that has the poses ``pusher`` and ``tee``.

    Returns
    -------
    across, along : ndarray, float64[n_frames]
        Coordinates of the pusher's centre in the frame of the block [m]: the bar lies across, the stem along.
    """
    block, pusher, (cosine, sine) = decoded.pose("tee"), decoded.pose("pusher"), decoded.direction("tee")
    dx, dy = pusher.x - block.x, pusher.y - block.y
    return cosine * dx + sine * dy, -sine * dx + cosine * dy


def _distance_to_box(x: Floats, y: Floats, box: Box) -> Floats:
    """Measure from points to the nearest side of a box [m], negative where they are inside it."""
    (center_x, center_y), (half_x, half_y, _) = box
    beyond_x, beyond_y = np.abs(x - center_x) - half_x, np.abs(y - center_y) - half_y
    outside = lengths(np.maximum(beyond_x, 0.0), np.maximum(beyond_y, 0.0))
    inside: Floats = np.minimum(np.maximum(beyond_x, beyond_y), 0.0)
    return outside + inside
