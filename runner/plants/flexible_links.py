"""Flexible-link plant, integrated by the Runge-Kutta scheme."""

from collections.abc import Sequence

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.errors import SimulationError
from runner.base.lazy_modules import pin
from runner.plants.flexible_joints import runge_kutta
from runner.plants.plant import Plant
from runner.robots.chain import Chain

_MOST_STEPS = 50
_AT_REST = 1e-10  # N m
_FARTHEST = 0.5  # rad, largest deflection of a spring


class FlexibleLinks(Plant):
    r"""A chain of rigid segments with springs between them, integrated by the classical Runge-Kutta scheme.

    .. math:: M(x) \ddot x + h(x, \dot x) + K x + D \dot x = \tau

    x contains the joints, which the motors drive, and the bending angles of the links, which have springs and dampers.
    Pinocchio computes the dynamics.

    Args:
        chain: Segments of the arm.
        motors: B, inertia of each joint's motor after its gear, shape (nq,), in kg m^2.
        damping: D among the springs, shape (k, k), in N m s/rad.
        step: Integration step, in s.
        steps_per_tick: Integration steps for which the torques of one tick are held.
        ends: Frames at which the stages end, from the base outwards.
    """

    bends = True

    def __init__(
        self,
        chain: Chain,
        motors: FloatArray,
        damping: FloatArray,
        step: float,
        steps_per_tick: int,
        ends: Sequence[str],
    ) -> None:
        self._model = pin.Model(chain.pin_model)
        armature = np.zeros(self._model.nv)
        armature[chain.motors] = motors
        self._model.armature = armature
        self._data = self._model.createData()
        self._driven, self._springs = chain.motors, chain.springs
        self._K = np.zeros(self._model.nv)
        self._K[chain.springs] = chain.stiffness
        self._D = damping
        self._step, self._steps_per_tick = step, steps_per_tick
        self._ends = [self._model.getFrameId(name) for name in ends]
        self.places: FloatArray = np.zeros(self._model.nq)
        """x, shape (nq + k,), in rad."""
        self.speeds: FloatArray = np.zeros(self._model.nq)
        """dx/dt, shape (nq + k,), in rad/s."""
        self._time = 0.0
        self.q, self.dq = np.zeros(len(chain.motors)), np.zeros(len(chain.motors))

    def reset(self, q: FloatArray, dq: FloatArray) -> None:
        """Reset the joints to a state, and the links to static equilibrium with their weight; see Plant.

        Raises:
            SimulationError: if no equilibrium is found, or a spring bends too far for the chain to model a beam.
        """
        self._time = 0.0
        self.q[:], self.dq[:] = q, dq
        self.places[:] = self.speeds[:] = 0.0
        self.places[self._driven], self.speeds[self._driven] = q, dq
        on = self._springs
        for _ in range(_MOST_STEPS):
            left = pin.computeGeneralizedGravity(self._model, self._data, self.places) + self._K * self.places
            if np.abs(left[on]).max() < _AT_REST and np.abs(self.places[on]).max() < _FARTHEST:
                return
            slope = pin.computeGeneralizedGravityDerivatives(self._model, self._data, self.places) + np.diag(self._K)
            self.places[on] -= np.linalg.solve(slope[np.ix_(on, on)], left[on])
        raise SimulationError(
            f"a spring of the links bends by more than {_FARTHEST:g} rad under their weight", 0.0, None
        )

    def set_gravity(self, gravity: FloatArray) -> None:
        """Set the gravity vector; see Plant."""
        self._model.gravity.linear = gravity

    def advance(self, tau: FloatArray) -> None:
        """Hold the motors' torques for one tick; see Plant.

        Raises:
            SimulationError: if a spring bends too far for the chain to model a beam.
        """
        h, n = self._step, len(self.places)
        acting = np.zeros(n)
        acting[self._driven] = tau
        x = np.concatenate([self.places, self.speeds])
        x = runge_kutta(lambda at: self._slope(at, acting), x, h, self._steps_per_tick)
        self.places[:], self.speeds[:] = x[:n], x[n:]
        self._time += self._steps_per_tick * h
        if np.abs(self.places[self._springs]).max() > _FARTHEST:  # the loop reports values that are not finite
            raise SimulationError(f"a spring of the links bends by more than {_FARTHEST:g} rad", self._time, None)
        self.q[:], self.dq[:] = self.places[self._driven], self.speeds[self._driven]

    def _slope(self, x: FloatArray, acting: FloatArray) -> FloatArray:
        n = len(acting)
        places, speeds = x[:n], x[n:]
        forces = acting - self._K * places
        forces[self._springs] -= self._D @ speeds[self._springs]
        return np.concatenate([speeds, pin.aba(self._model, self._data, places, speeds, forces)])

    def end_points(self) -> FloatArray:
        """Return the end point of each stage, shape (stages, 3), in m."""
        pin.framesForwardKinematics(self._model, self._data, self.places)
        return np.array([self._data.oMf[end].translation for end in self._ends])

    def tip_motion(self) -> FloatArray:
        """Return position and velocity of the tip, shape (2, 3), in m and m/s."""
        model, data, tip = self._model, self._data, self._ends[-1]
        pin.forwardKinematics(model, data, self.places, self.speeds)
        place = pin.updateFramePlacement(model, data, tip)
        return np.array([place.translation, pin.getFrameVelocity(model, data, tip, pin.LOCAL_WORLD_ALIGNED).linear])

    def energy(self) -> float:
        """Return the energy of segments, motors and springs, in J."""
        M = np.triu(pin.crba(self._model, self._data, self.places))  # with the motors
        kinetic = float(self.speeds @ (M @ self.speeds)) - 0.5 * float(np.diag(M) @ self.speeds**2)
        weight = float(pin.computePotentialEnergy(self._model, self._data, self.places))
        return kinetic + weight + 0.5 * float(self._K @ self.places**2)
