"""PyBullet as the engine of one arm: Featherstone's algorithm with semi-implicit Euler integration."""

import struct

import numpy as np

from runner.base.arrays import FloatArray
from runner.base.lazy_modules import pin, pybullet
from runner.plants.bullet_servers import SERVERS
from runner.plants.compiled_motion import CompiledLinksTorque
from runner.plants.plant import Plant
from runner.robots.model import RobotModel
from runner.robots.mounting import TOOL_MOUNT

# Bullet clamps joint speeds at 100 rad/s by default; a Mini's free goal move is faster than that.
_NO_SPEED_LIMIT = 1e12


class LinksTorque:
    r"""Torques that give links without armature the accelerations of an arm with armature.

    .. math:: \tau' = \tau - A \ddot q, \qquad (M + A) \ddot q + h = \tau
        \quad\Rightarrow\quad M \ddot q + h = \tau'

    h is the bias and gravity torque. The result is exact in free motion, in each state. Accelerations come from
    compiled code if available, else from Pinocchio's articulated-body algorithm.

    Args:
        model: Model of the arm, with its armature A.
    """

    def __init__(self, model: RobotModel) -> None:
        self._compiled = CompiledLinksTorque.compile(model)
        self._model, self._data = model.separate()
        self._armature = model.armature

    def set_gravity(self, gravity: FloatArray) -> None:
        """Set the gravity vector in the base frame, shape (3,), in m/s^2."""
        self._model.gravity.linear = gravity
        if self._compiled is not None:
            self._compiled.set_gravity(gravity)

    def at(self, q: FloatArray, dq: FloatArray, tau: FloatArray) -> FloatArray:
        """Return the torques of the links in a state, shape (nq,), in N m; valid until the next call."""
        if self._compiled is not None:
            return self._compiled.at(q, dq, tau)
        links: FloatArray = tau - self._armature * pin.aba(self._model, self._data, q, dq, tau)
        return links


