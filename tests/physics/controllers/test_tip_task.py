"""Task of the tip: rows of position and pose against the Jacobian and differences; refusals."""

import numpy as np
import pinocchio as pin
import pytest
from support import strangers
from support.arms import checked, tip_numbers
from support.strangers import X, Y, Z

from runner.base.errors import ConfigError
from runner.controllers.operational_space.tip_task import TipTask, held_orientation, task_start
from runner.controllers.torque_law import PinocchioArm
from runner.robots.model import RobotModel
from runner.symbolic.maths import NUMPY

ROBOT = checked("robot=xarm7", "controller=operational_space").arm
XARM7, HOME = ROBOT.model, ROBOT.home


def task(orientation=None, feedforward=True, max_speed=None, singularity_damping=0.3):
    return TipTask(XARM7, orientation, tip_numbers(20.0, 0.7, True, feedforward, singularity_damping), max_speed)


def jacobian(ours, q, dq, model=XARM7):
    return ours.jacobian(ours.parameters, PinocchioArm(model).tip(q, dq))


def error(ours, q, reference, model=XARM7):
    return ours.error(NUMPY, ours.parameters, PinocchioArm(model).tip(q, np.zeros_like(q)), reference)


def acceleration(ours, *arguments):
    return ours.acceleration(NUMPY, ours.parameters, *arguments)


def added(ours, J, error, mobility):
    return np.diagonal(ours.damp(NUMPY, ours.parameters, J, error, mobility) - mobility)


@pytest.mark.parametrize("rows", [3, 6])
def test_the_jacobian_and_its_rate_are_those_of_differences(rows):
    ours, generator, h = task(None if rows == 3 else np.eye(3)), np.random.default_rng(2), 1e-6
    assert ours.rows == rows
    for _ in range(20):
        q, dq = generator.uniform(-2.0, 2.0, (2, 7))
        J, dJ_dq = jacobian(ours, q, dq)
        before, after = (XARM7.tip_pose(q + sign * h * dq) for sign in (-1.0, 1.0))
        velocity = np.concatenate([after[:3, 3] - before[:3, 3], pin.log3(after[:3, :3] @ before[:3, :3].T)])[:rows]
        np.testing.assert_allclose(J @ dq, velocity / (2.0 * h), atol=1e-8)
        rate = (XARM7.tip_jacobian(q + h * dq) - XARM7.tip_jacobian(q - h * dq))[:rows] @ dq / (2.0 * h)
        np.testing.assert_allclose(dJ_dq, rate, atol=1e-7)


def test_a_turn_about_an_axis_is_its_angle_along_it():
    generator = np.random.default_rng(3)
    for _ in range(20):
        q, axis = generator.uniform(-2.0, 2.0, 7), generator.normal(size=3)
        axis, angle = axis / np.linalg.norm(axis), generator.uniform(0.01, 3.1)
        pose = XARM7.tip_pose(q)
        ours = task(pin.exp3(angle * axis) @ pose[:3, :3])
        reference = np.array([pose[:3, 3] + [0.1, 0.2, 0.3], np.ones(3), np.ones(3)])
        np.testing.assert_allclose(error(ours, q, reference), [0.1, 0.2, 0.3, *(angle * axis)], atol=1e-9)


def test_a_pose_asks_for_the_position_what_the_position_asks():
    error, velocity, reference = np.arange(1.0, 7.0), np.arange(6.0, 0.0, -1.0), np.arange(9.0).reshape(3, 3)
    pose, position = task(np.eye(3)), task()
    asked = acceleration(pose, error, velocity, reference)
    np.testing.assert_array_equal(asked[:3], acceleration(position, error[:3], velocity[:3], reference))
    np.testing.assert_allclose(asked[3:], 400.0 * error[3:] - 28.0 * velocity[3:])  # the orientation rests


def test_the_largest_speed_bounds_the_way_and_not_the_turn():
    error = np.array([3.0, 0.0, 4.0, 1.0, 2.0, 3.0])
    asked = acceleration(task(np.eye(3), max_speed=0.5), error, np.zeros(6), np.zeros((3, 3)))
    np.testing.assert_allclose(asked[:3], 28.0 * 0.5 * np.array([0.6, 0.0, 0.8]))
    np.testing.assert_allclose(asked[3:], 400.0 * error[3:])


