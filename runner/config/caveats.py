"""Config of the caveats: the threshold of each rule."""

from typing import Annotated

from pydantic import Field, NonNegativeFloat, PositiveFloat

from runner.schema.model import StrictModel

Share = Annotated[float, Field(ge=0.0, le=1.0)]


class SaturationThreshold(StrictModel):
    """Threshold of the rule on joints at their torque limit.

    Attributes:
        share: Share of the ticks that a joint may be at its torque limit.
    """

    share: Share


class ChatterThreshold(StrictModel):
    """Threshold of the rule on torques that jump between their limits.

    Attributes:
        share: Share of its loop's ticks at which a joint's torque may jump from one limit to the opposite one.
    """

    share: Share


class FollowThreshold(StrictModel):
    """Threshold of the rule on arms that did not follow.

    Attributes:
        share: Share of the size of its motion that the tip's error may reach.
    """

    share: PositiveFloat


class JointLimitsThreshold(StrictModel):
    """Threshold of the rule on joints beyond their position limits.

    Attributes:
        excess: How far a joint may be beyond a position limit, in rad.
    """

    excess: NonNegativeFloat


class ExactVelocityThreshold(StrictModel):
    """Threshold of the rule on exact velocities beside noisy positions.

    Attributes:
        noise: Noise or resolution that measured positions may have while measured velocities are exact, in rad.
    """

    noise: NonNegativeFloat


class FixedMismatchThreshold(StrictModel):
    """Threshold of the rule on repetitions that vary noise alone.

    Attributes:
        error: Largest relative error of the model that may be the same in every repetition.
    """

    error: NonNegativeFloat


class OverloadThreshold(StrictModel):
    """Threshold of the rule on payloads beyond the rating.

    Attributes:
        share: Share of the rated payload that tool and payload may weigh.
    """

    share: PositiveFloat


class NoEffortLimitThreshold(StrictModel):
    """Threshold of the rule on arms that lift anything.

    Attributes:
        payload: Payload that an arm may carry though a joint of it has no torque limit, in kg.
    """

    payload: NonNegativeFloat


class UnstableGainsThreshold(StrictModel):
    """Threshold of the rule on gains that the control period does not bear.

    Attributes:
        share: Share of what keeps a velocity loop stable at its period that its gain may take.
    """

    share: PositiveFloat


class UnstableContactThreshold(StrictModel):
    """Threshold of the rule on contact behind joint servos.

    Attributes:
        radius: How many times a small motion in contact with a wall may grow in each period of the controller.
    """

    radius: PositiveFloat


class ShortHorizonThreshold(StrictModel):
    """Threshold of the rule on runs that end before their law has done its work.

    Attributes:
        share: Share of the run that three time constants of the law's slowest part may take.
    """

    share: PositiveFloat


class DefaultPlantThreshold(StrictModel):
    """Threshold of the rule on a plant that stands in for the default one.

    Attributes:
        replaced: 0 tells of it, 1 does not.
    """

    replaced: Share


class RobotFileThreshold(StrictModel):
    """Threshold of the rule on what is not taken from the file of a robot.

    Attributes:
        left_out: How many things that would change the motion may be left out.
    """

    left_out: NonNegativeFloat


class PlantErrorThreshold(StrictModel):
    """Threshold of the rule on the plant's own error.

    Attributes:
        share: Share of a metric that the plant's step may be worth; 1 silences the rule.
    """

    share: Share


class CaveatsConfig(StrictModel):
    """When a run tells that its result may mislead; a rule each, which is sprung by what is above its threshold.

    Attributes:
        saturation: A joint at its torque limit.
        chatter: A joint's torque that jumps between its limits.
        did_not_follow: The tip's error, beside the size of its motion.
        joint_limits: Joints beyond their position limits.
        exact_velocity: Exact velocities beside noisy positions.
        fixed_mismatch: Repetitions that vary noise alone, under a wrong model.
        overload: A payload beyond the rating.
        no_effort_limit: A payload on an arm that lifts anything.
        unstable_gains: A velocity gain that its control period does not bear.
        unstable_contact: A wall too stiff for an admittance behind joint servos, or for a law that pushes by torques.
        short_horizon: A run that ends before its law has done its work.
        default_plant: Another plant in place of the default one.
        robot_file: What is not taken from the robot's file.
        plant_error: What the plant's step is worth, of a run that was held against Runge-Kutta.
    """

    saturation: SaturationThreshold
    chatter: ChatterThreshold
    did_not_follow: FollowThreshold
    joint_limits: JointLimitsThreshold
    exact_velocity: ExactVelocityThreshold
    fixed_mismatch: FixedMismatchThreshold
    overload: OverloadThreshold
    no_effort_limit: NoEffortLimitThreshold
    unstable_gains: UnstableGainsThreshold
    unstable_contact: UnstableContactThreshold
    short_horizon: ShortHorizonThreshold
    default_plant: DefaultPlantThreshold
    robot_file: RobotFileThreshold
    plant_error: PlantErrorThreshold
