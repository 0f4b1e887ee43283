"""Stability of an admittance on a wall: the bound against Jury's criterion and simulated contact."""

import numpy as np
import pytest
from support.covers import covered

from runner.base.errors import ConfigError
from runner.controllers.force.admittance_filter import Admittance, AdmittanceFilter
from runner.controllers.stability import check_wall, stiffest_wall, wall_radius

LAW = Admittance(np.full(6, 2.0), np.full(6, 60.0), np.array([0.0, 300.0, 300.0, 0.0, 0.0, 0.0]))
CONTACTS = {
    "period": (0.001, 0.0167),
    "axis": (0, 1),
    "damping of the wall and delay": ((0.0, 0), (0.0, 1), (0.0, 3), (5.0, 1)),
}


def press(law, period, axis, stiffness, damping, delay, ticks=2000):
    """Growth of a disturbance: the filter itself, pressed against a wall felt some ticks late."""
    admittance = AdmittanceFilter(law, period)
    positions = [0.0] * (delay + 2)
    peaks = []
    for tick in range(ticks):
        felt, before = positions[-1 - delay], positions[-2 - delay]
        force = -stiffness * felt - damping * (felt - before) / period + (1e-3 if tick == 0 else 0.0)
        admittance.step(np.eye(6)[axis] * force)
        positions.append(admittance.translation[axis])
        peaks.append(abs(positions[-1]))
        if peaks[-1] > 1e6:
            break
    return max(peaks[-ticks // 4 :]) / max(peaks[: ticks // 4])


@pytest.mark.parametrize("case", covered(CONTACTS))
def test_contact_dies_out_below_the_bound_and_grows_above_it(case):
    period, axis, (damping, delay) = case.values()
    bound = stiffest_wall(LAW, period, axis, damping, delay)
    assert press(LAW, period, axis, 0.95 * bound, damping, delay) < 0.5
    assert press(LAW, period, axis, 1.05 * bound, damping, delay) > 2.0


def test_the_bound_without_spring_and_delay_is_jury_s():
    # z^2 - (1 + a - k g1) z + a + k (p g2 - a g1) with a = exp(-B h / M), p = (1 - a) M / B: stable while the last
    # coefficient is below 1.
    M, B, h = LAW.mass[0], LAW.damping[0], 0.01
    a = np.exp(-B * h / M)
    p, g2 = (1.0 - a) * M / B, (1.0 - a) / B
    g1 = (h - p) / B
    expected = (1.0 - a) / (p * g2 - a * g1)
    assert stiffest_wall(LAW, h, 0, 0.0, 0) == pytest.approx(expected, rel=1e-9)


def test_at_the_bound_the_spectral_radius_is_one():
    bound = stiffest_wall(LAW, 0.001, 1, 2.0, 1)
    assert wall_radius(LAW, 0.001, 1, bound, 2.0, 1) == pytest.approx(1.0, abs=1e-9)


def test_a_shorter_period_more_damping_and_less_delay_stand_a_stiffer_wall():
    def bound(period=0.001, damping=60.0, delay=1):
        law = Admittance(np.full(6, 2.0), np.full(6, damping), np.zeros(6))
        return stiffest_wall(law, period, 0, 0.0, delay)

    assert bound(period=0.0005) > 1.5 * bound() > 1.5 * bound(period=0.002)
    assert bound(damping=120.0) > 1.5 * bound()
    assert bound(delay=0) > bound() > bound(delay=2)


def test_an_axis_without_damping_stands_no_wall():
    law = Admittance(np.full(6, 2.0), np.zeros(6), np.zeros(6))
    assert stiffest_wall(law, 0.001, 0, 0.0, 1) == 0.0


def test_a_very_heavily_damped_axis_has_a_bound():
    law = Admittance(np.full(6, 2.0), np.full(6, 1e6), np.zeros(6))
    # Only a damper: x + h f / B, unstable above k h / B = 2.
    assert stiffest_wall(law, 0.01, 0, 0.0, 0) == pytest.approx(2.0 * 1e6 / 0.01, rel=1e-3)


def test_a_wall_too_stiff_for_the_rate_is_refused_with_the_bound():
    bound = stiffest_wall(LAW, 0.0167, 0, 0.0, 1)
    check_wall(LAW, 0.001, 1e4, 0.0, 1)
    with pytest.raises(ConfigError) as refusal:
        check_wall(LAW, 0.0167, 1e4, 0.0, 1)
    assert len(refusal.value.problems) == 3
    problem = refusal.value.problems[0]
    assert problem.startswith("controller.period: at 0.0167 s the admittance along x is unstable against a wall")
    assert f"predicted bound: {bound:.4g} N/m" in problem
