"""Checking one group of a composed config against its model, and gathering problems."""

from collections.abc import Callable, Mapping
from typing import Any

from pydantic import ValidationError

from runner.config.magnitudes import absurd
from runner.config.messages import describe
from runner.config.robot import StagedRobotConfig
from runner.errors import ConfigError
from runner.registry import Registry, StrictModel
from runner.texts import quoted


def attempt(problems: list[str], check: Callable[[], Any]) -> Any:
    """Return what a check returns; where it raises ConfigError, add its problems to others and return None."""
    try:
        return check()
    except ConfigError as error:
        problems.extend(error.problems)
        return None


def parse_group(group: str, kinds: Registry | type[StrictModel], resolved: Mapping[str, Any]) -> StrictModel:
    """Return a group of a config, checked.

    Args:
        group: Its name.
        kinds: The registry whose kinds it holds, or the one model that it has.
        resolved: The config as plain data.

    Raises:
        ConfigError: with every problem of the group.
    """
    value = resolved.get(group)
    if not isinstance(value, Mapping):
        raise ConfigError([f"{group}: must be a group of keys; found {quoted(value)}"])
    if not isinstance(kinds, Registry):
        staged = group == "robot" and "stages" in value
        return parse(group, StagedRobotConfig if staged else kinds, value)
    if "kind" not in value:
        raise ConfigError([f"{group}.kind: missing; known: {', '.join(kinds.names())}"])
    return parse(group, kinds.config_model(str(value["kind"])), value)


def parse(group: str, model: type[StrictModel], value: Mapping[str, Any]) -> StrictModel:
    """Return values checked by a model; `group` is "" for those at the root.

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
