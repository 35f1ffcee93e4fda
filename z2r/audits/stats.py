"""Are the stored statistics those of the data, and what do wrong ones do to training?

LeRobot 0.6.1 scales what a policy sees and does by `meta/stats.json` (`lerobot/processor/normalize_processor.py`): ACT,
SmolVLA and π0 by mean and std, (x - mean) / (std + 1e-8); Diffusion and VQ-BeT by min and max, from -1 to 1. The
statistics of each episode, beside its metadata, are for whoever edits a dataset.
"""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from z2r.arrays import Bools, Columns, Floats, Ints
from z2r.audits import edit
from z2r.audits.claims import Claims
from z2r.audits.frames import RunStats
from z2r.audits.runs import Runs
from z2r.check import Answer, Check, Severity
from z2r.errors import Fault
from z2r.format.about import cameras_of
from z2r.format.rules import and_more, episodes_of
from z2r.format.schema import Feature, is_for_a_policy
from z2r.format.tables import STATISTICS, STATS_PATH, read_shard_statistics

STATS = Check(
    "stats", "the stored statistics are those of the data, so that a policy sees it in the right size", "warning"
)

_EPS = 1e-8  # what LeRobot adds to a std
# How far off what a policy sees is, of a std of 1, or of the range from -1 to 1: more than it should be; by a factor of
# 2; so far that nothing is learnt.
_FAR, _TWICE, _RUINED = 0.1, 1.0, 100.0

_WHITE = 1.01  # of a picture, with rounding
_ROUGH = 5e-6  # of a variance, as a share of the largest square
_FLOAT32_ROUNDING = 2.0**-24  # of a number, at most

_WITHOUT = {
    "count": "It counts where datasets are merged",
    "mean": "Who scales by mean and std, such as ACT, stops",
    "std": "Who scales by mean and std, such as ACT, stops",
    "min": "Who scales by min and max, such as Diffusion, stops",
    "max": "Who scales by min and max, such as Diffusion, stops",
}


type Statistics = dict[str, Floats]
"""Of one feature, by LeRobot's names, (..., size); ``count`` is (..., 1)."""


@STATS.of(Runs)
def stats_of_the_dataset(runs: Runs) -> Iterator[Answer]:
    """Are the statistics in meta/stats.json those of the data?"""
    stored = runs.claims.stored.stats.value
    if stored is None or len(runs.read) < len(runs.claims.paths):
        return
    recompute = f"Recompute them: {edit.recompute_stats(runs.claims.root)}"
    for name, stats in _flat(runs).items():
        feature, seen = runs.claims.schema.features[name], is_for_a_policy(name)
        for off, rounded, fault in _differences(name, feature, stored.get(name), _of_all(stats), float(stats.n.max())):
            effect = fault.mend if seen else "No policy scales by it"
            remedy = "LeRobot sums up in float32, which is too coarse so far from 0" if rounded else recompute
            yield _severity(off, seen), fault._replace(mend=f"{effect}. {remedy}")


@STATS.of(Runs)
def stats_of_cameras(runs: Runs) -> Iterator[Answer]:
    """Are the statistics of pictures from 0 to 1? LeRobot decodes them so, and scales them by these."""
    stored = runs.claims.stored.stats.value or {}
    for camera in cameras_of(runs.claims.schema):
        for kind in ("mean", "std", "max"):
            said = numbers(stored.get(camera.name, {}).get(kind))
            if said is not None and said.size and said.max() > _WHITE:
                found, expected = f"{said.max():.4g}", "at most 1, as LeRobot decodes pictures"
                mend = "From 0 to 255? Divide them by 255, or a policy sees one dark grey"
                yield Fault(STATS_PATH, f"{camera.name}.{kind}", found, expected, mend)
                break


@STATS.of(Runs)
def stats_of_each_episode(runs: Runs) -> Iterator[Answer]:
    """Are the statistics of each episode, which are stored with the metadata, those of its frames?"""
    run_of_episode = {number: run for run, number in enumerate(runs.number.tolist())}
    flat, features = _flat(runs), runs.claims.schema.features
    for shard in runs.claims.stored.episodes.value.shards:
        wanted = {name: features[name] for name in flat}
        (numbers, stored), faults = read_shard_statistics(runs.claims.root, shard, wanted)
        run = np.array([run_of_episode.get(number, -1) for number in numbers.tolist()], dtype=np.int64)
        for name, columns in stored.items():
            for fault in _episode_differences(shard, name, features[name], columns, flat[name], numbers, run):
                yield "note", fault
        yield from faults


class Summaries(NamedTuple):
    """What a dataset says of itself, and all that there is to go by for who reads no frame."""

    claims: Claims


