"""Does a column beside state and action go in two ways, in some episodes in one and in the others in the other?

An acceleration with gravity and without it, a reward from -1 and from 0, numbers of phases from 0 and from 1: where
episodes of two recordings are put together, each is right by itself. So the two are held against each other.
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from z2r.arrays import Bools, Floats
from z2r.audits.motion import parted, share_a_task
from z2r.audits.runs import Runs
from z2r.check import Answer, Check
from z2r.errors import Fault, some
from z2r.format.episodes import DATA_DIR
from z2r.format.schema import ACTION, STATE, column_label
from z2r.reading.stored import episodes_named

_MIN_EPISODES, _MIN_OF_A_KIND = 6, 2
_APART = 3  # times as far as the episodes of one kind are from each other
_SHARE = {"mean": 0.2, "lowest value": 1.0, "highest value": 1.0}  # of what the column goes through in an episode


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
    for name, stats in runs.stats.items() if len(runs.number) >= _MIN_EPISODES else ():
        feature = runs.claims.schema.features[name]
        if name in (STATE, ACTION) or feature.dtype == "bool":
            continue
        sums = {"mean": stats.mean, "lowest value": stats.low, "highest value": stats.high}
        for column in range(feature.size):
            of_column = {what: values[:, column] for what, values in sums.items()}
            kinds = _two_kinds(of_column, (stats.high - stats.low)[:, column], may_rest=name.startswith("observation"))
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


def _two_kinds(sums: dict[str, Floats], spans: Floats, *, may_rest: bool) -> _Kinds | None:
    """Part the runs in two by what tells most, each (n_runs,), if that is clear.

    A label that rests is a label; a sensor that rests in some episodes was lost there.
    """
    best = None
    for what, values in sums.items():
        rarer, gap, spread = parted(values)
        few = np.isin(np.arange(len(values)), rarer)
        moves = (max if may_rest else min)(np.median(spans[few]), np.median(spans[~few])) > 0
        far = gap / max(float(np.median(spans)), 1e-300)
        if len(rarer) >= _MIN_OF_A_KIND and moves and gap >= _APART * spread and far > _SHARE[what]:
            clearly = far / _SHARE[what]
            if best is None or clearly > best.clearly:
                best = _Kinds(few, what, float(np.median(values[few])), float(np.median(values[~few])), clearly)
    return best
