"""Are faults of a recording named, and is what is healthy left alone? Arms that are made up, each fault in many ways.

The faults and the healthy shapes were invented by who had not seen the checks (`arm_damages.py`, `healthy.py`).
"""

import msgspec
import numpy as np
import pytest
from arm_bench import NAMED, try_damage
from arm_damages import KINDS, write_case
from arms import ACTION, POS, STATE, make, write
from framed import FRAMED
from healthy import HEALTHY, write_healthy
from hypothesis import given
from hypothesis import strategies as st
from robots import write_arm
from test_scales import found

import z2r
from z2r.arrays import Columns
from z2r.audits import relations
from z2r.audits.following import Following, Pair, fold_following
from z2r.audits.motion import _COMMON, _MOVED, _TELLING, _coarse_steps, _nearest
from z2r.audits.steps import run_sums
from z2r.reading.reading import ColumnMeaning

SILENT: dict[str, set[str]] = {
    "state-at-half-rate": {"place"},
    "zero-action": {"place"},
    "small-spikes": {"place"},
    "trembling": {"place"},
    "clipped-state": {"half"},
    "clipped-action": {"half"},
    "backlash": {"half", "one"},
    "normalised-state": {"one"},
    "key-stuck": {"place"},
    "normalised-clipped": {"half"},
    "out-of-order": {"place"},
    "task-of-one": {"one"},
    "done-never": {"half", "one"},  # as in an episode that was cut off
}

# Of these, the first is what the check is about; the others it is not silent about either.
MADE_TO_FAIL = {
    "late": ("action-late", "half"),
    "unit": ("joint-rad-state", "all"),
    "joint-order": ("arms-exchanged-action", "all"),
    "follow": ("action-of-the-next", "one"),
    "command": ("action-zero", "half"),
    "discontinuity": ("joined", "one"),
    "stall": ("stall", "place"),
    "noise": ("noisy-sensor", "one"),
    "repeat": ("frames-doubled", "one"),
    "idle-episode": ("nobody-there", "one"),
    "elsewhere": ("sign-both", "one"),
    "clipped": ("clipped-state", "all"),
    "near-twin": ("copy-with-noise", "one"),
    "quaternion-sign": ("quaternion-flips", "all"),
    "unit-quaternion": ("quaternion-norm", "all"),
    "task-typo": ("task-placeholder", "all"),
    "limits": ("zero-gripper", "one"),  # under a reading, below
}
LACKS_A_FEATURE = ("other-features", "no-state", "no-action")  # which is said, and true


@pytest.mark.parametrize("name", KINDS)
def test_a_fault_is_named_where_anybody_could_know(name):
    variants = {variant for variant in KINDS[name].plant if not KINDS[name].why_not(variant)}
    verdicts = {variant: try_damage(name, variant, 0).verdict for variant in variants}
    assert {variant for variant, verdict in verdicts.items() if verdict != NAMED} == SILENT.get(name, set())


@pytest.mark.parametrize("name", HEALTHY)
def test_nothing_is_wrong_with_what_is_healthy(name, tmp_path):
    write_healthy(name, tmp_path / "dataset")
    wrong = [each for each in z2r.audit(tmp_path / "dataset").findings if each.severity != "note"]
    assert {each.check for each in wrong} == ({"policy-features"} if name in LACKS_A_FEATURE else set()), wrong


@pytest.mark.parametrize(("check", "case"), [each for each in MADE_TO_FAIL.items() if each[0] != "limits"])
def test_a_check_speaks_of_the_fault_that_it_is_about(check, case, tmp_path):
    planted = write_case(*case, tmp_path / "dataset")
    findings = z2r.audit(tmp_path / "dataset").findings
    assert {finding.check for finding in findings if finding.frame is not None} <= FRAMED.keys()
    said = [finding for finding in findings if finding.check == check]
    assert any(planted.is_named_by(str(finding)) for finding in said), said


def test_a_column_beyond_its_declared_limits_is_named(tmp_path):
    dataset, reading = write_arm(tmp_path)  # which declares 0 to 100 of the gripper, and it comes to 90
    assert not [finding for finding in z2r.audit(dataset.root, reading=reading).findings if finding.check == "limits"]
    narrow = msgspec.structs.replace(reading, columns={"gripper.pos": ColumnMeaning(unit="percent", low=30, high=95)})
    (found,) = [each for each in z2r.audit(dataset.root, reading=narrow).findings if each.check == "limits"]
    low = dataset.read("observation.state")[:, 5].min()
    assert f"{low:.4g} percent" in found.found
    assert "at least 30" in found.expected


