"""Is the reading right? Checks that need no label: what solid bodies, an action and time can do and cannot.

Each data file is folded into sums (`Sums`); what they say is judged at the end.
"""

from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from msgspec.structs import replace

from z2r.arrays import Bools, Columns, Floats, Ints, reduce_parts
from z2r.audits.findings import Finding, error, warning
from z2r.format.episodes import EpisodeIndex, parts_within
from z2r.format.schema import Schema
from z2r.pusht import motion
from z2r.pusht.motion import STILL
from z2r.pusht.overlap import LIMIT, overlap
from z2r.pusht.task import ACTION_LIMIT, PUSHER_RADIUS, WALL
from z2r.pusht.verdict import Recording
from z2r.reading.angles import wrap_angle
from z2r.reading.decode import Decoded, decode
from z2r.reading.reading import Reading
from z2r.reading.success import frame_errors, in_tolerance

# m in one frame, beyond what the action asks for: at most 0.005 inside the episodes of the shipped data, and at least
# 0.15 between them. Where the action does not say what moves, it takes a long leap.
_LEAP, _LONG_LEAP = 0.015, 0.08
_SMOOTH = 0.02  # m: as close as the action predicts the next frame where nothing was cut
_STUCK = 5  # frames in a row
_RARE = 0.05  # of the steps
_OFTEN = 0.01  # of the frames
_FLUNG = 0.025  # m in one frame: a block that is hit may go this much further than the pusher
_FEW = 3  # episodes


class Worst(NamedTuple):
    """How often something happened, how bad it was at worst, and in which frame of the dataset."""

    times: int = 0
    value: float = 0.0
    frame: int = 0


class Sums(NamedTuple):
    """What is kept of one data file."""

    n_frames: int
    overlap: Worst
    beyond_limit: Worst
    leaps: Worst
    long_leaps: Worst
    seams: Worst
    half_turns: Worst
    motion: Floats  # of each of these episodes, as `motion.sum_up` gives it
    stuck: Worst
    episode: Ints  # numbers of the episodes that this file holds a part of
    in_tolerance: Bools  # in one of its frames
    first: Floats  # offset from the target in its first frame here: x [m], y [m], turn [rad]
    last: Floats


def fold(frames: Columns, base: int, episodes: EpisodeIndex, reading: Reading, schema: Schema) -> Sums:
    """Sum up one data file, whose first row is frame `base` of the dataset."""
    n = len(frames[reading.feature])
    here, starts, stops = parts_within(episodes, base, base + n)
    inside = _pairs_inside(starts, stops, n)
    begins = np.isin(np.arange(1, n), starts)
    decoded = decode(frames, reading, schema)
    tee, pusher, action = decoded.pose("tee"), decoded.pose("pusher"), decoded.action
    assert action is not None and reading.action is not None
    steps = np.stack([np.diff(pusher.x), np.diff(pusher.y)], axis=1)
    offset = _offset(decoded)
    errors = frame_errors(decoded)
    leaps, smooth = _leaps(steps, action, np.hypot(np.diff(tee.x), np.diff(tee.y)), 1 / schema.fps)
    long = leaps > _LONG_LEAP
    together = inside & ~long if long.sum() < _RARE * len(long) else inside  # a leap is no motion, unless all motion is
    free = _away_from_walls(decoded)
    depth = overlap(decoded)
    fine = in_tolerance(errors, reading)
    return Sums(
        n_frames=n,
        overlap=_worst(depth, depth > LIMIT, base),
        beyond_limit=_worst(np.abs(action).max(axis=1), np.abs(action).max(axis=1) > ACTION_LIMIT * (1 + 1e-6), base),
        leaps=_worst(leaps, (leaps > _LEAP) & inside, base + 1),
        long_leaps=_worst(leaps, (leaps > _LONG_LEAP) & inside, base + 1),
        seams=_worst(smooth, (smooth < _SMOOTH) & begins & ~inside, base + 1),
        half_turns=_worst(errors["ang_err"], errors["ang_err"] > np.pi + 1e-6, base),
        motion=motion.sum_up(
            steps * schema.fps, action, together & free, starts, reading.action.lag if reading.action else 0
        ),
        stuck=_stuck(steps, action, inside & free, base + 1),
        episode=episodes.numbers[here],
        in_tolerance=reduce_parts(np.logical_or, fine, starts, stops),
        first=offset[starts],
        last=offset[stops - 1],
    )


