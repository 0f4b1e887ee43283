"""Closed-form inverse kinematics of the xArm7's joints 1, 2 and 4."""

import numpy as np
import pytest

from runner.base.errors import ConfigError
from runner.papers.studies.xarm7.parts.three_joint_kinematics import BRANCHES, Branch, ThreeJointArm

WRIST = 0.75
LINE = [np.array([x, y, 0.1508]) for x in (0.643, 0.6043) for y in np.linspace(-0.2, 0.2, 41)]


@pytest.fixture(scope="module")
def arm(xarm7):
    return ThreeJointArm(xarm7.model, WRIST)


def test_its_forward_kinematics_is_the_models(arm, xarm7):
    for q1, q2, q4 in np.random.default_rng(0).uniform(-3.0, 3.0, (200, 3)):
        np.testing.assert_allclose(arm.tip(q1, q2, q4), xarm7.model.tip_position(arm.posture(q1, q2, q4)), atol=1e-14)


@pytest.mark.parametrize("branch", BRANCHES)
def test_every_branch_inverts_forward_kinematics_along_the_line(arm, xarm7, branch):
    for point in LINE:
        q = arm.solve(point, branch)
        assert np.abs(xarm7.model.tip_position(q) - point).max() < 1e-12
        assert (q[[2, 4, 6]] == 0.0).all()
        assert q[5] == WRIST


def test_the_four_branches_are_different_postures(arm):
    for point in LINE:
        postures = [arm.solve(point, branch) for branch in BRANCHES]
        for i, first in enumerate(postures):
            for second in postures[:i]:
                assert np.abs(first - second).max() > 0.1


def test_every_posture_is_found_again_by_one_branch(arm):
    for q1, q2, q4 in np.random.default_rng(1).uniform(-3.0, 3.0, (200, 3)):
        found = [arm.solve(arm.tip(q1, q2, q4), branch)[[0, 1, 3]] for branch in BRANCHES]
        turns = [np.abs(np.remainder(q - [q1, q2, q4] + np.pi, 2 * np.pi) - np.pi).max() for q in found]
        assert min(turns) < 1e-6  # a double root, at full stretch, has the square root of the rounding


def test_only_one_branch_lies_inside_the_joint_limits(arm, xarm7):
    for point in LINE:
        inside = [b for b in BRANCHES if xarm7.model.limit_margins(arm.solve(point, b)).min() >= 0.0]
        assert inside == [Branch(1, 1)]


def test_the_round_posture_lies_on_the_line_through_x_0_6043(arm, xarm7):
    x, _, z = arm.tip(0.0, 0.75, 1.5)
    assert (round(float(x), 4), round(float(z), 4)) == (0.6043, 0.1508)


@pytest.mark.parametrize(("point", "text"), [([1.0, 0.0, 0.1508], "too far"), ([0.0, 0.0, 0.267], "too near")])
def test_a_point_out_of_reach_says_how_far_out(arm, point, text):
    with pytest.raises(np.linalg.LinAlgError, match=rf"from the shoulder, 0\.\d+ m {text}"):
        arm.solve(np.array(point), Branch(1, 1))


def test_another_chain_is_refused(macro):
    with pytest.raises(ConfigError, match="three_joint solves the xArm7's chain"):
        ThreeJointArm(macro, WRIST)
