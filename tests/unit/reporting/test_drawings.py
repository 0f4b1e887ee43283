"""Drawings as SVG: reproducible, offline, on the paper; camera and circles against geometry."""

import functools
import re
import xml.etree.ElementTree as ET

import numpy as np
import pytest
from support.arms import model_of, urdf_of

from runner.papers.studies.thesis.base_axis import distance_between
from runner.papers.studies.thesis.diagrams.block_diagram import ControlGraph, Edge, Node, block_diagram, control_graph
from runner.papers.studies.thesis.diagrams.frames import frame_assignment
from runner.papers.studies.thesis.diagrams.workspace import _best_samples, workspace_sphere
from runner.reporting.charts.arm import arm_motion
from runner.reporting.charts.canvas import Camera, circle
from runner.robots.model import RobotModel
from runner.robots.workspace import analyse

START, GOAL = np.array([0.0, 1.0, 1.0]), np.array([0.1679, -0.7571, 0.4255])


@pytest.fixture(scope="module")
def macro():
    return model_of("macro")


@pytest.fixture(scope="module")
def line():
    return START + np.linspace(0.0, 1.0, 50)[:, None] * (GOAL - START)


@pytest.fixture(scope="module")
def makers(macro, line):
    workspace = analyse(macro, 3000, np.random.default_rng(0))
    q = np.random.default_rng(1).uniform(-1.0, 1.0, (4, 3))
    return {
        "frames": lambda: frame_assignment(macro),
        "workspace": lambda: workspace_sphere(workspace),
        "diagram": lambda: block_diagram(control_graph("operational space")),
        "arm": lambda: arm_motion(macro, q, [0, 1, 2, 3], line, line, GOAL),
    }


@pytest.fixture(scope="module")
def drawn(makers):
    """Return a drawing by name, made once."""
    return functools.cache(lambda name: makers[name]())


@pytest.mark.parametrize("name", ["frames", "workspace", "diagram", "arm"])
def test_a_drawing_is_one_reproducible_svg_without_text_or_links(makers, drawn, name):
    svg = drawn(name)
    assert svg == makers[name]()
    root = ET.fromstring(svg)
    assert root.tag == "{http://www.w3.org/2000/svg}svg"
    assert not root.findall(".//{http://www.w3.org/2000/svg}text")  # letters are paths, no font is needed
    links = re.findall(r'href="([^"]{1,30})', svg)
    assert all(link.startswith(("#", "data:image/png;base64")) for link in links)
    assert "<dc:date>" not in svg
    assert len(svg) < 500_000


@pytest.mark.parametrize("name", ["frames", "workspace", "diagram", "arm"])
def test_a_drawing_fits_on_the_paper(drawn, name):
    width, height = (float(ET.fromstring(drawn(name)).get(key).removesuffix("pt")) / 72 for key in ("width", "height"))
    assert 3.0 < width < 8.0
    assert 1.5 < height < 6.0


def test_a_drawing_leaves_the_style_of_others_alone(makers):
    import matplotlib as mpl

    before = dict(mpl.rcParams)
    makers["diagram"]()
    assert dict(mpl.rcParams) == before


def test_camera_is_a_rotation_seen_along_its_third_axis():
    camera = Camera(40.0, 25.0)
    R = np.column_stack([camera.project(np.eye(3)), camera.nearness(np.eye(3))])
    np.testing.assert_allclose(R.T @ R, np.eye(3), atol=1e-15)
    assert np.linalg.det(R) == pytest.approx(1.0)
    assert camera.project(np.array([0.0, 0.0, 1.0]))[0] == pytest.approx(0.0)


def test_circle_turns_in_the_positive_sense():
    normal = np.array([1.0, 2.0, -0.5]) / np.linalg.norm([1.0, 2.0, -0.5])
    points = circle(np.array([1.0, 0.0, 0.0]), normal, 0.3) - [1.0, 0.0, 0.0]
    np.testing.assert_allclose(np.linalg.norm(points, axis=1), 0.3)
    np.testing.assert_allclose(points @ normal, 0.0, atol=1e-15)
    assert np.all(np.cross(points[:-1], points[1:]) @ normal > 0.0)


def test_the_thesis_path_passes_the_base_axis_at_0_0951_m(line):
    assert distance_between(line[:, :2], np.zeros(2)) == pytest.approx(0.0951, abs=5e-5)


def test_a_path_that_rests_has_a_nearest_point():
    assert distance_between(np.ones((3, 2)), np.zeros(2)) == pytest.approx(np.sqrt(2.0))


def test_best_samples_are_the_best_of_their_cells(macro):
    workspace = analyse(macro, 2000, np.random.default_rng(2))
    r, z, w = _best_samples(workspace)
    assert w.max() == workspace.manipulability.max()
    assert len(np.unique(np.column_stack([r, z]), axis=0)) == len(r) < 2000


def test_any_graph_can_be_drawn():
    nodes = (Node("a", "source", 0, 0, "$r$"), Node("s", "sum", 1, 0), Node("b", "block", 3, 1, "Plant\nwith name"))
    edges = (
        Edge("a", "s", "$r$", "+"),
        Edge("s", "b", "$e$"),
        Edge("b", "s", "$y$", "-", leave="bottom", enter="bottom", lane=2.5),
    )
    assert "<svg" in block_diagram(ControlGraph(nodes, edges))


def test_an_arm_can_be_drawn_without_paths(macro):
    assert "<svg" in arm_motion(macro, np.zeros((1, 3)), [0.0])


def test_frames_of_the_mini_count_from_three():
    mini = model_of("mini")
    assert frame_assignment(mini, first=3, last="6") != frame_assignment(mini)


def test_a_limited_workspace_shows_its_inner_radius(macro):
    text = urdf_of("macro").replace('lower="-1000.0" upper="1000.0"', 'lower="-1" upper="1"')
    workspace = analyse(RobotModel(text, "tip"), 2000, np.random.default_rng(3))
    assert "<svg" in workspace_sphere(workspace)
