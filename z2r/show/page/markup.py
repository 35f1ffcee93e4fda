"""How a page is written: HTML that reads with JavaScript off. Whatever comes from a dataset is escaped."""

import base64
import hashlib
import math
from html import escape
from pathlib import Path

import msgspec

from z2r.errors import printable
from z2r.format.schema import ACTION
from z2r.reading.decode import Decoded
from z2r.reading.goal import Goal
from z2r.reading.inspection import Inspection, Outcome
from z2r.reading.reading import Reading, locate
from z2r.reading.stored import StoredSuccess
from z2r.reading.success import frame_errors
from z2r.show.page.content import Content, View
from z2r.show.page.pictures import camera_of, fill, grid_text, ribbon, scene
from z2r.show.page.script_data import formulas, limit_text, script_data

_FOLDER = Path(__file__).parent
_MAX_EPISODE_ROWS = 100
_MAX_SCHEMA_ROWS = 400


def render(content: Content) -> str:
    """Return the whole page."""
    script, style = ((_FOLDER / f"page.{kind}").read_text(encoding="utf-8") for kind in ("js", "css"))
    return fill(
        "page.html",
        title=escape(content.title),
        question=_question(content),
        script=script,
        script_hash=_csp_hash(script),
        style=style,
        style_hash=_csp_hash(style),
        facts=_facts(content.inspection),
        switch="".join(_switch(view, content) for view in content.views) if len(content.views) > 1 else "",
        answers="".join(_answer(view, content) for view in content.views),
        left_out=f'<p class="note">{content.left_out}</p>' if content.left_out else "",
        player=_player(content),
        schema_rows=_schema_rows(content.inspection),
        episode_tables="".join(_episode_table(view) for view in content.views),
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
    facts |= {name: escape(printable("; ".join(lines))) for name, lines in inspection.about.lines.items()}
    return "".join(f"<div><dt>{name}</dt><dd>{value}</dd></div>" for name, value in facts.items())


def _switch(view: View, content: Content) -> str:
    reading = content.inspection.reading
    believed = view.mode.assumption if view.mode else f"as the reading {reading.name if reading else ''} has it"
    button = f'<input type="radio" name="reading" value="{view.name}"{"" if view.mode else " checked"}>'
    return f'<label class="choice">{button}<b>{view.name}</b><span>{escape(believed)}</span></label>'


def _question(content: Content) -> str:
    if content.inspection.outcome is None and content.inspection.stored:
        return "How many does the dataset call a success?"
    return f"How many reached {escape(content.destination)}?"


def _answer(view: View, content: Content) -> str:
    """Say how many episodes reached the goal in this view, or are stored as a success, above a ribbon of all."""
    parts = {"name": view.name, "hidden": "hidden" if view.mode else "", "ribbon": ribbon(view, content)}
    if view.outcome and view.reading:
        return fill("answer.html", **_what_was_reached(view, view.outcome, view.reading, content), **parts)
    why = escape(printable(f"{content.inspection.why_unknown}."))
    if view.stored:
        return fill("answer.html", **_what_is_stored(view.stored, why), **parts)
    return fill("unread.html", why=why, stored=_stored(view, content.inspection), **parts)


def _what_was_reached(view: View, outcome: Outcome, reading: Reading, content: Content) -> dict[str, str]:
    return {
        "percent": f"{outcome.share_reached:.0%}",
        "tally": outcome.tally,
        "claim": f"reached {escape(content.destination)}",
        "source": content.source,
        "note": escape(_note(view, reading)),
        "stored": _stored(view, content.inspection),
        "fine": "reached",
        "other": "not reached",
    }


def _what_is_stored(stored: StoredSuccess, why: str) -> dict[str, str]:
    return {
        "percent": f"{stored.share:.0%}",
        "tally": stored.tally,
        "claim": "called a success by the dataset",
        "source": "stored",
        "note": f"It says {stored.says}. Whether they reached their goal cannot be told from the rest: {why}",
        "stored": "",
        "fine": "success",
        "other": "no success",
    }


def _stored(view: View, inspection: Inspection) -> str:
    """Say what the dataset itself calls a success beside what is read, or why that says nothing."""
    if view.stored is None:
        return f'<p class="note">{escape(inspection.stored_note)}.</p>' if inspection.stored_note else ""
    agreement = "" if view.mode else inspection.agreement
    said = f"called a success by the dataset: {view.stored.says}" + (f"; {agreement}" if agreement else "")
    return f'<p class="note"><span class="tag">stored</span> {escape(said)}.</p>'


def _note(view: View, reading: Reading) -> str:
    if view.mode:
        return f"Read wrong on purpose. What gives it away: {view.mode.signature}."
    said = " and ".join(goal.says(reading.unit(goal)) for goal in reading.goal)
    frame = "last stored" if reading.decisive == "last" else "first"
    return f"Read off the {frame} frame of each episode, as the reading {reading.name} has it: is {said}?"


def _player(content: Content) -> str:
    """Show the last shown frame of the first episode: a picture where there are poses, else every dimension."""
    reading = content.inspection.reading
    if reading is None:
        return fill("plots.html", side="")
    last = content.decoded(reading).take(slice(content.shown.to_index[0] - 1, content.shown.to_index[0]))
    side = fill(
        "side.html",
        number=str(content.shown.number(0)),
        traces=_traces(content, last),
        decoded=_decoded(content, last),
        numbers=_numbers(content, reading) if reading.poses else "",  # else each has a plot
    )
    if not reading.poses:
        return fill("plots.html", side=side)
    return fill("world.html", scene=scene(content, reading, "scene"), key=_key(content, reading), side=side)


def _traces(content: Content, last: Decoded) -> str:
    """Make room for a trace of each goal, with its number and whether it holds."""
    errors = frame_errors(last)
    return "".join(
        f'<figure class="trace goal"><figcaption><b>{escape(content.goal_title(goal))}</b> '
        f'<span class="value">{_value(goal, float(errors[goal.name][0]), last.reading)}</span> '
        f"{_mark(bool(goal.holds(errors[goal.name])[0]), limit_text(last.reading, goal.name))}</figcaption></figure>"
        for goal in last.reading.goal
    )


def _value(goal: Goal, number: float, reading: Reading) -> str:
    return escape(_angle(number) if goal.turn else f"{number:.4f} {reading.unit(goal)}".strip())


def _mark(holds: bool, limit: str) -> str:
    what, kind = ("✓", "mark within") if holds else ("✗ not", "mark")
    return f'<span class="{kind}">{escape(f"{what} {limit}".strip())}</span>'


def _angle(radians: float) -> str:
    return f"{radians:.4f} rad = {math.degrees(radians):.1f}°"


def _decoded(content: Content, last: Decoded) -> str:
    """List the yaw of every body that has one, and how it is decoded; the last ones of the drawing come first."""
    known = formulas(last.reading)
    rows = [(name, content.label(name), last.pose(name).yaw) for name in reversed(content.bodies) if name in known]
    return "".join(
        f'<div><dt>{escape(label)}\'s yaw<code data-formula="{escape(name)}">{escape(known[name])}</code></dt>'
        f'<dd data-yaw="{escape(name)}">{_angle(float(yaw[0]))}</dd></div>'
        for name, label, yaw in rows
        if yaw is not None
    )


def _numbers(content: Content, reading: Reading) -> str:
    """List the numbers that a reading reads, and the action, in the frame that the picture shows."""
    wanted = {locate(name, reading.feature, content.schema) for name in reading.names}
    if reading.action and not reading.missing_action(content.schema):
        wanted |= {locate(name, ACTION, content.schema) for name in reading.action.columns}
    places = sorted(content.place(*each) for each in wanted)
    labels = [content.columns[place][1] for place in places]
    last = content.shown.to_index[0] - 1
    rows = []
    for place in places:
        name, label = content.columns[place]
        value = content.frames[name][last, place - content.place(name, 0)]
        said = label if labels.count(label) == 1 else f"{name}: {label}"  # a joint and its target have one name
        unit = escape(reading.meaning(name, label).unit)
        cells = f'<dd data-column="{place}">{value:.4f}</dd><dd class="unit">{unit}</dd>'
        rows.append(f"<div><dt>{escape(printable(said))}</dt>{cells}</div>")
    return "".join(rows)


def _key(content: Content, reading: Reading) -> str:
    swatches: list[tuple[str, str]] = [(body.role, body.label) for body in reversed(content.bodies.values())]
    if reading.action:
        swatches.append(("action", "action, one frame ahead"))
    unit = next(iter(reading.poses.values())).unit
    swatches.append(("grid", grid_text(camera_of(content, reading), unit)))
    return "".join(f'<li><i class="swatch {kind}"></i>{escape(label)}</li>' for kind, label in swatches)


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
    return rows + [cells.format(escape(printable(dim)), low[i], high[i]) for i, dim in enumerate(feature.labels)]


def _episode_table(view: View) -> str:
    episodes = view.episodes
    rows = [_episode_row(view, episode) for episode in range(min(len(episodes), _MAX_EPISODE_ROWS))]
    more = len(episodes) - len(rows)
    return fill(
        "episodes.html",
        name=view.name,
        hidden="hidden" if view.mode else "",
        outcome_heads=_outcome_heads(view),
        rows="".join(rows),
        more=f'<p class="note">and {more:,} more episodes</p>' if more else "",
    )


def _outcome_heads(view: View) -> str:
    heads: list[str] = []
    if view.outcome and view.reading:
        units = {goal.name: view.reading.unit(goal) for goal in view.reading.goal}
        heads += [*(f"{name} [{unit}]" if unit else name for name, unit in units.items()), "reached"]
    if view.stored:
        heads.append("stored")
    return "".join(f"<th>{escape(head)}</th>" for head in heads)


def _episode_row(view: View, episode: int) -> str:
    episodes, outcome = view.episodes, view.outcome
    cells = [f"{episodes.from_index[episode]:,}", f"{episodes.lengths[episode]:,}"]
    if outcome:
        cells += [f"{numbers[episode]:.3f}" for numbers in outcome.final_errors.values()]
        cells += ["yes" if outcome.reached[episode] else "no"]
    if view.stored:
        cells += ["yes" if view.stored.any_frame[episode] else "no"]
    return (
        f'<tr><th scope="row">{episodes.number(episode)}</th>' + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>"
    )
