"""Operational-space control of a redundant arm as a whole, with a dynamically consistent null space."""

from typing import Literal

import numpy as np
import pinocchio as pin
from pydantic import NonNegativeFloat, PositiveFloat
from scipy.linalg.lapack import dposv

from runner.controllers.controller import FloatArray, Loop
from runner.errors import ConfigError
from runner.registry import StrictModel
from runner.robots import RobotModel
from runner.robots.robot import Robot


class WholeBodyLaw(StrictModel):
    """The numbers of the whole-body law.

    Attributes:
        natural_frequency: omega_n of the closed loop in every direction of the tip, in rad/s.
        damping_ratio: xi of the closed loop.
        gravity_compensation: Whether the law holds the gravity term.
        feedforward: Whether the law follows the desired velocity and acceleration.
        null_space_frequency: omega_n of the posture task in the null space, in rad/s; it holds joints at home, and
            damps all joints.
        max_tip_speed: Tip speed at which the approach to the goal saturates, in m/s; None is no limit.
        singularity_damping: Share of the tip's error by which the inverse of J M^-1 J^T is damped near a singular
            posture; 0 is the law as printed.
    """

    natural_frequency: PositiveFloat
    damping_ratio: PositiveFloat
    gravity_compensation: bool
    feedforward: bool
    null_space_frequency: NonNegativeFloat
    max_tip_speed: PositiveFloat | None
    singularity_damping: NonNegativeFloat


class WholeBodyConfig(WholeBodyLaw):
    """Config of whole-body control.

    Attributes:
        kind: Its name in the registry.
        period: Time between two ticks, in s.
    """

    kind: Literal["whole_body"]
    period: PositiveFloat


