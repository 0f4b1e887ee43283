"""Free space without an external wrench."""

from typing import Literal

from runner.environments import Environment
from runner.schema.model import StrictModel


class FreeConfig(StrictModel):
    """Config of free space.

    Attributes:
        kind: Name of the kind in the registry.
    """

    kind: Literal["free"]


CONFIG = FreeConfig


def build(config: FreeConfig) -> Environment | None:
    """Return None, because free space exerts no wrench."""
    return None
