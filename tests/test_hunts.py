"""The hunts: the right answer is full, and what is constant, careless, wrong, or left to `z2r`, is told what it missed.

The datasets come from seeds, so what holds of one seed is held against others.
"""

import contextlib
import gc
import importlib
import io
import re
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from diagnosis import diagnosed
from layouts import BOOKKEEPING, Layout, write_dataset
from notebook_tools import STEMS, cell_tags, code_cells, committed
from solutions.hunts import FINALE, HUNTS

import z2r
from z2r.course.exercises._core import NOT_ATTEMPTED, NOT_YET, RIGHT
from z2r.course.hunts import actions, beliefs, headings, recordings, seams
from z2r.course.hunts._core import Trial
from z2r.course.hunts.finale import HEALTHY, SUSPECTS, Finale
from z2r.reading.action import ActionSample, infer_action

each_hunt = pytest.mark.parametrize("stem", HUNTS)
ENOUGH = 60  # points: what is not thought about must stay below


def printed(function: Callable[..., object], *args: object, **options: object) -> str:
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        function(*args, **options)
    return out.getvalue()


def points(reply: str) -> int:
    """What a reply gives, of 100."""
    if reply.startswith(RIGHT):
        return 100
    return int(found[1]) if (found := re.match(rf"{NOT_YET}: (\d+) of 100 points", reply)) else 0


def hunt_of(stem: str) -> Any:
    return importlib.import_module(f"z2r.course.hunts.{HUNTS[stem].module}")


def solution(stem: str) -> Callable[..., Any]:
    names: dict[str, Any] = {"np": np}
    exec(HUNTS[stem].solution, names)
    return names[HUNTS[stem].function]


def patched(stem: str, old: str, new: str) -> Callable[..., Any]:
    """The solution with one mistake in it."""
    assert HUNTS[stem].solution.count(old) == 1
    names: dict[str, Any] = {"np": np}
    exec(HUNTS[stem].solution.replace(old, new), names)
    return names[HUNTS[stem].function]


@each_hunt
@pytest.mark.parametrize("seed", range(4))
def test_the_solution_is_full_whatever_the_seed(stem, seed):
    reply = printed(hunt_of(stem).score, solution(stem), seed=seed)
    assert reply.startswith(f"{RIGHT}: "), reply


@each_hunt
def test_an_untouched_hunt_is_not_attempted(stem):
    assert printed(exec, f"{HUNTS[stem].imported}\n{HUNTS[stem].cell}", {}).startswith(NOT_ATTEMPTED)


@each_hunt
def test_the_seed_draws_the_datasets(stem):
    hunt = hunt_of(stem)
    drawn = [hunt._trials(hunt.rng_of(hunt._NUMBER, seed)) for seed in (0, 0, 1)]
    one, again, other = (content(list(trials)) for trials in drawn)
    assert one == again
    assert not set(one) & set(other)
    assert not set(one) & set(content(hunt.examples()))


def content(trials: list[Trial]) -> list[bytes]:
    """What is in each dataset, as something that can be compared."""
    return [b"".join(np.asarray(values).tobytes() for values in numbers_of(trial.args)) for trial in trials]


def numbers_of(args: Any) -> list[Any]:
    parts = args.values() if isinstance(args, dict) else args
    return [values for part in parts for values in (numbers_of(part) if isinstance(part, dict | tuple) else [part])]


@each_hunt
def test_an_example_is_the_learner_s_own(stem):
    trial = hunt_of(stem).examples()[0]
    spoil(trial.args)
    assert content([hunt_of(stem).examples()[0]]) != content([trial])
    assert printed(hunt_of(stem).score, solution(stem)).startswith(RIGHT)


def spoil(args: Any) -> None:
    for values in numbers_of(args):
        if isinstance(values, np.ndarray):
            values[...] = 0


CONSTANTS: dict[str, tuple[object, ...]] = {
    "02_episode_index": ([], [100], list(range(1, 50)), list(range(50, 500, 50))),
    "03_atan2_decoding": headings.ENCODINGS,
    "04_hidden_success": (True, False),
    "05_rerun_replay": (None, 0, 60, 75, 90),
    "06_what_is_an_action": (None, ("target", 0, 2, 1.0), ("change", 0, 1, 10.0)),
    "07_break_modes": (True, False),
    "08_your_dataset": recordings.DECISIONS,
    "10_cost_of_a_misreading": (True, False),
}


