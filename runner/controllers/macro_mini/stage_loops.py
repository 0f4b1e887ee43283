"""Control loops of mounted arms: control law and coupled target of each stage."""

from collections.abc import Sequence
from typing import Any, Literal, NamedTuple, TypeVar

import numpy as np

from runner.base.arrays import FloatArray
from runner.controllers.controller import VelocityGain
from runner.controllers.operational_space.operational_space import tip_law
from runner.controllers.operational_space.whole_body import WholeBodyLaw
from runner.controllers.torque_law import Arm, Arms, TorqueLaw, second_order, structure_of
from runner.robots.model import RobotModel
from runner.robots.robot import Robot, end_points
from runner.sensing.wrench import cross
from runner.symbolic.maths import Array, Backend, Scalar

Aim = Literal["rest", "own_offset", "base_offset"]

_STILL = np.zeros(3)


class StageParameters(NamedTuple):
    """The parameters of a stage's law."""

    tip: Any
    k_p: Scalar  # omega_n^2 of a held configuration, in 1/s^2
    k_v: Scalar  # 2 xi omega_n of a held configuration, in 1/s


class StageLaw:
    r"""Control law of a stage from only its own model: move the tip, or hold a configuration.

    tip_law moves the tip; its null space pulls more than three joints home. Inverse dynamics in joint space hold a
    configuration q_0:

    .. math:: \tau = M (-\omega_n^2 (q - q_0) - 2 \xi \omega_n \dot q) + V + G

    Args:
        model: The stage's arm on a fixed base.
        law: Config of the tip law; omega_n, xi and the gravity term also apply to a held configuration.
        home: Joint positions at home, shape (nq,), in rad.

    Attributes:
        model: The arm.
        gravity_compensation: True if the law includes the gravity term.
        parameters: Parameters of the law.

    Raises:
        ConfigError: if the arm has fewer joints than the tip has directions of motion.
    """

    def __init__(self, model: RobotModel, law: WholeBodyLaw, home: FloatArray) -> None:
        self.model, self.gravity_compensation = model, law.gravity_compensation
        self._tip: Any = tip_law(model, law, home)  # OperationalSpace or WholeBody, with different types of numbers
        gains = second_order(law.natural_frequency, law.damping_ratio)
        self.parameters = StageParameters(self._tip.parameters, *gains)

    def structure(self) -> dict[str, Any]:
        """Return the attributes without the parameters; see TorqueLaw.structure."""
        return structure_of(self)

    def move(
        self, arm: Arm, parameters: StageParameters, q: Array, dq: Array, reference: Array, gravity: Array | None = None
    ) -> Array:
        """Return the torques that move the tip to a reference in the base frame of the stage; see WholeBody.control."""
        torque: Array = self._tip.control(arm, parameters.tip, q, dq, reference, gravity)
        return torque

    def hold(
        self, arm: Arm, parameters: StageParameters, q: Array, dq: Array, posture: Array, gravity: Array | None = None
    ) -> Array:
        """Return the torques that hold a configuration, shape (nq,), in rad; see Arm.inverse_dynamics for gravity."""
        return arm.inverse_dynamics(q, dq, parameters.k_p * (posture - q) - parameters.k_v * dq, gravity)


class MacroParameters(NamedTuple):
    """The parameters of the first stage's loop."""

    law: StageParameters
    offset: Array  # offset o as a motion at rest, shape (3, 3)
    later: Array  # home offset of the stages on the first mounted stage, in the robot's base frame, shape (3,), in m
    rotations: Array  # rotations from the mounted stages' base frames at home into the robot's, shape (mounted, 3, 3)
    reach: Scalar  # distance up to which the first mounted stage follows its target, in m
    turn: Scalar  # length of a turn, in s


class MiniParameters(NamedTuple):
    """The parameters of a mounted stage's loop."""

    law: StageParameters
    offset: Array  # home offset r_0 as a motion at rest, shape (3, 3)
    later: Array  # home offset of the stages mounted on it, in the robot's base frame, shape (3,), in m
    rotation: Array  # rotation from its base frame at home into the robot's, shape (3, 3)
    between: Array  # the same for each mounted stage below it, (k, 3, 3); k is 0 unless base rotation is ignored
    gravity: Array  # gravity in the robot's base frame, shape (3,), in m/s^2
    reach: Scalar  # distance up to which the stage follows its target, in m
    turn: Scalar  # length of a turn, in s


