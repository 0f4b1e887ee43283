"""What every chapter may call: values of stored runs, and the blocks that most chapters need.

A function whose first argument is `runs` gets the work's runs filled in; see names.
"""

from collections.abc import Mapping
from typing import Any

from runner.errors import RunnerError, nearest
from runner.reporting import figures, run_values
from runner.reporting.document import Block, Curves, Playback
from runner.reporting.measured import Measured
from runner.store import Run


def metric(runs: Mapping[str, Run], run: str, name: str, words: str = "") -> Measured:
    """Return the median of a metric of a run, with its unit; conditions call it by the words, or by run and name."""
    return run_values.measured(runs[run], name, words or f"{name} of {run}")


def config(runs: Mapping[str, Run], run: str, key: str) -> Any:
    """Return a value of a run's config by its dotted key.

    Raises:
        RunnerError: if there is no such key.
    """
    value: Any = runs[run].config
    for part in key.split("."):
        if not isinstance(value, Mapping) or part not in value:
            raise RunnerError(f"{run}: no key {key}{nearest(part, value if isinstance(value, Mapping) else ())}")
        value = value[part]
    return value


def playback(runs: Mapping[str, Run], run: str, caption: str, end: float) -> Playback:
    """Return the motion of a run up to an instant, in s."""
    return figures.playback(runs[run], caption, end)


def desired_motion(
    runs: Mapping[str, Run], run: str, caption: str, number: str = "", axes: tuple[str, ...] = ("x", "y", "z")
) -> Curves:
    """Return the desired position, velocity and acceleration of a run's tip along some axes."""
    return figures.desired_motion(runs[run], caption, number, tuple(axes))


def failures(runs: Mapping[str, Run], prefix: str) -> list[Block]:
    """Return a notice that names the failed runs of those whose names begin so; nothing where none failed."""
    return run_values.failures({name: run for name, run in runs.items() if name.startswith(prefix)})
