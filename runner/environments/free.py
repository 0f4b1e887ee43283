"""Free space without an external wrench."""

from typing import Literal

from runner.environments.environment import Environment
from runner.schema.model import StrictModel


class FreeConfig(StrictModel):
    """Config of free space.

    Attributes:
        kind: Its name in the registry.
    """

    kind: Literal["free"]


CONFIG = FreeConfig


def build(config: FreeConfig) -> Environment | None:
    """Return None: there is nothing to feel."""
    return None
