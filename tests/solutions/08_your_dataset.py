PREDICT = "practice.predict_reached({})"
MOVES = "def never_moves(values):\n    return {}\npractice.check_never_moves(never_moves)"
AHEAD = """\
def frames_ahead(action, state):
    tried = {}
    shares = [share(action, state, ahead) for ahead in tried]
    return {}
practice.check_frames_ahead(frames_ahead)"""
SANE = "def is_sane(action, state):\n    return {}\npractice.check_is_sane(is_sane)"

EXERCISES = {
    "predict-reached": {
        "solution": PREDICT.format('"nothing"'),
        "wrong": {
            "all": (PREDICT.format('"13 of 13"'), "Nobody has said yet"),
            "none": (PREDICT.format('"0 of 13"'), "worse than no number"),
            "a number": (PREDICT.format("0"), "you said 0"),
            "wrong again": (PREDICT.format('"13 of 13", again="6 of 6"'), "it does not guess"),
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
    "frames-ahead": {
        "solution": AHEAD.format("range(-9, 10)", "tried[np.argmax(shares)]"),
        "wrong": {
            "only before": (AHEAD.format("range(-9, 0)", "tried[np.argmax(shares)]"), "for the elbow of arm"),
            "its place in the list": (AHEAD.format("range(-9, 10)", "np.argmax(shares)"), "or its place in the list"),
            "without its sign": (AHEAD.format("range(-9, 10)", "abs(tried[np.argmax(shares)])"), "five frames late"),
            "the worst": (AHEAD.format("range(-9, 10)", "tried[np.argmin(shares)]"), "Which numbers of frames"),
            "too few": (AHEAD.format("range(-1, 4)", "tried[np.argmax(shares)]"), "comes after the motion"),
        },
    },
    "is-sane": {
        "solution": SANE.format("np.abs(action[:-2, :5] - state[2:, :5]).max() < 9"),
        "wrong": {
            "all is well": (SANE.format("True"), "6 of 6 damaged ones pass"),
            "nothing is": (SANE.format("False"), "6 false alarms"),
            "the gripper too": (SANE.format("np.abs(action[:-2] - state[2:]).max() < 9"), "false alarms in 6 good"),
            "too strict": (SANE.format("np.abs(action[:-2, :5] - state[2:, :5]).max() < 3"), "false alarms in 6 good"),
            "a range": (SANE.format("np.abs(state).max() < 180"), "commands five frames late"),
            "a correlation": (
                SANE.format("all(np.corrcoef(action[:, j], state[:, j])[0, 1] > 0.9 for j in range(5))"),
                "a follower 17 degrees",
            ),
            "an answer for each frame": (SANE.format("np.abs(action - state) < 20"), "for the whole episode"),
            "an error": (SANE.format("action[999] > 0"), "raised IndexError"),
        },
    },
}
