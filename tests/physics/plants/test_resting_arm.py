"""Exact map of a resting arm with flexible joints: against the plant, and bounds of gains against Routh."""

from dataclasses import replace

import numpy as np
import pytest
from support.arms import model_of
from support.resting_arm import RestingArm

from runner.plants.flexibility import Flexibility
from runner.plants.flexible_joints import FlexibleJoints

HOME = np.zeros(3)  # rad, of the thesis
PERIOD, OMEGA = 1e-2, 30.0


def loaded_macro():
    return model_of("macro").with_payload(0.2)  # the Mini's mass


def weight_slope(model, width=1e-5):
    bumps = width * np.eye(3)
    return np.array(
        [(model.gravity_torque(HOME + bump) - model.gravity_torque(HOME - bump)) / (2.0 * width) for bump in bumps]
    ).T


def resting(model, stiffness, motor, damping):
    full = np.ones(3)
    return RestingArm(
        model.mass_matrix(HOME), weight_slope(model), stiffness * full, motor * full, np.asarray(damping) * full
    )


def one_joint(links, motor, stiffness, damping_ratio):
    reduced = links * motor / (links + motor)
    natural = np.sqrt(stiffness / reduced)
    damping = 2.0 * damping_ratio * natural * reduced
    return RestingArm(np.array([[links]]), np.zeros((1, 1)), *np.array([[stiffness], [motor], [damping]])), natural


def differenced(model, arm, at_motors, width=1e-5):
    """Spectral radius of the plant's map over one period, by central differences."""
    flexibility = Flexibility(arm.K, arm.B, arm.D, np.full(3, np.inf), np.zeros(3))
    plant = FlexibleJoints(model, flexibility, PERIOD / 20.0, 20)
    plant.reset(HOME, np.zeros(3))
    rest = np.concatenate([plant.q, plant.theta, np.zeros(6)])
    inertia, at_rest = arm.M + np.diag(arm.B), model.gravity_torque(HOME)

    def move(state):
        plant.q[:], plant.theta[:], plant.dq[:], plant.dtheta[:] = np.split(state, 4)
        y = (state - rest)[3:6] if at_motors else (state - rest)[:3]
        dy = plant.dtheta if at_motors else plant.dq
        plant.advance(at_rest + arm.W @ y - inertia @ (OMEGA**2 * y + 2.0 * OMEGA * dy))
        return np.concatenate([plant.q, plant.theta, plant.dq, plant.dtheta])

    bumps = width * np.eye(12)
    slopes = np.array([(move(rest + bump) - move(rest - bump)) / (2.0 * width) for bump in bumps]).T
    return np.abs(np.linalg.eigvals(slopes)).max()


@pytest.mark.parametrize("at_motors", [True, False])
@pytest.mark.parametrize(("stiffness", "motor"), [(300.0, 1.6), (300.0, 1.7), (1000.0, 2.0), (3000.0, 0.5)])
def test_the_exact_map_is_that_of_the_plant(stiffness, motor, at_motors):
    model = loaded_macro()
    arm = resting(model, stiffness, motor, [0.3, 0.5, 0.2])
    assert arm.radius(OMEGA, 1.0, PERIOD, at_motors) == pytest.approx(differenced(model, arm, at_motors), rel=1e-6)


def test_at_motors_a_motor_that_is_too_light_for_the_period_is_unstable():
    model = loaded_macro()
    heavy, light = (resting(model, 300.0, motor, 0.0).radius(OMEGA, 1.0, PERIOD, True) for motor in (1.7, 1.6))
    assert heavy < 1.0 < light


def test_soft_springs_leave_the_motors_alone_with_the_gains_of_the_whole():
    model = loaded_macro()
    largest = np.linalg.eigvalsh(model.mass_matrix(HOME)).max()
    limit = largest / (1.0 / (OMEGA * PERIOD) - 1.0)  # omega_n h (1 + lambda_max(B^-1 M)) = 1
    arms = [resting(model, 1e-6, factor * limit, 0.0) for factor in (1.001, 0.999)]
    heavy, light = (replace(arm, W=np.zeros((3, 3))).radius(OMEGA, 1.0, PERIOD, True) for arm in arms)
    assert heavy < 1.0 + 1e-6  # links on no spring stand still: 1
    assert light > 1.0 + 1e-4


@pytest.mark.parametrize(("damping_ratio", "factor"), [(0.02, 1.0008), (0.05, 1.005), (0.10, 1.020)])
def test_at_links_gains_are_borne_as_routh_has_it(damping_ratio, factor):
    arm, natural = one_joint(3.0, 2.0, 1000.0, damping_ratio)
    limit = factor * damping_ratio * natural
    below, above = (arm.radius(part * limit, 1.0, 2e-5, False) for part in (0.98, 1.02))
    assert below < 1.0 < above


@pytest.mark.parametrize(("stiffness", "expected"), [(300.0, 0.039), (1000.0, 0.094), (3000.0, 0.217)])
def test_at_motors_the_slow_mode_is_damped_as_in_continuous_time(stiffness, expected):
    links, motor, omega, period = 3.0, 0.5, 30.0, 1e-5
    damping, whole = 2.0 * 0.02 * np.sqrt(stiffness * links), links + motor
    arm = RestingArm(np.array([[links]]), np.zeros((1, 1)), *np.array([[stiffness], [motor], [damping]]))
    of_motor = [motor, damping + 2.0 * omega * whole, omega**2 * whole + stiffness]
    spring = [damping, stiffness]
    roots = np.roots(np.polysub(np.polymul([links, *spring], of_motor), np.polymul(spring, spring)))
    slow = roots[np.argmax(roots.real)]
    assert -slow.real / abs(slow) == pytest.approx(expected, abs=1e-3)
    assert np.log(arm.radius(omega, 1.0, period, True)) / period == pytest.approx(slow.real, rel=2e-3)


def test_stiff_springs_are_unstable_at_motors_where_their_mode_is_too_fast_for_the_period():
    model = loaded_macro()
    links = np.diag(model.mass_matrix(HOME))
    arms = [resting(model, K, 2.0, 2.0 * 0.02 * np.sqrt(K * links)) for K in (1e4, 1e5)]
    bears, fails = (arm.radius(OMEGA, 1.0, PERIOD, True) for arm in arms)
    assert bears < 1.0 < fails
    assert arms[1].radius(OMEGA, 1.0, PERIOD / 10.0, True) < 1.0


@pytest.mark.parametrize("at_motors", [True, False])
def test_without_bending_the_arm_is_a_unit_mass_under_the_held_law(at_motors):
    arm = replace(resting(loaded_macro(), 1e9, 2.0, 1e6), W=np.zeros((3, 3)))
    rigid = np.array([[1.0, PERIOD], [0.0, 1.0]]) - np.outer([PERIOD**2 / 2.0, PERIOD], [OMEGA**2, 2.0 * OMEGA])
    expected = np.abs(np.linalg.eigvals(rigid)).max()
    assert arm.radius(OMEGA, 1.0, PERIOD, at_motors) == pytest.approx(expected, rel=1e-4)
