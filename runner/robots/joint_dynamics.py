"""Joint damping, friction and armature from a robot file, and fixed joints."""

import xml.etree.ElementTree as ET
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.lazy_modules import pin
from runner.base.sanitize import few
from runner.robots.elements import number, vector_text, wrong_places
from runner.robots.inertials import place_of
from runner.robots.tree import UrdfTree

_LONGEST = 300  # characters of a message about omitted content


@dataclass(frozen=True)
class FileDynamics:
    """Joint dynamics in the file of an arm, for joints from the base outwards; 0 if the file has no value.

    Attributes:
        file: Name of the file.
        damping: Viscous damping, shape (nq,), in N m s/rad; N s/m for prismatic joints.
        friction: Coulomb friction, shape (nq,), in N m; N for prismatic joints.
        armature: Reflected inertia of motors and gears, shape (nq,), in kg m^2; kg for prismatic joints.
        left_out: Messages about other content that affects the motion; see write_urdf.
    """

    file: str
    damping: FloatArray
    friction: FloatArray
    armature: FloatArray
    left_out: tuple[str, ...]

    def by_key(self) -> list[tuple[str, str, FloatArray]]:
        """Return the name, the config key and the values of each joint property."""
        return [
            ("damping", "robot.friction.viscous", self.damping),
            ("friction", "robot.friction.coulomb", self.friction),
            ("armature", "robot.armature", self.armature),
        ]


def dynamics_of(tree: UrdfTree, file: str, gravity: float) -> FileDynamics:
    """Return the joint dynamics in the file of an arm.

    A value that is negative or not a number counts as 0.

    Args:
        tree: The arm.
        file: Name of the file.
        gravity: Gravity of the run, in m/s^2; the same gravity in the file does not count as omitted.
    """
    said = [each for each in tree.robot.findall("left_out") if each.get("gravity") != repr(gravity)]
    elements = [tree.joints[name].find("dynamics") for name in tree.chain]
    values = [[number(element, key) for element in elements] for key in ("damping", "friction", "armature")]
    damping, friction, armature = np.maximum(np.nan_to_num(values, posinf=0.0), 0.0)
    left_out = tuple(each.get("text", "")[:_LONGEST] for each in said)
    return FileDynamics(file, damping, friction, armature, left_out)


def by_value(values: FloatArray, names: Sequence[str]) -> str:
    """Return the nonzero values with their names as a string, in SI units, grouped by value."""
    told: dict[str, list[str]] = {}
    for value, name in zip(values.tolist(), names, strict=True):
        if value:
            told.setdefault(f"{value:g}", []).append(name)
    return ", ".join(f"{value} ({few(named)})" for value, named in told.items())


def rest_position(tree: UrdfTree, name: str, followers: tuple[str, ...] = ()) -> float:
    """Return the position at which a joint can be fixed, in rad; m for a prismatic joint.

    It is the joint's position in the file's keyframe `home`, or 0, clipped to its limits. A joint that mimics another
    one follows it.

    Args:
        tree: The arm.
        name: Name of the joint.
        followers: Joints that follow this one, to end a circle of them.
    """
    joint = tree.joints[name]
    mimic, limit = joint.find("mimic"), joint.find("limit")
    leader = "" if mimic is None else mimic.get("joint", "")
    if leader in tree.joints and leader not in (name, *followers) and name not in tree.home:
        factor, offset = (number(mimic, key) for key in ("multiplier", "offset"))
        led = rest_position(tree, leader, (*followers, name))
        return (1.0 if np.isnan(factor) else factor) * led + (0.0 if np.isnan(offset) else offset)
    position = tree.home.get(name, 0.0)
    lower, upper = number(limit, "lower"), number(limit, "upper")
    if joint.get("type") in ("revolute", "prismatic") and lower <= upper:
        position = float(np.clip(position, lower, upper))
    return position


def hold(tree: UrdfTree, name: str, position: float) -> None:
    """Fix a joint at a position, in rad; m for a prismatic joint."""
    joint = tree.joints[name]
    if position and not any(wrong_places(joint)):
        _move(joint, position)
    joint.set("type", "fixed")
    for tag in ("mimic", "limit", "dynamics", "axis"):
        for element in joint.findall(tag):
            joint.remove(element)


def _move(joint: ET.Element, position: float) -> None:
    """Move the origin of a joint by the motion of the joint to a position."""
    axis, origin = joint.find("axis"), joint.find("origin")
    along = np.array(("1 0 0" if axis is None else axis.get("xyz", "1 0 0")).split(), dtype=float)
    step = along / np.linalg.norm(along) * position
    prismatic = joint.get("type") == "prismatic"
    place = place_of(joint) * (pin.SE3(np.eye(3), step) if prismatic else pin.SE3(pin.exp3(step), np.zeros(3)))
    if origin is None:
        origin = ET.SubElement(joint, "origin")
    for key, values in (("xyz", place.translation), ("rpy", pin.rpy.matrixToRpy(place.rotation))):
        origin.set(key, vector_text(values))
