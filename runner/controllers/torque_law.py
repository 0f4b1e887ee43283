"""Torque law interface: equations written once, evaluated by Pinocchio or compiled."""

from abc import ABC, abstractmethod
from collections.abc import Sequence
from copy import copy
from functools import cached_property
from typing import Any, Generic, NamedTuple, Protocol, Self, TypeVar

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.lazy_modules import pin
from runner.base.portable import dot
from runner.controllers.controller import Controller
from runner.robots.model import RobotModel
from runner.symbolic.maths import NUMPY, Array, Backend, Scalar


class Tip(NamedTuple):
    """State of the tip of an arm, in the base frame; valid until the arm computes the next one."""

    x: Array  # position, shape (3,), in m
    R: Array  # rotation from the tip's frame, shape (3, 3)
    J: Array  # basic Jacobian, shape (6, nq), linear rows first
    dJ_dq: Array  # dJ/dt dq, shape (6,), in m/s^2 and rad/s^2  # noqa: N815 - as in the papers


class Arm(Protocol):
    """Kinematics and dynamics of an arm for control laws, over floats or the scalars of the arguments."""

    @property
    def backend(self) -> Backend:
        """Functions over these scalars."""

    def tip(self, q: Array, dq: Array) -> Tip:
        """Return the state of the tip at joint positions and velocities, shapes (nq,)."""

    def tip_pose(self, q: Array) -> tuple[Array, Array]:
        """Return x and R of Tip at joint positions, shape (nq,); valid as long as a Tip."""

    def tip_pose_and_twist(self, q: Array, dq: Array) -> tuple[Array, Array, Array]:
        """Return x and R of Tip, and the twist, shape (6,): linear in m/s, then angular in rad/s."""

    def mass_matrix(self, q: Array) -> Array:
        """Return M(q), shape (nq, nq), in kg m^2; only the upper triangle is valid."""

    def inverse_dynamics(self, q: Array, dq: Array, ddq: Array, gravity: Array | None = None) -> Array:
        """Return the torques M ddq + V + G, shape (nq,), in N m; valid until the next call.

        Gravity is in the base frame, shape (3,), in m/s^2; None is the arm's own. Without gravity compensation G is 0.
        """

    def momentum(self, q: Array, dq: Array, gravity: Array) -> tuple[Array, Array]:
        """Return the generalised momenta M dq and their rate without torques, dT/dq - G = C^T dq - G.

        Shapes (nq,), in kg m^2/s and N m. Gravity is in the base frame, shape (3,), in m/s^2, and also acts without
        gravity compensation.
        """

    def regressor(self, q: Array, dq: Array, dq_r: Array, ddq_r: Array) -> Array:
        """Return Y, shape (nq, 10 nq): Y theta + A ddq_r = M ddq_r + C dq_r + G, with the C of Christoffel's symbols.

        A is the armature. theta are the inertial parameters of the moving bodies, base first, in each joint's frame of
        the URDF: mass in kg, mass times centre of mass in kg m, and I_xx, I_xy, I_yy, I_xz, I_yz, I_zz about the
        frame's origin in kg m^2; see RobotModel.inertial_parameters.
        """


def second_order(natural_frequency: float, damping_ratio: float) -> tuple[float, float]:
    """Return k_p = omega_n^2, in 1/s^2, and k_v = 2 xi omega_n, in 1/s, of a linear second-order error equation."""
    return natural_frequency**2, 2.0 * damping_ratio * natural_frequency


def clip(backend: Backend, value: Scalar, limit: Scalar) -> Scalar:
    """Return a scalar clipped to the range from -limit to limit."""
    return -backend.maximum(-backend.maximum(value, -limit), -limit)


Arms = Sequence[Arm]


class PinocchioArm:
    """An arm with any number of joints, over floats; see Arm.

    Args:
        model: The arm.
        gravity_compensation: True if gravity acts on the arm.
    """

    backend = NUMPY

    def __init__(self, model: RobotModel, gravity_compensation: bool = True) -> None:
        self._model = pin.Model(model.pin_model)
        self._data = self._model.createData()
        self._tip = model.tip_frame
        self._zero = np.zeros(model.nq)
        self._gravity_compensation, self._own_gravity, self._turned = gravity_compensation, model.gravity, False
        self._gravity: FloatArray = self._model.gravity.linear  # a view into the model
        if not gravity_compensation:
            self._gravity[:] = 0.0
        # Views into Pinocchio's data, which each frame update refreshes without a new object per tick.
        self._x: FloatArray = self._data.oMf[self._tip].translation
        self._R: FloatArray = self._data.oMf[self._tip].rotation

    def tip(self, q: FloatArray, dq: FloatArray) -> Tip:
        """Return the state of the tip; see Arm."""
        model, data, tip = self._model, self._data, self._tip
        pin.forwardKinematics(model, data, q, dq, self._zero)
        pin.computeJointJacobians(model, data)
        pin.updateFramePlacement(model, data, tip)
        J = pin.getFrameJacobian(model, data, tip, pin.LOCAL_WORLD_ALIGNED)
        motion = pin.getFrameClassicalAcceleration(model, data, tip, pin.LOCAL_WORLD_ALIGNED)
        return Tip(self._x, self._R, J, motion.vector)

    def tip_pose(self, q: FloatArray) -> tuple[Array, Array]:
        """Return position and rotation of the tip; see Arm."""
        pin.forwardKinematics(self._model, self._data, q)
        pin.updateFramePlacement(self._model, self._data, self._tip)
        return self._x, self._R

    def tip_pose_and_twist(self, q: FloatArray, dq: FloatArray) -> tuple[Array, Array, Array]:
        """Return position, rotation and twist of the tip; see Arm."""
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
        """Return the generalised momenta and their rate without torques; see Arm."""
        model, data = self._model, self._data
        M, C = pin.crba(model, data, q), pin.computeCoriolisMatrix(model, data, q, dq)
        p = dot(M + np.triu(M, 1).T - np.tril(M, -1), dq)
        rate = dot(C.T, dq)
        before = self._gravity.copy()
        self._gravity[:] = gravity
        rate = rate - pin.computeGeneralizedGravity(model, data, q)
        self._gravity[:] = before
        return p, rate

    def regressor(self, q: FloatArray, dq: FloatArray, dq_r: FloatArray, ddq_r: FloatArray) -> FloatArray:
        """Return Y, shape (nq, 10 nq); see Arm.

        V is quadratic in the velocities: C(dq) dq_r = V((dq + dq_r) / 2) - V((dq - dq_r) / 2).
        """
        self._turn(np.zeros(3))
        less = pin.computeJointTorqueRegressor(self._model, self._data, q, 0.5 * (dq - dq_r), self._zero).copy()
        self._turn(None)
        more = pin.computeJointTorqueRegressor(self._model, self._data, q, 0.5 * (dq + dq_r), ddq_r)
        return np.asarray(more - less)

    def _turn(self, gravity: FloatArray | None) -> None:
        """Set gravity if the arm has gravity compensation; None is the arm's own."""
        if self._gravity_compensation and (self._turned or gravity is not None):
            self._gravity[:] = self._own_gravity if gravity is None else gravity
            self._turned = gravity is not None


