"""Starting motions against the position and speed limits of joints: each joint beyond one is named."""

from dataclasses import replace

import numpy as np
import pytest

from runner.assembly.assemble import start_of
from runner.assembly.validation import validate
from runner.base.errors import ConfigError
from runner.config.compose.compose import compose


def problems_of(*overrides):
    with pytest.raises(ConfigError) as raised:
        validate(compose(["robot=xarm7", "trajectory=joint_quintic", *overrides]))
    return raised.value.problems


def test_a_joint_beyond_its_position_limit_is_told_with_time_value_and_limit():
    assert problems_of("trajectory.goal_configuration=[0,0.75,0,4.5,0,0.75,0]") == (
        "trajectory: at t = 3 s the position of joint4 is 4.5 rad, beyond its limits, -0.192 to 3.927 rad",
    )


def test_a_joint_that_is_too_fast_is_told():
    # 1.875 * 2 rad / 1 s at half time
    assert problems_of("trajectory.goal_configuration=[2,0.75,0,1.5,0,0.75,0]", "trajectory.duration=1") == (
        "trajectory: at t = 0.5 s the speed of joint1 is 3.75 rad/s, beyond its limits, -3.142 to 3.142 rad/s",
    )


def test_every_joint_beyond_a_limit_is_told():
    assert len(problems_of("trajectory.goal_configuration=4.0", "trajectory.duration=1")) == 3 + 7


def test_runs_with_the_same_motion_check_once_that_the_arm_can_follow_it(monkeypatch):
    asked = []
    monkeypatch.setattr("runner.assembly.assemble.check_feasible", lambda config, q: asked.append(config))
    base = ["robot=xarm7", "controller=differential_inverse_kinematics", "duration=0.0421"]
    bullet, rk4, slower = (
        compose([*base, *more]) for more in (["plant=bullet"], ["plant=rk4"], ["controller.gain=19.5"])
    )
    on_rk4 = replace(bullet, resolved={**bullet.resolved, "plant": rk4.resolved["plant"]})
    starts = [start_of(validate(composed)) for composed in (bullet, on_rk4, slower)]
    assert [config.controller.gain for config in asked] == [20.0, 19.5]
    np.testing.assert_array_equal(starts[0], starts[1])
