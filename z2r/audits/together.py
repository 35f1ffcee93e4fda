"""Do the pictures go with the robot? What they show is foretold from where it is, and held against what they do show.

How a picture follows from where the robot is, only the dataset itself can say: each cell of it is fitted to the other
episodes. Where the robot was a little before, or is a little later, may foretell more: then the pictures are late, or
early. In a camera that sees little of the robot, little can be foretold, and then nothing is said.
"""

from collections.abc import Iterator, Mapping, Sequence
from typing import NamedTuple

import numpy as np

from z2r.arrays import Array, Bools, Floats

_MIN_EPISODES = 5  # from fewer nothing can be said about what is usual
_MIN_PICTURES = 12  # of an episode: fewer say little about how two things go together
_SAMPLE = 32  # episodes, from which it is learned how a picture follows
_COMPONENTS = 8  # of where the robot is, at most
_RIDGE = 1.0  # of doubt, as if so much of each term had been seen to mean nothing
_N_WAVES, _LENGTH, _HEIGHT = 60, 0.7, 0.5  # how many waves over where the robot is, how long [spreads], how high
_ROUNDS = 4  # until each episode has found its own delay
_DELAYS = np.arange(-15, 16) / 10  # s
_NONE = 15  # which of them is 0
_RESTS = 1e-9  # of what moves

_OTHERS = 32  # episodes before and after, whose robot may be the one that is shown

# Correlation: what is usual must be more; of a delay; what is less fits nothing.
_FITS, _SURELY, _FITS_NOT = 0.4, 0.5, 0.25
_LATE, _EARLY = 0.45, 0.25  # s: by less all pictures of a camera may well be late, or early
_NEAR = 0.25  # s: what is held against it
_MORE, _MOST = 0.02, 0.75  # of correlation, that it must bring in the median, and in how many of the episodes
_OF_ONE, _GAIN = 0.15, 0.05  # s, and of correlation: how far one episode must be from what is usual
_LEFT = 0.8  # of what is not foretold: what a delay of its own leaves of it, at most
_MANY, _AGREE = 0.3, 0.6  # of the episodes: what so many have is usual; and what so many have between them is known
_SAME = 0.2  # of how far pictures are from their mean: what is left of those that are the same
_LESS, _BETTER, _AS_WELL = 0.2, 0.3, 0.15  # of correlation: below what is usual; by so much better; about as well
_SOMETHING_ELSE = "pictures of something else"
_FAR_LESS, _SPREADS = 0.35, 7  # below what is usual, in correlation and in spreads of it: nobody need know why
_NEIGHBOURS = {1: "the next episode", -1: "the episode before"}


class Take(NamedTuple):
    """Some pictures of an episode, and where the robot is.

    Attributes
    ----------
    pictures : ndarray, (n_pictures, n_cells)
        How bright each cell is.
    at : ndarray, float64[n_pictures]
        When each was taken [s].
    places : ndarray, (n_places, size)
        Where the robot is, in whatever its columns mean.
    when : ndarray, float64[n_places]
        When it is there [s].
    """

    pictures: Array
    at: Floats
    places: Array
    when: Floats


class Fit(NamedTuple):
    """How well the pictures of a camera go with the robot.

    Attributes
    ----------
    usual : float
        The correlation that is usual; nan where too little of it can be foretold to say anything.
    astray : dict of int to str
        The episodes that do not fit, and what was found of each.
    late : float
        By how much the pictures of all the others are late [s], as those of any camera are a little.
    """

    usual: float
    astray: dict[int, str]
    late: float = 0.0


class _Axes(NamedTuple):
    """What makes few components of where the robot is, those that matter most: (size,) and (size, n_components)."""

    middle: Floats
    directions: Floats


class _Ready(NamedTuple):
    """A take at each delay, around its mean: (n_delays, n_pictures, n_terms) and (n_delays, n_pictures, n_cells).

    Where the robot is not known at that time, and at all times of delays that leave too little, they are 0.
    """

    terms: Floats
    cells: Floats


class _Sums(NamedTuple):
    """The normal equations of a take: (n_terms, n_terms) and (n_terms, n_cells)."""

    terms: Floats
    cells: Floats


