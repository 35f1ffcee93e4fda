"""Do the pictures of an episode look like those of the others? What they show most of the time is held against it.

Nothing says what a camera should show but its other episodes. Where all of them differ, as those of a camera on a wrist
do, nothing is said. What one that differs looks like is told by trying: would it fit the others if it were turned?
"""

from collections.abc import Callable, Iterator, Mapping
from typing import NamedTuple

import numpy as np

from z2r.arrays import Bools, Floats, Ints
from z2r.audits.glances import Glance

_MIN_EPISODES = 5  # from fewer nothing can be said about what is usual
_CANDIDATES = 16  # for what is usual: as half of the episodes are, some of these are among them
_GAP = 3  # times as far as those that are usual
_FEW = 0.25  # of the episodes: of more, nobody knows which ones are right
_LEVEL = 110  # to which all views are brought, so that daylight does not matter
_LIMIT = 40  # grey levels: what lies elsewhere changes some cells by more, a camera that was moved most of them
_VIEWS_APART = 5  # grey levels, on average over the picture
_TURNED_APART = 2  # grey levels: by so much it must be another view at least
_GRAINS_APART, _LEVELS_APART = 0.5, 0.3  # of a logarithm: factors of 1.6 and 1.35
_FITS, _FITS_TURNED = 0.4, 0.55  # of the distance: less is left where a guess is right, and where it is turned
_COLOURLESS = 3  # grey levels between the channels, on average
_DARK, _WHITE = 24, 250
_STRIPE = 25  # grey levels in a channel
_COVERED, _MUCH_COVERED, _BURNT = 0.08, 0.25, 0.25  # of the picture

_TURNS: dict[str, Callable[[Floats], Floats]] = {
    "upside down": lambda view: view[::-1, ::-1],
    "mirrored": lambda view: view[:, ::-1],
    "with red and blue exchanged": lambda view: view[..., ::-1],
}


class Unlike(NamedTuple):
    """Episodes whose pictures differ from those of the others of their camera, by their rows in the metadata.

    Attributes
    ----------
    rows, usual : ndarray of int
        Those that differ, and those from which they do.
    says : str
        What they look like; empty where that cannot be told.
    few : bool
        Whether they are so few that the others are likely to be right.
    """

    rows: Ints
    usual: Ints
    says: str
    few: bool


class _Views(NamedTuple):
    """What one camera shows: the rows of the episodes, (n, 12, 16, 3) of their views, and which of them differ."""

    rows: Ints
    views: Floats
    differ: Bools

    @property
    def usual(self) -> Floats:
        return _middle(self.views[~self.differ])

    @property
    def flat(self) -> Floats:
        return _level(self.views).reshape(len(self.views), -1)

    def only(self, some: Bools) -> "_Views":
        return _Views(self.rows[some], self.views[some], self.differ[some])


def unlike(cameras: Mapping[str, Mapping[int, Glance]]) -> dict[str, list[Unlike]]:
    """Find the episodes of each camera whose pictures differ from those of the others."""
    views = {camera: _views(seen) for camera, seen in cameras.items() if len(seen) >= _MIN_EPISODES}
    found = {}
    for camera, own in views.items():
        others = {f"like those of {name}": other for name, other in views.items() if name != camera}
        turned = _turned(own, others)
        left = _but(own, turned)
        strangers = [
            (said, _middle(other.views[some]))
            for said, other in others.items()
            for some in (~other.differ, other.differ)
            if some.any()
        ]
        seen = cameras[camera]
        unlike_others = [*turned, *_unlike_views(left, strangers)]
        found[camera] = [*unlike_others, *_blurred(left, seen), *_dark(_but(own, unlike_others), seen)]
    return found


def _but(own: _Views, told: list[Unlike]) -> _Views:
    """Leave out those of which something is told."""
    return own.only(~np.isin(own.rows, [row for each in told for row in each.rows.tolist()]))


