"""Joint torques for a tip acceleration and force, of a whole arm or of a mounted stage."""

from typing import Literal, NamedTuple

import numpy as np
from pydantic import NonNegativeFloat

from runner.base.arrays import FloatArray
from runner.controllers.controller import Controller, Loop, VelocityGain
from runner.controllers.macro_mini.macro_mini import MacroMiniConfig
from runner.controllers.macro_mini.macro_mini import build as build_stages
from runner.controllers.operational_space.tip_task import TipTask
from runner.controllers.operational_space.whole_body import WholeBodyLaw
from runner.controllers.operational_space.whole_body_posture import JointStiffness, PostureTask
from runner.controllers.torque_law import PinocchioArm
from runner.robots.robot import Robot
from runner.schema.model import StrictModel
from runner.schema.units import RadiansPerSecond, Seconds
from runner.schema.values import PositivePerStage, by_stage
from runner.symbolic.maths import NUMPY


class TipForceConfig(StrictModel):
    """Config of every law that commands a force on the tip.

    Attributes:
        actuated_stages: Stages that exert the force: the whole arm, or only the last stage. The lower stages then keep
            its base on the path, and their models include its mass.
        natural_frequency: omega_n of the tip motion, in rad/s, by stage; the whole arm uses that of the last stage.
        damping_ratio: xi of the tip motion, by stage; the whole arm uses that of the last stage.
        period: Time between two ticks, in s, by stage; the whole arm uses that of the last stage.
        gravity_compensation: True if the law includes the gravity term.
        feedforward: True if the law uses the desired velocity and acceleration.
        singularity_damping: As in operational-space control.
        null_space_frequency: omega_n of the posture task to home if the arm has redundant joints, in rad/s.
    """

    actuated_stages: Literal["whole", "last_stage"]
    natural_frequency: RadiansPerSecond[PositivePerStage]
    damping_ratio: PositivePerStage
    period: Seconds[PositivePerStage]
    gravity_compensation: bool
    feedforward: bool
    singularity_damping: NonNegativeFloat
    null_space_frequency: RadiansPerSecond[NonNegativeFloat]


class TaskState(NamedTuple):
    """State of the tip task, in the base frame of the arm and along the rows of the task.

    Attributes:
        axes: Directions of the task's rows in the robot's base frame, shape (rows, 3).
        q: Joint positions of the arm, shape (n,), in rad.
        dq: Joint velocities of the arm, shape (n,), in rad/s.
        gravity: Gravity in the base frame of the arm, shape (3,), in m/s^2.
        J: Jacobian of the task, shape (rows, n).
        dJ_dq: dJ/dt dq, shape (rows,), in m/s^2.
        M_inverse_J: M^-1 J^T, shape (n, rows).
        error: Desired less actual position, shape (rows,), in m.
        lag: Desired less actual velocity, shape (rows,), in m/s; the desired velocity is 0 without feedforward.
        velocity: Velocity of the tip relative to the robot's base, shape (rows,), in m/s.
        asked: F* of TipTask, shape (rows,), in m/s^2.
        desired: Desired acceleration, shape (rows,), in m/s^2; 0 without feedforward.
    """

    axes: FloatArray
    q: FloatArray
    dq: FloatArray
    gravity: FloatArray
    J: FloatArray
    dJ_dq: FloatArray  # noqa: N815 - as the papers write it
    M_inverse_J: FloatArray
    error: FloatArray
    lag: FloatArray
    velocity: FloatArray
    asked: FloatArray
    desired: FloatArray

    @property
    def mobility(self) -> FloatArray:
        """Lambda^-1 = J M^-1 J^T, shape (rows, rows), in 1/kg."""
        return np.asarray(self.J @ self.M_inverse_J)


