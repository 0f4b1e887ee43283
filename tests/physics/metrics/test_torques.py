"""Caveats of torques: time at the limit and chatter, on both sides of their thresholds."""

import numpy as np
import pytest
from support.caveat_runs import found, signals

LIMITS = np.array([10.0, 10.0, 10.0])


@pytest.fixture(scope="module")
def limited(checked_config):
    return checked_config("robot=macro", "torque_limits.max=10")


def torques(at_limit, of=100, joint=1):
    tau = np.zeros((of, 3))
    tau[:at_limit, joint] = 10.0
    return tau


def test_a_joint_at_its_limit_for_long_is_told(limited):
    caveat = found(limited, signals(tau=torques(25)))["saturation"]
    assert caveat.value == 0.25
    assert caveat.text == "joint q2 is at its torque limit, 10 N m, in 25 % of the ticks"


def test_a_joint_at_its_limit_for_a_short_time_has_no_caveat(limited):
    assert found(limited, signals(tau=torques(10))) == {}
    assert found(limited, signals(tau=torques(100) * 0.999)) == {}


def test_a_torque_that_jumps_between_its_limits_chatters(limited):
    tau = torques(0)
    tau[::2, 0], tau[1::2, 0] = 10.0, -10.0
    caveat = found(limited, signals(tau=tau))["chatter"]
    assert caveat.value == 0.99
    assert "joint q1 chatters: its torque jumps from one limit, 10 N m, to the opposite one at 99 %" in caveat.text


def test_a_torque_that_swings_from_limit_to_limit_does_not_chatter(limited):
    t = np.arange(200)
    tau = torques(0, 200)
    tau[:, 0] = np.clip(20.0 * np.sin(2.0 * np.pi * t / 50.0), -10.0, 10.0)
    assert set(found(limited, signals(tau=tau))) == {"saturation"}


def test_ticks_of_a_slow_loop_count(limited):
    tau = np.repeat(np.resize([10.0, -10.0], 10), 10)[:, None] * [1.0, 0.0, 0.0]
    every = np.array([10, 1, 1])
    assert found(limited, signals(tau=tau), ticks_per_torque=every)["chatter"].value == pytest.approx(0.9)


def test_the_worst_joint_of_the_worst_repetition_is_told(limited):
    runs = [signals(tau=torques(ticks, joint=joint)) for ticks, joint in ((20, 0), (0, 0), (60, 2), (30, 1))]
    caveat = found(limited, *runs)["saturation"]
    assert caveat.value == 0.6
    assert caveat.text.startswith("joint q3 ")
    assert caveat.text.endswith(", in 3 of 4 repetitions")


def test_joints_that_go_where_they_are_told_would_need_their_torques(limited):
    caveat = found(limited, signals(tau=torques(25)), plant="kinematic")["saturation"]
    assert caveat.text.startswith("joint q2 would need its torque limit, 10 N m, or more in 25 % of the ticks;")
    jumping = np.resize([10.0, -10.0], 100)[:, None] * [1.0, 0.0, 0.0]
    assert set(found(limited, signals(tau=jumping), plant="kinematic")) == {"saturation"}
