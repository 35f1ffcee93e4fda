"""Is the reading right? Checks that need no label: what solid bodies, an action and time can do and cannot.

Each block of a data file is folded into sums (`PushTSums`); what all of them say is asked at the end.
"""

from collections.abc import Callable, Iterator, Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np
from msgspec.structs import replace

from z2r.arrays import Bools, Floats, Ints, lengths, reduce_parts, stack_columns
from z2r.check import Answer, Check, Part
from z2r.errors import DatasetError, Fault
from z2r.format.episodes import DATA_DIR, EpisodeIndex, parts_within
from z2r.format.rules import episodes_of
from z2r.pusht.motion import STILL, motion_faults, motion_sums
from z2r.pusht.overlap import LIMIT, overlap
from z2r.pusht.task import ACTION_LIMIT, PUSHER_RADIUS, WALL
from z2r.reading.angles import wrap_angle
from z2r.reading.decode import Decoded
from z2r.reading.poses import Pose
from z2r.reading.reading import Reading
from z2r.reading.scene import FROZEN, SceneSums
from z2r.reading.success import frame_errors, in_tolerance
from z2r.reading.verdict import read_verdict, verdict_path

# m in one frame, beyond what the action asks for: at most 0.005 inside the episodes of the shipped data, and at least
# 0.15 between them. Where the action does not say what moves, it takes a long leap.
_LEAP, _LONG_LEAP = 0.015, 0.08
_SMOOTH = 0.02  # m: as close as the action predicts the next frame where nothing was cut
_STUCK = 5  # frames in a row
_RARE = 0.05  # of the steps
_OFTEN = 0.01  # of the frames
_FLUNG = 0.025  # m in one frame: a block that is hit may go this much further than the pusher
_MIN_EPISODES = 3  # from fewer nothing can be said about how they end


class Worst(NamedTuple):
    """How often something happened, how bad it was at worst, in which frame of the dataset, and in which episodes."""

    times: int = 0
    value: float = 0.0
    frame: int = 0
    episodes: tuple[int, ...] = ()


class PushTSums(NamedTuple):
    """What is kept of one block of a data file; the numbers of frames count over the whole dataset."""

    n_frames: int
    overlap: Worst
    beyond_limit: Worst
    leaps: Worst
    long_leaps: Worst
    seams: Worst
    half_turns: Worst
    motion: Floats  # of each of these episodes, as `motion_sums` gives it
    stuck: Worst
    episode: Ints  # numbers of the episodes that this block holds a part of
    in_tolerance: Bools  # in one of its frames
    first: Floats  # offset from the target in its first frame here: x [m], y [m], turn [rad]
    last: Floats


class _Rows(NamedTuple):
    """The rows of a block: which frame the first is, how many there are, and the parts of episodes in them."""

    base: int
    n: int
    starts: Ints
    number: Ints


