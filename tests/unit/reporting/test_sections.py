"""Sections of the report on a sweep, from sweeps that were never run."""

import itertools
from dataclasses import replace

import numpy as np
import pytest
from support.sample_sweep import measurements, noisy, two_axes

from runner.reporting.document import Curves, Maps, Notice, Table, Text
from runner.reporting.sweep import cells, distributions, effects, maps
from runner.reporting.sweep.cells import failing_cells, nothing_differs
from runner.reporting.sweep.effects import cells_with_intervals
from runner.reporting.sweep.stability import causes_of_failure
from runner.reporting.sweep.subject import choose
from runner.sweeps.differing import UnsweptDifference


def blocks(section, kind):
    return [block for block in section.blocks if isinstance(block, kind)]


def three_axes():
    grid = {"noise.position": [1e-4, 1e-3], "controller.period": [0.01, 0.02, 0.04], "controller.coupling": ["a", "b"]}
    return choose(measurements(grid, {"rms": noisy(lambda n, p, c: 1.0 + n + 4.0 * p + 2.0 * c)}))


def test_axes_are_told_with_their_values_and_the_command():
    made = cells.axes_section(two_axes(), "runner -m noise.position=1e-4,1e-3,1e-2")
    (table,) = blocks(made, Table)
    assert table.rows[1] == ["torque_limits.max (N m)", "4", "20, 40, 60, 80"]
    assert table.origin.command.startswith("runner -m")
    assert not blocks(made, Notice)
    assert "12 cells, every combination" in blocks(made, Text)[0].text


def test_what_differs_beyond_the_axes_stands_beside_them():
    plain = two_axes()
    found = [
        UnsweptDifference("controller.period", ("noise.position",), [("0.0001, 0.001", "0.01"), ("0.01", "0.001")]),
        UnsweptDifference("robot.home", (), [("", "x" * 80)]),
    ]
    subject = choose(replace(plain.measurements, differences=found))
    _, table = blocks(cells.axes_section(subject, ""), Table)
    assert table.caption.startswith("Also differs: config values that are not the same in all cells")
    assert table.rows[0] == ["controller.period (s)", "noise.position", "0.0001, 0.001: 0.01; 0.01: 0.001"]
    assert table.rows[1][1:] == ["none", "x" * 57 + "..."]
    assert len(blocks(cells.axes_section(plain, ""), Table)) == 1


def test_failures_and_few_repetitions_are_said_at_once():
    sample = {"rms": noisy(lambda noise, limit: 1.0 + noise, repetitions=5)}
    failure, warning = blocks(cells.axes_section(two_axes(failed=[0], **sample), ""), Notice)
    assert failure.title == "1 of 12 runs failed"
    assert warning.title == "Too few repetitions for intervals: 5 of 6"


def test_the_share_of_each_axis_is_told():
    subject = two_axes()
    (table,) = blocks(effects.section(subject), Table)
    assert [row[0] for row in table.rows] == [
        "noise.position",
        "torque_limits.max",
        "noise.position × torque_limits.max",
    ]
    assert table.rows[1][1] == "82 %"  # by hand: logs of 2^i 3^-j


def test_the_share_by_hand():
    i, j = np.meshgrid(np.arange(3) * np.log(2), np.arange(4) * np.log(3), indexing="ij")
    assert j.var() / (i.var() + j.var()) == pytest.approx(0.82, abs=0.005)


def shared_seeds(repetitions=8):
    """A metric whose scatter is mostly common to seeds; levels of the first axis differ by a little."""

    def values(level, _):
        shared = np.random.default_rng(1).normal(size=repetitions)
        own = np.random.default_rng([2, int(level), int(_)]).normal(size=repetitions)
        return 10.0 + 0.15 * level + shared + 0.05 * own

    return values


