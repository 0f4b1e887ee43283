"""Writes the tables of docs/studies.md of results from what was reproduced: `python -m tools.docs.study_tables FILE`.

`runner reproduce all --json > FILE` writes FILE, for all studies or for some. Each table is below a comment that names
the study and its claims. Their verdicts are stored in tools/docs/studies.json. A test compares the page with that file,
because only whole runs have them. `--check` writes nothing, and exits with 1 if the page differs from FILE.
"""

import argparse
import json
import re
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

PAGE = Path(__file__).resolve().parents[2] / "docs" / "studies.md"
STORED = Path(__file__).with_name("studies.json")
_TABLE = re.compile(r"(<!-- claims of (\w+): ([\d, ]+) -->\n)((?:\|.*\n)+)")

Verdicts = Mapping[str, Sequence[Mapping[str, Any]]]
"""The verdicts of each study by its name."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Write the tables and what they are made of, or check them; return the exit code."""
    parser = argparse.ArgumentParser(prog="python -m tools.docs.study_tables", description=__doc__)
    parser.add_argument("file", type=Path, help="output of `runner reproduce all --json`")
    parser.add_argument("--check", action="store_true", help="change nothing; exit 1 where it differs")
    options = parser.parse_args(arguments)
    text, stored = PAGE.read_text(encoding="utf-8"), json.loads(STORED.read_text(encoding="utf-8"))
    reproduced = json.loads(options.file.read_text(encoding="utf-8"))
    known = stored | {name: study["verdicts"] for name, study in reproduced.items()}
    kept = {name: known[name] for _, name, *_ in _TABLE.findall(text)}
    made = made_from(text, kept)
    if options.check:
        same = made == text and kept == stored
        print(f"docs/studies.md: {'as reproduced' if same else 'its tables are not what was reproduced'}")
        return int(not same)
    STORED.write_text(json.dumps(kept, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    PAGE.write_text(made, encoding="utf-8")
    return 0


def made_from(page: str, studies: Verdicts) -> str:
    """Return a page with its tables made from the verdicts of studies.

    Raises:
        KeyError: if a study or claim is missing.
    """

    def table(found: re.Match[str]) -> str:
        by_number = {verdict["claim"]: verdict for verdict in studies[found[2]]}
        return found[1] + "".join(_lines([by_number[number] for number in found[3].split(", ")]))

    return _TABLE.sub(table, page)


def _lines(verdicts: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return the lines of a table of claims; one without a printed value has no column for it."""
    printed = ["printed"] if any(verdict["printed"] for verdict in verdicts) else []
    header = ["claim", *printed, *(ours["way"] or "simulated" for ours in verdicts[0]["ours"])]
    rows: list[list[str]] = []
    for verdict in verdicts:
        rows.append([verdict["statement"], *([verdict["printed"]] if printed else []), *map(_found, verdict["ours"])])
    lines = [f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in row)} |\n" for row in (header, *rows)]
    return [lines[0], "|---" * len(header) + "|\n", *lines[1:]]


def _found(ours: Mapping[str, Any]) -> str:
    hangs = f"; depends on {', '.join(ours['hangs'])}" if ours["hangs"] else ""
    return f"{ours['verdict']}: {ours['measured']}{hangs}"


if __name__ == "__main__":
    raise SystemExit(main())
