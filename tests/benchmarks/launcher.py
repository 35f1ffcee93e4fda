"""What does a command cost? Runs commands one after the other, each in a process of its own.

A child begins with its parent's peak memory, so the parent of what is measured must have nothing loaded: this file,
which imports little, is run as a process between. Where modules are named, it imports them first, and runs a command,
which is a Python script then, in a fork of itself: for programs of which nothing but the import is slow.
"""

import importlib
import json
import os
import resource
import runpy
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from pathlib import Path
from typing import NamedTuple

WALL = 900
"""How long a command may take [s]: one that waits for something uses no CPU, and would never end."""
TOO_LONG = (-signal.SIGXCPU, -signal.SIGALRM)
"""What comes of a command that takes longer than it may."""


class Cost(NamedTuple):
    """What became of a command: its exit code, negative where a signal ended it, and what it took."""

    code: int
    seconds: float
    cpu_seconds: float
    mebibytes: float


type Run = Callable[[Sequence[str], Path], Cost]
"""Runs a command in a folder, and leaves what it prints there, in `output.txt` and `errors.txt`."""


@contextmanager
def launcher(
    environment: dict[str, str], cpu_limit: int = 3600, modules: Sequence[str] = (), python: str = sys.executable
) -> Iterator[Run]:
    """Start what runs commands, each for no more than so many seconds of CPU."""
    command = [python, "-P", __file__, str(cpu_limit), *modules]
    with subprocess.Popen(command, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True) as parent:

        def run(command: Sequence[str], folder: Path) -> Cost:
            print(json.dumps([command, str(folder)]), file=parent.stdin, flush=True)
            return Cost(*json.loads(parent.stdout.readline()))

        yield run


def serve(cpu_limit: int, modules: Sequence[str]) -> None:
    """Run what the lines of the input name, and answer each with a line: what `Cost` holds."""
    for name in modules:
        importlib.import_module(name)
    for line in sys.stdin:
        command, folder = json.loads(line)
        start = time.perf_counter()
        child = os.fork()
        if not child:
            return become(command, folder, cpu_limit, fork=bool(modules))
        _, status, usage = os.wait4(child, 0)
        with suppress(ProcessLookupError, PermissionError):
            os.killpg(child, signal.SIGKILL)  # what it left running
        code, cpu_seconds = os.waitstatus_to_exitcode(status), usage.ru_utime + usage.ru_stime
        print(json.dumps([code, time.perf_counter() - start, cpu_seconds, usage.ru_maxrss / 1024]), flush=True)


def become(command: Sequence[str], folder: str, cpu_limit: int, fork: bool) -> None:
    """Be the command, in this process."""
    os.setsid()
    os.chdir(folder)
    for number, name in enumerate((os.devnull, "output.txt", "errors.txt")):
        os.dup2(os.open(name, os.O_RDWR | os.O_CREAT | os.O_TRUNC, 0o644), number)
    signal.alarm(WALL)
    resource.setrlimit(resource.RLIMIT_CPU, (cpu_limit, resource.RLIM_INFINITY))
    resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
    if not fork:
        os.execv(command[0], command)
    sys.argv = list(command)
    runpy.run_path(command[0], run_name="__main__")


if __name__ == "__main__":
    serve(int(sys.argv[1]), sys.argv[2:])
