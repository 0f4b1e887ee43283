"""Rigid-body model of a robot arm: kinematics and dynamics of joints and tip, with Pinocchio."""

import copy
import xml.etree.ElementTree as ET
from collections.abc import Callable, Sequence
from functools import cached_property

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.engine_output import caught_output
from runner.base.errors import ConfigError
from runner.base.lazy_modules import pin
from runner.robots.elements import NO_LIMIT
from runner.robots.tree import check_tip

STANDARD_GRAVITY = 9.81  # m/s^2, the thesis' value (its G(q) shows 9.81 and 19.62)

_MOST_JOINTS = 64
_OF_GEOMETRY = "reach", "shoulder", "kinematics"  # cached properties of RobotModel
_SAID = r"\s*(Error|Warning|Info|Debug):|\s+at line \d+ in "  # start of a line from the URDF reader of Pinocchio


class RobotModel:
    """Rigid-body model of a fixed-base serial arm with revolute and prismatic joints.

    The armature of the joints, the reflected inertia of motors and gears, is read from `<dynamics armature="...">` and
    acts on the diagonal of the mass matrix only. Every result is a new array. Positions and Jacobians are in the base
    frame. Units of joints are those of revolute joints; for prismatic joints, read m, m/s and N instead of rad, rad/s
    and N m.

    Args:
        urdf: The URDF as a string.
        tip: Name of the controlled frame, the tool centre point.
        gravity: Magnitude of gravity along -z of the base, in m/s^2.

    Raises:
        ConfigError: if Pinocchio reports a problem in the URDF, if it has no moving joint, too many, a joint of another
            type, or a prismatic joint without limits, or if the frame does not exist.
    """

    def __init__(self, urdf: str, tip: str, gravity: float = STANDARD_GRAVITY) -> None:
        self.pin_model = _build(urdf)
        self.pin_model.gravity.linear = np.array([0.0, 0.0, -gravity])
        self.pin_model.armature = _armature(urdf, list(self.pin_model.names)[1:])
        joints = list(self.pin_model.joints)[1:]
        self.joint_names: tuple[str, ...] = tuple(list(self.pin_model.names)[1:])
        _check_joints(self.pin_model, self.joint_names)
        check_tip(tip, [frame.name for frame in self.pin_model.frames])
        self.tip_name = tip
        self.tip_frame: int = self.pin_model.getFrameId(tip)
        self.nq: int = self.pin_model.nq
        self.prismatic = np.array([joint.shortname().startswith("JointModelP") for joint in joints], dtype=bool)
        """True for each prismatic joint, shape (nq,)."""
        endless = self.prismatic & ~np.isfinite(self.position_limits).all(axis=0)
        if endless.any():
            raise ConfigError(
                f"robot.urdf: joint '{self.joint_names[index]}' slides without limits; give it a <limit> with lower "
                "and upper, in m"
                for index in np.flatnonzero(endless)
            )
        self._data = self.pin_model.createData()

    def tip_position(self, q: FloatArray) -> FloatArray:
        """Return the tip position in the base frame, shape (3,), in m."""
        return self.tip_pose(q)[:3, 3].copy()

    def tip_pose(self, q: FloatArray) -> FloatArray:
        """Return the tip's homogeneous transform in the base frame, shape (4, 4)."""
        pin.framesForwardKinematics(self.pin_model, self._data, q)
        pose: FloatArray = self._data.oMf[self.tip_frame].homogeneous.copy()
        return pose

    def tip_positions(self, q: FloatArray) -> FloatArray:
        """Return the tip positions for rows of joint positions, shapes (T, nq) to (T, 3), in m."""
        return self.frame_positions(q, self.tip_name)

    def frame_positions(self, q: FloatArray, frame: str) -> FloatArray:
        """Return the positions of a frame for rows of joint positions, shapes (T, nq) to (T, 3), in m."""
        positions, index = np.empty((len(q), 3)), self.pin_model.getFrameId(frame)
        origin = self._data.oMf[index].translation  # a view that each update refreshes
        for row, configuration in zip(positions, q, strict=True):
            pin.forwardKinematics(self.pin_model, self._data, configuration)
            pin.updateFramePlacement(self.pin_model, self._data, index)
            row[:] = origin
        return positions

    def frame_poses(self, q: FloatArray, frames: tuple[str, ...]) -> FloatArray:
        """Return the transforms of named frames in the base frame, shape (len(frames), 4, 4)."""
        pin.framesForwardKinematics(self.pin_model, self._data, q)
        ids = [self.pin_model.getFrameId(name) for name in frames]
        return np.array([self._data.oMf[index].homogeneous for index in ids])

    def tip_jacobian(self, q: FloatArray) -> FloatArray:
        """Return the tip's basic Jacobian in the base frame, shape (6, nq): linear rows first (thesis eq. 3.5)."""
        jacobian: FloatArray = pin.computeFrameJacobian(
            self.pin_model, self._data, q, self.tip_frame, pin.LOCAL_WORLD_ALIGNED
        )
        return jacobian.reshape(6, self.nq)  # for one joint, Pinocchio returns a vector

    def tip_bias_acceleration(self, q: FloatArray, dq: FloatArray) -> FloatArray:
        """Return the tip's linear acceleration at zero joint acceleration, dJ/dt dq, shape (3,), in m/s^2."""
        pin.forwardKinematics(self.pin_model, self._data, q, dq, np.zeros(self.nq))
        acceleration = pin.getFrameClassicalAcceleration(
            self.pin_model, self._data, self.tip_frame, pin.LOCAL_WORLD_ALIGNED
        )
        linear: FloatArray = acceleration.linear.copy()
        return linear

    def joint_axes(self, q: FloatArray) -> FloatArray:
        """Return axis and origin of each joint in the base frame, shape (nq, 6); origins in m."""
        pin.forwardKinematics(self.pin_model, self._data, q)
        found = []
        for joint, place in zip(list(self.pin_model.joints)[1:], list(self._data.oMi)[1:], strict=True):
            own = joint.createData()
            joint.calc(own, np.zeros(1))
            linear, angular = np.split(np.ravel(own.S), 2)
            found.append([*place.rotation @ (angular if angular.any() else linear), *place.translation])
        return np.array(found)

    def mass_matrix(self, q: FloatArray) -> FloatArray:
        """Return the joint-space mass matrix M(q), shape (nq, nq), in kg m^2 (thesis eq. 3.11)."""
        M: FloatArray = np.triu(pin.crba(self.pin_model, self._data, q))  # crba fills the upper triangle only
        M += np.triu(M, 1).T
        return M

    @property
    def inertial_parameters(self) -> FloatArray:
        """Ten parameters of each moving body, shape (10 nq,), in the order of Arm.regressor."""
        return np.concatenate([inertia.toDynamicParameters() for inertia in list(self.pin_model.inertias)[1:]])

    def gravity_torque(self, q: FloatArray) -> FloatArray:
        """Return the gravity term G(q), shape (nq,), in N m (thesis eq. 3.24)."""
        torque: FloatArray = pin.computeGeneralizedGravity(self.pin_model, self._data, q).copy()
        return torque

    def coriolis_torque(self, q: FloatArray, dq: FloatArray) -> FloatArray:
        """Return the centrifugal and Coriolis term V(q, dq), shape (nq,), in N m (thesis eq. 3.12)."""
        bias: FloatArray = pin.nonLinearEffects(self.pin_model, self._data, q, dq)
        return bias - self.gravity_torque(q)

    def forward_dynamics(self, q: FloatArray, dq: FloatArray, tau: FloatArray) -> FloatArray:
        """Return the joint accelerations under the given torques, shape (nq,), in rad/s^2 (thesis eq. 3.25)."""
        acceleration: FloatArray = pin.aba(self.pin_model, self._data, q, dq, tau).copy()
        return acceleration

    def energy(self, q: FloatArray, dq: FloatArray) -> float:
        """Return the mechanical energy, kinetic plus potential, in J."""
        return float(pin.computeMechanicalEnergy(self.pin_model, self._data, q, dq))

    @property
    def link_names(self) -> tuple[str, ...]:
        """Name of the link that each joint moves."""
        frames = list(self.pin_model.frames)
        of_joint = {frame.parentFrame: frame.name for frame in frames if frame.type == pin.FrameType.BODY}
        return tuple(of_joint[self.pin_model.getFrameId(name)] for name in self.joint_names)

    @property
    def gravity(self) -> FloatArray:
        """Gravity in the base frame, shape (3,), in m/s^2."""
        gravity: FloatArray = self.pin_model.gravity.linear.copy()
        return gravity

    @property
    def mass(self) -> float:
        """Mass of all moving links, in kg."""
        return float(sum(inertia.mass for inertia in list(self.pin_model.inertias)[1:]))

    @property
    def armature(self) -> FloatArray:
        """Reflected inertia of the motor and gear of each joint, shape (nq,), in kg m^2."""
        armature: FloatArray = self.pin_model.armature.copy()
        return armature

    def with_armature(self, armature: FloatArray) -> "RobotModel":
        """Return this arm with other armatures, shape (nq,), in kg m^2."""
        return self.with_change(lambda model: setattr(model, "armature", armature.copy()))

    def copy(self) -> "RobotModel":
        """Return a copy of this arm with a separate Pinocchio model."""
        return self.with_change(lambda model: None)

    def with_change(self, change: Callable[["pin.Model"], object]) -> "RobotModel":
        """Return this arm with a change of a copy of its Pinocchio model, made by a function of the copy."""
        own = copy.copy(self)
        own.pin_model, own._data = self.separate(change)
        for remembered in _OF_GEOMETRY:
            own.__dict__.pop(remembered, None)
        return own

    def separate(self, change: Callable[["pin.Model"], object] = lambda model: None) -> "tuple[pin.Model, pin.Data]":
        """Return a copy of the Pinocchio model, changed by a function, and its data."""
        model = pin.Model(self.pin_model)
        change(model)
        return model, model.createData()

    def with_payload(self, mass: float, position: FloatArray | None = None) -> "RobotModel":
        """Return this arm with a point mass fixed at its tip.

        Args:
            mass: The mass, in kg; a negative value removes mass.
            position: Position of the mass in the tip's frame, shape (3,), in m; None is the tip itself.
        """
        frame = self.pin_model.frames[self.tip_frame]
        point = pin.Inertia(mass, np.zeros(3) if position is None else position, np.zeros((3, 3)))
        return self.with_change(lambda model: model.appendBodyToJoint(frame.parentJoint, point, frame.placement))

    def with_tip(self, frame: str) -> "RobotModel":
        """Return this arm with another frame, given by name, as its tip."""
        other = self.copy()
        other.tip_name, other.tip_frame = frame, self.pin_model.getFrameId(frame)
        return other

    @property
    def position_limits(self) -> FloatArray:
        """Lower and upper position limits in the URDF, shape (2, nq), in rad; -inf and inf without a limit."""
        model = self.pin_model
        return np.array([-_limits(-model.lowerPositionLimit), _limits(model.upperPositionLimit)])

    @property
    def usual_range(self) -> FloatArray:
        """Position limits, for revolute joints clipped to one turn, about zero if possible, shape (2, nq)."""
        lower, upper = limits = self.position_limits
        turn = np.clip(limits, -np.pi, np.pi)
        from_end = np.maximum(lower, upper - 2.0 * np.pi), np.minimum(upper, lower + 2.0 * np.pi)
        beside = np.where(np.isfinite(limits), limits, from_end)
        return np.where(self.prismatic, limits, np.where(turn[0] == turn[1], beside, turn))

    @property
    def joint_units(self) -> tuple[str, ...]:
        """Unit of the position of each joint: rad, or m for prismatic joints."""
        return tuple("m" if prismatic else "rad" for prismatic in self.prismatic)

    @property
    def velocity_limits(self) -> FloatArray:
        """Speed limits in the URDF, shape (nq,), in rad/s; inf without a limit."""
        return _limits(self.pin_model.upperVelocityLimit)

    @property
    def effort_limits(self) -> FloatArray:
        """Effort limits in the URDF, shape (nq,), in N m; inf without a limit."""
        return _limits(self.pin_model.upperEffortLimit)

    def limit_margins(self, q: FloatArray) -> FloatArray:
        """Return the distance of joint positions to the nearer limit, shapes (..., nq), in rad; negative outside."""
        lower, upper = self.position_limits
        margins: FloatArray = np.minimum(q - lower, upper - q)
        return margins

    @cached_property
    def reach(self) -> float:
        """Largest possible distance of the tip from the first joint's origin, from link lengths and travels, in m."""
        placements = list(self.pin_model.jointPlacements)[2:]
        last = self.pin_model.frames[self.tip_frame].placement
        travel = float(np.abs(self.position_limits[:, self.prismatic]).max(axis=0).sum())
        return float(sum(np.linalg.norm(p.translation) for p in (*placements, last))) + travel

    @cached_property
    def kinematics(self) -> bytes:
        """Bytes that are equal for two arms with the same kinematics of the tip and the same position limits."""
        model = self.pin_model
        tip = model.frames[self.tip_frame]
        parts = [self.position_limits, list(model.parents), tip.parentJoint, tip.placement.homogeneous]
        for joint, placement in zip(list(model.joints)[1:], list(model.jointPlacements)[1:], strict=True):
            data = joint.createData()
            joint.calc(data, np.zeros(1))
            parts += [placement.homogeneous, data.S]
        return b"".join(np.asarray(part, dtype=np.float64).tobytes() for part in parts)

    @cached_property
    def shoulder(self) -> FloatArray:
        """Origin of the first joint in the base frame, shape (3,), in m: the centre of the workspace."""
        origin: FloatArray = self.pin_model.jointPlacements[1].translation.copy()
        return origin


