"""Shared legend: one for panels of the same curves, in the figure and on the page."""

import re

import numpy as np

from runner.reporting.charts.figure import Panel, Series, shares_legend
from runner.reporting.charts.interactive import plotly_spec
from runner.reporting.charts.static import draw
from runner.reporting.document import Curves

X = np.arange(3.0)


def panel(*names, style="line"):
    return Panel("p", "x (m)", "y (m)", [Series(name, X, X, style) for name in names])


def height(svg):
    return float(re.search(r'viewBox="[-\d.]+ [-\d.]+ [\d.]+ ([\d.]+)"', svg)[1])


def test_one_legend_serves_panels_of_the_same_curves():
    assert shares_legend([panel("a", "b"), panel("a", "b")])
    assert not shares_legend([panel("a", "b")])
    assert not shares_legend([panel("a", "b"), panel("a", "c")])
    assert not shares_legend([panel("a"), panel("a", style="dashed")])
    assert not shares_legend([panel(""), panel("")])


def test_lines_without_a_name_do_not_count():
    line = Series("", X, X, "dotted", label="printed 1 m")
    with_line = Panel("p", "x (m)", "y (m)", [*panel("a", "b").series, line])
    assert shares_legend([panel("a", "b"), with_line])
    drawing = draw(Curves("c", [with_line, panel("a", "b")]))
    assert "<!-- printed 1 m -->" in drawing
    assert drawing.count("<!-- a -->") == 1
    (*_, trace) = plotly_spec(Curves("c", [with_line]))[0]["traces"]
    assert (trace["mode"], trace["text"], trace["showlegend"]) == ("lines+text", ["", "", "printed 1 m"], False)


def test_a_figure_with_one_legend_is_lower_than_with_one_for_each_row():
    names = [f"curve number {index}" for index in range(4)]
    same = [panel(*names) for _ in range(4)]
    other = [*same[:3], panel(*names[:3], "another")]
    assert height(draw(Curves("c", same))) < height(draw(Curves("c", other)))


def test_the_page_shows_it_below_the_first_panel():
    first, second = plotly_spec(Curves("c", [panel("a", "b"), panel("a", "b")]))
    assert (first["legend"], second["legend"], first["together"]) == (True, False, True)
    first, second = plotly_spec(Curves("c", [panel("a"), panel("b")]))
    assert (first["legend"], second["legend"], first["together"]) == (True, True, False)


def test_a_key_without_points_is_in_the_legend_and_has_the_curves_of_its_style():
    empty = np.zeros(0)
    keys = [Series(name, empty, empty, style) for name, style in (("fitted", "line"), ("printed", "dashed"))]
    drawn = [Series("", X, X, style) for style in ("line", "dashed", "dashed", "dotted")]
    traces = plotly_spec(Curves("c", [Panel("p", "x (m)", "y (m)", [*keys, *drawn])]))[0]["traces"]
    assert [trace["showlegend"] for trace in traces] == [True, True, False, False, False, False]
    assert [trace["legendgroup"] for trace in traces] == ["0", "1", "0", "1", "1", "5"]
    # Plotly leaves out curves of no points, and their entries with them.
    assert all(trace["x"]["bdata"] and trace["y"]["bdata"] for trace in traces)
