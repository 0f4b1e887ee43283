"""docs/compare.md, followed command by command in one shell."""

import re

import pytest
from support.pages import ROOT, follow, steps

PAGE = ROOT / "docs" / "compare.md"


@pytest.mark.slow
def test_every_command_does_what_the_page_says(tmp_path):
    ended = follow(steps(PAGE), tmp_path, {})
    assert [one.code for one in ended] == [0] * len(ended), ended
    printed = "".join(one.printed for one in ended)
    assert "the levels of controller differ in controller alone" in printed
    said = re.search(r'reads "(A and B differ.*?)"', PAGE.read_text(), re.S)[1]
    assert " ".join(said.split()) in printed
    folder = tmp_path / ended[-1].printed.splitlines()[-1]
    assert {"report.html", "report.pdf"} <= {path.name for path in folder.iterdir()}
