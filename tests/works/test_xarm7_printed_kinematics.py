"""The report's printed formulas against its own chain of transforms, and what their misprints do."""

import math

import numpy as np
import pytest

from runner.robots.three_joint import BRANCHES, MOVING, ThreeJointArm
from runner.works.xarm7.printed_kinematics import (
    L1,
    L2,
    L3,
    L4,
    L5,
    THETA1,
    THETA2,
    Mended,
    chain_tip,
    printed_inverse,
    printed_tip,
    random_postures,
)

LINE = [np.array([x, y, 0.1508]) for x in (0.643, 0.6043) for y in np.linspace(-0.2, 0.2, 9)]


def turn(axis, angle):
    pose = np.eye(4)
    i, j = [(1, 2), (2, 0), (0, 1)]["xyz".index(axis)]
    pose[i, i] = pose[j, j] = math.cos(angle)
    pose[i, j], pose[j, i] = -math.sin(angle), math.sin(angle)
    return pose


def shift(x=0.0, z=0.0):
    pose = np.eye(4)
    pose[:3, 3] = x, 0.0, z
    return pose


def product_of_transforms(q):
    """Return the tip of the printed transforms A_1^0 to A_7^6, multiplied one by one."""
    right = math.pi / 2
    factors = [
        *(turn("z", q[0]), shift(z=L1)),
        *(turn("x", -right), turn("z", q[1])),
        *(turn("x", right), turn("z", q[2]), shift(z=L2)),
        *(turn("x", right), shift(x=L3), turn("z", q[3])),
        *(turn("x", right), shift(x=L4 * math.sin(THETA1)), turn("z", q[4]), shift(z=L4 * math.cos(THETA1))),
        *(turn("x", right), turn("z", q[5])),
        *(turn("x", -right), shift(x=L5 * math.sin(THETA2)), turn("z", q[6]), shift(z=L5 * math.cos(THETA2))),
    ]
    return np.linalg.multi_dot(factors)[:3, 3]


def test_the_printed_entries_are_the_product_of_the_printed_transforms(xarm7):
    for q in random_postures(xarm7.model, 100):
        np.testing.assert_allclose(chain_tip(q), product_of_transforms(q), rtol=0, atol=1e-14)


def test_the_chain_is_the_model_s_to_its_rounding(xarm7):
    for q in random_postures(xarm7.model, 1000):
        assert np.linalg.norm(chain_tip(q) - xarm7.model.tip_position(q)) < 7e-5


def test_the_printed_tip_is_right_only_where_its_angles_happen_to_be(xarm7):
    q = np.array([THETA1, THETA2, 0.3, 1.5, THETA2, 0.75, 0.4])
    np.testing.assert_allclose(printed_tip(q), chain_tip(q), rtol=0, atol=1e-15)
    apart = [np.linalg.norm(printed_tip(q) - chain_tip(q)) for q in random_postures(xarm7.model, 100)]
    assert np.median(apart) > 0.1


@pytest.mark.parametrize("unit", [1.0, 100.0])
def test_the_formulas_put_right_are_the_closed_form(xarm7, unit):
    arm = ThreeJointArm(xarm7.model, 0.75)
    for point in LINE:
        q = printed_inverse(point, 0.75, Mended(root=True, sign=True, unit=unit))
        np.testing.assert_allclose(q, arm.solve(point, BRANCHES[0])[list(MOVING)], rtol=0, atol=1e-4)  # the rounding


def test_the_printed_root_makes_the_unit_count():
    metres, centimetres = (
        printed_inverse(LINE[0], 0.75, Mended(root=False, sign=False, unit=unit)) for unit in (1.0, 100.0)
    )
    assert metres[0] == pytest.approx(centimetres[0], abs=1e-15)
    assert abs(metres[2] - centimetres[2]) > 0.1