def judge(sums: Sequence[Sums], files: Sequence[Path], reading: Reading) -> Iterator[Finding]:
    """Say what the sums of all data files say; `files` are theirs, in the same order."""
    yield from _judge_overlap(sums, files)
    yield from _judge_limit(sums, files)
    moves_oddly = list(motion.judge(_all_parts(sums), np.concatenate([each.motion for each in sums])))
    yield from moves_oddly
    yield from _judge_leaps([each.long_leaps if moves_oddly else each.leaps for each in sums], files)
    yield from _judge_seams([each.seams for each in sums], files)
    yield from _judge_stuck(sums, files)
    yield from _judge_half_turns(sums, files)
    yield from _judge_ends(sums, reading)


def check_verdict(reached: Bools, episodes: EpisodeIndex, verdict: Recording, name: str) -> Iterator[Finding]:
    """Does the reading agree with the simulator? Success implies that the last stored frame is in tolerance.

    Parameters
    ----------
    reached : ndarray, bool[n_episodes]
        As the reading has it.
    episodes : EpisodeIndex
        Where episodes end.
    verdict : Recording
        What the simulator said.
    name : str
        Of the file with the verdict.
    """
    told = [each.n_frames for each in verdict.episodes]
    if told != episodes.lengths.tolist():
        found = f"{len(told)} episodes with {sum(told)} frames"
        yield warning(
            "verdict", name, "episodes", found, f"{len(episodes)} with {episodes.n_frames}, as the index says"
        )
        return
    success = np.array([each.success for each in verdict.episodes])
    lost = success & ~reached
    if lost.any():
        place = f"success of episode {int(lost.argmax())}"
        found = f"true, while it is read as not reached ({lost.sum()} of {success.sum()} successes are)"
        yield error(
            "verdict", name, place, found, "every success read as reached", "The reading or its tolerances are wrong"
        )


def reached(sums: Sequence[Sums], reading: Reading) -> Bools:
    """Tell which episodes are in tolerance in their decisive frame, in the order of their numbers."""
    x, y, turn = _decisive(sums, reading).T
    return in_tolerance({"pos_err": np.hypot(x, y), "ang_err": np.abs(turn)}, reading)


def _judge_overlap(sums: Sequence[Sums], files: Sequence[Path]) -> Iterator[Finding]:
    worst, file = _overall([each.overlap for each in sums], files)
    # A hard push sinks in for a moment: it takes many frames, or a depth that no push reaches.
    if worst.value > 2 * LIMIT or worst.times > _OFTEN * sum(each.n_frames for each in sums):
        yield error(
            "overlap",
            file,
            f"frame {worst.frame}",
            f"the pusher {1000 * worst.value:.1f} mm inside the block ({worst.times:,} frames like it)",
            f"solid bodies apart, or at most {1000 * LIMIT:.0f} mm into each other",
            "A yaw is read wrong (sine and cosine swapped?), or two columns have each other's names",
        )


def _judge_limit(sums: Sequence[Sums], files: Sequence[Path]) -> Iterator[Finding]:
    worst, file = _overall([each.beyond_limit for each in sums], files)
    if worst.times:
        found = f"{worst.value:.3g} m/s ({worst.times:,} frames like it)"
        yield warning("action-range", file, f"action of frame {worst.frame}", found, f"at most {ACTION_LIMIT} m/s")


