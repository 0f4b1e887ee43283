"""Torque limits by joint: one value or a list, by stage, and never above the effort of the URDF."""

from dataclasses import replace

import numpy as np
import pytest

from runner.assembly.arms import read_outline
from runner.base.errors import ConfigError
from runner.config.compose.compose import compose
from runner.config.parsing import group_of, parse_robot
from runner.config.torque_limits import TorqueLimitsConfig


@pytest.fixture(scope="module")
def arms():
    resolved = {name: compose([f"robot={name}"]).resolved for name in ("macro", "combined")}
    return {name: read_outline(parse_robot(group_of("robot", config))) for name, config in resolved.items()}


def test_no_limit_leaves_the_efforts(arms):
    arm = arms["macro"]
    np.testing.assert_array_equal(
        arm.torque_limits(TorqueLimitsConfig(max=None, no_load_speed=None)).max, arm.effort_limits
    )


@pytest.mark.parametrize("value", [30.0, [10.0, 20.0, 30.0], [1e9, 20.0, 1e9]])
def test_the_smaller_of_limit_and_effort_counts(arms, value):
    arm = arms["macro"]
    wanted = np.minimum(np.broadcast_to(value, 3), arm.effort_limits)
    np.testing.assert_array_equal(arm.torque_limits(TorqueLimitsConfig(max=value, no_load_speed=None)).max, wanted)


def test_stages_have_limits_of_their_own(arms):
    arm = arms["combined"]
    limits = arm.torque_limits(TorqueLimitsConfig(max={"macro": 50.0, "mini": 2.0}, no_load_speed=None)).max
    assert (limits[:3] <= 50.0).all()
    assert (limits[3:] <= 2.0).all()


def test_a_list_of_another_length_is_told(arms):
    with pytest.raises(ConfigError, match=r"torque_limits.max: 2 values for 3 joints"):
        arms["macro"].torque_limits(TorqueLimitsConfig(max=[1.0, 2.0], no_load_speed=None))


def test_a_no_load_speed_is_that_of_its_joint(arms):
    arm = arms["macro"]
    assert not arm.torque_limits(TorqueLimitsConfig(max=30.0, no_load_speed=None)).depend_on_speed
    limits = arm.torque_limits(TorqueLimitsConfig(max=30.0, no_load_speed=[2.0, None, 4.0]))
    assert limits.depend_on_speed
    assert limits.no_load_speed.tolist() == [2.0, np.inf, 4.0]
    staged = TorqueLimitsConfig(max={"macro": 50.0, "mini": 2.0}, no_load_speed={"macro": 3.0, "mini": None})
    assert arms["combined"].torque_limits(staged).no_load_speed.tolist() == [3.0] * 3 + [np.inf] * 3


def test_a_no_load_speed_without_a_torque_limit_is_refused(arms):
    arm = replace(
        arms["macro"], stages=tuple(replace(each, effort_limits=np.full(3, np.inf)) for each in arms["macro"].stages)
    )
    with pytest.raises(ConfigError, match=r"no_load_speed: needs a torque limit; none for q1, q3. Set torque_limits"):
        arm.torque_limits(TorqueLimitsConfig(max=None, no_load_speed=[1.0, None, 1.0]))
