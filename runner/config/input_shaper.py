"""Config of the input shaper, and the shaped desired motion."""

import re
from collections.abc import Sequence
from dataclasses import replace
from typing import Annotated, Any, Literal, cast

from pydantic import BeforeValidator, Field

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.controllers import Loop
from runner.plants import PLANTS, PlantConfig
from runner.robots.robot import Robot
from runner.robots.vibration import Mode
from runner.schema.model import StrictModel
from runner.schema.units import Hertz
from runner.trajectories import Trajectory
from runner.trajectories.joint_motion import TipOfJoints
from runner.trajectories.shaped import Shaped, in_turn, zero_vibration

_KEY = "input_shaper.frequency"
_MODE = re.compile(r"mode_([1-9]\d?)")
_MOST = 4  # modes of one shaper: three impulses each


def _frequency(value: Any) -> Any:
    wanted = value if isinstance(value, list) else [value]
    number = [isinstance(each, int | float) and not isinstance(each, bool) and each > 0.0 for each in wanted]
    named = [isinstance(each, str) and _MODE.fullmatch(each) is not None for each in wanted]
    if not 1 <= len(wanted) <= _MOST or not all(map(max, number, named)):
        raise ValueError(f"must be a number above 0, the name of a mode such as mode_1, or a list of up to {_MOST}")
    return value


class InputShaperConfig(StrictModel):
    """Config of an input shaper, after Singer and Seering (J. Dyn. Syst. Meas. Control 112, 1990).

    Attributes:
        kind: zv, two impulses half a period apart; zvd, three in one period.
        frequency: Undamped frequency of the mode to suppress, in Hz. Or mode_1, mode_2, ... of the flexible plant in
            the start configuration with locked motors. Or a list of these.
        damping_ratio: Damping ratio of these modes. None takes that of the plant, and 0 for a frequency in Hz.
    """

    kind: Literal["zv", "zvd"]
    frequency: Hertz[Annotated[float | str | list[float | str], BeforeValidator(_frequency)]]
    damping_ratio: Hertz[Annotated[float, Field(ge=0.0, lt=1.0)] | None]

    def find(self, modes: Sequence[Mode]) -> list[Mode]:
        """Return the modes to suppress.

        Args:
            modes: Modes of the plant.

        Raises:
            ConfigError: for a mode that does not exist.
        """
        wanted = self.frequency if isinstance(self.frequency, list) else [self.frequency]
        found = [_find(each, modes) for each in wanted]
        given = self.damping_ratio
        return found if given is None else [mode._replace(damping_ratio=given) for mode in found]


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
    found, slowest = config.find(PLANTS.modes(plant, arm, q_start)), max(loop.period for loop in loops)
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
