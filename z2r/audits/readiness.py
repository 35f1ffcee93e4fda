"""Is the dataset ready to train on? What a policy of LeRobot wants of it, and what it would learn that nobody meant.

Nothing here is broken: much of it is meant to be so, and is said as a note.
"""

from collections.abc import Iterator, Mapping, Sequence
from types import MappingProxyType

import numpy as np

from z2r.arrays import Array, Floats, Ints
from z2r.audits import edit
from z2r.audits.claims import Claims
from z2r.audits.frames import FileFrames, RunStats
from z2r.audits.runs import Runs
from z2r.check import Answer, Check
from z2r.errors import Fault, count, some
from z2r.format.episodes import DATA_DIR
from z2r.format.rules import episodes_of
from z2r.format.schema import ACTION, BOOKKEEPING, INFO_PATH, STATE, is_for_a_policy
from z2r.reading.stored import episodes_named

CHUNKS: Mapping[str, int] = MappingProxyType({"ACT": 100, "Diffusion": 64, "SmolVLA and π0": 50})
"""How many frames policies plan for, unless told otherwise (lerobot 0.6.1, `lerobot/policies/*/configuration_*.py`)."""

_FEW = 20  # frames: in fewer, a value may well be the same by chance
_STILL = 0.05  # of the standard deviation: what jitter there is stays within
_IDLE_SECONDS, _IDLE_SHARE = 2.0, 0.2  # a standstill that is both longer than that, and more of the episode
_SHORT = 0.1  # of the median length
_AT_ONCE = 8  # frames of each run, in which most begin to move


@Check("policy-features", "there is an `action`, and something that is observed", "warning").of(Claims)
def policy_features(claims: Claims) -> Iterator[Answer]:
    """Policies of LeRobot learn `action` from what is called `observation.*`, and see nothing else."""
    names = [name for name in claims.schema.features if name not in BOOKKEEPING]
    mend = "LeRobot 0.6.1 has no operation that renames a feature: record or convert it again, under that name"
    if ACTION not in names:
        found = some([name for name in names if ACTION in name] or names)
        yield Fault(INFO_PATH, "features", found, "an action, which is what a policy learns", mend)
    if not any(is_for_a_policy(name) and name != ACTION for name in names):
        expected = "something that is observed, as observation.state or observation.images.NAME"
        yield Fault(INFO_PATH, "features", some(names), expected, mend)


@Check("constant", "what a policy sees and does changes, unless it is meant to stay", "note").of(Runs)
def constant(runs: Runs) -> Iterator[Answer]:
    """Is a dimension the same in all frames? A fixed target is; so is a joint that was never used."""
    for name, stats in runs.stats.items():
        n_frames = int(stats.n.sum())
        still = np.flatnonzero(stats.low.min(axis=0) == stats.high.max(axis=0)).tolist()
        if not still or n_frames < _FEW or not is_for_a_policy(name):
            continue
        feature = runs.claims.schema.features[name]
        mend = "Harmless while it stays so: a policy sees any other value up to 1e8 times too large, for the std is 0"
        if name == ACTION:
            mend = "A policy will always do the same there"
        elif len(still) == feature.size and name != STATE:
            mend += f". To leave it out: {edit.remove_feature(runs.claims.root, name)}"
        which = some([feature.labels[place] for place in still]) if feature.size > 1 else f"{stats.low[0, 0]:g}"
        found = f"{which}: the same in all {n_frames:,} frames"
        yield Fault(DATA_DIR, name, found, "values that change, unless they are meant to stay", mend)


@Check("idle", "no episode begins or ends with a long standstill", "note").of(Runs)
def idle(runs: Runs) -> Iterator[Answer]:
    """Does nothing move for long, in the beginning or the end of an episode?"""
    if runs.idle is None:
        return
    length, fps = runs.stop - runs.start, runs.claims.schema.fps
    long = (runs.idle > _IDLE_SECONDS * fps) & (runs.idle > _IDLE_SHARE * length[:, None])  # (n_runs, 2)
    long[:, 1] &= runs.idle[:, 0] < length  # what never moves begins with it
    said = []
    for side, doing in enumerate(("beginning", "ending")):
        if long[:, side].any():
            run = int(np.where(long[:, side], runs.idle[:, side], -1).argmax())
            worst = f"{runs.idle[run, side] / fps:.1f} of {length[run] / fps:.1f} s in episode {runs.number[run]}"
            said.append(f"{count(int(long[:, side].sum()), 'episode')} {doing} with a standstill, at worst {worst}")
    if said:
        mend = "A policy learns to wait there. LeRobot 0.6.1 has no operation that cuts frames out of an episode"
        named = episodes_of(runs.number, long[:, 0] | long[:, 1])
        yield Fault(DATA_DIR, "episodes", "; ".join(said), "episodes in which something moves", mend, named)


