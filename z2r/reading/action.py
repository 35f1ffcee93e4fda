"""What is an action? Which column of the state it drives, as a target or as a change, in which unit, how much later.

Nothing is declared and nothing is guessed: every dimension of the action is held against every column that was
observed, as the place where that column will be so many frames ahead (a *target*), and as its *change* from one frame
to the next. What explains the action best is the answer, if it explains it well, in both halves of the sample, and
better than all else; otherwise the answer is why it cannot be decided.

A *step* is a change in a frame, a *velocity* a change in a second. At one frame ahead both fit alike, so which of them
it is can only be told by the factor: where one of the two is a factor between units (1, 180/pi, 1000 ...) and the other
is not.
"""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from math import copysign, pi
from typing import Literal, NamedTuple

import numpy as np

from z2r.arrays import Bools, Columns, Floats, Ints, products
from z2r.errors import count
from z2r.format.episodes import EpisodeIndex
from z2r.format.schema import ACTION, Schema
from z2r.reading.reading import column_names

MAX_AHEAD = 15  # frames: an answer farther ahead is not given
_WINDOW = 20  # frames: looked at a little beyond that, so that an end of the window is seen as one
_SPANS = {"change": 1, "long change": 5, "longer change": 15}  # frames: a longer one stands out from sensor noise
_ALL_FOLLOW = 0.97  # explained: below, a joint may be held back at times
_NOISY = 0.9  # explained: below, nobody knows which of the two is noisy
_CLOSE = 0.02  # of the action's span
_BESIDE = 1.6  # times: what holds a joint back makes a factor look so much larger at most
_MIN_FRAMES = 60  # from fewer nothing is said
_MAX_COLUMNS = 256  # of the state

_HOLDS = 0.7  # share of an action's variance that must be explained, in each half of the sample
_CLEARLY = 1.5  # times as much must be left unexplained by anything else
_FLOOR = 1e-4  # of the variance: what leaves less than that unexplained explains all
_SPREAD = 0.6  # of what a change at once leaves unexplained: a change that takes several frames must leave less
_CHANCE = 0.01  # that something unrelated explains as much
_MOSTLY = 0.9  # of its frames, a column must have a number
_ALIKE = 1.1  # times as much unexplained: these frames ahead fit as well
_OFFSET = 0.05  # of the action's span: beside the target by more than that, it is said
_NEAR, _FAR = 0.08, 0.15  # off by less, a factor is one between units; by more, it is none

# What a factor between units says: so many of the action's are one of the state's.
_FACTORS: dict[float, str] = {
    1.0: "the same unit",
    180 / pi: "degrees for radians",
    pi / 180: "radians for degrees",
    1000.0: "thousandths",
    0.001: "thousands",
    100.0: "hundredths",
    0.01: "hundreds",
}

type Kind = Literal["target", "step", "velocity", "step or velocity", "unknown"]


class Fit(NamedTuple):
    """One explanation of one dimension of the action.

    Attributes
    ----------
    way : str
        ``target``, one of the ways of a change that the actions of as many frames bring about (``change``,
        ``long change``, ``longer change``), or ``spread``: a change that one action brings about over several frames.
    column : int
        Which column of the state.
    ahead : int
        How many frames ahead that column is there, or has changed.
    explained : float
        Share of the action's variance that it explains, in [0, 1].
    factor : float
        How many of the action's units are one of the column's; a change counts in a frame. Negative where the signs are
        opposite.
    offset : float
        What the action is where the column, or its change, is 0.
    """

    way: str
    column: int
    ahead: int
    explained: float
    factor: float
    offset: float

    @property
    def unexplained(self) -> float:
        """Share of the action's variance that it leaves unexplained, in [0, 1]."""
        return 1 - self.explained