class HeldParameters(NamedTuple):
    """The parameters of a loop that holds a stage's joints."""

    law: StageParameters
    posture: Array  # held configuration, shape (n,), in rad
    rotation: Array  # rotation from the stage's base frame at home into the robot's, shape (3, 3)
    gravity: Array  # gravity in the robot's base frame, shape (3,), in m/s^2


N = TypeVar("N", bound=Any)  # a NamedTuple with the parameters of the stage's law, `law`


class StageLoop(TorqueLaw[N]):
    """Base class of the loops of stages; `_released` is the state without a held configuration.

    Args:
        robot: The robot.
        stage: Index of the stage.
        law: Law of the stage.
        models: Further arms of the loop.
        parameters: Parameters of the loop, including `law`, those of the stage's law.
    """

    _released: FloatArray = np.zeros(0)

    def __init__(self, robot: Robot, stage: int, law: StageLaw, models: Sequence[RobotModel], parameters: N) -> None:
        self._law, joints = law, robot.stages[stage].joints
        self._first, self._end = joints.start, joints.stop
        super().__init__([law.model, *models], law.gravity_compensation, parameters, robot.model.nq)

    @property
    def velocity_gain(self) -> VelocityGain:
        """K_v."""
        return VelocityGain(0.0, self.parameters.law.k_v)

    def start(self, q: FloatArray) -> FloatArray:
        """Return the state without a held configuration; see TorqueLaw."""
        return self._released

    def own(self, q: Array, dq: Array) -> tuple[Array, Array]:
        """Return the positions and velocities of the stage's joints."""
        return q[self._first : self._end], dq[self._first : self._end]


class MacroController(StageLoop[MacroParameters]):
    """The loop of the first stage, which is fixed to the ground.

    Its target is x_d - o. The offset o of the mounted stages is 0 (macro_target tip_goal), their offset at home
    (minus_home), or their present offset (two-way coupling).

    Args:
        robot: The robot.
        law: Law of the stage.
        offset: Offset o, shape (3,), in m; None for the present offset.
        ignore_base_rotation: True if the rotation of the mounted stages' bases is taken as that at home.
        reach: Distance up to which the first mounted stage follows its target, in m.
        turn: Length of a turn, in s; see mini_moves. None if the stages move at any time.
    """

    def __init__(
        self,
        robot: Robot,
        law: StageLaw,
        offset: FloatArray | None,
        ignore_base_rotation: bool,
        reach: float,
        turn: float | None,
    ) -> None:
        minis = range(1, len(robot.stages))
        placed = [base_at_home(robot, mini) for mini in minis]
        bases = [model for model, _ in placed]
        self._turns, self._ignore_base_rotation = turn is not None, ignore_base_rotation
        self._minis = [(s.joints.start, s.joints.stop) for s in robot.stages[1:]] if offset is None else []
        self._bases = len(bases) if offset is None and not ignore_base_rotation else int(self._turns)
        self._released = _no_posture(law.model.nq if self._turns else None)
        tips = [stage.model for stage in robot.stages[1:]] if offset is None else []
        at_home = end_points(robot, robot.home[None])[:, 0]
        parameters = MacroParameters(
            law=law.parameters,
            offset=_at_rest(_STILL if offset is None else offset),
            later=at_home[-1] - at_home[1],
            rotations=np.array([rotation for _, rotation in placed]),
            reach=reach,
            turn=0.0 if turn is None else turn,
        )
        super().__init__(robot, 0, law, [*bases[: self._bases], *tips], parameters)

    def evaluate(
        self, arms: Arms, parameters: MacroParameters, time: Scalar, q: Array, dq: Array, reference: Array, state: Array
    ) -> tuple[Array, Array]:
        """Return the torques of the first stage, and the state of the held configuration; see TorqueLaw."""
        own, (own_q, own_dq) = arms[0], self.own(q, dq)
        bases = [arm.tip_pose(q) for arm in arms[1 : 1 + self._bases]] if self._bases else []
        target = reference - parameters.offset
        if self._minis:
            rotations = parameters.rotations if self._ignore_base_rotation else [R for _, R in bases]
            for (first, end), mini, R in zip(self._minis, arms[1 + self._bases :], rotations, strict=True):
                x, _ = mini.tip_pose(q[first:end])
                target[0] -= R.dot(x)
        if not self._turns:
            return self._law.move(own, parameters.law, own_q, own_dq, target), state
        backend, distance = own.backend, reference[0] - bases[0][0] - parameters.later
        beyond = backend.less(parameters.reach * parameters.reach, distance.dot(distance))
        own_turn = backend.less(mini_moves(backend, parameters.turn, time), 0.5)
        return backend.choose(
            backend.any_of(own_turn, beyond),
            lambda: (self._law.move(own, parameters.law, own_q, own_dq, target), self._released),
            lambda: _hold(self._law, own, parameters.law, own_q, own_dq, state),
        )


