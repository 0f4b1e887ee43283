"""Samples of a Fourier series of the joints against the number of periods of its highest harmonic."""

import numpy as np
import pytest

from runner.trajectories.joint_sinusoids import JointSinusoids


def samples(harmonics, fundamental, duration):
    """Return the samples of a series whose fundamental is in Hz."""
    coefficients = np.ones((1, harmonics, 2))
    return JointSinusoids(np.zeros(1), coefficients, 2.0 * np.pi * fundamental, 0.5, duration).samples


def test_each_period_of_the_highest_harmonic_takes_as_many_samples():
    one = samples(1, 1.0, 5.0) - samples(1, 1.0, 4.0)
    assert one >= 32  # of a sine: the polygon is off by 0.5 % of the amplitude
    assert samples(1, 1.0, 8.0) - samples(1, 1.0, 4.0) == 4 * one
    assert samples(4, 0.5, 8.0) - samples(4, 0.5, 4.0) == 8 * one


@pytest.mark.parametrize("factor", [2.0, 4.0, 8.0])
def test_the_same_curve_in_another_time_takes_the_same_samples(factor):
    assert samples(3, 0.25 * factor, 8.0 / factor) == samples(3, 0.25, 8.0)


def test_a_part_of_a_period_takes_a_part_of_its_samples():
    assert samples(1, 1.0, 4.0) < samples(1, 1.0, 4.1) < samples(1, 1.0, 4.5) < samples(1, 1.0, 5.0)
