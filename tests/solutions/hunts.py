"""A right answer to each hunt, as its page folds it away; and how the page hands the hunt out.

By the stem of the page: the module of the hunt, the learner's function and its arguments, and the solution. The finale
has no function; it is answered with names.
"""

from typing import NamedTuple


class Hunt(NamedTuple):
    module: str
    signature: str
    solution: str
    wrong: tuple[str, str, str, str]  # what to call it; what is exchanged in the solution, by what; what it is told

    @property
    def function(self) -> str:
        return self.signature.partition("(")[0]

    @property
    def imported(self) -> str:
        return f"from z2r.course.hunts import {self.module} as hunt"

    @property
    def score(self) -> str:
        return f"hunt.score({self.function})"

    @property
    def cell(self) -> str:
        """The cell as the page hands it out."""
        return f"def {self.signature}:\n    return ...\n\n\n{self.score}"

    @property
    def exercise(self) -> dict:
        name, old, new, message = self.wrong
        assert self.solution.count(old) == 1
        sources = {
            name: (self.solution.replace(old, new), message),
            "an error": (f"def {self.signature}:\n    return nowhere\n", "your function raised NameError"),
            "a word": (f"def {self.signature}:\n    return 'yes'\n", "your function returned 'yes'. Expected: "),
        }
        wrong = {name: (f"{source}{self.score}", told) for name, (source, told) in sources.items()}
        return {"solution": f"{self.solution}{self.score}", "wrong": wrong}


