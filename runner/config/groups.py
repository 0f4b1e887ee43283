"""Config groups of a run: the table of their models, and their validation group by group."""

from collections.abc import Mapping

from runner.base.errors import ConfigError, nearest
from runner.config.input_shaper import InputShaperConfig
from runner.config.joints import NoiseConfig, TorqueLimitsConfig
from runner.config.judgement import CaveatsConfig, SpecConfig
from runner.config.limits import LimitsConfig, SweepConfig
from runner.config.parsing import Parts, Problems, group_of, parse, parse_kind, parse_robot
from runner.config.robot import OneArmConfig
from runner.config.settings import PresetConfig, RunSettings
from runner.controllers import CONTROLLERS
from runner.controllers.disturbance_observer import DisturbanceObserverConfig
from runner.controllers.notch import NotchConfig
from runner.environments import ENVIRONMENTS
from runner.plants import PLANTS
from runner.plugins.registry import Kinds
from runner.robots.mismatch import MISMATCHES, MismatchConfig
from runner.robots.mismatch import NONE as NO_MISMATCH
from runner.schema.model import StrictModel
from runner.sensing import JOINT_TORQUE_SENSORS, NOISES, WRIST_SENSORS, EndpointSensorConfig, JointTorqueConfig
from runner.sensing.force_torque import IDEAL, ForceTorqueConfig
from runner.trajectories import TRAJECTORIES

GROUPS: Mapping[str, Kinds | type[StrictModel]] = {
    "plant": PLANTS,
    "controller": CONTROLLERS,
    "trajectory": TRAJECTORIES,
    "environment": ENVIRONMENTS,
    "noise": NoiseConfig,
    "torque_limits": TorqueLimitsConfig,
    "wrist_sensor": ForceTorqueConfig,
    "joint_torque_sensor": JointTorqueConfig,
    "endpoint_sensor": EndpointSensorConfig,
    "mismatch": MismatchConfig,
    "disturbance_observer": DisturbanceObserverConfig,
    "input_shaper": InputShaperConfig,
    "notch": NotchConfig,
    "robot": OneArmConfig,
    "preset": PresetConfig,
    "sweep": SweepConfig,
    "limits": LimitsConfig,
    "caveats": CaveatsConfig,
    "spec": SpecConfig,
}
"""The model of each group, or the kinds whose models it may have; see also parse_robot."""

PLUGGED: Mapping[str, tuple[Kinds, StrictModel | None]] = {
    "noise": (NOISES, None),
    "wrist_sensor": (WRIST_SENSORS, IDEAL),
    "joint_torque_sensor": (JOINT_TORQUE_SENSORS, JointTorqueConfig(noise=None, bias=0.0)),
    "mismatch": (MISMATCHES, NO_MISMATCH),
}
"""Groups that a plug-in replaces if they have a `kind`, each with a built-in config without effect, or None."""

_OPTIONAL = ("input_shaper", "notch")
_SETTINGS = tuple(RunSettings.model_fields)


def read_groups(resolved: Mapping[str, object], problems: Problems) -> Parts:
    """Return the valid groups of a config by name; a group already read, the same object, is not read again.

    Args:
        resolved: The config as plain data, interpolations resolved.
        problems: Collects the problems found.

    Returns:
        The models of valid groups; "settings", the keys at the root; and "plugged", the configs of plug-ins by group.
    """
    problems.attempt(_check_keys, resolved)
    settings = {key: resolved.get(key) for key in _SETTINGS}
    found: Parts = {"settings": problems.attempt(parse, "", RunSettings, settings), "plugged": {}}
    for group in GROUPS:
        if group in resolved or group not in _OPTIONAL:
            keys = problems.attempt(group_of, group, resolved)
            found[group] = problems.recall(_read_group, group, keys)
            if found[group] is not None and is_plugged(group, keys):
                found["plugged"][group], found[group] = found[group], PLUGGED[group][1]
    return found


def is_plugged(group: str, keys: Mapping[str, object] | None) -> bool:
    """Return True if the keys of a group select a plug-in instead of the built-in model."""
    return group in PLUGGED and keys is not None and "kind" in keys


def _read_group(group: str, keys: Mapping[str, object]) -> StrictModel:
    known = PLUGGED[group][0] if is_plugged(group, keys) else GROUPS[group]
    if isinstance(known, Kinds):
        return parse_kind(known, keys)
    return parse_robot(keys) if group == "robot" else parse(group, known, keys)


def _check_keys(resolved: Mapping[str, object]) -> None:
    known = (*_SETTINGS, *GROUPS)
    unknown = [str(key) for key in resolved if key not in known]
    if unknown:
        raise ConfigError(f"{key}: unknown key{nearest(key, known)}; keys: {', '.join(known)}" for key in unknown)