def fold_block(
    decoded: Decoded, base: int, episodes: EpisodeIndex, fps: float, before: Decoded | None = None
) -> PushTSums | None:
    """Sum up the frames of one block, of which the first is frame `base`; None where they have no action.

    `before` are the last two frames of the block before: only the step from them to the first frame is asked for.
    """
    n, action, meaning = len(decoded), decoded.action, decoded.reading.action
    if action is None or meaning is None:
        return None
    here, starts, stops = parts_within(episodes, base, base + n)
    rows = _Rows(base, n, starts, episodes.numbers[here])
    inside = _pairs_inside(starts, stops, n)
    tee, pusher = decoded.pose("tee"), decoded.pose("pusher")
    steps = stack_columns([np.diff(pusher.x), np.diff(pusher.y)])  # (n - 1, 2)
    offset, errors, depth = _offset(decoded), frame_errors(decoded), overlap(decoded)
    leaps = _leaps(steps, action, lengths(np.diff(tee.x), np.diff(tee.y)), 1 / fps)
    long = leaps > _LONG_LEAP
    together = inside & ~long if long.sum() < _RARE * len(long) else inside  # a leap is no motion, unless all motion is
    free = _away_from_walls(pusher)
    begins = episodes.from_index[here].min(initial=base + n)
    leaped, within = leaps, inside
    if before is not None:
        leaped = np.append(_leap_over_the_cut(before, decoded, 1 / fps), leaps)
        within = np.append(begins < base, inside)
    fastest = np.maximum(*np.abs(action.T))
    turned = np.abs(offset[:, 2])
    return PushTSums(
        n_frames=n,
        overlap=_worst(depth, depth > LIMIT, rows),
        beyond_limit=_worst(fastest, fastest > ACTION_LIMIT * (1 + 1e-6), rows),
        leaps=_worst(leaped, (leaped > _LEAP) & within, rows),
        long_leaps=_worst(leaped, (leaped > _LONG_LEAP) & within, rows),
        seams=_seams(before if begins == base else None, decoded, inside, 1 / fps, rows),
        half_turns=_worst(turned, turned > np.pi + 1e-6, rows),
        motion=motion_sums(steps * fps, action, together & free, starts, meaning.lag),
        stuck=_stuck(steps, action, inside & free, rows),
        episode=episodes.numbers[here],
        in_tolerance=reduce_parts(np.logical_or, in_tolerance(errors, decoded.reading), starts, stops),
        first=offset[starts],
        last=offset[stops - 1],
    )


@Check("action-range", "no action is beyond what the robot can do", "warning").of(SceneSums)
def action_range(scene: SceneSums) -> Iterator[Answer]:
    """Is every action within the limits of the environment?"""
    worst, path = _worst_of(scene, lambda sums: sums.beyond_limit)
    if worst.times:
        found = f"{worst.value:.3g} m/s ({worst.times:,} frames like it)"
        yield Fault(
            path,
            f"action of frame {worst.frame}",
            found,
            f"at most {ACTION_LIMIT} m/s",
            "",
            worst.episodes,
            worst.frame,
        )


@Check("overlap", "solid bodies stay apart", "error").of(SceneSums)
def bodies_stay_apart(scene: SceneSums) -> Iterator[Answer]:
    """A hard push sinks in for a moment: it takes many frames, or a depth that no push reaches."""
    worst, path = _worst_of(scene, lambda sums: sums.overlap)
    if worst.value > 2 * LIMIT or worst.times > _OFTEN * sum(each.n_frames for each in scene.sums):
        yield Fault(
            path,
            f"frame {worst.frame}",
            f"the pusher {1000 * worst.value:.1f} mm inside the block ({worst.times:,} frames like it)",
            f"solid bodies apart, or at most {1000 * LIMIT:.0f} mm into each other",
            "A yaw is read wrong (sine and cosine swapped?), or two columns have each other's names",
            worst.episodes,
            worst.frame,
        )


@Check("action-motion", "the action moves the pusher the way it says, at once and at the right speed", "error").of(
    SceneSums
)
def action_motion(scene: SceneSums) -> Iterator[Answer]:
    """Does the pusher do what the action says?"""
    yield from _motion_faults(scene)


LEAP = Check("leap", "nothing leaps inside an episode, and something does where one ends", "error")


@LEAP.of(SceneSums)
def nothing_leaps_inside_an_episode(scene: SceneSums) -> Iterator[Answer]:
    """Where the action does not say what moves, only a long leap counts."""
    moves_oddly = any(True for _ in _motion_faults(scene))
    worst, path = _worst_of(scene, lambda sums: sums.long_leaps if moves_oddly else sums.leaps)
    if worst.times:
        yield Fault(
            path,
            f"frame {worst.frame}, inside an episode",
            f"pusher or block {1000 * worst.value:.0f} mm further on than the action asks ({worst.times:,} like it)",
            "a leap only where an episode ends",
            "The index lacks a boundary here, or frames are missing or in the wrong order",
            worst.episodes,
            worst.frame,
        )


