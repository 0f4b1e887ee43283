"""The study that `runner study new` writes, against the example, the page that shows it, and its own conditions."""

import re

import pytest
from support.pages import ROOT

EXAMPLE = ROOT / "examples" / "own_paper"


@pytest.mark.costs(2)
def test_the_study_that_is_written_is_the_example_and_stands(cli, tmp_path):
    assert cli("study", "new", "mine").code == 0
    for path in EXAMPLE.iterdir():
        assert (tmp_path / "mine" / path.name).read_bytes() == path.read_bytes()
    ending = cli("reproduce", "mine", "--check", "hydra.sweeper.workers=0")
    assert (ending.code, ending.out) == (0, "outputs/reports/mine\n"), ending.err
    assert (tmp_path / "outputs" / "claims" / "mine.json").is_file()
    page = (tmp_path / "outputs" / "reports" / "mine" / "report.html").read_text()
    assert "Half the natural frequency more than doubles the settling time" in page
    assert "runner --config-dir mine robot=macro" in page
    drawn = cli("figures", "mine")
    assert drawn.code == 0, drawn.err
    assert drawn.out.splitlines()[-1] == "outputs/reports/mine/figures"
    assert {path.suffix for path in (tmp_path / "outputs" / "reports" / "mine" / "figures").iterdir()} >= {
        ".svg",
        ".csv",
    }


def test_the_page_of_the_docs_shows_the_example():
    page = (ROOT / "docs" / "paper.md").read_text()
    shown = re.findall(r"^```(?:yaml|markdown)\n(.*?)^```$", page, re.M | re.S)
    assert sorted(shown) == sorted(path.read_text() for path in EXAMPLE.iterdir())
