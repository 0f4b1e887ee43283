"""Compiled motion of one arm by the classical Runge-Kutta scheme, and torques of links with armature."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Sequence
from functools import cached_property
from typing import TYPE_CHECKING, Any, NamedTuple, Self

import numpy as np

from runner.base.arrays import FloatArray
from runner.plants.runge_kutta import advance_stage
from runner.robots.model import RobotModel
from runner.symbolic.algebra import ArmAlgebra, Factors
from runner.symbolic.arm import ArmConstants, constants_of, to_scalars
from runner.symbolic.code import ROWS, SCRATCH, STATE, TABLE, Block, Part, Repeat, Slots, put
from runner.symbolic.engine import MOST_JOINTS, evaluator
from runner.symbolic.expression import Value, places
from runner.symbolic.maths import Array
from runner.symbolic.program import Expressed, Frame, program
from runner.symbolic.structure import any_number, arm_pattern, values_of
from runner.symbolic.vectors import Vector, add, as_array, scale, subtract, times

if TYPE_CHECKING:  # these modules use this one
    from runner.plants.flexibility import Flexibility


class Springs(NamedTuple):
    """Springs and motors of the m flexible joints of an arm with n joints.

    Attributes:
        joints: Indices of the flexible joints, shape (m,).
        stiffness: K, shape (m,), in N m/rad.
        damping: D, shape (m,), in N m s/rad.
        motors: B, shape (m,), in kg m^2.
        load: External torques on the links, shape (n,), in N m.
        free: 0 for each motor whose brake is closed, else 1, shape (m,).
    """

    joints: Sequence[int]
    stiffness: Vector
    damping: Vector
    motors: Vector
    load: Vector
    free: Vector


class Mover:
    """Motion of one arm; positions are those of its links, followed by those of the motors behind springs.

    Args:
        algebra: Algebra of the arm.
        joint: Index of the arm's first position among those of the robot.
        nq: Number of positions of the robot.
        count: Number of positions of the arm.
        at: Allocator of slots.
        springs: Springs and motors; None for rigid joints.
    """

    def __init__(
        self, algebra: ArmAlgebra, joint: int, nq: int, count: int, at: Slots, springs: Springs | None = None
    ) -> None:
        self._algebra, self._count, self._at, self._springs = algebra, count, at, springs
        self._first = joint, nq + joint
        self._q, self._v = (places(STATE, first, count) for first in self._first)

    def move(self, acting: Vector, h: Value, parts: list[Part]) -> None:
        r"""Add the integration steps of a tick.

        .. math::

            q^+ = q + h v + \tfrac{h^2}{6} (a_1 + a_2 + a_3), \qquad v^+ = v + \tfrac{h}{6} (a_1 + 2 a_2 + 2 a_3 + a_4)

        Because dq/dt = v, the slopes of the positions are the intermediate velocities, so four accelerations suffice.
        """
        n, q, v = self._count, self._q, self._v
        first, scratch = self._at.take(SCRATCH, 4 * n)
        one, two = ([*[0.0] * n, *scratch[part * n : (part + 1) * n]] for part in (2, 3))  # of velocities only

        def slope(x: Array) -> Array:
            speeds = x[n:].tolist()
            return np.array([*speeds, *self.acceleration(x[:n].tolist(), speeds, acting)], dtype=object)

        x, row = as_array([*q, *v]), places(TABLE, 0, 3)
        at, sums = advance_stage(slope, x, h, row, as_array(scratch[: 2 * n]), [as_array(one), as_array(two)])
        stage, (one, two) = [*at, *sums[0][n:], *sums[1][n:]], (one[n:], two[n:])
        sixth = h / 6.0
        begin = put(SCRATCH, first, [*q, *v, *[0.0] * (2 * n)])
        stages = Repeat([put(SCRATCH, first, stage)], 4, tabled=True)
        ends = zip(self._first, (add(q, scale(h, v), scale(h * sixth, one)), add(v, scale(sixth, two))), strict=True)
        end = Block([(STATE, place_ + index, value) for place_, values in ends for index, value in enumerate(values)])
        parts.append(Repeat([begin, stages, end], "steps"))

    def acceleration(self, q: Vector, v: Vector, tau: Vector) -> Vector:
        """Return the accelerations of links and motors under the motors' torques; see FlexibleJoints."""
        if self._springs is None:
            return self._accelerate_links(q, v, tau)
        joints, stiffness, damping, inertias, load, free = self._springs
        n, acting, motors = len(load), list(tau), []
        for index, (joint, K, D, B) in enumerate(zip(joints, stiffness, damping, inertias, strict=True)):
            spring = K * (q[n + index] - q[joint]) + D * (v[n + index] - v[joint])
            motors.append(free[index] * (tau[joint] - spring) / B)
            acting[joint] = spring
        pushed = [torque + own for torque, own in zip(acting, load, strict=True)]
        return [*self._accelerate_links(q[:n], v[:n], pushed), *motors]

    def _accelerate_links(self, q: Vector, v: Vector, tau: Vector) -> Vector:
        """Return the accelerations of the links under their torques, shapes (n,)."""
        bias = self._algebra.inverse_dynamics(q, v, [0.0] * len(q))
        return Factors(self._algebra.mass_matrix(q)).solve(subtract(tau, bias))


