"""How a page is written: HTML that reads with JavaScript off. Whatever comes from a dataset is escaped."""

import base64
import hashlib
import math
from collections import Counter
from html import escape
from pathlib import Path

import msgspec
import numpy as np

from z2r.audits.findings import Finding
from z2r.check import SEVERITIES
from z2r.errors import count, printable
from z2r.format.episodes import EpisodeIndex
from z2r.format.schema import ACTION, STATE, Schema
from z2r.reading.decode import Decoded
from z2r.reading.goal import Goal
from z2r.reading.inspection import Inspection, Outcome
from z2r.reading.reading import ColumnMeaning, Reading, locate
from z2r.reading.stored import REWARD, SUCCESS, StoredSuccess
from z2r.reading.success import frame_errors
from z2r.show.page.content import Content, View
from z2r.show.page.films import Film
from z2r.show.page.pictures import camera_of, fill, grid_text, range_bar, ribbon, scene
from z2r.show.page.script_data import formulas, limit_text, script_data

_FOLDER = Path(__file__).parent
_MAX_EPISODE_ROWS = 100
_MAX_SCHEMA_ROWS = 400
_MAX_LINKS = 12  # to the episodes of one finding
_LABELS = {"success": {*SUCCESS}, "reward": {REWARD}}  # the columns that could say what was reached


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
        about=_about(content.inspection),
        switch="".join(_switch(view, content) for view in content.views) if len(content.views) > 1 else "",
        answers="".join(_answer(view, content) for view in content.views),
        left_out=f'<p class="note">{content.left_out}</p>' if content.left_out else "",
        kind="" if _has_poses(content) else "filmed" if content.films else "plain",
        player=_player(content),
        findings=_findings(content),
        facts_of_frames=_facts_of_frames(content.inspection),
        schema=_schema(content.inspection),
        episode_tables="".join(_episode_table(view, content) for view in content.views),
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


def _about(inspection: Inspection) -> str:
    """List what the dataset says of itself: its robot, its tasks, its cameras."""
    return "".join(
        f"<div><dt>{kind}</dt>" + "".join(f"<dd>{escape(printable(line))}</dd>" for line in lines) + "</div>"
        for kind, lines in inspection.about.lines.items()
    )


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


def _has_poses(content: Content) -> bool:
    return content.inspection.reading is not None and bool(content.inspection.reading.poses)


def _player(content: Content) -> str:
    """Show the last shown frame of the first episode: a picture where there are poses, and every dimension."""
    commanded = any(chart.command is not None for chart in content.charts)
    return fill(
        "player.html",
        stage=_stage(content),
        side=_side(content),
        commanded='<span><i class="swatch command"></i>command</span>' if commanded else "",
    )


def _stage(content: Content) -> str:
    """Draw the world where a reading has one, and make room for the cameras."""
    reading = content.inspection.reading
    world = ""
    if reading and reading.poses:
        world = f'{scene(content, reading, "scene")}<ul class="key">{_key(content, reading)}</ul>'
    cameras = "".join(_camera(film) for film in content.films)
    if not world + cameras:
        return ""
    return (
        f'<div class="stage">{world}{f"""<div id="cameras" class="cameras">{cameras}</div>""" if cameras else ""}</div>'
    )


def _camera(film: Film) -> str:
    """Make room for a camera, with what stands there as long as nothing plays."""
    missing = film.missing if not film.clips else "It plays where scripts run."
    parts = {"name": film.camera.name, "says": film.camera.says, "missing": missing}
    return fill("camera.html", **{key: escape(printable(text)) for key, text in parts.items()})


def _side(content: Content) -> str:
    """List what a reading makes of the frame: its goals, its yaws, and the numbers that it reads."""
    reading = content.inspection.reading
    if reading is None or not (reading.goal or reading.poses):
        return ""
    last = content.decoded(reading).take(slice(content.shown.to_index[0] - 1, content.shown.to_index[0]))
    return fill(
        "side.html",
        number=str(content.shown.number(0)),
        traces=_traces(content, last),
        decoded=_decoded(content, last),
        numbers=_numbers(content, reading) if reading.poses else "",  # else each has a chart
    )


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


