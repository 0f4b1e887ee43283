"""Base class of laws that command an acceleration and a force of the tip, of a whole arm or of a mounted stage."""

from abc import abstractmethod
from typing import Any, Literal, NamedTuple, TypeVar

import numpy as np
from pydantic import NonNegativeFloat

from runner.controllers.controller import Controller, Loop
from runner.controllers.macro_mini.macro_mini import MacroMiniConfig
from runner.controllers.macro_mini.macro_mini import build as build_stages
from runner.controllers.operational_space.whole_body import WholeBody, WholeBodyLaw
from runner.controllers.torque_law import Arms, TorqueLaw
from runner.robots.model import RobotModel
from runner.robots.robot import Robot
from runner.schema.model import StrictModel
from runner.schema.units import RadiansPerSecond, Seconds
from runner.schema.values import PositivePerStage, by_stage
from runner.sensing.wrench import cross
from runner.symbolic.maths import Array, Backend, Scalar


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


class ForceTask(NamedTuple):
    """Stage that exerts a force on the environment, and the loops of the stages below it."""

    robot: Robot
    name: str  # name of the last stage
    joints: slice  # joints of the last stage or of the whole arm
    law: WholeBody  # law of its tip without a force
    base: RobotModel | None  # robot with the base of the stage as its tip; None if the whole arm exerts the force
    feedforward: bool  # True if the law uses the desired velocity and acceleration
    period: float  # time between two ticks of the law, in s
    below: tuple[Loop, ...]  # loops of the stages that keep its base on the path; empty for the whole arm

    def loops(self, controller: Controller, uses_wrench: bool) -> tuple[Loop, ...]:
        """Return the loops of the robot with a controller of the tip; it can use the wrist sensor."""
        return (*self.below, Loop(self.name, self.joints, self.period, controller, uses_wrench=uses_wrench))


class TipMotion(NamedTuple):
    """Motion of the tip for a force law, along the rows of the task."""

    axes: Array  # directions of the rows in the robot's base frame, shape (rows, 3)
    error: Array  # desired less actual position, shape (rows,), in m
    lag: Array  # desired less actual velocity, shape (rows,), in m/s; the desired velocity is 0 without feedforward
    velocity: Array  # velocity of the tip relative to the robot's base, shape (rows,), in m/s
    asked: Array  # F* of TipTask, shape (rows,), in m/s^2
    desired: Array  # desired acceleration, shape (rows,), in m/s^2; 0 without feedforward
    mobility: Array  # Lambda^-1, shape (rows, rows), in 1/kg


N = TypeVar("N", bound=Any)  # a NamedTuple with the parameters of the WholeBody law and gravity, `law` and `gravity`


class TipForce(TorqueLaw[N]):
    r"""A law for a tip acceleration a and an additional tip force F; see WholeBody.joint_torques.

    .. math:: \tau = h + J^T (\Lambda (a - \dot J \dot q) + F) + N^T \tau_0

    A mounted stage has its own Lambda, J and h, as if its base were at rest; target, velocities and gravity are
    expressed in its base frame.

    Args:
        task: Force task of the robot.
        parameters: Parameters of the law: `law`, those of the law of the task; `gravity`, in the robot's base frame,
            shape (3,), in m/s^2; and its own.
    """

    def __init__(self, task: ForceTask, parameters: N) -> None:
        self._law, self._feedforward = task.law, task.feedforward
        self._first, self._end = task.joints.start, task.joints.stop
        bases = [] if task.base is None else [task.base]
        super().__init__([*task.law.models, *bases], task.law.gravity_compensation, parameters, task.robot.model.nq)

    @abstractmethod
    def command(self, backend: Backend, parameters: N, tip: TipMotion, state: Array) -> tuple[Array, Array, Array]:
        """Return acceleration and force along the rows, in m/s^2 and N, and the state; see TorqueLaw.evaluate."""

    def evaluate(
        self, arms: Arms, parameters: N, time: Scalar, q: Array, dq: Array, reference: Array, state: Array
    ) -> tuple[Array, Array]:
        """Return the torques of the law above; see TorqueLaw."""
        own, *base = arms
        axes = directions = parameters.law.tip.directions
        target, gravity = reference, None
        if base:
            x, R, moves = base[0].tip_pose_and_twist(q, dq)
            way = reference[0] - x
            drift = reference[1] - moves[:3] - cross(moves[3:], way)
            seen = np.array([way, drift, np.zeros(3), parameters.gravity]).dot(R)  # R^T of each row
            target, gravity, axes = seen[:3], seen[3], directions.dot(R.T)
        task = self._law.task_state(
            own, parameters.law, q[self._first : self._end], dq[self._first : self._end], target
        )
        velocity = task.velocity
        if base:
            velocity = velocity + axes.dot(moves[:3] + cross(moves[3:], R.dot(task.x)))
        wanted = target[1:].dot(directions.T) if self._feedforward else np.zeros((2, len(directions)))
        asked = self._law.acceleration(own, parameters.law, task, target)
        tip = TipMotion(axes, task.error, wanted[0] - task.velocity, velocity, asked, wanted[1], task.mobility)
        acceleration, force, state = self.command(own.backend, parameters, tip, state)
        return self._law.joint_torques(own, parameters.law, task, acceleration, force, gravity), state


def find_force_task(config: TipForceConfig, robot: Robot) -> ForceTask:
    """Return the force task of a robot.

    Raises:
        ConfigError: if a value is missing for a stage, or an arm has too few joints.
    """
    names = robot.stage_names
    frequencies = by_stage("controller.natural_frequency", config.natural_frequency, names)
    ratios = by_stage("controller.damping_ratio", config.damping_ratio, names)
    periods = by_stage("controller.period", config.period, names)
    law = WholeBodyLaw.of_stage(config, names, -1, null_space_frequency=config.null_space_frequency)
    apart = config.actuated_stages == "last_stage" and len(names) > 1
    stage, frame = robot.stages[-1], robot.stages[-1].base_frame
    first_held = None if len(names) > 1 and not apart else 0  # springs hold the stages that are mounted on others
    return ForceTask(
        robot=robot,
        name=names[-1],
        joints=stage.joints if apart else slice(0, robot.model.nq),
        law=WholeBody(*((stage.model, law, stage.home) if apart else (robot.model, law, robot.home)), first_held),
        base=robot.model.with_tip(frame) if apart and frame is not None else None,
        feedforward=config.feedforward,
        period=periods[-1],
        below=_carrying(config, robot, frequencies, ratios, periods) if apart else (),
    )


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