class ArmCode(ABC):
    """Code for one arm, compiled at first use, with a variable gravity vector.

    Args:
        model: Model of the arm.
        step: Integration step, in s; 0 if nothing is integrated.
    """

    def __init__(self, model: RobotModel, step: float = 0.0) -> None:
        self._model, self._step = model.copy(), step

    @classmethod
    def compile(cls, *args: Any) -> Self | None:
        """Return the code of an arm, or None if compiled code is unavailable; takes the constructor's arguments."""
        model: RobotModel = args[0]
        return cls(*args) if evaluator() and model.nq <= MOST_JOINTS else None

    @cached_property
    def _frame(self) -> Frame:
        def express() -> Expressed:
            at = Slots()
            return Expressed([], self._express(at), at.widths, [])

        frame = program(*self._names(), express, 1).frame(1, last=-1)
        frame.pars[:, 0] = values_of(self._scalars)
        return frame

    @abstractmethod
    def _names(self) -> tuple[str, str]:
        """Return the pattern of the code and a description for the user; see program."""

    @abstractmethod
    def _express(self, at: Slots) -> list[Part]:
        """Return the parts of the code; it takes numbers in the order of `_scalars`."""

    def _scalars(self, number: Callable[[float], Any]) -> tuple[Any, ...]:
        """Return the parameters of the code, converted by `number`: gravity, step, bodies."""
        gravity = [number(value) for value in self._model.gravity.tolist()]
        return gravity, number(self._step), constants_of(self._model, number, [0.0] * 3)

    def set_gravity(self, gravity: FloatArray) -> None:
        """Set the gravity vector in the base frame, shape (3,), in m/s^2."""
        self._frame.pars[:3, 0] = gravity


class CompiledStep(ArmCode):
    """Compiled integration steps of one arm without friction; see FlexibleJoints for springs and motors.

    Args:
        model: Rigid-body model of the links.
        step: Integration step, in s.
        flexibility: Springs and motors of the joints; None for rigid joints.
    """

    def __init__(self, model: RobotModel, step: float, flexibility: "Flexibility | None" = None) -> None:
        super().__init__(model, step)
        self._on: list[int] = []
        self._springs: tuple[FloatArray, ...] = ()
        if flexibility is not None:
            on = flexibility.flexible
            self._springs = flexibility.stiffness[on], flexibility.damping[on], flexibility.motors[on]
            self._on = np.flatnonzero(on).tolist()

    def _names(self) -> tuple[str, str]:
        springs = [to_scalars(own, any_number) for own in self._springs]
        pattern = f"step {arm_pattern(self._model)} {self._on} {springs!r}"
        return pattern, f"the motion of {self._model.nq} joints{' with springs' if springs else ''}"

    def _scalars(self, number: Callable[[float], Any]) -> tuple[Any, ...]:
        return *super()._scalars(number), [to_scalars(own, number) for own in self._springs]

    def _express(self, at: Slots) -> list[Part]:
        parts, n, m = list[Part](), self._model.nq, len(self._on)
        gravity, h, constants, numbers = self._scalars(at.number)
        at.take(STATE, 2 * (n + m))
        given = at.take(ROWS, 2 * n + m if numbers else n)[1]
        springs = None
        if numbers:
            stiffness, damping, motors = numbers
            springs = Springs(self._on, stiffness, damping, motors, given[n : 2 * n], given[2 * n :])
        algebra = ArmAlgebra(constants._replace(gravity=gravity))
        Mover(algebra, 0, n + m, n + m, at, springs).move(given[:n], h, parts)
        return parts

    def advance(self, state: FloatArray, given: FloatArray, steps: int) -> None:
        """Advance by a number of steps, in place.

        Args:
            state: Positions of the links and of the motors behind springs, in rad, then their velocities, in rad/s,
                shape (2 (n + m),).
            given: Held motor torques, shape (n,), in N m. With springs, external torques on the links, shape (n,), and
                0 for each motor whose brake is closed, else 1, shape (m,), follow them.
            steps: Number of steps.
        """
        frame = self._frame
        own = frame.state[:, 0]
        own[:], frame.rows[0, :, 0], frame.steps[0] = state, given, steps
        frame.call()
        state[:] = own


def links_torques(constants: ArmConstants, q: Vector, v: Vector, tau: Vector, at: Slots) -> Vector:
    """Return the torques of links without armature that have the accelerations of an arm with armature."""
    ddq = Mover(ArmAlgebra(constants), 0, len(q), len(q), at).acceleration(q, v, tau)
    motors = [times(body.armature, a) for body, a in zip(constants.bodies, ddq, strict=True)]
    return subtract(tau, motors)


class CompiledLinksTorque(ArmCode):
    """Compiled link torques, without the torques A ddq of the armature; see runner/plants/bullet.py."""

    def _names(self) -> tuple[str, str]:
        return f"links' torque {arm_pattern(self._model)}", f"the armature of {self._model.nq} joints"

    def _express(self, at: Slots) -> list[Part]:
        n = self._model.nq
        gravity, _, constants = self._scalars(at.number)
        q, v = (at.take(STATE, n)[1] for _ in range(2))
        first, tau = at.take(ROWS, n)
        return [put(ROWS, first, links_torques(constants._replace(gravity=gravity), q, v, tau, at))]

    def at(self, q: FloatArray, v: FloatArray, tau: FloatArray) -> FloatArray:
        """Return the torques of the links, shape (nq,), in N m; valid until the next call."""
        frame, n = self._frame, len(q)
        state, row = frame.state[:, 0], frame.rows[0, :, 0]
        state[:n], state[n:], row[:] = q, v, tau
        frame.call()
        return row
