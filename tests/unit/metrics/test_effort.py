"""Metrics of torque, speed and energy against hand-made traces."""

import numpy as np
import pytest
from support.one_run import of_one

from runner.metrics import effort
from runner.metrics.family import MetricContext
from runner.plugins.metric_units import unit_of
from runner.trajectories.goal import Goal

evaluate = of_one(effort)

T = np.arange(401) * 0.01
CONTEXT = MetricContext(Goal(np.zeros(3), np.ones(3)), 0.02, 0.01)


def rows(**cells):
    """Rows for two joints, zero except for the cells given as t{tick}_q{joint}=value."""
    values = np.zeros((len(T), 2))
    for name, value in cells.items():
        tick, joint = name.split("_")
        values[int(tick[1:]), int(joint[1:]) - 1] = value
    return values


def test_constant_torque_at_constant_speed(hand_made_trace):
    torque, speed = np.array([3.0, -2.0]), np.array([0.5, 0.25])
    found = evaluate(hand_made_trace(T, q=np.outer(T, speed), dq=speed, tau=torque), CONTEXT)
    assert found["energy"] == pytest.approx((3.0 * 0.5 + 2.0 * 0.25) * 4.0)  # the brake's work counts as work
    assert found["control_effort"] == pytest.approx((9.0 + 4.0) * 4.0)
    assert found["rms_torque"] == pytest.approx(np.sqrt(6.5))
    assert found["rms_torque_q1"] == pytest.approx(3.0)
    assert found["rms_torque_q2"] == pytest.approx(2.0)
    assert (found["peak_torque"], found["peak_torque_q1"], found["peak_torque_q2"]) == (3.0, 3.0, 2.0)
    assert (found["peak_joint_speed"], found["peak_joint_speed_q1"], found["peak_joint_speed_q2"]) == (0.5, 0.5, 0.25)


def test_chatter_is_the_change_from_tick_to_tick(hand_made_trace):
    jumping = np.column_stack([3.0 + 0.5 * (-1.0) ** np.arange(len(T)), 2.0 * T])  # 1 N m, and 0.02 N m, a tick
    found = evaluate(hand_made_trace(T, tau=jumping), CONTEXT)
    assert found["torque_chatter_q1"] == pytest.approx(1.0)
    assert found["torque_chatter_q2"] == pytest.approx(0.02)
    assert found["torque_chatter"] == pytest.approx(np.sqrt((1.0 + 0.02**2) / 2.0))
    assert evaluate(hand_made_trace(T[:2], tau=[3.0, -2.0]), CONTEXT)["torque_chatter"] == 0.0


def test_energy_does_not_cancel(hand_made_trace):
    swing = np.column_stack([np.abs(T - 2.0), np.zeros(len(T))])  # there and back, 2 rad each way
    assert evaluate(hand_made_trace(T, q=swing, tau=[3.0, 0.0]), CONTEXT)["energy"] == pytest.approx(12.0)


def test_a_torque_acts_on_the_motion_that_follows_it(hand_made_trace):
    step = np.zeros((len(T), 2))
    step[101:, 0] = 2.0  # moved between ticks 100 and 101
    assert evaluate(hand_made_trace(T, q=step, tau=rows(t100_q1=5.0)), CONTEXT)["energy"] == pytest.approx(10.0)
    assert evaluate(hand_made_trace(T, q=step, tau=rows(t101_q1=5.0)), CONTEXT)["energy"] == 0.0


def test_the_last_row_s_torque_was_never_held(hand_made_trace):
    found = evaluate(hand_made_trace(T, tau=rows(t400_q1=99.0), limits=50.0), CONTEXT)
    assert all(found[name] == 0.0 for name in found)


def test_the_last_row_s_speed_was_reached(hand_made_trace):
    assert evaluate(hand_made_trace(T, dq=rows(t400_q2=-9.0)), CONTEXT)["peak_joint_speed"] == 9.0


def test_saturation_is_the_share_of_ticks_with_any_joint_at_its_limit(hand_made_trace):
    tau = rows(t0_q1=50.0, t1_q1=-50.0, t1_q2=5.0, t2_q2=-5.0, t3_q1=49.9, t4_q2=4.9)
    found = evaluate(hand_made_trace(T, tau=tau, limits=[50.0, 5.0]), CONTEXT)
    assert found["saturation_fraction"] == pytest.approx(3 / 400)
    assert found["saturation_fraction_q1"] == pytest.approx(2 / 400)
    assert found["saturation_fraction_q2"] == pytest.approx(2 / 400)


def test_a_torque_at_its_limit_but_for_rounding_is_at_its_limit(hand_made_trace):
    limit = 0.1 + 0.2
    tau = rows(t0_q1=0.3, t1_q1=0.3 * (1.0 - 1e-9))
    assert limit > 0.3
    found = evaluate(hand_made_trace(T, tau=tau, limits=limit), CONTEXT)
    assert found["saturation_fraction"] == pytest.approx(1 / 400)


def test_no_limit_is_never_reached(hand_made_trace):
    assert evaluate(hand_made_trace(T, tau=1e30), CONTEXT)["saturation_fraction"] == 0.0


def test_joints_that_slide_have_forces_and_speeds_of_their_own(hand_made_trace):
    trace = hand_made_trace(T, tau=[3.0, -40.0], dq=[0.5, 0.2], q=np.outer(T, [0.5, 0.2]), units=("rad", "m"))
    found = evaluate(trace, CONTEXT)
    assert (found["peak_torque"], found["peak_torque_q1"], found["peak_joint_speed"]) == (3.0, 3.0, 0.5)
    assert (found["peak_joint_force"], found["peak_joint_force_q2"]) == (40.0, 40.0)
    assert found["rms_joint_force"] == pytest.approx(40.0)
    assert found["peak_sliding_speed"] == found["peak_sliding_speed_q2"] == 0.2
    assert found["energy"] == pytest.approx((3.0 * 0.5 + 40.0 * 0.2) * 4.0)
    assert found["control_effort"] == pytest.approx(9.0 * 4.0)
    assert found["force_effort"] == pytest.approx(1600.0 * 4.0)
    assert not {"peak_torque_q2", "peak_joint_speed_q2", "peak_joint_force_q1"} & set(found)
    assert {unit_of(name) for name in ("peak_joint_force_q2", "rms_joint_force")} == {"N"}


def test_an_arm_that_only_slides_has_no_torques(hand_made_trace):
    found = evaluate(hand_made_trace(T, tau=2.0, units=("m", "m")), CONTEXT)
    assert found["peak_joint_force"] == 2.0
    assert not {"peak_torque", "peak_joint_speed", "control_effort"} & set(found)


def test_an_arm_that_only_turns_has_no_forces(hand_made_trace):
    assert not {"peak_joint_force", "peak_sliding_speed", "force_effort"} & set(evaluate(hand_made_trace(T), CONTEXT))
