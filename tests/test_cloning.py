"""Behaviour cloning on PushT: what a policy sees, that it can learn, that it is judged rightly, and the experiment."""

from dataclasses import replace

import numpy as np
import pytest

import z2r
from z2r.format.episodes import EpisodeIndex
from z2r.pusht.beliefs import BELIEFS
from z2r.pusht.cloning import rows, sets
from z2r.pusht.cloning.data import CHUNK, MIRROR, MIRROR_ACTION, axes, cut, inputs, read_examples, scale_of, see, turn
from z2r.pusht.cloning.results import (
    ROLLOUTS,
    SHOWN,
    Result,
    costs_of,
    paired_difference,
    read_audited,
    read_results,
    read_rollout,
    wilson,
    write_table,
)
from z2r.pusht.cloning.rows import ROWS, TRAININGS
from z2r.pusht.simulator.env import PushTEnv
from z2r.pusht.simulator.replayed import MODES, play, replay
from z2r.pusht.task import CONTROL_HZ, PHYSICS_HZ, STATE_NAMES, TARGET_POSE
from z2r.reading.breaks import BREAK_MODES
from z2r.reading.verdict import read_verdict

PUSH = z2r.PUSHT
RNG = np.random.default_rng(0)


@pytest.fixture(scope="module")
def standin():
    return z2r.load(z2r.STANDIN)


def seeds_of(dataset):
    return [episode.seed for episode in read_verdict(dataset.root).episodes]


# --- what a policy sees


def test_it_sees_what_the_reading_says(standin):
    state = standin.read("observation.state")
    seen = see(state, PUSH, standin.schema)
    np.testing.assert_allclose(seen[:, :4], state[:, :4], atol=1e-7)
    np.testing.assert_allclose(np.stack([np.sin(seen[:, 4]), np.cos(seen[:, 4])]), state[:, 4:6].T, atol=1e-6)
    swapped = see(state, BREAK_MODES["yaw-swap"].reading(PUSH), standin.schema)
    np.testing.assert_allclose(np.cos(swapped[:, 4]), np.cos(np.pi / 2 - seen[:, 4]), atol=1e-6)


def scene(n):
    return np.column_stack([RNG.uniform(-0.4, 0.4, (n, 4)), RNG.uniform(-np.pi, np.pi, n)])


def moved(seen, by, angle):
    """Move and turn the whole table about the origin."""
    pusher, tee = (turn(seen[:, part], np.full(len(seen), angle)) + by for part in (slice(0, 2), slice(2, 4)))
    return np.column_stack([pusher, tee, seen[:, 4] + angle])


def test_seen_from_the_block_only_the_target_moves_when_the_table_does():
    now, before, action = scene(50), scene(50), RNG.normal(size=(50, 2))
    by, angle = np.array((0.1, -0.2)), 0.7
    one = inputs(now, before, action, "block")
    turned = turn(action, np.full(50, angle))
    other = inputs(moved(now, by, angle), moved(before, by, angle), turned, "block")
    differs = ~np.isclose(one, other).all(axis=0)
    assert np.flatnonzero(differs).tolist() == [2, 3, 4, 5]
    from_table = inputs(moved(now, by, angle), moved(before, by, angle), turned, "table")
    assert not np.isclose(inputs(now, before, action, "table"), from_table).all(axis=0)[:-1].any()


@pytest.mark.parametrize("vantage", ["block", "table"])
def test_a_mirrored_scene_is_seen_as_the_mirrored_numbers(vantage):
    assert TARGET_POSE[0] == TARGET_POSE[2] == 0  # or there is nothing to mirror about
    flip = np.array((-1, 1, -1, 1, -1.0))
    now, before, action = scene(50), scene(50), RNG.normal(size=(50, 2))
    mirrored = inputs(now * flip, before * flip, action * MIRROR_ACTION, vantage)
    np.testing.assert_allclose(mirrored, inputs(now, before, action, vantage) * MIRROR, atol=1e-12)
    along = turn(action, -axes(now, vantage))
    np.testing.assert_allclose(turn(action * MIRROR_ACTION, -axes(now * flip, vantage)), along * MIRROR_ACTION)


