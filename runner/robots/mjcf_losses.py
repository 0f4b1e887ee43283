"""Unsupported elements of an MJCF: rejected ones, and omitted ones with a note."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from runner.base.sanitize import few
from runner.robots.mjcf_joints import HOME, ON_JOINTS, actuator_name, free_joints, is_motor
from runner.robots.mjcf_urdf import joint_name
from runner.robots.model import STANDARD_GRAVITY


@dataclass(frozen=True)
class LeftOut:
    """Omitted content of an MJCF.

    Attributes:
        motion: Messages about content that would change the motion, each with an equivalent value of the key `gravity`,
            or "" if there is none.
        rest: Messages about other content.
    """

    motion: Mapping[str, str]
    rest: tuple[str, ...]


def refused_parts(spec: Any) -> Iterator[str]:
    """Yield a message about each kind of unsupported element in a specification, with names and a remedy."""
    yield from _listed("mocap bodies", [b for b in spec.bodies if b.mocap], "take them out")
    balls = [joint for joint in spec.joints if joint.type == mujoco.mjtJoint.mjJNT_BALL]
    yield from _listed("ball joints", balls, "the joints of an arm are hinges and slides")


def refused_shapes(spec: Any) -> Iterator[str]:
    """Yield a message about unsupported shapes with mass, of a specification without other shapes."""
    yield from _listed("height fields that weigh", spec.hfields, "give their body an <inertial>, or take them out")


def refused_model(model: Any) -> Iterator[str]:
    """Yield a message about each unsupported property of a compiled model, with names and a remedy."""
    if not model.njnt:
        yield "has no joint: it is no arm"
    yield from _joints(model, ~np.isfinite(model.qpos0), "a ref that is no finite number:", "give a number")


def left_out(spec: Any, model: Any) -> LeftOut:
    """Return the omitted content of a file, from its specification and its compiled model."""
    return LeftOut({**_of_gravity(spec), **dict.fromkeys(_of_motion(spec, model), "")}, tuple(_of_rest(spec, model)))


def _of_gravity(spec: Any) -> dict[str, str]:
    x, y, z = spec.option.gravity.tolist()
    if spec.option.disableflags & mujoco.mjtDisableBit.mjDSBL_GRAVITY:
        return {"gravity switched off by a flag (gravity=0)": repr(0.0)}
    key = "" if x or y or z > 0.0 else repr(-z)
    return {} if key == repr(STANDARD_GRAVITY) else {f"gravity of {x:g}, {y:g}, {z:g} m/s^2 (gravity, along -z)": key}


def _of_motion(spec: Any, model: Any) -> Iterator[str]:
    for curve, text, name in (
        (model.dof_dampingpoly, "damping that grows with the speed", partial(joint_name, model)),
        (model.actuator_dampingpoly, "damping of actuators that grows with the speed", partial(actuator_name, model)),
    ):
        if curve.any():
            yield f"{text}: {few([name(index) for index in np.flatnonzero(curve.any(axis=1)).tolist()])}"
    afloat = [body.name or "one without a name" for body in spec.bodies if body.gravcomp]
    if afloat:
        yield f"gravity compensation (gravcomp) of the bodies {few(afloat)}, which weigh here"
    free = [joint.parent.name or "one without a name" for joint in free_joints(spec)]
    if free:
        yield f"free joints of the bodies {few(free)}, which stand still here"
    option = spec.option
    for text, value in (("density", option.density), ("viscosity", option.viscosity)):
        if value:
            yield f"{text} of the air of {value:g} in SI units"
    if np.any(option.wind):
        yield f"wind of {', '.join(f'{value:g}' for value in option.wind)} m/s"


def _of_rest(spec: Any, model: Any) -> Iterator[str]:
    servos = [actuator_name(model, actuator) for actuator in range(model.nactuator) if not is_motor(model, actuator)]
    servos += [
        actuator.name or "one without a name" for actuator in spec.actuators if actuator.trntype not in ON_JOINTS
    ]
    if servos:
        names = few(servos)
        yield f"gains, dynamics and transmissions of the actuators {names}: controllers command the joints"
    shapes = len(spec.geoms)
    if shapes:
        yield f"shapes ({shapes}): no wall touches them, and the arm is drawn by its joints"
    for text, elements in (
        ("sensor", spec.sensors), ("camera", spec.cameras), ("light", spec.lights),
        ("contact pair", spec.pairs), ("contact exclusion", spec.excludes),
        ("other keyframe", [key for key in spec.keys if key.name != HOME]),
    ):  # fmt: skip
        if len(elements):
            yield f"{len(elements)} {text}{'s' if len(elements) > 1 else ''}"
    if spec.option.disableflags or spec.option.enableflags:
        yield "flags of <option>"
    usual = mujoco.MjSpec().option
    if (spec.option.timestep, spec.option.integrator) != (usual.timestep, usual.integrator):
        yield "time step and integrator (plant.step, plant.integrator)"


def _listed(text: str, elements: Sequence[Any], remedy: str) -> Iterator[str]:
    if len(elements):
        yield f"holds {text}: {few([_called(element) for element in elements])}; {remedy}"


def _called(element: Any) -> str:
    """Return the label of an element in messages: its name, or that of its body."""
    if element.name:
        return f"'{element.name}'"
    on = getattr(getattr(element, "parent", None), "name", "")
    return f"one of the body '{on}'" if on else "one without a name"


def _joints(model: Any, which: NDArray[np.bool_], text: str, remedy: str) -> Iterator[str]:
    if which.any():
        names = [f"'{joint_name(model, joint)}'" for joint in np.flatnonzero(which).tolist()]
        yield f"holds {text} {few(names)}; {remedy}"
