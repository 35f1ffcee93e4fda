"""The pictures of a page that stand by themselves: the scene from above, and the ribbon of all episodes."""

from dataclasses import dataclass
from html import escape
from math import floor, log10
from pathlib import Path
from string import Template

import numpy as np

from z2r.arrays import Ints
from z2r.check import SEVERITIES, Severity
from z2r.format.episodes import EpisodeIndex
from z2r.reading.bodies import Body
from z2r.reading.decode import Decoded
from z2r.reading.poses import Pose
from z2r.reading.reading import Reading, locate
from z2r.show.page.content import Content, View
from z2r.show.page.script_data import LONGEST_PATH

_FOLDER = Path(__file__).parent
_MAX_SEGMENTS = 240  # of the ribbon: about as many as can be told apart
_LABEL_PERCENT = 4  # of the ribbon: a number has room under a wider segment
_HALF = 410  # half the width of the picture, in its own unit
_POINT = 0.022  # of half the width: radius of a body of which nothing but the place is known
_STROKE = 'vector-effect="non-scaling-stroke"'
# So that a picture without the style of the page is coloured too.
_PAINT = {
    "object": 'fill="#0072b2" fill-opacity="0.82" stroke="#0072b2" stroke-width="2"',
    "goal": 'fill="#009e73" fill-opacity="0.14" stroke="#009e73" stroke-width="2" stroke-dasharray="3 4"',
    "robot": 'fill="#d55e00" stroke="#fffefb" stroke-width="1.5"',
}
_LINE_PAINT = {"object": "#0072b2", "goal": "#009e73", "robot": "#d55e00"}


@dataclass(frozen=True)
class Camera:
    """What the picture shows: its middle, and how far it goes from there, in the unit of the positions."""

    middle: tuple[float, float]
    half: float

    @property
    def grid(self) -> float:
        """The distance between two lines of the grid: a power of ten."""
        return float(10.0 ** floor(log10(self.half / 2)))


def fill(template: str, /, **parts: str) -> str:
    """Fill one of the templates beside this module."""
    return Template((_FOLDER / template).read_text(encoding="utf-8")).substitute(parts)


def ribbon(view: View, content: Content) -> str:
    """Draw all frames as one bar with a segment for each episode; for each group of episodes where there are many."""
    episodes, n_frames = view.episodes, content.inspection.episodes.n_frames
    edges = np.linspace(0, len(episodes), min(len(episodes), _MAX_SEGMENTS) + 1).astype(np.int64)
    fine = np.ones(len(episodes), np.bool_) if view.fine is None else view.fine
    shares = np.add.reduceat(fine, edges[:-1], dtype=np.float64) / np.diff(edges)
    begins = 100 * episodes.from_index[edges[:-1]] / n_frames
    ends = 100 * episodes.to_index[edges[1:] - 1] / n_frames
    kind = "episode" if view.fine is None else "reached"
    bars = "".join(
        _bar(f"bar {kind}", begin, end, 0, share) + _bar("bar missed", begin, end, share, 1 - share)
        for begin, end, share in zip(begins.tolist(), ends.tolist(), shares.tolist(), strict=True)
    )
    labels = "".join(
        f'<text x="{(begin + end) / 2:.3f}%" y="56">{episodes.number(episode)}</text>'
        for episode, begin, end in zip(edges[:-1].tolist(), begins.tolist(), ends.tolist(), strict=True)
        if end - begin > _LABEL_PERCENT
    )
    flags = "".join(
        f'<rect class="flag {severity}" x="{begin:.3f}%" width="{end - begin:.3f}%" y="-12" height="4"/>'
        for severity, begin, end in zip(_worst(content, episodes, edges), begins.tolist(), ends.tolist(), strict=True)
        if severity
    )
    role = f'role="img" aria-label="Episodes by length: {escape(_ribbon_says(view, content))}"'
    return f'<svg class="ribbon" {role}>{flags}{bars}<rect class="here" y="-5" height="44" rx="4"/>{labels}</svg>'


def _worst(content: Content, episodes: EpisodeIndex, edges: Ints) -> list[Severity | None]:
    """Return how bad the worst finding about some episode of each segment is; None where there is none."""
    findings = content.audit.findings if content.audit and len(episodes) == len(content.inspection.episodes) else ()
    rank = np.full(len(episodes), len(SEVERITIES))
    for finding in findings:
        about = np.isin(episodes.numbers, finding.episodes)
        rank[about] = np.minimum(rank[about], SEVERITIES.index(finding.severity))
    worst = np.minimum.reduceat(rank, edges[:-1]).tolist()
    return [SEVERITIES[place] if place < len(SEVERITIES) else None for place in worst]


def range_bar(low: float, mean: float, high: float, scale: tuple[float, float]) -> str:
    """Draw a range and its mean as a bar between the two ends of a scale; nothing where one of them is no number."""
    width = scale[1] - scale[0]
    if not (np.isfinite([low, mean, high]).all() and width > 0):
        return ""
    begin, middle, end = (100 * (value - scale[0]) / width for value in (low, mean, high))
    bar = f'<rect class="span" x="{begin:.2f}%" width="{max(end - begin, 0.5):.2f}%" y="25%" height="50%" rx="2"/>'
    bar += f'<rect class="mean" x="{middle:.2f}%" width="2" height="100%"/>'
    return f'<svg class="range" aria-hidden="true">{bar}</svg>'


def _ribbon_says(view: View, content: Content) -> str:
    if view.outcome:
        return f"{view.outcome.tally} reached {content.destination}"
    return f"{view.stored.tally} called a success" if view.stored else f"{len(view.episodes):,} in all"