def test_what_seeds_share_is_no_scatter_between_cells():
    subject = two_axes(rms=shared_seeds())
    text = blocks(effects.section(subject), Text)[0].text
    assert "share the random draws of a repetition, which make 96 % of the variation of rms" in text
    assert "p = " not in text
    (told,) = effects.describe_shared_variation(subject)
    assert told == "The draws of the repetitions explain 96 % of the spread of the rms."
    own = replace(subject.measurements, seeds=range(12))
    assert "share the random draws" not in blocks(effects.section(choose(own)), Text)[0].text


def test_cells_have_intervals_where_repetitions_are_enough():
    many = blocks(effects.section(two_axes()), Curves)[0].panels[0].series
    assert [series.name for series in many] == [f"noise.position = {value}" for value in ("0.0001", "0.001", "0.01")]
    assert all((series.low <= series.y).all() and (series.y <= series.high).all() for series in many)
    assert all(np.isfinite(series.low).all() for series in many)
    few = two_axes(rms=noisy(lambda noise, limit: 1.0 + limit, repetitions=5))
    assert np.isnan(blocks(effects.section(few), Curves)[0].panels[0].series[0].low).all()


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


def map_values(block):
    return np.sort(np.concatenate([panel.values.ravel() for panel in block.panels]))


def test_more_axes_are_maps_of_their_own_and_no_value_is_pooled():
    grid = {"a": [1.0, 2.0], "b": [1.0, 2.0], "trajectory": ["quintic", "goal"], "robot": ["macro", "mini"]}
    subject = choose(measurements(grid, {"rms": noisy(lambda a, b, c, d: 1 + 8 * a + 4 * b + 2 * c + d)}))
    (block,) = maps.section(subject).blocks
    assert [panel.title for panel in block.panels][:2] == [
        "trajectory = quintic, robot = macro",
        "trajectory = quintic, robot = mini",
    ]
    assert map_values(block).tolist() == sorted(subject.medians["rms"])
    assert "a map for each value of trajectory and robot" in block.caption
    assert all(panel.runs for panel in block.panels)


def test_of_many_maps_some_are_shown_and_the_caption_says_so():
    grid = {name: [1.0, 2.0, 3.0, 4.0] for name in "abcd"}
    subject = choose(
        measurements(grid, {"rms": noisy(lambda a, b, c, d: 1 + 9 * a + 7 * b + c / 10 + d / 20, repetitions=2)})
    )
    (block,) = maps.section(subject).blocks
    assert len(block.panels) == 9
    assert "(9 of 16, evenly chosen; All runs has the others)" in block.caption
    assert set(map_values(block)) <= set(subject.medians["rms"])


def test_over_seeds_a_map_shows_the_middle_cell_and_says_so():
    grid = {"seed": [0.0, 1.0, 2.0, 3.0], "a": [1.0, 2.0], "b": [1.0, 2.0]}
    subject = choose(measurements(grid, {"rms": lambda seed, a, b: [1.0 + seed + 10 * a + 100 * b]}))
    (block,) = maps.section(subject).blocks
    assert block.panels[0].values.tolist() == [[2.0, 12.0], [102.0, 112.0]]
    assert block.caption.startswith(
        "Of the medians of the cells of 4 seeds the middle one, of an even number the lower"
    )


def test_distributions_end_below_one_where_runs_failed():
    subject = two_axes(failed=[0, 4, 8])  # all with torque limit 20
    by_noise, by_limit = distributions.section(subject).blocks[0].panels
    assert [series.y[-1] for series in by_noise.series] == [0.75] * 3
    assert [series.name for series in by_limit.series] == ["20", "40", "60", "80"]
    assert by_limit.series[0].x.size == 0
    assert all((np.diff(series.y) >= 0).all() and (np.diff(series.x) >= 0).all() for series in by_noise.series)


