"""Inertia of motors and gears about joint axes: one value, one for each joint, or a named set of a file."""

from collections.abc import Sequence
from pathlib import Path

from pydantic import NonNegativeFloat

from runner.errors import ConfigError, nearest
from runner.registry import StrictModel
from runner.robots.inertials import read_sets
from runner.robots.tree import UrdfTree, moves
from runner.texts import quoted


class _RotorSet(StrictModel):
    source: str
    joints: dict[str, NonNegativeFloat]  # kg m^2, as the joint's link feels it


def rotor_file(urdf: Path) -> Path:
    """Return the file of a URDF's sets of rotor inertias: `arm.rotors.yaml` beside `arm.urdf`."""
    return urdf.with_suffix(".rotors.yaml")


def rotor_inertias(tree: UrdfTree, urdf: Path, given: float | Sequence[float] | str) -> dict[str, float]:
    """Return the rotor inertia of each joint that moves, in kg m^2.

    Args:
        tree: The arm.
        urdf: Its file.
        given: One value for all joints, a list with one for each from the base outwards, or the name of a set.

    Raises:
        ConfigError: for a list of another length, a set that there is not, one that cannot be read, or one that names a
            joint that the arm does not have.
    """
    ways = [[name for name in tree.way(end) if moves(tree.joints[name])] for end in tree.ends]
    joints = max(ways, key=len)  # of a serial arm all that move
    if isinstance(given, str):
        return _of_set(joints, urdf, given)
    if isinstance(given, int | float):
        return dict.fromkeys(joints, float(given))
    if len(given) != len(joints):
        raise ConfigError(
            [
                f"robot.rotor_inertia: {len(given)} values for {len(joints)} joints ({', '.join(joints)}); found "
                f"{quoted(list(given))}"
            ]
        )
    return dict(zip(joints, given, strict=True))


def _of_set(joints: Sequence[str], urdf: Path, name: str) -> dict[str, float]:
    path = rotor_file(urdf)
    sets = read_sets("robot.rotor_inertia", path, _RotorSet)
    if name not in sets:
        there = f"sets: {', '.join(sets)}" if sets else f"there is no {path.name}"
        raise ConfigError(
            [
                f"robot.rotor_inertia: no set '{name}'{nearest(name, sets)}; {there}. Allowed: a number of 0 or more, "
                "in kg m^2, a list with one for each joint, or the name of a set"
            ]
        )
    values = sets[name].joints
    strange = [joint for joint in values if joint not in joints]
    if strange:
        raise ConfigError(
            f"robot.rotor_inertia: set '{name}' names the joint '{joint}', which {urdf.name} does not have"
            f"{nearest(joint, joints)}; joints: {', '.join(joints)}"
            for joint in strange
        )
    return {joint: values.get(joint, 0.0) for joint in joints}
