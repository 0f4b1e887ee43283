"""Directions of a task: every motion of the tip lies in them, for spatial, planar and sliding arms."""

import numpy as np
import pytest
from support import strangers
from support.strangers import X, Y, Z

from runner.robots.inverse_kinematics import solve_tip_pose, solve_tip_position
from runner.robots.model import RobotModel
from runner.robots.task_space import distance_beside, task_basis


def model(*kinds, **values):
    return RobotModel(strangers.chain("arm", kinds, **values), "tip")


def turns(*axes):
    return [("revolute", axis) for axis in axes]


@pytest.mark.parametrize("pose", [False, True])
def test_a_spatial_arm_has_every_direction(macro, xarm7, pose):
    np.testing.assert_array_equal(task_basis(macro, pose), np.eye(6 if pose else 3))
    np.testing.assert_array_equal(task_basis(xarm7.model, pose), np.eye(6 if pose else 3))


def test_a_planar_arm_moves_in_its_plane_and_turns_about_its_axis():
    arm = model(*turns(X, X, X))
    np.testing.assert_array_equal(task_basis(arm, False), np.eye(3)[1:])
    np.testing.assert_array_equal(task_basis(arm, True), np.eye(6)[[1, 2, 3]])


def test_a_scara_turns_about_the_vertical_alone():
    arm = strangers.config("scara").arm.model
    np.testing.assert_array_equal(task_basis(arm, True), np.eye(6)[[0, 1, 2, 5]])


def test_slides_do_not_turn():
    arm = model(("prismatic", X), ("prismatic", Y), ("prismatic", Z))
    np.testing.assert_array_equal(task_basis(arm, True), np.eye(6)[:3])


def test_an_oblique_plane_has_two_unit_directions_in_it():
    arm = model(*turns("1 1 0", "1 1 0"), tip=(0.0, 0.0, 0.3))
    found = task_basis(arm, False)
    np.testing.assert_allclose(found @ found.T, np.eye(2), atol=1e-12)
    np.testing.assert_allclose(found @ [1.0, 1.0, 0.0], 0.0, atol=1e-12)


def test_every_motion_of_the_tip_lies_in_its_directions():
    for name in strangers.STRANGERS:
        arm = strangers.config(name).arm.model
        D = task_basis(arm, True)
        for q in np.random.default_rng(5).uniform(*arm.usual_range, (5, arm.nq)):
            J = arm.tip_jacobian(q)
            np.testing.assert_allclose(D.T @ D @ J, J, atol=1e-9)


def test_points_beside_the_plane():
    arm = model(*turns(X, X), tip=(0.07, 0.0, 0.25))
    np.testing.assert_allclose(distance_beside(arm, np.array([[0.07, 9.0, -9.0], [0.3, 0.0, 0.0]])), [0.0, 0.23],
                               atol=1e-12)  # fmt: skip


def test_inverse_kinematics_stays_in_the_plane():
    arm = model(*turns(X, X, X))
    home = np.array([0.3, 0.5, -0.4])
    start = np.add(arm.tip_position(home), [0.0, 0.05, -0.03])
    np.testing.assert_allclose(arm.tip_position(solve_tip_position(arm, start, home)), start, atol=1e-9)
    pose = arm.tip_pose(home)
    pose[:3, 3] = start
    np.testing.assert_allclose(arm.tip_pose(solve_tip_pose(arm, pose, home)), pose, atol=1e-9)
