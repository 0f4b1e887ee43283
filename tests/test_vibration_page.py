"""docs/vibration.md, followed command by command in one shell."""

from support.pages import ROOT, follow, steps


def test_every_command_of_the_page_runs(tmp_path):
    ended = follow(steps(ROOT / "docs" / "vibration.md"), tmp_path, {})
    assert [one.code for one in ended] == [0, 0, 0], ended
