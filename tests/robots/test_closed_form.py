import numpy as np
import pytest

from runner.robots import RobotModel, find_urdf, read_urdf
from runner.robots.closed_form import basic_jacobian, centrifugal_matrix, compare, gravity_torque, mass_matrix

ARMS = [("macro", 1.0, 1.0), ("mini", 0.1, 0.1)]


def thesis_arm(name: str) -> RobotModel:
    return RobotModel(read_urdf(find_urdf(f"{name}.urdf"), {}), "tip")


@pytest.mark.parametrize(("name", "L", "m"), ARMS)
def test_printed_matrices_are_the_model(name, L, m):
    differences = compare(thesis_arm(name), L, m, 1000, np.random.default_rng(0))
    assert set(differences) == {"M", "V", "G", "J", "T"}
    assert max(differences.values()) < 1e-12


def test_compare_sees_a_wrong_model():
    differences = compare(thesis_arm("mini"), 0.1, 0.11, 10, np.random.default_rng(0))
    assert differences["M"] > 1e-5
    assert differences["J"] < 1e-12


def test_centrifugal_matrix_has_no_effect_of_a_joint_on_itself():
    q = np.array([0.3, -0.5, 0.7])
    np.testing.assert_array_equal(np.diag(centrifugal_matrix(q, 1.0, 1.0)), 0.0)


def test_determinant_of_the_linear_jacobian():
    for q in np.random.default_rng(1).uniform(-np.pi, np.pi, (100, 3)):
        expected = -np.cos(q[2]) * (np.cos(q[1]) - np.sin(q[1] + q[2]))
        assert np.linalg.det(basic_jacobian(q, 1.0)[:3]) == pytest.approx(expected, abs=1e-14)


def test_check_values_of_the_macro():
    q, ddq = np.array([0.3, -0.5, 0.7]), np.array([0.6, 0.5, 0.4])
    dq = np.array([0.1, 0.2, 0.3])
    model = thesis_arm("macro")
    tau = mass_matrix(q, 1.0, 1.0) @ ddq + model.coriolis_torque(q, dq) + gravity_torque(q, 1.0, 1.0)
    np.testing.assert_allclose(tau, [0.701956, 16.105894, -1.333807], atol=1e-6)
