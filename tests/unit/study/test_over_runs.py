"""Tables, curves and numbers over the runs that a pattern names, from runs invented here."""

import numpy as np
import pytest
from support.made_up_runs import made_up_metric, made_up_run, planned

from runner.base.errors import RunnerError
from runner.papers.study.measured import Measured
from runner.papers.study.prose import blocks, plots, signals, tables
from runner.papers.study.results import MissingError, matching_runs


def run_of(value, failed=False, ends=None, unit="m"):
    """Return a run whose gain, error and signals follow from one value."""
    low, high = ends or (value, value)
    stored = {**made_up_metric(value, unit=unit), "min": low, "max": high}
    metrics = {} if failed else {"error": stored, "settling_time": {**stored, "unit": "s", "median": None}}
    t = np.array([0.0, 0.5, 1.0])
    signal = {"error_x": 3.0 * value * t, "error_y": 4.0 * value * t, "error_z": 0.0 * t}
    trace = {"t": t, "q1": value * t, "q2": -t} | signal
    return made_up_run(metrics, trace, {"controller": {"gain": 10 * value}}, failed=failed, command=f"runner {value}")


PATTERN = "gain/{controller.gain}/{preset}"
GAINS = {
    f"gain/{gain}/{preset}": run_of(float(gain) * (1.0 if preset == "full_equations" else 2.0))
    for preset in ("full_equations", "as_reported")
    for gain in (1, 10, 5)
} | {"held": run_of(7.0)}
RUNS = planned(PATTERN, GAINS)


def test_a_pattern_names_runs_in_the_order_of_the_plan():
    assert [one.name for one in matching_runs(RUNS, "gain/{gain}/full_equations")] == [
        "gain/1/full_equations",
        "gain/10/full_equations",
        "gain/5/full_equations",
    ]
    by = [one.levels for one in matching_runs(RUNS, "gain/{gain}/{preset}", ["preset"])]
    assert by[:3] == [{"gain": gain, "preset": "full_equations"} for gain in ("1", "10", "5")]
    assert [one.levels["preset"] for one in matching_runs(RUNS, "gain/{gain}/{preset}")][:2] == [
        "full_equations",
        "as_reported",
    ]


def test_a_pattern_that_names_nothing_is_refused():
    with pytest.raises(RunnerError, match=r"no run is named like 'gian/\{gain\}/full_equations'"):
        matching_runs(RUNS, "gian/{gain}/full_equations")
    with pytest.raises(RunnerError, match=r"has no axis 'gian' \(did you mean gain\?\)"):
        matching_runs(RUNS, "gain/{gain}/full_equations", ["gian"])
    with pytest.raises(MissingError, match="gain/2/full_equations: cut short"):
        matching_runs(planned(PATTERN, RUNS, {"gain/2/full_equations": "cut short"}), "gain/{gain}/full_equations")


def test_a_table_has_a_row_for_each_run_and_a_unit_for_each_metric():
    made = tables.table(
        RUNS,
        "Errors.",
        ["gain/{gain}/{preset}", "held"],
        tables.level("preset", "preset", missing="held"),
        tables.level("gain", words={"10": "ten"}),
        tables.column("error", "error"),
        tables.column("settles", "settling_time"),
        tables.column(
            "of the full equations", signals.at_the_end("q1"), "gain/{gain}/full_equations", only={"gain": "5"}
        ),
        by=["preset"],
        number="table 1",
    )
    assert made.lines[0] == ["preset", "gain", "error (m)", "settles (s)", "of the full equations"]
    assert [row[:2] for row in made.lines[1:]][:4] == [
        ["by the printed equations", "1"],
        ["by the printed equations", "ten"],
        ["by the printed equations", "5"],
        ["as fitted", "1"],
    ]
    assert [row[2] for row in made.lines[1:]] == ["1", "10", "5", "2", "20", "10", "7"]
    assert {row[3] for row in made.lines[1:]} == {"never"}
    assert [row[4] for row in made.lines[1:]] == ["–", "–", "5", "–", "–", "5", "–"]
    assert made.lines[-1][:2] == ["held", "–"]
    assert [column.kind for column in made.columns] == ["text", "text", "number", "text", "number"]
    assert [column.unit for column in made.columns] == ["1", "1", "m", "s", "1"]
    assert (made.origin.number, made.origin.command) == ("table 1", "runner 1.0")


