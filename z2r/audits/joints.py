"""Does every joint follow its command, in each episode as in the others? Nothing is declared: fellows are compared.

What is usual is taken from the episodes themselves, so what is the same in all of them is only wrong where no robot can
do it, or where one joint differs from all other joints.
"""

import warnings
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import combinations
from typing import Any, NamedTuple

import numpy as np

from z2r.arrays import Bools, Floats, Ints, products
from z2r.audits.following import MIN_FRAMES, Following, Pair
from z2r.audits.motion import LEAP, NOISE_A_FRAME
from z2r.audits.runs import Runs
from z2r.audits.values import JUMP
from z2r.check import Answer, Check
from z2r.errors import Fault, count, some
from z2r.format.episodes import DATA_DIR
from z2r.format.schema import ACTION, STATE
from z2r.reading.action import unit_of
from z2r.reading.joints import is_gripper
from z2r.reading.stored import episodes_named

_LITTLE = 0.05  # of a command's range: a shorter way tells nothing
_SOME = 0.34  # of the runs: a fault may be in half of them
WELL = 0.9  # share of a command's variance: a column that explains more follows well
_FRAMES = 4  # between two lags, at least: teleoperation jitters by one or two
_APART = 6  # frames between one joint and the others: some joints are slower
_SCALE = 1.6  # times: what holds a joint back makes a factor look so much larger at most
_MANY = 0.6  # of the other episodes: then nobody knows which are usual
_MOVES = 0.3  # of what is usual: less motion tells nothing
_VERY_WELL = 0.985  # explained: then a factor is known to a few percent
_SCALE_WELL = 1.2  # times
_GEARED = 1.18  # times the scale of the other joints
_FAR = 5  # times: no contact makes a factor look so much larger
_BESIDE_FOR_A_WHILE = 5  # times as far as in the others, for how far the command goes, in the worst second
_ALWAYS_BESIDE = 0.1  # of a joint's range
_DRIFTING, _STEADILY = 8, 0.8  # episodes at least, and of the variance of how far it is beside
_DEAD = 0.02  # of its command
_COPIED = 0.1  # of the frames in which a command changes
_STRAY = 8  # times as far beside its command as the others stray
_BESIDE = 0.06  # of a joint's range
_FAR_BESIDE = 0.09  # of a joint's range
_CROSSWISE, _OWN = 0.8, 0.5  # explained by the other's column, at least, and by its own, at most
_SAME_UNIT = 4  # times, between the ranges of a command and of what it does not even drive
# Times the largest step of a command, and of those before and after: measured, 2.3 where nothing is wrong.
_FARTHER = 2.5
_SPIKE, _NOISIER = 0.03, 8  # of a joint's range, and times its noise: measured, 4 where nothing is wrong
_COMMANDS = 4  # times the largest step of a joint: measured, 3.2 where nothing is wrong