@Check("short-episode", "no episode is cut off as it began", "note").of(Claims)
def short_episode(claims: Claims) -> Iterator[Answer]:
    """Is an episode much shorter than the others, or a single frame?"""
    length = claims.table.length
    usual = float(np.median(length))
    short = (length > 0) & ((length < _SHORT * usual) | (length == 1))
    if short.any() and not short.all():
        named = episodes_of(claims.table.number, short)
        shortest = int(length[short].min())
        found = f"{count(len(named), 'episode')} of {len(length):,}, the shortest of {count(shortest, 'frame')}"
        mend = f"Were they stopped by accident? To leave them out: {edit.delete_episodes(claims.root, named)}"
        expected = f"about {usual:g} frames, as the others have"
        yield Fault(DATA_DIR, episodes_named(named), found, expected, mend, named)


@Check("chunk", "every episode is as long as what a policy plans ahead", "note").of(Claims)
def chunk(claims: Claims) -> Iterator[Answer]:
    """Do the chunks that policies plan fit into the episodes?"""
    length, most = claims.table.length, max(CHUNKS.values())
    longest, episodes = int(length.max()), count(len(length), "episode")
    said = [
        f"{n:,} shorter than {frames} frames, a chunk of {policy}"
        for policy, frames in CHUNKS.items()
        if (n := int((length < frames).sum()))
    ]
    if said:
        beyond = f", and nothing is learnt of what is planned beyond {longest} frames" if longest < most else ""
        mend = f"LeRobot fills a chunk up with the last action{beyond}. A policy can plan for less: --policy.chunk_size"
        named = episodes_of(claims.table.number, length < most)
        yield Fault(DATA_DIR, episodes, "; ".join(said), "episodes into which a chunk fits", mend, named)


def fold_idle(
    frames: FileFrames, stats: Mapping[str, RunStats], reach: Sequence[Floats] = ()
) -> tuple[Ints | None, Sequence[Floats]]:
    """Count the frames of each run in which nothing moves, int64[n_runs, 2]: in the beginning, and in the end.

    `reach` is how far off a column must be to move, as the block before left it; the first runs of the file tell it,
    and it is returned for the next block. None where there is neither a state nor an action, or one of them cannot be
    read.
    """
    names = [name for name in (STATE, ACTION) if name in frames.schema.signals()]
    if not names or any(name not in stats for name in names):
        return None, ()
    reach = reach or [_STILL * stats[name].first(frames.head).together().std[0] for name in names]
    return standstill([frames.signals[name] for name in names], reach, frames.run_starts), reach


def standstill(features: Sequence[Array], reach: Sequence[Floats], starts: Ints) -> Ints:
    """Count the frames in which no column is away from where its run begins, and ends, int64[n_runs, 2].

    Parameters
    ----------
    features : sequence of ndarray, (n_rows, size)
        Of the same rows.
    reach : sequence of ndarray, float64[size]
        For each of them, how far off each of its columns must be to be away.
    starts : ndarray, int64[n_runs]
        The first row of each run.
    """
    length = np.diff(starts, append=len(features[0]))
    ways = ((starts, 1), (starts + length - 1, -1))
    return np.stack([_rest(features, reach, first, step, length) for first, step in ways], axis=1)


def _rest(features: Sequence[Array], reach: Sequence[Floats], first: Ints, step: int, length: Ints) -> Ints:
    """Count the frames from `first` on, by `step`, in which no column is away from where it is there: int64[n_runs]."""
    rest, left, seen = length.copy(), np.arange(len(first)), 0
    while len(left):  # as most runs do not rest long, look at a few frames of each, then at twice as many of the others
        ahead = np.minimum(np.arange(seen, 2 * seen + _AT_ONCE), length[left, None] - 1)
        rows = first[left, None] + step * ahead  # (n_left, n_ahead)
        away = np.zeros(rows.shape, dtype=bool)
        for values, reaches in zip(features, reach, strict=True):
            for column, far in zip(values.T, reaches, strict=True):
                away |= np.abs(column[rows].astype(np.float64) - column[first[left], None]) > far
        found = away.any(axis=1)
        rest[left[found]] = seen + away[found].argmax(axis=1)
        seen += ahead.shape[1]
        left = left[~found & (seen < length[left])]
    return rest
