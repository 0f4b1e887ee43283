"""Joint armature (reflected inertia of motors and gears): one value, one for each joint, or a named set."""

import xml.etree.ElementTree as ET
from collections.abc import Sequence
from pathlib import Path

from pydantic import NonNegativeFloat

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError, nearest
from runner.robots.inertials import read_sets
from runner.robots.robot import Robot, with_models
from runner.robots.tree import UrdfTree
from runner.schema.model import StrictModel
from runner.schema.per_joint import expand


class _ArmatureSet(StrictModel):
    source: str
    joints: dict[str, NonNegativeFloat]  # kg m^2, after the gear; kg where a joint slides


def armature_file(urdf: Path) -> Path:
    """Return the file of a robot's sets of armatures: `arm.armature.yaml` beside `arm.urdf`."""
    return urdf.with_suffix(".armature.yaml")


def armature_by_joint(tree: UrdfTree, path: Path, given: float | Sequence[float] | str) -> dict[str, float]:
    """Return the armature of each joint that moves, in kg m^2; kg where it slides.

    Args:
        tree: The arm.
        path: Its file.
        given: One value for all joints, a list with one for each from the base outwards, or the name of a set.

    Raises:
        ConfigError: for a list of another length, a set that there is not, one that cannot be read, or one that names a
            joint that the arm does not have.
    """
    joints = tree.chain
    if isinstance(given, str):
        return _of_set(tree, path, given)
    each = expand("robot.armature", float(given) if isinstance(given, int | float) else list(given), joints)
    return dict(zip(joints, each, strict=True))


def write_armature(tree: UrdfTree, values: dict[str, float]) -> None:
    """Write the armature of joints into an arm: `<dynamics armature="...">`, which RobotModel reads; 0 is not written.

    What the file itself says there is taken out.

    Args:
        tree: The arm, changed in place.
        values: By joint, in kg m^2.
    """
    for name, joint in tree.joints.items():
        dynamics = joint.find("dynamics")
        if dynamics is not None:
            dynamics.attrib.pop("armature", None)
        if values.get(name, 0.0):
            if dynamics is None:  # readers of URDFs demand these two
                dynamics = ET.SubElement(joint, "dynamics", damping="0.0", friction="0.0")
            dynamics.set("armature", repr(values[name]))


def with_armature(robot: Robot, armature: FloatArray) -> Robot:
    """Return a robot with other armatures, shape (nq,), in kg m^2, in its models; its URDF's text stays.

    With those of springy motors it is the limit of flexible joints with stiff springs, M + diag(B).
    """
    return with_models(robot, lambda model, joints, _: model.with_armature(armature[joints]))


def _of_set(tree: UrdfTree, path: Path, name: str) -> dict[str, float]:
    sets = read_sets("robot.armature", armature_file(path), _ArmatureSet)
    if name not in sets:
        there = f"sets: {', '.join(sets)}" if sets else f"there is no {armature_file(path).name}"
        raise ConfigError(
            [
                f"robot.armature: no set '{name}'{nearest(name, sets)}; {there}. Allowed: a number of 0 or more, in "
                "kg m^2, a list with one for each joint, or the name of a set"
            ]
        )
    values, joints = sets[name].joints, tree.chain
    strange = [joint for joint in values if joint not in joints]
    if strange:
        raise ConfigError(
            f"robot.armature: set '{name}' names the joint '{joint}': {tree.no_joint(joint)}" for joint in strange
        )
    return {joint: values.get(joint, 0.0) for joint in joints}
