"""What does a page say? The words and numbers of its templates; what is markup, they say."""

import base64
import hashlib
import math
from collections import Counter

import msgspec
import numpy as np

from z2r.audits.audit import Audit
from z2r.audits.findings import Finding
from z2r.check import SEVERITIES
from z2r.errors import count
from z2r.format.schema import ACTION, STATE, Feature
from z2r.reading.goal import Goal
from z2r.reading.inspection import Inspection
from z2r.reading.reading import ColumnMeaning, Reading, locate
from z2r.reading.stored import REWARD, SUCCESS
from z2r.reading.success import frame_errors
from z2r.show.page.content import Content, View
from z2r.show.page.pictures import range_bar, ribbon, scene
from z2r.show.page.script_data import formulas, limit_text, script_data
from z2r.show.page.templates import FOLDER, fill

_MAX_EPISODE_ROWS = 100
_MAX_SCHEMA_ROWS = 400
_MAX_LINKS = 12  # to the episodes of one finding
_LABELS = {"success": {*SUCCESS}, "reward": {REWARD}}  # the columns that could say what was reached

type _Parts = dict[str, object]


def render(content: Content, *, in_notebook: bool = False) -> str:
    """Return the whole page; in a notebook, whose reader may have to predict what they show, wrong readings wait."""
    script, base, own = (_read(name) for name in ("page.js", "base.css", "page.css"))
    style = base + own
    inspection, reading = content.inspection, content.inspection.reading
    world = scene(content, reading) if reading and reading.poses else None
    return fill(
        "page.html",
        title=content.title,
        question=_question(content),
        script=script,
        script_hash=_csp_hash(script),
        style=style,
        style_hash=_csp_hash(style),
        facts=_facts(inspection),
        about=inspection.about.lines,
        in_notebook=in_notebook,
        readings={view.name: _believed(view, reading) for view in content.views},
        answers=[_answer(view, content) for view in content.views],
        left_out=content.left_out,
        kind="" if world else "filmed" if content.films else "plain",
        world=world,
        films=content.films,
        side=_side(content, reading) if reading and (reading.goal or reading.poses) else None,
        commanded=any(chart.command is not None for chart in content.charts),
        audit=content.audit and _audited(content.audit, content),
        shown=content.shown.numbers,
        episode_tables=[_episode_table(view) for view in content.views],
        facts_of_frames=_facts_of_frames(inspection),
        features=_features(inspection),
        data=_json(script_data(content)),
    )


def _read(name: str) -> str:
    return (FOLDER / name).read_text(encoding="utf-8")


def _csp_hash(text: str) -> str:
    return f"sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}"


def _json(data: object) -> str:
    """Return JSON that cannot end the element it stands in."""
    return msgspec.json.encode(data).decode().replace("<", "\\u003c")


def _facts(inspection: Inspection) -> dict[str, str]:
    schema, episodes = inspection.schema, inspection.episodes
    lengths = episodes.lengths
    return {
        "episodes": f"{len(episodes):,}",
        "frames": f"{episodes.n_frames:,}",
        "frames a second": f"{schema.fps:g}",
        "seconds": f"{episodes.n_frames / schema.fps:,.1f}",
        "frames an episode": f"{lengths.min():,} to {lengths.max():,}",
        "on average": f"{lengths.mean():,.1f}",
        "LeRobot format": schema.codebase_version,
    }


def _believed(view: View, reading: Reading | None) -> str:
    return view.mode.assumption if view.mode else f"as the reading {reading.name if reading else ''} has it"


def _question(content: Content) -> str:
    if content.inspection.outcome is None and content.inspection.stored:
        return "How many does the dataset call a success?"
    return f"How many reached {content.destination}?"


def _answer(view: View, content: Content) -> _Parts:
    """Say how many episodes reached the goal in this view, or are stored as a success, above a ribbon of all."""
    said = _what_was_reached(view, content) or _what_is_stored(view, content) or _what_is_unknown(view, content)
    return {"name": view.name, "ribbon": ribbon(view, content), **said}


def _what_was_reached(view: View, content: Content) -> _Parts:
    if not (view.outcome and view.reading):
        return {}
    return {
        "percent": f"{view.outcome.share_reached:.0%}",
        "tally": view.outcome.tally,
        "claim": f"reached {content.destination}",
        "source": content.source,
        "note": _note(view, view.reading),
        "fine": "reached",
        "other": "not reached",
        **_beside(view, content.inspection),
    }


