"""Drawings of arms in stages and of their control, and figures of a run of theirs."""

import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.patches import FancyBboxPatch, Polygon

from runner.reporting.charts.static import draw
from runner.studies.thesis.chapter5 import macro_mini_targets
from runner.studies.thesis.diagrams.block_diagram import block_diagram
from runner.studies.thesis.diagrams.control_steps import control_steps, steps
from runner.studies.thesis.diagrams.frames import frame_assignment
from runner.studies.thesis.diagrams.macro_mini import macro_mini_graph
from runner.studies.thesis.diagrams.whole_body import whole_body_graph

SCHEDULES = [(schedule, beyond) for schedule in ("both", "turns") for beyond in ("hold", "stretch")]
GRAPH = ("two_way", "minus_home", "full", "real", True, True, True, False, "turns")


@pytest.fixture
def run(runs):
    return runs["stages"]


@pytest.fixture
def measured(monkeypatch):
    """Return a function that measures the figure of a drawing in its style."""

    def measure(draw, of_figure):
        found = []
        with monkeypatch.context() as patch:
            patch.setattr(Figure, "savefig", lambda figure, *_, **__: found.append(of_figure(figure)))
            draw()
        return found[0]

    return measure


@pytest.fixture(scope="module")
def makers(combined):
    return {
        "frames": lambda: frame_assignment(combined.model, 0, "T"),
        "whole": lambda: block_diagram(whole_body_graph(True, True, True, False, True)),
        "staged": lambda: block_diagram(macro_mini_graph(*GRAPH)),
        "steps": lambda: control_steps("turns", "stretch"),
    }


@pytest.mark.parametrize("name", ["frames", "whole", "staged", "steps"])
def test_a_drawing_is_one_reproducible_svg_that_fits_on_the_paper(makers, name):
    svg = makers[name]()
    assert svg == makers[name]()
    root = ET.fromstring(svg)
    assert not root.findall(".//{http://www.w3.org/2000/svg}text")
    assert all(link.startswith("#") for link in re.findall(r'href="([^"]{1,30})', svg))
    width, height = (float(root.get(key).removesuffix("pt")) / 72 for key in ("width", "height"))
    assert 3.0 < width < 8.0
    assert 1.5 < height < 6.0


@pytest.mark.parametrize("stage", [None, 0, 1])
def test_every_axis_of_every_frame_is_labelled_once_and_apart(combined, measured, stage):
    model = combined.model if stage is None else combined.stages[stage].model

    def labels(figure):
        return [(text.get_text(), text.get_window_extent()) for text in figure.axes[0].texts if text.get_text()]

    areas = measured(lambda: frame_assignment(model, 0, "T"), labels)
    names = [*map(str, range(model.nq)), "T"]
    expected = {f"${letter}_{{{name}}}$" for letter in "xyz" for name in names}
    expected |= {f"$q_{{{joint}}}$" for joint in range(1, model.nq + 1)}
    found = [text for text, _ in areas if "$" in text]
    assert sorted(found) == sorted(expected)
    for index, (one, area) in enumerate(areas):
        for other, other_area in areas[index + 1 :]:
            assert not area.overlaps(other_area), f"{one} on {other}"


def test_only_the_combined_arm_is_shown_enlarged(combined, measured):
    def texts(figure):
        return " ".join(text.get_text() for text in figure.axes[0].texts)

    models = [combined.model, *(stage.model for stage in combined.stages)]
    enlarged = ["enlarged" in measured(lambda model=model: frame_assignment(model), texts) for model in models]
    assert enlarged == [True, False, False]


def walk(schedule, beyond, turn, within):
    """Return the actions of one period, from the chart; each step occurs at most once."""
    chart = {step.name: step for step in steps(schedule, beyond)}
    step, done = steps(schedule, beyond)[0], []
    for _ in chart:
        if step.kind == "action":
            done.append(step.text)
        if not step.then:
            return " ".join(done)
        answer = {"turn": turn, "reach": within}.get(step.name)
        step = chart[step.then["" if answer is None else "yes" if answer else "no"]]
    raise AssertionError(f"{schedule}, {beyond}: the steps have no end")


@pytest.mark.parametrize(("schedule", "beyond"), SCHEDULES)
@pytest.mark.parametrize("turn", [False, True])
@pytest.mark.parametrize("within", [False, True])
def test_the_steps_do_what_the_loops_do(schedule, beyond, turn, within):
    done = walk(schedule, beyond, turn, within)
    turns = schedule == "turns"
    assert ("Macro holds" in done) == (turns and turn and within)
    assert ("Macro moves" in done) != ("Macro holds" in done)
    mini_waits = turns and not turn
    assert ("Mini holds" in done) == (mini_waits or (not within and beyond == "hold"))
    assert ("Mini stretches" in done) == (not mini_waits and not within and beyond == "stretch")
    assert ("Mini moves" in done) == (not mini_waits and within)


@pytest.mark.parametrize(("schedule", "beyond"), SCHEDULES)
def test_the_chart_has_every_text_within_its_block(measured, schedule, beyond):
    def areas(figure):
        axes = figure.axes[0]
        texts = [(text.get_text(), text.get_window_extent()) for text in axes.texts if text.get_text()]
        return texts, [
            block.get_window_extent() for block in axes.patches if isinstance(block, FancyBboxPatch | Polygon)
        ]

    texts, blocks = measured(lambda: control_steps(schedule, beyond), areas)
    chart = steps(schedule, beyond)
    for step in chart:
        within = [
            sum(block.x0 < area.x0 < area.x1 < block.x1 and block.y0 < area.y0 < area.y1 < block.y1 for block in blocks)
            for text, area in texts
            if text == step.text
        ]
        assert within == [1] * sum(other.text == step.text for other in chart)


def test_an_unknown_schedule_has_no_steps():
    with pytest.raises(ValueError, match="never"):
        steps("never", "hold")


def test_the_shares_add_up_to_the_way(run):
    figure = macro_mini_targets(run, "figure 5.3")
    tip, end_point, desired = (series.y for series in figure.panels[0].series)
    done, due = (series.y for series in figure.panels[1].series)
    np.testing.assert_allclose(end_point + done, tip, atol=1e-15)
    np.testing.assert_allclose(end_point + due, desired, atol=1e-15)
    np.testing.assert_array_equal(desired, run.trace()["desired_x"])
    assert figure.caption
    assert "<svg" in draw(figure)


def test_figures_can_end_early(run):
    figure = macro_mini_targets(run, until=0.05)
    assert all(series.x[-1] == pytest.approx(0.05) for panel in figure.panels for series in panel.series)