@dataclass(frozen=True)
class DrivenColumn:
    """What one dimension of the action is, with the evidence.

    Attributes
    ----------
    name : str
        The dimension of the action.
    kind : str
        ``target``, ``step``, ``velocity``, ``step or velocity``, or ``unknown`` where the data cannot decide.
    column : str or None
        The column of the state that it drives, as a reading names it.
    ahead : int or None
        How many frames ahead.
    alike : tuple of int
        All numbers of frames ahead that fit about as well, in order.
    factor : float or None
        How many of the action's units are one of the column's; of a velocity, a second. Negative for opposite signs.
    unit : str
        What that factor is between units; empty where it is none.
    explained : float
        Share of the action's variance that is explained, in [0, 1].
    within : float or None
        In 99 % of the frames, the action is no farther from what the column says, in the unit of the action.
    offset : float
        Of a target, what the action is where the column is 0, if that is much.
    copied : bool
        Whether it is the state so many frames ahead, bit for bit.
    next_best : str
        The best other explanation, and how much of the variance that explains.
    evidence : str
        All of it in words; where nothing is decided, why.
    """

    name: str
    kind: Kind
    evidence: str
    column: str | None = None
    ahead: int | None = None
    alike: tuple[int, ...] = ()
    factor: float | None = None
    unit: str = ""
    explained: float = 0.0
    within: float | None = None
    offset: float = 0.0
    copied: bool = False
    next_best: str = ""

    def __str__(self) -> str:
        return f"{self.name}: {self.evidence}"


@dataclass(frozen=True, eq=False)
class ActionSample:
    """Frames from which it is told what an action is: stretches of episodes, side by side.

    Attributes
    ----------
    action : ndarray, float64[n_frames, n_dims]
    state : ndarray, float64[n_frames, n_columns]
        Every column that was observed.
    stretch : ndarray, int64[n_frames]
        Which stretch a frame is in: only inside of one does time run on.
    names : tuple of str
        Of the dimensions of the action.
    columns : tuple of str
        Of the state, as a reading names them.
    fps : float
        Frames a second.
    """

    action: Floats
    state: Floats
    stretch: Ints
    names: tuple[str, ...]
    columns: tuple[str, ...]
    fps: float
    _pairs: dict[int, Ints] = field(default_factory=dict, init=False, repr=False)

    @cached_property
    def sums(self) -> Floats:
        """The action summed up to each frame, float64[n_frames + 1, n_dims]: the sum over some is a difference."""
        return np.concatenate([np.zeros((1, self.action.shape[1])), np.cumsum(self.action, axis=0)])

    @cached_property
    def turns(self) -> Floats:
        """The period of each column that is an angle and goes on at the other end of its range, else 0."""
        now = self.starts(1)
        leap, span = np.abs(self.state[now + 1] - self.state[now]).max(axis=0, initial=0), np.ptp(self.state, axis=0)
        turns = np.zeros(self.state.shape[1])
        for period in (2 * pi, 360.0):
            turns[(leap > 0.75 * period) & (span < 1.01 * period)] = period
        return turns

    def starts(self, ahead: int) -> Ints:
        """Return the frames that have a frame so far ahead in their own stretch, int64[n]."""
        if ahead not in self._pairs:
            last = len(self.stretch) - ahead
            same = self.stretch[: max(last, 0)] == self.stretch[ahead:]
            self._pairs[ahead] = np.flatnonzero(same)
        return self._pairs[ahead]