def test_a_column_that_lies_higher_as_a_whole_is_a_note(tmp_path):
    recording = make("so101", 0)
    assert not found(recording, tmp_path / "right", "elsewhere")
    span = np.median([np.ptp(own[STATE][:, 5]) for own in recording.episodes])
    for name in (STATE, ACTION):
        recording.episodes[3][name][:, 5] += 0.2 * span
    said = found(recording, tmp_path / "dataset", "elsewhere")
    [finding] = [each for each in said if "a first, a lowest and a highest value that are all higher" in each.found]
    assert f"{STATE}[{POS[5]}] in episode 3" in finding.field
    assert (finding.severity, finding.episodes) == ("note", (3,))


@pytest.mark.parametrize(("stays", "named"), [(1.0, {"note"}), (0.75, {"note"}), (0.0, set())])
def test_a_zero_that_moved_is_named_where_episodes_begin_and_end_by_it(stays, named, tmp_path):
    recording, rng = make("so101", 0), np.random.default_rng(3)
    moved = (1, 4, 7, 9, 10)
    for number, own in enumerate(recording.episodes):
        fades = np.linspace(1, stays, len(own[STATE]))
        for name in (STATE, ACTION):
            own[name][:, 0] += rng.uniform(-3, 3) + 15 * fades * (number in moved)
    said = [each for each in found(recording, tmp_path / "dataset", "elsewhere") if "a first frame at" in each.found]
    assert {each.severity for each in said} == named
    assert all((each.episodes, POS[0] in each.field) == (moved, True) for each in said)


def test_joints_whose_command_is_their_state_while_others_follow_are_named(tmp_path):
    recording = make("so101", 0)
    assert not found(recording, tmp_path / "right", "command")
    own = recording.episodes[3]
    own[ACTION][:, [1, 4]] = own[STATE][:, [1, 4]]
    [finding] = found(recording, tmp_path / "dataset", "command")
    assert f"the state of the same frame in action[{POS[1]}], action[{POS[4]}], bit for bit" in finding.found
    assert finding.episodes == (3,)


@pytest.mark.parametrize(
    ("n_episodes", "frames", "why"),
    [
        (5, 60, "there are fewer than 6 episodes of 20 frames or more"),
        (6, 60, ""),
        (8, 19, "there are fewer than 6 episodes of 20 frames or more"),
    ],
)
def test_it_is_said_why_no_column_was_held_against_the_others(n_episodes, frames, why, tmp_path):
    recording = make("so101", 0)
    recording.episodes[:] = [{name: own[name][:frames] for name in own} for own in recording.episodes[:n_episodes]]
    write(recording, tmp_path / "dataset")
    said = [each for each in z2r.audit(tmp_path / "dataset").not_checked if "goes with the others" in each]
    assert [each.startswith("whether each column") and each.endswith(f": {why}") for each in said] == [True] * bool(why)


def test_columns_of_too_many_episodes_are_not_held_against_each_other(tmp_path, monkeypatch):
    write(make("so101", 0), tmp_path / "dataset")
    monkeypatch.setattr(relations, "_NUMBERS", 1000)
    assert any("so many columns are too many" in each for each in z2r.audit(tmp_path / "dataset").not_checked)


def test_a_command_that_drives_no_column_is_listed(tmp_path):
    recording = make("so101", 0)
    recording.names[ACTION] = [*POS[:5], "claw"]
    write(recording, tmp_path / "dataset")
    [said] = [each for each in z2r.audit(tmp_path / "dataset").not_checked if "is followed" in each]
    assert said == "whether action[claw] is followed: neither names nor a reading say which column it drives"


def lagging(n: int, lag: int, factor: float, noise: float, rng: np.random.Generator) -> tuple[np.ndarray, np.ndarray]:
    """A command of smooth noise, and a column that is there `lag` frames later."""
    command = np.convolve(rng.normal(size=n + 60), np.hanning(25), "same")
    state = np.roll(command, lag) / factor + rng.normal(0, noise, len(command))
    return command[30 : 30 + n], state[30 : 30 + n]


