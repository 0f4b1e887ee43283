"""Metrics in reports: titles such as "largest tracking error, x", order, and the key ones of a run's task."""

import re
from collections.abc import Collection, Mapping, Sequence
from typing import TYPE_CHECKING

from runner.base.quantities import label_with_unit
from runner.plugins.metric_units import added_families
from runner.reporting.words import NAMES

if TYPE_CHECKING:
    from runner.store import Run

TITLES = NAMES["metrics"]
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
    given = [getattr(family, "TITLES", None) for family in added]
    own = {str(one): str(text) for some in given if isinstance(some, Mapping) for one, text in some.items()}
    stage, _, part = f"_{name}_".partition(f"_{base}_")
    texts = [{**own, **TITLES}.get(base, _spaced(base)), _part(part.strip("_"))]
    told = ", ".join(text for text in texts if text)
    return f"{_spaced(stage).capitalize()}: {told}" if stage else told


def capital(text: str) -> str:
    """Return a string with a capital as its first letter."""
    return text[:1].upper() + text[1:]


def metric_label(name: str, unit: str) -> str:
    """Return the title of a metric with its unit, as on the axis of a figure."""
    return label_with_unit(title(name), unit)


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


def key_metrics(run: "Run", most: int) -> Sequence[tuple[str, str, str]]:
    """Return the metrics that say most of a run's task: of a goal, of a motion along a path, of a contact.

    Each has a title; its median with the range over the repetitions, in a unit that spares powers of ten; and a remark
    or "".

    Args:
        run: The run; a failed one may have none.
        most: How many.
    """
    return [_in_words(name, run) for name in key_names(run)[:most]]


def key_names(run: "Run") -> Sequence[str]:
    """Return the names of the main metrics of a run's task that have a value; that it never settles is one."""
    task = "contact" if "steady_force" in run.metrics else run.config["trajectory"]["kind"]
    names = [name for name in dict.fromkeys((*_OF_TASK.get(task, ()), *_OF_MOTION)) if name in run.metrics]
    return [name for name in names if name == _SETTLING or run.metrics[name].median is not None]


def _in_words(name: str, run: "Run") -> tuple[str, str, str]:
    if run.metrics[name].median is None:
        return title(name), "–", "not reached in half of the repetitions or more"
    count = run.record["repetitions"]
    return (title(name), run.metrics[name].text, f"median of {count}" if count > 1 else "")
