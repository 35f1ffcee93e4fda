_NUMBERS = """\
prediction = {}
practice.check_numbers_in_a_frame(prediction)
"""

_VALUES_OF = """\
def values_of(state, schema, name):
    {}
practice.check_values_of(values_of)
"""

_BLOCK_POSITION = """\
def block_position(state, schema):
    {}
practice.check_block_position(block_position)
"""

EXERCISES = {
    "numbers-in-a-frame": {
        "solution": _NUMBERS.format(17),
        "wrong": {
            "features counted, not numbers": (_NUMBERS.format(7), "you said 7, it is 17"),
            "the bookkeeping forgotten": (_NUMBERS.format(12), "5 of the bookkeeping"),
            "the observation alone": (_NUMBERS.format(10), "2 of the action"),
        },
        "again": (
            "practice.check_numbers_in_a_frame(7, again=18)",
            "practice.check_numbers_in_a_frame(7, again=23)",
        ),
    },
    "values-of": {
        "solution": _VALUES_OF.format('return state[:, schema.columns("observation.state", [name])[0]]'),
        "wrong": {
            "a position that is right here alone": (_VALUES_OF.format("return state[:, 2]"), "in another order"),
            "the names of this page's dataset": (
                _VALUES_OF.format("return state[:, names.index(name)]"),
                "in another order",
            ),
            "a list of one position": (
                _VALUES_OF.format('return state[:, schema.columns("observation.state", [name])]'),
                "`columns` returns a list",
            ),
            "a row in place of a column": (
                _VALUES_OF.format('return state[schema.columns("observation.state", [name])[0]]'),
                "tee_x of this dataset, expected",
            ),
            "the array asked for a name": (_VALUES_OF.format("return state[name]"), "your function raised IndexError"),
        },
    },
    "block-position": {
        "solution": _BLOCK_POSITION.format(
            'return state[:, schema.columns("observation.state", ["tee_x", "tee_y"])]',
        ),
        "wrong": {
            "positions that are right here alone": (_BLOCK_POSITION.format("return state[:, 2:4]"), "in another order"),
            "the pusher in place of the block": (
                _BLOCK_POSITION.format(
                    'return state[:, schema.columns("observation.state", ["pusher_x", "pusher_y"])]'
                ),
                "the block in this dataset",
            ),
            "y before x": (
                _BLOCK_POSITION.format('return state[:, schema.columns("observation.state", ["tee_y", "tee_x"])]'),
                "Which names belong",
            ),
            "a name that is not there": (
                _BLOCK_POSITION.format('return state[:, schema.columns("observation.state", ["x", "y"])]'),
                "no dimension 'x'",
            ),
        },
    },
}
