"""Torques for an acceleration and a force of the tip, against forward dynamics."""

import numpy as np
import pytest

from runner.controllers.force.tip_force import TipForce
from runner.controllers.operational_space.whole_body import WholeBody, WholeBodyLaw


def law(**changes):
    numbers = {
        "natural_frequency": 30.0,
        "damping_ratio": 1.0,
        "gravity_compensation": True,
        "feedforward": True,
        "null_space_frequency": 30.0,
        "max_tip_speed": None,
        "singularity_damping": 0.0,
    }
    return WholeBodyLaw(**(numbers | changes))


def states(robot, count=20):
    """Return random states and references."""
    draw = np.random.default_rng(0)
    return [
        (*draw.uniform(-1.0, 1.0, (2, robot.model.nq)), draw.uniform(-1.0, 1.0, (3, 3)), draw.uniform(-5.0, 5.0, 3))
        for _ in range(count)
    ]


@pytest.fixture(scope="module")
def three_stages(checked_config):
    return checked_config("robot=macro_mini_mini").arm


def test_without_a_force_it_is_the_law_of_the_whole_body(combined):
    tip, whole = TipForce(combined, None, law()), WholeBody(combined.model, law(), combined.home)
    for q, dq, reference, _ in states(combined):
        state = tip.task_state(q, dq, reference)
        np.testing.assert_allclose(
            tip.torque(state, state.asked, np.zeros(3)), whole.torque(0.0, q, dq, reference), rtol=1e-9, atol=1e-9
        )


def test_the_tip_gets_the_acceleration_asked_and_that_of_the_force(three_stages):
    model = three_stages.model
    tip = TipForce(three_stages, None, law())
    for q, dq, reference, force in states(three_stages):
        state = tip.task_state(q, dq, reference)
        ddq = model.forward_dynamics(q, dq, tip.torque(state, state.asked, force))
        step = 1e-6  # dJ/dt dq by central differences
        turns = (model.tip_jacobian(q + step * dq)[:3] - model.tip_jacobian(q - step * dq)[:3]) @ dq / (2.0 * step)
        acceleration = model.tip_jacobian(q)[:3] @ ddq + turns
        np.testing.assert_allclose(acceleration, state.asked + state.mobility @ force, rtol=1e-5, atol=1e-5)


def test_the_posture_is_not_felt_by_the_tip(three_stages):
    """J M^-1 N^T tau_0 = 0, against what is left of tau_0 by the plain pseudo-inverse of J^T."""
    model = three_stages.model
    held, free = (TipForce(three_stages, None, law(null_space_frequency=rate)) for rate in (30.0, 0.0))
    for q, dq, reference, _ in states(three_stages):
        state = held.task_state(q, dq, reference)
        posture = held.torque(state, state.asked, np.zeros(3)) - free.torque(state, state.asked, np.zeros(3))
        J, M = model.tip_jacobian(q)[:3], model.mass_matrix(q)
        yields = np.linalg.solve(M, J.T)
        tau_0 = posture + J.T @ np.ones(3)
        moves = np.linalg.norm(yields.T @ tau_0)
        plain = tau_0 - J.T @ (np.linalg.pinv(J.T) @ tau_0)
        assert np.linalg.norm(yields.T @ posture) < 1e-10 * np.linalg.norm(posture) * np.linalg.norm(yields)
        assert np.linalg.norm(yields.T @ plain) > 1e-3 * moves


def test_a_riding_stage_sees_gravity_and_target_turned_and_moving(combined):
    """Its torques are those of its own arm on a fixed base, told R^T of all that the base's place and motion make."""
    tip = TipForce(combined, 1, law(feedforward=True))
    mini, base = combined.stages[1], combined.model.with_tip(combined.stages[1].base_frame)
    for q, dq, reference, _ in states(combined, 5):
        pose, motion = base.tip_pose(q), base.tip_jacobian(q) @ dq
        R, way = pose[:3, :3], reference[0] - pose[:3, 3]
        state = tip.task_state(q, dq, reference)
        np.testing.assert_allclose(state.gravity, R.T @ [0.0, 0.0, -9.81], atol=1e-12)
        np.testing.assert_allclose(state.error, R.T @ way - mini.model.tip_position(q[3:]), atol=1e-12)
        true = R.T @ (combined.model.tip_jacobian(q)[:3] @ dq)
        np.testing.assert_allclose(state.velocity, true, atol=1e-10)
        drift = R.T @ (reference[1] - motion[:3] - np.cross(motion[3:], way))
        np.testing.assert_allclose(state.lag, drift - mini.model.tip_jacobian(q[3:])[:3] @ dq[3:], atol=1e-10)
