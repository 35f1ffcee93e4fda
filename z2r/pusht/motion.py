"""Does the action move the pusher the way it says? Found by correlating the two, at once and shifted by some frames."""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from z2r.arrays import Bools, Floats, Ints
from z2r.check import Answer
from z2r.errors import Fault, count
from z2r.format.episodes import DATA_DIR
from z2r.format.rules import and_more

SHIFTS = (0, -1, 1, -2, 2)  # frames by which an action may be late or early; 0 first, so that it wins a tie
STILL = 0.005  # m/s: less is no motion

_LOUD = 0.05  # m/s: more than that was meant
_MIN_STEPS = 20  # from fewer nothing can be said about a correlation
_CLEARLY = 0.1  # better, of two correlations
_EXPLAINS = 0.5  # correlation of an action with what it does: 0.99 on the shipped data
# Of the speed that is asked for, what is reached: 0.92 to 0.96 on the shipped data, less the noisier the action is.
_SCALES = (0.55, 1.5)


def motion_sums(velocity: Floats, action: Floats, inside: Bools, starts: Ints, lag: int) -> Floats:
    """Sum up all from which the correlation of action and velocity follows, for each episode, shift and axis.

    Parameters
    ----------
    velocity : ndarray, float64[n - 1, 2]
        Of the pusher, from each frame to the next [m/s].
    action : ndarray, float64[n, 2]
        The velocity that is asked for [m/s].
    inside : ndarray, bool[n - 1]
        Whether one episode holds a frame and the next.
    starts : ndarray, int64[n_episodes]
        The first frame of each episode.
    lag : int
        By how many frames the reader believes an action to be stored late.

    Returns
    -------
    ndarray, float64[n_episodes, n_shifts, 6, 2]
        Number of frames, sums of action a and velocity v, and of a², v² and a v. NaN but for the first shift, where all
        episodes are explained so well by it that no other can be clearly better.
    """
    n, far = len(action), max(map(abs, SHIFTS)) + abs(lag)
    segment = np.concatenate([[0], np.cumsum(~inside)])  # the same number where frames hang together
    # The last frame has no motion, and may be an episode; before the first action and after the last there is none.
    moved, asked = np.zeros((2, n)), np.zeros((2, n + 2 * far))
    moved[:, :-1], asked[:, far : far + n] = velocity.T, action.T
    hangs, known = np.full(n + 2 * far, -1), np.append(inside, False)
    hangs[far : far + n] = segment
    sums = np.full((2, 6, len(SHIFTS), len(starts)), np.nan).T  # in memory, episodes lie beside each other
    for place, shift in enumerate(SHIFTS):
        if place == 1 and _surely_at_once(sums):
            break
        # Frame by frame, the action that would be the cause; where there is none, the frame does not count.
        causes = slice(far + shift + lag, far + shift + lag + n)
        counts = (known & (hangs[causes] == segment)).astype(np.float64)
        sums[:, place, 0] = np.add.reduceat(counts, starts)[:, None]
        for axis, (a, v) in enumerate(zip(asked[:, causes], moved, strict=True)):
            cause, effect = a * counts, v * counts
            for row, values in enumerate((cause, effect, cause * a, effect * v, cause * v), start=1):
                sums[:, place, row, axis] = np.add.reduceat(values, starts)
    return sums


def _surely_at_once(sums: Floats) -> bool:
    """Tell whether the first shift explains all episodes so well that no other can be clearly better."""
    fit = _fit(sums[:, :1])
    strength = np.abs(fit.correlation[:, 0]).mean(axis=1)
    return bool(((strength >= 1 - _CLEARLY) | (fit.n < _MIN_STEPS)).all())


def motion_faults(episodes: Ints, parts: Floats) -> Iterator[Answer]:
    """Judge each episode by itself, and all together where most are wrong, or each is too short to judge.

    Parameters
    ----------
    episodes : ndarray, int64[n_parts]
        The number of the episode that each part belongs to.
    parts : ndarray, float64[n_parts, n_shifts, 6, 2]
        From `motion_sums`.
    """
    numbers, place = np.unique(episodes, return_inverse=True)
    if (place[1:] > place[:-1]).all():  # each is an episode of its own, in order: as in most datasets
        motion = parts
    else:
        motion = np.zeros((len(numbers), *parts.shape[1:]))
        np.add.at(motion, place, parts)
    fit, of_all = _fit(motion), _fit(np.nansum(motion, axis=0, keepdims=True))
    fault, fault_of_all = _faults(fit), _faults(of_all)
    wrong = np.flatnonzero(fault)
    if fault_of_all.any() and (not len(wrong) or len(wrong) > len(numbers) / 2):
        yield Fault(DATA_DIR, "action against the motion of the pusher", *_say(of_all, fault_of_all, 0))
    elif len(wrong):
        found, expected, mend = _say(fit, fault, int(wrong[0]))
        episode = f"action in episode {numbers[wrong[0]]}"
        named = tuple(numbers[wrong].tolist())
        yield "warning", Fault(DATA_DIR, episode, f"{found}{and_more(fault > 0)}", expected, mend, named)


