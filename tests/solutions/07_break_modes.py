PREDICT = "practice.predict_drop_boundaries({})"
SWAP = "def swap(yaw):\n    return {}\npractice.check_swap(swap)"
SEEN = """\
def seen_from_block(pusher_x, pusher_y, x, y, yaw):
    dx, dy = pusher_x - x, pusher_y - y
    return {}
practice.check_seen_from_block(seen_from_block)"""

EXERCISES = {
    "predict-drop-boundaries": {
        "solution": PREDICT.format("217, 217, 1"),
        "wrong": {
            "all three reach it": (PREDICT.format("217, 217, 3"), "it is (217, 217, 1)"),
            "nothing changes": (PREDICT.format("217, 76, 3"), "all are in one episode"),
            "frames are lost": (PREDICT.format("76, 76, 1"), "No frame is lost"),
            "nothing is reached": (PREDICT.format("217, 217, 0"), "the last of all, which is on the target"),
            "the majority counts": (PREDICT.format("217, 217, 3, again=1"), "count for nothing"),
        },
        "again": (PREDICT.format("217, 217, 3, again=2"), PREDICT.format("217, 217, 3, again=0")),
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
