"""Checks across groups: payload, computation delay, controller wrappers and sensors."""

from collections.abc import Mapping, Sequence

import numpy as np

from runner.assembly.run_config import RunConfig
from runner.base.errors import ConfigError, nearest
from runner.controllers import Loop
from runner.controllers.force.hybrid_force import HybridForceConfig
from runner.plants import PLANTS, PlantConfig, options_of
from runner.plants.decoupled import TorquePlantConfig
from runner.sensing.endpoint import EndpointTicks


def check_schedule(config: RunConfig) -> None:
    """Check that the plant supports a payload that changes during the run.

    Raises:
        ConfigError: if it does not.
    """
    if not config.loaded:
        return
    key = "robot.payload.schedule: the payload cannot change on the way"
    if not config.takes_torques:
        fit = " or plant=".join(kind for kind in PLANTS.names() if PLANTS.commands(kind) == "torque")
        raise ConfigError(f"{key} of plant={config.plant.kind}, whose joints no mass moves; take plant={fit}, or []")
    if config.has_contact:
        raise ConfigError(
            f"{key} where the tip touches something or its sensor is read, which would have to tell the payload "
            "from the touch; take environment=free and a controller that feels nothing, or []"
        )


_MAX_TICKS = 10_000_000


def count_late(plant: PlantConfig, loops: Sequence[Loop]) -> tuple[int, ...]:
    """Return the delay of the commands of each loop, in ticks of the fastest loop, without jitter.

    Raises:
        ConfigError: for a mapping that names other loops, or a delay longer than any run.
    """
    late = options_of(plant).computation.by_loop([loop.name for loop in loops])
    if max(late) > _MAX_TICKS:
        raise ConfigError(f"plant.computation.delay: {max(late)} ticks found; allowed: up to {_MAX_TICKS}")
    return tuple(late)


def check_computation(config: RunConfig) -> None:
    """Check that only torques have jitter or misses, and that a pattern of misses fits into the run.

    Raises:
        ConfigError: if joint positions have them, or the pattern is too long.
    """
    computation, timing, key = options_of(config.plant).computation, config.timing, "plant.computation"
    if computation.is_even:
        return
    problems = []
    if config.commands != "torque":
        problems.append(
            f"{key}: {config.controller.kind} commands joint positions, which come all as late; take jitter=null and "
            "miss=null, or a controller that gives torques"
        )
    for loop in config.loops if isinstance(computation.miss, list) else ():
        own, pattern = timing.ticks // round(loop.period / timing.tick) + 1, computation.miss
        assert isinstance(pattern, list)  # noqa: S101 - as above
        if len(pattern) > own:
            problems.append(
                f"{key}.miss: a pattern of {len(pattern)} ticks, and the loop {loop.name} has {own} in the run; take a "
                "shorter one, or a longer duration"
            )
    if problems:
        raise ConfigError(problems)


def check_observer(config: RunConfig) -> None:
    """Check that a disturbance observer suits the controller and the plant.

    The controller must command torques and must not use the external wrench. The observer's model must describe the
    plant. The acting torque must be known or measured.

    Raises:
        ConfigError: if one of these conditions is not met; names it.
    """
    if config.disturbance_observer.by_loop(config.loops) is None:
        return
    problem = None
    if config.commands != "torque":
        kind = config.controller.kind
        problem = f"it corrects torques, and {kind} commands joint positions; take a controller that gives torques"
    elif any(loop.uses_wrench for loop in config.loops):
        kind = config.controller.kind
        problem = f"it takes a touch for a disturbance, which {kind} is to feel; take a controller that feels nothing"
    elif _parted(config):
        problem = (
            "its momenta are those of the whole arm, whose stages turn and feel each other; take "
            "plant.dynamics=coupled and plant.wrist_rotation=real"
        )
    elif config.disturbance_observer.torque == "measured":
        if config.joint_torque_sensor is not None:
            return
        raise ConfigError(
            "disturbance_observer.torque: measured needs torque sensors in the joints, and joint_torque_sensor."
            "noise is null; take joint_torque_sensor=ideal, or disturbance_observer.torque=commanded"
        )
    else:
        problem = _late(config)
    if problem is not None:
        raise ConfigError(f"disturbance_observer.bandwidth: {problem}, or disturbance_observer=none")


