"""Complete values of the single stages of a robot, such as the Macro and the Mini of the combined one."""

import copy
import re
from collections.abc import Mapping, Sequence
from functools import lru_cache
from pathlib import Path
from typing import Any

import yaml

from runner.base.bounded_yaml import CONFIG, read_yaml
from runner.base.dotted_keys import get
from runner.base.paths import conf_dir
from runner.config.robot import ArmConfig


def with_stages(values: dict[str, Any], choices: Mapping[str, str], config_dirs: Sequence[Path]) -> dict[str, Any]:
    """Return a config with complete values of single stages, if the robot has stages.

    Each stage gets the missing keys of one arm. Such a key at the robot itself remains if its value is not the default.
    Validation then rejects it. A mapping that overrides some stages gets the others from the value that the group's
    file refers to, such as `period: ${robot.period}`.
    """
    robot = values.get("robot")
    if not isinstance(robot, dict) or not isinstance(robot.get("stages"), dict):
        return values
    values = copy.deepcopy(values)
    robot = values["robot"]
    for key, value in _arm_defaults((conf_dir() / "robot_defaults.yaml").read_text()).items():
        if robot.get(key) == value:
            robot.pop(key, None)
        for stage in robot["stages"].values():
            if isinstance(stage, dict) and key not in stage:
                stage[key] = copy.deepcopy(value)
    for group, option in choices.items():
        for key, reference in _references(group, option, config_dirs):
            node: Any = values.get(group)
            given, default = get(node, key), get(values, reference)
            if isinstance(given, dict) and isinstance(default, dict):
                node[key] = {**default, **given}
    return values


@lru_cache(maxsize=1)
def _arm_defaults(text: str) -> dict[str, object]:
    defaults = yaml.safe_load(text)["robot"]
    return {key: value for key, value in defaults.items() if key in ArmConfig.model_fields}


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
    texts = [(str(key), value) for key, value in content.items() if isinstance(value, str)] if content else []
    return [(key, match[1]) for key, value in texts if (match := re.fullmatch(r"\$\{([\w.]+)\}", value))]
