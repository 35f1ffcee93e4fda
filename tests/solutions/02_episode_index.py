_LENGTH = """\
def episode_length(from_index, to_index):
    return {}
practice.check_episode_length(episode_length)
"""

_WITHOUT = """\
prediction = {}
practice.check_without_index(prediction, messy)
"""

_CUT = """\
def cut(frames, index, episode):
    start, stop = index.from_index[episode], index.to_index[episode]
    return {}
practice.check_cut(cut)
"""

EXERCISES = {
    "episode-length": {
        "solution": _LENGTH.format("to_index - from_index"),
        "wrong": {
            "both ends counted": (_LENGTH.format("to_index - from_index + 1"), "expected 74 and got 75"),
            "one frame short": (_LENGTH.format("to_index - from_index - 1"), "expected 74 and got 73"),
            "the wrong way round": (_LENGTH.format("from_index - to_index"), "got -74"),
            "right for one range alone": (_LENGTH.format("len(range(from_index, to_index))"), "all ranges of messy"),
        },
    },
    "without-the-index": {
        "solution": _WITHOUT.format("(1, 1.0)"),
        "wrong": {
            "as with the index": (_WITHOUT.format("(14, 0.79)"), "it is (1, 1.0)"),
            "one episode with the rate of all": (_WITHOUT.format("(1, 0.79)"), "only the last frame"),
            "one episode that fails": (_WITHOUT.format("(1, 0)"), "11 of 14"),
            "one number": (_WITHOUT.format("1"), "two numbers are needed"),
        },
        "again": (
            "practice.check_without_index((14, 0.79), messy, again=(1, 0.95))",
            "practice.check_without_index((14, 0.79), messy, again=(1, 0))",
        ),
    },
    "cut": {
        "solution": _CUT.format("frames[start:stop]"),
        "wrong": {
            "the other end moved": (_CUT.format("frames[start + 1 : stop + 1]"), "139 140 141]"),
            "one frame short": (_CUT.format("frames[start : stop - 1]"), "One frame too few"),
            "the last one dropped, which the last episode does not have": (
                _CUT.format("frames[start : stop + 1][:-1]"),
                "the frames of episode 5",
            ),
            "to the end of the dataset": (_CUT.format("frames[start:]"), "424 425 426]"),
            "nothing": (_CUT.format("frames[stop:start]"), "got ()"),
        },
    },
}
