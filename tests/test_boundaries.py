"""Where a limit is, exactly: what is just within it is fine, and what is just beyond is not."""

from pathlib import Path

import numpy as np
import pytest
from damages import DATA, declare_video, edit_column, edit_feature, edit_info, set_at

import z2r
from z2r.audits.frames import RunStats
from z2r.audits.values import jumps, no_sensor_is_frozen
from z2r.format.schema import MAX_SIGNAL_SIZE, read_schema
from z2r.pusht import checks
from z2r.pusht.overlap import LIMIT
from z2r.pusht.scene import SCENE
from z2r.pusht.world import PUSHT
from z2r.reading.scene import SceneSums


def checks_of(root: Path) -> set[str]:
    return {finding.check for finding in z2r.audit(root).findings}


# --- the schema


def test_a_feature_is_a_signal_up_to_a_size(standin_copy: Path) -> None:
    edit_feature(standin_copy, "wide", dtype="float32", shape=[MAX_SIGNAL_SIZE])
    edit_feature(standin_copy, "wider", dtype="float32", shape=[MAX_SIGNAL_SIZE + 1])
    signals = read_schema(standin_copy).signals()
    assert "wide" in signals
    assert "wider" not in signals


@pytest.mark.parametrize(("more", "refused"), [(0, False), (1, True)])
def test_so_many_features_are_read(more: int, refused: bool, standin_copy: Path) -> None:
    there = {**z2r.load(standin_copy).schema.features}
    features = {f"f{number}": {"dtype": "float32", "shape": [1]} for number in range(10_000 - len(there) + more)}
    kept = {name: {"dtype": feature.dtype, "shape": [*feature.shape]} for name, feature in there.items()}
    edit_info(standin_copy, features=features | kept)
    if not refused:
        assert len(read_schema(standin_copy).features) == 10_000
        return
    with pytest.raises(z2r.DatasetError, match="10,001 features"):
        read_schema(standin_copy)


@pytest.mark.parametrize(
    "template", ["videos/{video_key.__class__}/file.mp4", "videos/{video_key}/{file_index:9999d}.mp4", "{", "a}", "{x}"]
)
def test_a_template_of_videos_does_nothing_but_name_them(template: str, standin_copy: Path) -> None:
    declare_video(standin_copy)
    edit_info(standin_copy, video_path=template)
    [finding] = [each for each in z2r.audit(standin_copy).findings if each.field == "video_path"]
    assert (finding.check, finding.found) == ("video-file", repr(template))


# --- values


def stats_of(n_runs: int, spike: float, n: int = 100) -> RunStats:
    """Runs of one column that move by 0.01 from frame to frame, and leap away and back in the first of them."""
    one = np.ones((n_runs, 1))
    stats = RunStats(n=np.full(n_runs, float(n)), low=-one, high=one, mean=0 * one, squares=one, step=one, spike=one)
    return stats._replace(step=0.01 * one, spike=np.where(np.arange(n_runs)[:, None] == 0, spike, 0.01))


@pytest.mark.parametrize(
    ("spike", "n_runs", "n", "n_jumps"),
    [(0.1, 5, 100, 0), (0.1001, 5, 100, 1), (0.1001, 4, 100, 0), (0.1001, 5, 5, 1), (0.1001, 5, 4, 0)],
)
def test_a_jump_is_more_than_ten_usual_steps_among_five_long_episodes(
    spike: float, n_runs: int, n: int, n_jumps: int
) -> None:
    found = [*jumps("x", z2r.Feature("float32", (1,)), stats_of(n_runs, spike, n), np.arange(n_runs))]
    assert len(found) == n_jumps


@pytest.mark.parametrize(("n", "frozen"), [(39, False), (40, True)])
def test_a_sensor_is_frozen_from_40_frames_on(n: int, frozen: bool) -> None:
    stats = stats_of(6, 0.01, n)
    stats.high[0] = stats.low[0]
    runs = _Runs({"observation.state": stats})
    assert bool([*no_sensor_is_frozen.run(runs)]) == frozen


class _Runs:
    """As much of `z2r.audits.runs.Runs` as that check looks at."""

    def __init__(self, stats: dict[str, RunStats]) -> None:
        self.stats, self.number, self.claims = stats, np.arange(6), self
        self.schema, self.features = self, {"observation.state": z2r.Feature("float32", (1,))}


# --- physics


@pytest.mark.parametrize(("speed", "beyond"), [(1.0, False), (-1.0, False), (1.001, True)])
def test_an_action_may_be_as_fast_as_the_environment_lets_it(speed: float, beyond: bool, standin_copy: Path) -> None:
    edit_column(standin_copy, DATA, "action", set_at(3, [speed, 0.0]))
    assert ("action-range" in checks_of(standin_copy)) == beyond


@pytest.fixture(scope="module")
def scene() -> SceneSums:
    dataset = z2r.load("standin")
    frames = {name: dataset.read(name) for name in ("observation.state", "action")}
    decoded = z2r.decode(frames, PUSHT, dataset.schema)
    sums = SCENE.fold(decoded, 0, dataset.episodes, dataset.schema.fps)
    return SceneSums(dataset.root, dataset.episodes, PUSHT, [dataset.files[0].path], [sums])


def changed(scene: SceneSums, **changes: object) -> SceneSums:
    return scene._replace(sums=[scene.sums[0]._replace(**changes)])


@pytest.mark.parametrize(
    ("times", "depth", "wrong"),
    [(1, 2, False), (1, 2.001, True), (4, 1.5, False), (5, 1.5, True)],  # of 427 frames
)
def test_bodies_sink_in_twice_as_far_or_in_one_of_a_hundred_frames(
    times: int, depth: float, wrong: bool, scene: SceneSums
) -> None:
    worst = checks.Worst(times, depth * LIMIT, 0, (0,))
    assert bool([*checks.bodies_stay_apart.run(changed(scene, overlap=worst))]) == wrong


@pytest.mark.parametrize(("n_fine", "wrong"), [(3, False), (2, True)])  # of 6 that are in tolerance at some time
def test_half_of_the_episodes_stay_in_tolerance(n_fine: int, wrong: bool, scene: SceneSums) -> None:
    last = scene.sums[0].last.copy()
    last[n_fine:, 0] = 1.0  # m from the target
    assert bool([*checks.decisive_frame.run(changed(scene, last=last))]) == wrong


def test_half_a_turn_is_no_error_in_yaw(standin_copy: Path) -> None:
    """Where the block points the other way, the difference is half a turn, to the last bit of a float32."""

    def turn_round(rows: list[list[float]]) -> list[list[float]]:
        return [[*row[:4], -row[8], -row[9], *row[6:]] for row in rows]

    edit_column(standin_copy, DATA, "observation.state", turn_round)
    assert "yaw-error" not in checks_of(standin_copy)