def _parted(config: RunConfig) -> bool:
    """Return True if the stages of the plant move independently of each other."""
    apart = isinstance(config.plant, TorquePlantConfig) and config.plant.dynamics == "decoupled"
    return len(config.arm.stages) > 1 and (apart or config.ignore_base_rotation)


def _late(config: RunConfig) -> str | None:
    timing = config.timing
    if not timing.even:
        return (
            "it has to know which torque acts, and plant.computation has commands come unevenly; take jitter=null and "
            "miss=null, or disturbance_observer.torque=measured"
        )
    for loop, late in zip(config.loops, timing.late, strict=True):
        every = round(loop.period / timing.tick)
        if late % every:
            return (
                f"it has to know which torque acts between two ticks of the loop {loop.name}, {every} ticks of the "
                f"fastest loop apart, and plant.computation.delay with {late} is not a multiple of that; take {every}"
            )
    return None


def check_notch(config: RunConfig) -> None:
    """Check that a controller with a notch commands torques without the external wrench, fast enough for the notch.

    Raises:
        ConfigError: if it does not.
    """
    if config.notch is None:
        return
    if config.commands != "torque" or any(loop.uses_wrench for loop in config.loops):
        kind, what = config.controller.kind, "commands joint positions" if config.commands != "torque" else "feels"
        raise ConfigError(
            f"notch: {kind} {what}; take a controller that gives torques and feels nothing, or notch=none"
        )
    frequency, problems = config.notch.by_joint(config.arm), []
    for loop in config.loops:
        highest = 0.5 / loop.period
        of_loop = zip(config.arm.model.joint_names[loop.joints], frequency[loop.joints], strict=True)
        seen = f"of a loop of {loop.period:g} s; allowed: below {highest:.4g} Hz, half its rate"
        problems += [f"notch.frequency: {name} has {f:g} Hz, {seen}" for name, f in of_loop if highest <= f < np.inf]
        if config.notch.width >= highest:
            problems.append(f"notch.width: {config.notch.width:g} Hz, {seen}")
    if problems:
        raise ConfigError(dict.fromkeys(problems))


def endpoint_ticks(config: RunConfig) -> Mapping[str, EndpointTicks]:
    """Return the period and delay of the tip sensor in ticks, by loop; empty without a sensor.

    Raises:
        ConfigError: for an unknown loop, a time that is not a multiple of a loop's period, a control law that does not
            use the tip position, or mounted stages that do not turn with their base.
    """
    sensor, problems = config.endpoint_sensor, []
    loops = {loop.name: loop for loop in config.loops}
    problems = [
        f"endpoint_sensor.read_by: no control loop is called '{name}'{nearest(name, loops)}; loops: {', '.join(loops)}"
        for name in sensor.read_by
        if name not in loops
    ]
    readers = [loops[name] for name in sensor.read_by if name in loops]
    problems += [f"endpoint_sensor.read_by: {problem}" for loop in readers for problem in _refused_reader(config, loop)]
    found = {}
    for loop in readers:
        period = loop.period if sensor.period is None else sensor.period
        every, late = round(period / loop.period), round(sensor.delay / loop.period)
        found[loop.name] = EndpointTicks(max(every, 1), late)
        for key, value, ticks in (("period", period, every), ("delay", sensor.delay, late)):
            if abs(value - ticks * loop.period) > 1e-9 * loop.period or (key == "period" and not ticks):
                problems.append(
                    f"endpoint_sensor.{key}: {value:g} s is not a multiple of the period of the loop {loop.name}, "
                    f"{loop.period:g} s; take {max(ticks, 1) * loop.period:g}"
                )
    if problems:
        raise ConfigError(dict.fromkeys(problems))
    return found


def _refused_reader(config: RunConfig, loop: Loop) -> list[str]:
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
    """Check that joints have torque sensors if the control law estimates the force from joint torques.

    Raises:
        ConfigError: if they have none.
    """
    law = config.controller
    by_joints = isinstance(law, HybridForceConfig) and law.force_source == "joint_torque"
    if by_joints and config.joint_torque_sensor is None:
        raise ConfigError(
            "controller.force_source: joint_torque needs torque sensors in the joints, and "
            "joint_torque_sensor.noise is null; take joint_torque_sensor=ideal, or controller.force_source=wrist"
        )
