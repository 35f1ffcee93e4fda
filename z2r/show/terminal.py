"""What `z2r inspect` prints, the two facts and what the reading makes of them, and what `z2r audit` does."""

import contextlib
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from itertools import zip_longest
from typing import TYPE_CHECKING

import numpy as np
from rich import box
from rich.console import Console, ConsoleOptions, Group, RenderableType, RenderResult
from rich.measure import Measurement
from rich.padding import Padding
from rich.progress_bar import ProgressBar
from rich.table import Table
from rich.text import Text

from z2r.audits.edit import PROGRAM
from z2r.audits.findings import Finding
from z2r.check import SEVERITIES, Check, Severity
from z2r.errors import count, printable, short, some
from z2r.format.about import About, short_names
from z2r.format.schema import Schema
from z2r.format.store import bytes_fetched
from z2r.reading.breaks import BreakMode
from z2r.reading.inspection import Inspection
from z2r.reading.stored import StoredSuccess
from z2r.reading.verdict import Recording, verdict_path
from z2r.show import wallclock
from z2r.show.listing import Listed

if TYPE_CHECKING:  # `z2r inspect` has no use for it
    from z2r.audits.audit import Audit
    from z2r.audits.beliefs import Belief, Beliefs
    from z2r.audits.explain import Explanation

MAX_ROWS = 20  # of a table: what fits on a screen

_SEVERITY_STYLES: dict[Severity, str] = {"error": "bold red", "warning": "bold yellow", "note": "bold blue"}


def expectation(command: str, size: int) -> Text:
    """Say which machine tier this is, and what the ledger has measured there for a run like the one to come."""
    tier = wallclock.machine_tier()
    return Text(f"machine tier {tier}: {wallclock.expectation(command, size, tier)}", style="dim")


def wrong_on_purpose(mode: BreakMode, applies: bool = True, columns: Sequence[str] = ()) -> Text:
    """Say what is read wrong, of which columns if it is about some, and what that looks like."""
    return Text.assemble(
        (f"Reading it wrong on purpose: {mode.name}", "bold yellow"),
        f"\n  what is believed: {mode.assumption}",
        f"\n  of the columns:   {printable(some(columns))}" if columns else "",
        f"\n  its signature:    {mode.signature}",
        "" if applies else f"\n  here it changes nothing: it is about {mode.about}",
    )


def summary(inspection: Inspection, title: str, given: bool = False) -> RenderableType:
    """Return the whole summary, ready to print; `given` says whether somebody asked for the reading."""
    schema, episodes = inspection.schema, inspection.episodes
    lengths = episodes.lengths
    seconds = episodes.n_frames / schema.fps
    head = Text.assemble(
        (printable(title), "bold"),
        f"  {count(len(episodes), 'episode')}, {count(episodes.n_frames, 'frame')} at {schema.fps:g} fps"
        f" ({seconds:,.1f} s), LeRobot {printable(schema.codebase_version)}",
    )
    spread = f"\nlengths: {lengths.min()} to {lengths.max()} frames, {lengths.mean():.1f} on average"
    tables = (_schema_table(inspection), _action(inspection), _Episodes(inspection))
    return Group(
        head,
        _about(inspection.about),
        *(part for table in tables for part in (Text(), table)),
        Text(spread),
        _reached(inspection, given),
        *_stored(inspection),
    )


def _about(about: About) -> Table:
    """Return what the dataset says of itself, a line for each."""
    lines = Table.grid(padding=(0, 2))
    lines.add_column(style="dim", no_wrap=True)
    lines.add_column(overflow="fold")
    for kind, said in about.lines.items():
        for name, line in zip_longest([kind], said, fillvalue=""):
            lines.add_row(name, printable(line))
    return lines


def audit_report(audit: "Audit", title: str) -> RenderableType:
    """Return the findings of an audit, the worst first, and what nobody looked at, ready to print."""
    head = Text.assemble(
        (printable(title), "bold"),
        f"  {count(audit.n_episodes, 'episode')}, {count(audit.n_frames, 'frame')}"
        if audit.readable
        else "  cannot be read",
    )
    worst_first = sorted(audit.findings, key=lambda finding: SEVERITIES.index(finding.severity))
    findings = [part for finding in worst_first for part in (Text(), _finding(finding))]
    left_out = [Text(f"{check}: {number:,} more like these", style="dim") for check, number in audit.more.items()]
    if audit.n_accepted:
        left_out.append(Text(f"accepted before, and left out: {count(audit.n_accepted, 'finding')}", style="dim"))
    not_checked = [Text(f"not checked: {printable(what)}", style="dim") for what in audit.not_checked]
    return Group(head, *findings, Text(), *left_out, _verdict(audit), *not_checked)