HUNTS = {
    "02_episode_index": Hunt(
        "seams",
        "find_starts(state)",
        """\
def find_starts(state):
    steps = np.abs(np.diff(state, axis=0))
    usual = np.quantile(steps, 0.99, axis=0)  # of each column
    far = (steps > 3 * usual).any(axis=1)  # step k leads to frame k + 1
    alone = far[1:-1] & ~far[:-2] & ~far[2:]  # a drop-out leaps there and back
    return np.flatnonzero(alone) + 2
""",
        ("metres for everybody", "> 3 * usual", "> 0.1", "pushing, in millimetres: "),
    ),
    "03_atan2_decoding": Hunt(
        "headings",
        "encoding(x, y, columns)",
        """\
def encoding(x, y, columns):
    way = np.arctan2(np.gradient(y), np.gradient(x))
    c = columns.T
    if len(c) == 1:
        yaws = {"degrees": np.deg2rad(c[0]), "radians": c[0]}
    elif len(c) == 2:
        yaws = {"sin cos": np.arctan2(*c), "cos sin": np.arctan2(*c[::-1])}
    else:
        yaws = {
            "x y z w": 2 * np.arctan2(c[2], c[3]),
            "w x y z": 2 * np.arctan2(c[3], c[0]),
        }
    fits = {name: np.cos(yaw - way).mean() for name, yaw in yaws.items()}
    best = max(fits, key=fits.get)
    return best if fits[best] > 0.9 else "no heading"
""",
        ("every column is a heading", "> 0.9", "> -2", "a mast that turns by itself"),
    ),
    "04_hidden_success": Hunt(
        "goals",
        "reached(frames, task)",
        """\
def reached(frames, task):
    gaps = {a: frames[f"block_{a}"] - frames[f"goal_{a}"] for a in "xyz"}
    if task == "lift":
        return bool(np.linalg.norm([gap[-1] for gap in gaps.values()]) < 0.03)
    height = frames["block_z"] - frames["block_z"][0]
    on_it = np.hypot(gaps["x"][-1], gaps["y"][-1]) < 0.03
    let_go = frames["gripper.pos"][-1] > 40
    return bool(on_it and let_go and height.max() > 0.03)
""",
        ("never mind the jaws", " and let_go", "", "place, on the disc, and still held"),
    ),
    "05_rerun_replay": Hunt(
        "grip",
        "gripped(told, seen)",
        """\
def gripped(told, seen):
    wider = seen > told + 5  # percent: more than jaws that are never exact
    for frame in range(len(seen) - 12):
        soon = slice(frame, frame + 12)  # 0.4 s: longer than any delay
        if wider[soon].all() and np.ptp(seen[soon]) < 2:
            return frame
    return None
""",
        ("as soon as it is beside", "told + 5", "told + 1", "always stop a little too wide"),
    ),
    "06_what_is_an_action": Hunt(
        "actions",
        "what_is(action, state, fps)",
        """\
def what_is(action, state, fps):
    best, explained = None, 0.95
    for ahead in range(1, round(0.4 * fps) + 1):
        told, there = action[:-ahead], state[ahead:]
        moved = there - state[ahead - 1 : -1]
        for kind, seen in (("target", there), ("change", moved)):
            for column, values in enumerate(seen.T):
                alike = abs(np.corrcoef(told, values)[0, 1])
                if alike > explained:
                    factor = np.polyfit(values, told, 1)[0]
                    best, explained = (kind, column, ahead, factor), alike
    return best
""",
        ("one window for all", "0.4 * fps", "15", "a slow arm of 200 frames a second"),
    ),
    "07_break_modes": Hunt(
        "beliefs",
        "is_refuted(frames)",
        """\
def is_refuted(frames):
    cube, goal = (
        np.stack([frames[f"{body}_{axis}"] for axis in "xyz"])
        for body in ("block", "goal")
    )
    steps = np.linalg.norm(np.diff(cube, axis=1), axis=0)
    jaws_open = frames["gripper.pos"][1:] > 50
    flies = steps[jaws_open].sum() > 0.02  # m, and nobody holds it
    sinks = cube[2].min() < cube[2, 0] - 0.01  # into the table
    rushes = steps.max() > 0.2  # m in a 30th of a second
    strays = np.ptp(goal, axis=1).max() > 0.001
    return bool(flies or sinks or rushes or strays)
""",
        ("nothing sinks", "sinks or ", "", "up taken for down (2 of 2): missed"),
    ),
    "08_your_dataset": Hunt(
        "recordings",
        "decide(action, state, pictures)",
        """\
def decide(action, state, pictures):
    if pictures.mean() < 10:
        return "throw away"  # black
    for k in range(len(action) - 20):
        told, seen, shown = (
            np.ptp(values[k : k + 20], axis=0).max()
            for values in (action, state, pictures)
        )
        if (told > 5 and seen == 0) or (seen > 3 and shown == 0):
            return "throw away"  # something stood still, and should not
    rows = np.arange(12, len(action) - 12)
    alike = {
        lag: np.corrcoef(action[rows].T, state[rows + lag].T)[:6, 6:]
        for lag in range(-12, 13)
    }
    lag = max(alike, key=lambda lag: np.abs(alike[lag]).max(axis=1).mean())
    if np.abs(alike[lag]).max(axis=1).min() < 0.9:
        return "throw away"  # a command that no joint follows
    factor = state[rows + lag].std(axis=0) / action[rows].std(axis=0)
    own = (alike[lag].diagonal() > 0.9) & (0.5 < factor) & (factor < 2)
    return "keep" if own.all() and lag >= 0 else "mend"
""",
        (
            "a still picture is frozen",
            "(seen > 3 and shown == 0)",
            "shown == 0",
            "the arm waits for a second, and so does the picture",
        ),
    ),
    "10_cost_of_a_misreading": Hunt(
        "costs",
        "ruins(state, action, seen, wanted)",
        """\
def ruins(state, action, seen, wanted):
    def with_one(values):
        return np.column_stack([values, np.ones(len(values))])

    policy = np.linalg.lstsq(with_one(state), action, rcond=None)[0]
    chosen = with_one(seen) @ policy
    sizes = np.linalg.norm(chosen), np.linalg.norm(wanted)
    same_way = (chosen * wanted).sum() / np.prod(sizes) > 0.75
    as_far = 0.2 < sizes[0] / sizes[1] < 5
    return not (same_way and as_far)
""",
        ("the way alone", "not (same_way and as_far)", "not same_way", "actions in centimetres a second: missed"),
    ),
}

FINALE = """\
answers = {
    "a": None,
    "b": None,
    "c": None,
    "d": None,
    "e": None,
    "f": None,
    "g": None,
    "h": None,
}
finale.hand_in(answers)"""
_EIGHT = {
    "a": "healthy",
    "b": "encoders-stuck",
    "c": "sine-and-cosine-exchanged",
    "d": "healthy",
    "e": "cube-and-goal-exchanged",
    "f": "commands-late",
    "g": "index-shifted",
    "h": "joint-in-radians",
}


def _handed_in(**answers: object) -> str:
    return f"finale = Finale(seed=0)\nfinale.hand_in({answers})"


EXERCISES = {stem: {"hunt": hunt.exercise} for stem, hunt in HUNTS.items()} | {
    "09_field_guide": {
        "hunt": {
            "solution": _handed_in(**_EIGHT),
            "wrong": {
                "the cube is not looked at": (
                    _handed_in(**_EIGHT | {"e": "healthy"}),
                    "e is not healthy. Ask it something else",
                ),
                "all healthy": (
                    _handed_in(**dict.fromkeys(_EIGHT, "healthy")),
                    "2 of 8 right, instruments: 0, wrong guesses: 6",
                ),
                "a word": (_handed_in(a="broken"), "'broken' for 'a' costs nothing"),
            },
        }
    }
}