@pytest.mark.parametrize(("stem", "constant"), [(stem, each) for stem in CONSTANTS for each in CONSTANTS[stem]])
@pytest.mark.parametrize("seed", range(3))
def test_an_answer_that_is_always_the_same_is_not_enough(stem, constant, seed):
    reply = printed(hunt_of(stem).score, lambda *args: constant, seed=seed)
    assert reply.startswith(NOT_YET)
    assert points(reply) < ENOUGH


# --- wrong in a way of its own: what it does, and what it is told


def mutating(stem: str) -> Callable[..., Any]:
    """The solution, which leaves nothing of what it was given."""

    def function(*args: Any) -> Any:
        answer = solution(stem)(*args)
        spoil(args)
        return answer

    return function


def after(stem: str, change: Callable[[Any], Any]) -> Callable[..., Any]:
    return lambda *args: change(solution(stem)(*args))


def raising(*args: Any) -> Any:
    raise KeyError("yaw")


COMMON: dict[str, tuple[Callable[[str], Callable[..., Any]], str]] = {
    "it raises": (lambda stem: raising, "dataset 1 of"),
    "it changes what it is given": (mutating, "work on a copy"),
    "text": (lambda stem: lambda *args: "yes", "your function returned 'yes'. Expected: "),
    "a number that is none": (lambda stem: lambda *args: float("nan"), "your function returned nan. Expected: "),
    "an object": (lambda stem: lambda *args: object, "Expected: "),
    "a table": (lambda stem: lambda *args: np.zeros((2, 3)), "Expected: "),
    "too many arguments are needed": (lambda stem: lambda one, two, three, four, five: True, "raised TypeError"),
    "three dots now and then": (
        lambda stem: lambda *args, seen=[]: seen.append(0) or (... if len(seen) > 1 else solution(stem)(*args)),
        "returned Ellipsis",
    ),
}


@each_hunt
@pytest.mark.parametrize("mistake", COMMON)
def test_what_is_no_answer_is_told_what_one_is(stem, mistake):
    make, message = COMMON[mistake]
    reply = printed(hunt_of(stem).score, make(stem))
    assert reply.startswith(NOT_YET)
    assert message in reply, reply


def first_leap_only(state: Any) -> Any:
    return solution("02_episode_index")(state)[:1]


def widest_range(x: Any, y: Any, columns: Any) -> str:
    """What one would say who looks at the range alone."""
    n = columns.shape[1]
    if n == 1:
        return "degrees" if np.ptp(columns) > 2 * np.pi else "radians"
    return {2: "sin cos", 4: "x y z w"}[n]


def without_witness(x: Any, y: Any, columns: Any) -> str:
    answer = solution("03_atan2_decoding")(x, y, columns)
    return {"cos sin": "sin cos"}.get(answer, answer)


def one_frame_is_a_grip(told: Any, seen: Any) -> Any:
    wider = np.flatnonzero(seen > told + 5)
    return int(wider[0]) if len(wider) else None


def closed_is_gripped(told: Any, seen: Any) -> Any:
    still = np.flatnonzero(np.abs(np.diff(seen)) < 0.5)
    closed = still[still > np.argmax(seen)]
    return int(closed[0]) if len(closed) else None


def by_name_alone(state: Any, action: Any, seen: Any, wanted: Any) -> bool:
    """Whatever differs between training and play is called ruined."""
    return bool(np.abs(state.mean(axis=0) - seen.mean(axis=0)).max() > 0.2 or abs(action.std() - wanted.std()) > 0.05)


