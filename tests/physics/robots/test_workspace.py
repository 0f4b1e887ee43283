"""Workspace: reach, manipulability and singular surfaces against the thesis."""

import numpy as np
import pytest
from support.arms import model_of, urdf_of

from runner.robots.model import RobotModel
from runner.robots.workspace import analyse, manipulability

ARMS = [("macro", 1.0), ("mini", 0.1)]


def thesis_arm(name: str) -> RobotModel:
    return model_of(name)


@pytest.mark.parametrize(("name", "L"), ARMS)
def test_the_workspace_is_the_sphere_of_the_thesis(name, L):
    found = analyse(thesis_arm(name), 200, np.random.default_rng(0))
    assert found.reach == pytest.approx(2.0 * L, rel=1e-14)
    assert found.outer == pytest.approx(found.reach, rel=1e-9)
    assert found.inner < 1e-6 * L
    assert np.linalg.norm(found.tips - found.shoulder, axis=1).max() <= found.outer


@pytest.mark.parametrize(("name", "L"), ARMS)
def test_manipulability_is_a_function_of_the_tip_position(name, L):
    found = analyse(thesis_arm(name), 500, np.random.default_rng(1))
    r = np.hypot(found.tips[:, 0], found.tips[:, 1])
    rho = np.linalg.norm(found.tips, axis=1)
    expected = L * r * rho * np.sqrt(np.maximum(1.0 - (rho / (2.0 * L)) ** 2, 0.0))
    np.testing.assert_allclose(found.manipulability, expected, atol=1e-9 * L**3)


@pytest.mark.parametrize(("name", "L"), ARMS)
def test_singular_surfaces(name, L):
    model = thesis_arm(name)
    generator = np.random.default_rng(2)
    q1, q2 = generator.uniform(-np.pi, np.pi, (2, 50))
    stretched = np.column_stack([q1, q2, np.full(50, -np.pi / 2)])
    folded = np.column_stack([q1, q2, np.full(50, np.pi / 2)])
    on_axis = np.column_stack([q1, q2, np.pi / 2 - 2 * q2])  # s23 = sin(pi/2 - q2) = c2
    for q in (stretched, folded, on_axis):
        J = np.array([model.tip_jacobian(row)[:3] for row in q])
        assert manipulability(J).max() < 1e-12 * L**3
    assert np.ptp(np.linalg.norm(model.tip_positions(on_axis), axis=1)) > L  # the whole axis, not only its ends


def test_manipulability_is_the_determinant_for_three_joints_and_its_square_for_more():
    J = np.random.default_rng(3).normal(size=(20, 3, 3))
    np.testing.assert_allclose(manipulability(J), np.abs(np.linalg.det(J)), rtol=1e-10)
    J = np.random.default_rng(4).normal(size=(20, 3, 6))
    np.testing.assert_allclose(manipulability(J) ** 2, np.linalg.det(J @ J.transpose(0, 2, 1)), rtol=1e-10)


def test_joint_limits_bound_the_workspace():
    text = urdf_of("macro")
    text = text.replace('lower="-1000.0" upper="1000.0"', 'lower="-1" upper="1"')
    model = RobotModel(text, "tip")
    found = analyse(model, 2000, np.random.default_rng(5))
    # The elbow opens to q3 = -1 and folds to q3 = 1: rho^2 = 2 - 2 sin(q3).
    assert found.outer == pytest.approx(np.sqrt(2 + 2 * np.sin(1)), rel=1e-6)
    assert found.inner == pytest.approx(np.sqrt(2 - 2 * np.sin(1)), rel=1e-6)


def test_the_same_seed_gives_the_same_workspace():
    model = thesis_arm("macro")
    first, second = (analyse(model, 50, np.random.default_rng(6)) for _ in range(2))
    np.testing.assert_array_equal(first.tips, second.tips)
    assert (first.outer, first.inner) == (second.outer, second.inner)