class TipForce:
    r"""Joint torques for a tip acceleration a and an additional tip force F, with a null space.

    .. math:: \tau = h + J^T (\Lambda (a - \dot J \dot q) + F) + N^T \tau_0

    With F = 0 this is the law of WholeBody. A mounted stage has its own Lambda, J and h, as if its base were at rest;
    target, velocities and gravity are expressed in its base frame.

    Args:
        robot: The robot.
        stage: Index of the stage that exerts the force; None for the whole arm.
        law: Config of the tip motion and of the posture task.

    Raises:
        ConfigError: if the arm has fewer joints than the tip has directions of motion, or the tip cannot move.
    """

    def __init__(self, robot: Robot, stage: int | None, law: WholeBodyLaw) -> None:
        own = None if stage is None else robot.stages[stage]
        model = robot.model if own is None else own.model
        self.joints = slice(0, robot.model.nq) if own is None else own.joints
        frame = None if own is None else own.base_frame
        self._base = None if frame is None else PinocchioArm(robot.model.with_tip(frame))
        self._arm = PinocchioArm(model, law.gravity_compensation)
        self._gravity, self._feedforward = robot.model.gravity, law.feedforward
        self._task = TipTask(model, None, law, law.max_tip_speed)
        self._task.check_joints(model)
        rides = own is None and len(robot.stages) > 1
        home = robot.home if own is None else own.home
        frequency = law.null_space_frequency
        self._posture = (
            JointStiffness(model, frequency, home, self._task.rows) if rides else PostureTask(frequency, home)
        )

    @property
    def velocity_gain(self) -> VelocityGain:
        """K_v of F*."""
        return VelocityGain(0.0, float(self._task.numbers.k_v))

    @property
    def directions(self) -> FloatArray:
        """Directions of motion of the tip in the arm's base frame, shape (rows, 3)."""
        return self._task.numbers.directions

    def task_state(self, q: FloatArray, dq: FloatArray, reference: FloatArray) -> TaskState:
        """Return the state of the task from measurements of the robot, shapes (nq,), and a reference, shape (3, 3)."""
        numbers, own_q, own_dq = self._task.numbers, q[self.joints], dq[self.joints]
        tip = self._arm.tip(own_q, own_dq)
        J, dJ_dq = (values.copy() for values in self._task.jacobian(numbers, tip))
        R, carried, target, gravity = np.eye(3), np.zeros(3), reference, self._gravity
        if self._base is not None:
            x, R, moves = (values.copy() for values in self._base.tip_pose_and_twist(q, dq))
            way = reference[0] - x
            drift = reference[1] - moves[:3] - np.cross(moves[3:], way)
            target = np.array([way, drift, np.zeros(3)]) @ R  # R^T of each row
            carried = (moves[:3] + np.cross(moves[3:], R @ tip.x)) @ R
            gravity = R.T @ gravity
        error = self._task.error(NUMPY, numbers, tip, target)
        velocity, axes = J @ own_dq, numbers.directions[:, :3] @ R.T
        asked = self._task.acceleration(NUMPY, numbers, error, velocity, target)
        wanted = target[1:] @ numbers.directions[:, :3].T if self._feedforward else np.zeros((2, self._task.rows))
        M_inverse_J = NUMPY.solve_symmetric(self._arm.mass_matrix(own_q), J.T, "the mass matrix is singular")
        return TaskState(
            axes,
            own_q,
            own_dq,
            gravity,
            J,
            dJ_dq,
            M_inverse_J,
            error,
            wanted[0] - velocity,
            velocity + numbers.directions[:, :3] @ carried,
            asked,
            wanted[1],
        )

    def torque(self, state: TaskState, acceleration: FloatArray, force: FloatArray) -> FloatArray:
        """Return the torques of the law above for an acceleration and a force along the rows, shapes (rows,)."""
        J, numbers = state.J, self._task.numbers
        ddq_0, spring = self._posture.acceleration_and_torque(NUMPY, self._posture.numbers, J, state.q, state.dq)
        F = acceleration - state.dJ_dq - J @ ddq_0
        if spring is not None:
            F = F - state.M_inverse_J.T @ spring
        mobility = self._task.damp(NUMPY, numbers, J, state.error, state.mobility)
        moving = NUMPY.solve_symmetric(mobility, F, "the tip's Jacobian is singular")
        torque: FloatArray = self._arm.inverse_dynamics(state.q, state.dq, ddq_0, state.gravity) + J.T @ (
            moving + force
        )
        return torque if spring is None else torque + spring


class ForceTask(NamedTuple):
    """Stage that exerts a force on the environment, and the loops of the stages below it.

    Attributes:
        name: Name of the last stage.
        tip: TipForce of the last stage or of the whole arm.
        period: Time between two ticks of the law, in s.
        below: Loops of the stages that keep its base on the path; empty if the whole arm exerts the force.
    """

    name: str
    tip: TipForce
    period: float
    below: tuple[Loop, ...]

    def loops(self, controller: Controller, uses_wrench: bool) -> tuple[Loop, ...]:
        """Return the loops of the robot with a controller of the tip; it can use the wrist sensor."""
        return (*self.below, Loop(self.name, self.tip.joints, self.period, controller, uses_wrench=uses_wrench))


def find_force_task(config: TipForceConfig, robot: Robot) -> ForceTask:
    """Return the force task of a robot.

    Raises:
        ConfigError: if a value is missing for a stage, or an arm has too few joints.
    """
    names = robot.stage_names
    frequencies = by_stage("controller.natural_frequency", config.natural_frequency, names)
    ratios = by_stage("controller.damping_ratio", config.damping_ratio, names)
    periods = by_stage("controller.period", config.period, names)
    apart = config.actuated_stages == "last_stage" and len(names) > 1
    law = WholeBodyLaw(
        natural_frequency=frequencies[-1],
        damping_ratio=ratios[-1],
        gravity_compensation=config.gravity_compensation,
        feedforward=config.feedforward,
        null_space_frequency=config.null_space_frequency,
        max_tip_speed=None,
        singularity_damping=config.singularity_damping,
    )
    below = _carrying(config, robot, frequencies, ratios, periods) if apart else ()
    return ForceTask(names[-1], TipForce(robot, len(names) - 1 if apart else None, law), periods[-1], below)


def _carrying(
    config: TipForceConfig, robot: Robot, frequencies: list[float], ratios: list[float], periods: list[float]
) -> tuple[Loop, ...]:
    """Return the loops of all stages except the last, with one-way coupling and known mounted masses."""
    names = robot.stage_names
    stages = MacroMiniConfig(
        kind="macro_mini",
        natural_frequency=dict(zip(names, frequencies, strict=True)),
        damping_ratio=dict(zip(names, ratios, strict=True)),
        period=dict(zip(names, periods, strict=True)),
        coupling="one_way",
        damping_gain=0.0,
        macro_target="minus_home",
        mini_reference_velocity="full" if config.feedforward else "zero",
        wrist_rotation="real",
        gravity_compensation=config.gravity_compensation,
        feedforward=config.feedforward,
        schedule="both",
        reach=robot.reach(),
        beyond_reach="hold",
        payload="known",
        singularity_damping=config.singularity_damping,
    )
    return build_stages(stages, robot)[:-1]
