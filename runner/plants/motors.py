"""Encoders and drives of flexible joints: motor-side encoders, or encoders on both sides."""

from runner.base.arrays import FloatArray
from runner.plants.flexible_joints import FlexibleJoints
from runner.robots.model import RobotModel


class MotorSide:
    r"""What encoders see of flexible joints, before their noise, and what drives add to the torques of laws.

    Encoders that turn with the motors see

    .. math:: \hat q = \theta - K^{-1} G(\theta), \qquad \hat{\dot q} = \dot\theta

    At rest q-hat differs from q by K^-1 (G(q) - G(theta)), of second order in 1/K. Without the correction it is theta.

    Drives with encoders on both sides, exact ones, add the fast part of composite control (Spong, J. Dyn. Syst. Meas.
    Control 109, 1987), at the ticks of each control loop:

    .. math:: \tau = \tau_{law} - K_f (\dot\theta - \dot q)

    It takes down the vibration of the springs, which a law for the rigid arm by encoders at the links would excite.

    Args:
        plant: The plant with the springs.
        at_motors: Whether the encoders that laws read turn with the motors, else with the links.
        weight: The nominal arm, whose weight bends the joints; None for readings without correction.
    """

    def __init__(self, plant: FlexibleJoints, at_motors: bool, weight: RobotModel | None) -> None:
        self._plant, self._at_motors, self._weight = plant, at_motors, weight

    def read(self) -> tuple[FloatArray, FloatArray]:
        """Return positions and velocities of the joints as encoders tell them, shapes (nq,), in rad and rad/s."""
        plant = self._plant
        if not self._at_motors:
            return plant.q, plant.dq
        if self._weight is None:
            return plant.theta, plant.dtheta
        return plant.theta - plant.flexibility.deflection(self._weight.gravity_torque(plant.theta)), plant.dtheta

    def damping(self) -> FloatArray:
        """Return what drives add to the torques that laws ask for, shape (nq,), in N m."""
        return self._plant.flexibility.torsion_feedback * (self._plant.dq - self._plant.dtheta)
