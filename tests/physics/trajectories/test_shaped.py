"""Input shapers and shaped motions."""

from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from runner.trajectories.goal import Goal
from runner.trajectories.motion import quintic_motion
from runner.trajectories.shaped import Impulses, Shaped, in_turn, zero_vibration

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


A, B = np.array([0.0, 1.0, 1.0]), np.array([0.4, 0.7, 0.6])
IMPULSES = zero_vibration("zvd", 2.7, 0.02)
LINE = Shaped(quintic_motion(A, B, 1.0), IMPULSES)


def test_velocity_and_acceleration_are_derivatives_of_the_position():
    times, h = np.linspace(0.01, 1.5, 57), 1e-5
    before, now, after = (LINE.sample(times + shift) for shift in (-h, 0.0, h))
    assert (after[:, 0] - before[:, 0]) / (2 * h) == pytest.approx(now[:, 1], abs=1e-8)
    assert (after[:, 1] - before[:, 1]) / (2 * h) == pytest.approx(now[:, 2], abs=1e-6)


def test_it_starts_and_ends_where_the_motion_does_and_later_by_the_last_impulse():
    assert LINE.duration == pytest.approx(1.0 + 1.0 / (2.7 * np.sqrt(1 - 0.02**2)))
    assert LINE.run_duration == pytest.approx(LINE.duration + 1.0)
    first, last, beyond = LINE.sample(np.array([0.0, LINE.duration, LINE.duration + 1.0]))
    assert first == pytest.approx(np.array([A, A * 0, A * 0]), abs=1e-15)
    assert last == pytest.approx(np.array([B, A * 0, A * 0]), abs=1e-12)
    assert beyond == pytest.approx(last, abs=1e-12)
    before = LINE.sample(np.array([LINE.duration - 0.02]))[0]
    assert np.linalg.norm(before[1]) > 1e-4


def test_impulses_come_at_their_exact_times():
    """A motion of 1 ms shows each impulse as a step of its share."""
    quick, (_, at, _) = Shaped(quintic_motion(A, B, 1e-3), IMPULSES), IMPULSES.times
    share = IMPULSES.shares[0]
    reached = quick.sample(np.array([at, at + 1e-3]))[:, 0]
    assert reached[0] == pytest.approx(A + share * (B - A), abs=1e-12)
    assert reached[1] == pytest.approx(A + (share + IMPULSES.shares[1]) * (B - A), abs=1e-12)


def test_a_goal_becomes_a_staircase():
    stairs = Shaped(Goal(A, B), IMPULSES)
    motion = stairs.sample(IMPULSES.times + 1e-9)
    assert motion[:, 0] == pytest.approx(A + np.cumsum(IMPULSES.shares)[:, None] * (B - A), abs=1e-12)
    assert not motion[:, 1:].any()
    assert (stairs.duration, stairs.tracked) == (IMPULSES.delay, False)


def test_a_straight_line_stays_straight():
    assert LINE.distance_to_path(LINE.sample(np.linspace(0, 2, 41))[:, 0]).max() < 1e-12


def test_joints_are_shaped_alike():
    joints = Shaped(quintic_motion(A, B, 1.0), IMPULSES)
    times = np.linspace(0.0, 2.0, 31)
    assert joints.sample(times) == pytest.approx(LINE.sample(times), abs=1e-12)
    assert joints.duration == LINE.duration
    assert joints.samples == np.ceil(512 * LINE.duration)
