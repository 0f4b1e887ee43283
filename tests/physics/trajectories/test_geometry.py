"""Directions in configs, and distances to segments and curves."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from runner.trajectories.geometry import check_perpendicular, distance_to_curve, plane_axes

vectors = st.lists(st.floats(-2.0, 2.0), min_size=3, max_size=3)


@given(vectors, vectors)
def test_the_axes_of_a_plane_and_its_normal_are_a_right_handed_frame(normal, other):
    direction = np.cross(normal, other)
    assume(np.linalg.norm(direction) > 1e-3)
    first, second = plane_axes(normal, direction.tolist())
    n = np.array(normal) / np.linalg.norm(normal)
    frame = np.column_stack([first, second, n])
    np.testing.assert_allclose(frame.T @ frame, np.eye(3), atol=1e-12)
    assert np.linalg.det(frame) == pytest.approx(1.0)
    np.testing.assert_allclose(first, direction / np.linalg.norm(direction), atol=1e-12)


def test_rounding_is_taken_out():
    first, _ = plane_axes([0.0, 0.0, 1.0], [1.0, 0.0, 1e-7])
    np.testing.assert_array_equal(first, [1.0, 0.0, 0.0])


def test_a_direction_out_of_the_plane_is_refused_with_its_angle():
    assert check_perpendicular([1.0, 0.0, 1e-7], [0.0, 0.0, 1.0]) == [1.0, 0.0, 1e-7]
    with pytest.raises(ValueError, match=r"must be perpendicular to normal \[0.0, 0.0, 2.0\], which is 60 deg away"):
        check_perpendicular([0.0, np.sqrt(3.0), 1.0], [0.0, 0.0, 2.0])


def parabola(x):
    zeros, ones = np.zeros_like(x), np.ones_like(x)
    return np.stack(
        [
            np.stack([x, x**2, zeros], axis=1),
            np.stack([ones, 2.0 * x, zeros], axis=1),
            np.stack([zeros, 2.0 * ones, zeros], axis=1),
        ],
        axis=1,
    )


SAMPLES = np.linspace(-2.0, 2.0, 41)


def test_above_the_focus_of_a_parabola_both_branches_are_equally_near():
    """From (0, h) with h > 1/2 the nearest points lie at x^2 = h - 1/2, at the distance sqrt(h - 1/4)."""
    h = np.array([0.6, 1.0, 3.0])
    points = np.column_stack([np.zeros(3), h, np.zeros(3)])
    np.testing.assert_allclose(distance_to_curve(points, parabola, SAMPLES), np.sqrt(h - 0.25), rtol=1e-14)


def test_below_it_the_vertex_is_nearest():
    points = np.array([[0.0, 0.5, 0.0], [0.0, 0.2, 0.0], [0.0, -3.0, 4.0]])
    np.testing.assert_allclose(distance_to_curve(points, parabola, SAMPLES), [0.5, 0.2, 5.0], rtol=1e-14)


def test_along_a_normal_the_distance_is_the_way_along_it():
    x = np.random.default_rng(0).uniform(-1.9, 1.9, 5_000)
    foot, tangent = parabola(x)[:, 0], parabola(x)[:, 1]
    normal = np.column_stack([tangent[:, 1], -tangent[:, 0], np.zeros(len(x))])  # outwards, where it meets no other
    normal /= np.linalg.norm(normal, axis=1)[:, None]
    distance = np.logspace(-12, 2, len(x))
    found = distance_to_curve(foot + distance[:, None] * normal, parabola, SAMPLES)
    np.testing.assert_allclose(found, distance, rtol=1e-12, atol=1e-14)


def test_the_distance_beyond_an_end_goes_to_the_end():
    points = np.array([[2.0, 4.0, 0.0], [5.0, 8.0, 0.0], [-2.0, 4.0, 1.0]])
    np.testing.assert_allclose(distance_to_curve(points, parabola, SAMPLES), [0.0, 5.0, 1.0], atol=1e-15)


def test_coarser_samples_find_the_same():
    points = np.random.default_rng(1).normal(size=(300, 3))
    fine = distance_to_curve(points, parabola, np.linspace(-2.0, 2.0, 4_001))
    np.testing.assert_allclose(distance_to_curve(points, parabola, SAMPLES), fine, atol=1e-13)
