"""Drawings of arms in stages and of their control."""

import re
import xml.etree.ElementTree as ET

import pytest
from matplotlib.figure import Figure

from runner.papers.studies.thesis.diagrams.block_diagram import block_diagram, control_graph
from runner.papers.studies.thesis.diagrams.frames import frame_assignment


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
        "whole": lambda: block_diagram(control_graph("figure 5.2")),
        "staged": lambda: block_diagram(control_graph("figure 5.9")),
        "steps": lambda: block_diagram(control_graph("figure 5.6")),
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