def test_damping_is_a_share_of_the_error_in_lengths():
    J = np.zeros((6, 7))
    J[:, :6] = np.diag([1.0, 1.0, 1.0, 1.0, 1.0, 0.0])  # the last turn is lost
    error, reach = np.array([0.01, 0.0, 0.0, 0.0, 0.02, 0.0]), XARM7.reach
    amount = 0.3**2 * (0.01**2 + (0.02 * reach) ** 2)
    expected = amount / np.array([1.0, 1.0, 1.0, reach**2, reach**2, reach**2])
    ours = task(np.eye(3))
    np.testing.assert_allclose(added(ours, J, error, J @ J.T), expected)
    np.testing.assert_allclose(added(ours, J, 2.0 * error, 5.0 * J @ J.T), 20.0 * expected)
    assert not added(ours, J, 0.0 * error, J @ J.T).any()
    J[5, 5] = 1.0
    assert not added(ours, J, error, J @ J.T).any()
    assert not added(task(np.eye(3), singularity_damping=0.0), 0.0 * J, error, 0.0 * J @ J.T).any()


def test_a_pose_starts_with_home_s_orientation():
    start = np.array([0.643, -0.2, 0.1508])
    assert task_start("position", ROBOT, start) is None
    pose = XARM7.tip_pose(task_start("pose", ROBOT, start))
    np.testing.assert_allclose(pose[:3, 3], start, atol=1e-9)
    np.testing.assert_allclose(pose[:3, :3], XARM7.tip_pose(HOME)[:3, :3], atol=1e-9)
    np.testing.assert_array_equal(held_orientation("pose", XARM7, HOME), XARM7.tip_pose(HOME)[:3, :3])
    assert held_orientation("position", XARM7, HOME) is None


def chain(axes):
    return RobotModel(strangers.chain("arm", [("revolute", axis) for axis in axes]), "tip")


@pytest.mark.parametrize(
    ("name", "axes", "problem"),
    [
        ("pose", (X, Y, Z), "pose has 6 dimensions, and the arm 3 joints (q1, q2, q3); take controller.task=position"),
        ("pose", (X, Y), "pose has 6 dimensions, and the arm 2 joints (q1, q2); it needs 3 joints or more"),
        ("position", (X, Y), "position has 3 dimensions, and the arm 2 joints (q1, q2); it needs 3 joints or more"),
        ("pose", (X, X), "pose has 3 dimensions, and the arm 2 joints (q1, q2); take controller.task=position"),
    ],
)
def test_a_task_of_more_dimensions_than_joints_is_refused(name, axes, problem):
    with pytest.raises(ConfigError) as caught:
        held_orientation(name, chain(axes), np.zeros(len(axes)))
    assert caught.value.problems == (f"controller.task: {problem}",)


def test_a_planar_arm_of_two_joints_has_a_task_of_two_dimensions():
    model = chain((X, X))
    assert held_orientation("position", model, np.zeros(2)) is None
    task = TipTask(model, None, tip_numbers(10.0, 1.0, True, True, 0.0))
    q, dq = np.array([0.4, 0.7]), np.array([1.0, -2.0])
    J, dJ_dq = jacobian(task, q, dq, model)
    np.testing.assert_allclose(J, model.tip_jacobian(q)[1:3], atol=1e-15)  # y and z: the arm turns about x
    np.testing.assert_allclose(dJ_dq, model.tip_bias_acceleration(q, dq)[1:], atol=1e-13)
    reference = np.array([np.add(model.tip_position(q), [0.3, 0.1, -0.2]), [9.0, 1.0, 2.0], [9.0, 3.0, 4.0]])
    np.testing.assert_allclose(error(task, q, reference, model), [0.1, -0.2], atol=1e-15)
    asked = acceleration(task, error(task, q, reference, model), np.zeros(2), reference)
    np.testing.assert_allclose(asked, [100.0 * 0.1 + 20.0 * 1.0 + 3.0, 100.0 * -0.2 + 20.0 * 2.0 + 4.0], atol=1e-12)
