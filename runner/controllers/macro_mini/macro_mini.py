"""Macro/Mini control with a loop for each stage, from its own dynamics (thesis methods 2 and 3)."""

from collections.abc import Mapping
from typing import Literal

import numpy as np
from pydantic import NonNegativeFloat, PositiveFloat

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.controllers.controller import Controller, Loop
from runner.controllers.macro_mini.inertial_damping import InertialDamping
from runner.controllers.macro_mini.stage_loops import Aim, HeldController, MacroController, MiniController, StageLaw
from runner.controllers.operational_space.whole_body import WholeBodyLaw
from runner.robots.robot import Robot, end_points
from runner.schema.model import StrictModel
from runner.schema.units import Metres, PerSecond, RadiansPerSecond, Seconds
from runner.schema.values import PositivePerStage, by_stage


class MacroMiniConfig(StrictModel):
    """Config of stage-wise control; mappings have a value for each stage.

    Attributes:
        kind: Registry name of the controller.
        natural_frequency: omega_n of each stage's closed loop, in rad/s.
        damping_ratio: xi of each stage.
        period: Time between two ticks of each stage, in s; each is a multiple of the shortest.
        coupling: Target of the mounted stage (Mini). one_way: it compensates the error of the base stage (Macro);
            two_way: the Macro also compensates the Mini's present offset; independent: the Mini keeps its home offset
            in its own base frame, which turns with the Macro; independent_base: in the robot's base frame; mini_held:
            its joints are held at home; inertial_damping: its tip damps the Macro's vibration, about its home offset.
        damping_gain: g of inertial damping, in 1/s: force on the tip per base velocity and tip mass.
        macro_target: Target of the Macro with one_way coupling: x_d - r_0 (minus_home), or x_d (tip_goal), so that the
            Mini folds.
        mini_reference_velocity: Reference of the Mini: with its target's velocity (full) or a series of goals (zero).
        wrist_rotation: Rotation of the Mini's base in the controllers: measured (real), or that at home (parallel).
        gravity_compensation: True if the laws include the gravity term.
        feedforward: True if the Macro uses the desired velocity and acceleration.
        schedule: both, the stages move at any time; turns, they move in turns of one Macro period.
        reach: Distance of the target from the Mini's base up to which the Mini follows it, in m. With several Minis the
            target leaves the later ones at their home offset. One value for all Minis.
        beyond_reach: Behaviour of the Mini beyond reach: hold its configuration, or stretch towards the target.
        payload: Mass of the mounted stages in the model of the stage below: included (known), or not (unknown).
        singularity_damping: As in operational-space control.
    """

    kind: Literal["macro_mini"]
    natural_frequency: RadiansPerSecond[PositivePerStage]
    damping_ratio: PositivePerStage
    period: Seconds[PositivePerStage]
    coupling: Literal["one_way", "two_way", "independent", "independent_base", "mini_held", "inertial_damping"]
    damping_gain: PerSecond[NonNegativeFloat]
    macro_target: Literal["minus_home", "tip_goal"]
    mini_reference_velocity: Literal["zero", "full"]
    wrist_rotation: Literal["real", "parallel"]
    gravity_compensation: bool
    feedforward: bool
    schedule: Literal["both", "turns"]
    reach: Metres[PositiveFloat]
    beyond_reach: Literal["hold", "stretch"]
    payload: Literal["unknown", "known"]
    singularity_damping: NonNegativeFloat


TAKES_DRAWN = True
CONFIG = MacroMiniConfig
_AIMS: Mapping[str, Aim] = {
    "one_way": "rest",
    "two_way": "rest",
    "independent": "own_offset",
    "independent_base": "base_offset",
}


def build(config: MacroMiniConfig, robot: Robot) -> tuple[Loop, ...]:
    """Build the loops of a config, one for each stage.

    Raises:
        ConfigError: if the robot has only one stage, a value is missing for a stage, or a stage does not fit its law.
    """
    names = robot.stage_names
    if len(names) < 2:
        raise ConfigError(
            f"controller.kind: macro_mini couples stages and the robot has one ({names[0]}); take operational_space"
        )
    periods = by_stage("controller.period", config.period, names)
    controllers = [_controller(config, robot, index, periods[0]) for index in range(len(names))]
    return tuple(
        Loop(stage.name, stage.joints, period, controller)
        for stage, period, controller in zip(robot.stages, periods, controllers, strict=True)
    )


def _controller(config: MacroMiniConfig, robot: Robot, index: int, macro_period: float) -> Controller:
    ignore_base_rotation = config.wrist_rotation == "parallel"
    turn = macro_period if config.schedule == "turns" else None
    law = _law(config, robot, index)
    if index == 0:
        return MacroController(robot, law, _macro_offset(config, robot), ignore_base_rotation, config.reach, turn)
    if config.coupling == "mini_held":
        return HeldController(robot, index, law, ignore_base_rotation)
    if config.coupling == "inertial_damping" and ignore_base_rotation:
        raise ConfigError(
            "controller.wrist_rotation: parallel ignores the rotation of the base, which inertial_damping needs; "
            "take real"
        )
    if config.coupling == "inertial_damping":
        return InertialDamping(robot, index, law, config.damping_gain)
    return MiniController(
        robot,
        index,
        law,
        aim=_AIMS[config.coupling],
        later_offset=later_home_offset(robot, index),
        ignore_base_rotation=ignore_base_rotation,
        moving_target=config.mini_reference_velocity == "full",
        reach=config.reach,
        stretch=config.beyond_reach == "stretch",
        turn=turn,
    )


def _law(config: MacroMiniConfig, robot: Robot, index: int) -> StageLaw:
    names, model = robot.stage_names, robot.stages[index].model
    if config.payload == "known":
        model = model.with_payload(sum(stage.model.mass for stage in robot.stages[index + 1 :]))
    swings = config.coupling == "inertial_damping"
    feedforward = config.feedforward if index == 0 else swings or config.mini_reference_velocity == "full"
    frequency = by_stage("controller.natural_frequency", config.natural_frequency, names)[index]
    law = WholeBodyLaw.of_stage(config, names, index, feedforward=feedforward, null_space_frequency=frequency)
    return StageLaw(model, law, robot.stages[index].home)


def _macro_offset(config: MacroMiniConfig, robot: Robot) -> FloatArray | None:
    if config.coupling == "two_way":
        return None
    follows_home = config.macro_target == "minus_home" or config.coupling not in ("one_way", "two_way")
    return later_home_offset(robot, 0) if follows_home else np.zeros(3)


def later_home_offset(robot: Robot, index: int) -> FloatArray:
    """Return the offset of the tip at home from the end point of a stage, in the base frame, shape (3,), in m."""
    points = end_points(robot, robot.home[None])[:, 0]
    return np.asarray(points[-1] - points[index])
