"""Encoders that turn with the motors of flexible joints."""

from runner.plants.flexible_joints import Flexibility, FlexibleJoints
from runner.robots.model import FloatArray, RobotModel


class MotorSide:
    r"""What encoders at the motors see of the joints, before their noise.

    .. math:: \hat q = \theta - K^{-1} G(\theta), \qquad \hat{\dot q} = \dot\theta

    At rest q-hat differs from q by K^-1 (G(q) - G(theta)), of second order in 1/K. Without the correction it is theta.

    Args:
        plant: The plant whose motors turn.
        flexibility: Its springs.
        weight: The arm as it is believed, whose weight bends the joints; None for readings without correction.
    """

    def __init__(self, plant: FlexibleJoints, flexibility: Flexibility, weight: RobotModel | None) -> None:
        self._plant, self._flexibility, self._weight = plant, flexibility, weight

    def read(self) -> tuple[FloatArray, FloatArray]:
        """Return positions and velocities of the joints as the motors tell them, shapes (nq,), in rad and rad/s."""
        theta, dtheta = self._plant.theta, self._plant.dtheta
        if self._weight is None:
            return theta, dtheta
        return theta - self._flexibility.deflection(self._weight.gravity_torque(theta)), dtheta