class _Learned(NamedTuple):
    """How pictures follow from where the robot is, and how well: of each episode the correlation at each delay."""

    takes: Mapping[int, Take]
    axes: _Axes
    sums: Mapping[int, _Sums]
    curves: Mapping[int, Floats]


def fit(takes: Mapping[int, Take]) -> Fit:
    """Find the episodes, by their numbers, whose pictures do not go with the robot as those of the others do.

    Examples
    --------
    >>> rng, times = np.random.default_rng(0), np.arange(60) / 10
    >>> places = np.cumsum(rng.normal(size=(6, 60, 2)), axis=1)
    >>> seen = np.tanh(places @ rng.normal(size=(2, 5)) / 9)
    >>> right = {number: Take(seen[number], times, places[number], times) for number in range(6)}
    >>> fit(right).astray
    {}
    >>> print(fit(right | {4: Take(seen[4], times + 0.6, places[4], times)}).astray[4].split(":")[0])
    pictures 0.6 s later than those of the others
    """
    takes = {number: take for number, take in takes.items() if len(take.at) >= _MIN_PICTURES}
    if len(takes) < _MIN_EPISODES:
        return Fit(np.nan, {})
    learned, chosen = _learn(takes)
    curves = learned.curves
    usual, share = _usual_delay(curves)
    agree = [curve.max() for curve in curves.values() if abs(_DELAYS[curve.argmax()] - _DELAYS[usual]) <= _OF_ONE]
    typical = float(np.median(agree))
    for by, neighbour in _NEIGHBOURS.items():
        fits = _fits_of_neighbours(learned, chosen, by)
        if fits >= max(_FITS, typical + _GAIN):
            usually = f"the pictures of {neighbour}: a correlation of {fits:.2f} with its robot as a rule, and of"
            return Fit(fits, {number: f"{usually} {curve[_NONE]:.2f} with this" for number, curve in curves.items()})
    if not typical >= _FITS or share[usual] < _MANY:
        return Fit(np.nan, {})
    if not -_EARLY <= _DELAYS[usual] <= _LATE:
        gains = [curve[usual] - curve[np.abs(_DELAYS) <= _NEAR].max() for curve in curves.values()]
        if typical < _SURELY or np.mean(np.array(gains) > 0) < _MOST:
            return Fit(np.nan, {})
        return Fit(typical, {number: _all_late(curve, usual) for number, curve in curves.items()})
    spread = 1.4826 * float(np.median([abs(each - typical) for each in agree]))
    odd = {number: _odd(learned, number, usual, share, typical, spread) for number in takes}
    unlike = [number for number, found in odd.items() if found.startswith(_SOMETHING_ELSE)]
    if 2 * len(unlike) > len(takes):  # of most, who says that they are the odd ones?
        odd |= dict.fromkeys(unlike, "")
    return Fit(typical, {number: found for number, found in odd.items() if found}, float(_DELAYS[usual]))


def _odd(learned: _Learned, number: int, usual: int, share: Floats, typical: float, spread: float) -> str:
    """Say what is odd about the pictures of an episode; empty where nothing is."""
    curve = learned.curves[number]
    own, best = _around(curve, usual), int(curve.argmax())
    is_late = abs(_DELAYS[best] - _DELAYS[usual]) > _OF_ONE and _is_better(curve[best], own)
    in_half = _fit_of_half(learned, number, usual) if is_late or own < _FITS_NOT else own
    is_late = is_late and _is_better(curve[best], in_half)
    if is_late and share[usual] + share[best] >= _AGREE:  # else each has a delay of its own, and none means anything
        return _later(curve, usual, best)
    if own >= typical - _LESS:
        return ""
    better, other = max(_fits_of_others(learned, number))
    if better >= max(typical - _AS_WELL, own + _BETTER) and _belong_there(learned, number, other, usual):
        return (
            f"the pictures of episode {other}: a correlation of {better:.2f} with its robot, and of {own:.2f} with this"
        )
    less = _FAR_LESS * (1 + _leverage(learned, number)) if own < _FITS_NOT else np.inf
    nothing = own < typical - max(less, _SPREADS * spread) and in_half < typical - less
    said = f"a correlation of {own:.2f} with where the robot is, where {typical:.2f} is usual"
    return f"{_SOMETHING_ELSE}: {said}" if nothing else ""


