"""What do people call? The functions of `z2r`, with the datasets, the reading and the scene that ship handed down.

What is below knows no task: it takes a reading and a scene as arguments. Here they are looked up.
"""

import os
from concurrent.futures import Executor
from difflib import get_close_matches
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING

from z2r.arrays import Progress, no_progress
from z2r.audits import audit as audits
from z2r.audits import beliefs, both
from z2r.audits.audit import Audit, all_checks
from z2r.audits.beliefs import Beliefs
from z2r.audits.explain import EXPLANATIONS, Explanation, read_explanations
from z2r.check import Check
from z2r.data import READINGS_DIR, find_dataset
from z2r.data.urls import place_of
from z2r.errors import DatasetError, Fault, one_error
from z2r.format.dataset import Dataset
from z2r.format.dataset import load as load_folder
from z2r.format.schema import Schema, read_schema
from z2r.pusht.scene import EXPLANATIONS as PUSHT_EXPLANATIONS
from z2r.pusht.scene import SCENE
from z2r.pusht.world import PUSHT
from z2r.reading import inspection as inspections
from z2r.reading.action import DrivenColumn
from z2r.reading.breaks import BreakMode
from z2r.reading.inspection import Inspection, beginning
from z2r.reading.reading import Reading, read_reading
from z2r.reading.scene import Scene
from z2r.show import report as reports
from z2r.show.report import Panel, Report

if TYPE_CHECKING:  # rerun need not be installed to read
    from z2r.show.replay import Replay

MAX_REPLAY_FRAMES = 20_000  # half an hour at 10 Hz: more than anybody scrubs through

SCENES: dict[str, Scene] = {SCENE.name: SCENE}

ALL_CHECKS: tuple[Check, ...] = all_checks(SCENE)
"""All that is asked of a dataset, in the order in which findings come."""

CHECKS: dict[str, str] = {check.name: check.asks for check in ALL_CHECKS}
"""What each check asks, by its name, in the order in which findings come. The names are stable."""


def explain(check: str) -> Explanation:
    """Say why a check is there, where it would have helped, and how to mend what it finds.

    Raises
    ------
    ValueError
        If there is no check of that name.
    """
    if check not in CHECKS:
        near = get_close_matches(check, CHECKS, n=1)
        raise ValueError(
            f"found no check {check!r}"
            + (f": did you mean {near[0]}?" if near else ", expected one of those in CHECKS")
        )
    return {**read_explanations(EXPLANATIONS), **read_explanations(PUSHT_EXPLANATIONS)}[check]


def scene_of(reading: Reading | None) -> Scene | None:
    """Return the scene that a reading names; None where it names none.

    Raises
    ------
    ValueError
        If there is none of that name, or the reading lacks a pose that the scene needs.
    """
    if reading is None or reading.scene is None:
        return None
    if wrong := _wrong_scene(reading):
        raise ValueError("found {}, expected {}".format(*wrong))
    return SCENES[reading.scene]


def _wrong_scene(reading: Reading) -> tuple[str, str] | None:
    """Return what was found and what was expected of the scene that a reading names; None where nothing is wrong."""
    if reading.scene is None:
        return None
    if reading.scene not in SCENES:
        return f"scene {reading.scene!r}", f"one of {', '.join(SCENES)}"
    lacking = [name for name in SCENES[reading.scene].bodies if name not in reading.poses]
    return (f"no pose {', '.join(lacking)}", f"it: the scene {reading.scene} has that body") if lacking else None


_ROBOTS = ("lerobot_pusht", "so101", "koch", "aloha")  # the first that fits is taken


@cache
def shipped_readings() -> dict[str, Reading]:
    """Return the readings that ship, by their names: that of the shipped datasets, and those of robots people have."""
    others = (read_reading(READINGS_DIR / f"{name}.toml") for name in _ROBOTS)
    return {reading.name: reading for reading in (PUSHT, *others)}


