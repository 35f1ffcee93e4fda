"""What a recording says, read back row by row. The bytes of an .rrd differ from run to run; its rows do not."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pyarrow as pa
import pytest
from layouts import lay_out
from rerun.chunk import RrdReader

import z2r
from z2r.pusht import task
from z2r.pusht.world import PUSHT
from z2r.show.replay import write_replay

Rows = dict[tuple[str, str], list[tuple[float | None, object]]]


def read_rows(path: Path, timeline: str) -> Rows:
    """(entity, component) -> [(time, value)] in order of time; None stands for static."""
    rows: Rows = {}
    for chunk in RrdReader(path).stream():
        batch = chunk.to_record_batch()
        if chunk.is_static or timeline not in batch.schema.names:
            times = [None] * batch.num_rows
        else:
            times = batch.column(timeline).cast(pa.int64()).to_pylist()
        for place, field in enumerate(batch.schema):
            if (field.metadata or {}).get(b"rerun:kind") == b"data":
                values = batch.column(place).to_pylist()
                found = [(time, value) for time, value in zip(times, values, strict=True) if value is not None]
                rows.setdefault((chunk.entity_path, field.name), []).extend(found)
    return {key: sorted(found, key=lambda row: (row[0] is not None, row[0] or 0)) for key, found in rows.items()}


def read_layout(path: Path) -> str:
    """All that the layout of the viewer says, whose bytes are packed."""
    reader = RrdReader(path)
    [blueprint] = reader.blueprints()
    return "".join(str(chunk.to_record_batch().to_pydict()) for chunk in reader.stream(store=blueprint))


def values(rows: Rows, entity: str, component: str) -> np.ndarray:
    return np.array([value for time, value in rows[f"/{entity}", component] if time is not None], dtype=float)


def replay(tmp_path: Path, dataset: z2r.Dataset, mode: str | None = None, timeline: str = "sim_time") -> Rows:
    path = tmp_path / f"{mode}.rrd"
    wrong = z2r.break_mode(mode) if mode else None
    z2r.write_replay(wrong.dataset(dataset) if wrong else dataset, path, wrong.reading(PUSHT) if wrong else None)
    return read_rows(path, timeline)


def yaw(rows: Rows, entity: str = "world/objects/tee") -> np.ndarray:
    x, y, z, w = values(rows, entity, "Transform3D:quaternion").reshape(-1, 4).T
    assert np.allclose([x, y], 0)
    return 2 * np.arctan2(z, w)


def assert_same_direction(found: np.ndarray, expected: np.ndarray) -> None:
    np.testing.assert_allclose(np.exp(1j * found), np.exp(1j * expected), atol=1e-6)


@pytest.fixture(scope="module")
def standin() -> z2r.Dataset:
    return z2r.load(z2r.STANDIN)


@pytest.fixture(scope="module")
def rows(standin, tmp_path_factory) -> Rows:
    return replay(tmp_path_factory.mktemp("replay"), standin)


def test_the_world_is_drawn_where_the_state_says(standin, rows):
    state = standin.read("observation.state")
    tee = values(rows, "world/objects/tee", "Transform3D:translation").reshape(-1, 3)
    pusher = values(rows, "world/robot/pusher", "Transform3D:translation").reshape(-1, 3)
    np.testing.assert_allclose(tee[:, :2], state[:, 2:4], atol=1e-6)
    np.testing.assert_allclose(pusher[:, :2], state[:, 0:2], atol=1e-6)
    assert np.allclose(tee[:, 2], task.TEE_Z)
    assert np.allclose(pusher[:, 2], task.PUSHER_Z)
    assert_same_direction(yaw(rows), z2r.decode(state, PUSHT, standin.schema).yaw("tee"))


def test_the_traces_are_the_errors_the_actions_and_the_episodes(standin, rows):
    errors = z2r.frame_errors(z2r.decode(standin.read("observation.state"), PUSHT, standin.schema))
    for name in ("pos_err", "ang_err"):
        np.testing.assert_allclose(values(rows, f"eval/{name}", "Scalars:scalars")[:, 0], errors[name])
    np.testing.assert_allclose(values(rows, "policy/action", "Scalars:scalars"), standin.read("action"))
    episode = values(rows, "eval/episode_index", "Scalars:scalars")[:, 0]
    np.testing.assert_array_equal(episode, standin.read("episode_index")[:, 0])


def test_an_episode_keeps_its_number_where_others_are_left_out(standin, tmp_path):
    left = replace(standin, episodes=standin.episodes.only(np.isin(np.arange(6), [1, 4])))
    episode = values(replay(tmp_path, left), "eval/episode_index", "Scalars:scalars")[:, 0]
    np.testing.assert_array_equal(episode, np.repeat([1, 4], left.episodes.lengths))


def test_the_tolerances_are_drawn_from_end_to_end(standin, rows):
    for error, tolerance in (("pos_err", task.POS_TOL), ("ang_err", task.ANG_TOL)):
        drawn = rows[f"/eval/{error}/tolerance", "Scalars:scalars"]
        first, last = (time for time, _ in rows[f"/eval/{error}", "Scalars:scalars"][:: standin.episodes.n_frames - 1])
        assert drawn == [(first, [tolerance]), (last, [tolerance])]


def test_time_runs_at_the_datasets_fps_over_all_episodes(standin, rows):
    times = np.array([time for time, _ in rows["/eval/pos_err", "Scalars:scalars"]]) / 1e9
    np.testing.assert_allclose(times, np.arange(standin.episodes.n_frames) / standin.schema.fps)


def test_the_frame_timeline_counts_frames(standin, tmp_path):
    by_frame = replay(tmp_path, standin, timeline="frame")
    assert [time for time, _ in by_frame["/eval/pos_err", "Scalars:scalars"]] == list(range(standin.episodes.n_frames))


def test_shapes_are_static_and_those_of_the_task(rows):
    for entity in ("world/objects/tee", "world/objects/target"):
        [(time, half_sizes)] = rows[f"/{entity}", "Boxes3D:half_sizes"]
        assert time is None
        np.testing.assert_allclose(
            np.array(half_sizes)[:, :2], [task.BAR_HALF_SIZE[:2], task.STEM_HALF_SIZE[:2]], atol=1e-6
        )
    [(time, radius)] = rows["/world/robot/pusher", "Cylinders3D:radii"]
    assert time is None
    assert radius == pytest.approx([task.PUSHER_RADIUS])


def test_a_reading_that_swaps_the_yaw_draws_the_block_mirrored(standin, rows, tmp_path):
    wrong = replay(tmp_path, standin, "yaw-swap")
    assert_same_direction(yaw(wrong), np.pi / 2 - yaw(rows))
    target = "/world/objects/target", "Transform3D:quaternion"
    assert wrong[target] == rows[target]


def test_a_reading_that_swaps_every_yaw_draws_the_target_wrong_too(standin, rows, tmp_path):
    wrong = replay(tmp_path, standin, "yaw-swap-everywhere")
    assert_same_direction(yaw(wrong), np.pi / 2 - yaw(rows))
    [(_, [quaternion])] = wrong["/world/objects/target", "Transform3D:quaternion"]
    assert 2 * np.arctan2(quaternion[2], quaternion[3]) == pytest.approx(np.pi / 2)


def test_paths_are_one_for_each_episode_and_leap_when_boundaries_are_dropped(standin, rows, tmp_path):
    def strips(drawn: Rows) -> list[np.ndarray]:
        return [np.array(strip) for _, [strip] in drawn["/world/paths/tee", "LineStrips3D:strips"] if _ is not None]

    def longest_step(strip: np.ndarray) -> float:
        return float(np.linalg.norm(np.diff(strip, axis=0), axis=1).max())

    assert [len(strip) for strip in strips(rows)] == standin.episodes.lengths.tolist()
    [merged] = strips(replay(tmp_path, standin, "drop-boundaries"))
    assert len(merged) == standin.episodes.n_frames
    assert longest_step(merged) > 3 * max(longest_step(strip) for strip in strips(rows))


def test_the_viewers_layout_is_in_the_file(rows, standin, tmp_path):
    replay(tmp_path, standin)
    layout = read_layout(tmp_path / "None.rrd")
    for view in ("3D", "TimeSeries", "sim_time", "reached where pos_err < 0.03 m", "reached where ang_err < 0.2 rad"):
        assert view in layout


@pytest.mark.parametrize(
    ("max_frames", "n_frames", "n_episodes"), [(7, 7, 2), (9, 7, 2), (2, 2, 1), (1, 1, 1), (8 + 4, 12, 3), (99, 12, 3)]
)
def test_of_a_long_dataset_the_first_whole_episodes_are_shown(tmp_path, max_frames, n_frames, n_episodes):
    lay_out(tmp_path / "dataset", [3, 4, 5], files=[1, 2], shards=[3])
    dataset = z2r.load(tmp_path / "dataset")
    shown = z2r.write_replay(dataset, tmp_path / "x.rrd", PUSHT, max_frames)
    assert (shown.n_frames, shown.n_episodes) == (n_frames, n_episodes)
    drawn = values(read_rows(shown.path, "frame"), "policy/action", "Scalars:scalars")
    np.testing.assert_allclose(drawn, dataset.read("action")[:n_frames])


def test_without_a_reading_the_numbers_are_shown_and_no_world(tmp_path, standin):
    path = tmp_path / "numbers.rrd"
    write_replay(replace(z2r.inspect_dataset(standin, keep=1000), reading=None), path)
    drawn = read_rows(path, "frame")
    np.testing.assert_allclose(values(drawn, "observation/state", "Scalars:scalars"), standin.read("observation.state"))
    assert not [entity for entity, _ in drawn if entity.startswith("/world")]