def test_a_run_that_two_patterns_stand_for_has_one_row_unless_a_cell_differs():
    patterns = ["gain/{gain}/full_equations", "gain/1/{preset}"]
    value = tables.column("error", "error")
    assert [row[0] for row in tables.table(RUNS, "Errors.", patterns, value).lines[1:]] == ["1", "10", "5", "2"]
    told = tables.table(RUNS, "Errors.", patterns, tables.level("gain"), value).lines[1:]
    assert [row[0] for row in told] == ["1", "10", "5", "–", "–"]


def test_a_failed_run_says_so():
    runs = planned(PATTERN, {**RUNS, "gain/10/full_equations": run_of(0.0, failed=True)})
    made = tables.table(runs, "Errors.", "gain/{gain}/full_equations", tables.column("error", "error"))
    assert [row[0] for row in made.lines[1:]] == ["1", "failed", "5"]
    (series,) = plots.over(runs, "gain/{gain}/full_equations", "gain", "error")
    assert np.isnan(series.y[1])


def test_a_comparison_has_a_row_for_each_metric_and_a_column_for_each_level():
    made = tables.comparison(RUNS, "Both.", "gain/5/{preset}", "error", "settling_time")
    assert made.lines[0] == ["metric", "by the printed equations", "as fitted"]
    assert made.lines[1:] == [["error", "5 m", "10 m"], ["settling time", "never", "never"]]
    with pytest.raises(RunnerError, match="a comparison goes over one axis"):
        tables.comparison(RUNS, "Both.", "gain/{gain}/{preset}", "error")


def test_a_number_against_an_axis_has_the_band_of_its_repetitions():
    runs = planned(PATTERN, {**RUNS, "gain/10/full_equations": run_of(10.0, ends=(8.0, 13.0))})
    full_equations, reported = plots.over(runs, "gain/{gain}/{preset}", "gain", "error", "{preset}", color=3)
    assert (full_equations.name, reported.name, full_equations.color, reported.color) == (
        "by the printed equations",
        "as fitted",
        3,
        4,
    )
    np.testing.assert_array_equal(full_equations.x, [1.0, 10.0, 5.0])
    np.testing.assert_array_equal(full_equations.y, [1.0, 10.0, 5.0])
    np.testing.assert_array_equal(full_equations.low, [1.0, 8.0, 5.0])
    np.testing.assert_array_equal(full_equations.high, [1.0, 13.0, 5.0])
    assert reported.low is None
    (named,) = plots.over(RUNS, "gain/5/{preset}", "preset", "error")
    np.testing.assert_array_equal(named.x, [0.0, 1.0])


def test_signals_over_time():
    full_equations, reported = plots.line(
        RUNS, "gain/5/{preset}", signals.norm("error"), "{preset}", factor=1e3, until=0.5
    )
    np.testing.assert_allclose(full_equations.y, [0.0, 12.5e3])
    np.testing.assert_array_equal(reported.x, [0.0, 0.5])
    (apart,) = plots.line(RUNS, "gain/5/full_equations", signals.distance("error"), "", "gain/5/as_reported")
    np.testing.assert_allclose(apart.y, [0.0, 12.5, 25.0])
    assert [series.name for series in plots.joints(RUNS, "held")] == ["q1", "q2"]
    assert [series.name for series in plots.axes(RUNS, "held")] == ["x", "y", "z"]
    assert signals.largest_of("q2")(RUNS["held"]) == 1.0
    with pytest.raises(RunnerError, match=r"has no signal 'q3'"):
        plots.line(RUNS, "held", "q3")


def test_quantities_of_runs_have_arithmetic():
    run, other = RUNS["gain/1/full_equations"], RUNS["gain/5/full_equations"]
    error = signals.norm("error")
    assert signals.at_the_end(error)(run) == pytest.approx(5.0)
    assert (1.0 - 2 * signals.setting("controller.gain") ** 2 / 4)(run) == pytest.approx(-49.0)
    assert (signals.at_the_end(error) / signals.of_next(signals.at_the_end(error)))(run, other) == pytest.approx(0.2)
    assert signals.at_the_end(signals.difference(error, 0.2))(run, other) == pytest.approx(0.0)
    assert signals.norm(signals.at_the_end(signals.of_joints()))(run) == pytest.approx(np.sqrt(2.0))
    assert signals.range_of("q1")(run) == pytest.approx(1.0)
    assert signals.time_of_largest(signals.moved("q2"))(run) == 1.0
    assert signals.at_the_end(signals.worst_axis(-signals.vector("error")))(run) == pytest.approx(4.0)
    assert (2 * signals.metric_of("settling_time"))(run) is None
    assert signals.recorded("failure.time")(run) is None
    assert signals.total_of("t")(run) == signals.power_law(1.5, 2)(2.0) == 1.5
    assert [signals.power_law(1.5, 2.0, power)(8.0) for power in (1.0, 2.0, -0.5)] == [6.0, 24.0, 0.75]
    with pytest.raises(TypeError, match="has a value for a run; write of_run"):
        str(error)


