"""Closed-loop differential inverse kinematics, on every arm of the zoo and along the xArm7 report's line."""

import numpy as np
import pytest

ARMS = ("macro", "mini", "xarm7", "meca500")
DIK = "controller=differential_inverse_kinematics"


@pytest.mark.parametrize("arm", ARMS)
def test_it_follows_a_slow_quintic_with_any_arm(simulated, checked_config, arm):
    config = checked_config(f"robot={arm}", DIK, "trajectory=circle")
    trace = simulated(f"robot={arm}", DIK, "trajectory=circle")
    assert trace.failure is None
    assert np.abs(trace.error).max() < 1e-4 * config.arm.model.reach


@pytest.mark.parametrize("arm", ["xarm7", "meca500"])
def test_a_pose_task_keeps_the_orientation_of_home(simulated, checked_config, arm):
    overrides = (f"robot={arm}", DIK, "trajectory=circle", "controller.task=pose")
    arm_of_config, trace = checked_config(*overrides).arm, simulated(*overrides)
    home = arm_of_config.model.tip_pose(arm_of_config.home)[:3, :3]
    for q in trace.q[::20]:
        np.testing.assert_allclose(arm_of_config.model.tip_pose(q)[:3, :3], home, atol=1e-5)
    assert np.abs(trace.error).max() < 1e-5


def test_with_feedforward_it_tracks_the_line_to_10_um_within_every_joint_limit(simulated, xarm7):
    trace = simulated("robot=xarm7")
    assert np.abs(trace.error).max() < 1e-5
    assert xarm7.model.limit_margins(trace.q).min() > 0.0
    assert (np.abs(trace.dq) < xarm7.model.velocity_limits).all()


def test_without_feedforward_and_the_highest_gain_it_is_one_sample_late_but_on_the_line(simulated):
    rule = ("controller.integration=euler", "controller.feedforward=false", "controller.gain=100")
    trace = simulated("robot=xarm7", *rule)
    late = np.abs(trace.desired[:-1, 0] - trace.tip[1:]).max()
    assert late < 1e-5
    assert np.linalg.norm(trace.tip[:, [0, 2]] - [0.643, 0.1508], axis=1).max() < 1e-4


@pytest.mark.parametrize(("rule", "order"), [("euler", 2), ("midpoint", 3), ("rk4", 5)])
def test_the_drift_of_a_step_falls_with_the_order_of_its_rule(simulated, rule, order):
    def drift(period: float) -> float:
        rule_and_period = (f"controller.integration={rule}", f"controller.period={period}")
        still = simulated("robot=xarm7", "controller.gain=0", "robot.settling_band=1", *rule_and_period)
        return float(np.abs(still.error[-1]).max())

    assert drift(0.02) / drift(0.01) > 2 ** (order - 1) * 0.9


def test_null_space_motion_at_1_rad_per_s_leaves_the_tip_where_it_is(simulated):
    trace = simulated(
        "robot=xarm7",
        "trajectory=goal",
        "trajectory.start=[0.6,0,0.15]",
        "trajectory.goal=[0.6,0,0.15]",
        "controller.integration=rk4",
        "controller.null_space.posture=[0.8,0.75,-0.8,1.5,0.5,0.75,1.0]",
        "controller.null_space.gain=20",
        "controller.null_space.max_speed=1",
        "duration=2",
    )
    start = trace.tip[0]
    assert 0.5 < np.abs(trace.dq).max() <= 1.0 + 1e-6
    assert np.abs(trace.tip - start).max() < 1e-6


@pytest.mark.parametrize("task", ["joint_limits", "manipulability"])
def test_null_space_tasks_improve_what_they_are_after(simulated, xarm7, task):
    def run(gain: float):
        return simulated("robot=xarm7", f"controller.null_space.task={task}", f"controller.null_space.gain={gain}")

    def value(q):
        lower, upper = xarm7.model.position_limits
        if task == "joint_limits":
            return -((2.0 * q - lower - upper) ** 2 / (upper - lower) ** 2).sum()
        J = xarm7.model.tip_jacobian(q)[:3]
        return np.linalg.det(J @ J.T)

    sought, left = run(2.0), run(0.0)
    assert value(sought.q[-1]) > value(left.q[-1])
    assert np.abs(sought.error).max() < 1e-5


def test_a_measured_sag_of_the_servo_is_fed_back(simulated):
    sagging = (
        "robot=xarm7",
        "plant=default",
        "plant.servo.gravity_compensation=false",
        "trajectory.duration=2",
        "duration=2",
    )
    measured = simulated(*sagging)
    commanded = simulated(*sagging, "controller.feedback=commanded")
    assert np.abs(commanded.error[-1]).max() > 1e-3
    assert np.abs(measured.error[-1]).max() < 0.1 * np.abs(commanded.error[-1]).max()


def test_a_heavier_weight_slows_a_joint(simulated):
    light = simulated("robot=xarm7", "controller.null_space.task=none")
    heavy = simulated("robot=xarm7", "controller.null_space.task=none", "controller.weights=[100,1,1,1,1,1,1]")
    assert np.ptp(heavy.q[:, 0]) < 0.2 * np.ptp(light.q[:, 0])


@pytest.mark.parametrize(
    ("overrides", "text"),
    [
        (("robot=macro", DIK, "controller.task=pose"), "controller.task: pose has 6 dimensions, and the arm 3 joints"),
        (
            ("robot=xarm7", "controller.gain=200"),
            "controller.gain: 200 1/s times controller.period, 0.01 s, is above 1",
        ),
        (("robot=xarm7", "controller.weights=[1,2]"), "controller.weights: 2 values for 7 joints"),
        (("robot=xarm7", "controller.null_space.posture=[0]"), "controller.null_space.posture: 1 values for 7 joints"),
    ],
)
def test_bad_input_names_what_is_wrong(cli, overrides, text):
    ending = cli(*overrides)
    assert ending.code == 2
    assert text in ending.err
