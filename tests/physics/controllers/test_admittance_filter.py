"""Admittance filter: steps, energy and composition against the exact solution of its linear law."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import solve_ivp
from scipy.spatial.transform import Rotation
from support.physics import assert_energy_kept
from support.step_response import step_response

from runner.base.errors import ConfigError
from runner.controllers.force.admittance_filter import Admittance, AdmittanceFilter, discretise
from runner.sensing.wrench import wrench_transform

MASS = np.array([2.0, 3.0, 1.0, 0.02, 0.03, 0.01])
DAMPING = np.array([20.0, 120.0, 0.0, 0.1, 0.9, 0.2])  # light, heavy, none
STIFFNESS = np.array([800.0, 200.0, 100.0, 4.0, 1.0, 2.0])
LAW = Admittance(MASS, DAMPING, STIFFNESS)
SETTLING = Admittance(MASS, 1.4 * np.sqrt(MASS * STIFFNESS), STIFFNESS)
GUIDED = Admittance(MASS, np.where(DAMPING > 0.0, DAMPING, 5.0), np.zeros(6))
PERIODS = (1e-4, 1e-3, 0.0167, 0.1)


def one_axis(axis, value=1.0):
    return value * np.eye(6)[axis]


def run(law, period, wrenches):
    """Displacements before each step and after the last, shape (T + 1, 6)."""
    admittance = AdmittanceFilter(law, period)
    rows = [admittance.displacement]
    for wrench in wrenches:
        admittance.step(wrench)
        rows.append(admittance.displacement)
    return np.array(rows)


@pytest.mark.parametrize("period", PERIODS)
@pytest.mark.parametrize("law", [LAW, GUIDED], ids=["sprung", "guided"])
@pytest.mark.parametrize("axis", range(6))
def test_a_step_is_answered_as_the_law_says_at_any_rate(period, law, axis):
    ticks = min(round(2.0 / period), 2000)
    load = one_axis(axis, 5.0 if axis < 3 else 0.3)
    exact = step_response(law, load, period * np.arange(ticks + 1))
    found = run(law, period, [load] * ticks)
    np.testing.assert_allclose(found, wrapped(exact), rtol=0, atol=1e-10 * np.abs(exact).max())


def wrapped(displacements):
    """Displacements with rotation vectors of at most half a turn, as the filter gives them."""
    vectors = Rotation.from_rotvec(displacements[:, 3:]).as_rotvec()
    return np.hstack([displacements[:, :3], vectors])


@pytest.mark.parametrize("period", PERIODS[1:])
def test_it_rests_exactly_where_the_spring_bears_the_load(period):
    wrench = np.array([5.0, -3.0, 2.0, 1.2, -0.4, 0.6])
    found = run(SETTLING, period, [wrench] * round(10.0 / period))
    np.testing.assert_allclose(found[-1], wrench / STIFFNESS, rtol=1e-9)
    np.testing.assert_allclose(found[-1], found[-2], rtol=0, atol=1e-13)


@pytest.mark.parametrize("period", PERIODS[1:])
def test_without_a_load_it_does_not_move_and_after_one_it_comes_back(period):
    ticks = round(10.0 / period)
    assert np.all(run(LAW, period, np.zeros((100, 6))) == 0.0)
    push = [np.array([5.0, -3.0, 2.0, 1.2, -0.4, 0.6])] * max(ticks // 10, 1)
    np.testing.assert_allclose(run(SETTLING, period, push + [np.zeros(6)] * ticks)[-1], np.zeros(6), atol=1e-12)


@pytest.mark.parametrize("period", PERIODS)
def test_an_undamped_axis_keeps_its_energy(period):
    # Released from a stretched spring; numerical damping or growth would change 1/2 M v^2 + 1/2 K x^2.
    law = Admittance(MASS, np.zeros(6), STIFFNESS)
    admittance = AdmittanceFilter(law, period)
    energies = []
    for tick in range(5_000):
        admittance.step(one_axis(0, 8.0) if tick == 0 else np.zeros(6))
        x, v = admittance.displacement, admittance.velocity
        energies.append(0.5 * (MASS[0] * v[0] ** 2 + STIFFNESS[0] * x[0] ** 2))
    assert_energy_kept(energies, 5e-10)


@given(st.floats(1e-4, 0.2), st.integers(2, 5))
def test_one_long_period_is_several_short_ones(period, parts):
    Phi, Gamma = discretise(LAW, period)
    short_Phi, short_Gamma = discretise(LAW, period / parts)
    state, held = np.tile(np.eye(2), (6, 1, 1)), np.zeros((6, 2))
    for _ in range(parts):
        state = short_Phi @ state
        held = np.einsum("aij,aj->ai", short_Phi, held) + short_Gamma
    np.testing.assert_allclose(state, Phi, rtol=0, atol=1e-11 * np.abs(Phi).max())
    np.testing.assert_allclose(held, Gamma, rtol=0, atol=1e-12 * np.abs(Gamma).max())


def test_guided_by_hand_an_axis_moves_with_the_push_and_stops_by_its_damping():
    push = one_axis(1, 6.0)
    found = run(GUIDED, 0.001, [push] * 2000 + [np.zeros(6)] * 2000)
    impulse = 6.0 * 2.0
    assert found[-1][1] == pytest.approx(impulse / GUIDED.damping[1], rel=1e-9)


def test_translations_and_turns_do_not_mix():
    wrench = np.array([5.0, -3.0, 2.0, 0.0, 0.0, 0.0])
    assert np.all(run(LAW, 0.001, [wrench] * 500)[:, 3:] == 0.0)
    assert np.all(run(LAW, 0.001, [one_axis(4, 0.3)] * 500)[:, :3] == 0.0)


def test_a_pure_force_through_the_tip_turns_nothing():
    # The sensor reads it with the moment of its lever; seen from the tip that moment goes, to rounding.
    generator = np.random.default_rng(3)
    tip = np.eye(4)  # the tip in the sensor's frame
    tip[:3, :3] = Rotation.random(rng=generator).as_matrix()
    tip[:3, 3] = [0.012, -0.007, 0.093]
    from_sensor = wrench_transform(np.linalg.inv(tip))
    for law in (LAW, GUIDED):
        admittance = AdmittanceFilter(law, 0.001)
        for _ in range(1000):
            force = generator.uniform(-10.0, 10.0, 3)
            sensed = np.concatenate([force, np.cross(tip[:3, 3], force)])
            admittance.step(from_sensor @ sensed)
        assert np.abs(Rotation.from_matrix(admittance.rotation).as_rotvec()).max() < 1e-12
        assert np.abs(admittance.translation).max() > 1e-4


def test_turns_add_along_fixed_axes():
    # Guided by hand a quarter turn about x and, after rest, a quarter turn about y, of the frame that rests.
    law = Admittance(np.full(6, 0.01), np.full(6, 0.1), np.zeros(6))
    admittance = AdmittanceFilter(law, 0.001)
    quarter = 0.5 * np.pi * 0.1 / 1.0  # moment of B times the angle over a second
    for axis in (3, 4):
        for tick in range(4000):
            admittance.step(one_axis(axis, quarter) if tick < 1000 else np.zeros(6))
    expected = Rotation.from_rotvec([0.0, np.pi / 2, 0.0]) * Rotation.from_rotvec([np.pi / 2, 0.0, 0.0])
    np.testing.assert_allclose(admittance.rotation, expected.as_matrix(), atol=1e-9)


def test_guided_by_hand_it_turns_past_half_a_turn():
    law = Admittance(np.full(6, 0.01), np.full(6, 0.1), np.zeros(6))
    wrench = one_axis(5, 0.1 * 5.0)  # 5 rad/s at last
    found = run(law, 0.001, [wrench] * 2000)
    exact = step_response(law, wrench, np.array([2.0]))
    np.testing.assert_allclose(found[-1], wrapped(exact)[-1], atol=1e-10)
    assert exact[0, 5] > 3.0 * np.pi


def turn_exactly(law, moment, seconds):
    """Rotation of a body whose angular velocity, along fixed axes, obeys the law, by fine integration."""

    def derivative(_, state):
        omega, quaternion = state[:3], state[3:]
        spring = law.stiffness[3:] * Rotation.from_quat(quaternion).as_rotvec()
        acceleration = (moment - law.damping[3:] * omega - spring) / law.mass[3:]
        x, y, z, w = quaternion
        rate = 0.5 * np.concatenate([w * omega + np.cross(omega, [x, y, z]), [-omega @ [x, y, z]]])
        return np.concatenate([acceleration, rate])

    start = np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0])
    solution = solve_ivp(derivative, (0.0, seconds), start, rtol=1e-11, atol=1e-12)
    return Rotation.from_quat(solution.y[3:, -1])


def test_turning_about_changing_axes_converges_with_the_period():
    moment = np.array([2.0, -0.8, 1.1])
    exact = turn_exactly(LAW, moment, 0.2)
    errors = []
    for ticks in (100, 200, 400):
        admittance = AdmittanceFilter(LAW, 0.2 / ticks)
        for _ in range(ticks):
            admittance.step(np.concatenate([np.zeros(3), moment]))
        errors.append((Rotation.from_matrix(admittance.rotation) * exact.inv()).magnitude())
    assert errors[0] < 0.01
    assert errors[1] < 0.6 * errors[0]
    assert errors[2] < 0.6 * errors[1]


def test_the_rotation_stays_one():
    admittance = AdmittanceFilter(GUIDED, 0.001)
    generator = np.random.default_rng(0)
    for _ in range(20_000):
        admittance.step(generator.uniform(-1.0, 1.0, 6))
    R = admittance.rotation
    np.testing.assert_allclose(R.T @ R, np.eye(3), atol=1e-15)


def test_reset_forgets():
    admittance = AdmittanceFilter(LAW, 0.001)
    first = []
    for _ in range(2):
        for _ in range(50):
            admittance.step(np.ones(6))
        first.append(admittance.displacement)
        admittance.reset()
        assert np.all(admittance.displacement == 0.0)
        assert np.all(admittance.velocity == 0.0)
        np.testing.assert_array_equal(admittance.rotation, np.eye(3))
    np.testing.assert_array_equal(*first)


def test_what_is_handed_out_is_a_copy():
    admittance = AdmittanceFilter(LAW, 0.001)
    admittance.step(np.ones(6))
    kept = admittance.displacement.copy()
    admittance.displacement[:] = admittance.translation[:] = admittance.velocity[:] = 7.0
    np.testing.assert_array_equal(admittance.displacement, kept)


@pytest.mark.parametrize(
    ("mass", "damping", "stiffness", "problems"),
    [
        (0.0, 1.0, 1.0, ["controller.mass: M must be positive definite: allowed on each axis: above 0; found 0 for y"]),
        (-2.0, 1.0, 1.0, ["found -2 for y"]),
        (1.0, -0.5, 1.0, ["controller.damping: B must be positive semi-definite: .* 0 or more; found -0.5 for y"]),
        (1.0, 1.0, -3.0, ["controller.stiffness: K must be positive semi-definite: .*; found -3 for y"]),
        (float("nan"), 1.0, 1.0, ["controller.mass: .* found nan for y"]),
        (0.0, -1.0, -1.0, ["controller.mass", "controller.damping", "controller.stiffness"]),
    ],
)
def test_a_law_that_is_not_definite_is_refused_axis_by_axis(mass, damping, stiffness, problems):
    def on_y(value):
        return np.array([1.0, value, 1.0, 1.0, 1.0, 1.0])

    with pytest.raises(ConfigError) as refusal:
        Admittance(on_y(mass), on_y(damping), on_y(stiffness))
    assert len(refusal.value.problems) == len(problems)
    for problem in problems:
        assert refusal.match(problem)


def test_neither_damper_nor_spring_is_needed():
    Admittance(MASS, np.zeros(6), np.zeros(6))
