"""Motors of flexible joints: encoders, drives and friction."""

import numpy as np

from runner.base.arrays import FloatArray
from runner.plants.flexible_joints import FlexibleJoints
from runner.plants.plant import PlantWrapper
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


class MotorFriction(PlantWrapper):
    r"""Flexible joints whose motors are braked by friction, by backward Euler over the tick h.

    .. math:: (B + h b) \dot\theta^+ = B \dot\theta + h (\tau - K (\theta - q) - D (\dot\theta - \dot q) - \mu), \quad
        \mu \in c \, \mathrm{sgn}(\dot\theta^+), \qquad \tau_f = -b \dot\theta^+ - \mu

    mu is what stops a motor within the tick, or the whole c where that does not suffice; see Frictional, which this is
    for motors: none feels another. tau_f and the springs' torques are held over the tick: first order in it.

    Args:
        plant: The plant without friction.
        viscous: b of each joint's motor, shape (nq,), in N m s/rad; 0 where the joint is rigid.
        coulomb: c of each joint's motor, shape (nq,), in N m; likewise.
        tick: h, in s.
    """

    def __init__(self, plant: FlexibleJoints, viscous: FloatArray, coulomb: FloatArray, tick: float) -> None:
        super().__init__(plant)
        self._springs = plant
        self._viscous, self._coulomb, self._tick = viscous, coulomb, tick
        self._friction = np.zeros(len(plant.q))

    @property
    def friction(self) -> FloatArray:
        """Torques of friction in the last tick; see Plant."""
        return self._friction

    def advance(self, tau: FloatArray) -> None:
        """Hold the motors' torques for one tick, less friction; see Plant."""
        plant, h, on = self._springs, self._tick, self._springs.flexibility.flexible
        B, b, c = plant.flexibility.motors[on], self._viscous[on], self._coulomb[on]
        free = (B * plant.dtheta[on] + h * (tau - plant.spring_torque())[on]) / (B + h * b)
        mu = np.clip(free * (B + h * b) / h, -c, c)
        self._friction[on] = b * (free - h * mu / (B + h * b)) + mu
        plant.advance(tau - self._friction)
