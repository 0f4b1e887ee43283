"""Kinematic arm: it is at its commanded positions in each tick."""

import numpy as np
import pytest

from runner.plants.kinematic import Kinematic

TICK = 0.01


@pytest.fixture
def moved(macro):
    """Move the Macro along q(t) = (0.3 t^2, -0.2 t^2, 0.1 t^2) for a while, and return the plant."""
    plant = Kinematic(macro, TICK, 1)
    plant.reset(np.zeros(3), np.zeros(3))
    for k in range(1, 51):
        plant.advance(np.array([0.3, -0.2, 0.1]) * (k * TICK) ** 2)
    return plant


def test_joints_are_where_they_were_told_to_be_one_tick_later(moved):
    np.testing.assert_allclose(moved.q, np.array([0.3, -0.2, 0.1]) * 0.25, atol=1e-15)


def test_its_torques_are_those_that_inverse_dynamics_asks_for(moved, macro):
    a = 2.0 * np.array([0.3, -0.2, 0.1])
    q, dq = 0.5 * a * (49 * TICK) ** 2, a * 49.5 * TICK  # where the last tick began, and its speed
    expected = macro.mass_matrix(q) @ a + macro.coriolis_torque(q, dq) + macro.gravity_torque(q)
    np.testing.assert_allclose(moved.tau, expected, rtol=1e-9)


def test_at_rest_it_only_bears_its_weight(macro):
    plant = Kinematic(macro, TICK, 1)
    q = np.array([0.2, 0.4, -0.3])
    plant.reset(q, np.zeros(3))
    plant.advance(q)
    np.testing.assert_allclose(plant.tau, macro.gravity_torque(q), atol=1e-12)


def test_it_holds_against_the_world_s_load(macro):
    plant = Kinematic(macro, TICK, 1)
    q, load = np.array([0.2, 0.4, -0.3]), np.array([3.0, -6.0, 1.5])
    plant.reset(q, np.zeros(3))
    plant.load[:] = load
    plant.advance(q)
    np.testing.assert_array_equal(plant.q, q)
    np.testing.assert_allclose(plant.tau, macro.gravity_torque(q) - load, atol=1e-12)


def test_a_torque_controller_is_refused(cli):
    ending = cli("robot=macro", "plant=kinematic")
    assert ending.code == 2
    assert "plant.kind: kinematic follows joint positions, and operational_space gives torques" in ending.err
