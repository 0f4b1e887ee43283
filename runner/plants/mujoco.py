"""MuJoCo plant: composite-rigid-body algorithm with a choice of integrators."""

import xml.etree.ElementTree as ET
from collections.abc import Mapping
from typing import Any, Literal

import mujoco
import numpy as np
from pydantic import Field

from runner.base.arrays import FloatArray
from runner.base.errors import ConfigError
from runner.base.lazy_modules import eigen, pin
from runner.plants.decoupled import TorquePlantConfig, assemble_flexible, assemble_plant
from runner.plants.decoupled import default_step as default_step
from runner.plants.flexible_config import FlexibleJointsConfig
from runner.plants.flexible_config import modes as modes
from runner.plants.plant import Plant
from runner.robots.model import RobotModel
from runner.robots.mounting import TOOL_MOUNT
from runner.robots.robot import Robot
from runner.schema.units import AxisInertia

IMPLICIT_CONTACT = True  # a wall's spring and damper act in each step, from the velocity at its end
STOPS = True
Integrator = Literal["euler", "rk4"]
_INTEGRATORS = {
    "euler": mujoco.mjtIntegrator.mjINT_EULER,
    "rk4": mujoco.mjtIntegrator.mjINT_RK4,
}
mujoco.set_mju_user_warning(lambda text: None)  # MuJoCo would print, and write to a file, what the loop reports
_TOLERANCE = 1e-12  # of the solver for contact forces
_IMPEDANCE = 1e-4, 0.9999  # MuJoCo's range
# Links stay separate bodies, so that the mount of a tool has a reaction.
_COMPILER = {"fusestatic": "false", "discardvisual": "false", "inertiafromgeom": "false"}
_LEFT_OUT = {"joint": "dynamics", "link": "visual"}
_ROUNDING = 1e-15  # relative to a moment of inertia
_LEAST_OF_TENSOR = 1e-14  # kg m^2
# Names of elements besides the arm: the reaction sensors in a tool's mount, and the wall.
_FORCE, _MOMENT, _WALL = "reaction_force", "reaction_moment", "wall"


class MujocoConfig(TorquePlantConfig):
    """Config of the MuJoCo plant.

    Attributes:
        kind: Name in the registry.
        step: Integration step, in s; None selects a tenth of the fastest controller period, a quarter with several
            stages.
        integrator: Semi-implicit Euler (euler) or the classical Runge-Kutta scheme (rk4). MuJoCo's implicit schemes
            would equal euler, because friction of the joints acts outside MuJoCo's model.
        min_inertia: Smallest mass and principal moment of inertia of a moving link, in kg and kg m^2. Smaller values
            are raised to this one, because MuJoCo rejects moving links without mass and inertia.
        flexible_joints: Springs between motors and links; None for rigid joints.
    """

    kind: Literal["mujoco"]
    integrator: Integrator
    min_inertia: AxisInertia[float] = Field(ge=1e-12, le=1e-3)
    flexible_joints: FlexibleJointsConfig | None = None


