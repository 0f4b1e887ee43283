"""Show the progress of a sweep from its stored runs.

With --parts N it prints only the parts K of sweep.part=K/N that have missing cells, for `sbatch --array`.

Example: runner status latest
"""

import sys
from argparse import Namespace
from typing import TYPE_CHECKING

from runner.base.sanitize import one_line
from runner.cli.arguments import Parser, StoredFolder, count

if TYPE_CHECKING:
    from runner.store.sweep import Sweep


def add_arguments(parser: Parser) -> None:
    """Add the arguments."""
    parser.add_argument(
        "folder", type=StoredFolder("sweep", "tuning"), metavar="DIR", help="folder of a sweep, or latest"
    )
    parser.add_argument(
        "--parts", type=count, metavar="N", help="print the parts with missing cells, such as 3,17,40-42"
    )


def run(options: Namespace) -> int:
    """Print the numbers of runs that are done, failed, left or have caveats, and the command that continues."""
    from runner.base.machine import describe_mixture
    from runner.base.quantities import format_duration
    from runner.store import open_sweep
    from runner.store.kinds import kind_of
    from runner.sweeps.at_work import in_words
    from runner.sweeps.status import find_status, in_ranges, parts_of
    from runner.sweeps.tuning.study import count_trials, open_tuning

    sweep = open_sweep(options.folder)
    if options.parts is not None:
        _check_parts(sweep, options.parts)
    status = find_status(sweep)
    for damage in status.damage:
        print(f"runner: {damage}", file=sys.stderr)
    if options.parts is not None:
        print(in_ranges(parts_of(status.missing, options.parts)))
        return 0
    of_trials = kind_of(options.folder) == "tuning"
    if of_trials:
        print(count_trials(open_tuning(options.folder).trials))
    failed = f" ({status.failed} of them failed)" if status.failed and not of_trials else ""
    print(f"{status.done + status.left} runs: {status.done} done{failed}, {status.left} left")
    if mixture := describe_mixture(status.machines):
        print(one_line(mixture))
    if any(status.caveats):
        cells = "trials" if of_trials else "cells"
        with_some = sum(count > 0 for count in status.caveats)
        print(f"{with_some} of {len(status.caveats)} stored {cells} have caveats; `runner table` says which")
    if status.left and status.at_work:
        to_go = "" if status.seconds is None else f", about {format_duration(status.seconds)} to go"
        print(f"at work ({in_words(status.at_work)}){to_go}")
    elif status.left:
        print(f"not at work; continue with: {sweep.continuation}")
    return 0


def _check_parts(sweep: "Sweep", parts: int) -> None:
    from runner.base.errors import RunnerError
    from runner.store.axes import Axes

    if not isinstance(sweep.overrides, Axes):
        raise RunnerError(f"--parts: only a sweep of `runner -m` has parts ({sweep.folder}).")
    if parts > len(sweep.hashes):
        raise RunnerError(f"--parts: more parts than cells ({parts}). Allowed: 1 to {len(sweep.hashes)}.")
