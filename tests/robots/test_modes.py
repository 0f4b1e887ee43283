"""Natural vibrations against closed forms."""

import numpy as np
import pytest

from runner.robots.modes import find_modes


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
