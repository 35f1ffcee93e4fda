"""What are the dimensions of a feature called? Their names, in all the shapes in which people write them.

LeRobot itself writes a list, and a table of name to place for its gamepad and its keyboard (lerobot 0.6.1,
`lerobot/teleoperators/gamepad/teleop_gamepad.py`); converters group them by limb, or nest one list in another:

    ["x", "y", "grip"]                        {"motors": ["x", "y", "grip"]}
    {"x": 0, "y": 1, "grip": 2}               {"arm": ["x", "y"], "hand": ["grip"]}
    [["x", "y"], ["grip"]]
"""

import math
from collections import Counter, defaultdict
from collections.abc import Iterator, Sequence
from itertools import islice
from typing import Any

_MAX_DEPTH = 4  # of groups within groups: nobody has more, and a file may nest without end


def names_of(names: Any, shape: Sequence[int]) -> tuple[str, ...]:
    """Return the name of each dimension; empty where there is not one for each.

    Parameters
    ----------
    names : object
        What `meta/info.json` gives.
    shape : sequence of int
        The shape of one frame's value. Several groups name the dimensions only where it is a vector: of a picture,
        they may name the rows and the columns.

    Examples
    --------
    >>> names_of({"delta_y": 1, "delta_x": 0}, (2,))
    ('delta_x', 'delta_y')
    >>> names_of({"left": ["x", "grip"], "right": ["x"]}, (3,))
    ('left.x', 'grip', 'right.x')
    """
    if len(shape) > 1 and isinstance(names, dict) and len(names) > 1:
        return ()
    size = math.prod(shape)
    if _has_more_than(names, size):
        return ()
    flat = in_a_row(names, size + 1)
    return flat if len(flat) == size and all(isinstance(name, str) for name in flat) else ()


def in_a_row(names: Any, most: int | None = None) -> tuple[Any, ...]:
    """Return the names one after another, those that several groups have behind their group; what is no text stays.

    Parameters
    ----------
    names : object
        What `meta/info.json` gives.
    most : int, optional
        How many to return; all unless given.

    Examples
    --------
    >>> in_a_row([["x"], [7]])
    ('x', 7)
    """
    if names is None:
        return ()
    leaves = list(islice(_leaves(names, "", _MAX_DEPTH), most))
    groups = defaultdict(set)
    for group, name in leaves:
        groups[str(name)].add(group)
    return tuple(f"{group}.{name}" if group and len(groups[str(name)]) > 1 else name for group, name in leaves)


def repeated(names: Sequence[Any]) -> tuple[str, ...]:
    """Return the names that come more than once.

    >>> repeated(["x", "y", "x"])
    ('x',)
    """
    return tuple(name for name, times in Counter(map(str, names)).items() if times > 1)


def _has_more_than(names: Any, size: int) -> bool:
    """Tell quickly of most that are too many: a file may name a million, and the names are asked for often."""
    groups = names.values() if isinstance(names, dict) else names if isinstance(names, list | tuple) else ()
    return len(groups) > size or sum(len(each) for each in groups if isinstance(each, dict | list | tuple)) > size


def _leaves(names: Any, group: str, depth: int) -> Iterator[tuple[str, Any]]:
    """Yield each name with the group that it is in."""
    if not depth or not isinstance(names, dict | list | tuple):
        yield group, names
    elif isinstance(names, dict) and _are_places(names):
        yield from ((group, name) for name in sorted(names, key=names.__getitem__))
    else:
        inner = names.items() if isinstance(names, dict) else ((group, each) for each in names)
        for its_group, each in inner:
            yield from _leaves(each, its_group, depth - 1)


def _are_places(names: dict[str, Any]) -> bool:
    places = list(names.values())
    return all(type(place) is int for place in places) and sorted(places) == list(range(len(places)))
