"""The hunt of `10_cost_of_a_misreading`: which of these misreadings ruin a policy? The answer is played, not argued.

A small world, in which a policy is trained in a millisecond: a hand goes to a goal on a table, as it was shown. What is
misread is what the policy learns from, or what it sees when it is played, or both.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from z2r.arrays import Floats
from z2r.course.hunts._core import SEED, Trial, judge, one_of, rng_of, shuffled

_NUMBER = 10
_FPS = 10
_N_SHOWN, _N_FRAMES = 40, 40
_N_STARTS, _N_STEPS = 50, 80
_THERE = 0.03  # m: so near is there
_SPEED = 0.5  # m/s, at most
_TREMOR = 0.05  # m/s, of who shows it
_HAND, _GOAL, _YAW = [0, 1], [2, 3], [4, 5]  # columns of the state: x and y [m] twice, sine and cosine

type _Change = Callable[[np.random.Generator, Floats], Floats]


def _as_it_is(rng: np.random.Generator, values: Floats) -> Floats:
    return values


class _Misreading(NamedTuple):
    """What becomes of state and action in training, and of the state in play, (n_episodes, n_frames, n) each."""

    state: _Change = _as_it_is
    action: _Change = _as_it_is
    seen: _Change = _as_it_is


def score(ruins: Callable[..., Any], seed: int = SEED) -> None:
    """Score a function that says whether a misreading ruins a policy.

    Parameters
    ----------
    ruins : callable
        The learner's: takes the state, float64[n, 6], and the action, float64[n, 2], that a policy learns from; and
        those of other demonstrations, the state as the policy will see it and the action that it should then choose.
        Returns True where a policy that learnt so succeeds in less than half of its tries.
    seed : int, optional
        Of the misreadings.
    """
    hint = "Let one line learn the action from the state. Ask it where it will be, and compare: which way, how far?"
    judge(ruins, _trials(rng_of(_NUMBER, seed)), one_of((True, False), nothing=False), "True or False", hint)


def examples() -> list[Trial]:
    """Return some misreadings to look at; ``truth`` says whether the policy was ruined."""
    return _trials(rng_of(_NUMBER))


def _trials(rng: np.random.Generator) -> list[Trial]:
    return shuffled(rng, (_played(rng, what, misreading) for what, misreading in _MISREADINGS.items()))


def _played(rng: np.random.Generator, what: str, misreading: _Misreading) -> Trial:
    """Train a policy so, and play it: that is the truth."""
    gain = rng.uniform(2.0, 3.0)
    state, action = _shown(rng, gain)
    learnt = _flat(misreading.state(rng, state)), _flat(misreading.action(rng, action))
    policy = np.linalg.lstsq(_with_one(learnt[0]), learnt[1], rcond=None)[0]  # (7, 2)
    new_state, new_action = _shown(rng, gain)
    met = _flat(misreading.seen(rng, new_state)), _flat(new_action)
    world = _start(rng, _N_STARTS)
    for _ in range(_N_STEPS):
        seen = misreading.seen(rng, world[:, np.newaxis])[:, 0]
        world[:, _HAND] += (_with_one(seen) @ policy).clip(-_SPEED, _SPEED) / _FPS
    gap = np.hypot(*(world[:, _HAND] - world[:, _GOAL]).T)
    return Trial(what, (*learnt, *met), bool((gap < _THERE).mean() < 0.5))


def _start(rng: np.random.Generator, n: int) -> Floats:
    """Return where hands and goals are, and where the hands point, which is of no use here, (n, 6)."""
    yaw = rng.uniform(-np.pi, np.pi, n)
    return np.column_stack([rng.uniform(-0.3, 0.3, (n, 4)), np.sin(yaw), np.cos(yaw)])


def _shown(rng: np.random.Generator, gain: float) -> tuple[Floats, Floats]:
    """Let somebody show it, with a hand that is not steady: state (n_episodes, n_frames, 6), action (..., 2) [m/s]."""
    world, states, actions = _start(rng, _N_SHOWN), [], []
    for _ in range(_N_FRAMES):
        way = gain * (world[:, _GOAL] - world[:, _HAND])
        actions.append(way.clip(-_SPEED, _SPEED) + rng.normal(0, _TREMOR, way.shape))
        states.append(world.copy())
        world[:, _HAND] += actions[-1] / _FPS
    return np.stack(states, axis=1), np.stack(actions, axis=1)


def _flat(values: Floats) -> Floats:
    return values.reshape(-1, values.shape[-1])


def _with_one(state: Floats) -> Floats:
    return np.column_stack([state, np.ones(len(state))])


def _times(factor: float, columns: Sequence[int] = (0, 1)) -> _Change:
    def change(rng: np.random.Generator, values: Floats) -> Floats:
        values = values.copy()
        values[..., columns] *= factor
        return values

    return change


def _exchange(columns: Sequence[int]) -> _Change:
    def change(rng: np.random.Generator, values: Floats) -> Floats:
        values = values.copy()
        values[..., columns] = values[..., columns[::-1]]
        return values

    return change


def _beside(distance: float) -> _Change:
    return lambda rng, state: state + np.array([distance, 0, 0, 0, 0, 0])


def _late(n: int) -> _Change:
    """Store the action so many frames late, or early."""

    def change(rng: np.random.Generator, action: Floats) -> Floats:
        return action[:, np.clip(np.arange(_N_FRAMES) - n, 0, _N_FRAMES - 1)]

    return change


def _spoil(share: float, factor: float) -> _Change:
    """Let so many of the demonstrations do something else: this many times what they should have."""

    def change(rng: np.random.Generator, action: Floats) -> Floats:
        n = round(share * len(action))
        return np.concatenate([factor * action[:n], action[n:]])

    return change


def _goal_of_another(rng: np.random.Generator, state: Floats) -> Floats:
    state = state.copy()
    state[..., _GOAL] = np.roll(state[..., _GOAL], 1, axis=0)
    return state


_MISREADINGS: Mapping[str, _Misreading] = {
    "nothing is wrong": _Misreading(),
    "the hand in millimetres, in training and in play": _Misreading(state=_times(1000), seen=_times(1000)),
    "the hand in millimetres, in training only": _Misreading(state=_times(1000)),
    "the hand in millimetres, in play only": _Misreading(seen=_times(1000)),
    "vx and vy exchanged, in training only": _Misreading(action=_exchange(_HAND)),
    "x and y of the hand exchanged, in training and in play": _Misreading(_exchange(_HAND), seen=_exchange(_HAND)),
    "x and y of the hand exchanged, in training only": _Misreading(_exchange(_HAND)),
    "x and y of the goal exchanged, in play only": _Misreading(seen=_exchange(_GOAL)),
    "sine and cosine exchanged, in training only": _Misreading(_exchange(_YAW)),
    "the camera 15 cm beside its place, in training and in play": _Misreading(_beside(0.15), seen=_beside(0.15)),
    "the camera 15 cm beside its place, in play only": _Misreading(seen=_beside(0.15)),
    "the camera 1 cm beside its place, in play only": _Misreading(seen=_beside(0.01)),
    "actions two frames late": _Misreading(action=_late(2)),
    "actions three frames early": _Misreading(action=_late(-3)),
    "actions twice as large": _Misreading(action=_times(2)),
    "actions a third as large": _Misreading(action=_times(1 / 3)),
    "actions in metres a frame": _Misreading(action=_times(1 / _FPS)),
    "actions in centimetres a second": _Misreading(action=_times(100)),
    "actions with the other sign": _Misreading(action=_times(-1)),
    "a tenth of the demonstrations without any action": _Misreading(action=_spoil(0.1, 0.0)),
    "six of ten demonstrations with the other sign": _Misreading(action=_spoil(0.6, -1.0)),
    "the goal of another episode": _Misreading(_goal_of_another),
}