def test_no_example_reaches_across_the_end_of_an_episode():
    """The slow way, frame by frame."""
    episodes = EpisodeIndex(np.array([0, 7, 9]), np.array([7, 9, 30]))
    seen, action = scene(30), RNG.normal(size=(30, 2))
    examples = cut(seen, action, episodes, "table")
    for number in range(3):
        own = range(*episodes[number].indices(30))
        for frame in own:
            before = frame - 1 if frame - 1 in own else frame
            last = action[[before]] if before != frame else np.zeros((1, 2))
            expected = inputs(seen[[frame]], seen[[before]], last, "table")[0]
            np.testing.assert_array_equal(examples.inputs[frame], expected)
            assert examples.there[frame].tolist() == [frame + ahead in own for ahead in range(CHUNK)]
            for ahead in np.flatnonzero(examples.there[frame]):
                np.testing.assert_array_equal(examples.actions[frame, ahead], action[frame + ahead])


def test_dropped_boundaries_and_an_inclusive_end_do(standin):
    right = read_examples(standin, PUSH)
    dropped = read_examples(BREAK_MODES["drop-boundaries"].dataset(standin), PUSH)
    assert (~right.there).sum() > (~dropped.there).sum() > 0
    inclusive = read_examples(BREAK_MODES["inclusive-end"].dataset(standin), PUSH)
    assert len(inclusive.inputs) == len(right.inputs) + len(standin.episodes) - 1


# --- what is believed of the action


def believed_action(dataset, name):
    return BELIEFS[name].believe(dataset, PUSH)[0].read("action")


def test_late_actions_begin_at_rest_and_stay_in_their_episode(standin):
    action = standin.read("action")
    late = believed_action(standin, "late-2")
    for episode in map(standin.episodes.__getitem__, range(len(standin.episodes))):
        np.testing.assert_array_equal(late[episode][2:], action[episode][:-2])
        assert not late[episode][:2].any()


def test_the_other_beliefs(standin):
    action, state = standin.read("action"), standin.read("observation.state")
    np.testing.assert_array_equal(believed_action(standin, "exchanged"), action[:, ::-1])
    np.testing.assert_allclose(believed_action(standin, "centimetres"), action / 100)
    step = believed_action(standin, "step-for-velocity")
    first = standin.episodes[1]
    np.testing.assert_allclose(step[first][:-1], np.diff(state[first, :2], axis=0), atol=1e-7)
    assert not step[standin.episodes.to_index - 1].any()
    np.testing.assert_allclose(believed_action(standin, "velocity-by-30-fps"), 30 * step, atol=1e-5)


# --- the same actions again


def test_recorded_actions_played_again_pass_through_what_was_recorded(standin):
    state = standin.read("observation.state")
    for number, rollout in enumerate(replay(standin, seeds_of(standin))):
        recorded = state[standin.episodes[number]]
        assert rollout.success
        # Another version of MuJoCo goes another way by and by.
        np.testing.assert_allclose(rollout.states[:20], recorded[:20], atol=1e-3)


@pytest.mark.parametrize(
    ("mode", "succeed"),
    [
        (BELIEFS["exchanged"], 0),
        (BELIEFS["centimetres"], 0),
        (BELIEFS["step-for-velocity"], 0),
        (BREAK_MODES["wrong-fps"], 0),
        (BELIEFS["late-1"], 6),
        (BELIEFS["late-2"], 6),
        (BREAK_MODES["inclusive-end"], 6),
    ],
    ids=lambda value: getattr(value, "name", value),
)
def test_what_an_open_loop_forgives_and_what_not(standin, mode, succeed):
    assert sum(rollout.success for rollout in replay(standin, seeds_of(standin), mode)) == succeed


