"""Units and the map of columns that docs/recordings.md prints, against what is read."""

from support.pages import ROOT

from runner.recordings.columns_map import read_map
from runner.schema.units import WRITTEN

TEXT = (ROOT / "docs" / "recordings.md").read_text(encoding="utf-8")


def test_the_units_of_the_page_are_all_there_are():
    for unit in ("s", "rad", "m", "N m", "N"):
        *others, last = WRITTEN[unit]
        assert ", ".join([*others, last]) in TEXT or f"{', '.join(others)} or {last}" in TEXT, unit


def test_the_map_of_the_page_can_be_read(tmp_path):
    lines = TEXT.splitlines()
    first = lines.index("    time: {column: time_ms, unit: ms}")
    shown = [line.removeprefix("    ") for line in lines[first : first + 7]]
    (tmp_path / "map.yaml").write_text("\n".join(shown))
    said, _ = read_map(tmp_path / "map.yaml", ["q1", "q2"], ["rad", "rad"])
    assert len(said.columns) == 5
