import json
from concurrent.futures import ProcessPoolExecutor
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from layouts import data_files, lay_out, to_arrow, to_numpy
from test_dataset import oracle

import z2r
from z2r.format import parquet
from z2r.format.dataset import map_files
from z2r.pusht.world import PUSHT
from z2r.reading.breaks import BREAK_MODES
from z2r.reading.inspection import metrics_json


def slow_reading(root, tee_yaw, target_yaw) -> tuple[list[bool], list[float], list[float]]:
    """What the last frames say, the plain way: LeRobotDataset, item by item, scalar by scalar."""
    dataset = oracle(root)
    reached, pos_errs, ang_errs = [], [], []
    for stop in dataset.meta.episodes["dataset_to_index"]:
        state = [float(value) for value in dataset[stop - 1]["observation.state"]]
        _, _, x, y, tee_sin, tee_cos, target_x, target_y, target_sin, target_cos = state
        pos_err = ((x - target_x) ** 2 + (y - target_y) ** 2) ** 0.5
        turn = tee_yaw(tee_sin, tee_cos) - target_yaw(target_sin, target_cos)
        ang_err = abs(np.arctan2(np.sin(turn), np.cos(turn)))
        reached.append(bool(pos_err < 0.03 and ang_err < 0.2))
        pos_errs.append(pos_err)
        ang_errs.append(ang_err)
    return reached, pos_errs, ang_errs


def swapped(sin_yaw, cos_yaw):
    return np.arctan2(cos_yaw, sin_yaw)


@pytest.mark.parametrize(
    ("mode", "tee_yaw", "target_yaw"),
    [
        (None, np.arctan2, np.arctan2),
        ("yaw-swap", swapped, np.arctan2),
        ("yaw-swap-everywhere", swapped, swapped),
    ],
)
def test_outcomes_are_what_a_plain_loop_over_lerobot_finds(recorded, mode, tee_yaw, target_yaw):
    outcome = z2r.inspect_dataset(z2r.load(recorded), mode and z2r.break_mode(mode)).outcome
    reached, pos_err, ang_err = slow_reading(recorded, tee_yaw, target_yaw)
    assert outcome.reached.tolist() == reached
    np.testing.assert_allclose(outcome.final_errors["pos_err"], pos_err, atol=1e-6)
    np.testing.assert_allclose(outcome.final_errors["ang_err"], ang_err, atol=1e-6)


def test_the_recorded_episodes_are_a_mix_so_that_the_comparison_means_something(recorded):
    reached = z2r.inspect_dataset(z2r.load(recorded)).outcome.reached
    assert 0 < reached.sum() < len(reached)


@pytest.mark.parametrize("mode", [None, *BREAK_MODES])
def test_ranges_are_those_of_each_episodes_frames(recorded, mode):
    dataset = z2r.load(recorded)
    inspection = z2r.inspect_dataset(dataset, mode and z2r.break_mode(mode))
    for feature, ranges in inspection.ranges.items():
        values = inspection.dataset.read(feature)
        assert len(ranges.low) == len(inspection.episodes)
        for episode in range(len(inspection.episodes)):
            own = values[inspection.episodes[episode]]
            np.testing.assert_array_equal(ranges.low[episode], own.min(axis=0))
            np.testing.assert_array_equal(ranges.high[episode], own.max(axis=0))


SIGNATURES = {
    # first three episodes of the shipped dataset: how many reached of how many episodes
    None: (3, 3),
    "yaw-swap": (0, 3),
    "drop-boundaries": (1, 1),
    "yaw-swap-everywhere": (3, 3),
    "no-wrap": (3, 3),  # nothing, as the target's yaw is 0
    "inclusive-end": (1, 3),  # the last one has no next episode to read from
    "first-shard-only": (3, 3),  # nothing, as there is one shard
    "stale-file-pointer": (3, 3),  # nothing, as there is one file
    "name-sorted-files": (3, 3),
    "wrong-reference-point": (0, 3),
    "degrees-for-radians": (0, 3),
    "first-frame-for-last": (0, 3),
    "wrong-fps": (3, 3),
    "action-lag": (3, 3),
    "joints-exchanged": (3, 3),  # nothing, as no goal is about the pusher
    **dict.fromkeys(("wrong-angle-unit", "quaternion-order", "delta-for-absolute", "gripper-inverted"), (3, 3)),
}


