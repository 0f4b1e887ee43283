"""Time constants of the parts of control laws.

Import this module only if rigid-body models are available.
"""

import math
from functools import singledispatch
from typing import NamedTuple, cast

import numpy as np

from runner.assembly.run_config import RunConfig
from runner.base.arrays import FloatArray
from runner.controllers import CONTROLLERS
from runner.controllers.force.admittance import AdmittanceConfig
from runner.controllers.force.hybrid_force import HybridForceConfig
from runner.controllers.joint_space.adaptive import Adaptive, AdaptiveConfig
from runner.controllers.joint_space.computed_torque import ComputedTorqueConfig
from runner.controllers.joint_space.iterative_learning import IterativeLearningConfig
from runner.controllers.joint_space.joint_law import JointLawConfig
from runner.controllers.joint_space.joint_pd import JointPdConfig
from runner.controllers.joint_space.joint_pid import JointPidConfig
from runner.controllers.joint_space.motor_pd import MotorPdConfig
from runner.controllers.joint_space.passivity import PassivityConfig
from runner.controllers.joint_space.sliding_mode import SlidingModeConfig
from runner.controllers.kinematic.differential_inverse_kinematics import DifferentialInverseKinematicsConfig
from runner.controllers.macro_mini.macro_mini import MacroMiniConfig
from runner.controllers.operational_space.operational_space import OperationalSpaceConfig
from runner.controllers.operational_space.whole_body import WholeBodyConfig
from runner.controllers.torque_law import PinocchioArm
from runner.robots.task_space import mass_along, tip_mobility
from runner.schema.values import by_stage

_POSTURES = 32  # configurations of the desired motion
_ROUNDING = 1e-9
_STEPS = 50  # Newton steps; they converge from below, because a sum of exponentials is convex
_WEAK = 1e-6  # of the largest rate; smaller rates are ignored


class TimeConstant(NamedTuple):
    """Time constant of a part of a control law.

    Attributes:
        seconds: Time in which the remaining error falls to 1/e, in s.
        part: Name of the part, such as "integral".
    """

    seconds: float
    part: str


def slowest_part(run: RunConfig, q_start: FloatArray | None = None) -> TimeConstant | None:
    """Return the slowest part of a run's control laws and observer; None if no time constant is known.

    Args:
        run: The checked config.
        q_start: Joint positions at the start, shape (nq,), in rad; None is the home configuration.
    """
    config = run.controller
    # Another law can have the config of one of these, or a config derived from it.
    own = type(config).__module__ == CONTROLLERS.module(config.kind).__name__
    find = _parts.registry[type(config) if own and type(config) in _parts.registry else object]
    parts = dict(find(config, run, run.arm.home if q_start is None else q_start))
    bandwidths = run.disturbance_observer.by_loop(run.loops)
    if bandwidths:
        parts["disturbance observer"] = 1.0 / min(bandwidths)
    return max((TimeConstant(seconds, part) for part, seconds in parts.items()), default=None)


@singledispatch
def _parts(config: object, run: RunConfig, q: FloatArray) -> dict[str, float]:
    """Return the time constants of the parts of a law, in s; empty if none is known."""
    return {}


@_parts.register(JointPdConfig)
@_parts.register(MotorPdConfig)
@_parts.register(WholeBodyConfig)
def _(config: JointLawConfig | WholeBodyConfig, run: RunConfig, q: FloatArray) -> dict[str, float]:
    return {"position loop": _loop(config.natural_frequency, config.damping_ratio)}


@_parts.register(PassivityConfig)
@_parts.register(SlidingModeConfig)
def _(config: PassivityConfig | SlidingModeConfig, run: RunConfig, q: FloatArray) -> dict[str, float]:
    return {"position loop": _double_pole(config, run)}


@_parts.register
def _(config: AdaptiveConfig, run: RunConfig, q: FloatArray) -> dict[str, float]:
    return {"position loop": _double_pole(config, run), "adaptation": _adaptation(run, q)}


@_parts.register
def _(config: ComputedTorqueConfig, run: RunConfig, q: FloatArray) -> dict[str, float]:
    return _with_integral(config, config.integral_gain)


@_parts.register
def _(config: JointPidConfig, run: RunConfig, q: FloatArray) -> dict[str, float]:
    return _with_integral(config, config.integral_share * config.natural_frequency**3)


@_parts.register
def _(config: IterativeLearningConfig, run: RunConfig, q: FloatArray) -> dict[str, float]:
    """Return the time constants, with learning by a factor of 1 - gamma of the slow errors in each period."""
    left = abs(1.0 - config.learning_gain)
    periods = max(1.0, -1.0 / math.log(left)) if left > 0.0 else 1.0
    return {
        "position loop": _loop(config.natural_frequency, config.damping_ratio),
        "learning": periods * (config.repeats_every or 0.0),
    }


@_parts.register(OperationalSpaceConfig)
@_parts.register(MacroMiniConfig)
def _(config: OperationalSpaceConfig | MacroMiniConfig, run: RunConfig, q: FloatArray) -> dict[str, float]:
    return {"position loop": _stage_loops(config, run)}


