"""Dry and viscous motor friction in flexible joints."""

import numpy as np

from runner.base.arrays import FloatArray
from runner.plants.flexible_joints import FlexibleJoints


class MotorFriction:
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
        self.plant = plant
        """What friction brakes."""
        self.q, self.dq, self.load = plant.q, plant.dq, plant.load
        self._viscous, self._coulomb, self._tick = viscous, coulomb, tick
        self.friction: FloatArray = np.zeros(len(plant.q))
        """What it took from the motors' torques in the last tick; see TellsFriction."""

    def reset(self, q: FloatArray, dq: FloatArray) -> None:
        """Put the arm into a state; see Plant."""
        self.plant.reset(q, dq)

    def set_gravity(self, gravity: FloatArray) -> None:
        """Take another gravity vector; see Plant."""
        self.plant.set_gravity(gravity)

    def advance(self, tau: FloatArray) -> None:
        """Hold the motors' torques for one tick, less friction; see Plant."""
        plant, h, on = self.plant, self._tick, self.plant.flexibility.flexible
        B, b, c = plant.flexibility.motors[on], self._viscous[on], self._coulomb[on]
        free = (B * plant.dtheta[on] + h * (tau - plant.spring_torque())[on]) / (B + h * b)
        mu = np.clip(free * (B + h * b) / h, -c, c)
        self.friction[on] = b * (free - h * mu / (B + h * b)) + mu
        plant.advance(tau - self.friction)

    def close(self) -> None:
        """Release what the plant holds."""
        self.plant.close()
