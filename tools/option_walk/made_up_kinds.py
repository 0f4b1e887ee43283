"""A further kind in each registry, made as CONTRIBUTING says: a module, a YAML file, a line of the registry.

Each kind differs visibly from the default kind of its group. Some have a config derived from that of the default kind.
"""

import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import NamedTuple

from runner.controllers import CONTROLLERS
from runner.environments import ENVIRONMENTS
from runner.plants import PLANTS
from runner.plugins.registry import Kinds
from runner.robots.mismatch import MISMATCHES
from runner.sensing import JOINT_TORQUE_SENSORS, NOISES, WRIST_SENSORS
from runner.trajectories import TRAJECTORIES

_REGISTRIES: Mapping[str, Kinds] = {
    kinds.group: kinds
    for kinds in (
        NOISES, WRIST_SENSORS, JOINT_TORQUE_SENSORS, MISMATCHES, ENVIRONMENTS, CONTROLLERS, TRAJECTORIES, PLANTS
    )
}  # fmt: skip


class MadeUp(NamedTuple):
    """A made-up kind.

    Attributes:
        group: Config group.
        name: Name of the kind, and of its option.
        keys: Content of its YAML file.
        module: Source of its module.
    """

    group: str
    name: str
    keys: str
    module: str


_HEAD = """
from typing import Literal
import numpy as np
from runner.schema.model import StrictModel
"""
KINDS = (
    MadeUp("noise", "hysteresis", "width: 0.01\n", _HEAD + """
class CONFIG(StrictModel):
    kind: Literal["hysteresis"]
    width: float

class Encoders:
    def __init__(self, config):
        self.half, self.held = 0.5 * config.width, None
    def measure(self, tick, q, dq):
        self.held = q.copy() if self.held is None else np.clip(self.held, q - self.half, q + self.half)
        return self.held.copy(), dq

def build(config, joints, ticks, period, generator):
    return Encoders(config)
"""),
    MadeUp("noise", "shifted", "position: 0.0\ndistribution: none\nvelocity: exact\nshift: 0.01\n", _HEAD + """
from runner.sensing.encoders import NoiseConfig

class CONFIG(NoiseConfig):
    kind: Literal["shifted"]
    shift: float

class Encoders:
    def __init__(self, shift):
        self.shift = shift
    def measure(self, tick, q, dq):
        return q + self.shift, dq

def build(config, joints, ticks, period, generator):
    return Encoders(config.shift)
"""),
    MadeUp("wrist_sensor", "doubled", "gain: 2.0\n", _HEAD + """
class CONFIG(StrictModel):
    kind: Literal["doubled"]
    gain: float

class Sensor:
    def __init__(self, gain):
        self.gain = gain
    def read(self, tick, wrench):
        return self.gain * wrench

def build(config, ticks, period, generator):
    return Sensor(config.gain)
"""),
    MadeUp("joint_torque_sensor", "weak", "noise: 0.0\nbias: 0.0\ngain: 0.8\n", _HEAD + """
from runner.sensing.joint_torque import JointTorqueConfig

class CONFIG(JointTorqueConfig):
    kind: Literal["weak"]
    gain: float

class Sensors:
    def __init__(self, gain):
        self.gain = gain
    def read(self, tick, torque):
        return self.gain * torque

def build(config, joints, ticks, generator):
    return Sensors(config.gain)
"""),
    MadeUp("mismatch", "heavier", "factor: 1.5\n", _HEAD + """
from runner.robots.mismatch import scale_model
from runner.robots.robot import with_models

class CONFIG(StrictModel):
    kind: Literal["heavier"]
    factor: float

def build(config, robot, generator):
    def change(model, joints, bears_payload):
        ones = np.ones(model.nq)
        return scale_model(model, config.factor * ones, ones, np.ones(model.nq + 1))
    return with_models(robot, change)
"""),
    MadeUp("mismatch", "lighter", "mass: 1.0\ncentre_of_mass: 1.0\nlength: 1.0\ngravity: 1.0\npayload: 0.0\n"
           "spread: 0.0\nlink: {}\nfactor: 0.5\n", _HEAD + """
from runner.robots.mismatch import MismatchConfig, scale_model
from runner.robots.robot import with_models

class CONFIG(MismatchConfig):
    kind: Literal["lighter"]
    factor: float

def build(config, robot, generator):
    def change(model, joints, bears_payload):
        ones = np.ones(model.nq)
        return scale_model(model, config.factor * ones, ones, np.ones(model.nq + 1))
    return with_models(robot, change)
"""),
    MadeUp("environment", "spring", "stiffness: 300.0\n", _HEAD + """
from runner.environments import Environment

class CONFIG(StrictModel):
    kind: Literal["spring"]
    stiffness: float

class build(Environment):
    def __init__(self, config):
        self.config, self.start = config, np.zeros(3)
    def reset(self, tip):
        self.start = tip - 0.01
    def wrench(self, time, tip, velocity):
        return np.concatenate([self.config.stiffness * (self.start - tip), np.zeros(3)])
"""),
    MadeUp("environment", "sticky_wall", "distance: -0.001\nnormal: [-1.0, 0.0, 0.0]\nstiffness: 1.0e+3\ndamping: 5.0\n"
           "friction: 0.0\npull: 4.0\n", _HEAD + """
from runner.environments.wall import Wall, WallConfig

class CONFIG(WallConfig):
    kind: Literal["sticky_wall"]
    pull: float

class build(Wall):
    def wrench(self, time, tip, velocity):
        found = super().wrench(time, tip, velocity)
        found[:3] -= self.config.pull * self.normal
        return found
"""),
    MadeUp("controller", "soft_pd", "period: 0.002\nstiffness: 40.0\n", _HEAD + """
from runner.controllers.controller import Controller, Loop

class CONFIG(StrictModel):
    kind: Literal["soft_pd"]
    period: float
    stiffness: float

class SoftPd(Controller):
    def __init__(self, robot, config):
        self.robot, self.config = robot, config
    def torque(self, time, q, dq, reference):
        model = self.robot.model
        return model.gravity_torque(q) + self.config.stiffness * (self.robot.home - q) - dq
    def reset(self):
        pass

def build(config, robot):
    return (Loop(robot.stage_names[-1], slice(0, robot.model.nq), config.period, SoftPd(robot, config)),)
"""),
    MadeUp("trajectory", "swing", "duration: 0.4\nwidth: 0.05\n", _HEAD + """
from runner.trajectories.joint_motion import JointMotion
from runner.trajectories.motion import quintic_motion

class CONFIG(StrictModel):
    kind: Literal["swing"]
    duration: float
    width: float

def joint_motion(config, robot):
    return quintic_motion(robot.home, robot.home + config.width, config.duration)
"""),
    MadeUp("plant", "euler", "step: null\nlag: 0.5\n", _HEAD + """
import pinocchio as pin
from runner.plants.plant import Plant

class CONFIG(StrictModel):
    kind: Literal["euler"]
    step: float | None
    lag: float

class Euler(Plant):
    def __init__(self, model, step, steps, lag):
        self.pin, self.data = model.separate()
        self.step, self.steps, self.lag = step, steps, lag
        self.q, self.dq = np.zeros(model.nq), np.zeros(model.nq)
    def reset(self, q, dq):
        self.q[:], self.dq[:] = q, dq
    def set_gravity(self, gravity):
        self.pin.gravity.linear = gravity
    def advance(self, tau):
        for _ in range(self.steps):
            before = self.dq.copy()
            self.dq += self.step * pin.aba(self.pin, self.data, self.q, self.dq, tau)
            self.q += self.step * (self.lag * before + (1.0 - self.lag) * self.dq)
    def close(self):
        pass

def build(config, robot, step, steps):
    return Euler(robot.model, step, steps, config.lag)
"""),
)  # fmt: skip


@contextmanager
def made_up_kinds(folder: Path) -> Iterator[Path]:
    """Add the made-up kinds to the registries; their YAML files are written to a folder, which is returned."""
    names = {kind: f"runner.made_up.{kind.name}" for kind in KINDS}
    for kind, name in names.items():
        path = folder / kind.group / f"{kind.name}.yaml"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(f"# Made up\nkind: {kind.name}\n{kind.keys}")
        sys.modules[name] = module = ModuleType(name)
        exec(compile(kind.module, name, "exec"), vars(module))  # noqa: S102 - text of this file
        _REGISTRIES[kind.group]._modules[kind.name] = name
    try:
        yield folder
    finally:
        for kind, name in names.items():
            del _REGISTRIES[kind.group]._modules[kind.name], sys.modules[name]
