"""Functions of arrays with the same bits on every processor: equal to NumPy's where these have one order."""

import numpy as np
import pytest

from runner.base import portable


@pytest.mark.parametrize("shape", [(3,), (7, 3), (4, 5, 3)])
def test_products_are_those_of_the_definition(shape):
    a, b = np.random.default_rng(0).normal(size=(2, *shape))
    np.testing.assert_array_equal(portable.cross(a, b), np.cross(a, b))
    np.testing.assert_allclose(portable.dot(a, b), np.einsum("...i,...i->...", a, b), rtol=1e-15, atol=1e-15)
    np.testing.assert_array_equal(portable.dot(portable.cross(a, a), b), np.zeros(shape[:-1]))


@pytest.mark.parametrize("n", [1, 3, 7])
def test_a_singular_system_is_refused_and_another_solved(n):
    J = np.random.default_rng(n).normal(size=(n, n + 2))
    A, b = J @ J.T, np.arange(1.0, n + 1)
    np.testing.assert_allclose(A @ portable.solve_symmetric(A, b), b, rtol=1e-9)
    with pytest.raises(np.linalg.LinAlgError, match="no way"):
        portable.solve_symmetric(np.zeros((n, n)), b, "no way")
