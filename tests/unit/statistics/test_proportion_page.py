"""Probabilities and coverages that docs/how_sure.md prints, against exact intervals of a share."""

import re

import pytest
from support.pages import ROOT
from support.share_coverage import coverage

from runner.statistics.proportion import count_share

TEXT = (ROOT / "docs" / "how_sure.md").read_text(encoding="utf-8")


def test_the_probabilities_that_the_page_tells_apart_have_disjoint_intervals():
    tenth, hundredth = count_share(1_000_000 - 999_907, 10**6), count_share(1_000_000 - 999_991, 10**6)
    assert "999907 of 1000000" in TEXT
    assert "999991 of 1000000" in TEXT
    assert hundredth.high == pytest.approx(1.71e-5, rel=3e-3)
    assert tenth.low == pytest.approx(7.51e-5, rel=3e-3)
    assert hundredth.high < tenth.low
    assert tenth.low < 1e-4 < tenth.high
    assert hundredth.low < 1e-5 < hundredth.high


def test_the_coverage_in_the_table_is_the_exact_one():
    text = TEXT.partition("## Number of pairs")[0]
    table = [line for line in text.splitlines() if re.match(r"\| [\d ]+ \|", line) and "%" in line]
    rows = {int(row[1].replace(" ", "")): row[2:-1] for row in (line.split("|") for line in table)}
    assert list(rows) == [100, 1000, 10_000, 100_000, 1_000_000]
    for n, cells in list(rows.items())[:-1]:  # the last takes seconds
        told = [float(cell.replace("%", "")) / 100.0 for cell in cells]
        exact = [coverage(n, p) for p in (0.3, 0.1, 1e-2, 1e-3, 1e-4, 1e-5)]
        assert told == pytest.approx(exact, abs=5.1e-4)
