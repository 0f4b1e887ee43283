"""Torque law over expressions."""

from collections.abc import Callable, Iterable, Sequence
from copy import copy
from typing import Any, NamedTuple

import numpy as np

from runner.base.memory import Memory
from runner.controllers.torque_law import Tip, TorqueLaw
from runner.symbolic.algebra import ArmAlgebra
from runner.symbolic.arm import ArmConstants, constants_of
from runner.symbolic.backend import SymbolicBackend
from runner.symbolic.expression import Value, are_same
from runner.symbolic.maths import Array
from runner.symbolic.structure import CannotCompileError, any_number, arm_pattern, plain_structure, scalars
from runner.symbolic.vectors import as_array

_OURS = ("runner", "abc", "typing", "builtins")
_MEMORY = Memory(256)  # for patterns of laws


class LawScalars(NamedTuple):
    """The numbers of a law.

    Attributes:
        period: Time between ticks, in s.
        numbers: Numbers of the law.
        arms: Nominal arms of the law.
    """

    period: Value
    numbers: Any
    arms: tuple[ArmConstants, ...]


def law_scalars(law: TorqueLaw[Any], period: float, number: Callable[[float], Any]) -> LawScalars:
    """Return the numbers of a law with a period, in s, as scalars, converted by `number`."""
    still = [0.0] * 3
    arms = tuple(
        constants_of(model, number, [number(g) for g in model.gravity.tolist()] if law.gravity_compensation else still)
        for model in law.models
    )
    return LawScalars(number(period), scalars(law.parameters, number), arms)


class ExpressedArm:
    """An arm over expressions; see Arm.

    Args:
        algebra: Kinematics and dynamics of the arm.
        backend: Functions over expressions.
        gravity_compensation: True if gravity acts on the arm.
    """

    def __init__(self, algebra: ArmAlgebra, backend: SymbolicBackend, gravity_compensation: bool) -> None:
        self._algebra, self.backend, self._gravity_compensation = algebra, backend, gravity_compensation

    def tip(self, q: Array, dq: Array) -> Tip:
        """Return the tip's motion; see Arm."""
        return Tip(*(as_array(part) for part in self._algebra.tip(q.tolist(), dq.tolist())))

    def tip_pose(self, q: Array) -> tuple[Array, Array]:
        """Return the tip's position and rotation; see Arm."""
        tip = self.tip(q, np.zeros(len(q)))
        return tip.x, tip.R

    def tip_pose_and_twist(self, q: Array, dq: Array) -> tuple[Array, Array, Array]:
        """Return the tip's position, rotation and velocity; see Arm."""
        tip = self.tip(q, dq)
        return tip.x, tip.R, tip.J.dot(dq)

    def mass_matrix(self, q: Array) -> Array:
        """Return M(q); see Arm."""
        return np.asarray(as_array(self._algebra.mass_matrix(q.tolist())))

    def inverse_dynamics(self, q: Array, dq: Array, ddq: Array, gravity: Array | None = None) -> Array:
        """Return the torques of an acceleration; see Arm."""
        given = None if gravity is None or not self._gravity_compensation else gravity.tolist()
        return np.asarray(as_array(self._algebra.inverse_dynamics(q.tolist(), dq.tolist(), ddq.tolist(), given)))

    def momentum(self, q: Array, dq: Array, gravity: Array) -> tuple[Array, Array]:
        """Return the generalised momenta and their rates; see Arm."""
        p, rates = self._algebra.momentum(q.tolist(), dq.tolist(), gravity.tolist())
        return np.asarray(as_array(p)), np.asarray(as_array(rates))

    def regressor(self, q: Array, dq: Array, dq_r: Array, ddq_r: Array) -> Array:
        """Return the regressor of the inertial parameters; see Arm."""
        return np.asarray(as_array(self._algebra.regressor(q.tolist(), dq.tolist(), dq_r.tolist(), ddq_r.tolist())))


def expressed_torque(
    law: TorqueLaw[Any], own: LawScalars, time: Value, q: Any, dq: Any, reference: Array, memory: Any
) -> tuple[list[Value], list[Value], SymbolicBackend]:
    """Return a law's torques and memory as expressions, and the backend with possible failures.

    Args:
        law: The law.
        own: Numbers of the law.
        time: See TorqueLaw.evaluate.
        q: See TorqueLaw.evaluate.
        dq: See TorqueLaw.evaluate.
        reference: See TorqueLaw.evaluate.
        memory: See TorqueLaw.evaluate.

    Raises:
        CannotCompileError: if the law uses an operation that expressions do not support.
    """
    given = time, as_array(q), as_array(dq), reference, as_array(memory)
    try:
        torque, after, backend = _evaluated(copy(law), own, given)
        if not are_ours([law]):
            _check_pure(law, own, given, [*torque, *after])
    except Exception as error:
        reason = f"its `evaluate` does what expressions cannot do: {error}"
        raise CannotCompileError(
            f"{type(law).__name__} is not compiled, and runs through Pinocchio: {reason}"
        ) from error
    return torque, after, backend


def _evaluated(law: TorqueLaw[Any], own: LawScalars, given: Any) -> tuple[list[Value], list[Value], SymbolicBackend]:
    backend = SymbolicBackend()
    arms = [ExpressedArm(ArmAlgebra(constants), backend, law.gravity_compensation) for constants in own.arms]
    torque, after = law.evaluate(arms, own.numbers, *given)
    return list(np.asarray(torque).tolist()), list(np.asarray(after).tolist()), backend


def _check_pure(law: TorqueLaw[Any], own: LawScalars, given: Any, found: Sequence[Value]) -> None:
    """Check that a user's law gives the same expressions again, and stores nothing in itself.

    Raises:
        TypeError: if it does not.
    """
    again = copy(law)
    torque, after, _ = _evaluated(again, own, given)
    if changed := [name for name, value in vars(again).items() if vars(law).get(name) is not value]:
        raise TypeError(f"it changes {', '.join(changed)}; keep that in the state")
    if not are_same(found, [*torque, *after]):
        raise TypeError("a second call gives something else; keep what changes in the state")


def are_ours(laws: Iterable[TorqueLaw[Any]]) -> bool:
    """Return True if all laws are built-in."""
    kinds = [kind for law in laws for kind in type(law).__mro__]
    return all(kind.__module__.partition(".")[0] in _OURS for kind in kinds)


def law_cache_key(law: TorqueLaw[Any]) -> str:
    """Return a string that is the same for two laws with the same code.

    Raises:
        CannotCompileError: if the law has an attribute that cannot be compared.
    """
    return _MEMORY.recall(_pattern, law)


def _pattern(law: TorqueLaw[Any]) -> str:
    kind = type(law)
    return repr(
        (
            f"{kind.__module__}.{kind.__qualname__}",
            law.gravity_compensation,
            plain_structure("", law.structure()),
            scalars(law.parameters, any_number),
            [arm_pattern(model) for model in law.models],
        )
    )


def structure_cache_key(law: TorqueLaw[Any]) -> str:
    """Return a string for the fixed part of a law's code; it is the same for laws that differ only in their numbers.

    Raises:
        CannotCompileError: if the law has an attribute that cannot be compared.
    """
    return repr(plain_structure("", law.structure()))
