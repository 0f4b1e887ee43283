"""Position servos around a plant that takes torques."""

import numpy as np
import pytest
from support.physics import critically_damped

from runner.plants.motor_limits import TorqueLimits
from runner.plants.rk4 import Rk4
from runner.plants.servo import JointServo, ServoConfig

PERIOD = 0.001
Q = np.array([0.1, 0.3, -0.4])


@pytest.fixture
def servo(macro):
    """Make a servo around the Macro on rk4, at rest at Q."""

    def make(stiffness=1500.0, damping_ratio=1.0, gravity_compensation=True, interpolate=False, limit=np.inf):
        config = ServoConfig(
            stiffness=stiffness,
            damping_ratio=damping_ratio,
            period=PERIOD,
            gravity_compensation=gravity_compensation,
            interpolate=interpolate,
        )
        plant = JointServo(Rk4(macro, PERIOD, 1), macro, config, Q, TorqueLimits.constant(np.full(3, limit)), 1)
        plant.reset(Q, np.zeros(3))
        return plant

    return make


def test_at_rest_with_gravity_compensation_nothing_moves(servo):
    plant = servo()
    for _ in range(200):
        plant.advance(Q)
    np.testing.assert_allclose(plant.q, Q, atol=1e-12)


def test_without_gravity_compensation_it_sags_by_torque_over_stiffness(servo, macro):
    plant = servo(gravity_compensation=False)
    for _ in range(5000):
        plant.advance(Q)
    np.testing.assert_allclose(1500.0 * (Q - plant.q), macro.gravity_torque(plant.q), atol=1e-9)


def test_the_world_s_load_moves_it_by_torque_over_the_stiffness_that_is_left(servo, macro):
    """The load stops the acceleration that the servo relies on: the stiffness is M (M + h D + h^2 K)^-1 K."""
    plant, load, K = servo(), np.array([3.0, -6.0, 1.5]), 1500.0
    plant.load[:] = load
    for _ in range(5000):
        plant.advance(Q)
    M = macro.mass_matrix(plant.q)
    added = np.diag(PERIOD * 2.0 * np.sqrt(K * np.diagonal(macro.mass_matrix(Q))) + PERIOD**2 * K)
    np.testing.assert_allclose(M @ np.linalg.solve(M + added, K * (plant.q - Q)), load, atol=1e-9)


def test_a_small_step_answers_as_a_critically_damped_spring(servo, macro):
    """Only joint 1 of the Macro turns, about the vertical: M_11 of home, no coupling while the others hold still."""
    plant = servo(stiffness=1500.0)
    target = Q + np.array([1e-3, 0.0, 0.0])
    wn = np.sqrt(1500.0 / macro.mass_matrix(Q)[0, 0])
    times, answer = np.arange(1, 301) * PERIOD, []
    for _ in times:
        plant.advance(target)
        answer.append(plant.q[0] - Q[0])
    expected = 1e-3 * (1.0 - critically_damped(times, wn))
    assert np.abs(answer - expected).max() < 1e-3 * wn * PERIOD  # the servo's end-of-period evaluation is first order


@pytest.mark.parametrize("stiffness", [1e2, 1e4, 1e6, 1e9])
def test_no_stiffness_makes_the_sampled_servo_unstable(servo, stiffness):
    plant = servo(stiffness=stiffness, damping_ratio=0.7)
    for _ in range(5000):
        plant.advance(Q + np.array([0.1, -0.1, 0.1]))
    np.testing.assert_allclose(plant.q, Q + np.array([0.1, -0.1, 0.1]), atol=2e-4)


def test_torques_stay_within_their_limits(servo):
    plant = servo(limit=3.0)
    for _ in range(100):
        plant.advance(Q + 1.0)
        assert np.abs(plant.tau).max() <= 3.0


def test_a_commanded_ramp_is_followed_without_lag_where_set_points_bear_velocity(servo):
    speed = 0.2

    def lag(interpolate: bool) -> float:
        plant = servo(interpolate=interpolate)
        for k in range(1, 1001):
            plant.advance(Q + np.array([speed * k * PERIOD, 0.0, 0.0]))
        return float(abs(Q[0] + speed - plant.q[0]))

    assert lag(interpolate=True) < 1e-6
    assert lag(interpolate=False) > 1e-3


def test_a_servo_slower_than_its_commands_is_refused(cli):
    ending = cli("robot=xarm7", "plant=default", "plant.servo.period=0.02")
    assert ending.code == 2
    assert "plant.servo.period: 0.02 s is longer than controller.period, 0.01 s" in ending.err


def test_a_stiffness_list_of_the_wrong_length_names_the_joints(cli):
    ending = cli("robot=xarm7", "plant=default", "plant.servo.stiffness=[1,2]")
    assert ending.code == 2
    assert "plant.servo.stiffness: 2 values for 7 joints (joint1, joint2" in ending.err