@LEAP.of(SceneSums)
def something_leaps_where_an_episode_ends(scene: SceneSums) -> Iterator[Answer]:
    """Does a new episode begin anew?"""
    worst, path = _worst_of(scene, lambda sums: sums.seams)
    if worst.times:
        found = f"motion that runs straight on ({worst.times:,} like it)"
        mend = "The motion has no boundary here: is the index off by a frame, or one episode cut in two?"
        place = f"frame {worst.frame}, where an episode begins"
        yield "warning", Fault(path, place, found, "a new start", mend, worst.episodes, worst.frame)


@FROZEN.of(SceneSums)
def the_pusher_is_not_stuck(scene: SceneSums) -> Iterator[Answer]:
    """Does the pusher move where it is asked to?"""
    worst, path = _worst_of(scene, lambda sums: sums.stuck)
    if worst.times:
        found = f"the pusher at the very same place for {worst.value + 1:.0f} frames"
        expected = "motion, for the action asks for it"
        mend = "The sensor, or the recording, hung"
        yield Fault(path, f"up to frame {worst.frame}", found, expected, mend, worst.episodes, worst.frame)


@Check("yaw-error", "no error in yaw is more than half a turn", "error").of(SceneSums)
def yaw_error(scene: SceneSums) -> Iterator[Answer]:
    """Is the difference of two yaws wrapped?"""
    worst, path = _worst_of(scene, lambda sums: sums.half_turns)
    if worst.times:
        found = f"{worst.value:.2f} rad ({worst.times:,} frames like it)"
        mend = "Wrap the difference of two angles into one turn"
        yield Fault(
            path, f"error in yaw of frame {worst.frame}", found, "at most 3.14 rad", mend, worst.episodes, worst.frame
        )


@Check("final-offset", "episodes do not all miss the target in the same way", "warning").of(SceneSums)
def final_offset(scene: SceneSums) -> Iterator[Answer]:
    """Where ends are no closer together than starts, nobody brought the block anywhere."""
    reading, expected = scene.reading, "ends around the target"
    x, y, turn = _decisive(scene.sums, reading).T
    if reading.decisive == "first" or len(turn) < _MIN_EPISODES:
        return
    first_x, first_y, first_turn = _decisive(scene.sums, replace(reading, decisive="first")).T
    turned, turn_spread = _circular(turn)
    as_one = turn_spread < _circular(first_turn)[1] / 2
    if as_one and abs(turned) > max(_tolerance(reading, "ang_err"), 2 * turn_spread):
        found = f"all turned by about {turned:.2f} rad from the target"
        mend = "The yaw of the block or of the target is read wrong (sine and cosine swapped?)"
        yield Fault(DATA_DIR, "last frames", found, expected, mend)
    middle, spread = _middle(x, y)
    as_one = spread < _middle(first_x, first_y)[1] / 2
    if as_one and np.hypot(*middle) > max(_tolerance(reading, "pos_err"), 2 * spread):
        found = f"all about {1000 * middle[0]:.0f} and {1000 * middle[1]:.0f} mm away from the target"
        yield Fault(
            DATA_DIR, "last frames", found, expected, "The position of the block or of the target is read wrong"
        )


@Check("decisive-frame", "an episode that comes into tolerance mostly stays there", "warning").of(SceneSums)
def decisive_frame(scene: SceneSums) -> Iterator[Answer]:
    """Are most episodes that are ever in tolerance also there in the frame that decides?"""
    in_tolerance_once = np.concatenate([each.in_tolerance for each in scene.sums])
    ever = len(np.unique(_all_parts(scene.sums)[in_tolerance_once]))
    fine = int(reached(scene).sum())
    if ever >= _MIN_EPISODES and fine < ever / 2:
        which = scene.reading.decisive
        found = f"{fine} in tolerance in their {which} frame"
        mend = f"Is it the {which} frame that tells? Do ranges end where episodes end?"
        yield Fault(DATA_DIR, "episodes", found, f"most of the {ever} that are in tolerance at some time", mend)


