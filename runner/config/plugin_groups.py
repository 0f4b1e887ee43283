"""Config groups that a plug-in may replace: encoders, sensors and mismatch."""

from collections.abc import Mapping
from typing import TypeVar, cast

import numpy as np

from runner.config.compose.problems import Problems
from runner.config.parsing import group_of, parse, parse_kind
from runner.plugins.registry import KindConfig, Kinds
from runner.robots.mismatch import MISMATCHES
from runner.robots.mismatch import NONE as NO_MISMATCH
from runner.robots.robot import Robot
from runner.schema.model import StrictModel
from runner.sensing import JOINT_TORQUE_SENSORS, NOISES, WRIST_SENSORS, EncoderNoise, JointTorqueConfig
from runner.sensing.force_torque import IDEAL

M = TypeVar("M", bound=StrictModel)

PLUGGED: Mapping[str, Kinds] = {
    kinds.group: kinds for kinds in (NOISES, WRIST_SENSORS, JOINT_TORQUE_SENSORS, MISMATCHES)
}
"""Groups in whose place a plug-in's stands where it names its `kind`."""

# Ours without any effect, where a plug-in's stands in its place; of encoders that follows from the robot.
_WITHOUT_EFFECT: Mapping[str, StrictModel] = {
    "wrist_sensor": IDEAL,
    "joint_torque_sensor": JointTorqueConfig(noise=None, bias=0.0),
    "mismatch": NO_MISMATCH,
}


class GroupReader:
    """Reads groups of a config that have one model of ours.

    Args:
        problems: Takes what is wrong.
        resolved: The config as plain data, interpolations resolved.

    Attributes:
        plugged: Those that are a plug-in's in place of ours, of the models that their kinds name.
    """

    def __init__(self, problems: Problems, resolved: Mapping[str, object]) -> None:
        self._problems, self._resolved = problems, resolved
        self.plugged: dict[str, KindConfig] = {}

    def read(self, model: type[M], group: str) -> M | None:
        """Return a group of ours; where it is a plug-in's, ours without effect, and None for encoders."""
        keys = self._problems.attempt(group_of, group, self._resolved)
        if keys is None or group not in PLUGGED or "kind" not in keys:
            return self._problems.recall(parse, group, model, keys)
        found = self._problems.recall(parse_kind, PLUGGED[group], keys)
        if found is None:
            return None
        self.plugged[group] = cast("KindConfig", found)
        return cast("M | None", _WITHOUT_EFFECT.get(group))


def exact_encoders(arm: Robot) -> EncoderNoise:
    """Return no noise, for a robot whose encoders are a plug-in's."""
    zero = np.zeros(arm.model.nq)
    return EncoderNoise(zero, zero, zero, "none", "exact")
