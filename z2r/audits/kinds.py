"""Does a column go in two ways, in some episodes in one and in the others in the other?

An acceleration with gravity and without it, a reward from -1 and from 0, numbers of phases from 0 and from 1: where
episodes of two recordings are put together, each is right by itself. So the two are held against each other. Where one
of the two is a number that never changes, a sensor was lost.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from z2r.arrays import Bools, Floats
from z2r.audits.motion import parted, share_a_task
from z2r.audits.runs import Runs
from z2r.check import Answer, Check
from z2r.errors import Fault, count, some
from z2r.format.episodes import DATA_DIR
from z2r.format.schema import ACTION, STATE, column_label
from z2r.reading.scene import FROZEN
from z2r.reading.stored import episodes_named

MIN_EPISODES, _MIN_OF_A_KIND = 6, 2  # from fewer nothing is said
_APART = 3  # times as far as the episodes of one kind are from each other
_SHARE = {"mean": 0.2, "lowest value": 1.0, "highest value": 1.0}  # of what the column goes through in an episode
_LONG = 40  # frames: a sensor may well stand still for less
_ALL_THE_TIME = 0.75  # of the frames, in which a sensor moves wherever it is not lost
_FEW, _FEW_OF_THE_STATE = 0.3, 0.1  # of the episodes: of so many, `z2r.audits.values` asks more


class _Kinds(NamedTuple):
    """Which runs are of the rarer kind, bool[n_runs]; by what that is told, what it is in both, and how clearly."""

    few: Bools
    what: str
    here: float
    there: float
    clearly: float


@Check("two-kinds", "what is neither state nor action means the same in every episode", "note").of(Runs)
def columns_mean_the_same_everywhere(runs: Runs) -> Iterator[Answer]:
    """Is a column's mean, lowest or highest value in some episodes far from that of the others, and nothing between?"""
    together: dict[bytes, list[tuple[str, _Kinds]]] = {}
    for name, stats in runs.stats.items() if len(runs.number) >= MIN_EPISODES else ():
        feature = runs.claims.schema.features[name]
        if name in (STATE, ACTION) or feature.dtype == "bool":
            continue
        sums = {"mean": stats.mean, "lowest value": stats.low, "highest value": stats.high}
        for column in range(feature.size):
            of_column = {what: values[:, column] for what, values in sums.items()}
            kinds = _two_kinds(of_column, (stats.high - stats.low)[:, column])
            if kinds and share_a_task(runs, kinds.few):
                together.setdefault(kinds.few.tobytes(), []).append((column_label(name, feature, column), kinds))
    for alike in together.values():
        label, kinds = max(alike, key=lambda each: each[1].clearly)
        labels = [label, *(each for each, _ in alike if each != label)]
        number, others = (tuple(dict.fromkeys(runs.number[each].tolist())) for each in (kinds.few, ~kinds.few))
        place = f"{some(labels)} in {episodes_named(number)}"
        expected = f"about {kinds.there:.3g}, as in {episodes_named(others)}"
        mend = "They differ, and nothing lies between. Is it another unit, scale, offset, order or convention there? "
        mend += "Make both alike"
        found = f"a {kinds.what}{' of the first' if len(labels) > 1 else ''} of about {kinds.here:.3g}"
        whose = number if len(number) < len(others) else ()  # of as many, nobody knows which are the odd ones
        yield Fault(DATA_DIR, place, found, expected, mend, whose)


def _two_kinds(sums: dict[str, Floats], spans: Floats) -> _Kinds | None:
    """Part the runs in two by what tells most, each (n_runs,), if that is clear."""
    best = None
    for what, values in sums.items():
        rarer, gap, spread = parted(values)
        few = np.isin(np.arange(len(values)), rarer)
        moves = min(np.median(spans[few]), np.median(spans[~few])) > 0  # a label that rests is a label
        far = gap / max(float(np.median(spans)), 1e-300)
        if len(rarer) >= _MIN_OF_A_KIND and moves and gap >= _APART * spread and far > _SHARE[what]:
            clearly = far / _SHARE[what]
            if best is None or clearly > best.clearly:
                best = _Kinds(few, what, float(np.median(values[few])), float(np.median(values[~few])), clearly)
    return best


@FROZEN.of(Runs)
def no_sensor_is_lost_in_many_episodes(runs: Runs) -> Iterator[Answer]:
    """Does a sensor give one and the same number in many episodes, and move nearly all the time in all others?

    What is pushed or gripped rests at times in those, too.
    """
    long = (runs.n_frames >= _LONG)[:, None]
    for name, steps in runs.steps.items():
        stats, feature = runs.stats[name], runs.claims.schema.features[name]
        dead, share = long & (steps.moves == 0), steps.moves / runs.n_frames[:, None]  # (n_runs, size)
        n, rest = dead.sum(axis=0), (long & ~dead).sum(axis=0)
        number = np.where(dead, stats.low, np.nan)[dead.argmax(axis=0), range(feature.size)]
        told = (n > (_FEW_OF_THE_STATE if name == STATE else _FEW) * (n + rest)) & (n + rest >= MIN_EPISODES)
        told &= (n >= _MIN_OF_A_KIND) & (rest >= _MIN_OF_A_KIND) & (name != ACTION)
        told &= ((share >= _ALL_THE_TIME) | dead | ~long).all(axis=0) & ((stats.low == number) | ~dead).all(axis=0)
        for column in np.flatnonzero(told).tolist():
            wrong = dead[:, column] & ~_is_told_to_rest(runs, feature.labels[column])
            if wrong.sum() >= _MIN_OF_A_KIND and share_a_task(runs, wrong):
                named = tuple(dict.fromkeys(runs.number[wrong].tolist()))
                place = f"{column_label(name, feature, column)} in {episodes_named(named)}"
                found = f"{number[column]:.4g} in all frames"
                expected = f"a value that moves all the time, as in the other {count(int(rest[column]), 'episode')}"
                mend = "Was the sensor lost, or switched off? Train without it, or leave these episodes out"
                yield "note", Fault(DATA_DIR, place, found, expected, mend, named)


def _is_told_to_rest(runs: Runs, label: str) -> Bools:
    """Tell of each run whether the action has a column of this name that stands still there: bool[n_runs]."""
    labels = runs.claims.schema.features[ACTION].dim_names if ACTION in runs.steps else ()
    return (
        runs.steps[ACTION].moves[:, labels.index(label)] == 0 if label in labels else np.zeros(len(runs.number), bool)
    )
