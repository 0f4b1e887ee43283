"""Checks of sensors: position sensor of the tip, and joint torque sensors that a force controller reads."""

from collections.abc import Mapping

from runner.base.errors import ConfigError, nearest
from runner.config.run import RunConfig
from runner.controllers import Loop
from runner.controllers.force.hybrid_force import HybridForceConfig
from runner.sensing.endpoint import EndpointTicks


def endpoint_ticks(config: RunConfig) -> Mapping[str, EndpointTicks]:
    """Return when loops measure the tip, by loop; empty where there is no sensor.

    Raises:
        ConfigError: for names of no loop, for times that are no multiple of a loop's period, and for laws that do
            not ask where the tip is or bases that do not turn as the encoders tell.
    """
    sensor, problems = config.endpoint_sensor, []
    loops = {loop.name: loop for loop in config.loops}
    problems = [
        f"endpoint_sensor.read_by: no control loop is called '{name}'{nearest(name, loops)}; loops: {', '.join(loops)}"
        for name in sensor.read_by
        if name not in loops
    ]
    readers = [loops[name] for name in sensor.read_by if name in loops]
    problems += [f"endpoint_sensor.read_by: {problem}" for loop in readers for problem in _refused(config, loop)]
    found = {}
    for loop in readers:
        period = loop.period if sensor.period is None else sensor.period
        every, late = round(period / loop.period), round(sensor.delay / loop.period)
        found[loop.name] = EndpointTicks(max(every, 1), late)
        for key, value, ticks in (("period", period, every), ("delay", sensor.delay, late)):
            if abs(value - ticks * loop.period) > 1e-9 * loop.period or (key == "period" and not ticks):
                problems.append(
                    f"endpoint_sensor.{key}: {value:g} s is no multiple of the period of the loop {loop.name}, "
                    f"{loop.period:g} s; take {max(ticks, 1) * loop.period:g}"
                )
    if problems:
        raise ConfigError(dict.fromkeys(problems))
    return found


def _refused(config: RunConfig, loop: Loop) -> list[str]:
    problems = []
    if config.commands != "torque":
        problems.append(f"{config.controller.kind} commands joint positions; take a controller that gives torques")
    elif loop.follows_joints:
        problems.append("the trajectory is one of joints, which ask for no tip; take one of the tip, or []")
    elif loop.uses_wrench:
        problems.append(f"{config.controller.kind} finds the wall by the encoders; take a law that feels no force")
    if config.ignore_base_rotation:
        problems.append(
            "bases that keep the orientation of home turn otherwise than the encoders tell; take "
            "plant.wrist_rotation=real"
        )
    return problems


def check_reading(config: RunConfig) -> None:
    """Check that joints have torque sensors where a law reads the force from them.

    Raises:
        ConfigError: where they have none.
    """
    law = config.controller
    if isinstance(law, HybridForceConfig) and law.force_source == "joint_torque" and config.joint_torques is None:
        raise ConfigError(
            [
                "controller.force_source: joint_torque needs torque sensors in the joints, and "
                "joint_torque_sensor.noise is null; take joint_torque_sensor=ideal, or controller.force_source=wrist"
            ]
        )
