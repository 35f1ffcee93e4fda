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
REACHED, REACHED_BY_DEGREES = partial(_reached, None), partial(_reached, "degrees-for-radians")


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
    against : str
        The row that it is held against.
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
    against: str = "right"
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
    mirror : bool
        Whether it learns from mirrored examples too.
    scale : callable, optional
        Takes the scale of what it learns from, and OUT; returns the one to train with.
    """

    plays: tuple[Play, ...]
    source: str = "clean"
    mode: BreakMode | None = None
    select: Callable[[Dataset], Bools] = _all
    many: bool = False
    vantage: Vantage = "block"
    mirror: bool = True
    scale: Callable[[Scale, Path], Scale] | None = None


def _one(row: str, says: str, mode: BreakMode | None = None, against: str = "right", **options: Any) -> Training:
    """Return a training whose policy is played as it should be."""
    return Training((Play(row, says, against),), mode=mode, **options)


def _yaw(before: str = "", after: str = "", against: str = "right", **options: Any) -> Training:
    """Swap the yaw in training, and play the policy both rightly and as it was trained."""
    alone, too = "the yaw is atan2(cos, sin); then right at rollout", "the yaw is atan2(cos, sin), at rollout too"
    plays = (
        Play(f"{before}yaw-swap-in-training{after}", alone, against),
        Play(f"{before}yaw-swap-throughout{after}", too, against, mode=_SWAP),
    )
    return Training(plays, mode=_SWAP, **options)


_SWAP = BREAK_MODES["yaw-swap"]
_MODES = {
    **{name: BREAK_MODES[name] for name in ("drop-boundaries", "inclusive-end")},
    "early-1": BREAK_MODES["action-lag"],
    **BELIEFS,
}
_TELLING = ("drop-boundaries", "late-2", "late-5")
_FAULTY = {
    "actions-of-another": "have the actions of another",
    "frozen": "stand still from a third of them on, while the actions go on",
    "late": f"have actions that are stored {sets.LATE} frames late",
    "leaping": "have a block that leaps in every tenth frame",
    "mixture": "are faulty in one of these ways",
}
_NONE = "without those that an error or a warning names"

TRAININGS: tuple[Training, ...] = (
    Training(
        (
            Play("right", "nothing is wrong"),
            Play("fps-30-at-rollout", "three times as many actions a second, each a third as long", fps=3 * CONTROL_HZ),
            Play("yaw-swap-at-rollout", "right in training; then the yaw is atan2(cos, sin)", mode=_SWAP),
            Play("scale-of-another-set-at-rollout", "scaled as a noisier recording is", scale=_of_another_set),
            Play("scale-eightfold-at-rollout", "one input is divided by 8 times too much", scale=_eightfold),
        )
    ),
    _one("scale-eightfold-throughout", "the same in training and at rollout", scale=_eightfold),
    _yaw(),
    *(_one(name, mode.assumption, mode) for name, mode in _MODES.items()),
    _one("idle-tenth", "in a tenth of the episodes nobody moves", source="idle"),
    _one("idle-tenth-unnamed", f"the same, {_NONE}", against="idle-tenth", source="idle", select=UNNAMED),
    _one("damaged-tenth", "a tenth of the episodes have the actions of another", source="tenth"),
    _one("damaged-tenth-unnamed", f"the same, {_NONE}", against="damaged-tenth", source="tenth", select=UNNAMED),
    _one("failed-kept", "noisier demonstrations, 3 in 10 of which fail", source="failing"),
    *(
        _one(f"failed-{name}", f"the same, {says}", against="failed-kept", source="failing", select=select)
        for name, says, select in (
            ("dropped", "those that reached the goal", REACHED),
            ("dropped-by-degrees", "those that reached it with a tolerance in degrees", REACHED_BY_DEGREES),
            ("as-many-at-random", "as many as reached it, at random", partial(_as_many_at_random, REACHED)),
        )
    ),
    *(_one(f"faulty-{name}", f"3 in 10 episodes {says}", source=name) for name, says in _FAULTY.items()),
    *(
        _one(f"faulty-{name}-unnamed", f"the same, {_NONE}", against=f"faulty-{name}", source=name, select=UNNAMED)
        for name in _FAULTY
    ),
    *(
        _one(f"faulty-mixture-{name}", f"the same, {says}", against="faulty-mixture", source="mixture", select=select)
        for name, says, select in (
            ("kept", "what z2r audit --keep leaves", KEPT),
            ("as-many-at-random", "as many as are not named, at random", partial(_as_many_at_random, UNNAMED)),
            ("as-many-shortest", "as many as are not named, the shortest", partial(_as_many_shortest, UNNAMED)),
        )
    ),
    _one("one-frame", "one frame in, and no action before it", scale=_without_the_past),
    _one("no-mirror", "no example is mirrored", mirror=False),
    _one("from-the-table", "seen from the table, not from the block", vantage="table"),
    _one("plain", "seen from the table, and no example is mirrored", vantage="table", mirror=False),
    _yaw("plain-", against="plain", vantage="table", mirror=False),
    Training((Play("right-2000", "nothing is wrong", "right-2000", more=2),), many=True),
    *(_one(f"{name}-2000", _MODES[name].assumption, _MODES[name], "right-2000", many=True) for name in _TELLING),
    _yaw(after="-2000", against="right-2000", many=True),
)

ROWS: dict[str, str] = {play.row: play.says for training in TRAININGS for play in training.plays}
"""What is wrong, by the name of the row, in the order of the table."""
