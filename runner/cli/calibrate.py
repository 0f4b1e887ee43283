"""Simulate a calibration of a tool or a sensor, compare it with the truth, and store it.

Example: runner calibrate robot=meca500 calibration=gravity repetitions=10
"""

import sys
from argparse import Namespace
from typing import TYPE_CHECKING

from runner.base.quantities import plain_number
from runner.base.sanitize import one_line
from runner.cli.arguments import Parser
from runner.config.compose.files import outputs_override
from runner.reporting.table import Number, Table, numbers, terminal

if TYPE_CHECKING:
    from runner.store import Calibration


def add_arguments(parser: Parser) -> None:
    """Add the arguments."""
    parser.add_overrides("such as calibration=gravity, repetitions=10", root="calibrate")
    parser.add_shared("config_dir", output="outputs folder (default: outputs)")


def run(options: Namespace) -> int:
    """Simulate one calibration; print a table of its errors, and its folder as the last line."""
    from runner.sweeps.job import calibrate

    outputs = [] if options.output is None else [outputs_override(options.output)]
    done = calibrate(*options.overrides, *outputs, config_dirs=options.config_dir)
    for warning in done.provenance["warnings"]:
        print(one_line(f"runner: warning: {warning}"), file=sys.stderr)
    print(_report(done))
    print(done.folder)
    return 0


def _report(done: "Calibration") -> str:
    rows = []
    for name, summary in done.record["errors"].items():
        deviation = done.summary("deviations", name)["median"]
        values = (summary["median"], summary["min"], summary["max"], deviation)
        rows.append([name, summary["unit"], *map(Number, values)])
    header = ["error of", "unit", *numbers("median", "min", "max", "standard deviation")]
    errors = terminal(Table("", header, rows))
    judged = done.consistency
    if judged is None:
        return errors
    band = f"{plain_number(judged['lower'])} to {plain_number(judged['upper'])}"
    verdict = "as large as" if judged["holds"] else "not as large as"
    mean, share = plain_number(judged["mean"]), f"{100.0 * judged['level']:g} %"
    text = f"errors are {verdict} predicted: mean normalised error squared {mean}, {share} band {band}"
    return f"{errors}\n{text}"
