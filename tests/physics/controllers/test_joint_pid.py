"""PID control of each joint: its equation, what the integral takes away, its stability, and anti-windup."""

import numpy as np
import pytest
from support.arms import checked

from runner.controllers.joint_space.joint_pid import JointPid, JointPidConfig

ARM = checked("robot=xarm7", "controller=joint_pid", "trajectory=goal").arm
LINE = ("robot=macro", "controller=joint_pid", "controller.period=0.001", "plant=rk4")


def law(**changes):
    values = {
        "kind": "joint_pid",
        "task": "position",
        "natural_frequency": 30.0,
        "damping_ratio": 1.0,
        "period": 0.001,
        "gravity_compensation": True,
        "feedforward": True,
        "singularity_damping": 0.3,
        "null_space_frequency": 30.0,
        "integral_share": 0.125,
        "anti_windup": True,
    }
    return JointPid(ARM.model, JointPidConfig(**(values | changes)), ARM.home, joints=True)


def test_torques_are_those_of_the_equation():
    generator, controller, D = np.random.default_rng(5), law(), ARM.model.mass_matrix(ARM.home).diagonal()
    z = np.zeros(7)
    for _ in range(3):
        q, dq = ARM.home + 0.1 * generator.normal(size=7), 0.1 * generator.normal(size=7)
        reference = generator.normal(size=(3, 7)) + np.array([ARM.home, np.zeros(7), np.zeros(7)])
        e, de = reference[0] - q, reference[1] - dq
        expected = D * (900.0 * e + 60.0 * de + 3375.0 * z) + ARM.model.gravity_torque(q)
        np.testing.assert_allclose(controller.torque(0.0, q, dq, reference), expected, rtol=1e-10)
        z = z + 0.001 * e * ((np.abs(expected) < ARM.model.effort_limits) | (expected * e < 0.0))


def test_it_takes_away_the_sag_of_a_wrong_gravity_term(simulated):
    """With 0.8 of the masses in the model, joint PD rests at the closed-form sag; the integral leaves nothing of it."""
    motion = ("trajectory=joint_quintic", "mismatch.mass=0.8", "duration=9")
    config = checked(*LINE, *motion)
    goal = config.path.sample_joints(np.array([9.0]))[0, 0]
    resting = simulated(*LINE, *motion, "controller=joint_pd")
    w, model = config.controller.natural_frequency, config.arm.model
    sag = 0.2 * model.gravity_torque(resting.q[-1]) / (w**2 * 0.8 * model.mass_matrix(config.arm.home).diagonal())
    np.testing.assert_allclose(goal - resting.q[-1], sag, rtol=1e-3, atol=1e-9)
    np.testing.assert_allclose(goal - simulated(*LINE, *motion).q[-1], 0.0, atol=1e-9)


@pytest.mark.parametrize("xi", [0.7, 1.0])
def test_a_joint_is_stable_up_to_the_limit_of_hurwitz(xi):
    """The linear map of a joint that no other moves, at a period that is short against omega_n."""
    w, h = 30.0, 1e-5

    def radius(share):
        k_p, k_v, k_i = w**2, 2.0 * xi * w, share * w**3
        gain = np.array([-k_p, -k_v, k_i])
        held = np.array([[1.0, h, 0.0], [0.0, 1.0, 0.0], [-h, 0.0, 1.0]])
        return np.abs(np.linalg.eigvals(held + np.outer([0.5 * h**2, h, 0.0], gain))).max()

    assert radius(0.99 * 2.0 * xi) < 1.0 < radius(1.01 * 2.0 * xi)


def overshoot(trace, goal):
    return (np.sign(goal - trace.q[0]) * (trace.q - goal)).max()


def test_anti_windup_keeps_a_saturated_step_from_overshooting(simulated):
    step = ("trajectory=joint_quintic", "trajectory.goal_configuration=1.2", "trajectory.duration=0.05", "duration=8",
            "controller.natural_frequency=10", "torque_limits.max=[20,60,20]")  # fmt: skip
    goal = checked(*LINE, *step).path.sample_joints(np.array([8.0]))[0, 0]
    held, wound = (simulated(*LINE, *step, f"controller.anti_windup={on}") for on in ("true", "false"))
    assert np.abs(wound.tau[:100]).max(axis=0) == pytest.approx([20.0, 60.0, 20.0])  # it is at its limits
    assert overshoot(held, goal) < 0.3 * overshoot(wound, goal)
    np.testing.assert_allclose(held.q[-1], goal, atol=1e-6)


def test_anti_windup_changes_nothing_within_the_limits(simulated):
    motion = ("trajectory=joint_quintic", "duration=1", "torque_limits.max=null")
    held, wound = (simulated(*LINE, *motion, f"controller.anti_windup={on}") for on in ("true", "false"))
    np.testing.assert_array_equal(held.q, wound.q)