def find_reading(name: str | os.PathLike[str]) -> Reading:
    """Return a reading that ships, by its name, or the one in a file.

    Raises
    ------
    DatasetError
        If there is neither, or the file holds no reading.
    """
    shipped, path = shipped_readings(), Path(name)
    if not path.exists() and os.fspath(name) in shipped:
        return shipped[os.fspath(name)]
    if not path.exists():
        near = get_close_matches(os.fspath(name), shipped, n=1)
        expected = f"a reading file, or one of those that ship: {', '.join(shipped)}"
        raise DatasetError(Fault(path, "", "no such file", expected, f"Did you mean {near[0]}?" if near else ""))
    reading = read_reading(path)
    if wrong := _wrong_scene(reading):
        raise DatasetError(Fault(path, "scene", *wrong))
    return reading


def choose_reading(schema: Schema) -> Reading | None:
    """Return the reading that ships and fits, of several that of this robot; else one that nearly fits, as misspelt."""
    readings = [reading for reading in shipped_readings().values() if reading.names]
    fitting = [reading for reading in readings if not reading.missing(schema)]
    robot = schema.robot_type if isinstance(schema.robot_type, str) else ""
    of_this_robot = (reading for reading in fitting if reading.name in robot)
    nearly = (reading for reading in readings if len(reading.missing(schema)) < len(reading.names) / 2)
    return next(of_this_robot, None) or next(iter(fitting), None) or next(nearly, None)


def reading_for(root: Path) -> Reading | None:
    """Choose a reading for a folder; none where its schema cannot be read, which the audit will say."""
    try:
        return choose_reading(read_schema(root))
    except DatasetError:
        return None


@one_error()
def load(dataset: str | os.PathLike[str]) -> Dataset:
    """Read the two structural facts of a LeRobot v3 dataset; its frames are read when asked for.

    Parameters
    ----------
    dataset : str or path
        The folder that holds ``meta/`` and ``data/``; the name of a dataset that ships, such as ``standin``; one of the
        hub, such as ``lerobot/pusht``, that was downloaded before; or a URL such as ``s3://bucket/dataset``: nothing
        else is fetched.

    Raises
    ------
    DatasetError
        If it is no whole LeRobot v3 dataset.

    Examples
    --------
    >>> import z2r
    >>> z2r.load("standin")
    Dataset(standin: 6 episodes, 427 frames)
    """
    return load_folder(find_dataset(dataset))


@one_error()
def inspect_dataset(
    dataset: Dataset | str | os.PathLike[str],
    mode: BreakMode | None = None,
    reading: Reading | None = None,
    progress: Progress = no_progress,
    keep: int = 0,
    executor: Executor | None = None,
) -> Inspection:
    """Read every frame of a dataset once, and sum it up.

    Parameters
    ----------
    dataset : Dataset, str or path
        From `z2r.load`, or what that takes.
    mode : BreakMode, optional
        Get one assumption wrong on purpose.
    reading : Reading, optional
        What the columns mean; the one that ships and fits, unless given.
    progress : callable, optional
        Called with the number of frames done and the number of all, after each data file.
    keep : int, optional
        Keep as many of the first frames, those of whole episodes, for who wants to draw them.
    executor : Executor, optional
        What runs the fold over the data files; threads unless given.

    Raises
    ------
    DatasetError
        If a data file is missing, damaged, or not what the schema and the index say.

    Examples
    --------
    >>> import z2r
    >>> z2r.inspect_dataset("standin")
    Inspection(6 episodes, reached 6 of 6)
    """
    dataset = _loaded(dataset)
    reading = reading or choose_reading(dataset.schema)
    return inspections.inspect_dataset(dataset, mode, reading, progress, keep, executor)


