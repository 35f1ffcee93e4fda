STEPS = """\
def longest_steps(x, y, episodes):
    steps = np.hypot(np.diff(x), np.diff(y))
    parts = zip(episodes.from_index, episodes.to_index, strict=True)
    return {}
practice.check_longest_steps(longest_steps)"""
PREDICT = "practice.predict_unnoticed(root, {})"

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
    "predict-unnoticed": {
        "solution": PREDICT.format('"degrees-for-radians"'),
        "wrong": {
            "a body elsewhere": (PREDICT.format('"wrong-reference-point"'), "it is degrees-for-radians"),
            "another frame": (PREDICT.format('"first-frame-for-last"'), "how good is good enough"),
            "of an arm, then": (PREDICT.format('"joints-exchanged"'), "Of the arm, which is not noticed"),
            "and wrong again": (PREDICT.format('"joints-exchanged", again="wrong-fps"'), "within what arms do"),
        },
    },
}
