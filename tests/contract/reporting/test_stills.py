"""Figures of curves as SVG: any string, odd values, legends."""

import json
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
from support.sample_document import HOSTILE, curves

from runner.reporting.charts import static
from runner.reporting.charts.interactive import plotly_spec
from runner.reporting.charts.sheet import REPORT, column
from runner.reporting.document import Curves, Panel, Series

X = np.linspace(0.0, 1.0, 5000)
CURVES = {
    "curves": curves(),
    "in rows": Curves("", curves().panels * 3, columns=2),
    "logarithmic": Curves("", [replace(curves().panels[0], x_log=True, y_log=True)]),
    "less than a decade": Curves("", [Panel("", "time (s)", "error (m)", [Series("a", X, X + 1.0)], y_log=True)]),
    "long": Curves("", [Panel("", "time (s)", "error (m)", [Series("a", X, np.sin(9 * X), low=-X, high=X)])]),
    "names": Curves(
        "",
        [
            Panel(
                "",
                "",
                "error (m)",
                [Series("a", np.arange(3.0), np.arange(3.0), "points")],
                x_names=["computed torque", "a name of one_very_long part and more of it", "c"],
            )
        ],
    ),
}


@pytest.mark.parametrize("name", CURVES)
def test_a_drawing_is_as_recorded(name, as_recorded):
    as_recorded("drawings", name, static.draw(CURVES[name]))
    as_recorded("drawings", f"{name} on a narrow column", static.draw(CURVES[name], column(80)))
    as_recorded("drawings", f"{name} in HTML", plotly_spec(CURVES[name]))


@pytest.mark.parametrize("text", HOSTILE)
def test_any_text_gives_a_valid_drawing(text):
    ElementTree.fromstring(static.draw(curves(text)))


def test_the_same_figure_gives_the_same_text():
    assert static.draw(curves()) == static.draw(curves())


def test_text_is_drawn_and_no_date_is_written():
    drawing = static.draw(curves())
    assert "<text" not in drawing
    assert "dc:date" not in drawing


def test_logarithmic_axes_take_values_that_have_no_logarithm():
    x = np.array([0.0, 1.0, 10.0])
    panel = Panel("", "x", "y", [Series("a", x, -x)], x_log=True, y_log=True, y_range=(-1.0, 1.0))
    ElementTree.fromstring(static.draw(Curves("", [panel])))


def test_legend_entries_read_along_the_rows():
    x = np.arange(3.0)
    names = ["one", "two", "three", "four", "five"]
    panels = [Panel("", "", "", [Series(name, x, x) for name in [*names, last]]) for last in "abc"]
    drawing = static.draw(Curves("", panels, columns=3))
    # matplotlib fills columns, and names every drawn text in a comment.
    assert drawing.index("<!-- one -->") < drawing.index("<!-- three -->") < drawing.index("<!-- two -->")


@pytest.mark.parametrize("values", [np.zeros(0), np.full(3, np.nan), np.array([np.inf, 1.0, -np.inf]), np.ones(1)])
@pytest.mark.parametrize("log", [False, True])
def test_odd_values_are_no_error(values, log):
    x = np.arange(float(values.size))
    series = Series("a", x, values, low=values - 1, high=values + 1)
    other = Series("b", x, values)
    odd = Curves("", [Panel("", "", "", [series, other], x_log=log, y_log=log, x_range=(1.0, 1.0))])
    for sheet in (REPORT, column(80)):
        ElementTree.fromstring(static.draw(odd, sheet))
    json.dumps(plotly_spec(odd), allow_nan=False)


def test_figures_without_panels_or_curves_are_no_error():
    for empty in (Curves("", []), Curves("", [Panel("t", "x", "y", [])])):
        ElementTree.fromstring(static.draw(empty))
        plotly_spec(empty)


@pytest.mark.parametrize("text", HOSTILE)
def test_an_axis_of_names_takes_any_text(text):
    x = np.arange(2.0)
    named = Curves("", [Panel("", "", "", [Series("", x, x)], x_names=[text, "two"])])
    assert "<!-- two -->" in static.draw(named)
