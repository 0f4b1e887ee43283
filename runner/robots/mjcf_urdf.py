"""URDF export of a compiled MuJoCo model."""

import xml.etree.ElementTree as ET
from collections.abc import Collection, Iterator, Mapping
from typing import Any

import mujoco
import numpy as np

from runner.base.arrays import FloatArray
from runner.base.lazy_modules import pin
from runner.robots.inertials import make_massless, write_inertial

_NO_LIMIT = 1e6  # value that the runner reads as no limit, in SI units
_LINKS = (mujoco.mjtObj.mjOBJ_BODY, mujoco.mjtObj.mjOBJ_SITE)
_HINGE = mujoco.mjtJoint.mjJNT_HINGE


def joint_name(model: Any, joint: int) -> str:
    """Return the name of a joint in the URDF: its own or one made from its body's; never that of a body or a site."""
    own: str = model.joint(joint).name
    body = int(model.jnt_bodyid[joint])
    name = own or f"{body_name(model, body)}_joint{joint - model.body_jntadr[body] + 1}"
    while any(mujoco.mj_name2id(model, kind, name) >= 0 for kind in _LINKS):
        name += "_joint"
    return name


def body_name(model: Any, body: int) -> str:
    """Return the name of a body's link in the URDF: the name of the body, or one made from its index."""
    own: str = model.body(body).name
    return own or f"body{body}"


def write_urdf(
    name: str,
    model: Any,
    efforts: Mapping[int, float],
    dynamics: Mapping[str, FloatArray],
    left_out: Mapping[str, str],
) -> tuple[str, list[str]]:
    """Return the URDF of a model of bodies with hinges and slides on a fixed base.

    Each body becomes a link with the same frame, and each site a massless link. Massless links also separate the joints
    of a body with several joints, or a joint that is not at the origin of its body.

    Args:
        name: Name of the robot.
        model: MuJoCo's compiled model.
        efforts: Effort limits of joints by index, in N m or N; other joints have no limit.
        dynamics: Damping, friction and armature of each joint, shapes (njnt,), by these names, in SI units.
        left_out: Omitted content that would change the motion, and the equivalent gravity; see LeftOut.

    Returns:
        The URDF, and messages about changed names.
    """
    robot = ET.Element("robot", name=name)
    names = _Names(body_name(model, body) for body in range(model.nbody))
    for body in range(model.nbody):
        _write_body(ET.SubElement(robot, "link", name=body_name(model, body)), model, body)
        if body:
            _write_joints(robot, model, body, efforts, dynamics, names)
    for site in range(model.nsite):
        bearer = body_name(model, int(model.site_bodyid[site]))
        link = names.claim(model.site(site).name or f"site{site}", "_site")
        _write_massless(robot, link)
        place = _frame(model.site_pos, model.site_quat, site)
        _write_joint(robot, f"{link}_fixed", "fixed", bearer, link, place)
    for joint in range(model.njnt):
        if model.joint(joint).name not in ("", joint_name(model, joint)):
            names.told.append(f"joint '{model.joint(joint).name}' is '{joint_name(model, joint)}', beside a link")
    for text, gravity in left_out.items():
        ET.SubElement(robot, "left_out", text=text, gravity=gravity)
    ET.indent(robot)
    return ET.tostring(robot, encoding="unicode"), names.told


class _Names:
    """Unique names of links.

    Args:
        taken: Names of the bodies.
    """

    def __init__(self, taken: Iterator[str]) -> None:
        self._taken = set(taken)
        self.told: list[str] = []
        """Messages about changed names."""

    def claim(self, name: str, ending: str) -> str:
        """Return a name that no other link has: the given name, with an ending if necessary."""
        new = name
        while new in self._taken:
            new += ending
        self._taken.add(new)
        if new != name:
            self.told.append(f"site '{name}' is the link '{new}', beside another")
        return new


def _write_joints(
    robot: ET.Element, model: Any, body: int, efforts: Mapping[int, float], dynamics: Mapping[str, FloatArray],
    names: _Names,
) -> None:  # fmt: skip
    """Write the joints between a body and its parent, with massless links between them."""
    parent, name = body_name(model, int(model.body_parentid[body])), body_name(model, body)
    place = _frame(model.body_pos, model.body_quat, body)
    first, offset = int(model.body_jntadr[body]), np.zeros(3)
    joints = range(first, first + int(model.body_jntnum[body]))
    for joint in joints:
        anchor = model.jnt_pos[joint].copy()
        place = place * pin.SE3(np.eye(3), anchor - offset) * _back_by_ref(model, joint)
        last = joint == joints[-1] and not anchor.any()
        child = name if last else names.claim(f"{name}_{joint_name(model, joint)}", "_link")
        kind = "revolute" if model.jnt_type[joint] == _HINGE else "prismatic"
        element = _write_joint(robot, joint_name(model, joint), kind, parent, child, place)
        ET.SubElement(element, "axis", xyz=_text(model.jnt_axis[joint]))
        lower, upper = model.jnt_range[joint] if model.jnt_limited[joint] else (-_NO_LIMIT, _NO_LIMIT)
        ET.SubElement(element, "limit", {
            "lower": repr(float(lower)), "upper": repr(float(upper)),
            "effort": repr(efforts.get(joint, _NO_LIMIT)), "velocity": repr(_NO_LIMIT),
        })  # fmt: skip
        if any(values[joint] for values in dynamics.values()):
            ET.SubElement(element, "dynamics", {key: repr(float(values[joint])) for key, values in dynamics.items()})
        if not last:
            _write_massless(robot, child)
        parent, offset, place = child, anchor, pin.SE3.Identity()
    if parent != name:
        _write_joint(robot, f"{name}_fixed", "fixed", parent, name, place * pin.SE3(np.eye(3), -offset))


def _back_by_ref(model: Any, joint: int) -> "pin.SE3":
    """Return the motion of a joint from its `ref`, the position in MuJoCo's model, back to zero."""
    axis, ref = model.jnt_axis[joint], float(model.qpos0[model.jnt_qposadr[joint]])
    if model.jnt_type[joint] == _HINGE:
        return pin.SE3(pin.exp3(-ref * axis), np.zeros(3))
    return pin.SE3(np.eye(3), -ref * axis)


def _frame(positions: FloatArray, quaternions: FloatArray, index: int) -> "pin.SE3":
    w, x, y, z = quaternions[index]
    return pin.SE3(pin.Quaternion(w, x, y, z).normalized().toRotationMatrix(), positions[index].copy())


def _write_joint(robot: ET.Element, name: str, kind: str, parent: str, child: str, place: "pin.SE3") -> ET.Element:
    joint = ET.SubElement(robot, "joint", name=name, type=kind)
    ET.SubElement(joint, "parent", link=parent)
    ET.SubElement(joint, "child", link=child)
    ET.SubElement(joint, "origin", xyz=_text(place.translation), rpy=_text(pin.rpy.matrixToRpy(place.rotation)))
    return joint


def _write_massless(robot: ET.Element, name: str) -> None:
    make_massless(ET.SubElement(robot, "link", name=name))


def _write_body(link: ET.Element, model: Any, body: int) -> None:
    """Write the mass and the inertia about the centre of mass, in the axes of the body's frame."""
    frame, mass = _frame(model.body_ipos, model.body_iquat, body), float(model.body_mass[body])
    tensor = frame.rotation @ np.diag(model.body_inertia[body]) @ frame.rotation.T * (mass > 0.0)
    write_inertial(link, mass, frame.translation, tensor)


def _text(values: Collection[float]) -> str:
    return " ".join(repr(0.0 if value == 0.0 else float(value)) for value in values)
