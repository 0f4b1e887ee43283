"""Config keys at the root of a run, values of a preset, and torque limits."""

from typing import Annotated, Literal

import numpy as np
from pydantic import Field, NonNegativeFloat, NonNegativeInt, PositiveFloat, PositiveInt

from runner.base.arrays import FloatArray
from runner.config.arms import RobotOutline
from runner.robots.robot import by_joint
from runner.schema.model import StrictModel
from runner.schema.units import Acceleration, JointTorque, Seconds
from runner.schema.values import TorquePerStage


class RunSettings(StrictModel):
    """The keys at the root of a config.

    Attributes:
        seed: Seed of all random numbers, together with the number of the repetition.
        repetitions: Number of closed-loop runs in the job.
        duration: Length of a run, in s; None takes the duration of the trajectory.
        gravity: Magnitude of gravity along -z of the base, in m/s^2, for the plant and the controllers' model.
        plant_error: True to compare the run with the same run on Runge-Kutta; see runner/metrics/plant_error.py.
        outputs: Folder in which runs are stored.
    """

    seed: NonNegativeInt
    repetitions: PositiveInt
    duration: Seconds[PositiveFloat | None]
    gravity: Acceleration[NonNegativeFloat]
    plant_error: bool
    outputs: Annotated[str, Field(min_length=1)]


class PresetConfig(StrictModel):
    """A table of values that other groups take as `${preset.x}`; those groups explain them.

    Attributes:
        gravity_compensation: Value for controllers.
        feedforward: Value for controllers.
        macro_target: Value for stage-wise control.
        mini_reference_velocity: Value for stage-wise control.
        wrist_rotation: Value for stage-wise control and plants.
        dynamics: Value for plants.
    """

    gravity_compensation: bool
    feedforward: bool
    macro_target: Literal["minus_home", "tip_goal"]
    mini_reference_velocity: Literal["zero", "full"]
    wrist_rotation: Literal["real", "parallel"]
    dynamics: Literal["coupled", "decoupled"]


class TorqueLimitsConfig(StrictModel):
    """Limits of the joint torques.

    Attributes:
        max: Largest magnitude of the torque, in N m; N for prismatic joints. One value for all joints, or a list with
            one for each; by stage if the robot has several. None for no limit.
    """

    max: JointTorque[TorquePerStage | None]

    def by_joint(self, arm: RobotOutline) -> FloatArray:
        """Return the limit of each joint of a robot, shape (nq,), in N m: the effort in the URDF if it is smaller.

        Raises:
            ConfigError: for values that do not fit the robot's stages and joints.
        """
        return np.minimum(by_joint("torque_limits.max", self.max, arm.stage_joints), arm.effort_limits)
