"""Figures of curves as data for Plotly: strings, ranges, colours, gaps."""

import base64
import json

import numpy as np
import pytest
from support.sample_document import HOSTILE, curves

from runner.reporting.charts.interactive import neutral, plotly_spec
from runner.reporting.document import Curves, Panel, Series


def panel_of(**changes):
    x = np.linspace(1.0, 100.0, 20)
    return Curves("", [Panel("", "x", "y", [Series("a", x, x)], **changes)])


def decoded(values):
    return np.frombuffer(base64.b64decode(values["bdata"]), dtype=values["dtype"])


@pytest.mark.parametrize("text", HOSTILE)
def test_no_text_reaches_plotly_as_markup(text):
    written = json.dumps(plotly_spec(curves(text)))
    assert "<" not in written.replace("<br>", "")
    assert "$" not in written


def test_neutral_shows_tags_and_entities():
    assert neutral("<b> &lt; $x$") == "&lt;b&gt; &amp;lt; &#36;x&#36;"


def test_order_and_names_are_those_of_the_series():
    names = [trace["name"] for trace in plotly_spec(curves("e"))[0]["traces"] if trace.get("fill") is None]
    assert names == ["e", "", "e"]


def test_a_nameless_curve_stands_in_no_legend():
    shown = [trace["showlegend"] for trace in plotly_spec(curves("e"))[0]["traces"]]
    assert shown == [False, True, False, True]  # the first is the band


def test_arrays_are_single_precision():
    trace = plotly_spec(panel_of())[0]["traces"][0]
    assert np.allclose(decoded(trace["x"]), np.linspace(1, 100, 20))


def test_ranges_of_logarithmic_axes_are_exponents():
    layout = plotly_spec(panel_of(x_log=True, x_range=(1.0, 100.0)))[0]["layout"]
    assert layout["xaxis"]["type"] == "log"
    assert layout["xaxis"]["range"] == [0.0, 2.0]


def test_a_range_that_a_logarithmic_axis_cannot_show_is_left_to_plotly():
    assert "range" not in plotly_spec(panel_of(y_log=True, y_range=(0.0, 1.0)))[0]["layout"]["yaxis"]


def test_what_single_precision_cannot_hold_becomes_a_gap():
    y = np.array([1.0, np.inf, 2.0, 1e39, -1e39, 3e38])
    trace = plotly_spec(Curves("", [Panel("", "", "", [Series("", np.arange(6.0), y)])]))[0]["traces"][0]
    assert np.isnan(decoded(trace["y"])).tolist() == [False, True, False, True, True, False]


def test_curves_that_belong_together_share_a_color():
    x = np.arange(3.0)
    series = [Series("a", x, x, color=1), Series("b", x, x), Series("c", x, x, color=1), Series("d", x, x)]
    assert plotly_spec(Curves("", [Panel("", "", "", series)]))[0]["colors"] == [1, 0, 1, 2]


def test_points_carry_their_hints_and_runs():
    x = np.array([1.0, 2.0])
    pointed = Series("a", x, x, "points", hints=["<one>", "two"], runs=["ab", "cd"])
    (spec,) = plotly_spec(Curves("", [Panel("", "x", "y", [pointed])]))
    assert spec["traces"][0]["text"] == ["&lt;one&gt;", "two"]
    assert spec["traces"][0]["customdata"] == ["ab", "cd"]
    assert spec["layout"]["hovermode"] == "closest"


def test_an_axis_of_names_has_a_place_for_each():
    x = np.arange(2.0)
    (spec,) = plotly_spec(Curves("", [Panel("", "x", "y", [Series("", x, x)], x_names=["one_way", "<b>"])]))
    assert spec["layout"]["xaxis"]["tickvals"] == [0, 1]
    assert spec["layout"]["xaxis"]["ticktext"] == ["one_way", "&lt;b&gt;"]
