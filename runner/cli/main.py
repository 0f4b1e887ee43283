"""Command-line entry point: dispatch to a command, and exit codes.

Exit codes: 0 success, 1 a run failed or a check failed, 2 invalid input, 130 interrupted, 143 terminated. This module
imports little, so that help and completion start fast.
"""

import importlib
import os
import shlex
import signal
import sys
from collections.abc import Sequence
from typing import NoReturn

from runner.base.errors import DISK_FULL, RunnerError, describe_part_error, describe_write_error, nearest, user_place
from runner.base.former_names import COMMANDS as FORMER_COMMANDS
from runner.base.progress import show_progress
from runner.base.sanitize import one_line
from runner.cli.completion import answer, is_asked
from runner.cli.help import COMMANDS, GUIDE, HELP, SPELLED_OUT


def main() -> None:
    """Run the command line and leave the process with its exit code."""
    _open_outputs()
    signal.signal(signal.SIGTERM, _terminate)
    try:
        code = dispatch(sys.argv[1:])
        sys.stdout.flush()
    except OSError as error:
        # What is still buffered must not complain again when the interpreter flushes it at the very end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        code = 0  # nobody reads on, as in `runner list | head -1`
        if not isinstance(error, BrokenPipeError):
            print(f"runner: {describe_write_error(error) if error.errno in DISK_FULL else error}", file=sys.stderr)
            code = 2
    sys.exit(code)


class TerminatedError(KeyboardInterrupt):
    """The process was asked to end (SIGTERM); it ends as when it is interrupted."""


def _terminate(*_: object) -> NoReturn:
    signal.signal(signal.SIGTERM, signal.SIG_IGN)  # what ends must not be ended once more
    raise TerminatedError


def _open_outputs() -> None:
    """Send an output that the caller closed to nowhere; else a file of ours would take its number, and its prints."""
    for number, name in ((1, "stdout"), (2, "stderr")):
        if getattr(sys, name) is None:
            nowhere = os.open(os.devnull, os.O_WRONLY)
            if nowhere != number:
                os.dup2(nowhere, number)
                os.close(nowhere)
            setattr(sys, name, os.fdopen(number, "w"))


def dispatch(arguments: Sequence[str]) -> int:
    """Run one command line and return its exit code."""
    try:
        if is_asked(arguments):
            return answer(arguments, os.environ)
        with show_progress():
            return _choose(_take_plugins(arguments))
    except RunnerError as error:
        print(f"runner: {error}", file=sys.stderr)
        return 2
    except MemoryError as error:
        print(f"runner: not enough memory: {error}; shorten the run or ask for fewer repetitions", file=sys.stderr)
        return 2
    except Exception as error:
        from runner.plugins.discovery import has_users_parts

        if not (user_place(error) and has_users_parts()):  # a fault of ours: its whole trace is of use
            raise
        print(one_line(f"runner: your plug-in failed: {describe_part_error(error)}"), file=sys.stderr)
        return 2
    except KeyboardInterrupt as error:
        ended, code = ("terminated", 143) if isinstance(error, TerminatedError) else ("interrupted", 130)
        print(f"runner: {ended}; finished runs are stored; the same command continues", file=sys.stderr)
        return code


def _take_plugins(arguments: Sequence[str]) -> list[str]:
    """Add the parts that `--plugin GROUP=MODULE` names, in any command, and return the other arguments."""
    named, others = [], []
    words = iter(arguments)
    for word in words:
        if word == "--plugin":
            named.append(next(words, ""))
        elif word.startswith("--plugin="):
            named.append(word.removeprefix("--plugin="))
        else:
            others.append(word)
    if named:
        from runner.plugins.discovery import use_plugins

        use_plugins(named)
    return others


def _choose(arguments: Sequence[str]) -> int:
    if not arguments:
        print(GUIDE, end="")
        return 0
    first = arguments[0]
    if first in ("-h", "--help", "help"):
        print(HELP, end="")
        return 0
    if first == "--version":
        from importlib.metadata import version

        print(version("arm-control-runner"))
        return 0
    if first in COMMANDS:
        return _command(first, arguments[1:])
    if first in SPELLED_OUT:
        return _run([*SPELLED_OUT[first], *arguments[1:]])
    if first in FORMER_COMMANDS:
        raise RunnerError(f"{first} is now called {FORMER_COMMANDS[first]}.")
    if len(arguments) > 1 and arguments[1].startswith("=") and "=" not in first:
        given = "".join(arguments[1:3]) if arguments[1] == "=" else arguments[1]
        raise RunnerError(f"an override has no spaces beside its '=': `runner {shlex.join([first + given])}`")
    if first and first[0].isalpha() and "=" not in first:
        raise RunnerError(
            f"no command '{first}'{nearest(first, COMMANDS)}; commands: {', '.join(COMMANDS)}; a "
            "run is started by overrides such as robot=macro"
        )
    return _run(arguments)


def _run(arguments: Sequence[str]) -> int:
    code: int = importlib.import_module("runner.cli.run").main(arguments)
    return code


def _command(name: str, arguments: Sequence[str]) -> int:
    code: int = importlib.import_module(f"runner.cli.{name}").main(list(arguments))
    return code
