SAME = "practice.predict_same_rows({})"
TIME = "def sim_time(frame, fps):\n    return {}\npractice.check_sim_time(sim_time)"
QUATERNION = "def quaternion(yaw):\n    return 0, 0, {z}, {w}\npractice.check_quaternion(quaternion)"
W_FIRST = QUATERNION.replace("0, 0, {z}, {w}", "np.cos(yaw / 2), 0, 0, np.sin(yaw / 2)")

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
    "quaternion": {
        "solution": QUATERNION.format(z="np.sin(yaw / 2)", w="np.cos(yaw / 2)"),
        "wrong": {
            "half of one": (QUATERNION.format(z="np.sin(yaw / 2)", w="np.cos(yaw)"), "a yaw of 60 degrees"),
            "twice": (QUATERNION.format(z="np.sin(yaw * 2)", w="np.cos(yaw * 2)"), "Of which angle"),
            "swapped": (
                QUATERNION.format(z="np.cos(yaw / 2)", w="np.sin(yaw / 2)"),
                "expected (0, 0, 0.5, 0.866)",
            ),
            "half of the sine": (
                QUATERNION.format(z="np.sin(yaw) / 2", w="np.cos(yaw) / 2"),
                "got (0, 0, 0.433, 0.25)",
            ),
            "w first": (W_FIRST, "The order is x, y, z, w"),
            "in degrees": (QUATERNION.format(z="np.rad2deg(yaw)", w="0"), "not yet"),
        },
    },
}
