"""Panels whose ordinates are named places, in both drawings."""

import numpy as np

from runner.reporting.charts.figure import Curves, Panel, Series
from runner.reporting.charts.interactive import plotly_spec
from runner.reporting.charts.static import draw

NAMES = [f"family {number}" for number in range(16)]
PANEL = Panel("", "variations", "", [Series("", np.arange(16.0), np.arange(16.0), "points")], y_names=NAMES)


def test_the_page_names_the_rows_of_a_panel():
    axis = plotly_spec(Curves("", [PANEL]))[0]["layout"]["yaxis"]
    assert axis["tickvals"] == list(range(16))
    assert axis["ticktext"] == NAMES


def test_paper_names_each_row():
    text = draw(Curves("", [PANEL]))
    assert all(name in text for name in NAMES)
