"""Parameters of a run: keys of its config, and masses and lengths of its links."""

import copy
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from runner.config.run import RunConfig
from runner.controllers import CONTROLLERS
from runner.robots.armature import with_armature
from runner.robots.mismatch import scaled
from runner.robots.model import RobotModel
from runner.robots.robot import Robot, with_models

GROUPS = ("gains", "masses", "armature", "lengths", "payload", "friction", "gravity", "limits", "noise", "mismatch")
# Of each group of keys: where they stand, and those below that no derivative is asked by.
_KEYS: Mapping[str, tuple[str, tuple[str, ...]]] = {
    "gains": ("controller", ("period", "reach", "max_tip_speed")),
    "payload": ("robot.payload.mass", ()),
    "friction": ("plant.friction", ()),
    "gravity": ("gravity", ()),
    "limits": ("torque_limits.max", ()),
    "noise": ("noise", ("resolution",)),
    "mismatch": ("mismatch", ("spread",)),
}
_UNITS = {
    "natural_frequency": "rad/s", "null_space_frequency": "rad/s", "integral_gain": "1/s^3", "viscous": "N m s/rad",
    "coulomb": "N m", "gravity": "m/s^2", "max": "N m", "position": "rad", "bias": "rad", "torques": "N m",
    "mass": "kg",
}  # fmt: skip


@dataclass(frozen=True)
class Parameter:
    """A number on which a run depends.

    Attributes:
        name: Its name: a dotted key of the config, armature.JOINT, or mass.JOINT or length.JOINT of the link that a
            joint moves.
        group: One of GROUPS.
        value: Its value.
        unit: Its unit.
        with_value: Returns the run's config with another value.
        holds_law: Whether the numbers that the law has drawn from the arm's lengths are held.
    """

    name: str
    group: str
    value: float
    unit: str
    with_value: Callable[[float], RunConfig]
    holds_law: bool = False


def find_parameters(config: RunConfig, groups: Sequence[str], validated: Callable[[Any], RunConfig]) -> list[Parameter]:
    """Return the parameters of a run, in some groups, that are not zero.

    Args:
        config: The run's checked config.
        groups: Some of GROUPS.
        validated: Checks a resolved config.
    """
    found: list[Parameter] = []
    for group in groups:
        if group in _KEYS:
            found += _keys(config, group, validated)
        else:
            found += _links(config, group)
    return found


def _keys(config: RunConfig, group: str, validated: Callable[[Any], RunConfig]) -> Iterator[Parameter]:
    root, left_out = _KEYS[group]
    node: Any = config.resolved
    for word in root.split("."):
        node = node.get(word) if isinstance(node, Mapping) else None
    for path, value in _numbers(node, tuple(root.split("."))):
        if value != 0.0 and np.isfinite(value) and not set(path) & set(left_out):
            unit = next((_UNITS[word] for word in reversed(path) if word in _UNITS and group != "mismatch"), "1")
            name = "".join(f"[{word}]" if isinstance(word, int) else f".{word}" for word in path)[1:]
            with_value = partial(_changed, config, path, validated)
            yield Parameter(name, group, float(value), unit, with_value, "length" in path)


def _numbers(node: Any, path: tuple[Any, ...]) -> Iterator[tuple[tuple[Any, ...], float]]:
    if isinstance(node, Mapping):
        for key, value in node.items():
            yield from _numbers(value, (*path, key))
    elif isinstance(node, list):
        for index, value in enumerate(node):
            yield from _numbers(value, (*path, index))
    elif isinstance(node, (int, float)) and not isinstance(node, bool):
        yield path, node


def _changed(
    config: RunConfig, path: tuple[Any, ...], validated: Callable[[Any], RunConfig], value: float
) -> RunConfig:
    resolved: Any = copy.deepcopy(dict(config.resolved))
    node = resolved
    for word in path[:-1]:
        node = node[word]
    node[path[-1]] = value
    # The desired motion is held, too.
    return replace(validated(resolved), path=config.path)


def _links(config: RunConfig, group: str) -> Iterator[Parameter]:
    model = config.arm.model
    for joint, name in enumerate(model.joint_names, start=1):
        if group == "masses":
            mass = float(model.pin_model.inertias[joint].mass)
            if mass > 0.0:
                yield Parameter(f"mass.{name}", group, mass, "kg", partial(_with_mass, config, joint, mass))
        elif group == "armature":
            unit, armature = "kg" if model.slides[joint - 1] else "kg m^2", float(model.armature[joint - 1])
            if armature > 0.0:
                yield Parameter(f"armature.{name}", group, armature, unit, partial(_with_armature, config, joint))
        else:
            length = _length(model, joint)
            if length > 0.0:
                with_length = partial(_with_length, config, joint, length)
                yield Parameter(f"length.{name}", group, length, "m", with_length, holds_law=True)


def _length(model: RobotModel, joint: int) -> float:
    """Return the way from a joint to the next one, or to the tip, in m."""
    arm = model.pin_model
    for after in range(joint + 1, arm.njoints):
        if arm.parents[after] == joint:
            return float(np.linalg.norm(arm.jointPlacements[after].translation))
    return float(np.linalg.norm(arm.frames[model.tip_frame].placement.translation))


def _with_mass(config: RunConfig, joint: int, mass: float, value: float) -> RunConfig:
    masses = np.ones(config.arm.model.nq)
    masses[joint - 1] = value / mass
    return _with_arm(config, masses, np.ones(len(masses) + 1))


def _with_armature(config: RunConfig, joint: int, value: float) -> RunConfig:
    armature = config.arm.model.armature
    armature[joint - 1] = value
    return _with_robot(config, with_armature(config.arm, armature))


def _with_length(config: RunConfig, joint: int, length: float, value: float) -> RunConfig:
    lengths = np.ones(config.arm.model.nq + 1)
    lengths[joint] = value / length
    return _with_arm(config, np.ones(len(lengths) - 1), lengths)


def _with_arm(config: RunConfig, masses: Any, lengths: Any) -> RunConfig:
    """Return a config with another arm; masses (nq,) and lengths (nq + 1,) are factors."""

    def change(model: RobotModel, joints: slice, _: bool) -> RobotModel:
        own = masses[joints]
        return scaled(model, own, np.ones(len(own)), lengths[joints.start : joints.stop + 1])

    return _with_robot(config, with_models(config.arm, change))


def _with_robot(config: RunConfig, changed: Robot) -> RunConfig:
    """Return a config with another arm, true and believed."""
    return replace(config, arm=changed, loops=CONTROLLERS.build(config.controller, changed))
