"""What is said before training: what wrong statistics do, what a policy would learn that nobody meant, what to keep."""

import json
import re
import shlex
import sys
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow.parquet as pq
import pytest
from damages import (
    BASES,
    STATE,
    add_feature,
    change_values,
    declare_video,
    edit_column,
    edit_info,
    edit_stats,
    in_one,
    make,
    put,
    read_json,
    rename_feature,
    reorder,
    set_at,
    wait_in,
    wrong_in,
)
from hypothesis import given
from hypothesis import strategies as st
from layouts import DATA_PATH, STATS_PATH, data_files, lay_out, read_dataset
from test_audit import forget_names, run

import z2r
from z2r.audits import edit
from z2r.audits.findings import Finding
from z2r.audits.readiness import CHUNKS, standstill

N_EPISODES = 14  # of `split`, whose second data file holds episodes 3 to 6
SECOND_FILE = DATA_PATH.format(chunk_index=0, file_index=1)

type Do = Callable[[Path], object]


def found(root: Path, check: str) -> list[Finding]:
    return [finding for finding in z2r.audit(root).findings if finding.check == check]


def one(root: Path, check: str) -> Finding:
    [finding] = found(root, check)
    return finding


@pytest.fixture
def split(tmp_path: Path) -> Path:
    BASES["split"](tmp_path / "dataset")
    return tmp_path / "dataset"


# --- which episodes have no error


def without(*episodes: int) -> tuple[int, ...]:
    return tuple(number for number in range(N_EPISODES) if number not in episodes)


@pytest.mark.parametrize(
    ("column", "change"),
    [
        ("timestamp", set_at(7, 99.0)),
        ("timestamp", set_at(7, None)),
        ("frame_index", set_at(7, 99)),
        ("task_index", set_at(7, 3)),
        ("index", set_at(7, 3)),
        (STATE, put(float("nan"), 7, 2)),
        (STATE, put(None, 7, 2)),
        (STATE, put(0.9, 7, 4)),  # a sine whose cosine is another one's
        ("action", set_at(7, None)),
    ],
)
def test_an_error_in_a_row_keeps_its_episode_out(column, change, split):
    edit_column(split, SECOND_FILE, column, change)
    audit = z2r.audit(split)
    assert audit.kept == without(3)
    assert not audit.of_all


@pytest.mark.parametrize(
    "spoil",
    [
        Path.unlink,
        lambda path: path.write_bytes(b""),
        lambda path: pq.write_table(pq.read_table(path).drop_columns("action"), path),
    ],
)
def test_an_error_of_a_file_keeps_all_of_its_episodes_out(spoil, split):
    spoil(split / SECOND_FILE)
    assert z2r.audit(split).kept == without(3, 4, 5, 6)


def test_a_video_that_is_missing_keeps_its_episodes_out(split):
    declare_video(split)
    shard = "meta/episodes/chunk-000/file-001.parquet"  # of episodes 5 to 10
    edit_column(split, shard, "videos/observation.images.top/file_index", set_at(2, 1))
    missing = [each for each in z2r.audit(split).findings if each.check == "video-file"]
    assert sorted(each.episodes for each in missing) == [without(7), (7,)]
    assert not z2r.audit(split).kept


def test_errors_of_many_files_keep_all_of_their_episodes_out(tmp_path):
    """Also those that are left out of the findings, which are too many to be shown."""
    lay_out(tmp_path / "dataset", [3] * N_EPISODES, files=[1] * N_EPISODES, shards=[N_EPISODES])
    forget_names(tmp_path / "dataset")
    wrong = range(1, N_EPISODES, 2)
    for number in wrong:
        edit_column(
            tmp_path / "dataset", str(data_files(tmp_path / "dataset")[number]), "index", lambda v: [9] * len(v)
        )
    audit = z2r.audit(tmp_path / "dataset")
    assert audit.more
    assert audit.kept == without(*wrong)


def test_an_error_about_the_dataset_keeps_nothing_out_and_says_so(split):
    edit_info(split, total_frames=3, splits={"train": "0:99"})
    audit = z2r.audit(split)
    assert audit.kept == without()
    assert audit.of_all == ("totals", "splits")


