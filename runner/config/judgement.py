"""Config of what a report says about results: bounds on metrics, and thresholds of the caveat rules."""

from collections.abc import Mapping, Sequence
from typing import Annotated, Any

from pydantic import Field, NonNegativeFloat, PositiveFloat, create_model, field_validator

from runner.base.errors import nearest
from runner.base.sanitize import quoted
from runner.plugins.metric_units import unit_of, units
from runner.schema.bound import Bound
from runner.schema.model import StrictModel
from runner.schema.units import Kilograms, Radians, Unit

_METRICS = "metrics"


class SpecConfig(StrictModel):
    """Bounds on metrics.

    Attributes:
        metrics: Bound of each metric, by name; a name may begin with a stage and end with a joint or axis.
    """

    metrics: dict[str, Bound]

    @field_validator("metrics", mode="before")
    @classmethod
    def _check_names(cls, value: Any) -> Any:
        """Reject unknown names of metrics; only the results show which metrics a run has."""
        if not isinstance(value, Mapping) or not value:
            return value
        known = units()
        wrong = [f"{quoted(name)}{nearest(str(name), known)}" for name in value if unit_of(str(name)) is None]
        if wrong:
            raise ValueError(f"no metric is called {', '.join(wrong)}; metrics: {', '.join(known)}")
        return value

    @classmethod
    def find_unit(cls, path: Sequence[str]) -> Unit | None:
        """Return the unit of a key: an end of a bound has the unit of its metric."""
        if len(path) != len(("metrics", "NAME", "max")) or path[0] != _METRICS or path[2] not in ("min", "max"):
            return None
        unit = unit_of(path[1])
        return None if unit is None else Unit("" if unit == "1" else unit)


_Share = Annotated[float, Field(ge=0.0, le=1.0)]

THRESHOLDS: Mapping[str, tuple[str, Any, str]] = {
    "saturation": ("share", _Share, "Allowed fraction of ticks with a joint at its torque limit."),
    "chatter": (
        "share",
        _Share,
        "Allowed fraction of a loop's ticks at which a joint torque jumps from one limit to the opposite one.",
    ),
    "did_not_follow": ("share", PositiveFloat, "Allowed tip error as a fraction of the size of the tip's motion."),
    "joint_limits": ("excess", Radians[NonNegativeFloat], "Allowed excess of a joint over a position limit, in rad."),
    "joint_stops": ("share", _Share, "Allowed fraction of the ticks at which a joint is on a stop of the plant."),
    "joint_speed": ("share", PositiveFloat, "Allowed speed of a joint as a fraction of its speed limit."),
    "exact_velocity": (
        "noise",
        Radians[NonNegativeFloat],
        "Allowed noise or resolution of measured positions if measured velocities are exact, in rad.",
    ),
    "fixed_mismatch": (
        "error",
        NonNegativeFloat,
        "Largest allowed relative model error that is the same in every repetition.",
    ),
    "overload": ("share", PositiveFloat, "Allowed mass of tool and payload as a fraction of the rated payload."),
    "no_effort_limit": (
        "payload",
        Kilograms[NonNegativeFloat],
        "Allowed payload of an arm with a joint without torque limit, in kg.",
    ),
    "unstable_gains": (
        "share",
        PositiveFloat,
        "Allowed velocity gain as a fraction of the largest gain that is stable at the control period.",
    ),
    "unstable_contact": (
        "radius",
        PositiveFloat,
        "Allowed growth factor of a small motion in contact with a wall, per control period.",
    ),
    "short_horizon": (
        "share",
        PositiveFloat,
        "Allowed length of three time constants of the slowest part of the control law, as a fraction of the run.",
    ),
    "robot_file": ("left_out", NonNegativeFloat, "Allowed number of ignored elements that affect the motion."),
    "plant_error": (
        "share",
        _Share,
        "Allowed integration error of a metric, as a fraction; 1 disables the rule.",
    ),
    "rounding_grows": (
        "share",
        _Share,
        "Allowed change of a metric through rounding, as a fraction; 1 disables the rule.",
    ),
}

"""Key, type and meaning of the threshold of each caveat rule; the rules are in runner/caveats."""


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