# A function, or what is exchanged in the solution; and what must be in the reply.
WRONG: dict[str, dict[str, tuple[Callable[..., Any] | tuple[str, str], str]]] = {
    "02_episode_index": {
        "one frame late": (after("02_episode_index", lambda starts: starts + 1), "an arm, in degrees: "),
        "one frame early": (after("02_episode_index", lambda starts: starts - 1), "missed, 5 false"),
        "the first seam alone": (first_leap_only, "six demonstrations of pushing: 4 missed"),
        "metres for everybody": (
            ("> 3 * usual", "> 0.1"),
            "pushing, in millimetres: ",
        ),
        "a drop-out taken for a seam": (
            (" & ~far[:-2] & ~far[2:]", ""),
            "whose encoder drops out twice",
        ),
        "one column asked": (
            ("np.diff(state, axis=0)", "np.diff(state[:, :1], axis=0)"),
            "missed",
        ),
        "twice what is usual": (("3 * usual", "1.2 * usual"), "false alarms: "),
        "frames, not their numbers": (lambda state: state[:3], "a list of frame numbers"),
        "a mask": (lambda state: np.zeros(len(state), dtype=bool), "a list of frame numbers"),
        "one number": (lambda state: 100, "a list of frame numbers"),
    },
    "03_atan2_decoding": {
        "the range alone": (widest_range, "cosine and sine (3 of 3): you said 'sin cos', it is 'cos sin'"),
        "always in this order": (without_witness, "cosine and sine (3 of 3): you said 'sin cos'"),
        "every column is a heading": (("> 0.9", "> -2"), "a mast that turns by itself"),
        "no column is one": (("> 0.9", "> 2"), "you said 'no heading'"),
        "the way swapped": (
            ("np.arctan2(np.gradient(y), np.gradient(x))", "np.arctan2(np.gradient(x), y)"),
            "missed",
        ),
        "differences not on the circle": (
            ("np.cos(yaw - way).mean()", "1 - np.abs(yaw - way).mean()"),
            "degrees from 0 to 360: you said",
        ),
        "half of the turn": (("2 * np.arctan2(c[2], c[3])", "np.arctan2(c[2], c[3])"), "x y z w"),
        "the sine alone": (
            ("np.arctan2(*c), ", "np.arcsin(c[0]), "),
            "sine and cosine",
        ),
        "upper case": (after("03_atan2_decoding", str.upper), "one of 'degrees', 'radians'"),
    },
    "04_hidden_success": {
        "inverted": (after("04_hidden_success", lambda answer: not answer), "place, on the disc (3 of 3): missed"),
        "never mind the jaws": ((" and let_go", ""), "place, on the disc, and still held"),
        "never mind the way": (
            (" and height.max() > 0.03", ""),
            "place, pushed there, never carried",
        ),
        "any frame will do": (
            ('np.hypot(gaps["x"][-1], gaps["y"][-1])', 'np.hypot(gaps["x"], gaps["y"]).min()'),
            "knocked off again: a false alarm",
        ),
        "both axes on their own": (('np.hypot(gaps["x"][-1], gaps["y"][-1])', "0"), "beside"),
        "seen from above": (
            ("in gaps.values()]", "in list(gaps.values())[:2]]"),
            "under the ball",
        ),
        "a table of one height": (
            ('frames["block_z"] - frames["block_z"][0]', 'frames["block_z"] - 0.02'),
            "place, ",
        ),
        "twice as tolerant": (("on_it = np.hypot", "on_it = 0.5 * np.hypot"), "beside the disc"),
        "half as tolerant": (("on_it = np.hypot", "on_it = 2 * np.hypot"), "near the rim"),
        "only one task": (('task == "lift"', "False"), "lift, in the ball"),
        "a count": (after("04_hidden_success", int), "True or False"),
        "one for each frame": (lambda frames, task: frames["block_x"] > 0, "True or False"),
    },
    "05_rerun_replay": {
        "one frame is enough": (one_frame_is_a_grip, "nothing between the jaws"),
        "whoever stands still": (closed_is_gripped, "told to close half only"),
        "the stall is not asked for": ((" and np.ptp(seen[soon]) < 2", ""), "missed"),
        "half a second late": (
            after("05_rerun_replay", lambda frame: None if frame is None else frame + 15),
            "a cube (3 of 3): you said",
        ),
        "in seconds": (after("05_rerun_replay", lambda frame: None if frame is None else frame / 30), "None"),
        "as soon as it is beside": (("told + 5", "told + 1"), "always stop a little too wide"),
        "thin things do not count": (("told + 5", "told + 20"), "a thin thing (2 of 2): you said"),
        "nothing that slips": (("frame + 12", "frame + 3"), "slipped out at once"),
        "the first closing": (
            lambda told, seen: int(np.argmin(np.diff(seen))),
            "nothing in the first grasp, a cube in the second",
        ),
        "true": (lambda told, seen: True, "the number of a frame, or None"),
    },
    "06_what_is_an_action": {
        "one window for all": (("0.4 * fps", "15"), "a slow arm of 200 frames a second"),
        "a wide window": (("round(0.4 * fps) + 1", "min(12, len(state))"), "frames a second"),
        "at once": (("round(0.4 * fps) + 1", "2"), "you said None"),
        "signs lost": (
            ("np.polyfit(values, told, 1)[0]", "abs(np.polyfit(values, told, 1)[0])"),
            "you said",
        ),
        "upside down": (
            ("np.polyfit(values, told, 1)[0]", "np.polyfit(told, values, 1)[0]"),
            "you said",
        ),
        "negative likeness lost": (
            ("abs(np.corrcoef(told, values)[0, 1])", "np.corrcoef(told, values)[0, 1]"),
            "None",
        ),
        "targets alone": (
            ('("change", moved)', '("target", there)'),
            "a cart that is told how far to move on (2 of 2): you said None",
        ),
        "always an answer": (("None, 0.95", "None, 0"), "drives what no column tells"),
        "three parts": (lambda *args: ("target", 0, 1), '"target" or "change"'),
        "another word": (lambda *args: ("velocity", 0, 1, 1.0), '"target" or "change"'),
        "a name": (lambda *args: ("target", "elbow", 1, 1.0), '"target" or "change"'),
        "two frames off": (
            after("06_what_is_an_action", lambda found: found and (*found[:2], found[2] + 4, found[3])),
            "an arm that is told where to be (2 of 2): you said",
        ),
    },
    "07_break_modes": {
        "inverted": (after("07_break_modes", lambda answer: not answer), "right, and the task failed (3 of 3)"),
        "nobody flies": (("flies or ", ""), "the jaws taken for closed where they are open"),
        "nothing sinks": (("sinks or ", ""), "up taken for down (2 of 2): missed"),
        "nothing rushes": (("rushes or ", ""), "millimetres taken for metres"),
        "nothing strays": ((" or strays", ""), "cube and goal taken for each other"),
        "no jolt allowed": (("> 0.02", "> 0.0001"), "a false alarm"),
        "the cube may not move": (lambda frames: bool(np.ptp(frames["block_x"]) > 0.01), "a false alarm"),
        "failure is a misreading": (
            lambda frames: bool(frames["block_z"].max() < frames["block_z"][0] + 0.03),
            "right, and the task failed",
        ),
        "closed for open": (("> 50", "< 50"), "a false alarm"),
        "numbers": (after("07_break_modes", int), "True or False"),
        "one for each frame": (lambda frames: frames["block_x"] > 0, "True or False"),
    },
    "08_your_dataset": {
        "pictures unseen": (
            ("if pictures.mean() < 10:", "pictures = action\n    if False:"),
            "the camera is black (2 of 2): you said",
        ),
        "a still picture is frozen": (
            ("(seen > 3 and shown == 0)", "shown == 0"),
            "the arm waits for a second, and so does the picture",
        ),
        "dark is black": (
            ("pictures.mean() < 10", "pictures.mean() < 50"),
            "a dark room: you said",
        ),
        "late is fine": (
            (" and lag >= 0", ""),
            "the command is stored late (2 of 2): you said 'keep'",
        ),
        "early is wrong": (("lag >= 0", "lag == 2"), "an arm that follows a little later"),
        "units are fine": (
            (" & (0.5 < factor)", ""),
            "a joint is in radians (2 of 2): you said 'keep'",
        ),
        "signs are fine": (
            ("alike[lag].diagonal() >", "np.abs(alike[lag].diagonal()) >"),
            "a joint has the other sign: you said 'keep'",
        ),
        "whatever is wrong is thrown away": (
            after("08_your_dataset", lambda answer: "keep" if answer == "keep" else "throw away"),
            "you said 'throw away', it is 'mend'",
        ),
        "whatever is wrong is mended": (
            after("08_your_dataset", lambda answer: "keep" if answer == "keep" else "mend"),
            "you said 'mend', it is 'throw away'",
        ),
        "all can be mended": (("min() < 0.9", "min() < -1"), "the commands are out of order"),
        "encoders never stop": (("seen == 0", "seen < 0"), "all encoders stop for a while"),
        "one word": (after("08_your_dataset", lambda answer: answer.split()[0]), "one of 'keep', 'mend', 'throw away'"),
    },
    "10_cost_of_a_misreading": {
        "inverted": (
            after("10_cost_of_a_misreading", lambda answer: not answer),
            "the hand in millimetres, in play only: missed",
        ),
        "whatever differs": (by_name_alone, "in training and in play: a false alarm"),
        "the way alone": (
            ("not (same_way and as_far)", "not same_way"),
            "actions in centimetres a second: missed",
        ),
        "the size alone": (
            ("not (same_way and as_far)", "not as_far"),
            "actions with the other sign: missed",
        ),
        "the size to a tenth": (("0.2 < sizes", "0.9 < sizes"), "actions three frames early"),
        "never mind what it will see": (
            lambda *given: solution("10_cost_of_a_misreading")(*given[:2], *given[:2]),
            "in play only: missed",
        ),
        "nothing beside": (("np.ones(len(values))", "np.zeros(len(values))"), "15 cm"),
        "a share": (after("10_cost_of_a_misreading", float), "True or False"),
        "one for each": (lambda *args: args[0][:, 0] > 0, "True or False"),
    },
}


