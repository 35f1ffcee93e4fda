"""The hunt of `09_field_guide`: eight datasets. What is wrong with each, if anything?

Nothing is measured for the learner. The numbers are there, to draw them and to try one's own checks on, for nothing.
Each instrument of `z2r` costs a point for each dataset that it is held to: one check of the audit is one instrument.
A wrong guess costs more.
"""

import shutil
import tempfile
import weakref
from collections.abc import Callable, Iterator, Mapping
from pathlib import Path
from typing import NamedTuple

import msgspec
import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from z2r import api
from z2r.arrays import Ints
from z2r.audits.audit import Audit
from z2r.course.exercises._core import NOT_ATTEMPTED, NOT_YET, RIGHT
from z2r.course.hunts import arm
from z2r.course.hunts._core import SEED, rng_of
from z2r.course.hunts._frames import COMMAND, Frames, episodes_of, names_of, side_by_side
from z2r.data import ARM, MESSY, STANDIN
from z2r.format.dataset import load
from z2r.format.episodes import EPISODES_DIR, EpisodeIndex
from z2r.format.schema import BOOKKEEPING, INFO_PATH
from z2r.format.tables import TASKS_PATH
from z2r.reading.action import DrivenColumn
from z2r.reading.inspection import Inspection
from z2r.show.report import Panel

RIGHT_GUESS, WRONG_GUESS, INSTRUMENT = 5, -2, -1
"""Points, each."""

HEALTHY = "healthy"

_NUMBER = 9
_NAMES = "abcdefgh"
_N_EPISODES = 5
_LONG = 50  # frames: shorter episodes are not drawn
_AHEAD = 25  # frames: how far the clock of the cube is ahead


class Recording(NamedTuple):
    """One of the eight datasets.

    Attributes
    ----------
    columns : dict of str to ndarray, float64[n_frames]
        All numbers, by the names that the dataset gives them; those of an action begin with ``action/``.
    episodes : EpisodeIndex
        Where each episode begins and ends, as the dataset has it.
    fps : float
        Frames a second, as the dataset has it.
    """

    columns: Frames
    episodes: EpisodeIndex
    fps: float


type _Damage = Callable[[np.random.Generator, Recording], Recording]


class Suspect(NamedTuple):
    """What may be wrong with a dataset: what one would see of it, and how it is done."""

    shows: str
    damage: _Damage


def _each(change: Callable[[Frames], Frames]) -> _Damage:
    """Change every episode alike."""
    return lambda rng, it: _joined([change(frames) for frames in _parts(it)], it.fps)


def _store_commands_late(rng: np.random.Generator, it: Recording) -> Recording:
    n = int(rng.integers(2, 4) if it.fps == 10 else rng.integers(6, 10))
    return _each(lambda frames: arm.later(frames, COMMAND, n))(rng, it)


def _lose_a_second(rng: np.random.Generator, it: Recording) -> Recording:
    """Lose the frames of a second in one episode, where most happens meanwhile."""
    parts, n = _parts(it), round(it.fps)
    number = int(rng.integers(len(parts)))
    robot = [name for name in it.columns if name.startswith("pusher") or COMMAND + name in it.columns]
    seen = side_by_side(parts[number], robot)
    way = np.abs(seen[n:] - seen[:-n]) / np.ptp(side_by_side(it.columns, robot), axis=0)
    first = int(way.max(axis=1)[5:-5].argmax()) + 6
    parts[number] = {name: np.delete(values, np.s_[first : first + n - 1]) for name, values in parts[number].items()}
    return _joined(parts, it.fps)


def _shift_the_index(rng: np.random.Generator, it: Recording) -> Recording:
    """Let every episode but the first begin a frame late, and every one but the last end a frame late."""
    starts, stops = it.episodes.from_index.copy(), it.episodes.to_index.copy()
    starts[1:] += 1
    stops[:-1] += 1
    return it._replace(episodes=EpisodeIndex(starts, stops))


def _put_a_joint_in_radians(rng: np.random.Generator, it: Recording) -> Recording:
    joint = str(rng.choice(arm.JOINTS))
    return _each(lambda frames: arm.in_radians(frames, joint))(rng, it)