@Check("verdict", "the reading agrees with the simulator's verdict, where there is one", "error").of(SceneSums)
def agrees_with_the_verdict(scene: SceneSums) -> Iterator[Answer]:
    """Does the reading agree with the simulator? Success implies that the last stored frame is in tolerance."""
    episodes, path = scene.episodes, Path(verdict_path(scene.root).name)
    try:
        verdict = read_verdict(scene.root)
    except DatasetError as error:
        yield "warning", error.fault._replace(path=path)
        return
    fine = reached(scene)
    if verdict is None or len(fine) != len(episodes):
        return
    lengths = [each.n_frames for each in verdict.episodes]
    if lengths != episodes.lengths.tolist():
        found = f"{len(lengths)} episodes with {sum(lengths)} frames"
        expected = f"{len(episodes)} with {episodes.n_frames}, as the index says"
        yield "warning", Fault(path, "episodes", found, expected)
        return
    success = np.array([each.success for each in verdict.episodes])
    lost = success & ~fine
    if lost.any():
        found = f"true, while it is read as not reached ({lost.sum()} of {success.sum()} successes are)"
        mend = "The reading or its tolerances are wrong"
        named = episodes_of(episodes.numbers, lost)
        yield Fault(path, f"success of episode {named[0]}", found, "every success read as reached", mend, named)


def ungraded(root: Path) -> Iterator[str]:
    """Say that nobody graded the recording, where it is so."""
    try:
        graded = read_verdict(root) is not None
    except DatasetError:
        return  # the check of the verdict says so
    if not graded:
        yield "whether the tolerances are those of the task: no verdict of the simulator is beside the dataset"


PARTS = tuple(value for value in globals().values() if isinstance(value, Part))
"""What PushT adds to an audit, in the order in which it stands above."""


def reached(scene: SceneSums) -> Bools:
    """Tell which episodes are in tolerance in their decisive frame, in the order of their numbers."""
    x, y, turn = _decisive(scene.sums, scene.reading).T
    return in_tolerance({"pos_err": np.hypot(x, y), "ang_err": np.abs(turn)}, scene.reading)


def _motion_faults(scene: SceneSums) -> Iterator[Answer]:
    return motion_faults(_all_parts(scene.sums), np.concatenate([each.motion for each in scene.sums]))


def _worst_of(scene: SceneSums, which: Callable[[PushTSums], Worst]) -> tuple[Worst, Path]:
    """Return the worst of all files, how often it is so in all of them together, and the file that holds it."""
    worst = [which(each) for each in scene.sums]
    place = max(range(len(worst)), key=lambda number: (worst[number].times > 0, worst[number].value))
    episodes = sorted({number for each in worst for number in each.episodes})
    times = sum(each.times for each in worst)
    return worst[place]._replace(times=times, episodes=tuple(episodes)), scene.paths[place]


def _tolerance(reading: Reading, name: str) -> float:
    """Return how large the number of a goal may be; 0 where it has no such limit."""
    return next((goal.within for goal in reading.goal if goal.name == name and goal.within is not None), 0.0)


def _circular(angles: Floats) -> tuple[float, float]:
    """Mean and standard deviation of directions [rad]."""
    mean = np.exp(1j * angles).mean()
    return float(np.angle(mean)), float(np.sqrt(-2 * np.log(min(abs(mean), 1))))


def _middle(x: Floats, y: Floats) -> tuple[Floats, float]:
    """Middle of points, and the median of their distances from it [m]."""
    middle = np.median(np.stack([x, y]), axis=1)
    return middle, float(np.median(np.hypot(x - middle[0], y - middle[1])))


def _away_from_walls(pusher: Pose) -> Bools:
    """Tell of each frame and the next whether both are away from any wall, bool[n - 1]; all, if no frame is."""
    reach = np.maximum(np.abs(pusher.x), np.abs(pusher.y))
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
    return stack_columns([tee.x - target.x, tee.y - target.y, wrap_angle(turn) if wraps else turn])


def _leaps(steps: Floats, action: Floats, block_steps: Floats, seconds: float) -> Floats:
    """How far pusher or block go beyond what the action asks."""
    reach = lengths(*action[:-1].T) * seconds
    reach[1:] = np.maximum(reach[1:], reach[:-1])  # what moves does not stop at once
    beyond: Floats = np.maximum(lengths(*steps.T), block_steps - _FLUNG) - reach
    return beyond


