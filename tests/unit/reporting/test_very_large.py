"""Reports of sweeps with thousands of cells: what is grouped, thinned or left out, and that the report says so."""

import numpy as np
import pytest
from support.sample_sweep import measurements

from runner.reporting.charts.figure import POINTS
from runner.reporting.document import Curves, Table, Text
from runner.reporting.sweep import cells, distributions, effects, maps, tradeoff
from runner.reporting.sweep.subject import MOST_GROUPS, choose, group_levels

SEEDS = 3000


@pytest.fixture(scope="module")
def subject():
    """3,000 seeds, two gains, one repetition each; every tenth seed failed."""
    scatter = np.random.default_rng(0).normal(size=2 * SEEDS)
    metrics = {
        "max_tracking_error": lambda seed, gain: [np.exp(gain + 0.1 * scatter[2 * seed + gain])],
        "peak_torque": lambda seed, gain: [5.0 - gain + 0.1 * scatter[2 * seed + gain]],
    }
    grid = {"seed": list(map(float, range(SEEDS))), "controller.natural_frequency": [8.0, 10.0]}
    return choose(measurements(grid, metrics, failed=range(0, 2 * SEEDS, 20)))


def of_kind(section, kind):
    return [block for block in section.blocks if isinstance(block, kind)]


def test_an_axis_of_very_many_values_is_taken_in_groups_of_neighbours(subject):
    seed, gain = subject.axes
    levels = group_levels(seed)
    assert len(np.unique(levels)) == MOST_GROUPS
    assert (np.diff(levels) >= 0).all()
    counts = np.bincount(levels)
    assert counts.max() - counts.min() <= 2  # one value of the axis is two cells
    assert group_levels(gain) is gain.level


def test_effects_say_that_they_are_of_groups(subject):
    made = effects.section(subject)
    assert f"seed: taken in {MOST_GROUPS} groups of neighbouring values." in [text.text for text in of_kind(made, Text)]


def test_few_values_are_taken_as_they_are():
    grid = {"a": list(map(float, range(MOST_GROUPS))), "b": [1.0, 2.0]}
    few = choose(measurements(grid, {"rms": lambda a, b: [1.0 + a + b]}))
    assert not any("groups of" in text.text for text in of_kind(effects.section(few), Text))
    assert maps.is_readable(few)


def test_maps_of_very_many_values_are_left_out():
    def of(count):
        grid = {"a": list(map(float, range(count))), "b": [1.0, 2.0]}
        return choose(measurements(grid, {"rms": lambda a, b: [1.0 + a + b]}))

    assert maps.is_readable(of(200))
    assert not maps.is_readable(of(201))


def test_figures_have_points_that_can_be_told_apart(subject):
    figures = of_kind(distributions.section(subject), Curves)
    traded = tradeoff.section(subject, ("max_tracking_error", "peak_torque"))
    for figure in [*figures, *of_kind(traded, Curves)]:
        for panel in figure.panels:
            for series in panel.series:
                assert series.style != "points" or series.x.size <= POINTS  # lines are thinned where they are drawn
                assert len(series.hints or ()) <= POINTS
    assert f"of {2 * SEEDS - 2 * SEEDS // 20} cells" in of_kind(traded, Text)[0].text  # all count, not only those drawn


def test_cells_in_order_are_thinned_with_both_ends():
    gains = {"controller.natural_frequency": list(map(float, range(1, SEEDS + 1)))}
    many = choose(measurements(gains, {"rms": lambda gain: [gain]}, failed=range(0, SEEDS, 20)))
    (panel,) = of_kind(distributions.section(many), Curves)[-1].panels
    (series,) = panel.series
    assert (panel.x_label, panel.x_names) == ("rank of the cell, by median", [])
    assert series.x.size <= POINTS
    assert (series.x[0], series.x[-1]) == (1.0, 0.95 * SEEDS)  # every twentieth failed


def test_distributions_are_of_groups_not_of_single_seeds(subject):
    by_seed, by_gain = of_kind(distributions.section(subject), Curves)[0].panels
    assert by_seed.series[0].name == "0 to 46"  # a 64th of 3,000
    assert by_seed.series[-1].name.endswith(" to 2999")
    assert all(series.x.size > 100 for series in by_seed.series)
    assert [series.name for series in by_gain.series] == ["8", "10"]


def test_of_many_failures_some_are_listed(subject):
    by_axis, runs = of_kind(cells.failures_section(subject), Table)
    assert len([row for row in by_axis.rows if row[0] == "seed"]) == 40
    assert [row[2] for row in by_axis.rows if row[0] == "controller.natural_frequency"] == [f"300 of {SEEDS}"]
    assert len(runs.rows) == 40
    assert "260 more are" in runs.caption
