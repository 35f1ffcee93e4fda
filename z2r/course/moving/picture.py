"""How does a picture move under the reader's hand? As a page of its own, in a frame, with a still before it.

The page needs no kernel, no network and no other file, and its frame keeps it from touching the notebook. Where no
script runs, as on GitHub or in a notebook that nobody trusts yet, the still is what there is. It is an output of its
own, a PNG, since that is shown everywhere: what GitHub leaves of HTML, nobody promises. Where the page runs, it takes
the place of the still.
"""

import base64
import re
from dataclasses import dataclass
from pathlib import Path

from matplotlib.figure import Figure

from z2r.course import drawing
from z2r.show.page.templates import fill

_FOLDER = Path(__file__).parent
_HEIGHT = 420  # pixels, until the page in it says how high it is


@dataclass(frozen=True)
class MovingPicture:
    """A picture that shows itself in a notebook.

    Attributes
    ----------
    title : str
        What it shows, in one line.
    page : str
        The whole page.
    still : bytes
        What is shown where no script runs: a PNG, which may move by itself.
    """

    title: str
    page: str
    still: bytes

    def __repr__(self) -> str:
        return f"Moving picture: {self.title}"

    def _ipython_display_(self) -> None:
        from IPython.display import display

        still = {"image/png": base64.b64encode(self.still).decode(), "text/plain": repr(self)}
        display(still, raw=True, metadata={"image/png": {"alt": self.title}})
        display({"text/html": fill("frame.html", title=self.title, page=self.page, height=_HEIGHT, shift=0)}, raw=True)


def make(name: str, title: str, says: str, data: object, still: bytes) -> MovingPicture:
    """Fill the template of a picture.

    Parameters
    ----------
    name : str
        Of its template and its script in this folder.
    title, says : str
        What it shows, and what to do with it, each in one line.
    data : object
        What its script is given: whatever JSON can hold.
    still : bytes
        A PNG.
    """
    modules = ((_FOLDER / f"{each}.js").read_text(encoding="utf-8") for each in ("moving", name))
    script = re.sub(r"^(import [^;]*;\n|export )", "", "".join(modules), flags=re.MULTILINE)
    page = fill(f"{name}.html", _FOLDER, title=title, says=says, script=script, data=data)
    return MovingPicture(title, page, still)


def new_still(title: str, height: float) -> Figure:
    """Open a figure for a still, as wide as a page of the course, with its title."""
    figure = drawing.new_figure(9, height)
    figure.suptitle(title, x=0.01, ha="left", size=12)
    return figure