def follow(columns: Columns, starts: np.ndarray) -> Following:
    """Say how the only column of the state follows the only one of the action, in each run."""
    stats = {name: run_sums(values, starts)[0] for name, values in columns.items()}
    pair = Pair(0, "observation.state", 0, "action", "observation.state")
    found, _ = fold_following([pair], columns, stats, starts, head=len(starts))
    assert found is not None
    return found


@given(
    lag=st.integers(-8, 15),
    factor=st.sampled_from([1.0, -1.0, 180 / np.pi, 0.01, 1.25]),
    lengths=st.lists(st.integers(80, 200), min_size=1, max_size=5),
    seed=st.integers(0, 2**32 - 1),
)
def test_lag_and_factor_of_a_joint_are_those_that_it_was_made_with(lag, factor, lengths, seed):
    rng = np.random.default_rng(seed)
    parts = [lagging(n, lag, factor, 0.01 / abs(factor), rng) for n in lengths]
    action, state = (np.concatenate(each)[:, None] for each in zip(*parts, strict=True))
    starts = np.cumsum([0, *lengths])[:-1]
    found = follow({"action": action, "observation.state": state}, starts)
    assert found.lag[:, 0] == pytest.approx(lag, abs=1)
    assert found.factor[:, 0] == pytest.approx(factor, rel=0.05)


@given(
    value=st.floats(-1e3, 1e3), still=st.sampled_from(["action", "observation.state"]), seed=st.integers(0, 2**32 - 1)
)
def test_nothing_follows_where_nothing_moves(value, still, seed):
    action, state = (each[:, None] for each in lagging(400, 3, 1.0, 0.01, np.random.default_rng(seed)))
    columns = {"action": action, "observation.state": state}
    columns[still][100:300] = value  # the second of three runs, and both ends of it
    found = follow(columns, np.array([0, 100, 300]))
    assert found.explained[1, 0] == 0
    assert np.isnan(found.lag[1, 0])


@pytest.mark.parametrize("starts", [[0, 90, 91, 200], [*range(0, 300, 24)]], ids=["few runs", "many runs"])
def test_runs_are_summed_up_as_a_loop_over_frames_does(starts):
    rng, starts = np.random.default_rng(5), np.array(starts)
    values = np.round(np.cumsum(rng.normal(size=(300, 5)), axis=0), 1).astype(np.float32)
    values[:, 1] = np.clip(values[:, 1], *np.quantile(values[:, 1], [0.2, 0.8]))  # at an end in many runs
    values[:, 2] = 7  # and never moving
    values[:, 3] = np.where(np.arange(300) % 24 < 14, values[0, 3], values[:, 3])  # resting, and going on
    values[:, 4] = np.arange(300) % 24 // 12  # a switch
    stats, found = run_sums(values, starts, fps=10)
    for run, part in enumerate(np.split(values.astype(np.float64), starts[1:])):
        assert [each[run].tolist() for each in (stats.low, stats.high)] == [part.min(0).tolist(), part.max(0).tolist()]
        assert stats.mean[run] == pytest.approx(part.mean(axis=0))
        assert stats.squares[run] == pytest.approx(part.var(axis=0) * len(part))
        assert found.at_low[run].tolist() == (part == values.min(axis=0)).sum(axis=0).tolist()
        assert found.at_high[run].tolist() == (part == values.max(axis=0)).sum(axis=0).tolist()
        for column in range(5):
            stall = stall_of(part[:, column])
            told = (found.stall, found.stall_leap, found.stall_at, found.stall_length)
            assert [each[run, column] for each in told] == pytest.approx(stall)
        steps = np.abs(np.diff(part, axis=0))
        assert found.path[run] == pytest.approx(steps.sum(axis=0))
        assert found.moves[run].tolist() == (steps > 0).sum(axis=0).tolist()
        if len(part) > 1:
            assert stats.step[run] == pytest.approx(steps.max(axis=0))
            at = steps.argmax(axis=0)
            assert found.at[run].tolist() == np.where(steps.any(axis=0), 1 + at, 0).tolist()
            around = np.pad(steps, ((1, 1), (0, 0)))
            beside = [max(around[each, column], around[each + 2, column]) for column, each in enumerate(at)]
            assert found.around[run].tolist() == pytest.approx(beside)
            signed = np.diff(part, axis=0)
            back = np.where(signed[1:] * signed[:-1] < 0, np.minimum(steps[1:], steps[:-1]), 0)
            assert stats.spike[run] == pytest.approx(back.max(axis=0))
        third = np.diff(part, n=3, axis=0)
        assert found.noise[run] == pytest.approx(np.abs(third).sum(axis=0) if len(third) else np.zeros(5))
        alternates = (third[:-1] * third[1:]).sum(axis=0) < -0.4 * np.square(third).sum(axis=0)
        assert found.alternates[run].tolist() == alternates.tolist()
    assert found.stall.any()