def test_a_warning_keeps_nothing_out(tmp_path):
    BASES["messy"](tmp_path / "dataset")
    reorder(lambda episodes: [*episodes, episodes[0]])(tmp_path / "dataset")
    audit = z2r.audit(tmp_path / "dataset")
    assert [(finding.check, finding.episodes) for finding in wrong_in(audit)] == [("twin", (N_EPISODES,))]
    assert audit.kept == (*without(), N_EPISODES)


def test_of_what_cannot_be_read_nothing_is_kept(tmp_path):
    make("info missing", tmp_path / "dataset")
    assert z2r.audit(tmp_path / "dataset").kept == ()


def test_the_command_writes_what_lerobot_takes(split, tmp_path):
    import draccus
    from lerobot.configs.default import DatasetConfig
    from lerobot.datasets.lerobot_dataset import LeRobotDataset

    edit_column(split, SECOND_FILE, "timestamp", set_at(7, 99.0))
    edit_info(split, splits={"train": "0:99"})
    result = run(split, "--keep", "new/good.json", cwd=tmp_path)
    assert result.returncode == 1
    assert "wrote new/good.json: 13 of 14 episodes" in result.stdout
    assert "keep none out: splits" in result.stdout
    written = (tmp_path / "new/good.json").read_text()
    wanted = draccus.parse(DatasetConfig, args=["--repo_id=test/test", f"--episodes={written}"])
    dataset = LeRobotDataset("test/test", root=split, episodes=wanted.episodes, video_backend="pyav")
    assert {int(number) for number in dataset.hf_dataset["episode_index"]} == {*without(3)}


def test_the_command_says_so_where_there_is_nothing_to_write(tmp_path):
    make("info missing", tmp_path / "dataset")
    result = run(tmp_path / "dataset", "--keep", "good.json", "--json", cwd=tmp_path)
    assert result.returncode == 3
    assert not (tmp_path / "good.json").exists()
    assert json.loads(result.stdout)["exit_code"] == 3
    result = run(tmp_path / "dataset", "--keep", "good.json", cwd=tmp_path)
    assert "did not write good.json" in result.stdout


def test_the_command_never_writes_into_the_dataset(standin_copy, tmp_path):
    result = run(standin_copy, "--keep", standin_copy / "meta/good.json", cwd=tmp_path)
    assert result.returncode == 2
    assert "which is never written to. Name another" in re.sub(r"[\s│]+", " ", result.stderr)
    assert not (standin_copy / "meta/good.json").exists()


# --- what wrong statistics do


def seen_by_a_policy(root: Path, name: str, how: str) -> np.ndarray:
    """Scale a feature as LeRobot does."""
    import torch
    from lerobot.configs import FeatureType, NormalizationMode, PolicyFeature
    from lerobot.lerobot_types import TransitionKey
    from lerobot.processor import NormalizerProcessorStep

    values = torch.from_numpy(read_dataset(root)[0][name].copy())
    kind = FeatureType.ACTION if name == "action" else FeatureType.STATE
    features = {name: PolicyFeature(kind, values.shape[1:])}
    step = NormalizerProcessorStep(features, {kind: NormalizationMode(how)}, read_json(root, STATS_PATH))
    if name == "action":
        return step({TransitionKey.ACTION: values})[TransitionKey.ACTION].numpy()
    return step({TransitionKey.OBSERVATION: {name: values}})[TransitionKey.OBSERVATION][name].numpy()


def of_one(place: int, change: Callable[[float], float]) -> Callable[[np.ndarray], np.ndarray]:
    return lambda values: np.where(np.arange(len(values)) == place, change(values[place]), values)


@pytest.mark.parametrize(
    ("times", "severity", "says"),
    [
        (8.1, "warning", "too small"),
        (1 / 3, "warning", "too large"),
        (1.05, "note", "too small"),
        (0, "error", "large"),
    ],
)
def test_a_wrong_std_is_said_as_a_policy_sees_it(times, severity, says, standin_copy):
    edit_stats(standin_copy, STATE, "std", of_one(1, lambda value: value * times))
    finding = one(standin_copy, "stats")
    assert (finding.severity, finding.field) == (severity, f"{STATE}.std[pusher_y]")
    seen = seen_by_a_policy(standin_copy, STATE, "MEAN_STD")[:, 1].std()
    factor = float(re.search(r"(\S+) times too", finding.mend)[1])
    assert factor == pytest.approx(max(seen, 1 / seen), rel=1e-2)
    assert says in finding.mend