def _exchange_two_joints(rng: np.random.Generator, it: Recording) -> Recording:
    one, other = rng.choice(arm.JOINTS[1:4], 2, replace=False).tolist()
    return _each(lambda frames: arm.exchanged(frames, one, other))(rng, it)


def _stop_the_encoders(rng: np.random.Generator, it: Recording) -> Recording:
    parts, number, first = _parts(it), int(rng.integers(_N_EPISODES)), int(rng.integers(20, 40))
    parts[number] = arm.stuck(parts[number], first, 25)
    return _joined(parts, it.fps)


def _exchange_sine_and_cosine(frames: Frames) -> Frames:
    for body in ("tee", "target"):
        frames = arm.exchanged(frames, f"sin_{body}_yaw", f"cos_{body}_yaw")
    return frames


def _in_centimetres(frames: Frames) -> Frames:
    return {name: 100 * values if name.startswith(COMMAND) else values for name, values in frames.items()}


_ANY: dict[str, Suspect] = {
    HEALTHY: Suspect("nothing", lambda rng, it: it),
    "commands-late": Suspect("what moves answers an action before it is stored", _store_commands_late),
    "second-lost": Suspect("one leap, in the middle of one episode", _lose_a_second),
    "index-shifted": Suspect("a leap into the last frame of each episode but the last one", _shift_the_index),
}
_PUSHER: dict[str, Suspect] = {
    "sine-and-cosine-exchanged": Suspect(
        "every place right, and the pusher inside the block", _each(_exchange_sine_and_cosine)
    ),
    "actions-in-centimetres": Suspect("the pusher goes a hundredth as fast as it is told", _each(_in_centimetres)),
    "clock-three-times-too-fast": Suspect(
        "the pusher goes three times as fast as it is told", lambda rng, it: it._replace(fps=3 * it.fps)
    ),
    "pusher-x-and-y-exchanged": Suspect(
        "what is told along x happens along y", _each(lambda frames: arm.exchanged(frames, "pusher_x", "pusher_y"))
    ),
}
_ARM: dict[str, Suspect] = {
    "joint-in-radians": Suspect("one joint does 57 times less than it is told", _put_a_joint_in_radians),
    "joints-exchanged": Suspect("two joints do what the other one is told", _exchange_two_joints),
    "encoders-stuck": Suspect("for a while, all joints stand still whatever they are told", _stop_the_encoders),
    "jaws-turned-round": Suspect("the cube is carried in open jaws", _each(arm.with_jaws_turned_round)),
    "cube-and-goal-exchanged": Suspect("the goal moves, and the cube never does", _each(arm.with_cube_for_goal)),
    "cube-too-early": Suspect(
        "the cube rises before the jaws close", _each(lambda frames: arm.later(frames, "block", -_AHEAD))
    ),
}

SUSPECTS: dict[str, str] = {name: suspect.shows for name, suspect in (_ANY | _PUSHER | _ARM).items()}
"""Every answer that there is, and what one would see of it."""


