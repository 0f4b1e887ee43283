"""Caveat rules on the load of the arm: overload, and payload without torque limits."""

import math

import numpy as np

from runner.metrics.caveats.rule import SettingRule
from runner.metrics.caveats.setting import Setting


def _overload(setting: Setting) -> float | None:
    """Return the ratio of tool and payload to the rated payload; None if no rating is given."""
    robot = setting.robot
    return None if robot.rated_payload is None else robot.burden / robot.rated_payload


def _tell_overload(value: float, setting: Setting) -> str:
    robot = setting.robot
    what = "the payload weighs" if robot.tool is None else "tool and payload weigh"
    rating = f"the {robot.rated_payload:g} kg that {robot.name} is rated for"
    return f"{what} {robot.burden:.4g} kg, {value:.3g} times {rating}"


def _lifted(setting: Setting) -> float | None:
    """Return the payload, in kg, if a joint has no torque limit."""
    return None if all(map(math.isfinite, setting.torque_limits.tolist())) else setting.robot.payload.largest


def _tell_lifted(value: float, setting: Setting) -> str:
    endless = [name for name, limit in zip(setting.joint_names, setting.torque_limits, strict=True) if limit == np.inf]
    which = "no joint" if len(endless) == len(setting.joint_names) else f"not joint {', '.join(endless)}"
    return f"{setting.robot.name} lifts {value:.4g} kg, and would lift anything: {which} has a torque limit"


OVERLOAD = SettingRule("overload", _overload, _tell_overload)
NO_EFFORT_LIMIT = SettingRule("no_effort_limit", _lifted, _tell_lifted)