class _Fit(NamedTuple):
    """How well the action explains the motion of the pusher: a row for each episode, or one for all together."""

    n: Floats  # steps
    asked: Floats  # (n_rows, 2 axes), m/s: root mean square of the action
    moved: Floats  # (n_rows, 2 axes), m/s: and of the velocity
    spread: Floats  # m/s: the smaller standard deviation of both, along the axis where it is smaller
    correlation: Floats  # (n_rows, n_shifts, 2 axes)
    scale: Floats  # (n_rows, 2 axes): velocity over action


_FINE, _ONE_IS_STILL, _UNEXPLAINED, _SHIFTED, _AGAINST, _SCALED = range(6)


def _fit(motion: Floats) -> _Fit:
    n, a, v, aa, vv, av = np.moveaxis(motion, 2, 0)
    with np.errstate(divide="ignore", invalid="ignore"):
        spreads = np.sqrt(np.maximum([n * aa - a**2, n * vv - v**2], 0)) / n
        correlation = (n * av - a * v) / (spreads[0] * spreads[1] * np.square(n))
        asked, moved = np.sqrt(aa[:, 0] / n[:, 0]), np.sqrt(vv[:, 0] / n[:, 0])
        scale = av[:, 0] / aa[:, 0]
    return _Fit(n[:, 0].min(axis=1), asked, moved, spreads[:, :, 0].min(axis=(0, 2)), correlation, scale)


def _one_is_still(fit: _Fit) -> Bools:
    """Tell of each axis whether only one of action and pusher moves along it."""
    quiet: Bools = np.minimum(fit.asked, fit.moved) < STILL
    return quiet & (np.maximum(fit.asked, fit.moved) > _LOUD)


def _faults(fit: _Fit) -> Ints:
    """Say what is wrong with each row; nothing is said of a few steps, or of an axis along which nothing changes."""
    with np.errstate(invalid="ignore"):
        strength = np.abs(fit.correlation).mean(axis=2)
        strongest = np.fmax.reduce(strength, axis=1)  # of those that are known
        enough = fit.n >= _MIN_STEPS
        comparable = enough & (fit.spread >= STILL)
        return np.select(
            [
                enough & _one_is_still(fit).any(axis=1),
                comparable & (strongest < _EXPLAINS),
                comparable & (strongest > strength[:, 0] + _CLEARLY),
                comparable & (fit.correlation[:, 0].min(axis=1) < 0),
                comparable & ((fit.scale.min(axis=1) < _SCALES[0]) | (fit.scale.max(axis=1) > _SCALES[1])),
            ],
            [_ONE_IS_STILL, _UNEXPLAINED, _SHIFTED, _AGAINST, _SCALED],
            _FINE,
        )


def _say(fit: _Fit, fault: Ints, row: int) -> tuple[str, str, str]:
    """Say what was found, what was expected, and how to mend it."""
    correlation = fit.correlation[row]
    if fault[row] == _ONE_IS_STILL:
        axis = int(_one_is_still(fit)[row].argmax())
        asked, moved = fit.asked[row, axis], fit.moved[row, axis]
        found = f"motion of {moved:.2g} m/s along {'xy'[axis]}, and {asked:.2g} m/s asked for"
        return found, "both, or neither", "A column is stuck, or was never recorded"
    if fault[row] == _UNEXPLAINED:
        mend = "Are the columns of the action, or of the pusher, in another order?"
        return f"a correlation of {correlation[0].mean():.2f}", "the action to move the pusher", mend
    if fault[row] == _SHIFTED:
        strength = np.abs(correlation).mean(axis=1)
        shift = SHIFTS[int(np.nanargmax(strength))]
        late = f"{count(abs(shift), 'frame')} {'after' if shift < 0 else 'before'}"
        expected = f"it at once (correlation {np.nanmax(strength):.2f} there, {strength[0]:.2f} at once)"
        mend = "Actions and observations are shifted against each other"
        return f"the best match {late} the action is stored", expected, mend
    if fault[row] == _AGAINST:
        axes = " and ".join(axis for axis, value in zip("xy", correlation[0], strict=True) if value < 0)
        return (
            f"motion against the action along {axes}",
            "motion the same way",
            "A sign is wrong, or time runs backwards",
        )
    mend = "Check the fps, the units (m or mm, m/s or m per frame), and whether frames are missing"
    return f"{fit.scale[row].mean():.3g} times the speed that is asked for", "about that speed", mend
