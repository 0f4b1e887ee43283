"""Maps as drawings and as data for Plotly: cells, scale, strings."""

import json
from dataclasses import replace
from xml.etree import ElementTree

import numpy as np
import pytest
from support.sample_document import HOSTILE, maps

from runner.reporting.charts import static
from runner.reporting.charts.interactive import plotly_spec
from runner.reporting.charts.scales import maps_in_readable_units, scale_marks, value_range
from runner.reporting.charts.sheet import column
from runner.reporting.document import Map, Maps


def one_map(values, log=False, **changes):
    values = np.asarray(values, dtype=float)
    names = [[f"{kind}{number}" for number in range(count)] for kind, count in zip("yx", values.shape, strict=True)]
    panel = Map(**({"title": "", "x_label": "x", "y_label": "y", "x_names": names[1], "y_names": names[0],
                    "values": values, "failed": np.zeros(values.shape, dtype=bool)} | changes))  # fmt: skip
    return Maps("", "error (m)", [panel], log)


WAVES = np.sin(np.add.outer(np.arange(6.0), np.arange(5.0)))
MAPS = {
    "maps": maps(),
    "contours": one_map(WAVES, lines=[]),
    "logarithm": one_map(np.exp(WAVES), True, failed=WAVES > 0.95),
}


@pytest.mark.parametrize("name", MAPS)
def test_a_drawing_is_as_recorded(name, as_recorded):
    as_recorded("drawings", name, static.draw(MAPS[name]))
    as_recorded("drawings", f"{name} on a narrow column", static.draw(MAPS[name], column(80)))
    as_recorded("drawings", f"{name} in HTML", plotly_spec(MAPS[name]))


@pytest.mark.parametrize("text", HOSTILE)
def test_any_text_gives_a_valid_drawing_and_reaches_plotly_as_no_markup(text):
    ElementTree.fromstring(static.draw(maps(text)))
    written = json.dumps(plotly_spec(maps(text)), allow_nan=False)
    assert "<" not in written
    assert "$" not in written


def test_the_same_maps_give_the_same_text():
    assert static.draw(maps()) == static.draw(maps())


def test_cells_keep_their_places_hints_and_runs():
    (spec,) = plotly_spec(one_map([[1, 2, 3], [4, 5, 6]], hints=list("abcdef"), runs=list("ABCDEF")))
    heat = spec["traces"][0]
    assert heat["z"] == [[1.0, 2.0, 3.0], [4.0, 5.0, 6.0]]
    assert heat["hovertext"][1][0] == "d"
    assert heat["customdata"][1] == ["D", "E", "F"]
    assert spec["layout"]["xaxis"]["ticktext"] == ["x0", "x1", "x2"]
    assert spec["layout"]["yaxis"]["ticktext"] == ["y0", "y1"]


def test_all_maps_share_one_scale():
    block = Maps("", "m", [one_map([[1, 2]]).panels[0], one_map([[5, np.inf]]).panels[0]])
    assert value_range(block) == (1.0, 5.0)
    assert {(spec["traces"][0]["zmin"], spec["traces"][0]["zmax"]) for spec in plotly_spec(block)} == {(1.0, 5.0)}


@pytest.mark.parametrize("log", [False, True])
def test_a_difference_below_two_per_cent_gets_no_full_contrast(log):
    low, high = value_range(one_map([[0.28272, 0.282794]], log))
    ends = 10.0 ** np.array([low, high]) if log else np.array([low, high])
    assert ends == pytest.approx([0.28272 * 0.99, 0.282794 * 1.01], rel=2e-4)


def test_the_scale_spans_the_intervals_of_the_values_in_their_unit():
    block = one_map([[4.13e-3, 4.69e-3]], low=np.array([[2.8e-3, np.nan]]), high=np.array([[8e-3, np.inf]]))
    assert value_range(block) == (2.8e-3, 8e-3)
    (heat,) = plotly_spec(maps_in_readable_units(block))[0]["traces"]
    assert (heat["zmin"], heat["zmax"]) == pytest.approx((2.8, 8.0))


def test_lines_of_equal_value_divide_the_scale_and_not_what_cannot_be_told_apart():
    ragged = 1.0 + 1e-12 * np.arange(9.0).reshape(3, 3)
    drawn = [static.draw(one_map(values, contours=True)) for values in (ragged, np.arange(9.0).reshape(3, 3))]
    assert [text.count("#ffffff") > drawn[0].count("#ffffff") for text in drawn] == [False, True]


def test_the_logarithm_is_coloured_and_the_value_is_written():
    block = replace(one_map([[1e-4, 1e-2]], log=True), value_label="torque (N m)")
    (spec,) = plotly_spec(block)
    assert spec["traces"][0]["z"] == [[-4.0, -2.0]]
    assert spec["traces"][0]["text"] == [["0.0001", "0.01"]]
    places, marks = scale_marks(block)
    assert (places[0], places[-1]) == (-4.0, -2.0)
    assert marks[2] == "0.001"
    (wide,) = plotly_spec(replace(block, panels=one_map([[1e-6, 1.0]]).panels))
    assert wide["traces"][0]["text"] == [["1·10⁻⁶", "1·10⁰"]]


def test_lengths_are_shown_in_the_unit_that_fits_the_largest():
    block = replace(one_map([[1e-4, 1e-2]]), value_label="error (m)")
    (spec,) = plotly_spec(maps_in_readable_units(block))
    heat = spec["traces"][0]
    assert heat["z"] == [[0.1, 10.0]]
    assert heat["colorbar"]["title"]["text"] == "error (mm)"
    torques = maps_in_readable_units(replace(block, value_label="torque (N m)"))
    assert plotly_spec(torques)[0]["traces"][0]["z"] == [[1e-4, 1e-2]]


def test_a_value_beyond_every_number_is_never_and_a_failed_cell_is_crossed():
    failed = np.array([[False, False, True]])
    (spec,) = plotly_spec(one_map([[1.0, np.inf, np.inf]], failed=failed))
    heat, cross = spec["traces"]
    assert heat["z"] == [[1.0, None, None]]
    assert heat["text"] == [["1", "never", ""]]
    assert (cross["x"], cross["y"]) == ([2], [0])


def test_many_columns_show_colours_alone():
    assert "text" in plotly_spec(one_map(np.arange(10.0)[None]))[0]["traces"][0]
    assert "text" not in plotly_spec(one_map(np.arange(11.0)[None]))[0]["traces"][0]


def test_contours_join_equal_values():
    (spec,) = plotly_spec(one_map(np.arange(9.0).reshape(3, 3), contours=True))
    assert spec["traces"][0]["type"] == "contour"
    assert "text" not in spec["traces"][0]


@pytest.mark.parametrize("values", [[[np.nan]], [[2.0, 2.0]], [[-1.0, 0.0]], [[np.inf, np.inf]]])
@pytest.mark.parametrize("log", [False, True])
def test_odd_values_are_no_error(values, log):
    block = one_map(values, log)
    ElementTree.fromstring(static.draw(block))
    json.dumps(plotly_spec(block), allow_nan=False)
