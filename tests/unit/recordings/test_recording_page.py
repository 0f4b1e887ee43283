"""docs/recordings.md, followed command by command in one shell, and what it says of its numbers."""

import re

import pytest
from support.pages import ROOT, follow, steps

from runner.config.units import WRITTEN

PAGE = ROOT / "docs" / "recordings.md"


@pytest.mark.slow
def test_every_command_does_what_the_page_says(tmp_path):
    ended = follow(steps(PAGE), tmp_path, {"EXAMPLES": str(ROOT / "examples")})
    assert [one.code for one in ended] == [0, 0], ended
    printed = ended[1].printed
    assert float(re.search(r"time 0 is ([\d.]+) s", printed)[1]) == pytest.approx(0.7313, abs=0.001)
    identified = [
        float(value) for value in re.findall(r"^q\d +(?:viscous|Coulomb) .*? +([\d.]+) +[\d.]+ to", printed, re.M)
    ]
    assert identified == pytest.approx([1.2, 1.5, 0.8, 1.0, 0.5, 0.6], rel=0.05)
    folder = tmp_path / printed.splitlines()[-1]
    assert {"report.html", "report.pdf"} == {path.name for path in folder.iterdir()}


def test_the_units_of_the_page_are_all_there_are():
    text = PAGE.read_text(encoding="utf-8")
    for unit in ("s", "rad", "m", "N m", "N"):
        *others, last = WRITTEN[unit]
        assert ", ".join([*others, last]) in text or f"{', '.join(others)} or {last}" in text, unit


def test_the_map_of_the_page_can_be_read(tmp_path):
    from runner.recordings.columns_map import read_map

    lines = PAGE.read_text(encoding="utf-8").splitlines()
    first = lines.index("    time: {column: time_ms, unit: ms}")
    shown = [line.removeprefix("    ") for line in lines[first : first + 7]]
    (tmp_path / "map.yaml").write_text("\n".join(shown))
    said, _ = read_map(tmp_path / "map.yaml", ["q1", "q2"], ["rad", "rad"])
    assert len(said.columns) == 5
