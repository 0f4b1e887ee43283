"""Config of the robot."""

from typing import Annotated

from pydantic import Field, NonNegativeFloat, PositiveFloat

from runner.config.per_joint import PositivePerJoint
from runner.registry import StrictModel


class RobotConfig(StrictModel):
    """A robot and the values that its sources give for it; other groups take them as `${robot.x}`.

    Attributes:
        name: Its name.
        urdf: Its URDF: a file among ours, in a config folder of the user's, or an absolute path.
        tip: Name of the frame that is controlled.
        home: Joint positions at home, in rad.
        masses: Mass of links by name, in kg, in place of the URDF's.
        goal: Tip position that goal and quintic go to, in m.
        natural_frequency: omega_n of its controller, in rad/s.
        damping_ratio: xi of its controller.
        period: Its controller's period, in s.
        joint_error_limit: Error of its joint positions, in rad.
        torque_limit: Its largest continuous torque, in N m.
        settling_band: Tip error within which it counts as settled, on each axis, in m.
    """

    name: Annotated[str, Field(min_length=1)]
    urdf: Annotated[str, Field(min_length=1)]
    tip: Annotated[str, Field(min_length=1)]
    home: list[float]
    masses: dict[str, PositiveFloat]
    goal: Annotated[list[float], Field(min_length=3, max_length=3)]
    natural_frequency: PositiveFloat
    damping_ratio: PositiveFloat
    period: PositiveFloat
    joint_error_limit: NonNegativeFloat
    torque_limit: PositivePerJoint
    settling_band: PositiveFloat
