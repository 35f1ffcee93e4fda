"""How does every joint follow its command? Summed up for each run of frames, so that no file stays in memory.

A dimension of the action is held against the column that it drives, by a reading or by their names, as a place to be
in or as a change to make, some frames later or earlier. Each data file is folded into a few numbers for every run of
frames and every such pair (`Following`); `z2r.audits.joints` asks what they say together. What is usual in a file is
told by its first runs (`Usual`), so that no later one has to wait for those that come after it.
"""

import re
from collections.abc import Collection, Iterator, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from z2r.arrays import Bools, Columns, Floats, Ints, stack_columns
from z2r.audits.frames import RunStats
from z2r.audits.steps import Counts, change_in_runs, count_in_runs, is_a_turn, run_of
from z2r.format.schema import ACTION, STATE, Schema, column_label
from z2r.reading.joints import joints_of
from z2r.reading.reading import Reading

MIN_FRAMES = 40  # of a run: from fewer nothing is said
FOLLOWS = 0.7  # share of a command's variance that its column must explain

_LATE, _AHEAD = 10, 20  # frames: so far before and after a command its column is looked for
_SAMPLE = 5  # of the first runs of a file, from which its usual lag is taken
_LONGEST = 600  # frames of a run that are looked at closer
_OFF = 3  # times as much unexplained as in the better runs: look closer
_LITTLE = 0.004  # of the variance: what leaves less unexplained needs no closer look
_SECOND = 24  # frames, about: `_sums_of_a_second` adds up as many
_MAX_LOOKS = 256  # runs of a file, for each pair
_ALIKE, _TOO_LITTLE = 1.5, 1e-4  # times as much unexplained, and a share of the variance: these lags fit as well
_ROUNDING = 1e-12  # of a mean square: a variance that is less is none
_POOR = 0.9  # explained: below, another column may explain more

_LAGS = ("lag", "least", "most")


# Parts of a name that say of a command that it is one, as of `w_cmd` or `goal.x`, and of what sort: `delta_x` or `vx`.
_COMMAND = {"cmd", "command", "target", "goal", "des", "desired", "ref"}
_MOTION = {"d", "delta", "v", "vel", "velocity"}


class Pair(NamedTuple):
    """A dimension of the action, and the observed column that it drives: where they stand, and what to call them."""

    dim: int
    feature: str
    column: int
    command: str
    name: str


class Following(NamedTuple):
    """How columns follow their commands: a row for each run of frames, a column for each pair.

    Attributes
    ----------
    n : ndarray, float64[n_runs]
        Frames.
    asked, moved : ndarray, float64[n_runs, n_pairs]
        How far the command goes, and how far its column: the largest value less the smallest.
    kind : ndarray, float64[n_runs, n_pairs]
        0 where the column comes to be where the command says, 1 where its change is what the command says.
    lag, least, most : ndarray, float64[n_runs, n_pairs]
        How many frames after its command that is, and the range in which that can be told; NaN where it cannot.
    explained : ndarray, float64[n_runs, n_pairs]
        Share of the command's variance that is explained then.
    factor : ndarray, float64[n_runs, n_pairs]
        How many of the command's units are one of the column's.
    mean_asked, mean_seen : ndarray, float64[n_runs, n_pairs]
        Of the command, and of the column so many frames later.
    other, other_explained : ndarray, float64[n_runs, n_pairs]
        The pair whose column explains the command best, and how much; NaN where nobody looked.
    beside, beside_at : ndarray, float64[n_runs, n_pairs]
        How far the command is from where the column comes to be, at most, on average over about a second; and in which
        frame of the run that second begins. NaN where the column does not follow in this file.
    turns_asked, turns_seen : ndarray, int32[n_runs, n_pairs]
        How often the command, and the column, go on at the other end of a whole turn.
    copied, foretold : ndarray, float64[n_runs, n_pairs]
        Share of the frames in which the command changes where it is the column in the same frame, and in the next one,
        bit for bit.
    """

    n: Floats
    asked: Floats
    moved: Floats
    kind: Floats
    lag: Floats
    least: Floats
    most: Floats
    explained: Floats
    factor: Floats
    mean_asked: Floats
    mean_seen: Floats
    other: Floats
    other_explained: Floats
    beside: Floats
    beside_at: Floats
    turns_asked: Counts
    turns_seen: Counts
    copied: Floats
    foretold: Floats


