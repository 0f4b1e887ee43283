"""docs/figures_and_tables.md, followed command by command in one shell."""

import pytest
from support.pages import ROOT, follow, steps


@pytest.mark.slow
def test_every_command_of_the_page_does_what_it_says(tmp_path):
    ended = follow(steps(ROOT / "docs" / "figures_and_tables.md"), tmp_path, {})
    assert [one.code for one in ended] == [0] * len(ended), ended
    assert any("| controller | noise.position (rad) | " in one.printed for one in ended)
    assert r"\toprule" in (tmp_path / "table.tex").read_text()
    assert (tmp_path / "torque.csv").read_text().startswith("controller,noise.position,cells,failed,peak_torque.median")
    assert len(list((tmp_path / "figures").glob("s3-figure-2-*"))) == 3
    assert list((tmp_path / "outputs" / "reports").glob("*/figures/*.pdf"))
