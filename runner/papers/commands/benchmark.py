"""Check if your controller fits the benchmark.

LAW.py is the file for `--plugin controller=LAW.py`; its config controller/LAW.yaml and its ranges LAW.ranges.yaml are
next to it. LAW.py:NAME is a law that is one function, without config. The check composes every run and compares it with
a run of a built-in controller. It computes the first control steps on each arm, and estimates the total time. It stores
nothing. Exit code 2: the controller does not fit.

Example: runner benchmark check LAW.py
"""

import shlex
from argparse import Namespace
from collections.abc import Iterator
from typing import TYPE_CHECKING

from runner.base.errors import RunnerError
from runner.base.sanitize import one_line
from runner.cli.arguments import Parser
from runner.plugins.discovery import in_use, use_plugins

if TYPE_CHECKING:
    from runner.papers.study.code import UserPlugin

STUDY = "benchmark"


def add_arguments(parser: Parser) -> None:
    """Add the action `check`."""
    actions = parser.add_subparsers(dest="action", required=True, metavar="ACTION")
    check = actions.add_parser("check", help="check if your controller fits")
    check.add_argument("law", metavar="FILE", help="your controller, a Python file")
    check.add_argument(
        "--profile", default="", metavar="P", help="smaller or larger version of the benchmark (default: quick)"
    )


def run(options: Namespace) -> int:
    """Print a line for each arm, the total time, and the command that simulates the benchmark."""
    use_plugins([f"controller={options.law}"])
    from runner.config.compose.composer import Composer
    from runner.papers.study.code import read_user_plugins

    (part,) = read_user_plugins(in_use()[-1:])
    workers = Composer().sweeper([]).workers
    for line in check_law(STUDY, options.profile, part, workers):
        print(one_line(line))
    profile = ("--profile", options.profile) if options.profile else ()
    print(shlex.join(["runner", "reproduce", STUDY, *profile, "--plugin", f"controller={options.law}"]))
    return 0


def check_law(name: str, profile: str, part: "UserPlugin", workers: int) -> Iterator[str]:
    """Yield the check of a controller in a study that accepts plug-ins: a line for each arm, and the total time.

    Args:
        name: Name of the study.
        profile: Profile of the study; empty for its default profile.
        part: Plug-in of the controller.
        workers: Number of processes for the runs of the study.

    Raises:
        RunnerError: with all problems, if the controller does not fit.
    """
    from runner.papers.study.estimate import cost_line
    from runner.papers.study.fit import fit
    from runner.papers.study.study import load_study

    without = load_study(name, profile=profile)
    found = fit(load_study(name, profile=profile, parts=(part,)), without, part)
    if found.problems:
        raise RunnerError("\n".join([f"{part.name} does not fit:", *(f"  - {text}" for text in found.problems)]))
    for robot, tick in found.ticks.items():
        amount, ended = found.amounts[robot], ""
        if tick.diverged is not None:
            ended = f"; with the values of its config it diverges at {tick.diverged:g} s"
        yield (
            f"{robot}: a control tick of {1e3 * tick.period:g} ms computed in {1e6 * tick.computed:.0f} us; "
            f"{amount.trials:,} trials, {amount.longer:,} long runs, {amount.runs:,} runs{ended}"
        )
    if not found.tuned:
        yield f"no ranges in {part.name}.ranges.yaml: the law is compared only with the values of its config"
    yield cost_line([part.name], found.amounts, workers)
