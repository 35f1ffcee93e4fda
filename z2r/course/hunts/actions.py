"""The hunt of `06_what_is_an_action`: robots that nobody has seen. What does their action drive, how, and how late?"""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from z2r.arrays import Floats
from z2r.course.hunts._core import SEED, Marks, Trial, judge, rng_of, shuffled

LATEST = 0.4  # s: no robot here answers later

_NUMBER = 6
_N_COLUMNS = 4
_HASTE = 0.12  # s: how long a command keeps its way
_NOISE = 0.003  # of a column's range
_FACTORS = (1.0, -1.0, 57.3, 0.01745, 1000.0, -0.01)
_CLOSE = 0.1  # of a factor, or of the frames ahead: nearer than that is right, and so is one frame


def score(what_is: Callable[..., Any], seed: int = SEED) -> None:
    """Score a function that says what an action is.

    Parameters
    ----------
    what_is : callable
        The learner's: takes one dimension of an action, float64[n_frames], the state, float64[n_frames, 4], and the
        frames a second. Returns ``("target" or "change", column, ahead, factor)``: which column of the state is, or
        changes in a frame by, the action divided by the factor, so many frames after the action. A change from frame
        to frame counts where it ends. Returns None where no column does.
    seed : int, optional
        Of the robots.
    """
    hint = "Shift, fit, look at what is left. How many frames are 0.4 s for this robot, and which way does it turn?"
    expected = 'None, or ("target" or "change", column, frames ahead, factor)'
    judge(what_is, _trials(rng_of(_NUMBER, seed)), _mark, expected, hint)


def examples() -> list[Trial]:
    """Return some robots to look at: ``action, state, fps = examples()[0].args``; ``truth`` says what the action is."""
    return _trials(rng_of(_NUMBER))


def _mark(answer: Any, truth: tuple[str, int, int, float] | None) -> Marks | None:
    if answer is None:
        return Marks(right=1) if truth is None else Marks(missed=1)
    if not isinstance(answer, tuple | list) or len(answer) != 4 or answer[0] not in ("target", "change"):
        return None
    kind, column, ahead, factor = answer
    numbers = float(column), float(ahead), float(factor)  # what cannot be a number is no answer
    if truth is None:
        return Marks(false=1)
    late = abs(numbers[1] - truth[2]) <= max(1.0, _CLOSE * truth[2])
    scaled = abs(numbers[2] - truth[3]) <= _CLOSE * abs(truth[3])
    right = kind == truth[0] and numbers[0] == truth[1] and late and scaled
    return Marks(right=1) if right else Marks(missed=1)


def _trials(rng: np.random.Generator) -> list[Trial]:
    return shuffled(rng, _robots(rng))


def _robots(rng: np.random.Generator) -> Iterator[Trial]:
    for _ in range(2):
        yield _robot(rng, "an arm that is told where to be", "target", 30, rng.uniform(0.06, 0.2))
        yield _robot(rng, "a cart that is told how far to move on", "change", 10, 0.1)
        yield _robot(rng, "a hand that is told how fast to go, and takes its time", "change", 30, rng.uniform(0.1, 0.2))
        yield _robot(rng, "an arm of 100 frames a second", "target", 100, rng.uniform(0.22, 0.38))
        yield _robot(rng, "a slow arm of 200 frames a second", "target", 200, rng.uniform(0.2, 0.38))
        yield _robot(rng, "a hand of 100 frames a second that is told how fast to go", "change", 100, 0.3)
        yield _robot(rng, "a demonstration of less than two seconds", "target", 30, rng.uniform(0.06, 0.2), seconds=1.8)
        yield _robot(rng, "an action that drives what no column tells", None, 30, 0.1)


def _robot(
    rng: np.random.Generator, what: str, kind: str | None, fps: int, delay: float, seconds: float = 15.0
) -> Trial:
    """Let a robot do what chance tells it, a delay [s] later, and measure it."""
    n, ahead = round(seconds * fps), max(1, round(delay * fps))
    told, *others = (_wanted(rng, n + ahead, fps) for _ in range(_N_COLUMNS + 1))
    column, factor = int(rng.integers(_N_COLUMNS)), float(rng.choice(_FACTORS))
    if kind is not None:
        others[column] = told if kind == "target" else np.cumsum(told)
    late = np.stack(others, axis=1)[:n]  # what is done now was told `ahead` frames ago
    late += rng.normal(size=late.shape) * _noise_of(late, kind == "change")
    action = factor * told[ahead:] if kind is None else factor * told[ahead : ahead + n]
    state = late + rng.uniform(-2, 2, _N_COLUMNS)
    return Trial(what, (action, state, fps), None if kind is None else (kind, column, ahead, factor))


def _noise_of(values: Floats, is_summed_up: bool) -> Floats:
    """How much noise a sensor adds to each column: of one that moves in small steps, a share of a step."""
    own = np.diff(values, axis=0).std(axis=0) if is_summed_up else np.ptp(values, axis=0)
    noise: Floats = _NOISE * own
    return noise


def _wanted(rng: np.random.Generator, n: int, fps: int) -> Floats:
    """Return what somebody wants who changes his mind, but not at once."""
    width = max(1, round(_HASTE * fps))
    kernel = np.hanning(2 * width + 1)
    wanted: Floats = np.convolve(rng.normal(size=n + 2 * width), kernel, "valid")
    wanted /= wanted.std()
    return wanted