def test_at_another_rate_a_step_is_as_much_shorter_and_success_must_last_as_long():
    slow, fast = PushTEnv(), PushTEnv(fps=2 * CONTROL_HZ)
    assert np.array_equal(slow.reset(0), fast.reset(0))
    once = slow.step((0.3, 0.2)).observation
    fast.step((0.3, 0.2))
    np.testing.assert_array_equal(fast.step((0.3, 0.2)).observation, once)
    dataset = z2r.load(z2r.STANDIN)
    action = dataset.read("action")[dataset.episodes[0]]
    [seed, *_] = seeds_of(dataset)
    half_steps = len(play(np.repeat(action, 2, axis=0), seed, fps=2 * CONTROL_HZ).actions)
    assert abs(half_steps - 2 * len(play(action, seed).actions)) <= 1
    with pytest.raises(ValueError, match=f"expected 1 to {PHYSICS_HZ}"):
        PushTEnv(fps=0)


# --- the numbers of the table


def test_an_interval_of_wilson_solves_what_it_is_defined_by():
    """Its ends are the rates from which the one that was seen is 1.96 standard deviations away."""
    for k, n in ((0, 100), (3, 100), (150, 300), (300, 300)):
        for end in wilson(k, n):
            if 0 < end < 1:
                assert abs(k / n - end) == pytest.approx(1.959964 * np.sqrt(end * (1 - end) / n))


def test_a_difference_is_paired():
    base = RNG.random((3, 100)) < np.linspace(0, 1, 100)  # some starts are harder than others
    same = paired_difference(base.astype(float), base.astype(float))
    shuffled = paired_difference(base.astype(float), base[:, RNG.permutation(100)].astype(float))
    assert same[0] == 0
    assert same[2] - same[1] < shuffled[2] - shuffled[1]
    none = paired_difference(np.zeros((3, 100)), np.ones((3, 100)))
    assert none == (-1, -1, -1)


def result(row, seed, outcomes):
    return Result(row, 400, seed, outcomes, 9.5, 27000, 5000, 0.7, "a machine; torch 2", "python -m x", "right")


def test_a_table_survives_its_file_and_is_summed_up_by_row(tmp_path):
    results = [result("right", 0, "1111"), result("right", 1, "1110"), result("late-2", 0, "0000")]
    write_table(tmp_path / "results.csv", results)
    assert read_results(tmp_path / "results.csv") == results
    assert read_results(tmp_path / "none.csv") == []
    right, late = costs_of(results)
    assert (right.n_successes, right.n_rollouts, right.seeds) == (7, 8, (1, 0.75))
    assert late.cost[0] == -7 / 8


def test_what_ships_was_measured_on_the_same_starts_and_a_policy_that_reads_right_succeeds():
    results = read_results()
    assert {each.row for each in results} <= set(ROWS)
    assert {len(each.outcomes) for each in results if each.row != "right-2000"} == {100}
    assert all(each.command.endswith(f"--row {each.row}") for each in results)
    right = next(cost for cost in costs_of(results) if cost.row == "right-2000")
    assert right.n_rollouts == 600
    assert right.low >= 0.9


def test_every_row_was_measured_with_three_seeds():
    assert {(each.row, each.seed) for each in read_results()} == {(row, seed) for row in ROWS for seed in range(3)}


def test_the_rollouts_that_ship_are_those_of_the_table_and_small():
    results = read_results()
    for row in SHOWN:
        for number in range(3):
            rollout = read_rollout(row, number)
            assert rollout.success == (results_of(row, results)[0].outcomes[number] == "1")
            assert len(rollout.states) == len(rollout.actions) + 1
    for name in MODES:
        assert len(read_rollout(f"replay/{name}", 5).states) > 50
    assert ROLLOUTS.stat().st_size < 500_000


def results_of(row, results):
    return [each for each in results if each.row == row]


