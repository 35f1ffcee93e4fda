"""What an action is, told from the data alone: never wrong, and decided where anyone would see it.

Every robot of `action_robots.py` is read once; each dimension of its action is judged against how it was made. The
table of all robots is printed at the end (`pytest -s tests/test_action.py`).
"""

from collections import Counter
from functools import cache

import msgspec
import numpy as np
import pytest
from action_robots import DEGREES, KNOWN_FACTORS, OPEN, PLAIN, ROBOTS, Rig, judge, numbered
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from z2r.reading.action import ActionSample, infer_action

KINDS = {"target", "step", "velocity", "step or velocity", "unknown"}
VERDICTS = ("right", "withheld", "undecided", "wrong")
DIMS = [(name, i, truth) for name, make in ROBOTS.items() for i, truth in enumerate(make().truths)]
few = settings(max_examples=6, derandomize=True, suppress_health_check=list(HealthCheck))


def named(dims):
    return [pytest.param(name, i, id=f"{name}-{truth.name}") for name, i, truth in dims]


@cache
def answers(name):
    return infer_action(ROBOTS[name]().sample)


def verdict(name, i):
    robot = ROBOTS[name]()
    return judge(answers(name)[i], robot.truths[i], robot.sample.fps)


# The bench.


@pytest.mark.parametrize(("name", "i"), named(DIMS))
def test_no_answer_is_wrong(name, i):
    outcome, why = verdict(name, i)
    assert outcome != "wrong", f"{why} ({answers(name)[i]})"


@pytest.mark.parametrize(("name", "i"), named(d for d in DIMS if d[2].level == PLAIN))
def test_what_is_plain_is_decided(name, i):
    outcome, why = verdict(name, i)
    assert outcome in ("right", "wrong"), why


@pytest.mark.parametrize("name", ROBOTS)
def test_every_dimension_gets_an_answer_with_a_reason(name):
    sample = ROBOTS[name]().sample
    assert [a.name for a in answers(name)] == list(sample.names)
    for answer in answers(name):
        assert answer.kind in KINDS
        assert answer.evidence.strip()
        if answer.kind != "unknown":
            assert answer.column in sample.columns


@pytest.mark.parametrize("name", ROBOTS)
def test_every_answer_is_made_of_plain_values_so_that_it_can_be_written_to_metrics(name):
    for answer in answers(name):
        assert msgspec.to_builtins(answer)["name"] == answer.name  # refuses a numpy scalar


def frames_copied(sample, i, answer):
    """For how much of the frames the action is the state `ahead` frames later, bit for bit."""
    k, column = answer.ahead, sample.state[:, sample.columns.index(answer.column)]
    n = len(column) - k
    same = sample.stretch[:n] == sample.stretch[k:]
    return np.mean((sample.action[:n, i] == column[k:])[same])


@pytest.mark.parametrize("name", ROBOTS)
def test_a_copy_is_called_one(name):
    robot = ROBOTS[name]()
    for i, (answer, truth) in enumerate(zip(answers(name), robot.truths, strict=True)):
        if truth.copied and answer.kind != "unknown":
            assert answer.copied, truth.name
        if answer.copied:
            assert frames_copied(robot.sample, i, answer) > 0.95, truth.name


@pytest.mark.parametrize("name", ROBOTS)
def test_a_unit_is_named_when_the_factor_is_a_known_one(name):
    robot = ROBOTS[name]()
    for i, (answer, truth) in enumerate(zip(answers(name), robot.truths, strict=True)):
        claims = [c for c in truth.claims if c.kind == answer.kind and c.column == answer.column and c.within]
        if truth.level == OPEN or verdict(name, i)[0] != "right" or not claims:
            continue
        off = min(abs(abs(claims[0].factor) / k - 1) for k in KNOWN_FACTORS)
        if off < 0.001:
            assert answer.unit, answer
        elif off > 0.2:
            assert not answer.unit, answer


# What must not matter.


@cache
def laboratory():
    """A target, a flipped target in degrees, a step, a velocity and a walk; a free column; lags of two frames."""
    rig = Rig(99, 30, (200,) * 6)
    path = rig.teleop(4) * 0.8
    late = rig.track(path, gain=1.0, dead=1)
    signs = (1.0, -DEGREES, 1.0, 1.0)
    for i, (kind, factor) in enumerate(zip(("target", "target", "step", "velocity"), signs, strict=True)):
        rig.joints((f"a{i}",), path[:, i : i + 1], late[:, i : i + 1], kind=kind, factor=factor, noise=0.0005)
    rig.unrelated("walk", rig.walk(1)[:, 0])
    rig.column("free", rig.teleop(1)[:, 0])
    return rig.build()


