"""The example of a work in a folder, made by the wheel; and the page of the docs that shows it."""

import re

import pytest
from support.pages import ROOT

EXAMPLE = ROOT / "examples" / "own_paper"


@pytest.mark.costs(5)
def test_the_work_that_the_wheel_writes_is_the_example_and_stands(installed, tmp_path):
    assert installed.call(tmp_path, "runner", "work", "new", "mine").returncode == 0
    for path in EXAMPLE.iterdir():
        assert (tmp_path / "mine" / path.name).read_bytes() == path.read_bytes()
    ending = installed.call(tmp_path, "runner", "reproduce", "mine", "--check")
    assert (ending.returncode, ending.stdout) == (0, "outputs/reports/mine\n"), ending.stderr
    page = (tmp_path / "outputs" / "reports" / "mine" / "report.html").read_text()
    assert "Half the natural frequency more than doubles the settling time" in page
    assert "runner --config-dir mine robot=macro" in page


def test_the_page_of_the_docs_shows_the_example():
    page = (ROOT / "docs" / "paper.md").read_text()
    shown = re.findall(r"^```(?:yaml|markdown)\n(.*?)^```$", page, re.M | re.S)
    assert sorted(shown) == sorted(path.read_text() for path in EXAMPLE.iterdir())
