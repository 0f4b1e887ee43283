"""Tool centre point: estimates and covariance against the true tip, exact and noisy; refused poses."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from support.turns import rotation

from runner.base.errors import ConfigError
from runner.calibration.tool_centre_point import MIN_SINGULAR_VALUE, identify_tool_centre_point
from runner.calibration.uncertainty import consistency, pose_covariances

TIP = np.array([0.012, -0.007, 0.093])
EXACT = np.zeros((6, 6))


def poses_about(tip, rotations, point=(0.2, 0.05, 0.1)):
    poses = np.tile(np.eye(4), (len(rotations), 1, 1))
    poses[:, :3, :3] = rotations
    poses[:, :3, 3] = np.array(point) - poses[:, :3, :3] @ tip
    return poses


def identify(poses):
    return identify_tool_centre_point(poses, np.tile(EXACT, (len(poses), 1, 1)))


vectors = st.lists(st.floats(-2.0, 2.0), min_size=3, max_size=3).map(np.array)
turns = vectors.filter(lambda vector: np.linalg.norm(vector) > 0.05)


@given(vectors, st.lists(turns, min_size=3, max_size=12))
def test_exact_poses_give_the_exact_tip(tip, axes):
    poses = poses_about(tip, [rotation(axis) for axis in axes])
    A = (poses[0, :3, :3] - poses[1:, :3, :3]).reshape(-1, 3)
    assume(np.linalg.svd(A, compute_uv=False)[-1] > MIN_SINGULAR_VALUE * np.sqrt(len(poses)))
    found = identify(poses)
    np.testing.assert_allclose(found.position, tip, rtol=0, atol=1e-12)
    assert found.residual < 1e-12


@pytest.mark.parametrize("count", [4, 9])
def test_exact_postures_of_the_arm_give_the_exact_tip(meca500, touching, count):
    poses = np.array([meca500.tip_pose(q) for q in touching(TIP, count, 0.5)])
    np.testing.assert_allclose(identify(poses).position, TIP, rtol=0, atol=1e-9)


@pytest.mark.parametrize(("count", "tilt"), [(4, 0.17), (4, 0.5), (20, 0.5)])
def test_errors_are_as_large_as_the_covariance_says(meca500, touching, deviation, count, tilt):
    true = touching(TIP, count, tilt)
    errors, covariances = [], []
    for repetition in range(40):
        generator = np.random.default_rng([count, int(100 * tilt), repetition])
        measured = true + deviation * generator.standard_normal(true.shape)
        poses = np.array([meca500.tip_pose(q) for q in measured])
        found = identify_tool_centre_point(poses, pose_covariances(meca500, measured, deviation))
        errors.append(found.position - TIP)
        covariances.append(found.covariance)
    assert consistency(np.array(errors), np.array(covariances), 0.99).holds


def test_the_covariance_holds_the_first_pose_once_for_all_rows():
    # By hand for turns of half a turn about x, y and z: tips' errors e_k of equal size enter as (A'A)^-1 A' B e.
    half_turns = [np.eye(3), np.diag([1.0, -1.0, -1.0]), np.diag([-1.0, 1.0, -1.0]), np.diag([-1.0, -1.0, 1.0])]
    position_only = np.zeros((6, 6))
    position_only[:3, :3] = 1e-10 * np.eye(3)
    found = identify_tool_centre_point(poses_about(TIP, half_turns), np.tile(position_only, (4, 1, 1)))
    # Along x: rows 3 and 4 hold 2 x = b, so that x is wrong by ((e_3 - e_1) + (e_4 - e_1)) / 4: (1 + 1 + 4) / 16.
    np.testing.assert_allclose(found.covariance, 6.0 / 16.0 * 1e-10 * np.eye(3), atol=1e-24)


def test_an_orientation_s_error_acts_at_the_tip_s_distance(meca500):
    turned = np.zeros((6, 6))
    turned[3:, 3:] = 1e-10 * np.eye(3)
    rotations = [rotation(axis) for axis in np.eye(3)] + [np.eye(3)]
    near, far = (
        identify_tool_centre_point(poses_about(scale * TIP, rotations), np.tile(turned, (4, 1, 1))).covariance
        for scale in (1.0, 3.0)
    )
    np.testing.assert_allclose(far, 9.0 * near, rtol=1e-9)


def test_more_poses_and_a_wider_spread_know_the_tip_better(meca500, touching, deviation):
    def uncertainty(count, tilt):
        postures = touching(TIP, count, tilt)
        poses = np.array([meca500.tip_pose(q) for q in postures])
        covariance = identify_tool_centre_point(poses, pose_covariances(meca500, postures, deviation)).covariance
        return np.sqrt(np.trace(covariance))

    narrow, wide, many = uncertainty(4, 0.17), uncertainty(4, 0.6), uncertainty(20, 0.6)
    assert narrow > 2.0 * wide > 2.0 * many


@pytest.mark.parametrize(
    ("rotations", "reason"),
    [
        ([np.eye(3), rotation(np.array([0.5, 0.0, 0.0]))], "2 poses; a tool centre point needs 3 or more"),
        ([rotation(a * np.array([0.0, 0.6, 0.8])) for a in (0.1, 0.5, 1.0, 2.0)], r"parallel axes, \[0.0, 0.6, 0.8\]"),
        ([rotation(1e-3 * axis) for axis in (*np.eye(3), np.ones(3))], r"too much alike: .* more than 0.081 deg"),
        ([np.eye(3)] * 4, "condition number inf"),
    ],
)
def test_poses_that_leave_the_tip_unknown_are_refused_with_the_reason(rotations, reason):
    with pytest.raises(ConfigError, match=reason):
        identify(poses_about(TIP, rotations))


def test_a_refusal_names_the_singular_value_and_what_is_allowed():
    with pytest.raises(ConfigError, match=r"smallest singular value .*condition number .*allowed: 0.01 or more"):
        identify(poses_about(TIP, [rotation(np.array([0.0, 0.0, a])) for a in (0.1, 0.5, 1.0, 2.0)]))