@pytest.mark.parametrize("mode", SIGNATURES)
def test_each_break_mode_leaves_its_signature_on_the_first_three(mode):
    outcome = z2r.inspect_dataset(z2r.load(z2r.STANDIN).first(3), mode and z2r.break_mode(mode)).outcome
    assert (outcome.n_reached, len(outcome.reached)) == SIGNATURES[mode]


def test_every_break_mode_has_a_signature_here():
    assert set(BREAK_MODES) == set(SIGNATURES) - {None}


def test_yaw_swap_changes_nothing_but_the_yaw():
    right, wrong = (
        z2r.inspect_dataset(z2r.load(z2r.STANDIN), mode).metrics("x", 0) for mode in (None, z2r.break_mode("yaw-swap"))
    )
    changed = {key for key in right if right[key] != wrong[key]}
    assert changed == {"break_mode", "reached", "n_reached", "success_rate", "final_ang_err"}


def test_the_two_swaps_of_yaw_swap_everywhere_cancel():
    right, wrong = (
        z2r.inspect_dataset(z2r.load(z2r.MESSY), mode).outcome for mode in (None, z2r.break_mode("yaw-swap-everywhere"))
    )
    np.testing.assert_allclose(wrong.final_errors["ang_err"], right.final_errors["ang_err"], atol=1e-6)
    assert wrong.reached.tolist() == right.reached.tolist()


def test_dropped_boundaries_leave_one_episode_that_ends_where_the_last_one_does(recorded):
    dataset = z2r.load(recorded)
    right, wrong = (z2r.inspect_dataset(dataset, mode) for mode in (None, z2r.break_mode("drop-boundaries")))
    assert wrong.episodes.lengths.tolist() == [right.episodes.n_frames]
    assert wrong.outcome.final_errors["pos_err"] == right.outcome.final_errors["pos_err"][-1]


def test_an_unknown_break_mode_is_answered_with_those_there_are():
    with pytest.raises(ValueError, match="yaw-swap, drop-boundaries, yaw-swap-everywhere"):
        z2r.break_mode("yaw")


def test_metrics_agree_with_each_other_and_are_the_same_bytes_each_time(recorded):
    def metrics() -> bytes:
        return metrics_json(z2r.inspect_dataset(z2r.load(recorded)).metrics("recorded", None))

    first = metrics()
    assert metrics() == first
    read = json.loads(first)
    assert read["n_frames"] == sum(read["episode_lengths"])
    assert read["n_episodes"] == len(read["episode_lengths"]) == len(read["reached"]) == len(read["final_pos_err"])
    assert read["n_reached"] == sum(read["reached"])
    assert read["success_rate"] == round(read["n_reached"] / read["n_episodes"], 6)
    assert read["mean_episode_length"] == round(read["n_frames"] / read["n_episodes"], 6)
    assert (read["obs_dim"], read["act_dim"], read["fps"], read["seed"]) == (10, 2, 10, None)
    assert list(read)[:7] == ["source", "seed", "break_mode", "obs_dim", "act_dim", "fps", "feature_keys"]


def test_a_dataset_of_another_robot_is_summed_up_without_an_outcome(standin_copy):
    path = standin_copy / "meta/info.json"
    path.write_text(path.read_text().replace("tee_x", "cube_x"))
    inspection = z2r.inspect_dataset(z2r.load(standin_copy))
    assert inspection.outcome is None
    assert inspection.missing == ("tee_x",)
    metrics = inspection.metrics("x", None)
    assert metrics["reached"] is metrics["success_rate"] is metrics["final_ang_err"] is None
    assert metrics["n_frames"] == z2r.load(z2r.STANDIN).episodes.n_frames


def test_a_dataset_without_state_or_names_is_summed_up(tmp_path):
    lay_out(tmp_path / "dataset", [3, 4], files=[2], shards=[2])
    path = tmp_path / "dataset/meta/info.json"
    info = json.loads(path.read_text())
    del info["features"]["observation.state"]
    info["features"]["action"]["names"] = None
    path.write_text(json.dumps(info))
    inspection = z2r.inspect_dataset(z2r.load(tmp_path / "dataset"))
    assert list(inspection.ranges) == ["action"]
    assert inspection.metrics("x", None)["obs_dim"] is None


