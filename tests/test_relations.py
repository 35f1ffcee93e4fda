"""What a column has to do with the others, told from the other episodes; and commands whose names are only akin."""

from pathlib import Path

import numpy as np
import pytest
from arms import ACTION, POS, STATE, Recording, make, write
from hypothesis import given
from hypothesis import strategies as st
from test_scales import VELOCITY, arm, found

import z2r
from z2r.audits.findings import Finding
from z2r.audits.following import pairs_of
from z2r.audits.relations import keep_moments, moments_to_keep
from z2r.format.schema import Feature, Schema

EFFORT = "observation.effort"


def schema_of(**features: Feature) -> Schema:
    return Schema("v3.0", 30, 1, 1, features, "data")


def with_effort(seed: int = 0) -> Recording:
    """An SO-101 whose motors say what they hold: some of the weight of what is further out, and of what moves."""
    recording, rng = make("so101", seed), np.random.default_rng(7)
    recording.names[EFFORT] = POS
    weights = rng.normal(0, 0.05, (6, 6))
    for own in recording.episodes:
        moves = np.gradient(own[STATE], axis=0)
        own[EFFORT] = own[STATE] @ weights + 0.1 * moves + rng.normal(0, 0.01, own[STATE].shape)
    return recording


def untared(own: np.ndarray) -> np.ndarray:
    return own + 3 * own.std()


DAMAGES = {
    "not tared": untared,
    "the other sign": np.negative,
    "of another time": lambda own: np.roll(own, 30),
}


@pytest.mark.parametrize("kind", DAMAGES)
@pytest.mark.parametrize("column", [0, 3])
def test_a_column_that_does_not_go_with_the_others_is_named(kind, column, tmp_path):
    recording = with_effort()
    assert not found(recording, tmp_path / "right", "relation")
    own = recording.episodes[4][EFFORT]
    own[:, column] = DAMAGES[kind](own[:, column])
    [finding] = found(recording, tmp_path / "dataset", "relation")
    assert f"{EFFORT}[{POS[column]}] in episode 4" in finding.field
    assert (finding.severity, finding.episodes) == ("note", (4,))


def test_where_most_episodes_differ_nobody_knows_which_are_right(tmp_path):
    recording = with_effort()
    for own in recording.episodes[::2]:
        own[EFFORT][:, 1] *= -1
    assert not found(recording, tmp_path / "dataset", "relation")


@given(lengths=st.lists(st.integers(1, 60), min_size=2, max_size=6), cut=st.integers(1, 5), n=st.integers(8, 32))
def test_moments_of_blocks_are_those_of_the_whole(lengths, cut, n):
    cut = min(cut, len(lengths) - 1)
    schema = schema_of(a=Feature("float32", (2,)), b=Feature("float32", (1,)))
    rng, starts = np.random.default_rng(sum(lengths)), np.cumsum([0, *lengths[:-1]])
    signals = {name: rng.normal(size=(sum(lengths), size)) for name, size in (("b", 1), ("a", 2))}
    whole, row = keep_moments(schema, signals, starts, n), starts[cut]
    parts = [
        keep_moments(schema, {name: each[:row] for name, each in signals.items()}, starts[:cut], n),
        keep_moments(schema, {name: each[row:] for name, each in signals.items()}, starts[cut:] - row, n),
    ]
    np.testing.assert_array_equal(whole, np.concatenate(parts))
    for run, length in enumerate(lengths):
        own = signals["a"][starts[run] : starts[run] + length, 0].astype(np.float32)
        assert np.isnan(whole[run]).all() if length < 20 else np.isin(whole[run, :, 0, 0], own[1:-1]).all()


def test_what_is_kept_has_a_limit():
    schema = schema_of(**{STATE: Feature("float32", (32,)), ACTION: Feature("float32", (32,))})
    kept = {n: moments_to_keep(schema, n) for n in (5, 6, 100, 2_000, 100_000)}
    assert kept == {5: 0, 6: 32, 100: 32, 2_000: 16, 100_000: 0}


def late(recording: Recording, frames: int, *episodes: int) -> None:
    for number in episodes:
        own = recording.episodes[number]
        own[VELOCITY] = np.concatenate([np.repeat(own[VELOCITY][:1], frames, axis=0), own[VELOCITY][:-frames]])


@pytest.mark.parametrize("frames", [4, 8])
def test_a_velocity_that_is_late_is_named_with_the_frames(frames, tmp_path):
    recording = arm()
    late(recording, frames, 1, 2)
    said = [each for each in found(recording, tmp_path / "dataset", "velocity") if "the time of" in each.field]
    assert said
    for finding in said:
        assert set(finding.episodes) <= {1, 2}
        assert f"{frames} frames after observation.state[" in finding.found


def test_a_sensor_that_stands_in_an_episode_is_named(tmp_path):
    recording = with_effort()
    own = recording.episodes[2][EFFORT]
    own[len(own) // 3 :, 4] = own[len(own) // 3, 4]
    said = [each for each in found(recording, tmp_path / "dataset", "frozen") if EFFORT in each.field]
    assert [(each.field, each.severity, each.episodes) for each in said] == [
        (f"{EFFORT}[{POS[4]}] in episode 2", "note", (2,))
    ]


# --- commands whose names are akin to those of the columns


KIN = {
    "the same": (["x", "y"], ["x", "y"], [(0, 0), (1, 1)]),
    "a velocity": (["vx", "vy"], ["x", "y"], [(0, 0), (1, 1)]),
    "a step": (["delta_x", "d_y", "dz"], ["x", "y", "z"], [(0, 0), (1, 1), (2, 2)]),
    "a command": (["w_cmd", "v.target"], ["v", "w"], [(0, 1), (1, 0)]),
    "of a hand": (["hand_vx", "HAND.goal.y"], ["hand_x", "hand_y"], [(0, 0), (1, 1)]),
    "another hand's": (["left_vx"], ["right_x"], []),
    "one of two": (["vx"], ["x", "goal_x"], []),
    "something else": (["voltage", "drive"], ["oltage", "rive"], []),
}


@pytest.mark.parametrize("kind", KIN)
def test_commands_are_paired_by_kin_of_name(kind):
    actions, states, pairs = KIN[kind]
    features = {
        ACTION: Feature("float32", (len(actions),), actions),
        STATE: Feature("float32", (len(states),), states),
    }
    assert [(pair.dim, pair.column) for pair in pairs_of(schema_of(**features), None)] == pairs


def planar(root: Path, flipped: tuple[int, ...] = ()) -> list[Finding]:
    """A hand on a table that is told how fast to go; in some episodes, upwards is downwards."""
    recording = make("so101", 0)
    recording.names.update({STATE: ["x", "y"], ACTION: ["vx", "vy"]})
    rng = np.random.default_rng(0)
    for number, own in enumerate(recording.episodes):
        told = np.stack([np.convolve(rng.normal(size=len(own[STATE]) + 24), np.hanning(25), "valid") for _ in "xy"], 1)
        own[STATE] = np.concatenate([np.zeros((1, 2)), np.cumsum(told, axis=0)[:-1]]) / recording.fps
        own[ACTION] = told * np.array([1, -1 if number in flipped else 1])
    write(recording, root)
    return [each for each in z2r.audit(root).findings if each.severity != "note"]


def test_a_sign_is_named_though_the_command_has_another_name(tmp_path):
    assert not planar(tmp_path / "right")
    said = planar(tmp_path / "dataset", flipped=(2, 3))
    assert [(each.check, each.episodes) for each in said if "action[vy]" in each.field] == [("unit", (2, 3))]