@dataclass(frozen=True, eq=False)
class Joints:
    """How all columns follow their commands in all runs of frames, and what is usual.

    Attributes
    ----------
    pairs : tuple of Pair
        Dimensions of the action, and the columns of their names.
    number : ndarray, int64[n_runs]
        The `episode_index` of each run of frames.
    runs : Following
        A row for each run, a column for each pair.
    ranges : ndarray, float64[n_pairs]
        From the smallest to the largest command of all runs.
    moved : Runs
        How every feature moves in the same runs.
    """

    pairs: tuple[Pair, ...]
    number: Ints
    runs: Following
    ranges: Floats
    moved: Runs

    @cached_property
    def steps(self) -> "Steps":
        """How far commands and columns go from one frame to the next."""
        moved = self.moved
        seen = [(pair.feature, pair.column) for pair in self.pairs]
        asked = [(ACTION, pair.dim) for pair in self.pairs]
        spans = np.array([moved.spans(name)[column] for name, column in seen])
        alike = (spans < _SAME_UNIT * self.ranges) & (self.ranges < _SAME_UNIT * spans)
        factor = np.where(self.followed & (self.usual["kind"] == 0), np.abs(self.usual["factor"]), np.nan)
        factor[~self.followed & alike] = 1  # where the column does not follow, it has at least about the same range

        def of(places: Sequence[tuple[str, int]], parts: Mapping[str, Any], what: str) -> Floats:
            unknown = np.full(len(self.number), np.nan)
            return np.stack(
                [getattr(parts[name], what)[:, column] if name in parts else unknown for name, column in places], axis=1
            )

        return Steps(
            asked=of(asked, moved.stats, "step"),
            asked_spike=of(asked, moved.stats, "spike"),
            seen=factor * of(seen, moved.stats, "step"),
            seen_spike=factor * of(seen, moved.stats, "spike"),
            around=factor * of(seen, moved.steps, "around"),
            noise=factor * of(seen, moved.steps, "noise") / (NOISE_A_FRAME * moved.n_frames[:, None]),
            at=of(seen, moved.steps, "at"),
        )

    @cached_property
    def grips(self) -> Bools:
        """Which columns are called a gripper, bool[n_pairs]."""
        return np.array([is_gripper(pair.name) for pair in self.pairs], dtype=bool)

    @cached_property
    def judged(self) -> Bools:
        """Where a command goes far enough to tell whether it is followed, bool[n_runs, n_pairs]."""
        asked = self.runs.asked
        judged: Bools = (
            (asked > 0) & (asked >= _MOVES * _median(asked, asked > 0)) & (self.runs.n >= MIN_FRAMES)[:, None]
        )
        return judged

    @cached_property
    def follows(self) -> Bools:
        """Where a column follows its command, bool[n_runs, n_pairs]."""
        long = (self.runs.n >= MIN_FRAMES)[:, None] & (self.runs.asked > 0)
        follows: Bools = (
            ~self.exchanged & np.isfinite(self.runs.lag) & (self.judged | (long & (self.runs.explained > _VERY_WELL)))
        )
        return follows

    @cached_property
    def exchanged(self) -> Bools:
        """Where the column of another pair follows a command, and its own does not, bool[n_runs, n_pairs]."""
        runs, own = self.runs, np.arange(len(self.pairs))
        better = self.judged & (runs.other_explained > WELL) & (runs.explained < 1 - 2 * (1 - runs.other_explained))
        wrong = better & (runs.other != own) & np.isfinite(runs.other)
        # By chance, joints move alike in some episode: where they are exchanged, the other command goes astray as well.
        back = np.take_along_axis(wrong, np.nan_to_num(runs.other).astype(np.int64), axis=1)
        exchanged: Bools = wrong & (back | (runs.explained < _MOVES))
        return exchanged

    @cached_property
    def followed(self) -> Bools:
        """Which commands are followed in many runs, bool[n_pairs]."""
        followed: Bools = self.follows.sum(axis=0) > _SOME * np.maximum(self.judged.sum(axis=0), 1)
        return followed

    @cached_property
    def usual(self) -> dict[str, Floats]:
        """What is usual where a column follows, each float64[n_pairs]; NaN where it does not."""
        names = ("kind", "lag", "least", "most", "explained", "factor")
        return {name: _median(getattr(self.runs, name), self.follows) for name in names}


class Steps(NamedTuple):
    """The largest steps of commands and of their columns, in the command's unit: [n_runs, n_pairs]; NaN where unknown.

    A spike is a step that the next one takes back; `around` are the steps before and after the largest one of a column,
    `noise` is its standard deviation, and `at` is the frame of the run to which the largest step leads.
    """

    asked: Floats
    asked_spike: Floats
    seen: Floats
    seen_spike: Floats
    around: Floats
    noise: Floats
    at: Floats


LATE = Check("late", "what a command brings about comes after it, and as many frames later in every episode", "warning")


@LATE.of(Joints)
def commands_come_first(joints: Joints) -> Iterator[Answer]:
    """Is a joint where it was told to be before it was told so? No robot can do that."""
    usual = joints.usual
    first = np.where(usual["kind"] > 0, 0, -1)  # a change that ends with the frame of its command began before it
    early = joints.followed & (usual["most"] <= first) & (usual["explained"] > WELL)
    if early.sum() > 0.5 * joints.followed.sum():
        pair = int(np.where(early, usual["explained"], 0).argmax())
        found = f"what {joints.pairs[pair].name} does {_frames(usual['lag'][pair])}"
        mend = "A joint cannot move before it is told to: shift the actions to where they were sent"
        yield Fault(DATA_DIR, ACTION, f"{found}{_of_joints(early)}", "what it does after the command", mend)


@LATE.of(Joints)
def no_episode_is_late(joints: Joints) -> Iterator[Answer]:
    """Does a joint follow earlier or later than in the other episodes?"""
    runs, usual = joints.runs, joints.usual
    apart = (runs.most < usual["least"]) | (runs.least > usual["most"])
    off = joints.follows & joints.followed & (runs.kind == usual["kind"]) & (runs.explained > WELL) & apart
    wrong = off & (np.abs(runs.lag - usual["lag"]) >= _FRAMES)

    def said(run: int, pair: int) -> tuple[str, str, str]:
        by = int(usual["lag"][pair] - runs.lag[run, pair])
        found = f"what {joints.pairs[pair].name} does {_frames(runs.lag[run, pair])}"
        mend = f"Were these actions recorded {count(abs(by), 'frame')} {'late' if by > 0 else 'early'}?"
        return found, f"what it does {_frames(usual['lag'][pair])}, as in the other episodes", mend

    yield from _told(joints, wrong, said)


