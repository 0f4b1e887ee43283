"""Parameters of a run: keys of its config, and masses and lengths of its links."""

import copy
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial, reduce
from itertools import groupby, takewhile
from operator import getitem
from typing import Any

import numpy as np

from runner.config.in_si import Place, leaves, put
from runner.config.key_units import units_at
from runner.config.run import RunConfig
from runner.controllers import CONTROLLERS
from runner.robots.armature import with_armature
from runner.robots.mismatch import scaled
from runner.robots.model import RobotModel
from runner.robots.robot import Robot, with_models
from runner.store import simulated_part
from runner.trajectories.joint_motion import TipOfJoints

# The words of a key that give it a group, the first of them which it has.
_WORDS: Mapping[str, Sequence[str]] = {
    "gains": ("controller", "disturbance_observer", "notch"), "masses": ("masses", "tool"), "armature": ("armature",),
    "lengths": (), "payload": ("payload",), "friction": ("friction",), "gravity": ("gravity",),
    "limits": ("torque_limits",), "noise": ("noise",), "mismatch": ("mismatch",), "others": (),
}  # fmt: skip
GROUPS = tuple(_WORDS)
_SMALL = 1e-6  # in place of 0, to see if it acts


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
        numbers: Its numbers by their places in the config.
        with_numbers: Returns the run's checked config with other numbers at some of these places.
    """

    name: str
    group: str
    numbers: Mapping[Place, float]
    with_numbers: Callable[[Mapping[Place, float]], RunConfig]

    def moved(self, share: float) -> RunConfig:
        """Return the config with each number changed by another share, as of a list only the direction may act."""
        shares = enumerate(self.numbers.items(), start=1)
        return self.with_numbers({place: number * (1.0 + n * share) or _SMALL for n, (place, number) in shares})

    def parameters(self, config: RunConfig, moved: RunConfig) -> Iterator[Parameter]:
        """Yield a parameter for each number.

        Args:
            config: The run's checked config.
            moved: The one in which the key has changed.
        """
        before, after = _numbers(config), _numbers(moved)
        changed = dict.fromkeys(_name(place) for place in before if before[place] != after.get(place))
        moves = [name for name in changed if name != self.name]
        for place, number in self.numbers.items():
            name = self.name + "".join(f"[{word}]" for word in place if isinstance(word, int))
            unit = next(iter(units_at(config.resolved, place).at(place)), "1")

            def with_value(value: float, place: Place = place) -> RunConfig:
                return self.with_numbers({place: value})

            yield Parameter(name, self.group, number, unit, with_value, moves)


def find_keys(config: RunConfig, groups: Sequence[str], recomposed: Callable[[str], RunConfig]) -> Iterator[Key]:
    """Yield the keys of a run's config that hold numbers, in some groups.

    Args:
        config: The run's checked config.
        groups: Some of GROUPS.
        recomposed: Returns the checked config with a further override.
    """
    for name, found in groupby(_numbers(config).items(), lambda number: _name(number[0])):
        group = next((group for word in name.split(".") for group, words in _WORDS.items() if word in words), "others")
        if group in groups:
            yield Key(name, group, dict(found), partial(_with_numbers, config, name, recomposed))


def _numbers(config: RunConfig) -> dict[Place, float]:
    """Return the numbers of a config by their places."""
    own = simulated_part(config.resolved)
    own["robot"] = own.pop("robot")  # last: of two keys with one effect the first has the row
    numbers = ((place, value) for place, value in leaves(own) if isinstance(value, int | float))
    return {place: float(value) for place, value in numbers if not isinstance(value, bool) and np.isfinite(value)}


def _name(place: Place) -> str:
    return ".".join(str(word) for word in takewhile(lambda word: isinstance(word, str), place))


def _with_numbers(
    config: RunConfig, name: str, recomposed: Callable[[str], RunConfig], numbers: Mapping[Place, float]
) -> RunConfig:
    changed: Any = copy.deepcopy(dict(config.resolved))
    for place, number in numbers.items():
        put(changed, place, number)
    return recomposed(f"{name}={json.dumps(reduce(getitem, name.split('.'), changed))}")


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
