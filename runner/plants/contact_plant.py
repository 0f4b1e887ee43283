"""Tip contact with a surface, evaluated at every integration step."""

from typing import Protocol

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.lazy_modules import pin
from runner.plants.plant import Plant, PlantWrapper
from runner.robots.model import RobotModel


class Surface(Protocol):
    """What the tip touches: a force that follows from where the tip is and how fast; see Environment."""

    def reset(self, tip: FloatArray) -> None:
        """Start with the tip at a position in the base frame, shape (3,), in m."""

    def wrench(self, time: float, tip: FloatArray, velocity: FloatArray) -> FloatArray:
        """Return force in N and moment about the tip in N m, along the base's axes, shape (6,)."""
        ...


class WithTipContact(PlantWrapper):
    r"""A plant of which the tip, a point, touches a surface: its force is held for an integration step.

    The force f(x, v) of a step from q_n is taken at

    .. math:: x = x(q_n + \lambda h \dot q_n), \qquad v = J \dot q_n

    Where a step moves positions by the velocity at its end (semi-implicit Euler), lambda is 0; where it moves them
    exactly under what is held (Runge-Kutta), it is 1/2. On a spring both are the leapfrog scheme: no energy is gained
    or lost on an undamped wall, the peak of a push is right to (omega h)^2 / 8, and a spring is stable up to
    omega h = 2.

    Args:
        plant: The plant; one `advance` of it takes a step. What loads the joints is added to its torques.
        model: The arm, for its tip.
        surface: What the tip touches.
        step: h, in s.
        steps_per_tick: Integration steps for which the torques of one tick are held.
        lead: lambda.
    """

    def __init__(
        self, plant: Plant, model: RobotModel, surface: Surface, step: float, steps_per_tick: int, lead: float
    ) -> None:
        super().__init__(plant)
        self._surface = surface
        self._model, self._tip = model.pin_model, model.tip_frame
        self._data = self._model.createData()
        self._step, self._steps_per_tick, self._lead = step, steps_per_tick, lead
        self._time = 0.0
        self._wrench = np.zeros(6)

    def reset(self, q: FloatArray, dq: FloatArray) -> None:
        """Put the arm into a state, and the surface where it stands to the tip there; see Plant."""
        super().reset(q, dq)
        pin.forwardKinematics(self._model, self._data, q)
        self._surface.reset(pin.updateFramePlacement(self._model, self._data, self._tip).translation.copy())
        self._time = 0.0
        self._touch(0.0)

    def advance(self, tau: FloatArray) -> None:
        """Hold the torques for one tick; see Plant."""
        for _ in range(self._steps_per_tick):
            self.plant.push(tau, self._touch(self._lead * self._step))
            self._time += self._step
        self._touch(0.0)

    def _touch(self, ahead: float) -> FloatArray:
        """Return the joint torques of the surface where the tip goes in a time, in s; keep its wrench."""
        model, data = self._model, self._data
        pin.computeJointJacobians(model, data, self.q + ahead * self.dq)
        tip = pin.updateFramePlacement(model, data, self._tip)
        J = pin.getFrameJacobian(model, data, self._tip, pin.LOCAL_WORLD_ALIGNED)
        applied = self._surface.wrench(self._time + ahead, tip.translation.copy(), J[:3] @ self.dq)
        self._wrench[:] = applied
        self._wrench[3:] += np.cross(tip.translation, applied[:3])
        load: FloatArray = J.T @ applied
        return load

    def contact_wrench(self) -> FloatArray:
        """Return the wrench of the surface on the arm in the state that it has now; see Plant."""
        return self._wrench
