"""Exercises of `01_schema`."""

from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import msgspec
import numpy as np
from matplotlib.figure import Figure

from z2r.api import load
from z2r.arrays import Array
from z2r.course import figures
from z2r.course.exercises._core import Case, Question, judge_function, judge_prediction
from z2r.data import ARM, STANDIN
from z2r.format.schema import ACTION, BOOKKEEPING, STATE, Schema
from z2r.pusht.world import PUSHT
from z2r.reading.decode import decode

_EVERY = 30  # frames: few enough rows that an answer can be printed, and the block has moved between them


def check_numbers_in_a_frame(prediction: int | None, again: int | None = None) -> None:
    """Judge how many numbers one frame holds, over all features.

    Parameters
    ----------
    prediction : int or None
        What the learner put in place of None.
    again : int, optional
        The answer to the second question, which is asked of whoever was wrong.
    """
    sizes = _sizes(STANDIN)
    bookkeeping = sum(sizes[name] for name in BOOKKEEPING)
    why = f"{sizes[STATE]} of the state, {sizes[ACTION]} of the action and {bookkeeping} of the bookkeeping."
    of_arm = _sizes(ARM)
    others = sum(of_arm.values()) - bookkeeping
    second = Question(
        sum(of_arm.values()),
        f"{others} of what it saw and did, and {bookkeeping} of the bookkeeping, as everywhere.",
        "A frame of the arm has six joints, six numbers of the simulator, an action for each joint, and the same"
        " bookkeeping. How many numbers are that, without the pictures?",
    )
    judge_prediction(prediction, sum(sizes.values()), why, second, again)


def _sizes(root: Path) -> dict[str, int]:
    """How many numbers each feature has, without pictures."""
    features = load(root).schema.features
    return {name: feature.size for name, feature in features.items() if feature.is_numeric}


def check_values_of(function: Callable[..., Any]) -> None:
    """Judge a function that picks the values of one named dimension out of the state.

    Parameters
    ----------
    function : callable
        Takes the state, (n_frames, size), the schema and a name; returns one value for each frame, (n_frames,).
    """
    trials = zip(_datasets(), ("tee_x", "sin_tee_yaw", "pusher_y"), strict=True)
    cases = [Case(f"{name} of {what}", (state, schema, name)) for (what, state, schema), name in trials]
    hint = "Let the schema that you are given say where the name stands, and return one number for each frame."
    judge_function(
        function,
        _values_of,
        cases,
        hint,
        special_hint=lambda got, expected: (
            "`columns` returns a list, and so you get a table with one column. Take the one element of the list."
            if got.shape == (*expected.shape, 1)
            else None
        ),
    )


def check_block_position(function: Callable[..., Any]) -> Figure | None:
    """Judge a function that picks the block's position out of the state.

    Parameters
    ----------
    function : callable
        Takes the state, (n_frames, size), and the schema; returns x and y [m] in each frame, (n_frames, 2).

    Returns
    -------
    Figure or None
        Where the block is in the first frame, and where a wrong answer has it.
    """
    case = judge_function(
        function,
        lambda state, schema: state[:, schema.columns(STATE, ["tee_x", "tee_y"])],
        [Case(f"the block in {what}", (state, schema)) for what, state, schema in _datasets()],
        hint="Which names belong to the block's position, and who knows where they are?",
        untouched=lambda state, schema: state[:, 4:6],
    )
    if case is None:
        return None
    state, schema = case.args
    tee = decode(state[:1], PUSHT, schema).pose("tee")
    got = _as_positions(function(state, schema))
    if got is None:
        return None
    yaw = float(decode(state[:1], PUSHT, schema).yaw("tee")[0])
    return figures.two_poses((float(tee.x[0]), float(tee.y[0]), yaw), (got[0], got[1], yaw), label="your block")


def _values_of(state: Array, schema: Schema, name: str) -> Array:
    values: Array = state[:, schema.columns(STATE, [name])[0]]
    return values


def _as_positions(answer: object) -> tuple[float, float] | None:
    try:
        positions = np.asarray(answer, dtype=float)
    except (TypeError, ValueError):
        return None
    if positions.ndim != 2 or positions.shape[1] != 2 or not len(positions) or not np.isfinite(positions).all():
        return None
    return float(positions[0, 0]), float(positions[0, 1])


def _datasets() -> list[tuple[str, Array, Schema]]:
    """Return some frames of the shipped dataset, and the same with their columns in other places."""
    dataset = load(STANDIN).first(1)
    state, schema = dataset.read(STATE)[::_EVERY], dataset.schema
    names = schema.features[STATE].dim_names
    shuffled = np.random.default_rng(0).permutation(len(names))
    clock = (np.arange(len(state), dtype=np.float32) * np.float32(_EVERY / schema.fps))[:, np.newaxis]
    return [
        ("this dataset", state, schema),
        (
            "the same frames with the columns in another order",
            state[:, shuffled],
            _with_names(schema, [names[place] for place in shuffled]),
        ),
        (
            "the same frames with a clock as their first column",
            np.hstack([clock, state]),
            _with_names(schema, ["clock", *names]),
        ),
    ]


def _with_names(schema: Schema, names: Sequence[str]) -> Schema:
    feature = msgspec.structs.replace(schema.features[STATE], shape=(len(names),), names=list(names))
    return msgspec.structs.replace(schema, features=schema.features | {STATE: feature})
