"""Values of single stages, merged with the defaults of the robot and with those of the other stages."""

import re
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import yaml
from omegaconf import DictConfig, OmegaConf

from runner.base.bounded_yaml import CONFIG, read_yaml
from runner.base.paths import conf_dir
from runner.config.robot import ArmConfig


def complete_stages(config: DictConfig, choices: Mapping[str, str], config_dirs: Sequence[Path]) -> None:
    """Add the missing stages to mappings that override some stages, with the values that the group's file refers to.

    For example, a group's file contains `period: ${robot.period}`. An override of one stage replaces this reference by
    a mapping with only that stage. This function adds the other stages, so that the override merges.

    Args:
        config: The composed config, completed in place.
        choices: The option chosen in each group.
        config_dirs: Config folders of the user, searched before conf/.
    """
    for group, option in choices.items():
        for key, reference in _references(group, option, config_dirs):
            node = config.get(group)
            if not isinstance(node, DictConfig) or OmegaConf.is_interpolation(node, key) or key not in node:
                continue
            given, default = node[key], OmegaConf.select(config, reference)
            if isinstance(given, DictConfig) and isinstance(default, DictConfig):
                node[key] = {**default, **given}


def _references(group: str, option: str, config_dirs: Sequence[Path]) -> list[tuple[str, str]]:
    """Return key and target of each value in the file of an option that is a single reference."""
    for folder in (*config_dirs, conf_dir()):
        path = folder / group / f"{option}.yaml"
        if path.is_file():
            return _references_of(path.read_text(), path)
    return []


@lru_cache(maxsize=256)
def _references_of(text: str, path: Path) -> list[tuple[str, str]]:
    content = read_yaml(text, path, CONFIG)
    found = [
        (key, re.fullmatch(r"\$\{([\w.]+)\}", value))
        for key, value in (content.items() if isinstance(content, Mapping) else ())
        if isinstance(value, str)
    ]
    return [(str(key), match[1]) for key, match in found if match is not None]


def complete_stage_arms(config: DictConfig) -> None:
    """Move the defaults of one arm from a robot that has stages to its stages, in place.

    A key of one arm whose value is not the default remains at the robot. Validation then rejects it.

    Args:
        config: The composed config, unchanged if the robot has no stages.
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
