"""A further kind in each registry, made as CONTRIBUTING says: a module, a YAML file, a line of the registry.

Each kind differs visibly from the default kind of its group. Some have a config derived from that of the default kind.
"""

import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import Any, Literal, NamedTuple

import numpy as np
import pinocchio as pin
import yaml
from pydantic import create_model

from runner.base.arrays import FloatArray
from runner.controllers import CONTROLLERS
from runner.controllers.controller import Controller, Loop
from runner.environments import ENVIRONMENTS, Environment
from runner.environments.wall import Wall, WallConfig
from runner.plants import PLANTS
from runner.plants.plant import Plant
from runner.plugins.registry import Kinds
from runner.robots.mismatch import MISMATCHES, MismatchConfig, scale_model
from runner.robots.model import RobotModel
from runner.robots.robot import Robot, with_models
from runner.schema.model import StrictModel
from runner.sensing import ENDPOINT_SENSORS, JOINT_TORQUE_SENSORS, NOISES, WRIST_SENSORS
from runner.sensing.encoders import NoiseConfig
from runner.sensing.endpoint import EndpointSensorConfig
from runner.sensing.joint_torque import JointTorqueConfig
from runner.trajectories import TRAJECTORIES
from runner.trajectories.motion import quintic_motion


class MadeUp(NamedTuple):
    """A made-up kind.

    Attributes:
        kinds: Registry.
        name: Name of the kind, and of its option.
        keys: Its own keys with their values.
        members: Members of its module without CONFIG.
        derived: Model and option of the config that its own is derived from.
    """

    kinds: Kinds
    name: str
    keys: Mapping[str, Any]
    members: Mapping[str, Any]
    derived: tuple[type[StrictModel], str] = (StrictModel, "")

    @property
    def option(self) -> str:
        """The override that chooses it."""
        return f"{self.kinds.group}={self.name}"

    def module(self) -> ModuleType:
        """Return its module."""
        made = ModuleType(f"runner.made_up.{self.name}")
        fields: dict[str, Any] = {key: (type(value), ...) for key, value in self.keys.items()}
        model = create_model("Config", __base__=self.derived[0], kind=(Literal[self.name], ...), **fields)
        vars(made).update(self.members, CONFIG=model)
        return made

    def text(self) -> str:
        """Return its YAML file."""
        defaults = {"defaults": [self.derived[1], "_self_"]} if self.derived[1] else {}
        return f"# Made up\n{yaml.safe_dump({**defaults, 'kind': self.name, **self.keys}, sort_keys=False)}"


class _Hysteresis:
    def __init__(self, width: float) -> None:
        self._half, self._held = 0.5 * width, None

    def measure(self, tick: int, q: FloatArray, dq: FloatArray) -> tuple[FloatArray, FloatArray]:
        self._held = q.copy() if self._held is None else np.clip(self._held, q - self._half, q + self._half)
        return self._held.copy(), dq


class _Shifted:
    def __init__(self, shift: float) -> None:
        self._shift = shift

    def measure(self, tick: int, q: FloatArray, dq: FloatArray) -> tuple[FloatArray, FloatArray]:
        return q + self._shift, dq


class _Gained:
    """A sensor whose reading is proportional to the truth."""

    def __init__(self, config: Any, *_: object) -> None:
        self._gain = config.gain

    def read(self, tick: int, truth: FloatArray) -> FloatArray:
        return self._gain * truth


class _Offset:
    """A tip sensor with a constant error."""

    def __init__(self, config: Any, *_: object) -> None:
        self._offset = config.offset

    def measure(self, number: int, tip: FloatArray) -> FloatArray:
        return np.array([tip[0] + self._offset, tip[1]])


def _scaled(config: Any, robot: Robot, generator: np.random.Generator) -> Robot:
    def change(model: RobotModel, joints: object, bears_payload: object) -> RobotModel:
        ones = np.ones(model.nq)
        return scale_model(model, config.factor * ones, ones, np.ones(model.nq + 1))

    return with_models(robot, change)


class _Spring(Environment):
    def __init__(self, config: Any) -> None:
        self._stiffness, self._start = config.stiffness, np.zeros(3)

    def reset(self, tip: FloatArray) -> None:
        self._start = tip - 0.01

    def wrench(self, time: float, tip: FloatArray, velocity: FloatArray) -> FloatArray:
        return np.concatenate([self._stiffness * (self._start - tip), np.zeros(3)])


