"""What `z2r inspect` prints, the two facts and what the reading makes of them, and what `z2r audit` does."""

import contextlib
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from typing import TYPE_CHECKING

import numpy as np
from rich import box
from rich.bar import Bar
from rich.console import Console, Group, RenderableType
from rich.padding import Padding
from rich.table import Table
from rich.text import Text

from z2r.audits.findings import Finding
from z2r.check import Severity
from z2r.errors import printable
from z2r.format.schema import Schema
from z2r.reading.breaks import BreakMode
from z2r.reading.inspection import Inspection
from z2r.show.wallclock import Run, machine_tier

if TYPE_CHECKING:  # `z2r inspect` has no use for it
    from z2r.audits.audit import Audit

MAX_ROWS = 20  # of a table: what fits on a screen

_SEVERITY_STYLES: dict[Severity, str] = {"error": "bold red", "warning": "bold yellow", "note": "bold blue"}


def expectation(run: Run | None, unit: str) -> Text:
    """Say which machine tier this is, and how long the ledger expects it to take."""
    tier = Text(f"machine tier {machine_tier()}: ", style="dim")
    if run is None:
        return tier.append("not yet measured")
    return tier.append(f"expect {run.seconds:.2g} s (median of {run.runs} runs, {run.size:,} {unit})")


def wrong_on_purpose(mode: BreakMode) -> Text:
    """Say what is read wrong, and what that looks like."""
    return Text.assemble(
        (f"Reading it wrong on purpose: {mode.name}", "bold yellow"),
        f"\n  what is believed: {mode.assumption}\n  its signature:    {mode.signature}",
    )


def summary(inspection: Inspection, title: str) -> RenderableType:
    """Return the whole summary, ready to print."""
    schema, episodes = inspection.schema, inspection.episodes
    lengths = episodes.lengths
    seconds = episodes.n_frames / schema.fps
    head = Text.assemble(
        (printable(title), "bold"),
        f"  {_count(len(episodes), 'episode')}, {_count(episodes.n_frames, 'frame')} at {schema.fps:g} fps"
        f" ({seconds:,.1f} s), LeRobot {printable(schema.codebase_version)}",
    )
    spread = f"\nlengths: {lengths.min()} to {lengths.max()} frames, {lengths.mean():.1f} on average"
    return Group(
        head, Text(), _schema_table(inspection), Text(), _episode_table(inspection), Text(spread), _reached(inspection)
    )


def audit_report(audit: "Audit", title: str) -> RenderableType:
    """Return the findings of an audit, and what nobody looked at, ready to print."""
    head = Text.assemble(
        (printable(title), "bold"),
        f"  {_count(audit.n_episodes, 'episode')}, {_count(audit.n_frames, 'frame')}"
        if audit.readable
        else "  cannot be read",
    )
    findings = [part for finding in audit.findings for part in (Text(), _finding(finding))]
    left_out = [Text(f"{check}: {number:,} more like these", style="dim") for check, number in audit.more.items()]
    not_checked = [Text(f"not checked: {printable(what)}", style="dim") for what in audit.not_checked]
    return Group(head, *findings, Text(), *left_out, _verdict(audit), *not_checked)


def left_out(lines: Sequence[str]) -> Text:
    """Say which episodes of a damaged dataset are not in what was read."""
    said = "".join(f"\n  {printable(line)}" for line in lines) or " nothing"
    return Text.assemble(("left out:", "bold yellow"), said)


def _finding(finding: Finding) -> RenderableType:
    where = " ".join(filter(None, [finding.file, finding.field]))
    lines = Table.grid(padding=(0, 1))
    lines.add_column(style="dim", justify="right", no_wrap=True)
    lines.add_column(overflow="fold")
    for name, text in (("found", finding.found), ("expected", finding.expected), ("mend", finding.mend)):
        if text:
            lines.add_row(name, printable(text))
    style = _SEVERITY_STYLES[finding.severity]
    title = Text.assemble((finding.severity, style), "  ", (finding.check, "bold"), "  ", printable(where))
    return Group(title, Padding(lines, (0, 0, 0, 2)))


