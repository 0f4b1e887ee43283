"""docs/tutorial.md, followed command by command in one shell."""

import pytest
from support.pages import ROOT, follow, steps

INSTALL = 3  # commands that install and choose a folder; the test stands in for them
FINDINGS = 1  # exit code of `runner doctor` where there is something to mend


@pytest.mark.slow
def test_every_command_does_what_the_tutorial_says(tmp_path):
    to_follow = steps(ROOT / "docs" / "tutorial.md")[INSTALL:]
    ended = follow(to_follow, tmp_path, {"EXAMPLE": str(ROOT / "examples" / "own_robot")})
    for one in ended:
        assert one.code in ((0, FINDINGS) if one.step.command.startswith("runner doctor") else (0,)), one
    assert ended[-1].printed.splitlines()[-1].startswith("good: 1 metrics of 1 run")
    assert len(list((tmp_path / "outputs/runs").iterdir())) == 2 + 16
    assert len(list((tmp_path / "outputs/reports").glob("*/report.pdf"))) == 2
    assert len((tmp_path / "mine/robot/lbr_iiwa.yaml").read_text().splitlines()) <= 15