def pairs_of(schema: Schema, reading: Reading | None) -> tuple[Pair, ...]:
    """Return each dimension of the action with the column of the state that it drives, as far as that is known.

    A reading says so, or else their names are the same, but for what says that one is a command, or a step or velocity
    of the other; or else neither has names and both have as many dimensions. What a name promises is held against the
    data: a column that does not follow is not judged.

    Examples
    --------
    >>> import z2r
    >>> [(pair.command, pair.name) for pair in pairs_of(z2r.load("standin").schema, z2r.PUSHT)]
    [('action[pusher_vx]', 'observation.state[pusher_x]'), ('action[pusher_vy]', 'observation.state[pusher_y]')]
    """
    places = [(joint.action[1], *joint.state) for joint in joints_of(schema, reading)]
    features = schema.signals()
    if ACTION in features and STATE in features:
        action, state = features[ACTION], features[STATE]
        if not (reading and reading.action):
            taken = {dim for dim, *_ in places}, {column for _, feature, column in places if feature == STATE}
            places += [(dim, STATE, column) for dim, column in _kin(action.dim_names, state.dim_names, *taken)]
        if not places and action.size == state.size and not action.dim_names and not state.dim_names:
            places = [(dim, STATE, dim) for dim in range(action.size)]
    return tuple(
        Pair(
            dim,
            feature,
            column,
            column_label(ACTION, features[ACTION], dim),
            column_label(feature, features[feature], column),
        )
        for dim, feature, column in places
        if feature in features
    )


def _kin(
    commands: Sequence[str], columns: Sequence[str], named: Collection[int], taken: Collection[int]
) -> Iterator[tuple[int, int]]:
    """Pair commands and columns whose names differ by a word such as ``cmd`` or ``d``, if one column alone fits.

    Examples
    --------
    >>> [*_kin(["hand_vx", "w_cmd", "y"], ["hand_x", "y", "w"], {2}, {1})]
    [(0, 0), (1, 2)]
    >>> [*_kin(["cmd_vx"], ["x", "vx"], set(), set())]
    [(0, 1)]
    """
    stems = [_stem(name) for name in columns]
    for dim, command in enumerate(commands):
        said = _stem(command)
        same = [column for column, stem in enumerate(stems) if stem == said]  # `vx_cmd` is of `vx`, if there is one
        kin = same or [column for column, stem in enumerate(stems) if stem == _without_motion(said)]
        if dim not in named and len(kin) == 1 and kin[0] not in taken:
            yield dim, kin[0]


def _stem(name: str) -> list[str]:
    return [part for part in re.split("[^a-z0-9]+", name.lower()) if part not in _COMMAND]


def _without_motion(stem: list[str]) -> list[str]:
    return [re.sub("^[dv](?=[xyz]$)", "", part) for part in stem if part not in _MOTION]


class Usual(NamedTuple):
    """How a column follows its command in the first runs of a file, which all of its runs are held against.

    Attributes
    ----------
    lag : _Lag or None
        In which way, and how much later; None where it does not follow.
    mean_asked, mean_seen : float
        Of the command, and of the column, or of its change where that is what follows.
    factor : float
        How many of the command's units are one of the column's.
    unexplained : float
        Share of the command's variance that the column leaves unexplained in the better runs.
    looks : int
        How many more runs of the file may be looked at closer.
    """

    lag: "_Lag | None"
    mean_asked: float
    mean_seen: float
    factor: float
    unexplained: float
    looks: int


