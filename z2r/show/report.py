"""What does a dataset look like, with nothing installed? Write one HTML page that shows it.

The page needs no network, no server and no other file. Every number that sums the dataset up is in its HTML, worked out
by the package, so that it reads with JavaScript off. So is every number of a frame: the script in it
(`z2r/show/page/page.js`) decodes nothing, it moves the picture, and shows what a wrong reading makes of it.

Whatever comes from the dataset is data: it is escaped, and a content security policy lets nothing run but that script.
"""

import base64
import os
from dataclasses import dataclass
from pathlib import Path

from z2r.audits.audit import Audit
from z2r.format.schema import Schema
from z2r.format.store import write
from z2r.reading.inspection import Inspection
from z2r.reading.reading import Reading
from z2r.reading.scene import Scene
from z2r.show.page.content import n_frames_for, read_content
from z2r.show.page.markup import render
from z2r.show.page.moving import moving_picture
from z2r.show.page.templates import fill

_MAX_BYTES = 3_000_000  # of the frames and clips in a page, which stays below 5 MB
_MAX_BYTES_IN_NOTEBOOK = 600_000  # what is shown in a notebook is saved in it
_PANEL_HEIGHT = 1180  # pixels, until the page in it says how high it is
_PICTURE_HEIGHT = 540  # with what is said of it


@dataclass(frozen=True)
class Report:
    """What a page shows: the frames of the first `n_episodes` episodes, `n_frames` in all.

    Attributes
    ----------
    path : Path
        The page.
    n_episodes, n_frames : int
        Less than the dataset has where they would make the page too large. The numbers that sum the dataset up cover
        all of it.
    left_out : str
        Which episodes are left out, in a sentence; empty where none is.
    """

    path: Path
    n_episodes: int
    n_frames: int
    left_out: str


@dataclass(frozen=True)
class Panel:
    """A page that shows itself in a notebook, in a frame from which it cannot touch anything else.

    Attributes
    ----------
    page : str
        The whole page.
    title : str
        What is shown, in one line.
    picture : bytes
        The first episode for places where no script runs, such as a notebook on GitHub: an animated WebP, or nothing.
    """

    page: str
    title: str
    picture: bytes

    def __repr__(self) -> str:
        return f"Panel: {self.title}"

    def _repr_html_(self) -> str:
        return fill(
            "panel.html",
            title=self.title,
            page=self.page,
            picture=base64.b64encode(self.picture).decode(),
            height=_PANEL_HEIGHT,
            picture_height=_PICTURE_HEIGHT,
        )


def write_report(
    inspection: Inspection, path: str | os.PathLike[str], scene: Scene | None = None, audit: Audit | None = None
) -> Report:
    """Write a page that shows a dataset.

    Parameters
    ----------
    inspection : Inspection
        From `z2r.reading.inspection.inspect_dataset`, which was asked to keep as many frames as `n_frames_in_report`
        says.
    path : str or path
        The .html file to write. One that is there is replaced; folders that are missing are made.
    scene : Scene, optional
        What the bodies look like.
    audit : Audit, optional
        What is wrong with it.

    Raises
    ------
    DatasetError
        If `path` is in the dataset, which is never written to, or cannot be written.
    """
    path = Path(path)
    content = read_content(inspection, _MAX_BYTES, scene, audit)
    write(path, render(content).encode(), inspection.dataset.root)
    return Report(path, len(content.shown), content.shown.n_frames, content.left_out)


def panel(inspection: Inspection, scene: Scene | None = None) -> Panel:
    """Show a dataset in a notebook, as `write_report` shows it; the inspection keeps `n_frames_in_panel` frames.

    Parameters
    ----------
    inspection : Inspection
        What was found in the dataset.
    scene : Scene, optional
        What the bodies look like.
    """
    content = read_content(inspection, _MAX_BYTES_IN_NOTEBOOK, scene)
    right, episodes = content.views[0], inspection.episodes
    reached = f", reached {content.destination}: {right.outcome.tally} ({content.source})" if right.outcome else ""
    stored = f", stored: {inspection.stored.says}" if inspection.stored else ""
    counts = f"episodes: {len(episodes):,}, frames: {episodes.n_frames:,}"
    title = f"{content.title}, {counts}{reached}{stored}"
    return Panel(render(content, in_notebook=True), title, moving_picture(content))


def n_frames_in_report(schema: Schema, reading: Reading | None) -> int:
    """Say how many frames a page has room for."""
    return n_frames_for(schema, reading, _MAX_BYTES)


def n_frames_in_panel(schema: Schema, reading: Reading | None) -> int:
    """Say how many frames a page in a notebook has room for."""
    return n_frames_for(schema, reading, _MAX_BYTES_IN_NOTEBOOK)