def check_list(checks: Sequence[Check]) -> RenderableType:
    """Return a table of what each check asks."""
    table = _table("What z2r audit asks")
    for name in ("check", "severity", "what holds where nothing is wrong"):
        table.add_column(name, overflow="fold")
    for check in checks:
        table.add_row(check.name, check.severity, check.asks)
    return table


def explained(check: Check, explanation: "Explanation") -> RenderableType:
    """Return what a check asks, why, where it happened and how to mend it, ready to print."""
    head = Text.assemble((check.name, "bold"), f"  {check.severity}")
    case = explanation.case or "none that is public and known to us"
    source = [Text(explanation.source, style="dim")] if explanation.source else []
    parts = {"asks": check.asks, "why": explanation.why, "mend": explanation.mend, "a real case": case}
    said = [part for name, text in parts.items() for part in (Text(), Text(name, style="bold"), Text(text.strip()))]
    return Group(head, *said, *source)


def beliefs_report(beliefs: "Beliefs", title: str) -> RenderableType:
    """Return a table of wrong beliefs, which of them the data refutes and by which checks, and which do not apply."""
    head = Text.assemble((printable(title), "bold"), f"  {count(beliefs.as_it_is.n_episodes, 'episode')}")
    table = _table("What the data says of wrong beliefs")
    for name in ("break mode", "what is believed", "refuted by"):
        table.add_column(name, overflow="fold")
    for belief in beliefs.beliefs:
        if not belief.lacking:
            columns = f" ({printable(some(belief.columns))})" if belief.columns else ""
            table.add_row(belief.mode, belief.believed + columns, _refuted_by(belief))
    verdicts = Counter(belief.verdict for belief in beliefs.beliefs)
    tally = f"{verdicts['refuted']} refuted, {verdicts['not refuted']} not refuted"
    left_out = [f"{each.mode}, which is about {each.lacking}" for each in beliefs.beliefs if each.lacking]
    notes = [f"does not apply: {each}" for each in left_out]
    notes += [f"refutes nothing: {check}, which finds something in the data as it is" for check in beliefs.found_anyway]
    return Group(head, Text(), table, Text(), Text(tally, style="bold"), *(Text(line, style="dim") for line in notes))


def _refuted_by(belief: "Belief") -> Text:
    if not belief.refuted_by:
        return Text("not refuted", style="bold yellow")
    return Text(", ".join(belief.refuted_by), style="green")


def listing(found: Sequence[Listed]) -> RenderableType:
    """Return a table of datasets, and below it why some of them cannot be read."""
    table = _table("What is there")
    for name in ("name", "where", "episodes", "frames", "fps", "robot", "cameras"):
        table.add_column(name, justify="right" if name in ("episodes", "frames", "fps") else "left", overflow="fold")
    for each in found:
        table.add_row(*map(printable, _listed(each)))
    broken = [Text(f"{printable(each.name)}: {each.fault}", style="yellow") for each in found if each.fault]
    return Group(table, *([Text(), *broken] if broken else []))


def _listed(each: Listed) -> tuple[str, ...]:
    if each.fault:
        return each.name, each.where, "?", "?", "?", "", ""
    cameras = short_names(each.cameras)
    counts = f"{each.n_episodes:,}", f"{each.n_frames:,}", f"{each.fps:g}"
    return each.name, each.where, *counts, short(each.robot_type or ""), some(cameras)


def left_out(lines: Sequence[str]) -> Text:
    """Say which episodes of a damaged dataset are not in what was read."""
    said = "".join(f"\n  {printable(line)}" for line in lines) or " nothing"
    return Text.assemble(("left out:", "bold yellow"), said)


def _finding(finding: Finding) -> RenderableType:
    where = " ".join(filter(None, [finding.file, finding.field]))
    lines = Table.grid(padding=(0, 1))
    lines.add_column(style="dim", justify="right", no_wrap=True)
    lines.add_column(overflow="fold")
    advice, command, options = finding.mend.partition(f"{PROGRAM} --")
    for name, text in (("found", finding.found), ("expected", finding.expected), ("mend", advice)):
        if text:
            lines.add_row(name, printable(text))
    style = _SEVERITY_STYLES[finding.severity]
    title = Text.assemble((finding.severity, style), "  ", (finding.check, "bold"), "  ", printable(where))
    parts: list[RenderableType] = [title, Padding(lines, (0, 0, 0, 2))]
    if command:  # one line, however long: it is there to be copied
        parts.append(Text(printable(command + options), overflow="ignore", no_wrap=True))
    return Group(*parts)


