"""Functions of control laws on floats, against NumPy and closed forms."""

import numpy as np
import pytest

from runner.symbolic.maths import NUMPY

A = np.array([[4.0, 1.0, 0.5], [1.0, 3.0, 0.2], [0.5, 0.2, 2.0]])
B = np.array([1.0, -2.0, 3.0])


def test_linear_systems_are_solved():
    solution, determinant = NUMPY.solve_three(A, B, "singular")
    np.testing.assert_allclose(A @ solution, B, atol=1e-14)
    assert determinant == pytest.approx(np.linalg.det(A))
    np.testing.assert_allclose(A @ NUMPY.solve_symmetric(A, B, "singular"), B, atol=1e-14)


@pytest.mark.parametrize("order", [[0, 1, 2], [1, 0, 2], [1, 2, 0], [2, 1, 0], [2, 0, 1], [0, 2, 1]])
def test_the_determinant_keeps_its_sign_in_any_order_of_rows(order):
    assert NUMPY.solve_three(A[order], B, None)[1] == pytest.approx(np.linalg.det(A[order]))


def test_a_singular_system_is_an_error_with_the_text_given():
    for solve in (NUMPY.solve_three, NUMPY.solve_symmetric):
        with pytest.raises(np.linalg.LinAlgError, match="nothing moves"):
            solve(np.zeros((3, 3)), B, "nothing moves")


def test_definite_matrices_are_told_from_others():
    assert NUMPY.positive_definite(A)
    assert not NUMPY.positive_definite(np.diag([1.0, -1.0, 2.0]))
    assert NUMPY.smallest_eigenvalue(np.diag([3.0, 0.5, 2.0])) == pytest.approx(0.5)


def test_the_rotation_vector_is_axis_times_angle():
    c, s = np.cos(0.7), np.sin(0.7)
    turn = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    np.testing.assert_allclose(NUMPY.rotation_vector(turn), [0.0, 0.0, 0.7], atol=1e-14)


def test_scalars_and_choices():
    assert NUMPY.floor(-1.5) == -2.0
    assert NUMPY.absolute(-1.5) == NUMPY.maximum(1.5, -2.0) == NUMPY.sqrt(2.25) == 1.5
    assert NUMPY.any_of(NUMPY.less(2.0, 1.0), NUMPY.less(1.0, 2.0))
    assert NUMPY.choose(False, lambda: 1 / 0, lambda: B) is B


def test_functions_of_arrays_act_entry_by_entry():
    a, b = np.array([1.0, 2.0, 3.0]), np.array([1.0, 3.0, 2.0])
    assert NUMPY.less(a, b).tolist() == [False, True, False]
    assert NUMPY.select(NUMPY.equal(a, b), -a, b).tolist() == [-1.0, 3.0, 2.0]
    assert (NUMPY.select(True, 1.0, 2.0), NUMPY.decay(0.0)) == (1.0, (1.0, 0.0))
    first, none = NUMPY.first(np.array([False, True, True]))
    assert (first.tolist(), bool(none)) == ([False, True, False], False)
    assert NUMPY.first(np.array([False, False]))[1]


def test_chosen_rows_are_a_system_of_their_own():
    A, b = np.array([[4.0, 1.0, 2.0], [1.0, 3.0, 0.0], [2.0, 0.0, 5.0]]), np.array([1.0, 2.0, 3.0])
    found = NUMPY.solve_chosen(A, b, np.array([True, False, True]))
    np.testing.assert_allclose([4.0 * found[0] + 2.0 * found[2], found[1], 2.0 * found[0] + 5.0 * found[2]], [1, 0, 3])
    assert not NUMPY.solve_chosen(A, b, np.zeros(3, dtype=bool)).any()
