"""Paths that an arm cannot follow are refused before anything runs, with when, where and why."""

import re

import numpy as np
import pytest


def refusal(cli, *overrides: str) -> str:
    ending = cli("robot=xarm7", *overrides)
    assert ending.code == 2
    return ending.err


def test_a_point_out_of_reach_says_how_far_out(cli):
    assert "m too far" in refusal(cli, "controller=three_joint", "trajectory.goal=[0.7,0.4,0.1508]")
    assert "outside the workspace" in refusal(cli, "trajectory.goal=[0.9,0.9,0.1508]")


def test_a_path_into_a_joint_limit_says_when_and_which_joint(cli):
    err = refusal(cli, "trajectory.start=[-0.3,0,0.5]", "trajectory.goal=[0.1,0,-0.3]")
    assert re.search(r"at t = [\d.]+ s the tip leaves the path, by [\d.]+ m at most: joint\d stands at its limit", err)


def test_too_short_a_time_says_the_shortest_feasible_one_and_that_one_runs(cli):
    err = refusal(cli, "trajectory.duration=0.2")
    assert re.search(r"at t = [\d.]+ s joint\d would turn at [\d.]+ rad/s, and its limit is 3\.142 rad/s", err)
    shortest = float(re.search(r"shortest feasible time is ([\d.]+) s", err)[1])
    assert cli("robot=xarm7", f"trajectory.duration={1.02 * shortest}").code == 0
    assert cli("robot=xarm7", f"trajectory.duration={0.95 * shortest}").code == 2


def test_a_path_within_one_period_is_no_path_for_the_joints(cli):
    err = refusal(cli, "trajectory.duration=1e-5")
    assert "trajectory.duration: 1e-05 s is shorter than one controller period, 0.01 s" in err


def test_a_goal_is_no_path(cli):
    assert cli("robot=xarm7", "trajectory=goal", "duration=2").code == 0


@pytest.mark.parametrize("x", [0.643, 0.6043])
def test_the_reports_line_can_be_followed(simulated, x):
    trace = simulated("robot=xarm7", f"trajectory.start=[{x},-0.2,0.1508]", f"trajectory.goal=[{x},0.2,0.1508]")
    assert np.abs(trace.error).max() < 1e-5
