"""Impulses of input shapers against the modes that they are to leave at rest."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from runner.trajectories.impulses import Impulses, in_turn, zero_vibration

RATIOS = [0.5, 0.8, 0.95, 1.0, 1.05, 1.3, 2.0]


@pytest.mark.parametrize("ratio", RATIOS)
def test_without_damping_the_residual_is_a_cosine_and_its_square(ratio):
    cosine = abs(np.cos(0.5 * np.pi * ratio))
    assert zero_vibration("zv", 3.0, 0.0).residual(3.0 * ratio) == pytest.approx(cosine, abs=1e-14)
    assert zero_vibration("zvd", 3.0, 0.0).residual(3.0 * ratio) == pytest.approx(cosine**2, abs=1e-14)


@pytest.mark.parametrize("kind", ["zv", "zvd"])
@pytest.mark.parametrize("zeta", [0.0, 0.02, 0.3])
def test_shares_add_up_and_the_mode_itself_rests(kind, zeta):
    impulses = zero_vibration(kind, 3.0, zeta)
    assert impulses.shares.sum() == pytest.approx(1.0, abs=1e-15)
    assert impulses.residual(3.0, zeta) < 1e-14
    assert impulses.delay == pytest.approx((1 if kind == "zv" else 2) * 0.5 / (3.0 * np.sqrt(1.0 - zeta**2)))


@pytest.mark.parametrize("zeta", [0.0, 0.1])
def test_zvd_has_no_slope_over_the_frequency_and_zv_has(zeta):
    def slope(kind):
        impulses = zero_vibration(kind, 3.0, zeta)
        return impulses.residual(3.0 + 1e-5, zeta) / 1e-5

    assert slope("zv") == pytest.approx(0.5 * np.pi / 3.0, rel=0.2)
    assert slope("zvd") < 1e-4


@pytest.mark.parametrize("kind", ["zv", "zvd"])
@pytest.mark.parametrize("ratio", [0.8, 1.0, 1.15])
def test_an_oscillator_rings_as_the_residual_says(kind, ratio):
    zeta, f = 0.05, 2.0 * ratio
    impulses = zero_vibration(kind, 2.0, zeta)
    omega = 2.0 * np.pi * f

    def after(times, shares, end):
        """Return the amplitude of x'' + 2 zeta omega x' + omega^2 x = a pulse of 0.1 s, repeated, at an end."""

        def slope(t, x):
            force = np.dot(shares, np.sin(np.pi * np.clip((t - np.array(times)) / 0.1, 0.0, 1.0)))
            return [x[1], force - 2 * zeta * omega * x[1] - omega**2 * x[0]]

        breaks, x = [0.0, *sorted({*times[1:], *(np.array(times) + 0.1)})], [0.0, 0.0]
        for first, last in pairwise(breaks):
            x = solve_ivp(slope, (first, last), x, rtol=1e-10, atol=1e-13).y[:, -1]
        assert breaks[-1] == end
        return np.hypot(x[0], (x[1] + zeta * omega * x[0]) / (omega * np.sqrt(1 - zeta**2)))

    alone = after([0.0], [1.0], 0.1)
    shaped = after(impulses.times, impulses.shares, impulses.delay + 0.1)
    assert shaped / alone == pytest.approx(impulses.residual(f, zeta), abs=1e-6)


def test_sequences_in_turn_leave_every_one_of_their_modes_at_rest():
    both = in_turn([zero_vibration("zv", 2.0, 0.02), zero_vibration("zvd", 5.0, 0.1)])
    assert both.residual(2.0, 0.02) < 1e-14
    assert both.residual(5.0, 0.1) < 1e-14
    assert np.all(np.diff(both.times) > 0.0)
    assert len(both.times) == 6
    assert both.shares.sum() == pytest.approx(1.0)


def test_one_impulse_leaves_all_vibration():
    assert Impulses(np.zeros(1), np.ones(1)).residual(7.0, 0.3) == 1.0
