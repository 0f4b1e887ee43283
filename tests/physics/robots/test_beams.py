"""Beams: Euler and Bernoulli's modes, and rigid parts that weigh what the whole does."""

from itertools import islice

import numpy as np
import pinocchio as pin
import pytest
from support.arms import checked

from runner.papers.studies.thesis_beyond.cantilever import cantilever_roots
from runner.robots.vibration import Beam, moving_links, parts_of, span, stiffen_robot


@pytest.mark.parametrize(
    ("tip_ratio", "squares"),
    [(0.0, [3.51602, 22.03449, 61.69721]), (1.0, [1.55730, 16.25009]), (10.0, [0.54138, 15.51151])],
)
def test_the_roots_of_a_cantilever_are_those_of_the_textbooks(tip_ratio, squares):
    roots = np.array(list(islice(cantilever_roots(tip_ratio), len(squares))))
    assert roots**2 == pytest.approx(squares, abs=6e-6)


def test_a_heavy_tip_makes_a_massless_spring_of_the_beam():
    """omega^2 = 3 EI/(m_tip L^3), so that b^4 r goes to 3, less what the beam's own 33/140 adds."""
    first = next(cantilever_roots(1e4))
    assert first**4 * (1e4 + 33.0 / 140.0) == pytest.approx(3.0, rel=1e-5)


@pytest.mark.parametrize("count", [1, 2, 5])
def test_parts_weigh_together_what_the_rod_does(count):
    along, beam, length = np.array([0.6, 0.0, 0.8]), Beam(1.0, 0.7), 1.3
    whole = pin.Inertia.Zero()
    for part in parts_of(length, count):
        whole += pin.SE3(np.eye(3), part.begin * along).act(part.rod(beam, length, along))
    assert whole.mass == pytest.approx(0.7)
    assert whole.lever == pytest.approx(0.65 * along)
    assert whole.inertia == pytest.approx(0.7 * 1.3**2 / 12.0 * (np.eye(3) - np.outer(along, along)), abs=1e-14)
    assert len(parts_of(length, count)) == count + 1
    assert [part.begin for part in parts_of(length, count)][1:] == pytest.approx(
        [(k + 0.5) * length / count for k in range(count)]
    )


def test_links_that_move_are_named_and_measured():
    arm = checked("robot=macro").arm
    assert moving_links(arm.model) == {"link1": 1, "link2": 2, "link3": 3}
    spans = [span(arm.model, joint, arm.flange).tolist() for joint in (1, 2, 3)]
    assert spans == [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]


def test_a_stiffened_robot_has_the_rods_in_its_whole_and_in_its_stages():
    arm = checked("robot=combined").arm
    heavy = stiffen_robot(arm, {"link2": Beam(1.0, 0.3), "mini_link3": Beam(1.0, 0.02)})
    assert heavy.model.mass - arm.model.mass == pytest.approx(0.32)
    assert [a.model.mass - b.model.mass for a, b in zip(heavy.stages, arm.stages, strict=True)] == [
        pytest.approx(0.3),
        pytest.approx(0.02),
    ]
    gained = heavy.stages[0].model.mass_matrix(np.zeros(3)) - arm.stages[0].model.mass_matrix(np.zeros(3))
    assert gained == pytest.approx(np.diag([0.1, 0.1, 0.0]), abs=1e-12)  # m L^2/3 about both joints at its start
