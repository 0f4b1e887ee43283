"""Command-line entry point: dispatch to a command, and exit codes.

Exit codes: 0 success, 1 a run failed or a check failed, 2 invalid input, 3 internal error, 130 interrupted, 143
terminated. This module imports little, so that help and completion start fast.
"""

import contextlib
import io
import os
import signal
import sys
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NoReturn

from runner.base.errors import DISK_FULL, RunnerError, describe_part_error, describe_write_error, user_place
from runner.base.progress import show_progress
from runner.base.sanitize import one_line
from runner.cli.commands import COMMON, run_line


def main() -> None:
    """Run the command line and leave the process with its exit code."""
    if "_ARGCOMPLETE" in os.environ:
        from runner.cli.completion.complete import complete

        complete()
    _open_outputs()
    signal.signal(signal.SIGTERM, _terminate)
    try:
        code = dispatch(sys.argv[1:])
        sys.stdout.flush()
    except OSError as error:
        # Buffered output must not raise again when the interpreter flushes it at the end.
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
        code = 0  # the reader has closed the pipe, as in `runner list | head -1`
        if not isinstance(error, BrokenPipeError):
            print(f"runner: {describe_write_error(error) if error.errno in DISK_FULL else error}", file=sys.stderr)
            code = 2
    sys.exit(code)


class TerminatedError(KeyboardInterrupt):
    """The process received SIGTERM; it ends as on an interrupt."""


def _terminate(*_: object) -> NoReturn:
    signal.signal(signal.SIGTERM, signal.SIG_IGN)  # a second signal must not interrupt the shutdown
    raise TerminatedError


def _open_outputs() -> None:
    """Open a closed output stream on the null device; otherwise the next opened file gets its descriptor."""
    for number, name in ((1, "stdout"), (2, "stderr")):
        if getattr(sys, name) is None:
            nowhere = os.open(os.devnull, os.O_WRONLY)
            if nowhere != number:
                os.dup2(nowhere, number)
                os.close(nowhere)
            setattr(sys, name, os.fdopen(number, "w"))


def dispatch(words: Sequence[str]) -> int:
    """Run one command line and return its exit code."""
    try:
        common, others = COMMON.parse_known_args(words)
        if common.plugin:
            from runner.plugins.discovery import use_plugins

            use_plugins(common.plugin)
        if common.quiet:
            return _print_path(lambda: run_line(others))
        with show_progress():
            return run_line(others)
    except RunnerError as error:
        print(f"runner: {error}", file=sys.stderr)
        return 2
    except MemoryError as error:
        print(f"runner: not enough memory: {error}; shorten the run or ask for fewer repetitions", file=sys.stderr)
        return 2
    except Exception as error:
        return _explain(error)
    except KeyboardInterrupt as error:
        ended, code = ("terminated", 143) if isinstance(error, TerminatedError) else ("interrupted", 130)
        print(f"runner: {ended}; finished runs are stored; the same command continues", file=sys.stderr)
        return code


def _explain(error: Exception) -> int:
    """Print an unexpected error; return the exit code.

    Raises:
        OSError: if the error is an OSError and no plug-in caused it.
    """
    from runner.plugins.discovery import has_users_parts

    if user_place(error) and has_users_parts():
        print(one_line(f"runner: your plug-in failed: {describe_part_error(error)}"), file=sys.stderr)
        return 2
    if isinstance(error, OSError):
        raise error
    import traceback

    traceback.print_exception(error)
    text = f"{type(error).__name__}: {error}"
    print(one_line(f"runner: internal error: {text}. Report it with the command and the trace above."), file=sys.stderr)
    return 3


def _print_path(run: Callable[[], int]) -> int:
    """Run a command; print only the path of the result, and the messages if it fails."""
    out, messages = io.StringIO(), io.StringIO()
    with contextlib.redirect_stdout(out), contextlib.redirect_stderr(messages):
        code = run()
    if code:
        sys.stderr.write(messages.getvalue())
    for line in out.getvalue().splitlines()[-1:]:
        if Path(line).exists():
            print(line)
    return code
