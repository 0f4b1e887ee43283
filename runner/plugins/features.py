"""Optional members of the module of a kind, with their defaults."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any, Literal, TypeVar

from runner.base.errors import ConfigError

Commands = Literal["torque", "position"]
"""Command from a controller to a plant: joint torques or joint positions."""
_METHODS: Mapping[Commands, str] = {"torque": "torque", "position": "joint_positions"}  # of a law, by its command


@dataclass(frozen=True)
class Features:
    """Optional members of the module of a kind, with the default values for modules without them.

    Attributes:
        COMMANDS: Command that a controller returns or a plant takes.
        COMPILED: True if compiled code contains the encoders or the nominal model that the module builds. Runs with
            others are interpreted.
    """

    COMMANDS: Commands = "torque"
    COMPILED: bool = False


F = TypeVar("F", bound=Any)


def read_features(of_group: type[F], part: object) -> F:
    """Return the optional members of a module or a config, as a dataclass with their defaults."""
    own = vars(part)
    found: F = of_group(**{field.name: own[field.name] for field in fields(of_group) if field.name in own})
    return found


def check_commands(group: str, kind: str, loops: object, commands: Commands) -> None:
    """Check that the laws of loops, if a part has any, have the method for their command.

    Raises:
        ConfigError: if one has only the method for the other command.
    """
    other: Commands = "torque" if commands == "position" else "position"
    for loop in loops if isinstance(loops, Sequence) and commands in _METHODS else ():
        law = getattr(loop, "controller", None)
        if hasattr(law, _METHODS[other]) and not hasattr(law, _METHODS[commands]):
            raise ConfigError(
                f"{group}.kind: the module of '{kind}' has COMMANDS = \"{commands}\", and its law "
                f"{type(law).__name__} has {_METHODS[other]} instead of {_METHODS[commands]}; "
                f'write COMMANDS = "{other}" in the module'
            )
