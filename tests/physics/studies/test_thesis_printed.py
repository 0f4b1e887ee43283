"""Printed matrices and determinants of the thesis against the robots' models."""

import numpy as np
import pytest

from runner.papers.studies.thesis.equations.derivations.thesis_printed import (
    compare,
    gravity_torque,
    linear_jacobian,
    mass_matrix,
)
from runner.robots.description import find_urdf, read_urdf
from runner.robots.model import RobotModel


def thesis_arm(name: str) -> RobotModel:
    return RobotModel(read_urdf(find_urdf(f"{name}.urdf"), {}), "tip")


@pytest.mark.parametrize("name", ["macro", "mini"])
def test_printed_matrices_are_the_model(name):
    differences = compare(thesis_arm(name), name == "mini", 1000, np.random.default_rng(0))
    assert set(differences) == {"M", "V", "G", "J", "T"}
    assert max(differences.values()) < 1e-12


def test_compare_sees_a_wrong_model():
    differences = compare(thesis_arm("macro"), True, 10, np.random.default_rng(0))
    assert min(differences.values()) > 0.1


@pytest.mark.parametrize(("mini", "L"), [(False, 1.0), (True, 0.1)])
def test_determinant_of_the_linear_jacobian(mini, L):
    q = np.random.default_rng(1).uniform(-np.pi, np.pi, (100, 3))
    expected = -(L**3) * np.cos(q[:, 2]) * (np.cos(q[:, 1]) - np.sin(q[:, 1] + q[:, 2]))
    np.testing.assert_allclose(np.linalg.det(linear_jacobian(q, mini)), expected, atol=1e-14)


def test_check_values_of_the_macro():
    q, ddq = np.array([0.3, -0.5, 0.7]), np.array([0.6, 0.5, 0.4])
    dq = np.array([0.1, 0.2, 0.3])
    model = thesis_arm("macro")
    tau = mass_matrix(q[None])[0] @ ddq + model.coriolis_torque(q, dq) + gravity_torque(q[None])[0]
    np.testing.assert_allclose(tau, [0.701956, 16.105894, -1.333807], atol=1e-6)
