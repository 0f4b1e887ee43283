"""Motions convolved with impulses."""

import numpy as np
import pytest

from runner.trajectories.goal import Goal
from runner.trajectories.impulses import zero_vibration
from runner.trajectories.motion import quintic_motion
from runner.trajectories.shaped import Shaped

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
