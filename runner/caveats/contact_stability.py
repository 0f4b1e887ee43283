"""Contact with a wall at the start of a run.

Import this module only if rigid-body models are available.
"""

import math

import numpy as np

from runner.assembly.run_config import RunConfig
from runner.base.arrays import FloatArray
from runner.caveats.servo_contact_stability import ServoContact
from runner.controllers import CommandsForce
from runner.controllers.force.hybrid_force import HybridForceConfig
from runner.controllers.stability import touch_radius
from runner.plants import PLANTS, options_of
from runner.plants.servo import ServoLaw
from runner.robots.task_space import mass_along, tip_mobility


def servo_contact(config: RunConfig, q_start: FloatArray) -> ServoContact | None:
    """Return the contact of a servo-driven arm with a wall; None if the run has none or the model does not cover it.

    Args:
        config: The checked config.
        q_start: Joint positions at the start, shape (nq,), in rad.
    """
    plant, law, wall, timing = config.plant, config.controller, config.wall, config.timing
    servo, sensor = options_of(plant).servo, config.force_torque_sensor
    if wall is None or not isinstance(law, CommandsForce) or servo is None:
        return None
    if not config.takes_torques or config.commands != "position" or len(config.arm.stages) > 1:
        return None
    if config.robot.tool is None or sensor is None:
        return None
    low_pass = sensor.low_pass
    return ServoContact(
        arm=config.arm,
        q=q_start,
        servo=ServoLaw(config.arm.model, servo, config.arm.home),
        step=timing.step,
        steps=timing.steps_per_tick,
        tick=timing.tick,
        ticks=round(law.period / timing.tick),
        delay=timing.late[0],
        interpolate=servo.interpolate,
        implicit=PLANTS.features(plant.kind).IMPLICIT_CONTACT,
        law=law.law,
        at_tip=law.wrench_frame == "tip",
        inertia=law.compensation == "gravity_and_inertia",
        seen=1.0 if low_pass is None else float(-np.expm1(-2.0 * np.pi * low_pass * timing.tick)),
        normal=np.array(wall.normal) / np.linalg.norm(wall.normal),
        stiffness=wall.stiffness,
        damping=wall.damping,
    )


def force_contact(config: RunConfig, q_start: FloatArray) -> float | None:
    """Return the growth factor of a small motion on a wall in one period of a hybrid force law, or None without one.

    Args:
        config: The checked config.
        q_start: Joint positions at the start, shape (nq,), in rad.
    """
    wall, law, loop, timing = config.wall, config.controller, config.loops[-1], config.timing
    if wall is None or not isinstance(law, HybridForceConfig) or law.force_source != "wrist":
        return None
    if config.force_torque_sensor is None:
        return None
    normal = np.array(wall.normal) / np.linalg.norm(wall.normal)
    mass = mass_along(tip_mobility(config.arm.model, q_start, loop.joints.start), normal)
    late = math.ceil(timing.late[-1] * timing.tick / loop.period - 1e-9)
    gains = law.force_gain, law.force_damping
    return touch_radius(gains, mass, wall.stiffness, wall.damping, law.wall_stiffness, loop.period, late)
