SAME = "practice.predict_same_rows({})"
TIME = "def sim_time(frame, fps):\n    return {}\npractice.check_sim_time(sim_time)"

EXERCISES = {
    "same-rows": {
        "solution": SAME.format('"position"'),
        "wrong": {
            "the yaw": (SAME.format('"yaw"'), "it is position"),
            "everything": (SAME.format('"both"'), "you said 'both'"),
            "nothing": (SAME.format('"neither"'), "does not touch x and y"),
            "a number": (SAME.format("1"), "you said 1"),
            "another word": (SAME.format("'x and y'"), "four answers: neither, yaw, position, both"),
        },
    },
    "sim-time": {
        "solution": TIME.format("frame / fps"),
        "wrong": {
            "ten is typed in": (TIME.format("frame / 10"), "frame 90 at 30"),
            "multiplied": (TIME.format("frame * fps"), "expected 6.7 and got 670"),
            "upside down": (TIME.format("fps / frame"), "expected 6.7"),
            "whole seconds": (TIME.format("frame // fps"), "got 6"),
            "frames count from 1": (TIME.format("(frame + 1) / fps"), "got 6.8"),
        },
    },
}
