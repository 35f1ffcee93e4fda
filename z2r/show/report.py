"""What does a dataset look like, with nothing installed? Write one HTML page that shows it.

The page needs no network, no server and no other file. Every number that sums the dataset up is in its HTML, worked out
by the package, so that it reads with JavaScript off. The script in it (`z2r/page/page.js`) decodes the frames by the
rules of `z2r.reading`, moves the picture, and shows what a wrong reading makes of it.

Whatever comes from the dataset is data: it is escaped, and a content security policy lets nothing run but that script.
"""

import base64
import os
from dataclasses import dataclass
from html import escape
from pathlib import Path

from z2r.arrays import Progress, no_progress
from z2r.format.dataset import Dataset
from z2r.show.page.content import read_content
from z2r.show.page.markup import render
from z2r.show.page.pictures import scene

_MAX_FRAME_BYTES = 3_000_000  # of the frames in a page, which stays below 5 MB
_MAX_FRAME_BYTES_IN_NOTEBOOK = 600_000  # what is shown in a notebook is saved in it
_PANEL_HEIGHT = 1180  # pixels: down to the picture and its key
_STILL_HEIGHT = 540


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
    still : str
        A picture of it for places where no script runs, such as a notebook on GitHub: SVG, or nothing.
    """

    page: str
    title: str
    still: str

    def __repr__(self) -> str:
        return f"Panel: {self.title}"

    def _repr_html_(self) -> str:
        image = base64.b64encode(self.still.encode()).decode()
        still = f'<img alt="" width="420" src="data:image/svg+xml;base64,{image}">' if self.still else ""
        # The frame covers the still. Where it is taken out, as in a notebook that is not trusted, the still is there.
        return (
            f'<div style="height: {_STILL_HEIGHT}px; overflow: hidden"><p>{escape(self.title)}</p>{still}'
            "<p>This is a still. The panel moves where the notebook is trusted and scripts run.</p></div>"
            '<iframe title="Panel of a robot dataset" sandbox="allow-scripts" width="100%" '
            f'height="{_PANEL_HEIGHT}" style="display: block; position: relative; border: 0; '
            f'margin-top: -{_STILL_HEIGHT}px" srcdoc="{escape(self.page)}"></iframe>'
        )


def write_report(dataset: Dataset, path: str | os.PathLike[str], progress: Progress = no_progress) -> Report:
    """Write a page that shows a dataset.

    Parameters
    ----------
    dataset : Dataset
        From `z2r.load`.
    path : str or path
        The .html file to write. One that is there is replaced; folders that are missing are made.
    progress : callable, optional
        Called with the number of frames done and the number of all, after each data file.

    Raises
    ------
    DatasetError
        If a data file is missing, damaged, or not what the schema and the index say.
    ValueError
        If `path` is inside the dataset, which is never written to.
    """
    path = Path(path)
    if path.resolve().is_relative_to(dataset.root.resolve()):
        raise ValueError(f"{path} is inside the dataset, which is never written to")
    content = read_content(dataset, _MAX_FRAME_BYTES, progress)
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(render(content), encoding="utf-8")
    return Report(path, len(content.shown), content.shown.n_frames, content.left_out)


def panel(dataset: Dataset) -> Panel:
    """Show a dataset in a notebook, as `write_report` shows it: put the call last in a cell.

    Parameters
    ----------
    dataset : Dataset
        From `z2r.load`.

    Raises
    ------
    DatasetError
        If a data file is missing, damaged, or not what the schema and the index say.

    Examples
    --------
    >>> import z2r
    >>> z2r.panel(z2r.load(z2r.STANDIN))
    Panel: standin, episodes: 6, frames: 427, reached the target: 6 of 6 (reconstructed)
    """
    content = read_content(dataset, _MAX_FRAME_BYTES_IN_NOTEBOOK)
    right = content.views[0]
    reached = f", reached the target: {right.tally} (reconstructed)" if right.outcome else ""
    still = scene(content, right.reading, "still") if right.reading else ""
    counts = f"episodes: {len(dataset.episodes):,}, frames: {dataset.episodes.n_frames:,}"
    return Panel(render(content), f"{content.title}, {counts}{reached}", still)