@one_error()
def audit(
    dataset: Dataset | str | os.PathLike[str],
    mode: BreakMode | None = None,
    reading: Reading | None = None,
    progress: Progress = no_progress,
    executor: Executor | None = None,
    *,
    pictures: bool = False,
    meta_only: bool = False,
) -> Audit:
    """Look for everything that can be wrong with a dataset, in one pass over its files.

    Parameters
    ----------
    dataset : Dataset, str or path
        The folder, or a dataset from it. It is not written to; outside of it, only a verdict beside it is read.
    mode : BreakMode, optional
        Audit what somebody believes who gets this assumption wrong. The dataset must be whole.
    reading : Reading, optional
        What the columns mean; the one that ships and fits, unless given. The scene that it names adds its checks.
    progress : callable, optional
        Called with the number of data files done and the number of all, after each; then, with `pictures`, with that of
        the episodes of each camera.
    executor : Executor, optional
        What runs the pass over the data files; threads unless given.
    pictures : bool, optional
        Decode some pictures of every episode and look at them. Needs the extra ``video``.
    meta_only : bool, optional
        Read no frame: only metadata, the footers of data files and the indices of videos, for a verdict before a
        download. Goes with neither `mode` nor `pictures`.

    Raises
    ------
    DatasetError
        Only with a `mode`: if the dataset is not whole.
    ValueError
        Where `meta_only` is asked for what it does not go with.
    MissingExtraError
        Only with `pictures`: if PyAV is not installed.

    Examples
    --------
    >>> import z2r
    >>> audit = z2r.audit("standin")
    >>> audit.exit_code, [(finding.severity, finding.check) for finding in audit.findings]
    (0, [('note', 'constant'), ('note', 'chunk')])
    >>> audit.kept
    (0, 1, 2, 3, 4, 5)
    >>> wrong = z2r.audit("standin", z2r.break_mode("yaw-swap-everywhere"))
    >>> [finding.check for finding in wrong.findings if finding.severity == "error"]
    ['overlap']
    """
    if meta_only and (mode or pictures):
        raise ValueError("meta_only reads no frame: it goes with neither a break mode nor pictures")
    root = dataset.root if isinstance(dataset, Dataset) else _folder(dataset)
    reading = reading or reading_for(root)
    return audits.audit(
        root, mode, reading, scene_of(reading), progress, executor, pictures=pictures, meta_only=meta_only
    )


@one_error()
def audit_beliefs(
    dataset: Dataset | str | os.PathLike[str],
    reading: Reading | None = None,
    progress: Progress = no_progress,
    executor: Executor | None = None,
) -> Beliefs:
    """Say which wrong beliefs a dataset refutes, and by which check: audit it as it is, and under every break mode.

    Parameters
    ----------
    dataset : Dataset, str or path
        As for `audit`. It must be whole.
    reading : Reading, optional
        What the columns mean; the one that ships and fits, unless given.
    progress : callable, optional
        Called with the number of audits done and the number of all, after each.
    executor : Executor, optional
        What runs each pass over the data files; threads unless given.

    Raises
    ------
    DatasetError
        If the dataset is not whole.

    Examples
    --------
    >>> import z2r
    >>> beliefs = {belief.mode: belief for belief in z2r.audit_beliefs("standin").beliefs}
    >>> [beliefs[mode].verdict for mode in ("joints-exchanged", "no-wrap", "gripper-inverted")]
    ['refuted', 'not refuted', 'does not apply']
    """
    root = dataset.root if isinstance(dataset, Dataset) else find_dataset(dataset)
    reading = reading or reading_for(root)
    return beliefs.audit_beliefs(root, reading, scene_of(reading), progress, executor)


@one_error()
def write_replay(
    dataset: Dataset | str | os.PathLike[str],
    path: str | os.PathLike[str],
    reading: Reading | None = None,
    max_frames: int = MAX_REPLAY_FRAMES,
    episode: int | None = None,
) -> "Replay":
    """Write the first episodes of a dataset, or one of them, into a rerun recording (.rrd). Needs the extra ``view``.

    It shows the cameras as their pictures lie on disk, never decoded, the numbers, the tasks, and what the reading
    makes of them: a world, and how far the goals are.

    Parameters
    ----------
    dataset : Dataset, str or path
        From `z2r.load`, or what that takes; or what a break mode makes of it.
    path : str or path
        The .rrd file to write. One that is there is replaced.
    reading : Reading, optional
        What the columns mean; the one that ships and fits, unless given.
    max_frames : int, optional
        Show whole episodes up to this many frames; of a longer first episode, its beginning.
    episode : int, optional
        The `episode_index` of the one to show.

    Returns
    -------
    Replay
        How much it shows, and in `left_out` which pictures it does not, and why: a video may be missing.

    Raises
    ------
    DatasetError
        If a data file is missing, damaged, or not what the schema and the index say; or if `path` is in the dataset,
        which is never written to, or cannot be written.
    ValueError
        If there is no such episode.
    """
    from z2r.show import replay

    dataset = _loaded(dataset)
    if episode is None:
        dataset = dataset.first(len(beginning(dataset.episodes, max_frames)))
    reading = reading or choose_reading(dataset.schema)
    inspection = inspections.inspect_dataset(dataset, None, reading, keep=max_frames, episode=episode)
    return replay.write_replay(inspection, Path(path), scene_of(inspection.reading))


