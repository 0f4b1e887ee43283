"""Points of figures as CSV, in the units and columns of the figures."""

import csv
import io

import numpy as np
from support.sample_document import SVG, playback

from runner.base.paths import templates_dir
from runner.reporting.charts.scales import curves_in_readable_units, maps_in_readable_units
from runner.reporting.document import Curves, Map, Maps, Panel, Picture, Series
from runner.reporting.export.figures import as_csv

T = np.array([0.0, 1.0, 2.0])


def rows(figure):
    return list(csv.reader(io.StringIO(as_csv(figure).decode())))


def test_a_curve_and_its_band_in_the_units_that_are_shown():
    y = np.array([0.001, np.nan, 0.003])
    figure = Curves("", [Panel("Tip", "time (s)", "error (m)", [Series("x", T, y, low=y - 0.001, high=y + 0.001)])])
    found = rows(curves_in_readable_units(figure))
    assert found == [
        ["panel", "curve", "x axis", "x", "y axis", "y", "low", "median", "high"],
        ["Tip", "x", "time (s)", "0.0", "error (mm)", "", "0.0", "1.0", "2.0"],
        ["Tip", "x", "time (s)", "1.0", "error (mm)", "", "", "", ""],
        ["Tip", "x", "time (s)", "2.0", "error (mm)", "", "2.0", "3.0", "4.0"],
    ]


def test_what_is_beyond_every_number_is_an_empty_field_in_curves_and_maps():
    """Question 19: `inf` in a column makes DuckDB read it as text."""
    values = np.array([[np.inf, np.nan]])
    cells = Map("M", "x", "y", ["1", "2"], ["a"], values, np.isnan(values))
    assert [row[-1] for row in rows(Maps("", "error (m)", [cells]))[1:]] == ["", ""]
    curve = Series("a", T, np.array([np.inf, 1.0, -np.inf]))
    assert [row[5] for row in rows(Curves("", [Panel("", "x", "y", [curve])]))[1:]] == ["", "1.0", ""]


def test_points_moved_apart_for_the_eye_are_written_at_their_place():
    """Fault 3: 1.7 rad of plotting noise below an axis of 0.001 rad."""
    dots = Series("a pair", np.repeat([0.0, 1.0], 3), np.arange(6.0), "points", shift=np.tile([-0.3, 0.0, 0.3], 2))
    bars = Series("difference", T[:2], T[:2], "points", low=T[:2] - 1.0, high=T[:2] + 1.0)
    found = rows(Curves("", [Panel("", "noise (rad)", "y", [dots, bars], x_names=["all", "0.001"])]))[1:]
    assert [row[3] for row in found] == ["all"] * 3 + ["0.001"] * 3 + ["all", "0.001"]
    assert [row[5:] for row in found[-2:]] == [["", "-1.0", "0.0", "1.0"], ["", "0.0", "1.0", "2.0"]]


def test_no_point_is_left_out():
    x = np.arange(50_000.0)
    assert len(rows(Curves("", [Panel("", "x", "y", [Series("a", x, np.sin(x))])]))) == 50_001


def test_names_below_an_axis_stand_for_their_places():
    figure = Curves("", [Panel("", "robot", "y", [Series("", T[:2], T[:2])], x_names=["macro", "mini"])])
    assert [row[3] for row in rows(figure)[1:]] == ["macro", "mini"]


def test_a_map_has_a_row_for_each_cell():
    values = np.array([[0.001, 0.002], [np.nan, 0.004]])
    panel = Map("M", "mass (kg)", "robot", ["1", "2"], ["macro", "mini"], values, np.isnan(values))
    found = rows(maps_in_readable_units(Maps("", "error (m)", [panel], log=True)))
    assert found[0] == ["panel", "x axis", "x", "y axis", "y", "quantity", "value"]
    assert found[1:] == [
        ["M", "mass (kg)", "1", "robot", "macro", "error (mm)", "1.0"],
        ["M", "mass (kg)", "2", "robot", "macro", "error (mm)", "2.0"],
        ["M", "mass (kg)", "1", "robot", "mini", "error (mm)", ""],
        ["M", "mass (kg)", "2", "robot", "mini", "error (mm)", "4.0"],
    ]


def test_the_columns_are_those_that_the_html_report_saves():
    script = (templates_dir() / "figure_tools.js").read_text()
    assert '["panel", "curve", "x axis", "x", "y axis", "y", "low", "median", "high"]' in script
    assert '["panel", "x axis", "x", "y axis", "y", "quantity", "value"]' in script


def test_a_motion_has_its_paths_and_a_drawing_no_points():
    found = rows(playback(4))
    assert found[0] == ["curve", "x (m)", "y (m)", "z (m)"]
    assert [row[0] for row in found[1:]] == ["path of the tip"] * 4 + ["desired path"] * 4
    assert as_csv(Picture("", SVG, "")) is None


def test_no_cell_is_a_formula():
    figure = Curves("", [Panel("=1+1", "x", "y", [Series("@a", T, -T)])])
    assert rows(figure)[2][:2] == ["'=1+1", "'@a"]
    assert float(rows(figure)[2][5]) == -1.0