@cache
def before():
    return infer_action(laboratory().sample)


def changed(**what) -> tuple:
    return infer_action(with_(laboratory().sample, **what))


def with_(sample, **what):
    fields = {name: getattr(sample, name) for name in ("action", "state", "stretch", "names", "columns", "fps")}
    return ActionSample(**{**fields, **what})


def told(answer):
    return answer.name, answer.kind, answer.column, answer.ahead


def assert_same(after, *, kinds=True):
    for old, new in zip(before(), after, strict=True):
        assert told(new) == told(old) or (not kinds and told(new)[2:] == told(old)[2:])
        if old.factor is not None and old.kind == new.kind != "unknown":
            assert new.factor == pytest.approx(old.factor, rel=0.02)


def test_the_laboratory_is_read_rightly():
    robot = laboratory()
    outcomes = [judge(a, t, robot.sample.fps) for a, t in zip(before(), robot.truths, strict=True)]
    assert [o for o, _ in outcomes] == ["right"] * 4 + ["withheld"], outcomes


@few
@given(order=st.permutations(range(5)))
def test_the_order_of_the_state_does_not_matter(order):
    sample = laboratory().sample
    assert_same(changed(state=sample.state[:, order], columns=tuple(sample.columns[i] for i in order)))


@few
@given(order=st.permutations(range(5)))
def test_the_order_of_the_action_does_not_matter(order):
    sample = laboratory().sample
    after = changed(action=sample.action[:, order], names=tuple(sample.names[i] for i in order))
    assert_same([after[order.index(i)] for i in range(5)])


@few
@given(order=st.permutations(range(6)))
def test_the_order_of_the_episodes_does_not_matter(order):
    sample = laboratory().sample
    rows = np.concatenate([np.flatnonzero(sample.stretch == e) for e in order])
    assert_same(changed(action=sample.action[rows], state=sample.state[rows], stretch=np.sort(sample.stretch)))


@few
@given(scale=st.sampled_from([DEGREES, 1 / DEGREES, 1000.0, 0.001, 100.0, 0.01]))
def test_a_scale_of_the_action_changes_the_factor_alone(scale):
    for old, new in zip(before(), changed(action=laboratory().sample.action * scale), strict=True):
        assert (new.name, new.column, new.ahead) == (old.name, old.column, old.ahead)
        assert (new.kind == "unknown") == (old.kind == "unknown")
        assert new.kind in (old.kind, "step or velocity")
        if new.kind == old.kind != "unknown":
            assert new.factor == pytest.approx(old.factor * scale, rel=1e-3)


@few
@given(scale=st.sampled_from([DEGREES, 1 / DEGREES, 1000.0, 0.001]))
def test_a_scale_of_the_state_changes_the_factor_alone(scale):
    for old, new in zip(before(), changed(state=laboratory().sample.state * scale), strict=True):
        assert (new.name, new.column, new.ahead) == (old.name, old.column, old.ahead)
        assert new.kind in (old.kind, "step or velocity")
        if new.kind == old.kind != "unknown":
            assert new.factor == pytest.approx(old.factor / scale, rel=1e-3)


@few
@given(signs=st.lists(st.sampled_from([-1.0, 1.0]), min_size=5, max_size=5))
def test_a_flipped_action_flips_the_sign_alone(signs):
    after = changed(action=laboratory().sample.action * signs)
    for old, new, sign in zip(before(), after, signs, strict=True):
        assert told(new) == told(old)
        if old.kind != "unknown":
            assert new.factor == pytest.approx(sign * old.factor, rel=1e-3)


@few
@given(offsets=st.lists(st.floats(-10, 10), min_size=5, max_size=5))
def test_another_zero_of_the_state_changes_nothing(offsets):
    assert_same(changed(state=laboratory().sample.state + offsets))


def shifted(frames):
    """The same record, each action written down `frames` frames earlier."""
    sample = laboratory().sample
    n = len(sample.stretch) - frames
    keep = sample.stretch[:n] == sample.stretch[frames:]
    parts = {"action": sample.action[frames:], "state": sample.state[:n], "stretch": sample.stretch[:n]}
    return changed(**{name: values[keep] for name, values in parts.items()})


@few
@given(frames=st.integers(1, 10))
def test_an_action_written_earlier_is_that_much_further_ahead(frames):
    for old, new in zip(before(), shifted(frames), strict=True):
        assert told(new)[:3] == told(old)[:3]
        if old.kind != "unknown":
            assert new.ahead == old.ahead + frames