class _StickyWall(Wall):
    def wrench(self, time: float, tip: FloatArray, velocity: FloatArray) -> FloatArray:
        found = super().wrench(time, tip, velocity)
        found[:3] -= self.config.pull * self.normal
        return found


class _SoftPd(Controller):
    def __init__(self, robot: Robot, stiffness: float) -> None:
        self._robot, self._stiffness = robot, stiffness

    def torque(self, time: float, q: FloatArray, dq: FloatArray, reference: object) -> FloatArray:
        return self._robot.model.gravity_torque(q) + self._stiffness * (self._robot.home - q) - dq

    def reset(self) -> None:
        """Do nothing: it has no state."""


def _soft_pd(config: Any, robot: Robot) -> tuple[Loop, ...]:
    law = _SoftPd(robot, config.stiffness)
    return (Loop(robot.stage_names[-1], slice(0, robot.model.nq), config.period, law),)


class _Euler(Plant):
    def __init__(self, config: Any, robot: Robot, step: float, steps: int) -> None:
        self._pin, self._data = robot.model.separate()
        self._step, self._steps, self._lag = step, steps, config.lag
        self.q, self.dq = np.zeros(robot.model.nq), np.zeros(robot.model.nq)

    def reset(self, q: FloatArray, dq: FloatArray) -> None:
        self.q[:], self.dq[:] = q, dq

    def set_gravity(self, gravity: FloatArray) -> None:
        self._pin.gravity.linear = gravity

    def advance(self, tau: FloatArray) -> None:
        for _ in range(self._steps):
            before = self.dq.copy()
            self.dq += self._step * pin.aba(self._pin, self._data, self.q, self.dq, tau)
            self.q += self._step * (self._lag * before + (1.0 - self._lag) * self.dq)

    def close(self) -> None:
        """Do nothing: it holds nothing."""


KINDS = (
    MadeUp(NOISES, "hysteresis", {"width": 0.01}, {"build": lambda config, *_: _Hysteresis(config.width)}),
    MadeUp(
        NOISES, "shifted", {"shift": 0.01}, {"build": lambda config, *_: _Shifted(config.shift)}, (NoiseConfig, "none")
    ),
    MadeUp(WRIST_SENSORS, "doubled", {"gain": 2.0}, {"build": _Gained}),
    MadeUp(ENDPOINT_SENSORS, "offset", {"offset": 0.01}, {"build": _Offset}, (EndpointSensorConfig, "none")),
    MadeUp(JOINT_TORQUE_SENSORS, "weak", {"gain": 0.8}, {"build": _Gained}, (JointTorqueConfig, "ideal")),
    MadeUp(MISMATCHES, "heavier", {"factor": 1.5}, {"build": _scaled}),
    MadeUp(MISMATCHES, "lighter", {"factor": 0.5}, {"build": _scaled}, (MismatchConfig, "none")),
    MadeUp(ENVIRONMENTS, "spring", {"stiffness": 300.0}, {"build": _Spring}),
    MadeUp(
        ENVIRONMENTS, "sticky_wall", {"pull": 4.0},
        {"build": _StickyWall}, (WallConfig, "wall"),
    ),
    MadeUp(CONTROLLERS, "soft_pd", {"period": 0.002, "stiffness": 40.0}, {"build": _soft_pd}),
    MadeUp(
        TRAJECTORIES, "swing", {"duration": 0.4, "width": 0.05},
        {"joint_motion": lambda config, robot: quintic_motion(robot.home, robot.home + config.width, config.duration)},
    ),
    MadeUp(PLANTS, "euler", {"step": 0.001, "lag": 0.5}, {"build": _Euler}),
)  # fmt: skip


@contextmanager
def made_up_kinds(folder: Path) -> Iterator[Path]:
    """Add the made-up kinds to the registries; their options are written to a folder, which is returned.

    Raises:
        ValueError: if the runner has a kind of such a name.
    """
    for kind in KINDS:
        if kind.name in kind.kinds._modules:
            raise ValueError(f"{kind.option}: the runner has this kind; rename the one in {Path(__file__).name}")
        path, module = folder / kind.kinds.group / f"{kind.name}.yaml", kind.module()
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(kind.text())
        sys.modules[module.__name__], kind.kinds._modules[kind.name] = module, module.__name__
    try:
        yield folder
    finally:
        for kind in KINDS:
            del sys.modules[kind.kinds._modules.pop(kind.name)]