class Finale:
    """Eight datasets, drawn from a seed: four of the pusher, four of the arm. Some of them are healthy.

    Parameters
    ----------
    seed : int, optional
        Another one makes other datasets.

    Examples
    --------
    >>> finale = Finale(seed=0)
    >>> finale["a"].episodes
    EpisodeIndex(5 episodes, 361 frames)
    >>> finale.hand_in(dict.fromkeys(finale.names))
    not attempted yet: put the name of a suspect in place of None, then run the cell again.
    """

    def __init__(self, seed: int = SEED) -> None:
        self.seed = seed
        self._used: set[tuple[str, str]] = set()
        self._wrong: set[tuple[str, str]] = set()
        self._right: set[str] = set()
        drawn = list(_draw(rng_of(_NUMBER, seed)))
        self._roots = dict(zip(_NAMES, (root for root, _, _ in drawn), strict=True))
        self._truth = dict(zip(_NAMES, (name for _, name, _ in drawn), strict=True))
        self._recordings = dict(zip(_NAMES, (recording for _, _, recording in drawn), strict=True))
        self._audits: dict[str, Audit] = {}
        self._folder = Path(tempfile.mkdtemp())
        weakref.finalize(self, shutil.rmtree, self._folder)  # a TemporaryDirectory that nobody closes warns

    def __repr__(self) -> str:
        return self.line

    def __getitem__(self, name: str) -> Recording:
        """Return the numbers of a dataset, for nothing: ``finale["a"].columns["action/pusher_vx"]``."""
        it = self._recordings[name]
        return it._replace(columns={column: values.copy() for column, values in it.columns.items()})

    @property
    def names(self) -> tuple[str, ...]:
        """What the datasets are called."""
        return tuple(_NAMES)

    @property
    def points(self) -> int:
        """Of 40: 5 for each right guess, 2 less for each wrong one, 1 less for each use of an instrument."""
        told = RIGHT_GUESS * len(self._right) + WRONG_GUESS * len(self._wrong) + INSTRUMENT * len(self._used)
        return max(told, 0)

    @property
    def line(self) -> str:
        """The score, to share."""
        counts = f"instruments: {len(self._used)}, wrong guesses: {len(self._wrong)}"
        points = f"{self.points} of {RIGHT_GUESS * len(_NAMES)} points"
        return f"z2r finale, seed {self.seed}: {points} ({len(self._right)} of {len(_NAMES)} right, {counts})"

    def hand_in(self, answers: Mapping[str, str | None]) -> None:
        """Judge what is wrong with the datasets, and tell the score; the same wrong guess costs once.

        Parameters
        ----------
        answers : mapping of str to str or None
            One of `SUSPECTS` for each name; None where there is no answer yet.
        """
        if not isinstance(answers, Mapping):
            print(f"{NOT_YET}: found {answers!r}, expected a dict with an answer for each of {', '.join(_NAMES)}.")
            return
        given = {name: answer for name, answer in answers.items() if answer is not None}
        strange = [each for each in given.items() if each[0] not in self.names or each[1] not in [*SUSPECTS]]
        if not given:
            print(f"{NOT_ATTEMPTED}: put the name of a suspect in place of None, then run the cell again.")
            return
        if strange:
            name, answer = strange[0]
            print(f"{NOT_YET}: {answer!r} for {name!r} costs nothing, and says nothing.", end=" ")
            print(f"Expected for one of {', '.join(_NAMES)}: {', '.join(SUSPECTS)}.")
            return
        wrong = {name: answer for name, answer in given.items() if answer != self._truth[name]}
        self._wrong |= set(wrong.items())
        self._right |= given.keys() - wrong.keys()
        open_ones = [name for name in _NAMES if name not in self._right]
        if not (wrong or open_ones):
            print(f"{RIGHT}: {self.line}")
            return
        print(f"{NOT_YET}: {self.line}")
        for name, answer in wrong.items():
            seen = f": of that you would see {SUSPECTS[answer]}" if answer != HEALTHY else ". Ask it something else"
            print(f"    {name} is not {answer}{seen}")
        if unanswered := [name for name in open_ones if name not in wrong]:
            print(f"    no answer yet: {', '.join(unanswered)}")

    def ask(self, name: str, check: str) -> list[str]:
        """Return what one check of `z2r.audit` finds in a dataset. Costs a point; `z2r.api.CHECKS` says what each asks.

        A check that there is not costs nothing.
        """
        if check not in api.CHECKS:
            print(f"found no check {check!r}, expected one of {', '.join(api.CHECKS)}")
            return []
        root = self._used_on(check, name)
        if name not in self._audits:
            self._audits[name] = api.audit(root)
        return [str(each) for each in self._audits[name].findings if each.check == check]

    def infer_action(self, name: str) -> tuple[DrivenColumn, ...]:
        """Return what `z2r.infer_action` says of every dimension of the action. Costs a point."""
        return api.infer_action(self._used_on("infer_action", name))

    def inspect(self, name: str) -> Inspection:
        """Return what `z2r.inspect_dataset` says. Costs a point."""
        return api.inspect_dataset(self._used_on("inspect", name))

    def panel(self, name: str) -> Panel:
        """Show a dataset as `z2r.panel` does. Costs a point."""
        return api.panel(self._used_on("panel", name))

    def _used_on(self, instrument: str, name: str) -> Path:
        """Note that an instrument is used, and return the dataset as a folder."""
        recording = self._recordings[name]
        self._used.add((instrument, name))
        root = self._folder / f"dataset-{name}"
        if not root.exists():
            _write(recording, self._roots[name], root)
        return root


