"""MuJoCo model of an arm, from the same URDF text as for other engines."""

import xml.etree.ElementTree as ET
from collections.abc import Mapping
from typing import Any

import mujoco
import numpy as np

from runner.base.errors import ConfigError
from runner.base.lazy_modules import pin
from runner.robots.tool_link import TOOL_MOUNT

# Links stay separate bodies, so that the mount of a tool has a reaction.
_COMPILER = {"fusestatic": "false", "discardvisual": "false", "inertiafromgeom": "false"}
_LEFT_OUT = {"joint": "dynamics", "link": "visual"}
_ROUNDING = 1e-15  # relative to a moment of inertia
_LEAST_OF_TENSOR = 1e-14  # kg m^2
FORCE, MOMENT, WALL = "reaction_force", "reaction_moment", "wall"
"""Names of elements besides the arm: the reaction sensors in a tool's mount, and the wall."""


def read_spec(urdf: str, min_inertia: float, armature: Mapping[str, float]) -> Any:
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


def compiled(spec: Any) -> Any:
    """Return the compiled model of a specification.

    Raises:
        ConfigError: if MuJoCo rejects it.
    """
    try:
        return spec.compile()
    except ValueError as error:
        raise _refused(error) from error


def _refused(error: ValueError) -> ConfigError:
    return ConfigError(f"robot.urdf: MuJoCo does not take it as it is: {' '.join(str(error).split())}")


def _is_flat(body: Any) -> bool:
    """Return True if a body's inertia about an axis is nearly zero, which MuJoCo rejects in a tensor."""
    moments = np.linalg.eigvalsh(_tensor(body))
    return bool(moments[0] < _LEAST_OF_TENSOR and moments.any())


def _tensor(body: Any) -> Any:
    xx, yy, zz, xy, xz, yz = np.nan_to_num(body.fullinertia)  # NaN if all are zero
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _give_inertia(body: Any, least: float) -> None:
    """Raise a moving link's mass and inertia to a minimum; let no moment exceed the sum of the others.

    A disc's moment may exceed it by rounding, which MuJoCo rejects.
    """
    moments, axes = np.linalg.eigh(_tensor(body))
    moments = np.maximum(moments, least)
    moments[0] = max(moments[0], (1.0 + _ROUNDING) * moments[2] - moments[1])
    axes[:, 0] *= np.linalg.det(axes)  # right-handed
    along = pin.Quaternion(*body.iquat.tolist()) * pin.Quaternion(axes)
    body.mass = max(body.mass, least)
    body.fullinertia[0] = np.nan  # the principal moments replace it
    body.inertia, body.iquat = moments, [along.w, along.x, along.y, along.z]


def _add_wall(spec: Any) -> None:
    """Add a frictionless wall, the only body in contact with the arm's shapes: the plane z = 0 until it is moved."""
    for number, geom in enumerate(spec.geoms):
        geom.name, geom.contype, geom.conaffinity = f"{WALL} {number}", 0, 0
    touching = [geom.name for geom in spec.geoms]
    spec.worldbody.add_geom(name=WALL, type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0.0, 0.0, 1.0], contype=0, conaffinity=0)
    for name in touching:
        spec.add_pair(name=name, geomname1=WALL, geomname2=name, condim=1)


def _add_tool_sensors(spec: Any, tool: str) -> None:
    """Add reaction sensors to a tool's mount, at its origin."""
    spec.body(tool).add_site(name=TOOL_MOUNT)
    for name, kind in ((FORCE, mujoco.mjtSensor.mjSENS_FORCE), (MOMENT, mujoco.mjtSensor.mjSENS_TORQUE)):
        spec.add_sensor(name=name, type=kind, objtype=mujoco.mjtObj.mjOBJ_SITE, objname=TOOL_MOUNT)
