ERRORS = """\
def my_frame_errors(frame):
    dx = frame["{0}_x"] - frame["{1}_x"]
    dy = frame["{0}_y"] - frame["{2}_y"]
    tee_yaw = z2r.decode_yaw(frame["sin_tee_yaw"], frame["cos_tee_yaw"])
    target_yaw = z2r.decode_yaw(frame["sin_target_yaw"], frame["cos_target_yaw"])
    return {3}
practice.check_frame_errors(my_frame_errors)
"""
MENDED = """\
def my_frame_errors(frame):
    tee_yaw = z2r.decode_yaw(frame["sin_tee_yaw"], frame["cos_tee_yaw"])
    target_yaw = z2r.decode_yaw(frame["sin_target_yaw"], frame["cos_target_yaw"])
    ang_err = abs(z2r.wrap_angle(tee_yaw - target_yaw))
    return math.hypot(frame["tee_x"] - frame["target_x"], frame["tee_y"] - frame["target_y"]), ang_err
practice.check_frame_errors(my_frame_errors)
"""
BOTH = "math.hypot(dx, dy), abs(z2r.wrap_angle(tee_yaw - target_yaw))"
REACHED = (
    "def my_episode_reached(pos_err, ang_err):\n    return {}\npractice.check_episode_reached(my_episode_reached)\n"
)
GOAL = "def my_goal():\n    return {}\npractice.check_arm_goal(my_goal, poses)\n"
DISTANCE = GOAL.format('z2r.Goal(name="apart", distance=("cube", "goal"), within={})')
LOOSER = "prediction = {}\npractice.check_looser(prediction)\n"

EXERCISES = {
    "frame-errors": {
        "solution": MENDED,
        "wrong": {
            "from the pusher to the target": (
                ERRORS.format("pusher", "target", "target", BOTH),
                "the first frame of episode 0 of standin, expected (0.1179, 2.884) and got (0.4205, 2.884)",
            ),
            "only x mended": (ERRORS.format("tee", "target", "pusher", BOTH), "From where to where"),
            "a target at the origin": (
                "def my_frame_errors(frame):\n"
                "    yaw = z2r.decode_yaw(frame['sin_tee_yaw'], frame['cos_tee_yaw'])\n"
                "    return math.hypot(frame['tee_x'], frame['tee_y']), abs(yaw)\n"
                "practice.check_frame_errors(my_frame_errors)\n",
                "the first frame of episode 0 with another target",
            ),
            "no wrap": (
                ERRORS.format("tee", "target", "target", "math.hypot(dx, dy), abs(tee_yaw - target_yaw)"),
                "a difference of two angles",
            ),
            "one error": (ERRORS.format("tee", "target", "target", "math.hypot(dx, dy)"), "raised TypeError"),
        },
    },
    "episode-reached": {
        "solution": REACHED.format("pos_err[-1] < task.POS_TOL and ang_err[-1] < task.ANG_TOL"),
        "wrong": {
            "the position alone": (REACHED.format("pos_err[-1] < task.POS_TOL"), "with ang_err larger by 0.4 rad"),
            "the angle alone": (REACHED.format("ang_err[-1] < task.ANG_TOL"), "episode 2 of messy"),
            "the first frame": (
                REACHED.format("bool(pos_err[0] < task.POS_TOL and ang_err[0] < task.ANG_TOL)"),
                "for episode 0 of standin, expected True and got False",
            ),
            "any frame": (
                REACHED.format("bool(((pos_err < task.POS_TOL) & (ang_err < task.ANG_TOL)).any())"),
                "played backwards",
            ),
            "held for five stored frames": (
                REACHED.format("bool((pos_err[-5:] < task.POS_TOL).all() and (ang_err[-5:] < task.ANG_TOL).all())"),
                "for episode 0 of standin, expected True and got False",
            ),
            "one of the two": (
                REACHED.format("pos_err[-1] < task.POS_TOL or ang_err[-1] < task.ANG_TOL"),
                "for episode 2 of messy, expected False and got True",
            ),
            "every frame": (
                REACHED.format("(pos_err < task.POS_TOL) & (ang_err < task.ANG_TOL)"),
                "expected True and got 67 values",
            ),
        },
    },
    "looser": {
        "solution": LOOSER.format("13"),
        "wrong": {
            "no change": (LOOSER.format("11"), "you said 11, it is 13"),
            "one more": (LOOSER.format("12"), "a count belongs to its tolerances"),
            "all of them": (LOOSER.format("14"), "you said 14"),
        },
        "again": ("practice.check_looser(11, again=11)", "practice.check_looser(11, again=4)"),
    },
    "arm-goal": {
        "solution": DISTANCE.format("0.03"),
        "wrong": {
            "too far": (DISTANCE.format("0.05"), "by your goal, episode 11 reached it without success"),
            "too near": (DISTANCE.format("0.01"), "did not reach it, and were a success"),
            "the height alone": (
                GOAL.format('z2r.Goal(name="z", value="block_z", at_least=0.1)'),
                "0, 1, 2, 3, 5, 6, 7 did not reach it",
            ),
            "the joints alone": (
                GOAL.format('z2r.Goal(name="grip", value="observation.state/gripper.pos", at_least=25)'),
                "4, 11 reached it without success",
            ),
            "a column that is elsewhere": (
                GOAL.format('z2r.Goal(name="grip", value="gripper.pos", at_least=25)'),
                "found no column gripper.pos",
            ),
            "no limit": (GOAL.format('z2r.Goal(name="apart", distance=("cube", "goal"))'), "found no limit"),
            "a pose itself": (
                GOAL.format('z2r.Goal(name="apart", distance=(poses["cube"], poses["goal"]), within=0.03)'),
                "expected its name in quotes: cube or goal",
            ),
            "a pose that is not there": (
                GOAL.format('z2r.Goal(name="apart", distance=("block", "goal"), within=0.03)'),
                "found block in goal apart",
            ),
            "a number": (GOAL.format("0.03"), "expected a z2r.Goal"),
        },
    },
}
