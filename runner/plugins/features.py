"""Optional members of the module of a kind, with their defaults."""

from dataclasses import dataclass, fields
from types import ModuleType
from typing import Literal, TypeVar

Commands = Literal["torque", "position"]
"""What a controller gives and a plant takes: torques of the joints, or their positions."""


@dataclass(frozen=True)
class Features:
    """Optional members of the module of a kind; each has the value that a module without it has.

    Attributes:
        COMMANDS: What a controller gives or a plant takes.
    """

    COMMANDS: Commands = "torque"


F = TypeVar("F", bound=Features)


def read_features(of_group: type[F], module: ModuleType) -> F:
    """Return the optional members of a module."""
    own = vars(module)
    return of_group(**{field.name: own[field.name] for field in fields(of_group) if field.name in own})
