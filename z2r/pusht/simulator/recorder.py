"""Is my data any good? Record demonstrations of your own with the simulator.

The scripted expert drives, `LeRobotDataset` writes. A frame is the observation before a step and the action taken, as
a robot would record it; the recorder stops when the environment latches success, so the observation after the last
action is never stored.
"""

import contextlib
import importlib.metadata
import os
import platform
import warnings
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from z2r.arrays import Progress, no_progress
from z2r.errors import DatasetError, Fault, MissingExtraError
from z2r.format.schema import ACTION, STATE
from z2r.format.store import folder_for
from z2r.pusht.task import ACTION_LIMIT, ACTION_NAMES, CONTROL_HZ, DEMO_NOISE, MAX_STEPS, STATE_NAMES, TASK
from z2r.reading.verdict import Recording, Verdict, read_verdict, verdict_path, write_verdict

_STACK = ("z2r", "mujoco", "lerobot", "numpy")


def record(
    out: str | os.PathLike[str],
    seeds: Sequence[int],
    noise: float = DEMO_NOISE,
    max_steps: int = MAX_STEPS,
    progress: Progress = no_progress,
    *,
    replace: bool = False,
) -> Recording:
    """Record one episode for each seed as a LeRobot v3 dataset, and the simulator's verdict beside it.

    The dataset is written under a hidden name next to `out` and takes its own name when it is whole: a recording that
    was killed leaves nothing that looks like a dataset.

    Parameters
    ----------
    out : str or path
        The folder to make. The verdict goes to ``<out>.verdict.json``.
    seeds : sequence of int
        Seeds of the episodes, at least one.
    noise : float, optional
        Standard deviation of the Gaussian noise on each action [m/s], >= 0.
    max_steps : int, optional
        Control steps after which an episode times out, >= 1.
    progress : callable, optional
        Called with the number of episodes done and the number of all, after each episode.
    replace : bool, optional
        Take the place of an earlier recording, once this one is whole.

    Raises
    ------
    FileExistsError
        If `out` exists.
    DatasetError
        If `out` cannot be written; or with `replace`, if it is there and no recording with a verdict beside it.
    MissingExtraError
        If mujoco or lerobot is not installed.
    """
    out = Path(out).resolve()
    if out.exists():
        _check_may_go(out, replace=replace)
    _check_extras()
    from z2r.pusht.simulator.env import PushTEnv
    from z2r.pusht.simulator.expert import ScriptedExpert

    env, expert, verdicts = PushTEnv(max_steps), ScriptedExpert(), []
    with folder_for(out, verdict_path(out)) as folder:
        with new_dataset(folder / out.name) as dataset:
            for seed in seeds:
                verdicts.append(record_episode(dataset, env, expert, seed, noise))
                progress(len(verdicts), len(seeds))
        recording = Recording(_command(out, seeds, noise, max_steps), _stack(), verdicts)
        write_verdict(folder / out.name, recording)
    return recording


def record_episode(dataset: Any, env: Any, expert: Any, seed: int, noise: float) -> Verdict:
    """Drive one episode, and add it to a dataset.

    Parameters
    ----------
    dataset : LeRobotDataset
        Open for writing.
    env : PushTEnv
        The simulator.
    expert : ScriptedExpert
        What drives.
    seed : int
        Where the episode starts, and how its noise goes.
    noise : float
        Standard deviation of the Gaussian noise on each action [m/s], >= 0.
    """
    rng = np.random.default_rng([seed, 1])  # apart from the stream that the environment draws the start from
    observation = env.reset(seed)
    expert.reset()
    done = False
    while not done:
        shaky = expert(observation) + rng.normal(scale=noise, size=len(ACTION_NAMES))
        action = np.clip(shaky, -ACTION_LIMIT, ACTION_LIMIT).astype(np.float32)
        dataset.add_frame({STATE: observation, ACTION: action, "task": TASK})
        observation, done = (result := env.step(action)).observation, result.done
    dataset.save_episode()
    details = {"pos_err": round(env.pos_err, 9), "ang_err": round(env.ang_err, 9)}
    return Verdict(env.steps, env.success, seed, details)


def _check_may_go(out: Path, *, replace: bool) -> None:
    if not replace:
        raise FileExistsError(f"{out} exists: name a folder that does not, or remove it first")
    if read_verdict(out) is None:
        expected = f"nothing, or a recording with {verdict_path(out).name} beside it, which is replaced"
        raise DatasetError(Fault(out, "", "something else", expected, "Move it away, or name another --out"))


@contextlib.contextmanager
def new_dataset(root: Path) -> Iterator[Any]:
    """Lend an empty PushT dataset, to write episodes into; whole as soon as it is given back.

    Raises
    ------
    MissingExtraError
        If mujoco or lerobot is not installed.
    """
    _check_extras()
    from lerobot.datasets.lerobot_dataset import LeRobotDataset

    features = {
        STATE: {"dtype": "float32", "shape": (len(STATE_NAMES),), "names": list(STATE_NAMES)},
        ACTION: {"dtype": "float32", "shape": (len(ACTION_NAMES),), "names": list(ACTION_NAMES)},
    }
    with _no_progress_bars():
        dataset = LeRobotDataset.create(
            repo_id="z2r/pusht",
            root=root,
            fps=CONTROL_HZ,
            features=features,
            robot_type="pusht",
            use_videos=False,
            video_backend="pyav",  # unused, but unless one is named LeRobot probes for FFmpeg and prints what it lacks
        )
        try:
            yield dataset
        finally:
            dataset.finalize()  # in any case: LeRobot would do it later, and write into a folder that is gone


@contextlib.contextmanager
def _no_progress_bars() -> Iterator[None]:
    """Keep the `datasets` library from drawing one bar for each episode."""
    import datasets

    were_off = datasets.are_progress_bars_disabled()
    datasets.disable_progress_bars()
    try:
        yield
    finally:
        if not were_off:
            datasets.enable_progress_bars()


def _check_extras() -> None:
    try:
        with warnings.catch_warnings():
            warnings.filterwarnings("ignore", message="IProgress not found")  # of a bar that is not drawn either
            import lerobot.datasets.lerobot_dataset  # noqa: F401
            import mujoco  # noqa: F401
    except ModuleNotFoundError as error:
        raise MissingExtraError(
            f"recording needs {error.name}, which is not installed. In a clone of the course: pip install '.[record]'"
        ) from error


def _command(out: Path, seeds: Sequence[int], noise: float, max_steps: int) -> str:
    seeds = list(seeds)
    if seeds == list(range(seeds[0], seeds[0] + len(seeds))):
        options = f"--episodes {len(seeds)} --seed {seeds[0]} --noise {noise:g} --max-steps {max_steps}"
        return f"z2r record {out.name} {options}"
    call = f"z2r.record({out.name!r}, seeds={seeds}, noise={noise:g}, max_steps={max_steps})"
    return f'python -c "import z2r; {call}"'


def _stack() -> dict[str, str]:
    versions = {name: importlib.metadata.version(name) for name in _STACK}
    return {"python": platform.python_version(), "platform": f"{platform.system()} {platform.machine()}", **versions}
