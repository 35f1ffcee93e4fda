OTHER = "practice.predict_other_robot({})"
MOVES = "def never_moves(values):\n    return {}\npractice.check_never_moves(never_moves)"
MEAN = "def column_mean(values, episodes):\n    return {}\npractice.check_column_mean(column_mean)"

EXERCISES = {
    "other-robot": {
        "solution": OTHER.format('"nothing"'),
        "wrong": {
            "as before": (OTHER.format('"6 of 6"'), "it is nothing"),
            "none reached": (OTHER.format('"0 of 6"'), "it does not guess"),
            "a number": (OTHER.format("0"), "you said 0"),
        },
    },
    "never-moves": {
        "solution": MOVES.format("values.min(axis=0) == values.max(axis=0)"),
        "wrong": {
            "first and last": (MOVES.format("values[0] == values[-1]"), "goes and comes back"),
            "one answer for all": (MOVES.format("values.min() == values.max()"), "One answer for each column"),
            "along the frames": (MOVES.format("values.min(axis=1) == values.max(axis=1)"), "One answer for"),
            "those that move": (MOVES.format("values.min(axis=0) < values.max(axis=0)"), "smallest value"),
            "a spread of zero": (MOVES.format("values.std(axis=0) == 0"), "a constant 0.1 in float32"),
            "those that are zero": (MOVES.format("values.max(axis=0) == 0"), "not yet"),
        },
    },
    "column-mean": {
        "solution": MEAN.format("values.mean()"),
        "wrong": {
            "the median": (MEAN.format("np.median(values)"), "x of the block"),
            "of the sums": (
                MEAN.format("np.mean([values[episodes[i]].sum() for i in range(len(episodes))])"),
                "Every frame counts once",
            ),
            "one episode": (MEAN.format("values[episodes[0]].mean()"), "expected"),
            "the example": (MEAN.format("values.sum() / 1000"), "x of the block"),
        },
    },
}
