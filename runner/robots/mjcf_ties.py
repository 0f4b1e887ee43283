"""Joint constraints of an MJCF: equality constraints, tendons, muscles and springs."""

from collections.abc import Iterator, Sequence
from itertools import chain
from typing import Any

import mujoco
import numpy as np

from runner.robots.mjcf_joints import ON_JOINTS

_MUSCLE, _FREE = mujoco.mjtDyn.mjDYN_MUSCLE, mujoco.mjtJoint.mjJNT_FREE


def take_out_ties(spec: Any) -> list[tuple[Any, str]]:
    """Take out of a specification its equality constraints, tendons, muscles, free joints, and what acts on no joint.

    Returns:
        Each joint that one of them acts on, as an element of the specification, with its words.
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
    """Return the joints that let a body of a specification go anywhere."""
    return [joint for joint in spec.joints if joint.type == _FREE]


def other_ties(model: Any) -> Iterator[tuple[int, str]]:
    """Yield joints of a compiled model, by index, that a spring moves or that slide without end, with its words."""
    sprung = (model.jnt_stiffness != 0.0) | model.jnt_stiffnesspoly.any(axis=1)
    endless = (model.jnt_type == mujoco.mjtJoint.mjJNT_SLIDE) & (model.jnt_limited == 0)
    for which, text in ((sprung, "has a spring (stiffness, springdamper)"), (endless, "slides without a range")):
        yield from ((joint, text) for joint in np.flatnonzero(which).tolist())


def _of_equalities(spec: Any) -> Iterator[tuple[str, Sequence[Any]]]:
    """Yield what each constraint that is active is called, and the joints that it acts on."""
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
    """Return the joints that a tendon pulls on: those that it names, or those between the bodies that it runs over."""
    ends = [wrap.target for wrap in tendon.path if wrap.type != mujoco.mjtWrap.mjWRAP_PULLEY]
    if tendon.path[0].type == mujoco.mjtWrap.mjWRAP_JOINT:
        return ends
    return _between([end.parent for end in ends])


def _between(bodies: Sequence[Any]) -> Sequence[Any]:
    """Return the joints that move some of the bodies and not all."""
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