@pytest.mark.parametrize(("stem", "mistake"), [(stem, mistake) for stem in WRONG for mistake in WRONG[stem]])
def test_a_wrong_answer_is_told_what_it_missed(stem, mistake):
    wrong, message = WRONG[stem][mistake]
    reply = printed(hunt_of(stem).score, patched(stem, *wrong) if isinstance(wrong, tuple) else wrong)
    assert reply.startswith(NOT_YET), reply
    assert message in reply, reply


@each_hunt
def test_a_dozen_mistakes_are_planted_in_each_hunt(stem):
    assert len(WRONG[stem]) + len(COMMON) + len(CONSTANTS[stem]) >= 12


def test_what_is_told_is_short():
    reply = printed(headings.score, lambda *args: "degrees")
    assert len(reply.splitlines()) <= 7
    assert max(map(len, reply.splitlines())) <= 120


# --- what z2r itself says, with its defaults


def write_arm(root: Path, features: dict[str, tuple[list[str], np.ndarray]], fps: int) -> Path:
    """Write one episode of an arm."""
    declared = {
        name: {"dtype": "float32", "shape": [len(names)], "names": names} for name, (names, _) in features.items()
    }
    frames = {name: values.astype(np.float32) for name, (_, values) in features.items()}
    n = len(next(iter(frames.values())))
    write_dataset(root, frames, [n], Layout([1], [1]), features=declared | BOOKKEEPING, fps=fps, robot_type="so101")
    return root


