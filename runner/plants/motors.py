"""Motors of flexible joints: encoders, drives and friction."""

import numpy as np

from runner.base.arrays import FloatArray
from runner.plants.flexible_joints import FlexibleJoints
from runner.plants.plant import PlantWrapper
from runner.robots.model import RobotModel


class MotorSide:
    r"""Encoder readings of flexible joints without noise, and the torques that drives add.

    Encoders at the motors measure

    .. math:: \hat q = \theta - K^{-1} G(\theta), \qquad \hat{\dot q} = \dot\theta

    At rest q-hat differs from q by K^-1 (G(q) - G(theta)), of second order in 1/K. Without correction, it is theta.

    Drives with exact encoders on both sides add the fast part of composite control (Spong, J. Dyn. Syst. Meas. Control
    109, 1987), at the ticks of each control loop:

    .. math:: \tau = \tau_{law} - K_f (\dot\theta - \dot q)

    It damps the vibration of the springs, which a rigid-arm control law with encoders at the links would excite.

    Args:
        plant: The plant with the springs.
        at_motors: True if the controllers read encoders at the motors, False for encoders at the links.
        weight: Nominal model whose weight deflects the joints; None for readings without correction.
    """

    def __init__(self, plant: FlexibleJoints, at_motors: bool, weight: RobotModel | None) -> None:
        self._plant, self._at_motors, self._weight = plant, at_motors, weight

    def read(self) -> tuple[FloatArray, FloatArray]:
        """Return joint positions and velocities as measured by the encoders, shapes (nq,), in rad and rad/s."""
        plant = self._plant
        if not self._at_motors:
            return plant.q, plant.dq
        if self._weight is None:
            return plant.theta, plant.dtheta
        return plant.theta - plant.flexibility.deflection(self._weight.gravity_torque(plant.theta)), plant.dtheta

    def damping(self) -> FloatArray:
        """Return the torques that the drives add to the controllers' torques, shape (nq,), in N m."""
        return self._plant.flexibility.torsion_feedback * (self._plant.dq - self._plant.dtheta)


class MotorFriction(PlantWrapper):
    r"""Flexible joints with motor friction, by backward Euler over the tick h.

    .. math:: (B + h b) \dot\theta^+ = B \dot\theta + h (\tau - K (\theta - q) - D (\dot\theta - \dot q) - \mu), \quad
        \mu \in c \, \mathrm{sgn}(\dot\theta^+), \qquad \tau_f = -b \dot\theta^+ - \mu

    mu is the torque that stops a motor within the tick, or the whole c if that does not suffice; see Frictional. The
    motors do not act on each other. tau_f and the springs' torques are held over the tick and are of first order in h.

    Args:
        plant: The plant without friction.
        viscous: b of each joint's motor, shape (nq,), in N m s/rad; 0 for a rigid joint.
        coulomb: c of each joint's motor, shape (nq,), in N m; 0 for a rigid joint.
        tick: h, in s.
    """

    def __init__(self, plant: FlexibleJoints, viscous: FloatArray, coulomb: FloatArray, tick: float) -> None:
        super().__init__(plant)
        self._springs = plant
        self._viscous, self._coulomb, self._tick = viscous, coulomb, tick
        self._friction = np.zeros(len(plant.q))

    @property
    def friction(self) -> FloatArray:
        """Friction torques in the last tick; see Plant."""
        return self._friction

    def advance(self, tau: FloatArray) -> None:
        """Hold the motors' torques minus friction for one tick; see Plant."""
        plant, h, on = self._springs, self._tick, self._springs.flexibility.flexible
        B, b, c = plant.flexibility.motors[on], self._viscous[on], self._coulomb[on]
        free = (B * plant.dtheta[on] + h * (tau - plant.spring_torque())[on]) / (B + h * b)
        mu = np.clip(free * (B + h * b) / h, -c, c)
        self._friction[on] = b * (free - h * mu / (B + h * b)) + mu
        plant.advance(tau - self._friction)
