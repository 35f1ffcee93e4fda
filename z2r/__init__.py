"""Seeing Like a Robot: read a LeRobot v3 dataset before you train on it.

>>> import z2r
>>> dataset = z2r.load(z2r.STANDIN)
>>> dataset.read("observation.state")[dataset.episodes[0]].shape[1]
10

The public names are listed in ``__init__.pyi`` and loaded when they are used: `import z2r` costs next to nothing, and
nobody who only reads pays for rerun, MuJoCo or LeRobot.
"""

from typing import Any

import lazy_loader

_load, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib.metadata import version

        return version("z2r")
    return _load(name)
