"""What did it look like? Write the frames of a dataset into a rerun recording (.rrd).

The recording shows the dataset as the reading has it: a wrong reading draws a wrong picture. Frames of all episodes lie
one after another on two timelines, `sim_time` [s] and `frame`. Every column is sent whole, never row by row, and the
layout of the viewer is part of the file: what is to be seen is large, numbers stand beside it, the episodes below.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import rerun as rr
import rerun.blueprint as rrb

from z2r.arrays import Columns
from z2r.errors import printable
from z2r.format.about import About, read_task_texts
from z2r.format.schema import STATE
from z2r.format.store import write
from z2r.reading.decode import Decoded, decode
from z2r.reading.inspection import Inspection
from z2r.reading.scene import Scene
from z2r.reading.success import frame_errors
from z2r.show.cameras import Seen, send_cameras
from z2r.show.plots import send_numbers, view_of, whole_time
from z2r.show.recorder import Recorder
from z2r.show.world import COLORS, send_world

_COLUMNS = 2  # plots beside each other, where there is something to see as well
_SHADES = ((58, 78, 110), (92, 110, 140))  # of episodes in turn


@dataclass(frozen=True)
class Replay:
    """What a recording shows.

    Attributes
    ----------
    path : Path
        The file.
    n_frames, n_episodes : int
        How many frames it has, which begin so many episodes.
    left_out : tuple of str
        What of the cameras it does not show, and why.
    """

    path: Path
    n_frames: int
    n_episodes: int
    left_out: tuple[str, ...] = ()


def write_replay(inspection: Inspection, path: Path, scene: Scene | None = None) -> Replay:
    """Write the frames that an inspection has kept into a rerun recording.

    Parameters
    ----------
    inspection : Inspection
        From `z2r.reading.inspection.inspect_dataset`, which was asked to keep some frames. Without a reading, only the
        cameras and the numbers are shown; without poses in it, no world.
    path : Path
        The .rrd file to write. One that is there is replaced.
    scene : Scene, optional
        What the bodies look like; without it, each is a point.

    Raises
    ------
    DatasetError
        If `path` is in the dataset, which is never written to, or cannot be written.
    """
    dataset, reading, shown = inspection.dataset, inspection.reading, inspection.shown
    frames: Columns = {name: values[shown.frame_numbers] for name, values in inspection.kept.items()}
    decoded = decode(frames, reading, dataset.schema) if reading else None
    recorder = Recorder(path.stem, dataset.schema.fps, shown.lengths)
    world = send_world(recorder, decoded, scene) if decoded and decoded.reading.poses else None
    seen = send_cameras(recorder, dataset, shown.moved(inspection.kept_from))
    left_out = [STATE] if world else []  # the world is drawn of it
    pages = send_numbers(recorder, dataset.schema, reading, inspection.action, frames, left_out)
    goals = _send_errors(recorder, decoded) if decoded else []
    strip = _send_episodes(recorder, inspection)
    recorder.static("about", rr.TextDocument(_about(inspection.about, seen)))
    write(path, recorder.close(_layout(world, seen.cameras, goals, pages, strip)), dataset.root)
    return Replay(path, recorder.n_frames, len(shown), seen.left_out)


def _about(about: About, seen: Seen) -> str:
    """Return what the dataset says of itself, a line for each; as plain text, so that no name in it is markup."""
    lines = ({"not shown": list(seen.left_out)} if seen.left_out else {}) | about.lines
    return "\n".join(f"{kind}: {printable(line)}" for kind, each in lines.items() for line in each)


def _send_episodes(recorder: Recorder, inspection: Inspection) -> list[str]:
    """Send which episode it is, and what the robot was told; return what is a strip along the time."""
    shown, entity = inspection.shown, "eval/episode_index"
    recorder.columns(entity, rr.Scalars.columns(scalars=np.repeat(shown.numbers, shown.lengths)))
    states = [f"episode {number}" for number in shown.numbers.tolist()]
    shades = [_SHADES[place % len(_SHADES)] for place in range(len(states))]
    recorder.static(entity, rr.StateConfiguration(values=states, colors=shades))
    recorder.columns(entity, rr.StateChange.columns(state=states), recorder.starts)
    texts = read_task_texts(inspection.dataset.root, shown.numbers)
    if texts is None or not any(texts):
        return [entity]
    said = [printable(text) for text in texts]
    recorder.columns("task", rr.TextDocument.columns(text=said), recorder.starts)
    recorder.columns("task", rr.StateChange.columns(state=said), recorder.starts)
    return [entity, "task"]


def _send_errors(recorder: Recorder, decoded: Decoded) -> list[rrb.View]:
    """Send how far the goals are, with what counts as reached; return a plot for each."""
    reading, errors, ends = decoded.reading, frame_errors(decoded), np.array([0, recorder.n_frames - 1])
    plots = []
    for goal in reading.goal:
        entity, unit = f"eval/{rr.escape_entity_path_part(goal.name)}", reading.unit(goal)
        title = f"{goal.name} [{unit}]" if unit else goal.name
        recorder.static(entity, rr.SeriesLines(names=title, colors=COLORS["object"], widths=2))
        recorder.lines(entity, errors[goal.name])
        for limit, value in goal.limits.items():
            line = f"{entity}/{'tolerance' if limit == 'within' else limit}"
            said = f"{limit.replace('_', ' ')} {value:g} {unit}".strip()
            recorder.static(line, rr.SeriesLines(names=said, colors=COLORS["goal"]))
            recorder.columns(line, rr.Scalars.columns(scalars=[value] * 2), frames=ends)
        plots.append(view_of(f"reached where {goal.says(unit)}", f"{entity}/**", legend=False))
    return plots


def _layout(
    world: rrb.View | None,
    cameras: Mapping[str, str],
    goals: Sequence[rrb.View],
    pages: Mapping[str, Sequence[rrb.View]],
    strip: Sequence[str],
) -> rrb.Blueprint:
    """Lay the viewer out: on the left what is to be seen, on the right the numbers, below them the episodes."""
    pictures = [rrb.Spatial2DView(name=name, origin=entity) for name, entity in cameras.items()]
    seen: list[rrb.View | rrb.Container] = [world] if world else []
    if pictures:
        seen.append(rrb.Horizontal(*pictures) if world else rrb.Grid(*pictures, grid_columns=1 + len(pictures) // 4))
    columns = _COLUMNS if seen else _COLUMNS + 1
    tabs = [
        rrb.Grid(*views, grid_columns=columns, name=name) if len(views) > 1 else views[0]
        for name, views in pages.items()
    ]
    numbers = [*goals, tabs[0] if len(tabs) == 1 else rrb.Tabs(*tabs, active_tab=0)] if tabs else list(goals)
    rows = [1] * len(goals) + [max(-(-len(views) // columns) for views in pages.values())] if tabs else None
    right = rrb.Vertical(*numbers, row_shares=rows)
    above = rrb.Horizontal(rrb.Vertical(*seen), right, column_shares=[3, 2 if world else 3]) if seen else right
    below = rrb.Horizontal(
        rrb.StateTimelineView(
            name="episodes", origin="/", contents=[f"/{entity}" for entity in strip], time_view=whole_time()
        ),
        *([rrb.TextDocumentView(name="task", origin="task")] if "task" in strip else []),
        rrb.TextDocumentView(name="about", origin="about"),
        column_shares=[2, 1, 1][: 1 + len(strip)],
    )
    time_panel = rrb.TimePanel(timeline="sim_time", play_state="paused", state="collapsed")
    return rrb.Blueprint(rrb.Vertical(above, below, row_shares=[5, 1]), time_panel, collapse_panels=True)
