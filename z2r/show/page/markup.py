"""How a page is written: HTML that reads with JavaScript off. Whatever comes from a dataset is escaped."""

import base64
import hashlib
import math
from html import escape
from pathlib import Path

import msgspec
import numpy as np

from z2r.errors import printable
from z2r.format.schema import ACTION
from z2r.reading.inspection import Inspection
from z2r.reading.reading import Reading, named_columns, read_pose
from z2r.reading.success import frame_errors
from z2r.show.page.content import Content, View, dims, formula, script_data
from z2r.show.page.pictures import fill, ribbon, scene

_FOLDER = Path(__file__).parent
_MAX_EPISODE_ROWS = 100
_MAX_SCHEMA_ROWS = 400


def render(content: Content) -> str:
    """Return the whole page."""
    script, style = ((_FOLDER / f"page.{kind}").read_text(encoding="utf-8") for kind in ("js", "css"))
    reading = content.inspection.reading
    return fill(
        "page.html",
        title=escape(content.title),
        script=script,
        script_hash=_csp_hash(script),
        style=style,
        style_hash=_csp_hash(style),
        facts=_facts(content.inspection),
        switch="".join(map(_switch, content.views)) if len(content.views) > 1 else "",
        answers="".join(_answer(view, content) for view in content.views),
        left_out=f'<p class="note">{content.left_out}</p>' if content.left_out else "",
        player=_world(content, reading) if reading else fill("plots.html"),
        schema_rows=_schema_rows(content.inspection),
        episode_tables="".join(_episode_table(view, hidden=view.mode is not None) for view in content.views),
        data=_json(script_data(content)),
    )


def _csp_hash(text: str) -> str:
    return f"sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}"


def _json(data: object) -> str:
    """Return JSON that cannot end the element it stands in."""
    return msgspec.json.encode(data).decode().replace("<", "\\u003c")


def _facts(inspection: Inspection) -> str:
    schema, episodes = inspection.schema, inspection.episodes
    lengths = episodes.lengths
    facts = {
        "episodes": f"{len(episodes):,}",
        "frames": f"{episodes.n_frames:,}",
        "frames a second": f"{schema.fps:g}",
        "seconds": f"{episodes.n_frames / schema.fps:,.1f}",
        "frames an episode": f"{lengths.min():,} to {lengths.max():,}",
        "on average": f"{lengths.mean():,.1f}",
        "LeRobot format": escape(printable(schema.codebase_version)),
    }
    return "".join(f"<div><dt>{name}</dt><dd>{value}</dd></div>" for name, value in facts.items())


def _switch(view: View) -> str:
    believed = view.mode.assumption if view.mode else "the block's yaw is atan2(sin, cos)"
    button = f'<input type="radio" name="reading" value="{view.name}"{"" if view.mode else " checked"}>'
    return f'<label class="choice">{button}<b>{view.name}</b><span>{escape(believed)}</span></label>'


def _answer(view: View, content: Content) -> str:
    """Say how many episodes reached the target in this view, above a ribbon of all of them."""
    outcome, reading = view.outcome, view.reading
    parts = {"name": view.name, "hidden": "hidden" if view.mode else "", "ribbon": ribbon(view, content)}
    if outcome is None or reading is None:
        return fill("unread.html", missing=escape(printable(", ".join(content.inspection.missing))), **parts)
    note = (
        "The dataset stores no success. This is read off the last stored frame of each episode: is the block within "
        f"{reading.pos_tol} m and {reading.ang_tol} rad of the target?"
    )
    if view.mode:
        note = f"Read wrong on purpose. What gives it away: {view.mode.signature}."
    return fill(
        "answer.html",
        percent=f"{outcome.success_rate:.0%}",
        tally=view.tally,
        note=escape(note),
        **parts,
    )


