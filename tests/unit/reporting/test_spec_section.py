"""The spec of a sweep over its axes."""

from pathlib import Path

import numpy as np
import pytest
from support.sample_sweep import measurements, two_axes

from runner.reporting.document import Curves, Maps, Table, Text
from runner.reporting.sweep import spec
from runner.reporting.sweep.subject import choose
from runner.schema.bound import Bound
from runner.statistics.proportion import count_share
from runner.store.sweep import Sweep

SPEC = {"rms": Bound(max=0.5)}


def failing(*numbers, of=100):
    """Return the values of a metric; this many of them break SPEC, by the level of the first axis."""
    return lambda level, *_: np.where(np.arange(of) < numbers[level], 1.0, 0.0)


def one_axis(values=(1e-4, 1e-3, 1e-2), numbers=(0, 20, 100)):
    return choose(measurements({"noise.position": list(values)}, {"rms": failing(*numbers)}))


def swept(bounds):
    return Sweep(Path(), (), (), "", bounds)


def blocks(section, kind):
    return [block for block in section.blocks if isinstance(block, kind)]


def test_over_one_axis_it_is_a_curve_with_the_interval_as_its_band():
    (figure,) = blocks(spec.section(one_axis(), swept(SPEC)), Curves)
    shares, few = figure.panels[0].series
    exact = [count_share(count, 100) for count in (0, 20, 100)]
    np.testing.assert_allclose(shares.y, [0.0, 0.2, 1.0])
    np.testing.assert_allclose(shares.low, [each.low for each in exact])
    np.testing.assert_allclose(shares.high, [each.high for each in exact])
    assert (few.name, few.x.tolist(), few.y.tolist()) == ("too few repetitions to tell", [1e-4], [0.0])


def test_over_texts_they_stand_in_their_order():
    (figure,) = blocks(spec.section(one_axis(("a", "b", "c")), swept(SPEC)), Curves)
    assert list(figure.panels[0].x_names) == ["a", "b", "c"]


def test_over_two_axes_it_is_a_map_of_the_share_and_one_of_the_upper_end():
    axes = {"noise.position": [1e-4, 1e-3, 1e-2], "torque_limits.max": [20.0, 40.0]}
    subject = choose(measurements(axes, {"rms": failing(0, 4, 60)}))
    (figure,) = blocks(spec.section(subject, swept(SPEC)), Maps)
    share, upper = figure.panels
    np.testing.assert_allclose(share.values, [[0.0, 0.04, 0.6]] * 2)
    np.testing.assert_allclose(upper.values[0], [count_share(count, 100).high for count in (0, 4, 60)])
    assert figure.log
    assert share.failed.tolist() == [[True, False, False]] * 2
    assert "A cross marks too few repetitions to tell. Cells without a colour are 0." in figure.caption
    assert share.hints[1] == "torque_limits.max=20, noise.position=0.001: 4 of 100 failed, 0.04 (0.011 to 0.0993)"


def test_a_third_axis_gives_further_maps():
    axes = {"noise.position": [1e-4, 1e-3], "torque_limits.max": [20.0, 40.0], "controller.coupling": ["a", "b"]}
    subject = choose(measurements(axes, {"rms": failing(3, 30)}))
    (figure,) = blocks(spec.section(subject, swept(SPEC)), Maps)
    assert [panel.title.partition(":")[0] for panel in figure.panels[::2]] == [
        "controller.coupling = a", "controller.coupling = b",
    ]  # fmt: skip


def test_seeds_are_pooled():
    subject = choose(measurements({"noise.position": [1e-4, 1e-3], "seed": [0.0, 1.0]}, {"rms": failing(1, 30)}))
    (figure,) = blocks(spec.section(subject, swept(SPEC)), Curves)
    np.testing.assert_allclose(figure.panels[0].series[0].high, [count_share(2, 200).high, count_share(60, 200).high])


def test_the_table_pools_seeds_like_the_figures():
    axes = {"noise.position": [1e-4, 1e-3], "seed": [0.0, 1.0]}
    (table,) = blocks(spec.section(choose(measurements(axes, {"rms": failing(1, 30)})), swept(SPEC)), Table)
    assert [row[0] for row in table.rows] == ["noise.position=0.001", "noise.position=0.0001"]
    assert [row[1].partition(",")[0] for row in table.rows] == ["60 of 200 failed", "2 of 200 failed"]
    assert "Cells that differ only in the seed are counted together." in table.caption
    (table,) = blocks(
        spec.section(choose(measurements({"seed": [0.0, 1.0]}, {"rms": failing(1, 30)})), swept(SPEC)), Table
    )
    assert [row[:1] for row in table.rows] == [["all seeds"]]


def test_the_table_has_each_cell_with_its_interval_those_that_fail_most_first():
    (table,) = blocks(spec.section(one_axis(), swept(SPEC)), Table)
    assert [row[0] for row in table.rows] == ["noise.position=0.01", "noise.position=0.001", "noise.position=0.0001"]
    assert table.rows[-1][1] == "0 of 100 failed, 0 (0 to 0.0362); too few"


def test_several_bounds_are_kept_together_by_the_same_repetitions():
    metrics = {"rms": failing(0, 20, 100), "overshoot": lambda level: np.where(np.arange(100) < 90, 0.0, 1.0)}
    subject = choose(measurements({"noise.position": [1.0, 2.0, 3.0]}, metrics))
    both = {**SPEC, "overshoot": Bound(max=0.5)}
    found = spec.find_failing(subject, both)
    assert [one.failed.tolist() for one in found] == [[0, 20, 100], [10, 10, 10], [10, 30, 100]]
    assert spec.summary(subject, swept(both)) == "0 of 3 cells keep the spec in every repetition."
    assert spec.summary(subject, swept(SPEC)) == "1 of 3 cells keep the spec in every repetition."


def test_a_failed_run_keeps_nothing_and_a_missing_metric_is_told():
    subject = two_axes(failed=(0,))
    (found,) = spec.find_failing(subject, {"peak_torque": Bound(max=1e6)})
    assert found.failed.tolist() == [8] + [0] * 11
    texts = [block.text for block in blocks(spec.section(subject, swept({"overshoot": Bound(max=1.0)})), Text)]
    assert texts[-1].startswith("No run of the sweep has the metric of the bound: overshoot at most 1 m")


@pytest.mark.parametrize(("failed", "few"), [(0, True), (3, True), (4, False), (100, False)])
def test_too_few_are_those_that_leave_even_the_magnitude_open(failed, few):
    (found,) = spec.find_failing(one_axis((1.0, 2.0), (failed, 50)), SPEC)
    assert found.few.tolist() == [few, False]
    low, high = (end[0] for end in found.ends)
    assert (high > 10.0 * low) == few
