"""Postures of the null space: what they ask for, and that they only lose energy."""

import numpy as np
import pytest
from support.arms import checked
from support.physics import assert_passive

from runner.controllers.operational_space.whole_body import (
    JointStiffness,
    PostureTask,
    null_space_projection,
    posture_pd,
)
from runner.symbolic.maths import NUMPY

XARM7 = checked("robot=xarm7", "controller=operational_space").arm
MODEL, HOME, OMEGA = XARM7.model, XARM7.home, 12.0
COMBINED = checked("robot=combined").arm.model
REST = np.array([0.1, -0.2, 0.3, -0.4, 0.5, -0.6])


def test_the_spring_is_symmetric_and_of_the_held_joints_alone():
    for first in (3, 4):
        K = JointStiffness(COMBINED, OMEGA, REST, first).parameters.stiffness
        np.testing.assert_allclose(K, K.T, atol=1e-12 * np.abs(K).max())
        assert np.linalg.eigvalsh(K[first:, first:])[0] > 0.0
        assert not K[:first].any()
        assert not K[:, :first].any()


def test_the_spring_s_inertia_is_what_the_held_joints_meet_with_the_tip_at_rest():
    J = COMBINED.tip_jacobian(REST)[:3]
    Z = np.vstack([-np.linalg.solve(J[:, :3], J[:, 3:]), np.eye(3)])  # the Mini moves, the tip does not
    expected = OMEGA**2 * Z.T @ COMBINED.mass_matrix(REST) @ Z
    K = JointStiffness(COMBINED, OMEGA, REST, 3).parameters.stiffness
    np.testing.assert_allclose(K[3:, 3:], expected, atol=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize("rows", [3, 6])
def test_a_posture_asks_for_nothing_that_moves_the_tip(rows):
    generator, posture = np.random.default_rng(5), PostureTask(OMEGA, HOME)
    for _ in range(20):
        q, dq = HOME + generator.uniform(-0.5, 0.5, 7), generator.uniform(-1.0, 1.0, 7)
        J = MODEL.tip_jacobian(q)[:rows]
        ddq, torque = posture.acceleration_and_torque(NUMPY, posture.parameters, J, q, dq)
        wanted = -2.0 * OMEGA * dq - OMEGA**2 * (q - HOME)
        np.testing.assert_array_equal(posture_pd(posture.parameters, q, dq), wanted)
        np.testing.assert_allclose(ddq, wanted - np.linalg.pinv(J) @ J @ wanted, atol=1e-8 * np.abs(wanted).max())
        np.testing.assert_allclose(J @ ddq, 0.0, atol=1e-8 * np.abs(wanted).max())
        assert torque is None


def test_the_projector_passes_smoothly_through_a_lost_rank():
    J, ddq = MODEL.tip_jacobian(HOME)[:3], np.arange(1.0, 8.0)
    J[2] = J[1]
    np.testing.assert_allclose(J @ null_space_projection(NUMPY, J, ddq), 0.0, atol=1e-8)
    np.testing.assert_allclose(null_space_projection(NUMPY, J, ddq), ddq - np.linalg.pinv(J) @ J @ ddq, atol=1e-8)
    assert np.isfinite(null_space_projection(NUMPY, 0.0 * J, ddq)).all()


def test_a_posture_only_loses_energy_while_the_tip_rests():
    # |dq|^2 + omega^2 |q - home|^2, along the null space, midpoint by midpoint.
    posture, h = PostureTask(OMEGA, HOME), 5e-4

    def acceleration(q, dq):
        J, e = MODEL.tip_jacobian(q)[:3], 1e-6
        bias = (MODEL.tip_jacobian(q + e * dq) - MODEL.tip_jacobian(q - e * dq))[:3] @ dq / (2.0 * e)
        return posture.acceleration_and_torque(NUMPY, posture.parameters, J, q, dq)[0] - np.linalg.pinv(J) @ bias

    q, dq = HOME + np.array([0.6, 0.3, -0.6, 0.4, 0.7, -0.5, 0.8]), np.zeros(7)
    tip, energies = MODEL.tip_position(q), []
    for _ in range(3000):
        energies.append(dq @ dq + OMEGA**2 * (q - HOME) @ (q - HOME))
        middle, speed = q + 0.5 * h * dq, dq + 0.5 * h * acceleration(q, dq)
        q, dq = q + h * speed, dq + h * acceleration(middle, speed)
    assert_passive(energies, rounding=1e-9 * energies[0])
    np.testing.assert_allclose(MODEL.tip_position(q), tip, atol=1e-5)
    np.testing.assert_allclose(dq, 0.0, atol=1e-5)
    J = MODEL.tip_jacobian(q)[:3]
    np.testing.assert_allclose((q - HOME) - np.linalg.pinv(J) @ J @ (q - HOME), 0.0, atol=1e-5)
