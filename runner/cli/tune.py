"""Tune numeric config keys to improve metrics, and write a report.

A key is tuned if it has a range instead of a value: controller.natural_frequency="interval(5,50)", on a logarithmic
scale "tag(log, interval(5,50))", whole numbers "int(interval(1,9))", a grid "range(0.01,0.05,0.01)". Repeat an
interrupted command to continue it; with more --trials it adds to the stored ones.

Example: runner tune robot=macro controller.natural_frequency="interval(5,50)" --minimize peak_torque
"""

import argparse
import shlex
import sys
from functools import partial
from typing import TYPE_CHECKING

from runner.base import progress
from runner.base.errors import RunnerError
from runner.cli import report
from runner.cli.arguments import Parser, count
from runner.config.compose.files import outputs_override

if TYPE_CHECKING:
    from runner.sweeps.tuning.study import Tuning

_TRIALS = 100
_JOBS = 4


def add_arguments(parser: Parser) -> None:
    """Add the arguments."""
    parser.add_overrides("as for a run; a range if the key is tuned")
    for direction in ("minimize", "maximize"):
        parser.add_argument(
            f"--{direction}",
            action="append",
            dest="objectives",
            metavar="METRIC",
            type=partial(_objective, direction),
            help=f"metric to {direction}; repeat for a Pareto front",
        )
    parser.add_argument(
        "--trials", type=count, default=_TRIALS, metavar="N", help="number of trials in all (default: %(default)s)"
    )
    parser.add_shared(
        "config_dir",
        output="outputs folder (default: outputs)",
        jobs="number of trials that run at once (default: %(default)s)",
    )
    parser.set_defaults(jobs=_JOBS)


def run(options: argparse.Namespace) -> int:
    """Simulate the missing trials and write the report; print its folder as the last line."""
    objectives = dict.fromkeys(options.objectives or ())
    if not objectives:
        options.parser.error("no metric to tune for. Add --minimize METRIC or --maximize METRIC.")
    if len({metric for _, metric in objectives}) < len(objectives):
        raise RunnerError("--minimize and --maximize: both have the same metric. Allowed: each metric once.")
    from runner.sweeps.tuning.objective import Objective
    from runner.sweeps.tuning.run import tune

    outputs = [] if options.output is None else [outputs_override(options.output)]
    tuning = tune(
        [*options.overrides, *outputs],
        [Objective(metric, direction) for direction, metric in objectives],
        options.trials,
        options.jobs,
        shlex.join(["runner", "tune", *options.words]),
        options.config_dir,
    )
    return _tell(tuning)


def _tell(tuning: "Tuning") -> int:
    from runner.reporting.challenge.beside import scope_line
    from runner.reporting.stored import write
    from runner.reporting.sweep.tuning import compare_on_fresh_seed
    from runner.sweeps.tuning.objective import best
    from runner.sweeps.tuning.study import at_ends, count_trials

    trials, objectives = tuning.trials, tuning.study.objectives
    failed = sum(bool(trial.failure) for trial in trials)
    print(f"runner: {count_trials(trials)}", file=sys.stderr)
    for number in best(trials, objectives):
        values = ", ".join(
            f"{objective.metric} {value:.5g} {objective.unit}".strip()
            for objective, value in zip(objectives, trials[number].values, strict=True)
        )
        print(f"chosen: {values} with {shlex.join(tuning.study.trial_overrides(trials[number]))}")
    answers, compared = compare_on_fresh_seed(tuning)
    scope = scope_line(answers, [tuning.folder], [str(tuning.folder)])
    for sentence in filter(None, (*at_ends(tuning), *compared, scope)):
        print(f"runner: {sentence}", file=sys.stderr)
    progress.begin("preparing the report")
    print(write([tuning.folder], (), report.FORMATS))
    return 0 if failed < len(trials) else 1


def _objective(direction: str, metric: str) -> tuple[str, str]:
    return direction, metric
