"""docs/how_sure.md, followed command by command in one shell, and what it says of its numbers."""

import re

import pytest
from support.pages import ROOT, follow, is_shown, steps
from support.share_coverage import coverage

from runner.statistics.share import count_share

PAGE = ROOT / "docs" / "how_sure.md"
_ENDS = re.compile(r"(\d+) of (\d+) ")


def shares(text):
    """Return the share of each bound that a text shows."""
    return [count_share(int(kept), int(of)) for kept, of in _ENDS.findall(text)]


@pytest.mark.slow
def test_every_command_does_what_the_page_says(tmp_path):
    ended = follow(steps(PAGE), tmp_path, {})
    broken = [one.step.command for one in ended if one.code]
    assert broken == ["runner check latest --at-most 1e-4"]
    for one in ended:
        assert is_shown(one), (one.step.shown, one.printed)
    tenth, hundredth = (shares(one.printed)[0].rest for one in ended if "repetitions=1000000" in one.step.command)
    assert hundredth.high < tenth.low
    assert tenth.low < 1e-4 < tenth.high
    assert hundredth.low < 1e-5 < hundredth.high
    folder = tmp_path / ended[-1].printed.splitlines()[-1]
    assert {"report.html", "report.pdf"} <= {path.name for path in folder.iterdir()}


def test_the_probabilities_that_the_page_tells_apart_have_disjoint_intervals():
    tenth, hundredth = count_share(1_000_000 - 999_907, 10**6), count_share(1_000_000 - 999_991, 10**6)
    text = PAGE.read_text()
    assert "999907 of 1000000" in text
    assert "999991 of 1000000" in text
    assert hundredth.high == pytest.approx(1.71e-5, rel=3e-3)
    assert tenth.low == pytest.approx(7.51e-5, rel=3e-3)
    assert hundredth.high < tenth.low


def test_the_coverage_in_the_table_is_the_exact_one():
    table = [line for line in PAGE.read_text().splitlines() if line.startswith("| ") and "%" in line]
    rows = {int(row[1].replace(" ", "")): row[2:-1] for row in (line.split("|") for line in table)}
    assert list(rows) == [100, 1000, 10_000, 100_000, 1_000_000]
    for n, cells in list(rows.items())[:-1]:  # the last takes seconds
        told = [float(cell.replace("%", "")) / 100.0 for cell in cells]
        exact = [coverage(n, p) for p in (0.3, 0.1, 1e-2, 1e-3, 1e-4, 1e-5)]
        assert told == pytest.approx(exact, abs=5.1e-4)
