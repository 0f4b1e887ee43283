"""Frame of a plane from its normal and one direction."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from runner.trajectories.vectors import check_perpendicular, plane_axes

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