@LATE.of(Joints)
def no_joint_is_late(joints: Joints) -> Iterator[Answer]:
    """Does one joint follow much earlier or later than the others?"""
    usual = joints.usual
    known = joints.followed & (usual["explained"] > WELL)
    if known.sum() < 3:
        return
    lag = float(np.median(usual["lag"][known]))
    far = np.where(usual["lag"] > lag, usual["least"] - lag, lag - usual["most"])
    wrong = known & (far >= max(_APART, abs(lag)))
    for pair in np.flatnonzero(wrong).tolist():
        found = f"what {joints.pairs[pair].name} does {_frames(usual['lag'][pair])}"
        expected = f"about {lag:.0f}, as of the other {known.sum() - 1} joints"
        yield Fault(
            DATA_DIR, joints.pairs[pair].command, found, expected, "Is it slower than they, or is its clock another?"
        )


@LATE.of(Joints)
def no_joint_alone_comes_first(joints: Joints) -> Iterator[Answer]:
    """Does a joint go before it is told to, again and again, where others go after it? A grip may hide how well."""
    runs, usual = joints.runs, joints.usual
    after = (joints.follows & (runs.least > 0) & (runs.explained > WELL)).sum(axis=1) > 1
    wrong = joints.follows & (runs.kind == 0) & (runs.lag <= -_FRAMES) & (runs.most < 0)
    wrong &= after[:, None] & (runs.explained <= WELL)  # of what follows better, the others tell
    wrong &= wrong.sum(axis=0) > 1
    others = float(np.nanmedian(np.where(usual["explained"] > WELL, usual["lag"], np.nan))) if wrong.any() else 0.0

    def said(run: int, pair: int) -> tuple[str, str, str]:
        found = f"what {joints.pairs[pair].name} does {_frames(runs.lag[run, pair])}"
        mend = "A joint cannot move before it is told to: was its command recorded late, or by another clock?"
        return found, f"what it does about {others:.0f} frames after it, as of the other joints", mend

    yield from _told(joints, wrong, said)


UNIT = Check("unit", "a joint is measured in the unit, with the sign and from the zero of its command", "warning")


@UNIT.of(Joints)
def joints_have_the_unit_of_their_command(joints: Joints) -> Iterator[Answer]:
    """Is one joint measured in another unit than its command, or with another sign, while the others are not?"""
    usual = joints.usual
    known = joints.followed & (usual["kind"] == 0)
    plain = known & _near(usual["factor"], 1.0, _SCALE)
    mend = "Which of the two is right? Convert the other one in all episodes"
    if known.sum() > 1 and not plain.any():  # all alike is a convention
        pair = int(np.where(known, usual["explained"], -1).argmax())
        found = f"{_factor(usual['factor'][pair])} for 1 of {joints.pairs[pair].name}{_of_joints(known)}"
        yield (
            "note",
            Fault(DATA_DIR, ACTION, found, "the same unit of both", "A policy need not care, whoever reads it must"),
        )
        return
    middle = float(np.median(usual["factor"][plain])) if plain.any() else 1.0
    geared = plain & (usual["explained"] > _VERY_WELL) & ~_near(usual["factor"], middle, _GEARED)
    for pair in np.flatnonzero(known & (geared | ~plain)).tolist():
        factor, others = usual["factor"][pair], int(plain.sum() - plain[pair])
        expected = f"about 1, as of {others} other joints" if others else "1: the same unit of both"
        fault = Fault(
            DATA_DIR,
            joints.pairs[pair].command,
            f"{_factor(factor)} for 1 of {joints.pairs[pair].name}",
            expected,
            mend,
        )
        is_fault = not plain[pair] and others and unit_of(factor) and (factor > 0 or factor > -_SCALE)
        far = factor < 0 or not _near(factor, 1.0, _FAR)  # what no grip explains
        if is_fault or far or (usual["explained"][pair] > _VERY_WELL and not joints.grips[pair]):
            yield fault if is_fault else ("note", fault)


