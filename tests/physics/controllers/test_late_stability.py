"""Stability under delays and missed deadlines: bounds against polynomials and simulated loops."""

import numpy as np
import pytest

from runner.assembly.assemble import assemble
from runner.controllers.stability import (
    delay_limit,
    force_loop_radius,
    miss_limit,
    miss_radius,
    pattern_limit,
)
from runner.simulation.loop import simulate
from runner.simulation.sensors import make_sensors

H = 0.01  # s, the Macro's period
NEAR = ("robot=macro", "plant=rk4", "gravity=0", "trajectory.start=[0.7,0.6,1.2]", "trajectory.goal=[0.70001,0.6,1.2]")


def test_a_late_loop_bears_the_roots_of_its_polynomial():
    assert delay_limit(0) == pytest.approx(1.0, abs=1e-9)
    assert delay_limit(1) == pytest.approx(np.roots([1.0, -8.0, 22.0, -8.0]).real.min(), abs=1e-9)
    assert delay_limit(2) == pytest.approx(0.2579, abs=1e-4)


def test_without_misses_the_mean_square_is_the_square_of_the_radius():
    assert miss_radius(0.5, 0.0) == pytest.approx(force_loop_radius(0.5, np.inf, 1.0) ** 2, rel=1e-9)
    assert miss_limit(1.01) == 0.0


def grows(trace):
    """Return True if a run's error in x grows; the reference is zero, the start 10 um."""
    error = np.abs(trace.error[:, 0])
    return trace.failure is not None or error[-100:].max() > error[300:400].max() + 1e-12


@pytest.mark.parametrize(("missed", "period"), [(1, 20), (2, 30), (3, 40)])
def test_regular_misses_are_borne_as_a_longer_period_is(simulated, missed, period):
    pattern = f"plant.computation.miss={[0] + [1] * missed}"
    for share, expected in ((0.97, False), (1.03, True)):
        law = f"controller.natural_frequency={share * pattern_limit(missed) / H}"
        assert grows(simulated(*NEAR, law, pattern, "duration=10")) == expected, (share, period)


def test_the_thesis_macro_bears_two_regular_misses_and_not_three(simulated):
    line = ("robot=macro", "trajectory=quintic", "plant=rk4")
    assert simulated(*line, "plant.computation.miss=[0,1,1]").failure is None
    bad = simulated(*line, "plant.computation.miss=[0,1,1,1]")
    assert bad.failure is not None or np.abs(bad.error).max() > 0.1


def test_the_thesis_macro_bears_one_tick_of_delay_and_not_two(simulated):
    line = ("robot=macro", "trajectory=quintic", "plant=rk4")
    assert np.abs(simulated(*line, "plant.computation.delay=1").error).max() < 5e-3
    assert simulated(*line, "plant.computation.delay=2").failure is not None


def second_moments(checked_config, rate, missed, repetitions=6000, ticks=60):
    """Map of the second moments of (x, v h, a h^2) of one Macro axis over a tick, fitted to simulated runs, (6, 6)."""
    config = checked_config(
        *NEAR, f"controller.natural_frequency={rate / H}", f"plant.computation.miss={missed}", f"duration={ticks * H}"
    )
    closed, before, after = assemble(config), [], []
    J = closed.robot.model.tip_jacobian(closed.q_start)[0]
    for repetition in range(repetitions):
        trace = simulate(closed, *make_sensors(closed, config, repetition))
        x, v = -trace.error[:, 0], trace.dq @ J * H
        a = np.append(0.0, np.diff(v))  # of the tick before
        z = np.column_stack([x, v, a])[1:]
        there = np.abs(z[:-1]).max(axis=1) > 1e-11  # rounding is 1e-16
        size = np.linalg.norm(z[:-1][there], axis=1, keepdims=True)
        before.append(z[:-1][there] / size)
        after.append(z[1:][there] / size)
    closed.close()
    pairs = np.triu_indices(3)
    squares = [np.einsum("ti,tj->tij", z, z)[:, *pairs] for z in (np.vstack(before), np.vstack(after))]
    return np.linalg.lstsq(*squares, rcond=None)[0].T


@pytest.mark.slow
@pytest.mark.parametrize("rate", [0.3, 0.5, 0.7])
def test_misses_are_borne_in_the_mean_square_up_to_the_closed_form(checked_config, rate):
    """Compute from both sides of the closed form the rate with constant second moments, in simulated runs."""
    shares = np.array([0.85, 1.0, 1.15])
    moments = [second_moments(checked_config, rate, share * miss_limit(rate)) for share in shares]
    growths = [np.log(np.abs(np.linalg.eigvals(each)).max()) for each in moments]
    slope, offset = np.polyfit(shares, growths, 1)
    assert growths[0] < 0.0 < growths[2]
    assert -offset / slope == pytest.approx(1.0, abs=0.05)


def test_two_repetitions_miss_otherwise_and_one_again_alike(simulated):
    runs = [simulated(*NEAR, "plant.computation.miss=0.3", "duration=1", repetition=r).tau for r in (0, 1, 0)]
    assert not np.array_equal(runs[0], runs[1])
    np.testing.assert_array_equal(runs[0], runs[2])


def test_missed_torques_are_held(simulated):
    tau = simulated(*NEAR, "plant.computation.miss=[0,1,0]", "duration=0.3").tau
    held = np.all(tau[1:] == tau[:-1], axis=1)
    assert held[0::3].all()  # ticks 1, 4, ... repeat those before
    assert not held[1::3].any()


def test_jitter_lets_the_newest_command_act(simulated):
    even = simulated(*NEAR, "duration=0.5", "plant.computation.delay=1")
    certain = simulated(*NEAR, "duration=0.5", "plant.computation.jitter=[0,1]")
    np.testing.assert_allclose(certain.q, even.q, atol=1e-12)
    uneven = simulated(*NEAR, "duration=0.5", "plant.computation.jitter=[0.5,0.5]")
    assert not np.array_equal(uneven.tau, even.tau)


def test_each_loop_has_a_delay_of_its_own(simulated):
    both = ("robot=combined", "trajectory=quintic", "plant=rk4", "duration=0.4")
    late = simulated(*both, "plant.computation.delay={macro: 10, mini: 1}")
    assert len(np.unique(late.tau[:11, 0])) == 1  # the first command, until the second one has come
    assert late.tau[11, 0] == late.tau[19, 0] or late.tau[20, 0] != late.tau[10, 0]
    assert len(np.unique(late.tau[:2, 3])) == 1
    assert late.tau[2, 3] != late.tau[1, 3]
    alike = [simulated(*both, f"plant.computation.delay={delay}") for delay in (1, "{macro: 1, mini: 1}")]
    np.testing.assert_array_equal(alike[0].q, alike[1].q)
