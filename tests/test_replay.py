"""What a recording says, read back row by row. The bytes of an .rrd differ from run to run; its rows do not."""

from dataclasses import replace
from pathlib import Path

import healthy
import msgspec
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq
import pytest
import rerun as rr
from filmed import CAMERAS, FRONT, LENGTHS, SIDE, shoot, video, write_filmed, write_photographed
from layouts import data_files, lay_out, shard_files
from rerun.chunk import RrdReader
from robots import JOINTS, write_arm

import z2r
from z2r.format.mp4 import read_video_index
from z2r.pusht import task
from z2r.pusht.world import PUSHT
from z2r.show import cameras
from z2r.show.plots import colors_of
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


def test_what_a_world_is_drawn_of_is_not_plotted_again(rows):
    assert [entity for entity, _ in rows if entity.startswith("/policy/action")]
    assert not [entity for entity, _ in rows if entity.startswith("/observation/state")]


# --- where an episode ends, and which one is shown


def test_no_line_goes_on_to_the_next_episode(standin, rows, tmp_path):
    between = (standin.episodes.from_index[1:] - 0.5) / standin.schema.fps
    for line in ("eval/pos_err", "eval/ang_err", "policy/action"):
        ends = [time for time, _ in rows[f"/{line}", "Clear:is_recursive"]]
        np.testing.assert_allclose(np.array(ends) / 1e9, between)
    merged = replay(tmp_path, standin, "drop-boundaries")
    assert ("/policy/action", "Clear:is_recursive") not in merged


def test_one_episode_is_shown_where_it_is_asked_for(standin, tmp_path):
    shown = z2r.write_replay(standin, tmp_path / "x.rrd", episode=4)
    assert (shown.n_frames, shown.n_episodes) == (standin.episodes.lengths[4], 1)
    drawn, own = read_rows(shown.path, "sim_time"), standin.episodes[4]
    np.testing.assert_allclose(values(drawn, "policy/action", "Scalars:scalars"), standin.read("action")[own])
    assert np.unique(values(drawn, "eval/episode_index", "Scalars:scalars")) == 4
    assert drawn["/policy/action", "Scalars:scalars"][0][0] == 0
    with pytest.raises(ValueError, match="found no episode 6, expected one of 0 to 5"):
        z2r.write_replay(standin, tmp_path / "y.rrd", episode=6)


def test_episodes_and_tasks_are_text_from_the_first_frame_of_each(tmp_path):
    write_filmed(tmp_path / "dataset")
    [path] = shard_files(tmp_path / "dataset")
    table = pq.read_table(path)
    told = [["lift"], ["place"], ["place"], ["lift"], *[["place"]] * 4]
    place = table.column_names.index("tasks")
    pq.write_table(table.set_column(place, "tasks", pa.array(told)), path)
    z2r.write_replay(tmp_path / "dataset", tmp_path / "x.rrd")
    drawn, starts = read_rows(tmp_path / "x.rrd", "frame"), (np.cumsum(LENGTHS) - LENGTHS).tolist()
    assert drawn["/task", "TextDocument:text"] == list(zip(starts, told, strict=True))
    assert drawn["/task", "StateChange:state"] == list(zip(starts, told, strict=True))
    episodes = [[f"episode {number}"] for number in range(len(LENGTHS))]
    assert drawn["/eval/episode_index", "StateChange:state"] == list(zip(starts, episodes, strict=True))
    assert "StateTimeline" in read_layout(tmp_path / "x.rrd")


# --- joints


def rgb(rows: Rows, entity: str) -> list[tuple[int, ...]]:
    [(_, colors)] = rows[entity, "SeriesLines:colors"]
    return [tuple(color.to_bytes(4)[:3]) for color in colors]


def test_state_and_action_of_a_joint_have_a_plot_and_a_colour_of_their_own(tmp_path):
    dataset, reading = write_arm(tmp_path)
    z2r.write_replay(dataset, tmp_path / "x.rrd", reading)
    drawn, layout = read_rows(tmp_path / "x.rrd", "frame"), read_layout(tmp_path / "x.rrd")
    both = {"state": dataset.read("observation.state"), "action": dataset.read("action")}
    for place, name in enumerate(JOINTS):
        entity = f"joints/{rr.escape_entity_path_part(name)}"
        for (role, whole), color in zip(both.items(), colors_of(place), strict=True):
            np.testing.assert_allclose(
                values(drawn, f"{entity}/{role}", "Scalars:scalars")[:, 0], whole[:, place], rtol=1e-6
            )
            assert rgb(drawn, f"/{entity}/{role}") == [color]
            assert len(drawn[f"/{entity}/{role}", "Clear:is_recursive"]) == len(dataset.episodes) - 1
            assert f"/{entity}/{role}" in layout
    assert rgb(drawn, "/observation/state") == [colors_of(place)[0] for place in range(len(JOINTS))]
    assert rgb(drawn, "/policy/action") == [colors_of(place)[1] for place in range(len(JOINTS))]
    assert "gripper.pos [percent]" in layout


