"""What every chapter may call: values of stored runs, and the blocks that most chapters need.

A function whose first argument is `runs` gets the work's runs filled in; see names.
"""

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

from runner.errors import RunnerError, nearest
from runner.reporting import figures, run_values
from runner.reporting.document import Block, Curves, Formula, Notice, Playback
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


def formula(typst: str, spoken: str, number: str = "") -> Formula:
    """Return a displayed equation in Typst mathematics, with its words and its number in the source."""
    return Formula(typst, spoken, number)


def notice(title: str, text: str) -> Notice:
    """Return a warning: a limit of what is compared."""
    return Notice("warning", title, text)


def largest(name: str, *values: Measured) -> Measured:
    """Return the largest of some measured values by a name of its own; none where one of them has no value."""
    return _extreme(max, name, values)


def smallest(name: str, *values: Measured) -> Measured:
    """Return the smallest, likewise."""
    return _extreme(min, name, values)


def of_run(runs: Mapping[str, Run], words: str, what: Callable[..., float | None], unit: str, *names: str) -> Measured:
    """Return what a function gives for a run, or for some runs, as a measured value that conditions call by words."""
    chosen = [runs[name] for name in names]
    failed = any(run.status == "failed" for run in chosen)
    return Measured(words, None if failed else what(*chosen), unit)


def _extreme(chosen: Callable[[list[float]], float], name: str, values: Sequence[Measured]) -> Measured:
    known = [each.value for each in values if each.value is not None and not math.isnan(each.value)]
    value = chosen(known) if len(known) == len(values) and known else None
    return Measured(name, value, values[0].unit if values else "1", tuple(values))
