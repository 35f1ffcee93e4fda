"""What is read wrong, and how? The rows of the table: what each policy learns from, and how it is played.

Needs neither torch nor the simulator.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from z2r.arrays import Bools
from z2r.format.dataset import Dataset, load
from z2r.pusht.beliefs import BELIEFS
from z2r.pusht.cloning import sets
from z2r.pusht.cloning.data import Scale, Vantage, read_examples, scale_of
from z2r.pusht.task import CONTROL_HZ
from z2r.pusht.world import PUSHT
from z2r.reading.breaks import BREAK_MODES, BreakMode
from z2r.reading.inspection import inspect_dataset

ONE_FRAME = 6  # inputs that one frame holds: the others come from the frame before


def _all(dataset: Dataset) -> Bools:
    return np.ones(len(dataset.episodes), dtype=bool)


def _reached(mode: str | None, dataset: Dataset) -> Bools:
    """Tell which episodes reached the goal, as somebody reads them who gets one thing wrong, or none."""
    outcome = inspect_dataset(dataset, BREAK_MODES[mode] if mode else None, PUSHT).outcome
    assert outcome is not None
    return outcome.reached


def _as_many_at_random(select: Callable[[Dataset], Bools], dataset: Dataset) -> Bools:
    drawn = np.random.default_rng(sets.KIND_SEED).permutation(len(dataset.episodes))
    chosen: Bools = drawn < select(dataset).sum()
    return chosen


def _as_many_shortest(select: Callable[[Dataset], Bools], dataset: Dataset) -> Bools:
    order = dataset.episodes.lengths.argsort(kind="stable")
    chosen: Bools = order.argsort() < select(dataset).sum()
    return chosen


def _numbered(numbers: Callable[[Path], Sequence[int]], dataset: Dataset) -> Bools:
    return np.isin(np.arange(len(dataset.episodes)), numbers(dataset.root))


KEPT = partial(_numbered, sets.kept_by_audit)
UNNAMED = partial(_numbered, sets.named_by_none)
REACHED = partial(_reached, None)


def _eightfold(scale: Scale, _: Path) -> Scale:
    """Take the first input, the pusher's place across the block, for eight times as widely spread as it is."""
    return replace(scale, inputs=scale.inputs * np.array([8.0, *np.ones(len(scale.inputs) - 1)]))


def _without_the_past(scale: Scale, _: Path) -> Scale:
    """Let all that one frame does not hold be 0, however large it is."""
    past = np.arange(len(scale.inputs)) >= ONE_FRAME
    return replace(scale, inputs=np.where(past, np.inf, scale.inputs))


def _of_another_set(_: Scale, folder: Path) -> Scale:
    return scale_of(read_examples(load(folder / "sets/failing"), PUSHT))


@dataclass(frozen=True)
class Play:
    """A way to play a policy: one row of the table.

    Attributes
    ----------
    row : str
        The name of the row.
    says : str
        What is wrong, in a few words.
    mode : BreakMode, optional
        How observations are read wrong.
    fps : int
        How many actions are played in a second.
    more : int
        From how many times as many starts.
    scale : callable, optional
        Takes the scale that the policy was trained with, and OUT; returns the one that it is played with.
    """

    row: str
    says: str
    mode: BreakMode | None = None
    fps: int = CONTROL_HZ
    more: int = 1
    scale: Callable[[Scale, Path], Scale] | None = None


@dataclass(frozen=True)
class Training:
    """A policy: what it learns from, and how it is played.

    Attributes
    ----------
    plays : tuple of Play
        At least one.
    source : str
        The set of demonstrations.
    mode : BreakMode, optional
        How they are read wrong.
    select : callable
        Which of their episodes are used.
    many : bool
        Whether it learns from many, rather than from few.
    vantage : str
        From where the scene is seen.
    scale : callable, optional
        Takes the scale of what it learns from, and OUT; returns the one to train with.
    """

    plays: tuple[Play, ...]
    source: str = "clean"
    mode: BreakMode | None = None
    select: Callable[[Dataset], Bools] = _all
    many: bool = False
    vantage: Vantage = "block"
    scale: Callable[[Scale, Path], Scale] | None = None


def _plain(row: str, says: str, mode: BreakMode | None = None, **options: Any) -> Training:
    """Return a training whose policy is played as it should be."""
    return Training((Play(row, says),), mode=mode, **options)