def infer_action(sample: ActionSample, units: Mapping[str, str] | None = None) -> tuple[DrivenColumn, ...]:
    """Say of every dimension of the action what it is, from the data alone.

    Parameters
    ----------
    sample : ActionSample
        Some thousand frames are plenty.
    units : mapping of str to str, optional
        The units of dimensions of the action, for the words of the evidence; nothing else comes of them.

    Returns
    -------
    tuple of DrivenColumn
        One for each dimension of the action.
    """
    if not len(sample.names):
        return ()
    sample = _with_numbers_only(sample)
    if len(sample.starts(max(_SPANS.values()) // 3)) < _MIN_FRAMES:
        why = f"cannot be decided: {len(sample.stretch):,} frames are too few"
        return tuple(DrivenColumn(name, "unknown", why) for name in sample.names)
    sample = _with_moving_columns(sample)
    table = list(_fits(sample))
    answers = (_answer(sample, dim, table) for dim in range(len(sample.names)))
    return tuple(_in_words(answer, (units or {}).get(answer.name, "")) for answer in answers)


def _with_numbers_only(sample: ActionSample) -> ActionSample:
    """Leave out columns that often have no number, and the frames in which another has none: time stops there."""
    if not len(sample.stretch):
        return sample
    finite = np.isfinite(sample.state)
    kept = finite.mean(axis=0) > _MOSTLY
    whole = finite[:, kept].all(axis=1) & np.isfinite(sample.action).all(axis=1)
    if whole.all() and kept.all():
        return sample
    stretch = np.cumsum(np.diff(sample.stretch, prepend=sample.stretch[:1]) != 0) + np.cumsum(~whole)
    columns = tuple(name for name, keep in zip(sample.columns, kept, strict=True) if keep)
    state = sample.state[:, kept][whole]
    return ActionSample(sample.action[whole], state, stretch[whole], sample.names, columns, sample.fps)


def _with_moving_columns(sample: ActionSample) -> ActionSample:
    moves = np.ptp(sample.state, axis=0) > 0
    columns = tuple(name for name, keep in zip(sample.columns, moves, strict=True) if keep)
    return sample if moves.all() else replace(sample, state=sample.state[:, moves], columns=columns)


def explained_by_frames(sample: ActionSample, dim: int) -> dict[str, Floats]:
    """Say how much of one dimension of the action is explained, by the column that explains it best, frames ahead.

    Parameters
    ----------
    sample : ActionSample
        Frames enough for an answer.
    dim : int
        Which dimension of the action.

    Returns
    -------
    dict of str to ndarray, float64[n]
        As a target, and as a change in a frame: the share explained 0, 1, 2 ... frames ahead, in [0, 1].
    """
    table, found = list(_fits(_with_moving_columns(sample))), {}
    for way, what in (("target", "as a target"), ("change", "as a change")):
        shares = [each.explained[dim] for each in table if each.way == way]  # of each column, so many frames ahead
        found[what] = np.max(shares, axis=1) if shares else np.zeros(1)
    return found


class _Fits(NamedTuple):
    """All explanations of one way and one number of frames ahead; arrays are (n_dims, n_columns)."""

    way: str
    ahead: int
    explained: Floats
    factor: Floats
    offset: Floats


def _fits(sample: ActionSample) -> Iterator[_Fits]:
    """Hold all dimensions of the action against all columns, which move, in every way and so many frames ahead."""
    for way, ahead in _hypotheses() if sample.columns else ():
        asked, seen = _pairs(sample, way, ahead)
        if len(asked) >= _MIN_FRAMES // 2:
            yield _Fits(way, ahead, *_regress(asked, seen))


def _hypotheses() -> Iterator[tuple[str, int]]:
    yield from (("target", ahead) for ahead in range(_WINDOW + 1))
    yield from ((way, ahead) for way in _SPANS for ahead in range(_WINDOW + 1))
    yield from (("spread", ahead) for ahead in range(2, _WINDOW + 1))


def _pairs(
    sample: ActionSample, way: str, ahead: int, dims: slice = slice(None), columns: slice = slice(None)
) -> tuple[Floats, Floats]:
    """Return the action of some frames, and what one explanation holds against it: (n, n_dims) and (n, n_columns)."""
    action, state, turns = sample.action[:, dims], sample.state[:, columns], sample.turns[columns]
    if way == "target":
        now = sample.starts(ahead)
        return action[now], state[now + ahead]
    if way == "spread":
        now = sample.starts(ahead)
        return action[now], _change(state[now + ahead] - state[now], turns) / ahead
    n, sums = _SPANS[way], sample.sums[:, dims]
    first = sample.starts(ahead + n - 1 if ahead else n)  # the change ends `ahead` frames ahead, or begins a frame ago
    if not ahead:
        first = first[first > 0]
        first = first[sample.stretch[first - 1] == sample.stretch[first]]
    asked = (sums[first + n] - sums[first]) / n if n > 1 else action[first]
    return asked, _change(state[first + ahead - 1 + n] - state[first + ahead - 1], turns) / n


def _pair(sample: ActionSample, dim: int, fit: Fit) -> tuple[Floats, Floats]:
    """Return one dimension of the action, and what one explanation holds against it, both (n,)."""
    dims, columns = slice(dim, dim + 1), slice(fit.column, fit.column + 1)
    asked, seen = _pairs(sample, fit.way, fit.ahead, dims, columns)
    return asked[:, 0], seen[:, 0]


def _change(change: Floats, turns: Floats) -> Floats:
    """Take an angle that goes on at the other end of its range for what it is: a small change."""
    return change - turns * np.round(change / np.where(turns > 0, turns, 1)) if turns.any() else change


def _regress(asked: Floats, seen: Floats) -> tuple[Floats, Floats, Floats]:
    """Fit every dimension of the action to every column: share explained, factor and offset, (n_dims, n_columns).

    The command is exact and what it brings about is noisy, so the column is explained by the action and not the other
    way round: noise would make the factor smaller than it is.
    """
    n, mean_a, mean_s = len(asked), asked.mean(axis=0), seen.mean(axis=0)
    both = products(asked, seen) / n - np.outer(mean_a, mean_s)  # (n_dims, n_columns)
    var_a = (np.einsum("ij,ij->j", asked, asked) / n - np.square(mean_a))[:, None]
    var_s = (np.einsum("ij,ij->j", seen, seen) / n - np.square(mean_s))[None]
    with np.errstate(divide="ignore", invalid="ignore"):
        explained = np.clip(np.nan_to_num(np.square(both) / (var_a * var_s)), 0, 1)
        factor = np.where(both == 0, 0.0, var_a / both)
        offset = mean_a[:, None] - factor * mean_s[None]
    return explained, factor, offset


def _answer(sample: ActionSample, dim: int, table: Sequence[_Fits]) -> DrivenColumn:
    name = sample.names[dim]
    if np.ptp(sample.action[:, dim]) == 0:
        return DrivenColumn(name, "unknown", "cannot be decided: it never changes")
    fits = [fit for each in table for fit in _best_of(each, dim)]
    if not fits:
        return DrivenColumn(name, "unknown", "cannot be decided: no column of the state moves")
    best = _best(fits)
    rival, pair = _rival(best, fits), _pair(sample, dim, best)
    if why := _why_undecided(sample, pair, best, rival):
        return DrivenColumn(
            name, "unknown", f"cannot be decided: {why}", explained=best.explained, next_best=_said(sample, rival)
        )
    return _decided(sample, dim, pair, best, fits, rival)


def _best_of(fits: _Fits, dim: int) -> Iterator[Fit]:
    """Yield the fits of one dimension; of many columns, the two that explain it best."""
    for place in np.argsort(-fits.explained[dim])[:2].tolist():
        numbers = (float(each[dim, place]) for each in (fits.explained, fits.factor, fits.offset))
        yield Fit(fits.way, place, fits.ahead, *numbers)


def _best(fits: Sequence[Fit]) -> Fit:
    """Return what explains most; a change over several frames is only taken where one at once is clearly worse."""
    at_once = max((fit for fit in fits if fit.way != "spread"), key=lambda fit: fit.explained)
    spread = max(fits, key=lambda fit: fit.explained)
    return spread if spread.unexplained < _SPREAD * at_once.unexplained else at_once


def _is_target(fit: Fit) -> bool:
    return fit.way == "target"


def _rival(best: Fit, fits: Sequence[Fit]) -> Fit | None:
    """Return the best explanation that says something else: another column, or a change for a target."""
    others = [fit for fit in fits if fit.column != best.column or _is_target(fit) != _is_target(best)]
    return max(others, key=lambda fit: fit.explained, default=None)


def _why_undecided(sample: ActionSample, pair: tuple[Floats, Floats], best: Fit, rival: Fit | None) -> str:
    """Say why the best explanation will not do; empty where it will."""
    if best.explained < _HOLDS:
        return f"nothing that was observed explains more than {best.explained:.0%} of it"
    halves = _explained_in_halves(*pair)
    if halves.min() < _HOLDS:
        return f"{_said(sample, best)}, but only {halves.min():.0%} in half of the frames"
    if _by_chance(*pair, n_tried=len(sample.columns) * _WINDOW) > _CHANCE:
        return f"{_said(sample, best)}, but there is too little motion to tell that from chance"
    if rival and rival.unexplained < max(_CLEARLY * best.unexplained, _FLOOR) and not _is_copied(*pair, best):
        return f"{_said(sample, best)}, and {_said(sample, rival)}"
    if _centre(best) > MAX_AHEAD:
        return f"{_said(sample, best)}, and more so the farther ahead: what it does lies beyond the {MAX_AHEAD} frames"
    return ""


def _explained_in_halves(asked: Floats, seen: Floats) -> Floats:
    """Say how much of the action each half of the sample explains, with what the other half says, float64[2]."""
    moved = np.cumsum(np.square(asked - asked.mean()))
    first = moved <= moved[-1] / 2  # halves of its motion, and not of its time
    return np.array([_explained_by(asked, seen, first), _explained_by(asked, seen, ~first)])


def _explained_by(asked: Floats, seen: Floats, known: Bools) -> float:
    """Fit on the known frames, and say how much of the variance of the others is explained, at most 1."""
    _, factor, offset = _regress(asked[known, None], seen[known, None])
    left = asked[~known] - factor[0, 0] * seen[~known] - offset[0, 0]
    # What a column does not tell of the action is compared with how far the action goes at all.
    spread = np.square(asked[~known] - asked.mean()).mean()
    return float(1 - np.square(left).mean() / spread) if spread else 0.0


def _by_chance(asked: Floats, seen: Floats, n_tried: int) -> float:
    """Say how likely one of all explanations would explain as much if nothing were related, at most 1.

    Smooth motion tells less than its number of frames, and its changes may tell more than its course: both are asked.
    """
    changes = (_chance(asked[n:] - asked[:-n], seen[n:] - seen[:-n]) for n in (1, 5))
    return min(1.0, *(n_tried * chance for chance in (_chance(asked, seen), *changes)))


def _chance(one: Floats, other: Floats) -> float:
    """Say how likely two series that have nothing to do with each other would be so much alike.

    What is left of their number is taken from how much each value is like the one before (M. S. Bartlett, "Some aspects
    of the time-correlation problem in regard to tests of significance", 1935).
    """
    a, b = one - one.mean(), other - other.mean()
    spread = float(np.sqrt((a @ a) * (b @ b)))
    unexplained = 1 - (a @ b / spread) ** 2 if spread else 1.0
    like = _likeness(a) * _likeness(b)
    n_telling = len(a) * (1 - like) / (1 + like)
    return float(max(unexplained, 1e-12) ** max((n_telling - 2) / 2, 0))


def _likeness(values: Floats) -> float:
    """Correlation of each value with the next, in [0, 1)."""
    spread = float(values @ values)
    return float(np.clip(values[1:] @ values[:-1] / spread, 0.0, 1 - 1e-9)) if spread else 0.0


def _is_copied(asked: Floats, seen: Floats, fit: Fit) -> bool:
    return _is_target(fit) and bool(np.array_equal(asked, seen))


def _decided(
    sample: ActionSample, dim: int, pair: tuple[Floats, Floats], best: Fit, fits: Sequence[Fit], rival: Fit | None
) -> DrivenColumn:
    asked, seen = pair
    factor, offset = _mostly(asked, seen, best)
    best = best._replace(factor=factor, offset=offset)
    kind, factor, unit = _kind(best, sample.fps)
    alike = [fit for fit in fits if fit.way == best.way and fit.column == best.column]
    limit = _ALIKE * best.unexplained + 1e-9
    ahead = tuple(sorted({_centre(fit) for fit in alike if fit.unexplained <= limit} | {_centre(best)}))
    off = np.abs(asked - best.factor * seen - best.offset)
    return DrivenColumn(
        name=sample.names[dim],
        kind=kind,
        evidence="",
        column=sample.columns[best.column],
        ahead=_centre(best),
        alike=ahead,
        factor=factor,
        unit=unit,
        explained=best.explained,
        within=float(np.quantile(off, 0.99)),
        copied=_is_copied(asked, seen, best),
        next_best=_said(sample, rival),
        offset=best.offset if abs(best.offset) > _OFFSET * float(np.ptp(asked)) else 0.0,
    )


def _centre(fit: Fit) -> int:
    """Return how many frames ahead; of a change over several frames, where its middle is."""
    return (fit.ahead + 1) // 2 if fit.way == "spread" else fit.ahead


def _mostly(asked: Floats, seen: Floats, fit: Fit) -> tuple[float, float]:
    """Return the factor and the offset that fit the most frames closely.

    A joint that is held back by what it grips or pushes does not follow, and that is no other factor: where a factor
    between units is near, and holds in more frames than the one of least squares, it is the one.
    """
    close = _CLOSE * float(np.ptp(asked))
    near = [copysign(known, fit.factor) for known in _FACTORS if 1 / _BESIDE < abs(fit.factor) / known < _BESIDE]
    tried = [(factor, offset) for factor in near for offset in (float(np.median(asked - factor * seen)), 0.0)]

    def n_close(candidate: tuple[float, float]) -> int:
        return int((np.abs(asked - candidate[0] * seen - candidate[1]) < close).sum())

    least_squares = fit.factor, fit.offset
    if fit.explained < _NOISY:  # in the state or in the command: halfway between what either would say
        factor = fit.factor * fit.explained**0.5
        least_squares = factor, float(asked.mean() - factor * seen.mean())
    return max([least_squares, *tried], key=n_close) if fit.explained < _ALL_FOLLOW else least_squares


def _kind(fit: Fit, fps: float) -> tuple[Kind, float, str]:
    """Tell a step from a velocity by the factor, and return the factor as that kind has it, with what it is."""
    if _is_target(fit):
        return "target", fit.factor, unit_of(fit.factor)
    in_a_second = fit.factor / fps
    if unit_of(fit.factor) and _is_no_unit(in_a_second):
        return "step", fit.factor, unit_of(fit.factor)
    if unit_of(in_a_second) and _is_no_unit(fit.factor):
        return "velocity", in_a_second, unit_of(in_a_second)
    return "step or velocity", fit.factor, ""


def unit_of(factor: float) -> str:
    """Say what a factor is between units; empty where it is none."""
    near = (said for known, said in _FACTORS.items() if abs(abs(factor) / known - 1) < _NEAR)
    return next(near, "")


def _is_no_unit(factor: float) -> bool:
    return all(abs(abs(factor) / known - 1) > _FAR for known in _FACTORS)


def _said(sample: ActionSample, fit: Fit | None) -> str:
    """Say what an explanation explains, in short."""
    if fit is None:
        return ""
    what = "as a target" if _is_target(fit) else "as a change"
    return f"{sample.columns[fit.column]} {what}, {_frames(fit.ahead)}, explains {fit.explained:.1%}"


def _frames(ahead: int) -> str:
    return f"{count(ahead, 'frame')} ahead"


def _in_words(answer: DrivenColumn, unit: str) -> DrivenColumn:
    """Say what was found: which column, how many frames ahead, in which unit, and how closely."""
    if answer.kind == "unknown" or answer.ahead is None or answer.factor is None:
        return answer
    where = _frames(answer.ahead)
    if answer.alike[0] < answer.ahead - 1 or answer.alike[-1] > answer.ahead + 1:
        where = f"{answer.alike[0]} to {answer.alike[-1]} frames ahead, which all fit alike"
    said = [f"the {answer.kind} of {answer.column}", where, *_scale_in_words(answer, unit)]
    if answer.copied:
        return replace(answer, evidence=", ".join([*said[:2], "its very copy, bit for bit"]))
    close = f"within {answer.within:.3g}{f' {unit}' if unit else ''} in 99 % of frames"
    return replace(answer, evidence=", ".join([*said, close]))


def _scale_in_words(answer: DrivenColumn, unit: str) -> Iterator[str]:
    """Say what is out of the ordinary: another unit, another scale, the opposite sign, beside the target."""
    factor = answer.factor or 0.0
    if not answer.unit:
        yield f"{abs(factor):.4g} for 1"
    elif abs(abs(factor) - 1) > _FAR:
        yield answer.unit
    if factor < 0:
        yield "with the opposite sign"
    if answer.kind == "target" and answer.offset:
        yield f"with an offset of {answer.offset:.3g}{f' {unit}' if unit else ''}"


def sample_windows(episodes: EpisodeIndex, max_frames: int = 8_000, longest: int = 200) -> EpisodeIndex:
    """Choose stretches of episodes, evenly over a dataset, from which an action can be told.

    Parameters
    ----------
    episodes : EpisodeIndex
        Where episodes end.
    max_frames : int, optional
        All of them where they are no more; else about as many, in stretches of at most `longest` frames.
    longest : int, optional
        Frames.

    Examples
    --------
    >>> index = EpisodeIndex(from_index=np.array([0, 3]), to_index=np.array([3, 8]))
    >>> sample_windows(index).to_index.tolist(), sample_windows(index, max_frames=4, longest=2).from_index.tolist()
    ([3, 8], [0, 3, 7])
    """
    if episodes.n_frames <= max_frames:
        return episodes
    before = np.cumsum(-(-episodes.lengths // longest))  # windows, up to the end of each episode
    chosen = np.arange(0, int(before[-1]), -(-episodes.n_frames // max_frames))
    place = np.searchsorted(before, chosen, side="right")  # the episode of each
    inner = chosen - np.concatenate([[0], before[:-1]])[place]
    start = episodes.from_index[place] + longest * inner
    return EpisodeIndex(start, np.minimum(start + longest, episodes.to_index[place]), episodes.numbers[place])


def sample_of(frames: Columns, windows: EpisodeIndex, schema: Schema) -> ActionSample:
    """Put together what an action is told from.

    Parameters
    ----------
    frames : dict of str to ndarray
        The frames of the windows, side by side: all features of `sampled_features`.
    windows : EpisodeIndex
        From `sample_windows`.
    schema : Schema
        Names the columns.
    """
    features = [name for name in sampled_features(schema) if name != ACTION and name in frames]
    state = [frames[name].astype(np.float64) for name in features]
    action = frames[ACTION].astype(np.float64) if ACTION in frames else np.empty((windows.n_frames, 0))
    columns = [column for name in features for column in column_names(name, schema)]
    return ActionSample(
        action=action,
        state=np.concatenate(state, axis=1) if state else np.empty((len(action), 0)),
        stretch=np.repeat(np.arange(len(windows)), windows.lengths),
        names=schema.features[ACTION].labels if ACTION in frames else (),
        columns=tuple(columns),
        fps=schema.fps,
    )


def sampled_features(schema: Schema) -> tuple[str, ...]:
    """Return the features from which an action is told: the action, and what was observed, up to some columns."""
    signals = schema.signals()
    if ACTION not in signals:
        return ()
    wanted, n_columns = [ACTION], 0
    for name, feature in signals.items():
        if name.startswith("observation") and n_columns + feature.size <= _MAX_COLUMNS:
            wanted.append(name)
            n_columns += feature.size
    return tuple(wanted)
