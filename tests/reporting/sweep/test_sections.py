import numpy as np
import pytest
from sample_sweep import measurements, noisy, two_axes

from runner.reporting.document import Curves, Maps, Notice, Table, Text
from runner.reporting.sweep import axes, distributions, effects, failures, maps
from runner.reporting.sweep.subject import choose


def blocks(section, kind):
    return [block for block in section.blocks if isinstance(block, kind)]


def three_axes():
    grid = {"noise.position": [1e-4, 1e-3], "controller.period": [0.01, 0.02, 0.04], "controller.coupling": ["a", "b"]}
    return choose(measurements(grid, {"rms": noisy(lambda n, p, c: 1.0 + n + 4.0 * p + 2.0 * c)}))


def test_axes_are_told_with_their_values_and_the_command():
    made = axes.section(two_axes(), "runner -m noise.position=1e-4,1e-3,1e-2")
    (table,) = blocks(made, Table)
    assert table.rows[1] == ["torque_limits.max (N m)", "4", "20, 40, 60, 80"]
    assert table.origin.command.startswith("runner -m")
    assert not blocks(made, Notice)
    assert "12 cells, every combination" in blocks(made, Text)[0].text


def test_failures_and_few_repetitions_are_said_at_once():
    sample = {"rms": noisy(lambda noise, limit: 1.0 + noise, repetitions=5)}
    failure, warning = blocks(axes.section(two_axes(failed=[0], **sample), ""), Notice)
    assert failure.title == "1 of 12 runs failed"
    assert warning.title == "Too few repetitions for intervals: 5 of 6"


def test_the_axis_that_matters_is_named():
    subject = two_axes()
    assert "torque_limits.max explains 82 %" in effects.summary(subject)  # by hand: logs of 2^i 3^-j
    (table,) = blocks(effects.section(subject), Table)
    assert [row[0] for row in table.rows] == [
        "noise.position",
        "torque_limits.max",
        "noise.position × torque_limits.max",
    ]
    assert table.rows[1][1] == "82 % (p = 0.001)"


def test_the_share_by_hand():
    i, j = np.meshgrid(np.arange(3) * np.log(2), np.arange(4) * np.log(3), indexing="ij")
    assert j.var() / (i.var() + j.var()) == pytest.approx(0.82, abs=0.005)


def test_chance_is_called_chance():
    subject = two_axes(rms=noisy(lambda noise, limit: 1.0, repetitions=6))
    assert "no more than chance may" in effects.summary(subject)


def test_main_effects_are_medians_over_the_other_axes():
    subject = two_axes()
    panels = blocks(effects.section(subject), Curves)[0].panels
    assert len(panels) == 4
    (series,) = panels[1].series
    values = subject.measurements.values["max_tracking_error"]
    pooled = [values[subject.axes[1].level == level] for level in range(4)]
    assert series.y.tolist() == [np.quantile(some, 0.5, method="inverted_cdf") for some in pooled]
    assert panels[1].y_log
    assert panels[0].x_log


def test_cells_have_intervals_where_repetitions_are_enough():
    many = blocks(effects.section(two_axes()), Curves)[1].panels[0].series
    assert [series.name for series in many] == [f"noise.position = {value}" for value in ("0.0001", "0.001", "0.01")]
    assert all((series.low <= series.y).all() and (series.y <= series.high).all() for series in many)
    assert all(np.isfinite(series.low).all() for series in many)
    few = two_axes(rms=noisy(lambda noise, limit: 1.0 + limit, repetitions=5))
    assert np.isnan(blocks(effects.section(few), Curves)[1].panels[0].series[0].low).all()


def test_two_axes_make_a_map_of_cells_and_one_of_equal_values():
    first, second = blocks(maps.section(two_axes(failed=[3])), Maps)
    cells, contours = first.panels
    assert (cells.x_names, cells.y_names) == (["0.0001", "0.001", "0.01"], ["20", "40", "60", "80"])
    assert cells.values.shape == (4, 3)
    assert cells.values[0, 2] == pytest.approx(4.0, rel=0.05)  # noise 2, limit 0
    assert cells.failed.tolist() == [[False] * 3] * 3 + [[True, False, False]]
    assert cells.values[3, 0] == np.inf
    assert contours.contours
    assert not cells.contours
    assert first.log
    assert not second.log
    assert cells.runs[3 * 1 + 2] == f"{2 * 4 + 1:024x}"


def test_three_axes_make_small_multiples():
    (block,) = blocks(maps.section(three_axes()), Maps)
    assert len(block.panels) == 2
    titles = {panel.title.partition(" = ")[0] for panel in block.panels}
    assert len(titles) == 1
    values = np.concatenate([panel.values.ravel() for panel in block.panels])
    assert np.sort(values) == pytest.approx(np.sort(three_axes().medians["rms"]))


def test_more_axes_are_pooled_by_the_median():
    grid = {"a": [1.0, 2.0], "b": [1.0, 2.0], "c": [1.0, 2.0], "d": [1.0, 2.0, 3.0]}
    subject = choose(measurements(grid, {"rms": noisy(lambda a, b, c, d: 1 + 4 * a + 2 * b + c, scatter=0.001)}))
    text, block = maps.section(subject).blocks
    assert "over d the median is taken" in text.text
    assert sorted(np.concatenate([panel.values.ravel() for panel in block.panels])) == pytest.approx(
        np.arange(1.0, 9.0), rel=0.01
    )
    assert not block.panels[0].runs


def test_distributions_end_below_one_where_runs_failed():
    subject = two_axes(failed=[0, 4, 8])  # all with torque limit 20
    by_noise, by_limit = distributions.section(subject).blocks[0].panels
    assert [series.y[-1] for series in by_noise.series] == [0.75] * 3
    assert [series.name for series in by_limit.series] == ["20", "40", "60", "80"]
    assert by_limit.series[0].x.size == 0
    assert all((np.diff(series.y) >= 0).all() and (np.diff(series.x) >= 0).all() for series in by_noise.series)


def test_cells_stand_in_order():
    subject = two_axes()
    (panel,) = distributions.section(subject).blocks[1].panels
    assert (np.diff(panel.series[0].y) >= 0).all()
    assert panel.series[0].runs == subject.hashes(subject.ranked)


def test_failed_runs_are_listed_with_where_they_lie():
    by_axis, runs = failures.section(two_axes(failed=[0, 4])).blocks
    assert ["torque_limits.max", "20", "2 of 3"] in by_axis.rows
    assert ["noise.position", "0.001", "1 of 4"] in by_axis.rows
    assert [row[1:] for row in runs.rows] == [
        [f"noise.position={noise}, torque_limits.max=20", "diverged, at once"] for noise in ("0.0001", "0.001")
    ]
