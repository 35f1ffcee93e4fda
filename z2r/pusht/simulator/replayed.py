"""Do the recorded actions still do what they did? Play them again, as somebody reads them, and see.

It is what one does first on a real arm. Nobody looks at what happens meanwhile: the loop is open. What forgives a
misreading here may still cost a policy everything, and the other way round.
"""

from collections.abc import Sequence

import numpy as np

from z2r.arrays import Floats
from z2r.format.dataset import Dataset
from z2r.format.schema import ACTION
from z2r.pusht.beliefs import BELIEFS
from z2r.pusht.played import Rollout
from z2r.pusht.simulator.env import PushTEnv
from z2r.pusht.task import CONTROL_HZ
from z2r.reading.breaks import BREAK_MODES, BreakMode

MODES: dict[str, BreakMode | None] = {
    "as-recorded": None,
    **{name: BREAK_MODES[name] for name in ("inclusive-end", "wrong-fps", "action-lag")},
    **BELIEFS,
}
"""What the actions of an episode can be taken for, by name."""

STANDS_STILL = 1.0  # s, after the last action: a robot is where it is when its replay ends


def replay(dataset: Dataset, seeds: Sequence[int], mode: BreakMode | None = None) -> list[Rollout]:
    """Play the actions of each episode again, from where it began.

    Parameters
    ----------
    dataset : Dataset
        Recorded in the simulator.
    seeds : sequence of int
        Where its episodes began, as the verdict beside it says.
    mode : BreakMode, optional
        How actions, episodes or the clock are read wrong. Where episodes are lost, so are the last seeds.

    Returns
    -------
    list of Rollout
        One for each episode, as it is believed to be. It ends with success, or `STANDS_STILL` after the last action.
    """
    believed = mode.believe(dataset, None)[0] if mode else dataset
    action, fps = believed.read(ACTION).astype(np.float64), round(believed.schema.fps)
    return [
        play(action[believed.episodes[number]], seed, fps)
        for number, seed in zip(range(len(believed.episodes)), seeds, strict=False)
    ]


def play(action: Floats, seed: int, fps: int = CONTROL_HZ) -> Rollout:
    """Play some actions, (n, 2) [m/s], from a start, so many in a second, until the simulator calls it a success."""
    asked = np.concatenate([action, np.zeros((round(STANDS_STILL * fps), 2))])
    env = PushTEnv(len(asked), fps)
    states = [env.reset(seed), *(env.step(each).observation for each in asked if env.running)]
    return Rollout(env.success, np.array(states), asked[: env.steps])
