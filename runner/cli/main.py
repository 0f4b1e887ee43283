"""Command-line entry point: dispatch to a command, and exit codes.

Exit codes: 0 success, 1 a run failed or a check failed, 2 invalid input, 130 interrupted, 143 terminated. This module
imports little, so that help and completion start fast.
"""

import importlib
import os
import shlex
import signal
import sys
from collections.abc import Mapping, Sequence
from typing import NoReturn

from runner.base.errors import DISK_FULL, RunnerError, describe_part_error, describe_write_error, nearest, user_place
from runner.base.former_names import COMMANDS as FORMER_COMMANDS
from runner.base.progress import show_progress
from runner.base.sanitize import one_line
from runner.cli.completion import answer, is_asked

HELP = """\
runner: config-driven experiments for robot-arm control, with reports

  runner [run] robot=macro trajectory=goal       one run; its key metrics, and as the last line its folder
  runner -m robot=macro,mini noise.position=1e-4,1e-3
                                                 a sweep over every combination, also `runner sweep ...`; again, it
                                                 makes what is missing
  runner status DIR                              how far a sweep is
  runner tune OVERRIDES --minimize METRIC        choose numbers, as in controller.period="interval(0.005,0.05)"
  runner reproduce [thesis|xarm7|meca500|audit|all|FOLDER]
                                                 run what is missing and write the report of a study
  runner report DIR... [--html] [--pdf]          a report from stored runs or sweeps
  runner table DIR [--format latex|markdown|csv|parquet] [--metrics A,B] [--by KEY,KEY]
                                                 a sweep as one table, or a table for a paper
  runner figures DIR [--width single|double|MM]  each figure of a report as SVG, PDF and CSV
  runner verify [DIR]                            is all in an outputs folder as it was written?
  runner check DIR [--baseline FILE]             compare every metric with a baseline; --save-baseline FILE writes that
                                                 of a sweep
  runner compare A B...                          runs or sweeps side by side: what differs, every metric in pairs;
                                                 compare SWEEP --by controller: the levels of an axis
  runner sensitivity RUN [--metrics A,B] [--parameters gains,masses,...] [--finite-differences]
                                                 which parameter a run's metrics depend on most, by exact derivatives
  runner study new FOLDER                        write a first study of your own, to reproduce another paper;
                                                 check FOLDER looks through it, diff OLD NEW compares two versions
  runner benchmark check LAW.py [--profile P]    does a law of yours fit in the benchmark, and how long will it take?
  runner calibrate [OVERRIDES]                   calibrate tool or sensor against the truth: calibration=gravity
  runner audit URDF --tip FRAME --jacobian FILE  your own formulas against a robot; also --position, --mass-matrix,
                                                 --gravity
  runner doctor FILE [--tip FRAME] [--name NAME] [-o DIR] [--format config,html]
                                                 does a robot of yours fit, what to mend, and a config to start from
  runner example DIR                             copy the examples: an arm, a controller, a paper, a notebook
  latest                                         in place of a DIR: the run, sweep, tuning or report made or found last
  runner list [robots|controllers|trajectories|experiments|plants|environments|wrist_sensors|mismatch|noise|presets|
               torque_limits|calibrations|metrics|claims|baselines|studies]

  runner --cfg job [OVERRIDES]                   show the composed config without running it
  runner --config-dir DIR OVERRIDES              take YAML and URDFs from your own folder, too
  runner --plugin controller=FILE.py OVERRIDES   take a controller, trajectory, plant, environment or metric from your
                                                 own module; again for the next one
  runner --hydra-help                            all flags of Hydra
  eval "$(runner -sc install=bash)"              tab completion (also fish, zsh)

Groups: robot, controller, trajectory, plant, environment, wrist_sensor, mismatch, noise, torque_limits, preset,
experiment. A value is set by its dotted key, as in controller.period=0.005; `runner --cfg job` shows all keys. Exit
codes: 0 good, 1 a run failed or a check fell short, 2 bad input.
"""
GUIDE = """\
runner: experiments on the control of robot arms; a line of text makes a run, a sweep or a report

  runner robot=macro trajectory=quintic          one run; its key metrics and its folder are told
  runner report latest                           a report on it, HTML and PDF
  runner -m robot=macro controller.period=5ms,10ms
                                                 a sweep over every combination
  runner list                                    robots, controllers, trajectories, metrics and studies there are
  runner doctor FILE                             does a URDF or MJCF of yours fit?

All commands: runner --help. All keys of a run: runner --cfg job. The pages are in docs/ of the source, docs/tutorial.md
first.
"""
COMMANDS = (
    "reproduce", "report", "table", "figures", "status", "tune", "verify", "check", "compare", "sensitivity",
    "calibrate", "audit", "benchmark",
    "doctor", "list", "study", "example",
)  # fmt: skip
SPELLED_OUT: Mapping[str, Sequence[str]] = {"run": (), "sweep": ("-m",)}
"""Words before overrides that name what overrides make, with the flags that each stands for."""


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
    """Make a run or a sweep, or tell again of the run that the same line gave before."""
    from runner.base.environment_variables import quiet_environment
    from runner.store.recall.runs import find_again, line_key

    quiet_environment()
    key = line_key(arguments)
    found = find_again(key)
    if found is None:
        code: int = importlib.import_module("runner.cli.run").main(arguments, key)
        return code
    from runner.cli.ending import tell_run

    run, thresholds = found
    return tell_run(run, False, thresholds)


def _command(name: str, arguments: Sequence[str]) -> int:
    code: int = importlib.import_module(f"runner.cli.{name}").main(list(arguments))
    return code