def test_cells_stand_in_order():
    axes = {"controller.period": [0.01, 0.02, 0.04]}
    subject = choose(measurements(axes, {"rms": noisy(lambda period: 3.0 - period)}))
    (panel,) = distributions.section(subject).blocks[1].panels
    assert (np.diff(panel.series[0].y) >= 0).all()
    assert panel.series[0].runs == subject.hashes(subject.ranked)
    assert (panel.x_label, panel.x_names) == ("cell: controller.period", ["0.04", "0.02", "0.01"])
    assert panel.series[0].x.tolist() == [0.0, 1.0, 2.0]
    assert len(distributions.section(two_axes()).blocks) == 1  # noise is a condition, which no designer orders


def test_a_figure_without_a_point_is_not_drawn():
    assert blocks(effects.section(two_axes(failed=range(12))), Curves) == []
    assert blocks(effects.section(two_axes(failed=[*range(1, 4), *range(5, 8), *range(9, 12)])), Curves) == []
    assert blocks(effects.section(two_axes(failed=range(2, 12))), Curves) != []


def test_failed_runs_are_listed_with_where_they_lie():
    by_cause, by_axis, runs = cells.failures_section(two_axes(failed=[0, 4])).blocks
    assert by_cause.lines[0] == [
        "torque_limits.max (N m)",
        *(f"noise.position={n}" for n in ("0.0001", "0.001", "0.01")),
    ]
    assert by_cause.rows == [
        ["20", "diverged, at once", "diverged, at once", "none"],
        *([limit, "none", "none", "none"] for limit in ("40", "60", "80")),
    ]
    assert ["torque_limits.max", "20", "2 of 3"] in by_axis.rows
    assert ["noise.position", "0.001", "1 of 4"] in by_axis.rows
    subject = two_axes(failed=[0, 4])
    subject.measurements.failures[0] = "diverged: not finite or above 1e+06 rad/s"
    assert cells.failures_section(subject).blocks[2].rows[0][2] == "diverged: not finite or above 1·10⁶ rad/s"
    assert [row[1:] for row in runs.rows] == [
        [f"noise.position={noise}, torque_limits.max=20", "diverged, at once"] for noise in ("0.0001", "0.001")
    ]


@pytest.mark.parametrize(("apart", "y_range"), [(0.001, (0.990495, 1.010505)), (0.1, None)])
def test_cells_that_differ_by_less_than_two_per_cent_do_not_fill_their_panel(apart, y_range):
    error = noisy(lambda step: 1.0 + apart * step, repetitions=1, scatter=0.0)
    figure = cells_with_intervals(choose(measurements({"plant.step": [1e-3, 2e-3]}, {"rms": error})), "rms")
    (curve,) = figure.panels[0].series
    assert list(curve.x) == [1e-3, 2e-3]
    assert figure.panels[0].y_range == (None if y_range is None else pytest.approx(y_range, abs=1e-5))


def test_a_map_has_the_interval_of_each_cell_and_none_of_few_repetitions():
    block, *_ = blocks(maps.section(two_axes()), Maps)
    low, high = two_axes().ends("max_tracking_error")
    (panel, *_) = block.panels
    assert sorted(panel.low.ravel()) == sorted(low)
    assert sorted(panel.high.ravel()) == sorted(high)
    assert ((panel.low <= panel.values) & (panel.values <= panel.high)).all()
    assert block.caption.endswith("The colours span the 95 % intervals of the medians.")
    block, *_ = blocks(maps.section(two_axes(rms=noisy(lambda noise, limit: 1.0 + noise, repetitions=5))), Maps)
    assert np.isnan(block.panels[0].low).all()
    assert "span" not in block.caption