def _findings(content: Content) -> str:
    """List what the audit found, the worst first, and what it did not look at."""
    audit = content.audit
    if audit is None:
        return '<p class="note">Nobody has looked for faults here: <code>z2r audit</code> does.</p>'
    found = sorted(audit.findings, key=lambda each: SEVERITIES.index(each.severity))
    tally = Counter(each.severity for each in found)
    counts = ", ".join(count(tally[severity], severity) for severity in SEVERITIES if tally[severity])
    more = [f"{check}: {number:,} more like it" for check, number in audit.more.items()]
    return fill(
        "findings.html",
        counts=escape("; ".join([counts or "Nothing is wrong, as far as was checked", *more])) + ".",
        findings="".join(_finding(each, content) for each in found),
        open="" if found else " open",
        n_not_checked=f"{len(audit.not_checked)}",
        not_checked="".join(f"<li>{escape(printable(each))}</li>" for each in audit.not_checked),
    )


def _finding(finding: Finding, content: Content) -> str:
    """Say what is wrong, and link every episode that it is about; the frame that it names comes first."""
    place = content.place_of(finding.frame)
    links = [_link(content.shown, *place)] if place else []
    others = [number for number in finding.episodes if not place or number != place[0]]
    links += [_link(content.shown, number) for number in others[:_MAX_LINKS]]
    more = f" and {len(others) - _MAX_LINKS:,} more" if len(others) > _MAX_LINKS else ""
    parts = {
        "check": finding.check,
        "found": finding.found,
        "expected": finding.expected,
        "mend": f" {finding.mend}." if finding.mend else "",
        "where": ": ".join(filter(None, [finding.file, finding.field])),
    }
    return fill(
        "finding.html",
        severity=finding.severity,
        episodes=f'<p class="episodes">Episode {" ".join(links)}{more}</p>' if links else "",
        **{key: escape(printable(text)) for key, text in parts.items()},
    )


def _link(shown: EpisodeIndex, number: int, frame: int | None = None) -> str:
    """Name an episode, and a frame of it; as a link where the page holds them."""
    said, to = f"{number}", f"#episode={number}"
    if frame is not None:
        said, to = f"{number}, frame {frame:,}", f"{to}&amp;frame={frame}"
    return f'<a href="{to}">{said}</a>' if number in shown.numbers else said


def _facts_of_frames(inspection: Inspection) -> str:
    """Say what a policy is fitted to, and what the frames lack."""
    schema, sentences = inspection.schema, []
    if STATE in inspection.ranges and ACTION in inspection.ranges:
        pairs = f"{inspection.episodes.n_frames:,} (state, action) pairs"
        sentences.append(f"{pairs}: behaviour cloning fits state \u2192 action to exactly these rows.")
    lacking = [what for what, names in _LABELS.items() if not schema.features.keys() & names]
    if lacking:
        sentences.append(f"There is no {' and no '.join(lacking)} column.")
    return f'<p class="note">{" ".join(sentences)}</p>' if sentences else ""


def _schema(inspection: Inspection) -> str:
    """Return a table for each feature of numbers, up to a limit, and the list of the others."""
    tables, n_rows = [], 0
    for name in inspection.ranges:
        rows = _dimension_rows(name, inspection)[: _MAX_SCHEMA_ROWS - n_rows]
        n_rows += len(rows)
        if rows:
            tables.append(
                fill(
                    "schema.html",
                    name=_heading(name, inspection.schema),
                    rows="".join(rows),
                    limits=_limits(name, inspection),
                )
            )
    left = sum(len(ranges.mean) for ranges in inspection.ranges.values()) - n_rows
    if left:
        tables.append(f'<p class="note">and {left:,} more dimensions</p>')
    others = "".join(
        f"<li>{_heading(name, inspection.schema)}</li>"
        for name in inspection.schema.features
        if name not in inspection.ranges
    )
    return "".join(tables) + (f'<div class="feature"><h3>and</h3><ul>{others}</ul></div>' if others else "")


