"""List what is stored, write it as one page, or remove what is old.

Example: runner results --output results.html
"""

import re
import sys
import time
from argparse import ArgumentTypeError, Namespace
from datetime import datetime
from pathlib import Path

from runner.base.sanitize import one_line
from runner.cli.arguments import Parser
from runner.config.compose.files import outputs_dir

_DAY = 86400.0


def add_arguments(parser: Parser) -> None:
    """Add the arguments."""
    parser.add_argument(
        "outputs", nargs="?", type=Path, default=outputs_dir(), metavar="DIR", help="outputs folder (default: outputs)"
    )
    parser.add_shared(output="write one offline page, such as results.html")
    parser.add_argument(
        "--delete", type=_before, metavar="OLDER", help="list what is older than a date (2026-11-01) or an age (30d)"
    )
    parser.add_argument("--yes", action="store_true", help="with --delete: remove what is listed")


def run(options: Namespace) -> int:
    """Print the results, or what can be removed."""
    from runner.base.errors import RunnerError

    if options.yes and options.delete is None:
        raise RunnerError("--yes: only with --delete OLDER.")
    if options.delete is not None:
        if options.output:
            raise RunnerError("--output: not with --delete.")
        _delete(options)
        return 0
    from runner.reporting.results import HEADER, rows_of, write_page
    from runner.reporting.table import Table, terminal

    rows = rows_of(options.outputs)
    if options.output:
        write_page(rows, options.outputs, options.output)
        print(options.output)
        return 0
    if not rows:
        print(f"nothing is stored in {options.outputs}")
        return 0
    table = Table("", [*HEADER, "folder"], [[*row.cells, str(row.entry.folder)] for row in rows])
    print(terminal(table, indent=""))
    return 0


def _delete(options: Namespace) -> None:
    from runner.base.errors import RunnerError
    from runner.store.listing import list_entries, removable, remove
    from runner.sweeps.at_work import commands_in, in_words

    entries = list_entries(options.outputs)
    found, kept = removable(entries, options.delete)
    for reason in kept:
        print(one_line(f"runner: {reason}"), file=sys.stderr)
    for entry in found:
        print(entry.folder)
    megabytes = sum(entry.size for entry in found) / 1e6
    told = f"{len(found)} of {len(entries)} results, {megabytes:.3g} MB"
    if not options.yes:
        print(f"runner: {told}; nothing is removed without --yes", file=sys.stderr)
        return
    if commands := commands_in(options.outputs):
        raise RunnerError(f"a sweep is at work in {options.outputs} ({in_words(commands)}); nothing is removed.")
    remove(found)
    print(f"runner: removed {told}", file=sys.stderr)


def _before(text: str) -> float:
    """Return the time in s since 1970 that a date or an age names."""
    if age := re.fullmatch(r"(\d+)d", text):
        return time.time() - int(age[1]) * _DAY
    try:
        return datetime.fromisoformat(text).timestamp()
    except ValueError:
        raise ArgumentTypeError(f"no date or age ({text!r}). Allowed: a date such as 2026-11-01, or 30d.") from None