@STATS.of(Summaries)
def stats_add_up(summaries: Summaries) -> Iterator[Answer]:
    """Are the statistics in meta/stats.json those that the statistics of all episodes add up to?"""
    claims = summaries.claims
    stored, shards = claims.stored.stats.value, claims.stored.episodes.value.shards
    features = {name: feature for name, feature in claims.schema.signals().items() if len(feature.shape) == 1}
    read = [read_shard_statistics(claims.root, shard, features).value.stored for shard in shards]
    for name, feature in features.items() if stored else ():
        parts = [shard.get(name, {}) for shard in read]
        if not all(kind in part for part in parts for kind in STATISTICS):
            continue
        episodes = {kind: np.concatenate([part[kind] for part in parts]).astype(np.float64) for kind in STATISTICS}
        if not all(np.isfinite(each).all() for each in episodes.values()) or episodes["count"].min() < 1:
            continue
        longest, seen = float(episodes["count"].max()), is_for_a_policy(name)
        for off, rounded, fault in _differences(name, feature, (stored or {}).get(name), _added_up(episodes), longest):
            if not rounded:
                expected = str(fault.expected).replace("recomputed", "which those of the episodes add up to")
                yield ("warning" if seen and off > _FAR else "note"), fault._replace(expected=expected)


def _added_up(episodes: Statistics) -> Statistics:
    """Return the statistics of all frames, by those of each episode."""
    n, mean = episodes["count"], np.average(episodes["mean"], 0, episodes["count"][:, 0])  # (n_episodes, 1), (size,)
    square = np.average(np.square(episodes["std"]) + np.square(episodes["mean"] - mean), 0, n[:, 0])
    low, high = episodes["min"].min(axis=0), episodes["max"].max(axis=0)
    return {"count": n.sum(axis=0), "min": low, "max": high, "mean": mean, "std": np.sqrt(square)}


def _severity(off: float, seen: bool) -> Severity:
    """Say how bad it is that what a policy sees is so far off; nothing is, where none sees it."""
    if not seen or off <= _FAR:
        return "note"
    return "error" if off >= _RUINED else "warning"


def _flat(runs: Runs) -> dict[str, RunStats]:
    """Of a matrix, LeRobot stores the statistics of the last axis only: leave it out.

    What is taken for something else is left out too. Its statistics are numbers of the same file, in the same unit and
    order, whatever that is: who is wrong about the one is wrong about the other, and the two cannot refute each other.
    """
    features, misread = runs.claims.schema.features, runs.claims.misread
    left_out = misread.features if misread else ()
    return {
        name: stats for name, stats in runs.stats.items() if len(features[name].shape) == 1 and name not in left_out
    }


def _of_each(stats: RunStats, runs: Ints) -> Statistics:
    columns = {"min": stats.low, "max": stats.high, "mean": stats.mean, "std": stats.std}
    return {"count": stats.n[runs, None], **{kind: values[runs] for kind, values in columns.items()}}


def _of_all(stats: RunStats) -> Statistics:
    return {kind: values[0] for kind, values in _of_each(stats.together(), np.array([0])).items()}


def _close(true: Statistics) -> Floats:
    """As close as numbers of this size come that were float32 once."""
    close: Floats = 1e-5 * np.maximum(np.abs(true["min"]), np.abs(true["max"])) + 1e-6
    return close


def _tolerance(true: Statistics, longest: Floats | float) -> Statistics:
    """Say how far off each statistic may be that LeRobot itself computes.

    LeRobot 0.6.1 sums the frames of one episode, `longest` at most, up in float32 (`lerobot/datasets/compute_stats.py`:
    `RunningQuantileStats`), and takes the variance as a difference of two such means. Each addition is rounded, and
    where a column stands still, always the same way.
    """
    size, std = np.maximum(np.abs(true["min"]), np.abs(true["max"])), true["std"]
    close, rounded = _close(true), longest * _FLOAT32_ROUNDING
    rough = np.maximum(_ROUGH * np.maximum(1, true["count"] / 5_000), rounded) * np.square(size)
    return {
        "count": np.zeros_like(true["count"]),
        "min": close,
        "max": close,
        "mean": close + rounded * size + 1e-3 * std,
        "std": close + 1e-3 * std + np.sqrt(np.square(std) + rough) - std,
    }