def _turned(own: _Views, others: Mapping[str, _Views]) -> list[Unlike]:
    """Find those that fit one of the others once they are turned, or that fit it as another camera shows it.

    However many they are: it needs no view that is usual. Which of them are right is told by how many they are; of two
    that are as many, it is those that are not like the first episode.
    """
    candidates = _candidates(len(own.rows))
    middle = int(candidates[np.argmin([np.median(_far(own.flat, own.flat[row])) for row in candidates])])
    turned = _turned_from(own, others, middle)
    as_many = (2 * len(each.rows) == len(own.rows) and own.rows[0] in each.rows for each in turned)
    return _turned_from(own, others, 0) if any(as_many) else turned


def _turned_from(own: _Views, others: Mapping[str, _Views], middle: int) -> list[Unlike]:
    at = own.rows[middle]
    seen = [(said, view) for said, other in others.items() for view in other.views[other.rows == at]]
    says, usual = dict[str, list[int]](), own.views[middle]
    for row, view in zip(own.rows.tolist(), own.views, strict=True):
        far = _apart(view, usual)
        left, said = _nearest(view, usual, seen)
        said = said if far >= _TURNED_APART and left <= _FITS_TURNED * far else _lacks(view, usual, _MUCH_COVERED)
        if said:
            says.setdefault(said, []).append(row)
    return [
        Unlike(np.array(rows), own.rows[~np.isin(own.rows, rows)], said, _is_few(len(rows), len(own.rows)))
        for said, rows in says.items()
    ]


def differ(features: Floats, floor: float) -> Bools:
    """Tell which episodes differ from what is usual, (n,), by their features (n, k).

    Half of them or more are usual, and lie together; the others are at least `floor` away, and much farther than those
    that are usual are. Where they are many, they lie together as well.

    Examples
    --------
    >>> differ(np.array([[0.0], [1], [2], [1], [9], [1]]), floor=5).nonzero()[0].tolist()
    [4]
    >>> differ(np.array([[0.0], [1], [3], [5], [9], [12]]), floor=5).any()
    np.False_
    """
    n = len(features)
    half = (n + 1) // 2
    each = [_far(features, features[row]) for row in _candidates(n)]
    densest = min(each, key=lambda far: float(np.partition(far, half - 1)[half - 1]))
    far = _far(features, np.median(features[np.argsort(densest, kind="stable")[:half]], axis=0))
    ordered = np.sort(far)
    gaps = np.flatnonzero(ordered[half:] >= np.maximum(floor, _GAP * ordered[half - 1 : -1]))
    if not len(gaps):
        return np.zeros(n, dtype=bool)
    edge = ordered[half + gaps[0]]
    others = features[far >= edge]
    together = _far(others, np.median(others, axis=0)).max() <= edge / _GAP
    apart: Bools = (far >= edge) & (together or _is_few(len(others), n))
    return apart


def _candidates(n: int) -> Ints:
    return np.unique(np.linspace(0, n - 1, _CANDIDATES).astype(np.int64))


def _far(features: Floats, feature: Floats) -> Floats:
    far: Floats = np.minimum(np.abs(features - feature), _LIMIT).mean(axis=1)
    return far


def _is_few(some: int, n: int) -> bool:
    return some <= max(1, _FEW * n)


def _views(seen: Mapping[int, Glance]) -> _Views:
    views = np.stack([glance.view for glance in seen.values()]).astype(np.float64)
    return _Views(np.array([*seen]), views, differ(_level(views).reshape(len(views), -1), _VIEWS_APART))


def _level(views: Floats) -> Floats:
    """Make all of them as bright."""
    level: Floats = views * (_LEVEL / np.maximum(views.mean(axis=(-3, -2, -1), keepdims=True), 1))
    return level


def _middle(views: Floats) -> Floats:
    middle: Floats = np.median(views, axis=0)
    return middle


def _unlike_views(own: _Views, strangers: list[tuple[str, Floats]]) -> Iterator[Unlike]:
    """Put those that look the same in one. Where they are many, all look the same, or the others do to them."""
    odd, usual = own.rows[own.differ], own.rows[~own.differ]
    if not len(usual):  # those that they differ from are turned
        return
    if not _is_few(len(odd), len(own.rows)):
        other = _middle(own.views[own.differ])
        said, back = _guess(other, own.usual, strangers), _guess(own.usual, other, strangers)
        yield Unlike(usual, odd, back, few=False) if back and not said else Unlike(odd, usual, said, few=False)
        return
    says = dict[str, list[int]]()
    for row, view in zip(odd.tolist(), own.views[own.differ], strict=True):
        says.setdefault(_guess(view, own.usual, strangers), []).append(row)
    for said, rows in says.items():
        yield Unlike(np.array(rows), usual, said, few=True)


