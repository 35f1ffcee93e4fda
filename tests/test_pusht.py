"""The PushT simulator and the scripted expert that recorded the shipped demonstrations."""

import math
from collections.abc import Iterator

import numpy as np
import pytest
from numpy.typing import NDArray

from z2r.pusht.simulator import expert as expert_module
from z2r.pusht.simulator.env import SLIDE_DAMPING, START_GAP, YAW_DAMPING, PushTEnv, StepResult
from z2r.pusht.simulator.expert import BLOCK_RADIUS, TOUCH, TWIST, ScriptedExpert, predict_push
from z2r.pusht.task import (
    ACTION_LIMIT,
    ACTION_NAMES,
    ANG_TOL,
    BAR_CENTER,
    BAR_HALF_SIZE,
    CONTROL_HZ,
    MAX_STEPS,
    POS_TOL,
    PUSHER_RADIUS,
    STATE_NAMES,
    STEM_CENTER,
    STEM_HALF_SIZE,
    SUCCESS_HOLD,
    TARGET_POSE,
    WALL,
)

Frame = tuple[NDArray[np.float32], NDArray[np.float32], StepResult]  # observation before the step, action, result

NOISE = 0.08  # m/s
STILL = np.zeros(2)
AWAY = (0.3, 0.3)  # m: where the pusher is out of the way of a block on the target


def corners(observation: NDArray[np.float32]) -> NDArray[np.float64]:
    """Corners of the two boxes in the world, (8, 2)."""
    signs = np.array([(-1, -1), (-1, 1), (1, 1), (1, -1)])
    boxes = ((BAR_CENTER, BAR_HALF_SIZE), (STEM_CENTER, STEM_HALF_SIZE))
    local = np.concatenate([np.array(center) + signs * half_size[:2] for center, half_size in boxes])
    x, y, sin, cos = (float(value) for value in observation[2:6])
    moved: NDArray[np.float64] = local @ np.array([(cos, sin), (-sin, cos)]) + np.array((x, y))
    return moved


def overlap(observation: NDArray[np.float32]) -> float:
    """How deep [m] the pusher's disc is in the T, from the edges of its boxes: an oracle apart from the expert's."""
    pusher = observation[:2].astype(np.float64)
    boxes = corners(observation).reshape(2, 4, 2)
    starts, ends = boxes, np.roll(boxes, -1, axis=1)
    edges = ends - starts
    along = np.clip(((pusher - starts) * edges).sum(-1) / (edges**2).sum(-1), 0, 1)
    distance = np.linalg.norm(starts + along[..., None] * edges - pusher, axis=-1).min(axis=1)
    offset = pusher - starts
    inside = (edges[..., 0] * offset[..., 1] - edges[..., 1] * offset[..., 0] <= 0).all(axis=1)
    return float(PUSHER_RADIUS - np.where(inside, -distance, distance).min())


def place(env: PushTEnv, tee: tuple[float, float, float], pusher: tuple[float, float] = AWAY) -> None:
    """Put the bodies somewhere in a running episode."""
    env._data.qpos[:] = (*pusher, *tee)
    env._data.qvel[:] = 0


def play(seed: int, noise: float, env: PushTEnv) -> Iterator[Frame]:
    """Yield the frames of an episode of the expert's."""
    expert, rng = ScriptedExpert(), np.random.default_rng([seed, 1])
    observation = env.reset(seed)
    while True:
        action = np.clip(expert(observation) + rng.normal(0, noise, 2), -ACTION_LIMIT, ACTION_LIMIT).astype(np.float32)
        result = env.step(action)
        yield observation, action, result
        if result.done:
            return
        observation = result.observation


def record(seed: int, env: PushTEnv) -> bytes:
    """All observations of a noisy episode of 60 steps at most, as bytes."""
    frames = zip(range(60), play(seed, NOISE, env), strict=False)
    return b"".join(result.observation.tobytes() for _, (_, _, result) in frames)


# The environment: starts


def test_observation_follows_state_names() -> None:
    """Each entry is the joint, or the target's number, that its name says."""
    env = PushTEnv()
    observation = env.reset(3)
    assert observation.dtype == np.float32
    assert observation.shape == (len(STATE_NAMES),)
    joints = {name: env._data.joint(name).qpos[0] for name in ("pusher_x", "pusher_y", "tee_x", "tee_y", "tee_yaw")}
    target_x, target_y, target_yaw = TARGET_POSE
    expected = {
        **joints,
        "sin_tee_yaw": math.sin(joints["tee_yaw"]),
        "cos_tee_yaw": math.cos(joints["tee_yaw"]),
        "target_x": target_x,
        "target_y": target_y,
        "sin_target_yaw": math.sin(target_yaw),
        "cos_target_yaw": math.cos(target_yaw),
    }
    assert observation.tolist() == [np.float32(expected[name]) for name in STATE_NAMES]