class MiniController(StageLoop[MiniParameters]):
    """The loop of a mounted stage.

    Its target in its base frame is R^T (x_d - o - x_E). o is the home offset of the stages mounted on it, regardless of
    their rotation, because each of them compensates the remaining error. The reach is measured from its base to this
    target, so it is that of the stage's own arm. Gravity in its base frame is R^T g. With ignore_base_rotation, x_E is
    the first stage's end point plus the offsets of the stages between, with R at home.

    With another aim the target is its home offset: r_0 in its base frame, which turns with the stage below, or R^T r_0
    with r_0 in the robot's base frame.

    Args:
        robot: The robot.
        stage: Index of the stage, 1 or more.
        law: Law of the stage.
        aim: Target: the remaining distance (rest), or the home offset in its own or the robot's base frame.
        later_offset: Home offset o of the stages mounted on this one, in the robot's base frame, shape (3,), in m.
        ignore_base_rotation: True if the rotation of its base is taken as that at home.
        moving_target: True if the target's velocity is part of the reference.
        reach: Distance up to which the stage follows its target, in m.
        stretch: True if it stretches towards a target beyond reach; else it holds its configuration.
        turn: Length of a turn, in s; see mini_moves. None if the stages move at any time.
    """

    def __init__(
        self,
        robot: Robot,
        stage: int,
        law: StageLaw,
        aim: Aim,
        later_offset: FloatArray,
        ignore_base_rotation: bool,
        moving_target: bool,
        reach: float,
        stretch: bool,
        turn: float | None,
    ) -> None:
        self._aim, self._ignore_base_rotation = aim, ignore_base_rotation
        self._stretch, self._turns = stretch, turn is not None
        self._moving = moving_target and aim != "own_offset"
        r_0 = robot.stages[stage].home_offset
        self._follows = aim == "rest"
        self._holds = self._follows and (self._turns or not stretch)
        self._released = _no_posture(law.model.nq if self._holds else None)
        at_home, between = base_at_home(robot, stage)[1], robot.stages[1:stage] if ignore_base_rotation else ()
        self._between = [(below.joints.start, below.joints.stop) for below in between]
        base, _ = base_at_home(robot, stage - len(between))
        parameters = MiniParameters(
            law=law.parameters,
            offset=_at_rest(at_home.dot(r_0) if aim == "base_offset" else r_0),
            later=later_offset,
            rotation=at_home,
            between=np.array([base_at_home(robot, index)[1] for index in range(1, 1 + len(between))]).reshape(-1, 3, 3),
            gravity=robot.model.gravity,
            reach=reach,
            turn=0.0 if turn is None else turn,
        )
        super().__init__(robot, stage, law, [base, *(below.model for below in between)], parameters)

    def evaluate(
        self, arms: Arms, parameters: MiniParameters, time: Scalar, q: Array, dq: Array, reference: Array, state: Array
    ) -> tuple[Array, Array]:
        """Return the torques of this stage, and the state of the held configuration; see TorqueLaw."""
        own = arms[0]
        backend, (own_q, own_dq) = own.backend, self.own(q, dq)
        way, target, gravity = self._target(arms[1:], parameters, q, dq, reference)
        if not self._follows:
            return self._law.move(own, parameters.law, own_q, own_dq, target, gravity), state
        squared, near = way.dot(way), target
        beyond = backend.less(parameters.reach * parameters.reach, squared)
        if self._stretch:
            target = backend.choose(
                beyond, lambda: _at_rest(near[0] * (parameters.reach / backend.sqrt(squared))), lambda: near
            )
        if not self._holds:
            return self._law.move(own, parameters.law, own_q, own_dq, target, gravity), state
        return backend.choose(
            self._waits(backend, parameters, time, beyond),
            lambda: _hold(self._law, own, parameters.law, own_q, own_dq, state, gravity),
            lambda: (self._law.move(own, parameters.law, own_q, own_dq, target, gravity), self._released),
        )

    def _target(
        self, below: Arms, parameters: MiniParameters, q: Array, dq: Array, reference: Array
    ) -> tuple[Array, Array, Array]:
        """Return the vector to the target in the robot's base frame; target and gravity in the stage's."""
        base, *between = below
        if self._moving:
            x, R, moves = base.tip_pose_and_twist(q, dq)
        else:
            x, R = base.tip_pose(q)
        for (first, end), arm, turned in zip(self._between, between, parameters.between, strict=True):
            if self._moving:
                offset, _, goes = arm.tip_pose_and_twist(q[first:end], dq[first:end])
                moves = np.concatenate([moves[:3] + turned.dot(goes[:3]), moves[3:]])
            else:
                offset, _ = arm.tip_pose(q[first:end])
            x = x + turned.dot(offset)
        if self._ignore_base_rotation:
            R = parameters.rotation
        if self._aim == "own_offset":
            return parameters.offset[0], parameters.offset, R.T.dot(parameters.gravity)
        way = reference[0] - parameters.later - x if self._follows else parameters.offset[0]
        velocity = _STILL
        if self._moving:
            velocity = reference[1] - moves[:3] if self._follows else _STILL
            velocity = velocity if self._ignore_base_rotation else velocity - cross(moves[3:], way)
        seen = np.array([way, velocity, _STILL, parameters.gravity]).dot(R)  # R^T of each row
        return way, seen[:3], seen[3]

    def _waits(self, backend: Backend, parameters: MiniParameters, time: Scalar, beyond: Scalar) -> Scalar:
        if not self._turns:
            return beyond
        waits = backend.less(mini_moves(backend, parameters.turn, time), 0.5)
        return waits if self._stretch else backend.any_of(waits, beyond)


