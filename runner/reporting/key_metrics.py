"""Key metrics of a run's task, for the first screen of a report and the command line."""

from collections.abc import Sequence
from typing import NamedTuple

from runner.reporting.metric_titles import title
from runner.store import Run

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


def key_metrics(run: Run, most: int) -> Sequence[KeyMetric]:
    """Return the metrics that say most of a run's task: of a goal, of a motion along a path, of a contact.

    Args:
        run: The run; a failed one may have none.
        most: How many.
    """
    return [_in_words(name, run) for name in key_names(run)[:most]]


def key_names(run: Run) -> Sequence[str]:
    """Return the names of the main metrics of a run's task that have a value."""
    task = "contact" if "steady_force" in run.metrics else run.config["trajectory"]["kind"]
    names = dict.fromkeys((*_OF_TASK.get(task, ()), *_OF_MOTION))
    return [name for name in names if _says_something(name, run)]


def _says_something(name: str, run: Run) -> bool:
    """Return True if a run has a value of a metric; that it never settles is one."""
    return name in run.metrics and (name == _SETTLING or run.metrics[name].median is not None)


def _in_words(name: str, run: Run) -> KeyMetric:
    if run.metrics[name].median is None:
        return KeyMetric(title(name), "–", "not reached in half of the repetitions or more")
    count = run.record["repetitions"]
    return KeyMetric(title(name), run.metrics[name].text, f"median of {count}" if count > 1 else "")
