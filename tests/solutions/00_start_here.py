RATE = "def share_reached(reached):\n    return {}\npractice.check_share_reached(share_reached)"

EXERCISES = {
    "yaw-swap": {
        "solution": "practice.check_yaw_swap(0)",
        "wrong": {
            "nothing changes": ("practice.check_yaw_swap(3)", "it is 0"),
            "one survives": ("practice.check_yaw_swap(1)", "you said 1"),
            "a word": ("practice.check_yaw_swap('none')", "you said 'none'"),
            "a number in quotes": ("practice.check_yaw_swap('0')", "Write the number without the quotes"),
        },
        "again": ("practice.check_yaw_swap(3, again=0)", "practice.check_yaw_swap(3, again=3)"),
    },
    "share-reached": {
        "solution": RATE.format("sum(reached) / len(reached)"),
        "wrong": {
            "the count": (RATE.format("sum(reached)"), "expected 1 and got 6"),
            "in percent": (RATE.format("100 * sum(reached) / len(reached)"), "expected 1 and got 100"),
            "a constant of the example": (RATE.format("1.0"), "of which one reached it"),
            "the reading at hand": (RATE.format("outcome.reached.mean()"), "the same in all 3 trials"),
            "it raises": (RATE.format("reached.rate"), "raised AttributeError"),
        },
    },
}
