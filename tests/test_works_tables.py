"""The tables of docs/works.md are those of the works' reports."""

import json
import re

import pytest

from bench import make_works_tables
from bench.make_works_tables import PAGE, made_from


def verdict(number, printed="9 mm", **ours):
    found = [
        {"preset": "sound", "way": way, "measured": measured, "verdict": "holds"} for way, measured in ours.items()
    ]
    return {"claim": number, "statement": f"Statement {number}", "printed": printed, "ours": found}


WORKS = {
    "thesis": {"verdicts": [verdict("1", full="8 mm"), verdict("2", full="7 | mm"), verdict("3", full="6 mm")]},
    "meca500": {"verdicts": [verdict("1", "", **{"": "within 1 %"})]},
}
STALE = """Before.

<!-- claims of thesis: 3, 2 -->
| stale |
|---|
| 0.1 |

Between.

<!-- claims of meca500: 1 -->
| stale |

After.
"""


def test_rows_are_made_in_the_order_that_the_page_names():
    assert made_from(STALE, WORKS).splitlines()[2:12] == [
        "<!-- claims of thesis: 3, 2 -->",
        "| claim | printed | full |",
        "|---|---|---|",
        "| Statement 3 | 9 mm | holds: 6 mm |",
        r"| Statement 2 | 9 mm | holds: 7 \| mm |",
        "",
        "Between.",
        "",
        "<!-- claims of meca500: 1 -->",
        "| claim | found |",
    ]


def test_a_claim_that_no_report_has_is_an_error():
    with pytest.raises(KeyError):
        made_from(STALE.replace("3, 2", "4"), WORKS)


def test_check_tells_a_stale_page(monkeypatch, tmp_path, capsys):
    page, file = tmp_path / "works.md", tmp_path / "works.json"
    page.write_text(STALE)
    file.write_text(json.dumps(WORKS))
    monkeypatch.setattr(make_works_tables, "PAGE", page)
    assert make_works_tables.main([str(file), "--check"]) == 1
    assert page.read_text() == STALE
    assert make_works_tables.main([str(file)]) == 0
    assert make_works_tables.main([str(file), "--check"]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == "docs/works.md: as reproduced"


def test_every_work_has_a_table():
    assert re.findall(r"<!-- claims of (\w+): ", PAGE.read_text(encoding="utf-8")) == ["thesis", "xarm7", "meca500"]
