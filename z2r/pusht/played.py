"""How did a start go? What was seen, what was done, and what the simulator said of it."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from z2r.arrays import Floats


class Rollout(NamedTuple):
    """How one start went.

    Attributes
    ----------
    success : bool
        The simulator's verdict.
    states : ndarray, float32[n_steps + 1, 10]
        What was observed, from the start to the end, in the order of ``STATE_NAMES``.
    actions : ndarray, float64[n_steps, 2]
        What was done [m/s].
    """

    success: bool
    states: NDArray[np.float32]
    actions: Floats
