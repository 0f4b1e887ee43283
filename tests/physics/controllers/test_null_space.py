"""Null-space tasks."""

import numpy as np
import pytest
from scipy.optimize import approx_fprime

from runner.controllers.kinematic.resolved_rate import NullSpaceConfig, NullSpaceTask, log_manipulability_gradient
from runner.robots.workspace import manipulability


def random_postures(model, count: int) -> np.ndarray:
    generator = np.random.default_rng(4)
    return generator.uniform(-1.5, 1.5, (count, model.nq))


@pytest.mark.parametrize("rows", [3, 6])
def test_the_gradient_of_manipulability_is_that_of_finite_differences(xarm7, rows):
    for q in random_postures(xarm7.model, 20):
        expected = approx_fprime(q, lambda p: np.log(manipulability(xarm7.model.tip_jacobian(p)[:rows])), 1e-7)
        gradient = log_manipulability_gradient(xarm7.model.tip_jacobian(q), np.eye(rows))
        np.testing.assert_allclose(gradient, expected, rtol=1e-4, atol=1e-5)


@pytest.fixture
def task(xarm7):
    """Make a task on the xArm7 with gain 2."""

    def make(name: str, max_speed: float | None = None) -> NullSpaceTask:
        config = NullSpaceConfig(task=name, gain=2.0, posture=None, max_speed=max_speed)
        return NullSpaceTask(config, xarm7.home, xarm7.model.position_limits)

    return make


def test_the_posture_task_pulls_home(task, xarm7):
    q = xarm7.home + np.linspace(-0.3, 0.3, 7)
    velocity = task("posture").velocity(q, xarm7.model.tip_jacobian(q), np.eye(3))
    np.testing.assert_allclose(velocity, 2.0 * (xarm7.home - q), atol=1e-15)


def test_the_joint_limit_task_leads_to_the_middle_of_the_ranges_and_rests_there(task, xarm7):
    lower, upper = xarm7.model.position_limits
    middle = 0.5 * (lower + upper)
    J = xarm7.model.tip_jacobian(middle)
    np.testing.assert_allclose(task("joint_limits").velocity(middle, J, np.eye(3)), 0.0, atol=1e-15)
    near_stop = task("joint_limits").velocity(upper - 0.01, J, np.eye(3))
    assert (near_stop < 0.0).all()
    assert near_stop[1] == pytest.approx(2.0 * (0.01 - 0.5 * (upper - lower)[1]) / (0.5 * (upper - lower)[1]) ** 2)


def test_unlimited_joints_have_no_middle(macro):
    config = NullSpaceConfig(task="joint_limits", gain=2.0, posture=None, max_speed=None)
    unlimited = np.array([[-np.inf] * 3, [np.inf] * 3])
    task = NullSpaceTask(config, np.zeros(3), unlimited)
    np.testing.assert_array_equal(task.velocity(np.ones(3), macro.tip_jacobian(np.ones(3)), np.eye(3)), np.zeros(3))


def test_a_task_asks_for_no_more_than_its_largest_speed(task, xarm7):
    q = xarm7.home + np.linspace(-0.9, 0.9, 7)
    free = task("posture").velocity(q, xarm7.model.tip_jacobian(q), np.eye(3))
    slow = task("posture", max_speed=0.5).velocity(q, xarm7.model.tip_jacobian(q), np.eye(3))
    assert np.abs(slow).max() == pytest.approx(0.5)
    np.testing.assert_allclose(slow / 0.5, free / np.abs(free).max())


def test_no_task_asks_for_nothing(task, xarm7):
    np.testing.assert_array_equal(task("none").velocity(xarm7.home + 1.0, np.zeros((6, 7)), np.eye(3)), np.zeros(7))
