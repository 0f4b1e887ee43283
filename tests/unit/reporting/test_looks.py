"""Figures of made-up sweeps by property: no number without a value, one look for a level, levels in the data."""

import csv
import io

import numpy as np
import pytest
from support.sample_sweep import measurements

from runner.reporting.charts import palette, static
from runner.reporting.comparison.difference_figure import difference_panel
from runner.reporting.document import Curves
from runner.reporting.export.figures import as_csv, for_paper
from runner.reporting.sweep import distributions, effects
from runner.reporting.sweep.question import find_answers
from runner.reporting.sweep.subject import MOST_LOOKS, choose

SWEEPS, DRAWN = 500, 20
LAWS = ["joint_pd", "computed_torque", "operational_space", "pid", "sliding_mode"]
NUMBERS = {"noise.position": [1e-4, 1e-3, 1e-2], "controller.natural_frequency": [1.0, 10.0, 400.0],
           "seed": list(map(float, range(12)))}  # fmt: skip


def made_up(seed):
    """Return a sweep of laws over one other axis, with failed cells and cells that settle in some repetitions or none.

    Repetitions of both laws that have no value are drawn for whole levels, too.
    """
    rng = np.random.default_rng(seed)
    laws = LAWS[: rng.integers(2, len(LAWS) + 1)]
    name = list(NUMBERS)[seed % len(NUMBERS)]
    values = NUMBERS[name][: rng.integers(1, len(NUMBERS[name]) + 1)]
    shape = (len(laws), len(values), 8)
    found = np.exp(0.1 * rng.normal(size=shape) + 0.2 * np.arange(len(laws))[:, None, None])
    found[rng.random(shape) < rng.choice([0.0, 0.3])] = np.inf
    found[rng.random(shape[:2]) < rng.choice([0.0, 0.3])] = np.inf
    found[:, rng.random(shape[1]) < rng.choice([0.0, 0.5])] = np.inf
    axes = {"controller": laws, name: values} if len(values) > 1 else {"controller": laws}
    metric = {"settling_time": lambda law, level=0: found[law, level]}
    failed = [cell for cell, own in enumerate(found.reshape(-1, 8)) if np.isinf(own).all() and rng.random() < 0.5]
    return choose(measurements(axes, metric, failed), ["settling_time"])


def figures(subject, answers):
    """Return the figures of a sweep as blocks: differences, cells, distributions."""
    made = [Curves("d", [difference_panel([(one.place, one) for one in answers], "at")])] if answers else []
    made += filter(None, [effects.cells_with_intervals(subject, "settling_time") if len(subject.axes) <= 2 else None])
    if subject.ranked:
        made += [block for block in distributions.section(subject).blocks if isinstance(block, Curves)]
    return made


def rows(figure):
    return list(csv.DictReader(io.StringIO(as_csv(figure).decode())))


@pytest.fixture(scope="module")
def sweeps():
    subjects = [made_up(seed) for seed in range(SWEEPS)]
    return [(subject, find_answers(subject)) for subject in subjects]


@pytest.mark.costs(4)
def test_no_number_where_no_pair_has_a_value(sweeps):
    lost = 0
    for subject, answers in sweeps:
        values = subject.measurements.values["settling_time"]
        for one in answers:
            first = slice(1 if one.comparison.exact else None)  # nothing is drawn
            a, b = (values[of, first] for of in (one.pairs.of_a, one.pairs.of_b))
            both = np.isinf(a) & np.isinf(b)
            assert one.comparison.empty.repetitions == both.sum()
            assert one.comparison.empty.levels == both.any(axis=1).sum()
            if subject.axes[-1].name != "seed":  # whose levels are draws
                assert one.comparison.n == (~both).any(axis=0).sum()
            assert one.is_lost == both.all()
            if one.is_lost:
                lost += 1
                assert "–" in one.cells[0]
                assert not any(letter.isdigit() for letter in one.sentence().partition(": ")[2].split(" and ")[1])
                (panel,) = Curves("", [difference_panel([("all", one)], "at")]).panels
                assert not any(np.isfinite(series.y).any() for series in panel.series[1:])
            elif both.any():
                assert str(one.comparison.empty) in one.sentence() or one.word.startswith("too few")
    assert lost > 100


@pytest.mark.costs(4)
def test_a_level_has_one_look_in_every_figure(sweeps):
    for subject, answers in sweeps:
        seen = {}
        for figure in figures(subject, answers):
            for panel in figure.panels:
                own = [series for series in panel.series if series.level]
                assert len({series.color for series in own}) == len({series.name for series in own}) <= MOST_LOOKS
                for series in own:
                    level = series.name.rpartition(" = ")[2]
                    assert seen.setdefault(level, series.color) == series.color
        laws = subject.axes[0]
        assert subject.looks(laws) == {level: level for level in range(len(laws.values))}
        shown = distributions.choose_cells(subject, subject.ranked)
        for name, cells, look in shown.cells:
            level = name.removeprefix("controller=")
            assert {laws.text(int(laws.level[cell])) for cell in cells} == {level}
            assert seen.get(level, look) == look


def test_more_levels_than_looks_are_told():
    axes = {"controller.natural_frequency": list(map(float, range(1, 13)))}
    many = choose(measurements(axes, {"rms": lambda level: [1.0 + level] * 3}))
    figure = next(block for block in distributions.section(many).blocks if isinstance(block, Curves))
    assert f"{MOST_LOOKS} of 12 values of controller.natural_frequency are shown." in figure.caption
    assert len({series.color for series in figure.panels[0].series}) == MOST_LOOKS


def test_looks_differ_in_colour_mark_and_dash():
    for kind in (palette.LIGHT, palette.MARKS, palette.DASHES):
        assert len(set(kind)) == len(kind) == MOST_LOOKS


@pytest.mark.costs(4)
def test_abscissae_of_the_data_are_levels(sweeps):
    for subject, answers in sweeps:
        for figure in figures(subject, answers)[: 1 + bool(answers)]:
            names = {name for panel in figure.panels for name in panel.x_names}
            numbers = {float(value) for axis in subject.axes if axis.numbers is not None for value in axis.numbers}
            for row in rows(figure):
                if row["x axis"].startswith(("at", "controller", "noise", "seed")):
                    assert row["x"] in names or float(row["x"]) in numbers
                for name in ("y", "low", "median", "high"):
                    assert row[name] == "" or np.isfinite(float(row[name]))


@pytest.mark.costs(4)
def test_such_figures_are_drawn(sweeps):
    for subject, answers in sweeps[:: SWEEPS // DRAWN]:
        for figure in figures(subject, answers)[:1]:
            assert "<svg" in static.draw(for_paper(figure)[0])
