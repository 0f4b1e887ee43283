"""Metrics in reports: titles such as "largest tracking error, x", order, and the key ones of a run's task."""

import re
from collections.abc import Collection, Mapping, Sequence
from types import ModuleType
from typing import TYPE_CHECKING, NamedTuple

from runner.base.quantities import label_with_unit
from runner.plugins.metric_units import added_families

if TYPE_CHECKING:
    from runner.store import Run

TITLES = {
    "settling_time": "settling time",
    "steady_state_error": "steady-state error",
    "overshoot": "overshoot",
    "max_tracking_error": "largest tracking error",
    "max_axis_error": "largest tracking error on one axis",
    "rms_tracking_error": "rms tracking error",
    "rms_tracking_error_last_period": "rms tracking error, last period",
    "rms_tracking_error_period": "rms tracking error, period",
    "cross_track_error": "largest distance from the path",
    "max_joint_error": "largest joint error",
    "rms_joint_error": "rms joint error",
    "peak_torque": "largest torque",
    "rms_torque": "rms torque",
    "torque_chatter": "torque chatter",
    "peak_joint_speed": "largest joint speed",
    "peak_joint_force": "largest joint force",
    "rms_joint_force": "rms joint force",
    "force_chatter": "force chatter",
    "peak_sliding_speed": "largest sliding speed",
    "saturation_fraction": "share of ticks at a torque limit",
    "energy": "energy",
    "control_effort": "control effort",
    "force_effort": "force effort",
    "reach_loss_fraction": "share of ticks out of reach",
    "peak_force": "largest contact force",
    "steady_force": "contact force at rest",
    "force_error": "error of the felt contact force",
}
"""Titles of the built-in metrics. A family of metrics from a plug-in may have its own TITLES."""

_PREFERRED = (
    "max_tracking_error",
    "settling_time",
    "steady_state_error",
    "peak_torque",
    "cross_track_error",
    "saturation_fraction",
    "control_effort",
)
COSTS = ("peak_torque", "rms_torque", "control_effort", "energy")
"""Metrics of what a motion costs."""

_JOINT = re.compile(r"q(\d+)")
_PART = re.compile(r".*_([xyz]|q\d+)$")


def title(name: str) -> str:
    """Return the title of a metric: its stage, what it is, its axis or joint; underscores become spaces without one."""
    added = added_families()
    names = [*TITLES, *(metric for family in added for metric in family.UNITS)]
    base = max((base for base in names if f"_{base}_" in f"_{name}_"), key=len, default=name)
    titles = {**_titles_of(added), **TITLES}
    stage, _, part = f"_{name}_".partition(f"_{base}_")
    texts = [titles.get(base, _spaced(base)), _part(part.strip("_"))]
    told = ", ".join(text for text in texts if text)
    return f"{_spaced(stage).capitalize()}: {told}" if stage else told


def capital(text: str) -> str:
    """Return a string with a capital as its first letter."""
    return text[:1].upper() + text[1:]


def metric_label(name: str, unit: str) -> str:
    """Return the title of a metric with its unit, as on the axis of a figure."""
    return label_with_unit(title(name), unit)


def _titles_of(families: Sequence[ModuleType]) -> dict[str, str]:
    """Return the titles that families give; a value that is not a mapping is ignored."""
    given = [getattr(family, "TITLES", None) for family in families]
    return {str(name): str(text) for titles in given if isinstance(titles, Mapping) for name, text in titles.items()}


def is_part(name: str) -> bool:
    """Return True for a metric of one direction or joint, such as peak_torque_q1."""
    return _PART.match(name) is not None


def whole_metrics(known: Collection[str]) -> list[str]:
    """Return metrics without those of one direction or joint, errors first, as they are compared."""
    return [name for name in dict.fromkeys([*_PREFERRED, *known]) if name in known and not is_part(name)]


def first_screen(metrics: Sequence[str]) -> list[str]:
    """Return the metrics of a first screen, of some in order: the first, and what it costs or else the second."""
    costs = [name for name in COSTS if name in metrics[1:]] or metrics[1:]
    return [*metrics[:1], *costs[:1]]


def _part(part: str) -> str:
    joint = _JOINT.fullmatch(part)
    return f"joint {joint[1]}" if joint else _spaced(part)


def _spaced(name: str) -> str:
    return name.strip("_").replace("_", " ")


_SETTLING = "settling_time"
_OF_TASK = {
    "goal": (_SETTLING, "steady_state_error", "peak_torque", "saturation_fraction", "overshoot"),
    "contact": ("steady_force", "peak_force", "max_tracking_error", "peak_torque"),
}
_OF_MOTION = (
    "max_tracking_error",
    "steady_state_error",
    "peak_torque",
    "saturation_fraction",
    "rms_tracking_error",
)


class KeyMetric(NamedTuple):
    """Title, value and remark of a metric.

    Attributes:
        title: What it is.
        value: Its median with the range over the repetitions, in a unit that spares powers of ten.
        remark: Remark for the reader; empty for nothing.
    """

    title: str
    value: str
    remark: str


def key_metrics(run: "Run", most: int) -> Sequence[KeyMetric]:
    """Return the metrics that say most of a run's task: of a goal, of a motion along a path, of a contact.

    Args:
        run: The run; a failed one may have none.
        most: How many.
    """
    return [_in_words(name, run) for name in key_names(run)[:most]]


def key_names(run: "Run") -> Sequence[str]:
    """Return the names of the main metrics of a run's task that have a value."""
    task = "contact" if "steady_force" in run.metrics else run.config["trajectory"]["kind"]
    names = dict.fromkeys((*_OF_TASK.get(task, ()), *_OF_MOTION))
    return [name for name in names if _says_something(name, run)]


def _says_something(name: str, run: "Run") -> bool:
    """Return True if a run has a value of a metric; that it never settles is one."""
    return name in run.metrics and (name == _SETTLING or run.metrics[name].median is not None)


def _in_words(name: str, run: "Run") -> KeyMetric:
    if run.metrics[name].median is None:
        return KeyMetric(title(name), "–", "not reached in half of the repetitions or more")
    count = run.record["repetitions"]
    return KeyMetric(title(name), run.metrics[name].text, f"median of {count}" if count > 1 else "")
