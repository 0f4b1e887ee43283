"""`runner report DIR... [--html] [--pdf] [--metrics A,B]`: write a report on runs, a sweep or a comparison."""

from collections.abc import Sequence

from runner.base.environment_variables import quiet_environment
from runner.cli.arguments import Parser, name_list, stored_folder


def main(arguments: Sequence[str]) -> int:
    """Write the report; print its folder as the last line."""
    parser = Parser("report", __doc__)
    parser.add_argument(
        "folders",
        nargs="+",
        type=stored_folder("run", "sweep", "tuning"),
        metavar="DIR",
        help="run folders, sweep folders, or the folder of one tuning; or latest",
    )
    parser.add_argument("--html", action="store_true", help="only HTML (with --pdf: both)")
    parser.add_argument("--pdf", action="store_true", help="only PDF (with --html: both)")
    parser.add_argument(
        "--metrics",
        type=name_list,
        default=[],
        metavar="A,B",
        help="metrics by which a sweep is compared; the first ranks it",
    )
    options = parser.parse_args(arguments)
    quiet_environment()
    from runner.reporting.stored import write

    formats = [name for name in ("html", "pdf") if getattr(options, name)] or ["html", "pdf"]
    print(write(options.folders, options.metrics, formats))
    return 0
