"""Flexible joints: springs between motors and links, by the Runge-Kutta scheme or around a physics engine.

It also contains encoders and drives of the motors; see runner/plants/friction.py for their friction.
"""

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.lazy_modules import pin
from runner.plants.compiled_motion import CompiledStep
from runner.plants.flexibility import Flexibility
from runner.plants.plant import Plant
from runner.plants.runge_kutta import runge_kutta
from runner.robots.model import RobotModel


def links_of(model: RobotModel, flexible: np.ndarray) -> RobotModel:
    """Return the model of an arm's links, without the armature of flexible joints, which belongs to their motors."""
    return model.with_armature(np.where(flexible, 0.0, model.armature))


class FlexibleJoints(Plant):
    r"""An arm with flexible joints, integrated by the classical Runge-Kutta scheme.

    .. math:: M(q) \ddot q + h(q, \dot q) = K (\theta - q) + D (\dot\theta - \dot q), \qquad
        B \ddot\theta + K (\theta - q) + D (\dot\theta - \dot q) = \tau

    The model is that of Spong (J. Dyn. Syst. Meas. Control 109, 1987): only a motor's own spin accelerates its inertia.
    On a rigid joint the torque acts directly on the link. A brake that closes stops its motor at once, whatever the
    torque. Accelerations come from compiled code if available, else from Pinocchio's articulated-body algorithm.

    Args:
        model: Rigid-body model of the links.
        flexibility: Springs, dampers and motors of the joints.
        step: Integration step, in s.
        steps_per_tick: Integration steps for which the torques of one tick are held.
    """

    def __init__(self, model: RobotModel, flexibility: Flexibility, step: float, steps_per_tick: int) -> None:
        self._model, self._data = model.separate()
        self.flexibility, self._on = flexibility, flexibility.flexible
        self._stiffness, self._motors = flexibility.stiffness[self._on], flexibility.motors[self._on]
        self._ticks, self._free = 0, np.ones(int(self._on.sum()), dtype=bool)
        self._damping = flexibility.damping[self._on]
        self._step, self._steps_per_tick = step, steps_per_tick
        self._compiled = CompiledStep.compile(model, step, flexibility)
        self.q, self.dq = np.zeros(model.nq), np.zeros(model.nq)
        self.theta: FloatArray = np.zeros(model.nq)
        """Motor positions after the gear, shape (nq,), in rad; equal to q for a rigid joint."""
        self.dtheta: FloatArray = np.zeros(model.nq)
        """Motor velocities after the gear, shape (nq,), in rad/s; equal to dq for a rigid joint."""
        self.load: FloatArray = np.zeros(model.nq)
        """External torques on the links in the next tick; see Plant."""

    def reset(self, q: FloatArray, dq: FloatArray) -> None:
        """Reset the links to a state, and the motors to static equilibrium with the links' weight; see Plant."""
        self.q[:], self.dq[:], self.dtheta[:] = q, dq, dq
        self._ticks, self.load[:] = 0, 0.0
        weight = pin.computeGeneralizedGravity(self._model, self._data, self.q)
        self.theta[:] = self.q + self.flexibility.deflection(weight)

    def set_gravity(self, gravity: FloatArray) -> None:
        """Set the gravity vector; see Plant."""
        self._model.gravity.linear = gravity
        if self._compiled is not None:
            self._compiled.set_gravity(gravity)

    def advance(self, tau: FloatArray) -> None:
        """Hold the motors' torques for one tick; see Plant."""
        on, nq = self._on, len(self.q)
        self._brake(on)
        x = np.concatenate([self.q, self.theta[on], self.dq, self.dtheta[on]])
        if self._compiled is not None:
            self._compiled.advance(x, np.concatenate([tau, self.load, self._free]), self._steps_per_tick)
        else:
            x = runge_kutta(lambda at: self._slope(at, tau), x, self._step, self._steps_per_tick)
        places, speeds = x[: len(x) // 2], x[len(x) // 2 :]
        self.q[:], self.dq[:] = places[:nq], speeds[:nq]
        self.theta[:], self.dtheta[:] = self.q, self.dq
        self.theta[on], self.dtheta[on] = places[nq:], speeds[nq:]

    def _brake(self, on: np.ndarray) -> None:
        now, self._ticks = self._ticks * self._steps_per_tick * self._step, self._ticks + 1
        self._free = now < self.flexibility.brake_time[on] - 1e-9
        self.dtheta[on] *= self._free

    def _slope(self, x: FloatArray, tau: FloatArray) -> FloatArray:
        """Return the time derivative of the state: positions of links and motors, then their velocities."""
        on, nq, n = self._on, len(self.q), len(x) // 2
        places, speeds = x[:n], x[n:]
        spring = self._stiffness * (places[nq:] - places[:nq][on]) + self._damping * (speeds[nq:] - speeds[:nq][on])
        acting = tau + self.load
        acting[on] = spring + self.load[on]
        links = pin.aba(self._model, self._data, places[:nq], speeds[:nq], acting)
        return np.concatenate([speeds, links, self._free * (tau[on] - spring) / self._motors])

    def spring_torque(self) -> FloatArray:
        """Return the torques of springs and dampers on the links, shape (nq,), in N m; 0 for a rigid joint."""
        torque, on = np.zeros(len(self.q)), self._on
        torque[on] = self._stiffness * (self.theta - self.q)[on] + self._damping * (self.dtheta - self.dq)[on]
        return torque

    def energy(self) -> float:
        """Return the energy of links, springs and motors, in J."""
        bent = (self.theta - self.q)[self._on]
        links = pin.computeMechanicalEnergy(self._model, self._data, self.q, self.dq)
        springs = 0.5 * float(self._stiffness @ bent**2)
        return float(links) + springs + 0.5 * float(self._motors @ self.dtheta[self._on] ** 2)


class SeriesElastic(FlexibleJoints):
    r"""An arm with flexible joints whose links are moved by a physics engine.

    In each step of length h, the torques of springs and dampers at its start act on the links. They also act on the
    motors, by semi-implicit Euler:

    .. math:: \dot\theta_{n+1} = \dot\theta_n + h B^{-1} (\tau - K (\theta_n - q_n) - D (\dot\theta_n - \dot q_n)),
        \qquad \theta_{n+1} = \theta_n + h \dot\theta_{n+1}

    With an engine of the same scheme (PyBullet, MuJoCo's Euler), the whole scheme is of first order. Undamped, it is
    symplectic: a mode is stable up to a rate of 2 / h, and energy is conserved in the long run.

    Args:
        engine: Plant of the links; one call of `advance` takes one step.
        model: Rigid-body model of the links.
        flexibility: Springs, dampers and motors of the joints.
        step: h, in s.
        steps_per_tick: Steps for which the torques of one tick are held.
    """

    def __init__(
        self, engine: Plant, model: RobotModel, flexibility: Flexibility, step: float, steps_per_tick: int
    ) -> None:
        super().__init__(model, flexibility, step, steps_per_tick)
        self._engine = engine
        self.q, self.dq = engine.q, engine.dq

    def reset(self, q: FloatArray, dq: FloatArray) -> None:
        """Reset links and motors to a state; see FlexibleJoints."""
        self._engine.reset(q, dq)
        super().reset(q, dq)

    def set_gravity(self, gravity: FloatArray) -> None:
        """Set the gravity vector; see Plant."""
        super().set_gravity(gravity)
        self._engine.set_gravity(gravity)

    def advance(self, tau: FloatArray) -> None:
        """Hold the motors' torques for one tick; see Plant."""
        on, h = self._on, self._step
        self._brake(on)
        for _ in range(self._steps_per_tick):
            spring = self.spring_torque()
            self._engine.advance(np.where(on, spring, tau) + self.load)
            self.dtheta[on] += h * self._free * (tau - spring)[on] / self._motors
            self.theta[on] += h * self.dtheta[on]
        self.theta[~on], self.dtheta[~on] = self.q[~on], self.dq[~on]

    def close(self) -> None:
        """Release the resources of the engine."""
        self._engine.close()


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
        self.plant, self._at_motors, self._weight = plant, at_motors, weight

    def read(self) -> tuple[FloatArray, FloatArray]:
        """Return joint positions and velocities as measured by the encoders, shapes (nq,), in rad and rad/s."""
        plant = self.plant
        if not self._at_motors:
            return plant.q, plant.dq
        if self._weight is None:
            return plant.theta, plant.dtheta
        return plant.theta - plant.flexibility.deflection(self._weight.gravity_torque(plant.theta)), plant.dtheta

    def damping(self) -> FloatArray:
        """Return the torques that the drives add to the controllers' torques, shape (nq,), in N m."""
        return self.plant.flexibility.torsion_feedback * (self.plant.dq - self.plant.dtheta)