@one_error()
def write_report(
    dataset: Dataset | str | os.PathLike[str],
    path: str | os.PathLike[str],
    reading: Reading | None = None,
    progress: Progress = no_progress,
    executor: Executor | None = None,
    *,
    with_audit: bool = True,
) -> Report:
    """Write a page that shows a dataset.

    Parameters
    ----------
    dataset : Dataset, str or path
        From `z2r.load`, or what that takes.
    path : str or path
        The .html file to write. One that is there is replaced; folders that are missing are made.
    reading : Reading, optional
        What the columns mean; the one that ships and fits, unless given.
    progress : callable, optional
        Called with the number of frames done and the number of all, after each data file.
    executor : Executor, optional
        What runs the pass over the data files; threads unless given.
    with_audit : bool, optional
        Audit the dataset too, in the same pass over its files, and show what was found.

    Raises
    ------
    DatasetError
        If a data file is missing, damaged, or not what the schema and the index say; or if `path` is in the dataset,
        which is never written to, or cannot be written.
    """
    dataset = _loaded(dataset)
    reading = reading or choose_reading(dataset.schema)
    keep = reports.n_frames_in_report(dataset.schema, reading)
    if not with_audit:
        inspection = inspect_dataset(dataset, reading=reading, progress=progress, keep=keep, executor=executor)
        return reports.write_report(inspection, path, scene_of(inspection.reading))
    inspection, found = both.inspect_and_audit(dataset, reading, scene_of(reading), progress, keep, executor)
    return reports.write_report(inspection, path, scene_of(inspection.reading), found)


@one_error()
def panel(dataset: Dataset | str | os.PathLike[str], reading: Reading | None = None) -> Panel:
    """Show a dataset in a notebook, as `write_report` shows it: put the call last in a cell.

    Parameters
    ----------
    dataset : Dataset, str or path
        From `z2r.load`, or what that takes.
    reading : Reading, optional
        What the columns mean; the one that ships and fits, unless given.

    Raises
    ------
    DatasetError
        If a data file is missing, damaged, or not what the schema and the index say.

    Examples
    --------
    >>> import z2r
    >>> z2r.panel("standin")
    Panel: standin, episodes: 6, frames: 427, reached the target: 6 of 6 (reconstructed)
    """
    dataset = _loaded(dataset)
    reading = reading or choose_reading(dataset.schema)
    keep = reports.n_frames_in_panel(dataset.schema, reading)
    inspection = inspect_dataset(dataset, reading=reading, keep=keep)
    return reports.panel(inspection, scene_of(inspection.reading))


@one_error()
def infer_action(dataset: Dataset | str | os.PathLike[str], reading: Reading | None = None) -> tuple[DrivenColumn, ...]:
    """Say of every dimension of the action what it is, from the data alone.

    Parameters
    ----------
    dataset : Dataset, str or path
        From `z2r.load`, or what that takes.
    reading : Reading, optional
        Says the units of the action, for the words of the evidence; the one that ships and fits, unless given.

    Raises
    ------
    DatasetError
        If a data file is missing, damaged, or not what the schema and the index say.

    Examples
    --------
    >>> import z2r
    >>> print(z2r.infer_action("standin")[0])
    pusher_vx: the velocity of pusher_x, 1 frame ahead, within 0.013 m/s in 99 % of frames
    """
    return inspect_dataset(dataset, reading=reading).action


def _folder(dataset: str | os.PathLike[str]) -> Path:
    """Return the folder that is meant; where there is none, that is the audit's first finding."""
    try:
        return find_dataset(dataset)
    except DatasetError:
        return place_of(dataset)


def _loaded(dataset: Dataset | str | os.PathLike[str]) -> Dataset:
    return dataset if isinstance(dataset, Dataset) else load(dataset)
