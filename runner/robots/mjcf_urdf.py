"""URDF export of a compiled MuJoCo model, with effort limits, joint dynamics, home positions and constraints."""

import xml.etree.ElementTree as ET
from collections.abc import Collection, Iterator, Mapping, Sequence
from itertools import chain
from typing import Any

import mujoco
import numpy as np

from runner.base.arrays import FloatArray
from runner.base.lazy_modules import pin
from runner.robots.elements import add_joint, vector_text
from runner.robots.inertials import make_massless, write_inertial
from runner.robots.mjcf_motors import MotorLimits

HOME = "home"  # name of the keyframe that is used
ON_JOINTS = (mujoco.mjtTrn.mjTRN_JOINT, mujoco.mjtTrn.mjTRN_JOINTINPARENT)
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
        name, new = model.joint(joint).name, joint_name(model, joint)
        if name not in ("", new):
            names.told.append(f"joint '{name}' is '{new}', as a link has the name")
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
            self.told.append(f"site '{name}' is the link '{new}', as another link has the name")
        return new


def _write_joints(
    robot: ET.Element, model: Any, body: int, efforts: Mapping[int, float], dynamics: Mapping[str, FloatArray],
    names: _Names,
) -> None:  # fmt: skip
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
    rpy = pin.rpy.matrixToRpy(place.rotation)
    return add_joint(robot, name, kind, parent, child, xyz=_text(place.translation), rpy=_text(rpy))


def _write_massless(robot: ET.Element, name: str) -> None:
    make_massless(ET.SubElement(robot, "link", name=name))


def _write_body(link: ET.Element, model: Any, body: int) -> None:
    """Write the mass and the inertia about the centre of mass, in the axes of the body's frame."""
    frame, mass = _frame(model.body_ipos, model.body_iquat, body), float(model.body_mass[body])
    tensor = frame.rotation @ np.diag(model.body_inertia[body]) @ frame.rotation.T * (mass > 0.0)
    write_inertial(link, mass, frame.translation, tensor)


def _text(values: Collection[float]) -> str:
    return vector_text(value or 0.0 for value in values)  # 0.0 for -0.0


def dynamics_of(model: Any) -> Mapping[str, FloatArray]:
    """Return damping, friction and armature of each joint, shapes (njnt,), in SI units, including its actuators.

    The speed of an actuator is that of its joint times the gear, so its values are multiplied by the squared gear.
    """
    gear = np.zeros((model.nactuator, model.njnt))
    for joint, actuators in _acting(model).items():
        gear[actuators, joint] = model.actuator_gear[actuators, 0]
    return {
        "damping": model.dof_damping + model.actuator_damping @ gear**2,
        "friction": model.dof_frictionloss.copy(),
        "armature": model.dof_armature + model.actuator_armature @ gear**2,
    }


def home_of(spec: Any, model: Any) -> dict[str, float]:
    """Return the joint positions of the keyframe `home` by joint, in rad or m; empty without this keyframe."""
    for key in spec.keys:
        if key.name == HOME and len(key.qpos) == model.nq:
            return {joint_name(model, joint): float(key.qpos[joint]) for joint in range(model.njnt)}
    return {}


def efforts_of(model: Any, motors: Mapping[int, MotorLimits]) -> tuple[dict[int, float], list[str]]:
    """Return the effort limit of joints by index, in N m (N for prismatic joints), and messages about them.

    The limit is the smallest of the joint's actuatorfrcrange and the ranges of its only actuator: the force range, for
    a plain motor the control range times gain and gear, and for a direct-current motor its stall torque. If the limits
    of both directions differ, the smaller one counts.

    Args:
        model: MuJoCo's compiled model.
        motors: Limits of direct-current motors by actuator; see motor_limits.
    """
    efforts: dict[int, float] = {}
    told: list[str] = []
    acting = _acting(model)
    for joint in range(model.njnt):
        ranges = [model.jnt_actfrcrange[joint]] if model.jnt_actfrclimited[joint] else []
        if len(acting.get(joint, ())) == 1:
            ranges += _forces(model, acting[joint][0])
            stall = motors.get(acting[joint][0], MotorLimits(None, None)).stall_torque
            ranges += [] if stall is None else [np.array([-stall, stall])]
        elif joint in acting:
            told.append(f"the limits of the {len(acting[joint])} actuators of joint '{joint_name(model, joint)}'")
        for low, high in ranges:
            effort = float(min(abs(low), abs(high)))
            efforts[joint] = min(effort, efforts.get(joint, effort))
            if abs(low) != abs(high):
                ends = f"from {min(low, high):g} to {max(low, high):g}"
                told.append(
                    f"effort of joint '{joint_name(model, joint)}' {ends}, of which {effort:g} stands both ways"
                )
    return efforts, told


def _acting(model: Any) -> dict[int, list[int]]:
    """Return the indices of the actuators on each joint, by index of the joint; joints without actuators are absent."""
    acting: dict[int, list[int]] = {}
    on_joints = [int(kind) for kind in ON_JOINTS]
    for actuator in range(model.nactuator):
        if model.actuator_trntype[actuator] in on_joints:
            acting.setdefault(int(model.actuator_trnid[actuator, 0]), []).append(actuator)
    return acting


