"""Numbers on pages: never torn, never parted from their unit, one map with its answers."""

import numpy as np
import pytest

from runner.reporting.answer_map import AnswerMap, MapCell
from runner.reporting.document import Curves, Document, Notice, Panel, Section, Series, Text
from runner.reporting.render import render_html, render_pdf
from runner.reporting.templating import bind_units, name_parts


@pytest.mark.parametrize(
    ("text", "bound"),
    [
        ("0.35 mm, 8 pairs", "0.35_mm, 8_pairs"),
        ("by 4585 N² m² s.", "by 4585_N²_m²_s."),
        ("63 N m (3·10⁻⁴ m)", "63_N_m (3·10⁻⁴_m)"),
        ("12 % of 2 rad/s at 3 ms", "12_% of 2_rad/s at 3_ms"),
        ("3 metres in 4 columns, N m", "3 metres in 4 columns, N m"),
    ],
)
def test_a_number_stays_with_its_unit(text, bound):
    assert bind_units(text).replace("\u00a0", "_") == bound


def test_names_break_behind_their_parts_and_numbers_stay_whole():
    assert name_parts("noise.position=0.0001") == ["noise.", "position=", "0.0001"]
    assert name_parts("k=tag(log,interval(2,80))") == ["k=", "tag(", "log,", "interval(", "2,", "80))"]
    assert name_parts("a_b<c") == ["a_", "b&lt;c"]


def test_a_page_keeps_numbers_with_units():
    page = render_html(Document("Title", "", "An error of 0.35 mm.", [], "", key_numbers=[("e", "4 mm to 8.7 mm", "")]))
    assert "0.35\u00a0mm" in page
    assert "<strong>4\u00a0mm to 8.7\u00a0mm</strong>" in page


def test_titles_keep_numbers_with_units():
    panels = [Panel("at 10 mm", "t (s)", "y (m)", [Series("", np.zeros(2), np.zeros(2))])]
    notice = Notice("warning", "A limit of 50 N m", "")
    document = Document("Within 2 mm", "noise 3 mm", "", [Section("By 4 mm", [notice, Curves("", panels, 1)])], "")
    page = render_html(document)
    page = page[page.index("<h1") :]
    for text in ("Within 2\u00a0mm", "noise 3\u00a0mm", "By 4\u00a0mm", "A limit of 50\u00a0N\u00a0m", "at 10\u00a0mm"):
        assert text in page


def test_the_map_of_answers_is_on_the_first_screen_of_page_and_paper():
    rows = [("a<b", [MapCell("law_one -20 % *", 1)]), ("c", [MapCell("equal")])]
    shown = AnswerMap("Where.", "robot", ["noise=1"], rows)
    document = Document("Title", "", "The answer.\nMore.", [Section("One", [Text("words")])], "", map=shown)
    page = render_html(document)
    assert page.index("The answer.") < page.index('class="answer-map"') < page.index("More.")
    assert "a&lt;b" in page
    assert page.count('class="won"') == 1
    assert "law_<wbr>one -20\u00a0% *" in page
    assert render_pdf(document).startswith(b"%PDF")