def _verdict(audit: "Audit") -> Text:
    counts = Counter(finding.severity for finding in audit.findings)
    said = ", ".join(count(counts[severity], severity) for severity in _SEVERITY_STYLES if counts[severity])
    if counts["error"] or counts["warning"]:
        return Text(said, style="bold red" if counts["error"] else "bold yellow")
    nothing = "nothing wrong was found in what was checked"
    return Text(f"{nothing}; {said}" if said else nothing, style="bold green")


def _table(title: str) -> Table:
    return Table(
        title=title, title_justify="left", title_style="bold", box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False
    )


def _schema_table(inspection: Inspection) -> Table:
    table = _table("What a frame is")
    for name in ("feature", "dtype", "dimension"):
        table.add_column(name, overflow="fold")
    for name in ("low", "high"):
        table.add_column(name, justify="right", no_wrap=True)
    rows = _schema_rows(inspection)
    for row in rows[: 2 * MAX_ROWS]:
        table.add_row(*map(printable, row))
    if len(rows) > 2 * MAX_ROWS:
        table.add_row(Text(f"and {len(rows) - 2 * MAX_ROWS:,} more dimensions", style="dim"))
    return table


def _schema_rows(inspection: Inspection) -> list[tuple[str, ...]]:
    rows: list[tuple[str, ...]] = []
    for name, feature in inspection.schema.features.items():
        if name not in inspection.ranges:
            rows.append((name, feature.dtype, _shape(inspection.schema, name), "", ""))
            continue
        low, high = inspection.ranges[name].low.min(axis=0), inspection.ranges[name].high.max(axis=0)
        for place, label in enumerate(feature.labels):
            first = (name, feature.dtype) if place == 0 else ("", "")
            rows.append((*first, label, f"{low[place]:.3f}", f"{high[place]:.3f}"))
    return rows


def _action(inspection: Inspection) -> RenderableType:
    """Say what each dimension of the action is, as far as the data tells."""
    if not inspection.action:
        return Text("no action in the dataset", style="dim")
    table = _table("What the action is, inferred from how the state follows it")
    table.show_header = False
    table.add_column(overflow="fold")
    table.add_column(overflow="fold")
    for driven in inspection.action[:MAX_ROWS]:
        style = "yellow" if driven.kind == "unknown" else ""
        table.add_row(printable(driven.name), Text(printable(driven.evidence), style=style))
    if len(inspection.action) > MAX_ROWS:
        table.add_row("...", Text(f"and {len(inspection.action) - MAX_ROWS:,} more", style="dim"))
    return table


def _shape(schema: Schema, name: str) -> str:
    shape = schema.features[name].shape
    return "" if shape == (1,) else " x ".join(str(size) for size in shape)


@dataclass(frozen=True)
class _Episodes:
    """The table of the episodes; where a terminal is too narrow for all of it, without its bars."""

    inspection: Inspection

    def __rich_console__(self, console: Console, options: ConsoleOptions) -> RenderResult:
        with_bars = _episode_table(self.inspection, bars=True)
        needed = Measurement.get(console, options.update(max_width=1000), with_bars).minimum
        yield with_bars if needed <= options.max_width else _episode_table(self.inspection, bars=False)


def _episode_table(inspection: Inspection, *, bars: bool) -> Table:
    n_episodes = len(inspection.episodes)
    table = _table("Where episodes end")
    for name in ("episode", "from", "length"):
        table.add_column(name, justify="right", overflow="fold")
    if bars:
        table.add_column("", width=12)
    for name in _outcome_columns(inspection):
        table.add_column(name, justify="right", overflow="fold")
    for episode in range(min(n_episodes, MAX_ROWS)):
        bar = [_bar(inspection, episode)] if bars else []
        table.add_row(*_place(inspection, episode), *bar, *_ending(inspection, episode))
    if n_episodes > MAX_ROWS:
        table.caption, table.caption_justify = Text(f"... and {n_episodes - MAX_ROWS:,} more", style="dim"), "left"
    return table


def _place(inspection: Inspection, episode: int) -> tuple[str, ...]:
    episodes = inspection.episodes
    return str(episodes.number(episode)), str(episodes.from_index[episode]), str(episodes.lengths[episode])


def _bar(inspection: Inspection, episode: int) -> RenderableType:
    """Draw the length of an episode; rich draws this bar in ASCII where the terminal has nothing else."""
    lengths = inspection.episodes.lengths
    longest, length = float(lengths.max()), float(lengths[episode])
    return ProgressBar(longest, length, width=12, complete_style="blue", finished_style="blue")