def fold_following(
    pairs: Sequence[Pair],
    columns: Columns,
    stats: Mapping[str, RunStats],
    starts: Ints,
    head: int,
    usual: Sequence[Usual] = (),
) -> tuple[Following | None, Sequence[Usual]]:
    """Sum up how the columns of one data file follow their commands.

    Parameters
    ----------
    pairs : sequence of Pair
        Of `pairs_of`.
    columns : dict of str to ndarray
        The frames of the file, or of a block of whole runs of it.
    stats : dict of str to RunStats
        What is known of each run of these.
    starts : ndarray, int64[n_runs]
        The first row of each run of frames.
    head : int
        How many of the first runs tell what is usual, where nobody knows it yet.
    usual : sequence of Usual
        What is usual for each pair, as the block before left it; nothing for the first block.

    Returns
    -------
    following : Following or None
        None where a feature of a pair is not there.
    usual : sequence of Usual
        For the block after this one.
    """
    if not pairs or any(name not in columns for name in (ACTION, *(pair.feature for pair in pairs))):
        return None, ()
    stops = np.append(starts[1:], len(columns[ACTION]))
    known: Sequence[Usual | int] = usual or [head] * len(pairs)
    folded = [_fold_pair(pairs, place, columns, stats, starts, stops, known[place]) for place in range(len(pairs))]
    parts, now = zip(*folded, strict=True)
    each = {name: stack_columns([part[name] for part in parts]) for name in Following._fields if name != "n"}
    return Following((stops - starts).astype(np.float64), **each), now


class _Lag(NamedTuple):
    """In which way a column follows (1: by its change), how many frames later, in which range, and how closely."""

    kind: int
    lag: int
    least: int
    most: int
    explained: float


def _usual(
    asked: Floats, seen: Floats, ranges: dict[str, Floats], starts: Ints, stops: Ints, head: int
) -> tuple[Usual, dict[str, Floats]]:
    """Say how a column follows in the first runs of a file, and how in each of all runs, as `_fit_runs` does."""
    lag = _usual_lag(asked, seen, starts[:head], stops[:head])
    target = change_in_runs(seen, starts) if lag and lag.kind else seen
    means = float(asked[: stops[head - 1]].mean()), float(target[: stops[head - 1]].mean())
    fit = _fit_runs(asked, target, starts, stops, lag.lag if lag else 0, means)
    well = fit["explained"][:head] > _POOR
    factor = float(np.median(fit["factor"][:head][well])) if well.any() else 1.0
    moves = _moves(ranges["asked"], ranges["moved"], stops - starts)[:head]
    good = float(np.quantile(1 - fit["explained"][:head][moves], 0.2)) if moves.any() else 0.0
    return Usual(lag, *means, factor, good, _MAX_LOOKS if lag else _SAMPLE), fit


