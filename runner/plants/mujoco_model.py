"""MuJoCo model of an arm, from the same URDF text as for other engines."""

import xml.etree.ElementTree as ET
from collections.abc import Mapping
from typing import Any

import mujoco
import numpy as np

from runner.base.errors import ConfigError
from runner.base.lazy_modules import pin
from runner.robots.tool_link import TOOL_MOUNT

# Links stay bodies of their own, so that a tool has a reaction in its mount.
_COMPILER = {"fusestatic": "false", "discardvisual": "false", "inertiafromgeom": "false"}
_LEFT_OUT = {"joint": "dynamics", "link": "visual"}
_ROUNDING = 1e-15  # of a moment of inertia
_LEAST_OF_TENSOR = 1e-14  # kg m^2
FORCE, MOMENT, WALL = "reaction_force", "reaction_moment", "wall"
"""Names of what is beside the arm: sensors of the reaction in a tool's mount, and a wall that its shapes can touch."""


def read_spec(urdf: str, min_inertia: float, armature: Mapping[str, float]) -> Any:
    """Return an arm as MuJoCo's specification, which can still be changed before it is compiled.

    Its joints have no damping and no friction, whatever the text says, and its shapes touch nothing but a wall.

    Args:
        urdf: The arm's URDF text.
        min_inertia: MuJoCo takes no moving link without mass and inertia: one with less mass, or less of a principal
            moment, gets this, in kg and kg m^2.
        armature: Of each joint by name, in kg m^2.

    Raises:
        ConfigError: if MuJoCo cannot read the text.
    """
    root = ET.fromstring(urdf)  # noqa: S314 - our own text, checked when it was read
    for own in root.findall("mujoco"):  # a file may say how MuJoCo is to read it
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
    """Return the model that a specification describes.

    Raises:
        ConfigError: if MuJoCo refuses it.
    """
    try:
        return spec.compile()
    except ValueError as error:
        raise _refused(error) from error


def _refused(error: ValueError) -> ConfigError:
    return ConfigError(f"robot.urdf: MuJoCo does not take it as it is: {' '.join(str(error).split())}")


def _is_flat(body: Any) -> bool:
    """Tell whether a body has next to no inertia about an axis, which MuJoCo refuses in a tensor."""
    moments = np.linalg.eigvalsh(_tensor(body))
    return bool(moments[0] < _LEAST_OF_TENSOR and moments.any())


def _tensor(body: Any) -> Any:
    xx, yy, zz, xy, xz, yz = np.nan_to_num(body.fullinertia)  # NaN where all are zero
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def _give_inertia(body: Any, least: float) -> None:
    """Give a moving link the least mass and inertia where it has less, and let no moment exceed the others' sum.

    By rounding that of a disc may, which MuJoCo refuses.
    """
    moments, axes = np.linalg.eigh(_tensor(body))
    moments = np.maximum(moments, least)
    moments[0] = max(moments[0], (1.0 + _ROUNDING) * moments[2] - moments[1])
    axes[:, 0] *= np.linalg.det(axes)  # right-handed
    along = pin.Quaternion(*body.iquat.tolist()) * pin.Quaternion(axes)
    body.mass = max(body.mass, least)
    body.fullinertia[0] = np.nan  # its principal moments stand for it
    body.inertia, body.iquat = moments, [along.w, along.x, along.y, along.z]


def _add_wall(spec: Any) -> None:
    """Let the arm's shapes touch nothing but a frictionless wall, the plane z = 0 of the base until it is moved."""
    for number, geom in enumerate(spec.geoms):
        geom.name, geom.contype, geom.conaffinity = f"{WALL} {number}", 0, 0
    touching = [geom.name for geom in spec.geoms]
    spec.worldbody.add_geom(name=WALL, type=mujoco.mjtGeom.mjGEOM_PLANE, size=[0.0, 0.0, 1.0], contype=0, conaffinity=0)
    for name in touching:
        spec.add_pair(name=name, geomname1=WALL, geomname2=name, condim=1)


def _add_tool_sensors(spec: Any, tool: str) -> None:
    """Put sensors of the reaction in a tool's mount at its origin."""
    spec.body(tool).add_site(name=TOOL_MOUNT)
    for name, kind in ((FORCE, mujoco.mjtSensor.mjSENS_FORCE), (MOMENT, mujoco.mjtSensor.mjSENS_TORQUE)):
        spec.add_sensor(name=name, type=kind, objtype=mujoco.mjtObj.mjOBJ_SITE, objname=TOOL_MOUNT)