def _judge_leaps(worst: Sequence[Worst], files: Sequence[Path]) -> Iterator[Finding]:
    leaps, file = _overall(worst, files)
    if leaps.times:
        yield error(
            "leap",
            file,
            f"frame {leaps.frame}, inside an episode",
            f"pusher or block {1000 * leaps.value:.0f} mm further on than the action asks ({leaps.times:,} like it)",
            "a leap only where an episode ends",
            "The index lacks a boundary here, or frames are missing or in the wrong order",
        )


def _judge_seams(worst: Sequence[Worst], files: Sequence[Path]) -> Iterator[Finding]:
    seams, file = _overall(worst, files)
    if seams.times:
        yield warning(
            "leap",
            file,
            f"frame {seams.frame}, where an episode begins",
            f"motion that runs straight on ({seams.times:,} like it)",
            "a new start",
            "The motion has no boundary here: is the index off by a frame, or one episode cut in two?",
        )


def _judge_stuck(sums: Sequence[Sums], files: Sequence[Path]) -> Iterator[Finding]:
    worst, file = _overall([each.stuck for each in sums], files)
    if worst.times:
        found = f"the pusher at the very same place for {worst.value + 1:.0f} frames"
        expected = "motion, for the action asks for it"
        yield warning(
            "frozen", file, f"up to frame {worst.frame}", found, expected, "The sensor, or the recording, hung"
        )


def _judge_half_turns(sums: Sequence[Sums], files: Sequence[Path]) -> Iterator[Finding]:
    worst, file = _overall([each.half_turns for each in sums], files)
    if worst.times:
        found = f"{worst.value:.2f} rad ({worst.times:,} frames like it)"
        mend = "Wrap the difference of two angles into one turn"
        yield error("yaw-error", file, f"error in yaw of frame {worst.frame}", found, "at most 3.14 rad", mend)


def _judge_ends(sums: Sequence[Sums], reading: Reading) -> Iterator[Finding]:
    in_tolerance_once = np.concatenate([each.in_tolerance for each in sums])
    ever = len(np.unique(_all_parts(sums)[in_tolerance_once]))
    fine = int(reached(sums, reading).sum())
    if ever >= _FEW and fine < ever / 2:
        found = f"{fine} in tolerance in their {reading.decisive} frame"
        expected = f"most of the {ever} that are in tolerance at some time"
        mend = f"Is it the {reading.decisive} frame that tells? Do ranges end where episodes end?"
        yield warning("decisive-frame", "data", "episodes", found, expected, mend)
    x, y, turn = _decisive(sums, reading).T
    if reading.decisive == "first" or len(turn) < _FEW:
        return
    first_x, first_y, first_turn = _decisive(sums, replace(reading, decisive="first")).T
    turned, turn_spread = _circular(turn)
    # Where ends are no closer together than starts, nobody brought the block anywhere.
    if abs(turned) > max(_within(reading, "ang_err"), 2 * turn_spread) and turn_spread < _circular(first_turn)[1] / 2:
        found = f"all turned by about {turned:.2f} rad from the target"
        mend = "The yaw of the block or of the target is read wrong (sine and cosine swapped?)"
        yield warning("final-offset", "data", "last frames", found, "ends around the target", mend)
    middle, spread = _middle(x, y)
    if np.hypot(*middle) > max(_within(reading, "pos_err"), 2 * spread) and spread < _middle(first_x, first_y)[1] / 2:
        found = f"all about {1000 * middle[0]:.0f} and {1000 * middle[1]:.0f} mm away from the target"
        mend = "The position of the block or of the target is read wrong"
        yield warning("final-offset", "data", "last frames", found, "ends around the target", mend)


def _within(reading: Reading, name: str) -> float:
    return next(goal.within for goal in reading.goal if goal.name == name and goal.within is not None)


def _circular(angles: Floats) -> tuple[float, float]:
    """Mean and standard deviation of directions [rad]."""
    mean = np.exp(1j * angles).mean()
    return float(np.angle(mean)), float(np.sqrt(-2 * np.log(min(abs(mean), 1))))


