"""Does a joint go as smoothly as its command, and turn round with it? Where it does not, look at its gears.

Such a joint follows well enough on the whole. What it lacks is seen from frame to frame, and where it turns round.
"""

from collections.abc import Iterator

import numpy as np

from z2r.arrays import Floats
from z2r.audits.following import MIN_FRAMES
from z2r.audits.joints import WELL, Joints, if_many, in_episodes
from z2r.audits.motion import parted
from z2r.check import Answer, Check
from z2r.format.schema import ACTION, STATE
from z2r.reading.joints import is_gripper

_STANDS, _OFTEN, _LEAPS = 0.3, 0.4, 0.02  # of the frames in which its command moves; of all; of its range
_PLAY, _PLAYS_APART = 0.03, 2  # of its range, and times as far as the episodes of one kind are from each other
_SURELY_SOLVED = 1e-6  # so that what stands still can be solved for, too


@Check("stick", "a joint moves as smoothly as its command", "note").of(Joints)
def no_joint_sticks(joints: Joints) -> Iterator[Answer]:
    """Does a joint stand exactly still in most frames and then leap, while its command and other joints go smoothly?"""
    moved, n = joints.moved, joints.runs.n[:, None]
    if not joints.pairs or STATE not in moved.steps or ACTION not in moved.steps:
        return
    seen, asked = (moved.steps[name] for name in (STATE, ACTION))
    usual = np.median(seen.moves / n, axis=1)  # a sensor that is read more seldom stands still in all columns
    for pair in joints.pairs:
        if pair.feature != STATE or is_gripper(pair.name):
            continue
        goes, told = seen.moves[:, pair.column], asked.moves[:, pair.dim]
        leap = seen.path[:, pair.column] / np.maximum(goes, 1)
        wrong = (goes < _STANDS * told) & (goes > 1) & (told > _OFTEN * n[:, 0]) & (goes < usual * n[:, 0] / 2)
        wrong &= (leap > _LEAPS * moved.spans(STATE)[pair.column]) & (joints.runs.n >= MIN_FRAMES)
        if wrong.any():
            run = int(np.where(wrong, leap, 0).argmax())
            still = 1 - goes[run] / joints.runs.n[run]
            found = f"the same number again in {still:.0%} of the frames, and leaps of about {leap[run]:.3g} in between"
            mend = "Does the joint stick and slip, or is its sensor stuck, or read too seldom? Look at it"
            expected = f"motion as smooth as that of {pair.command}, which changes in {told[run] / n[run, 0]:.0%}"
            yield in_episodes(pair.name, joints.number[wrong], found, expected, mend)


@Check("play", "a joint stays behind its command by as much on its way up as on its way down", "note").of(Joints)
def no_joint_has_more_play(joints: Joints) -> Iterator[Answer]:
    """Is a joint, in some episodes, farther behind where it turns round than its speed explains? A gear has play so."""
    known = joints.followed & (joints.usual["kind"] == 0) & ~joints.grips & (joints.usual["explained"] > WELL)
    for pair in np.flatnonzero(known).tolist() if len(joints.number) > 1 else ():
        play = _play(joints, pair)
        told = np.flatnonzero(np.isfinite(play))
        if len(told) < 2:
            continue
        few, gap, spread = parted(play[told])
        usual, more = sorted((told[few], np.delete(told, few)), key=lambda each: float(np.median(play[each])))
        if gap < max(_PLAY * joints.ranges[pair], _PLAYS_APART * spread) or len(more) > len(usual):
            continue  # where most have much, nothing is known of the others
        wrong = np.isin(np.arange(len(play)), more)
        found = f"{2 * np.median(play[more]):.3g} between its ways up and down, beyond what its speed explains"
        mend = "Has a gear or a horn come loose, or is it held back? Look at the joint"
        mend += if_many(wrong, np.isfinite(play))
        expected = f"about {2 * np.median(play[usual]):.2g}, as in the other episodes"
        yield in_episodes(joints.pairs[pair].name, joints.number[wrong], found, expected, mend)


def _play(joints: Joints, pair: int) -> Floats:
    """Fit how far a joint is behind to how fast its command goes and to which way it goes: what the way alone makes.

    Returns
    -------
    ndarray, float64[n_runs]
        In units of the command, half of what is between both ways; NaN where no moments are kept.
    """
    where, moved = joints.pairs[pair], joints.moved
    asked = moved.moments_of(ACTION)[..., where.dim].astype(np.float64)  # (n_runs, n_moments, 2)
    seen = joints.usual["factor"][pair] * moved.moments_of(where.feature)[..., where.column].astype(np.float64)
    play, n_moments = np.full(len(joints.number), np.nan), asked.shape[1]
    known = np.isfinite(asked).all(axis=(1, 2)) & np.isfinite(seen).all(axis=(1, 2)) & joints.judged[:, pair]
    known &= (joints.runs.turns_asked + joints.runs.turns_seen)[:, pair] == 0  # what leaps by a turn is far behind
    if not n_moments or not known.any():
        return play
    asked, seen = asked[known] / joints.ranges[pair], seen[known] / joints.ranges[pair]
    terms = np.stack([np.ones(asked.shape[:2]), asked[:, :, 1], np.sign(seen[:, :, 1])], axis=2)
    products = np.swapaxes(terms, 1, 2) @ terms + _SURELY_SOLVED * np.eye(3)
    behind = np.swapaxes(terms, 1, 2) @ (asked[:, :, :1] - seen[:, :, :1])
    play[known] = joints.ranges[pair] * np.linalg.solve(products, behind)[:, 2, 0]
    return play
