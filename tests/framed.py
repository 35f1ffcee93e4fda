"""A dataset for every check that can name a frame. `test_audit.py` and `test_motion.py` hold that no other one does."""

from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np
from arm_damages import write_case
from damages import BASES, POSITIONS, SIN_COS, TARGET_SIN_COS, change_values, make

from z2r.pusht.task import ACTION_NAMES


def turn_the_world(root: Path) -> None:
    """Turn the table that everything stands on by half a turn: the same story, seen from the other side."""
    everything = (*POSITIONS, *SIN_COS, *TARGET_SIN_COS, *ACTION_NAMES)
    BASES["split"](root)
    change_values(everything, np.negative)(root)


FRAMED: dict[str, Callable[[Path], object]] = {
    "action-range": partial(make, "actions in cm/s"),
    "discontinuity": partial(write_case, "joined", "one"),
    "frozen": partial(make, "a state stuck for 20 frames"),
    "jump": partial(make, "one glitched value"),
    "leap": partial(make, "one boundary off by one"),
    "overlap": partial(make, "a block frozen in one episode"),
    "quaternion-sign": partial(write_case, "quaternion-flips", "all"),
    "stall": partial(write_case, "stall", "place"),
    "timestamp": partial(make, "fps 30 on 10 Hz data"),
    "unit-circle": partial(make, "one glitched sine"),
    "unit-quaternion": partial(write_case, "quaternion-norm", "all"),
    "yaw-error": turn_the_world,  # which is read as READ_AS says
}
READ_AS = {"yaw-error": "no-wrap"}