@UNIT.of(Joints)
def joints_keep_their_unit(joints: Joints) -> Iterator[Answer]:
    """Is a joint measured in another unit, or with another sign or scale, in some episodes?"""
    runs, usual = joints.runs, joints.usual
    known = joints.follows & joints.followed & (runs.kind == usual["kind"])
    with np.errstate(divide="ignore", invalid="ignore"):
        apart = np.abs(np.log(np.abs(runs.factor / usual["factor"])))  # 0 where it is the same
    turned = runs.factor * usual["factor"] < 0
    far = (apart > np.log(_SCALE)) | turned
    stray = _median(apart, known & ~far)
    well = runs.explained > _VERY_WELL
    # A gripper is held back by what it grips, in one episode more than in another: only a far factor says something.
    free = (usual["explained"] > _VERY_WELL) & ~joints.grips
    wrong = known & far & (((free | turned) & (runs.explained > WELL)) | (apart > np.log(_FAR)))
    wrong |= known & well & free & (runs.kind == 0) & (apart > np.log(_SCALE_WELL)) & (apart > _STRAY * stray)

    def said(run: int, pair: int) -> tuple[str, str, str]:
        found = f"{_factor(runs.factor[run, pair])} for 1 of {joints.pairs[pair].name}"
        mend = "Was a calibration, a gear or a unit changed between recordings? Convert one kind to the other"
        return found, f"{_factor(usual['factor'][pair])}, as in the other episodes", mend

    yield from _told(joints, wrong, said)


@UNIT.of(Joints)
def commands_stay_of_one_kind(joints: Joints) -> Iterator[Answer]:
    """Does a command say where to be in some episodes, and how far to go in others?"""
    runs, usual = joints.runs, joints.usual
    wrong = joints.follows & joints.followed & (runs.kind != usual["kind"]) & (runs.explained > WELL)
    kinds = ("a place to be in", "a change to make")

    def said(run: int, pair: int) -> tuple[str, str, str]:
        expected = f"{kinds[int(usual['kind'][pair])]}, as in the other episodes"
        return kinds[int(runs.kind[run, pair])], expected, "Convert one kind to the other, or leave these out"

    yield from _told(joints, wrong, said)


@UNIT.of(Joints)
def joints_keep_their_zero(joints: Joints) -> Iterator[Answer]:
    """Does a joint stay beside its command in some episodes, by much more than in the others?"""
    known, beside = _beside(joints)
    middle = _median(beside, known)
    stray = _median(np.abs(beside - middle), known)
    off = np.abs(beside - middle)
    wrong = known & ~joints.grips & (off > _STRAY * stray) & (off > _BESIDE * joints.ranges)
    wrong &= (known.sum(axis=0) >= 3) & (wrong.sum(axis=0) < 0.6 * known.sum(axis=0))

    def said(run: int, pair: int) -> tuple[str, str, str]:
        found = f"{beside[run, pair]:.3g} beside {joints.pairs[pair].name}, on average"
        mend = "Was the robot or its leader calibrated anew in between? Then one pose has two numbers"
        return found, f"about {middle[pair]:.3g}, as in the other episodes", mend

    yield from _told(joints, wrong, said)


@UNIT.of(Joints)
def no_joint_is_beside_its_command(joints: Joints) -> Iterator[Answer]:
    """Is a joint beside its command everywhere, by much more than the other joints? That is harmless if it stays so."""
    usual, (known, each) = joints.usual, _beside(joints)
    beside, span = _median(each, known), _median(joints.runs.asked, joints.judged)
    share = np.nan_to_num(np.abs(beside) / np.where(span > 0, span, np.inf))
    well = (
        known.any(axis=0)
        & (usual["explained"] > _VERY_WELL)
        & _near(usual["factor"], 1.0, _SCALE)
        & (span > _LITTLE * np.nanmax(span, initial=0))
    )
    for pair in np.flatnonzero(well & (share > _ALWAYS_BESIDE)).tolist():
        found = f"{beside[pair]:.3g} beside {joints.pairs[pair].name} in nearly all episodes"
        expected = f"nearly the same number: it goes through {span[pair]:.3g}"
        mend = "Harmless as long as it stays so; are leader and follower calibrated alike?"
        yield "note", Fault(DATA_DIR, joints.pairs[pair].command, found, expected, mend)


