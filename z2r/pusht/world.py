"""What are the bodies of PushT, and what does its reading say? Pusher, block and target, and `PUSHT`."""

from pathlib import Path

import numpy as np

from z2r.arrays import Floats
from z2r.pusht import task
from z2r.reading.bodies import Body, Box, Disc
from z2r.reading.reading import Reading, read_reading
from z2r.reading.success import in_tolerance as within_goals

PUSHT: Reading = read_reading(Path(__file__).with_name("pusht.toml"))

TEE_BOXES = tuple(Box(center, half_size) for center, half_size in task.TEE)


def _tee_outline() -> Floats:
    """Around the T in its own frame, (8, 2) [m]: the stem hangs from the lower edge of the bar."""
    bar, stem = (box.corners for box in TEE_BOXES)
    return np.concatenate([bar[:3], stem[1:3], stem[3:], stem[:1], bar[3:]])


_MARKING = tuple(Box(center, (*half_size[:2], 0.0005)) for center, half_size in task.TEE)  # m: half as high as paint

BODIES: dict[str, Body] = {
    "target": Body("target", "goal", _MARKING, _tee_outline(), z=0.0005, flat=True),
    "tee": Body("block", "object", TEE_BOXES, _tee_outline(), z=task.TEE_Z),
    "pusher": Body("pusher", "robot", (Disc(task.PUSHER_RADIUS, task.PUSHER_LENGTH),), z=task.PUSHER_Z),
}


def in_tolerance(pos_err: float, ang_err: float) -> bool:
    """Whether a distance [m] and a turn [rad] are both within the tolerances of the task, as its reading has them.

    >>> in_tolerance(0.01, 0.1), in_tolerance(0.01, 3.1), in_tolerance(0.03, 0.1)
    (True, False, False)
    """
    errors = {"pos_err": np.array([pos_err]), "ang_err": np.array([ang_err])}
    return bool(within_goals(errors, PUSHT)[0])