def test_thousands_of_episodes_in_many_files_are_counted_right(tmp_path):
    lengths = np.random.default_rng(0).integers(1, 5, size=3000)
    lay_out(tmp_path / "dataset", lengths, files=[100] * 30, shards=[1000] * 3)
    dataset = z2r.load(tmp_path / "dataset")
    outcome = z2r.inspect_dataset(dataset).outcome
    last = dataset.read("observation.state")[np.cumsum(lengths) - 1]
    errors = z2r.frame_errors(z2r.decode(last, PUSHT, dataset.schema))
    assert outcome.reached.tolist() == z2r.in_tolerance(errors, PUSHT).tolist()
    assert 0 < outcome.n_reached < 3000


def test_a_state_of_pictures_has_no_reading_whatever_its_names(standin_copy):
    path = standin_copy / "meta/info.json"
    info = json.loads(path.read_text())
    info["features"]["observation.state"]["dtype"] = "image"
    path.write_text(json.dumps(info))
    dataset = z2r.load(standin_copy)
    chosen, given = z2r.inspect_dataset(dataset), z2r.inspect_dataset(dataset, reading=PUSHT)
    assert chosen.outcome is chosen.reading is given.outcome is given.reading is None
    assert chosen.missing == ()  # nothing of PushT is there, so nobody takes it for PushT
    assert set(given.missing) == set(PUSHT.names)


def test_processes_inspect_like_threads(recorded):
    dataset = z2r.load(recorded)
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as pool:
        by_processes = z2r.inspect_dataset(dataset, executor=pool, keep=50)
    by_threads = z2r.inspect_dataset(dataset, keep=50)
    assert by_processes.metrics("x", 0) == by_threads.metrics("x", 0)
    for name, kept in by_threads.kept.items():
        np.testing.assert_array_equal(by_processes.kept[name], kept)


def regroup(root: Path, rows_per_group: int) -> None:
    for path in data_files(root):
        pq.write_table(pq.read_table(path), path, row_group_size=rows_per_group)


@pytest.mark.parametrize("rows_per_group", [1, 7, 100, 10**6])
@pytest.mark.parametrize("numbers", [1, 12 * 50, 12 * 10**6])
def test_a_file_in_blocks_is_what_it_is_as_a_whole(rows_per_group, numbers, standin_copy, monkeypatch):
    dataset = z2r.load(standin_copy)
    whole, action = z2r.inspect_dataset(dataset, keep=200), dataset.read("action")
    regroup(standin_copy, rows_per_group)
    monkeypatch.setattr(parquet, "_BLOCK", numbers)
    found = z2r.inspect_dataset(dataset, keep=200)
    assert found.metrics("", None) == whole.metrics("", None)
    for name, ranges in whole.ranges.items():
        np.testing.assert_array_equal(found.ranges[name].low, ranges.low)
        np.testing.assert_array_equal(found.ranges[name].high, ranges.high)
        np.testing.assert_allclose(found.ranges[name].mean, ranges.mean, rtol=1e-12)
        np.testing.assert_array_equal(found.kept[name], whole.kept[name])
    np.testing.assert_array_equal(dataset.read("action"), action)
    np.testing.assert_array_equal(dataset.first(3).read("action"), action[: dataset.episodes.to_index[2]])


def test_a_fault_in_a_later_block_says_from_where_its_row_is_counted(standin_copy, monkeypatch):
    [path] = data_files(standin_copy)
    table = pq.read_table(path)
    state = to_numpy(table["observation.state"]).copy()
    state[130, 2] = np.nan
    place = table.column_names.index("observation.state")
    pq.write_table(table.set_column(place, "observation.state", to_arrow(state)), path, row_group_size=60)
    monkeypatch.setattr(parquet, "_BLOCK", 12 * 60)
    with pytest.raises(z2r.DatasetError, match="in row 10, counted from row 120 on"):
        z2r.inspect_dataset(z2r.load(standin_copy))


def test_a_block_is_all_that_is_read_at_a_time(standin_copy, monkeypatch):
    regroup(standin_copy, 10**6)
    monkeypatch.setattr(parquet, "_BLOCK", 12 * 50)
    sizes = map_files(z2r.load(standin_copy), ["observation.state", "action"], lambda _, frames: len(frames["action"]))
    assert max(sizes) == 50
    assert sum(sizes) == 427
