"""What an MJCF holds that no arm of ours has: refused by name, or named as left out."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Any

import mujoco
import numpy as np
from numpy.typing import NDArray

from runner.robots.mjcf_efforts import is_motor
from runner.robots.mjcf_urdf import body_name, joint_name
from runner.robots.model import FloatArray
from runner.texts import few

_GRAVITY = (0.0, 0.0, -9.81)


@dataclass(frozen=True)
class LeftOut:
    """What is left out of an MJCF.

    Attributes:
        motion: What would change the arm's motion, in words.
        rest: All else, in words.
    """

    motion: tuple[str, ...]
    rest: tuple[str, ...]


def refused_parts(spec: Any) -> Iterator[str]:
    """Yield what no arm of ours has, of MuJoCo's specification of a file, with its names and what to do about it."""
    muscle = mujoco.mjtDyn.mjDYN_MUSCLE
    yield from _listed("tendons", spec.tendons, "take them out, with what pulls on them")
    yield from _listed("muscles", [a for a in spec.actuators if a.dyntype == muscle], "give the joints motors")
    yield from _listed("equality constraints", spec.equalities, "take them out, or make the joints fixed")
    yield from _listed("mocap bodies", [b for b in spec.bodies if b.mocap], "take them out")
    yield from _listed("bodies without gravity (gravcomp)", [b for b in spec.bodies if b.gravcomp], "take gravcomp out")
    for kind, text in ((mujoco.mjtJoint.mjJNT_FREE, "free joints"), (mujoco.mjtJoint.mjJNT_BALL, "ball joints")):
        joints = [joint for joint in spec.joints if joint.type == kind]
        yield from _listed(text, joints, "an arm stands on the world, and its joints are hinges and slides")


def refused_shapes(spec: Any) -> Iterator[str]:
    """Yield shapes that cannot weigh, of a specification in which only those are left that do."""
    yield from _listed("height fields that weigh", spec.hfields, "give their body an <inertial>, or take them out")


def refused_model(model: Any) -> Iterator[str]:
    """Yield what no arm of ours has, of a compiled model, with its names and what to do about it."""
    if not model.njnt:
        yield "has no joint: it is no arm"
    roots = [int(np.flatnonzero(model.body_treeid == tree)[0]) for tree in range(model.ntree)]
    if len(roots) > 1:
        names = ", ".join(f"'{body_name(model, root)}'" for root in roots)
        yield f"holds several trees, which begin at the bodies {names}; allowed: one arm, with what stands on the world"
    sprung = (model.jnt_stiffness != 0.0) | model.jnt_stiffnesspoly.any(axis=1)
    yield from _joints(model, sprung, "springs at the joints", "take stiffness and springdamper out")
    yield from _joints(model, ~np.isfinite(model.qpos0), "a ref that is no finite number:", "mend it")
    endless = (model.jnt_type == mujoco.mjtJoint.mjJNT_SLIDE) & (model.jnt_limited == 0)
    yield from _joints(model, endless, "slides without a range:", "give each its range, in m")


def left_out(spec: Any, model: Any) -> LeftOut:
    """Return what is left out of a file, of its specification and the model compiled of it."""
    return LeftOut(tuple(_of_motion(spec, model)), tuple(_of_rest(spec, model)))


def _of_motion(spec: Any, model: Any) -> Iterator[str]:
    joint, actuator = partial(joint_name, model), partial(_actuator_name, model)
    for values, curve, text, name in (
        (model.dof_damping, model.dof_dampingpoly, "damping (plant.friction.viscous)", joint),
        (model.dof_frictionloss, None, "friction (plant.friction.coulomb)", joint),
        (model.dof_armature, None, "armature (robot.armature)", joint),
        (model.actuator_armature, None, "armature of actuators (likewise)", actuator),
        (model.actuator_damping, model.actuator_dampingpoly, "damping of actuators (plant.friction.viscous)", actuator),
    ):
        held = (values != 0.0) | (False if curve is None else curve.any(axis=1))
        if held.any():
            yield f"{text}: {_by_value(np.flatnonzero(held).tolist(), values, name)}"
    option = spec.option
    if tuple(option.gravity) != _GRAVITY:
        yield f"gravity of {_vector(option.gravity)} m/s^2 (gravity, along -z)"
    if option.disableflags & mujoco.mjtDisableBit.mjDSBL_GRAVITY:
        yield "gravity switched off by a flag (gravity=0)"
    for text, value in (("density", option.density), ("viscosity", option.viscosity)):
        if value:
            yield f"{text} of the air of {value:g} in SI units"
    if np.any(option.wind):
        yield f"wind of {_vector(option.wind)} m/s"


def _of_rest(spec: Any, model: Any) -> Iterator[str]:
    servos = [actuator for actuator in range(model.nactuator) if not is_motor(model, actuator)]
    if servos:
        names = few([_actuator_name(model, actuator) for actuator in servos])
        yield f"gains, dynamics and transmissions of the actuators {names}: controllers command the joints"
    shapes = len(spec.geoms)
    if shapes:
        yield f"shapes ({shapes}): no wall touches them, and the arm is drawn by its joints"
    for text, elements in (
        ("sensor", spec.sensors), ("camera", spec.cameras), ("light", spec.lights),
        ("contact pair", spec.pairs), ("contact exclusion", spec.excludes),
    ):  # fmt: skip
        if len(elements):
            yield f"{len(elements)} {text}{'s' if len(elements) > 1 else ''}"
    for key in spec.keys:
        if len(key.qpos) == model.nq:
            yield f"keyframe '{key.name}' (robot.home: [{', '.join(f'{value:g}' for value in key.qpos)}])"
    if spec.option.disableflags or spec.option.enableflags:
        yield "flags of <option>"
    usual = mujoco.MjSpec().option
    if (spec.option.timestep, spec.option.integrator) != (usual.timestep, usual.integrator):
        yield "time step and integrator (plant.step, plant.integrator)"


def _actuator_name(model: Any, actuator: int) -> str:
    return model.actuator(actuator).name or f"actuator{actuator}"


def _by_value(indices: Sequence[int], values: FloatArray, name: Callable[[int], str]) -> str:
    """Return names with their values, in SI units, those of equal value together."""
    told: dict[str, list[str]] = {}
    for index in indices:
        told.setdefault(f"{values[index]:g}", []).append(name(index))
    return ", ".join(f"{value} ({few(names)})" for value, names in told.items())


def _vector(values: FloatArray) -> str:
    return ", ".join(f"{value:g}" for value in values)


def _listed(text: str, elements: Sequence[Any], mend: str) -> Iterator[str]:
    if len(elements):
        yield f"holds {text}: {few([_called(element) for element in elements])}; {mend}"


def _called(element: Any) -> str:
    """Return how an element is spoken of: by its name, or by the body that it is on."""
    if element.name:
        return f"'{element.name}'"
    on = getattr(getattr(element, "parent", None), "name", "")
    return f"one of the body '{on}'" if on else "one without a name"


def _joints(model: Any, which: NDArray[np.bool_], text: str, mend: str) -> Iterator[str]:
    if which.any():
        names = [f"'{joint_name(model, joint)}'" for joint in np.flatnonzero(which).tolist()]
        yield f"holds {text} {few(names)}; {mend}"