def _draw(rng: np.random.Generator) -> Iterator[tuple[Path, str, Recording]]:
    """Draw what each dataset is made of, and what is wrong with it."""
    bases = rng.permutation(["pusher", "arm"] * (len(_NAMES) // 2)).tolist()
    n_healthy = int(rng.integers(1, 4))
    is_healthy = rng.permutation(np.arange(len(_NAMES)) < n_healthy).tolist()
    wrong = {name: suspect for name, suspect in _ANY.items() if name != HEALTHY}
    left = {base: rng.permutation([*wrong, *own]).tolist() for base, own in (("pusher", _PUSHER), ("arm", _ARM))}
    for base, healthy in zip(bases, is_healthy, strict=True):
        name = HEALTHY if healthy else left[base].pop()
        root = ARM if base == "arm" else (STANDIN, MESSY)[int(rng.integers(2))]
        yield root, name, (_ANY | _PUSHER | _ARM)[name].damage(rng, _recorded(rng, root))


def _recorded(rng: np.random.Generator, root: Path) -> Recording:
    """Draw some episodes; those of the pusher may be seen in a mirror, which changes nothing."""
    episodes = [frames for frames in episodes_of(root) if len(next(iter(frames.values()))) >= _LONG]
    drawn = [episodes[number] for number in rng.choice(len(episodes), _N_EPISODES, replace=False)]
    if root != ARM and rng.random() < 0.5:
        drawn = [_mirrored(frames) for frames in drawn]
    return _joined(drawn, load(root).schema.fps)


def _mirrored(frames: Frames) -> Frames:
    """Take left for right everywhere: the block is its own mirror image."""
    turned = [name for name in frames if name.endswith(("_x", "vx")) or name.startswith("sin")]
    return frames | {name: -frames[name] for name in turned}


def _joined(parts: list[Frames], fps: float) -> Recording:
    columns = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    stops = np.cumsum([len(next(iter(part.values()))) for part in parts])
    return Recording(columns, EpisodeIndex(np.append(0, stops[:-1]), stops), fps)


def _parts(it: Recording) -> list[Frames]:
    episodes = (it.episodes[number] for number in range(len(it.episodes)))
    return [{name: values[frames] for name, values in it.columns.items()} for frames in episodes]


def _write(it: Recording, like: Path, root: Path) -> None:
    """Write a LeRobot v3 dataset with the features of another one, but for its pictures, and without statistics."""
    schema, lengths, n = load(like).schema, it.episodes.lengths, len(it.episodes)
    names = names_of(like)
    features = {name: schema.features[name] for name in (*names, *BOOKKEEPING)}
    of_each = np.zeros(n, dtype=np.int64)
    index = {"episode_index": it.episodes.numbers, "length": lengths, "tasks": [["do it"]] * n}
    places = {"dataset_from_index": it.episodes.from_index, "dataset_to_index": it.episodes.to_index}
    kinds = ("data", "meta/episodes")
    places |= {f"{kind}/{part}": of_each for kind in kinds for part in ("chunk_index", "file_index")}
    totals = {"total_episodes": n, "total_frames": it.episodes.n_frames}
    info = msgspec.structs.replace(schema, fps=it.fps, features=features, **totals)
    vectors = {name: side_by_side(it.columns, names[name]).astype(np.float32) for name in names}
    tables = {
        schema.data_path.format(chunk_index=0, file_index=0): {
            name: pa.FixedSizeListArray.from_arrays(values.ravel(), values.shape[1]) for name, values in vectors.items()
        }
        | _bookkeeping(it),
        f"{EPISODES_DIR}/chunk-000/file-000.parquet": index | places,
        str(TASKS_PATH): {"task_index": [0], "task": ["do it"]},
    }
    for path, columns in tables.items():
        (root / path).parent.mkdir(parents=True, exist_ok=True)
        pq.write_table(pa.table(columns), root / path)
    (root / INFO_PATH).write_bytes(msgspec.json.encode(info))


def _bookkeeping(it: Recording) -> dict[str, Ints]:
    lengths = it.episodes.lengths
    number = np.concatenate([np.arange(length) for length in lengths])
    return {
        "timestamp": (number / it.fps).astype(np.float32),
        "frame_index": number,
        "episode_index": np.repeat(it.episodes.numbers, lengths),
        "index": np.arange(len(number)),
        "task_index": np.zeros(len(number), dtype=np.int64),
    }