def alarms(root: Path) -> list[str]:
    return [str(each) for each in z2r.audit(root).findings if each.severity != "note"]


SO101 = z2r.load(z2r.ARM).schema.features["action"].dim_names


def test_the_audit_does_not_find_the_seams(tmp_path):
    def audited(state: np.ndarray) -> list[int]:
        names = SO101 if state.shape[1] == 6 else z2r.load(z2r.STANDIN).schema.features["observation.state"].dim_names
        said = alarms(write_arm(tmp_path / str(hash(state.tobytes())), {"observation.state": (names, state)}, 30))
        return [int(number) for line in said for number in re.findall(r"frame (\d+)", line)]

    assert points(printed(seams.score, audited)) < ENOUGH


def test_infer_action_is_not_enough():
    def inferred(action: np.ndarray, state: np.ndarray, fps: float) -> Any:
        stretch = np.zeros(len(action), dtype=int)
        [found] = infer_action(ActionSample(action[:, None], state, stretch, ("a",), ("0", "1", "2", "3"), fps))
        if found.kind == "unknown":
            return None
        factor = found.factor * (fps if found.kind == "velocity" else 1)
        return ("target" if found.kind == "target" else "change"), int(found.column), found.ahead, factor

    reply = printed(actions.score, inferred)
    assert 0 < points(reply) < ENOUGH
    assert "false alarms: 0" in reply  # what it says is right; the rest it does not say