def _verdict(audit: "Audit") -> Text:
    counts = Counter(finding.severity for finding in audit.findings)
    if not counts:
        return Text("nothing wrong was found", style="bold green")
    said = ", ".join(_count(counts[severity], severity) for severity in _SEVERITY_STYLES if counts[severity])
    return Text(said, style="bold red" if counts["error"] else "bold yellow" if counts["warning"] else "bold")


def _count(number: int, noun: str) -> str:
    return f"{number:,} {noun}" + ("" if number == 1 else "s")


def _table(title: str) -> Table:
    return Table(
        title=title, title_justify="left", title_style="bold", box=box.SIMPLE_HEAD, show_edge=False, pad_edge=False
    )


def _schema_table(inspection: Inspection) -> Table:
    table = _table("What a frame is")
    for name in ("feature", "dtype", "dimension"):
        table.add_column(name, overflow="fold")
    table.add_column("low", justify="right")
    table.add_column("high", justify="right")
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
        dims = feature.dim_names or tuple(f"[{i}]" for i in range(feature.size))
        for i, dim in enumerate(dims):
            first = (name, feature.dtype) if i == 0 else ("", "")
            rows.append((*first, dim, f"{low[i]:.3f}", f"{high[i]:.3f}"))
    return rows


def _shape(schema: Schema, name: str) -> str:
    shape = schema.features[name].shape
    return "" if shape == (1,) else " x ".join(str(size) for size in shape)


def _episode_table(inspection: Inspection) -> Table:
    episodes, outcome = inspection.episodes, inspection.outcome
    longest = int(episodes.lengths.max())
    table = _table("Where episodes end")
    for name in ("episode", "from", "length"):
        table.add_column(name, justify="right")
    table.add_column("", width=12)
    if outcome:
        for name in ("pos_err [m]", "ang_err [rad]", "reached"):
            table.add_column(name, justify="right")
    for episode in range(min(len(episodes), MAX_ROWS)):
        length = int(episodes.lengths[episode])
        cells: list[RenderableType] = [str(episodes.number(episode)), str(episodes.from_index[episode]), str(length)]
        cells.append(Bar(longest, 0, length, color="blue"))
        if outcome:
            reached = bool(outcome.reached[episode])
            cells += [f"{outcome.final_pos_err[episode]:.3f}", f"{outcome.final_ang_err[episode]:.3f}"]
            cells.append(Text("yes" if reached else "no", style="green" if reached else "red"))
        table.add_row(*cells)
    if len(episodes) > MAX_ROWS:
        table.add_row("...", "", "", Text(f"and {len(episodes) - MAX_ROWS:,} more", style="dim"))
    return table


def _reached(inspection: Inspection) -> Text:
    outcome, reading = inspection.outcome, inspection.reading
    if outcome is None or reading is None:
        return Text(
            f"no reading for success: the schema has no {', '.join(inspection.missing)} in observation.state",
            style="yellow",
        )
    return Text.assemble(
        ("reached target: ", "bold"),
        (f"{outcome.n_reached}/{len(outcome.reached)}", "bold green" if np.all(outcome.reached) else "bold yellow"),
        f" ({outcome.success_rate:.0%})",
        (
            f"\nthat is: the last stored frame is within {reading.pos_tol} m and {reading.ang_tol} rad of the target",
            "dim",
        ),
    )


def console(quiet: bool = False) -> Console:
    """Return a console that prints what it is given and interprets no markup in it; if `quiet`, it prints nothing."""
    return Console(quiet=quiet, markup=False, emoji=False, highlight=False)


@contextlib.contextmanager
def progress(doing: str, unit: str, quiet: bool) -> Iterator[Callable[[int, int], None]]:
    """Show a progress bar on stderr while something runs; lend the function that moves it: (done, total)."""
    screen = Console(stderr=True)
    if quiet or not screen.is_terminal:
        yield lambda done, total: None
        return
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TextColumn, TimeRemainingColumn

    columns = (TextColumn(doing), BarColumn(), MofNCompleteColumn(), TextColumn(unit), TimeRemainingColumn())
    with Progress(*columns, console=screen, transient=True) as bar:
        task = bar.add_task(doing, total=None)
        yield lambda done, total: bar.update(task, completed=done, total=total)
