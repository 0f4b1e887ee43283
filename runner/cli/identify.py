"""Identify an arm's masses, friction and rotor inertias from logs of it, with intervals.

It says what the logs can determine, and what not. Friction and cut-off are chosen by the error on torques that the
fit has not seen. The last line is the folder of the result, with a report.

Example: runner identify log1.csv log2.csv --columns columns.yaml --robot ur5e
"""

import shlex
import sys
from argparse import ArgumentTypeError, Namespace
from pathlib import Path

from runner.base.sanitize import one_line
from runner.cli.arguments import Parser, read_per_cent, seconds
from runner.identification.friction_kinds import KINDS


def add_arguments(parser: Parser) -> None:
    """Add the arguments."""
    parser.usage = "runner identify --columns MAP --robot ROBOT [OPTION ...] LOG [LOG ...]"
    parser.add_argument("logs", type=Path, nargs="+", metavar="LOG", help="logs of one arm: files or folders")
    parser.add_argument(
        "--columns", type=Path, action="append", required=True, metavar="MAP",
        help="column map of all logs; repeat for one each",
    )  # fmt: skip
    parser.add_argument("--robot", required=True, metavar="ROBOT", help="the robot, as in `runner robot=ROBOT`")
    parser.add_argument("--dry-run", action="store_true", help="only print what the logs can determine")
    parser.add_argument(
        "--friction", choices=KINDS, metavar="KIND", help=f"one of {', '.join(KINDS)} (default: chosen)"
    )
    parser.add_argument("--cutoff", type=float, metavar="HZ", help="cut-off of both sides, in Hz (default: chosen)")
    parser.add_argument(
        "--prior", type=_width, metavar="WIDTH", help="combine with the file's values, this wide, such as 30%%"
    )
    parser.add_argument(
        "--fill-gaps", type=seconds, default=0.0, metavar="TIME", help="longest gap to fill, such as 20ms"
    )
    parser.add_shared("config_dir", output="outputs folder (default: outputs)")


def _width(text: str) -> float:
    """Return the share of a text such as "30%"."""
    share = read_per_cent(text)
    if share is None or not 0.0 < share <= 1.0:
        raise ArgumentTypeError(f"not a width ('{text}'). Allowed: above 0% up to 100%, such as 30%.")
    return share


def run(options: Namespace) -> int:
    """Print what the logs can determine, then the answer and the parameters; print the folder as the last line."""
    from runner.config.compose.files import outputs_dir
    from runner.identification.examination import examine_logs, read_question
    from runner.identification.identify import identify
    from runner.identification.words import answer_lines, examination_lines, method_lines
    from runner.reporting.identification_report import parameters
    from runner.reporting.stored import write
    from runner.reporting.table import terminal
    from runner.store.kinds import note
    from runner.sweeps.arm import arm_of

    arm = arm_of(options.robot, options.config_dir)
    question = read_question(options.robot, arm.model, arm.urdf, options.logs, options.columns, options.fill_gaps)
    examined = examine_logs(question)
    for line in examination_lines(examined):
        print(one_line(line))
    if options.dry_run:
        return 0
    sys.stdout.flush()
    command = shlex.join(["runner", "identify", *options.words])
    place = options.output or outputs_dir()
    found = identify(examined, place, command, options.friction, options.cutoff, options.prior)
    print()
    for line in answer_lines(found):
        print(one_line(line))
    print(f"\n{terminal(parameters(found), indent='')}\n")
    for line in method_lines(found):
        print(one_line(line))
    found.write()
    note(found.folder)
    print(f"report: {write([found.folder], (), ('html', 'pdf'))}")
    print(found.folder)
    return 0
