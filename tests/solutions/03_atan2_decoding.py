SWAP = "prediction = {}\npractice.check_swap(prediction)\n"
DECODE = "def decode(sin_yaw, cos_yaw):\n    return {}\npractice.check_decode(decode)\n"
TURN = "def apart(before, after):\n    {}\npractice.check_turn(apart)\n"

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
}
