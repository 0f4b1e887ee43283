"""Caveats of a motion: error of the motion's size, goals missed and position limits passed."""

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
    caveat = found(path, signals(q=q), position_limits=limits, plant="rk4")["joint_limits"]
    assert caveat.value == pytest.approx(0.05)
    assert caveat.text == ("joint q2 goes 0.05 rad beyond its position limits, at which the plant rk4 does not hold it")


def test_a_joint_at_its_position_limit_has_no_caveat(path):
    limits = np.array([[-1.0, -2.0, -3.0], [1.0, 2.0, 3.0]])
    assert found(path, signals(q=ROWS * [1.0, -2.005, 3.0]), position_limits=limits) == {}


def test_a_run_on_rk4_passes_a_limit_and_says_so(make_run):
    run = make_run(
        "robot=xarm7", "controller=computed_torque", "trajectory=goal", "plant=rk4", "torque_limits.max=0.5",
        "duration=0.5",
    )  # fmt: skip
    assert "joint_limits" in {caveat["rule"] for caveat in run.caveats}
