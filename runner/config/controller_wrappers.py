"""Checks of the wrappers around controllers: disturbance observer and notch filter."""

import numpy as np

from runner.base.errors import ConfigError
from runner.config.run import RunConfig
from runner.plants.decoupled import TorquePlantConfig


def check_observer(config: RunConfig) -> None:
    """Check that an observer meets laws of torques, a plant that its model describes, and commands at its ticks.

    Raises:
        ConfigError: where it does not; names what it lacks.
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
        if config.joint_torques is not None or "joint_torque_sensor" in config.plugged:
            return
        raise ConfigError(
            [
                "disturbance_observer.torque: measured needs torque sensors in the joints, and joint_torque_sensor."
                "noise is null; take joint_torque_sensor=ideal, or disturbance_observer.torque=commanded"
            ]
        )
    else:
        problem = _late(config)
    if problem is not None:
        raise ConfigError([f"disturbance_observer.bandwidth: {problem}, or disturbance_observer=none"])


def _parted(config: RunConfig) -> bool:
    """Tell whether the stages of the plant move each for itself."""
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
                f"fastest loop apart, and plant.computation.delay with {late} is no multiple of that; take {every}"
            )
    return None


def check_notch(config: RunConfig) -> None:
    """Check that a notch meets laws of torques that are fast enough for its frequencies.

    Raises:
        ConfigError: where it does not.
    """
    if config.notch is None:
        return
    if config.commands != "torque" or any(loop.uses_wrench for loop in config.loops):
        kind, what = config.controller.kind, "commands joint positions" if config.commands != "torque" else "feels"
        raise ConfigError(
            [f"notch: {kind} {what}; take a controller that gives torques and feels nothing, or notch=none"]
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
