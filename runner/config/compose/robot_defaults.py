"""Defaults of conf/robot_defaults.yaml for each stage of a robot with several stages."""

from functools import lru_cache
from typing import Any

import yaml
from omegaconf import DictConfig, OmegaConf

from runner.base.paths import conf_dir
from runner.config.robot import ArmConfig


def complete_stage_arms(config: DictConfig) -> None:
    """Move the defaults of one arm from a robot that has stages to its stages, in place.

    What stands at the robot itself though it is of one arm, and is no default, stays there: validation refuses it.

    Args:
        config: The composed config; one whose robot has no stages is left as it is.
    """
    group = config.get("robot")
    robot: Any = OmegaConf.to_container(group, resolve=False) if isinstance(group, DictConfig) else None
    if not isinstance(robot, dict) or not isinstance(robot.get("stages"), dict):
        return
    defaults = _arm_defaults((conf_dir() / "robot_defaults.yaml").read_text())
    for key, value in defaults.items():
        if robot.get(key) == value:
            del group[key]
        for name, stage in robot["stages"].items():
            if isinstance(stage, dict) and key not in stage:
                group["stages"][name][key] = value


@lru_cache(maxsize=1)
def _arm_defaults(text: str) -> dict[str, Any]:
    defaults = yaml.safe_load(text)["robot"]
    return {key: value for key, value in defaults.items() if key in ArmConfig.model_fields}