def _ending(inspection: Inspection, episode: int) -> Iterator[RenderableType]:
    outcome, stored = inspection.outcome, inspection.stored
    if outcome:
        yield from (f"{numbers[episode]:.3f}" for numbers in outcome.final_errors.values())
        yield _yes_or_no(bool(outcome.reached[episode]))
    if stored:
        yield _yes_or_no(bool(stored.any_frame[episode]))


def _yes_or_no(answer: bool) -> Text:
    return Text("yes" if answer else "no", style="green" if answer else "red")


def _outcome_columns(inspection: Inspection) -> list[str]:
    """Name what is said of each episode's end: a column for each goal, the answer, and what the dataset says of it."""
    reading, stored = inspection.reading, ["stored"] if inspection.stored else []
    if inspection.outcome is None or reading is None:
        return stored
    units = {goal.name: reading.unit(goal) for goal in reading.goal}
    return [*(f"{name} [{unit}]" if unit else name for name, unit in units.items()), "reached", *stored]


def _reached(inspection: Inspection, given: bool) -> Text:
    outcome, reading = inspection.outcome, inspection.reading
    if outcome is None or reading is None:
        why = f"{printable(inspection.why_unknown)}: z2r reading drafts one to fill in"
        return Text(f"reached: unknown, for {why}", style="yellow")
    says = " and ".join(goal.says(reading.unit(goal)) for goal in reading.goal)
    frame = "last stored" if reading.decisive == "last" else "first"
    return Text.assemble(
        (f"reached {reading.destination}: ", "bold"),
        (f"{outcome.n_reached}/{len(outcome.reached)}", "bold green" if np.all(outcome.reached) else "bold yellow"),
        f" ({outcome.share_reached:.0%})",
        (f"\ndeclared by the reading {printable(reading.name)}{'' if given else ', which ships and fits'}: ", "dim"),
        (f"{says} in the {frame} frame", "dim"),
    )


def _stored(inspection: Inspection) -> Iterator[Text]:
    """Say what the dataset itself calls a success, and whether the reading agrees."""
    stored = inspection.stored
    if stored:
        style = "bold green" if np.all(stored.any_frame) else "bold yellow"
        yield Text.assemble(("stored: ", "bold"), (stored.says, style))
    if inspection.agreement:
        yield Text(f"reached and stored: {inspection.agreement}", style="dim")
    if inspection.stored_note:
        yield Text(f"stored: {inspection.stored_note}", style="yellow")


def graded(inspection: Inspection, recording: Recording) -> Text:
    """Say which episodes the verdict beside a dataset calls a success, and whether the reading agrees."""
    success = recording.success_of(inspection.episodes)
    if success is None:
        frames = sum(each.n_frames for each in recording.episodes)
        of_others = f"{count(len(recording.episodes), 'episode')} with {count(frames, 'frame')}"
        return Text(f"verdict: it is of others, {of_others}, and is not compared", style="yellow")
    verdict = StoredSuccess(printable(verdict_path(inspection.dataset.root).name), success, success)
    said = Text.assemble(
        ("verdict: ", "bold"), (f"success in {verdict.says}", "bold green" if success.all() else "bold yellow")
    )
    if inspection.outcome:
        agreement = verdict.agreement(inspection.outcome.reached, inspection.episodes)
        said.append(f"\nreached and verdict: {agreement}", "dim")
    return said


def console(quiet: bool = False) -> Console:
    """Return a console that prints what it is given and interprets no markup in it; if `quiet`, it prints nothing."""
    return Console(quiet=quiet, markup=False, emoji=False, highlight=False)


@contextlib.contextmanager
def progress(doing: str, unit: str, quiet: bool) -> Iterator[Callable[[int, int], None]]:
    """Show a progress bar on stderr while something runs; lend the function that moves it: (done, total).

    It also counts the bytes that are fetched, as soon as there are any: a large file moves nothing else for a while.
    """
    screen = Console(stderr=True)
    if quiet or not screen.is_terminal:
        yield lambda done, total: None
        return
    from rich.filesize import decimal
    from rich.progress import (
        BarColumn,
        MofNCompleteColumn,
        Progress,
        ProgressColumn,
        TextColumn,
        TimeRemainingColumn,
    )

    class Fetched(ProgressColumn):
        def render(self, task: object) -> Text:
            return Text(f"{decimal(n_bytes)} fetched" if (n_bytes := bytes_fetched()) else "")

    columns = (TextColumn(doing), BarColumn(), MofNCompleteColumn(), TextColumn(unit), TimeRemainingColumn(), Fetched())
    with Progress(*columns, console=screen, transient=True) as bar:
        task = bar.add_task(doing, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)
