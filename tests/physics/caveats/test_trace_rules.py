"""Caveats of signals: error of the motion's size, missed goals, passed position limits, torques at their limits."""

import numpy as np
import pytest
from support.caveat_runs import found, signals

ROWS = np.linspace(0.0, 1.0, 101)[:, None]
PATH = ROWS * [0.4, 0.0, 0.0]  # m
OFF = [0.0, 1.0, 0.0]


@pytest.fixture(scope="module")
def path(checked_config):
    return checked_config("robot=macro", "trajectory=quintic")


@pytest.fixture(scope="module")
def goal(checked_config):
    return checked_config("robot=macro")


def test_an_error_of_the_size_of_the_motion_is_told(path):
    error = np.multiply(np.sin(np.pi * ROWS) * 0.2, OFF)
    caveat = found(path, signals(tip=PATH - error, desired=PATH))["did_not_follow"]
    assert caveat.value == pytest.approx(0.5)
    assert caveat.text == "the arm did not follow: the tip's error reaches 50 % of the size of its motion"


def test_a_small_error_has_no_caveat(path):
    error = np.multiply(np.sin(np.pi * ROWS) * 0.05, OFF)
    assert found(path, signals(tip=PATH - error, desired=PATH)) == {}


def test_a_goal_is_to_be_reached_at_the_end_alone(goal):
    desired = np.tile(PATH[-1], (101, 1))
    assert found(goal, signals(tip=np.minimum(2.0 * PATH, PATH[-1]), desired=desired)) == {}
    caveat = found(goal, signals(tip=0.5 * PATH, desired=desired))["did_not_follow"]
    assert caveat.value == pytest.approx(0.55)
    assert "at the end the tip is still 55 % of its way from the goal" in caveat.text


def test_an_arm_that_is_to_stay_or_to_give_way_has_nothing_to_follow(path):
    pushed = signals(tip=PATH, desired=np.zeros_like(PATH))
    assert found(path, pushed) == {}
    lagging = signals(tip=0.1 * PATH, desired=PATH)
    assert set(found(path, lagging)) == {"did_not_follow"}
    assert found(path, lagging, complies=True) == {}


def test_a_joint_beyond_its_position_limits_is_told(path):
    limits = np.array([[-1.0, -2.0, -np.inf], [1.0, 2.0, np.inf]])
    q = ROWS * [0.9, -2.05, 99.0]
    caveat = found(path, signals(q=q), position_limits=limits, plant="rk4", stops=False)["joint_limits"]
    assert caveat.value == pytest.approx(0.05)
    assert caveat.text == ("joint q2 goes 0.05 rad beyond its position limits, at which the plant rk4 does not hold it")


def test_a_joint_at_its_position_limit_has_no_caveat(path):
    limits = np.array([[-1.0, -2.0, -3.0], [1.0, 2.0, 3.0]])
    assert found(path, signals(q=ROWS * [1.0, -2.005, 3.0]), position_limits=limits) == {}


def test_a_plant_with_stops_tells_which_joint_is_on_one(path):
    limits = np.array([[-1.0, -2.0, -np.inf], [1.0, 2.0, np.inf]])
    q = np.clip(ROWS * [2.0, -1.9, 99.0], None, [1.002, 3.0, np.inf])  # a stop gives way by 2 mrad
    stopped = found(path, signals(q=q), position_limits=limits, plant="bullet", stops=True)["joint_stops"]
    assert stopped.value == pytest.approx(51 / 101)
    assert stopped.text == (
        "joint q1 is on a stop of the plant bullet, at a position limit, in 50.5 % of the ticks; "
        "other plants may let it pass"
    )
    assert found(path, signals(q=q), position_limits=limits, plant="rk4", stops=False) == {}
    beyond = found(path, signals(q=ROWS * [1.5, 0.0, 0.0]), position_limits=limits, plant="bullet", stops=True)
    assert beyond["joint_limits"].text.endswith("its position limits: the stops of the plant bullet give way")


@pytest.mark.parametrize("plant", ["bullet", "mujoco"])
def test_a_goal_beyond_a_stop_is_told_by_engines_that_have_stops(make_run, plant):
    run = make_run("robot=xarm7", "controller=joint_pd", "trajectory=goal", f"plant={plant}", "duration=0.5",
                   "controller.gravity_compensation=false", "torque_limits.max=0.5")  # fmt: skip
    assert "joint_stops" in {caveat["rule"] for caveat in run.caveats}


def test_a_run_on_rk4_passes_a_limit_and_says_so(make_run):
    run = make_run(
        "robot=xarm7", "controller=computed_torque", "trajectory=goal", "plant=rk4", "torque_limits.max=0.5",
        "duration=0.5",
    )  # fmt: skip
    assert "joint_limits" in {caveat["rule"] for caveat in run.caveats}


def test_a_joint_beyond_its_speed_limit_has_a_caveat_on_a_plant_of_torques(make_run):
    """12 rad/s at a limit of 0.5 rad/s passed without a word."""
    fast = ("robot=macro", "trajectory=quintic", "trajectory.duration=1", "plant=rk4", "duration=1")
    limits = "robot.velocity_limits={q1: 0.5, q2: 0.5, q3: 0.5}"
    run, free = make_run(*fast, limits), make_run(*fast)
    peaks = [run.metrics[f"peak_joint_speed_q{joint}"].median for joint in (1, 2, 3)]
    (caveat,) = [each for each in run.caveats if each["rule"] == "joint_speed"]
    assert caveat["value"] == pytest.approx(np.max(peaks) / 0.5, rel=1e-6)
    assert "times its speed limit, 0.5 rad/s, which the plant rk4 does not enforce" in caveat["text"]
    assert "joint_speed" not in {each["rule"] for each in free.caveats}


def test_a_joint_at_its_speed_limit_has_no_caveat_and_0_is_no_limit(path):
    limits = np.array([2.0, 0.0, np.inf])
    moving = signals(dq=np.ones((101, 3)) * [-2.0 * (1.0 + 1e-12), 9.0, 9.0])
    assert found(path, moving, velocity_limits=limits) == {}
    caveat = found(path, signals(dq=np.ones((101, 3)) * [-2.1, 9.0, 9.0]), velocity_limits=limits)["joint_speed"]
    assert caveat.value == pytest.approx(1.05)


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
