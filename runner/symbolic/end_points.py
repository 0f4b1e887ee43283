"""Symbolic end points of a robot's stages; see end_points of runner/robots/robot.py."""

from collections.abc import Callable
from typing import Any, NamedTuple

from runner.robots.robot import Robot, StageBase
from runner.symbolic.algebra import ArmAlgebra
from runner.symbolic.arm import ArmConstants, constants_of
from runner.symbolic.expression import Value
from runner.symbolic.vectors import Matrix, Vector, add, product


class PointScalars(NamedTuple):
    """Constants of an end point.

    Attributes:
        arm: The arm that ends at the point.
        first: Index of the arm's first joint.
        rotation: Rotation of the arm's base, shape (3, 3), if the base is at the previous end point and does not
            rotate; else None.
    """

    arm: ArmConstants
    first: int
    rotation: Matrix | None


def point_scalars(robot: Robot, ignore_base_rotation: bool, number: Callable[[float], Any]) -> tuple[PointScalars, ...]:
    """Return the constants of all stages' end points as scalars."""
    riding, still = robot.stages[1:], [0.0] * 3
    if not (riding and ignore_base_rotation):
        frames = [*(str(stage.base_frame) for stage in riding), None]
        return tuple(PointScalars(constants_of(robot.model, number, still, frame), 0, None) for frame in frames)
    found = [PointScalars(constants_of(robot.model, number, still, str(riding[0].base_frame)), 0, None)]
    for index, stage in enumerate(riding, start=1):
        rotation = StageBase(robot, index, ignore_base_rotation=True).rotation.tolist()
        turned = [[number(value) for value in row] for row in rotation]
        found.append(PointScalars(constants_of(stage.model, number, still), stage.joints.start, turned))
    return tuple(found)


def expressed_points(points: tuple[PointScalars, ...], q: Vector) -> list[Value]:
    """Return the end points in the robot's base frame from the joint positions, three numbers for each stage."""
    found: list[Vector] = []
    for point in points:
        own = q[point.first : point.first + len(point.arm.bodies)]
        x = ArmAlgebra(point.arm).tip(own, [0.0] * len(own))[0]
        found.append(x if point.rotation is None else add(found[-1], product(point.rotation, x)))
    return [value for point in found for value in point]
