"""Optional members of the module of a kind, with their defaults."""

from dataclasses import dataclass, fields
from typing import Any, Literal, TypeVar

Commands = Literal["torque", "position"]
"""Command from a controller to a plant: joint torques or joint positions."""


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
