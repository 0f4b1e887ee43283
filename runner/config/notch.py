"""Checks of the notch filter."""

import numpy as np

from runner.base.errors import ConfigError
from runner.config.run import RunConfig


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
