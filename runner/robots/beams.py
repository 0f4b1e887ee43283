"""Flexible links as beams, divided into rigid segments."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pinocchio as pin

from runner.base.arrays import FloatArray
from runner.robots.model import RobotModel
from runner.robots.robot import Robot, with_models


@dataclass(frozen=True)
class Beam:
    """A link that bends across its length.

    Attributes:
        EI: Bending stiffness, in N m^2, the same in both planes along it.
        mass: Spread evenly along it beside what the robot's file gives, in kg.
    """

    EI: float
    mass: float


def moving_links(arm: RobotModel) -> dict[str, int]:
    """Return the links that joints move, by name, with the number of that joint in Pinocchio's model."""
    model = arm.pin_model
    return {
        frame.name: frame.parentJoint
        for frame in model.frames
        if frame.type == pin.FrameType.BODY and model.frames[frame.parentFrame].type == pin.FrameType.JOINT
    }


def span(arm: RobotModel, joint: int, flange: str) -> FloatArray:
    """Return the end of the link that a joint moves, in its frame, shape (3,), in m.

    That is where the next joint stands; of the last link it is the flange.
    """
    model = arm.pin_model
    children = [model.jointPlacements[j] for j in range(joint + 1, model.njoints) if model.parents[j] == joint]
    end: FloatArray = (children or [model.frames[model.getFrameId(flange)].placement])[0].translation.copy()
    return end


@dataclass(frozen=True)
class Part:
    """A rigid part of a link.

    Attributes:
        begin: Where it begins along the link, in m.
        end: Where it ends, in m.
    """

    begin: float
    end: float

    def rod(self, beam: Beam, length: float, along: FloatArray) -> pin.Inertia:
        """Return the inertia of a part of a beam, a thin rod, about where it begins."""
        own = self.end - self.begin
        mass = beam.mass * own / length
        across = np.eye(3) - np.outer(along, along)
        return pin.Inertia(mass, 0.5 * own * along, mass * own**2 / 12.0 * across)


def parts_of(length: float, count: int) -> list[Part]:
    """Return the rigid parts of a link with springs in the middles of `count` equal lengths: one more than these."""
    cuts = (np.arange(count) + 0.5) * length / count
    return [Part(*ends) for ends in zip([0.0, *cuts], [*cuts, length], strict=True)]


def stiffen_robot(robot: Robot, beams: Mapping[str, Beam]) -> Robot:
    """Return a robot whose links have the masses of beams along them, and do not bend."""
    links = moving_links(robot.model)
    rods = [
        (joint, Part(0.0, length).rod(beam, length, end / length))
        for joint, beam in ((links[name], beam) for name, beam in beams.items())
        for end in [span(robot.model, joint, robot.flange)]
        for length in [float(np.linalg.norm(end))]
    ]

    def loaded(model: RobotModel, joints: slice, _: bool) -> RobotModel:
        own = model.copy()
        for joint, rod in rods:
            if joints.start < joint <= joints.stop:
                own.pin_model.appendBodyToJoint(joint - joints.start, rod, pin.SE3.Identity())
        own._data = own.pin_model.createData()
        return own

    return with_models(robot, loaded)
