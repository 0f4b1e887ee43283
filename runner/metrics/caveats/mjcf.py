"""Caveat rule on contents of the robot's files that are missing in the run."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from runner.metrics.caveats.rule import SettingRule
from runner.metrics.caveats.setting import Setting

if TYPE_CHECKING:
    from runner.config.run import RunConfig

_IDEAL = "kinematic"  # the plant on which forces have no effect


def left_out_of(config: "RunConfig") -> Mapping[str, Sequence[str]]:
    """Return messages, by robot file, about contents that would change the motion and are missing in the run.

    Damping, friction and armature of a joint in the file count if the value of the joint in the run is zero. The
    mapping is empty for the kinematic plant.
    """
    from runner.config.flexibility import find_flexibility
    from runner.plants.decoupled import TorquePlantConfig
    from runner.plants.friction_law import joint_friction
    from runner.robots.joint_dynamics import by_value

    arm, plant = config.arm, config.plant
    if plant.kind == _IDEAL:
        return {}
    viscous, coulomb = np.zeros((2, arm.model.nq))
    if isinstance(plant, TorquePlantConfig):
        friction = joint_friction("plant.friction", plant.friction, arm.model.joint_names)
        viscous, coulomb = friction.viscous, friction.coulomb
    flexibility = find_flexibility(config)
    armature = arm.model.armature
    if flexibility is not None:
        armature = np.maximum(armature, flexibility.motors)
    found = {}
    for stage in arm.stages:
        if stage.file is None:
            continue
        parts = list(stage.file.left_out)
        for (what, key, held), given in zip(stage.file.by_key(), (viscous, coulomb, armature), strict=True):
            lost = np.where(given[stage.joints] == 0.0, held, 0.0)
            if lost.any():
                parts.append(f"{what} ({key}): {by_value(lost, stage.model.joint_names)}")
        if parts:
            found[stage.file.file] = parts
    return found


def _left_out(setting: Setting) -> float | None:
    """Return the number of messages of `left_out_of`; None if there are none."""
    return float(sum(map(len, setting.left_out.values()))) if setting.left_out else None


def _tell_left_out(value: float, setting: Setting) -> str:
    return "; ".join(f"not taken from {file}: {'; '.join(parts)}" for file, parts in setting.left_out.items())


ROBOT_FILE = SettingRule("robot_file", _left_out, _tell_left_out)
