"""Command-line entry point: help on all commands, the choice of the command, and exit codes.

Exit codes: 0 success, 1 a run failed or a check failed, 2 invalid input, 3 internal error, 75 temporary, 130
interrupted, 143 terminated. This module imports little, so that help and completion start fast.
"""

import contextlib
import gc
import io
import os
import shlex
import signal
import sys
import textwrap
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import NoReturn

from runner.base.engines import quiet_environment
from runner.base.errors import DISK_FULL, RunnerError, describe_part_error, describe_write_error, unknown, user_place
from runner.base.former_names import COMMANDS as FORMER_COMMANDS
from runner.base.progress import show_progress
from runner.base.sanitize import one_line
from runner.cli import commands
from runner.cli.commands import OVERRIDES
from runner.cli.parser import COMMON, build_parser
from runner.config.compose.files import groups

GUIDE = """\
runner: simulate and compare robot-arm controllers from the command line

  runner robot=macro trajectory=quintic          one run: key metrics and the run's folder
  runner report latest                           a report on it, HTML and PDF
  runner sweep robot=macro controller.period=5ms,10ms
                                                 a sweep over every combination
  runner list                                    available robots, controllers, trajectories, metrics and studies
  runner doctor FILE                             check if your own URDF or MJCF fits

All commands: runner --help. All keys of a run: runner --cfg job. The pages are in docs/ of the source, docs/tutorial.md
first.
"""
_NOTES = """\
`runner COMMAND --help` describes one command. A line of overrides without a command is a run; with -m it is a sweep.
`latest` means the newest result, instead of a DIR. `runner --cfg job` shows all keys of a run.
eval "$(runner -sc install=bash)" turns on completion in bash; zsh and fish also work.
"""
_EXITS = """\
Exit codes: 0 success, 1 a run failed or a check failed, 2 invalid input, 3 internal error, 75 temporary (the same
command continues), 130 interrupted, 143 terminated.
"""
_COLUMN, _WIDTH = 13, 120
_NEW_OBJECTS = 100_000  # between two looks for garbage: nearly all that a command makes stays until its end


def main() -> None:
    """Run the command line and leave the process with its exit code."""
    if "_ARGCOMPLETE" in os.environ:
        from runner.cli.completion.complete import complete

        complete()
    gc.set_threshold(_NEW_OBJECTS)
    _open_outputs()
    signal.signal(signal.SIGTERM, _terminate)
    signal.signal(signal.SIGINT, _interrupt)
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
    gc.freeze()  # the interpreter looks for garbage once more before it ends
    sys.exit(code)


class TerminatedError(KeyboardInterrupt):
    """The process received SIGTERM; it ends as on an interrupt."""


def _terminate(*_: object) -> NoReturn:
    signal.signal(signal.SIGTERM, signal.SIG_IGN)  # a second signal must not interrupt the shutdown
    raise TerminatedError


def _interrupt(*_: object) -> NoReturn:
    signal.signal(signal.SIGINT, signal.SIG_DFL)  # a second Ctrl-C ends the process at once
    raise KeyboardInterrupt


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
    quiet_environment()
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
        return error.exit_code
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
    """Print an unexpected error and return the exit code; raise an OSError that no plug-in caused."""
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


def help_text() -> str:
    """Return the help on all commands."""
    lines = [GUIDE.splitlines()[0]]
    added = {"Installed packages": tuple(added)} if (added := commands.installed()) else {}
    for group, names in (commands.groups() | added).items():
        lines += ["", group]
        modules: dict[str, list[str]] = {}
        for name in names:
            modules.setdefault(commands.summary(name), []).append(name)
        for summary, same in modules.items():
            first = f"  {', '.join(same):<{_COLUMN}}"
            lines.append(textwrap.fill(summary, _WIDTH, initial_indent=first, subsequent_indent=" " * len(first)))
    shared = COMMON.format_help().partition("\n\n")[2]
    groups_text = textwrap.fill(f"Groups of config: {', '.join(groups())}.", _WIDTH)
    return "\n".join([*lines, "", "Options of every command", shared, _NOTES, groups_text, _EXITS])


def run_line(words: Sequence[str]) -> int:
    """Run the command of a line, without the common options; return its exit code."""
    first, *rest = words or [""]
    if not words:
        print(GUIDE, end="")
    elif first in ("-h", "--help", "help"):
        print(help_text(), end="")
    elif first == "--version" or ("--version" in words and (first not in commands.names() or first in OVERRIDES)):
        from importlib.metadata import version

        print(version("arm-control-runner"))
    elif any(word in ("-sc", "--shell-completion") for word in words):
        from runner.cli.completion.complete import shell_code

        print(shell_code(words))
    elif first not in OVERRIDES and (first in commands.names() or _is_installed(first)):
        return _run_command(first, rest)
    else:
        return _run_overrides(words)
    return 0


def _may_be_command(word: str) -> bool:
    return word[:1].isalpha() and "=" not in word


def _is_installed(word: str) -> bool:
    return _may_be_command(word) and word in commands.installed()


def _run_command(name: str, words: Sequence[str]) -> int:
    arguments, others = build_parser([name]).parse_known_args([name, *words])
    if others:
        arguments.parser.reject(others)
    arguments.words = words
    code: int = arguments.run(arguments)
    return code


def _run_overrides(words: Sequence[str]) -> int:
    """Simulate the run or the sweep of a line; reject a first word that is neither a command nor an override."""
    first = words[0]
    if first in FORMER_COMMANDS:
        raise RunnerError(f"{first} is now called {FORMER_COMMANDS[first]}.")
    if len(words) > 1 and words[1].startswith("=") and "=" not in first:
        given = "".join(words[1:3]) if words[1] == "=" else words[1]
        raise RunnerError(f"an override has no spaces around its '=': `runner {shlex.join([first + given])}`")
    if first not in OVERRIDES and _may_be_command(first):
        known = (*commands.names(), *commands.installed())
        raise RunnerError(f"{unknown('command', first, known)} A run starts with overrides such as robot=macro.")
    if {"-h", "--help"} & {*words}:
        build_parser(["run"]).parse_args(["run", "--help"])
    from runner.cli.run import simulate

    many = ["-m"] if first == "sweep" else []
    return simulate([*many, *words[first in OVERRIDES :]])
