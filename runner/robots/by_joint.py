"""Joint values of a robot from config values per stage, with infinity for null."""

import numpy as np

from runner.base.arrays import FloatArray
from runner.robots.robot import Robot
from runner.schema.per_joint import expand
from runner.schema.per_stage import OptionalPerStage, by_stage


def by_joint(key: str, value: OptionalPerStage, arm: Robot) -> FloatArray:
    """Return a key's value of each joint of a robot, shape (nq,); infinite for null.

    Raises:
        ConfigError: for values that do not fit the robot's stages and joints.
    """
    if value is None:
        return np.full(arm.model.nq, np.inf)
    values: list[float | None] = []
    for stage, given in zip(arm.stages, by_stage(key, value, arm.stage_names), strict=True):
        at = f"{key}.{stage.name}" if len(arm.stages) > 1 else key
        values += expand(at, given, stage.model.joint_names)  # type: ignore[arg-type]
    return np.array([np.inf if each is None else each for each in values])
