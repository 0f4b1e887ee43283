"""The planar arm against the equations that Slotine and Li print for it, and every torque law of one arm on it.

Slotine and Li, Applied Nonlinear Control, 1991, example 9.1 (mass matrix and velocity terms), in the book's letters.
"""

import numpy as np
import pytest
from support.arms import model_of, urdf_of

from runner.robots.model import RobotModel
from runner.sweeps.job import run

M1, L1, ME, I1, LC1, IE, LCE, DELTA_E = 1.0, 1.0, 2.0, 0.12, 0.5, 0.25, 0.6, np.radians(30.0)
A1 = I1 + M1 * LC1**2 + IE + ME * LCE**2 + ME * L1**2
A2 = IE + ME * LCE**2
A3, A4 = ME * L1 * LCE * np.cos(DELTA_E), ME * L1 * LCE * np.sin(DELTA_E)
STATES = np.random.default_rng(22).uniform(-3.0, 3.0, (50, 2, 2))


@pytest.fixture(scope="module")
def planar():
    return model_of("planar")


def close(value, expected):
    return np.abs(np.subtract(value, expected)).max() < 1e-13 * A1 * 9.81


def test_the_mass_matrix_is_the_book_s(planar):
    for q, _ in STATES:
        coupled = A3 * np.cos(q[1]) + A4 * np.sin(q[1])
        assert close(planar.mass_matrix(q), [[A1 + 2.0 * coupled, A2 + coupled], [A2 + coupled, A2]])


def test_the_velocity_terms_are_the_book_s(planar):
    for q, dq in STATES:
        h = A3 * np.sin(q[1]) - A4 * np.cos(q[1])
        velocity_terms = np.array([[-h * dq[1], -h * (dq[0] + dq[1])], [h * dq[0], 0.0]]) @ dq
        assert close(planar.coriolis_torque(q, dq), velocity_terms)


def test_gravity_is_the_slope_of_the_height_of_both_masses(planar):
    for q, _ in STATES:
        first, second = np.cos(q[0]), np.cos(q[0] + q[1] - DELTA_E)
        outer = 9.81 * ME * LCE * second
        assert close(planar.gravity_torque(q), [9.81 * (M1 * LC1 + ME * L1) * first + outer, outer])


def test_without_gravity_it_is_the_horizontal_arm_of_the_book():
    model = RobotModel(urdf_of("planar"), "tip", gravity=0.0)
    assert all(close(model.gravity_torque(q), 0.0) for q, _ in STATES)


def test_the_tip_lies_where_two_links_of_a_metre_end(planar):
    for q, _ in STATES:
        x, z = (turn(q[0]) + turn(q[0] + q[1]) for turn in (np.cos, np.sin))
        assert close(planar.tip_position(q), [x, 0.0, z])


# Largest errors on the straight line of 1 m in 3 s, exact laws have only the error of sampling, 1 ms.
@pytest.mark.parametrize(
    ("controller", "most"),
    [("computed_torque", 2e-5), ("operational_space", 2e-5), ("passivity", 2e-5), ("whole_body", 1e-5),
     ("joint_pd", 6e-3)],
)  # fmt: skip
def test_torque_laws_lead_its_tip(tmp_path, controller, most):
    made = run("robot=planar", f"controller={controller}", "plant=rk4", f"outputs={tmp_path}")
    (error,) = made.record["metrics"]["max_axis_error"]["values"]
    assert 0.0 < error < most


def test_it_runs_as_it_stands_and_around_a_circle_in_its_plane(tmp_path):
    made = run("robot=planar", "trajectory=circle", "trajectory.normal=[0,1,0]", "plant=rk4", f"outputs={tmp_path}")
    assert made.status == "ok"
    assert made.config["controller"]["kind"] == "computed_torque"