class HeldController(StageLoop[HeldParameters]):
    """The loop of a mounted stage whose joints are held at home.

    Args:
        robot: The robot.
        stage: Index of the stage, 1 or more.
        law: Law of the stage.
        ignore_base_rotation: True if the rotation of its base is taken as that at home.
    """

    def __init__(self, robot: Robot, stage: int, law: StageLaw, ignore_base_rotation: bool) -> None:
        self._ignore_base_rotation = ignore_base_rotation
        base, at_home = base_at_home(robot, stage)
        parameters = HeldParameters(law.parameters, robot.stages[stage].home, at_home, robot.model.gravity)
        super().__init__(robot, stage, law, [base], parameters)

    def evaluate(
        self, arms: Arms, parameters: HeldParameters, time: Scalar, q: Array, dq: Array, reference: Array, state: Array
    ) -> tuple[Array, Array]:
        """Return the torques of this stage; see TorqueLaw."""
        own, base = arms
        R = parameters.rotation if self._ignore_base_rotation else base.tip_pose(q)[1]
        own_q, own_dq = self.own(q, dq)
        gravity = R.T.dot(parameters.gravity)
        return self._law.hold(own, parameters.law, own_q, own_dq, parameters.posture, gravity), state


def mini_moves(backend: Backend, turn: Scalar, time: Scalar) -> Scalar:
    """Return 0 in the turns of the first stage, which begins, and 1 in those of the mounted stages; turn is in s."""
    count = backend.floor(time / turn + 1e-9)
    return count - 2.0 * backend.floor(0.5 * count)


def base_at_home(robot: Robot, stage: int) -> tuple[RobotModel, FloatArray]:
    """Return the robot with the base of a mounted stage as its tip, and the base's rotation at home, shape (3, 3)."""
    frame = robot.stages[stage].base_frame
    assert frame is not None  # noqa: S101 - a mounted stage
    model = robot.model.with_tip(frame)
    return model, model.tip_pose(robot.home)[:3, :3]


def _at_rest(position: Array) -> Array:
    """Return a position as a motion at rest, shape (3, 3)."""
    return np.array([position, _STILL, _STILL])


def _no_posture(joints: int | None) -> FloatArray:
    """Return the state without a held configuration: joint positions, then a flag; empty if a stage never holds."""
    return np.zeros(0 if joints is None else joints + 1)


def _hold(
    law: StageLaw,
    arm: Arm,
    parameters: StageParameters,
    q: Array,
    dq: Array,
    state: Array,
    gravity: Array | None = None,
) -> tuple[Array, Array]:
    """Return the torques that hold the configuration at the start of a hold, and its state."""
    backend = arm.backend
    kept = backend.choose(backend.less(0.5, state[-1]), lambda: state, lambda: np.concatenate([q, [1.0]]))
    return law.hold(arm, parameters, q, dq, kept[:-1], gravity), kept
