"""Which datasets are there? Those that ship, those in a folder, and those in the caches, by their schema alone.

Nothing else of them is read, so that a list of many is there at once; whether one is whole, `z2r audit` says.
"""

from collections.abc import Iterator
from pathlib import Path

import msgspec

from z2r.data import SHIPPED
from z2r.data.caches import in_caches, in_folder
from z2r.errors import DatasetError
from z2r.format.about import cameras_of, robot_of
from z2r.format.schema import read_schema


class Listed(msgspec.Struct, frozen=True):
    """One dataset that is there.

    Attributes
    ----------
    name : str
        What the commands take for it.
    where : str
        ``ships``, ``here``, or whose cache it is in: ``LeRobot``, ``hub``.
    path : str
        The folder.
    n_episodes, n_frames, fps : int, int, float, or None
        As it says itself; None where it cannot be read.
    robot_type : str or None
        What recorded it, where it says so.
    cameras : tuple of str
        The features that are pictures.
    fault : str or None
        Why it cannot be read, in one line.
    """

    name: str
    where: str
    path: str
    n_episodes: int | None = None
    n_frames: int | None = None
    fps: float | None = None
    robot_type: str | None = None
    cameras: tuple[str, ...] = ()
    fault: str | None = None


def list_datasets(folder: Path) -> list[Listed]:
    """List the datasets that ship, that are in a folder or are the folder, and that are in the caches.

    Parameters
    ----------
    folder : Path
        Such as the current one, whose datasets are called by their path from there.
    """
    return [_listed(name, where, root) for name, where, root in _found(folder)]


def _found(folder: Path) -> Iterator[tuple[str, str, Path]]:
    yield from ((name, "ships", root) for name, root in SHIPPED.items())
    yield from ((str(root), "here", root) for root in in_folder(folder))
    yield from ((name, where, root) for name, root, where in in_caches())


def _listed(name: str, where: str, root: Path) -> Listed:
    try:
        schema = read_schema(root)
    except DatasetError as error:
        return Listed(name, where, str(root), fault=str(error.fault.relative_to(root)))
    return Listed(
        name=name,
        where=where,
        path=str(root),
        n_episodes=schema.total_episodes,
        n_frames=schema.total_frames,
        fps=schema.fps,
        robot_type=robot_of(schema),
        cameras=tuple(camera.name for camera in cameras_of(schema)),
    )
