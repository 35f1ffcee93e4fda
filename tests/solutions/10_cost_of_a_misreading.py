REPLAY = "practice.predict_replay({}, {})"
ORDER = "practice.check_order({}, six)"
AGAIN = "practice.check_order({}, four)"
INTERVAL = """\
def my_interval(one, other, rng):
    differences = []
    for _ in range(1000):
        drawn = rng.integers(len(one), size=len(one))
        differences.append({})
    return np.quantile(differences, {})
practice.check_interval(my_interval)
"""
BOTH, ENDS = "one[drawn].mean() - other[drawn].mean()", "(0.025, 0.975)"
CHEAP_TO_COSTLY = ["drop-boundaries", "late-2", "yaw-swap-throughout", "fps-30-at-rollout", "late-5", "exchanged"]
SCALE, VELOCITY = "scale-eightfold-{}", "velocity-by-{}-fps"
CONSISTENT_FIRST = [SCALE.format("throughout"), VELOCITY.format(10), VELOCITY.format(30), SCALE.format("at-rollout")]


def moved(rows: list[str], row: str, to: int) -> list[str]:
    others = [each for each in rows if each != row]
    return [*others[:to], row, *others[to:]]


EXERCISES = {
    "predict-replay": {
        "solution": REPLAY.format(0, 6),
        "wrong": {
            "late ruins it": (REPLAY.format(0, 0), "a block that nobody touches waits"),
            "both are harmless": (REPLAY.format(6, 6), "it is 0 of 6 and 6 of 6"),
            "the other way round": (REPLAY.format(6, 0), "you said '6 of 6 and 0 of 6'"),
        },
        "again": (REPLAY.format(0, "0, again=6"), REPLAY.format(0, "0, again=0")),
    },
    "order": {
        "solution": ORDER.format(CHEAP_TO_COSTLY),
        "wrong": {
            "costly to cheap": (ORDER.format(CHEAP_TO_COSTLY[::-1]), "than drop-boundaries, and it is costlier"),
            "boundaries are costly": (
                ORDER.format(moved(CHEAP_TO_COSTLY, "drop-boundaries", 5)),
                "as cheaper than drop-boundaries",
            ),
            "late by five is cheap": (
                ORDER.format(moved(CHEAP_TO_COSTLY, "late-5", 0)),
                "you have late-5 as cheaper than",
            ),
            "one forgotten": (ORDER.format(CHEAP_TO_COSTLY[1:]), "'drop-boundaries' is missing"),
            "one twice": (ORDER.format([*CHEAP_TO_COSTLY, "late-2"]), "a name stands twice"),
            "another name": (ORDER.format(["late"]), "'late' is none of the 6 names"),
            "one name": (ORDER.format("'late-5'"), "is missing"),
        },
    },
    "order-again": {
        "solution": AGAIN.format(CONSISTENT_FIRST),
        "wrong": {
            "wrong twice is worse": (
                AGAIN.format(moved(CONSISTENT_FIRST, SCALE.format("throughout"), 3)),
                "as cheaper than scale-eightfold-throughout",
            ),
            "the faster clock": (
                AGAIN.format(moved(CONSISTENT_FIRST, VELOCITY.format(10), 3)),
                "as cheaper than velocity-by-10-fps",
            ),
            "names of the other list": (AGAIN.format("six"), "'exchanged' is none of the 4 names"),
        },
    },
    "interval": {
        "solution": INTERVAL.format(BOTH, ENDS),
        "wrong": {
            "one of them not drawn": (INTERVAL.format("one[drawn].mean() - other.mean()", ENDS), "a policy and itself"),
            "the other way round": (
                INTERVAL.format("other[drawn].mean() - one[drawn].mean()", ENDS),
                "Which of the two rates is taken from which?",
            ),
            "half as wide": (INTERVAL.format(BOTH, "(0.25, 0.75)"), "for early-1 and right"),
            "one end": (INTERVAL.format(BOTH, "0.975"), "for a policy and itself"),
            "not drawn at all": (INTERVAL.format("one.mean() - other.mean()", ENDS), "for early-1 and right"),
            "an error": (INTERVAL.format("one[again].mean()", ENDS), "raised NameError"),
        },
    },
}
