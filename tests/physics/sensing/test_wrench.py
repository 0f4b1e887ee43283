"""Wrenches in other frames: power, composition and inverse against rigid-body algebra."""

from fractions import Fraction

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from runner.sensing.wrench import cross, cross_matrix, wrench_transform

vectors = st.lists(st.floats(-2.0, 2.0), min_size=3, max_size=3).map(np.array)
wrenches = st.lists(st.floats(-10.0, 10.0), min_size=6, max_size=6).map(np.array)


def make_pose(turn, origin):
    pose = np.eye(4)
    pose[:3, :3] = Rotation.from_rotvec(turn).as_matrix()
    pose[:3, 3] = origin
    return pose


poses = st.builds(make_pose, vectors, vectors)


@given(vectors, vectors)
def test_the_cross_matrix_is_the_cross_product(v, w):
    np.testing.assert_allclose(cross_matrix(v) @ w, np.cross(v, w), rtol=0, atol=1e-14)


@given(poses, poses)
def test_one_change_after_another_is_the_change_of_the_product(first, second):
    np.testing.assert_allclose(
        wrench_transform(second @ first), wrench_transform(second) @ wrench_transform(first), atol=1e-13
    )


@given(poses)
def test_the_way_back_is_the_inverse_and_no_way_changes_nothing(pose):
    back = wrench_transform(np.linalg.inv(pose))
    np.testing.assert_allclose(back @ wrench_transform(pose), np.eye(6), atol=1e-13)
    np.testing.assert_array_equal(wrench_transform(np.eye(4)), np.eye(6))


@given(poses, wrenches, vectors, vectors)
def test_the_power_is_the_same_in_both_frames(pose, wrench, velocity, omega):
    # Of a body that carries both frames; the velocity of S2's origin is that of a body-fixed point.
    R, p = pose[:3, :3], pose[:3, 3]
    at_second_origin = velocity + np.cross(omega, -R.T @ p)
    power = wrench[:3] @ velocity + wrench[3:] @ omega
    seen = wrench_transform(pose) @ wrench
    assert seen[:3] @ (R @ at_second_origin) + seen[3:] @ (R @ omega) == pytest.approx(power, abs=1e-11)


@given(vectors, vectors, poses)
def test_a_force_is_seen_with_the_moment_of_its_lever(point, force, pose):
    # A force at a point: its moment is lever times force in each frame, whichever way the frames lie.
    wrench = np.concatenate([force, np.cross(point, force)])
    turned, moved = pose[:3, :3] @ force, pose[:3, :3] @ point + pose[:3, 3]
    np.testing.assert_allclose(
        wrench_transform(pose) @ wrench, np.concatenate([turned, np.cross(moved, turned)]), atol=1e-13
    )


def test_the_cross_product_is_numpy_s_of_any_scalars():
    for a, b in np.random.default_rng(5).normal(size=(20, 2, 3)):
        np.testing.assert_array_equal(cross(a, b), np.cross(a, b))
        exact = [np.array([Fraction(x) for x in vector], dtype=object) for vector in (a, b)]
        np.testing.assert_allclose(cross(*exact).astype(float), np.cross(a, b), atol=1e-15)
