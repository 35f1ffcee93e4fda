"""What does each wrong reading leave behind? A table to click: its rows, its columns, and the kinds of mistake."""

import io
from collections.abc import Sequence

from z2r.course.field_guide import Change, by_kind
from z2r.course.figures import what_changes
from z2r.course.moving.picture import MovingPicture, make
from z2r.reading.breaks import break_mode

_TITLE = "What each wrong reading changes, and who notices"
_SAYS = "Click a row, a column or a kind. A dot means: no change."


def changes_table(changes: Sequence[Change]) -> MovingPicture:
    """Show what each break mode changes, by kind, and what its signature is.

    Parameters
    ----------
    changes : sequence of Change
        From `z2r.course.field_guide.what_changes`, at least one.

    Raises
    ------
    ValueError
        If there is none.

    Examples
    --------
    >>> from z2r.course.field_guide import what_changes
    >>> changes_table(what_changes("standin"))
    Moving picture: What each wrong reading changes, and who notices
    """
    still = io.BytesIO()
    what_changes(changes).savefig(still, format="png")
    kinds = by_kind(changes)
    rows = [(kind, change) for kind, own in kinds.items() for change in own]
    data = {
        "kinds": [_kind(kind, own) for kind, own in kinds.items()],
        "columns": [*(_column(name, kinds) for name in changes[0].marks), _noticed(changes)],
        "rows": [_row(kind, change) for kind, change in rows],
    }
    return make("changes", _TITLE, _SAYS, data, still.getvalue())


def _row(kind: str, change: Change) -> dict[str, object]:
    mode = break_mode(change.name)
    found = f"Checks of the audit that find it here: {', '.join(change.checks)}."
    if not change.checks:
        found = "It sleeps: here it changes nothing." if change.is_dormant else "No check of the audit finds it here."
    n_checks = f"{len(change.checks) or ('' if change.is_dormant else 'none')}"
    said = [f"It believes: {mode.assumption}.", f"What gives it away: {mode.signature}.", found]
    return {"name": change.name, "said": said, "kind": kind, "marks": [*change.marks.values(), n_checks]}


def _column(name: str, kinds: dict[str, list[Change]]) -> dict[str, object]:
    marked = [change.name for own in kinds.values() for change in own if change.marks[name]]
    other = [kind for kind, own in kinds.items() if not any(change.marks[name] for change in own)]
    said = [f"Changed by {', '.join(marked) or 'none'}."]
    return {
        "name": name,
        "said": [*said, f"No mistake about {' or about '.join(other)} changes it."] if other else said,
    }


def _noticed(changes: Sequence[Change]) -> dict[str, object]:
    unseen = [change.name for change in changes if not change.checks and not change.is_dormant]
    said = f"Found by none, though it changes something: {', '.join(unseen) or 'no mistake'}."
    return {"name": "checks that find it", "said": [said]}


def _kind(kind: str, own: list[Change]) -> dict[str, object]:
    changed = [name for name in own[0].marks if any(change.marks[name] for change in own)]
    same = [name for name in own[0].marks if name not in changed]
    said = [
        f"They change: {', '.join(changed) or 'nothing'}.",
        f"None of them changes: {', '.join(same) or 'nothing'}.",
    ]
    return {"name": kind, "said": said}
