"""Consistency of errors with their covariance: the band's coverage against its stated probability."""

import numpy as np
import pytest

from runner.calibration import consistency


def draw(scale, repetitions=40, parameters=3, seed=0):
    """Errors of a correlated covariance, larger than it says by a scale."""
    generator = np.random.default_rng(seed)
    root = np.tril(generator.standard_normal((parameters, parameters))) + 2.0 * np.eye(parameters)
    errors = scale * generator.standard_normal((repetitions, parameters)) @ root.T
    return errors, np.tile(root @ root.T, (repetitions, 1, 1))


def test_errors_as_large_as_their_covariance_lie_in_the_band_as_often_as_it_says():
    held = [consistency(*draw(1.0, seed=seed), 0.9).holds for seed in range(1000)]
    assert np.mean(held) == pytest.approx(0.9, abs=0.04)  # four standard deviations


@pytest.mark.parametrize("scale", [0.7, 1.4])
def test_errors_of_another_size_do_not(scale):
    assert not consistency(*draw(scale, repetitions=80), 0.99).holds


def test_the_band_closes_on_the_number_of_parameters():
    few, many = (consistency(*draw(1.0, repetitions), 0.99) for repetitions in (40, 4000))
    assert few.lower < many.lower < 3.0 < many.upper < few.upper
    assert many.mean == pytest.approx(3.0, abs=0.2)