def _guess(view: Floats, usual: Floats, strangers: list[tuple[str, Floats]]) -> str:
    """Say what a view looks like, by what fits far better than it does."""
    left, said = _nearest(view, usual, strangers)
    if left <= _FITS * _apart(view, usual):
        return said
    return _lacks(view, usual, _COVERED)


def _lacks(view: Floats, usual: Floats, covered_at_least: float) -> str:
    """Say what is missing in a view. Where nothing else says that it differs, a dark thing in it must be large."""
    if np.ptp(view, axis=-1).mean() <= _COLOURLESS < np.ptp(usual, axis=-1).mean() / _GAP:
        return "without colour"
    if _has_stripe(view) and not _has_stripe(usual):
        return "with a stripe from edge to edge"
    burnt = ((view >= _WHITE).all(axis=-1) & (usual < _WHITE).any(axis=-1)).mean()
    if burnt >= _BURNT:
        return f"white in {burnt:.0%} of the picture"
    covered = ((view <= _DARK).all(axis=-1) & (usual > _DARK).any(axis=-1)).mean()
    return f"black in {covered:.0%} of the picture" if covered >= covered_at_least else ""


def _has_stripe(view: Floats) -> bool:
    """Tell whether a row or a column is of another colour than those beside it, all along and in the same way."""
    for lines in (view, view.swapaxes(0, 1)):
        beside = np.stack([lines[1:-1] - lines[:-2], lines[1:-1] - lines[2:]], axis=1)  # (n_lines, 2, length, 3)
        if (beside.min(axis=(1, 2)) >= _STRIPE).any() or (beside.max(axis=(1, 2)) <= -_STRIPE).any():
            return True
    return False


def _nearest(view: Floats, usual: Floats, strangers: list[tuple[str, Floats]]) -> tuple[float, str]:
    """Return what makes a view fit best, or which stranger it fits, and how far it is then."""
    tries = [(said, turn(view), usual) for said, turn in _TURNS.items()]
    tries += [(said, view, other) for said, other in strangers]
    return min((_apart(one, other), said) for said, one, other in tries)


def _apart(one: Floats, other: Floats) -> float:
    return float(_far(_level(one).reshape(1, -1), _level(other).ravel())[0])


def _blurred(own: _Views, seen: Mapping[int, Glance]) -> Iterator[Unlike]:
    """Find those that are far less sharp than others that show the same."""
    rows = own.rows[~own.differ]
    grain = np.log([max(float(np.median(seen[row].grain)), 1e-6) for row in rows.tolist()])
    odd = differ(grain[:, None], _GRAINS_APART) if len(rows) >= _MIN_EPISODES else np.zeros(len(rows), dtype=bool)
    if not odd.any():
        return
    ratio, few = np.median(grain[odd]) - np.median(grain[~odd]), _is_few(int(odd.sum()), len(rows))
    if few and ratio > 0:
        return  # a thing of which one sees more
    blurred = odd if ratio < 0 else ~odd
    said = f"blurred, with {np.exp(-abs(ratio)):.0%} of the sharpness"
    yield Unlike(rows[blurred], rows[~blurred], said, few)


def _dark(own: _Views, seen: Mapping[int, Glance]) -> Iterator[Unlike]:
    """Find those that are far darker or brighter than the others. That may be daylight, so nobody is sure."""
    level = np.array([max(float(np.median(seen[row].level)), 1) for row in own.rows.tolist()])
    odd = differ(np.log(level)[:, None], _LEVELS_APART) if len(level) >= _MIN_EPISODES else np.zeros(0, dtype=bool)
    if odd.any():
        said = f"of a brightness of {np.median(level[odd]):.0f} of 255, where {np.median(level[~odd]):.0f} is usual"
        yield Unlike(own.rows[odd], own.rows[~odd], said, few=False)