def _heading(name: str, schema: Schema) -> str:
    feature = schema.features[name]
    kind = feature.dtype if feature.shape == (1,) else f"{feature.dtype}[{', '.join(map(str, feature.shape))}]"
    return f"{escape(printable(name))} <span>{escape(printable(kind))}</span>"


def _dimension_rows(name: str, inspection: Inspection) -> list[str]:
    """Return a row for each dimension: its range and mean as numbers, and as a bar on the scale of the feature."""
    ranges, meanings = inspection.ranges[name], _meanings(name, inspection)
    low, high = ranges.low.min(axis=0).astype(np.float64), ranges.high.max(axis=0).astype(np.float64)
    limits = [end for _, each in meanings for end in (each.low, each.high) if end is not None]
    ends = np.array([*low, *high, *limits])
    ends = ends[np.isfinite(ends)]
    scale = (float(ends.min()), float(ends.max())) if len(ends) else (0.0, 0.0)
    return [
        fill(
            "dimension.html",
            name=escape(printable(label)),
            unit=escape(printable(meaning.unit)),
            low=f"{low[i]:.3f}",
            mean=f"{ranges.mean[i]:.3f}",
            high=f"{high[i]:.3f}",
            bar=range_bar(low[i], ranges.mean[i], high[i], scale),
        )
        for i, (label, meaning) in enumerate(meanings)
    ]


def _meanings(feature: str, inspection: Inspection) -> list[tuple[str, ColumnMeaning]]:
    """Return the label of each dimension of a feature, and what is known of it."""
    reading, labels = inspection.reading, inspection.schema.features[feature].labels
    return [(label, reading.meaning(feature, label) if reading else ColumnMeaning()) for label in labels]


def _limits(feature: str, inspection: Inspection) -> str:
    """Say the limits that are declared, each once, with the dimensions that have them."""
    within: dict[str, list[str]] = {}
    for label, meaning in _meanings(feature, inspection):
        if said := _limit(meaning):
            within.setdefault(said, []).append(label)
    verb = "clipped to" if feature == ACTION else "limits"
    said = "; ".join(f"{', '.join(labels)}: {verb} {limit}" for limit, labels in within.items())
    return f'<p class="note">{escape(printable(said))}</p>' if said else ""


def _limit(meaning: ColumnMeaning) -> str:
    low, high = meaning.low, meaning.high
    if low is not None and high is not None:
        said = f"\u00b1{high:g}" if low == -high else f"{low:g} to {high:g}"
    elif low is None and high is None:
        return ""
    else:
        said = f"at most {high:g}" if low is None else f"at least {low:g}"
    return f"{said} {meaning.unit}".strip()


def _episode_table(view: View, content: Content) -> str:
    episodes = view.episodes
    rows = [_episode_row(view, episode, content) for episode in range(min(len(episodes), _MAX_EPISODE_ROWS))]
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


def _episode_row(view: View, episode: int, content: Content) -> str:
    episodes, outcome = view.episodes, view.outcome
    cells = [f"{episodes.from_index[episode]:,}", f"{episodes.lengths[episode]:,}"]
    if outcome:
        cells += [f"{numbers[episode]:.3f}" for numbers in outcome.final_errors.values()]
        cells += ["yes" if outcome.reached[episode] else "no"]
    if view.stored:
        cells += ["yes" if view.stored.any_frame[episode] else "no"]
    return (
        f'<tr data-episode="{episode}"><th scope="row">{_link(content.shown, episodes.number(episode))}</th>'
        + "".join(f"<td>{cell}</td>" for cell in cells)
        + "</tr>"
    )
