"""Registry of kinds: modules by the `kind:` of a config.

A registry has one line for each kind, with the module that defines it. The module is imported when the kind is first
used. The module provides `CONFIG`, the pydantic model of its config group, and `build`, which creates the object. Users
can add kinds: see runner/plugins/discovery.py.
"""

import copy
from collections.abc import Callable, Mapping
from importlib import import_module
from types import ModuleType
from typing import Concatenate, Generic, ParamSpec, Protocol, TypeVar

from runner.base.errors import ConfigError, RunnerError, describe_part_error, nearest
from runner.base.former_names import explain_value
from runner.plugins.discovery import added_parts, load
from runner.plugins.features import Commands, Features, check_commands, read_features
from runner.schema.model import StrictModel


class KindConfig(Protocol):
    """Config of a part; an instance of the `CONFIG` model of its kind."""

    @property
    def kind(self) -> str:
        """Name of the kind."""
        ...


C = TypeVar("C", bound=KindConfig, contravariant=True)
P = ParamSpec("P")
T = TypeVar("T")
P2 = ParamSpec("P2")
A = TypeVar("A")


class Kinds:
    """Kinds of one config group.

    Args:
        group: Name of the config group, such as "controller".
        modules: Module name of each kind.
        default: Kind of a config without `kind`; None if `kind` must be given.
    """

    base: type[StrictModel] = StrictModel  # of the config of each kind

    def __init__(self, group: str, modules: Mapping[str, str], default: str | None = None) -> None:
        self.group, self.default = group, default
        self._modules = dict(modules)

    def names(self) -> list[str]:
        """Return the known kinds, including user-supplied ones, sorted."""
        return sorted(self._modules | self._plugins())

    def config_model(self, kind: str) -> type[StrictModel]:
        """Return the pydantic model of a kind's config.

        Raises:
            ConfigError: if the kind is unknown, or if its module cannot be imported or has no valid CONFIG.
        """
        module = self.module(kind)
        model = vars(module).get("CONFIG")
        if not (isinstance(model, type) and issubclass(model, self.base)):
            raise ConfigError(
                f"{self.group}.kind: module {module.__name__} of '{kind}' needs CONFIG, a class derived from "
                f"runner.plugin.{self.base.__name__}; found {model!r}"
            )
        return model

    def is_user_supplied(self, kind: str) -> bool:
        """Return True if a kind is not built-in: its part is guarded, and runs do not share it."""
        return not self.module(kind).__name__.startswith("runner.")

    def commands(self, kind: str) -> Commands:
        """Return the command that a kind of controllers returns or a kind of plants takes."""
        return read_features(Features, self.module(kind)).COMMANDS

    def is_compiled(self, kind: str) -> bool:
        """Return True if compiled code contains the encoders or the nominal model of a kind; see Features."""
        return read_features(Features, self.module(kind)).COMPILED

    def module(self, kind: str) -> ModuleType:
        """Return the module of a kind.

        Raises:
            ConfigError: if the kind is unknown, or its module cannot be imported.
        """
        modules = self._modules if kind in self._modules else self._plugins()
        if kind not in modules:
            if former := explain_value(self.group, kind):
                raise ConfigError(f"{self.group}.kind: {former}")
            known = ", ".join(self.names())
            more = f"; a plug-in adds its kind: --plugin {self.group}=FILE.py" if self.default else ""
            raise ConfigError(
                f"{self.group}.kind: '{kind}' is unknown{nearest(kind, self.names())}; known: {known}{more}"
            )
        return load(self.group, kind, modules[kind])

    def built_in(self) -> list[ModuleType]:
        """Return the modules of the built-in kinds."""
        return [import_module(module) for module in self._modules.values()]

    def added(self) -> list[ModuleType]:
        """Return the modules of the user-supplied kinds.

        Raises:
            ConfigError: if one cannot be imported.
        """
        return [load(self.group, point.name, point.value) for point in added_parts(self.group)]

    def _plugins(self) -> dict[str, str]:
        return {point.name: point.value for point in added_parts(self.group)}


class Registry(Kinds, Generic[C, P, T]):
    """Kinds of one config group, and the construction of their parts.

    The type parameters are the config, the other arguments of `build`, and the part.

    Args:
        group: Name of the config group, such as "controller".
        modules: Module name of each kind.
        guard: Function of a user-supplied part and the arguments of `build`; returns the guarded part.
        default: Kind of a config without `kind`; None if `kind` must be given.
    """

    def __init__(
        self,
        group: str,
        modules: Mapping[str, str],
        guard: Callable[Concatenate[T, C, P], T] | None = None,
        default: str | None = None,
    ) -> None:
        super().__init__(group, modules, default)
        self.guard = guard

    def build(self, config: C, *args: P.args, **kwargs: P.kwargs) -> T:
        """Build the part that a validated config describes; the other arguments depend on the group only.

        Raises:
            ConfigError: see `build_by`.
        """
        return self.build_by(self.module(config.kind).build, config, *args, **kwargs)

    def build_by(self, make: Callable[Concatenate[C, P], T], config: C, /, *args: P.args, **kwargs: P.kwargs) -> T:
        """Build a part by a function of its module; a user-supplied part is guarded.

        Raises:
            ConfigError: see `ask`.
        """
        built = self.ask(config, make, *args, **kwargs)
        if self.guard is None or not self.is_user_supplied(config.kind):
            return built
        check_commands(self.group, config.kind, built, self.commands(config.kind))
        return self.guard(built, config, *args, **kwargs)

    def ask(self, config: C, function: Callable[Concatenate[C, P2], A], *args: P2.args, **kwargs: P2.kwargs) -> A:
        """Return the result of a function of a kind's module; a user-supplied one receives copies of its arguments.

        Raises:
            ConfigError: if a user-supplied function raises an exception; the message contains its line.
        """
        if not self.is_user_supplied(config.kind):
            return function(config, *args, **kwargs)
        own, handed, named = copy.deepcopy((config, args, kwargs))
        try:
            return function(own, *handed, **named)
        except RunnerError:
            raise
        except Exception as error:
            fault = f"'{config.kind}' cannot be built: {describe_part_error(error)}"
            raise ConfigError(f"{self.group}.kind: {fault}") from error
