"""Validation of one config group against its model."""

from collections.abc import Mapping
from typing import Any, TypeVar

from pydantic import ValidationError

from runner.base.errors import ConfigError
from runner.base.sanitize import quoted
from runner.config.compose.messages import describe
from runner.config.robot import OneArmConfig, RobotConfig, StagedRobotConfig
from runner.plugins.registry import Kinds
from runner.schema.model import StrictModel
from runner.schema.plausibility import absurd

M = TypeVar("M", bound=StrictModel)
Parts = dict[str, Any]
"""Valid groups of a config, and what is built from them, by name."""


def group_of(group: str, resolved: Mapping[str, object]) -> Mapping[str, object]:
    """Return the keys of a group of a config.

    Raises:
        ConfigError: if the group is missing or not a mapping.
    """
    value = resolved.get(group)
    if not isinstance(value, Mapping):
        raise ConfigError([f"{group}: must be a group of keys; found {quoted(value)}"])
    return value


def parse_kind(kinds: Kinds, value: Mapping[str, object]) -> StrictModel:
    """Return a group checked by the model of its `kind`.

    Args:
        kinds: Kinds that the group may have.
        value: Keys of the group.

    Raises:
        ConfigError: with every problem of the group.
    """
    if "kind" not in value:
        raise ConfigError([f"{kinds.group}.kind: missing; known: {', '.join(kinds.names())}"])
    return parse(kinds.group, kinds.config_model(str(value["kind"])), value)


def parse_robot(value: Mapping[str, object]) -> RobotConfig:
    """Return the checked group of the robot, with one arm or several stages.

    Raises:
        ConfigError: with every problem of the group.
    """
    return parse("robot", StagedRobotConfig, value) if "stages" in value else parse("robot", OneArmConfig, value)


def parse(group: str, model: type[M], value: Mapping[str, object]) -> M:
    """Return values checked by a model; `group` is "" for values at the root.

    Raises:
        ConfigError: with every problem found.
    """
    problems = list(absurd(group, value))
    if problems:
        raise ConfigError(problems)
    try:
        return model.model_validate(dict(value))
    except ValidationError as error:
        raise ConfigError(describe(group, model, error)) from None