def test_34_joints_are_all_named_and_no_two_are_alike(tmp_path):
    healthy.write_healthy("34-joints", tmp_path / "dataset")
    z2r.write_replay(tmp_path / "dataset", tmp_path / "x.rrd")
    drawn, layout = read_rows(tmp_path / "x.rrd", "frame"), read_layout(tmp_path / "x.rrd")
    colors = rgb(drawn, "/observation/state") + rgb(drawn, "/policy/action")
    assert len(set(colors)) == 2 * 34
    assert all(f"'joint_{number:02d}'" in layout for number in range(34))
    assert "joint_12 … joint_22" in layout


def test_an_action_that_is_no_position_is_not_drawn_with_the_state(standin, rows, tmp_path):
    assert not [entity for entity, _ in rows if entity.startswith("/joints")]
    assert rows["/policy/action", "SeriesLines:names"] == [(None, ["pusher_vx [m/s]", "pusher_vy [m/s]"])]
    dataset, reading = write_arm(tmp_path)
    steps = msgspec.structs.replace(reading, action=msgspec.structs.replace(reading.action, drives="delta"))
    z2r.write_replay(dataset, tmp_path / "x.rrd", steps)
    assert not [entity for entity, _ in read_rows(tmp_path / "x.rrd", "frame") if entity.startswith("/joints")]


# --- cameras


def seen(rows: Rows, camera: str) -> list[tuple[float | None, str, int]]:
    """The time of each row, the video that it refers to, and when in it [ns]."""
    of_camera = (rows[f"/cameras/{camera}", f"VideoFrameReference:{part}"] for part in ("video_reference", "timestamp"))
    return [(time, video, at) for (time, [video]), (_, [at]) in zip(*of_camera, strict=True)]


def test_each_frame_refers_to_its_own_moment_of_the_video_that_lies_on_disk(tmp_path):
    root = tmp_path / "dataset"
    write_filmed(root)
    shoot(root, SIDE, files=[3, 5])
    shown = z2r.write_replay(root, tmp_path / "x.rrd")
    assert shown.left_out == ()
    drawn, metadata = read_rows(shown.path, "frame"), pq.read_table(shard_files(root)[0]).to_pylist()
    for name in CAMERAS:
        expected = [
            (f"cameras/{name[19:]}/chunk-000-file-{row[f'videos/{name}/file_index']:03d}", at)
            for row in metadata
            for at in row[f"videos/{name}/from_timestamp"] + np.arange(row["length"]) / 10
        ]
        found = seen(drawn, name[19:])
        assert [time for time, _, _ in found] == list(range(sum(LENGTHS)))
        assert [video for _, video, _ in found] == [video for video, _ in expected]
        np.testing.assert_allclose([at / 1e9 for *_, at in found], [at for _, at in expected], atol=1e-9)
    for number in range(2):
        [(time, [blob])] = drawn[f"/cameras/side/chunk-000-file-{number:03d}", "AssetVideo:blob"]
        assert time is None
        assert bytes(blob) == video(root, SIDE, number).read_bytes()


def test_of_one_episode_only_the_video_that_shows_it_is_there(tmp_path):
    root = tmp_path / "dataset"
    write_filmed(root, files=[3, 5])
    drawn = read_rows(z2r.write_replay(root, tmp_path / "x.rrd", episode=4).path, "frame")
    assert {entity for entity, part in drawn if part == "AssetVideo:blob"} == {
        "/cameras/front/chunk-000-file-001",
        "/cameras/side/chunk-000-file-001",
    }
    start = LENGTHS[3] / 10
    assert [at for *_, at in seen(drawn, "front")] == [round(1e9 * (start + at / 10)) for at in range(LENGTHS[4])]


def test_a_video_that_is_missing_is_named_and_shows_nothing(tmp_path):
    root = tmp_path / "dataset"
    write_filmed(root, files=[3, 5])
    video(root, FRONT, 1).unlink()
    shown = z2r.write_replay(root, tmp_path / "x.rrd")
    [line] = shown.left_out
    assert line.startswith("videos/observation.images.front/chunk-000/file-001.mp4: found no such file")
    drawn, first_three = read_rows(shown.path, "frame"), sum(LENGTHS[:3])
    assert line in drawn["/about", "TextDocument:text"][0][1][0]
    assert [time for time, *_ in seen(drawn, "front")] == list(range(first_three))
    assert [time for time, _ in drawn["/cameras/front", "Clear:is_recursive"]] == [first_three - 1]
    assert len(seen(drawn, "side")) == sum(LENGTHS)