def _leap_over_the_cut(before: Decoded, decoded: Decoded, seconds: float) -> float:
    """How far pusher or block go beyond what the action asks from the last frame of a block to the next one."""
    first = decoded.take(slice(1))
    assert before.action is not None  # as `fold_block` has seen, of both
    assert first.action is not None
    pusher, tee = (
        np.diff([np.append(getattr(before.pose(name), axis), getattr(first.pose(name), axis)) for axis in "xy"])
        for name in ("pusher", "tee")
    )  # (2, n_steps)
    leaps = _leaps(pusher.T, np.concatenate([before.action, first.action]), lengths(*tee), seconds)
    return float(leaps[-1])


def _seams(before: Decoded | None, decoded: Decoded, inside: Bools, seconds: float, rows: _Rows) -> Worst:
    """Find where an episode begins, and the motion runs straight on."""
    smooth, begin = np.full(rows.n, np.inf), rows.starts[rows.starts > 0]
    begin = begin[~inside[begin - 1]]
    smooth[begin] = _off_course(_places(decoded, begin - 1), _places(decoded, begin), seconds)
    if before is not None:
        smooth[:1] = _off_course(_places(before, np.array([-1])), _places(decoded, np.array([0])), seconds)
    return _worst(smooth, smooth < _SMOOTH, rows)


def _places(decoded: Decoded, frames: Ints) -> Floats:
    """Return where pusher and block are in some frames, and what the action asks for: x and y of each, (6, n)."""
    assert decoded.action is not None  # as `fold_block` has seen
    pusher, tee = decoded.pose("pusher"), decoded.pose("tee")
    return np.stack([each[frames] for each in (pusher.x, pusher.y, tee.x, tee.y, *decoded.action.T)])


def _off_course(last: Floats, first: Floats, seconds: float) -> Floats:
    """How far pusher or block are from where the action of the frame before would bring them, by `_places`."""
    pusher, tee = first[:2] - last[:2] - last[4:] * seconds, first[2:4] - last[2:4]
    return np.maximum(lengths(*pusher), lengths(*tee))


def _stuck(steps: Floats, action: Floats, inside: Bools, rows: _Rows) -> Worst:
    """Find where the pusher does not move at all, frame after frame, although it is asked to."""
    x, y = steps.T
    still = inside & (x == 0) & (y == 0)
    if not still.any():  # as in most
        return Worst()
    still &= np.hypot(*action[:-1].T) > STILL
    step = np.arange(1, len(still) + 1)
    in_a_row = step - np.maximum.accumulate(np.where(still, 0, step))
    return _worst(in_a_row.astype(np.float64), in_a_row >= _STUCK, rows)


def _worst(values: Floats, wrong: Bools, rows: _Rows) -> Worst:
    """Sum up values of frames, or of steps, which are counted as the frame that they lead to."""
    if not wrong.any():
        return Worst()
    at_worst = int(np.where(wrong, values, -np.inf).argmax())
    first = rows.n - len(values)
    part = np.searchsorted(rows.starts, np.flatnonzero(wrong) + first, side="right") - 1
    episodes = tuple(np.unique(rows.number[part[part >= 0]]).tolist())
    return Worst(int(wrong.sum()), float(values[at_worst]), rows.base + first + at_worst, episodes)


def _all_parts(sums: Sequence[PushTSums]) -> Ints:
    return np.concatenate([each.episode for each in sums])


def _decisive(sums: Sequence[PushTSums], reading: Reading) -> Floats:
    """Offset from the target in the decisive frame of each episode; of one in several files, the part that holds it."""
    parts = _all_parts(sums)
    if reading.decisive == "first":
        return np.concatenate([each.first for each in sums])[np.unique(parts, return_index=True)[1]]
    backwards = np.unique(parts[::-1], return_index=True)[1]
    return np.concatenate([each.last for each in sums])[::-1][backwards]