def _forces(model: Any, actuator: int) -> list[FloatArray]:
    """Return the ranges of the torque of an actuator on its joint."""
    gear, ranges = model.actuator_gear[actuator, 0], []
    if model.actuator_forcelimited[actuator]:
        ranges.append(gear * model.actuator_forcerange[actuator])
    if is_motor(model, actuator) and model.actuator_ctrllimited[actuator]:
        ranges.append(gear * model.actuator_gainprm[actuator, 0] * model.actuator_ctrlrange[actuator])
    return ranges


def is_motor(model: Any, actuator: int) -> bool:
    """Return True if the force of an actuator on its joint is its control times gain and gear."""
    return bool(
        model.actuator_gaintype[actuator] == mujoco.mjtGain.mjGAIN_FIXED
        and model.actuator_biastype[actuator] == mujoco.mjtBias.mjBIAS_NONE
        and model.actuator_dyntype[actuator] == mujoco.mjtDyn.mjDYN_NONE
        and any(actuator in acting for acting in _acting(model).values())
    )


def actuator_name(model: Any, actuator: int) -> str:
    """Return the name of an actuator, or one made from its index."""
    return model.actuator(actuator).name or f"actuator{actuator}"


_MUSCLE, _FREE = mujoco.mjtDyn.mjDYN_MUSCLE, mujoco.mjtJoint.mjJNT_FREE


def take_out_ties(spec: Any) -> list[tuple[Any, str]]:
    """Remove equality constraints, tendons, muscles, free joints and actuators without a joint from a specification.

    Returns:
        Each constrained joint, as an element of the specification, with a message.
    """
    tendons = ((f"is tied by a tendon{_named(tendon)}", _pulled(tendon)) for tendon in spec.tendons)
    found = (*_of_equalities(spec), *tendons, *_of_muscles(spec))
    ties = [(joint, text) for text, joints in found for joint in joints if joint.type != _FREE]
    free = free_joints(spec)
    names = [joint.name for joint in free if joint.name]
    others = [
        each
        for each in spec.actuators
        if each.trntype not in ON_JOINTS or each.dyntype == _MUSCLE or each.target in names
    ]
    for element in (*others, *spec.equalities, *spec.tendons, *free):
        spec.delete(element)
    return ties


def free_joints(spec: Any) -> list[Any]:
    """Return the free joints of a specification."""
    return [joint for joint in spec.joints if joint.type == _FREE]


def other_ties(model: Any) -> Iterator[tuple[int, str]]:
    """Yield the joints of a compiled model, by index, with a spring or with unlimited sliding, with a message."""
    sprung = (model.jnt_stiffness != 0.0) | model.jnt_stiffnesspoly.any(axis=1)
    endless = (model.jnt_type == mujoco.mjtJoint.mjJNT_SLIDE) & (model.jnt_limited == 0)
    for which, text in ((sprung, "has a spring (stiffness, springdamper)"), (endless, "slides without a range")):
        yield from ((joint, text) for joint in np.flatnonzero(which).tolist())


def _of_equalities(spec: Any) -> Iterator[tuple[str, Sequence[Any]]]:
    """Yield a message about each active constraint, and the joints on which it acts."""
    for equality in spec.equalities:
        names = [name for name in (equality.name1, equality.name2) if name]
        joints: Sequence[Any]
        if equality.type == mujoco.mjtEq.mjEQ_JOINT:
            joints = [spec.joint(name) for name in names]
        elif equality.type == mujoco.mjtEq.mjEQ_TENDON:
            joints = [joint for name in names for joint in _pulled(spec.tendon(name))]
        elif equality.objtype == mujoco.mjtObj.mjOBJ_SITE:
            joints = _between([spec.site(name).parent for name in names])
        else:
            joints = _between([spec.body(name) for name in names] + [spec.worldbody] * (len(names) == 1))
        if equality.active:
            yield f"is tied by an equality constraint{_named(equality)}", joints


def _of_muscles(spec: Any) -> Iterator[tuple[str, Sequence[Any]]]:
    for actuator in spec.actuators:
        if actuator.dyntype == _MUSCLE and actuator.trntype in ON_JOINTS:
            yield f"is pulled by a muscle{_named(actuator)}", [spec.joint(actuator.target)]


def _pulled(tendon: Any) -> Sequence[Any]:
    """Return the joints of a fixed tendon, or the joints between the bodies along the path of a spatial tendon."""
    ends = [wrap.target for wrap in tendon.path if wrap.type != mujoco.mjtWrap.mjWRAP_PULLEY]
    if tendon.path[0].type == mujoco.mjtWrap.mjWRAP_JOINT:
        return ends
    return _between([end.parent for end in ends])


def _between(bodies: Sequence[Any]) -> Sequence[Any]:
    """Return the joints that move some of the bodies but not all."""
    ways = [_way(body) for body in bodies]
    return [joint for joint in dict.fromkeys(chain(*ways)) if not all(joint in way for way in ways)]


def _way(body: Any) -> list[Any]:
    """Return the joints between the world and a body."""
    way: list[Any] = []
    while body is not None:
        way += body.joints
        body = body.parent
    return way


def _named(element: Any) -> str:
    return f" '{element.name}'" if element.name else ""