def set_moment(root: Path, wrong: float) -> None:
    """Say that the pictures of the third episode begin at another moment of their video [s]."""
    [path] = shard_files(root)
    table, column = pq.read_table(path), f"videos/{FRONT}/from_timestamp"
    times = table[column].to_pylist()
    times[2] = wrong
    pq.write_table(table.set_column(table.column_names.index(column), column, pa.array(times)), path)


@pytest.mark.parametrize("wrong", [np.nan, np.inf])
def test_a_moment_that_is_no_number_leaves_the_camera_out(wrong, tmp_path):
    root = tmp_path / "dataset"
    write_filmed(root)
    set_moment(root, wrong)
    shown = z2r.write_replay(root, tmp_path / "x.rrd")
    assert f"{FRONT}/from_timestamp in row 2: found {wrong}, expected a number of seconds" in shown.left_out[0]
    drawn = {entity for entity, _ in read_rows(shown.path, "frame")}
    assert "/cameras/side" in drawn
    assert "/cameras/front" not in drawn


@pytest.mark.parametrize("wrong", [1e300, 500.0])
def test_frames_at_moments_that_no_video_has_are_named_and_show_nothing(wrong, tmp_path):
    root = tmp_path / "dataset"
    write_filmed(root)
    set_moment(root, wrong)
    shown = z2r.write_replay(root, tmp_path / "x.rrd")
    assert f"{LENGTHS[2]} frames outside of it" in shown.left_out[0]
    hidden = range(sum(LENGTHS[:2]), sum(LENGTHS[:3]))
    assert {time for time, *_ in seen(read_rows(shown.path, "frame"), "front")}.isdisjoint(hidden)


def test_videos_that_are_too_large_are_cut_to_what_is_shown(tmp_path, monkeypatch):
    root = tmp_path / "dataset"
    write_filmed(root)
    monkeypatch.setattr(cameras, "MAX_BYTES", video(root, FRONT).stat().st_size)
    drawn = read_rows(z2r.write_replay(root, tmp_path / "x.rrd", episode=4).path, "frame")
    whole = read_video_index(root, video(root, FRONT).relative_to(root))
    [(_, [blob])] = drawn["/cameras/front/chunk-000-file-000", "AssetVideo:blob"]
    (tmp_path / "cut.mp4").write_bytes(bytes(blob))
    cut, first = read_video_index(tmp_path, Path("cut.mp4")), sum(LENGTHS[:4])
    assert len(cut.times) < len(whole.times) / 4
    times = rr.AssetVideo(path=tmp_path / "cut.mp4").read_frame_timestamps_nanos() / 1e9
    own = [int(np.abs(times - at / 1e9).argmin()) for *_, at in seen(drawn, "front")]
    np.testing.assert_allclose(times[own], [at / 1e9 for *_, at in seen(drawn, "front")], atol=1e-4)
    assert cut.sizes[own].tolist() == whole.sizes[first : first + LENGTHS[4]].tolist()


def test_without_pyav_videos_that_are_too_large_are_left_out(tmp_path, monkeypatch):
    root = tmp_path / "dataset"
    write_filmed(root)
    monkeypatch.setattr(cameras, "MAX_BYTES", video(root, FRONT).stat().st_size)
    monkeypatch.setattr(cameras, "can_decode", lambda: False)
    shown = z2r.write_replay(root, tmp_path / "x.rrd", episode=4)
    assert [line.split(":")[0] for line in shown.left_out] == ["videos/observation.images.side/chunk-000/file-000.mp4"]


@pytest.mark.parametrize("kind", ["png", "jpeg"])
def test_images_are_shown_as_they_are_encoded(kind, tmp_path):
    root = tmp_path / "dataset"
    write_photographed(root, kind=kind)
    drawn = read_rows(z2r.write_replay(root, tmp_path / "x.rrd", episode=2).path, "frame")
    first = sum(LENGTHS[:2])
    [path] = data_files(root)
    stored = pq.read_table(path, columns=[SIDE]).column(0).slice(first, LENGTHS[2]).to_pylist()
    found = drawn["/cameras/side", "EncodedImage:blob"]
    assert [time for time, _ in found] == list(range(LENGTHS[2]))
    assert [bytes(blob) for _, [blob] in found] == [picture["bytes"] for picture in stored]
    assert {media for _, [media] in drawn["/cameras/side", "EncodedImage:media_type"]} == {f"image/{kind}"}