class Bullet(Plant):
    """A torque-controlled arm in PyBullet, without motors, damping or speed limit. It collides only with a wall.

    PyBullet has no armature. In each step, an arm with armature receives the torques that give its accelerations.

    Args:
        urdf: URDF of the arm, as a string.
        model: Model built from the URDF, for gravity and the order of the joints.
        step: Integration step, in s.
        steps_per_tick: Integration steps for which the torques of one tick are held.

    Raises:
        ConfigError: if PyBullet cannot load the URDF, or prints anything while loading it.
    """

    def __init__(self, urdf: str, model: RobotModel, step: float, steps_per_tick: int) -> None:
        self._state = np.zeros(2 * model.nq)
        self.q, self.dq = np.split(self._state, 2)
        self._put = struct.Struct(f"{2 * model.nq}d").pack_into  # a third of the time of filling arrays from tuples
        self._steps_per_tick = steps_per_tick
        self._armature = model.armature
        self._links_torque = LinksTorque(model) if self._armature.any() else None
        self._wall: int | None = None
        self._server = SERVERS.open(urdf)
        self._client, self._body = self._server.client, self._server.body
        try:
            self._set_up(model, step)
        except BaseException:
            SERVERS.give_back(self._server, reusable=False)
            raise

    def _set_up(self, model: RobotModel, step: float) -> None:
        """Configure the server for this plant, whatever the previous plant left."""
        self._joints = self._order_joints(model.joint_names)
        if self._server.used:
            self.reset(self.q, self.dq)
        else:
            self._remove_damping_and_motors()
        self._tool_mount = self._enable_tool_sensor()
        self.set_gravity(model.gravity)
        # Bullet splits one stepSimulation into the steps. That is bit-identical to separate calls, and cheaper.
        # Its "substeps" start at 2; 0 means none.
        at_once = self._steps_per_tick if self._links_torque is None else 1
        pybullet.setPhysicsEngineParameter(
            fixedTimeStep=step * at_once,
            numSubSteps=at_once if at_once > 1 else 0,
            physicsClientId=self._client,
        )

    def _enable_tool_sensor(self) -> int | None:
        """Enable the reaction sensor in the tool's mount, at its origin in world axes; return its joint's index."""
        index = self._joint_indices().get(TOOL_MOUNT)
        if index is not None:
            pybullet.setPhysicsEngineParameter(jointFeedbackMode=3, physicsClientId=self._client)
            pybullet.enableJointForceTorqueSensor(self._body, index, 1, physicsClientId=self._client)
        return index

    def _order_joints(self, names: tuple[str, ...]) -> list[int]:
        index = self._joint_indices()
        return [index[name] for name in names]

    def _joint_indices(self) -> dict[str, int]:
        count = pybullet.getNumJoints(self._body, physicsClientId=self._client)
        infos = [pybullet.getJointInfo(self._body, i, physicsClientId=self._client) for i in range(count)]
        return {info[1].decode(): info[0] for info in infos}

    def _remove_damping_and_motors(self) -> None:
        # Two calls: PyBullet 3.2.7 ignores jointDamping in a call with maxJointVelocity.
        undamped = {"linearDamping": 0.0, "angularDamping": 0.0, "jointDamping": 0.0}
        for link in range(-1, pybullet.getNumJoints(self._body, physicsClientId=self._client)):
            for settings in (undamped, {"maxJointVelocity": _NO_SPEED_LIMIT}):
                pybullet.changeDynamics(self._body, link, **settings, physicsClientId=self._client)
        pybullet.setJointMotorControlArray(
            self._body,
            self._joints,
            pybullet.VELOCITY_CONTROL,
            forces=[0.0] * len(self._joints),
            physicsClientId=self._client,
        )

    def reset(self, q: FloatArray, dq: FloatArray) -> None:
        """Reset the arm to a state; see Plant."""
        for joint, position, velocity in zip(self._joints, q.tolist(), dq.tolist(), strict=True):
            pybullet.resetJointState(self._body, joint, position, velocity, physicsClientId=self._client)
        self.q[:], self.dq[:] = q, dq

    def set_gravity(self, gravity: FloatArray) -> None:
        """Set the gravity vector; see Plant."""
        pybullet.setGravity(*gravity.tolist(), self._client)
        if self._links_torque is not None:
            self._links_torque.set_gravity(gravity)

    def advance(self, tau: FloatArray) -> None:
        """Hold the torques for one tick; see Plant."""
        if self._links_torque is None:
            self._hold(tau)
            return
        for _ in range(self._steps_per_tick):
            self._hold(self._links_torque.at(self.q, self.dq, tau))

    def _hold(self, tau: FloatArray) -> None:
        """Hold torques of the links for one call of stepSimulation."""
        client, body, joints = self._client, self._body, self._joints
        pybullet.setJointMotorControlArray(
            body, joints, pybullet.TORQUE_CONTROL, forces=tau.tolist(), physicsClientId=client
        )
        pybullet.stepSimulation(client)
        states = pybullet.getJointStates(body, joints, client)
        self._put(self._state.data, 0, *[state[0] for state in states], *[state[1] for state in states])

    def add_wall(self, point: FloatArray, normal: FloatArray, stiffness: float, damping: float) -> bool:
        """Add a wall that touches the links with a collision shape; see Plant."""
        client = self._client
        box = pybullet.createCollisionShape(pybullet.GEOM_BOX, halfExtents=[1.0, 1.0, 0.5], physicsClientId=client)
        turn = pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), normal).coeffs()
        middle = (point - 0.5 * normal).tolist()
        self._wall = pybullet.createMultiBody(
            0.0, box, basePosition=middle, baseOrientation=turn.tolist(), physicsClientId=client
        )
        pybullet.setPhysicsEngineParameter(contactSlop=0.0, physicsClientId=client)  # else 10 um without force
        pybullet.changeDynamics(
            self._wall,
            -1,
            contactStiffness=stiffness,
            contactDamping=damping,
            lateralFriction=0.0,
            physicsClientId=client,
        )
        return True

    def tool_reaction(self) -> FloatArray | None:
        """Return the wrench of the tool on the flange in the last step, as Bullet computes it; None without a tool.

        Force in N and moment about the flange's origin in N m, along the base's axes, shape (6,). In motion it has an
        error quadratic in the speeds, at any step.
        """
        if self._tool_mount is None:
            return None
        return -np.array(pybullet.getJointState(self._body, self._tool_mount, physicsClientId=self._client)[2])

    def contact_wrench(self) -> FloatArray:
        """Return the wrench of the wall on the arm; see Plant."""
        wrench = np.zeros(6)
        if self._wall is not None:
            for contact in pybullet.getContactPoints(self._body, self._wall, physicsClientId=self._client):
                # Bullet divides the impulse of the last step by the duration of all steps of the tick.
                place, force = np.array(contact[5]), self._steps_per_tick * contact[9] * np.array(contact[7])
                wrench += np.concatenate([force, np.cross(place, force)])
        return wrench

    def joint_axes(self, q: FloatArray) -> FloatArray:
        """Return axis and origin of each joint as Bullet has them; see RobotModel.joint_axes."""
        self.reset(q, np.zeros_like(q))
        found = []
        for joint in self._joints:
            axis = pybullet.getJointInfo(self._body, joint, physicsClientId=self._client)[13]
            state = pybullet.getLinkState(self._body, joint, 0, 1, physicsClientId=self._client)
            turned = pybullet.rotateVector(state[1], axis)  # it is given in the frame of the centre of mass
            found.append([*turned, *state[4]])
        return np.array(found)

    def mass_matrix(self, q: FloatArray) -> FloatArray:
        """Return Bullet's mass matrix with armature, shape (nq, nq), in kg m^2, in the model's order of joints."""
        places = np.argsort(np.argsort(self._joints))  # Bullet uses its own order of joints
        ordered = np.empty_like(q)
        ordered[places] = q
        M = np.array(pybullet.calculateMassMatrix(self._body, ordered.tolist(), physicsClientId=self._client))
        return M[np.ix_(places, places)] + np.diag(self._armature)

    def close(self) -> None:
        """Return the physics server for reuse by the next plant of the same arm."""
        changed = self._wall is not None or self._tool_mount is not None  # their engine parameters would persist
        diverged = not (np.isfinite(self.q).all() and np.isfinite(self.dq).all())
        SERVERS.give_back(self._server, reusable=not (changed or diverged))