def test_the_audit_refutes_no_belief_about_the_cube(tmp_path):
    def audited(frames: dict[str, np.ndarray]) -> bool:
        folder = tmp_path / str(hash(frames["block_x"].tobytes() + frames["gripper.pos"].tobytes()))
        world = [name for name in frames if name.startswith(("block", "goal"))]
        parts = {
            "observation.state": (SO101, np.stack([frames[name] for name in SO101], axis=1)),
            "observation.environment_state": (world, np.stack([frames[name] for name in world], axis=1)),
            "action": (SO101, np.stack([frames[f"action/{name}"] for name in SO101], axis=1)),
        }
        return bool(alarms(write_arm(folder, parts, 30)))

    assert points(printed(beliefs.score, audited)) < ENOUGH


@pytest.mark.parametrize("otherwise", ["mend", "throw away"])
def test_the_audit_does_not_decide(otherwise, tmp_path):
    def audited(action: np.ndarray, state: np.ndarray, pictures: np.ndarray) -> str:
        folder = tmp_path / str(hash(action.tobytes() + state.tobytes() + pictures.tobytes()))
        parts = {"observation.state": (SO101, state), "action": (SO101, action)}
        return otherwise if alarms(write_arm(folder, parts, 30)) else "keep"

    assert points(printed(recordings.score, audited)) < ENOUGH


# --- the finale


def test_an_untouched_finale_is_not_attempted():
    finale = Finale()
    assert printed(finale.hand_in, dict.fromkeys(finale.names)).startswith(NOT_ATTEMPTED)
    assert finale.points == 0


@pytest.mark.parametrize("seed", range(5))
def test_who_finds_all_by_hand_has_all_points(seed):
    finale = Finale(seed)
    answers = {name: diagnosed(finale[name]) for name in finale.names}
    reply = printed(finale.hand_in, answers)
    assert reply.startswith(RIGHT), reply
    assert reply.strip().endswith(f"seed {seed}: 40 of 40 points (8 of 8 right, instruments: 0, wrong guesses: 0)")


def test_the_seed_draws_the_eight():
    drawn = [[fingerprint(Finale(seed), name) for name in "abcdefgh"] for seed in (0, 0, 1)]
    assert drawn[0] == drawn[1]
    assert not set(drawn[0]) & set(drawn[2])


def fingerprint(finale: Finale, name: str) -> bytes:
    return b"".join(values.tobytes() for values in finale[name].columns.values())


def test_some_of_the_eight_are_healthy_and_none_is_like_another():
    drawn = [[*Finale(seed)._truth.values()] for seed in range(20)]
    for kinds in drawn:
        assert 1 <= kinds.count(HEALTHY) <= 3
        assert max(map(kinds.count, {*kinds} - {HEALTHY})) <= 2  # one of the pusher, one of the arm
    assert {kind for kinds in drawn for kind in kinds} == {*SUSPECTS}


@pytest.mark.parametrize("suspect", SUSPECTS)
def test_one_answer_for_all_of_the_eight_is_not_enough(suspect):
    for seed in range(3):
        finale = Finale(seed)
        assert printed(finale.hand_in, dict.fromkeys(finale.names, suspect)).startswith(NOT_YET)
        assert finale.points < 40 * ENOUGH / 100


def test_the_whole_audit_is_not_enough():
    finale = Finale()
    answers = {}
    for name in finale.names:
        found = [check for check in z2r.api.CHECKS if finale.ask(name, check)]
        answers[name] = diagnosed(finale[name]) if found else HEALTHY  # as if it said all that it might
    printed(finale.hand_in, answers)
    assert finale.points < 40 * ENOUGH / 100


