"""The report's printed formulas against its own chain of transforms, and what their misprints do."""

import numpy as np
import pytest

from runner.papers.studies.xarm7.equations.derivations.xarm7 import THETA1, THETA2, pose
from runner.papers.studies.xarm7.equations.derivations.xarm7_inverse import printed_inverse, printed_tip
from runner.papers.studies.xarm7.kinematics import random_postures
from runner.papers.studies.xarm7.parts.three_joint_kinematics import BRANCHES, MOVING, ThreeJointArm

LINE = np.array([[x, y, 0.1508] for x in (0.643, 0.6043) for y in np.linspace(-0.2, 0.2, 9)])


def test_the_printed_tip_put_right_is_the_product_of_the_printed_transforms(xarm7):
    q = random_postures(xarm7.model, 100)
    np.testing.assert_allclose(printed_tip(q, right=True), pose(q)[:, :3, 3] / 100.0, rtol=0, atol=1e-14)


def test_the_chain_is_the_model_s_to_its_rounding(xarm7):
    q = random_postures(xarm7.model, 1000)
    assert np.linalg.norm(printed_tip(q, right=True) - xarm7.model.tip_positions(q), axis=1).max() < 7e-5


def test_the_printed_tip_is_right_only_where_its_angles_happen_to_be(xarm7):
    lucky = np.array([[THETA1, THETA2, 0.3, 1.5, THETA2, 0.75, 0.4]])
    np.testing.assert_allclose(printed_tip(lucky, right=False), printed_tip(lucky, right=True), rtol=0, atol=1e-15)
    q = random_postures(xarm7.model, 100)
    assert np.median(np.linalg.norm(printed_tip(q, right=False) - printed_tip(q, right=True), axis=1)) > 0.1


@pytest.mark.parametrize("unit", [1.0, 100.0])
def test_the_formulas_put_right_are_the_closed_form(xarm7, unit):
    arm = ThreeJointArm(xarm7.model, 0.75)
    exact = [arm.solve(point, BRANCHES[0])[list(MOVING)] for point in LINE]
    q = printed_inverse(LINE, 0.75, right=("q2", "q4"), unit=unit)
    np.testing.assert_allclose(q, exact, rtol=0, atol=1e-4)  # the rounding of the lengths


def test_the_printed_root_makes_the_unit_count():
    metres, centimetres = (printed_inverse(LINE, 0.75, unit=unit) for unit in (1.0, 100.0))
    np.testing.assert_allclose(metres[:, 0], centimetres[:, 0], rtol=0, atol=1e-15)
    assert np.abs(metres[:, 2] - centimetres[:, 2]).min() > 0.1
