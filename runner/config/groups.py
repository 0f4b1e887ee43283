"""Config groups of a run: the table of their models, and their validation group by group."""

from collections.abc import Mapping

from runner.base.errors import ConfigError, nearest
from runner.config.input_shaper import InputShaperConfig
from runner.config.judgement import CaveatsConfig, SpecConfig
from runner.config.limits import LimitsConfig, SweepConfig
from runner.config.parsing import Parts, Problems, group_of, parse, parse_kind, parse_robot
from runner.config.robot import OneArmConfig
from runner.config.settings import PresetConfig, RunSettings
from runner.config.torque_limits import TorqueLimitsConfig
from runner.controllers import CONTROLLERS
from runner.controllers.disturbance_observer import DisturbanceObserverConfig
from runner.controllers.notch import NotchConfig
from runner.environments import ENVIRONMENTS
from runner.plants import PLANTS
from runner.plugins.registry import Kinds
from runner.robots.mismatch import MISMATCHES
from runner.schema.model import StrictModel
from runner.sensing import ENDPOINT_SENSORS, JOINT_TORQUE_SENSORS, NOISES, WRIST_SENSORS
from runner.trajectories import TRAJECTORIES

GROUPS: Mapping[str, Kinds | type[StrictModel]] = {
    "plant": PLANTS,
    "controller": CONTROLLERS,
    "trajectory": TRAJECTORIES,
    "environment": ENVIRONMENTS,
    "noise": NOISES,
    "torque_limits": TorqueLimitsConfig,
    "wrist_sensor": WRIST_SENSORS,
    "joint_torque_sensor": JOINT_TORQUE_SENSORS,
    "endpoint_sensor": ENDPOINT_SENSORS,
    "mismatch": MISMATCHES,
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

_OPTIONAL = ("input_shaper", "notch")
_SETTINGS = tuple(RunSettings.model_fields)


def read_groups(resolved: Mapping[str, object], problems: Problems) -> Parts:
    """Return the valid groups of a config by name; a group already read, the same object, is not read again.

    Args:
        resolved: The config as plain data, interpolations resolved.
        problems: Collects the problems found.

    Returns:
        The models of valid groups, and "settings", the keys at the root.
    """
    problems.attempt(_check_keys, resolved)
    settings = {key: resolved.get(key) for key in _SETTINGS}
    found: Parts = {"settings": problems.attempt(parse, "", RunSettings, settings)}
    for group in GROUPS:
        if group in resolved or group not in _OPTIONAL:
            keys = problems.attempt(group_of, group, resolved)
            found[group] = problems.recall(_read_group, group, keys)
    return found


def _read_group(group: str, keys: Mapping[str, object]) -> StrictModel:
    known = GROUPS[group]
    if isinstance(known, Kinds):
        return parse_kind(known, keys)
    return parse_robot(keys) if group == "robot" else parse(group, known, keys)


def _check_keys(resolved: Mapping[str, object]) -> None:
    known = (*_SETTINGS, *GROUPS)
    unknown = [str(key) for key in resolved if key not in known]
    if unknown:
        raise ConfigError(f"{key}: unknown key{nearest(key, known)}; keys: {', '.join(known)}" for key in unknown)