def test_the_exponent_of_two_numbers_is_found_over_runs():
    runs = [RUNS[f"gain/{gain}/full_equations"] for gain in (1, 10, 5)]
    gain, end = signals.setting("controller.gain"), signals.at_the_end(signals.norm("error"))
    assert signals.exponent(gain, end**-2)(*runs) == pytest.approx(-2.0)
    assert signals.exponent("error", gain)(*runs) == pytest.approx(1.0)
    apart = signals.largest_of(signals.distance("error"))  # 5 times the difference from 1
    assert signals.exponent(gain - 10.0, apart, shared=1)(*runs[1:], runs[0]) == pytest.approx(1.0)
    assert signals.exponent(gain, apart, shared=1)(*runs, runs[0]) is None
    both = blocks.of_run(RUNS, "exponent", signals.exponent(gain, "error"), "1", "gain/{gain}/full_equations")
    assert both.value == pytest.approx(1.0)


def test_a_cell_has_the_ends_of_a_signal():
    made = tables.listing(RUNS, "Ways.", "held", ["end"], [blocks.value_of(RUNS, signals.ends_of("q2"), "held")])
    assert made.lines[1:] == [["-1 to 0"]]
    assert made.columns[0].kind == "number"
    gain = blocks.value_of(RUNS, signals.ends_of(signals.setting("controller.gain")), "held")
    assert tables.listing(RUNS, "Gain.", "held", ["gain"], [gain]).lines[1:] == [["70"]]


def test_a_column_has_its_own_size_of_rounding_errors():
    small = tables.column("small", signals.setting("controller.gain", 1e-14), rounding=0)
    coarse = tables.column("coarse", "error", rounding=6.0)
    made = tables.table(RUNS, "Small.", "gain/{gain}/full_equations", small, coarse)
    assert made.lines[1:] == [["1.00·10⁻¹³", "0 (rounding)"], ["1.00·10⁻¹²", "10"], ["5.00·10⁻¹³", "0 (rounding)"]]


def test_joints_are_drawn_of_any_signal_that_has_a_column_for_each():
    halves = plots.joints(RUNS, "held", 0.5 * signals.of_joints())
    np.testing.assert_allclose([each.y for each in halves], [[0.0, 1.75, 3.5], [0.0, -0.25, -0.5]])


def test_a_vector_has_a_part_along_a_direction_of_the_config_and_one_across_it():
    run = made_up_run(
        {},
        {"t": np.arange(3.0)}
        | {f"f_{axis}": np.arange(3.0) * size for axis, size in zip("xyz", (3, 4, 12), strict=True)},
        {"wall": {"normal": [0.0, 0.0, -2.0]}},
    )
    np.testing.assert_allclose(signals.along("f", "wall.normal")(run), [0.0, -12.0, -24.0])
    np.testing.assert_allclose(signals.across(2 * signals.vector("f"), "wall.normal")(run), [0.0, 10.0, 20.0])


def test_a_signal_can_be_cut_to_a_part_of_the_time():
    run = RUNS["gain/1/full_equations"]
    np.testing.assert_array_equal(signals.between("t", 0.5, 1.0)(run), [0.5, 1.0])
    assert signals.mean_of(signals.between("q1", 0.5, 1.0))(run) == pytest.approx(0.75)
    assert signals.mean_of(signals.between("q1", 2.0, 3.0))(run) is None
    np.testing.assert_array_equal(signals.between("t", -0.5)(run), [0.5, 1.0])
    np.testing.assert_array_equal(signals.between("t", 0.0, 0.5)(run), [0.0, 0.5])


def test_runs_are_points_over_two_of_their_numbers():
    gain, end = signals.setting("controller.gain"), signals.at_the_end(signals.norm("error"))
    (series,) = plots.points(RUNS, "gain/{gain}/full_equations", "gain", end, "all")
    assert (series.x.tolist(), series.y.tolist()) == ([1.0, 10.0, 5.0], pytest.approx([5.0, 50.0, 25.0]))

    def small(run):
        return gain(run) < 60.0

    (series,) = plots.points(RUNS, "gain/{gain}/full_equations", gain, end, only=small, where=False)
    assert series.x.tolist() == [100.0]