N = TypeVar("N", bound=tuple[Any, ...])


class TorqueLaw(Controller, ABC, Generic[N]):
    """Base class of torque laws; a Controller that Pinocchio evaluates.

    A derived class writes `evaluate` with the functions of the arms, `arm.backend` and NumPy operators. A Python `if`
    uses only attributes set in the constructor. Numbers that can differ between runs are in `parameters`.

    Args:
        models: Arms of the law, which reads only their URDF-derived constants. It commands the joints of the first.
        gravity_compensation: True if gravity acts on the nominal arms.
        parameters: Parameters of the law: floats, arrays, or tuples of them.
        measured: Number of measured joints; None for those of the first arm.

    Attributes:
        models: The arms.
        gravity_compensation: As above.
        parameters: As above.
        measured: Number of measured joints.
        compilable: False if the law is evaluated only on floats.
    """

    compilable = True

    def __init__(
        self, models: Sequence[RobotModel], gravity_compensation: bool, parameters: N, measured: int | None = None
    ) -> None:
        self.models, self.parameters = tuple(models), parameters
        self.gravity_compensation = gravity_compensation
        self.measured = self.models[0].nq if measured is None else measured
        self.state: FloatArray | None = None
        """State of `evaluate`; None before the first tick."""

    @abstractmethod
    def evaluate(
        self, arms: Arms, parameters: N, time: Scalar, q: Array, dq: Array, reference: Array, state: Array
    ) -> tuple[Array, Array]:
        """Return the torques of the commanded joints, in N m, and the state for the next tick.

        The function is pure: it stores nothing, reads only these parameters, and does not change its arguments.

        Args:
            arms: One arm for each model, over the scalars of the other arguments.
            parameters: Parameters of the law.
            time: Time since the start, in s.
            q: Measured joint positions, shape (measured,), in rad.
            dq: Measured joint velocities, shape (measured,), in rad/s.
            reference: Desired motion of the tip, shape (3, 3), or of the joints, (3, nq); see Controller.torque.
            state: State of the last tick, or `start`.
        """

    def with_parameters(self, **changed: Any) -> Self:
        """Return a copy of the law with some parameters changed and no state."""
        other = copy(self)
        parameters: Any = self.parameters
        other.parameters, other.state = parameters._replace(**changed), None
        return other

    def structure(self) -> dict[str, Any]:
        """Return the attributes that select the equations of `evaluate`, without the parameters."""
        return structure_of(self)

    def start(self, q: FloatArray) -> FloatArray:
        """Return the state of the first tick, shape (k,), from the measured joint positions."""
        return _NOTHING

    def reset(self) -> None:
        """Clear the state of an earlier run."""
        self.state = None

    def torque(self, time: float, q: FloatArray, dq: FloatArray, reference: FloatArray) -> FloatArray:
        """Return the torques of the law; see Controller.torque."""
        state = self.start(q) if self.state is None else self.state
        torque, self.state = self.evaluate(self._arms, self.parameters, time, q, dq, reference, state)
        return torque

    @cached_property
    def _arms(self) -> tuple[PinocchioArm, ...]:
        return tuple(PinocchioArm(model, self.gravity_compensation) for model in self.models)


def structure_of(part: Any) -> dict[str, Any]:
    """Return the attributes of a law or its part without the parameters; a nested part as class name and structure."""
    kept = {name: value for name, value in vars(part).items() if name not in _COMMON}
    return {name: _described(value) if hasattr(value, "structure") else value for name, value in kept.items()}


def _described(part: Any) -> tuple[str, dict[str, Any]]:
    kind = type(part)
    return f"{kind.__module__}.{kind.__qualname__}", part.structure()


_NOTHING = np.zeros(0)
_COMMON = frozenset(
    {
        "model",
        "models",
        "parameters",
        "gravity_compensation",
        "measured",
        "state",
        "compilable",
        "reads_joint_torques",
        "_arms",
    }
)
