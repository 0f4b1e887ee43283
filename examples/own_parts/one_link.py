"""Error of the controller's model: the mass of one link."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, NonNegativeFloat, PositiveFloat

from runner.plugin import StrictModel, scale_model, with_models


class OneLinkConfig(StrictModel):
    """Config of a wrong link.

    Attributes:
        kind: Its name in the registry.
        joint: Number of the joint that moves the link, counted from 1.
        mass: Factor on its mass and inertia.
        spread: Largest additional relative error, drawn in each repetition.
    """

    kind: Literal["one_link"]
    joint: Annotated[int, Field(ge=1)]
    mass: PositiveFloat
    spread: NonNegativeFloat


CONFIG = OneLinkConfig


def build(config, robot, generator):
    masses = np.ones(robot.model.nq)
    masses[config.joint - 1] = config.mass * (1.0 + config.spread * generator.uniform(-1.0, 1.0))

    def change(model, joints, bears_payload):
        own = masses[joints]
        return scale_model(model, own, np.ones(len(own)), np.ones(len(own) + 1))

    return with_models(robot, change)