def test_what_is_held_against_the_unnamed_are_as_many(standin):
    def three(dataset):
        return np.array((True, False, True, True, False, False))

    at_random, shortest = rows._as_many_at_random(three, standin), rows._as_many_shortest(three, standin)
    assert at_random.sum() == shortest.sum() == 3
    assert standin.episodes.lengths[shortest].max() <= standin.episodes.lengths[~shortest].min()


def test_every_damage_does_what_it_says(standin):
    state, action = standin.read("observation.state"), standin.read("action")
    one, other = ((state[standin.episodes[each]], action[standin.episodes[each]]) for each in (0, 1))
    n = len(one[0])
    for damage in sets.FAULTS.values():
        seen, done = damage(one, other)
        assert (seen.shape, done.shape) == ((n, 10), (n, 2))
        assert np.array_equal(seen, one[0]) != np.array_equal(done, one[1])  # one of the two is as it was
    np.testing.assert_array_equal(sets.late(one, other)[1][sets.LATE :], one[1][: -sets.LATE])
    np.testing.assert_array_equal(sets.actions_of_another(one, other)[1][: len(other[1])], other[1][:n])
    assert (sets.frozen(one, other)[0][n // 3 :] == one[0][n // 3]).all()
    assert np.abs(sets.leaping(one, other)[0] - one[0]).max() == pytest.approx(sets.LEAP, abs=1e-6)
    seen, done = sets.idle(one, other)
    np.testing.assert_array_equal(seen, np.tile(one[0][0], (sets.IDLE_FRAMES, 1)))
    assert not done.any()


def test_every_row_has_another_name():
    names = [play.row for training in TRAININGS for play in training.plays]
    assert len(set(names)) == len(names)


# --- what needs torch


@pytest.fixture(scope="module")
def model():
    pytest.importorskip("torch")
    from z2r.pusht.cloning import model

    model.use_one_thread()
    return model


def test_a_policy_learns_what_it_is_shown(model, standin):
    examples = read_examples(standin, PUSH)
    policy = model.train(examples, steps=60, seed=0)
    for flip, flip_action in ((1, 1), (MIRROR, MIRROR_ACTION)):  # and it knows the mirrored ones as well
        wrong = ((policy(examples.inputs * flip) - examples.actions * flip_action) ** 2)[examples.there].mean()
        assert wrong < 0.8 * (examples.actions**2)[examples.there].mean()
    again = model.train(examples, steps=60, seed=0)
    np.testing.assert_array_equal(policy(examples.inputs), again(examples.inputs))


def test_what_is_learned_is_in_metres_a_second_whatever_the_scale(model, standin):
    examples = read_examples(standin, PUSH)
    fast = examples._replace(actions=10 * examples.actions)
    assert scale_of(fast).action == pytest.approx(10 * scale_of(examples).action)
    slow_policy, fast_policy = (model.train(each, steps=3, seed=0) for each in (examples, fast))
    np.testing.assert_allclose(fast_policy(examples.inputs), 10 * slow_policy(examples.inputs), rtol=1e-3, atol=1e-3)


def test_what_lies_beyond_the_end_of_an_episode_teaches_nothing(model, standin):
    examples = read_examples(standin, PUSH)
    nonsense = np.where(examples.there[..., None], examples.actions, 1e3)
    one, other = (model.train(each, steps=3, seed=0) for each in (examples, examples._replace(actions=nonsense)))
    np.testing.assert_array_equal(one(examples.inputs), other(examples.inputs))


def test_a_rollout_is_the_simulators_and_asks_with_what_was_seen_and_done(standin):
    """An expert of one rule, always to the right of the table, in the numbers that a policy gets and gives."""
    from z2r.pusht.cloning.rollout import PLAYED, roll_out

    asked = []

    def policy(numbers):
        asked.append(numbers)
        right = np.tile((0.2, 0.0), (len(numbers), CHUNK, 1))
        yaw = -np.arctan2(numbers[:, 4], numbers[:, 5])  # the target, as the block sees it, is turned the other way
        return turn(right, -yaw[:, None])

    [rollout] = roll_out(policy, [5], PUSH, standin.schema, max_seconds=2.0)
    env = PushTEnv(max_steps=20)
    states = [env.reset(5), *(env.step((0.2, 0.0)).observation for _ in range(20))]
    np.testing.assert_allclose(rollout.states, states, atol=1e-6)
    np.testing.assert_allclose(rollout.actions, np.tile((0.2, 0.0), (20, 1)))
    assert not rollout.success
    seen = see(np.array(states), PUSH, standin.schema)
    expected = inputs(seen[[PLAYED]], seen[[PLAYED - 1]], np.array([[0.2, 0.0]]), "block")
    np.testing.assert_allclose(asked[1], expected, atol=1e-5)


def test_recorded_chunks_played_by_a_policy_do_what_they_did(standin):
    """What a perfect policy would say, from the start of a recorded episode, ends in success."""
    from z2r.pusht.cloning.rollout import PLAYED, roll_out

    first = replace(standin, episodes=standin.episodes.only(slice(1)))
    chunks = iter(read_examples(first, PUSH).actions[::PLAYED])
    [rollout] = roll_out(lambda _: next(chunks)[None], seeds_of(standin)[:1], PUSH, standin.schema)
    assert rollout.success


def test_the_time_that_it_states_is_what_was_measured_or_none(model, monkeypatch):
    from z2r.pusht.cloning import experiment

    measured = [result(play.row, 0, "1")._replace(minutes=1.5) for play in TRAININGS[0].plays]
    monkeypatch.setattr(experiment, "read_results", lambda: measured)
    total = round(1.5 * len(TRAININGS[0].plays))
    assert f"measured: {total} minutes of one core (a machine" in experiment.expectation([(0, 0)], smoke=False)
    for wanted, smoke in (([(0, 1)], False), ([(0, 0), (1, 0)], False), ([(0, 0)], True)):
        assert "not yet measured" in experiment.expectation(wanted, smoke=smoke)


def run(*options):
    from click.testing import CliRunner

    from z2r.pusht.cloning.experiment import main

    done = CliRunner().invoke(main, [str(each) for each in options], catch_exceptions=False)
    return done.exit_code, done.output


def test_one_command_makes_the_whole_table_and_goes_on_where_it_stopped(model, tmp_path):
    assert run(tmp_path, "--smoke", "--jobs", 1)[0] == 0
    first = read_results(tmp_path / "results.csv")
    assert [each.row for each in first] == [*ROWS]
    assert read_rollout("late-2", 0, tmp_path / "rollouts.npz").states.shape[1] == len(STATE_NAMES)
    clean, late = (z2r.load(tmp_path / "sets" / name) for name in ("clean", "late"))
    damaged = sets.damaged_episodes(8, 0.3)
    assert len(damaged) == 2
    actions = [
        (clean.read("action")[clean.episodes[each]], late.read("action")[late.episodes[each]]) for each in range(8)
    ]
    assert [each for each, (one, other) in enumerate(actions) if not np.array_equal(one, other)] == damaged
    leaping = next(each for each in read_audited(tmp_path / "audited.csv") if each.source == "leaping")
    assert leaping.damaged > 0 == leaping.kept_damaged

    write_table(tmp_path / "results.csv", [each for each in first if each.row != "late-2"])
    code, said = run(tmp_path, "--smoke", "--row", "late-2", "--jobs", 2)  # in another process
    assert code == 0
    assert "1 policies to train" in said
    again = read_results(tmp_path / "results.csv")
    assert [each._replace(minutes=0) for each in again] == [each._replace(minutes=0) for each in first]
    code, said = run(tmp_path)
    assert code == 2
    assert "rows of another size" in said