@pytest.mark.parametrize(("by", "severity"), [(0.5, "warning"), (0.01, "note"), (100, "error")])
def test_a_wrong_mean_is_said_as_a_policy_sees_it(by, severity, standin_copy):
    edit_stats(standin_copy, "action", "mean", of_one(0, lambda value: value + by))
    finding = one(standin_copy, "stats")
    shift = float(re.search(r"shifted by (\S+) std", finding.mend)[1])
    assert shift == pytest.approx(-seen_by_a_policy(standin_copy, "action", "MEAN_STD")[:, 0].mean(), rel=1e-2)
    assert finding.severity == severity


@pytest.mark.parametrize(
    ("kind", "by", "severity"), [("max", 10, "warning"), ("min", -0.5, "warning"), ("max", 0.01, "note")]
)
def test_a_wrong_range_is_said_as_a_policy_sees_it(kind, by, severity, standin_copy):
    edit_stats(standin_copy, "action", kind, of_one(0, lambda value: value + by))
    finding = one(standin_copy, "stats")
    said = [float(end) for end in re.search(r"from (\S+) to (\S+),", finding.mend).groups()]
    seen = seen_by_a_policy(standin_copy, "action", "MIN_MAX")[:, 0]
    assert said == pytest.approx([seen.min(), seen.max()], abs=1e-2)
    assert finding.severity == severity


def forget_a_quantile(root: Path) -> None:
    stored = read_json(root, STATS_PATH)
    del stored["action"]["q01"]
    (root / STATS_PATH).write_text(json.dumps(stored))


def test_statistics_without_the_quantiles_by_which_a_policy_scales_are_a_note(standin_copy):
    seen_by_a_policy(standin_copy, "action", "QUANTILES")
    assert not found(standin_copy, "stats")
    forget_a_quantile(standin_copy)
    with pytest.raises(ValueError, match="requires q01 and q99"):
        seen_by_a_policy(standin_copy, "action", "QUANTILES")
    finding = one(standin_copy, "stats")
    assert (finding.severity, finding.field) == ("note", "action")
    assert "no q01 and q99" in finding.found


def test_a_range_of_nothing_is_an_error(standin_copy):
    for kind in ("min", "max"):
        edit_stats(standin_copy, "action", kind, of_one(0, lambda _: 0.1))
    assert {finding.severity for finding in found(standin_copy, "stats")} == {"error"}
    assert np.abs(seen_by_a_policy(standin_copy, "action", "MIN_MAX")[:, 0]).max() > 1e6


def test_where_nothing_moves_a_std_does_no_harm_and_a_mean_does(standin_copy):
    edit_stats(standin_copy, STATE, "std", of_one(6, lambda _: 0.2))
    assert one(standin_copy, "stats").severity == "note"
    assert not seen_by_a_policy(standin_copy, STATE, "MEAN_STD")[:, 6].any()
    edit_stats(standin_copy, STATE, "std", of_one(6, lambda _: 0))
    edit_stats(standin_copy, STATE, "mean", of_one(6, lambda _: 0.2))
    assert one(standin_copy, "stats").severity == "error"


def test_what_lerobot_itself_rounds_is_told_where_a_policy_sees_it_in_another_size(tmp_path):
    """It sums up in float32: far from 0, a step is lost, and to compute it again does not help."""
    from lerobot.datasets.lerobot_dataset import LeRobotDataset

    feature = {"dtype": "float32", "shape": (2,), "names": ["near", "far"]}
    where = {"repo_id": "test/test", "root": tmp_path / "dataset", "video_backend": "pyav"}
    dataset = LeRobotDataset.create(**where, fps=30, features={STATE: feature, "action": feature}, use_videos=False)
    for length in (140, 150):
        for moved in 10 * np.sin(np.arange(length) / 10):
            values = np.array([moved, 1.7e5 + moved], dtype=np.float32)
            dataset.add_frame({STATE: values, "action": values, "task": "push it"})
        dataset.save_episode()
    dataset.finalize()
    for finding in (findings := found(tmp_path / "dataset", "stats")):
        assert finding.field.endswith("std[far]")
        assert "too coarse" in finding.mend
        factor = float(re.search(r"(\S+) times too small", finding.mend)[1])
        seen = seen_by_a_policy(tmp_path / "dataset", finding.field.removesuffix(".std[far]"), "MEAN_STD")
        assert 1 / factor == pytest.approx(seen[:, 1].astype(float).std(), rel=1e-2)
    assert len(findings) == 2