def test_what_is_wrong_is_told_by_what_one_would_see_of_it():
    finale = Finale()
    name = next(name for name in finale.names if diagnosed(finale[name]) == HEALTHY)
    reply = printed(finale.hand_in, {name: "joint-in-radians"})
    assert f"{name} is not joint-in-radians: of that you would see {SUSPECTS['joint-in-radians']}" in reply
    others = ", ".join(other for other in finale.names if other != name)
    assert f"no answer yet: {others}" in reply
    assert "0 of 40 points (0 of 8 right, instruments: 0, wrong guesses: 1)" in reply


def test_the_same_wrong_guess_and_the_same_instrument_cost_once():
    finale = Finale()
    answers = {name: diagnosed(finale[name]) for name in finale.names}
    wrong = answers | {"a": next(each for each in SUSPECTS if each != answers["a"])}
    for _ in range(2):
        printed(finale.hand_in, wrong)
        finale.ask("b", "leap")
        finale.ask("b", "late")
        finale.infer_action("c")
        finale.inspect("d")
    printed(finale.hand_in, answers)
    assert finale.points == 40 - 2 - 4
    assert repr(finale) == "z2r finale, seed 0: 34 of 40 points (8 of 8 right, instruments: 4, wrong guesses: 1)"
    assert printed(finale.hand_in, wrong).startswith(NOT_YET)  # what was right before is not right now


@pytest.mark.parametrize(
    ("answers", "message"),
    [
        ({"a": "broken"}, "'broken' for 'a' costs nothing"),
        ({"z": HEALTHY}, "'healthy' for 'z' costs nothing"),
        ({"a": 3}, "3 for 'a' costs nothing"),
        ({"a": [HEALTHY]}, "['healthy'] for 'a' costs nothing"),
        ({0: HEALTHY}, "'healthy' for 0 costs nothing"),
        ([HEALTHY] * 8, "expected a dict"),
        (HEALTHY, "expected a dict"),
        (8, "expected a dict"),
    ],
)
def test_what_is_no_answer_costs_nothing(answers, message):
    finale = Finale()
    reply = printed(finale.hand_in, answers)
    assert reply.startswith(NOT_YET)
    assert message in reply, reply
    assert "wrong guesses: 0" in finale.line


def test_a_check_that_there_is_not_costs_nothing():
    finale = Finale()
    assert "expected one of" in printed(finale.ask, "a", "everything")
    assert "instruments: 0" in finale.line


def test_an_instrument_says_what_z2r_says():
    finale = Finale()
    kinds = {name: diagnosed(finale[name]) for name in finale.names}
    [late] = [name for name in kinds if kinds[name] == "commands-late"]
    [finding] = finale.ask(late, "late")
    assert "expected what it does after the command" in finding
    assert len(finale.infer_action(late)) == len([name for name in finale[late].columns if name.startswith("action/")])
    assert len(finale.inspect(late).episodes) == 5
    assert "Panel: dataset-" in repr(finale.panel(late))


@pytest.mark.filterwarnings("error")
def test_a_finale_that_is_forgotten_leaves_no_folder_and_says_nothing():
    finale = Finale()
    finale.ask("a", "leap")
    folder = finale._folder
    assert folder.exists()
    del finale
    gc.collect()
    assert not folder.exists()


def test_the_numbers_that_are_handed_out_are_the_learner_s_own():
    finale = Finale()
    before = fingerprint(finale, "a")
    for values in finale["a"].columns.values():
        values[...] = 0
    assert fingerprint(finale, "a") == before


# --- the pages

HUNTED = {stem: cell for stem in STEMS for cell in code_cells(committed(stem)) if "hunt" in cell_tags(cell)}


def test_every_page_from_02_on_has_a_hunt():
    assert set(HUNTED) == {stem for stem in STEMS if stem >= "02"}


@pytest.mark.parametrize("stem", HUNTED)
def test_the_page_hands_out_the_hunt_and_folds_away_its_solution(stem):
    prose = "\n".join(cell.source for cell in committed(stem).cells if cell.cell_type == "markdown")
    assert HUNTED[stem].source == (HUNTS[stem].cell if stem in HUNTS else FINALE)
    assert stem not in HUNTS or f"```python\n{HUNTS[stem].solution}```" in prose
