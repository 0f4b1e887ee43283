"""Desired motion after the input shaper, and the modes that it suppresses."""

from collections.abc import Sequence
from dataclasses import replace
from typing import cast

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.config.input_shaper import InputShaperConfig
from runner.controllers import Loop
from runner.plants import PLANTS, PlantConfig
from runner.robots.robot import Robot
from runner.robots.vibration import Mode
from runner.trajectories import Trajectory
from runner.trajectories.joint_motion import TipOfJoints
from runner.trajectories.shaped import Shaped, in_turn, zero_vibration

_KEY = "input_shaper.frequency"


def shape(
    config: InputShaperConfig,
    plant: PlantConfig,
    arm: Robot,
    path: Trajectory,
    q_start: FloatArray,
    loops: Sequence[Loop],
) -> Trajectory:
    """Return a desired motion convolved with the impulses of a shaper.

    Args:
        config: The shaper.
        plant: Config of the plant, which has the named modes.
        arm: The simulated arm.
        path: Motion of the tip; if it follows from a joint motion, the function shapes the joint motion.
        q_start: Joint positions at the start, shape (nq,), in rad.
        loops: The control loops.

    Raises:
        ConfigError: for a motion that never ends, a mode that does not exist, or a mode above half the rate of the
            slowest loop.
    """
    if path.goal is None:
        raise ConfigError("input_shaper: the trajectory never ends; take one that comes to rest, or none")
    found, slowest = find_modes(config, PLANTS.modes(plant, arm, q_start)), max(loop.period for loop in loops)
    unseen = [
        f"{_KEY}: {mode.frequency:.4g} Hz found; a loop of {slowest:g} s sees motions below {0.5 / slowest:.4g} Hz"
        for mode in found
        if mode.frequency >= 0.5 / slowest
    ]
    if unseen:
        raise ConfigError(unseen)
    impulses = in_turn([zero_vibration(config.kind, *mode) for mode in found])
    if isinstance(path, TipOfJoints):
        return replace(path, joints=Shaped(cast(Trajectory, path.joints), impulses))
    return Shaped(path, impulses)


def find_modes(config: InputShaperConfig, modes: Sequence[Mode]) -> list[Mode]:
    """Return the modes to suppress.

    Args:
        config: The shaper.
        modes: Modes of the plant.

    Raises:
        ConfigError: for a mode that does not exist.
    """
    wanted = config.frequency if isinstance(config.frequency, list) else [config.frequency]
    found = [_find(each, modes) for each in wanted]
    given = config.damping_ratio
    return found if given is None else [mode._replace(damping_ratio=given) for mode in found]


def _find(wanted: float | str, modes: Sequence[Mode]) -> Mode:
    """Return the mode that a value names; a frequency in Hz gives a mode without damping."""
    if not isinstance(wanted, str):
        return Mode(wanted, 0.0)
    number = int(wanted.removeprefix("mode_"))
    if number <= len(modes):
        return modes[number - 1]
    if not modes:
        raise ConfigError(
            f"{_KEY}: {wanted} is a mode of a flexible plant, and this one is rigid; take plant=rk4_flexible, or Hz"
        )
    told = ", ".join(f"mode_{i} ({mode.frequency:.4g} Hz)" for i, mode in enumerate(modes, start=1))
    raise ConfigError(f"{_KEY}: {wanted} found; the plant has {told}, with its motors held where the arm starts")