@_parts.register
def _(config: HybridForceConfig, run: RunConfig, q: FloatArray) -> dict[str, float]:
    """Return the time constants along the wall, and into it with the tip's effective mass in a configuration."""
    mobility = tip_mobility(run.arm.model, q, run.loops[-1].joints.start)
    mass = mass_along(mobility, np.array(config.normal))
    square = config.wall_stiffness * (1.0 + config.force_gain) / mass
    brake = 2.0 * config.force_damping * math.sqrt(square)
    integral = config.wall_stiffness * config.integral_gain / mass
    force = {"force integral": _settling(1.0, brake, square, integral)} if integral else {}
    return {"position loop": _stage_loops(config, run), "force loop": _settling(1.0, brake, square), **force}


@_parts.register
def _(config: AdmittanceConfig, run: RunConfig, q: FloatArray) -> dict[str, float]:
    axes = zip(config.mass, config.damping, config.stiffness, strict=True)
    return {"admittance": max(_settling(*axis) for axis in axes)}


@_parts.register
def _(config: DifferentialInverseKinematicsConfig, run: RunConfig, q: FloatArray) -> dict[str, float]:
    return {"position loop": 1.0 / config.gain} if config.gain else {}


def _loop(natural_frequency: float, damping_ratio: float) -> float:
    """Return the time constant of s^2 + 2 xi omega_n s + omega_n^2, in s."""
    return _settling(1.0, 2.0 * damping_ratio * natural_frequency, natural_frequency**2)


def _stage_loops(config: OperationalSpaceConfig | MacroMiniConfig | HybridForceConfig, run: RunConfig) -> float:
    """Return the time constant of the slowest stage, in s."""
    names = run.arm.stage_names
    rates = by_stage("controller.natural_frequency", config.natural_frequency, names)
    return max(map(_loop, rates, by_stage("controller.damping_ratio", config.damping_ratio, names)))


def _double_pole(config: JointLawConfig, run: RunConfig) -> float:
    """Return the time constant of two joint poles at omega_n, or of the outer loop if the law tracks the tip."""
    return _loop(config.natural_frequency, 1.0 if run.loops[0].follows_joints else config.damping_ratio)


def _with_integral(config: JointLawConfig, gain: float) -> dict[str, float]:
    """Return the time constant of s^3 + 2 xi omega_n s^2 + omega_n^2 s + k_i, in s."""
    rate, damping = config.natural_frequency, config.damping_ratio
    if gain == 0.0:
        return {"position loop": _loop(rate, damping)}
    return {"integral": _settling(1.0, 2.0 * damping * rate, rate**2, gain)}


def _settling(*coefficients: float) -> float:
    """Return the time constant of the slowest nonzero root of a polynomial, in s; 0 if a motion does not decay."""
    roots = np.roots(coefficients)
    fades = min((-roots.real[roots != 0.0]).tolist(), default=0.0)
    return 1.0 / fades if fades > _ROUNDING * np.abs(roots).max() else 0.0


def _adaptation(run: RunConfig, q: FloatArray) -> float:
    r"""Return the time in which the torque error of wrong parameters falls to 1/e along the desired motion, in s.

    For slow adaptation, s = K_D^-1 Y (theta - theta^), and on average

    .. math:: \dot{\tilde\theta} = -\Gamma \langle Y^T K_D^{-1} Y \rangle \tilde\theta

    with the rates r_i. The torque error is a sum of exponentials, whose sizes depend on the parameter errors. These are
    assumed to have the covariance Gamma. Then the mean square of Y (theta - theta^) is proportional to
    sum r_i exp(-2 r_i t). If the desired motion is one of the tip, the joint motion is linearized about the start.
    """
    law = cast(Adaptive, run.loops[0].controller)
    parameters, arm = law.parameters.own, PinocchioArm(law.models[0], law.gravity_compensation)
    root, brake = np.sqrt(parameters.adaptation_gain), np.sqrt(parameters.damping)[:, None]
    R: FloatArray = np.zeros((len(root), len(root)))
    for posture, dq, ddq in _desired_joints(run, q):
        Y = arm.regressor(posture, dq, dq, ddq)
        if Y.shape[1] < len(root):  # the law also adapts to friction
            Y = np.concatenate([Y, np.diag(dq), np.diag(np.sign(dq))], axis=1)
        scaled = Y * root / brake
        R += scaled.T @ scaled / _POSTURES
    rates = np.linalg.eigvalsh(R)
    rates = rates[rates > _WEAK * rates.max()]
    time = 0.0
    for _ in range(_STEPS if len(rates) else 0):
        left = rates * np.exp(-2.0 * rates * time)
        time += float((left.sum() - rates.sum() * math.exp(-2.0)) / (2.0 * rates @ left))
    return time


def _desired_joints(run: RunConfig, q: FloatArray) -> FloatArray:
    """Return joint positions, velocities and accelerations of the desired motion, shape (T, 3, nq)."""
    times = np.linspace(0.0, run.path.duration, _POSTURES)
    joints = run.path.sample_joints(times)
    if joints is not None:
        return joints
    inverse = np.linalg.pinv(run.arm.model.tip_jacobian(q)[:3], rcond=0.01)
    joints = run.path.sample(times) @ inverse.T
    joints[:, 0] = q
    return joints
