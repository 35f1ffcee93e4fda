"""Are the stored quantiles such as LeRobot stores them? π0.5 scales what it sees and does by q01 and q99.

LeRobot 0.6.1 estimates those of an episode from a histogram, and takes for those of the dataset the mean over its
episodes (`lerobot/datasets/compute_stats.py`: `aggregate_feature_stats`). Those of all frames are others. Which of the
two is stored, nobody can tell, and either will do.
"""

from collections.abc import Iterator

import numpy as np

from z2r.arrays import Columns, Floats
from z2r.audits import edit
from z2r.audits.claims import Claims
from z2r.audits.runs import Runs
from z2r.audits.stats import STATS, numbers
from z2r.check import Answer
from z2r.errors import Fault, some
from z2r.format.rules import and_more
from z2r.format.schema import Feature, is_for_a_policy
from z2r.format.tables import QUANTILES, STATS_PATH, read_shard_statistics

_SLACK = 0.15  # of the range from q01 to q99: by so much a histogram, and a mean over episodes, may be off
_NEEDED = ("q01", "q99")


@STATS.of(Claims)
def quantiles_are_there(claims: Claims) -> Iterator[Answer]:
    """Can a policy be trained that scales by quantiles? LeRobot 0.6.1 stops where meta/stats.json has none."""
    stored, signals = claims.stored.stats.value or {}, claims.schema.signals()
    bare = [
        name for name in signals if is_for_a_policy(name) and name in stored and not {*_NEEDED} <= stored[name].keys()
    ]
    if bare:
        mend = f"π0.5 cannot be trained without; others can. Add them: {edit.recompute_stats(claims.root)}"
        yield "note", Fault(STATS_PATH, some(bare), "no q01 and q99", "both, as LeRobot 0.6.1 stores them", mend)


@STATS.of(Runs)
def quantiles_of_the_dataset(runs: Runs) -> Iterator[Answer]:
    """Do the quantiles in meta/stats.json lie where those of the episodes do?"""
    stored, features = runs.claims.stored.stats.value or {}, runs.claims.schema.features
    wanted = {name: features[name] for name in runs.stats if is_for_a_policy(name) and len(features[name].shape) == 1}
    for name, of_episodes in _of_episodes(runs, wanted).items():
        width = _mean(of_episodes, "q99") - _mean(of_episodes, "q01")
        for kind in QUANTILES:
            said = numbers(stored.get(name, {}).get(kind))
            if said is None or said.shape != width.shape:
                continue
            low, high = _limits(of_episodes, kind, width)
            off = _off(said, low, high, width)
            if (off > 0).any():
                column = int(off.argmax())
                place = f"{name}.{kind}{features[name].at(column)}"
                expected = f"{low[column]:.4g} to {high[column]:.4g}, by those of the episodes"
                mend = f"π0.5 scales by them. Recompute them: {edit.recompute_stats(runs.claims.root)}"
                yield Fault(STATS_PATH, place, f"{said[column]:.6g}{and_more(off > 0)}", expected, mend)


@np.errstate(all="ignore")  # what is stored may be any number
def _limits(of_episodes: Columns, kind: str, width: Floats) -> tuple[Floats, Floats]:
    """Return between which numbers a quantile lies, (size,): amid the episodes' as that of all frames is."""
    each = of_episodes[kind].astype(np.float64)
    return each.min(axis=0) - _SLACK * width, each.max(axis=0) + _SLACK * width


@np.errstate(all="ignore")
def _off(said: Floats, low: Floats, high: Floats, width: Floats) -> Floats:
    """Say how far a quantile is beyond its limits, in widths, (size,); 0 where it is not, or nothing moves."""
    wrong = (width > 0) & ~((said >= low) & (said <= high))
    return np.where(wrong, np.nan_to_num(np.maximum(low - said, said - high) / width, nan=np.inf), 0.0)


@np.errstate(all="ignore")
def _mean(of_episodes: Columns, kind: str) -> Floats:
    count = of_episodes["count"].astype(np.float64)
    mean: Floats = (of_episodes[kind].astype(np.float64) * count).sum(axis=0) / count.sum()
    return mean


def _of_episodes(runs: Runs, wanted: dict[str, Feature]) -> dict[str, Columns]:
    """Return the quantiles of all episodes, and how many frames each has: those of features that have all of them."""
    kinds = ("count", *QUANTILES)
    root, shards = runs.claims.root, runs.claims.stored.episodes.value.shards
    parts = [read_shard_statistics(root, shard, wanted, kinds).value.stored for shard in shards]
    whole = [name for name in wanted if parts and all({*kinds} == part.get(name, {}).keys() for part in parts)]
    return {name: {kind: np.concatenate([part[name][kind] for part in parts]) for kind in kinds} for name in whole}