def _differences(
    name: str, feature: Feature, stored: Mapping[str, Any] | None, true: Statistics, longest: float
) -> Iterator[tuple[float, bool, Fault]]:
    """Yield the statistics that differ: how far off what a policy sees is, whether LeRobot rounds so, and what it sees.

    What LeRobot may have computed itself differs only where a policy sees something that moves in half the size, or
    less, or twice.
    """
    if not stored:
        fault = Fault(STATS_PATH, name, "no statistics", "some for each feature", "A policy sees it unscaled")
        yield _TWICE, False, fault
        return
    known = {kind: _numbers_or_what(stored.get(kind), right.size) for kind, right in true.items()}
    said = true | {kind: numbers for kind, numbers in known.items() if not isinstance(numbers, str)}
    tolerance, moves = _tolerance(true, longest), true["std"] > _close(true)
    for kind, right in true.items():
        place = f"{name}.{kind}"
        if isinstance(found := known[kind], str):
            off = 0 if kind == "count" else _TWICE
            yield off, False, Fault(STATS_PATH, place, found, f"{right.size} numbers", _WITHOUT[kind])
            continue
        far = _off(kind, said, true, moves)
        beyond = ~(np.abs(found - right) <= tolerance[kind])
        wrong: Bools = beyond | (far > _TWICE) & moves[: right.size]
        if wrong.any():
            column = int(np.where(wrong, far, -1).argmax())
            place += "" if kind == "count" else feature.at(column)
            number, expected = f"{found[column]:.6g}{and_more(wrong)}", f"{right[column]:.6g}, recomputed"
            effect = _effect(kind, column, said, true, far[column], moves)
            yield far[column], not beyond[column], Fault(STATS_PATH, place, number, expected, effect)


def numbers(stored: object) -> Floats | None:
    """Return the numbers that are stored, in one row; None where something else is."""
    try:
        return np.asarray(stored, dtype=np.float64).ravel()
    except (TypeError, ValueError, OverflowError):
        return None


def _numbers_or_what(stored: object, size: int) -> Floats | str:
    """Return so many numbers that are stored, or what is there in their place."""
    if stored is None:
        return "nothing"
    found = numbers(stored)
    if found is None:
        return "something else"
    return found if found.size == size else f"{found.size} numbers"


@np.errstate(all="ignore")  # what is stored may be any number
def _off(kind: str, said: Statistics, true: Statistics, moves: Bools) -> Floats:
    """How far off what a policy sees is, of a std of 1, or of the range from -1 to 1, float64[size]."""
    if kind == "count":
        return np.zeros(1)
    if kind == "std":
        ratio = (said["std"] + _EPS) / true["std"]
        return np.where(moves, np.where(ratio > 0, np.maximum(ratio, 1 / ratio) - 1, np.inf), 0)
    unit: Floats = np.maximum(np.abs(said["max"] - said["min"]), _EPS) / 2
    if kind == "mean":
        unit = np.where(moves, true["std"], np.abs(said["std"]) + _EPS)
    off: Floats = np.abs(said[kind] - true[kind]) / unit
    return off


@np.errstate(all="ignore")
def _effect(kind: str, column: int, said: Statistics, true: Statistics, off: float, moves: Bools) -> str:
    """Say what a policy sees."""
    if kind == "count":
        return _WITHOUT[kind]
    if kind == "mean":
        return f"A policy sees it shifted by {off:.3g} std" if moves[column] else f"A policy sees {off:.3g}, and not 0"
    if kind == "std":
        if not moves[column]:
            return "It does no harm: nothing moves there"
        ratio = (said["std"][column] + _EPS) / true["std"][column]
        size = f"{1 / ratio:.3g} times too large" if abs(ratio) < 1 else f"{ratio:.3g} times too small"
        return f"A policy sees it {size}"
    low, width = said["min"][column], max(said["max"][column] - said["min"][column], _EPS)
    ends = [2 * (true[end][column] - low) / width - 1 for end in ("min", "max")]
    return "Scaled by min and max, as for Diffusion, it goes from {:.3g} to {:.3g}, and not from -1 to 1".format(*ends)


def _episode_differences(
    shard: Path, name: str, feature: Feature, columns: Columns, stats: RunStats, numbers: Ints, run: Ints
) -> Iterator[Fault]:
    there = np.flatnonzero(run >= 0)
    true = _of_each(stats, run[there])
    tolerance = _tolerance(true, true["count"])
    mend = f"Training does not read them: {edit.PROGRAM} does, where it deletes episodes or splits"
    for kind, right in true.items():
        if kind not in columns:
            continue
        stored = columns[kind][there].astype(np.float64)
        wrong: Bools = ~(np.abs(stored - right) <= tolerance[kind])
        if wrong.any():
            places = np.argwhere(wrong)
            row, column = places[0].tolist()
            place = f"stats/{name}/{kind}{'' if kind == 'count' else feature.at(column)} in row {there[row]}"
            said = f"{stored[row, column]:.6g}{and_more(wrong)}"
            expected, named = f"{right[row, column]:.6g}, recomputed", episodes_of(numbers[there], places[:, 0])
            yield Fault(shard, place, said, expected, mend, named)