def test_the_worst_of_a_check_comes_first(standin_copy):
    """So that a note about the number of frames hides no std of zero."""
    names = [f"next.{letter}" for letter in "abcde"]
    for name in names:
        add_feature(standin_copy, name, 0.5)
    for name in names:
        edit_stats(standin_copy, name, "mean", lambda values: values + 1)
    edit_stats(standin_copy, "action", "std", lambda values: values * 2)
    findings = found(standin_copy, "stats")
    assert [finding.severity for finding in findings] == ["warning", *["note"] * 4]
    assert "No policy scales by it" in findings[1].mend


# --- the lines that mend it


def obey(line: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Do what a line says, in this process: another one would import torch again."""
    from lerobot.scripts.lerobot_edit_dataset import edit_dataset

    monkeypatch.setattr(sys, "argv", shlex.split(line))
    edit_dataset()


def line_of(finding: Finding) -> str:
    return edit.PROGRAM + finding.mend.partition(edit.PROGRAM)[2]


@pytest.mark.parametrize(
    ("base", "spoil", "check"),
    [
        ("standin", lambda root: edit_stats(root, STATE, "std", lambda values: values * 8), "stats"),
        ("standin", forget_a_quantile, "stats"),
        ("messy", in_one(3, lambda n: range(3)), "short-episode"),
        ("standin", lambda root: add_feature(root, "observation.light", 0.5), "constant"),
    ],
    ids=["recompute_stats", "recompute_quantiles", "delete_episodes", "remove_feature"],
)
def test_a_line_that_is_printed_runs_and_mends(base, spoil, check, tmp_path, monkeypatch):
    root = tmp_path / "it's a dataset"
    BASES[base](root)
    spoil(root)
    [finding] = [finding for finding in found(root, check) if edit.PROGRAM in finding.mend]
    obey(line_of(finding), monkeypatch)
    mended = root.with_name(f"{root.name}-edited")
    assert not wrong_in(z2r.audit(mended))
    assert not [finding for finding in found(mended, check) if edit.PROGRAM in finding.mend]
    assert found(root, check)  # the original is as it was


def test_a_line_is_printed_so_that_it_can_be_copied(standin_copy, tmp_path):
    edit_stats(standin_copy, STATE, "std", lambda values: values * 8)
    assert line_of(one(standin_copy, "stats")) in run(standin_copy, cwd=tmp_path).stdout.splitlines()


def test_a_line_is_no_longer_than_anybody_reads():
    assert "\n" not in edit.delete_episodes(Path("d"), range(10**5))
    assert len(edit.delete_episodes(Path("d"), range(10**5))) < 100
    assert len(edit.remove_feature(Path("d"), "x" * 10**6)) < 100


# --- what a policy wants of a dataset


@pytest.mark.parametrize(
    ("old", "new", "wanted"), [("action", "actions", "an action"), (STATE, "state", "observation.state")]
)
def test_a_feature_of_another_name_is_no_use_to_a_policy(old, new, wanted, standin_copy):
    rename_feature(standin_copy, old, new)
    finding = one(standin_copy, "policy-features")
    assert finding.severity == "warning"
    assert new in finding.found
    assert wanted in finding.expected


def test_pictures_are_something_observed(standin_copy):
    rename_feature(standin_copy, STATE, "state")
    declare_video(standin_copy)
    assert not found(standin_copy, "policy-features")


def test_a_dimension_that_never_changes_is_a_note(standin_copy):
    finding = one(standin_copy, "constant")
    assert (finding.severity, finding.field) == ("note", STATE)
    assert finding.found.startswith("target_x, target_y, sin_target_yaw, cos_target_yaw: the same")
    change_values(["target_x"], lambda values: values + 1e-3, [2])(standin_copy)
    assert one(standin_copy, "constant").found.startswith("target_y, sin")


def test_an_action_that_never_changes_is_one_that_a_policy_always_takes(standin_copy):
    change_values(["pusher_vx"], lambda values: values * 0 + 0.1)(standin_copy)
    [finding] = [finding for finding in found(standin_copy, "constant") if finding.field == "action"]
    assert finding.found == "pusher_vx: the same in all 427 frames"
    assert "always" in finding.mend


@given(
    lengths=st.lists(st.integers(1, 8), min_size=1, max_size=5),
    moves=st.lists(st.booleans(), min_size=40, max_size=40),
)
def test_a_standstill_is_counted_from_both_ends(lengths, moves):
    n = sum(lengths)
    values = np.cumsum(moves[:n], dtype=np.float32)[:, None]
    starts = np.cumsum(lengths) - lengths
    counted = []
    for start, length in zip(starts.tolist(), lengths, strict=True):
        rows = values[start : start + length, 0].tolist()
        counted.append((rows.count(rows[0]), rows.count(rows[-1])))  # it only ever rises
    idle = standstill([values, np.zeros((n, 2))], [np.array([0.5]), np.zeros(2)], starts)
    assert idle.tolist() == [list(ends) for ends in counted]


def test_jitter_is_no_motion_and_a_slow_start_is():
    rng = np.random.default_rng(0)
    moving = np.concatenate([np.zeros(50), np.linspace(0, 100, 100), np.full(30, 100.0)])
    values = moving + rng.normal(0, 0.1, len(moving))
    [[head, tail]] = standstill([values[:, None]], [np.array([0.05 * values.std()])], np.array([0]))
    assert 50 <= head <= 55
    assert 30 <= tail <= 35


@pytest.mark.parametrize(("before", "after", "n"), [(19, 0, 0), (40, 0, 1), (0, 40, 1), (40, 40, 2)])
def test_a_long_standstill_is_a_note_about_its_episode(before, after, n, tmp_path):
    BASES["messy"](tmp_path / "dataset")
    wait_in(3, before, after)(tmp_path / "dataset")
    findings = found(tmp_path / "dataset", "idle")
    assert [(finding.severity, finding.episodes) for finding in findings] == [("note", (3,))] * bool(n)
    assert sum(finding.found.count("episode 3") for finding in findings) == n
    assert z2r.audit(tmp_path / "dataset").exit_code == 0


def test_episodes_that_are_cut_off_as_they_began_are_a_note(tmp_path):
    BASES["messy"](tmp_path / "dataset")
    assert not found(tmp_path / "dataset", "short-episode")
    in_one(3, lambda n: range(5))(tmp_path / "dataset")
    in_one(4, lambda n: range(2))(tmp_path / "dataset")
    finding = one(tmp_path / "dataset", "short-episode")
    assert (finding.severity, finding.episodes) == ("note", (3, 4))
    assert "the shortest of 2 frames" in finding.found


def test_chunks_are_those_of_lerobot():
    from lerobot.policies.act.configuration_act import ACTConfig
    from lerobot.policies.diffusion.configuration_diffusion import DiffusionConfig
    from lerobot.policies.pi0.configuration_pi0 import PI0Config
    from lerobot.policies.smolvla.configuration_smolvla import SmolVLAConfig

    assert {
        "ACT": ACTConfig().chunk_size,
        "Diffusion": DiffusionConfig().horizon,
        "SmolVLA and π0": SmolVLAConfig().chunk_size,
    } == CHUNKS
    assert PI0Config().chunk_size == SmolVLAConfig().chunk_size


@pytest.mark.parametrize(
    ("lengths", "says"),
    [
        ([100, 120], None),
        ([99, 120], "1 shorter than 100 frames, a chunk of ACT"),
        ([63, 64], "2 shorter than 100 frames, a chunk of ACT; 1 shorter than 64 frames, a chunk of Diffusion"),
    ],
)
def test_episodes_shorter_than_a_chunk_are_counted(lengths, says, tmp_path):
    lay_out(tmp_path / "dataset", lengths, files=[2], shards=[2])
    forget_names(tmp_path / "dataset")
    findings = found(tmp_path / "dataset", "chunk")
    assert [finding.found for finding in findings] == ([says] if says else [])
    assert all(("beyond 64 frames" in finding.mend) == (max(lengths) == 64) for finding in findings)
