"""Writes the tables of docs/works.md of results from what was reproduced: `python -m bench.make_works_tables FILE`.

FILE is what `runner reproduce all --json FILE` wrote. Each table stands below a comment that names the work and the
claims in it; the rows are those of the work's report. `--check` changes nothing, and ends with 1 where the page says
something else.
"""

import argparse
import json
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

PAGE = Path(__file__).resolve().parents[1] / "docs" / "works.md"
_TABLE = re.compile(r"(<!-- claims of (\w+): ([\d, ]+) -->\n)((?:\|.*\n)+)")

Verdict = Mapping[str, Any]


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the tables, or check them; return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m bench.make_works_tables", description=__doc__)
    parser.add_argument("file", type=Path, help="what `runner reproduce all --json FILE` wrote")
    parser.add_argument("--check", action="store_true", help="change nothing; exit 1 where it differs")
    options = parser.parse_args(arguments)
    text = PAGE.read_text(encoding="utf-8")
    made = made_from(text, json.loads(options.file.read_text(encoding="utf-8")))
    if options.check:
        print(
            "docs/works.md: as reproduced" if made == text else "docs/works.md: its tables are not what was reproduced"
        )
        return int(made != text)
    PAGE.write_text(made, encoding="utf-8")
    return 0


def made_from(page: str, works: Mapping[str, Mapping[str, Any]]) -> str:
    """Return a page with its tables made from what was reproduced, by the works' names.

    Raises:
        KeyError: if a work or claim is not there.
    """

    def table(found: re.Match[str]) -> str:
        by_number = {verdict["claim"]: verdict for verdict in works[found[2]]["verdicts"]}
        return found[1] + "".join(_lines([by_number[number] for number in found[3].split(", ")]))

    return _TABLE.sub(table, page)


def _lines(verdicts: Sequence[Verdict]) -> list[str]:
    """Return the lines of a table of claims; one without a printed value has no column for it."""
    printed = ["printed"] if any(verdict["printed"] for verdict in verdicts) else []
    header = ["claim", *printed, *(ours["way"] or "found" for ours in verdicts[0]["ours"])]
    rows: list[list[str]] = []
    for verdict in verdicts:
        found = [f"{ours['verdict']}: {ours['measured']}" for ours in verdict["ours"]]
        rows.append([verdict["statement"], *([verdict["printed"]] if printed else []), *found])
    lines = [f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in row)} |\n" for row in (header, *rows)]
    return [lines[0], "|---" * len(header) + "|\n", *lines[1:]]


if __name__ == "__main__":
    raise SystemExit(main())
