"""Parameters of a run: keys of its config, and masses and lengths of its links."""

import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial
from typing import Any

import numpy as np

from runner.config.key_units import units_at
from runner.config.run import RunConfig
from runner.controllers import CONTROLLERS
from runner.robots.armature import with_armature
from runner.robots.mismatch import scaled
from runner.robots.model import RobotModel
from runner.robots.robot import Robot, with_models
from runner.store import simulated_part
from runner.trajectories.joint_motion import TipOfJoints

GROUPS = (
    "gains", "masses", "armature", "lengths", "payload", "friction", "gravity", "limits", "noise", "mismatch", "others",
)  # fmt: skip
# The group of a key is that of the first of its words which is here; "others" where none is.
_GROUP_OF = {
    "controller": "gains", "disturbance_observer": "gains", "notch": "gains", "masses": "masses", "tool": "masses",
    "armature": "armature", "payload": "payload", "friction": "friction", "gravity": "gravity",
    "torque_limits": "limits", "noise": "noise", "mismatch": "mismatch",
}  # fmt: skip
_SMALL = 1e-6  # in place of 0, to see if it acts

Recomposed = Callable[..., RunConfig]


@dataclass(frozen=True)
class Parameter:
    """A number on which a run depends.

    Attributes:
        name: Dotted key of the config; or armature.JOINT, mass.JOINT or length.JOINT of the link that a joint moves.
        group: One of GROUPS.
        value: Its value.
        unit: Its unit.
        with_value: Returns the run's config with another value.
        moves: Other keys of the config that change with it.
    """

    name: str
    group: str
    value: float
    unit: str
    with_value: Callable[[float], RunConfig]
    moves: Sequence[str] = ()


@dataclass(frozen=True)
class Key:
    """A key of a config that holds a number, or a list of numbers.

    Attributes:
        name: Its dotted name.
        group: One of GROUPS.
        value: What it holds.
        recomposed: Returns the run's checked config with further overrides.
    """

    name: str
    group: str
    value: Any
    recomposed: Recomposed

    def moved(self, share: float) -> RunConfig:
        """Return the config with each number of the key changed by another share; those that are 0 become small ones.

        By one share alike, the direction that a list may be would not change.
        """
        return self._with(lambda place, number: number * (1.0 + share * (1 + sum(place))) or _SMALL)

    @property
    def is_set(self) -> bool:
        """Whether one of the numbers is not 0."""
        return any(number for _, number in _numbers(self.value))

    def parameters(self, config: RunConfig, moved: RunConfig) -> Iterator[Parameter]:
        """Yield a parameter for each number of the key.

        Args:
            config: The run's checked config.
            moved: The one in which the key has changed.
        """
        before, after = (dict(_keys(simulated_part(one.resolved))) for one in (config, moved))
        moves = [name for name in before if before[name] != after.get(name) and name != self.name]
        for place, number in _numbers(self.value):
            name = self.name + "".join(f"[{index}]" for index in place)
            path: tuple[str | int, ...] = (*self.name.split("."), *place)
            unit = next(iter(units_at(config.resolved, path).at(path)), "1")
            yield Parameter(name, self.group, float(number), unit, partial(self._with_number, place), moves)

    def _with_number(self, place: tuple[int, ...], new: float) -> RunConfig:
        return self._with(lambda own, number: new if own == place else number)

    def _with(self, change: Callable[[tuple[int, ...], float], float]) -> RunConfig:
        return self.recomposed(f"{self.name}={json.dumps(_mapped(self.value, change))}")


def find_keys(config: RunConfig, groups: Sequence[str], recomposed: Recomposed) -> Iterator[Key]:
    """Yield the keys of a run's config that hold numbers, in some groups.

    Args:
        config: The run's checked config.
        groups: Some of GROUPS.
        recomposed: Returns the checked config with further overrides.
    """
    own = simulated_part(config.resolved)
    robot = {"robot": own.pop("robot")}  # last: of two keys with one effect the first has the row
    for name, value in (*_keys(own), *_keys(robot)):
        group = next((_GROUP_OF[word] for word in name.split(".") if word in _GROUP_OF), "others")
        if group in groups:
            yield Key(name, group, value, recomposed)


def _keys(node: Mapping[str, Any], path: str = "") -> Iterator[tuple[str, Any]]:
    """Yield the dotted name and value of each key with a number, or with a list that has one."""
    for name, value in node.items():
        if isinstance(value, Mapping):
            yield from _keys(value, f"{path}{name}.")
        elif any(_numbers(value)):
            yield f"{path}{name}", value


def _numbers(value: Any, place: tuple[int, ...] = ()) -> Iterator[tuple[tuple[int, ...], float]]:
    """Yield each number of a value with its place in nested lists."""
    if isinstance(value, list):
        for index, inner in enumerate(value):
            yield from _numbers(inner, (*place, index))
    elif isinstance(value, (int, float)) and not isinstance(value, bool) and np.isfinite(value):
        yield place, value


def _mapped(value: Any, change: Callable[[tuple[int, ...], float], float], place: tuple[int, ...] = ()) -> Any:
    """Return a value with its numbers changed, given their places and themselves."""
    if isinstance(value, list):
        return [_mapped(inner, change, (*place, index)) for index, inner in enumerate(value)]
    return change(place, value) if any(_numbers(value)) else value


def find_links(config: RunConfig, groups: Sequence[str]) -> Iterator[Parameter]:
    """Yield the masses, armature and lengths of an arm, in some of GROUPS, that are not 0."""
    for group in ("masses", "armature", "lengths"):
        if group in groups:
            yield from _links(config, group)


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
                yield Parameter(f"length.{name}", group, length, "m", partial(_with_length, config, joint, length))


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
    loops = CONTROLLERS.build_for(config.controller, changed, isinstance(config.path, TipOfJoints))
    return replace(config, arm=changed, loops=loops)