def _build(urdf: str) -> "pin.Model":
    model, said = _read(urdf)
    if said:  # about a shape that Pinocchio does not support; models have no shapes
        model, said = _read(_without_shapes(urdf))
    if said:
        raise ConfigError(f"robot.urdf: Pinocchio does not accept it: {' '.join(said)}")
    return model


def _armature(urdf: str, joints: Sequence[str]) -> FloatArray:
    """Return the armature of joints in a URDF, shape (nq,), in kg m^2."""
    if "armature" not in urdf:
        return np.zeros(len(joints))
    robot = ET.fromstring(urdf)  # noqa: S314 - Pinocchio has read it
    found = {joint.get("name"): joint.find("dynamics[@armature]") for joint in robot.iter("joint")}
    values = [found.get(name) for name in joints]
    return np.array([0.0 if value is None else float(value.get("armature", "0")) for value in values])


def _read(urdf: str) -> "tuple[pin.Model, list[str]]":
    """Return the model of a URDF, and the messages of the URDF reader."""
    said: list[str] = []
    try:
        with caught_output(2, _SAID) as said:
            return pin.buildModelFromXML(urdf), said
    except (ValueError, RuntimeError) as error:
        raise ConfigError(f"robot.urdf: Pinocchio cannot build it: {' '.join([str(error), *said])}") from error


def _without_shapes(urdf: str) -> str:
    robot = ET.fromstring(urdf)  # noqa: S314 - Pinocchio has read it
    for link in robot.iter("link"):
        for shape in (*link.findall("visual"), *link.findall("collision")):
            link.remove(shape)
    return ET.tostring(robot, encoding="unicode")


def _check_joints(model: "pin.Model", names: Sequence[str]) -> None:
    problems = []
    if not 1 <= len(names) <= _MOST_JOINTS:
        problems.append(f"robot.urdf: {len(names) or 'no'} joints that move; allowed: 1 to {_MOST_JOINTS}")
    for name, joint in zip(names, list(model.joints)[1:], strict=True):
        if joint.nq != 1 or not joint.shortname().startswith(("JointModelR", "JointModelP")):
            allowed = "revolute (with wide limits) or prismatic"
            problems.append(f"robot.urdf: joint '{name}' has another type; allowed: {allowed}")
    if problems:
        raise ConfigError(problems)


def _limits(values: FloatArray) -> FloatArray:
    """Return limits, with inf for values that mean no limit."""
    limits: FloatArray = np.where(values < NO_LIMIT, values, np.inf)
    return limits
