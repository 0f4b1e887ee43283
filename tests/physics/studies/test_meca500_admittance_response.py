"""Closed forms of the admittance response against SciPy and their limits."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from runner.config.compose.compose import compose
from runner.controllers.force.admittance_filter import Admittance, AdmittanceFilter
from runner.papers.studies.meca500.frequency_response import frequency_response, sampled_frequency_response
from runner.papers.studies.meca500.plan import law_in
from runner.papers.studies.meca500.step_response import critical_response
from runner.papers.study.study import load_study

# Light, heavy and critical damping, none, hand guiding, a free mass.
LAW = Admittance(
    np.array([2.0, 3.0, 2.0, 1.0, 0.02, 0.5]),
    np.array([20.0, 120.0, 80.0, 0.0, 0.1, 0.0]),
    np.array([800.0, 200.0, 800.0, 4.0, 0.0, 0.0]),
)
STIFF = np.array([800.0, 200.0, 600.0, 4.0, 3.0, 5.0])
LOADS = np.array([5.0, -3.0, 2.0, 0.4, 0.3, -0.2])
TIMES = np.linspace(0.0, 3.0, 40)


def test_the_critical_response_solves_the_law():
    critical = Admittance(LAW.mass, 2.0 * np.sqrt(LAW.mass * STIFF), STIFF)

    def derivative(_, state):
        x, v = np.split(state, 2)
        return np.concatenate([v, (LOADS - critical.damping * v - critical.stiffness * x) / critical.mass])

    solution = solve_ivp(derivative, (0.0, 3.0), np.zeros(12), t_eval=TIMES, rtol=1e-11, atol=1e-13, method="DOP853")
    np.testing.assert_allclose(critical_response(critical, LOADS, TIMES), solution.y[:6].T, rtol=0, atol=1e-9)


@pytest.mark.parametrize("case", ["kinematic, 1 ms", "servo, 16.7 ms"])
def test_the_laws_of_the_steps_are_critically_damped(case):
    law = law_in(compose(load_study("meca500").jobs()[f"step/{case}/rotation z"]).resolved)
    np.testing.assert_allclose(law.damping**2, 4.0 * law.mass * law.stiffness, rtol=1e-12)


def test_the_frequency_response_is_that_of_a_spring_when_slow_and_of_a_mass_when_fast():
    slow, fast = frequency_response(LAW, np.array([1e-4, 1e5]))
    np.testing.assert_allclose(slow[:4], 1.0 / LAW.stiffness[:4], rtol=1e-3)
    np.testing.assert_allclose(fast * LAW.mass, np.full(6, -1e-10), rtol=1e-2)


def test_at_resonance_only_the_damper_bears_the_load():
    natural = np.sqrt(LAW.stiffness[0] / LAW.mass[0])
    assert frequency_response(LAW, np.array([natural]))[0, 0] == pytest.approx(1.0 / (1j * natural * LAW.damping[0]))


@pytest.mark.parametrize("period", [0.001, 0.0167])
def test_the_sampled_response_is_the_filter_s_own(period):
    law = Admittance(LAW.mass, np.full(6, 60.0), np.full(6, 200.0))
    frequency = 2.0 * np.pi / (64 * period)  # 64 samples a turn
    admittance = AdmittanceFilter(law, period)
    found = []
    for tick in range(64 * 100):
        found.append(admittance.translation[0])
        admittance.step(np.eye(6)[0] * np.cos(frequency * period * tick))
    last = np.array(found[-64:])  # a whole number of turns
    phasor = 2.0 / 64.0 * last @ np.exp(-1j * frequency * period * np.arange(64))
    assert sampled_frequency_response(law, period, np.array([frequency]))[0, 0] == pytest.approx(phasor, rel=1e-9)


def test_holding_the_load_costs_half_a_period_of_lag_and_vanishes_with_it():
    frequencies, exact = np.array([5.0, 15.0]), frequency_response(LAW, np.array([5.0, 15.0]))
    for period in (0.002, 0.001):
        lag = np.exp(-0.5j * frequencies * period)[:, None]
        sampled = sampled_frequency_response(LAW, period, frequencies)
        np.testing.assert_allclose(sampled, exact * lag, rtol=2e-4)
        assert np.all(np.abs(sampled / exact - 1.0) < 0.55 * frequencies[:, None] * period)
