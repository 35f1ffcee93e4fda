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
    rows = [_row(kind, change) for kind, own in by_kind(changes).items() for change in own]
    data = {"kinds": list(by_kind(changes)), "columns": list(changes[0].marks), "rows": rows}
    return make("changes", _TITLE, _SAYS, data, still.getvalue())


def _row(kind: str, change: Change) -> dict[str, object]:
    mode = break_mode(change.name)
    return {
        "kind": kind,
        "name": change.name,
        "marks": list(change.marks.values()),
        "checks": change.checks,
        "dormant": change.is_dormant,
        "assumption": mode.assumption,
        "signature": mode.signature,
    }
