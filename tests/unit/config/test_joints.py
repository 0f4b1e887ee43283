"""Torque limits by joint: one value or a list, by stage, and never above the effort of the URDF."""

import numpy as np
import pytest

from runner.base.errors import ConfigError
from runner.config.arms import read_outline
from runner.config.compose.compose import compose
from runner.config.parsing import group_of, parse_robot
from runner.config.settings import TorqueLimitsConfig


@pytest.fixture(scope="module")
def arms():
    resolved = {name: compose([f"robot={name}"]).resolved for name in ("macro", "combined")}
    return {name: read_outline(parse_robot(group_of("robot", config))) for name, config in resolved.items()}


def test_no_limit_leaves_the_efforts(arms):
    arm = arms["macro"]
    np.testing.assert_array_equal(TorqueLimitsConfig(max=None).by_joint(arm), arm.effort_limits)


@pytest.mark.parametrize("value", [30.0, [10.0, 20.0, 30.0], [1e9, 20.0, 1e9]])
def test_the_smaller_of_limit_and_effort_counts(arms, value):
    arm = arms["macro"]
    wanted = np.minimum(np.broadcast_to(value, 3), arm.effort_limits)
    np.testing.assert_array_equal(TorqueLimitsConfig(max=value).by_joint(arm), wanted)


def test_stages_have_limits_of_their_own(arms):
    arm = arms["combined"]
    limits = TorqueLimitsConfig(max={"macro": 50.0, "mini": 2.0}).by_joint(arm)
    assert (limits[:3] <= 50.0).all()
    assert (limits[3:] <= 2.0).all()


def test_a_list_of_another_length_is_told(arms):
    with pytest.raises(ConfigError, match=r"torque_limits.max: 2 values for 3 joints"):
        TorqueLimitsConfig(max=[1.0, 2.0]).by_joint(arms["macro"])