def _is_better(fits: float, own: float) -> bool:
    return 1 - fits**2 <= _LEFT * (1 - own**2) and fits >= max(_SURELY, own + _GAIN)


def _fit_of_half(learned: _Learned, number: int, delay: int) -> float:
    """Return the correlation of that half of an episode that fits better: what is odd is so from beginning to end.

    Where the robot is in one place that it never is in else, that half may fit nothing, and turn the mean of the other.
    """
    take, half = learned.takes[number], len(learned.takes[number].at) // 2
    halves = (
        take._replace(pictures=take.pictures[some], at=take.at[some]) for some in (slice(half), slice(half, None))
    )
    ready = [_ready(each, learned.axes, _DELAYS[delay : delay + 1], least=2) for each in halves]
    weights = _weights(learned.sums, number)
    return max(float(_curve(each, weights)[0]) for each in ready)


def _leverage(learned: _Learned, number: int) -> float:
    """Return how far its places are from those of the others: by so much more is foretold wrongly, as a variance."""
    terms = _terms(_components(learned.takes[number], learned.axes))
    around = terms - terms.mean(axis=0)
    known = np.sum([sums.terms for other, sums in learned.sums.items() if other != number], axis=0)
    return float((around * np.linalg.solve(known + _RIDGE * np.eye(len(known)), around.T).T).sum() / len(terms))


def _belong_there(learned: _Learned, number: int, other: int, usual: int) -> bool:
    """Tell whether the pictures of two episodes are exchanged, or the same: that they look alike is not enough."""
    is_exchanged = _fit_of_another(learned, other, number) >= _around(learned.curves[other], usual) + _AS_WELL
    return is_exchanged or _same(learned.takes[number], learned.takes[other])


def _same(one: Take, other: Take) -> bool:
    """Tell whether two takes show the same at the same times, as far as both go."""
    both = one.at <= other.at[-1]
    seen, again = (one.pictures[both].astype(np.float64), _at(other.at, other.pictures, one.at[both]))
    left = np.square(seen - again).sum()
    return bool(left <= _SAME * np.square(seen - seen.mean(axis=0)).sum()) if both.sum() >= _MIN_PICTURES else False


def _at(when: Floats, values: Array, times: Floats) -> Floats:
    """Return what lies between values (n, k), of the times `when`, at other times: (..., k)."""
    return np.stack([np.interp(times, when, each) for each in values.astype(np.float64).T], axis=-1)


def _around(curve: Floats, delay: int) -> float:
    return float(curve[max(delay - 1, 0) : delay + 2].max())


def _all_late(curve: Floats, best: int) -> str:
    seconds = _DELAYS[best]
    then = "was then" if seconds > 0 else "is then"
    said = f"a correlation of {curve[best]:.2f} with where the robot {then}, and of {curve[_NONE]:.2f} with where it is"
    return f"pictures that are {abs(seconds):g} s {'late' if seconds > 0 else 'early'}: {said}"


def _later(curve: Floats, usual: int, best: int) -> str:
    by, own = _DELAYS[best] - _DELAYS[usual], _around(curve, usual)
    said = f"shifted so, a correlation of {curve[best]:.2f} with where the robot is, else of {own:.2f}"
    return f"pictures {abs(by):.2g} s {'later' if by > 0 else 'earlier'} than those of the others: {said}"


def _learn(takes: Mapping[int, Take]) -> tuple[_Learned, list[int]]:
    """Learn from some of the episodes; return also which."""
    axes = _axes(takes)
    chosen = np.array([*takes])[np.linspace(0, len(takes) - 1, min(len(takes), _SAMPLE)).astype(int)].tolist()
    sample = {number: _ready(takes[number], axes) for number in chosen}
    delays = _own_delays(sample)
    sums = {number: _sums(ready, delays[number]) for number, ready in sample.items()}
    curves = {
        number: _curve(sample.get(number) or _ready(take, axes), _weights(sums, number))
        for number, take in takes.items()
    }
    return _Learned(takes, axes, sums, curves), chosen


