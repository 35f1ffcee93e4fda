"""The pictures of a page that stand by themselves: the scene from above, and the ribbon of all episodes."""

from collections.abc import Sequence
from pathlib import Path
from string import Template

import numpy as np

from z2r.arrays import Floats
from z2r.pusht import task
from z2r.reading.inspection import Inspection
from z2r.reading.reading import Pose, Reading, named_columns, read_pose
from z2r.show.page.content import LONGEST_PATH, Content, View

_FOLDER = Path(__file__).parent
_MAX_SEGMENTS = 240  # of the ribbon: about as many as can be told apart
_LABEL_PERCENT = 4  # of the ribbon: a number has room under a wider segment
_TEE_REACH = task.STEM_HALF_SIZE[1] - task.STEM_CENTER[1]  # m: from the origin of the block to the end of its stem


def fill(template: str, /, **parts: str) -> str:
    """Fill one of the templates beside this module."""
    return Template((_FOLDER / template).read_text(encoding="utf-8")).substitute(parts)


def ribbon(view: View, content: Content) -> str:
    """Draw all frames as one bar with a segment for each episode; for each group of episodes where there are many."""
    episodes, outcome, n_frames = view.episodes, view.outcome, content.inspection.episodes.n_frames
    edges = np.linspace(0, len(episodes), min(len(episodes), _MAX_SEGMENTS) + 1).astype(np.int64)
    reached = outcome.reached if outcome else np.ones(len(episodes), np.bool_)
    shares = np.add.reduceat(reached, edges[:-1], dtype=np.float64) / np.diff(edges)
    begins = 100 * episodes.from_index[edges[:-1]] / n_frames
    ends = 100 * episodes.to_index[edges[1:] - 1] / n_frames
    kind = "reached" if outcome else "episode"
    bars = "".join(
        _bar(f"bar {kind}", begin, end, 0, share) + _bar("bar missed", begin, end, share, 1 - share)
        for begin, end, share in zip(begins.tolist(), ends.tolist(), shares.tolist(), strict=True)
    )
    labels = "".join(
        f'<text x="{(begin + end) / 2:.3f}%" y="56">{episodes.number(episode)}</text>'
        for episode, begin, end in zip(edges[:-1].tolist(), begins.tolist(), ends.tolist(), strict=True)
        if end - begin > _LABEL_PERCENT
    )
    what = f"{view.tally} reached the target" if outcome else f"{len(episodes):,} in all"
    role = f'role="img" aria-label="Episodes by length: {what}"'
    return f'<svg class="ribbon" {role}>{bars}<rect class="here" y="-5" height="44" rx="4"/>{labels}</svg>'


def _bar(kind: str, begin: float, end: float, top: float, height: float) -> str:
    where = f'x="{begin:.3f}%" width="{end - begin:.3f}%" y="{top:.1%}" height="{height:.1%}"'
    return f'<rect class="{kind}" {where}/>' if height else ""


def scene(content: Content, reading: Reading, name: str) -> str:
    """Draw the last shown frame of the first episode as SVG that stands by itself; the script moves its parts."""
    schema = content.inspection.schema
    state = content.frames[reading.feature][content.shown[0]][-LONGEST_PATH:]
    columns = named_columns(state, reading, schema)
    tee, target = read_pose(columns, reading.tee), read_pose(columns, reading.target)
    pusher_x, pusher_y = (columns[axis] for axis in reading.pusher)
    half = 1000 * _half_width(content.inspection, reading)
    return fill(
        "scene.svg",
        name=name,
        half=f"{half:.0f}",
        size=f"{2 * half:.0f}",
        wall=f"{task.WALL}",
        width=f"{2 * task.WALL}",
        grid="".join(f"M{i / 10} -{task.WALL}V{task.WALL}M-{task.WALL} {i / 10}H{task.WALL}" for i in range(-3, 4)),
        outline=_tee_outline(),
        tee=_transform(tee),
        target=_transform(target),
        tee_path=_points(tee.x, tee.y),
        pusher_path=_points(pusher_x, pusher_y),
        pusher=f"{pusher_x[-1]:.6g}",
        pusher_y=f"{pusher_y[-1]:.6g}",
        radius=f"{task.PUSHER_RADIUS}",
    )


def _half_width(inspection: Inspection, reading: Reading) -> float:
    """How far the picture must reach [m]: to just outside the walls, or farther if block or pusher went there."""
    ranges = inspection.ranges[reading.feature]
    farthest = np.maximum(np.abs(ranges.low), np.abs(ranges.high)).max(axis=0)

    def reach(names: Sequence[str], size: float) -> float:
        return float(farthest[inspection.schema.columns(reading.feature, names)].max()) + size

    blocks = (*reading.tee.names[:2], *reading.target.names[:2])
    return max(task.WALL + 0.01, reach(reading.pusher, task.PUSHER_RADIUS), reach(blocks, _TEE_REACH))


def _tee_outline() -> str:
    """Outline of the T in its own frame [m], as an SVG path: the stem hangs from the lower edge of the bar."""
    (bar_x, bar_y), (bar_width, bar_height, _) = task.BAR_CENTER, task.BAR_HALF_SIZE
    (stem_x, stem_y), (stem_width, stem_height, _) = task.STEM_CENTER, task.STEM_HALF_SIZE
    top, bottom, foot = bar_y + bar_height, bar_y - bar_height, stem_y - stem_height
    return (
        f"M{bar_x - bar_width:g} {top:g}H{bar_x + bar_width:g}V{bottom:g}H{stem_x + stem_width:g}V{foot:g}"
        f"H{stem_x - stem_width:g}V{bottom:g}H{bar_x - bar_width:g}Z"
    )


def _transform(pose: Pose) -> str:
    return f"translate({pose.x[-1]:.6g} {pose.y[-1]:.6g}) rotate({np.rad2deg(pose.yaw[-1]):.6g})"


def _points(x: Floats, y: Floats) -> str:
    return " ".join(f"{a:.4g},{b:.4g}" for a, b in zip(x.tolist(), y.tolist(), strict=True))
