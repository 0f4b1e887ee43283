"""Natural vibrations against closed forms."""

import numpy as np
import pytest

from runner.robots.modes import Mode, find_modes, largest_rate


def test_of_one_mass_on_a_spring():
    (mode,) = find_modes(np.array([[3.0]]), np.array([[1.2]]), np.array([[500.0]]))
    assert mode.frequency == pytest.approx(np.sqrt(500.0 / 3.0) / (2 * np.pi), rel=1e-12)
    assert mode.damping_ratio == pytest.approx(1.2 / (2 * np.sqrt(3.0 * 500.0)), rel=1e-12)


def test_of_a_chain_of_masses():
    """Three unit masses between walls, equal springs: omega_k = 2 sin(k pi / 8)."""
    K = 2.0 * np.eye(3) - np.eye(3, k=1) - np.eye(3, k=-1)
    modes = find_modes(np.eye(3), 0.1 * K, K)
    omega = 2.0 * np.sin(np.arange(1, 4) * np.pi / 8)
    assert [mode.frequency for mode in modes] == pytest.approx(list(omega / (2 * np.pi)), rel=1e-12)
    assert [mode.damping_ratio for mode in modes] == pytest.approx(list(0.05 * omega), rel=1e-10)


def test_what_creeps_back_is_no_vibration():
    assert find_modes(np.eye(2), np.diag([3.0, 0.1]), np.eye(2)) == [pytest.approx((1 / (2 * np.pi), 0.05))]


def test_its_amplitude_in_a_signal_is_that_at_the_time_asked_for():
    times = np.linspace(0.0, 3.0, 601)
    omega, zeta = 2 * np.pi * 2.0, 0.05
    signal = 4.0 + 0.3 * np.exp(-zeta * omega * times) * np.sin(omega * np.sqrt(1 - zeta**2) * times + 0.7)
    for after in (0.0, 1.0):
        amplitude = Mode(2.0, zeta).amplitude(times, signal, after)
        assert amplitude == pytest.approx(0.3 * np.exp(-zeta * omega * after), rel=1e-9)


def test_the_largest_rate_is_that_of_the_fastest_mode_or_of_what_creeps_fastest():
    assert largest_rate(np.eye(2), np.zeros((2, 2)), np.diag([4.0, 25.0])) == pytest.approx(5.0)
    assert largest_rate(np.eye(1), np.array([[10.0]]), np.eye(1)) == pytest.approx(5.0 + np.sqrt(24.0))
    free = np.array([[1.0, -1.0], [-1.0, 1.0]])  # two masses and a spring, free as a whole
    assert largest_rate(np.eye(2), 0.0 * free, free) == pytest.approx(np.sqrt(2.0))
