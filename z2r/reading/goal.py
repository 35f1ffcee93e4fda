"""What has to be true at the end? A goal: one number of a frame, and the limits that it must keep."""

import msgspec
import numpy as np

from z2r.arrays import Bools, Floats

_KINDS = ("distance", "turn", "value", "stored")
_LIMITS = ("within", "at_most", "at_least")


class Goal(msgspec.Struct, frozen=True, forbid_unknown_fields=True, omit_defaults=True, kw_only=True):
    """One thing that must hold in the decisive frame of an episode.

    Attributes
    ----------
    name : str
        What to call its number: a key in the metrics, the title of a plot.
    distance : pair of str, optional
        Between the positions of two poses.
    turn : pair of str, optional
        Between the orientations of two poses [rad].
    value : str, optional
        Of a column.
    stored : str, optional
        A column that says it outright, such as ``next.success``: anything above 0 will do unless there is a limit.
    within : float, optional
        The number must be smaller than this, whatever its sign.
    at_most, at_least : float, optional
        The number may be as large, or as small, as this.
    wraps : bool
        Whether a difference of two yaws is wrapped into one turn. False is a mistake, made on purpose in `no-wrap`.

    Raises
    ------
    ValueError
        If it is not one of the four, or has no limit where it needs one.
    """

    name: str
    distance: tuple[str, str] | None = None
    turn: tuple[str, str] | None = None
    value: str | None = None
    stored: str | None = None
    within: float | None = None
    at_most: float | None = None
    at_least: float | None = None
    wraps: bool = True

    def __post_init__(self) -> None:
        kinds = [kind for kind in _KINDS if getattr(self, kind) is not None]
        if len(kinds) != 1:
            raise ValueError(f"found {' and '.join(kinds) or 'none of them'}, expected one of {', '.join(_KINDS)}")
        if self.stored is None and all(getattr(self, limit) is None for limit in _LIMITS):
            raise ValueError(f"found no limit, expected one of {', '.join(_LIMITS)}")

    @property
    def poses(self) -> tuple[str, ...]:
        """The poses between which it measures."""
        return self.distance or self.turn or ()

    @property
    def column(self) -> str | None:
        """The column that it reads, where it measures between no poses."""
        return self.value if self.value is not None else self.stored

    @property
    def limits(self) -> dict[str, float]:
        """The limits that it has, by their names."""
        return {limit: value for limit in _LIMITS if (value := getattr(self, limit)) is not None}

    @property
    def band(self) -> tuple[float | None, float | None]:
        """Between which numbers it holds, as a plot shows it; None on a side that has no limit.

        >>> Goal(name="height", value="z", within=0.3, at_least=0.1).band
        (0.1, 0.3)
        """
        within = [] if self.within is None else [self.within]
        lows = [-limit for limit in within] + ([] if self.at_least is None else [self.at_least])
        highs = within + ([] if self.at_most is None else [self.at_most])
        return max(lows, default=None), min(highs, default=None)

    def says(self, unit: str = "") -> str:
        """Say it in short, such as ``pos_err < 0.03 m``."""
        signs = {"within": "<", "at_most": "<=", "at_least": ">="}
        after = f" {unit}" if unit else ""
        limits = [f"{signs[limit]} {value:g}{after}" for limit, value in self.limits.items()] or ["> 0"]
        return f"{self.name} {' and '.join(limits)}"

    def holds(self, numbers: Floats) -> Bools:
        """Tell of each number whether it keeps the limits, bool[n]: the one place where a tolerance is compared."""
        fine = np.ones(numbers.shape, dtype=bool) if self.limits else numbers > 0
        if self.within is not None:
            fine &= np.abs(numbers) < self.within
        if self.at_most is not None:
            fine &= numbers <= self.at_most
        if self.at_least is not None:
            fine &= numbers >= self.at_least
        return fine
