"""Torque law interface: equations written once, evaluated by Pinocchio or compiled."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from copy import copy
from functools import cached_property
from typing import Any, Generic, NamedTuple, Protocol, Self, TypeVar

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.lazy_modules import pin
from runner.controllers.controller import Controller
from runner.robots.model import RobotModel
from runner.symbolic.maths import NUMPY, Array, Backend, Scalar


class Tip(NamedTuple):
    """The tip of an arm in one state, in the base frame; valid until the arm is asked for the next one.

    Attributes:
        x: Position, shape (3,), in m.
        R: Rotation from the tip's frame, shape (3, 3).
        J: Basic Jacobian, shape (6, nq), linear rows first.
        dJ_dq: dJ/dt dq, shape (6,), in m/s^2 and rad/s^2.
    """

    x: Array
    R: Array
    J: Array
    dJ_dq: Array  # noqa: N815 - as the papers write it


class Arm(Protocol):
    """What a law may ask of its arm, over floats or whatever scalar its arguments hold."""

    @property
    def backend(self) -> Backend:
        """The functions over these scalars."""
        ...

    def tip(self, q: Array, dq: Array) -> Tip:
        """Return the tip's motion, its Jacobian included, at joint positions and velocities, shapes (nq,)."""
        ...

    def tip_pose(self, q: Array) -> tuple[Array, Array]:
        """Return where the tip is, x and R of Tip, at joint positions, shape (nq,); valid as long as a Tip."""
        ...

    def tip_pose_and_twist(self, q: Array, dq: Array) -> tuple[Array, Array, Array]:
        """Return where the tip is and its velocity, shape (6,), linear before angular, in m/s and rad/s."""
        ...

    def mass_matrix(self, q: Array) -> Array:
        """Return M(q), shape (nq, nq), in kg m^2; the lower triangle is not to be read."""
        ...

    def inverse_dynamics(self, q: Array, dq: Array, ddq: Array, gravity: Array | None = None) -> Array:
        """Return the torques M ddq + V + G, shape (nq,), in N m; valid until it is asked again.

        Gravity is given in the base frame, shape (3,), in m/s^2; None is the arm's own. An arm that is believed to have
        no weight has none, whatever is given.
        """
        ...

    def momentum(self, q: Array, dq: Array, gravity: Array) -> tuple[Array, Array]:
        """Return the generalised momenta M dq, and what they change by without torques: dT/dq - G, which is C^T dq - G.

        Shapes (nq,), in kg m^2/s and N m. Gravity is given in the base frame, shape (3,), in m/s^2, and acts on an arm
        that is believed to have no weight, too.
        """
        ...

    def regressor(self, q: Array, dq: Array, dq_r: Array, ddq_r: Array) -> Array:
        """Return Y, shape (nq, 10 nq): Y theta + A ddq_r = M ddq_r + C dq_r + G, with the C of Christoffel's symbols.

        A is the armature. theta are the inertial parameters of the moving bodies, base first, in each joint's frame of
        the URDF: mass in kg, mass times the way to its centre in kg m, and I_xx, I_xy, I_yy, I_xz, I_yz, I_zz about the
        frame's origin in kg m^2; see RobotModel.inertial_parameters.
        """
        ...


class PinocchioArm:
    """An arm of any number of joints, on floats; see Arm.

    Args:
        model: The arm.
        gravity_compensation: True if gravity acts on it.
    """

    backend = NUMPY

    def __init__(self, model: RobotModel, gravity_compensation: bool = True) -> None:
        self._model = pin.Model(model.pin_model)
        self._data = self._model.createData()
        self._tip = model.tip_frame
        self._zero = np.zeros(model.nq)
        self._gravity_compensation, self._own_gravity, self._turned = gravity_compensation, model.gravity, False
        self._gravity: FloatArray = self._model.gravity.linear  # a view: what is written there acts
        if not gravity_compensation:
            self._gravity[:] = 0.0
        # Views into Pinocchio's data: each update of the frame refreshes them, without a new object per tick.
        self._x: FloatArray = self._data.oMf[self._tip].translation
        self._R: FloatArray = self._data.oMf[self._tip].rotation

    def tip(self, q: FloatArray, dq: FloatArray) -> Tip:
        """Return the tip's motion; see Arm."""
        model, data, tip = self._model, self._data, self._tip
        pin.forwardKinematics(model, data, q, dq, self._zero)
        pin.computeJointJacobians(model, data)
        pin.updateFramePlacement(model, data, tip)
        J = pin.getFrameJacobian(model, data, tip, pin.LOCAL_WORLD_ALIGNED)
        motion = pin.getFrameClassicalAcceleration(model, data, tip, pin.LOCAL_WORLD_ALIGNED)
        return Tip(self._x, self._R, J, motion.vector)

    def tip_pose(self, q: FloatArray) -> tuple[Array, Array]:
        """Return where the tip is; see Arm."""
        pin.forwardKinematics(self._model, self._data, q)
        pin.updateFramePlacement(self._model, self._data, self._tip)
        return self._x, self._R

    def tip_pose_and_twist(self, q: FloatArray, dq: FloatArray) -> tuple[Array, Array, Array]:
        """Return where the tip is and its velocity; see Arm."""
        model, data, tip = self._model, self._data, self._tip
        pin.forwardKinematics(model, data, q, dq)
        pin.updateFramePlacement(model, data, tip)
        return self._x, self._R, pin.getFrameVelocity(model, data, tip, pin.LOCAL_WORLD_ALIGNED).vector

    def mass_matrix(self, q: FloatArray) -> FloatArray:
        """Return M(q); see Arm."""
        M: FloatArray = pin.crba(self._model, self._data, q)
        return M

    def inverse_dynamics(
        self, q: FloatArray, dq: FloatArray, ddq: FloatArray, gravity: FloatArray | None = None
    ) -> FloatArray:
        """Return the torques of an acceleration; see Arm."""
        self._turn(gravity)
        torque: FloatArray = pin.rnea(self._model, self._data, q, dq, ddq)
        return torque

    def momentum(self, q: FloatArray, dq: FloatArray, gravity: FloatArray) -> tuple[Array, Array]:
        """Return the generalised momenta and how they change; see Arm."""
        model, data = self._model, self._data
        M, C = pin.crba(model, data, q), pin.computeCoriolisMatrix(model, data, q, dq)
        p = (M + np.triu(M, 1).T - np.tril(M, -1)).dot(dq)
        rate = C.T.dot(dq)
        before = self._gravity.copy()
        self._gravity[:] = gravity
        rate = rate - pin.computeGeneralizedGravity(model, data, q)
        self._gravity[:] = before
        return p, rate

    def regressor(self, q: FloatArray, dq: FloatArray, dq_r: FloatArray, ddq_r: FloatArray) -> FloatArray:
        """Return how the torques depend on the inertial parameters; see Arm.

        V is quadratic in the velocities: C(dq) dq_r = V((dq + dq_r) / 2) - V((dq - dq_r) / 2).
        """
        self._turn(np.zeros(3))
        less = pin.computeJointTorqueRegressor(self._model, self._data, q, 0.5 * (dq - dq_r), self._zero).copy()
        self._turn(None)
        more = pin.computeJointTorqueRegressor(self._model, self._data, q, 0.5 * (dq + dq_r), ddq_r)
        return np.asarray(more - less)

    def _turn(self, gravity: FloatArray | None) -> None:
        """Let a gravity act on what has weight; None is the arm's own."""
        if self._gravity_compensation and (self._turned or gravity is not None):
            self._gravity[:] = self._own_gravity if gravity is None else gravity
            self._turned = gravity is not None


