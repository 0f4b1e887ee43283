"""Readable names for presets, plants, controllers and variants."""

import re

PRESET = {"as_reported": "as fitted", "full_equations": "by the printed equations"}
"""The presets of the studies, in the order of their columns."""

PLANT = {
    "bullet": "PyBullet",
    "mujoco": "MuJoCo",
    "rk4": "Runge-Kutta",
    "rk4_flexible_links": "Runge-Kutta with bending links",
}

_WORDS = {
    **PRESET,
    **PLANT,
    "one_way": "one-way",
    "two_way": "two-way",
    "independent": "independent, offset turning with the wrist",
    "independent_base": "independent, offset fixed in the base frame",
    "mini_held": "Mini held",
    "whole_body": "whole body",
    "tip_goal": "the goal itself",
    "minus_home": "the goal less the offset at home",
    "joint_limits": "joint limits",
    "operational_space": "operational space",
    "computed_torque": "computed torque",
    "joint_pd": "joint PD",
    "joint_pid": "joint PID",
    "motor_pd": "motor PD",
    "sliding_mode": "sliding mode",
    "passivity": "passivity-based",
    "with_integral": "computed torque + integral",
    "observed": "computed torque + observer",
    "observed_pd": "joint PD + observer",
    "hybrid_force": "force and motion",
    "last_stage": "the last stage alone",
    "iterative_learning": "iterative learning",
    "euler": "Euler",
    "macro_mini": "Macro and Mini coupled",
}
_CODE_NAME = re.compile(rf"\b({'|'.join(_WORDS)})\b")


def in_words(name: str) -> str:
    """Return a preset, plant, coupling or variant, such as "full_equations, decoupled", as a readable name."""
    return _CODE_NAME.sub(lambda found: _WORDS[found[0]], name)
