"""Config values per joint: one value for all joints of a stage, or a list with one for each."""

from collections.abc import Sequence

from pydantic import NonNegativeFloat, PositiveFloat

from runner.base.errors import ConfigError
from runner.base.sanitize import quoted
from runner.schema.model import StrictModel
from runner.schema.units import JointDamping, JointTorque

PositivePerJoint = PositiveFloat | list[PositiveFloat]
NonNegativePerJoint = NonNegativeFloat | list[NonNegativeFloat]


class FrictionConfig(StrictModel):
    """Config of joint friction: one value for all joints, or a list with one for each.

    Attributes:
        viscous: Torque per speed, in N m s/rad; N s/m for prismatic joints.
        coulomb: Torque against any motion, in N m; N for prismatic joints. Joints at rest move only above it.
    """

    viscous: JointDamping[NonNegativePerJoint]
    coulomb: JointTorque[NonNegativePerJoint]


def expand(key: str, value: float | list[float], joints: Sequence[str]) -> list[float]:
    """Return one value for each joint.

    Raises:
        ConfigError: if the length of a list differs from the number of joints; names the joints.
    """
    if not isinstance(value, list):
        return [value] * len(joints)
    if len(value) != len(joints):
        raise ConfigError(
            [f"{key}: {len(value)} values for {len(joints)} joints ({', '.join(joints)}); found {quoted(value)}"]
        )
    return value
