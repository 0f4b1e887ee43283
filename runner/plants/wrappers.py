"""Plants around another plant: contact of the tip with a surface, and payload changes during the motion."""

from collections.abc import Sequence
from typing import Protocol

import numpy as np

from runner.base import portable
from runner.base.arrays import FloatArray
from runner.base.lazy_modules import pin
from runner.plants.plant import Plant, PlantWrapper
from runner.robots.model import RobotModel


class Surface(Protocol):
    """A surface that exerts a force on the tip, as a function of the tip's position and velocity; see Environment."""

    def reset(self, tip: FloatArray) -> None:
        """Start with the tip at a position in the base frame, shape (3,), in m."""

    def wrench(self, time: float, tip: FloatArray, velocity: FloatArray) -> FloatArray:
        """Return force in N and moment about the tip in N m, along the base's axes, shape (6,)."""
        ...


class WithTipContact(PlantWrapper):
    r"""A plant whose tip, a point, touches a surface; the contact force is held for an integration step.

    The force f(x, v) of a step from q_n is evaluated at

    .. math:: x = x(q_n + \lambda h \dot q_n), \qquad v = J \dot q_n

    lambda is 0 if a step moves positions by the velocity at its end (semi-implicit Euler). It is 1/2 if a step
    integrates positions exactly under held torques (Runge-Kutta). On a spring both are the leapfrog scheme: an undamped
    wall conserves energy. The relative error of the peak force is (omega h)^2 / 8. A spring is stable for omega h < 2.

    Args:
        plant: The plant; one call of `advance` takes one step. The load on the joints is added to its torques.
        model: Model of the arm, for its tip.
        surface: The surface.
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
        """Reset the arm to a state, and the surface to the tip's position in it; see Plant."""
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
        """Return the surface's joint torques at the tip's position after `ahead` seconds; store its wrench."""
        model, data = self._model, self._data
        pin.computeJointJacobians(model, data, self.q + ahead * self.dq)
        tip = pin.updateFramePlacement(model, data, self._tip)
        J = pin.getFrameJacobian(model, data, self._tip, pin.LOCAL_WORLD_ALIGNED)
        applied = self._surface.wrench(self._time + ahead, tip.translation.copy(), portable.dot(J[:3], self.dq))
        self._wrench[:] = applied
        self._wrench[3:] += np.cross(tip.translation, applied[:3])
        return portable.dot(J.T, applied)

    def contact_wrench(self) -> FloatArray:
        """Return the wrench of the surface on the arm in the current state; see Plant."""
        return self._wrench


class PayloadChanges(PlantWrapper):
    """Plants of one arm, each with another payload.

    At a change, the arm keeps its position and velocity. The new payload starts with the velocity of the tip, and no
    impact occurs. A payload picked up at rest by a moving tip would cause one.

    Args:
        plants: Plant of each payload, in order.
        ticks: First tick of each plant except the first, ascending.
    """

    def __init__(self, plants: Sequence[Plant], ticks: Sequence[int]) -> None:
        super().__init__(plants[0])
        self._plants, self._ticks = plants, ticks
        self._tick = 0
        self.q, self.dq = self.q.copy(), self.dq.copy()

    def reset(self, q: FloatArray, dq: FloatArray) -> None:
        """Reset the arm to a state, with its first payload; see Plant."""
        self._tick, self.plant = 0, self._plants[0]
        self._put(q, dq)

    def set_gravity(self, gravity: FloatArray) -> None:
        """Set the gravity vector; see Plant."""
        for plant in self._plants:
            plant.set_gravity(gravity)

    def advance(self, tau: FloatArray) -> None:
        """Hold the torques for one tick; see Plant."""
        now = self._plants[int(np.searchsorted(self._ticks, self._tick, side="right"))]
        if now is not self.plant:
            self.plant = now
            self._put(self.q, self.dq)
        self.plant.advance(tau)
        self.q[:], self.dq[:] = self.plant.q, self.plant.dq
        self._tick += 1

    def close(self) -> None:
        """Release the resources of the plants."""
        for plant in self._plants:
            plant.close()

    def _put(self, q: FloatArray, dq: FloatArray) -> None:
        self.plant.reset(q, dq)
        self.q[:], self.dq[:] = q, dq
