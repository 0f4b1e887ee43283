"""Joints of an MJCF: effort limits, damping, friction, armature, home positions and constraints."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import chain
from typing import Any

import mujoco
import numpy as np

from runner.base.arrays import FloatArray
from runner.robots.mjcf_urdf import joint_name

HOME = "home"  # name of the keyframe that is used
ON_JOINTS = (mujoco.mjtTrn.mjTRN_JOINT, mujoco.mjtTrn.mjTRN_JOINTINPARENT)


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


def efforts_of(model: Any) -> tuple[dict[int, float], list[str]]:
    """Return the effort limit of joints by index, in N m (N for prismatic joints), and messages about them.

    The limit is the smallest of the joint's actuatorfrcrange and the ranges of its only actuator: the force range, and
    for a plain motor the control range times gain and gear. If the limits of both directions differ, the smaller one
    counts.
    """
    efforts: dict[int, float] = {}
    told: list[str] = []
    acting = _acting(model)
    for joint in range(model.njnt):
        ranges = [model.jnt_actfrcrange[joint]] if model.jnt_actfrclimited[joint] else []
        if len(acting.get(joint, ())) == 1:
            ranges += _forces(model, acting[joint][0])
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
    found = (*_of_equalities(spec), *_of_tendons(spec), *_of_muscles(spec))
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


def _of_tendons(spec: Any) -> Iterator[tuple[str, Sequence[Any]]]:
    yield from ((f"is tied by a tendon{_named(tendon)}", _pulled(tendon)) for tendon in spec.tendons)


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
