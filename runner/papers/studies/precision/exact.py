"""Reference solutions of motion under constant torques in double precision, by two independent methods."""

import numpy as np
import pinocchio as pin
from scipy.integrate import solve_ivp

from runner.base.arrays import FloatArray
from runner.plants import Plant
from runner.robots.model import RobotModel

_LEAST = 100.0 * np.finfo(float).eps  # the relative tolerance that SciPy takes
_STAGES, _STEP = 8, 0.0025  # of the collocation; its longest step, in s
_ITERATIONS, _SETTLED = 60, 4e-16  # at most; the change relative to the state at which its stages are taken as solved


class _Arm(Plant):
    """The state of an arm on the ground; see Plant.

    Args:
        model: The arm.
    """

    def __init__(self, model: RobotModel) -> None:
        self._model, self._data = model.pin_model, model.pin_model.createData()
        self.q, self.dq = np.zeros(model.nq), np.zeros(model.nq)

    def reset(self, q: FloatArray, dq: FloatArray) -> None:
        """Put the arm into a state; see Plant."""
        self.q[:], self.dq[:] = q, dq


class AdaptiveStep(_Arm):
    """Dormand and Prince's pair of order 8 with step control (DOP853), on the articulated-body algorithm.

    Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, 2nd edition, 1993, section II.10.

    Args:
        model: The arm.
        tick: Time for which torques are held, in s.
        tolerance: Of the error in a step, relative and, in rad and rad/s, absolute.
    """

    def __init__(self, model: RobotModel, tick: float, tolerance: float) -> None:
        super().__init__(model)
        self._tick, self._tolerance = tick, tolerance

    def advance(self, tau: FloatArray) -> None:
        """Hold the torques for one tick; see Plant."""
        model, data, n = self._model, self._data, len(self.q)

        def slope(_time: float, state: FloatArray) -> FloatArray:
            return np.concatenate([state[n:], pin.aba(model, data, state[:n], state[n:], tau)])

        start = np.concatenate([self.q, self.dq])
        ended = solve_ivp(
            slope, (0.0, self._tick), start, "DOP853", rtol=max(self._tolerance, _LEAST), atol=self._tolerance
        )
        self.q[:], self.dq[:] = ended.y[:n, -1], ended.y[n:, -1]


class Collocation(_Arm):
    r"""Gauss' collocation of order 16, on mass matrix and bias of recursive Newton-Euler.

    A polynomial through the stages' accelerations is integrated twice, to velocities and positions:

    .. math::

        v_i = v + h \sum_j A_{ij} a_j, \qquad q_i = q + h c_i v + h^2 \sum_j (A^2)_{ij} a_j, \qquad
        M(q_i) a_i = \tau - b(q_i, v_i)

    Hairer, Norsett, Wanner, as above, section II.7. The stages are solved by fixed point, to the last digits.

    Args:
        model: The arm.
        tick: Time for which torques are held, in s.
    """

    def __init__(self, model: RobotModel, tick: float) -> None:
        super().__init__(model)
        self._steps = int(np.ceil(tick / _STEP - 1e-9))
        self._h = tick / self._steps
        nodes, weights = np.polynomial.legendre.leggauss(_STAGES)
        self._c, self._b = (nodes + 1.0) / 2.0, weights / 2.0
        # A V = diag(c^k / k) for the powers c^(k - 1) in V: what integrates every polynomial through the stages.
        powers = np.arange(1, _STAGES + 1)
        self._A = np.linalg.solve((self._c[:, None] ** (powers - 1)).T, (self._c[:, None] ** powers / powers).T).T
        self._AA = self._A @ self._A

    def advance(self, tau: FloatArray) -> None:
        """Hold the torques for one tick; see Plant."""
        h, b, c = self._h, self._b, self._c
        a = np.tile(self._acceleration(self.q, self.dq, tau), (_STAGES, 1))
        for _ in range(self._steps):
            q, v = self.q, self.dq
            for _ in range(_ITERATIONS):
                at = q + h * c[:, None] * v + h * h * (self._AA @ a)
                speed = v + h * (self._A @ a)
                found = np.array([self._acceleration(*state, tau) for state in zip(at, speed, strict=True)])
                change = h * float(np.abs(found - a).max())
                a = found
                if change <= _SETTLED * (1.0 + float(np.abs(speed).max())):
                    break
            self.q = q + h * v + h * h * ((b * (1.0 - c)) @ a)
            self.dq = v + h * (b @ a)

    def _acceleration(self, q: FloatArray, v: FloatArray, tau: FloatArray) -> FloatArray:
        mass = pin.crba(self._model, self._data, q)
        mass = np.triu(mass) + np.triu(mass, 1).T
        return np.linalg.solve(mass, tau - pin.nonLinearEffects(self._model, self._data, q, v))


def energy_drift(model: RobotModel, q: FloatArray, dq: FloatArray) -> float:
    """Return by how much kinetic and potential energy change along a motion, over the largest kinetic energy.

    Args:
        model: The arm.
        q: Joint positions, shape (T, nq), in rad.
        dq: Joint velocities, shape (T, nq), in rad/s.
    """
    kinetic = max(float(0.5 * v @ model.mass_matrix(x) @ v) for x, v in zip(q, dq, strict=True))
    total = np.array([model.energy(*state) for state in zip(q, dq, strict=True)])
    return float(np.abs(total - total[0]).max() / kinetic)
