"""Names to parts: what a `kind:` in a config stands for.

A registry holds one line per kind, the module that defines it. The module is imported when the kind is first
used, and offers `CONFIG`, the pydantic model of its config group, and `build`, which makes the object. Users add
kinds of their own: see runner/plugins.py.
"""

import copy
from collections.abc import Callable, Mapping
from types import ModuleType
from typing import Any, Literal

from pydantic import BaseModel, ConfigDict

from runner.errors import ConfigError, RunnerError, nearest, told
from runner.plugins import added, load


class StrictModel(BaseModel):
    """Base of every config model: no unknown key, no silent conversion, no NaN or infinity, unchangeable."""

    model_config = ConfigDict(extra="forbid", strict=True, allow_inf_nan=False, frozen=True)


class Registry:
    """The kinds of one config group.

    Args:
        group: Name of the config group, such as "controller".
        modules: Module name of each kind.
        watch: Makes what is watched of what a module of the user's built, given this and what `build` was given.
    """

    def __init__(self, group: str, modules: Mapping[str, str], watch: Callable[..., Any] | None = None) -> None:
        self.group = group
        self._modules = dict(modules)
        self._watch = watch

    def names(self) -> list[str]:
        """Return the known kinds, those of the user's included, sorted."""
        return sorted(self._modules | self._plugins())

    def config_model(self, kind: str) -> type[StrictModel]:
        """Return the pydantic model of a kind's config.

        Raises:
            ConfigError: if the kind is unknown, or its module cannot be imported or has no such model.
        """
        module = self._module(kind)
        model = getattr(module, "CONFIG", None)
        if not (isinstance(model, type) and issubclass(model, StrictModel)):
            raise ConfigError(
                [
                    f"{self.group}.kind: module {module.__name__} of '{kind}' needs CONFIG, a class derived from "
                    f"runner.registry.StrictModel; found {model!r}"
                ]
            )
        return model

    def build(self, config: Any, *args: Any) -> Any:
        """Make the object that a validated config describes; `args` are what every kind of this group gets.

        A module of the user's gets copies of them, and what it builds is watched.

        Raises:
            ConfigError: where a part of the user's raises anything; names the place.
        """
        if self.is_ours(config.kind):
            return self._module(config.kind).build(config, *args)
        built = self._ask_theirs("build", config, *args)
        return built if self._watch is None else self._watch(built, config, *args)

    def is_ours(self, kind: str) -> bool:
        """Tell whether a kind comes with this package, where no watching is needed."""
        return self._module(kind).__name__.startswith("runner.")

    def commands(self, kind: str) -> Literal["torque", "position"]:
        """Return what a kind of controller gives, or a kind of plant takes: "torque" or "position" of the joints."""
        commands: Literal["torque", "position"] = getattr(self._module(kind), "COMMANDS", "torque")
        return commands

    def follows_paths(self, kind: str) -> bool:
        """Tell whether a kind of controller brings a perfect arm along any path that the arm can follow."""
        return bool(getattr(self._module(kind), "FOLLOWS_PATHS", False))

    def start_posture(self, config: Any, *args: Any) -> Any:
        """Return where the arm stands at a trajectory's start, or None where the controller's kind has no wish."""
        choose = getattr(self._module(config.kind), "start_posture", None)
        if choose is None:
            return None
        return choose(config, *args) if self.is_ours(config.kind) else self._ask_theirs("start_posture", config, *args)

    def default_step(self, kind: str, tick: float, stages: int) -> float:
        """Return the step that a kind of plant takes when its config names none, in s."""
        step: float = self._module(kind).default_step(tick, stages)
        return step

    def _ask_theirs(self, name: str, config: Any, *args: Any) -> Any:
        """Return what a function of a module of the user's gives, which is handed copies alone."""
        try:
            return getattr(self._module(config.kind), name)(*copy.deepcopy((config, *args)))
        except RunnerError:
            raise
        except Exception as error:
            raise ConfigError([f"{self.group}.kind: '{config.kind}' cannot be built: {told(error)}"]) from error

    def _module(self, kind: str) -> ModuleType:
        modules = self._modules if kind in self._modules else self._plugins()
        if kind not in modules:
            known = ", ".join(self.names())
            raise ConfigError([f"{self.group}.kind: '{kind}' is unknown{nearest(kind, self.names())}; known: {known}"])
        return load(self.group, kind, modules[kind])

    def _plugins(self) -> dict[str, str]:
        return {point.name: point.value for point in added(self.group)}