def _fits_of_neighbours(learned: _Learned, chosen: Sequence[int], by: int) -> float:
    """Return the correlation that is usual if all pictures are taken for those of an episode so much later."""
    numbers = [*learned.takes]
    place_of = {number: place for place, number in enumerate(numbers)}
    of = {number: place_of[number] + by for number in chosen if 0 <= place_of[number] + by < len(numbers)}
    ready = {number: _with_places_of(learned, number, numbers[place]) for number, place in of.items()}
    return _typical(ready, dict.fromkeys(ready, 0))


def _fits_of_others(learned: _Learned, number: int) -> Iterator[tuple[float, int]]:
    """Yield how well the pictures of an episode fit where the robot is in the episodes around it."""
    numbers = [*learned.takes]
    place = numbers.index(number)
    for other in numbers[max(place - _OTHERS, 0) : place + _OTHERS + 1]:
        if other != number:
            yield _fit_of_another(learned, number, other), other


def _fit_of_another(learned: _Learned, number: int, other: int) -> float:
    """Return how well the pictures of an episode fit where the robot is in another, as learned from neither."""
    return float(_curve(_with_places_of(learned, number, other), _weights(learned.sums, number, other))[0])


def _with_places_of(learned: _Learned, number: int, other: int) -> _Ready:
    """Hold the pictures of one episode against the robot of another, with no delay: the arrays have one."""
    own, take = learned.takes[number], learned.takes[other]
    return _ready(own._replace(places=take.places, when=take.when), learned.axes, delays=np.zeros(1))


def _axes(takes: Mapping[int, Take]) -> _Axes:
    places = np.concatenate([take.places for take in takes.values()]).astype(np.float64)  # (n, size)
    spread = places.std(axis=0)
    scale = np.divide(1, spread, out=np.zeros_like(spread), where=spread > _RESTS)
    alike = np.cov((places * scale).T).reshape(len(scale), -1)
    return _Axes(places.mean(axis=0), scale[:, None] * np.linalg.eigh(alike)[1][:, ::-1][:, :_COMPONENTS])


def _components(take: Take, axes: _Axes) -> Floats:
    """Return where the robot is at each of its places: (n_places, n_components)."""
    components: Floats = (take.places.astype(np.float64) - axes.middle) @ axes.directions
    return components


def _ready(take: Take, axes: _Axes, delays: Floats = _DELAYS, least: int = _MIN_PICTURES) -> _Ready:
    components = _components(take, axes)
    times = take.at - delays[:, None]  # (n_delays, n_pictures)
    known = (times >= take.when[0] - _RESTS) & (times <= take.when[-1] + _RESTS)
    known &= known.sum(axis=1, keepdims=True) >= least
    return _Ready(_around_mean(_terms(_at(take.when, components, times)), known), _around_mean(take.pictures, known))


def _terms(at: Floats) -> Floats:
    """Return of what pictures are made up, (..., n_terms), from components of where the robot is, (..., n_components).

    Themselves, their products, and waves in chosen directions, which stand for whatever is not so simple (Rahimi and
    Recht, "Random Features for Large-Scale Kernel Machines", 2007): low, so that the rest comes first.
    """
    n = at.shape[-1]
    one, other = np.triu_indices(n)
    rng = np.random.default_rng(0)
    directions = rng.normal(scale=1 / (_LENGTH * np.sqrt(n)), size=(n, _N_WAVES))
    waves = _HEIGHT * np.cos(at @ directions + rng.uniform(0, 2 * np.pi, _N_WAVES))
    terms: Floats = np.concatenate([at, at[..., one] * at[..., other], waves], axis=-1)
    return terms


def _around_mean(values: Array, known: Bools) -> Floats:
    """Of (n_pictures, k), or that for each delay: what is known, (n_delays, n_pictures), from its mean."""
    inside = known[..., None]
    mean = (values * inside).sum(axis=-2, keepdims=True) / np.maximum(inside.sum(axis=-2, keepdims=True), 1)
    around: Floats = (values - mean) * inside
    return around


def _sums(ready: _Ready, delay: int) -> _Sums:
    terms = ready.terms[delay]
    return _Sums(terms.T @ terms, terms.T @ ready.cells[delay])


