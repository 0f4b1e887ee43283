"""Stiffest wall of a sampled force law: the bound against simulated contact."""

import numpy as np
import pytest

from runner.controllers.stability import force_loop_limit, force_loop_radius, touch_radius


@pytest.mark.parametrize("delay", [0, 1, 2])
def test_without_a_wall_the_limit_is_that_of_a_sampled_position_loop(delay):
    """The closed forms are those of omega_n h with d ticks of delay; that of one is the root of a cubic."""
    root = min(np.roots([1.0, -8.0, 22.0, -8.0]).real)
    expected = {0: 1.0, 1: root, 2: 0.2579}[delay]
    assert force_loop_limit(np.inf, 1.0, delay) == pytest.approx(expected, rel=1e-3)


@pytest.mark.parametrize("force_gain", [0.0, 1.0, 9.0])
def test_a_slow_law_is_the_continuous_one(force_gain):
    """Critically damped, both eigenvalues are exp(-omega_c h)."""
    rate = 0.01
    assert force_loop_radius(rate, force_gain, 1.0) == pytest.approx(np.exp(-rate), rel=2e-3)


@pytest.mark.parametrize("delay", [0, 1, 2])
@pytest.mark.parametrize("force_gain", [0.0, 1.0, 9.0])
def test_a_motion_simulated_period_by_period_grows_beyond_the_limit_alone(force_gain, delay):
    limit = force_loop_limit(force_gain, 1.0, delay)
    assert _grows(1.001 * limit, force_gain, delay)
    assert not _grows(0.999 * limit, force_gain, delay)


@pytest.mark.parametrize("delay", [0, 1, 2])
def test_a_wall_as_believed_is_that_of_the_force_loop(delay):
    mass, stiffness, period = 0.1, 2e4, 1e-3
    rate = period * np.sqrt(2.0 * stiffness / mass)
    found = touch_radius((1.0, 1.0), mass, stiffness, 0.0, stiffness, period, delay)
    assert found == pytest.approx(force_loop_radius(rate, 1.0, 1.0, delay), rel=1e-12)


def test_a_wall_s_own_damping_slows_what_remains_of_a_law_without_gain():
    """Without k_f, and with a small assumed stiffness, mass, wall and damper are left: exp of the slowest mode."""
    mass, stiffness, drag, period = 0.1, 1e3, 5.0, 1e-3
    modes = np.roots([mass, drag, stiffness])
    found = touch_radius((0.0, 1.0), mass, stiffness, drag, 1e-12, period, 0)
    assert found == pytest.approx(np.exp(modes.real.max() * period), rel=1e-6)


def _grows(rate, force_gain, delay):
    """Return True if a mass grows, by the exact motion under a held push: x = u/w^2 + (x - u/w^2) cos w + v/w sin w."""
    square = rate**2 / (1.0 + force_gain)
    w, x, v, pushes = np.sqrt(square), 1.0, 0.0, [0.0] * delay
    sizes = []
    for _ in range(20_000):
        pushes.append(-square * force_gain * x - 2.0 * rate * v)
        rest = pushes.pop(0) / square
        x, v = rest + (x - rest) * np.cos(w) + v / w * np.sin(w), v * np.cos(w) - (x - rest) * w * np.sin(w)
        sizes.append(abs(x) + abs(v))
        if not 1e-100 < sizes[-1] < 1e100:
            break
    return sizes[-1] > sizes[len(sizes) // 2]
