"""Scatter of the tip against drawn joint errors, and coverage of the band of consistent errors."""

import numpy as np
import pytest

from runner.calibration.uncertainty import consistency, joint_deviation, pose_covariances

REPEATABILITY = 5e-6
POSTURES = np.array([[0.0, 0.3, -0.2, 0.1, 1.2, 0.0], [0.5, 0.1, 0.4, -1.0, 0.6, 2.0]])


def scatter(model, q, deviation, draws=4000):
    generator = np.random.default_rng(2)
    return np.array([model.tip_pose(q + deviation * generator.standard_normal(6)) for _ in range(draws)])


def test_the_joints_scatter_the_tip_by_the_repeatability(meca500):
    deviation = joint_deviation(meca500, POSTURES, REPEATABILITY)
    squares = [
        np.mean(np.sum((scatter(meca500, q, deviation)[:, :3, 3] - meca500.tip_position(q)) ** 2, axis=1))
        for q in POSTURES
    ]
    # 4,000 draws know a mean square to 2 %.
    np.testing.assert_allclose(np.sqrt(np.mean(squares)), REPEATABILITY, rtol=0.03)


def test_the_covariance_is_that_of_the_scattered_poses(meca500):
    deviation, q = 1.4e-5, POSTURES[1]
    (covariance,) = pose_covariances(meca500, q[None], deviation)
    true, poses = meca500.tip_pose(q), scatter(meca500, q, deviation)
    turns = poses[:, :3, :3] @ true[:3, :3].T
    errors = np.hstack([poses[:, :3, 3] - true[:3, 3], turns[:, [2, 0, 1], [1, 2, 0]]])
    whitened = np.linalg.solve(np.linalg.cholesky(covariance), errors.T)
    np.testing.assert_allclose(np.cov(whitened), np.eye(6), atol=0.08)  # four standard deviations and more


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