def _world(content: Content, reading: Reading) -> str:
    """Show the last shown frame of the first episode: the picture, the two errors, the two yaws and the numbers."""
    schema, state = content.inspection.schema, content.frames[reading.feature][content.shown[0]][-1:]
    columns, errors = named_columns(state, reading, schema), frame_errors(state, reading, schema)
    pos_err, ang_err = float(errors.pos_err[0]), float(errors.ang_err[0])
    return fill(
        "world.html",
        scene=scene(content, reading, "scene"),
        number=str(content.shown.number(0)),
        numbers=_numbers(content, reading),
        pos_err=f"{pos_err:.4f} m",
        ang_err=_angle(ang_err),
        pos_mark=_mark(pos_err <= reading.pos_tol, f"{reading.pos_tol} m"),
        ang_mark=_mark(ang_err <= reading.ang_tol, f"{reading.ang_tol} rad"),
        tee_formula=escape(formula(reading.tee)),
        target_formula=escape(formula(reading.target)),
        tee_yaw=_angle(float(read_pose(columns, reading.tee).yaw[0])),
        target_yaw=_angle(float(read_pose(columns, reading.target).yaw[0])),
    )


def _mark(within: bool, tolerance: str) -> str:
    what, kind = ("✓ within", "mark within") if within else ("✗ not within", "mark")
    return f'<span class="{kind}">{what} {tolerance}</span>'


def _angle(radians: float) -> str:
    return f"{radians:.4f} rad = {math.degrees(radians):.1f}°"


def _numbers(content: Content, reading: Reading) -> str:
    """List the numbers that a reading reads, and the action, in the frame that the picture shows."""
    wanted = {reading.feature: set(reading.names), ACTION: set(reading.velocity)}
    last = {name: frames[content.shown[0]][-1] for name, frames in content.frames.items()}
    values = np.concatenate([last[name] for name in content.frames])
    rows = [
        f'<div><dt>{escape(dim)}</dt><dd data-column="{place}">{values[place]:.4f}</dd>'
        f'<dd class="unit">{_unit(feature, dim, reading)}</dd></div>'
        for place, (feature, dim) in enumerate(content.columns)
        if dim in wanted.get(feature, ())
    ]
    return "".join(rows)


def _unit(feature: str, dim: str, reading: Reading) -> str:
    if feature == ACTION:
        return "m/s"
    return "" if dim in (*reading.tee.names[2:], *reading.target.names[2:]) else "m"


def _schema_rows(inspection: Inspection) -> str:
    rows = [row for name in inspection.schema.features for row in _feature_rows(name, inspection)]
    more = len(rows) - _MAX_SCHEMA_ROWS
    note = f'<tr><td colspan="3">and {more:,} more rows</td></tr>' if more > 0 else ""
    return "".join(rows[:_MAX_SCHEMA_ROWS]) + note


def _feature_rows(name: str, inspection: Inspection) -> list[str]:
    """Return a heading for a feature, and a row for each of its dimensions."""
    feature = inspection.schema.features[name]
    kind = feature.dtype if feature.shape == (1,) else f"{feature.dtype}[{', '.join(map(str, feature.shape))}]"
    heading = f"{escape(printable(name))} <span>{escape(printable(kind))}</span>"
    rows = [f'<tr class="feature"><th scope="colgroup" colspan="3">{heading}</th></tr>']
    if name not in inspection.ranges:
        return rows
    ranges = inspection.ranges[name]
    low, high = ranges.low.min(axis=0), ranges.high.max(axis=0)
    cells = '<tr><td>{}</td><td class="number">{:.3f}</td><td class="number">{:.3f}</td></tr>'
    return rows + [cells.format(escape(printable(dim)), low[i], high[i]) for i, dim in enumerate(dims(feature))]


def _episode_table(view: View, hidden: bool) -> str:
    episodes, outcome = view.episodes, view.outcome
    rows = [_episode_row(view, episode) for episode in range(min(len(episodes), _MAX_EPISODE_ROWS))]
    more = len(episodes) - len(rows)
    return fill(
        "episodes.html",
        name=view.name,
        hidden="hidden" if hidden else "",
        outcome_heads="<th>pos_err [m]</th><th>ang_err [rad]</th><th>reached</th>" if outcome else "",
        rows="".join(rows),
        more=f'<p class="note">and {more:,} more episodes</p>' if more else "",
    )


def _episode_row(view: View, episode: int) -> str:
    episodes, outcome = view.episodes, view.outcome
    cells = [f"{episodes.from_index[episode]:,}", f"{episodes.lengths[episode]:,}"]
    if outcome:
        cells += [f"{outcome.final_pos_err[episode]:.3f}", f"{outcome.final_ang_err[episode]:.3f}"]
        cells += ["yes" if outcome.reached[episode] else "no"]
    return (
        f'<tr><th scope="row">{episodes.number(episode)}</th>' + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>"
    )