@UNIT.of(Joints)
def no_joint_drifts_from_its_command(joints: Joints) -> Iterator[Answer]:
    """Is a joint more and more beside its command, from episode to episode?"""
    (known, each), span = _beside(joints), _median(joints.runs.asked, joints.judged)
    for pair in np.flatnonzero(known.sum(axis=0) >= _DRIFTING).tolist():
        beside = each[known[:, pair], pair]
        order = np.arange(len(beside))
        drift, _ = np.polyfit(order, beside, 1) * (len(beside) - 1)
        steady = np.ptp(beside) == 0 or np.corrcoef(order, beside)[0, 1] ** 2 < _STEADILY
        if steady or abs(drift) < _ALWAYS_BESIDE * span[pair]:
            continue
        found = f"{beside[0]:.3g} beside {joints.pairs[pair].name} in the first episode, {beside[-1]:.3g} in the last"
        mend = "Does a horn or a belt slip, or does something give way? Calibrate it anew"
        yield "note", Fault(DATA_DIR, joints.pairs[pair].command, found, "the same in all episodes", mend)


ORDER = Check("joint-order", "a command drives the joint of its own name", "warning")


@ORDER.of(Joints)
def commands_drive_their_own_joint(joints: Joints) -> Iterator[Answer]:
    """Does another joint follow a command than that of its name?"""
    runs = joints.runs

    def said(run: int, pair: int) -> tuple[str, str, str]:
        other = int(runs.other[run, pair])
        found = f"what {joints.pairs[other].name} does ({runs.other_explained[run, pair]:.1%} explained)"
        expected = f"what {joints.pairs[pair].name} does ({runs.explained[run, pair]:.1%})"
        return found, expected, "Are two joints, or two arms, exchanged in the state or in the action?"

    yield from _told(joints, joints.exchanged, said)


@ORDER.of(Joints)
def no_two_commands_are_always_exchanged(joints: Joints) -> Iterator[Answer]:
    """Do two columns follow each other's commands in all episodes together, as grippers do that hold something?"""
    explained, signs = _explained_at_moments(joints)
    own = np.diag(explained)
    follows = own * (np.diag(signs) > 0)  # of two that go against each other, each seems to go against its command
    for one, other in combinations(range(len(own)), 2):
        both = [one, other]
        crosswise = min(explained[one, other], explained[other, one])
        if crosswise < max(_CROSSWISE, own[both].max()) or follows[both].max() > _OWN:
            continue
        if joints.exchanged[:, both].any():
            continue
        found = f"what {joints.pairs[other].name} does ({explained[one, other]:.0%} explained), and the reverse"
        expected = f"what {joints.pairs[one].name} does ({follows[one]:.0%})"
        mend = "Are the two exchanged in the state or in the action, in all episodes?"
        yield Fault(DATA_DIR, joints.pairs[one].command, found, expected, mend)


def _explained_at_moments(joints: Joints) -> tuple[Floats, Floats]:
    """Return how much of each command each column explains at some moments of all runs, and which way: both (n, n)."""
    at = {name: joints.moved.moments_of(name)[:, :, 0] for name in (ACTION, *(pair.feature for pair in joints.pairs))}
    asked = [at[ACTION][:, :, pair.dim].T.ravel() for pair in joints.pairs]
    both = np.stack([*asked, *(at[pair.feature][:, :, pair.column].T.ravel() for pair in joints.pairs)])
    both = both[:, np.isfinite(both).all(axis=0)].astype(np.float64)
    if not both.size:
        return np.zeros((len(asked), len(asked))), np.zeros((len(asked), len(asked)))
    both -= both.mean(axis=1, keepdims=True)
    sizes = np.square(both).sum(axis=1)
    together = products(both[: len(asked)].T, both[len(asked) :].T)
    whole = np.outer(sizes[: len(asked)], sizes[len(asked) :])
    share = np.divide(np.square(together), whole, out=np.zeros_like(together), where=together != 0)
    return share, np.sign(together)


@UNIT.of(Joints)
def both_turn_alike(joints: Joints) -> Iterator[Answer]:
    """Does a joint go on at the other end of a whole turn, where its command goes on beyond it, or the reverse?"""
    runs = joints.runs
    names = [(pair.name, pair.command) for pair in joints.pairs]
    for first, (turns, others) in enumerate(
        ((runs.turns_seen, runs.turns_asked), (runs.turns_asked, runs.turns_seen)),
    ):
        wrong = (turns > 0) & (others.sum(axis=0) == 0) & joints.judged
        for pair in np.flatnonzero(wrong.any(axis=0)).tolist():
            turning, steady = names[pair][first], names[pair][1 - first]
            mend = "Unwind the angle, or wrap both alike: else a policy sees two places that are one"
            expected = f"the same of {steady}, which goes on"
            yield in_episodes(turning, joints.number[wrong[:, pair]], "a whole turn in one step", expected, mend)


