SWAP = "prediction = {}\npractice.check_swap(prediction)\n"
DECODE = "def decode(sin_yaw, cos_yaw):\n    return {}\npractice.check_decode(decode)\n"
TURN = "def apart(before, after):\n    {}\npractice.check_turn(apart)\n"
QUATERNION = "def quaternion(yaw):\n    return 0, 0, {z}, {w}\npractice.check_quaternion(quaternion)"
W_FIRST = QUATERNION.replace("0, 0, {z}, {w}", "np.cos(yaw / 2), 0, 0, np.sin(yaw / 2)")

EXERCISES = {
    "swap": {
        "solution": SWAP.format("-30"),
        "wrong": {
            "a turn by 90 degrees": (SWAP.format("210"), "you said 210, it is -30.0"),
            "a whole turn too much": (SWAP.format("330"), "right direction, but write it between -180 and 180"),
            "a turn the other way": (SWAP.format("30"), "The swap makes 90 - yaw"),
            "no change": (SWAP.format("120"), "you said 120"),
            "no number": (SWAP.format("'mirrored'"), "you said 'mirrored'"),
        },
        "again": ("practice.check_swap(210, again=45)", "practice.check_swap(210, again=-135)"),
    },
    "decode": {
        "solution": DECODE.format("math.atan2(sin_yaw, cos_yaw)"),
        "wrong": {
            "swapped arguments": (
                DECODE.format("math.atan2(cos_yaw, sin_yaw)"),
                "for a yaw of 30 degrees, expected 0.5236 and got 1.047",
            ),
            "the sine alone": (DECODE.format("math.asin(sin_yaw)"), "for a yaw of 150 degrees"),
            "the cosine alone": (DECODE.format("math.acos(cos_yaw)"), "for a yaw of -60 degrees"),
            "a quotient": (DECODE.format("math.atan(sin_yaw / cos_yaw)"), "loses half of the circle"),
            "degrees": (DECODE.format("math.degrees(math.atan2(sin_yaw, cos_yaw))"), "That looks like degrees"),
            "no angle": (DECODE.format("(sin_yaw, cos_yaw)"), "which of the two does atan2 want first?"),
        },
    },
    "turn": {
        "solution": TURN.format("return abs(z2r.wrap_angle(after - before))"),
        "wrong": {
            "nothing wrapped, degrees": (TURN.format("return abs(math.degrees(after - before))"), "10 and 40 degrees"),
            "the sign is left": (TURN.format("return z2r.wrap_angle(after - before)"), "never negative"),
            "wrapped after abs": (TURN.format("return z2r.wrap_angle(abs(after - before))"), "wrap first, then abs"),
            "a whole turn too far": (TURN.format("return (after - before) % (2 * math.pi)"), "60 and -50 degrees"),
            "only one direction mended": (
                TURN.format("return min(abs(after - before), abs(after - before + 2 * math.pi))"),
                "-170 and 170 degrees",
            ),
            "nothing wrapped": (TURN.format("return abs(after - before)"), "179 and -179 degrees"),
            "a typing error": (TURN.format("return abs(wrap(after - before))"), "raised NameError"),
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
