"""Scalars that stand for numbers: what folds away, and what they refuse."""

import numpy as np
import pytest

from runner.symbolic.expression import Expression, in_order, place, select


def test_zeros_and_ones_leave_nothing_behind():
    x = place("given", 0)
    assert 0.0 * x == x * 0.0 == 0.0 / x == 0.0
    for same in (x + 0.0, 0.0 + x, x - 0.0, x * 1.0, 1.0 * x, x / 1.0, select(place("given", 1), x, x)):
        assert same is x
    assert (x * -1.0).operation == (0.0 - x).operation == "fneg"


def test_arrays_of_objects_go_through_numpy():
    x = np.array([place("given", index) for index in range(3)], dtype=object)
    A = np.array([[1.0, 0.0, 0.0], [0.0, 0.0, -1.0], [0.0, 2.0, 0.0]])
    found = A.dot(x)
    assert found[0] is x[0]
    assert (found[1].operation, found[2].operation) == ("fneg", "fmul")
    assert (x[0] * np.eye(3))[0, 0] is x[0]
    assert isinstance(np.float64(2.0) * x[0], Expression)
    assert len(list(in_order([x.dot(x)]))) == 8


@pytest.mark.parametrize("branch", [bool, lambda x: x < 1.0, lambda x: x >= 1.0, lambda x: max(x, 1.0), lambda x: x**3])
def test_branches_on_values_and_other_powers_are_refused(branch):
    with pytest.raises(TypeError, match=r"backend\.|only squares"):
        branch(place("given", 0))
