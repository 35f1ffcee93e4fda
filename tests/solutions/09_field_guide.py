STEPS = """\
def longest_steps(x, y, episodes):
    steps = np.hypot(np.diff(x), np.diff(y))
    parts = zip(episodes.from_index, episodes.to_index, strict=True)
    return {}
practice.check_longest_steps(longest_steps)"""
MATCH = """\
def match(action, velocity, shift):
    later = {}
    return None if later is ... else np.corrcoef(later, velocity[: len(later)])[0, 1]
practice.check_match(match)"""
DIAGNOSIS = 'practice.check_diagnosis("{}", {!r})'

EXERCISES = {
    "longest-steps": {
        "solution": STEPS.format("[steps[start:stop - 1].max() for start, stop in parts]"),
        "wrong": {
            "the other end moved": (STEPS.format("[steps[start + 1:stop].max() for start, stop in parts]"), "lead out"),
            "two steps fewer": (STEPS.format("[steps[start:stop - 2].max() for start, stop in parts]"), "not yet"),
            "the leaps cut off": (
                STEPS.format("[min(steps[start:stop].max(), 0.042) for start, stop in parts]"),
                "for the episodes of messy",
            ),
            "the shortest": (STEPS.format("[steps[start:stop - 1].min() for start, stop in parts]"), "expected"),
            "one number": (STEPS.format("steps.max()"), "for the episodes of messy"),
        },
    },
    "match": {
        "solution": MATCH.format("action[shift:shift + len(velocity)]"),
        "wrong": {
            "not cut": (MATCH.format("action[shift:]"), "raised ValueError"),
            "not shifted": (MATCH.format("action[:len(velocity) - shift]"), "one frame later"),
            "the other way": (MATCH.format("action[:-1 - shift]"), "one frame later"),
            "always one": (MATCH.format("action[1:]"), "no frame later"),
        },
    },
    "dataset-a": {
        "solution": DIAGNOSIS.format("a", "ranges-one-frame-late"),
        "wrong": {
            "files mixed up": (DIAGNOSIS.format("a", "files-in-wrong-order"), "anywhere inside"),
            "merged": (DIAGNOSIS.format("a", "two-episodes-merged"), "twice as long"),
            "no suspect": (DIAGNOSIS.format("a", "broken"), "none of the suspects"),
        },
    },
    "dataset-b": {
        "solution": DIAGNOSIS.format("b", "sine-and-cosine-swapped"),
        "wrong": {
            "units": (DIAGNOSIS.format("b", "positions-in-millimetres"), "hundreds of metres"),
            "time": (DIAGNOSIS.format("b", "fps-three-times-too-high"), "three times as fast"),
            "a number": (DIAGNOSIS.format("b", 3), "none of the suspects"),
        },
    },
    "dataset-c": {
        "solution": DIAGNOSIS.format("c", "actions-one-frame-late"),
        "wrong": {
            "the other way": (DIAGNOSIS.format("c", "actions-one-frame-early"), "one frame earlier"),
            "time": (DIAGNOSIS.format("c", "fps-three-times-too-high"), "Do the cells above show it?"),
            "index": (DIAGNOSIS.format("c", "ranges-one-frame-late"), "a leap at its end"),
        },
    },
}