def test_starts_are_apart_inside_unsolved_and_spread() -> None:
    """Whatever the seed, there is something to do, room to do it in, and nothing overlaps."""
    env, starts = PushTEnv(), []
    for seed in range(500):
        observation = env.reset(seed)
        starts.append(observation)
        assert not env.in_tolerance, seed
        assert not env.success, seed
        assert overlap(observation) < -START_GAP + 1e-6, seed
        assert np.abs(corners(observation)).max() < WALL - 2 * PUSHER_RADIUS - START_GAP, seed
        assert np.abs(observation[:2]).max() < WALL - PUSHER_RADIUS, seed
    states = np.array(starts)
    for sin, cos in ((4, 5), (8, 9)):
        np.testing.assert_allclose(states[:, sin] ** 2 + states[:, cos] ** 2, 1, atol=1e-6)
    quadrants = np.floor(np.arctan2(states[:, 4], states[:, 5]) / (np.pi / 2))
    assert np.unique(quadrants, return_counts=True)[1].min() > 80
    assert len(np.unique(states[:, :6], axis=0)) == 500


def test_one_seed_gives_the_same_bytes_fresh_and_reused() -> None:
    """Nothing of an earlier episode leaks into the next."""
    fresh = record(4, PushTEnv())
    assert fresh == record(4, PushTEnv())
    reused = PushTEnv()
    record(5, reused)  # abandoned in the middle
    assert fresh == record(4, reused)
    assert fresh != record(5, PushTEnv())


# The environment: when an episode is over


def test_success_wants_a_hold_in_a_row_and_latches() -> None:
    """Leaving tolerance starts the count again; success ends the episode and stays."""
    env = PushTEnv()
    env.reset(0)
    place(env, TARGET_POSE)
    for _ in range(SUCCESS_HOLD - 1):
        assert not env.step(STILL).success
    place(env, (POS_TOL + 0.01, 0.0, 0.0))
    assert not env.step(STILL).done
    place(env, TARGET_POSE)
    successes = [env.step(STILL).success for _ in range(SUCCESS_HOLD)]
    assert successes == [False] * (SUCCESS_HOLD - 1) + [True]
    place(env, (0.2, 0.2, 1.0))
    assert env.success  # the verdict stays, whatever happens to the block now
    with pytest.raises(RuntimeError, match="reset"):
        env.step(STILL)
    env.reset(0)
    assert not env.success
    assert env.steps == 0
    place(env, TARGET_POSE)
    env.step(STILL)
    env.reset(0)
    place(env, TARGET_POSE)
    successes = [env.step(STILL).success for _ in range(SUCCESS_HOLD)]
    assert successes == [False] * (SUCCESS_HOLD - 1) + [True]


@pytest.mark.parametrize(
    ("tee", "within"),
    [
        ((0.0, POS_TOL - 0.001, ANG_TOL - 0.001), True),
        ((0.0, POS_TOL + 0.001, 0.0), False),
        ((0.8 * POS_TOL, 0.8 * POS_TOL, 0.0), False),  # distance, not each axis
        ((0.0, 0.0, ANG_TOL + 0.001), False),
        ((0.0, 0.0, -ANG_TOL - 0.001), False),
        ((0.0, 0.0, 2 * math.pi - ANG_TOL + 0.001), True),  # yaw has wound up
        ((0.0, 0.0, math.pi), False),
    ],
)
def test_tolerances(tee: tuple[float, float, float], within: bool) -> None:
    """Both errors count, the yaw's the shorter way round."""
    env = PushTEnv()
    env.reset(0)
    place(env, tee)
    assert env.in_tolerance is within
    assert env.pos_err == pytest.approx(math.hypot(tee[0], tee[1]))
    assert env.ang_err == pytest.approx(abs(math.remainder(tee[2], math.tau)))
    assert env.step(STILL)[3:] == (env.pos_err, env.ang_err)


def test_an_episode_times_out() -> None:
    """It is over at `max_steps`, and says so."""
    env = PushTEnv(max_steps=7)
    env.reset(0)
    assert [env.step(STILL).timed_out for _ in range(7)] == [False] * 6 + [True]
    assert env.steps == 7
    assert not env.success
    with pytest.raises(RuntimeError, match=r"steps taken: 7.*reset"):
        env.step(STILL)
    assert PushTEnv().max_steps == MAX_STEPS


def test_success_at_the_last_step_is_not_a_time_out() -> None:
    """Success comes first."""
    env = PushTEnv(max_steps=SUCCESS_HOLD)
    env.reset(0)
    place(env, TARGET_POSE)
    results = [env.step(STILL) for _ in range(SUCCESS_HOLD)]
    assert results[-1].success
    assert not results[-1].timed_out
    assert [result.done for result in results] == [False] * (SUCCESS_HOLD - 1) + [True]


