"""Where does what stand in the pictures of a page: in the scene from above, and in the ribbon of all episodes?"""

from collections.abc import Iterator
from dataclasses import dataclass
from math import floor, log10
from typing import NamedTuple

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

_MAX_SEGMENTS = 240  # of the ribbon: about as many as can be told apart
_LABEL_PERCENT = 4  # of the ribbon: a number has room under a wider segment
_HALF = 410  # half the width of the picture, in its own unit
_POINT = 0.022  # of half the width: radius of a body of which nothing but the place is known


@dataclass(frozen=True)
class Camera:
    """What the picture shows: its middle, and how far it goes from there, in the unit of the positions."""

    middle: tuple[float, float]
    half: float

    @property
    def grid(self) -> float:
        """The distance between two lines of the grid: a power of ten."""
        return float(10.0 ** floor(log10(self.half / 2)))


class Floor(NamedTuple):
    """The ground: its corner at the lowest x and y, how wide it is, and the two ends of each line of its grid."""

    corner: tuple[float, float]
    width: float
    lines: list[tuple[tuple[float, float], tuple[float, float]]]


def ribbon(view: View, content: Content) -> dict[str, object]:
    """Lay out all frames as one bar with a segment for each episode; for each group of episodes where there are many.

    Segments are (kind, x, width, y, height), flags (severity, x, width) and labels (x, number); lengths are in percent.
    """
    episodes, n_frames = view.episodes, content.inspection.episodes.n_frames
    edges = np.linspace(0, len(episodes), min(len(episodes), _MAX_SEGMENTS) + 1).astype(np.int64)
    begins = (100 * episodes.from_index[edges[:-1]] / n_frames).tolist()
    ends = (100 * episodes.to_index[edges[1:] - 1] / n_frames).tolist()
    spans = [(f"{begin:.3f}%", f"{end - begin:.3f}%") for begin, end in zip(begins, ends, strict=True)]
    worst = _worst(content, episodes, edges)
    return {
        "says": _ribbon_says(view, content),
        "bars": [
            (kind, *span, f"{top:.1%}", f"{height:.1%}")
            for span, segment in zip(spans, _segments(view, edges), strict=True)
            for kind, top, height in segment
            if height
        ],
        "flags": [(severity, *span) for severity, span in zip(worst, spans, strict=True) if severity],
        "labels": [
            (f"{(begin + end) / 2:.3f}%", episodes.number(episode))
            for episode, begin, end in zip(edges[:-1].tolist(), begins, ends, strict=True)
            if end - begin > _LABEL_PERCENT
        ],
    }


def _segments(view: View, edges: Ints) -> Iterator[list[tuple[str, float, float]]]:
    """Say of each segment how much of it is what: kind, where it begins, how high it is."""
    if view.fine is None:
        yield from [[("episode", 0.0, 1.0)]] * (len(edges) - 1)
        return
    for share in (np.add.reduceat(view.fine, edges[:-1], dtype=np.float64) / np.diff(edges)).tolist():
        yield [("reached", 0.0, share), ("missed", share, 1 - share)]


def _worst(content: Content, episodes: EpisodeIndex, edges: Ints) -> list[Severity | None]:
    """Return how bad the worst finding about some episode of each segment is; None where there is none."""
    findings = content.audit.findings if content.audit and len(episodes) == len(content.inspection.episodes) else ()
    rank = np.full(len(episodes), len(SEVERITIES))
    for finding in findings:
        about = np.isin(episodes.numbers, finding.episodes)
        rank[about] = np.minimum(rank[about], SEVERITIES.index(finding.severity))
    worst = np.minimum.reduceat(rank, edges[:-1]).tolist()
    return [SEVERITIES[place] if place < len(SEVERITIES) else None for place in worst]


def range_bar(low: float, mean: float, high: float, scale: tuple[float, float]) -> dict[str, str] | None:
    """Lay out a range and its mean between the two ends of a scale; nothing where one of them is no number."""
    width = scale[1] - scale[0]
    if not (np.isfinite([low, mean, high]).all() and width > 0):
        return None
    begin, middle, end = (100 * (value - scale[0]) / width for value in (low, mean, high))
    return {"begin": f"{begin:.2f}%", "width": f"{max(end - begin, 0.5):.2f}%", "mean": f"{middle:.2f}%"}


