"""Handshakes with processes: they report at a named point, and wait there until the test lets them on."""

import fcntl
import itertools
import os
import select
import sys
from pathlib import Path
from textwrap import dedent

from support.patience import PATIENCE

_NUMBERS = itertools.count()
_STOP = """\
import fcntl
import os


def stop():
    with open({here!r}, "w") as pipe:
        pipe.write(f"{{os.getpid()}}\\n")
    with open({gate!r}) as gate:
        fcntl.flock(gate, fcntl.LOCK_SH)
"""
_METRIC = """

UNITS = {{}}


def evaluate(trace, context):
    if len(trace.t) == {rows}:
        stop()
    return {{}}
"""
_COMMAND = """
import functools
import importlib
import itertools
import sys

from runner.base.engines import quiet_environment

quiet_environment()
module, _, path = sys.argv.pop(1).partition(":")
*owners, name = path.split(".")
owner = functools.reduce(getattr, owners, importlib.import_module(module))
function, last, calls = getattr(owner, name), int(sys.argv.pop(1)), itertools.count(1)


def counted(*given):
    made = function(*given)
    if next(calls) == last:
        stop()
    return made


setattr(owner, name, counted)

from runner.cli.main import main

main()
"""


class Gate:
    """A gate in a folder: a pipe on which processes report, and a lock that they wait for.

    Attributes:
        source: Python source of `stop()`, which reports and waits.
    """

    def __init__(self, folder: Path) -> None:
        here, gate = folder / "here", folder / "gate"
        os.mkfifo(here)
        self._folder = folder
        self._pipe = os.fdopen(os.open(here, os.O_RDWR), "r+b", buffering=0)  # it has a writer, and never ends
        self._lock = gate.open("w")
        fcntl.flock(self._lock, fcntl.LOCK_EX)
        self.source = _STOP.format(here=str(here), gate=str(gate))

    def metric(self, rows: int) -> str:
        """Write a metric that stops at traces of this many rows; return the plug-in."""
        path = self._folder / f"gate_{os.getpid()}_{next(_NUMBERS)}.py"  # Python knows a module by only its name
        path.write_text(self.source + _METRIC.format(rows=rows))
        return f"metric={path}"

    def command(self, function: str, calls: int, *arguments: object) -> list[str]:
        """Return the command line of a `runner` that stops once it has made this many calls of a function.

        Args:
            function: The function, such as "os:fsync".
            calls: Number of calls, the one after which it stops included.
            arguments: Arguments of the command.
        """
        return [sys.executable, "-c", self.source + dedent(_COMMAND), function, str(calls), *map(str, arguments)]

    def next_at(self) -> int:
        """Return the process that reports next.

        Raises:
            TimeoutError: if none does within the patience.
        """
        if not select.select([self._pipe], [], [], PATIENCE)[0]:
            raise TimeoutError("no process got to the gate")
        return int(self._pipe.readline())

    def open(self) -> None:
        """Let all processes on, those that come later included."""
        fcntl.flock(self._lock, fcntl.LOCK_UN)

    def give_up(self) -> None:
        """Let whoever waits for a report have process 0."""
        self._pipe.write(b"0\n")

    def close(self) -> None:
        """Close the pipe and the lock."""
        self._pipe.close()
        self._lock.close()