# The environment: actions


@pytest.mark.parametrize(
    ("action", "message"),
    [
        ([0.1, math.nan], r"nan.*finite"),
        ([math.inf, 0.0], r"inf.*finite"),
        ([0.1], r"\(1,\).*expected \(2,\)"),
        ([[0.1, 0.2]], r"\(1, 2\).*expected \(2,\)"),
    ],
)
def test_a_bad_action_is_refused_and_changes_nothing(action: object, message: str) -> None:
    """The error says what was found and what was expected."""
    env = PushTEnv()
    before = env.reset(0)
    with pytest.raises(ValueError, match=message):
        env.step(action)  # type: ignore[arg-type]
    assert env.steps == 0
    assert env._observation().tobytes() == before.tobytes()


def test_misuse_is_refused() -> None:
    """Stepping before a reset, and an episode without steps."""
    with pytest.raises(RuntimeError, match="reset"):
        PushTEnv().step(STILL)
    with pytest.raises(ValueError, match="max_steps is 0; expected at least 1"):
        PushTEnv(max_steps=0)


def test_an_action_is_a_velocity_and_is_clipped() -> None:
    """The pusher goes where it is told to, within the limit."""
    env = PushTEnv()

    def travel(action: tuple[float, float]) -> NDArray[np.float64]:
        env.reset(0)
        place(env, (0.2, 0.2, 0.0), pusher=(-0.2, -0.2))
        env.step(action)
        return np.array(env._data.qpos[:2]) - (-0.2, -0.2)

    np.testing.assert_allclose(travel((0.2, -0.1)), np.array((0.2, -0.1)) / CONTROL_HZ, atol=2e-3)
    np.testing.assert_array_equal(travel((5.0, -3.0)), travel((ACTION_LIMIT, -ACTION_LIMIT)))
    assert len(ACTION_NAMES) == 2


def test_nothing_leaves_through_a_wall() -> None:
    """Not even at full speed, with the block in between."""
    env = PushTEnv()
    for direction in np.linspace(0, 2 * np.pi, 16, endpoint=False):
        env.reset(0)
        place(env, (0.1 * math.cos(direction), 0.1 * math.sin(direction), direction), pusher=(0.0, -0.13))
        action = np.array((math.cos(direction), math.sin(direction)))
        for _ in range(15):
            observation = env.step(action).observation
            assert np.abs(observation[:2]).max() < WALL
            assert np.abs(corners(observation)).max() < WALL + 0.005
        assert np.abs(observation[:2]).max() > WALL - 4 * PUSHER_RADIUS  # it did get to a wall, or a block at one


def test_the_block_stops_at_once_and_lies_still() -> None:
    """The table's friction: no gliding on, no creeping."""
    env = PushTEnv()
    env.reset(0)
    place(env, (0.0, 0.1, 0.3), pusher=(0.0, 0.16))
    for _ in range(4):
        env.step((0.0, -0.3))
    moved = env._data.qpos[2:].copy()
    assert moved[1] < 0.07
    env.step(STILL)
    stopped = env._data.qpos[2:].copy()
    assert np.abs(stopped - moved).max() < 0.008
    for _ in range(10):
        env.step(STILL)
    np.testing.assert_allclose(env._data.qpos[2:], stopped, atol=1e-4)


# The expert


def test_the_experts_model_of_a_push_is_the_simulators() -> None:
    """Its block radius is the simulator's, and a push ends about where it predicts."""
    assert pytest.approx(math.sqrt(YAW_DAMPING / SLIDE_DAMPING)) == BLOCK_RADIUS
    contact = int(np.hypot(*(TOUCH - (0.03, 0.03)).T).argmin())  # on top of the bar, right of the middle
    start = np.array((0.0, 0.0, 0.5))
    env = PushTEnv()
    env.reset(0)
    place(env, tuple(start), pusher=tuple(expert_module._rotate(TOUCH[contact], 0.5)))
    for _ in range(3):  # 6 cm along the face's normal, which turns with the block
        yaw = env._data.qpos[4]
        env.step((0.2 * math.sin(yaw), -0.2 * math.cos(yaw)))
    predicted = predict_push(start, TWIST[contact], np.array(0.06))
    assert abs(predicted[2] - start[2]) > 0.3
    np.testing.assert_allclose(env._data.qpos[2:4], predicted[:2], atol=0.012)
    np.testing.assert_allclose(env._data.qpos[4], predicted[2], atol=0.12)


def test_a_predicted_push_is_the_sum_of_small_ones() -> None:
    """The closed form of the arc, against integrating the twist."""
    for twist in TWIST:
        pose = np.array((0.1, -0.2, 2.0))
        for _ in range(2000):
            pose = pose + 0.0001 * np.append(expert_module._rotate(twist[:2], pose[2]), twist[2])
        predicted = predict_push(np.array((0.1, -0.2, 2.0)), twist, np.array(0.2))
        np.testing.assert_allclose(predicted, pose, atol=1e-3)


