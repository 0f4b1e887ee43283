"""Joint velocities for a tip velocity."""

import numpy as np
import pytest
from scipy.optimize import minimize

from runner.controllers.kinematic.resolved_rate import ResolvedRate

FREE = np.full(7, np.inf)


@pytest.fixture
def jacobian(xarm7):
    return xarm7.model.tip_jacobian(np.array([0.1, 0.75, 0.2, 1.5, -0.3, 0.75, 0.4]))


@pytest.mark.parametrize("rows", [3, 6])
def test_undamped_it_is_the_pseudo_inverse(jacobian, rows):
    J, v = jacobian[:rows], np.arange(1.0, rows + 1) / 10.0
    dq = ResolvedRate(np.ones(7), 0.0).solve(J, v, np.zeros(7), -FREE, FREE)
    np.testing.assert_allclose(dq, np.linalg.pinv(J) @ v, atol=1e-12)


@pytest.mark.parametrize("rows", [3, 6])
def test_the_null_space_motion_does_not_move_the_tip(jacobian, rows):
    J, dq0 = jacobian[:rows], np.linspace(-1.0, 1.0, 7)
    dq = ResolvedRate(np.ones(7), 0.0).solve(J, np.zeros(rows), dq0, -FREE, FREE)
    np.testing.assert_allclose(J @ dq, 0.0, atol=1e-12)
    np.testing.assert_allclose(dq, (np.eye(7) - np.linalg.pinv(J) @ J) @ dq0, atol=1e-12)


def test_weights_make_the_cheapest_motion(jacobian):
    J, v, weights = jacobian[:3], np.array([0.1, -0.2, 0.05]), np.array([1.0, 5.0, 2.0, 9.0, 1.0, 3.0, 1.0])
    dq = ResolvedRate(weights, 0.0).solve(J, v, np.zeros(7), -FREE, FREE)
    best = minimize(
        lambda x: x @ (weights * x),
        np.zeros(7),
        jac=lambda x: 2.0 * weights * x,
        constraints={"type": "eq", "fun": lambda x: J @ x - v, "jac": lambda x: J},
        options={"ftol": 1e-15},
    )
    np.testing.assert_allclose(dq, best.x, atol=1e-7)


def test_a_singular_posture_has_an_answer_with_damping_and_none_without(macro):
    J, v = macro.tip_jacobian(np.array([0.0, 0.0, np.pi / 2]))[:3], np.array([0.0, 0.1, 0.0])
    bounds = np.full(3, np.inf)
    damped = ResolvedRate(np.ones(3), 0.05).solve(J, v, np.zeros(3), -bounds, bounds)
    assert np.abs(damped).max() <= np.linalg.norm(v) / (2.0 * 0.05)  # of v / (s + lambda^2 / s), at s = lambda
    with pytest.raises(np.linalg.LinAlgError):
        ResolvedRate(np.ones(3), 0.0).solve(np.vstack([J[:2], J[1]]), v, np.zeros(3), -bounds, bounds)


def test_damping_has_no_influence_away_from_singular_postures(jacobian):
    J, v = jacobian[:3], np.array([0.1, -0.2, 0.05])
    smallest = np.linalg.svd(J, compute_uv=False)[-1]
    plain = ResolvedRate(np.ones(7), 0.0).solve(J, v, np.zeros(7), -FREE, FREE)
    damped = ResolvedRate(np.ones(7), 0.99 * smallest).solve(J, v, np.zeros(7), -FREE, FREE)
    np.testing.assert_array_equal(damped, plain)


def test_a_bound_is_kept_and_the_other_joints_do_its_work(jacobian):
    J, v = jacobian[:3], np.array([0.1, -0.2, 0.05])
    plain = ResolvedRate(np.ones(7), 0.0).solve(J, v, np.zeros(7), -FREE, FREE)
    most = int(np.argmax(np.abs(plain)))
    bound = FREE.copy()
    bound[most] = 0.3 * abs(plain[most])
    dq = ResolvedRate(np.ones(7), 0.0).solve(J, v, np.zeros(7), -bound, bound)
    assert abs(dq[most]) <= bound[most]
    np.testing.assert_allclose(J @ dq, v, atol=1e-12)


def test_what_no_joint_may_do_is_left_undone_within_the_bounds(jacobian):
    J, v = jacobian[:3], np.array([10.0, 0.0, 0.0])
    bound = np.full(7, 0.1)
    dq = ResolvedRate(np.ones(7), 0.0).solve(J, v, np.zeros(7), -bound, bound)
    assert np.abs(dq).max() <= 0.1
    assert (J @ dq)[0] > 0.0
