"""The tables of docs/studies.md are those of the verdicts that are stored, and these are of the studies' claims."""

import json
import re
from typing import get_args

import pytest

from runner.papers.reporting.equation import EquationVerdict
from runner.papers.reporting.published_claims import Verdict, load_claims, load_statements
from tools.docs import study_tables
from tools.docs.study_tables import PAGE, STORED, made_from

KEPT = json.loads(STORED.read_text(encoding="utf-8"))


def verdict(number, printed="9 mm", hangs=(), **ours):
    found = [
        {
            "preset": "full_equations",
            "way": way,
            "measured": measured,
            "verdict": "matches",
            "hangs": dict.fromkeys(hangs, ""),
        }
        for way, measured in ours.items()
    ]
    return {"claim": number, "statement": f"Statement {number}", "printed": printed, "ours": found}


STUDIES = {
    "thesis": [verdict("1", full="8 mm"), verdict("2", hangs=("the seed",), full="7 | mm"), verdict("3", full="6 mm")],
    "meca500": [verdict("1", "", **{"": "within 1 %"})],
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


def test_the_page_says_what_is_stored():
    page = PAGE.read_text(encoding="utf-8")
    assert made_from(page, KEPT) == page
    assert re.findall(r"<!-- claims of (\w+): ", page) == list(KEPT) == ["thesis", "xarm7", "meca500"]


@pytest.mark.parametrize("study", KEPT)
def test_what_is_stored_is_of_the_claims_as_they_are(study):
    stated = load_statements(study) if study == "meca500" else load_claims(study)
    assert [each["statement"] for each in KEPT[study]] == [each.statement for each in stated]
    words = {ours["verdict"] for each in KEPT[study] for ours in each["ours"]}
    assert words <= {*get_args(Verdict), *get_args(EquationVerdict)}


def test_rows_are_made_in_the_order_that_the_page_names():
    assert made_from(STALE, STUDIES).splitlines()[2:12] == [
        "<!-- claims of thesis: 3, 2 -->",
        "| claim | printed | full |",
        "|---|---|---|",
        "| Statement 3 | 9 mm | matches: 6 mm |",
        r"| Statement 2 | 9 mm | matches: 7 \| mm; depends on the seed |",
        "",
        "Between.",
        "",
        "<!-- claims of meca500: 1 -->",
        "| claim | simulated |",
    ]


def test_a_claim_that_no_report_has_is_an_error():
    with pytest.raises(KeyError):
        made_from(STALE.replace("3, 2", "4"), STUDIES)


def test_check_tells_a_stale_page(monkeypatch, tmp_path, capsys):
    page, file, stored = tmp_path / "studies.md", tmp_path / "studies.json", tmp_path / "stored.json"
    page.write_text(STALE)
    file.write_text(json.dumps({study: {"verdicts": verdicts} for study, verdicts in STUDIES.items()}))
    stored.write_text("{}")
    monkeypatch.setattr(study_tables, "PAGE", page)
    monkeypatch.setattr(study_tables, "STORED", stored)
    assert study_tables.main([str(file), "--check"]) == 1
    assert page.read_text() == STALE
    assert study_tables.main([str(file)]) == 0
    assert study_tables.main([str(file), "--check"]) == 0
    assert capsys.readouterr().out.splitlines()[-1] == "docs/studies.md: as reproduced"
    assert json.loads(stored.read_text()) == STUDIES