@few
@given(seed=st.integers(0, 2**31), n_columns=st.integers(1, 6))
def test_unrelated_columns_change_nothing(seed, n_columns):
    sample = laboratory().sample
    rig = Rig(seed, 30, (200,) * 6)
    extra = np.concatenate([rig.walk(n_columns), rig.teleop(n_columns), np.ones((1200, 1))], axis=1)
    names = numbered("extra", extra.shape[1])
    assert_same(changed(state=np.concatenate([sample.state, extra], axis=1), columns=sample.columns + names))


@few
@given(seed=st.integers(0, 2**31))
def test_unrelated_dimensions_change_nothing_and_get_no_claim(seed):
    sample = laboratory().sample
    rig = Rig(seed, 30, (200,) * 6)
    extra = np.concatenate([rig.walk(2), rig.teleop(3), rig.switch()[:, None]], axis=1)
    after = changed(action=np.concatenate([sample.action, extra], axis=1), names=sample.names + numbered("extra", 6))
    assert_same(after[:5])
    assert {a.kind for a in after[5:]} == {"unknown"}


@few
@given(seed=st.integers(0, 2**31), seconds=st.integers(2, 20), hertz=st.floats(0.05, 1.0))
def test_one_episode_of_smooth_unrelated_things_gets_no_claim(seed, seconds, hertz):
    rig = Rig(seed, 20, (20 * seconds,))
    state, action = rig.teleop(6, hertz), rig.teleop(6, hertz)
    sample = ActionSample(action, state, rig.stretch, numbered("a", 6), numbered("s", 6), 20.0)
    assert {a.kind for a in infer_action(sample)} == {"unknown"}


@few
@given(seed=st.integers(0, 2**31), lag=st.integers(0, 12), gain=st.floats(0.4, 1.0), noise=st.floats(0, 0.02))
def test_a_leader_and_its_follower_are_never_misread(seed, lag, gain, noise):
    rig = Rig(seed, 30, (150,) * 5)
    command = rig.teleop(4)
    rig.joints(numbered("joint", 4), command, rig.track(command, gain=gain, dead=lag), noise=noise)
    robot = rig.build()
    for answer, truth in zip(infer_action(robot.sample), robot.truths, strict=True):
        outcome, why = judge(answer, truth, 30)
        assert outcome != "wrong", why


# Hardly any data, and what is not to be touched.


def test_the_sample_is_not_written_to():
    sample = ROBOTS["everything_mixed"]().sample
    kept = [np.copy(v) for v in (sample.action, sample.state, sample.stretch)]
    infer_action(sample)
    for old, new in zip(kept, (sample.action, sample.state, sample.stretch), strict=True):
        np.testing.assert_array_equal(old, new)


@pytest.mark.parametrize("lengths", [(), (1,), (2,), (3,), (1,) * 50, (2,) * 50])
@pytest.mark.parametrize(("n_dims", "n_columns"), [(0, 0), (0, 2), (2, 0), (2, 3)])
def test_hardly_any_data_is_unknown(lengths, n_dims, n_columns):
    rng = np.random.default_rng(0)
    stretch = np.repeat(np.arange(len(lengths)), np.array(lengths, dtype=int)).astype(np.int64)
    action, state = rng.normal(size=(len(stretch), n_dims)), rng.normal(size=(len(stretch), n_columns))
    sample = ActionSample(action, state, stretch, numbered("a", n_dims), numbered("s", n_columns), 30.0)
    assert [a.kind for a in infer_action(sample)] == ["unknown"] * n_dims


def test_a_robot_that_never_moves_is_unknown():
    n = 300
    sample = ActionSample(np.ones((n, 2)), np.ones((n, 3)), np.zeros(n, np.int64), ("a", "b"), ("c", "d", "e"), 30.0)
    assert [a.kind for a in infer_action(sample)] == ["unknown", "unknown"]


@pytest.mark.parametrize("value", [np.nan, np.inf, 1e300])
def test_a_column_of_a_broken_sensor_changes_nothing(value):
    sample = laboratory().sample
    broken = np.full((len(sample.stretch), 1), value)
    assert_same(changed(state=np.concatenate([sample.state, broken], axis=1), columns=(*sample.columns, "broken")))


def test_a_few_frames_without_a_reading_change_nothing():
    state = laboratory().sample.state.copy()
    state[[17, 230, 231, 900]] = np.nan
    assert_same(changed(state=state))


# The table.


def test_the_table():
    print(f"\n{'robot':62}" + "".join(f"{v:>11}" for v in VERDICTS))
    total = Counter()
    for name, make in ROBOTS.items():
        counts = Counter(verdict(name, i)[0] for i in range(len(make().truths)))
        total += counts
        print(f"{name:62}" + "".join(f"{counts[v] or '':>11}" for v in VERDICTS))
    print(f"{'all':62}" + "".join(f"{total[v]:>11}" for v in VERDICTS))
    assert total["right"] > 0