FOLLOW = Check("follow", "a joint follows its command in every episode, if it does in most", "warning")


@FOLLOW.of(Joints)
def joints_follow_in_every_episode(joints: Joints) -> Iterator[Answer]:
    """Does a joint go its own way in some episodes? The action is of another episode then, or the sensor is broken."""
    runs, usual = joints.runs, joints.usual
    steady = joints.followed & (usual["explained"] > WELL) & (usual["kind"] == 0)
    wrong = joints.judged & steady & (runs.explained < np.minimum(0.5, 1 - 5 * (1 - usual["explained"])))
    wrong &= ~((runs.other_explained > WELL) & (runs.other != np.arange(len(joints.pairs))))

    def said(run: int, pair: int) -> tuple[str, str, str]:
        found = f"{runs.explained[run, pair]:.0%} of it explained by {joints.pairs[pair].name}"
        mend = "Are these the actions of another episode, or is a sensor or a motor broken?"
        return found, f"{usual['explained'][pair]:.1%}, as in the other episodes", mend

    yield from _told(joints, wrong, said)


@FOLLOW.of(Joints)
def joints_follow_all_the_time(joints: Joints) -> Iterator[Answer]:
    """Is a joint far beside its command for a while, as in no other episode?"""
    runs, usual = joints.runs, joints.usual
    known = joints.judged & joints.followed & np.isfinite(runs.beside) & (usual["explained"] > _VERY_WELL)
    with np.errstate(divide="ignore", invalid="ignore"):
        share = runs.beside / runs.asked  # who goes far at once is far behind for a while
    calm = _median(share, known)
    wrong = known & (share > _BESIDE_FOR_A_WHILE * calm) & (runs.beside > _FAR_BESIDE * joints.ranges)
    wrong &= (known.sum(axis=0) >= max(3, 0.5 * len(known))) & (wrong.sum(axis=0) < 0.6 * known.sum(axis=0))

    def said(run: int, pair: int) -> tuple[str, str, str]:
        where = f"{joints.pairs[pair].name} from frame {runs.beside_at[run, pair]:.0f} on"
        found = f"{runs.beside[run, pair]:.3g} beside {where}, for about a second"
        mend = "Did something hold it, did it slip, or does its sensor or its command hang there?"
        return found, f"about {calm[pair] * runs.asked[run, pair]:.3g} at most, as in the other episodes", mend

    yield from _told(joints, wrong, said)


@FOLLOW.of(Joints)
def no_joint_is_dead(joints: Joints) -> Iterator[Answer]:
    """Does a joint hardly move in any episode, whatever it is told, while others do as they are told?"""
    runs = joints.runs
    dead = joints.judged.any(axis=0) & ~joints.followed & (runs.moved < _DEAD * runs.asked).all(axis=0)
    for pair in np.flatnonzero(dead).tolist() if joints.followed.any() else ():
        found = f"a command that goes through {runs.asked[:, pair].max():.3g}"
        expected = f"one that {joints.pairs[pair].name} follows: it moves by {runs.moved[:, pair].max():.3g} at most"
        mend = "Is its motor off, or its sensor broken? Nothing can be learned of it"
        yield Fault(DATA_DIR, joints.pairs[pair].command, found, expected, mend)


COMMAND = Check("command", "where a robot moves, its command is recorded", "warning")
ECHO = Check("echo", "a state is measured, and is no copy of a command", "note")


@COMMAND.of(Joints)
def commands_are_recorded(joints: Joints) -> Iterator[Answer]:
    """Does a command stand still while its joint moves as far as it does elsewhere, or as other joints do?"""
    runs = joints.runs
    usual = _median(runs.moved, joints.judged)
    usual = np.where(np.isfinite(usual), usual, np.nanmedian(usual) if np.isfinite(usual).any() else runs.moved.max())
    wrong = (runs.asked == 0) & (runs.moved > _MOVES * usual) & (runs.n >= MIN_FRAMES)[:, None]

    def said(run: int, pair: int) -> tuple[str, str, str]:
        found = f"the same number in all {runs.n[run]:.0f} frames"
        expected = f"a command, since {joints.pairs[pair].name} moves by {runs.moved[run, pair]:.3g}"
        return found, expected, "Nothing can be learned from it: leave these episodes out, or record them again"

    yield from _told(joints, wrong, said)


