"""Validation of one config group against its model, and collection of the problems found."""

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, TypeVar

from pydantic import ValidationError

from runner.base.errors import ConfigError
from runner.base.memory import Memory
from runner.base.sanitize import quoted
from runner.config.compose.messages import describe
from runner.config.robot import OneArmConfig, RobotConfig, StagedRobotConfig
from runner.plugins.registry import Kinds
from runner.schema.model import StrictModel, absurd

M = TypeVar("M", bound=StrictModel)
T = TypeVar("T")


class Problems:
    """Problems that checks have found so far.

    Args:
        memory: Cache of earlier results of checks for the same parts; None to run every check.

    Attributes:
        found: A message for each problem.
    """

    def __init__(self, memory: Memory | None = None) -> None:
        self.found: list[str] = []
        self._memory = memory

    def attempt(self, check: Callable[..., T], /, *parts: Any) -> T | None:
        """Return the result of a check of parts; None if one of the parts is None, or if the check finds a problem."""
        return self._collect(_made, check, *parts)

    def recall(self, check: Callable[..., T], /, *parts: Any) -> T | None:
        """Return the result of `attempt`, cached for equal parts; see Memory.recall."""
        return self._collect(_made if self._memory is None else partial(self._memory.recall, _made), check, *parts)

    def _collect(self, make: Callable[..., tuple[T | None, Sequence[str]]], check: object, *parts: Any) -> T | None:
        for part in parts:
            if part is None:
                return None
        value, problems = make(check, *parts)
        self.found += problems
        return value

    def report(self) -> None:
        """End the checks.

        Raises:
            ConfigError: if one of them has found a problem.
        """
        if self.found:
            raise ConfigError(self.found)


def _made(check: Callable[..., T], *parts: object) -> tuple[T | None, Sequence[str]]:
    """Return the result of a check of parts, and the problems that it finds."""
    try:
        return check(*parts), ()
    except ConfigError as error:
        return None, error.problems


def require(value: T | None) -> T:
    """Return the result of a check that found no problem."""
    assert value is not None  # noqa: S101 - a check without result has found a problem
    return value


Parts = dict[str, Any]
"""Valid groups of a config, and what is built from them, by name."""


def group_of(group: str, resolved: Mapping[str, object]) -> Mapping[str, object]:
    """Return the keys of a group of a config.

    Raises:
        ConfigError: if the group is missing or not a mapping.
    """
    value = resolved.get(group)
    if not isinstance(value, Mapping):
        raise ConfigError(f"{group}: must be a group of keys; found {quoted(value)}")
    return value


def parse_kind(kinds: Kinds, value: Mapping[str, object]) -> StrictModel:
    """Return a group checked by the model of its `kind`, or of the group's default kind.

    Args:
        kinds: Kinds that the group may have.
        value: Keys of the group.

    Raises:
        ConfigError: with every problem of the group.
    """
    kind = value.get("kind", kinds.default)
    if kind is None:
        raise ConfigError(f"{kinds.group}.kind: missing; known: {', '.join(kinds.names())}")
    return parse(kinds.group, kinds.config_model(str(kind)), value)


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
