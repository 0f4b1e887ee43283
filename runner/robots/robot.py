"""Robot as a chain of stages: one arm, or several arms mounted on each other; values by joint."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.lazy_modules import pin
from runner.robots.joint_dynamics import FileDynamics
from runner.robots.model import RobotModel
from runner.schema.values import OptionalPerStage, TorquePerStage, by_stage, expand


@dataclass(frozen=True)
class Stage:
    """One arm of a robot.

    Attributes:
        name: Name of the stage.
        model: Model of this arm only, on a fixed base.
        urdf: URDF of the arm.
        joints: Slice of the arm's joints in those of the robot.
        home: Joint positions at home, in rad.
        base_frame: Frame of the robot that is the base of the arm; None for the first stage, on the robot's base.
        file: Joint dynamics in the arm's file; None if the arm has no file.
    """

    name: str
    model: RobotModel
    urdf: str
    joints: slice
    home: FloatArray
    base_frame: str | None
    file: FileDynamics | None = None

    @property
    def home_offset(self) -> FloatArray:
        """Tip position r_0 of the arm at home in its own base frame, shape (3,), in m."""
        return self.model.tip_position(self.home)


@dataclass(frozen=True)
class Robot:
    """Chain of stages, from the base outwards.

    Attributes:
        urdf: URDF of the whole robot.
        model: Rigid-body model of the whole robot; its tip is that of the last stage.
        stages: The arms.
        flange: Frame on which a tool and a force/torque sensor are fixed; the tip itself without a tool.
        payload_position: Position of the payload in the tip's frame, in m.
    """

    urdf: str
    model: RobotModel
    stages: tuple[Stage, ...]
    flange: str
    payload_position: tuple[float, ...] = (0.0, 0.0, 0.0)

    @property
    def home(self) -> FloatArray:
        """Joint positions at home, shape (nq,), in rad."""
        return np.concatenate([stage.home for stage in self.stages])

    @property
    def stage_names(self) -> tuple[str, ...]:
        """Names of the stages."""
        return tuple(stage.name for stage in self.stages)

    @property
    def stage_joints(self) -> dict[str, tuple[str, ...]]:
        """Joint names of each stage."""
        return {stage.name: stage.model.joint_names for stage in self.stages}

    def reach(self) -> float:
        """Return the largest possible distance of the tip from the first joint, in m; see RobotModel.reach."""
        return self.model.reach


def with_models(robot: Robot, change: Callable[[RobotModel, slice, bool], RobotModel]) -> Robot:
    """Return a robot with a change of its model and of the model of each stage.

    Args:
        robot: The robot.
        change: Function of a model, its joints in the robot, and whether it includes the payload; returns a new model.
    """
    last = robot.stages[-1]
    stages = tuple(replace(stage, model=change(stage.model, stage.joints, stage is last)) for stage in robot.stages)
    whole = stages[0].model if len(stages) == 1 else change(robot.model, slice(0, robot.model.nq), True)
    return replace(robot, model=whole, stages=stages)


def with_armature(robot: Robot, armature: FloatArray) -> Robot:
    """Return a robot with other armatures, shape (nq,), in kg m^2, in its models; the URDF does not change.

    With the motor inertias B of flexible joints, it is the limit for stiff springs, M + diag(B).
    """
    return with_models(robot, lambda model, joints, _: model.with_armature(armature[joints]))


class StageBase:
    """Pose and velocity of the base of a mounted stage, from the joints of the stages below it.

    Args:
        robot: The robot.
        stage: Index of the mounted stage, 1 or more.
        ignore_base_rotation: True if the base keeps its orientation at home (the thesis' R = I). Then the joints below
            only move its origin.
    """

    def __init__(self, robot: Robot, stage: int, ignore_base_rotation: bool) -> None:
        self._model = robot.model.pin_model
        self._data = self._model.createData()
        self._frame = self._model.getFrameId(robot.stages[stage].base_frame)
        self._zero = np.zeros(robot.model.nq)
        placement = self._data.oMf[self._frame]
        self.position: FloatArray = placement.translation
        """Origin of the base in the robot's base frame, shape (3,), in m; changed by `update`."""
        self.rotation: FloatArray = placement.rotation
        """Rotation from the stage's base frame to the robot's, shape (3, 3); changed by `update`."""
        self._ignore_base_rotation = ignore_base_rotation
        if ignore_base_rotation:
            pin.framesForwardKinematics(self._model, self._data, robot.home)
            self.rotation = placement.rotation.copy()

    def update(self, q: FloatArray, dq: FloatArray) -> None:
        """Update the base from the joint positions and velocities of the robot, shapes (nq,)."""
        pin.forwardKinematics(self._model, self._data, q, dq, self._zero)
        pin.updateFramePlacement(self._model, self._data, self._frame)

    def velocity(self) -> tuple[FloatArray, FloatArray]:
        """Return linear and angular velocity of the base in the robot's base frame, shapes (3,), in m/s and rad/s."""
        motion = pin.getFrameVelocity(self._model, self._data, self._frame, pin.LOCAL_WORLD_ALIGNED)
        return motion.linear, np.zeros(3) if self._ignore_base_rotation else motion.angular


def end_points(robot: Robot, q: FloatArray, ignore_base_rotation: bool = False) -> FloatArray:
    """Return the end point of every stage for rows of joint positions.

    The end point of a stage is the base origin of the stage mounted on it; that of the last stage is the tip.

    Args:
        robot: The robot.
        q: Joint positions, shape (T, nq), in rad.
        ignore_base_rotation: True if the bases of mounted stages keep their orientation at home (the thesis' R = I).

    Returns:
        Positions in the robot's base frame, shape (stages, T, 3), in m.
    """
    if len(robot.stages) == 1:
        return robot.model.tip_positions(q)[None]
    if ignore_base_rotation:
        return _end_points_of_fixed_bases(robot, q)
    frames = [stage.base_frame for stage in robot.stages[1:]]
    positions = [robot.model.frame_positions(q, str(frame)) for frame in frames]
    return np.array([*positions, robot.model.tip_positions(q)])


def _end_points_of_fixed_bases(robot: Robot, q: FloatArray) -> FloatArray:
    points = [robot.model.frame_positions(q, str(robot.stages[1].base_frame))]
    for index, stage in enumerate(robot.stages[1:], start=1):
        rotation = StageBase(robot, index, ignore_base_rotation=True).rotation
        points.append(points[-1] + stage.model.tip_positions(q[:, stage.joints]) @ rotation.T)
    return np.array(points)


def by_joint(key: str, value: TorquePerStage | OptionalPerStage, stages: Mapping[str, Sequence[str]]) -> FloatArray:
    """Return the value of a config key for each joint of a robot, shape (nq,); infinite for null.

    Args:
        key: The config key.
        value: Value of the key.
        stages: Joint names of each stage.

    Raises:
        ConfigError: if the values do not match the stages and joints of the robot.
    """
    values: list[float | None] = []
    given = [None] * len(stages) if value is None else by_stage(key, value, list(stages))
    for (name, joints), own in zip(stages.items(), given, strict=True):
        values += expand(f"{key}.{name}" if len(stages) > 1 else key, own, joints)  # type: ignore[arg-type]
    return np.array([np.inf if each is None else each for each in values])
