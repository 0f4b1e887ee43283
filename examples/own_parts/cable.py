"""A cable along the arm: it pulls at a link as a spring with a damper, and its bending turns a joint back."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, NonNegativeFloat

from runner.plugin import StrictModel, units

Vector = Annotated[list[float], Field(min_length=3, max_length=3)]


class CableConfig(StrictModel):
    """Config of a cable.

    Attributes:
        kind: Its name in the registry.
        link: Name of the link that it is tied to.
        point: Where, in the link's frame, in m.
        anchor: Where its other end is, in the base frame, in m.
        stiffness: In N/m; it pulls and never pushes.
        slack: Length up to which it is loose, in m.
        damping: Force per speed of the point, in N s/m.
        joint: Number of the joint that its bending turns back, counted from 1.
        bending: Torque per angle, in N m/rad.
    """

    kind: Literal["cable"]
    link: str
    point: units.Metres[Vector]
    anchor: units.Metres[Vector]
    stiffness: units.Stiffness[NonNegativeFloat]
    slack: units.Metres[NonNegativeFloat]
    damping: units.Damping[NonNegativeFloat]
    joint: Annotated[int, Field(ge=1)]
    bending: units.RotaryStiffness[NonNegativeFloat]


class Cable:
    """The cable; see runner/environments/__init__.py."""

    def __init__(self, config):
        self.config = config
        self.points = {config.link: config.point}
        self.anchor = np.array(config.anchor)

    def reset(self, tip):
        pass

    def wrench(self, time, tip, velocity):
        return np.zeros(6)

    def link_forces(self, time, positions, velocities):
        config = self.config
        away = self.anchor - positions
        length = np.linalg.norm(away, axis=1, keepdims=True)
        pull = config.stiffness * np.maximum(length - config.slack, 0.0)
        return pull * away / np.maximum(length, 1e-9) - config.damping * velocities

    def joint_torques(self, time, q, dq):
        torques = np.zeros(len(q))
        torques[self.config.joint - 1] = -self.config.bending * q[self.config.joint - 1]
        return torques


CONFIG = CableConfig


def build(config):
    return Cable(config)