def test_the_expert_acts_on_the_observation_alone() -> None:
    """The same observations give the same actions, without any environment."""
    env = PushTEnv()
    expert = ScriptedExpert()
    observations = [before for before, _, _ in play(7, NOISE, env)][:30]  # ends in the middle of a push
    first = [expert(observation) for observation in observations]
    assert expert.phase == "shove"
    assert first[0].dtype == np.float32
    assert first[0].shape == (len(ACTION_NAMES),)
    expert.reset()
    second = [expert(observation) for observation in observations]
    np.testing.assert_array_equal(first, second)
    with pytest.raises(ValueError, match="shorter"):
        expert(observations[0][:9])


def nudged_in_mid_push(nudge: tuple[float, float]) -> tuple[str, NDArray[np.float32]]:
    """Phase and action of an expert that pushes a block straight down, once the block is shifted by `nudge` [m]."""
    env, expert = PushTEnv(), ScriptedExpert()
    env.reset(0)
    place(env, (0.0, 0.2, 0.0), pusher=(0.0, 0.24))
    observation = env._observation()
    for _ in range(4):
        observation = env.step(expert(observation)).observation
    assert expert.phase == "shove"
    observation[2:4] += np.array(nudge, dtype=np.float32)
    action = expert(observation)
    return expert.phase, action


@pytest.mark.parametrize("nudge", [(0.0, -0.1), (0.04, 0.0)])
def test_the_expert_gives_up_a_push_that_lost_the_block(nudge: tuple[float, float]) -> None:
    """The block is gone, or the contact on its face is."""
    phase, _ = nudged_in_mid_push(nudge)
    assert phase == "approach"


@pytest.mark.parametrize("slip", [0.01, -0.01])
def test_the_expert_keeps_to_its_contact(slip: float) -> None:
    """Where the pusher slips a little along the face, it goes on pushing and moves back."""
    phase, (vx, vy) = nudged_in_mid_push((slip, 0.0))
    assert phase == "shove"
    assert vy < -0.15
    assert vx * slip > 0.0003


def test_reset_forgets_what_the_expert_was_about_to_do() -> None:
    """The first action after a reset is that of a new expert, even if the last episode stopped on the way."""
    env = PushTEnv()
    used, fresh = ScriptedExpert(), ScriptedExpert()
    for observation in [before for before, _, _ in play(7, NOISE, env)][:10]:
        used(observation)
    assert used.phase == "approach"
    used.reset()
    np.testing.assert_array_equal(used(env.reset(8)), fresh(env.reset(8)))


@pytest.fixture(scope="module", params=[0.0, NOISE], ids=["clean", "noisy"])
def episodes(request: pytest.FixtureRequest) -> list[list[Frame]]:
    """Every frame of seeds 0 to 99, without and with action noise."""
    env = PushTEnv()
    return [list(play(seed, request.param, env)) for seed in range(100)]


def test_the_expert_succeeds(episodes: list[list[Frame]]) -> None:
    """At least 98 of 100, in less than 80 steps on average."""
    failed = [seed for seed, frames in enumerate(episodes) if not frames[-1][2].success]
    assert len(failed) <= 2, failed  # none on the machine it was written on; another stack may lose one
    assert np.mean([len(frames) for frames in episodes]) < 80


def test_the_last_stored_frame_of_a_success_is_in_tolerance(episodes: list[list[Frame]]) -> None:
    """So that *reached* can be read from what is stored, which is observations before the step."""
    for seed, frames in enumerate(episodes):
        if frames[-1][2].success:
            x, y, sin, cos = frames[-1][0][2:6]
            assert math.hypot(x, y) < POS_TOL, seed
            assert abs(math.atan2(sin, cos)) < ANG_TOL, seed


def test_solid_bodies_hardly_overlap(episodes: list[list[Frame]]) -> None:
    """What the reader's overlap check relies on."""
    depths = np.array([overlap(observation) for frames in episodes for observation, _, _ in frames])
    assert depths.max() < 0.0055
    assert (depths > 0.003).mean() < 0.002
    assert (depths > -0.001).mean() > 0.2  # they do touch: it pushes


def test_the_expert_moves_at_a_hands_pace(episodes: list[list[Frame]]) -> None:
    """Neither a sprint nor a crawl."""
    steps = np.concatenate([np.diff([observation[:2] for observation, _, _ in frames], axis=0) for frames in episodes])
    speeds = np.linalg.norm(steps, axis=1) * CONTROL_HZ
    assert np.quantile(speeds, 0.99) < 0.5
    assert 0.1 < np.median(speeds) < 0.3
