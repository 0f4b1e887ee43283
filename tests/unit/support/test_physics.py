"""Named assertions of physics: each passes what it states and fails just beyond its tolerance."""

from dataclasses import replace

import numpy as np
import pytest
from support.physics import (
    assert_agree,
    assert_energy_kept,
    assert_linear_design,
    assert_order,
    assert_passive,
    assert_same_motion,
    critically_damped,
    linear_design,
)


def fails(assertion, *given, **more):
    with pytest.raises(AssertionError):
        assertion(*given, **more)
    return True


def test_agreement_is_a_share_of_the_largest_entry():
    expected = np.array([1.0, -200.0])
    assert_agree(np.add(expected, [1.9, 0.0]), expected, 0.01)
    assert fails(assert_agree, np.add(expected, [2.1, 0.0]), expected, 0.01)
    assert_agree(np.add(expected, [2.1, 0.0]), expected, 0.01, of=[300.0])
    assert fails(assert_agree, np.add(expected, [3.1, 0.0]), expected, 0.01, of=[300.0])


@pytest.mark.parametrize("order", [1, 2, 4])
def test_an_order_is_that_of_halved_steps(order):
    errors = [3.0 * h**order for h in (0.2, 0.1, 0.05)]
    assert_order(errors, order, within=0.01)
    assert fails(assert_order, errors, order + 1, within=0.99)
    assert fails(assert_order, [errors[0], errors[1], 1.1 * errors[2]], order, within=0.1)


def test_energy_is_kept_or_falls():
    assert_energy_kept([2.0, 2.0019, 1.9981], 1e-3)
    assert fails(assert_energy_kept, [2.0, 2.0021], 1e-3)
    assert_passive([2.0, 1.0, 1.0 + 1e-9, 0.5], rounding=2e-9)
    assert fails(assert_passive, [2.0, 1.0, 1.1, 0.5], rounding=2e-9)
    assert fails(assert_passive, [2.0, 2.0, 2.0], rounding=0.0)  # loses nothing


def test_the_linear_design_damps_critically():
    omega, t, h = 5.0, np.linspace(0.0, 1.0, 11), 1e-4
    x, before, after = (critically_damped(t + shift, omega) for shift in (0.0, -h, h))
    velocity, acceleration = (after - before) / (2.0 * h), (after - 2.0 * x + before) / h**2
    goal = np.zeros((3, 11))
    np.testing.assert_allclose(linear_design(goal, x, velocity, omega, 1.0), acceleration, atol=1e-5)
    assert_linear_design(acceleration, goal, x, velocity, omega, 1.0, share=1e-5)
    assert fails(assert_linear_design, acceleration, goal, x, velocity, omega, 1.01, share=1e-5)
    moving = np.ones((3, 11))
    np.testing.assert_allclose(linear_design(moving, x, velocity, 0.0, 1.0), 1.0)


def test_the_same_motion_has_the_same_joints_and_torques(hand_made_trace):
    trace = hand_made_trace([0.0, 0.1, 0.2], q=1.0, tau=5.0)
    assert_same_motion(trace, replace(trace, q=trace.q + 0.9e-11))
    assert fails(assert_same_motion, trace, replace(trace, q=trace.q + 1.1e-11))
    assert fails(assert_same_motion, trace, replace(trace, tau=trace.tau * (1.0 + 1.1e-9)))
    assert fails(assert_same_motion, trace, replace(trace, end_points=trace.end_points + 1.1e-11))
    assert fails(assert_same_motion, trace, replace(trace, desired=trace.desired + 1e-15))