def test_causes_are_shown_over_the_two_axes_that_hold_the_failures():
    axes = {"seed": [0, 1], "controller": ["a", "b"], "controller.period": [0.01, 0.02]}
    sample = measurements(axes, {"rms": lambda *levels: np.ones(8)})
    # By seed, then law, then period; law b fails with the long period, once by another cause.
    failures = ["", "", "", "failed in repetition 0 at t = 0.1 s (q1): diverged: above 1e+06 rad/s"] * 2
    failures[7] = "cut short: above the time limit"
    subject = choose(replace(sample, failures=failures, statuses=["failed" if text else "ok" for text in failures]))
    by_cause, *_ = cells.failures_section(subject).blocks
    assert by_cause.rows == [["0.01", "none", "none"], ["0.02", "none", "diverged, above the time limit"]]
    failures[3] = ""
    subject = choose(replace(sample, failures=failures, statuses=["failed" if text else "ok" for text in failures]))
    assert cells.failures_section(subject).blocks[0].rows[1] == ["b", "none", "above the time limit (1 of 2)"]


def test_a_sweep_says_if_nothing_can_differ_in_it():
    same = measurements(AXES, {"rms": lambda *levels: np.ones(6), "peak": lambda *levels: np.full(6, np.nan)})
    assert nothing_differs(choose(same)) == "All 6 cells have equal values of every metric."
    one = measurements({"seed": [0]}, {"rms": lambda seed: np.ones(1)})
    assert nothing_differs(choose(one)) == "One cell: nothing to compare."
    assert nothing_differs(two_axes()) == ""


def test_causes_need_two_axes_of_two_levels():
    sample = measurements({"controller": ["a", "b"], "seed": [0]}, {"rms": lambda *levels: np.ones(2)})
    subject = choose(replace(sample, failures=["", "cut short: t"], statuses=["ok", "failed"]))
    assert [block.caption for block in cells.failures_section(subject).blocks] == [
        "Failed runs by axis.",
        "Failed runs.",
    ]


AXES = {"controller.period": [0.005, 0.01, 0.02], "controller": ["a", "b"]}


@pytest.mark.parametrize(
    ("fails", "told"),
    [
        (lambda period, law: period > 0, "Every run with controller.period 0.01 or more failed, and no other."),
        (lambda period, law: law == 1, "Every run with controller b failed, and no other."),
        (
            lambda period, law: period == 2 and law == 0,
            "Every run with controller.period 0.02 and controller a failed, and no other.",
        ),
        (lambda period, law: (period, law) in {(0, 0), (1, 1)}, "All failed runs have controller.period 0.01 or less."),
        (
            lambda period, law: (period, law) != (0, 1),
            "Every run with controller.period 0.005 and controller b finished, and no other.",
        ),
        (lambda period, law: True, ""),
    ],
)
def test_the_shortest_condition_of_failures(fails, told):
    sample = measurements(AXES, {"rms": lambda *levels: np.ones(6)})
    places = list(itertools.product(range(3), range(2)))
    statuses = ["failed" if fails(*place) else "ok" for place in places]
    assert failing_cells(choose(replace(sample, statuses=statuses))) == told


def test_the_cause_of_failures_is_a_caveat_that_only_failed_cells_have():
    sample = measurements(AXES, {"rms": lambda *levels: np.ones(6)})
    caveats = [[{"rule": "exact_velocity", "text": "velocities are exact", "value": 1.0}] for _ in range(6)]
    unstable = {"rule": "unstable_gains", "text": "the loop is unstable", "value": 2.0}
    failed = [place in (4, 5) for place in range(6)]
    found = [[*some, unstable] if lost else some for some, lost in zip(caveats, failed, strict=True)]
    subject = choose(replace(sample, statuses=["failed" if lost else "ok" for lost in failed], caveats=found))
    assert causes_of_failure(subject) == (
        "The velocity loop is unstable: controller.natural_frequency or controller.period is 2 times too large."
    )
    assert causes_of_failure(choose(replace(sample, caveats=found))) == ""


def test_levels_between_others_are_listed():
    sample = measurements({"controller.period": [1, 2, 3, 4]}, {"rms": lambda *levels: np.ones(6)})
    told = failing_cells(choose(replace(sample, statuses=["failed", "ok", "failed", "ok"])))
    assert told == "Every run with controller.period 1 or 3 failed, and no other."
