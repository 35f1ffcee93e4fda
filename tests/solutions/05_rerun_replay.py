SAME = "practice.predict_same_rows({})"
TIME = "def sim_time(frame, fps):\n    return {}\npractice.check_sim_time(sim_time)"
FILM = "def video_time(frame_index, from_timestamp, fps):\n    return {}\npractice.check_video_time(video_time)"

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
        "again": (
            "practice.predict_same_rows('yaw', again='position')",
            "practice.predict_same_rows('yaw', again='both')",
        ),
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
    "video-time": {
        "solution": FILM.format("from_timestamp + frame_index / fps"),
        "wrong": {
            "the start alone": (FILM.format("from_timestamp"), "frame 100 of episode 1"),
            "thirty is typed in": (FILM.format("from_timestamp + frame_index / 30"), "at 15 frames a second"),
            "the start in frames": (FILM.format("(from_timestamp + frame_index) / fps"), "frame 0 of episode 1"),
            "taken away": (FILM.format("frame_index / fps - from_timestamp"), "expected 4.3 and got -4.3"),
        },
    },
}
