"""Runs commands that go wrong where a test wants: killed, or told that the disk is full, at any byte and any rename.

It reads requests line by line and forks for each job: the package and its libraries are loaded once. A job is
`[folder, args, fault]`; the jobs of a request run at the same time. A fault is `[kind, where]`:

- ``kill``, ``full`` at the nth time that the program opens a file to write, makes a folder, renames, or waits for the
  disk: it is gone, or the system says that there is no space. Python's own audit events say when that is.
- ``kill_in``, ``full_in`` at a byte of a file, whoever writes it, Python or not: the kernel sees to it (RLIMIT_FSIZE).
- ``pipe``, ``dev_full``: the standard output is a pipe whose reader has left, or a disk without space.
- ``read_only``: rights count, also for root. ``homeless``: there is no home.
"""

import contextlib
import ctypes
import errno
import gc
import io
import json
import os
import pwd
import resource
import signal
import sys
import traceback
from collections.abc import Callable
from pathlib import Path

WRITES = os.O_WRONLY | os.O_RDWR


def watch(act: Callable[[], None]) -> None:
    """Call it whenever something is about to be written below this folder, to begin with."""
    here, fsync = str(Path.cwd()), os.fsync

    def concerns(event: str, args: tuple) -> bool:
        if event == "open":
            return isinstance(args[0], str) and args[0].startswith(here) and bool(args[2] & WRITES)
        return event in ("os.mkdir", "os.rename")

    def watched_fsync(file: int) -> None:
        act()
        fsync(file)

    sys.addaudithook(lambda event, args: act() if concerns(event, args) else None)
    os.fsync = watched_fsync


def break_at(kind: str, where: int, seen: list[int]) -> None:
    def act() -> None:
        seen[0] += 1
        if seen[0] - 1 == where and kind == "kill":
            os.kill(os.getpid(), signal.SIGKILL)
        if seen[0] - 1 == where and kind == "full":
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    watch(act)


def drop_rights() -> None:
    """Let root be held by the rights of files, as everybody is."""
    version_3 = (ctypes.c_uint32 * 2)(0x20080522, 0)
    ctypes.CDLL(None).capset(version_3, (ctypes.c_uint32 * 6)())


def no_entry(number: int) -> None:
    raise KeyError(number)


def prepare(kind: str, where: int, seen: list[int]) -> None:
    if kind in ("count", "kill", "full"):
        break_at(kind, where, seen)
    if kind in ("kill_in", "full_in"):
        resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
        resource.setrlimit(resource.RLIMIT_FSIZE, (where, where))
        signal.signal(signal.SIGXFSZ, signal.SIG_DFL if kind == "kill_in" else signal.SIG_IGN)
    if kind == "read_only":
        drop_rights()
    if kind == "homeless":
        del os.environ["HOME"]
        pwd.getpwuid = no_entry


def output_of(kind: str) -> io.TextIOBase:
    if kind not in ("pipe", "dev_full"):
        return io.TextIOWrapper(io.BytesIO())
    if kind == "dev_full":
        return Path("/dev/full").open("w")
    reader, writer = os.pipe()
    os.close(reader)
    return os.fdopen(writer, "w")


def run(folder: str, args: list[str], kind: str, where: int) -> dict:
    from z2r.cli import main

    os.chdir(folder)
    sys.argv, seen, said = ["z2r", *args], [0], io.StringIO()
    with contextlib.redirect_stdout(output_of(kind)), contextlib.redirect_stderr(said):
        try:
            prepare(kind, where, seen)
            main()
            code = 0
        except SystemExit as end:
            code = end.code or 0
        except BaseException:
            code = traceback.format_exc()
    return {"code": code, "said": said.getvalue(), "seen": seen[0]}


def start(job: list) -> tuple[int, int]:
    """Fork for a job; return where it answers, and its number."""
    folder, args, (kind, where) = job
    reader, writer = os.pipe()
    if not (child := os.fork()):
        os.write(writer, json.dumps(run(folder, args, kind, where)).encode())
        os._exit(0)
    os.close(writer)
    return reader, child


def end(reader: int, child: int) -> dict:
    with os.fdopen(reader) as answers:
        answer = answers.read()
    signalled = os.waitstatus_to_exitcode(os.waitpid(child, 0)[1])
    return json.loads(answer) if answer else {"code": signalled, "said": "", "seen": 0}


if __name__ == "__main__":
    import datasets  # noqa: F401
    from lerobot.datasets.lerobot_dataset import LeRobotDataset  # noqa: F401

    import z2r.api
    import z2r.audits.audit
    import z2r.pusht.simulator.env
    import z2r.pusht.simulator.recorder
    import z2r.show.draft
    import z2r.show.replay
    import z2r.show.report
    import z2r.show.terminal  # noqa: F401

    gc.freeze()  # so that no child copies what it only inherits
    for line in sys.stdin:
        print(json.dumps([end(*job) for job in [start(job) for job in json.loads(line)]]), flush=True)
