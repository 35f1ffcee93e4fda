PREDICT = "practice.predict_yaw_swap({})"
SWAP = "def swap(yaw):\n    return {}\npractice.check_swap(swap)"
SEEN = """\
def seen_from_block(pusher_x, pusher_y, x, y, yaw):
    dx, dy = pusher_x - x, pusher_y - y
    return {}
practice.check_seen_from_block(seen_from_block)"""

EXERCISES = {
    "predict-yaw-swap": {
        "solution": PREDICT.format("217, 76, 0"),
        "wrong": {
            "all as before": (PREDICT.format("217, 76, 3"), "it is (217, 76, 0)"),
            "frames are lost": (PREDICT.format("0, 76, 0"), "you said (0, 76, 0)"),
            "lengths change": (PREDICT.format("217, 67, 0"), "which the swap does not touch"),
            "one survives": (PREDICT.format("217, 76, 1"), "about 90 degrees"),
            "another question": (PREDICT.format("217, 76, 3"), "for the target as well"),
            "two swaps are worse": (PREDICT.format("217, 76, 3, again=0"), "the angle between them stays"),
        },
    },
    "swap": {
        "solution": SWAP.format("z2r.YawColumns(sin=yaw.cos, cos=yaw.sin)"),
        "wrong": {
            "nothing swapped": (SWAP.format("yaw"), "expected sin=cos_tee_yaw, cos=sin_tee_yaw"),
            "only one": (SWAP.format("z2r.YawColumns(sin=yaw.cos, cos=yaw.cos)"), "And the other one?"),
            "names of the example": (
                SWAP.format("z2r.YawColumns(sin='cos_tee_yaw', cos='sin_tee_yaw')"),
                "the yaw of the target",
            ),
            "changed in place": (SWAP.format("setattr(yaw, 'sin', yaw.cos)"), "raised AttributeError"),
            "the wrong type": (SWAP.format("(yaw.cos, yaw.sin)"), "for the yaw of the block"),
        },
    },
    "seen-from-block": {
        "solution": SEEN.format("np.cos(yaw) * dx + np.sin(yaw) * dy, np.cos(yaw) * dy - np.sin(yaw) * dx"),
        "wrong": {
            "half mended": (
                SEEN.format("np.cos(yaw) * dx + np.sin(yaw) * dy, np.sin(yaw) * dx + np.cos(yaw) * dy"),
                "Which way is back",
            ),
            "not turned": (SEEN.format("dx, dy"), "turned by 90 degrees, expected (0.1, -0.03) and got (0.03, 0.1)"),
            "swapped": (
                SEEN.format("np.sin(yaw) * dx + np.cos(yaw) * dy, np.sin(yaw) * dy - np.cos(yaw) * dx"),
                "expected",
            ),
            "one number": (SEEN.format("dx"), "not yet"),
        },
    },
}
