"""Joint-limit check of a desired joint motion: positions and speeds."""

import numpy as np

from runner.base.errors import ConfigError
from runner.base.limits import SAMPLES
from runner.robots.robot import Robot
from runner.trajectories import Trajectory
from runner.trajectories.joint_motion import TipOfJoints

_SAMPLES = 4001
_ROUNDING = 1e-9  # of a limit


def check_joints(arm: Robot, path: Trajectory) -> None:
    """Check positions and speeds of the joints where the desired motion is one of the joints.

    Raises:
        ConfigError: if it needs too many samples; for each joint that is led beyond a limit: the time, its value there
            that lies farthest beyond, and the limit.
    """
    if not isinstance(path, TipOfJoints):
        return
    if excess := SAMPLES.excess(path.joints.samples):
        raise ConfigError([f"trajectory.duration: a motion of {path.duration:g} s {excess}; make it shorter or slower"])
    times = np.linspace(0.0, path.duration, max(_SAMPLES, path.joints.samples + 1))
    motion, model = path.sample_joints(times), arm.model
    lower, upper = model.position_limits
    limits = (
        ("position", "", motion[:, 0], lower, upper),
        ("speed", "/s", motion[:, 1], -model.velocity_limits, model.velocity_limits),
    )
    problems = []
    for what, per, values, least, most in limits:
        beyond = np.maximum(least - values, values - most)
        for joint in range(model.nq):
            row = int(beyond[:, joint].argmax())
            if beyond[row, joint] > _ROUNDING * max(abs(least[joint]), abs(most[joint])):
                unit, low, high = f"{model.joint_units[joint]}{per}", least[joint], most[joint]
                problems.append(
                    f"trajectory: at t = {times[row]:.4g} s the {what} of {model.joint_names[joint]} is "
                    f"{values[row, joint]:.4g} {unit}, beyond its limits, {low:.4g} to {high:.4g} {unit}"
                )
    if problems:
        raise ConfigError(problems)