@COMMAND.of(Joints)
def commands_are_no_copies(joints: Joints) -> Iterator[Answer]:
    """Is the action nothing but the state, in all episodes or in some, or for a while?"""
    runs, moves = joints.runs, joints.judged.any(axis=1)
    for what, copies in (("in the same frame", runs.copied), ("in the next frame", runs.foretold)):
        least = np.where(joints.judged, copies, np.inf)[moves].min(axis=1, initial=np.inf)  # of all joints that move
        usual = float(np.quantile(least, 0.5, method="lower")) if moves.any() else np.nan
        if usual > 1 - _COPIED and copies is runs.copied:
            mend = "A policy learns to stay where it is: the command was not recorded"
            yield Fault(DATA_DIR, ACTION, f"{STATE} {what}, bit for bit", "a command, which comes before it", mend)
        wrong = (least > _COPIED) & (usual < _COPIED / 3)
        if wrong.any():
            numbers = joints.number[moves][wrong]
            found = f"{STATE} {what}, bit for bit, in {least[wrong].max():.0%} of the frames in which it changes"
            mend = "Was the robot led by hand there, or was no command recorded?"
            yield in_episodes(ACTION, numbers, found, "a command, as in the other episodes", mend)
    yield from _partly_copied(joints)


@ECHO.of(Joints)
def states_are_no_echo(joints: Joints) -> Iterator[Answer]:
    """Is the state of all joints, in most episodes, what they were told in the frame before?"""
    moves = joints.judged.any(axis=1)
    least = np.where(joints.judged, joints.runs.foretold, np.inf)[moves].min(axis=1, initial=np.inf)
    usual = float(np.quantile(least, 0.5, method="lower")) if moves.any() else 0.0
    if usual > 1 - _COPIED:
        found = f"the action of the frame before, bit for bit, in {usual:.0%} of the frames in which that changes"
        mend = "Is the action made of the next state, as many do? Else the state is an echo of the command, which "
        mend += "nobody measured: it says nothing of a load, a grip or a lag"
        yield Fault(DATA_DIR, STATE, found, "a measurement, which differs from what it was told", mend)


def _partly_copied(joints: Joints) -> Iterator[Fault]:
    """Find joints whose command is their state, bit for bit, while those of others are not."""
    copied, judged = np.where(joints.judged, joints.runs.copied, 0.0), joints.judged
    copies = judged & (copied > 1 - _COPIED)
    partly = copies.any(axis=1) & (judged & (copied < _COPIED / 3)).any(axis=1)
    if partly.any():
        run = int(partly.argmax())
        names = [pair.command for pair, is_one in zip(joints.pairs, copies[run].tolist(), strict=True) if is_one]
        found = f"the state of the same frame in {some(names)}, bit for bit"
        mend = "Was no command recorded there? A policy learns to stay where it is"
        yield in_episodes(ACTION, joints.number[partly], found, "commands, as of the other joints", mend)


@LEAP.of(Joints)
def no_joint_leaps_farther_than_it_is_told(joints: Joints) -> Iterator[Answer]:
    """Does a joint leap, all at once, far beyond the largest step of its command? A grip may let go like this."""
    steps = joints.steps
    wrong = joints.judged & ~joints.grips & (steps.seen > _FARTHER * steps.asked)
    wrong &= (steps.seen > _FARTHER * steps.around) & (steps.seen > _LITTLE * joints.ranges)
    wrong &= steps.seen_spike < steps.seen / 2
    for pair in np.flatnonzero(wrong.any(axis=0)).tolist():
        run = int(np.where(wrong[:, pair], steps.seen[:, pair], 0).argmax())
        found = (
            f"a leap of {steps.seen[run, pair]:.3g} in frame {steps.at[run, pair]:.0f} of episode {joints.number[run]}"
        )
        expected = f"steps like those of its command, of {steps.asked[run, pair]:.3g} at most"
        mend = "Did a horn or a belt slip, was a reading lost, or did something give way? Look at it"
        yield "note", in_episodes(joints.pairs[pair].name, joints.number[wrong[:, pair]], found, expected, mend)


@JUMP.of(Joints)
def no_single_reading_is_off(joints: Joints) -> Iterator[Answer]:
    """Is a reading or a command again and again far off for one frame, farther than the other of the two ever steps?"""
    steps, judged = joints.steps, joints.judged & ~joints.grips
    seen = judged & (steps.seen_spike > steps.asked) & (steps.seen_spike > _SPIKE * joints.ranges)
    seen &= steps.seen_spike > _NOISIER * steps.noise
    asked = judged & (steps.asked_spike > _COMMANDS * steps.seen) & (steps.asked_spike > _SPIKE * joints.ranges)
    for pair in np.flatnonzero(seen.sum(axis=0) > 0.5 * judged.sum(axis=0)).tolist():
        yield _off_for_a_frame(joints, pair, joints.pairs[pair].name, seen, steps.seen_spike, steps.asked)
    for pair in np.flatnonzero(asked.any(axis=0)).tolist():
        fault = _off_for_a_frame(joints, pair, joints.pairs[pair].command, asked, steps.asked_spike, steps.seen)
        yield "note", fault  # a policy may well say what no robot can do


