import re
import xml.etree.ElementTree as ET

import matplotlib as mpl
import numpy as np
import pytest

from runner.cli import dispatch
from runner.config.compose import compose
from runner.config.validation import validate
from runner.controllers.macro_mini_graph import macro_mini_graph
from runner.controllers.whole_body_graph import whole_body_graph
from runner.drawing import block_diagram, canvas, frame_assignment
from runner.drawing.control_steps import _centre, _half, control_steps, steps
from runner.drawing.stills import draw
from runner.reporting.figures_staged import macro_mini_targets, staged_torque_and_error
from runner.store import open_run

SCHEDULES = [(schedule, beyond) for schedule in ("both", "turns") for beyond in ("hold", "stretch")]
GRAPH = ("two_way", "minus_home", "full", "real", True, True, True, False, "turns")


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    outputs = tmp_path_factory.mktemp("staged")
    overrides = ["robot=combined", "trajectory=quintic", "trajectory.duration=0.05", "duration=0.1", "plant=rk4"]
    assert dispatch([*overrides, "repetitions=1", "noise=thesis", "torque_limits=thesis", f"outputs={outputs}"]) == 0
    (folder,) = (path for path in (outputs / "runs").iterdir() if path.is_dir())
    return open_run(folder)


@pytest.fixture(scope="module")
def robot():
    return validate(compose(["robot=combined"]).resolved).arm


@pytest.fixture(scope="module")
def makers(robot):
    return {
        "frames": lambda: frame_assignment(robot.model, 0, "T"),
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
def test_every_axis_of_every_frame_is_labelled_once_and_apart(robot, stage):
    model = robot.model if stage is None else robot.stages[stage].model
    with mpl.rc_context(canvas._STYLE):
        figure = frame_assignment.__wrapped__(model, 0, "T")
        texts = [text for text in figure.axes[0].texts if text.get_text()]
        areas = [(text.get_text(), text.get_window_extent()) for text in texts]
    names = [*map(str, range(model.nq)), "T"]
    expected = {f"${letter}_{{{name}}}$" for letter in "xyz" for name in names}
    expected |= {f"$q_{{{joint}}}$" for joint in range(1, model.nq + 1)}
    found = [text for text, _ in areas if "$" in text]
    assert sorted(found) == sorted(expected)
    for index, (one, area) in enumerate(areas):
        for other, other_area in areas[index + 1 :]:
            assert not area.overlaps(other_area), f"{one} on {other}"


def test_only_the_combined_arm_is_shown_enlarged(robot):
    def texts(model):
        return " ".join(text.get_text() for text in frame_assignment.__wrapped__(model).axes[0].texts)

    assert "enlarged" in texts(robot.model)
    assert not any("enlarged" in texts(stage.model) for stage in robot.stages)


def walk(schedule, beyond, turn, within):
    """What is done in a period, from the chart."""
    chart = {step.name: step for step in steps(schedule, beyond)}
    step, done = steps(schedule, beyond)[0], []
    while True:
        if step.kind == "action":
            done.append(step.text)
        if not step.then:
            return " ".join(done)
        answer = {"turn": turn, "reach": within}.get(step.name)
        step = chart[step.then["" if answer is None else "yes" if answer else "no"]]


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
def test_the_chart_has_every_text_within_its_block(schedule, beyond):
    with mpl.rc_context(canvas._STYLE):
        figure = control_steps.__wrapped__(schedule, beyond)
        axes = figure.axes[0]
        to_inches = axes.transData.inverted()
        areas = [(t.get_text(), to_inches.transform(t.get_window_extent())) for t in axes.texts if t.get_text()]
    for step in steps(schedule, beyond):
        low, high = next(a for text, a in areas if text == step.text and abs(a.mean(0) - _centre(step)).max() < 0.1)
        assert np.all(low > _centre(step) - _half(step))
        assert np.all(high < _centre(step) + _half(step))


def test_an_unknown_schedule_has_no_steps():
    with pytest.raises(ValueError, match="never"):
        steps("never", "hold")


def test_torques_and_errors_stand_in_panels_by_stage(run):
    figure = staged_torque_and_error(run, "caption", "figure 5.12")
    assert [[series.name for series in panel.series] for panel in figure.panels] == [
        ["1", "2", "3"], ["4", "5", "6"], ["x_E", "y_E", "z_E"], ["x_T", "y_T", "z_T"],
    ]  # fmt: skip
    trace = run.trace
    np.testing.assert_array_equal(figure.panels[1].series[0].y, trace["tau4"])
    np.testing.assert_array_equal(figure.panels[2].series[1].y, trace["macro_error_y"])
    np.testing.assert_array_equal(figure.panels[3].series[2].y, trace["error_z"])
    assert figure.origin.number == "figure 5.12"
    assert "<svg" in draw(figure)


def test_the_shares_add_up_to_the_way(run):
    figure = macro_mini_targets(run, "figure 5.3")
    tip, end_point, desired = (series.y for series in figure.panels[0].series)
    done, due = (series.y for series in figure.panels[1].series)
    np.testing.assert_allclose(end_point + done, tip, atol=1e-15)
    np.testing.assert_allclose(end_point + due, desired, atol=1e-15)
    np.testing.assert_array_equal(desired, run.trace["desired_x"])
    assert figure.caption
    assert "<svg" in draw(figure)


def test_figures_can_end_early(run):
    for figure in (staged_torque_and_error(run, "", until=0.05), macro_mini_targets(run, until=0.05)):
        assert all(series.x[-1] == pytest.approx(0.05) for panel in figure.panels for series in panel.series)
