"""Joint properties of an MJCF: effort limits, damping, friction, armature and home positions."""

from collections.abc import Mapping
from typing import Any

import mujoco
import numpy as np

from runner.base.arrays import FloatArray
from runner.robots.mjcf_urdf import joint_name

HOME = "home"  # the keyframe that is taken
ON_JOINTS = (mujoco.mjtTrn.mjTRN_JOINT, mujoco.mjtTrn.mjTRN_JOINTINPARENT)


def dynamics_of(model: Any) -> Mapping[str, FloatArray]:
    """Return damping, friction and armature of each joint, shapes (njnt,), in SI units; those of its actuators count.

    An actuator turns as fast as its joint times its gear, and so counts by the square of it.
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
    """Return where a specification's keyframe `home` has the model's joints, in rad or m; empty without one."""
    for key in spec.keys:
        if key.name == HOME and len(key.qpos) == model.nq:
            return {joint_name(model, joint): float(key.qpos[joint]) for joint in range(model.njnt)}
    return {}


def efforts_of(model: Any) -> tuple[dict[int, float], list[str]]:
    """Return the largest torque of joints by index, in N m (N where they slide), and what is told of it.

    It is the least of the joint's actuatorfrcrange and of what its one actuator can give: its force range, and where it
    is a plain motor that of its control, times gain and gear. Of unequal limits to both sides it is the smaller.
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
    """Return the actuators on each joint that has some, by index."""
    acting: dict[int, list[int]] = {}
    on_joints = [int(kind) for kind in ON_JOINTS]
    for actuator in range(model.nactuator):
        if model.actuator_trntype[actuator] in on_joints:
            acting.setdefault(int(model.actuator_trnid[actuator, 0]), []).append(actuator)
    return acting


def _forces(model: Any, actuator: int) -> list[FloatArray]:
    """Return the ranges of what an actuator puts on its joint."""
    gear, ranges = model.actuator_gear[actuator, 0], []
    if model.actuator_forcelimited[actuator]:
        ranges.append(gear * model.actuator_forcerange[actuator])
    if is_motor(model, actuator) and model.actuator_ctrllimited[actuator]:
        ranges.append(gear * model.actuator_gainprm[actuator, 0] * model.actuator_ctrlrange[actuator])
    return ranges


def is_motor(model: Any, actuator: int) -> bool:
    """Tell whether an actuator puts a force on its joint that is its control, times gain and gear."""
    return bool(
        model.actuator_gaintype[actuator] == mujoco.mjtGain.mjGAIN_FIXED
        and model.actuator_biastype[actuator] == mujoco.mjtBias.mjBIAS_NONE
        and model.actuator_dyntype[actuator] == mujoco.mjtDyn.mjDYN_NONE
        and any(actuator in acting for acting in _acting(model).values())
    )


def actuator_name(model: Any, actuator: int) -> str:
    """Return the name of an actuator, or one made of its number."""
    return model.actuator(actuator).name or f"actuator{actuator}"
