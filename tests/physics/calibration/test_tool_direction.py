"""Direction of a tool: alignment angles against rotations, and errors against their covariance."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from runner.base.errors import ConfigError
from runner.calibration.tool_centre_point import ToolCentrePoint, identify_tool_centre_point
from runner.calibration.tool_direction import alignment, alignment_angles, identify_tool_direction
from runner.calibration.uncertainty import consistency, pose_covariances

directions = (
    st.lists(st.floats(-1.0, 1.0), min_size=3, max_size=3)
    .map(np.array)
    .filter(lambda vector: np.linalg.norm(vector) > 0.1)
    .map(lambda vector: vector / np.linalg.norm(vector))
)


def tool(position, deviation=0.0):
    return ToolCentrePoint(np.array(position), deviation**2 * np.eye(3), 1.0, 1.0, 0.0)


@given(directions)
def test_the_aligned_z_axis_is_the_direction(direction):
    R = alignment(*alignment_angles(direction))
    np.testing.assert_allclose(R[:, 2], direction, rtol=0, atol=1e-15)
    np.testing.assert_allclose(R.T @ R, np.eye(3), atol=1e-15)
    assert np.linalg.det(R) == pytest.approx(1.0)


def test_the_alignment_turns_about_x_and_then_about_the_new_y():
    c, s = np.cos(0.3), np.sin(0.3)
    np.testing.assert_allclose(alignment(0.3, 0.0), [[1, 0, 0], [0, c, -s], [0, s, c]], atol=1e-16)
    np.testing.assert_allclose(alignment(0.0, 0.3), [[c, 0, s], [0, 1, 0], [-s, 0, c]], atol=1e-16)
    np.testing.assert_allclose(alignment(0.7, 0.3), alignment(0.7, 0.0) @ alignment(0.0, 0.3), atol=1e-16)


def test_the_report_s_example():
    alpha, beta = alignment_angles(np.ones(3) / np.sqrt(3.0))
    assert (alpha, beta) == (pytest.approx(-np.pi / 4), pytest.approx(np.arctan(1.0 / np.sqrt(2.0))))


@pytest.mark.parametrize("x", [1.0, -1.0])
def test_along_x_where_any_alpha_does_it_is_zero(x):
    assert alignment_angles(np.array([x, 0.0, 0.0])) == (0.0, x * np.pi / 2)


def test_the_direction_leads_from_the_short_tool_to_the_long_one():
    found = identify_tool_direction(tool([0.01, 0.0, 0.13]), tool([0.01, 0.03, 0.09]))
    np.testing.assert_allclose(found.direction, [0.0, -0.6, 0.8], atol=1e-14)
    np.testing.assert_allclose(found.rotation[:, 2], found.direction, atol=1e-15)
    np.testing.assert_array_equal(found.covariance, np.zeros((2, 2)))


def test_the_direction_s_error_is_the_tips_over_their_distance():
    found = identify_tool_direction(tool([0.0, 0.0, 0.10], 3e-6), tool([0.0, 0.0, 0.05], 4e-6))
    np.testing.assert_allclose(found.covariance, (5e-6 / 0.05) ** 2 * np.eye(2), rtol=1e-12)


def test_tips_that_cannot_be_told_apart_are_refused():
    with pytest.raises(ConfigError, match=r"tips are 2e-05 m apart, known to .* a direction needs 5 times that"):
        identify_tool_direction(tool([0.0, 0.0, 0.10002], 5e-6), tool([0.0, 0.0, 0.1], 5e-6))
    with pytest.raises(ConfigError, match="0 m apart"):
        identify_tool_direction(tool([0.0, 0.0, 0.1]), tool([0.0, 0.0, 0.1]))


def test_errors_are_as_large_as_the_covariance_says(meca500, touching, deviation):
    tips = np.array([0.012, -0.007, 0.108]), np.array([0.009, -0.004, 0.083])  # long, short
    true = (tips[0] - tips[1]) / np.linalg.norm(tips[0] - tips[1])
    postures = [touching(tip, 6, 0.5) for tip in tips]
    tilts, covariances = [], []
    for repetition in range(40):
        generator = np.random.default_rng([8, repetition])
        found = []
        for exact in postures:
            measured = exact + deviation * generator.standard_normal(exact.shape)
            poses = np.array([meca500.tip_pose(q) for q in measured])
            found.append(identify_tool_centre_point(poses, pose_covariances(meca500, measured, deviation)))
        direction = identify_tool_direction(*found)
        tilts.append(direction.tilt(true))
        covariances.append(direction.covariance)
    assert consistency(np.array(tilts), np.array(covariances), 0.99).holds