def _what_is_stored(view: View, content: Content) -> _Parts:
    if not view.stored:
        return {}
    why = f"Whether they reached their goal cannot be told from the rest: {content.inspection.why_unknown}."
    return {
        "percent": f"{view.stored.share:.0%}",
        "tally": view.stored.tally,
        "claim": "called a success by the dataset",
        "source": "stored",
        "note": f"It says {view.stored.says}. {why}",
        "fine": "success",
        "other": "no success",
        "stored": "",
    }


def _what_is_unknown(view: View, content: Content) -> _Parts:
    why = f"How many episodes reached their goal cannot be told: {content.inspection.why_unknown}."
    return {"percent": "", "claim": "Reached or not: unknown", "note": why, **_beside(view, content.inspection)}


def _beside(view: View, inspection: Inspection) -> _Parts:
    """Say what the dataset itself calls a success beside what is read, or why that says nothing."""
    if view.stored is None:
        return {"is_stored": False, "stored": inspection.stored_note}
    agreement = "" if view.mode else inspection.agreement
    said = f"called a success by the dataset: {view.stored.says}" + (f"; {agreement}" if agreement else "")
    return {"is_stored": True, "stored": said}


def _note(view: View, reading: Reading) -> str:
    if view.mode:
        return f"Read wrong on purpose. What gives it away: {view.mode.signature}."
    said = " and ".join(goal.says(reading.unit(goal)) for goal in reading.goal)
    frame = "last stored" if reading.decisive == "last" else "first"
    return f"Read off the {frame} frame of each episode, as the reading {reading.name} has it: is {said}?"


def _side(content: Content, reading: Reading) -> _Parts:
    """List what a reading makes of the last shown frame of the first episode: goals, yaws, the numbers that it reads.

    Of yaws, the last ones of the drawing come first. Without poses, each number has a chart.
    """
    end = int(content.shown.to_index[0])
    last = content.decoded(reading).take(slice(end - 1, end))
    errors, known = frame_errors(last), formulas(reading)
    yaws = {pose: last.pose(pose).yaw for pose in reversed(content.bodies) if pose in known}
    return {
        "number": content.shown.number(0),
        "goals": [
            (
                content.goal_title(goal),
                _value(goal, float(errors[goal.name][0]), reading),
                goal.holds(errors[goal.name])[0],
                limit_text(reading, goal.name),
            )
            for goal in reading.goal
        ],
        "yaws": [
            (pose, content.label(pose), known[pose], _angle(float(yaw[0])))
            for pose, yaw in yaws.items()
            if yaw is not None
        ],
        "numbers": _numbers(content, reading, end - 1) if reading.poses else [],
    }


def _value(goal: Goal, number: float, reading: Reading) -> str:
    return _angle(number) if goal.turn else f"{number:.4f} {reading.unit(goal)}".strip()


def _angle(radians: float) -> str:
    return f"{radians:.4f} rad = {math.degrees(radians):.1f}°"


def _numbers(content: Content, reading: Reading, frame: int) -> list[tuple[int, str, str, str]]:
    """List the numbers that a reading reads, and the action: column, label, value and unit."""
    wanted = {locate(name, reading.feature, content.schema) for name in reading.names}
    if reading.action and not reading.missing_action(content.schema):
        wanted |= {locate(name, ACTION, content.schema) for name in reading.action.columns}
    places = sorted(content.place(*each) for each in wanted)
    labels = [content.columns[place][1] for place in places]
    rows = []
    for place in places:
        name, label = content.columns[place]
        value = content.frames[name][frame, place - content.place(name, 0)]
        said = label if labels.count(label) == 1 else f"{name}: {label}"  # a joint and its target have one name
        rows.append((place, said, f"{value:.4f}", reading.meaning(name, label).unit))
    return rows


def _audited(audit: Audit, content: Content) -> _Parts:
    """Say what the audit found, the worst first, and what it did not look at."""
    tally = Counter(each.severity for each in audit.findings)
    said = [] if audit.findings else ["Nothing is wrong, as far as was checked"]
    said += [f"{check}: {number:,} more like it" for check, number in audit.more.items()]
    return {
        "tally": {severity: count(tally[severity], severity) for severity in SEVERITIES if tally[severity]},
        "said": "; ".join(said),
        "findings": [
            _finding(each, content) for each in sorted(audit.findings, key=lambda each: SEVERITIES.index(each.severity))
        ],
        "not_checked": audit.not_checked,
    }