def _middle(x: Floats, y: Floats) -> tuple[Floats, float]:
    """Middle of points, and the median of their distances from it [m]."""
    middle = np.median(np.stack([x, y]), axis=1)
    return middle, float(np.median(np.hypot(x - middle[0], y - middle[1])))


def _away_from_walls(decoded: Decoded) -> Bools:
    """Tell of each frame and the next whether both are away from any wall, bool[n - 1]; all, if no frame is."""
    reach = np.max(np.abs(decoded.pose("pusher")[:2]), axis=0)
    free = reach < WALL - 2 * PUSHER_RADIUS
    if not free.any():
        return np.ones(len(reach) - 1, dtype=bool)
    pairs: Bools = free[1:] & free[:-1]
    return pairs


def _pairs_inside(starts: Ints, stops: Ints, n: int) -> Bools:
    """Tell of each frame and the next whether one episode holds both, bool[n - 1]."""
    change = np.zeros(n + 1, dtype=np.int64)
    np.add.at(change, starts, 1)
    np.add.at(change, np.maximum(stops - 1, starts), -1)
    inside: Bools = np.cumsum(change)[: n - 1] > 0
    return inside


def _offset(decoded: Decoded) -> Floats:
    """How far the block is from the target: x [m], y [m], turn [rad], float64[n, 3]."""
    tee, target = decoded.pose("tee"), decoded.pose("target")
    turn = decoded.yaw("tee") - decoded.yaw("target")
    wraps = all(goal.wraps for goal in decoded.reading.goal)
    return np.stack([tee.x - target.x, tee.y - target.y, wrap_angle(turn) if wraps else turn], axis=1)


def _leaps(steps: Floats, action: Floats, block_steps: Floats, seconds: float) -> tuple[Floats, Floats]:
    """How far pusher or block go beyond what the action asks, and how far they are from where it would bring them."""
    asked = action[:-1] * seconds
    reach = np.hypot(*asked.T)
    reach[1:] = np.maximum(reach[1:], reach[:-1])  # what moves does not stop at once
    beyond = np.maximum(np.hypot(*steps.T), block_steps - _FLUNG) - reach
    return beyond, np.maximum(np.hypot(*(steps - asked).T), block_steps)


def _stuck(steps: Floats, action: Floats, inside: Bools, first_frame: int) -> Worst:
    """Find where the pusher does not move at all, frame after frame, although it is asked to."""
    still = inside & (steps == 0).all(axis=1) & (np.hypot(*action[:-1].T) > STILL)
    rows = np.arange(1, len(still) + 1)
    in_a_row = rows - np.maximum.accumulate(np.where(still, 0, rows))
    return _worst(in_a_row.astype(np.float64), in_a_row >= _STUCK, first_frame)


def _worst(values: Floats, wrong: Bools, first_frame: int) -> Worst:
    if not wrong.any():
        return Worst()
    row = int(np.where(wrong, values, -np.inf).argmax())
    return Worst(int(wrong.sum()), float(values[row]), first_frame + row)


def _overall(worst: Sequence[Worst], files: Sequence[Path]) -> tuple[Worst, Path]:
    place = max(range(len(worst)), key=lambda i: (worst[i].times > 0, worst[i].value))
    return worst[place]._replace(times=sum(each.times for each in worst)), files[place]


def _all_parts(sums: Sequence[Sums]) -> Ints:
    return np.concatenate([each.episode for each in sums])


def _decisive(sums: Sequence[Sums], reading: Reading) -> Floats:
    """Offset from the target in the decisive frame of each episode; of one in several files, the part that holds it."""
    parts = _all_parts(sums)
    if reading.decisive == "first":
        return np.concatenate([each.first for each in sums])[np.unique(parts, return_index=True)[1]]
    backwards = np.unique(parts[::-1], return_index=True)[1]
    return np.concatenate([each.last for each in sums])[::-1][backwards]
