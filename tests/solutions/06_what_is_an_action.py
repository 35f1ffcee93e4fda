PREDICT = "practice.predict_a_second({})"
WITHIN = """\
def within(asked, seen):
    slope, offset = np.polyfit(seen, asked, 1)
    off = {}
    return None if off is ... else np.quantile(off, 0.99)
practice.check_within(within)"""
DRIVEN = """\
def driven_column(action, state):
    likeness = [np.corrcoef(action, column)[0, 1] for column in state.T]
    return {}
practice.check_driven_column(driven_column)"""

EXERCISES = {
    "predict-a-second": {
        "solution": PREDICT.format("0.996, 1.04"),
        "wrong": {
            "all times ten": (PREDICT.format("9.96, 104.5"), "moves no dot off the line"),
            "a slope ten times as large": (PREDICT.format("0.996, 104.5"), "slope ten times as small"),
            "as before": (PREDICT.format("0.996, 10.4"), "you said (0.996, 10.4)"),
            "less explained": (PREDICT.format("0.0996, 1.04"), "as much is explained as before"),
            "another question": (PREDICT.format("0.996, 10.4"), "counted in a minute"),
            "and wrong again": (PREDICT.format("0.996, 10.4, again=62.4"), "it is 0.0174"),
        },
    },
    "within": {
        "solution": WITHIN.format("abs(asked - (slope * seen + offset))"),
        "wrong": {
            "with its sign": (WITHIN.format("asked - (slope * seen + offset)"), "without its sign"),
            "no offset": (WITHIN.format("abs(asked - slope * seen)"), "What does the line say"),
            "no line": (WITHIN.format("abs(asked - seen)"), "the elbow of arm"),
            "the other way round": (WITHIN.format("abs(seen - (slope * asked + offset))"), "not yet"),
            "squared": (WITHIN.format("(asked - (slope * seen + offset)) ** 2"), "expected"),
        },
    },
    "driven-column": {
        "solution": DRIVEN.format("np.argmax(np.abs(likeness))"),
        "wrong": {
            "the least": (DRIVEN.format("np.argmin(likeness)"), "for the elbow of arm"),
            "the least of all": (DRIVEN.format("np.argmin(np.abs(likeness))"), "expected 2"),
            "the number itself": (DRIVEN.format("max(likeness, key=abs)"), "for the elbow of arm"),
            "always the elbow": (DRIVEN.format("2"), "its gripper"),
        },
    },
}
