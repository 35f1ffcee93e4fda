"""What do the pictures look like in each episode? Seen where they are decoded; else guessed from what they take."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from itertools import combinations
from pathlib import Path
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from z2r.arrays import Bools, Floats, Ints
from z2r.audits.claims import Claims
from z2r.audits.copies import pictures_again, pictures_of_neighbours
from z2r.audits.footage import Footage, ImageSums, VideoSums, place_frames, size_of_the_same
from z2r.audits.glances import Filmed, Glance, Glances
from z2r.audits.hues import Misnamed, misnamed
from z2r.audits.runs import Runs
from z2r.audits.signs import Parted, drift, parted
from z2r.audits.together import Take, fit
from z2r.audits.views import Unlike, unlike
from z2r.errors import Fault, some
from z2r.format.about import cameras_of
from z2r.format.episodes import DATA_DIR
from z2r.format.schema import ACTION, STATE

_MIN_EPISODES = 5  # from fewer nothing can be said about what is usual
_LONG = 20  # frames: a picture may well stand still for less
_SELDOM = 0.1  # of the episodes
_DECODE = "To be sure, look at the pictures: z2r audit --pictures"

# Measured on h264, hevc and av1 as LeRobot encodes them, 96 x 96 to 480 x 640: a picture of one colour takes 36 to 162
# bytes, the plainest drawing 255 to 2,135.
_FLAT, _PIXELS_TO_A_FLAT_BYTE = 64, 512
_LITTLE = 0.25  # of what a change usually takes

# Of decoded pictures, from 0 to 255.
_ONE_COLOUR = 3  # of standard deviation, at most
_NOISE = 8  # what a cell changes by when the same picture is encoded again: measured, 7 and at times 24 at most
_SAME_VIEW, _SAME_CELL = 1.5, 16  # what cells differ by, and one of them, when the same picture is encoded twice
_DARK, _BLACK = 24, 4
_NO_SIGNAL = 1.2  # of grain: white noise has 1.41, and one pixel of a picture of something is much like the next

_HARDLY = 0.25  # of a large change while the robot moves
_SLOW, _TURNS = 0.2, 8  # of the robot's way, and steps between two in which it moves
_NOTHING, _OFTEN = 0.2, 0.6  # of the other step, that one makes which repeats a picture; and of such pairs of steps
_FITFUL = 0.5  # of these steps: from little change to more, or back

_MOSTLY, _A_WHILE, _NEVER = 0.5, 0.12, 0.03  # of the robot's way
_MIN_HUNG = 10  # frames, and at least a second
_HUNG, _FARTHER_THAN, _AS_FAST = 0.03, 2, 0.5  # of its way; times as far as in most episodes; of its usual speed
_PAIRS, _APART = 8, 1.5  # pairs of pictures, and frames between those that are far apart
_MUCH, _AS_FAR = 8, 0.9  # of 255, by which pictures differ; and of what they differ by that are far apart
_FEW, _ALONE, _FOR_GOOD = 4, 4, 0.25  # pictures; times what most differ by; of a leap, what stays of it
_BREAKS, _FARTHER = 2, 2  # leaps, and times as far as half an episode makes
_SWINGS = 8  # of 255: what light and shutter make of a picture from one to the next
_BLURRED = 0.6  # of the sharpness that an episode has most of the time
_MORE_THAN_NOISE = 1.5  # of 255
_BACK = 0.95  # of the farther one of two steps, the way of both
_TINY = 1e-9  # of it
_STEPS = 2  # of the robot's way for each picture: of one step, one is taken
_AGAIN = "the same pictures, although the robot is elsewhere, as episode"


class Way(NamedTuple):
    """At which frames of an episode it is known where the robot is, where it is, and how far it has come, up to 1."""

    frames: Ints
    places: Floats
    way: Floats


class Suspects(NamedTuple):
    """In which episodes something is wrong, by their rows in the metadata, and what was found in one of them."""

    wrong: Bools
    found: Callable[[int], str]


_NOBODY = Suspects(np.zeros(0, dtype=bool), str)


class Look(NamedTuple):
    """What the pictures of one camera look like.

    Attributes
    ----------
    camera, place : str, Path
        Which feature it is, and where they are stored.
    number : ndarray, int64[n_episodes]
        What the dataset calls the episodes.
    flat, still, blank, dark, hung, slow, flicker, broken, leap, swing, focus, disorder, again, seam, astray
        Each `Suspects`: where they are of one colour, or noise; stay the same although the robot moves; some of them
        are of one colour, or noise; some of them are black; stay the same for a while, unlike in the
        others; do so again and again; differ from one to the next; do so at times; are others from some frame on; get
        brighter and darker all the time; are blurred at times; are not in their order; are those of another episode;
        are so for some frames at an end; do not go with the robot.
    mend : str
        How to be surer; empty where it is sure.
    fits : float
        How well pictures usually go with the robot: a correlation; nan where too little of it is seen to say it.
    late : float
        By how much all of them are late [s].
    colour : ndarray, float64[3]
        Red, green and blue on average over all that was seen, from 0 to 1.
    deviation : ndarray, float64[3]
        Their standard deviations over all pixels of all pictures, from 0 to 1; of small pictures, so a little less.
    unlike : sequence of Unlike
        Which episodes look otherwise than the others; nobody knows where no picture is decoded.
    parted : sequence of Parted
        Of which episodes the pictures are made in another way, as a number says.
    drift : str
        By how much the camera moves from episode to episode, or once; empty where it does not.
    bars : str
        Where all pictures are black from edge to edge; empty where they are not on both sides.
    """

    camera: str
    place: Path
    number: Ints
    flat: Suspects
    still: Suspects
    mend: str
    blank: Suspects = _NOBODY
    dark: Suspects = _NOBODY
    hung: Suspects = _NOBODY
    slow: Suspects = _NOBODY
    flicker: Suspects = _NOBODY
    broken: Suspects = _NOBODY
    leap: Suspects = _NOBODY
    swing: Suspects = _NOBODY
    focus: Suspects = _NOBODY
    disorder: Suspects = _NOBODY
    again: Suspects = _NOBODY
    seam: Suspects = _NOBODY
    astray: Suspects = _NOBODY
    fits: float = np.nan
    late: float = 0.0
    colour: Floats = np.full(3, np.nan)
    deviation: Floats = np.full(3, np.nan)
    unlike: Sequence[Unlike] = ()
    parted: Sequence[Parted] = ()
    drift: str = ""
    bars: str = ""


class Twin(NamedTuple):
    """Two cameras, and in which episodes they show the same."""

    look: Look
    other: Look
    same: Bools


class Looks(NamedTuple):
    """What is claimed; what the pictures of all cameras look like; what cannot be decoded or seen; and tasks."""

    claims: Claims
    cameras: Sequence[Look]
    twins: Sequence[Twin]
    faults: Sequence[Fault]
    not_checked: Sequence[str]
    misnamed: Sequence[Misnamed] = ()


def looks_of_sizes(filmed: Filmed) -> Looks:
    """Tell from how many bytes each picture takes what it looks like: where nothing is decoded, most of it is a guess.

    Of images that stand in the data files, it is known which are the same.
    """
    footage, runs, images = filmed.footage, filmed.runs, filmed.images
    moves = _robot_moves(runs)
    of_videos = [_look_of_sizes(footage, camera, moves) for camera in footage.claims.videos.value]
    of_images = {camera: _look_of_images(camera, runs, sums, moves) for camera, sums in images.items()}
    twins = [
        Twin(of_images[camera], of_images[other], _episodes(runs, images[camera].prints == images[other].prints))
        for other, camera in combinations(images, 2)
    ]
    names = [camera.name for camera in cameras_of(runs.claims.schema)]
    unseen = f"what {some(names)} show: no picture was decoded, and sizes only hint at it (--pictures decodes)"
    return Looks(runs.claims, [*of_videos, *of_images.values()], twins, (), [unseen])


def looks_of_glances(filmed: Filmed, glances: Glances) -> Looks:
    """Tell from some decoded pictures what all of them look like."""
    runs = filmed.runs
    paths = {} if filmed.places is None else _paths_of_episodes(runs, filmed.places)
    looks = {camera: _look_of_glances(camera, seen, runs, paths) for camera, seen in glances.cameras.items()}
    rests = {camera: _rests(seen, filmed.images.get(camera), runs) for camera, seen in glances.cameras.items()}
    looks = {camera: _with_hung(look, rests[camera], runs, paths) for camera, look in looks.items()}
    twins = [
        Twin(looks[camera], looks[other], _same_views(glances.cameras[camera], glances.cameras[other], runs))
        for other, camera in combinations(looks, 2)
    ]
    views = _own_views(glances, looks, twins)
    looks = {camera: look._replace(unlike=views.get(camera, ())) for camera, look in looks.items()}
    tasks = _tasks(runs)
    looks = {camera: _with_signs(look, glances.cameras[camera], tasks) for camera, look in looks.items()}
    rights = {camera: _right(look, twins) for camera, look in looks.items()}
    looks = {
        camera: _held_against_the_robot(
            look, {row: own for row, own in seen.items() if rights[camera][row]}, runs, paths
        )
        for (camera, look), seen in zip(looks.items(), glances.cameras.values(), strict=True)
    }
    n_episodes = len(runs.claims.stored.episodes.value.table.number)
    return Looks(
        runs.claims,
        list(looks.values()),
        twins,
        glances.faults,
        [*_unseen(glances, n_episodes), *_unfit(looks, n_episodes)],
        _misnamed(glances, tasks, runs.claims),
    )


def _place(claims: Claims, camera: str) -> Path:
    spans = claims.videos.value.get(camera)
    return spans.paths[0].parent if spans else DATA_DIR


def _robot_moves(runs: Runs) -> Bools:
    """Tell of each episode of the metadata whether the robot moves in it, half as far as is usual or more."""
    number, of_signal = runs.claims.stored.episodes.value.table.number, runs.stats.get(STATE, runs.stats.get(ACTION))
    if of_signal is None:
        return np.zeros(len(number), dtype=bool)
    span = of_signal.high - of_signal.low  # (n_runs, size)
    usual = np.median(span, axis=0)
    share = np.minimum(span[:, usual > 0] / usual[usual > 0], 1)
    return np.isin(number, runs.number[share.sum(axis=1) >= 0.5 * np.maximum(1, (usual > 0).sum())])


# --- decoded


def _paths_of_episodes(runs: Runs, places: Floats) -> dict[int, Way]:
    """Return where the robot goes in each episode, by its row; in those that are in one file as a whole."""
    table = runs.claims.stored.episodes.value.table
    length = dict(zip(table.number.tolist(), enumerate(table.length.tolist()), strict=True))
    paths = {}
    for number, n_frames, own in zip(runs.number.tolist(), (runs.stop - runs.start).tolist(), places, strict=True):
        row, claimed = length.get(number, (-1, -1))
        if n_frames == claimed:
            paths[row] = Way(place_frames(np.array([n_frames]))[0], own, _way(own))
    return paths


def _way(places: Floats) -> Floats:
    """Return how far the robot has come at each of its places, from 0 to 1 of all its way.

    Each column counts alike, so that neither its unit nor its noise outweighs the others.
    """
    steps = np.abs(np.diff(places.astype(np.float64), axis=0, prepend=places[:1]))  # (n_places, size)
    whole = steps.sum(axis=0)
    way: Floats = (steps[:, whole > 0] / whole[whole > 0]).mean(axis=1).cumsum() if whole.any() else steps.sum(axis=1)
    return way


def _look_of_glances(camera: str, seen: Mapping[int, Glance], runs: Runs, paths: Mapping[int, Way]) -> Look:
    number, moves = runs.claims.stored.episodes.value.table.number, _robot_moves(runs)
    flat, blank, dark, still, hung, slow = np.zeros((6, len(moves)), dtype=bool)
    flicker, broken, leap, swing, focus, disorder = np.zeros((6, len(moves)), dtype=bool)
    share, again = dict[int, float](), dict[int, str]()
    for row, glance in seen.items():
        flat[row] = glance.spread.max() <= _ONE_COLOUR or np.median(glance.grain) >= _NO_SIGNAL
        nothing = _shows_nothing(glance)
        dark[row] = not flat[row] and nothing.any() and glance.level[nothing].max() <= _DARK
        blank[row] = not flat[row] and nothing.any() and not dark[row]
        flicker[row] = not flat[row] and _flickers(glance)
        if not (flat[row] or nothing.any() or flicker[row]):
            leap[row], focus[row] = _leap(glance) > 0, _sharpness_at_times(glance) <= _BLURRED
            broken[row] = not focus[row] and len(_breaks(glance)) >= _BREAKS
            swing[row] = len(glance.swing) >= _PAIRS and np.median(glance.swing) >= _SWINGS
        if moves[row] and row in paths and not flat[row]:
            path = paths[row]
            way = np.diff(np.interp(glance.frame, path.frames, path.way))
            share[row] = _longest(way, glance.peak <= _NOISE) / max(way.sum(), _TINY)
            still[row] = share[row] >= _MOSTLY
            elsewhere = (way * (glance.peak <= _NOISE)).sum() / max(way.sum(), _TINY) - share[row]
            hung[row] = elsewhere <= _NEVER and _A_WHILE <= share[row] < _MOSTLY
            of_way, repeats = _repeats(way, glance.peak)
            in_a_row = _repeats_in_a_row(glance)
            slow[row] = (repeats or in_a_row > 0) and not still[row]
            again[row] = f"{of_way:.0%} of the robot's way" if repeats else f"{in_a_row:.0%} of the steps or more"
            other = still[row] or slow[row] or flicker[row] or broken[row] or swing[row]
            disorder[row] = not other and _is_out_of_order(glance)
    copies = pictures_again(seen, {row: (path.frames, path.places) for row, path in paths.items()})
    neighbours = pictures_of_neighbours({row: glance for row, glance in seen.items() if not flat[row]})
    colour, square = np.mean([glance.colours for glance in seen.values()] or [np.full((2, 3), np.nan)], axis=0)
    return Look(
        camera=camera,
        place=_place(runs.claims, camera),
        number=number,
        again=Suspects(np.isin(np.arange(len(number)), list(copies)), lambda row: f"{_AGAIN} {number[copies[row]]}"),
        seam=Suspects(np.isin(np.arange(len(number)), list(neighbours)), lambda row: neighbours[row]),
        flat=Suspects(flat, lambda row: _nothing(seen[row])),
        blank=Suspects(blank, lambda row: _blanks(seen[row])),
        dark=Suspects(dark, lambda row: _blanks(seen[row])),
        still=Suspects(still, lambda row: f"the same picture for {share[row]:.0%} of the robot's way"),
        hung=Suspects(hung, lambda row: f"hardly a change of the picture for {share[row]:.0%} of the robot's way"),
        flicker=Suspects(flicker, lambda row: _said_of_flicker(seen[row])),
        broken=Suspects(broken, lambda row: _said_of_breaks(seen[row])),
        leap=Suspects(leap, lambda row: _said_of_leap(seen[row])),
        swing=Suspects(
            swing, lambda row: f"a brightness that goes up and down by {np.median(seen[row].swing):.0f} of 255"
        ),
        focus=Suspects(
            focus,
            lambda row: f"pictures of which some have {_sharpness_at_times(seen[row]):.0%} of the usual sharpness",
        ),
        disorder=Suspects(disorder, lambda row: _said_of_disorder(seen[row])),
        slow=Suspects(slow, lambda row: f"the picture of before again for {again[row]}"),
        mend="",
        bars=_bars([glance.view for glance in seen.values()]),
        colour=colour,
        deviation=np.sqrt(np.maximum(square - colour**2, 0)),
    )


def _rests(seen: Mapping[int, Glance], images: ImageSums | None, runs: Runs) -> dict[int, Ints]:
    """Say of each episode, by its row, from which frame on its pictures are the same for longest, and for how many."""
    if images is None:
        return {row: glance.rest for row, glance in seen.items() if glance.rest is not None}
    row = {number: row for row, number in enumerate(runs.claims.stored.episodes.value.table.number.tolist())}
    rests = zip(runs.number.tolist(), images.rest, strict=True)
    return {row[number]: rest for number, rest in rests if number in row}


def _with_hung(look: Look, rests: Mapping[int, Ints], runs: Runs, paths: Mapping[int, Way]) -> Look:
    """Find where pictures are the same for a while although the robot moves, unlike in nearly all other episodes."""
    length, moves = runs.claims.stored.episodes.value.table.length, _robot_moves(runs)
    way, n = np.zeros((2, len(length)))
    known = [*rests.keys() & paths.keys()]
    for row in known:
        path, (first, n[row]) = paths[row], rests[row]
        way[row] = np.ptp(np.interp([first, first + n[row]], path.frames, path.way)) / max(path.way[-1], _TINY)
    usual = float(np.quantile(way[known], 0.75)) if len(known) >= _MIN_EPISODES else np.inf
    wrong = moves & (way >= max(_HUNG, _FARTHER_THAN * usual))
    wrong &= (n >= max(_MIN_HUNG, runs.claims.schema.fps)) & (way >= _AS_FAST * n / np.maximum(length, 1))
    wrong &= ~(look.flat.wrong | look.still.wrong | look.slow.wrong)
    said = "the same picture in {:.0f} frames from frame {} on, for {:.0%} of the robot's way"
    hardly = look.hung  # as a few decoded pictures say: where wheels slip, noise goes on

    def found(row: int) -> str:
        return said.format(n[row], rests[row][0], way[row]) if wrong[row] else hardly.found(row)

    return look._replace(hung=Suspects(wrong | hardly.wrong, found))


def _bars(views: Sequence[NDArray[np.uint8]]) -> str:
    """Say where all views (12, 16, 3) of a camera are black, if on two sides and less than half: it was made to fit."""
    if len(views) < _MIN_EPISODES:
        return ""
    brightest = np.max(views, axis=(0, 3))  # (12, 16)
    for sides, lines in (("above and below", brightest.max(axis=1)), ("left and right", brightest.max(axis=0))):
        lit = np.flatnonzero(lines > _BLACK)
        if len(lit) > len(lines) / 2 and lit[0] > 0 and lit[-1] < len(lines) - 1:
            return f"black {sides}, {1 - len(lit) / len(lines):.0%} of the picture"
    return ""


def _right(look: Look, twins: Sequence[Twin]) -> Bools:
    """Tell in which episodes the pictures of a camera are such that they can be held against the robot."""
    right = ~(look.flat.wrong | look.blank.wrong | look.still.wrong | look.swing.wrong)
    for twin in twins:
        right &= ~(twin.same & (twin.look.camera == look.camera))
    for unlike_others in look.unlike:
        right[unlike_others.rows] = False
    return right


def _held_against_the_robot(look: Look, seen: Mapping[int, Glance], runs: Runs, paths: Mapping[int, Way]) -> Look:
    fps, moves = runs.claims.schema.fps, _robot_moves(runs)
    takes = {
        int(look.number[row]): take_of(glance, paths[row], fps)
        for row, glance in seen.items()
        if moves[row] and row in paths and np.isfinite(paths[row].places).all()
    }
    fits, astray, late = fit(takes)
    wrong = np.isin(look.number, list(astray))
    return look._replace(fits=fits, late=late, astray=Suspects(wrong, lambda row: astray[int(look.number[row])]))


def take_of(glance: Glance, path: Way, fps: float) -> Take:
    """Take one picture of a robot that rests, as long as it stays the same: else all of them outweigh the others."""
    way = np.interp(glance.frame, path.frames, path.way)
    changes = np.append(0, np.cumsum(glance.peak > _HARDLY * np.quantile(glance.peak, 0.9)))
    _, moved = np.unique(np.floor(_STEPS * len(way) * way + changes), return_index=True)
    return Take(glance.cells[moved], glance.frame[moved] / fps, path.places, path.frames / fps)


def _flickers(glance: Glance) -> bool:
    """Tell whether a picture is farther from the next than those are that lie far apart."""
    if len(glance.threes) < _PAIRS or np.median(np.diff(glance.frame)) < _APART:
        return False
    near, far = np.quantile(glance.near, 0.75), np.quantile(glance.far, 0.75)
    return bool(near >= max(_MUCH, _AS_FAR * far))


def _said_of_flicker(glance: Glance) -> str:
    near, far = np.quantile(glance.near, 0.75), np.quantile(glance.far, 0.75)
    apart = np.median(np.diff(glance.frame))
    return f"pictures that differ from the next by {near:.0f} of 255, and from those {apart:.0f} frames on by {far:.0f}"


def _leap(glance: Glance) -> int:
    """Return from which of the pictures on the picture is another one, after a leap; 0 where it is none."""
    leap = int(glance.change.argmax()) + 1
    before, after = (np.median(some, axis=0) for some in (glance.cells[:leap], glance.cells[leap:]))
    for_good = np.abs(before - after).mean() >= _FOR_GOOD * glance.change[leap - 1]
    inside = _FEW <= leap <= len(glance.frame) - _FEW
    alone = glance.change[leap - 1] >= max(_MUCH, _ALONE * np.quantile(glance.change, 0.9))
    return leap if inside and alone and for_good else 0


def _said_of_leap(glance: Glance) -> str:
    leap = _leap(glance)
    return f"another picture from frame {glance.frame[leap]:.0f} on, by {glance.change[leap - 1]:.0f} of 255 at once"


def _breaks(glance: Glance) -> Ints:
    """Return which pictures are farther from the one before than those are that lie half the episode apart."""
    return 1 + np.flatnonzero(glance.far >= max(_MUCH, _FARTHER * float(np.median(glance.across))))


def _said_of_breaks(glance: Glance) -> str:
    breaks = _breaks(glance)
    leaps = f"{len(breaks)} leaps of {np.median(glance.far[breaks - 1]):.0f} of 255 on average, first up to frame"
    return f"{leaps} {glance.frame[breaks[0]]:.0f}, where half an episode makes {np.median(glance.across):.0f}"


def _sharpness_at_times(glance: Glance) -> float:
    """Return how sharp pictures are at times, beside what they mostly are: 0.75 or more, while things come and go."""
    return float(np.quantile(glance.grain, 0.15) / max(float(np.median(glance.grain)), _TINY))


def _way_back(glance: Glance) -> float:
    """Say how far the next picture but one is, compared with the farther one of the two steps to it.

    From 1.3 to 2, the more the smoother it goes; less than 1 where pictures are out of order. Half of the places count,
    in which most moves; 2 where that is no more than noise.
    """
    farthest = glance.threes.max(axis=1)
    moving = glance.threes[farthest >= np.median(farthest)]  # (n, 3)
    farther = moving[:, :2].max(axis=1).mean()
    return float(moving[:, 2].mean() / farther) if farther >= _MORE_THAN_NOISE else 2.0


def _is_out_of_order(glance: Glance) -> bool:
    return len(glance.threes) >= _PAIRS and _way_back(glance) <= _BACK


def _said_of_disorder(glance: Glance) -> str:
    return f"pictures that are nearer to the next but one than to the next: {_way_back(glance):.2f} times as far"


def _repeats(way: Floats, peak: Floats) -> tuple[float, bool]:
    """Say for which share of the robot's way the picture hardly changes, and whether that comes and goes all the time.

    A robot that goes out of the picture comes back later; a camera that is slow shows each picture some times.
    """
    moving = way >= way.mean() / 2
    little = peak <= _HARDLY * np.quantile(peak[moving], 0.9)
    share = (way * little).sum() / max(way.sum(), _TINY)
    turns = np.diff(little)[moving[1:] & moving[:-1]]
    return float(share), bool(share >= _SLOW and len(turns) >= _TURNS and turns.mean() >= _FITFUL)


def _repeats_in_a_row(glance: Glance) -> float:
    """Return how many steps from one frame to the next change nothing, of those where one before or after does; else 0.

    Of a camera that is as fast as the frames, some do where the robot starts or stops; of one slower by a third,
    two of three.
    """
    steps = glance.threes[:, :2]
    larger = steps.max(axis=1)
    moving = larger >= max(_MORE_THAN_NOISE, float(np.median(larger)))
    if moving.sum() < _FEW:
        return 0.0
    repeats = steps[moving].min(axis=1) <= _NOTHING * larger[moving]
    return float(repeats.mean() / 2) if repeats.mean() >= _OFTEN else 0.0


def _longest(way: Floats, still: Bools) -> float:
    """Return how far the robot comes in the longest stretch in which the picture stays the same."""
    stretch = np.cumsum(np.diff(still, prepend=still[:1]))
    return float((np.bincount(stretch, way * still)).max())


def _nothing(glance: Glance) -> str:
    """Say what pictures show that show nothing."""
    is_flat = glance.spread.max() <= _ONE_COLOUR
    return f"one colour, {_shade(glance.level.mean())}" if is_flat else "noise, in which no pixel is like the next"


def _shows_nothing(glance: Glance) -> Bools:
    """Tell which pictures are of one colour, or noise."""
    nothing: Bools = (glance.spread <= _ONE_COLOUR) | (glance.grain >= _NO_SIGNAL)
    return nothing


def _blanks(glance: Glance) -> str:
    blank = _shows_nothing(glance)
    is_noise = (glance.spread[blank] > _ONE_COLOUR).any()
    said = "noise" if is_noise else f"one colour, {_shade(glance.level[blank].mean())},"
    some_of = f"{blank.sum()} of the {len(blank)} pictures that were looked at"
    return f"{said} in {some_of}, first in frame {glance.frame[blank.argmax()]:.0f},"


def _own_views(glances: Glances, looks: Mapping[str, Look], twins: Sequence[Twin]) -> dict[str, list[Unlike]]:
    """Hold the pictures of each camera against each other, but for those of which something worse is known."""
    wrong = {camera: look.flat.wrong.copy() for camera, look in looks.items()}
    for twin in twins:
        wrong[twin.look.camera] |= twin.same
    seen = glances.cameras.items()
    return unlike({name: {row: own for row, own in each.items() if not wrong[name][row]} for name, each in seen})


def _tasks(runs: Runs) -> dict[int, int]:
    """Return the task of each episode, by its row, as far as they are known; of several, one."""
    if runs.tasks is None:
        return {}
    task = dict(zip(runs.number[runs.tasks[:, 0]].tolist(), runs.tasks[:, 1].tolist(), strict=True))
    numbers = runs.claims.stored.episodes.value.table.number.tolist()
    return {row: task[number] for row, number in enumerate(numbers) if number in task}


def _misnamed(glances: Glances, tasks: Mapping[int, int], claims: Claims) -> list[Misnamed]:
    named = claims.stored.tasks.value
    texts = {} if named is None else dict(zip(named.number.tolist(), named.text, strict=True))
    hues = [{row: glance.hues for row, glance in seen.items()} for seen in glances.cameras.values()]
    return misnamed(hues, tasks, texts)


def _with_signs(look: Look, seen: Mapping[int, Glance], tasks: Mapping[int, int]) -> Look:
    """Look for signs, but in episodes of which more is known, as that explains them."""
    told = look.flat.wrong | look.blank.wrong | look.dark.wrong | look.still.wrong | look.hung.wrong | look.slow.wrong
    told[[row for each in look.unlike if each.says for row in each.rows.tolist()]] = True
    left = {row: glance for row, glance in seen.items() if not told[row]}
    signs = {row: glance.signs for row, glance in left.items()}
    return look._replace(
        parted=parted(signs, tasks), drift=drift({row: glance.still for row, glance in left.items()}, look.number)
    )


def _shade(level: float) -> str:
    return "black" if level <= _DARK else f"of a brightness of {level:.0f} of 255"


def _unseen(glances: Glances, n_episodes: int) -> Iterator[str]:
    for camera, seen in glances.cameras.items():
        if len(seen) < n_episodes:
            yield f"what {camera} shows in {n_episodes - len(seen):,} of {n_episodes:,} episodes: too little is decoded"


def _unfit(looks: Mapping[str, Look], n_episodes: int) -> Iterator[str]:
    names = [camera for camera, look in looks.items() if np.isnan(look.fits)]
    if n_episodes < _MIN_EPISODES:
        few, alike = f"fewer than {_MIN_EPISODES} episodes", "are alike, made in one way, hang for a while"
        yield f"whether the pictures of {some(names)} {alike}, and show where the robot is: there are {few}"
    elif names:
        yield f"whether the pictures of {some(names)} show where the robot is: too little of it is seen in them"


def _same_views(seen: Mapping[int, Glance], others: Mapping[int, Glance], runs: Runs) -> Bools:
    """Tell in which episodes two cameras show the same."""
    same = np.zeros(len(runs.claims.stored.episodes.value.table.number), dtype=bool)
    for row in seen.keys() & others.keys():
        apart = np.abs(seen[row].prints.astype(np.float32) - others[row].prints)
        same[row] = apart.mean() <= _SAME_VIEW and apart.max() <= _SAME_CELL
    return same


# --- guessed


def _look_of_sizes(footage: Footage, camera: str, moves: Bools) -> Look:
    table = footage.claims.stored.episodes.value.table
    key, other, pixels = np.full((3, len(table.number)), np.nan)
    alike = np.zeros(len(table.number), dtype=bool)
    for video, said in zip(footage.videos, footage.sums, strict=True):
        if video.camera == camera and isinstance(said, VideoSums):
            rows = video.rows
            key[rows], other[rows], alike[rows] = said.pictures.key, said.pictures.other, said.pictures.alike
            pixels[rows] = said.height * said.width
    long, usual = table.length >= _LONG, _median(other)
    return Look(
        camera=camera,
        place=_place(footage.claims, camera),
        number=table.number,
        flat=Suspects(
            long & (key <= _FLAT + pixels / _PIXELS_TO_A_FLAT_BYTE),
            lambda row: f"{key[row]:.0f} bytes a picture, no more than one colour takes",
        ),
        still=Suspects(
            moves & _seem_still(long, other, alike, size_of_the_same(pixels)),
            lambda row: f"{other[row]:.0f} bytes for a change of the picture, where {usual:.0f} are usual",
        ),
        mend=_DECODE,
    )


def _look_of_images(camera: str, runs: Runs, sums: ImageSums, moves: Bools) -> Look:
    same = sums.n_changes == 0
    return Look(
        camera=camera,
        place=DATA_DIR,
        number=runs.claims.stored.episodes.value.table.number,
        flat=Suspects(
            _episodes(runs, same & sums.tiny),
            lambda _: "the same picture in all frames, no larger than one colour takes",
        ),
        still=Suspects(_episodes(runs, same) & moves, lambda _: "the same picture in all frames"),
        mend="",
    )


def _episodes(runs: Runs, wrong: Bools) -> Bools:
    """Tell of each episode of the metadata whether it is one of these runs, and a long one."""
    long = runs.stop - runs.start >= _LONG
    return np.isin(runs.claims.stored.episodes.value.table.number, runs.number[wrong & long])


def _seem_still(long: Bools, change: Floats, alike: Bools, little: Floats) -> Bools:
    """Tell in which episodes a change takes next to nothing, or always the same: in a few of them, or in nearly all."""
    less = change <= np.minimum(little, _LITTLE * _median(change))
    seldom, always = long & (less | alike), long & alike & ~(change > little)
    if long.sum() >= _MIN_EPISODES and _is_seldom(seldom, long.sum()):
        return seldom
    return always if _is_seldom(long & ~always, long.sum()) else np.zeros_like(long)


def _is_seldom(wrong: Bools, n: int) -> bool:
    return bool(wrong.sum() <= max(1, _SELDOM * n))


def _median(values: Floats) -> float:
    return float(np.median(values[~np.isnan(values)])) if not np.isnan(values).all() else np.nan
