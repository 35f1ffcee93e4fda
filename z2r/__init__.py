"""Seeing Like a Robot: read a LeRobot v3 dataset before you train on it.

>>> import z2r
>>> dataset = z2r.load(z2r.STANDIN)
>>> dataset.read("observation.state")[dataset.episodes[0]].shape[1]
10

The public names are listed in ``__init__.pyi`` and loaded when they are used: `import z2r` costs next to nothing, and
nobody who only reads pays for rerun, MuJoCo or LeRobot.
"""

import lazy_loader

__getattr__, __dir__, __all__ = lazy_loader.attach_stub(__name__, __file__)
