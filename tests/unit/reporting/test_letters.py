"""Widths of letters, and labels broken by them."""

import re
import tomllib
from pathlib import Path

import numpy as np
import pytest
import yaml
from support.sample_document import playback

from runner.base.paths import templates_dir
from runner.reporting.charts import static
from runner.reporting.charts.interactive import plotly_spec
from runner.reporting.charts.letters import COMPUTER_MODERN, SANS, text_width, wrap
from runner.reporting.charts.sheet import wrap_text
from runner.reporting.document import Curves, Document, Map, Maps, Panel, Section, Series
from runner.reporting.render import render_html

X = np.arange(3.0)


def panel(label="y", y=X):
    return Panel("", "x", label, [Series("a", X, y)])


def test_a_letter_is_as_wide_as_its_font_says():
    assert text_width("m" * 10, 8.0) == pytest.approx(10 * text_width("m", 8.0))
    assert text_width("m", 16.0) == pytest.approx(2 * text_width("m", 8.0))
    assert text_width("0", 10.0, COMPUTER_MODERN) == pytest.approx(5.0, abs=0.01)  # half an em
    assert text_width("iiii", 8.0, SANS) < text_width("mm", 8.0, SANS)
    assert text_width("\u00a0", 8.0) == text_width(" ", 8.0)


def test_lines_are_within_the_width_and_words_stay_whole():
    lines = wrap("difference in largest tracking error (mm)", 150.0, 12.0)
    assert " ".join(lines) == "difference in largest tracking error (mm)"
    assert max(text_width(line, 12.0) for line in lines) <= 150.0
    assert wrap("immeasurable", 1.0, 12.0) == ["immeasurable"]


def test_the_label_of_the_first_figure_of_a_report_fits_its_axis():
    """Fault 7: 41 letters, of which a page showed 38."""
    (drawn,) = plotly_spec(Curves("", [panel("difference in largest tracking error (mm)")]))
    lines = drawn["layout"]["yaxis"]["title"]["text"].split("<br>")
    assert len(lines) > 1
    assert max(text_width(line, 12.0) for line in lines) <= 150.0


@pytest.mark.parametrize("unit", ["N m", "N² m² s"])
def test_a_unit_is_on_one_line(unit):
    """Fault 6: "largest torque (N / m)"."""
    for width in range(10, 24):
        lines = wrap_text(f"largest torque ({unit})", width).split("\n")
        assert any(line.endswith(f"({unit})".replace(" ", "\u00a0")) for line in lines), width
    (drawn,) = plotly_spec(Curves("", [panel(f"largest torque of this joint ({unit})")]))
    assert f"({unit})".replace(" ", "\u00a0") in drawn["layout"]["yaxis"]["title"]["text"]


def test_a_panel_without_a_value_says_never():
    """Fault 15: an empty panel of a metric that no cell reached."""
    empty, full = (Curves("", [panel(y=y)]) for y in (np.full(3, np.nan), X))
    assert [bool(plotly_spec(each)[0]["layout"].get("annotations")) for each in (empty, full)] == [True, False]
    texts = [[text.get_text() for text in static.as_figure(each).axes[0].texts] for each in (empty, full)]
    assert texts == [["never"], []]


def test_the_scale_of_colours_is_drawn_as_vectors():
    """Fault 15: a raster of 100 dots an inch."""
    cells = Maps("", "v", [Map("", "x", "y", ["1", "2"], ["a"], np.array([[1.0, 2.0]]), np.zeros((1, 2), dtype=bool))])
    assert "<image" not in static.draw(cells)
    assert b"/Subtype /Image" not in static.draw_pdf(cells)


def test_a_page_without_scripts_shows_its_first_figure_and_says_where_the_others_are():
    """Fault 9: a page was blank where figures belong."""
    blocks = [Curves("1", [panel()]), Curves("2", [panel()]), playback()]
    page = render_html(Document("", "", "", [Section("", blocks)], ""))
    told = re.findall(r'<div class="no-script">(.*?)</div>', page, re.S)
    assert ["<img" in each for each in told] == [True, False, False]
    assert all("need scripts, which are off here; report.pdf has" in each for each in told)
    assert 'querySelectorAll(".no-script")' in (templates_dir() / "report.js").read_text()


def test_a_printed_page_cuts_no_table():
    """Fault 10: scroll bars on paper, and the last column cut."""
    printed = (templates_dir() / "style.css").read_text().partition("@media print")[2]
    assert ".scroll { overflow: visible;" in printed


def test_the_citation_has_the_version_and_its_date():
    """Fault 15: cited without a year."""
    root = Path(__file__).parents[3]
    cited = yaml.safe_load((root / "CITATION.cff").read_text())
    version = tomllib.loads((root / "pyproject.toml").read_text())["project"]["version"]
    changes = re.search(rf"^## \[{re.escape(version)}\] - (\S+)", (root / "CHANGELOG.md").read_text(), re.M)
    assert (str(cited["version"]), str(cited["date-released"])) == (version, changes[1])
