"""Parameters of a run: keys of its config, and masses, armature and lengths of its links."""

import copy
import json
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import partial, reduce
from itertools import groupby, takewhile
from operator import getitem
from typing import Any

import numpy as np

from runner.assembly.run_config import RunConfig
from runner.base.dotted_keys import Place, leaves, put
from runner.config.compose.units import unit_at
from runner.robots.mismatch import scale_model
from runner.robots.model import RobotModel
from runner.robots.robot import Robot, with_armature, with_models
from runner.store import simulated_part

# Key segments of each group; the first known segment of a key determines its group.
_WORDS: Mapping[str, Sequence[str]] = {
    "gains": ("controller", "disturbance_observer", "notch"), "masses": ("masses", "tool"), "armature": ("armature",),
    "lengths": (), "payload": ("payload",), "friction": ("friction",), "gravity": ("gravity",),
    "limits": ("torque_limits",), "noise": ("noise",), "mismatch": ("mismatch",), "others": (),
}  # fmt: skip
GROUPS = tuple(_WORDS)
_SMALL = 1e-6  # replaces 0 in the test whether a key has an effect


@dataclass(frozen=True)
class Parameter:
    """Parameter of a run.

    Attributes:
        name: Dotted key of the config; or armature.JOINT, mass.JOINT or length.JOINT, for the link moved by a joint.
        group: One of GROUPS.
        value: Value of the parameter.
        unit: Unit of the value.
        with_value: Function of another value; returns the config of the run with it.
        followers: Other keys of the config that change with the parameter.
    """

    name: str
    group: str
    value: float
    unit: str
    with_value: Callable[[float], RunConfig]
    followers: Sequence[str] = ()


@dataclass(frozen=True)
class NumericKey:
    """Key of a config whose value is a number or a list of numbers.

    Attributes:
        name: Dotted name of the key.
        group: One of GROUPS.
        numbers: Numbers of the key by their paths in the config.
        config: Checked config of the run.
        recomposed: Function of an additional override; returns the checked config.
    """

    name: str
    group: str
    numbers: Mapping[Place, float]
    config: RunConfig
    recomposed: Callable[[str], RunConfig]

    def changed(self, share: float) -> RunConfig:
        """Return the config with each number changed by a different fraction: a run may depend on ratios in a list."""
        shares = enumerate(self.numbers.items(), start=1)
        return self._with({place: number * (1.0 + n * share) or _SMALL for n, (place, number) in shares})

    def parameters(self, changed: RunConfig) -> Iterator[Parameter]:
        """Yield a parameter for each number, given the config with changed numbers."""
        before, after = _numbers(self.config), _numbers(changed)
        names = dict.fromkeys(_name(place) for place in before if before[place] != after.get(place))
        followers = [name for name in names if name != self.name]
        for place, number in self.numbers.items():
            name = self.name + "".join(f"[{word}]" for word in place if isinstance(word, int))
            unit = next(iter(unit_at(self.config.resolved, place).at(place)), "1")
            yield Parameter(name, self.group, number, unit, partial(self._with_number, place), followers)

    def _with_number(self, place: Place, number: float) -> RunConfig:
        return self._with({place: number})

    def _with(self, numbers: Mapping[Place, float]) -> RunConfig:
        changed: Any = copy.deepcopy(dict(self.config.resolved))
        for place, number in numbers.items():
            put(changed, place, number)
        return self.recomposed(f"{self.name}={json.dumps(reduce(getitem, self.name.split('.'), changed))}")


def find_keys(config: RunConfig, groups: Sequence[str], recomposed: Callable[[str], RunConfig]) -> Iterator[NumericKey]:
    """Yield the numeric keys of the config of a run.

    Args:
        config: Checked config of the run.
        groups: Groups of the keys, from GROUPS.
        recomposed: Function of an additional override; returns the checked config.
    """
    for name, found in groupby(_numbers(config).items(), lambda number: _name(number[0])):
        group = next((group for word in name.split(".") for group, words in _WORDS.items() if word in words), "others")
        if group in groups:
            yield NumericKey(name, group, dict(found), config, recomposed)


def _numbers(config: RunConfig) -> dict[Place, float]:
    own = simulated_part(config.resolved)
    own["robot"] = own.pop("robot")  # last, because the first of two keys with the same effect is listed
    numbers = ((place, value) for place, value in leaves(own) if isinstance(value, int | float))
    return {place: float(value) for place, value in numbers if not isinstance(value, bool) and np.isfinite(value)}


def _name(place: Place) -> str:
    return ".".join(str(word) for word in takewhile(lambda word: isinstance(word, str), place))


def find_links(config: RunConfig, groups: Sequence[str]) -> Iterator[Parameter]:
    """Yield the nonzero masses, armatures and lengths of an arm that are in the given groups."""
    model = config.arm.model
    for joint, name in enumerate(model.joint_names, start=1):
        mass, length = float(model.pin_model.inertias[joint].mass), _length(model, joint)
        armature, unit = float(model.armature[joint - 1]), "kg" if model.prismatic[joint - 1] else "kg m^2"
        found = (
            Parameter(f"mass.{name}", "masses", mass, "kg", partial(_with_scaled, config, 0, joint, mass)),
            Parameter(f"armature.{name}", "armature", armature, unit, partial(_with_armature, config, joint)),
            Parameter(f"length.{name}", "lengths", length, "m", partial(_with_scaled, config, 1, joint, length)),
        )
        yield from (parameter for parameter in found if parameter.group in groups and parameter.value > 0.0)


def _length(model: RobotModel, joint: int) -> float:
    """Return the distance from a joint to the next one, or to the tip, in m."""
    arm = model.pin_model
    for after in range(joint + 1, arm.njoints):
        if arm.parents[after] == joint:
            return float(np.linalg.norm(arm.jointPlacements[after].translation))
    return float(np.linalg.norm(arm.frames[model.tip_frame].placement.translation))


def _with_scaled(config: RunConfig, row: int, joint: int, own: float, value: float) -> RunConfig:
    """Return a config with another mass (row 0) or length (row 1) of a link."""
    factors = np.ones((2, config.arm.model.nq + 1))  # of masses and lengths, for the base and each link
    factors[row, joint] = value / own

    def change(model: RobotModel, joints: slice, _: bool) -> RobotModel:
        masses, lengths = factors[:, joints.start : joints.stop + 1]
        return scale_model(model, masses[1:], np.ones(model.nq), lengths)

    return _with_robot(config, with_models(config.arm, change))


def _with_armature(config: RunConfig, joint: int, value: float) -> RunConfig:
    armature = config.arm.model.armature
    armature[joint - 1] = value
    return _with_robot(config, with_armature(config.arm, armature))


def _with_robot(config: RunConfig, changed: Robot) -> RunConfig:
    """Return a config with another arm in the plant and in the controllers."""
    return replace(config, arm=changed, loops=config.loops_for(changed))