def _finding(finding: Finding, content: Content) -> tuple[Finding, tuple[int, int] | None, list[int], str]:
    """Return it with the frame that it names, with other episodes that it is about, and how many more there are."""
    place = content.place_of(finding.frame)
    others = [number for number in finding.episodes if not place or number != place[0]]
    more = f"{len(others) - _MAX_LINKS:,}" if len(others) > _MAX_LINKS else ""
    return finding, place, others[:_MAX_LINKS], more


def _facts_of_frames(inspection: Inspection) -> str:
    """Say what a policy is fitted to, and what the frames lack."""
    schema, sentences = inspection.schema, []
    if STATE in inspection.ranges and ACTION in inspection.ranges:
        pairs = f"{inspection.episodes.n_frames:,} (state, action) pairs"
        sentences.append(f"{pairs}: behaviour cloning fits state \u2192 action to exactly these rows.")
    lacking = [what for what, names in _LABELS.items() if not schema.features.keys() & names]
    if lacking:
        sentences.append(f"There is no {' and no '.join(lacking)} column.")
    return " ".join(sentences)


def _features(inspection: Inspection) -> _Parts:
    """Return a table for each feature of numbers, up to a limit, and the others."""
    features, room = inspection.schema.features, _MAX_SCHEMA_ROWS
    tables: list[tuple[str, str, list[tuple[object, ...]], str]] = []
    for name, ranges in inspection.ranges.items():
        if room > 0:
            tables.append(
                (name, _kind(features[name]), _dimensions(name, inspection)[:room], _limits(name, inspection))
            )
        room -= len(ranges.mean)
    return {
        "tables": tables,
        "left": f"{-room:,}" if room < 0 else "",
        "others": [(name, _kind(feature)) for name, feature in features.items() if name not in inspection.ranges],
    }


def _kind(feature: Feature) -> str:
    return feature.dtype if feature.shape == (1,) else f"{feature.dtype}[{', '.join(map(str, feature.shape))}]"


def _dimensions(name: str, inspection: Inspection) -> list[tuple[object, ...]]:
    """Return label, unit, range and mean of each dimension, as numbers, and as a bar on the scale of the feature."""
    ranges, meanings = inspection.ranges[name], _meanings(name, inspection)
    low, high = ranges.low.min(axis=0).astype(np.float64), ranges.high.max(axis=0).astype(np.float64)
    limits = [end for _, each in meanings for end in (each.low, each.high) if end is not None]
    ends = np.array([*low, *high, *limits])
    ends = ends[np.isfinite(ends)]
    scale = (float(ends.min()), float(ends.max())) if len(ends) else (0.0, 0.0)
    numbers = zip(low.tolist(), ranges.mean.tolist(), high.tolist(), strict=True)
    return [
        (label, meaning.unit, *(f"{number:z.3f}" for number in three), range_bar(*three, scale))
        for (label, meaning), three in zip(meanings, numbers, strict=True)
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
    return "; ".join(f"{', '.join(labels)}: {verb} {limit}" for limit, labels in within.items())


def _limit(meaning: ColumnMeaning) -> str:
    low, high = meaning.low, meaning.high
    if low is not None and high is not None:
        said = f"\u00b1{high:g}" if low == -high else f"{low:g} to {high:g}"
    elif low is None and high is None:
        return ""
    else:
        said = f"at most {high:g}" if low is None else f"at least {low:g}"
    return f"{said} {meaning.unit}".strip()


def _episode_table(view: View) -> _Parts:
    n_rows = min(len(view.episodes), _MAX_EPISODE_ROWS)
    more = len(view.episodes) - n_rows
    return {
        "name": view.name,
        "heads": _outcome_heads(view),
        "rows": [(view.episodes.number(episode), _episode_cells(view, episode)) for episode in range(n_rows)],
        "more": f"{more:,}" if more else "",
    }


def _outcome_heads(view: View) -> list[str]:
    heads: list[str] = []
    if view.outcome and view.reading:
        units = {goal.name: view.reading.unit(goal) for goal in view.reading.goal}
        heads += [*(f"{name} [{unit}]" if unit else name for name, unit in units.items()), "reached"]
    if view.stored:
        heads.append("stored")
    return heads


def _episode_cells(view: View, episode: int) -> list[str]:
    episodes, outcome = view.episodes, view.outcome
    cells = [f"{episodes.from_index[episode]:,}", f"{episodes.lengths[episode]:,}"]
    if outcome:
        cells += [f"{numbers[episode]:.3f}" for numbers in outcome.final_errors.values()]
        cells += ["yes" if outcome.reached[episode] else "no"]
    if view.stored:
        cells += ["yes" if view.stored.any_frame[episode] else "no"]
    return cells
