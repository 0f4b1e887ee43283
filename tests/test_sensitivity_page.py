"""docs/sensitivity.md, followed command by command in one shell."""

import pytest
from support.pages import ROOT, follow, steps


@pytest.mark.slow
def test_every_command_of_the_page_does_what_it_says(tmp_path):
    ended = follow(steps(ROOT / "docs" / "sensitivity.md"), tmp_path, {})
    assert [one.code for one in ended] == [0, 0], ended
    shown = next(line.split() for line in ended[1].printed.splitlines() if "mass.q2" in line)
    assert shown[:6] == ["mass.q2", "1", "kg", "83.9", "N", "m"]