def _bar(kind: str, begin: float, end: float, top: float, height: float) -> str:
    where = f'x="{begin:.3f}%" width="{end - begin:.3f}%" y="{top:.1%}" height="{height:.1%}"'
    return f'<rect class="{kind}" {where}/>' if height else ""


def scene(content: Content, reading: Reading, name: str) -> str:
    """Draw the last shown frame of the first episode as SVG that stands by itself; the script moves its parts."""
    episode = slice(max(0, int(content.shown.to_index[0]) - LONGEST_PATH), int(content.shown.to_index[0]))
    decoded, camera = content.decoded(reading).take(episode), camera_of(content, reading)
    bodies = content.bodies
    moving = [pose for pose, body in bodies.items() if body.role != "goal"]
    scale = _HALF / camera.half
    return fill(
        "scene.svg",
        name=name,
        label=escape("Seen from above: " + ", ".join(body.label for body in bodies.values())),
        place=f"scale({scale:.6g} {-scale:.6g}) translate({-camera.middle[0]:.6g} {-camera.middle[1]:.6g})",
        ground=_ground(content, camera),
        ahead="".join(_path(pose, decoded, bodies[pose], "ahead", 'stroke-opacity="0.25"') for pose in moving),
        paths="".join(_path(pose, decoded, bodies[pose], "path", "") for pose in moving),
        bodies="".join(_body(pose, decoded, body, camera) for pose, body in bodies.items()),
    )


def camera_of(content: Content, reading: Reading) -> Camera:
    """Look at the walls of a scene and just beyond, and farther if a body went there; without it, at all places."""
    names = [(pose.x, pose.y, content.bodies[name].reach) for name, pose in reading.poses.items()]
    low = np.min([[_end(content, reading, n, "low") - reach for n in (x, y)] for x, y, reach in names], axis=0)
    high = np.max([[_end(content, reading, n, "high") + reach for n in (x, y)] for x, y, reach in names], axis=0)
    if content.scene:
        return Camera((0.0, 0.0), float(max(content.scene.half_width * 1.025, *np.abs(low), *np.abs(high))))
    x, y = ((low + high) / 2).tolist()
    return Camera((x, y), float((high - low).max()) * 0.55 or 1.0)


def _end(content: Content, reading: Reading, name: str, which: str) -> float:
    feature, dim = locate(name, reading.feature, content.schema)
    ends = getattr(content.inspection.ranges[feature], which)[:, dim]
    return float(ends.min() if which == "low" else ends.max())


def _ground(content: Content, camera: Camera) -> str:
    """Draw the floor with its grid, and the walls where a scene has some."""
    half = content.scene.half_width if content.scene else camera.half
    (x, y), step = (camera.middle, camera.grid) if not content.scene else ((0.0, 0.0), camera.grid)
    rect = f'x="{x - half:.6g}" y="{y - half:.6g}" width="{2 * half:.6g}" height="{2 * half:.6g}"'
    lines = [f"M{i * step:.6g} {y - half:.6g}v{2 * half:.6g}" for i in _inner(x - half, x + half, step)] + [
        f"M{x - half:.6g} {i * step:.6g}h{2 * half:.6g}" for i in _inner(y - half, y + half, step)
    ]
    walls = f'<rect class="walls" {rect} stroke="#7b7f86" stroke-width="2" {_STROKE}/>' if content.scene else ""
    grid = f'<path class="grid" d="{"".join(lines)}" stroke="#e9e6dd" stroke-width="1" {_STROKE}/>'
    return f'<rect class="floor" {rect} fill="#fffefb"/>\n{grid}\n{walls}'


def _inner(low: float, high: float, step: float) -> range:
    """Numbers of the lines of the grid that lie between two places."""
    return range(floor(low / step + 1.001), floor(high / step + 0.999))


def _path(pose: str, decoded: Decoded, body: Body, kind: str, style: str) -> str:
    points = _points(decoded.pose(pose))
    paint = f'stroke="{_LINE_PAINT[body.role]}" {style} stroke-width="{2 if kind == "path" else 1.5}" {_STROKE}'
    return f'<polyline class="{kind} {body.role}-line" data-pose="{escape(pose)}" points="{points}" {paint}/>\n'


def _body(pose: str, decoded: Decoded, body: Body, camera: Camera) -> str:
    paint = f"{_PAINT[body.role]} {_STROKE}"
    place = f'data-pose="{escape(pose)}" transform="{_transform(decoded.pose(pose))}"'
    if len(body.outline):
        corners = "L".join(f"{x:.6g} {y:.6g}" for x, y in body.outline.tolist())
        return f'<path class="body {body.role}" d="M{corners}Z" {place} {paint}/>\n'
    radius = body.reach or _POINT * camera.half
    ahead = f'<path class="heading" d="M0 0H{2.4 * radius:.6g}" stroke-width="2" {_STROKE}/>'
    inner = ahead if decoded.reading.poses[pose].yaw else ""
    stroke = f'stroke="{_LINE_PAINT[body.role]}"' if inner else ""
    return f'<g class="body {body.role}" {place} {stroke}><circle r="{radius:.6g}" {paint}/>{inner}</g>\n'


def _transform(pose: Pose) -> str:
    turn = 0.0 if pose.yaw is None else np.rad2deg(pose.yaw[-1])
    return f"translate({pose.x[-1]:.6g} {pose.y[-1]:.6g}) rotate({turn:.6g})"


def _points(pose: Pose) -> str:
    return " ".join(f"{a:.4g},{b:.4g}" for a, b in np.stack([pose.x, pose.y], axis=1).tolist())


def grid_text(camera: Camera, unit: str) -> str:
    """Say how wide a square of the grid is."""
    return f"{100 * camera.grid:g} cm" if unit == "m" and camera.grid < 1 else f"{camera.grid:g} {unit}".strip()
