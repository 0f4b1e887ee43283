"""Joint quintic: rest at both ends, and the peak speed of its closed form."""

import numpy as np

from runner.trajectories.motion import quintic_motion

START, GOAL, T_F = np.array([0.1, -0.4]), np.array([0.9, 0.2]), 0.8
MOTION = quintic_motion(START, GOAL, T_F)


def test_it_rests_at_both_ends_and_after():
    ends = MOTION.sample(np.array([0.0, T_F, 2.0]))
    np.testing.assert_allclose(ends[:, 0], [START, GOAL, GOAL], atol=1e-15)
    np.testing.assert_allclose(ends[:, 1:], 0.0, atol=1e-12)


def test_half_way_it_has_the_peak_speed_and_no_acceleration():
    (middle,) = MOTION.sample(np.array([0.5 * T_F]))
    np.testing.assert_allclose(middle[0], 0.5 * (START + GOAL), rtol=1e-12)
    np.testing.assert_allclose(middle[1], 1.875 * (GOAL - START) / T_F, rtol=1e-12)
    np.testing.assert_allclose(middle[2], 0.0, atol=1e-12)


def test_derivatives_are_those_of_the_motion():
    times, h = np.linspace(0.1, 0.7, 5), 1e-5
    before, now, after = (MOTION.sample(times + step) for step in (-h, 0.0, h))
    np.testing.assert_allclose(now[:, 1:], (after - before)[:, :2] / (2.0 * h), rtol=1e-7, atol=1e-7)
