"""Names of the sums that torques determine, and the columns that tell something new."""

import numpy as np
import pinocchio as pin
import pytest
from support.identified_logs import arm_of

from runner.identification.parameters import base_sums, group_columns, sum_name


def test_the_base_parameters_of_the_panda_are_named_as_sums():
    model = arm_of("panda")
    without, with_rotors = base_sums(model, False), base_sums(model, True)
    assert (len(without), len(with_rotors)) == (43, 48)
    names = [each.name for each in without]
    for name in (
        "c2y m2 - 0.316 (m3 + m4 + m5 + m6 + m7) - c3z m3", "c3x m3 + 0.0825 (m4 + m5 + m6 + m7)",
        "c4x m4 - 0.0825 (m5 + m6 + m7)", "c4y m4 + 0.384 (m5 + m6 + m7) + c5z m5", "c5y m5 - c6z m6",
        "c6x m6 + 0.088 m7", "c6y m6 - c7z m7",
    ):  # fmt: skip
        assert name in names


def test_sums_of_a_planar_arm_follow_from_its_lengths():
    model = arm_of("macro")
    full = np.concatenate([model.inertial_parameters, np.array([0.1, 0.2, 0.3])])
    q, dq, ddq = np.array([0.3, -0.4, 0.8]), np.array([0.5, 0.2, -0.7]), np.array([1.0, -2.0, 3.0])
    links = pin.computeJointTorqueRegressor(model.pin_model, model.pin_model.createData(), q, dq, ddq)
    Y = np.hstack([links, np.diag(ddq)])
    sums = base_sums(model, True)
    base = np.array([each.factors @ full for each in sums])
    np.testing.assert_allclose(Y[:, [each.column for each in sums]] @ base, Y @ full, rtol=1e-10)


@pytest.mark.parametrize(
    ("factors", "name"),
    [
        ([1.0, 0.0, 0.0], "a"),
        ([1.0, 1.0, -1.0], "a + b - c"),
        ([1.0, -2.5, -2.5], "a - 2.5 (b + c)"),
        ([1.0, 0.5, -0.5], "a + 0.5 (b - c)"),
    ],
)
def test_a_sum_is_named(factors, name):
    assert sum_name(np.array(factors), ["a", "b", "c"], 0) == name


def test_columns_that_repeat_others_are_grouped_in_the_order_of_preference():
    random = np.random.default_rng(0)
    X = random.normal(size=(50, 3))
    X = np.column_stack([X, X[:, 0] + 2.0 * X[:, 1], np.zeros(50)])
    taken, factors = group_columns(X, [3, 0, 1, 2, 4], 1e-6)
    assert taken == [3, 0, 2]
    np.testing.assert_allclose(factors[:, 1], [0.5, -0.5, 0.0], atol=1e-12)
    assert not factors[:, 4].any()
