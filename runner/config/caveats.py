"""Config of the caveats: the threshold of each rule."""

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import Field, NonNegativeFloat, PositiveFloat, create_model

from runner.schema.model import StrictModel

_Share = Annotated[float, Field(ge=0.0, le=1.0)]

# Key, type and meaning of the threshold of each rule.
_THRESHOLDS: Mapping[str, tuple[str, Any, str]] = {
    "saturation": ("share", _Share, "Share of the ticks that a joint may be at its torque limit."),
    "chatter": (
        "share",
        _Share,
        "Share of its loop's ticks at which a joint's torque may jump from one limit to the opposite one.",
    ),
    "did_not_follow": ("share", PositiveFloat, "Share of the size of its motion that the tip's error may reach."),
    "joint_limits": ("excess", NonNegativeFloat, "How far a joint may be beyond a position limit, in rad."),
    "exact_velocity": (
        "noise",
        NonNegativeFloat,
        "Noise or resolution that measured positions may have while measured velocities are exact, in rad.",
    ),
    "fixed_mismatch": (
        "error",
        NonNegativeFloat,
        "Largest relative error of the model that may be the same in every repetition.",
    ),
    "overload": ("share", PositiveFloat, "Share of the rated payload that tool and payload may weigh."),
    "no_effort_limit": (
        "payload",
        NonNegativeFloat,
        "Payload that an arm may carry though a joint of it has no torque limit, in kg.",
    ),
    "unstable_gains": (
        "share",
        PositiveFloat,
        "Share of what keeps a velocity loop stable at its period that its gain may take.",
    ),
    "unstable_contact": (
        "radius",
        PositiveFloat,
        "How many times a small motion in contact with a wall may grow in each period of the controller.",
    ),
    "short_horizon": (
        "share",
        PositiveFloat,
        "Share of the run that three time constants of the law's slowest part may take.",
    ),
    "default_plant": ("replaced", _Share, "0 tells of it, 1 does not."),
    "robot_file": ("left_out", NonNegativeFloat, "How many things that would change the motion may be left out."),
    "plant_error": (
        "share",
        _Share,
        "Share of a metric that the plant's step may be worth; 1 silences the rule.",
    ),
}


def _make_threshold(rule: str) -> Any:
    """Return the field of a rule: a group of one key."""
    key, kind, meaning = _THRESHOLDS[rule]
    fields: dict[str, Any] = {key: (kind, ...)}
    doc = f"Threshold of the rule {rule}.\n\nAttributes:\n    {key}: {meaning}\n"
    return create_model(f"{rule}_threshold", __base__=StrictModel, __doc__=doc, **fields), ...


_Thresholds: Any = create_model(
    "_Thresholds", __base__=StrictModel, **{rule: _make_threshold(rule) for rule in _THRESHOLDS}
)


class CaveatsConfig(_Thresholds):  # type: ignore[misc] # the table has its fields
    """When a run tells that its result may mislead; a rule each, which is sprung by what is above its threshold.

    Attributes:
        saturation: A joint at its torque limit.
        chatter: A joint's torque that jumps between its limits.
        did_not_follow: The tip's error, beside the size of its motion.
        joint_limits: Joints beyond their position limits.
        exact_velocity: Exact velocities beside noisy positions.
        fixed_mismatch: Repetitions that vary noise alone, under a wrong model.
        overload: A payload beyond the rating.
        no_effort_limit: A payload on an arm that lifts anything.
        unstable_gains: A velocity gain that its control period does not bear.
        unstable_contact: A wall too stiff for an admittance behind joint servos, or for a law that pushes by torques.
        short_horizon: A run that ends before its law has done its work.
        default_plant: Another plant in place of the default one.
        robot_file: What is not taken from the robot's file.
        plant_error: What the plant's step is worth, of a run that was held against Runge-Kutta.
    """
