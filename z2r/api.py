"""What does `import z2r` offer? Here the parts meet: a dataset, its reading, and the scene of the task.

Nothing below knows which tasks there are: a reading's scene is looked up here and handed down.
"""

import os
from concurrent.futures import Executor

from z2r.arrays import Progress, no_progress
from z2r.audits.audit import Audit, all_checks
from z2r.audits.audit import audit as _audit
from z2r.format.dataset import Dataset
from z2r.pusht.checks import PUSHT_CHECKS
from z2r.reading.breaks import BreakMode
from z2r.reading.reading import PUSHT, Reading
from z2r.reading.scene import SceneChecks

CHECKS: dict[str, str] = {check.name: check.asks for check in all_checks(PUSHT_CHECKS)}
"""What each check asks, by its name, in the order in which findings come. The names are stable."""


def audit(
    dataset: Dataset | str | os.PathLike[str],
    mode: BreakMode | None = None,
    reading: Reading = PUSHT,
    progress: Progress = no_progress,
    executor: Executor | None = None,
) -> Audit:
    """Look for everything that can be wrong with a dataset, in one pass over its files.

    Parameters
    ----------
    dataset : Dataset, str or path
        The dataset, or its folder: all of it is audited, as it is on disk. It is not written to, and nothing outside of
        it is read but the simulator's verdict beside it.
    mode : BreakMode, optional
        Audit what somebody believes who gets this assumption wrong. The dataset must be whole.
    reading : Reading, optional
        What the columns mean. Where the schema lacks its columns, the checks of the reading are left out.
    progress : callable, optional
        Called with the number of data files done and the number of all, after each.
    executor : Executor, optional
        Who reads the data files, such as a ``ProcessPoolExecutor``; at most four threads unless given.

    Returns
    -------
    Audit
        Memory is bounded by the data files in flight, one for each worker, and a few numbers for each episode.

    Raises
    ------
    DatasetError
        Only with a `mode`: if the dataset is not whole.

    Examples
    --------
    >>> import z2r
    >>> z2r.audit(z2r.STANDIN).findings
    ()
    >>> [finding.check for finding in z2r.audit(z2r.STANDIN, z2r.break_mode("yaw-swap-everywhere")).findings]
    ['overlap']
    """
    root = dataset.root if isinstance(dataset, Dataset) else dataset
    return _audit(root, mode, reading, scene_of(reading), progress, executor)


def scene_of(reading: Reading) -> SceneChecks | None:
    """Return what the task of a reading knows beyond its columns; None where no task is known."""
    return PUSHT_CHECKS if reading.names == PUSHT.names else None
