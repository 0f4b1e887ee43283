"""External wrenches on the arm, the equivalent joint torques, and the load on the wrist sensor."""

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.lazy_modules import pin
from runner.environments import Environment
from runner.environments.link_forces import LinkForces
from runner.robots.mounting import find_tool, holding_wrench
from runner.robots.robot import Robot
from runner.sensing.wrench import cross, wrench_transform


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
            applied = self._environment.wrench(time, tip.translation.copy(), J[:3] @ dq)
            on_joints = self._environment.joint_torques(time, q, dq)
        self.external[:] = applied + contact
        self.external[3:] -= cross(tip.translation, contact[:3])
        self.load[:] = self._load_on_flange(tip)
        torques: FloatArray = J.T @ applied
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