_YAW = BREAK_MODES["yaw-swap"]
_FILES = {name: BREAK_MODES[name] for name in ("drop-boundaries", "inclusive-end")}
_ACTIONS = {"early-1": BREAK_MODES["action-lag"], **BELIEFS}
_FAULTY = (*sets.FAULTS, "mixture")
_MANY = {name: {**_FILES, **_ACTIONS}[name] for name in ("drop-boundaries", "late-2", "late-5")}
_NONE = "without those that an error or a warning names"

TRAININGS: tuple[Training, ...] = (
    Training(
        (
            Play("right", "nothing is wrong"),
            Play("fps-30-at-rollout", "three times as many actions are played in a second", fps=3 * CONTROL_HZ),
            Play("yaw-swap-at-rollout", "right in training; then the yaw is atan2(cos, sin)", _YAW),
            Play("scale-of-another-set-at-rollout", "scaled as a noisier recording is", scale=_of_another_set),
            Play("scale-eightfold-at-rollout", "one input is divided by 8 times too much", scale=_eightfold),
        )
    ),
    _plain("scale-eightfold-throughout", "the same in training and at rollout", scale=_eightfold),
    Training(
        (
            Play("yaw-swap-in-training", "the yaw is atan2(cos, sin); then right at rollout"),
            Play("yaw-swap-throughout", "the yaw is atan2(cos, sin), at rollout too", _YAW),
        ),
        mode=_YAW,
    ),
    *(_plain(name, mode.assumption, mode) for name, mode in {**_FILES, **_ACTIONS}.items()),
    _plain("idle-tenth", "in a tenth of the episodes nobody moves", source="idle"),
    _plain("idle-tenth-unnamed", f"the same, {_NONE}", source="idle", select=UNNAMED),
    _plain("damaged-tenth", "a tenth of the episodes have the actions of another", source="tenth"),
    _plain("damaged-tenth-unnamed", f"the same, {_NONE}", source="tenth", select=UNNAMED),
    _plain("failed-kept", "noisier demonstrations, 3 in 10 of which fail", source="failing"),
    _plain("failed-dropped", "the same, those that reached the goal", source="failing", select=REACHED),
    _plain(
        "failed-dropped-by-degrees",
        "the same, those that reached it with a tolerance in degrees",
        source="failing",
        select=partial(_reached, "degrees-for-radians"),
    ),
    _plain(
        "failed-as-many-at-random",
        "the same, as many as reached the goal, at random",
        source="failing",
        select=partial(_as_many_at_random, REACHED),
    ),
    *(_plain(f"faulty-{name}", f"3 in 10 episodes are faulty: {name}", source=name) for name in _FAULTY),
    *(_plain(f"faulty-{name}-unnamed", f"the same, {_NONE}", source=name, select=UNNAMED) for name in _FAULTY),
    _plain("faulty-mixture-kept", "the same, what z2r audit --keep leaves", source="mixture", select=KEPT),
    _plain(
        "faulty-mixture-as-many-at-random",
        "the same, as many as are not named, at random",
        source="mixture",
        select=partial(_as_many_at_random, UNNAMED),
    ),
    _plain(
        "faulty-mixture-as-many-shortest",
        "the same, as many as are not named, the shortest",
        source="mixture",
        select=partial(_as_many_shortest, UNNAMED),
    ),
    _plain("one-frame", "one frame in, and no action before it", scale=_without_the_past),
    _plain("from-the-table", "seen from the table, not from the block", vantage="table"),
    Training(
        (
            Play("from-the-table-yaw-swap-in-training", "the same; the yaw is atan2(cos, sin), then right at rollout"),
            Play("from-the-table-yaw-swap-throughout", "the same; the yaw is atan2(cos, sin), at rollout too", _YAW),
        ),
        mode=_YAW,
        vantage="table",
    ),
    Training((Play("right-2000", "nothing is wrong", more=2),), many=True),
    *(_plain(f"{name}-2000", _MANY[name].assumption, _MANY[name], many=True) for name in _MANY),
    Training(
        (
            Play("yaw-swap-in-training-2000", "the yaw is atan2(cos, sin); then right at rollout"),
            Play("yaw-swap-throughout-2000", "the yaw is atan2(cos, sin), at rollout too", _YAW),
        ),
        mode=_YAW,
        many=True,
    ),
)

ROWS: dict[str, str] = {play.row: play.says for training in TRAININGS for play in training.plays}
"""What is wrong, by the name of the row, in the order of the table."""