def test_panels_to_be_compared_share_the_range_of_y_that_shows_all_of_them():
    small, large = (plots.panel(str(top), "t", "y", plots.limit(top, 0, 1), plots.limit(0, 0, 1)) for top in (1.0, 4.0))
    (first, second) = plots.same_y(small, large)
    assert first.y_range == second.y_range == pytest.approx((-0.2, 4.2))
    powers = [plots.panel("", "t", "y", plots.limit(10.0**n, 0, 1), y_log=True) for n in (-2, 2)]
    assert plots.same_y(*powers)[0].y_range == pytest.approx((10**-2.2, 10**2.2))
    level = plots.panel("", "t", "y", plots.limit(1, 0, 1))
    assert plots.same_y(level, plots.panel("", "t", "y")) == [level, plots.panel("", "t", "y")]


def test_a_figure_takes_panels_one_by_one_and_several_in_one():
    alone, *pair = (plots.panel(title, "t", "y", plots.limit(1, 0, 1)) for title in "abc")
    figure = plots.curves(RUNS, "Caption.", "gain/5/full_equations", alone, pair)
    assert [each.title for each in figure.panels] == ["a", "b", "c"]
    assert figure.columns == 2


def test_axes_of_a_vector_are_scaled():
    lines = plots.axes(RUNS, "gain/5/full_equations", factor=1000)
    np.testing.assert_allclose([each.y[-1] for each in lines], [15e3, 20e3, 0.0])


def test_closed_forms_and_limits():
    (curve,) = plots.closed_form(lambda x: None if x > 5.0 else 1.0 / x, 1.0, 10.0, "1/x", log=True)
    np.testing.assert_allclose(curve.y[curve.x <= 5.0], 1.0 / curve.x[curve.x <= 5.0])
    assert np.isnan(curve.y[curve.x > 5.0]).all()
    np.testing.assert_allclose(np.diff(np.log(curve.x)), np.log(10.0) / 99)
    (level,) = plots.limit(2.0, 0.0, 1.0)
    np.testing.assert_array_equal([level.x, level.y], [[0.0, 1.0], [2.0, 2.0]])
    (upright,) = plots.upright(2.0, 0.0, 1.0)
    np.testing.assert_array_equal([upright.x, upright.y], [[2.0, 2.0], [0.0, 1.0]])


def test_a_panel_of_powers_of_ten_leaves_zeros_out():
    panel = plots.panel("", "t", "e", plots.line(RUNS, "held", "q1"), y_log=True, x_range=[0, 1])
    assert np.isnan(panel.series[0].y[0])
    assert panel.x_range == (0.0, 1.0)
    figure = plots.curves(RUNS, "Figure.", "held", panel, number="figure 1")
    assert (figure.columns, figure.origin.number) == (1, "figure 1")


def test_a_map_has_a_cell_for_each_run():
    runs = planned(PATTERN, {**RUNS, "gain/10/full_equations": run_of(0.0, failed=True)})
    made = plots.heat_map(runs, "Map.", "gain/{gain}/{preset}", "gain", "preset", "error", "error (m)")
    (panel,) = made.panels
    assert (panel.x_names, panel.y_names) == (["1", "10", "5"], ["full_equations", "as_reported"])
    np.testing.assert_array_equal(panel.values, [[1.0, np.nan, 5.0], [2.0, 20.0, 10.0]])
    np.testing.assert_array_equal(panel.failed, [[False, True, False], [False, False, False]])


def test_values_of_runs_and_the_largest_of_them():
    one, two = (blocks.metric(RUNS, f"gain/{gain}/full_equations", "error") for gain in (1, 5))
    assert blocks.largest("largest", one, two).value == 5.0
    assert blocks.smallest("smallest", one, two).parts == (one, two)
    assert blocks.largest("largest", one, Measured("none", None, "m")).value is None
    assert blocks.of_run(RUNS, "end", signals.at_the_end("q1"), "rad", "held").value == 7.0
    assert (
        blocks.of_run({"held": run_of(1.0, failed=True)}, "end", signals.at_the_end("q1"), "rad", "held").value is None
    )


@pytest.mark.parametrize(
    ("column", "told"),
    [
        (tables.level("presett"), r"no axis 'presett' \(did you mean preset\?\); axes: gain, preset"),
        (tables.column("e", "error", only={"gian": "5"}), r"no axis 'gian' \(did you mean gain\?\)"),
        (
            tables.column("e", "error", only={"preset": "full_equation"}),
            r"has no level 'full_equation' \(did you mean full_equations\?\)",
        ),
    ],
)
def test_an_axis_or_level_that_no_run_has_is_refused(column, told):
    with pytest.raises(RunnerError, match=told):
        tables.table(RUNS, "Errors.", "gain/{gain}/{preset}", column)