N = TypeVar("N", bound=tuple[Any, ...])


class TorqueLaw(Controller, ABC, Generic[N]):
    """A torque law; a Controller by Pinocchio.

    A derived class writes `evaluate` with the arms' functions, `arm.backend` and NumPy's operators. What decides by an
    `if` of Python is fixed when the law is made; a number that may change from run to run stands in `numbers`.

    Args:
        models: The arms that the law reckons with; only their URDF-derived constants are read. The first one's joints
            are commanded.
        gravity_compensation: True if the law's nominal arms have weight.
        numbers: The law's numbers: floats, arrays, or tuples of them.
        measured: How many joints are measured; None where they are the first arm's.

    Attributes:
        models: The arms.
        gravity_compensation: As above.
        numbers: As above.
        measured: As above, a number.
    """

    def __init__(
        self, models: Sequence[RobotModel], gravity_compensation: bool, numbers: N, measured: int | None = None
    ) -> None:
        self.models, self.numbers = tuple(models), numbers
        self.gravity_compensation = gravity_compensation
        self.measured = self.models[0].nq if measured is None else measured
        self.memory: FloatArray | None = None
        """What `evaluate` keeps from tick to tick; None before the first one."""

    @abstractmethod
    def evaluate(
        self, arms: Sequence[Arm], numbers: N, time: Scalar, q: Array, dq: Array, reference: Array, memory: Array
    ) -> tuple[Array, Array]:
        """Return the torques of the joints commanded, in N m, and the memory for the next tick.

        It keeps nothing, reads no number but these, and changes none of its arguments.

        Args:
            arms: One for each of the models, over the scalars of the arguments that follow.
            numbers: The law's numbers.
            time: Time since the start, in s.
            q: Measured joint positions, shape (measured,), in rad.
            dq: Measured joint velocities, shape (measured,), in rad/s.
            reference: Desired motion of the tip, shape (3, 3), or of the joints, (3, nq); see Controller.torque.
            memory: What the last tick left, or `start`.
        """

    def with_numbers(self, **changed: Any) -> Self:
        """Return the law with some of its numbers changed, that has not run yet."""
        other = copy(self)
        numbers: Any = self.numbers
        other.numbers, other.memory = numbers._replace(**changed), None
        return other

    def structure(self) -> dict[str, Any]:
        """Return what decides how `evaluate` goes, beside its numbers: what a derived class has kept."""
        return structure_of(self)

    def start(self, q: FloatArray) -> FloatArray:
        """Return the memory of the first tick, shape (k,), from the positions of the joints measured there."""
        return _NOTHING

    def reset(self) -> None:
        """Forget what an earlier run left."""
        self.memory = None

    def torque(self, time: float, q: FloatArray, dq: FloatArray, reference: FloatArray) -> FloatArray:
        """Return the torques of the law; see Controller.torque."""
        memory = self.start(q) if self.memory is None else self.memory
        torque, self.memory = self.evaluate(self._arms, self.numbers, time, q, dq, reference, memory)
        return torque

    @cached_property
    def _arms(self) -> tuple[PinocchioArm, ...]:
        return tuple(PinocchioArm(model, self.gravity_compensation) for model in self.models)


def structure_of(part: Any) -> dict[str, Any]:
    """Return what a law, or a part of one, has kept beside its numbers; another law in it as kind and structure."""
    kept = {name: value for name, value in vars(part).items() if name not in _COMMON}
    return {name: _described(value) if hasattr(value, "structure") else value for name, value in kept.items()}


def _described(part: Any) -> tuple[str, dict[str, Any]]:
    kind = type(part)
    return f"{kind.__module__}.{kind.__qualname__}", part.structure()


_NOTHING = np.zeros(0)
_COMMON = frozenset({"model", "models", "numbers", "gravity_compensation", "measured", "memory", "_arms"})
