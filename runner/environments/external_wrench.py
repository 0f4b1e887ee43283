"""External wrenches on tip and links, the equivalent joint torques, and the load on the wrist sensor."""

import numpy as np

from runner.base import portable
from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError, nearest
from runner.base.lazy_modules import pin
from runner.base.sanitize import quoted
from runner.environments import Environment
from runner.robots.mounting import find_tool, holding_wrench
from runner.robots.robot import Robot
from runner.sensing.wrench import cross, cross_matrix, wrench_transform


class Interaction:
    """External wrenches on the arm, updated at each tick.

    The load on the wrist sensor follows from the rigid-body balance of the tool. It is exact also during motion. The
    joint reaction of PyBullet has an error proportional to the square of the speeds.

    Args:
        robot: The robot, including the tool on the flange, whose weight and inertia load the sensor.
        environment: The environment; None in free space, or if the plant simulates the contact itself.
        tick: Time between two updates, in s.

    Raises:
        ConfigError: if the environment exerts a force on a link that the robot does not have.
    """

    def __init__(self, robot: Robot, environment: Environment | None, tick: float) -> None:
        self._model, self._data = robot.model.separate()
        self._environment = environment
        self._pushed = LinkForces(environment, self._model) if environment is not None and environment.points else None
        self._tick = tick
        self._tip = robot.model.tip_frame
        self._flange = self._model.getFrameId(robot.flange)
        self._tool = find_tool(self._model, self._flange)
        self._gravity = robot.model.gravity
        self._zero = np.zeros(robot.model.nq)
        self._last_dq = np.zeros(robot.model.nq)
        self.external = np.zeros(6)
        """Wrench of the environment on the tip: force in N, moment about the tip in N m, along the axes of the base."""
        self.load = np.zeros(6)
        """Wrench of environment and tool on the flange: force in N, moment about its origin in N m, along its axes."""

    def begin(self, generator: np.random.Generator) -> None:
        """Prepare the environment for a repetition with its generator of random numbers."""
        if self._environment is not None:
            self._environment.begin(self._tick, generator)

    def reset(self, q: FloatArray) -> None:
        """Reset to rest at joint positions, shape (nq,), in rad."""
        self._last_dq = np.zeros_like(q)
        pin.framesForwardKinematics(self._model, self._data, q)
        if self._environment is not None:
            self._environment.reset(self._data.oMf[self._tip].translation.copy())

    def update(self, time: float, q: FloatArray, dq: FloatArray, contact: FloatArray) -> FloatArray:
        """Update the wrenches from the true state, and return the joint torques of the environment outside the plant.

        Args:
            time: Time since the start, in s.
            q: Joint positions, shape (nq,), in rad.
            dq: Joint velocities, shape (nq,), in rad/s.
            contact: Wrench of the contacts that the plant simulated in the last tick: force in N and moment about the
                origin of the base in N m, along the axes of the base, shape (6,).

        Returns:
            Shape (nq,), in N m.
        """
        model, data = self._model, self._data
        ddq = (dq - self._last_dq) / self._tick
        self._last_dq = dq.copy()
        pin.forwardKinematics(model, data, q, dq, ddq)
        pin.computeJointJacobians(model, data)
        tip = pin.updateFramePlacement(model, data, self._tip)
        J = pin.getFrameJacobian(model, data, self._tip, pin.LOCAL_WORLD_ALIGNED)
        applied, on_joints = np.zeros(6), None
        if self._environment is not None:
            applied = self._environment.wrench(time, tip.translation.copy(), portable.dot(J[:3], dq))
            on_joints = self._environment.joint_torques(time, q, dq)
        self.external[:] = applied + contact
        self.external[3:] -= cross(tip.translation, contact[:3])
        self.load[:] = self._load_on_flange(tip)
        torques = portable.dot(J.T, applied)
        if self._pushed is not None:
            torques += self._pushed.torques(time, model, data, dq)
        if on_joints is not None:
            torques += on_joints
        return torques

    def to_flange_axes(self, wrench: FloatArray) -> FloatArray:
        """Return a wrench, shape (6,), in the axes of the flange instead of the base."""
        R = self._data.oMf[self._flange].rotation
        return np.concatenate([wrench[:3] @ R, wrench[3:] @ R])

    def _load_on_flange(self, tip: "pin.SE3") -> FloatArray:
        model, data = self._model, self._data
        flange = pin.updateFramePlacement(model, data, self._flange)
        from_base = pin.SE3(flange.rotation.T, flange.rotation.T @ (tip.translation - flange.translation))
        load: FloatArray = wrench_transform(from_base.homogeneous) @ self.external
        load -= holding_wrench(model, data, self._flange, self._tool, self._gravity)
        return load


class LinkForces:
    r"""Forces of an environment at points of links.

    .. math:: \tau = \sum_i (J_{v,i} - [r_i]_\times J_{\omega,i})^T f_i

    J_v and J_omega are the linear and angular Jacobian of a link, and r_i is the vector from the link's origin to the
    point.

    Args:
        environment: The environment.
        model: The arm's Pinocchio model.

    Raises:
        ConfigError: if the arm does not have a link.
    """

    def __init__(self, environment: Environment, model: "pin.Model") -> None:
        self._environment = environment
        links = [frame.name for frame in model.frames if frame.type == pin.FrameType.BODY]
        points = environment.points
        unknown = [link for link in points if link not in links]
        if unknown:
            raise ConfigError(
                f"environment.kind: it pushes the link {quoted(link)}, and the robot has none of that name"
                f"{nearest(link, links)}; links: {', '.join(links)}"
                for link in unknown
            )
        self._points = [(model.getFrameId(link), np.array(point, dtype=np.float64)) for link, point in points.items()]

    def torques(self, time: float, model: "pin.Model", data: "pin.Data", dq: FloatArray) -> FloatArray:
        """Return the joint torques equivalent to the forces, shape (nq,), in N m.

        Args:
            time: Time since the start, in s.
            model: The arm's Pinocchio model.
            data: Placements and joint Jacobians of the model at the true state of the arm.
            dq: True joint velocities, shape (nq,), in rad/s.
        """
        jacobians, positions = [], []
        for frame, point in self._points:
            place = pin.updateFramePlacement(model, data, frame)
            J = pin.getFrameJacobian(model, data, frame, pin.LOCAL_WORLD_ALIGNED).reshape(6, -1)
            arm = place.rotation @ point
            jacobians.append(J[:3] - cross_matrix(arm) @ J[3:])
            positions.append(place.translation + arm)
        stacked = np.reshape(jacobians, (-1, 3, len(dq)))
        forces = self._environment.link_forces(time, np.reshape(positions, (-1, 3)), stacked @ dq)
        torques: FloatArray = np.einsum("ixj,ix->j", stacked, forces)
        return torques
