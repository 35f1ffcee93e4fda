"""Who runs it on many machines? A Ray cluster, as an executor like any other.

Reading a dataset is a fold over its files, and any `concurrent.futures.Executor` runs it: threads and processes, and
those that come with other engines, such as ``Client.get_executor()`` of Dask and ``MPIPoolExecutor`` of
``mpi4py.futures``. Ray has none, so here is one. What comes out is the same, byte for byte, whoever runs it.
"""

import contextlib
import logging
import os
import socket
from collections.abc import Callable
from concurrent.futures import Executor, Future
from pathlib import Path
from typing import Any

from z2r.errors import DatasetError, Fault, MissingExtraError

_PATIENCE = 10.0  # s


class RayExecutor(Executor):
    """Runs calls as tasks of a Ray cluster, on which z2r is installed. A task whose worker is lost runs again.

    Parameters
    ----------
    address : str
        Such as ``ray://host:10001``; or ``local``, for a cluster of this machine alone, which ends with the executor.

    Raises
    ------
    MissingExtraError
        If Ray is not installed.
    DatasetError
        If no cluster answers there.
    """

    def __init__(self, address: str = "local") -> None:
        try:
            import ray
        except ImportError:
            raise MissingExtraError("a cluster needs Ray. In a clone of the course: pip install '.[ray]'") from None
        self._ray, self._is_own = ray, not ray.is_initialized()
        try:
            _knock(address)
            ray.init(
                address,
                ignore_reinit_error=True,
                include_dashboard=False,
                log_to_driver=False,
                logging_level=logging.ERROR,
            )
        except Exception as error:  # Ray raises a bare one where it does not start in time, as on a busy machine
            if self._is_own:
                ray.shutdown()
            why = str(error).partition("\n")[0] or type(error).__name__
            said = f"no cluster at {address} ({why})"
            raise DatasetError(Fault(Path("--ray"), "", said, "the address of one, or none")) from None
        self._run = ray.remote(_run)

    def submit[**P, T](self, function: Callable[P, T], /, *args: P.args, **kwargs: P.kwargs) -> Future[T]:
        """Run a call on the cluster; it, its arguments and its result must survive pickling."""
        done: Future[T] = Future()

        def settle(task: Future[tuple[Any, BaseException | None]]) -> None:
            if not done.set_running_or_notify_cancel():
                return
            try:
                result, error = task.result()
            except BaseException as lost:
                result, error = None, lost
            done.set_exception(error) if error else done.set_result(result)

        self._run.remote(Path.cwd(), function, args, kwargs).future().add_done_callback(settle)
        return done

    def shutdown(self, wait: bool = True, *, cancel_futures: bool = False) -> None:
        """Leave the cluster, unless it was joined before."""
        if self._is_own:
            self._ray.shutdown()


def _knock(address: str) -> None:
    """See that somebody answers at an address, for which Ray itself would wait for minutes."""
    host, _, port = address.removeprefix("ray://").rpartition(":")
    if port.isdigit():
        socket.create_connection((host, int(port)), timeout=_PATIENCE).close()


def _run(folder: Path, function: Callable[..., Any], args: Any, kwargs: Any) -> tuple[Any, BaseException | None]:
    """Return what a call returns, or raises, which Ray would wrap: whoever waits for it knows it by its type.

    It runs in the folder of who asked for it, from which paths may count; a machine may not have that.
    """
    with contextlib.suppress(OSError):
        os.chdir(folder)
    try:
        return function(*args, **kwargs), None
    except BaseException as error:
        return None, error
