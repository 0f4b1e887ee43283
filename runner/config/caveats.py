"""Thresholds of the caveat rules."""

from collections.abc import Mapping
from typing import Annotated, Any

from pydantic import Field, NonNegativeFloat, PositiveFloat, create_model

from runner.schema.model import StrictModel
from runner.schema.units import Kilograms, Radians

_Share = Annotated[float, Field(ge=0.0, le=1.0)]

THRESHOLDS: Mapping[str, tuple[str, Any, str]] = {
    "saturation": ("share", _Share, "Share of the ticks that a joint may be at its torque limit."),
    "chatter": (
        "share",
        _Share,
        "Share of its loop's ticks at which a joint's torque may jump from one limit to the opposite one.",
    ),
    "did_not_follow": ("share", PositiveFloat, "Share of the size of its motion that the tip's error may reach."),
    "joint_limits": ("excess", Radians[NonNegativeFloat], "Excess of a joint over a position limit, in rad."),
    "exact_velocity": (
        "noise",
        Radians[NonNegativeFloat],
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
        Kilograms[NonNegativeFloat],
        "Payload that an arm may carry though a joint of it has no torque limit, in kg.",
    ),
    "unstable_gains": (
        "share",
        PositiveFloat,
        "Velocity gain as a share of the largest gain that is stable at the control period.",
    ),
    "unstable_contact": (
        "radius",
        PositiveFloat,
        "Growth factor of a small motion in contact with a wall in each control period.",
    ),
    "short_horizon": (
        "share",
        PositiveFloat,
        "Share of the run that three time constants of the slowest part of the control law may take.",
    ),
    "default_plant": ("replaced", _Share, "0 reports it, 1 does not."),
    "robot_file": ("left_out", NonNegativeFloat, "Number of elements left out that affect the motion."),
    "plant_error": (
        "share",
        _Share,
        "Share of a metric that may be integration error; 1 disables the rule.",
    ),
}

"""Key, type and meaning of the threshold of each caveat rule; runner/metrics/caveats has the rules."""


def _make_threshold(rule: str) -> Any:
    """Return the field of a rule: a group of one key."""
    key, kind, meaning = THRESHOLDS[rule]
    fields: dict[str, Any] = {key: (kind, ...)}
    doc = f"Threshold of the rule {rule}.\n\nAttributes:\n    {key}: {meaning}\n"
    return create_model(f"{rule}_threshold", __base__=StrictModel, __doc__=doc, **fields), ...


_FIELDS: Any = {rule: _make_threshold(rule) for rule in THRESHOLDS}
_Thresholds: Any = create_model("_Thresholds", __base__=StrictModel, **_FIELDS)


class CaveatsConfig(_Thresholds):  # type: ignore[misc] # the table has its fields
    """The threshold of each caveat rule: a run has the caveat if the rule's value is above it."""
