"""Does a policy do it? The simulator runs it from starts that it has not seen, and says how each of them ends.

All starts are played side by side: the network is asked once for all of them, and most of what it says is
played before it is asked again.
"""

from collections.abc import Callable, Sequence

import numpy as np

from z2r.arrays import Floats
from z2r.format.schema import Schema
from z2r.pusht.cloning.data import CHUNK, Vantage, axes, inputs, see, turn
from z2r.pusht.played import Rollout
from z2r.pusht.simulator.env import PushTEnv
from z2r.pusht.task import ACTION_LIMIT, CONTROL_HZ, MAX_STEPS
from z2r.reading.reading import Reading

PLAYED = 6  # actions of a chunk: asked again after each, a policy lingers where it has just been


def roll_out(
    policy: Callable[[Floats], Floats],
    starts: Sequence[int],
    reading: Reading,
    schema: Schema,
    vantage: Vantage = "block",
    fps: int = CONTROL_HZ,
    max_seconds: float = MAX_STEPS / CONTROL_HZ,
) -> list[Rollout]:
    """Play a policy from some starts.

    Parameters
    ----------
    policy : callable
        Maps inputs, float64[n, 13], to chunks of actions, float64[n, CHUNK, 2], as `Policy` does.
    starts : sequence of int
        A seed for each.
    reading : Reading
        How what is observed is read.
    schema : Schema
        Where its columns stand.
    vantage : str, optional
        From where the policy sees the scene.
    fps : int, optional
        How many actions are played in a second.
    max_seconds : float, optional
        When to give up [s].
    """
    envs = [PushTEnv(round(max_seconds * fps), fps) for _ in starts]
    states = [[env.reset(seed)] for env, seed in zip(envs, starts, strict=True)]
    actions: list[list[Floats]] = [[] for _ in starts]
    while running := [number for number, env in enumerate(envs) if env.running]:
        now, before = (see(np.array([states[each][-back:][0] for each in running]), reading, schema) for back in (1, 2))
        last = np.array([actions[each][-1] if actions[each] else np.zeros(2) for each in running])
        chunks = turn(policy(inputs(now, before, last, vantage)), axes(now, vantage)[:, None])
        chunks = np.clip(chunks, -ACTION_LIMIT, ACTION_LIMIT)  # (n, CHUNK, 2)
        for each, chunk in zip(running, chunks, strict=True):
            for action in chunk[:PLAYED]:
                if envs[each].running:
                    states[each].append(envs[each].step(action).observation)
                    actions[each].append(action)
    ends = zip(envs, states, actions, strict=True)
    return [Rollout(env.success, np.array(seen), np.array(done)) for env, seen, done in ends]


def stand_still(inputs: Floats) -> Floats:
    """Do nothing, whatever is seen."""
    return np.zeros((len(inputs), CHUNK, 2))