def _off_for_a_frame(joints: Joints, pair: int, name: str, wrong: Bools, spike: Floats, other: Floats) -> Fault:
    run = int(np.where(wrong[:, pair], spike[:, pair], 0).argmax())
    found = (
        f"a leap of {spike[run, pair]:.3g} away and back, in episode {joints.number[run]} from one frame to the next"
    )
    both = joints.pairs[pair].name, joints.pairs[pair].command
    expected = f"steps like those of {both[name == both[0]]}, of {other[run, pair]:.3g} at most"
    mend = "Was a sample read or sent wrong? Smooth it, or leave these episodes out"
    return in_episodes(name, joints.number[wrong[:, pair]], found, expected, mend)


def _beside(joints: Joints) -> tuple[Bools, Floats]:
    """Say where it is known how far a command is beside its column, on average, and how far it is."""
    runs, usual = joints.runs, joints.usual
    known: Bools = joints.follows & joints.followed & (runs.explained > WELL)
    known = known & (runs.kind == 0) & (usual["kind"] == 0)
    return known, runs.mean_asked - usual["factor"] * runs.mean_seen


def _told(joints: Joints, wrong: Bools, said: Callable[[int, int], tuple[str, str, str]]) -> Iterator[Answer]:
    """Name what is wrong: the whole action in the runs in which most joints are, else each joint by itself."""
    n_judged = np.maximum((joints.judged | wrong).sum(axis=1), 2)
    together = wrong.sum(axis=1) > 0.5 * n_judged
    if together.any():
        run = int(together.argmax())
        pair = int(np.where(wrong[run], joints.runs.explained[run], -1).argmax())
        found, expected, mend = said(run, pair)
        mend += if_many(together, np.atleast_1d(joints.judged.any(axis=1)))
        yield in_episodes(ACTION, joints.number[together], f"{found}{_of_joints(wrong[run])}", expected, mend)
    alone = wrong & ~together[:, None]
    for pair in np.flatnonzero(alone.any(axis=0)).tolist():
        found, expected, mend = said(int(alone[:, pair].argmax()), pair)
        mend += if_many(alone[:, pair], joints.judged[:, pair])
        yield in_episodes(joints.pairs[pair].command, joints.number[alone[:, pair]], found, expected, mend)


def if_many(wrong: Bools, judged: Bools) -> str:
    """Admit where about half of the episodes are one way and half the other that neither is known to be right."""
    n, others = int(wrong.sum()), int((judged & ~wrong).sum())
    return (
        f". It is {n} episodes against {others}: which of them are right, the data does not say"
        if others and n >= _MANY * others
        else ""
    )


def in_episodes(what: str, numbers: Ints, found: str, expected: str, mend: str) -> Fault:
    """Return a fault of some episodes, of which some runs are."""
    episodes = tuple(dict.fromkeys(numbers.tolist()))
    return Fault(DATA_DIR, f"{what} in {episodes_named(episodes)}", found, expected, mend, episodes)


def _near(factor: Any, other: float, times: float) -> Any:
    """Say where a factor is within so many times of another one."""
    return (factor > other / times) & (factor < other * times)


def _median(values: Floats, where: Bools) -> Floats:
    """Return the lower median of each column where it counts, NaN where nothing does: (n, m) to (m,)."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RuntimeWarning)  # a column in which nothing counts
        middle: Floats = np.nanquantile(np.where(where, values, np.nan), 0.5, axis=0, method="lower")
    return middle


def _frames(lag: float) -> str:
    return f"{count(abs(int(lag)), 'frame')} {'before' if lag < 0 else 'after'} it"


def _of_joints(wrong: Bools) -> str:
    n = int(wrong.sum())
    return f", and so of {count(n - 1, 'more joint')}" if n > 1 else ""


def _factor(factor: float) -> str:
    """Say a factor, and what it is between units."""
    unit = unit_of(factor)
    said = f" ({unit})" if unit and abs(abs(factor) - 1) > 0.1 else ""
    return f"{factor:.3g}{said}"