class WholeBody:
    r"""Operational-space control of the tip position of an arm with more joints than three (thesis method 1).

    .. math::

        \tau = h + J^T \Lambda (F^* - \dot J \dot q) + N^T \tau_0, \qquad
        \Lambda = (J M^{-1} J^T)^{-1}, \quad \bar J = M^{-1} J^T \Lambda, \quad N^T = 1 - J^T \bar J^T

        \tau_0 = -k_{vn} M \dot q - K (q - q_\mathrm{rest})

    F* is that of OperationalSpace. With a largest tip speed V it is Khatib's saturated form,

    .. math::

        F^* = \ddot x_d - k_v (\dot x - \dot x_d - \nu \frac{k_p}{k_v} (x_d - x)), \quad
        \nu = \min(1, V k_v / (k_p |x_d - x|))

    Damping alone would let a Mini that rides on a Macro stretch. K is constant, symmetric, and zero but for the joints
    whose posture is held: a spring, so that the posture can only lose energy while the tip rests. At rest it gives them
    omega_n = null_space_frequency: K is omega_n^2 times the inertia that they meet there with the tip held. An
    acceleration, M S (q - q_rest), is no spring: of one of the Mini's joints alone N^T leaves nothing at home.

    Args:
        model: The whole arm.
        config: The law's numbers.
        rest: Posture of the null space, shape (nq,), in rad.
        first_held: The first joint whose posture is held, and with it all after it. The default holds all but three,
            which is all that riding Minis have. Where it is less, K is made from their inertia alone.

    Raises:
        ConfigError: if the arm has fewer than three joints.
    """

    def __init__(self, model: RobotModel, config: WholeBodyLaw, rest: FloatArray, first_held: int = 3) -> None:
        if model.nq < 3:
            raise ConfigError(
                [
                    f"controller.kind: needs 3 joints or more to bring the tip anywhere; the arm has {model.nq} "
                    f"({', '.join(model.joint_names)})"
                ]
            )
        self._model = pin.Model(model.pin_model)
        self._data = self._model.createData()
        self._gravity_compensation = config.gravity_compensation
        self.set_gravity(model.gravity)
        self._tip = model.tip_frame
        self._x = self._data.oMf[self._tip].translation
        self._zero = np.zeros(model.nq)
        self._k_p = config.natural_frequency**2
        self._k_v = 2.0 * config.damping_ratio * config.natural_frequency
        self._feedforward = config.feedforward
        self._max_speed = config.max_tip_speed
        self._stiffness = config.null_space_frequency**2 * _inertia_at_rest(model, rest, first_held)
        self._k_vn = 2.0 * config.null_space_frequency
        self._rest = rest
        self._damping = config.singularity_damping
        self._singular_below = 0.1 * model.reach

    def set_gravity(self, gravity: FloatArray) -> None:
        """Take another gravity vector in the arm's base frame, shape (3,), in m/s^2."""
        self._model.gravity.linear = gravity if self._gravity_compensation else np.zeros(3)

    def reset(self) -> None:
        """Do nothing: the law has no memory."""

    def torque(self, time: float, q: FloatArray, dq: FloatArray, reference: FloatArray) -> FloatArray:
        """Return the torques of the law above; see Controller.torque."""
        model, data = self._model, self._data
        pin.forwardKinematics(model, data, q, dq, self._zero)
        pin.computeJointJacobians(model, data)
        pin.updateFramePlacement(model, data, self._tip)
        J = pin.getFrameJacobian(model, data, self._tip, pin.LOCAL_WORLD_ALIGNED)[:3]
        dJ_dq = pin.getFrameClassicalAcceleration(model, data, self._tip, pin.LOCAL_WORLD_ALIGNED).linear
        bias = pin.nonLinearEffects(model, data, q, dq).copy()
        M = pin.crba(model, data, q)  # its upper triangle is all that dposv reads
        _, M_inverse_J, info = dposv(M, J.T)
        if info:
            raise np.linalg.LinAlgError("the mass matrix is singular")
        error = reference[0] - self._x
        task = self._task_force(error, J.dot(dq), reference) - dJ_dq
        # N^T tau_0 = tau_0 - J^T Lambda J M^-1 tau_0.
        damping, spring = -self._k_vn * dq, self._stiffness.dot(self._rest - q)
        task -= J.dot(damping) + M_inverse_J.T.dot(spring)
        force = self._solve_task_inertia(J, J.dot(M_inverse_J), task, error)
        full = np.triu(M) + np.triu(M, 1).T
        torque: FloatArray = bias + J.T.dot(force) + full.dot(damping) + spring
        return torque

    def _task_force(self, error: FloatArray, velocity: FloatArray, reference: FloatArray) -> FloatArray:
        """Return F*, the commanded tip acceleration, shape (3,), in m/s^2."""
        approach = self._k_p * error
        if self._max_speed is not None:
            largest = self._k_v * self._max_speed
            norm = float(np.sqrt(approach.dot(approach)))
            if norm > largest:
                approach *= largest / norm
        if self._feedforward:
            return np.asarray(reference[2] + self._k_v * (reference[1] - velocity) + approach)
        return np.asarray(approach - self._k_v * velocity)

    def _solve_task_inertia(
        self, J: FloatArray, mobility: FloatArray, force: FloatArray, error: FloatArray
    ) -> FloatArray:
        """Return Lambda times a task acceleration, damped near a singular posture."""
        if self._damping:
            smallest = float(np.sqrt(abs(np.linalg.eigvalsh(J.dot(J.T))[0])))
            if smallest < self._singular_below:
                nearness = smallest / self._singular_below
                # Scaled by the mobility's size, so that the damping is a share of the tip's error as in joint space.
                scale = np.trace(mobility) / max(float(np.vdot(J, J)), 1e-300)
                mobility = mobility + scale * self._damping**2 * error.dot(error) * (1.0 - nearness**2) * np.eye(3)
        _, solution, info = dposv(mobility, force)
        if info:
            raise np.linalg.LinAlgError("the tip's Jacobian is singular")
        return np.asarray(solution)


def _inertia_at_rest(model: RobotModel, rest: FloatArray, first_held: int) -> FloatArray:
    """Return the inertia that the joints from a first one on meet at rest, shape (nq, nq), zero for the others."""
    inertia = np.zeros((model.nq, model.nq))
    held = slice(first_held, model.nq)
    M, J = model.mass_matrix(rest), model.tip_jacobian(rest)[:3]
    if first_held < 3:
        inertia[held, held] = M[held, held]
    else:
        M_inverse = np.linalg.pinv(M, hermitian=True)
        mobility = M_inverse - M_inverse @ J.T @ np.linalg.pinv(J @ M_inverse @ J.T, hermitian=True) @ J @ M_inverse
        inertia[held, held] = np.linalg.pinv(mobility[held, held], hermitian=True)
    return inertia


CONFIG = WholeBodyConfig


def build(config: WholeBodyConfig, robot: Robot) -> tuple[Loop, ...]:
    """Make the one loop that a config describes; it commands every joint."""
    joints = slice(0, robot.model.nq)
    return (Loop("whole", joints, config.period, WholeBody(robot.model, config, robot.home)),)
