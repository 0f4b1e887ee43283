"""`runner report DIR... [--format html,pdf] [--metrics A,B] [-o DIR]`: write a report on runs, sweeps or a tuning."""

from argparse import Namespace

from runner.cli.arguments import Parser, Stored

FORMATS = ("html", "pdf")


def add_arguments(parser: Parser) -> None:
    """Add the arguments."""
    parser.add_argument(
        "folders",
        nargs="+",
        type=Stored("run", "sweep", "tuning"),
        metavar="DIR",
        help="run folders, sweep folders, or the folder of one tuning; or latest",
    )
    parser.add_formats(FORMATS, "html, pdf or both; default: both")
    parser.add_shared(
        metrics="metrics by which a sweep is compared; the first ranks it",
        output="folder to write to; default: a folder in reports/ of the outputs folder",
    )


def run(options: Namespace) -> int:
    """Write the report; print its folder as the last line."""
    from runner.reporting.stored import write

    formats = [name for name in FORMATS if name in (options.format or FORMATS)]
    print(write(options.folders, options.metrics or (), formats, options.output))
    return 0