def _usual_lag(asked: Floats, seen: Floats, starts: Ints, stops: Ints) -> _Lag | None:
    """Say how a column follows in most of some runs, as a few of them tell that are spread over them; None: not."""
    long = np.flatnonzero(stops - starts >= MIN_FRAMES)
    chosen = long[:: max(1, -(-len(long) // _SAMPLE))].tolist()
    looks = (_best_lag(asked[rows], seen[rows]) for rows in (_rows(run, starts, stops) for run in chosen))
    found = [look for look in looks if look.explained > FOLLOWS]
    if not found:
        return None
    kind = int(np.median([look.kind for look in found]))
    alike = sorted((look for look in found if look.kind == kind), key=lambda look: look.lag)
    return alike[len(alike) // 2]


def _rows(run: int, starts: Ints, stops: Ints) -> slice:
    return slice(int(starts[run]), int(min(stops[run], starts[run] + _LONGEST)))


def _fold_pair(
    pairs: Sequence[Pair],
    place: int,
    columns: Columns,
    stats: Mapping[str, RunStats],
    starts: Ints,
    stops: Ints,
    known: Usual | int,
) -> tuple[dict[str, Any], Usual]:
    """Sum up one pair: every field of `Following` but the first, each float64[n_runs]; and what is usual.

    What is usual is known, or so many of the first runs tell.
    """
    pair = pairs[place]
    asked, seen = _command(pair, columns), _column(pair, columns)
    of_asked, of_seen = stats[ACTION].column(pair.dim), stats[pair.feature].column(pair.column)
    ranges = {"asked": of_asked.high - of_asked.low, "moved": of_seen.high - of_seen.low}
    changes = _changes(asked, starts)
    turns = {
        "turns_asked": _turns(asked, of_asked.step, ranges["asked"], starts),
        "turns_seen": _turns(seen, of_seen.step, ranges["moved"], starts),
    }
    both = np.logical_and(*turns.values())
    if both.any():
        for run in np.flatnonzero(both).tolist():
            _unwind(asked[starts[run] : stops[run]])
            _unwind(seen[starts[run] : stops[run]])
        ranges = {"asked": _ranges(asked, starts), "moved": _ranges(seen, starts)}
    if isinstance(known, Usual):
        usual, lag = known, known.lag
        target = change_in_runs(seen, starts) if lag and lag.kind else seen
        fit = _fit_runs(asked, target, starts, stops, lag.lag if lag else 0, known[1:3])
    else:
        usual, fit = _usual(asked, seen, ranges, starts, stops, known)
    nothing = np.full(len(starts), np.nan)
    found: dict[str, Any] = {
        **ranges,
        "kind": np.full(len(starts), float(usual.lag.kind if usual.lag else 0)),
        **{name: np.full(len(starts), getattr(usual.lag, name, np.nan), dtype=np.float64) for name in _LAGS},
        **fit,
        "other": nothing.copy(),
        "other_explained": nothing.copy(),
        **_stray(asked, seen, starts, stops, usual),
        **turns,
        **_copied(asked, seen, changes, starts),
    }
    looks = _worth_a_look(found, stops - starts, usual)
    for run in looks:
        rows = _rows(run, starts, stops)
        for name, value in _look(asked[rows], seen[rows], found["explained"][run]):
            found[name][run] = value
        if found["explained"][run] < _POOR:
            found["other"][run], found["other_explained"][run] = _best_other(pairs, columns, asked[rows], rows)
    for name in _LAGS:
        found[name][found["explained"] < FOLLOWS] = np.nan
    return found, usual._replace(looks=usual.looks - len(looks))


def _ranges(values: Floats, starts: Ints) -> Floats:
    """Say how far each run goes: the largest value less the smallest."""
    ranges: Floats = np.maximum.reduceat(values, starts) - np.minimum.reduceat(values, starts)
    return ranges


def _changes(values: Floats, starts: Ints) -> Bools:
    """Say of each frame whether a column is not what it was in the frame before of the same run."""
    changes = np.empty(len(values), dtype=bool)
    np.not_equal(values[1:], values[:-1], out=changes[1:])
    changes[starts] = False
    return changes


def _turns(values: Floats, largest: Floats, ranges: Floats, starts: Ints) -> Counts:
    """Count the steps of a whole turn in each run, of which the largest step is known."""
    if not is_a_turn(largest, ranges).any():
        return np.zeros(len(starts), np.int32)
    sizes = np.abs(change_in_runs(values, starts))
    return count_in_runs(is_a_turn(sizes, np.repeat(ranges, np.diff(starts, append=len(sizes)))), starts)


def _unwind(values: Floats) -> None:
    """Let an angle go on beyond a whole turn, where it stands."""
    values[:] = np.unwrap(values, period=360.0 if np.ptp(values) > 180 else 2 * np.pi)


def _copied(asked: Floats, seen: Floats, changes: Bools, starts: Ints) -> dict[str, Floats]:
    """Say of each run in which share of the frames a command is the column in the same frame, and in the next one."""
    n = np.maximum(count_in_runs(changes, starts), 1)
    foretold = changes.copy()
    foretold[:-1] &= asked[:-1] == seen[1:]
    foretold[np.append(starts[1:], len(foretold)) - 1] = False
    return {
        "copied": count_in_runs(changes & (asked == seen), starts) / n,
        "foretold": count_in_runs(foretold, starts) / n,
    }


def _stray(asked: Floats, seen: Floats, starts: Ints, stops: Ints, usual: Usual) -> dict[str, Floats]:
    """Say how far beside its command a column comes to be in the worst second of each run."""
    worst, at = np.full(len(starts), np.nan), np.full(len(starts), np.nan)
    if usual.lag is None or usual.lag.kind:
        return {"beside": worst, "beside_at": at}
    lag = usual.lag.lag
    beside = _with_an_end(seen, lag)[:-1]
    beside *= usual.factor
    np.subtract(asked, beside, out=beside)
    beside -= usual.mean_asked - usual.factor * usual.mean_seen
    mean = _sums_of_a_second(beside)  # of the frames from each on
    np.abs(mean, out=mean)
    mean /= _SECOND
    first, last = starts + max(-lag, 0), stops - max(lag, 0) - _SECOND
    long = first < last
    if not long.any():
        return {"beside": worst, "beside_at": at}
    ends = np.stack([first[long], last[long]], axis=1).ravel()
    worst[long] = np.maximum.reduceat(mean, ends)[::2]
    levels = np.stack([np.full(long.sum(), np.nan), worst[long]], axis=1).ravel()  # between runs, and in them
    bounds = np.concatenate([[0], ends, [len(mean)]])
    level = np.repeat(np.concatenate([levels, [np.nan]]), bounds[1:] - bounds[:-1])
    hits = np.flatnonzero(mean == level)[::-1]  # the first of each run is written last
    run = run_of(hits, starts)
    at[run] = hits - starts[run]
    return {"beside": worst, "beside_at": at}


def _sums_of_a_second(values: Floats) -> Floats:
    """Add up 24 in a row, from each on; running totals would be slower, and lose digits."""
    twos = values[:-1] + values[1:]
    fours = twos[:-2] + twos[2:]
    eights = fours[:-4] + fours[4:]
    sums: Floats = eights[:-16] + eights[8:-8] + eights[16:]
    return sums


def _moves(asked: Floats, moved: Floats, n: Ints) -> Bools:
    """Say in which runs both move for long enough to tell something."""
    moves: Bools = (n >= MIN_FRAMES) & (asked > 0) & (moved > 0)
    return moves


def _worth_a_look(found: dict[str, Floats], n: Ints, usual: Usual) -> list[int]:
    """Choose the runs in which the column follows worse than in the better ones, or the first, where it does not."""
    worth = _moves(found["asked"], found["moved"], n)
    if usual.lag:
        worth &= 1 - found["explained"] > max(_LITTLE, _OFF * usual.unexplained)
    some: list[int] = np.flatnonzero(worth)[: usual.looks].tolist()
    return some


def _look(asked: Floats, seen: Floats, explained: float) -> Iterator[tuple[str, float]]:
    """Say how else a column follows in one run, where that explains more."""
    best = _best_lag(asked, seen)
    if best.explained <= explained:
        return
    start, stop = np.array([0]), np.array([len(asked)])
    target = change_in_runs(seen, start) if best.kind else seen
    fit = _fit_runs(asked, target, start, stop, best.lag, (float(asked.mean()), float(target.mean())))
    yield from (best._asdict() | {name: float(value[0]) for name, value in fit.items()}).items()


def _best_lag(asked: Floats, seen: Floats) -> _Lag:
    """Say in which way a column follows best in one run of frames."""
    before, after = min(_LATE, len(asked) // 4), min(_AHEAD, len(asked) // 4)
    core, kind = asked[before : len(asked) - after], 0
    explained = _explained(core, seen)  # (before + after + 1,)
    if explained.max() < _POOR:
        by_change = _explained(core, change_in_runs(seen, np.array([0])))
        kind = int(by_change.max() > explained.max())
        explained = by_change if kind else explained
    lag, best = int(explained.argmax()), float(explained.max())
    alike = np.flatnonzero(1 - explained <= _ALIKE * (1 - best) + _TOO_LITTLE) - before
    return _Lag(kind, lag - before, int(alike[0]), int(alike[-1]), best)


def _best_other(pairs: Sequence[Pair], columns: Columns, asked: Floats, rows: slice) -> tuple[float, float]:
    """Return the pair whose column follows a command of one run best, and how much that explains."""
    before, after = min(_LATE, len(asked) // 4), min(_AHEAD, len(asked) // 4)
    core = asked[before : len(asked) - after]
    explained = [_explained(core, _column(pair, columns, rows)).max() for pair in pairs]
    best = int(np.argmax(explained))
    return float(best), float(explained[best])


def _explained(asked: Floats, seen: Floats) -> Floats:
    """Say how much of a command's variance a column explains at every lag, float64[n_lags], in [0, 1].

    The column is longer than the command by as many frames as there are lags, less one.
    """
    seen, asked, ones = seen - seen.mean(), asked - asked.mean(), np.ones(len(asked))
    both: Any = np.correlate(seen, asked, "valid")
    sums, squares = np.correlate(seen, ones, "valid"), np.correlate(np.square(seen), ones, "valid")
    spread = squares - np.square(sums) / len(asked)
    spread[spread <= _ROUNDING * squares] = 0  # of what stands still, nothing
    return _share(both, spread * (asked @ asked) * bool(np.ptp(asked)))


def _share(both: Floats, whole: Floats) -> Floats:
    """Return the share of a variance that is explained: a covariance squared, over both variances."""
    share: Floats = np.divide(np.square(both), whole, out=np.zeros(len(both)), where=whole > 0).clip(max=1)
    return share


def _fit_runs(
    asked: Floats, seen: Floats, starts: Ints, stops: Ints, lag: int, centre: tuple[float, float]
) -> dict[str, Floats]:
    """Fit a column, so many frames later, to its command in every run, each float64[n_runs].

    As in `z2r.reading.action`, the column is explained by the command, which is exact. Numbers near 0 keep more digits:
    `centre` is about where both are.
    """
    first, last = np.minimum(starts + max(-lag, 0), stops), np.maximum(stops - max(lag, 0), starts)
    last = np.maximum(last, first)
    n, ends = np.maximum(last - first, 1), np.stack([first, last], axis=1).ravel()
    centre_a, centre_s = centre
    asked, seen = _with_an_end(asked, 0), _with_an_end(seen, lag)
    asked -= centre_a
    seen -= centre_s

    def means(values: Floats) -> Floats:
        mean: Floats = np.where(first < last, np.add.reduceat(values, ends)[::2], 0.0) / n
        return mean

    def variances(values: Floats, mean: Floats) -> Floats:
        squares = means(np.square(values))
        variance = squares - np.square(mean)
        return np.where(variance > _ROUNDING * squares, variance, 0.0)  # of what stands still, nothing

    mean_a, mean_s = means(asked), means(seen)
    var_a, var_s, both = variances(asked, mean_a), variances(seen, mean_s), means(asked * seen) - mean_a * mean_s
    factor = np.divide(var_a, both, out=np.zeros(len(both)), where=both != 0)
    return {
        "explained": _share(both, var_a * var_s),
        "factor": factor,
        "mean_asked": mean_a + centre_a,
        "mean_seen": mean_s + centre_s,
    }


def _with_an_end(values: Floats, lag: int) -> Floats:
    """Return values so many frames earlier, then the others, and one more: the last run, too, has an end there."""
    first = lag % len(values)
    return np.concatenate([values[first:], values[:first], [0.0]])


def _command(pair: Pair, columns: Columns) -> Floats:
    return columns[ACTION][:, pair.dim].astype(np.float64)


def _column(pair: Pair, columns: Columns, rows: slice = slice(None)) -> Floats:
    return columns[pair.feature][rows, pair.column].astype(np.float64)