def _ribbon_says(view: View, content: Content) -> str:
    if view.outcome:
        return f"{view.outcome.tally} reached {content.destination}"
    return f"{view.stored.tally} called a success" if view.stored else f"{len(view.episodes):,} in all"


def scene(content: Content, reading: Reading) -> dict[str, object]:
    """Lay out the last shown frame of the first episode, seen from above; the script moves its parts."""
    episode = slice(max(0, int(content.shown.to_index[0]) - LONGEST_PATH), int(content.shown.to_index[0]))
    decoded, camera = content.decoded(reading).take(episode), camera_of(content, reading)
    bodies, scale = content.bodies, _HALF / camera.half
    return {
        "label": ", ".join(body.label for body in bodies.values()),
        "place": f"scale({scale:.6g} {-scale:.6g}) translate({-camera.middle[0]:.6g} {-camera.middle[1]:.6g})",
        "floor": _floor(content, camera),
        "paths": [
            (pose, body.role, _points(decoded.pose(pose))) for pose, body in bodies.items() if body.role != "goal"
        ],
        "bodies": [_body(pose, decoded, body, camera) for pose, body in bodies.items()],
        "key": _key(content, reading, camera),
    }


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


def floor_of(content: Content, camera: Camera) -> Floor:
    """Return the floor that is seen: up to the walls where a scene has some."""
    half = content.scene.half_width if content.scene else camera.half
    (x, y), step = (0.0, 0.0) if content.scene else camera.middle, camera.grid
    columns, rows = ([i * step for i in _inner(at - half, at + half, step)] for at in (x, y))
    lines = [((at, y - half), (at, y + half)) for at in columns] + [((x - half, at), (x + half, at)) for at in rows]
    return Floor((x - half, y - half), 2 * half, lines)


def disc_radius(body: Body, camera: Camera) -> float:
    """Say how large a body is drawn that has no outline."""
    return body.reach or _POINT * camera.half


def _floor(content: Content, camera: Camera) -> dict[str, object]:
    """Lay out the floor with its grid, and the walls where a scene has some."""
    (x, y), width, lines = floor_of(content, camera)
    place = {"x": f"{x:.6g}", "y": f"{y:.6g}", "width": f"{width:.6g}"}
    grid = "".join(f"M{begin[0]:.6g} {begin[1]:.6g}L{end[0]:.6g} {end[1]:.6g}" for begin, end in lines)
    return {**place, "grid": grid, "has_walls": content.scene is not None}


def _inner(low: float, high: float, step: float) -> range:
    """Numbers of the lines of the grid that lie between two places."""
    return range(floor(low / step + 1.001), floor(high / step + 0.999))


def _body(pose: str, decoded: Decoded, body: Body, camera: Camera) -> dict[str, object]:
    """Lay out a body: its outline, or else a disc, with a line ahead where it is known how it is turned."""
    corners = "L".join(f"{x:.6g} {y:.6g}" for x, y in body.outline.tolist())
    radius = disc_radius(body, camera)
    return {
        "pose": pose,
        "role": body.role,
        "place": _transform(decoded.pose(pose)),
        "outline": f"M{corners}Z" if corners else "",
        "radius": f"{radius:.6g}",
        "heading": f"M0 0H{2.4 * radius:.6g}" if decoded.reading.poses[pose].yaw else "",
    }


def _transform(pose: Pose) -> str:
    turn = 0.0 if pose.yaw is None else np.rad2deg(pose.yaw[-1])
    return f"translate({pose.x[-1]:.6g} {pose.y[-1]:.6g}) rotate({turn:.6g})"


def _points(pose: Pose) -> str:
    return " ".join(f"{a:.4g},{b:.4g}" for a, b in np.stack([pose.x, pose.y], axis=1).tolist())


def _key(content: Content, reading: Reading, camera: Camera) -> list[tuple[str, str]]:
    """Say what the colours are, and how wide a square of the grid is."""
    key: list[tuple[str, str]] = [(body.role, body.label) for body in reversed(content.bodies.values())]
    if reading.action:
        key.append(("action", "action, one frame ahead"))
    unit = next(iter(reading.poses.values())).unit
    wide = f"{100 * camera.grid:g} cm" if unit == "m" and camera.grid < 1 else f"{camera.grid:g} {unit}".strip()
    return [*key, ("grid", wide)]
