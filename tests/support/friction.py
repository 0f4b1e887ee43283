"""Friction laws for tests, from the keys of `plant.friction`, and a wheel to brake."""

import numpy as np

from runner.plants.friction_law import JointFriction, joint_friction
from runner.schema.values import FrictionConfig, SigmoidConfig
from runner.symbolic.maths import NUMPY

MASS = 0.5 + 2.0 * 0.3**2  # kg m^2, of the wheel about its joint
WHEEL = """
<robot name="wheel"><link name="base"><inertial><mass value="0"/>
  <inertia ixx="0" iyy="0" izz="0" ixy="0" ixz="0" iyz="0"/></inertial></link><link name="wheel"><inertial>
  <origin xyz="0.3 0 0"/><mass value="2"/><inertia ixx="0.3" iyy="0.3" izz="0.5" ixy="0" ixz="0" iyz="0"/>
</inertial></link>
<joint name="q1" type="revolute"><parent link="base"/><child link="wheel"/><axis xyz="0 0 1"/>
  <limit lower="-1e9" upper="1e9" effort="1e9" velocity="1e9"/></joint></robot>
"""
NONE = {"viscous": 0.0, "coulomb": 0.0, "asymmetry": None, "static": None, "stribeck_speed": None}


def friction_law(
    joints: int = 1, level=0.0, steepness=0.0, shift=0.0, stribeck_curve="gauss", **values
) -> JointFriction:
    """Return the friction of joints q1, q2, ...; the sigmoid's keys are given without its name."""
    sigmoid = SigmoidConfig(level=level, steepness=steepness, shift=shift)
    config = FrictionConfig(**{**NONE, **values}, stribeck_curve=stribeck_curve, sigmoid=sigmoid)
    return joint_friction("plant.friction", config, [f"q{joint + 1}" for joint in range(joints)])


def law_of_tick(law: JointFriction, v: np.ndarray, held: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return torque per speed and level of dry friction of each joint, shapes (n,)."""
    damping, level = law.at(NUMPY, v.tolist(), held.tolist())
    return np.array(damping), np.array(level)
