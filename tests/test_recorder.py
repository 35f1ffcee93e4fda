import shutil

import numpy as np
import pytest

import z2r
from z2r.pusht.simulator.env import PushTEnv
from z2r.reading.verdict import verdict_path


@pytest.fixture(scope="module")
def recording(tmp_path_factory):
    root = tmp_path_factory.mktemp("recorder") / "dataset"
    return root, z2r.record(root, seeds=[3, 4, 5], noise=0.1, max_steps=65)


def test_a_recording_is_a_dataset_with_a_frame_for_every_action(recording):
    root, verdict = recording
    dataset = z2r.load(root)
    assert dataset.episodes.lengths.tolist() == [episode.n_frames for episode in verdict.episodes]
    assert max(dataset.episodes.lengths) <= 65


def test_a_frame_is_the_observation_before_the_step_and_the_action_taken(recording):
    """The simulator, given the recorded actions, passes through the recorded observations to the verdict."""
    root, verdict = recording
    dataset = z2r.load(root)
    state, action = dataset.read("observation.state"), dataset.read("action")
    for number, told in enumerate(verdict.episodes):
        env = PushTEnv(max_steps=65)
        observation = env.reset(told.seed)
        for frame in range(*dataset.episodes[number].indices(len(state))):
            np.testing.assert_array_equal(state[frame], observation)
            observation = env.step(action[frame]).observation
        assert (env.success, env.steps) == (told.success, told.n_frames)
        assert told.details == pytest.approx({"pos_err": env.pos_err, "ang_err": env.ang_err})


def test_the_verdict_is_beside_the_dataset_and_not_in_it(recording):
    root, verdict = recording
    assert z2r.read_verdict(root) == verdict
    assert verdict_path(root).parent == root.parent
    assert "success" not in z2r.load(root).schema.features
    assert verdict.command == "z2r record dataset --episodes 3 --seed 3 --noise 0.1 --max-steps 65"
    assert {"mujoco", "lerobot", "python", "platform"} <= set(verdict.stack)


def test_nothing_else_is_left_beside_it(recording):
    root, _ = recording
    assert {path.name for path in root.parent.iterdir()} == {"dataset", "dataset.verdict.json"}


def test_an_out_that_exists_is_refused_and_left_alone(tmp_path):
    (tmp_path / "mine").mkdir()
    with pytest.raises(FileExistsError, match="mine"):
        z2r.record(tmp_path / "mine", seeds=[0])
    assert not list((tmp_path / "mine").iterdir())


def test_a_recording_that_fails_leaves_nothing(tmp_path):
    def interrupt(done, total):
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        z2r.record(tmp_path / "dataset", seeds=[0, 1], max_steps=3, progress=interrupt)
    assert not list(tmp_path.iterdir())


def test_a_recording_that_was_killed_leaves_nothing_that_reads_as_a_dataset(tmp_path):
    """Who is killed leaves what lies on the disk at that moment; `test_faults.py` kills processes, at every step."""
    (tmp_path / "running").mkdir()

    def look(done, total):
        if done == 12:  # metadata is flushed every ten episodes
            shutil.copytree(tmp_path / "running", tmp_path / "left")
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        z2r.record(tmp_path / "running/dataset", seeds=range(13), max_steps=5, progress=look)
    assert not (tmp_path / "left/dataset").exists()
    leftovers = [*(tmp_path / "left").rglob("meta")]
    assert leftovers
    for leftover in leftovers:
        with pytest.raises(z2r.DatasetError):
            z2r.load(leftover.parent)
