"""Keys that depend on another key: rejected if they contradict the run, reported if they have no effect.

Only keys that the command line or an experiment sets count, not the values of robot files and of other options.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from runner.assembly.run_config import RunConfig
from runner.base.dotted_keys import get
from runner.base.errors import ConfigError
from runner.base.sanitize import quoted
from runner.config.compose.given_keys import given_keys, references_in
from runner.controllers.force.hybrid_force import HybridForceConfig
from runner.controllers.force.impedance import ImpedanceConfig
from runner.controllers.macro_mini.macro_mini import MacroMiniConfig
from runner.environments.push import PushConfig
from runner.plants.decoupled import TorquePlantConfig
from runner.plants.friction_law import JointFriction, joint_friction
from runner.robots.mismatch import MISMATCHES
from runner.sensing.endpoint import EndpointSensorConfig
from runner.sensing.velocity import Velocity, gains

_FRICTION = "robot.friction"
_PLAIN = {"wrist_sensor": "ideal"}  # option of a group that sets nothing; of other groups none
_UNCORRECTED = "range", "resolution", "noise", "drift", "low_pass", "mass"
_SHAPES = "stribeck_speed", "stribeck_curve", "sigmoid.steepness", "sigmoid.shift"  # no torques


class _Rule(NamedTuple):
    """Keys without effect in some runs.

    Attributes:
        keys: Keys, and groups with all their keys.
        reason: Function of a run; returns the reason, with the key on which the effect depends, or None if the keys
            act.
        but: Keys in these groups that do not count.
    """

    keys: Sequence[str]
    reason: Callable[[RunConfig], str | None]
    but: Sequence[str] = ()


def check_dependent_keys(config: RunConfig) -> None:
    """Check that no key of the command line or an experiment contradicts the run: friction that the plant lacks.

    Raises:
        ConfigError: if one does.
    """
    if not _lacks_friction(config):
        return
    shapes = [f"{_FRICTION}.{name}" for name in _SHAPES]
    found = {
        key: get(config.resolved, key)
        for key in given_keys(config.composed)
        if _is_in(key, [_FRICTION]) and key not in shapes
    }
    problems = [
        f"{key}: {quoted(value)} found, and plant={config.plant.kind} has no joint friction. Take a plant with "
        "friction, such as plant=rk4, or 0"
        for key, value in found.items()
        if _is_nonzero(value)
    ]
    if problems:
        raise ConfigError(problems)


def idle_keys(config: RunConfig) -> list[str]:
    """Return a line for each key of the command line or an experiment that has no effect in a run.

    A line names the key on which the effect depends. Friction of a robot file that the plant lacks has one line.
    """
    found = []
    if _lacks_friction(config):
        found.append(f"{_FRICTION}: no effect, because plant={config.plant.kind} has no joint friction")
    for key, origin in given_keys(config.composed).items():
        chosen = key in config.composed.choices
        if chosen and not _is_special(config, key):
            continue
        reason = next(filter(None, (rule.reason(config) for rule in _rules_of(key))), None)
        if reason is None and not chosen and _is_in(key, _REFERRED) and key not in references_in(config.composed):
            reason = f"no chosen option refers to it as ${{{key}}}"
        if reason is not None:
            found.append(f"{origin if chosen else key}: no effect, because {reason}")
    return found


def depends(key: str) -> bool:
    """Return True if the effect of a key depends on another one."""
    return bool(_rules_of(key)) or _is_in(key, _REFERRED)


@lru_cache(maxsize=512)
def _rules_of(key: str) -> Sequence[_Rule]:
    return [rule for rule in _RULES if _is_in(key, rule.keys) and not _is_in(key, rule.but)]


def _is_special(config: RunConfig, group: str) -> bool:
    """Return True if all that a chosen option of a group sets may be without effect, and the option sets something."""
    if config.composed.choices[group] == _PLAIN.get(group, "none"):
        return False
    if group == "wrist_sensor":  # its mass loads the arm
        sensor = config.force_torque_sensor
        return sensor is None or not sensor.mass > 0.0
    return group != "mismatch" or _keeps_lengths(config)


def _is_in(key: str, groups: Iterable[str]) -> bool:
    return any(key == group or key.startswith(f"{group}.") for group in groups)


def _is_nonzero(value: Any) -> bool:
    """Return True if a number, or one in a list or group, is not 0."""
    items = value.values() if isinstance(value, Mapping) else value if isinstance(value, list) else None
    return bool(value) if items is None else any(map(_is_nonzero, items))


def _lacks_friction(config: RunConfig) -> bool:
    """Return True if the robot has joint friction and the plant does not."""
    if hasattr(config.plant, "friction"):
        return False
    return bool(joint_friction(_FRICTION, config.robot.friction, config.arm.model.joint_names).acts.any())


def _moves_ideally(config: RunConfig) -> str | None:
    ideal = not config.takes_torques
    return f"plant={config.plant.kind} moves the joints ideally, whatever their mass" if ideal else None


def _keeps_lengths(config: RunConfig) -> bool:
    """Return True if the nominal model has the kinematics of the robot."""
    home = config.arm.home
    nominal = MISMATCHES.build(config.mismatch, config.arm, np.random.default_rng(0))
    return bool(np.array_equal(nominal.model.tip_jacobian(home), config.arm.model.tip_jacobian(home)))


def _reads_no_tip(config: RunConfig) -> str | None:
    return None if config.endpoint_sensor.read_by else "endpoint_sensor.read_by is []: no loop reads the sensor"


def _reads_no_torques(config: RunConfig) -> str | None:
    if config.joint_torque_sensor is None:
        return "joint_torque_sensor.noise is null: the joints have no torque sensors"
    law, observer = config.controller, config.disturbance_observer
    reads = any(loop.controller.reads_joint_torques for loop in config.loops)
    if isinstance(law, HybridForceConfig):
        reads = law.force_source == "joint_torque"
    if reads or (observer.bandwidth is not None and observer.torque == "measured"):
        return None
    return "neither the law nor disturbance_observer.torque=measured reads the sensors"


def _feels_nothing(config: RunConfig) -> str | None:
    return None if config.has_contact else "environment=free, and no control law uses the sensor"


def _has_no_observer(config: RunConfig) -> str | None:
    return "disturbance_observer.bandwidth is null" if config.disturbance_observer.bandwidth is None else None


def _has_no_bandwidth(key: str, way: Velocity) -> str | None:
    return None if gains(way, 1.0, 1.0) else f"{key}.velocity={way} has no bandwidth"


def _measures_no_velocity(config: RunConfig) -> str | None:
    noise = config.encoder_noise
    return None if noise is None else _has_no_bandwidth("noise", noise.velocity)


def _measures_no_tip_velocity(config: RunConfig) -> str | None:
    sensor = config.endpoint_sensor
    if not isinstance(sensor, EndpointSensorConfig):
        return None
    return _has_no_bandwidth("endpoint_sensor", sensor.velocity)


def _uses_no_velocity(config: RunConfig) -> str | None:
    positions = config.encoder_noise is not None and config.commands == "position"
    return f"controller={config.controller.kind} commands joint positions and reads no speeds" if positions else None


def _draws_no_noise(config: RunConfig) -> str | None:
    noise = config.encoder_noise
    return "noise.distribution is none" if noise is not None and noise.distribution == "none" else None


def _has_no_noise(config: RunConfig) -> str | None:
    noise = config.encoder_noise
    return None if noise is None or noise.position.any() else "noise.position is 0"


def _draws_slowly(config: RunConfig) -> str | None:
    push = config.environment
    if not isinstance(push, PushConfig) or push.bandwidth is None:
        return None
    if not push.noise:
        return "environment.noise is 0"
    highest = 0.5 / config.timing.tick
    fast = push.bandwidth > (1.0 + 1e-9) * highest
    return f"the force changes once in a control step, {highest:g} Hz at most by controller.period" if fast else None


def _pushes_steadily(config: RunConfig) -> str | None:
    push = config.environment
    steady = isinstance(push, PushConfig) and not any((*push.force, *push.moment))
    return "environment.force and environment.moment are 0" if steady else None


def _has_no_stiction(config: RunConfig) -> str | None:
    found = _friction(config)
    return None if found is None or any(found.stiction) else "friction.static is not above friction.coulomb"


def _has_no_curve(config: RunConfig) -> str | None:
    found = _friction(config)
    if found is None or any(map(all, zip(found.stiction, found.stribeck_speed, strict=True))):
        return None
    return _has_no_stiction(config) or "friction.stribeck_speed is null"


def _has_no_sigmoid(config: RunConfig) -> str | None:
    found = _friction(config)
    if found is None or any(found.slopes[0]):
        return None
    return "friction.sigmoid.level and friction.sigmoid.steepness must both be above 0"


def _friction(config: RunConfig) -> JointFriction | None:
    plant = config.plant
    if not isinstance(plant, TorquePlantConfig):
        return None
    return joint_friction("plant.friction", plant.friction, config.arm.model.joint_names)


def _has_no_servo(config: RunConfig) -> str | None:
    return f"controller={config.controller.kind} gives torques" if config.commands == "torque" else None


def _is_one_stage(config: RunConfig) -> str | None:
    return f"robot={config.robot.name} has one stage" if len(config.arm.stages) == 1 else None


def _bears_nothing(config: RunConfig) -> str | None:
    return None if config.robot.payload.largest else "robot.payload.mass is 0"


def _has_one_stage_or_all_comply(config: RunConfig) -> str | None:
    law = config.controller
    if not isinstance(law, ImpedanceConfig):
        return None
    if len(config.arm.stages) > 1 and law.actuated_stages == "last_stage":
        return None
    return "controller.kind=impedance uses it in stages that do not comply, and has none"


def _follows_joints(config: RunConfig) -> str | None:
    joints = all(loop.follows_joints for loop in config.loops) and config.follows_joints
    return f"trajectory.kind={config.composed.choices.get('trajectory')} is a motion of the joints" if joints else None


def _is_not_redundant(config: RunConfig) -> str | None:
    task = getattr(config.controller, "task", "position")
    free = config.arm.model.nq - (6 if task == "pose" else 3)
    return f"the {config.arm.model.nq} joints of robot={config.robot.name} are not redundant" if free <= 0 else None


def _meets_no_wall(config: RunConfig) -> str | None:
    return "environment is not a wall" if config.wall is None else None


def _checks_no_wall(config: RunConfig) -> str | None:
    if config.takes_torques:
        return f"plant={config.plant.kind} does not move the joints ideally"
    return _meets_no_wall(config)


def _damps_no_base(config: RunConfig) -> str | None:
    law = config.controller
    if not isinstance(law, MacroMiniConfig) or law.coupling == "inertial_damping":
        return None
    return f"controller.coupling is {law.coupling}"


def _stays_at_rest(config: RunConfig) -> str | None:
    rests = isinstance(config.controller, HybridForceConfig) and get(config.resolved, "trajectory.kind") == "goal"
    return "trajectory.kind=goal has no desired velocity" if rests else None


def _corrects_no_reading(_: RunConfig) -> str:
    return (
        "a control law corrects readings by bias, rotation and height of controller.sensor; wrist_sensor has the rest"
    )


_RULES = (
    _Rule(["mismatch"], _moves_ideally, but=["mismatch.length", "mismatch.kind"]),
    _Rule(["endpoint_sensor"], _reads_no_tip),
    _Rule(["endpoint_sensor.velocity_bandwidth"], _measures_no_tip_velocity),
    _Rule(["joint_torque_sensor"], _reads_no_torques),
    _Rule(["wrist_sensor"], _feels_nothing, but=["wrist_sensor.mass"]),
    _Rule(["disturbance_observer.torque"], _has_no_observer),
    _Rule(["noise.velocity_bandwidth"], _measures_no_velocity),
    _Rule(["noise.velocity", "noise.velocity_bandwidth"], _uses_no_velocity),
    _Rule(["noise.position"], _draws_no_noise),
    _Rule(["noise.distribution"], _has_no_noise),
    _Rule(["environment.bandwidth"], _draws_slowly),
    _Rule(["environment.frequency"], _pushes_steadily),
    _Rule(["robot.friction.stribeck_speed", "plant.friction.stribeck_speed"], _has_no_stiction),
    _Rule(["robot.friction.stribeck_curve", "plant.friction.stribeck_curve"], _has_no_curve),
    _Rule(["robot.friction.sigmoid", "plant.friction.sigmoid"], _has_no_sigmoid),
    _Rule(["plant.servo"], _has_no_servo),
    _Rule(["plant.dynamics", "plant.wrist_rotation"], _is_one_stage),
    _Rule(["controller.actuated_stages"], _is_one_stage),
    _Rule(["controller.natural_frequency", "controller.damping_ratio"], _has_one_stage_or_all_comply),
    _Rule(["controller.null_space_frequency"], _is_not_redundant),
    _Rule([f"controller.{name}" for name in ("task", "singularity_damping", "null_space_frequency")], _follows_joints),
    _Rule(["controller.check_stability"], _checks_no_wall),
    _Rule(["controller.damping_gain"], _damps_no_base),
    _Rule(["controller.feedforward"], _stays_at_rest),
    _Rule([f"controller.sensor.{name}" for name in _UNCORRECTED], _corrects_no_reading),
    _Rule(["robot.payload.position"], _bears_nothing),
    _Rule(["robot.tool.tip_radius"], _meets_no_wall),
)
_REFERRED = (
    "robot.start", "robot.goal", "robot.path_size", "robot.natural_frequency", "robot.damping_ratio", "robot.period",
    "robot.joint_error_limit", "robot.no_joint_error", "robot.torque_limit", "preset",
)  # fmt: skip
"""Keys that act only through a reference in another group, such as ${robot.goal}."""