class Mujoco(Plant):
    """A torque-controlled serial arm in MuJoCo, without damping or speed limit. It collides only with a wall.

    Args:
        urdf: URDF of the arm, as a string.
        model: Model built from the URDF, for gravity and the names of the joints.
        step: Integration step, in s.
        steps_per_tick: Integration steps for which the torques of one tick are held.
        integrator: See MujocoConfig.
        min_inertia: See MujocoConfig; in kg and kg m^2.

    Raises:
        ConfigError: if MuJoCo cannot load the URDF.
    """

    def __init__(
        self,
        urdf: str,
        model: RobotModel,
        step: float,
        steps_per_tick: int,
        integrator: Integrator,
        min_inertia: float,
    ) -> None:
        self._model = _compiled(
            _read_spec(urdf, min_inertia, dict(zip(model.joint_names, model.armature, strict=True)))
        )
        self._data = data = mujoco.MjData(self._model)
        self._steps_per_tick = steps_per_tick
        options = self._model.opt
        options.timestep, options.integrator, options.tolerance = step, _INTEGRATORS[integrator], _TOLERANCE
        # No automatic reset, because the loop reports divergence; no contact until a wall is added.
        options.disableflags |= mujoco.mjtDisableBit.mjDSBL_AUTORESET | mujoco.mjtDisableBit.mjDSBL_CONTACT
        self._set_names(model.joint_names)
        self.q, self.dq, self._tau = data.qpos, data.qvel, data.qfrc_applied
        self._wrench = np.zeros(6)
        self.set_gravity(model.gravity)

    def _set_names(self, names: tuple[str, ...]) -> None:
        found = tuple(self._model.joint(index).name for index in range(self._model.njnt))
        if found != names:
            raise ConfigError(f"robot.urdf: MuJoCo has the joints {', '.join(found)}, not {', '.join(names)}")

    def reset(self, q: FloatArray, dq: FloatArray) -> None:
        """Reset the arm to a state; see Plant."""
        mujoco.mj_resetData(self._model, self._data)
        self.q[:], self.dq[:] = q, dq

    def set_gravity(self, gravity: FloatArray) -> None:
        """Set the gravity vector; see Plant."""
        self._model.opt.gravity[:] = gravity

    def advance(self, tau: FloatArray) -> None:
        """Hold the torques for one tick; see Plant."""
        self._tau[:] = tau
        mujoco.mj_step(self._model, self._data, self._steps_per_tick)

    def add_wall(self, point: FloatArray, normal: FloatArray, stiffness: float, damping: float) -> bool:
        r"""Add a wall that touches the links with a collision shape; see Plant.

        Backward Euler on spring and damper, the contact model of Bullet, is MuJoCo's contact

        .. math:: f = (a_{ref} - a) / R, \qquad 1 / R = h^2 k + h c, \qquad a_{ref} = -R \, (k \, r + (h k + c) \, v)

        of a distance r with velocity v and acceleration a. MuJoCo expresses R by an impedance d, R = (1 - d) A / d,
        with an estimate A of the contact's inverse mass. It takes the rest as stiffness and damping of an acceleration.
        """
        model, h = self._model, self._model.opt.timestep
        wall = model.geom(_WALL).id
        turn = pin.Quaternion.FromTwoVectors(np.array([0.0, 0.0, 1.0]), normal)
        model.geom_pos[wall], model.geom_quat[wall] = point, [turn.w, turn.x, turn.y, turn.z]
        model.geom_sameframe[wall] = mujoco.mjtSameFrame.mjSAMEFRAME_NONE  # it is no longer at the base's origin
        for pair in range(model.npair):
            mobility = model.body_invweight0[model.geom_bodyid[model.pair_geom2[pair]], 0]
            added = mobility * h * (h * stiffness + damping)
            d = np.clip(added / (1.0 + added), *_IMPEDANCE)
            model.pair_solimp[pair, :2] = d
            model.pair_solref[pair] = -(1.0 - d) * mobility * np.array([stiffness, h * stiffness + damping])
        model.opt.disableflags &= ~int(mujoco.mjtDisableBit.mjDSBL_CONTACT)
        return True

    def contact_wrench(self) -> FloatArray:
        """Return the wrench of the wall on the arm; see Plant."""
        wrench, data = np.zeros(6), self._data
        for index, contact in enumerate(data.contact):
            mujoco.mj_contactForce(self._model, data, index, self._wrench)
            force = self._wrench[0] * contact.frame[:3]
            wrench += np.concatenate([force, np.cross(contact.pos, force)])
        return wrench

    def tool_reaction(self) -> FloatArray | None:
        """Return the wrench of the tool on the flange in the last step, as MuJoCo computes it; None without a tool.

        Force in N and moment about the flange's origin in N m, along the base's axes, shape (6,). It is the value at
        the start of the step, exact in motion.
        """
        if not self._model.nsensor:
            return None
        data = self._data
        turned = data.site(TOOL_MOUNT).xmat.reshape(3, 3)
        return -np.concatenate([turned @ data.sensor(name).data for name in (_FORCE, _MOMENT)])

    def joint_axes(self, q: FloatArray) -> FloatArray:
        """Return axis and origin of each joint as MuJoCo has them; see RobotModel.joint_axes."""
        data = mujoco.MjData(self._model)
        data.qpos[:] = q
        mujoco.mj_kinematics(self._model, data)
        return np.hstack([data.xaxis, data.xanchor])

    def mass_matrix(self, q: FloatArray) -> FloatArray:
        """Return MuJoCo's joint-space mass matrix, shape (nq, nq), in kg m^2."""
        data, M = mujoco.MjData(self._model), np.zeros((len(q), len(q)))
        data.qpos[:] = q
        mujoco.mj_fwdPosition(self._model, data)
        mujoco.mj_fullM(self._model, data, M)
        return M