def stall_of(values: np.ndarray) -> tuple[float, float, int, int]:
    """Find the worst leap after six frames of rest or more: how many times as far, how far, where, and the rest."""
    steps, worst = np.abs(np.diff(values, prepend=values[0])), (0.0, 0.0, 0, 0)
    for frame in range(7, len(values) - 5):
        rest = 0
        while frame - 1 - rest > 0 and steps[frame - 1 - rest] == 0:
            rest += 1
        after = steps[frame + 1 : frame + 6]
        if steps[frame] > 0 and rest >= 6 and (after > 0).sum() >= 4:
            worst = max(worst, (steps[frame] / after.max(), steps[frame], frame, rest))
    return worst


@given(st.integers(0, 2**32 - 1), st.integers(2, 33), st.integers(1, 4))
def test_the_nearest_demonstration_is_found_as_by_comparing_all(seed, n, size):
    rng = np.random.default_rng(seed)
    marks = np.cumsum(rng.normal(size=(n, 12, size)), axis=1)
    marks[rng.integers(n, size=n // 3)] = marks[0] + rng.normal(size=(n // 3, 12, size)) * 0.02  # copies
    marks[rng.integers(n)] = marks[0, 0]  # rests
    for run, end in enumerate(rng.integers(4, 25, size=n)):
        marks[run, end:] = np.nan
    marks[rng.integers(n), rng.integers(12), rng.integers(size)] = np.nan
    values = (marks - np.nanmean(marks, axis=(0, 1))) / np.nanstd(marks, axis=(0, 1))
    order = np.nansum(values[:, :6], axis=(1, 2)).argsort()
    moves = (np.abs(np.diff(values, axis=1)) > _MOVED).sum(axis=(1, 2))
    apart = np.full((n, n), np.inf)
    for place, one in enumerate(order):
        for other in order[place + 1 :]:
            there = np.isfinite(values[[one, other]]).all(axis=(0, 2))
            if there.sum() >= _COMMON and moves[one] >= _TELLING:
                between = np.sqrt(np.square(values[one, there] - values[other, there]).mean())
                apart[one, other] = apart[other, one] = between
    distance, neighbour = _nearest(marks)
    known = np.isfinite(apart.min(axis=1))
    np.testing.assert_array_equal(np.isfinite(distance), known)
    np.testing.assert_allclose(distance[known], apart.min(axis=1)[known], rtol=1e-4, atol=1e-5)
    np.testing.assert_allclose(apart[known, neighbour[known]], apart.min(axis=1)[known], rtol=1e-4, atol=1e-5)


@given(st.integers(0, 2**32 - 1), st.floats(-3, 1), st.integers(8, 40))
def test_a_coarse_step_is_found_as_by_looking_at_all_gaps(seed, scale, n_moments):
    rng, step = np.random.default_rng(seed), 10**scale
    values = np.cumsum(rng.normal(size=(6, n_moments)), axis=1) * 10 ** rng.uniform(-1, 2)
    values[:3] = np.round(values[:3] / step) * step
    values[1] += rng.normal(size=n_moments) * 1e-9 * np.ptp(values)  # within one level
    values[5] = np.nan
    span = float(np.nanmax(values) - np.nanmin(values))
    found = _coarse_steps(values, span)
    for row, own in zip(found, values, strict=True):
        gaps = np.diff(np.sort(own))
        gaps = gaps[gaps > 1e-5 * span]
        coarse = len(gaps) >= 7 and gaps.min() * 100 >= span
        coarse = coarse and np.abs(own / gaps.min() - np.round(own / gaps.min())).max() <= 0.01
        assert row == (gaps.min() if coarse else 0)
