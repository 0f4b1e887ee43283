"""Write a report on runs, sweeps, a tuning, a challenge or an identification.

Example: runner report latest --format html
"""

from argparse import Namespace

from runner.cli.arguments import Parser, StoredFolder

FORMATS = ("html", "pdf")


def add_arguments(parser: Parser) -> None:
    """Add the arguments."""
    parser.add_argument(
        "folders",
        nargs="+",
        type=StoredFolder("run", "sweep", "tuning", "challenge", "identification"),
        metavar="DIR",
        help="runs, sweeps, one tuning, challenge or identification; or latest",
    )
    parser.add_formats(FORMATS, "html, pdf or both (default: html,pdf)")
    parser.add_shared(
        metrics="metrics that compare a sweep; the first ranks it (default: the main ones)",
        by="one sweep: the axis that it asks about (default: its question, such as the controller)",
        output="folder to write (default: in reports/ of the outputs folder)",
    )


def run(options: Namespace) -> int:
    """Write the report; print its folder as the last line."""
    from runner.reporting.stored import write

    formats = [name for name in FORMATS if name in (options.format or FORMATS)]
    print(write(options.folders, options.metrics or (), formats, options.output, options.by or ()))
    return 0