def _read_spec(urdf: str, min_inertia: float, armature: Mapping[str, float]) -> Any:
    """Return an arm as MuJoCo's specification, which can be changed before it is compiled.

    Damping and friction in the URDF are ignored. The arm's shapes collide only with a wall.

    Args:
        urdf: URDF of the arm, as a string.
        min_inertia: Smallest mass and principal moment of inertia of a moving link, in kg and kg m^2; smaller values
            are raised to this one.
        armature: Armature of each joint by name, in kg m^2.

    Raises:
        ConfigError: if MuJoCo cannot read the URDF.
    """
    root = ET.fromstring(urdf)  # noqa: S314 - text from the runner, checked when it was read
    for own in root.findall("mujoco"):  # a file may contain settings for MuJoCo's parser
        root.remove(own)
    ET.SubElement(ET.SubElement(root, "mujoco"), "compiler", _COMPILER)
    for whole, part in _LEFT_OUT.items():
        for element in root.iter(whole):
            for left_out in element.findall(part):
                element.remove(left_out)
    try:
        spec = mujoco.MjSpec.from_string(ET.tostring(root, encoding="unicode"))
    except ValueError as error:
        raise _refused(error) from error
    for body in spec.bodies:
        if body.joints:
            _give_inertia(body, min_inertia)
        elif _is_flat(body):
            _give_inertia(body, 0.0)
    for joint in spec.joints:
        joint.armature = armature.get(joint.name, 0.0)
    _add_wall(spec)
    for mounted in root.iterfind(f"joint[@name='{TOOL_MOUNT}']/child"):
        _add_tool_sensors(spec, mounted.get("link", ""))
    return spec


def _compiled(spec: Any) -> Any:
    """Return the compiled model of a specification.

    Raises:
        ConfigError: if MuJoCo rejects it.
    """
    try:
        return spec.compile()
    except ValueError as error:
        raise _refused(error) from error


def _refused(error: ValueError) -> ConfigError:
    return ConfigError(f"robot.urdf: MuJoCo does not accept it: {' '.join(str(error).split())}")


def _is_flat(body: Any) -> bool:
    """Return True if a body's inertia about an axis is nearly zero, which MuJoCo rejects in a tensor."""
    moments = eigen.SelfAdjointEigenSolver(_tensor(body)).eigenvalues()
    return bool(moments[0] < _LEAST_OF_TENSOR and moments.any())


def _tensor(body: Any) -> Any:
    xx, yy, zz, xy, xz, yz = np.nan_to_num(body.fullinertia)  # NaN if all are zero
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _give_inertia(body: Any, least: float) -> None:
    """Raise a moving link's mass and inertia to a minimum; let no moment exceed the sum of the others.

    A disc's moment may exceed it by rounding, which MuJoCo rejects.
    """
    principal = eigen.SelfAdjointEigenSolver(_tensor(body))
    moments, axes = np.maximum(principal.eigenvalues(), least), principal.eigenvectors().copy()
    moments[0] = max(moments[0], (1.0 + _ROUNDING) * moments[2] - moments[1])
    axes[:, 0] *= np.linalg.det(axes)  # right-handed
    along = pin.Quaternion(*body.iquat.tolist()) * pin.Quaternion(axes)
    body.mass = max(body.mass, least)
    body.fullinertia[0] = np.nan  # the principal moments replace it
    body.inertia, body.iquat = moments, [along.w, along.x, along.y, along.z]


def _add_wall(spec: Any) -> None:
    """Add a frictionless wall, the only body in contact with the arm's shapes: the plane z = 0 until it is moved."""
    for number, geom in enumerate(spec.geoms):
        geom.name, geom.contype, geom.conaffinity = f"{_WALL} {number}", 0, 0
    touching = [geom.name for geom in spec.geoms]
    spec.worldbody.add_geom(
        name=_WALL, type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0.0, 0.0, 1.0], contype=0, conaffinity=0
    )
    for name in touching:
        spec.add_pair(name=name, geomname1=_WALL, geomname2=name, condim=1)


def _add_tool_sensors(spec: Any, tool: str) -> None:
    spec.body(tool).add_site(name=TOOL_MOUNT)
    for name, kind in ((_FORCE, mujoco.mjtSensor.mjSENS_FORCE), (_MOMENT, mujoco.mjtSensor.mjSENS_TORQUE)):
        spec.add_sensor(name=name, type=kind, objtype=mujoco.mjtObj.mjOBJ_SITE, objname=TOOL_MOUNT)


CONFIG = MujocoConfig


def build(config: MujocoConfig, robot: Robot, step: float, steps_per_tick: int) -> Plant:
    """Build the plant of a config."""
    tick, chosen = step * steps_per_tick, (config.integrator, config.min_inertia)
    if config.flexible_joints is not None:
        parts = config, config.flexible_joints, robot, step, steps_per_tick
        return assemble_flexible(*parts, lambda links: Mujoco(robot.urdf, links, step, 1, *chosen))
    return assemble_plant(config, robot, tick, lambda urdf, model: Mujoco(urdf, model, step, steps_per_tick, *chosen))


def moves_exactly(config: MujocoConfig) -> bool:
    """Return True if the integrator is the Runge-Kutta scheme."""
    return config.integrator == "rk4"
