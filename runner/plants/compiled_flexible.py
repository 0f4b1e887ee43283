"""Compiled steps of a flexible-joint arm: the classical Runge-Kutta scheme on links and motors."""

from collections.abc import Callable, Sequence
from typing import Any, NamedTuple

import numpy as np

from runner.base.arrays import FloatArray
from runner.plants.compiled_motion import ArmCode, Mover
from runner.robots.model import RobotModel
from runner.symbolic.algebra import ArmAlgebra
from runner.symbolic.arm import to_scalars
from runner.symbolic.code import ROWS, STATE, Part, Slots
from runner.symbolic.engine import MOST_JOINTS, evaluator
from runner.symbolic.structure import any_number, arm_pattern
from runner.symbolic.vectors import Vector


class Springs(NamedTuple):
    """Parameters of the springs and motors of the m flexible joints.

    Attributes:
        stiffness: K, shape (m,), in N m/rad.
        damping: D, shape (m,), in N m s/rad.
        motors: B, shape (m,), in kg m^2.
    """

    stiffness: Vector
    damping: Vector
    motors: Vector


class _FlexibleMover(Mover):
    """Motion of links and motors; positions are those of n links and then of m motors. See FlexibleJoints.

    Args:
        algebra: Algebra of the links.
        on: Indices of the m flexible joints among the n joints.
        links: n.
        springs: Parameters of the springs and motors.
        given: Motor torques and external torques on the links, shapes (n,), and for each motor 0 if its brake is
            closed, else 1, shape (m,).
        at: Allocator of slots.
    """

    def __init__(
        self, algebra: ArmAlgebra, on: Sequence[int], links: int, springs: Springs, given: Vector, at: Slots
    ) -> None:
        super().__init__(algebra, 0, links + len(on), links + len(on), at)
        self._links, self._on, self._springs = links, on, springs
        self._load, self._free = given[links : 2 * links], given[2 * links :]

    def acceleration(self, q: Vector, v: Vector, tau: Vector) -> Vector:
        """Return the accelerations of links and motors under motor torques, shape (n,); see Mover."""
        n, acting, motors = self._links, list(tau), []
        for index, (joint, K, D, B) in enumerate(zip(self._on, *self._springs, strict=True)):
            spring = K * (q[n + index] - q[joint]) + D * (v[n + index] - v[joint])
            motors.append(self._free[index] * (tau[joint] - spring) / B)
            acting[joint] = spring
        pushed = [torque + load for torque, load in zip(acting, self._load, strict=True)]
        return [*super().acceleration(q[:n], v[:n], pushed), *motors]


class CompiledFlexibleStep(ArmCode):
    """Compiled integration steps of an arm with flexible joints, without friction.

    Args:
        model: Rigid-body model of the links.
        flexible: True for each joint with a spring, shape (n,).
        stiffness: K, damping: D, motors: B of each joint, shapes (n,).
        step: Integration step, in s.
    """

    def __init__(
        self,
        model: RobotModel,
        flexible: FloatArray,
        stiffness: FloatArray,
        damping: FloatArray,
        motors: FloatArray,
        step: float,
    ) -> None:
        super().__init__(model, step)
        self._on = np.flatnonzero(flexible).tolist()
        self._springs = stiffness[flexible], damping[flexible], motors[flexible]

    def _names(self) -> tuple[str, str]:
        springs = [to_scalars(own, any_number) for own in self._springs]
        pattern = f"flexible step {arm_pattern(self._model)} {self._on} {springs!r}"
        return pattern, f"the motion of {self._model.nq} joints with springs"

    def _scalars(self, number: Callable[[float], Any]) -> tuple[Any, ...]:
        return *super()._scalars(number), Springs(*(to_scalars(own, number) for own in self._springs))

    def _express(self, at: Slots) -> list[Part]:
        parts, n, on = list[Part](), self._model.nq, self._on
        gravity, h, constants, springs = self._scalars(at.number)
        at.take(STATE, 2 * (n + len(on)))
        given = at.take(ROWS, 2 * n + len(on))[1]
        algebra = ArmAlgebra(constants._replace(gravity=gravity))
        _FlexibleMover(algebra, on, n, springs, given, at).move(given[:n], h, parts)
        return parts

    def advance(self, state: FloatArray, tau: FloatArray, load: FloatArray, free: FloatArray, steps: int) -> FloatArray:
        """Return the state after a number of steps under held torques.

        Args:
            state: Positions of the links and of the flexible joints' motors, then their velocities, shape (2 (n + m),).
            tau: Motor torques, shape (n,), in N m; those of rigid joints act on the links.
            load: External torques on the links, shape (n,), in N m.
            free: 1 for each flexible joint's motor without a closed brake, else 0, shape (m,).
            steps: Number of steps.
        """
        frame = self._frame
        frame.state[:, 0], frame.rows[0, :, 0] = state, np.concatenate([tau, load, free])
        frame.steps[0] = steps
        frame.call()
        after: FloatArray = frame.state[:, 0].copy()
        return after


def compile_flexible(
    model: RobotModel, flexible: FloatArray, stiffness: FloatArray, damping: FloatArray, motors: FloatArray, step: float
) -> CompiledFlexibleStep | None:
    """Return a compiled step of an arm with flexible joints, or None if unavailable; see CompiledFlexibleStep."""
    if not evaluator() or model.nq > MOST_JOINTS:
        return None
    return CompiledFlexibleStep(model, flexible, stiffness, damping, motors, step)