def _weights(learned: Mapping[int, _Sums], *but: int) -> Floats:
    """Return how the cells follow from the terms, (n_terms, n_cells), as learned from all these episodes but some."""
    some = [sums for number, sums in learned.items() if number not in but]
    terms, cells = (np.sum(each, axis=0) for each in zip(*some, strict=True))
    weights: Floats = np.linalg.solve(terms + _RIDGE * np.eye(len(terms)), cells)
    return weights


def _curve(ready: _Ready, weights: Floats) -> Floats:
    """Return the correlation of what is shown with what is foretold at each delay, (n_delays,); -1 where nothing is."""
    foretold = ready.terms @ weights
    both = (foretold * ready.cells).sum(axis=(1, 2))
    sizes = np.sqrt(np.square(foretold).sum(axis=(1, 2)) * np.square(ready.cells).sum(axis=(1, 2)))
    curve: Floats = np.divide(both, sizes, out=np.full(len(both), -1.0), where=sizes > _RESTS)
    return curve


def _curves(sample: Mapping[int, _Ready], delays: Mapping[int, int]) -> dict[int, Floats]:
    learned = {number: _sums(ready, delays[number]) for number, ready in sample.items()}
    return {number: _curve(ready, _weights(learned, number)) for number, ready in sample.items()}


def _own_delays(sample: Mapping[int, _Ready]) -> Mapping[int, int]:
    """Find the delay of each episode, as its place in `_DELAYS`.

    Each finds where it fits the others as they are. As that leaves open by how much all of them are late, all are tried
    at each delay: alike, where they fit as well as each with its own does.
    """
    own, places = _settled(sample, dict.fromkeys(sample, _NONE)), range(len(_DELAYS))
    alike = [dict.fromkeys(sample, place) for place in places]
    as_well = _typical(sample, own) - _MORE
    best = _better(sample, alike)
    if _typical(sample, alike[best]) >= as_well:
        return _settled(sample, alike[best])
    apart = [_shifted(own, place - _NONE) for place in places]
    return _settled(sample, apart[_better(sample, apart)])


def _better(sample: Mapping[int, _Ready], tried: Sequence[Mapping[int, int]]) -> int:
    """Return which of these fits best, if it does so in most episodes; else the best around no delay."""
    fits = np.array([_fits(sample, delays) for delays in tried])  # (n_delays, n)
    usual = np.median(fits, axis=1)
    best, near = int(usual.argmax()), int(np.where(np.abs(_DELAYS) <= _NEAR, usual, -1).argmax())
    gain = fits[best] - fits[near]
    return best if np.median(gain) >= _MORE and (gain > 0).mean() >= _MOST else near


def _fits(sample: Mapping[int, _Ready], delays: Mapping[int, int]) -> list[float]:
    """Return the correlation of each at its delay, as the others foretell it at theirs."""
    ready = {number: _Ready(*(each[delays[number]][None] for each in both)) for number, both in sample.items()}
    return [float(curve[0]) for curve in _curves(ready, dict.fromkeys(sample, 0)).values()]


def _typical(sample: Mapping[int, _Ready], delays: Mapping[int, int]) -> float:
    return float(np.median(_fits(sample, delays)))


def _settled(sample: Mapping[int, _Ready], delays: Mapping[int, int]) -> Mapping[int, int]:
    for _ in range(_ROUNDS):
        delays = {number: int(curve.argmax()) for number, curve in _curves(sample, delays).items()}
    return delays


def _shifted(delays: Mapping[int, int], by: int) -> dict[int, int]:
    return {number: min(max(delay + by, 0), len(_DELAYS) - 1) for number, delay in delays.items()}


def _usual_delay(curves: Mapping[int, Floats]) -> tuple[int, Floats]:
    """Return the delay that many episodes have, of two the smaller one; and how many have about each, (n_delays,)."""
    best = np.array([curve.argmax() for curve in curves.values()])
    share: Floats = (np.abs(_DELAYS[best][:, None] - _DELAYS) <= _OF_ONE).mean(axis=0)
    least = int(np.where(share >= min(_MANY, share.max()), np.abs(_DELAYS) - share / len(_DELAYS), np.inf).argmin())
    return int(np.median(best[np.abs(_DELAYS[best] - _DELAYS[least]) <= _OF_ONE])), share
